//! `nappe render`: every style, view and format.

use crate::run::Folder;

const MODEL: &str = r#"
title = "Saddle"
[surfaces.saddle]
kind = "bezier"
points = [[[0, 0, 0], [0, 1, 1], [0, 2, 0]], [[1, 0, 1], [1, 1, -2], [1, 2, 1]], [[2, 0, 0], [2, 1, 1], [2, 2, 0]]]
[curves.line]
kind = "line"
from = [0, 0, 0]
to = [2, 2, 2]
"#;

fn drawn(folder: &Folder, args: &str) -> Vec<u8> {
    let run = folder.nappe(&format!(
        "render model.nappe.toml -o out.png --size 200x150 {args}"
    ));
    assert_eq!(run.code, 0, "{args}: {}", run.stderr);
    assert!(run.stdout.is_empty());
    folder.read("out.png")
}

#[test]
fn every_option_changes_the_picture() {
    let folder = Folder::with_model(MODEL);
    let mut pictures = vec![drawn(&folder, "")];
    for args in [
        "--style curvature-gaussian",
        "--style curvature-mean",
        "--style zebra",
        "--style wire",
        "--view front",
        "--view top",
        "--view 10,20",
        "--azimuth -30",
        "--elevation 80",
        "--projection parallel",
        "--isolines 0",
        "--nets",
        "--curves",
        "--no-edges",
        "--background dark",
        "--background transparent",
        "--bare",
    ] {
        let picture = drawn(&folder, args);
        assert!(picture.starts_with(b"\x89PNG"), "{args}");
        let size = [16, 20].map(|i| u32::from_be_bytes(picture[i..i + 4].try_into().unwrap()));
        assert_eq!(size, [200, 150], "{args}");
        assert!(!pictures.contains(&picture), "{args} changes nothing");
        pictures.push(picture);
    }
}

#[test]
fn the_same_command_draws_the_same_picture() {
    let folder = Folder::with_model(MODEL);
    assert_eq!(
        drawn(&folder, "--style zebra"),
        drawn(&folder, "--style zebra")
    );
}

#[test]
fn svg_is_well_formed_and_names_the_model() {
    let folder = Folder::with_model(MODEL);
    let run = folder.nappe("render model.nappe.toml -o out.svg --tolerance 0.05");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let text = String::from_utf8(folder.read("out.svg")).unwrap();
    assert!(text.contains("<svg") && text.trim_end().ends_with("</svg>"));
    assert!(text.contains("Saddle"));
}

#[test]
fn other_endings_are_refused_before_anything_is_built() {
    let folder = Folder::with_model("[surfaces.a]\nkind = 'nothing'\n");
    for file in ["out.stl", "out.jpg", "none/out.png"] {
        let run = folder.nappe(&format!("render model.nappe.toml -o {file}"));
        assert!(run.problem().contains(file), "{}", run.stderr);
        assert!(!run.stderr.contains("unknown kind"), "{}", run.stderr);
    }
    assert_eq!(folder.names(), ["model.nappe.toml"]);
}

#[test]
fn a_model_of_curves_alone_is_drawn_by_them() {
    let folder =
        Folder::with_model("[curves.a]\nkind = 'line'\nfrom = [0, 0, 0]\nto = [1, 2, 3]\n");
    assert!(drawn(&folder, "").len() > 500);
}

#[test]
fn parts_too_small_to_be_seen_are_left_out_with_a_note() {
    let square = |name: &str, x: f64, size: f64| {
        let (a, b) = (x, x + size);
        format!(
            "[surfaces.{name}]\nkind = 'bilinear'\ncorners = [[[{a}, 0, 0], [{a}, {size}, 0]], [[{b}, 0, 0], [{b}, {size}, 0]]]\n"
        )
    };
    // First and last, so that what is left out shifts the numbers of what is drawn.
    let model =
        square("dust", -1.0, 1e-6) + &square("floor", 0.0, 1.0) + &square("speck", 2.0, 1e-6);
    let folder = Folder::with_model(&model);
    let alone = Folder::with_model(&square("floor", 0.0, 1.0));
    for style in ["shaded", "curvature-mean", "wire"] {
        let run = folder.nappe(&format!(
            "render model.nappe.toml -o a.png --size 100x100 --style {style}"
        ));
        assert_eq!(run.code, 0, "{}", run.stderr);
        assert!(
            run.stderr.contains("not drawn: dust, speck\n"),
            "{}",
            run.stderr
        );
        let run = alone.nappe(&format!(
            "render model.nappe.toml -o a.png --size 100x100 --style {style}"
        ));
        assert!(!run.stderr.contains("not drawn"), "{}", run.stderr);
    }
    // Where all are alike in size, all are drawn.
    let folder = Folder::with_model(&(square("dust", 0.0, 1e-6) + &square("speck", 2e-6, 1e-6)));
    let run = folder.nappe("render model.nappe.toml -o a.png --size 100x100");
    assert!(
        run.code == 0 && !run.stderr.contains("not drawn"),
        "{}",
        run.stderr
    );
}

