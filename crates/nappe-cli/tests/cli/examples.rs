//! The bundled models.

use crate::run::Folder;
use std::fs;

#[test]
fn all_are_listed_printed_and_written() {
    let folder = Folder::new();
    let list = folder.nappe("examples");
    let names: Vec<&str> = list
        .data()
        .lines()
        .skip(2)
        .map(|l| l.split_whitespace().next().unwrap())
        .collect();
    assert!(names.contains(&"duct"));
    folder.nappe("examples --write models");
    for name in &names {
        let printed = folder.nappe(&format!("examples {name}"));
        let written =
            fs::read_to_string(folder.path(&format!("models/{name}.nappe.toml"))).unwrap();
        assert_eq!(printed.data(), written);
    }
    assert_eq!(
        fs::read_dir(folder.path("models")).unwrap().count(),
        names.len()
    );
}

#[test]
fn files_that_are_there_are_not_replaced_without_force() {
    let folder = Folder::new();
    folder.write("duct.nappe.toml", "mine");
    let run = folder.nappe("examples --write .");
    assert!(
        run.problem().contains("already there: duct.nappe.toml"),
        "{}",
        run.stderr
    );
    assert!(run.stderr.contains("--force"));
    assert_eq!(folder.names(), ["duct.nappe.toml"]);
    assert_eq!(folder.read("duct.nappe.toml"), b"mine");
    assert_eq!(folder.nappe("examples --write . --force").code, 0);
    assert_ne!(folder.read("duct.nappe.toml"), b"mine");
}

#[test]
fn a_slip_is_answered_with_the_near_name() {
    let run = Folder::new().nappe("examples tepot");
    assert!(
        run.problem().contains("did you mean `teapot`?"),
        "{}",
        run.stderr
    );
}

#[test]
fn every_example_builds_and_passes_its_checks() {
    let folder = Folder::new();
    assert_eq!(folder.nappe("examples --write .").code, 0);
    for name in folder.names() {
        // Coarse, to be quick: that the model is right does not depend on the tolerance.
        let run = folder.nappe(&format!("build {name} -o out.stl"));
        assert_eq!(run.code, 0, "{name}: {}", run.stderr);
        let run = folder.nappe(&format!("check {name}"));
        assert_eq!(
            run.code,
            0,
            "{name}: {}{}",
            run.stderr,
            String::from_utf8_lossy(&run.stdout)
        );
    }
}
