//! `nappe check`: verdicts against joints whose gap, angle and curvature are known.

use crate::run::Folder;
use insta::assert_snapshot;
use std::f64::consts::FRAC_PI_2;

/// A floor and a wall that meet at a right angle, and a flat continuation of the floor.
const MODEL: &str = r#"
tolerance = 0.01
[surfaces.floor]
kind = "bilinear"
corners = [[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0]]]
[surfaces.wall]
kind = "bilinear"
corners = [[[1, 0, 0], [1, 1, 0]], [[1, 0, 1], [1, 1, 1]]]
[surfaces.yard]
kind = "bilinear"
corners = [[[-1, 0, 0], [-1, 1, 0]], [[0, 0, 0], [0, 1, 0]]]
"#;

fn claim(a: &str, b: &str, continuity: &str, tolerance: &str) -> String {
    format!(
        "[[checks]]\nbetween = [\"{a}\", \"{b}\"]\ncontinuity = \"{continuity}\"\ntolerance = {tolerance}\n"
    )
}

#[test]
fn claims_that_hold_pass_and_others_fail() {
    let right = claim("floor.east", "wall.west", "G0", "1e-9")
        + &claim("floor.west", "yard.east", "G1", "\"0.01deg\"")
        + &claim("floor.west", "yard.east", "G2", "0.001");
    let folder = Folder::with_model(&format!("{MODEL}{right}"));
    let run = folder.nappe("check model.nappe.toml");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_snapshot!("check-passes", run.data());

    let wrong = claim("floor.east", "wall.west", "G1", "\"45deg\"")
        + &claim("floor.south", "wall.north", "G0", "0.5");
    let folder = Folder::with_model(&format!("{MODEL}{wrong}"));
    let run = folder.nappe("check model.nappe.toml");
    assert_eq!(run.code, 1);
    assert_eq!(run.stderr, "");
    assert_snapshot!("check-fails", String::from_utf8(run.stdout).unwrap());
}

/// The second surface leaves its west side, where its derivative across vanishes, at a right angle to the first.
const STILL: &str = r#"
tolerance = 0.01
[surfaces.a]
kind = "bilinear"
corners = [[[20, 0, 0], [20, 10, 0]], [[30, 0, 0], [30, 10, 0]]]
[surfaces.b]
kind = "bezier"
points = [[[30, 0, 0], [30, 10, 0]], [[30, 0, 0], [30, 10, 0]], [[30, 0, 9], [30, 10, 9]]]
"#;

#[test]
fn a_claim_about_normals_that_do_not_exist_is_not_proven() {
    // Two triangles that have a corner in common, as collapsed sides.
    let tips = r#"
tolerance = 0.01
[surfaces.a]
kind = "bezier"
points = [[[0, 0, 0], [0, 0, 0]], [[1, 0, 0], [1, 1, 0]]]
[surfaces.b]
kind = "bezier"
points = [[[-1, 0, 3], [-1, -1, 5]], [[0, 0, 0], [0, 0, 0]]]
"#;
    for (model, sides) in [(STILL, ["a.east", "b.west"]), (tips, ["a.west", "b.east"])] {
        for (continuity, tolerance) in [("G1", "\"1deg\""), ("G2", "0.001")] {
            let claim = claim(sides[0], sides[1], continuity, tolerance);
            let run =
                Folder::with_model(&format!("{model}{claim}")).nappe("check model.nappe.toml");
            assert_eq!(run.code, 1, "{continuity} of {sides:?}");
            let text = String::from_utf8(run.stdout).unwrap();
            assert!(
                text.contains("angle unknown") && text.contains("not proven"),
                "{text}"
            );
        }
    }
}

#[test]
fn the_numbers_are_those_of_geometry() {
    let folder = Folder::with_model(&format!(
        "{MODEL}{}",
        claim("floor.east", "wall.west", "G1", "\"91deg\"")
    ));
    let run = folder.nappe("check model.nappe.toml --format json");
    let json: serde_json::Value = serde_json::from_str(run.data()).unwrap();
    let found = &json["checks"][0]["found"];
    let at_most = |what: &str| found[what]["at_most"]["error"].as_f64().unwrap();
    assert_eq!(found["angle"]["at_most"]["is"], "bounded");
    assert!((FRAC_PI_2..FRAC_PI_2 * 1.02).contains(&at_most("angle")));
    assert!((found["angle"]["found"].as_f64().unwrap() - FRAC_PI_2).abs() < 1e-12);
    assert!(at_most("gap") < 1e-12);
    assert_eq!(json["shared_sides"].as_array().unwrap().len(), 2);
    assert_eq!(json["failures"], 0);
}

