//! Public files, where they are at hand.

use crate::shared;
use nappe_exchange::{ItemForm, step};

/// File, entities, solids and sheets, faces.
pub(crate) const FILES: [(&str, usize, usize, usize); 19] = [
    ("axom/boxed_sphere.step", 11111, 2, 192),
    ("axom/sliced_cylinder.step", 226, 1, 5),
    ("axom/tet.step", 171, 1, 4),
    ("cax-if/MAINBODY_FRONT.stp", 1126, 1, 22),
    ("cax-if/TAIL_TURBINE.stp", 704, 1, 20),
    ("cax-if/as1-oc-214.stp", 6425, 18, 160),
    ("cax-if/dm1-id-214.stp", 1189, 7, 48),
    ("cax-if/sg1-c5-214.stp", 460, 1, 16),
    ("hulls-and-wing/wigley.step", 152, 1, 1),
    ("occt/screw.step", 1239, 1, 10),
    ("thin-revolved/single_volume_thin.stp", 2451, 1, 6),
    ("tigl/nacelle.stp", 3432, 1, 6),
    ("truck/abc-0000.step", 863, 6, 25),
    ("truck/abc-0008.step", 699, 1, 21),
    ("truck/occt-cone.step", 129, 1, 3),
    ("truck/occt-cube.step", 361, 1, 6),
    ("truck/occt-cylinder.step", 129, 1, 3),
    ("truck/occt-sphere.step", 41, 1, 1),
    ("truck/occt-torus.step", 41, 1, 1),
];

#[test]
fn public_files_are_read_whole() {
    let Some(shared) = shared() else {
        eprintln!("skipped: the public files are not beside the project");
        return;
    };
    for (name, entities, items, faces) in FILES {
        let file = step::read(&std::fs::read(shared.join(name)).unwrap()).unwrap();
        let d = &file.document;
        assert_eq!(d.left_out, [], "{name}");
        let mut found = 0;
        for item in &d.items {
            if let ItemForm::Body { body, .. } = &item.form {
                found += body.faces.len();
                body.validate(d.uncertainty.unwrap_or(1e-6)).unwrap();
            }
        }
        assert_eq!(
            (file.entities, d.items.len(), found),
            (entities, items, faces),
            "{name}"
        );
    }
}

#[test]
fn an_assembly_has_names_places_and_colours() {
    let Some(shared) = shared() else {
        eprintln!("skipped: the public files are not beside the project");
        return;
    };
    let bytes = std::fs::read(shared.join("cax-if/as1-oc-214.stp")).unwrap();
    let d = step::read(&bytes).unwrap().document;
    let bolts = d
        .items
        .iter()
        .filter(|i| i.name == "l-bracket-assembly/nut-bolt-assembly/bolt");
    let places: Vec<_> = bolts
        .map(|i| match &i.form {
            ItemForm::Body { body, .. } => body.vertices[0].point,
            _ => panic!(),
        })
        .collect();
    assert_eq!(places.len(), 6);
    for (i, a) in places.iter().enumerate() {
        assert!(places[..i].iter().all(|b| a.distance(*b) > 1.0));
    }
    assert!(d.items.iter().all(|i| i.colour.is_some()));
}
