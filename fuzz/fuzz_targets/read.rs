//! Any bytes are either a file of the format that the first of them chooses, or an error with its place; never a panic, a hang
//! or memory out of proportion. What was read can be measured and made a scene.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nappe_exchange::read::{Read, read_bytes};
use nappe_exchange::{ItemForm, mesh_facts};

const ENDINGS: [&str; 12] = [
    "igs", "stl", "obj", "ply", "glb", "gltf", "3mf", "xml", "bpt", "brep", "dat", "cpt",
];

fuzz_target!(|bytes: &[u8]| {
    let Some((choice, bytes)) = bytes.split_first() else {
        return;
    };
    match read_bytes(ENDINGS[usize::from(*choice) % ENDINGS.len()], bytes) {
        Ok(Read::Mesh(mesh)) => {
            std::hint::black_box(mesh_facts(&mesh));
            mesh.to_scene().validate().expect("a mesh that was read makes a valid scene");
        }
        Ok(Read::Document(document)) => {
            for item in &document.items {
                if let ItemForm::Body { body, .. } = &item.form {
                    let _ = std::hint::black_box(body.validate(1.0));
                }
            }
        }
        Err(fault) => {
            std::hint::black_box(fault.to_string());
        }
    }
});
