//! `nappe render`: every style, view and format.

use crate::run::Folder;

const MODEL: &str = r#"
title = "Saddle"
[surfaces.saddle]
kind = "bezier"
points = [[[0, 0, 0], [0, 1, 1], [0, 2, 0]], [[1, 0, 1], [1, 1, -2], [1, 2, 1]], [[2, 0, 0], [2, 1, 1], [2, 2, 0]]]
[curves.line]
kind = "line"
from = [0, 0, 0]
to = [2, 2, 2]
"#;

fn drawn(folder: &Folder, args: &str) -> Vec<u8> {
    let run = folder.nappe(&format!(
        "render model.nappe.toml -o out.png --size 200x150 {args}"
    ));
    assert_eq!(run.code, 0, "{args}: {}", run.stderr);
    assert!(run.stdout.is_empty());
    folder.read("out.png")
}

#[test]
fn every_option_changes_the_picture() {
    let folder = Folder::with_model(MODEL);
    let mut pictures = vec![drawn(&folder, "")];
    for args in [
        "--style curvature-gaussian",
        "--style curvature-mean",
        "--style zebra",
        "--style wire",
        "--view front",
        "--view top",
        "--view 10,20",
        "--azimuth -30",
        "--elevation 80",
        "--projection parallel",
        "--isolines 0",
        "--nets",
        "--curves",
        "--no-edges",
        "--background dark",
        "--background transparent",
        "--bare",
    ] {
        let picture = drawn(&folder, args);
        assert!(picture.starts_with(b"\x89PNG"), "{args}");
        let size = [16, 20].map(|i| u32::from_be_bytes(picture[i..i + 4].try_into().unwrap()));
        assert_eq!(size, [200, 150], "{args}");
        assert!(!pictures.contains(&picture), "{args} changes nothing");
        pictures.push(picture);
    }
}

#[test]
fn the_same_command_draws_the_same_picture() {
    let folder = Folder::with_model(MODEL);
    assert_eq!(
        drawn(&folder, "--style zebra"),
        drawn(&folder, "--style zebra")
    );
}

#[test]
fn svg_is_well_formed_and_names_the_model() {
    let folder = Folder::with_model(MODEL);
    let run = folder.nappe("render model.nappe.toml -o out.svg --tolerance 0.05");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let text = String::from_utf8(folder.read("out.svg")).unwrap();
    assert!(text.contains("<svg") && text.trim_end().ends_with("</svg>"));
    assert!(text.contains("Saddle"));
}

#[test]
fn other_endings_are_refused_before_anything_is_built() {
    let folder = Folder::with_model("[surfaces.a]\nkind = 'nothing'\n");
    for file in ["out.stl", "out.jpg", "none/out.png"] {
        let run = folder.nappe(&format!("render model.nappe.toml -o {file}"));
        assert!(run.problem().contains(file), "{}", run.stderr);
        assert!(!run.stderr.contains("unknown kind"), "{}", run.stderr);
    }
    assert_eq!(folder.names(), ["model.nappe.toml"]);
}

#[test]
fn a_model_of_curves_alone_is_drawn_by_them() {
    let folder =
        Folder::with_model("[curves.a]\nkind = 'line'\nfrom = [0, 0, 0]\nto = [1, 2, 3]\n");
    assert!(drawn(&folder, "").len() > 500);
}
