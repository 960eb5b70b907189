//! How fast large files are, against what the machine can do.

use crate::wave;
use nappe::body::{Body, sew};
use nappe::surface::SurfaceRef;
use nappe::{DVec3, Units};
use nappe_exchange::step::{self, Schema, StepOptions};
use nappe_exchange::{Document, Item, ItemForm};
use std::time::Instant;

/// The least of some times, seconds.
fn least<T>(mut f: impl FnMut() -> T) -> f64 {
    let time = |_| {
        let start = Instant::now();
        std::hint::black_box(f());
        start.elapsed().as_secs_f64()
    };
    (0..3).map(time).fold(f64::INFINITY, f64::min)
}

#[test]
#[ignore = "measures times, which other work on the machine changes"]
fn a_thousand_bicubic_faces() {
    // About 800 points each, as 53 MB of text have.
    let face = |i: usize| wave(28, 28, DVec3::X * (20.0 * i as f64), 1.0 + i as f64 * 1e-3);
    let item = |i: usize| {
        let surfaces: [SurfaceRef; 1] = [face(i)];
        let body: Body = sew(&surfaces, 1e-9).body;
        Item {
            name: String::new(),
            colour: None,
            form: ItemForm::Body {
                body,
                faces: Vec::new(),
            },
        }
    };
    let document = Document {
        units: Units::Millimetre,
        items: (0..1000).map(item).collect(),
        ..Document::default()
    };
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("large.step");
    let options = StepOptions {
        schema: Schema::Ap242,
        tolerance: 1e-6,
    };
    let write = least(|| step::write(&path, &document, &options).unwrap());
    let bytes = std::fs::read(&path).unwrap();
    let read = least(|| step::read(&bytes).unwrap());
    let copy = least(|| bytes.clone());
    let scan = least(|| bytes.iter().filter(|b| **b == b';').count());
    let plain = least(|| std::fs::write(dir.path().join("plain"), &bytes));
    eprintln!(
        "{:.1} MB: written in {write:.3} s, read in {read:.3} s; copied {copy:.4} s, scanned {scan:.4} s, file {plain:.3} s",
        bytes.len() as f64 / 1e6
    );
    let file = step::read(&bytes).unwrap();
    assert_eq!(file.document.items.len(), 1000);
    assert_eq!(file.document.left_out, []);
    assert!(read < 100.0 * (copy + scan) && write < 100.0 * (copy + scan + plain));
}