#[test]
fn a_gap_that_the_mesh_would_not_close_fails() {
    // The wall is moved by half the tolerance of the mesh.
    let folder = Folder::with_model(&MODEL.replace(
        "[1, 0, 0], [1, 1, 0]], [[1, 0, 1]",
        "[1, 0, 0.005], [1, 1, 0.005]], [[1, 0, 1]",
    ));
    let run = folder.nappe("check model.nappe.toml");
    assert_eq!(run.code, 1);
    assert!(
        String::from_utf8(run.stdout)
            .unwrap()
            .contains("not joined")
    );
}

#[test]
fn a_surface_that_folds_over_fails() {
    // The middle row of points lies beyond the last: r_u turns round.
    let folder = Folder::with_model(
        r#"
[surfaces.fold]
kind = "bezier"
points = [[[0, 0, 0], [0, 1, 0]], [[3, 0, 0], [3, 1, 0]], [[1, 0, 0], [1, 1, 0]]]
"#,
    );
    let run = folder.nappe("check model.nappe.toml");
    assert_eq!(run.code, 1);
    assert!(
        String::from_utf8(run.stdout)
            .unwrap()
            .contains("folds over")
    );
}

/// A wall over a figure of eight.
const EIGHT: &str = r#"
[surfaces.eight]
kind = "ruled"
south = { kind = "expression", x = "sin(2*pi*t+0.4)", y = "sin(4*pi*t+0.8)", z = "0" }
north = { kind = "expression", x = "sin(2*pi*t+0.4)", y = "sin(4*pi*t+0.8)", z = "1" }
"#;

#[test]
fn a_surface_that_passes_through_itself_fails() {
    let folder = Folder::with_model(EIGHT);
    let run = folder.nappe("check model.nappe.toml --format json");
    assert_eq!(run.code, 1);
    let json: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    let found = &json["passing_through"]["found"][0];
    assert_eq!(found["surfaces"], serde_json::json!(["eight", "eight"]));
    assert_eq!(
        (&found["is"], &found["proven"]),
        (&"cross".into(), &true.into())
    );
    let angle = found["angle"].as_f64().unwrap();
    assert!((angle - 2.0 * 0.5f64.atan()).abs() < 1e-6, "{angle}");
    assert_eq!(json["failures"], 1);
}

#[test]
fn surfaces_that_pass_through_each_other_are_told_and_do_not_fail() {
    let through = MODEL.replace(
        "[[1, 0, 0], [1, 1, 0]], [[1, 0, 1]",
        "[[0.3, 0, -1], [0.3, 1, -1]], [[1, 0, 1]",
    );
    let folder = Folder::with_model(&through);
    let run = folder.nappe("check model.nappe.toml");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(
        run.data().contains("floor – wall  cross at 70.7°, proven"),
        "{}",
        run.data()
    );
}

#[test]
fn a_torn_surface_fails() {
    let folder = Folder::with_torn_surface();
    let run = folder.nappe("check model.nappe.toml");
    assert_eq!(run.code, 1, "{}", run.stderr);
    let text = String::from_utf8(run.stdout).unwrap();
    assert!(text.contains("torn at u = 0.5: it jumps there"), "{text}");
}

#[test]
fn a_crossing_on_the_seam_of_a_closed_surface_fails() {
    let rail = |z: u8| {
        format!(
            "{{ kind = \"expression\", x = \"sin(2*t)\", y = \"sin(t)\", z = \"{z}\", domain = [0, \"tau\"] }}"
        )
    };
    let folder = Folder::with_model(&format!(
        "[surfaces.eight]\nkind = \"ruled\"\nsouth = {}\nnorth = {}\n",
        rail(0),
        rail(1)
    ));
    let run = folder.nappe("check model.nappe.toml --format json");
    assert_eq!(run.code, 1);
    let json: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    let found = &json["passing_through"]["found"][0];
    assert_eq!(found["is"], "cross");
    // The branches have the slopes ±1/2.
    let angle = found["angle"].as_f64().unwrap();
    assert!((angle - 2.0 * 0.5f64.atan()).abs() < 1e-6, "{angle}");
}

