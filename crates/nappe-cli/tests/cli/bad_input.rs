//! Bad input: each kind gives exit code 1 and says file, line, column, the object's name, the numbers and a remedy.
//! Nothing is written and what was there stays.

use crate::run::Folder;
use insta::assert_snapshot;

/// Builds a wrong model beside an old output file. The place is where the message must point: line and column.
fn refused(name: &str, model: &str, place: &str) {
    let folder = Folder::with_model(model);
    folder.write("model.glb", "old");
    let run = folder.nappe("build model.nappe.toml");
    let text = run.problem();
    assert!(
        text.contains(&format!("model.nappe.toml:{place}]")),
        "{name}: does not point to {place}:\n{text}"
    );
    assert!(text.contains("help:"), "{name}: no remedy:\n{text}");
    assert!(run.stdout.is_empty());
    assert_eq!(folder.read("model.glb"), b"old");
    assert_eq!(folder.names(), ["model.glb", "model.nappe.toml"]);
    assert_snapshot!(format!("bad-{name}"), text);
}

#[test]
fn unknown_keys_and_kinds() {
    refused(
        "unknown-kind",
        r#"[surfaces.dome]
kind = "revolutoin"
profile = "p"
"#,
        "3:8",
    );
    refused(
        "unknown-key",
        r#"[curves.edge]
kind = "line"
form = [0, 0, 0]
to = [1, 0, 0]
"#,
        "4:1",
    );
    refused("unknown-units", "units = \"inch\"\n", "2:9");
}

#[test]
fn arrays_of_the_wrong_shape() {
    refused(
        "short-vector",
        r#"[curves.edge]
kind = "polyline"
points = [[0, 0, 0], [1, 0], [2, 0, 0]]
"#,
        "4:22",
    );
    refused(
        "ragged-net",
        r#"[surfaces.net]
kind = "bezier"
points = [[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0], [1, 2, 0]]]
"#,
        "4:35",
    );
}

#[test]
fn numbers_that_are_not_finite() {
    refused(
        "nan",
        r#"[curves.edge]
kind = "line"
from = [0, nan, 0]
to = [1, 0, 0]
"#,
        "4:12",
    );
    refused(
        "infinite",
        r#"[params]
a = "1 / (2 - 2)"
[curves.edge]
kind = "line"
from = [0, "a", 0]
to = [1, 0, 0]
"#,
        "3:6",
    );
}

#[test]
fn weights_that_are_not_positive() {
    for (name, weight, column) in [("zero", "0", 15), ("negative", "-0.5", 15)] {
        refused(
            &format!("weight-{name}"),
            &format!(
                "[curves.arc]\nkind = \"bezier\"\npoints = [[1, 0, 0], [1, 1, 0], [0, 1, 0]]\nweights = [1, {weight}, 1]\n"
            ),
            &format!("5:{column}"),
        );
    }
}

#[test]
fn knots_that_are_wrong() {
    let nurbs = |knots: &str| {
        format!(
            "[curves.spline]\nkind = \"nurbs\"\ndegree = 2\npoints = [[0, 0, 0], [1, 1, 0], [2, 0, 0], [3, 1, 0]]\nknots = {knots}\n"
        )
    };
    refused(
        "knots-unsorted",
        &nurbs("[0, 0, 0, 0.7, 0.2, 1, 1]"),
        "6:24",
    );
    refused("knots-few", &nurbs("[0, 0, 0, 1, 1, 1]"), "6:9");
    refused(
        "knots-multiplicity",
        &nurbs("[0, 0, 0, 0, 1, 1, 1]"),
        "6:10",
    );
}

/// Four lines around a square, with the ends of one of them open to change.
fn square(north: &str, rest: &str) -> String {
    format!(
        r#"[curves.south]
kind = "line"
from = [0, 0, 0]
to = [1, 0, 0]
[curves.north]
kind = "line"
{north}
[curves.west]
kind = "line"
from = [0, 0, 0]
to = [0, 1, 0]
[curves.east]
kind = "line"
from = [1, 0, 0]
to = [1, 1, 0]
[surfaces.patch]
south = "south"
north = "north"
west = "west"
east = "east"
{rest}
"#
    )
}

#[test]
fn boundaries_that_do_not_meet_or_run_the_wrong_way() {
    refused(
        "corner-gap",
        &square("from = [0, 1, 0]\nto = [1, 1, 0.25]", "kind = \"coons\""),
        "20:9",
    );
    refused(
        "wrong-direction",
        &square("from = [1, 1, 0]\nto = [0, 1, 0]", "kind = \"coons\""),
        "20:9",
    );
}

