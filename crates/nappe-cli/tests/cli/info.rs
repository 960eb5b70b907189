//! `nappe info` against closed forms.

use crate::run::Folder;
use insta::assert_snapshot;
use serde_json::Value;
use std::f64::consts::PI;

/// A cylinder wall of radius 2 and height 3 with a flat foot and lid: a closed can.
const MODEL: &str = r#"
title = "Can"
units = "m"
[params]
r = { value = 2, min = 1, max = 5, doc = "radius" }
h = "r + 1"
[surfaces.can]
kind = "revolution"
profile = { kind = "polyline", points = [[0, 0, "h"], ["r", 0, "h"], ["r", 0, 0], [0, 0, 0]] }
[surfaces.ball]
kind = "revolution"
profile = { kind = "arc", center = [0, 0, 0], radius = 1, normal = "y", from = "-90deg", to = "90deg" }
construction_only = true
[curves.edge]
kind = "circle"
center = [0, 0, 0]
radius = "r"
"#;

fn json(folder: &Folder, args: &str) -> Value {
    let run = folder.nappe(&format!("info model.nappe.toml --format json {args}"));
    serde_json::from_str(run.data()).unwrap()
}

/// The value lies as close to the truth as it says itself, and close at all.
fn assert_measured(m: &Value, truth: f64) {
    let (value, error) = (
        m["value"].as_f64().unwrap(),
        m["certainty"]["error"].as_f64().unwrap(),
    );
    assert!(
        (value - truth).abs() <= error + 1e-13 * truth.abs(),
        "{value} ± {error} is not {truth}"
    );
    assert!(error <= 1e-2 * truth.abs(), "± {error}");
}

#[test]
fn area_volume_and_box_of_a_can() {
    let folder = Folder::with_model(MODEL);
    for (args, r) in [("", 2.0), ("--set r=4", 4.0)] {
        let h = r + 1.0;
        let info = json(&folder, args);
        assert_measured(&info["area"], 2.0 * PI * r * r + 2.0 * PI * r * h);
        let volume = info["volume"]["value"].as_f64().unwrap();
        let error = info["volume"]["certainty"]["error"].as_f64().unwrap();
        assert!((volume.abs() - PI * r * r * h).abs() <= error + 1e-12 * volume.abs());
        assert_eq!(info["not_closed"], Value::Null);
        let far = info["box"]["certainty"]["error"].as_f64().unwrap();
        let max = info["box"]["max"].as_array().unwrap();
        for (x, truth) in max.iter().zip([r, r, h]) {
            assert!((x.as_f64().unwrap() - truth).abs() <= far + 1e-12);
        }
        assert_eq!(info["surfaces"].as_array().unwrap().len(), 1);
        assert_eq!(info["params"][1]["value"], h);
        assert_eq!(info["units"], "m");
    }
}

#[test]
fn curvature_of_a_sphere() {
    let folder = Folder::with_model(&MODEL.replace("construction_only = true", ""));
    let info = json(&folder, "--set r=3");
    let ball = &info["surfaces"][1];
    assert_eq!(ball["name"], "ball");
    for end in 0..2 {
        let gaussian = ball["gaussian_curvature"][end]["value"].as_f64().unwrap();
        let mean = ball["mean_curvature"][end]["value"].as_f64().unwrap();
        assert!((gaussian - 1.0).abs() < 1e-9, "{gaussian}");
        assert!((mean.abs() - 1.0).abs() < 1e-9, "{mean}");
    }
    assert_eq!(ball["closed_v"], true);
    assert_eq!(ball["collapsed_sides"].as_array().unwrap().len(), 2);
}

#[test]
fn the_report_for_people() {
    let folder = Folder::with_model(
        r#"
title = "Sheet"
[surfaces.sheet]
kind = "bilinear"
corners = [[[0, 0, 0], [0, 1, 0]], [[2, 0, 0], [2, 1, 0]]]
"#,
    );
    assert_snapshot!(folder.nappe("info model.nappe.toml").data());
}

#[test]
fn other_files_are_refused_with_a_reason() {
    let folder = Folder::new();
    folder.write("a.stl", "solid");
    folder.write("b.step", "ISO-10303-21;");
    for name in ["a.stl", "b.step"] {
        let run = folder.nappe(&format!("info {name}"));
        assert!(
            run.problem().contains("cannot be read yet"),
            "{}",
            run.stderr
        );
    }
}
