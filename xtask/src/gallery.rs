//! Draws the examples with the release build of the command, and the page that shows them.

use crate::{Outcome, cargo, root, run};
use std::fmt::Write as _;
use std::fs;
use std::process::Command;

/// The size of each picture in pixels.
const SIZE: &str = "900x640";

/// One picture: the name of the example, the file that it goes to, options of `nappe render`, a caption.
struct Picture(&'static str, &'static str, &'static str, &'static str);

/// The page in its order: headings with their pictures.
const CHAPTERS: &[(&str, &[Picture])] = &[
    (
        "A whole model",
        &[
            Picture(
                "duct",
                "duct.png",
                "--isolines 8 --azimuth 25 --elevation 20",
                "A round-to-square transition duct: four Coons panels with cubic blending between two straight collars. \
                 Radius, side, height and collar are parameters of the model.",
            ),
            Picture(
                "duct",
                "duct-zebra.png",
                "--style zebra --azimuth 25 --elevation 12",
                "The same duct under zebra stripes. They go on from the panels into the collars, where `nappe check` \
                 proves that the surfaces share their tangent planes, and break at the corner edges.",
            ),
        ],
    ),
    (
        "Patches from corners and nets",
        &[
            Picture(
                "bilinear",
                "bilinear.png",
                "--isolines 12 --azimuth 20",
                "Four corners of a cube give the bilinear surface x = u (1 − v), y = v, z = u, a hyperbolic paraboloid: \
                 all its isolines are straight.",
            ),
            Picture(
                "hermite",
                "hermite.png",
                "--isolines 8",
                "Two Hermite patches on the same corners and tangents. The twists of the left one are zero; those of \
                 the right one are not, and change the inside only.",
            ),
            Picture(
                "bezier-rib",
                "bezier-rib.png",
                "--nets",
                "A Bézier surface with its control net, and a ruled rib that stands on one of its isoparametric curves.",
            ),
            Picture(
                "rational-basis",
                "rational-basis.png",
                "--isolines 8",
                "A rational surface on a trigonometric basis, which gives an exact quarter of an ellipse, beside a NURBS \
                 surface with two heavy points in its middle.",
            ),
            Picture(
                "teapot",
                "teapot.png",
                "",
                "The Utah teapot: 32 bicubic Bézier patches, meshed without a gap along their shared sides.",
            ),
            Picture(
                "teapot",
                "teapot-mean-curvature.png",
                "--style curvature-mean --no-edges",
                "Mean curvature of the teapot, with its legend. The normals of the original patches point inward, so \
                 what bulges outward is positive.",
            ),
            Picture(
                "wigley",
                "wigley.png",
                "--azimuth 60 --elevation 15 --isolines 6",
                "The Wigley hull. Its formula is biquadratic, so nine control points give it exactly.",
            ),
        ],
    ),
    (
        "Surfaces from curves",
        &[
            Picture(
                "wing-ruled",
                "wing-ruled.png",
                "--azimuth 20",
                "A wing ruled between two aerofoils from coordinate tables.",
            ),
            Picture(
                "wing-coons",
                "wing-coons.png",
                "--azimuth 20",
                "A wing with curved leading and trailing edges: Coons surfaces on four curves each.",
            ),
            Picture(
                "blade",
                "blade.png",
                "--azimuth 20",
                "A turbine blade: each side is a Coons surface on hub, tip, leading and trailing edge.",
            ),
            Picture(
                "coons-blending",
                "coons-blending.png",
                "--isolines 8",
                "One contour, four blendings: linear (left), cubic (front), trigonometric (back), and quintic blending \
                 functions written in the model (right).",
            ),
            Picture(
                "coons-neighbour",
                "coons-neighbour.png",
                "--style zebra",
                "A Coons surface that takes the derivative across one side from its neighbour: the stripes go on \
                 across the shared side.",
            ),
            Picture(
                "coons-quintic",
                "coons-quintic.png",
                "--style zebra",
                "The same with quintic blending: the surface takes second derivatives too, and the stripes go on without \
                 a bend.",
            ),
            Picture(
                "diagonal-key",
                "diagonal-key.png",
                "--azimuth 75 --isolines 6",
                "Three surfaces on one contour. Left: the Diagonal-key surface. Middle: the same with the free functions \
                 p and q. Right: the Coons surface.",
            ),
            Picture(
                "diagonal-key-space",
                "diagonal-key-space.png",
                "--azimuth 75 --isolines 6",
                "A contour whose generators do not lie in parallel planes: the particular solution in space, and beside \
                 it the surface with two free vectors.",
            ),
            Picture(
                "diagonal-key-stitched",
                "diagonal-key-stitched.png",
                "--isolines 6",
                "A Diagonal-key surface between two Bézier surfaces, stitched smoothly to both.",
            ),
        ],
    ),
    (
        "Surfaces of revolution",
        &[
            Picture(
                "revolution-grigoriev",
                "revolution-grigoriev.png",
                "--nets",
                "Grigoriev's construction: a rational quarter and its reflections, with their control nets.",
            ),
            Picture(
                "revolution-chashnikov",
                "revolution-chashnikov.png",
                "",
                "Chashnikov's construction: each quarter is the Coons surface of its boundary with trigonometric \
                 blending, and exactly the surface of revolution.",
            ),
            Picture(
                "revolution-conic-sections",
                "revolution-conic-sections.png",
                "--azimuth 135 --elevation 35",
                "Grigoriev's other sections: from right to left a circle (μ = 1/2), an ellipse, a parabola, a hyperbola.",
            ),
            Picture(
                "sphere-octants",
                "sphere-octants.png",
                "--nets",
                "The unit sphere from eight rational octants, with their control nets.",
            ),
            Picture(
                "vase",
                "vase.png",
                "--elevation 20",
                "A vase: a cubic spline through measured points, turned. Its foot has a pole.",
            ),
            Picture(
                "vase",
                "vase-gaussian-curvature.png",
                "--style curvature-gaussian --elevation 20 --no-edges",
                "Gaussian curvature of the vase: positive on the belly, negative at the neck.",
            ),
            Picture(
                "bottle",
                "bottle.svg",
                "--style wire --elevation 15 --tolerance 0.5",
                "A bottle as a line drawing in SVG, hidden lines left out.",
            ),
        ],
    ),
    (
        "Curves on surfaces",
        &[
            Picture(
                "curves-on-surfaces",
                "curves-on-surfaces.png",
                "--curves --isolines 3",
                "Curves given by conditions: f(u, v) = 0, a plane section, a silhouette, an isophote, and the circle where \
                 the Gaussian curvature of a ring changes its sign.",
            ),
            Picture(
                "intersection",
                "intersection.png",
                "--curves --isolines 0 --azimuth -50 --elevation 35",
                "Two closed curves in which a pipe meets a ring, each proven to be complete, and the curve in which a spline sheet \
                 cuts it.",
            ),
            Picture(
                "quadrics",
                "quadrics-sections.png",
                "--azimuth 25 --elevation 38 --isolines 0 --silhouettes --sections z:10",
                "Silhouettes and plane sections, traced on the surfaces and not on their meshes.",
            ),
            Picture(
                "vase",
                "vase-isophotes.png",
                "--isolines 0 --silhouettes --isophotes 14 --isocurvature gaussian=0",
                "Lines of equal angle to the view, and in blue where the Gaussian curvature is zero.",
            ),
        ],
    ),
    (
        "Closed forms",
        &[
            Picture(
                "quadrics",
                "quadrics.png",
                "--azimuth 25 --elevation 38",
                "The ten quadrics, each made of rational biquadratic patches: ellipsoid, sphere, hyperboloids of one and \
                 two sheets; paraboloids, cone, cylinder; parabolic and hyperbolic cylinders.",
            ),
            Picture(
                "torus",
                "torus.png",
                "--isolines 6",
                "A torus, a piece of one, and a single biquadratic patch of 80° by 70°.",
            ),
            Picture(
                "blend",
                "blend.png",
                "--isolines 7 --azimuth 30 --elevation 28",
                "Blends that continue two surfaces with their curvatures: between two sheets, and between two round pipes \
                 of different size and direction.",
            ),
            Picture(
                "fillet-planes",
                "fillet-planes.png",
                "--azimuth 25 --elevation 35",
                "Fillets between two planes: one radius, and a radius that grows along the edge.",
            ),
            Picture(
                "fillet-cylinder",
                "fillet-cylinder.png",
                "",
                "A fillet around the foot of a pin, between a plane and a cylinder.",
            ),
            Picture(
                "fillet-pipes",
                "fillet-pipes.png",
                "",
                "A ball rolled round the joint of two pipes: a fillet between cylinders.",
            ),
            Picture(
                "fillet-hull",
                "fillet-hull.png",
                "--azimuth -60 --elevation 30",
                "A fillet of variable radius between two free-form surfaces.",
            ),
            Picture(
                "fillet-box",
                "fillet-box.png",
                "",
                "A chain of fillets round the upper edges of a box, with eighths of spheres in the corners.",
            ),
        ],
    ),
];

