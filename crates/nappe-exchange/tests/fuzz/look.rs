//! What is done with the bytes of a file, here and where coverage guides the search.

use nappe_exchange::read::{Read, read_bytes};
use nappe_exchange::{Document, ItemForm, mesh_facts, step};

/// The endings of all formats but STEP, which has its own way in.
pub(crate) const ENDINGS: [&str; 12] = [
    "igs", "stl", "obj", "ply", "glb", "gltf", "3mf", "xml", "bpt", "brep", "dat", "cpt",
];

/// Reads bytes and looks at what was read. Panics if a mesh that was read is none.
pub(crate) fn look(ending: &str, bytes: &[u8]) {
    match read_bytes(ending, bytes) {
        Ok(Read::Mesh(mesh)) => {
            std::hint::black_box(mesh_facts(&mesh));
            let valid = mesh.to_scene().validate();
            assert!(valid.is_ok(), "a mesh that was read is no scene: {valid:?}");
        }
        Ok(Read::Document(document)) => look_at(&document),
        Err(fault) => {
            std::hint::black_box(fault.to_string());
        }
    }
}

/// The same for STEP.
pub(crate) fn look_step(bytes: &[u8]) {
    match step::read(bytes) {
        Ok(file) => look_at(&file.document),
        Err(e) => {
            std::hint::black_box(e.to_string());
        }
    }
}

fn look_at(document: &Document) {
    for item in &document.items {
        match &item.form {
            ItemForm::Body { body, .. } => {
                let _ = std::hint::black_box(body.validate(1.0));
            }
            ItemForm::Curve(c) => {
                std::hint::black_box(c.point(c.domain().mid()));
            }
            ItemForm::Points(p) => {
                assert!(p.iter().all(|p| p.is_finite()), "a point that is no number");
            }
        }
    }
}
