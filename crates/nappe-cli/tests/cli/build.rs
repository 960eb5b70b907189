//! `nappe build`: every format is written and read back, and files are whole or not there.

use crate::run::Folder;
use insta::assert_snapshot;

/// A square of side 2 and height 0 or 1: two triangles would do for the floor, the roof is bent.
const MODEL: &str = r#"title = "Tent"
units = "cm"
tolerance = 0.01

[params]
side = { value = 2, min = 1, max = 9 }

[surfaces.floor]
kind = "bilinear"
corners = [[[0, 0, 0], [0, "side", 0]], [["side", 0, 0], ["side", "side", 0]]]

[surfaces.roof]
kind = "bilinear"
corners = [[[0, 0, 1], [0, "side", 2]], [["side", 0, 2], ["side", "side", 1]]]

[curves.pole]
kind = "line"
from = [0, 0, 0]
to = [0, 0, 1]
"#;

/// The table with what differs from run to run masked.
fn masked(text: &str) -> String {
    text.lines()
        .map(|l| match l.strip_prefix("time") {
            Some(_) => "time  (masked)\n".to_owned(),
            None => format!("{l}\n"),
        })
        .collect()
}

/// The value of a row of the table.
fn fact<'a>(table: &'a str, name: &str) -> &'a str {
    let line = table.lines().find(|l| l.starts_with(name)).unwrap();
    line[name.len()..].trim()
}

fn triangles(table: &str) -> usize {
    fact(table, "triangles").replace(',', "").parse().unwrap()
}

#[test]
fn the_default_is_a_glb_beside_the_model() {
    let folder = Folder::with_model(MODEL);
    let run = folder.nappe("build model.nappe.toml");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stdout.is_empty());
    assert_eq!(folder.names(), ["model.glb", "model.nappe.toml"]);
    assert_snapshot!(masked(&run.stderr));
    assert_eq!(folder.nappe("-q build model.nappe.toml").stderr, "");
}

#[test]
fn every_format_is_written_and_holds_the_mesh() {
    let folder = Folder::with_model(MODEL);
    let formats = [
        "glb", "gltf", "stl", "obj", "ply", "3mf", "vtu", "json", "png", "svg",
    ];
    let outputs: String = formats.map(|f| format!(" -o out.{f}")).concat();
    let run = folder.nappe(&format!("build model.nappe.toml{outputs}"));
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_eq!(folder.names().len(), 1 + formats.len());
    let n = triangles(&run.stderr);
    assert!(n > 4);

    let file = |ending: &str| folder.read(&format!("out.{ending}"));
    let text = |ending: &str| String::from_utf8(file(ending)).unwrap();
    // Binary STL: 80 bytes, the count, 50 bytes for each triangle.
    let stl = file("stl");
    assert_eq!(
        u32::from_le_bytes(stl[80..84].try_into().unwrap()) as usize,
        n
    );
    assert_eq!(stl.len(), 84 + 50 * n);
    assert_eq!(
        text("obj").lines().filter(|l| l.starts_with("f ")).count(),
        n
    );
    let ply = file("ply");
    assert!(ply.starts_with(b"ply"));
    let face = format!("element face {n}\n");
    assert!(ply.windows(face.len()).any(|w| w == face.as_bytes()));
    // The curve is a cell too.
    let vtu = file("vtu");
    let cells = format!("NumberOfCells=\"{}\"", n + 1);
    assert!(vtu.windows(cells.len()).any(|w| w == cells.as_bytes()));
    let gltf: serde_json::Value = serde_json::from_str(&text("gltf")).unwrap();
    let indices: u64 = gltf["meshes"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|m| m["primitives"].as_array().unwrap())
        .filter(|p| p["mode"].as_u64().unwrap_or(4) == 4)
        .map(|p| {
            gltf["accessors"][p["indices"].as_u64().unwrap() as usize]["count"]
                .as_u64()
                .unwrap()
        })
        .sum();
    assert_eq!(indices as usize, 3 * n);
    assert!(file("glb").starts_with(b"glTF"));
    assert!(file("3mf").starts_with(b"PK"));
    assert!(file("png").starts_with(b"\x89PNG"));
    assert!(text("svg").contains("<svg"));

    let json: serde_json::Value = serde_json::from_str(&text("json")).unwrap();
    let names = |list: &str| -> Vec<String> {
        let all = json[list].as_array().unwrap();
        all.iter()
            .map(|o| o["name"].as_str().unwrap().to_owned())
            .collect()
    };
    assert_eq!(names("surfaces"), ["floor", "roof"]);
    assert_eq!(names("curves"), ["pole"]);
    assert_eq!(json["units"], "cm");
    assert_eq!(
        json["surfaces"][1]["points"][1][0],
        serde_json::json!([2.0, 0.0, 2.0])
    );
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let folder = Folder::with_model(MODEL);
    for ending in ["glb", "obj", "3mf", "png", "svg", "json"] {
        assert_eq!(
            folder
                .nappe(&format!("build model.nappe.toml -o a.{ending}"))
                .code,
            0
        );
        assert_eq!(
            folder
                .nappe(&format!("build model.nappe.toml -o b.{ending}"))
                .code,
            0
        );
        let (a, b) = (
            folder.read(&format!("a.{ending}")),
            folder.read(&format!("b.{ending}")),
        );
        assert!(a == b, ".{ending} differs");
    }
}