#[test]
fn a_bow_tie_fails_and_an_hourglass_is_told_to_touch_itself() {
    let bow = Folder::with_model(
        "[surfaces.bow]\nkind = \"bilinear\"\ncorners = [[[0, 0, 0], [1, 1, 0]], [[1, 0, 0], [0, 1, 0]]]\n",
    );
    let run = bow.nappe("check model.nappe.toml --format json");
    assert_eq!(run.code, 1);
    let json: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    let place = json["surfaces"][0]["folds"][0][1].as_f64().unwrap();
    assert!((place - 0.5).abs() < 1e-6, "{place}");
    for model in [
        "kind = \"revolution\"\nprofile = { kind = \"polyline\", points = [[1, 0, 0], [0, 0, 1], [1, 0, 2]] }\n",
        "kind = \"torus\"\nmajor = 1\nminor = 1\n",
    ] {
        let folder = Folder::with_model(&format!("[surfaces.glass]\n{model}"));
        let run = folder.nappe("check model.nappe.toml");
        assert!(
            run.data()
                .contains("= 0.5 is one point, where it touches itself"),
            "{}",
            run.data()
        );
    }
}

#[test]
fn a_claim_that_is_only_estimated_says_so_in_its_row() {
    // Curvature is not proven up to the poles in which the seam of a sphere ends.
    let folder = Folder::with_model(&format!(
        "[surfaces.ball]\nkind = \"quadric\"\nshape = \"sphere\"\nsemi_axes = [1]\n{}",
        claim("ball.west", "ball.east", "G2", "0.01")
    ));
    let run = folder.nappe("check model.nappe.toml");
    let row = run.data().lines().find(|l| l.contains("G2 within 0.01"));
    assert!(row.unwrap().ends_with("  estimated"), "{}", run.data());
    assert!(run.data().contains("1 claim is only estimated"));
}

/// A long side with two short ones along it, of which the second turns away by atan(0.4).
const IN_PART: &str = r#"
tolerance = 0.01
[surfaces.floor]
kind = "bilinear"
corners = [[[0, 0, 0], [0, 2, 0]], [[2, 0, 0], [2, 2, 0]]]
[surfaces.left]
kind = "bilinear"
corners = [[[0, 2, 0], [0, 3, 0]], [[0.8, 2, 0], [0.8, 3, 0]]]
[surfaces.right]
kind = "bilinear"
corners = [[[0.8, 2, 0], [0.8, 3, 0.4]], [[2, 2, 0], [2, 3, 0.4]]]
"#;

#[test]
fn sides_that_meet_in_part_are_measured_along_it() {
    let folder = Folder::with_model(IN_PART);
    let run = folder.nappe("check model.nappe.toml");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_snapshot!("check-in-part", String::from_utf8(run.stdout).unwrap());
    let run = folder.nappe("check model.nappe.toml --format json");
    let json: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    let parts = json["sides_in_part"].as_array().unwrap();
    assert_eq!(parts.len(), 2);
    for (part, (angle, along)) in parts
        .iter()
        .zip([(0.0, [0.0, 0.4]), (0.4f64.atan(), [0.4, 1.0])])
    {
        let stretches = part["stretches"].as_array().unwrap();
        assert_eq!(stretches.len(), 1);
        for k in 0..2 {
            let end = stretches[0]["along"][k].as_f64().unwrap();
            assert!((end - along[k]).abs() < 1e-12);
        }
        let found = stretches[0]["found"]["angle"]["found"].as_f64().unwrap();
        assert!((found - angle).abs() < 1e-12);
    }
}

/// The claims of a model's only report.
fn claims_of(model: &str) -> (i32, Vec<serde_json::Value>) {
    let folder = Folder::with_model(model);
    let run = folder.nappe("check model.nappe.toml --format json");
    let json: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    (run.code, json["checks"].as_array().unwrap().clone())
}