pub(crate) fn draw() -> Outcome {
    let folder = root().join("docs/gallery");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    run(&mut cargo(&[
        "build",
        "--release",
        "--package",
        "nappe-cli",
    ]))?;
    let target =
        std::env::var("CARGO_TARGET_DIR").map_or_else(|_| root().join("target"), Into::into);
    let nappe = target.join("release").join("nappe");
    for Picture(example, file, options, _) in CHAPTERS.iter().flat_map(|(_, p)| *p) {
        run(Command::new(&nappe)
            .args([
                "render",
                "--quiet",
                &format!("examples/{example}.nappe.toml"),
            ])
            .args(["-o", &format!("docs/gallery/{file}"), "--size", SIZE])
            .args(options.split_whitespace()))?;
    }
    let path = root().join("docs/gallery.md");
    fs::write(&path, page().map_err(|e| e.to_string())?)
        .map_err(|e| format!("{}: {e}", path.display()))
}

/// The page as Markdown.
fn page() -> Result<String, std::fmt::Error> {
    let mut page = String::from(
        "# Gallery\n\nDrawn by `cargo xtask gallery` from the models in [`examples/`](../examples), without a GPU and \
         without a screen. Surfaces seen from behind, where the normal points away, are mixed with grey.\n",
    );
    for (heading, pictures) in CHAPTERS {
        write!(page, "\n## {heading}\n")?;
        for Picture(example, file, options, caption) in *pictures {
            let model = format!("examples/{example}.nappe.toml");
            let command = format!("nappe render {model} -o {file} --size {SIZE} {options}");
            let name = file.split_once('.').map_or(*file, |(name, _)| name);
            write!(
                page,
                "\n### {name}\n\n![{name}](gallery/{file})\n\n{caption} Model: [{example}](../{model}).\n\n```sh\n{}\n```\n",
                command.trim_end()
            )?;
        }
    }
    Ok(page)
}

#[test]
fn the_page_is_up_to_date() {
    let there = fs::read_to_string(root().join("docs/gallery.md")).unwrap_or_default();
    assert!(
        page().is_ok_and(|p| p == there),
        "run `cargo xtask gallery` and commit what it draws"
    );
}