#[test]
fn surfaces_without_a_net_are_named() {
    let folder = Folder::with_model(
        "[surfaces.turned]\nkind = 'revolution'\nprofile = { kind = 'line', from = [1, 0, 0], to = [1, 0, 1] }\n\
         [surfaces.arcs]\nkind = 'revolution'\nconstruction = 'rational'\n\
         profile = { kind = 'line', from = [3, 0, 0], to = [3, 0, 1] }\n\
         [surfaces.wave]\nkind = 'ruled'\nsouth = { kind = 'expression', x = 't', y = '5', z = 'sin(t)', domain = [0, 6] }\n\
         north = { kind = 'line', from = [0, 6, 0], to = [6, 6, 0] }\n",
    );
    let run = folder.nappe("render model.nappe.toml -o a.png --size 100x100 --nets");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let notes: Vec<&str> = run
        .stderr
        .lines()
        .filter(|l| l.contains("no control net"))
        .collect();
    assert_eq!(notes.len(), 2, "{}", run.stderr);
    assert!(
        notes[0].contains("turned (revolution): its points are those of a NURBS surface"),
        "{}",
        notes[0]
    );
    assert!(
        notes[1].contains("wave (ruled): it has no exact NURBS form"),
        "{}",
        notes[1]
    );
    assert!(
        run.stderr
            .contains("help: a revolution with construction = \"rational\" has one")
    );
    let run = folder.nappe("render model.nappe.toml -o a.png --size 100x100");
    assert!(!run.stderr.contains("control net"), "{}", run.stderr);
}

#[test]
fn the_legend_of_a_cone_is_not_rounding_and_is_open_where_there_is_no_bound() {
    let folder = Folder::with_model(
        "[surfaces.cone]\nkind = 'revolution'\nprofile = { kind = 'line', from = [1, 0, 0], to = [0, 0, 2] }\n",
    );
    let legend = |style: &str| {
        let run = folder.nappe(&format!(
            "render model.nappe.toml -o a.svg --bare --style {style}"
        ));
        assert_eq!(run.code, 0, "{}", run.stderr);
        let svg = String::from_utf8(folder.read("a.svg")).unwrap();
        let texts = svg
            .split("<text")
            .skip(1)
            .filter_map(|t| t.split_once('>')?.1.split_once('<'));
        texts.map(|t| t.0.to_owned()).collect::<Vec<String>>()
    };
    // A cone can be unrolled: its Gaussian curvature is 0, and shown in the middle of a range that is no rounding error.
    let gaussian = legend("curvature-gaussian");
    assert!(
        gaussian.iter().any(|t| t == "0.0") && gaussian.iter().any(|t| t == "1.0"),
        "{gaussian:?}"
    );
    assert!(
        !gaussian.iter().any(|t| t.contains('e') && t.contains("−3")),
        "{gaussian:?}"
    );
    // Its mean curvature is 1/(2 s tan a), with s the distance from the tip and a the half angle: without bound, but of 2%
    // of the area only it is above 1/(2 · √0.02 · √5 · 1/2) = 3.2.
    let mean = legend("curvature-mean");
    let last = mean
        .iter()
        .find(|t| t.contains('≥') || t.contains("&#8805;"));
    let value: f64 = last.unwrap().rsplit(' ').next().unwrap().parse().unwrap();
    assert!((3.0..=5.0).contains(&value), "{mean:?}");
}