#[test]
fn a_claim_of_sides_that_meet_in_part_is_tested_along_that_part() {
    // Of the second the angle is atan(0.4) = 21.8°, and each is tested along its own part of the long side.
    let claims = claim("left.south", "floor.north", "G2", "1e-6")
        + &claim("floor.north", "right.south", "G0", "1e-9")
        + &claim("floor.north", "right.south", "G1", "\"22deg\"")
        + &claim("floor.north", "right.south", "G1", "\"21.7deg\"");
    let (code, found) = claims_of(&format!("{IN_PART}{claims}"));
    assert_eq!(code, 1);
    let passes: Vec<bool> = found.iter().map(|c| c["passes"] == true).collect();
    assert_eq!(passes, [true, true, true, false]);
    for (c, verdict) in found.iter().zip(["proven", "proven", "proven", "fails"]) {
        assert_eq!(c["verdict"], verdict);
        assert_eq!(c["in_part"], true);
        assert!(c["found"].is_null() && c["sampled_distances"].is_null());
    }
    let along = |c: &serde_json::Value, k: usize, end: usize| {
        c["stretches"][0]["along"][k][end].as_f64().unwrap()
    };
    for (c, ranges) in found.iter().zip([
        [[0.0, 1.0], [0.0, 0.4]],
        [[0.4, 1.0], [0.0, 1.0]],
        [[0.4, 1.0], [0.0, 1.0]],
        [[0.4, 1.0], [0.0, 1.0]],
    ]) {
        assert_eq!(c["stretches"].as_array().unwrap().len(), 1);
        for k in 0..2 {
            for end in 0..2 {
                assert!((along(c, k, end) - ranges[k][end]).abs() < 1e-12);
            }
        }
    }
    let folder = Folder::with_model(&format!("{IN_PART}{claims}"));
    let run = folder.nappe("check model.nappe.toml");
    let text = String::from_utf8(run.stdout).unwrap();
    assert!(
        text.contains("in part, along u from 0 to 1 – u from 0 to 0.4: curvature ≤"),
        "{text}"
    );
    assert!(text.contains("✗ 1 failure"), "{text}");
}

#[test]
fn a_claim_in_part_says_how_far_the_sides_are_apart_there() {
    // The neighbour is 0.003 above the long side, and then 0.3: more than a share of its size, which a mesh would never join.
    for (up, tolerance, passes) in [
        (0.003, 0.004, true),
        (0.003, 0.002, false),
        (0.3, 0.31, true),
        (0.3, 0.29, false),
    ] {
        let model = format!(
            r#"
tolerance = 0.01
[surfaces.floor]
kind = "bilinear"
corners = [[[0, 0, 0], [0, 2, 0]], [[9, 0, 0], [9, 2, 0]]]
[surfaces.left]
kind = "bilinear"
corners = [[[0, 2, {up}], [0, 3, {up}]], [[6, 2, {up}], [6, 3, {up}]]]
{}"#,
            claim("left.south", "floor.north", "G0", &tolerance.to_string())
        );
        let (_, found) = claims_of(&model);
        assert_eq!(found[0]["passes"], passes, "{up} within {tolerance}");
        assert_eq!(found[0]["in_part"], true);
        let stretch = &found[0]["stretches"][0];
        assert!((stretch["found"]["gap"]["found"].as_f64().unwrap() - up).abs() < 1e-12);
        let end = stretch["along"][1][1].as_f64().unwrap();
        assert!((end - 2.0 / 3.0).abs() < 0.05, "{end}");
    }
}

#[test]
fn a_gap_at_the_end_of_sides_is_not_cut_away_from_a_claim() {
    // The sides agree up to z = 0.98; from there one of them leans away by 0.003, three times what is claimed.
    let model = |lean: f64, tall: f64| {
        let rail = |y: f64| {
            format!(
                "{{ kind = \"polyline\", points = [[0, {y}, 0], [0, {y}, 0.98], [{lean}, {y}, {tall}]] }}"
            )
        };
        format!(
            r#"
tolerance = 0.001
[surfaces.a]
kind = "bilinear"
corners = [[[-1, 0, 0], [-1, 0, 1]], [[0, 0, 0], [0, 0, 1]]]
[surfaces.b]
kind = "ruled"
south = {}
north = {}
{}"#,
            rail(0.0),
            rail(1.0),
            claim("a.east", "b.south", "G0", "1e-3")
        )
    };
    let (code, found) = claims_of(&model(0.003, 0.999));
    assert_eq!(
        (code, found[0]["passes"].as_bool()),
        (1, Some(false)),
        "{found:?}"
    );
    // One that only ends before is met from end to end.
    let (code, found) = claims_of(&model(0.0, 0.99));
    assert_eq!(
        (code, found[0]["passes"].as_bool()),
        (0, Some(true)),
        "{found:?}"
    );
}

