//! STEP files in and out.

#![allow(clippy::unwrap_used)]

mod asked;
mod corners;
mod far;
mod faults;
mod files;
mod meant;
mod mutated;
mod peers;
mod round;
#[path = "../shared/mod.rs"]
mod shared;
mod swept;
mod together;
mod told;

use nappe::body::sew;
use nappe::surface::SurfaceRef;
use nappe::{DVec3, Units};
use nappe_exchange::step::{self, Schema, StepOptions};
use nappe_exchange::{Document, Item, ItemForm};
use shared::shared;

/// A document with surfaces sewn to one body.
fn sewn(surfaces: &[SurfaceRef], units: Units) -> Document {
    let item = Item {
        name: "it's a \u{3c0}".into(),
        colour: Some([0.25, 0.5, 0.75]),
        form: ItemForm::Body {
            body: sew(surfaces, 1e-9).body,
            faces: Vec::new(),
        },
    };
    Document {
        name: Some("name".into()),
        units,
        items: vec![item],
        ..Document::default()
    }
}

/// The bytes of a document's file.
fn written(document: &Document, schema: Schema) -> Vec<u8> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.step");
    let options = StepOptions {
        schema,
        tolerance: 1e-9,
    };
    step::write(&path, document, &options).unwrap();
    std::fs::read(path).unwrap()
}

/// A wavy net of bicubic pieces.
fn wave(rows: usize, columns: usize, at: DVec3, size: f64) -> SurfaceRef {
    use nappe::NurbsSurface;
    use nappe::basis::BSplineBasis;
    let point = |i: usize, j: usize| {
        let (x, y) = (i as f64 / 3.0, j as f64 / 7.0);
        at + size * DVec3::new(x, y, (x * 1.7 + y).sin() / 9.0)
    };
    let points: Vec<DVec3> = (0..rows * columns)
        .map(|k| point(k / columns, k % columns))
        .collect();
    let knots = [rows, columns].map(|n| BSplineBasis::clamped_uniform(3, n));
    std::sync::Arc::new(NurbsSurface::new([3, 3], knots, &points, None).unwrap())
}
