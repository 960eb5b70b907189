//! Files of other systems: converted to meshes, told, imported.

use crate::run::Folder;
use insta::assert_snapshot;

/// A quarter of a cylinder with radius 2 and height 3, and a curve, in centimetres.
const MODEL: &str = r#"
title = "Quarter"
units = "cm"
[curves.rim]
kind = "arc"
center = [0, 0, 3]
radius = 2
from = "0deg"
to = "90deg"
[curves.foot]
kind = "arc"
center = [0, 0, 0]
radius = 2
from = "0deg"
to = "90deg"
construction_only = true
[surfaces.wall]
kind = "ruled"
south = "foot"
north = "rim"
"#;

/// Six sides of a cube with edge 2, normals outward.
fn cube() -> String {
    let mut text = String::from("title = \"Cube\"\n");
    for (name, from, a, b) in [
        ("bottom", [0, 0, 0], [0, 2, 0], [2, 0, 0]),
        ("top", [0, 0, 2], [2, 0, 0], [0, 2, 0]),
        ("front", [0, 0, 0], [2, 0, 0], [0, 0, 2]),
        ("back", [0, 2, 0], [0, 0, 2], [2, 0, 0]),
        ("left", [0, 0, 0], [0, 0, 2], [0, 2, 0]),
        ("right", [2, 0, 0], [0, 2, 0], [0, 0, 2]),
    ] {
        let corner = |i: i32, j: i32| [0, 1, 2].map(|k| from[k] + i * a[k] + j * b[k]);
        let corners = [0, 1].map(|i| [0, 1].map(|j| corner(i, j)));
        text.push_str(&format!(
            "[surfaces.{name}]\nkind = \"bilinear\"\ncorners = {corners:?}\n"
        ));
    }
    text
}

fn masked(text: &str) -> String {
    let line = |l: &str| match l {
        l if l.starts_with("time") => "time  (masked)\n".to_owned(),
        l => format!("{l}\n"),
    };
    text.lines().map(line).collect()
}

#[test]
fn bodies_become_meshes_and_pictures() {
    let folder = Folder::with_model(MODEL);
    folder
        .nappe("build model.nappe.toml -o q.step -o q.igs")
        .data();
    let run = folder.nappe("convert q.step q.glb --tolerance 0.01");
    run.data();
    assert_snapshot!(masked(&run.stderr));
    for file in [
        "q.stl", "q.obj", "q.ply", "q.3mf", "q.vtu", "q.gltf", "q.png", "q.svg",
    ] {
        let run = folder.nappe(&format!("convert q.igs {file}"));
        assert_eq!(run.code, 0, "{file}: {}", run.stderr);
        assert!(!folder.read(file).is_empty(), "{file}");
    }
    let obj = String::from_utf8(folder.read("q.obj")).unwrap();
    assert!(obj.contains("wall") && obj.contains("rim"), "{obj}");
    // Chords of a circle within 0.01: the area is a little less than 2 × 3 × π / 2.
    let told = folder.nappe("info q.glb --format json");
    let told: serde_json::Value = serde_json::from_str(told.data()).unwrap();
    let exact = 3.0 * std::f64::consts::PI;
    let area = told["area"].as_f64().unwrap();
    assert_eq!(told["units"].as_str(), Some("cm"));
    assert!(
        (0.98..=1.0 + 1e-6).contains(&(area / exact)),
        "{area}, not {exact}"
    );
}

