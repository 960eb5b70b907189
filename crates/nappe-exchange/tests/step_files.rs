//! Public STEP files, where they are at hand.

use nappe_exchange::{ItemForm, step};
use std::path::{Path, PathBuf};

/// The folder of public files beside the project; `None` where it is not.
fn shared() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    ["../shared/data", "../../shared/data"]
        .into_iter()
        .map(|d| root.join(d))
        .find(|d| d.is_dir())
}

/// File, faces, and how many things are left out.
const FILES: [(&str, usize, usize); 19] = [
    ("axom/boxed_sphere.step", 0, 0),
    ("axom/sliced_cylinder.step", 0, 0),
    ("axom/tet.step", 0, 0),
    ("cax-if/MAINBODY_FRONT.stp", 0, 0),
    ("cax-if/TAIL_TURBINE.stp", 0, 0),
    ("cax-if/as1-oc-214.stp", 0, 0),
    ("cax-if/dm1-id-214.stp", 0, 0),
    ("cax-if/sg1-c5-214.stp", 0, 0),
    ("hulls-and-wing/wigley.step", 0, 0),
    ("occt/screw.step", 0, 0),
    ("thin-revolved/single_volume_thin.stp", 0, 0),
    ("tigl/nacelle.stp", 0, 0),
    ("truck/abc-0000.step", 0, 0),
    ("truck/abc-0008.step", 0, 0),
    ("truck/occt-cone.step", 0, 0),
    ("truck/occt-cube.step", 0, 0),
    ("truck/occt-cylinder.step", 0, 0),
    ("truck/occt-sphere.step", 0, 0),
    ("truck/occt-torus.step", 0, 0),
];

#[test]
fn public_files_are_read() {
    let Some(shared) = shared() else {
        eprintln!("skipped: the public files are not beside the project");
        return;
    };
    for (name, _, _) in FILES {
        let bytes = std::fs::read(shared.join(name)).unwrap();
        let start = std::time::Instant::now();
        let file = step::read(&bytes).unwrap();
        let d = &file.document;
        let mut faces = 0;
        for i in &d.items {
            if let ItemForm::Body { body, .. } = &i.form {
                faces += body.faces.len();
                body.validate(d.uncertainty.unwrap_or(1e-6)).unwrap();
            }
        }
        println!(
            "{name}: {} entities, {} items, {faces} faces, {:?} {:?} {:?}",
            file.entities,
            d.items.len(),
            d.units,
            d.uncertainty,
            start.elapsed()
        );
        println!(
            "   names {:?}",
            d.items
                .iter()
                .map(|i| (&i.name, i.colour))
                .take(4)
                .collect::<Vec<_>>()
        );
        for l in &d.left_out {
            println!(
                "   left out {} × {} {}: {}",
                l.count, l.what, l.first, l.why
            );
        }
    }
}
