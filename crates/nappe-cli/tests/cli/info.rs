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
        assert_eq!(info["not_closed"], serde_json::json!([]));
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
fn centroid_and_inertia_of_a_can_and_how_it_bends() {
    let folder = Folder::with_model(MODEL);
    let info = json(&folder, "--bending");
    // Radius 2, height 3.
    let shell = &info["shells"][0];
    let near = |point: &Value, want: [f64; 3]| {
        let error = point["certainty"]["error"].as_f64().unwrap();
        assert_eq!(point["certainty"]["is"], "bounded");
        for (k, want) in want.into_iter().enumerate() {
            let x = point["point"][k].as_f64().unwrap();
            assert!((x - want).abs() <= error && error < 1e-3, "{point}");
        }
    };
    near(&info["centroid"], [0.0, 0.0, 1.5]);
    near(&shell["centroid"], [0.0, 0.0, 1.5]);
    let mass = 12.0 * PI;
    let across = mass * (3.0 * 4.0 + 9.0) / 12.0;
    let tensor = &shell["inertia"]["tensor"];
    assert_measured(&tensor[0][0], across);
    assert_measured(&tensor[2][2], mass * 2.0);
    let principal = &shell["inertia"]["principal"];
    assert_measured(&principal[0], across.min(mass * 2.0));
    // From outside any ball touches everywhere; inside none gets into the edges.
    let balls = &info["surfaces"][0]["rolling_balls"];
    let radius = |side: &str| balls[side]["radius"].as_f64().unwrap_or(f64::INFINITY);
    let mut both = [radius("normal_side"), radius("behind")];
    both.sort_by(f64::total_cmp);
    assert_eq!(both, [0.0, f64::INFINITY], "{balls}");
    // Two discs and a cylinder in one surface: its pieces can be laid flat, the can cannot.
    let can = &info["surfaces"][0];
    assert_eq!(can["developable"], "in pieces", "{can}");
    let total = can["total_curvature"]["value"].as_f64().unwrap();
    assert!(total.abs() < 1e-6, "{total}");
    // Only if asked for.
    assert!(json(&folder, "")["surfaces"][0]["total_curvature"].is_null());
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
    folder.write("a.vtu", "<VTKFile>");
    folder.write("b.step", "ISO-10303-21;");
    for (name, said) in [
        ("a.vtu", ".vtu files cannot be read"),
        ("b.step", "b.step: "),
    ] {
        let run = folder.nappe(&format!("info {name}"));
        assert!(run.problem().contains(said), "{}", run.stderr);
    }
}

/// Spheres by their radius and the x of their centre.
fn spheres(all: &[(f64, f64)]) -> Folder {
    let sphere = |(k, (radius, x)): (usize, &(f64, f64))| {
        format!(
            "[surfaces.ball_{k}]\nkind = \"quadric\"\nshape = \"sphere\"\nsemi_axes = [{radius:?}]\ncenter = [{x:?}, 0, 0]\n"
        )
    };
    let all: String = all.iter().enumerate().map(sphere).collect();
    Folder::with_model(&all)
}

#[test]
fn the_volumes_of_shells_are_added_only_beside_each_other() {
    let ball = |r: f64| 4.0 / 3.0 * PI * r * r * r;
    // Across each other, one inside the other, and side by side.
    for (other, added) in [((1.0, 0.5), false), ((0.5, 0.0), false), ((0.5, 3.0), true)] {
        let folder = spheres(&[(1.0, 0.0), other]);
        let info = json(&folder, "");
        let shells = info["shells"].as_array().unwrap();
        assert_eq!(shells.len(), 2);
        for (shell, r) in shells.iter().zip([1.0, other.0]) {
            assert_measured(&shell["volume"], ball(r));
        }
        let text = folder.nappe("info model.nappe.toml");
        if added {
            assert_measured(&info["volume"], ball(1.0) + ball(0.5));
            assert!(text.data().contains("in 2 shells beside each other"));
        } else {
            assert_eq!(info["volume"], Value::Null);
            assert!(
                text.data().contains("of 2 shells, not added"),
                "{}",
                text.data()
            );
            assert!(!text.data().contains("enclosed"), "{}", text.data());
        }
    }
}

#[test]
fn a_cube_of_six_faces_turned_anyhow_has_its_volume() {
    let corner = |k: usize| [k & 1, k >> 1 & 1, k >> 2];
    // Each face with u and v along the other two axes: opposite faces have the same normal.
    let mut model = String::new();
    for axis in 0..3 {
        let [a, b] = [(axis + 1) % 3, (axis + 2) % 3].map(|d| 1 << d);
        for at in [0, 1 << axis] {
            let p = [at, at + b, at + a, at + a + b].map(corner);
            model += &format!(
                "[surfaces.face_{axis}_{at}]\nkind = \"bilinear\"\ncorners = [[{:?}, {:?}], [{:?}, {:?}]]\n",
                p[0], p[1], p[2], p[3]
            );
        }
    }
    let info = json(&Folder::with_model(&model), "");
    assert_measured(&info["volume"], 1.0);
    let shells = info["shells"].as_array().unwrap();
    assert_eq!(shells.len(), 1);
    for normals in ["normals_outwards", "normals_inwards"] {
        assert_eq!(shells[0][normals].as_array().unwrap().len(), 3);
    }
}

#[test]
fn a_torn_surface_has_neither_area_nor_volume() {
    let folder = Folder::with_torn_surface();
    let info = json(&folder, "");
    assert_eq!(
        (&info["area"], &info["volume"]),
        (&Value::Null, &Value::Null)
    );
    let torn = serde_json::json!({ "dir": "u", "at": 0.5 });
    assert_eq!(info["surfaces"][0]["torn"], torn);
    let run = folder.nappe("info model.nappe.toml");
    assert!(
        run.data().contains("`step` is torn at u = 0.5"),
        "{}",
        run.data()
    );
}

