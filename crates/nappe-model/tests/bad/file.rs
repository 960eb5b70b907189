//! The file, its keys and parameters, and the shapes of values.

use crate::{Row, check, faults};
use nappe_model::{Overrides, parse};

const ROWS: &[Row] = &[
    // The file.
    ("titel = 'x'", (2, 1), &["titel"], "`title`"),
    ("units = 'mmm'", (2, 9), &["mmm", "units"], "mm"),
    (
        "tolerance = -1",
        (2, 13),
        &["tolerance", "-1"],
        "greatest distance",
    ),
    (
        "tolerance = [1]",
        (2, 13),
        &["tolerance", "a list of 1 value"],
        "number",
    ),
    ("curves = 3", (2, 10), &["curves", "number 3"], "[curves]"),
    ("checks = 3", (2, 10), &["checks"], "[[checks]]"),
    ("[curves.'a b']\nkind = 'line'", (2, 9), &["a b"], "letters"),
    // Kinds and keys.
    (
        "[surfaces.s]\nkind = 'revoltion'",
        (3, 8),
        &["surface `s`", "revoltion"],
        "\"revolution\"",
    ),
    (
        "[surfaces.s]\nkind = 'qqqq'",
        (3, 8),
        &["surface `s`", "qqqq"],
        "bilinear",
    ),
    (
        "[surfaces.s]\nangle = '1deg'",
        (2, 11),
        &["surface `s`", "kind"],
        "kinds are",
    ),
    (
        "[curves.c]\nkind = 'line'\nfrom = [0,0,0]\ntoo = [1,0,0]",
        (5, 1),
        &["curve `c`", "too"],
        "`to`",
    ),
    (
        "[curves.c]\nkind = 'line'\nfrom = [0,0,0]",
        (2, 9),
        &["curve `c`", "`to` is missing"],
        "three numbers",
    ),
    (
        "[curves.c]\nkind = 'arc'",
        (2, 9),
        &["curve `c`", "missing"],
        "`through`",
    ),
    (
        "[curves.c]\nkind = 'arc'\ncenter = [0,0,0]\nradius = 1\nfrom = '0deg'\nto = '1deg'\nthrough = [[0,0,0],[1,0,0],[0,1,0]]",
        (8, 1),
        &["through", "center"],
        "remove",
    ),
    (
        "[curves.c]\nkind = 3",
        (3, 8),
        &["curve `c`", "kind", "number 3"],
        "text",
    ),
    (
        "[curves]\nc = 3",
        (3, 5),
        &["curve `c`", "table", "number 3"],
        "kind",
    ),
    // Shapes.
    (
        "[curves.c]\nkind = 'line'\nfrom = [0,0]\nto = [1,0,0]",
        (4, 8),
        &["curve `c`", "from", "three numbers"],
        "[x, y, z]",
    ),
    (
        "[curves.c]\nkind = 'polyline'\npoints = [0, 1]",
        (4, 11),
        &["curve `c`", "points[0]"],
        "[x, y, z]",
    ),
    (
        "[surfaces.s]\nkind = 'bezier'\npoints = [[[0,0,0],[0,1,0]],[[1,0,0]]]",
        (4, 29),
        &["surface `s`", "points[1]", "length 1", "2"],
        "same length",
    ),
    (
        "[surfaces.s]\nkind = 'bilinear'\ncorners = [[[0,0,0],[0,1,0]]]",
        (4, 11),
        &["surface `s`", "corners", "2 rows of 2"],
        "2 rows",
    ),
    (
        "[surfaces.s]\nkind = 'bezier'\npoints = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\nweights = [[1,1,1],[1,1,1]]",
        (5, 11),
        &["surface `s`", "2 × 3", "2 × 2"],
        "one weight for each point",
    ),
    (
        "[curves.c]\nkind = 'nurbs'\ndegree = 1.5\npoints = [[0,0,0],[1,0,0]]",
        (4, 10),
        &["degree", "1.5"],
        "whole number",
    ),
    // Numbers.
    (
        "[curves.c]\nkind = 'line'\nfrom = [0,nan,0]\nto = [1,0,0]",
        (4, 11),
        &["curve `c`", "from.y", "NaN"],
        "finite",
    ),
    (
        "[curves.c]\nkind = 'line'\nfrom = [0,0,0]\nto = [1,0,-inf]",
        (5, 11),
        &["curve `c`", "to.z", "inf"],
        "finite",
    ),
    (
        "[curves.c]\nkind = 'line'\nfrom = [0,0,0]\nto = [1,'exp(999)',0]",
        (5, 10),
        &["too large", "exp(999)"],
        "exponent",
    ),
    // Parameters.
    (
        "[params]\na = 'b'\nb = 'a + 1'",
        (3, 1),
        &["a → b → a"],
        "number",
    ),
    ("[params]\na = 'a'", (3, 1), &["a → a"], "number"),
    (
        "[params]\nradius = 1\nd = '2*radus'",
        (5 - 1, 8),
        &["parameter `d`", "radus"],
        "`radius`",
    ),
    ("[params]\na = 'sine(1)'", (3, 6), &["sine"], "`sin`"),
    (
        "[params]\na = { value = 5, max = 4 }",
        (3, 15),
        &["parameter `a`", "5", "4"],
        "at most 4",
    ),
    (
        "[params]\na = { min = 4 }",
        (3, 1),
        &["parameter `a`", "value"],
        "value",
    ),
    (
        "[params]\na = { value = 5, mix = 4 }",
        (3, 18),
        &["parameter `a`", "mix"],
        "`min`",
    ),
    (
        "[params]\ne = 2",
        (3, 1),
        &["`e`", "fixed meaning"],
        "another name",
    ),
    (
        "[params]\n'a b' = 2",
        (3, 1),
        &["a b", "not a name"],
        "letters",
    ),
    (
        "[params]\na = '1/(2-2)'",
        (3, 6),
        &["parameter `a`", "division by zero"],
        "zero",
    ),
    ("[params]\na = '(1'", (3, 6), &["not closed"], ")"),
    (
        "[params]\na = true",
        (3, 5),
        &["parameter `a`", "true"],
        "number",
    ),
    (
        "[curves.c]\nKIND = 'line'\nfrom = [0,0,0]\nto = [1,0,0]",
        (3, 1),
        &["curve `c`", "no key `KIND`"],
        "`kind`",
    ),
    // Sizes.
    (
        "[curves.c]\nkind = 'line'\nfrom = [0,1e31,0]\nto = [1,0,0]",
        (4, 11),
        &["curve `c`", "`from.y`", "1e31", "±1e30"],
        "larger unit",
    ),
    (
        "[params]\na = '10^200'",
        (3, 5),
        &["parameter `a`", "e200", "±1e30"],
        "smaller number",
    ),
];

