//! What the snippets may import.

use nappe::DVec3;
use nappe::curve::Line;
use nappe::surface::bilinear;
use nappe_model::{Imported, ImportedCurve, ImportedFace, Importer};
use std::sync::Arc;

/// Takes every file for one with a hull and a keel.
#[derive(Debug)]
pub(crate) struct Files;

impl Importer for Files {
    fn import(&self, _: &str) -> Result<Arc<Imported>, String> {
        let corner = |i: u8, j: u8| DVec3::new(f64::from(i), f64::from(j), 0.0);
        let hull = bilinear([0, 1].map(|i| [0, 1].map(|j| corner(i, j)))).expect("a surface");
        let keel = Line::new(DVec3::ZERO, DVec3::X).expect("a line");
        Ok(Arc::new(Imported {
            faces: vec![ImportedFace {
                name: "hull".into(),
                surface: Arc::new(hull),
                forward: true,
                whole: true,
            }],
            curves: vec![ImportedCurve {
                name: "keel".into(),
                curve: Arc::new(keel),
            }],
            ..Imported::default()
        }))
    }
}