#[test]
fn info_and_check_agree_on_what_is_closed() {
    // A slit of 0.0001° is closed by the mesh; one of 1° is not.
    for (to, closed) in [("359.9999deg", true), ("359deg", false)] {
        let folder = Folder::with_model(&format!(
            "[surfaces.ball]\nkind = \"quadric\"\nshape = \"sphere\"\nsemi_axes = [1]\nrange = {{ u = [\"0deg\", \"{to}\"] }}\n"
        ));
        let info = json(&folder, "");
        assert_eq!(info["surfaces"][0]["closed_u"], closed);
        assert_eq!(info["volume"].is_null(), !closed);
        let run = folder.nappe("check model.nappe.toml --format json");
        let check: Value = serde_json::from_slice(&run.stdout).unwrap();
        assert_eq!(check["open_sides"].as_array().unwrap().is_empty(), closed);
        if closed {
            // The slit is no part of the surface: the bound covers what closes it.
            assert_measured(&info["volume"], 4.0 / 3.0 * PI);
        }
    }
}

#[test]
fn derivatives_by_a_parameter() {
    // With uniform parameters the corners of the profile stay where they are along it, else they move.
    let uniform = MODEL.replace(
        "[0, 0, 0]] }",
        "[0, 0, 0]], parametrization = \"uniform\" }",
    );
    assert_ne!(uniform, MODEL);
    derivatives_of_a_can(&Folder::with_model(&uniform));
    derivatives_of_a_can(&Folder::with_model(MODEL));
}

fn derivatives_of_a_can(folder: &Folder) {
    let info = json(folder, "--sensitivity r --sensitivity h");
    let [by_r, by_h] = [0, 1].map(|k| &info["sensitivities"][k]);
    let r = 2.0;
    assert_eq!(by_r["parameter"], "r");
    assert_eq!(by_r["value"], r);
    // h = r + 1 follows r; by itself it is taken as a number.
    assert_measured(&by_r["area"], 8.0 * PI * r + 2.0 * PI);
    assert_measured(&by_h["area"], 2.0 * PI * r);
    assert_measured(&by_r["shells"][0]["volume"], PI * (3.0 * r * r + 2.0 * r));
    assert_measured(&by_h["shells"][0]["volume"], PI * r * r);
    assert_measured(&by_h["shells"][0]["centroid"][2], 0.5);
    for (end, truth) in [("min", [-1.0, -1.0, 0.0]), ("max", [1.0, 1.0, 1.0])] {
        for (axis, truth) in truth.into_iter().enumerate() {
            let face = &by_r["box"][end][axis];
            let [lo, hi] = [0, 1].map(|k| face["range"][k].as_f64().unwrap());
            assert!(
                lo <= truth && truth <= hi && hi - lo < 1e-3,
                "{end} {axis}: {face}"
            );
            assert_eq!(face["one_sided"], false);
        }
    }
    let report = folder.nappe("info model.nappe.toml --sensitivity h");
    let report = report.data();
    assert!(report.contains("derivatives by"), "{report}");
}

#[test]
fn what_has_no_derivative_is_told_by_name() {
    let text = MODEL.replace(
        "polyline\", points = [[0, 0, \"h\"], [\"r\", 0, \"h\"], [\"r\", 0, 0], [0, 0, 0]]",
        "arc\", through = [[1, 0, 0], [\"r\", 0, 1], [1, 0, 2]]",
    );
    assert_ne!(text, MODEL);
    let folder = Folder::with_model(&text);
    let info = json(&folder, "--sensitivity r");
    let by_r = &info["sensitivities"][0];
    let surface = &by_r["surfaces"][0];
    assert_eq!(surface["motion"], "unknown");
    let why = surface["why"].as_str().unwrap();
    assert!(why.contains("the kind \"arc\""), "{why}");
    for key in ["area", "box", "centroid"] {
        assert_eq!(by_r[key], Value::Null);
    }
    assert_eq!(by_r["shells"][0], Value::Null);
    let run = folder.nappe("info model.nappe.toml --sensitivity radius");
    let problem = run.problem();
    assert!(
        problem.contains("there is no parameter `radius`"),
        "{problem}"
    );
}

#[test]
fn a_joint_that_opens_is_told_by_name() {
    let folder = Folder::with_model(
        r#"
[params]
gap = 0
[surfaces.ball]
kind = "revolution"
profile = { kind = "arc", center = [0, 0, 0], radius = 1, normal = "y", from = "-90deg", to = "90deg" }
start = "gap deg"
angle = "180deg"
[surfaces.rest]
kind = "revolution"
profile = { kind = "arc", center = [0, 0, 0], radius = 1, normal = "y", from = "-90deg", to = "90deg" }
start = "180deg"
angle = "180deg"
"#,
    );
    let info = json(&folder, "--sensitivity gap");
    assert_measured(&info["volume"], 4.0 / 3.0 * PI);
    let by = &info["sensitivities"][0];
    let shell = &by["shells"][0];
    assert_eq!(shell["volume"], Value::Null);
    let why = shell["why"].as_str().unwrap();
    assert!(
        why.contains("ball.") && why.contains("rest.") && why.contains("0.0175"),
        "{why}"
    );
    // The area needs no closed shell.
    let area = by["area"]["value"].as_f64().unwrap();
    assert!(area.abs() < 1e-6, "{area}");
    let report = folder.nappe("info model.nappe.toml --sensitivity gap");
    assert!(
        report.data().contains("part at a speed of 0.0175"),
        "{}",
        report.data()
    );
}