#[test]
fn a_claim_of_sides_that_both_go_on_alone_must_say_that_it_means_a_part() {
    // The upper wall was moved: a tenth of each side is on the other.
    let model = r#"
tolerance = 0.01
[surfaces.a]
kind = "bilinear"
corners = [[[-1, 0, 0], [-1, 0, 1]], [[0, 0, 0], [0, 0, 1]]]
[surfaces.b]
kind = "bilinear"
corners = [[[0, 0, 0.9], [0, 0, 1.9]], [[1, 0, 0.9], [1, 0, 1.9]]]
"#;
    let claim = claim("a.east", "b.west", "G1", "\"1deg\"");
    let (code, found) = claims_of(&format!("{model}{claim}"));
    assert_eq!((code, &found[0]["verdict"]), (1, &"only in part".into()));
    assert_eq!(found[0]["passes"], false);
    let (code, found) = claims_of(&format!("{model}{claim}in_part = true\n"));
    assert_eq!((code, &found[0]["verdict"]), (0, &"proven".into()));
    for k in 0..2 {
        let along = &found[0]["stretches"][0]["along"][k];
        let width = along[1].as_f64().unwrap() - along[0].as_f64().unwrap();
        assert!((width - 0.1).abs() < 1e-9, "{along}");
    }
}

#[test]
fn closed_sides_that_start_at_different_points_are_tested_all_round() {
    // A cylinder and the cone that goes on from it, turned by a quarter: 45° between them, along two stretches.
    let model = r#"
tolerance = 0.01
[surfaces.low]
kind = "revolution"
profile = { kind = "line", from = [1, 0, 5], to = [1, 0, 6] }
[surfaces.high]
kind = "revolution"
profile = { kind = "line", from = [1, 0, 6], to = [2, 0, 7] }
start = "90deg"
"#;
    let claims = claim("low.east", "high.west", "G1", "\"45.5deg\"")
        + &claim("low.east", "high.west", "G1", "\"44.9deg\"");
    let (_, found) = claims_of(&format!("{model}{claims}"));
    assert_eq!(found[0]["verdict"], "proven");
    assert_eq!(found[1]["verdict"], "fails");
    for k in 0..2 {
        let stretches = found[0]["stretches"].as_array().unwrap();
        let width = |s: &serde_json::Value| {
            s["along"][k][1].as_f64().unwrap() - s["along"][k][0].as_f64().unwrap()
        };
        let whole: f64 = stretches.iter().map(width).sum();
        assert!((whole - 1.0).abs() < 1e-9, "{whole}");
    }
}

#[test]
fn a_claim_of_sides_that_do_not_meet_says_how_far_they_are_apart() {
    // From (x, 0, 0) to the nearest of (1, 1, z): at least 1, and at the far end √2.
    let model = format!(
        "{MODEL}{}",
        claim("floor.south", "wall.north", "G1", "\"90deg\"")
    );
    let (code, found) = claims_of(&model);
    assert_eq!((code, &found[0]["verdict"]), (1, &"fails".into()));
    assert_eq!(found[0]["in_part"], false);
    let apart = [0, 1].map(|k| found[0]["sampled_distances"][k].as_f64().unwrap());
    assert!((apart[0] - 1.0).abs() < 1e-12 && (apart[1] - 2f64.sqrt()).abs() < 1e-12);
    let run = Folder::with_model(&model).nappe("check model.nappe.toml");
    let text = String::from_utf8(run.stdout).unwrap();
    assert!(
        text.contains("the sides do not meet: 1 to 1.414 mm apart"),
        "{text}"
    );
}

#[test]
fn a_torn_surface_is_not_drawn_as_if_whole() {
    let folder = Folder::with_torn_surface();
    let run = folder.nappe("check model.nappe.toml --draw a.svg");
    assert_eq!(run.code, 1);
    let text = String::from_utf8(run.stdout).unwrap();
    assert!(text.contains("torn at u = 0.5: it jumps there"), "{text}");
    assert!(run.stderr.contains("torn at u = 0.5"), "{}", run.stderr);
    assert!(!folder.names().contains(&"a.svg".to_owned()));
}