#[test]
fn tolerance_and_parameters_are_taken_from_the_command_line() {
    let folder = Folder::with_model(MODEL);
    let built = |args: &str| {
        folder
            .nappe(&format!("build model.nappe.toml {args}"))
            .stderr
    };
    let (coarse, fine) = (built(""), built("--tolerance 0.0001"));
    assert!(triangles(&fine) > 10 * triangles(&coarse));
    let large = built("--set side=4*2");
    assert!(fact(&large, "box").starts_with("8 × 8 × 2 cm"), "{large}");
}

#[test]
fn objects_for_construction_only_are_not_put_out() {
    let folder = Folder::with_model(&MODEL.replace(
        "[surfaces.floor]",
        "[surfaces.floor]\nconstruction_only = true",
    ));
    let run = folder.nappe("build model.nappe.toml -o out.json -o out.obj");
    assert_eq!(fact(&run.stderr, "patches"), "1");
    for file in ["out.json", "out.obj"] {
        let text = String::from_utf8(folder.read(file)).unwrap();
        assert!(text.contains("roof") && !text.contains("floor"), "{file}");
    }
}

#[test]
fn outputs_that_cannot_be_are_told_before_anything_is_built() {
    // The model is wrong too, but the outputs come first.
    let folder = Folder::with_model("[surfaces.a]\nkind = 'nothing'\n");
    let run = folder.nappe("build model.nappe.toml -o out.slt -o none/out.glb -o . -o good.glb");
    assert_snapshot!(run.problem());
    assert_eq!(folder.names(), ["model.nappe.toml"]);
    assert_eq!(
        folder
            .nappe("build model.nappe.toml -o a.glb -o a.glb")
            .code,
        2
    );
}

#[cfg(unix)]
#[test]
fn a_folder_that_may_not_be_written_to_is_told() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::with_model(MODEL);
    let locked = folder.path("locked");
    std::fs::create_dir(&locked).unwrap();
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o555)).unwrap();
    // The superuser may write everywhere: then there is nothing to see.
    if std::fs::write(locked.join("probe"), "").is_ok() {
        return;
    }
    let run = folder.nappe("build model.nappe.toml -o locked/out.glb");
    assert!(run.problem().contains("locked/out.glb"), "{}", run.stderr);
    assert!(
        run.stderr.contains("check the permissions"),
        "{}",
        run.stderr
    );
    assert_eq!(std::fs::read_dir(&locked).unwrap().count(), 0);
}