#[test]
fn the_faces_of_a_solid_close() {
    let folder = Folder::with_model(&cube());
    folder.nappe("build model.nappe.toml -o cube.step").data();
    folder.nappe("convert cube.step cube.stl").data();
    let told = folder.nappe("info cube.stl --format json");
    let told: serde_json::Value = serde_json::from_str(told.data()).unwrap();
    assert_eq!(told["volume"].as_f64(), Some(8.0));
    assert_eq!(told["open_edges"].as_u64(), Some(0));
    assert_snapshot!("info-cube", folder.nappe("info cube.step").data());
    assert_snapshot!("info-cube-mesh", folder.nappe("info cube.stl").data());
    let told = folder.nappe("info cube.step --format json");
    let told: serde_json::Value = serde_json::from_str(told.data()).unwrap();
    assert_eq!(told["faces_by_kind"]["plane"].as_u64(), Some(6));
    assert_eq!(
        (told["solids"].as_u64(), told["edges"].as_u64()),
        (Some(1), Some(12))
    );
    for (key, exact) in [("area", 24.0), ("volume", 8.0)] {
        let value = told[key]["value"].as_f64().unwrap();
        assert!((value - exact).abs() <= 1e-9, "{key}: {value}");
    }
}

/// A face whose edges are not on its surface is named; the file holds the others.
#[test]
fn a_face_without_triangles_is_told() {
    let folder = Folder::with_model(&cube());
    folder.nappe("build model.nappe.toml -o cube.step").data();
    let text = String::from_utf8(folder.read("cube.step")).unwrap();
    // The first plane is moved away from its edges.
    let at = text.find("=PLANE(").or(text.find("= PLANE(")).unwrap();
    let refers = |from: usize| {
        let hash = from + text[from..].find('#').unwrap();
        let end = hash + text[hash..].find([',', ')']).unwrap();
        text[hash..end].to_owned()
    };
    let defined = |id: &str| {
        text.find(&format!("\n{id}="))
            .or(text.find(&format!("\n{id} =")))
            .unwrap()
            + 1
    };
    let placed = |id: &str| {
        let at = defined(id);
        at + text[at..].find('(').unwrap()
    };
    let placement = refers(at);
    let origin = refers(placed(&placement));
    let from = defined(&origin);
    let end = from + text[from..].find(';').unwrap();
    let moved = format!(
        "{}{origin}=CARTESIAN_POINT('',(70.,80.,90.)){}",
        &text[..from],
        &text[end..]
    );
    folder.write("bad.step", &moved);
    let run = folder.nappe("convert bad.step bad.obj");
    let said = run.problem();
    assert!(said.contains(" of item 1 `Cube` is left out"), "{said}");
    assert!(said.contains("bad.obj holds the rest"), "{said}");
    assert!(said.contains("5 of 6"), "{said}");
    let told = folder.nappe("info bad.step");
    assert!(told.data().contains("not told"), "{}", told.data());
    assert!(told.data().contains("cannot be meshed"), "{}", told.data());
}

/// Geometry that a reader leaves out: the rest is written, and the exit code is 1. What is no geometry is only told.
#[test]
fn geometry_that_is_not_read_is_missing() {
    let folder = Folder::with_model(&cube());
    folder
        .nappe("build model.nappe.toml -o cube.step -o cube.igs")
        .data();
    let text = String::from_utf8(folder.read("cube.step")).unwrap();
    let at = text.find("ADVANCED_FACE").unwrap();
    let strange = format!("{}STRANGE_FACE{}", &text[..at], &text[at + 13..]);
    folder.write("strange.step", &strange);
    for out in ["a.obj", "a.igs", "a.png"] {
        let run = folder.nappe(&format!("convert strange.step {out}"));
        assert_eq!(run.code, 1, "{out}: {}", run.stderr);
        let said = run.problem();
        assert!(said.contains("STRANGE_FACE"), "{said}");
        assert!(said.contains(&format!("{out} holds the rest")), "{said}");
        assert!(!folder.read(out).is_empty(), "{out}");
    }
    let told = folder.nappe("info strange.step");
    assert!(
        told.data().contains("missing geometry: STRANGE_FACE"),
        "{}",
        told.data()
    );
    let told = folder.nappe("info strange.step --format json");
    let told: serde_json::Value = serde_json::from_str(told.data()).unwrap();
    assert_eq!(told["left_out"][0]["is_geometry"], true, "{told}");
    // Something that is said of geometry.
    let end = text.rfind("ENDSEC;").unwrap();
    let hidden = format!(
        "{}#999999=INVISIBILITY(());\n{}",
        &text[..end],
        &text[end..]
    );
    folder.write("hidden.step", &hidden);
    let run = folder.nappe("convert hidden.step b.obj");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(
        run.stderr.contains("left out: INVISIBILITY"),
        "{}",
        run.stderr
    );
    // Meshes may hold what has no triangles.
    folder.write(
        "free.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ncstype bezier\ndeg 1\ncurv 0 1 1 2\nend\n",
    );
    let run = folder.nappe("convert free.obj free.stl");
    assert_eq!(run.code, 1, "{}", run.stderr);
    let said = run.problem();
    assert!(said.contains("free-form"), "{said}");
    assert!(said.contains("free.stl holds the rest"), "{said}");
    assert!(!folder.read("free.stl").is_empty());
    let told = folder.nappe("info free.obj");
    assert!(
        told.data().contains("missing geometry: 1 free-form"),
        "{}",
        told.data()
    );
}

