//! Whoever reads or writes is told how far that is.

use crate::{sewn, wave};
use nappe::{DVec3, Units};
use nappe_exchange::{Document, Progress, Read, Scene, WriteOptions, read_telling, write};
use std::sync::Mutex;

/// Bodies of one face each, or one body of all.
fn document(one: bool) -> Document {
    let faces: Vec<_> = (0..60)
        .map(|i| wave(20, 20, DVec3::X * (20.0 * f64::from(i)), 1.0))
        .collect();
    let mut document = sewn(&faces[..1], Units::Millimetre);
    document.items = if one {
        sewn(&faces, Units::Millimetre).items
    } else {
        let bodies = faces.chunks(1).map(|f| sewn(f, Units::Millimetre));
        bodies.flat_map(|d| d.items).collect()
    };
    document
}

#[test]
fn shares_grow_to_the_whole() {
    let dir = tempfile::tempdir().unwrap();
    for ending in ["step", "igs"] {
        for one in [false, true] {
            let path = dir.path().join("a").with_extension(ending);
            let told = Mutex::new(Vec::new());
            let tell = |share: f64| told.lock().unwrap().push(share);
            let listen = |what: &str| {
                let told = std::mem::take(&mut *told.lock().unwrap());
                let most = told.iter().copied().fold(0.0, f64::max);
                let what = format!("{what} {ending}: {told:?}");
                assert!(told.len() >= 4, "{what}");
                assert!(told.iter().all(|s| (0.0..=1.0).contains(s)), "{what}");
                // Half of it is done at some time between the first and the last quarter.
                assert!(told.iter().any(|s| (0.25..=0.75).contains(s)), "{what}");
                assert!(most > 0.9, "{what}");
            };
            let scene = Scene {
                document: document(one),
                ..Scene::default()
            };
            let options = WriteOptions {
                progress: Progress::to(&tell),
                ..WriteOptions::default()
            };
            write(&path, &scene, &options).unwrap();
            listen("writing");
            let read = read_telling(&path, Progress::to(&tell)).unwrap();
            listen("reading");
            let Read::Document(read) = read else { panic!() };
            assert_eq!(read.left_out, []);
        }
    }
}