#[test]
fn a_model_that_meshes_to_nothing_says_so() {
    let folder =
        Folder::with_model("[curves.a]\nkind = 'line'\nfrom = [0, 0, 0]\nto = [1, 0, 0]\n");
    let run = folder.nappe("build model.nappe.toml");
    assert!(run.problem().contains("nothing to write"), "{}", run.stderr);
    assert_eq!(folder.names(), ["model.nappe.toml"]);
    assert_eq!(folder.nappe("build model.nappe.toml -o a.json").code, 0);
}

#[test]
fn a_tolerance_below_rounding_is_refused() {
    let folder = Folder::with_model(MODEL);
    let run = folder.nappe("build model.nappe.toml --tolerance 1e-16");
    assert!(
        run.problem().contains("below the rounding errors"),
        "{}",
        run.stderr
    );
    assert_eq!(folder.names(), ["model.nappe.toml"]);
}

#[test]
fn sides_that_nearly_meet_are_noted() {
    // Two squares with a gap of half the tolerance; of a hundredth of it, there is nothing to say.
    let model = |gap: f64| {
        format!(
            "tolerance = 0.01\n[surfaces.a]\nkind = \"bilinear\"\ncorners = [[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0]]]\n\
             [surfaces.b]\nkind = \"bilinear\"\ncorners = [[[1, 0, {gap}], [1, 1, {gap}]], [[2, 0, 0], [2, 1, 0]]]\n"
        )
    };
    for (gap, noted) in [(0.005, true), (0.0001, false)] {
        let folder = Folder::with_model(&model(gap));
        let run = folder.nappe("build model.nappe.toml -o a.stl");
        assert_eq!(run.code, 0, "{}", run.stderr);
        let told = run
            .stderr
            .contains("a.east and b.west nearly meet, but with a gap of 0.005 mm");
        assert_eq!(told, noted, "{}", run.stderr);
    }
}

/// A long side that two shorter ones meet, and rings that start at different points.
const IN_PART: &str = r#"
[surfaces.a]
kind = "bilinear"
corners = [[[0, 0, 0], [0, 1, 0]], [[2, 0, 0], [2, 1, 0]]]
[surfaces.b]
kind = "bilinear"
corners = [[[0, 1, 0], [0, 2, 0]], [[1, 1, 0], [1, 2, 0]]]
[surfaces.c]
kind = "bilinear"
corners = [[[1, 1, 0], [1, 2, 0]], [[2, 1, 0], [2, 2, 0]]]
[surfaces.low]
kind = "revolution"
profile = { kind = "line", from = [1, 0, 5], to = [1, 0, 6] }
[surfaces.high]
kind = "revolution"
profile = { kind = "line", from = [1, 0, 6], to = [2, 0, 7] }
start = "90deg"
"#;

#[test]
fn sides_that_meet_in_part_are_noted_with_the_place_to_split() {
    let folder = Folder::with_model(IN_PART);
    for command in ["build model.nappe.toml -o a.stl", "check model.nappe.toml"] {
        let run = folder.nappe(command);
        assert_eq!(run.code, 0, "{}", run.stderr);
        for text in [
            "b.south lies along part of a.north, from (0, 1, 0) to (1, 1, 0): they are not joined",
            "c.south lies along part of a.north, from (1, 1, 0) to (2, 1, 0): they are not joined",
            "help: split a at u = 0.5, so that whole sides meet",
            "high.west lies along low.east all the way round, but they start at different points",
            "help: let both start at one point; high.west starts at (0, 1, 6)",
        ] {
            assert!(run.stderr.contains(text), "{text}: {}", run.stderr);
        }
        assert_eq!(
            run.stderr.matches("not watertight there").count(),
            3,
            "{}",
            run.stderr
        );
    }
    let mended = IN_PART.replace("start = \"90deg\"", "");
    let folder = Folder::with_model(&mended);
    let run = folder.nappe("build model.nappe.toml -o a.stl");
    assert_eq!(
        run.stderr.matches("not watertight there").count(),
        2,
        "{}",
        run.stderr
    );
    let run = folder.nappe("check model.nappe.toml --format json");
    let json: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    let found = json["sides_in_part"].as_array().unwrap();
    assert_eq!(found.len(), 2);
    let b = found.iter().find(|f| f["part"] == "b.south").unwrap();
    assert_eq!(b["along"], "a.north");
    assert_eq!(b["split"], serde_json::json!({ "dir": "u", "at": [0.5] }));
    assert_eq!(b["to"], serde_json::json!([1.0, 1.0, 0.0]));
}

