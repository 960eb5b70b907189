//! The files that are written of all examples, read again: no face is left out, none without an area.

use crate::peers_files::{AGREE, ENDINGS, Example, examples, number};
use crate::run::Folder;
use serde_json::Value;

/// Of a file.
fn look(folder: &Folder, file: &str) -> Value {
    let info = folder.nappe(&format!("info {file} --format json"));
    let info: Value = serde_json::from_str(info.data()).unwrap();
    assert!(info["problems"].as_array().unwrap().is_empty(), "{file}");
    assert!(info["left_out"].as_array().unwrap().is_empty(), "{file}");
    info
}

#[test]
fn files_of_all_examples_come_back_whole() {
    let folder = Folder::new();
    for path in examples() {
        let example = Example::build(&folder, &path);
        let (name, told) = (&example.name, &example.info);
        let surfaces = told["surfaces"].as_array().unwrap();
        for ending in ENDINGS {
            let file = format!("{name}.{ending}");
            let read = look(&folder, &file);
            assert_eq!(read["faces"], surfaces.len(), "{file}");
            let (area, own) = (&read["area"]["value"], &told["area"]["value"]);
            assert!(
                (number(area) - number(own)).abs() <= AGREE * number(own),
                "{file}: {area} for {own}"
            );
            let shells = told["shells"].as_array().unwrap();
            assert_eq!(read["solids"], shells.len(), "{file}");
            let volume: f64 = shells.iter().map(|s| number(&s["volume"]["value"])).sum();
            if volume > 0.0 {
                let found = number(&read["volume"]["value"]);
                assert!(
                    (found - volume).abs() <= AGREE * volume,
                    "{file}: {found} for {volume}"
                );
            }
            folder.nappe(&format!("convert {file} {name}.stl")).data();
        }
        // As a user builds it.
        let model = path.to_str().unwrap();
        folder
            .nappe(&format!("build {model} -o {name}.step -o {name}.igs"))
            .data();
        for ending in ENDINGS {
            let file = format!("{name}.{ending}");
            assert_eq!(look(&folder, &file)["faces"], surfaces.len(), "{file}");
            folder.nappe(&format!("convert {file} {name}.stl")).data();
        }
    }
}
