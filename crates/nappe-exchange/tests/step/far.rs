//! Surfaces of which one control point is far away, as a fault in a file makes them.

use nappe_exchange::{Progress, Read, mesh_document, read};

/// Its rounding alone is more than the tolerance: that is told at once, and no edge is made ever finer.
#[test]
fn a_surface_that_goes_far_away_is_told() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/far-point.step");
    let Read::Document(document) = read(path.as_ref()).unwrap() else {
        panic!("a document");
    };
    let made = mesh_document(&document, None, Progress::default());
    assert_eq!(made.scene.parts.len(), 0);
    let why = made.missing.iter().find(|m| m.place.contains("wall"));
    let why = &why.unwrap().why;
    assert!(why.contains("away from the surface"), "{why}");
}