/// Three strips along each other, bent; the last runs along its sides with other parameters.
const STRIPS: &str = r#"
tolerance = 0.001
[curves.a]
kind = "expression"
x = "t"
y = "0"
z = "sin(3*t)"
construction_only = true
[curves.b]
kind = "expression"
x = "t"
y = "1"
z = "sin(3*t)"
construction_only = true
[curves.c]
kind = "expression"
x = "t"
y = "2"
z = "cos(5*t)"
construction_only = true
[surfaces.one]
kind = "ruled"
south = "a"
north = "b"
[surfaces.two]
kind = "ruled"
south = "b"
north = "c"
"#;

#[test]
fn exact_files_have_common_curves_where_surfaces_share_sides() {
    let folder = Folder::with_model(STRIPS);
    let run = folder.nappe("build model.nappe.toml -o a.json");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(!run.stderr.contains("apart"), "{}", run.stderr);
    let json: serde_json::Value = serde_json::from_slice(&folder.read("a.json")).unwrap();
    let of = |k: usize| &json["surfaces"][k];
    for k in 0..2 {
        assert!(of(k)["exactness"]["by"].as_f64().unwrap() <= 0.001);
    }
    // The second has all knots of the first along the side, and the same points at its ends.
    let knots = |k: usize| -> Vec<f64> {
        let all = of(k)["knots_u"].as_array().unwrap().iter();
        all.map(|x| x.as_f64().unwrap()).collect()
    };
    assert!(knots(0).iter().all(|t| knots(1).contains(t)));
    let ends = |k: usize, first: bool| -> Vec<f64> {
        let rows = of(k)["points"].as_array().unwrap();
        let row = if first {
            &rows[0]
        } else {
            &rows[rows.len() - 1]
        };
        let columns = row.as_array().unwrap();
        let point = if k == 0 {
            &columns[columns.len() - 1]
        } else {
            &columns[0]
        };
        let point = point.as_array().unwrap().iter();
        point.map(|x| x.as_f64().unwrap()).collect()
    };
    for first in [true, false] {
        let (p, q) = (ends(0, first), ends(1, first));
        assert!(
            p.iter().zip(&q).all(|(x, y)| (x - y).abs() < 1e-14),
            "{p:?} {q:?}"
        );
    }
    // With other parameters no common curve can be taken over, and that is told.
    let uneven = STRIPS.replace(
        "[surfaces.two]",
        "[curves.d]\nkind = \"expression\"\nx = \"(t+t^2)/2\"\ny = \"1\"\nz = \"sin(1.5*(t+t^2))\"\nconstruction_only = true\n[surfaces.two]",
    );
    let folder = Folder::with_model(&uneven.replace("south = \"b\"", "south = \"d\""));
    let run = folder.nappe("build model.nappe.toml -o a.json");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let text = "note: the NURBS forms of one.north and two.south are at most";
    assert!(run.stderr.contains(text), "{}", run.stderr);
    assert!(run.stderr.contains("mm apart (proven)"), "{}", run.stderr);
}

#[test]
fn every_refusal_to_write_has_its_remedy() {
    let folder = Folder::with_model(MODEL);
    folder.write("file", "");
    std::fs::create_dir(folder.path("folder.stl")).unwrap();
    for (target, told, remedy) in [
        (
            "none/a.stl",
            "the directory none does not exist",
            "make it first",
        ),
        (
            "file/a.stl",
            "file is not a directory",
            "choose another name",
        ),
        (
            "file/deep/a.stl",
            "file is not a directory",
            "choose another name",
        ),
        ("folder.stl", "is a directory", "choose another name"),
    ] {
        for command in ["build", "render"] {
            let target = if command == "render" {
                target.replace("stl", "png")
            } else {
                target.to_owned()
            };
            if command == "render" && target == "folder.png" {
                continue;
            }
            let run = folder.nappe(&format!("{command} model.nappe.toml -o {target}"));
            let text = run.problem().replace("\n  │ ", " ");
            assert!(
                text.contains(told) && text.contains(remedy),
                "{target}: {text}"
            );
        }
    }
    let run = folder.nappe("build file/model.nappe.toml");
    assert!(run.problem().contains("help: "), "{}", run.stderr);
    assert_eq!(folder.names(), ["file", "folder.stl", "model.nappe.toml"]);
}