#[test]
fn a_contour_without_a_diagonal() {
    let mut model = square(
        "from = [0, 1, 0]\nto = [1, 1, 0]",
        "kind = \"diagonal-key\"",
    );
    model = model.replace(
        "[curves.east]\nkind = \"line\"\nfrom = [1, 0, 0]\nto = [1, 1, 0]",
        "[curves.east]\nkind = \"bezier\"\npoints = [[1, 0, 0], [1.5, 0.5, 0], [1, 1, 0]]",
    );
    refused("diagonal-zero", &model, "17:11");
}

#[test]
fn trigonometric_blending_too_near_a_half_turn() {
    refused(
        "trigonometric",
        &square(
            "from = [0, 1, 0]\nto = [1, 1, 0]",
            "kind = \"coons\"\nblend = { trigonometric = \"179.9999999deg\" }",
        ),
        "24:9",
    );
}

#[test]
fn a_profile_that_crosses_the_axis() {
    refused(
        "axis",
        r#"[curves.profile]
kind = "line"
from = [-1, 0, 0]
to = [2, 0, 3]
[surfaces.cone]
kind = "revolution"
profile = "profile"
"#,
        "8:11",
    );
}

#[test]
fn angles_without_unit_or_out_of_range() {
    let turned = |angle: &str| {
        format!(
            "[surfaces.cone]\nkind = \"revolution\"\nprofile = {{ kind = \"line\", from = [1, 0, 0], to = [2, 0, 3] }}\nangle = {angle}\n"
        )
    };
    refused("angle-unit", &turned("90"), "5:9");
    refused("angle-range", &turned("\"400deg\""), "5:9");
}

#[test]
fn parameters_and_references_in_circles_or_unknown() {
    refused(
        "parameter-cycle",
        "[params]\na = \"b + 1\"\nb = \"2 * a\"\n",
        "3:1",
    );
    refused(
        "parameter-unknown",
        "[params]\nradius = 3\nwaist = \"0.5 * raduis\"\n",
        "4:16",
    );
    refused(
        "parameter-range",
        "[params]\nradius = { value = 3, min = 5 }\n",
        "3:20",
    );
    refused(
        "reference-unknown",
        r#"[curves.profile]
kind = "line"
from = [1, 0, 0]
to = [2, 0, 3]
[surfaces.cone]
kind = "revolution"
profile = "profil"
"#,
        "8:11",
    );
    refused(
        "reference-cycle",
        "[curves.a]\nkind = \"reverse\"\ncurve = \"b\"\n[curves.b]\nkind = \"reverse\"\ncurve = \"a\"\n",
        "7:9",
    );
}

#[test]
fn a_division_by_zero_says_where() {
    refused(
        "division",
        r#"[curves.pole]
kind = "expression"
x = "t"
y = "1 / (t - 0.5)"
z = "0"
domain = [0, 1]
"#,
        "5:5",
    );
}

#[test]
fn a_collapsed_surface() {
    refused(
        "collapsed",
        r#"[surfaces.nothing]
kind = "bilinear"
corners = [[[0, 0, 0], [1, 1, 1]], [[2, 2, 2], [3, 3, 3]]]
"#,
        "4:11",
    );
}

#[test]
fn several_problems_are_told_in_one_run() {
    refused(
        "several",
        r#"units = "furlong"
[params]
a = "b"
[curves.one]
kind = "lime"
[curves.two]
kind = "line"
from = [0, 0]
[surfaces.three]
kind = "ruled"
south = "one"
north = "nothing"
"#,
        "2:9",
    );
}

#[test]
fn settings_that_do_not_fit() {
    let folder = Folder::with_model("[params]\nradius = { value = 3, min = 1, max = 9 }\n");
    let mut all = String::new();
    for set in ["raduis=4", "radius=10", "radius=x+1", "radius=1/0"] {
        let run = folder.nappe(&format!("build model.nappe.toml --set {set}"));
        all.push_str(&format!("$ --set {set}\n{}\n", run.problem()));
    }
    assert_snapshot!(all);
}

#[test]
fn files_that_are_no_models() {
    let folder = Folder::new();
    folder.write("broken.nappe.toml", "nappe = 1\n[curves.a\nkind = 'line'\n");
    folder.write("empty.nappe.toml", "");
    folder.write("old.nappe.toml", "nappe = 7\n");
    std::fs::write(folder.path("bytes.nappe.toml"), [0xff, 0xfe, 0x00]).unwrap();
    let mut all = String::new();
    for name in ["broken", "empty", "old", "bytes", "missing"] {
        let run = folder.nappe(&format!("build {name}.nappe.toml"));
        all.push_str(&format!("$ {name}\n{}\n", run.problem()));
    }
    let run = folder.nappe("build .");
    all.push_str(&format!("$ .\n{}\n", run.problem()));
    assert_snapshot!(all);
}