#[test]
fn every_fault_has_its_place_its_numbers_and_its_remedy() {
    check(ROWS);
}

#[test]
fn the_version_is_asked_for() {
    for (text, words) in [
        ("", "`nappe = 1` is missing"),
        ("nappe = 2", "version 2"),
        ("nappe = 'x'", "version 1"),
    ] {
        let d = faults(text);
        assert!(d.list[0].message.contains(words), "{d}");
        assert!(
            d.list[0]
                .help
                .as_deref()
                .is_some_and(|h| h.contains("nappe = 1")),
            "{d}"
        );
    }
}

#[test]
fn several_faults_are_reported_in_one_run_in_the_order_of_the_file() {
    let d = faults(
        r#"nappe = 1
[params]
a = "b"
b = "a"
c = 1
[curves.one]
kind = "line"
from = [0, 0]
to = ["cc", 0, "1/0"]
[curves.two]
kind = "bezier"
points = [["a", 0, 0], [1, 0, 0]]
[curves.three]
kind = "reverse"
curve = "two"
[surfaces.four]
kind = "ruled"
south = "one"
north = "three"
[surfaces.five]
kind = "torus"
major = 1
minor = -1
"#,
    );
    let lines: Vec<usize> = d
        .list
        .iter()
        .map(|x| d.line_column(x.labels[0].span.start).0)
        .collect();
    assert_eq!(lines, [3, 8, 9, 9, 23], "{d}");
    // two uses a, three uses two, four uses one and three.
    assert_eq!(d.skipped, 3, "{d}");
    assert!(
        d.summary()
            .contains("5 errors; 3 objects were not built because they depend"),
        "{}",
        d.summary()
    );
}

#[test]
fn several_syntax_faults_are_reported_in_one_run() {
    let d = faults(
        "nappe = 1\ntitle = \"a\nunits = mm\n[curves.a]\nkind = 'line'\nfrom = [0,,0]\nbogus = 1\n",
    );
    let syntax: Vec<usize> = d
        .list
        .iter()
        .filter(|x| x.code == "syntax")
        .map(|x| d.line_column(x.labels[0].span.start).0)
        .collect();
    assert!(
        syntax.len() >= 3 && syntax.contains(&3) && syntax.contains(&6),
        "{d}"
    );
}

#[test]
fn overrides_that_fit_nothing_are_faults() {
    let text = "nappe = 1\n[params]\nradius = { value = 2, max = 3 }\n";
    let mut o = Overrides::default();
    o.set("radus", "3");
    let d = parse(text, "f", &o).unwrap_err();
    assert!(
        d.to_string().contains("no parameter `radus`") && d.to_string().contains("`radius`"),
        "{d}"
    );
    let mut o = Overrides::default();
    o.set("radius", "4");
    let d = parse(text, "f", &o).unwrap_err();
    assert!(
        d.to_string()
            .contains("is 4 (set on the command line), outside its range at most 3"),
        "{d}"
    );
    let mut o = Overrides::default();
    o.set("radius", "2*");
    assert!(
        parse(text, "f", &o)
            .unwrap_err()
            .to_string()
            .contains("f:3:1: parameter `radius` (set on the command line): ")
    );
}

#[test]
fn files_that_cannot_be_read_are_faults() {
    let missing = nappe_model::load(
        std::path::Path::new("no/such/file.nappe.toml"),
        &Overrides::default(),
    );
    let d = missing.expect_err("a file that is not there");
    assert!(
        d.to_string()
            .starts_with("no/such/file.nappe.toml: cannot be read"),
        "{d}"
    );
    let directory = nappe_model::load(std::path::Path::new("."), &Overrides::default());
    assert!(
        directory
            .expect_err("a directory")
            .to_string()
            .contains("is a directory")
    );
}