#[test]
fn a_negative_tolerance_is_named_as_what_it_is() {
    let folder = Folder::with_model(MODEL);
    for command in ["build model.nappe.toml", "render model.nappe.toml -o a.png"] {
        for argument in ["=-1", "=-0.5e-3", "=0", "=-inf", " -1"] {
            let run = folder.nappe(&format!("{command} --tolerance{argument}"));
            assert_eq!(run.code, 2);
            assert!(
                run.stderr.contains("is not a length greater than zero"),
                "{argument}: {}",
                run.stderr
            );
        }
    }
}

/// A model goes out as IGES, is converted to STEP and back, and meshes go from format to format.
#[test]
fn files_are_converted() {
    let folder = Folder::new();
    folder.write(
        "ball.nappe.toml",
        "nappe = 1\n[surfaces.ball]\nkind = \"quadric\"\nshape = \"sphere\"\nsemi_axes = [2]\n",
    );
    folder
        .nappe("build ball.nappe.toml -o ball.igs -o ball.stl")
        .data();
    folder.nappe("convert ball.igs ball.step").data();
    folder.nappe("convert ball.step again.iges").data();
    let text = String::from_utf8(folder.read("again.iges")).unwrap();
    // A solid with one face.
    let entities = |kind: &str| {
        let directory = text.lines().filter(|l| l.as_bytes().get(72) == Some(&b'D'));
        directory
            .step_by(2)
            .filter(|l| l[..8].trim() == kind)
            .count()
    };
    assert_eq!(
        (entities("186"), entities("510"), entities("128")),
        (1, 1, 1)
    );
    folder.nappe("convert ball.stl ball.ply").data();
    folder.nappe("convert ball.ply ball.3mf").data();
    let refused = folder.nappe("convert ball.stl ball.igs");
    assert!(
        refused.problem().contains("no exact surfaces"),
        "{}",
        refused.problem()
    );
    let refused = folder.nappe("convert ball.igs ball.xyz");
    assert!(refused.problem().contains(".xyz"), "{}", refused.problem());
}

#[test]
fn step_files_follow_the_standard_that_is_asked_for_and_their_surfaces_are_counted() {
    let folder = Folder::with_model(MODEL);
    let run = folder.nappe("build model.nappe.toml -o tent.step");
    run.data();
    // The floor, the roof and the pole.
    assert_eq!(fact(&run.stderr, "curves and surfaces"), "3");
    let schema = |name: &str| {
        let text = String::from_utf8(folder.read(name)).unwrap();
        let line = text.lines().find(|l| l.starts_with("FILE_SCHEMA"));
        line.unwrap().to_owned()
    };
    assert!(schema("tent.step").contains("AP242"));
    folder
        .nappe("build model.nappe.toml --ap214 -o tent.step")
        .data();
    assert!(schema("tent.step").contains("AUTOMOTIVE_DESIGN"));
    folder.nappe("convert tent.step again.stp").data();
    assert!(schema("again.stp").contains("AP242"));
    folder.nappe("convert tent.step again.stp --ap214").data();
    assert!(schema("again.stp").contains("AUTOMOTIVE_DESIGN"));
    for wrong in [
        "build model.nappe.toml --ap214 -o tent.stl",
        "convert tent.step tent.igs --ap214",
    ] {
        let run = folder.nappe(wrong);
        assert_eq!(run.code, 2, "{}", run.stderr);
        assert!(
            run.stderr.contains("--ap214 is for STEP files"),
            "{}",
            run.stderr
        );
    }
}