/// A square sheet; more is said before it and of it.
fn sheet(before: &str, corner: &str) -> String {
    format!(
        "{before}[surfaces.sheet]\nkind = \"bilinear\"\ncorners = [[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], {corner}]]\n"
    )
}

#[test]
fn what_only_the_mesh_finds_is_told_at_its_place() {
    refused(
        "mesh-fine",
        &sheet("tolerance = 1e-18\n", "[1, 1, 1]"),
        "2:13",
    );
    refused(
        "mesh-many",
        &sheet("tolerance = 1e-9\n", "[1, 1, 1]"),
        "2:13",
    );
    refused(
        "mesh-far",
        &sheet("", "[1e28, 1e28, 1e28]")
            .replace("0, 0, 0", "1e28, 0, 0")
            .replace("[0, 1, 0]", "[1e28, 1, 0]")
            .replace("[1, 0, 0]", "[1e28, 0, 1]")
            .replace("[1e28, 1e28, 1e28]", "[1e28, 1, 1]"),
        "2:11",
    );
    // The samples see a sheet; the jump at t = 1/2 is seen by the mesh.
    refused(
        "mesh-torn",
        r#"[curves.step]
kind = "expression"
x = "t"
y = "if(t < 0.5, 0, 5)"
z = "0"
[surfaces.torn]
kind = "ruled"
south = "step"
north = { kind = "transform", curve = "step", translate = [0, 0, 4] }
"#,
        "7:11",
    );
}

#[test]
fn a_tolerance_of_the_command_line_is_named_so() {
    let folder = Folder::with_model(&sheet("tolerance = 0.1\n", "[1, 1, 1]"));
    let mut all = String::new();
    for tolerance in ["1e-18", "1e-9"] {
        let run = folder.nappe(&format!("build model.nappe.toml --tolerance {tolerance}"));
        all.push_str(&format!("$ --tolerance {tolerance}\n{}\n", run.problem()));
    }
    assert_snapshot!(all);
    assert_eq!(folder.names(), ["model.nappe.toml"]);
}

#[test]
fn sizes_beyond_what_is_computed_with() {
    refused("size-large", &sheet("", "[1e200, 1, 1]"), "4:49");
    refused(
        "size-tiny",
        "[surfaces.ball]\nkind = \"quadric\"\nshape = \"sphere\"\nsemi_axes = [1e-200]\n",
        "5:13",
    );
    refused(
        "size-scaled",
        "[surfaces.ball]\nkind = \"quadric\"\nshape = \"sphere\"\nsemi_axes = [20]\n\
         [surfaces.large]\nkind = \"transform\"\nsurface = \"ball\"\nscale = 1e30\n",
        "9:9",
    );
}

/// Just within the bounds everything works.
#[test]
fn the_largest_and_the_smallest_models() {
    for size in ["1e29", "1e-29"] {
        let folder = Folder::with_model(&format!(
            "[surfaces.ring]\nkind = \"torus\"\nmajor = \"2*{size}\"\nminor = {size}\n"
        ));
        for args in [
            "build model.nappe.toml --tolerance 1e28 -o a.glb -o a.stl -o a.vtu -o a.json"
                .replace("1e28", &size.replace("29", "28").replace("e-28", "e-30")),
            "info model.nappe.toml".into(),
            "check model.nappe.toml".into(),
            "render model.nappe.toml -o a.png --size 64x64".into(),
        ] {
            let run = folder.nappe(&args);
            assert_eq!(run.code, 0, "{args}: {}", run.stderr);
        }
        let stl = folder.read("a.stl");
        let finite = stl[84..].chunks_exact(50).all(|t| {
            t[..48]
                .chunks_exact(4)
                .all(|x| f32::from_le_bytes([x[0], x[1], x[2], x[3]]).is_finite())
        });
        assert!(finite, "{size}");
    }
}

#[test]
fn one_file_is_not_written_twice_by_two_names() {
    let folder = Folder::with_model(&sheet("", "[1, 1, 1]"));
    let run = folder.nappe("build model.nappe.toml -o a.stl -o ./a.stl");
    assert_eq!(run.code, 2, "{}", run.stderr);
    assert_eq!(folder.names(), ["model.nappe.toml"]);
}
