//! Files of other systems that a model imports.

use nappe_exchange::{Document, ItemForm, Read, face_name, is_whole};
use nappe_model::{Imported, ImportedCurve, ImportedFace, Importer};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Reads each file once; their paths are relative to a folder.
#[derive(Debug)]
pub(crate) struct Files {
    folder: PathBuf,
    read: Mutex<HashMap<String, Result<Arc<Imported>, String>>>,
}

/// Where a file does not say how far its parts agree, edges are taken for sides of a surface within this length, metres.
const AGREEMENT: f64 = 1e-8;

impl Files {
    /// The files beside a model.
    pub(crate) fn beside(model: &Path) -> Files {
        Files {
            folder: model.parent().map(Path::to_owned).unwrap_or_default(),
            read: Mutex::default(),
        }
    }
}

impl Importer for Files {
    fn import(&self, file: &str) -> Result<Arc<Imported>, String> {
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        let entry = read.entry(file.to_owned());
        entry
            .or_insert_with(|| match nappe_exchange::read(&self.folder.join(file)) {
                Err(e) => Err(e.to_string()),
                Ok(Read::Mesh(_)) => Err(format!("{file}: holds triangles and no exact surfaces")),
                Ok(Read::Document(d)) => Ok(Arc::new(imported(&d))),
            })
            .clone()
    }
}

fn imported(document: &Document) -> Imported {
    let agreement = AGREEMENT / document.units.metres();
    let agreement = document.uncertainty.unwrap_or(agreement);
    let mut out = Imported {
        units: document.units,
        ..Imported::default()
    };
    for (number, item) in document.items.iter().enumerate() {
        match &item.form {
            ItemForm::Body { body, .. } if body.validate(f64::INFINITY).is_ok() => {
                for (face, f) in body.faces.iter().enumerate() {
                    // A shell may take a face the other way round.
                    let shells = body.shells.iter().flat_map(|s| &s.faces);
                    let kept = shells.clone().find(|s| s.0 == face).is_none_or(|s| s.1);
                    out.faces.push(ImportedFace {
                        name: face_name(number, item, face),
                        surface: f.surface.clone(),
                        forward: f.forward == kept,
                        whole: is_whole(body, face, agreement),
                    });
                }
            }
            ItemForm::Curve(curve) => out.curves.push(ImportedCurve {
                name: item.name.clone(),
                curve: curve.clone(),
            }),
            ItemForm::Body { .. } | ItemForm::Points(_) => {}
        }
    }
    out
}