#[test]
fn conversions_that_cannot_be_are_refused() {
    let folder = Folder::with_model(&cube());
    folder
        .nappe("build model.nappe.toml -o cube.step -o cube.stl")
        .data();
    let run = folder.nappe("convert cube.step cube.json");
    assert!(run.problem().contains("whole surfaces"), "{}", run.stderr);
    let run = folder.nappe("convert cube.stl cube.ply --tolerance 0.1");
    assert_eq!(run.code, 2, "{}", run.stderr);
    let run = folder.nappe("info cube.step --bending");
    assert_eq!(run.code, 2, "{}", run.stderr);
    folder.write("empty.igs", "");
    for command in [
        "info empty.igs",
        "convert empty.igs a.glb",
        "info none.step",
    ] {
        let run = folder.nappe(command);
        assert!(!run.problem().contains("panicked"), "{}", run.stderr);
    }
    assert!(!folder.path("a.glb").exists());
}

/// What goes out comes in again, in another unit, and builds the same.
#[test]
fn models_import_surfaces_and_curves() {
    let folder = Folder::with_model(MODEL);
    folder.nappe("build model.nappe.toml -o q.step").data();
    folder.write(
        "again.nappe.toml",
        "nappe = 1\nunits = \"mm\"\n[surfaces.wall]\nkind = \"import\"\nfile = \"q.step\"\n\
         [curves.rim]\nkind = \"import\"\nfile = \"q.step\"\n",
    );
    let points = |file: &str, of: &str| -> Vec<f64> {
        let run = folder.nappe(&format!("eval {file} {of} --grid 5 --format csv"));
        let lines = run.data().lines().skip(1).map(str::to_owned);
        let numbers = lines.flat_map(|l| {
            l.split(',')
                .map(|x| x.parse().unwrap())
                .collect::<Vec<f64>>()
        });
        numbers.collect()
    };
    let there = points("model.nappe.toml", "--surface wall");
    let here = points("again.nappe.toml", "--surface wall");
    assert_eq!(there.len(), here.len());
    let far = here.chunks(5).flat_map(|p| p[2..].to_vec());
    let largest = far.fold(0.0f64, |a, x| a.max(x.abs()));
    assert!((largest - 30.0).abs() < 1e-9, "{largest}");
    let told = folder.nappe("info again.nappe.toml --format json");
    let told: serde_json::Value = serde_json::from_str(told.data()).unwrap();
    let area = told["area"]["value"].as_f64().unwrap();
    let exact = 300.0 * std::f64::consts::PI;
    assert!((area - exact).abs() < 1e-4 * exact, "{area}, not {exact}");
    folder.write(
        "bad.nappe.toml",
        "nappe = 1\n[surfaces.wall]\nkind = \"import\"\nfile = \"q.step\"\nface = 2\n",
    );
    let run = folder.nappe("check bad.nappe.toml");
    assert!(
        run.problem().contains("q.step has no face 2"),
        "{}",
        run.stderr
    );
}