const NOT_TO_THE_END: &str = "in part, but not from end to end";
const CREASE: &str = "a crease in a surface";

/// A strip with a bend of about an angle in its middle.
fn bent(angle: &str) -> String {
    let line = |y: u8| {
        format!("{{ kind = \"polyline\", points = [[0, {y}, 0], [1, {y}, 0], [2, {y}, {angle}]] }}")
    };
    format!(
        "[surfaces.strip]\nkind = \"ruled\"\nsouth = {}\nnorth = {}\n",
        line(0),
        line(1)
    )
}

#[test]
fn joints_are_drawn_by_what_they_reach() {
    let wrong = claim("floor.east", "wall.west", "G1", "\"45deg\"");
    let folder = Folder::with_model(&format!("{MODEL}{wrong}"));
    let run = folder.nappe("check model.nappe.toml --draw joints.svg --size 400x300");
    // Drawn also where a claim fails, which decides the exit code.
    assert_eq!(run.code, 1);
    assert!(
        run.stderr.starts_with("joints.svg: 400 × 300 pixels"),
        "{}",
        run.stderr
    );
    let svg = String::from_utf8(folder.read("joints.svg")).unwrap();
    let says = |svg: &str, text: &str| svg.contains(&format!(">{text}</text>"));
    for text in [
        "G0: an edge",
        "G2",
        "an open side",
        "a claim fails or is not proven",
    ] {
        assert!(says(&svg, text), "{text}");
    }
    for text in ["G1", "not joined: a gap", NOT_TO_THE_END, CREASE, "cross"] {
        assert!(!says(&svg, text), "{text}");
    }
    // What is said of other models.
    let crossing = r#"
[surfaces.blade]
kind = "bilinear"
corners = [[[0.5, 0.2, -1], [0.5, 0.2, 1]], [[0.6, 0.8, -1], [0.6, 0.8, 1]]]
"#;
    let apart = MODEL.replace(
        "[[0, 0, 0], [0, 1, 0]]]",
        "[[-0.002, 0, 0], [-0.002, 1, 0]]]",
    );
    let folded = r#"
[surfaces.bow]
kind = "bilinear"
corners = [[[0, 0, 0], [0, 1, 0]], [[1, 1, 0], [1, 0, 0]]]
"#;
    for (model, text) in [
        (format!("{MODEL}{crossing}"), "cross"),
        (apart, "not joined: a gap"),
        // Sides that meet in part, by what they reach there.
        (IN_PART.to_owned(), "G0: an edge"),
        (IN_PART.to_owned(), "G2"),
        (bent("0.01"), CREASE),
        (STILL.to_owned(), "G0; more is not proven"),
        (folded.to_owned(), "folds over"),
    ] {
        let folder = Folder::with_model(&model);
        folder.nappe("check model.nappe.toml --draw a.svg --view 20,50");
        let svg = String::from_utf8(folder.read("a.svg")).unwrap();
        assert!(says(&svg, text), "{text}");
        assert!(!says(&svg, NOT_TO_THE_END), "{text}");
    }
    // Less than 0.1° is smooth, in a surface as between two.
    let folder = Folder::with_model(&bent("0.0005"));
    folder.nappe("check model.nappe.toml --draw a.svg");
    assert!(!says(
        &String::from_utf8(folder.read("a.svg")).unwrap(),
        CREASE
    ));
    let folder = Folder::with_model(MODEL);
    // The picture has pixels too, and another view is another picture.
    let pictures = ["iso", "top"].map(|view| {
        folder.nappe(&format!(
            "check model.nappe.toml --draw a.png --size 200x150 --view {view}"
        ));
        folder.read("a.png")
    });
    assert!(pictures[0].starts_with(b"\x89PNG") && pictures[0] != pictures[1]);
}

#[test]
fn a_picture_that_cannot_be_written_is_refused_at_once() {
    let folder = Folder::with_model(MODEL);
    for name in ["a.stl", "a", "nowhere/a.png"] {
        let run = folder.nappe(&format!("check model.nappe.toml --draw {name}"));
        assert_eq!(run.code, 1, "{name}");
        assert!(
            run.stdout.is_empty() && run.stderr.contains(name),
            "{}",
            run.stderr
        );
    }
    assert_eq!(folder.nappe("check model.nappe.toml --view top").code, 2);
    assert_eq!(folder.names(), ["model.nappe.toml"]);
}
