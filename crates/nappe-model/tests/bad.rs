//! Every bad input: the place, the words and the remedy of its message.

use nappe_model::{Diagnostics, Overrides, RenderStyle, parse};

fn faults(text: &str) -> Diagnostics {
    match parse(text, "bad.nappe.toml", &Overrides::default()) {
        Err(d) => d,
        Ok(_) => panic!("accepted:\n{text}"),
    }
}

/// The text after `nappe = 1` (so its first line is line 2), the line and column of the message, words of the message,
/// and words of the remedy.
type Row = (
    &'static str,
    (usize, usize),
    &'static [&'static str],
    &'static str,
);

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
    // Weights and knots.
    (
        "[curves.c]\nkind = 'bezier'\npoints = [[0,0,0],[1,0,0],[2,1,0]]\nweights = [1, 0, 1]",
        (5, 15),
        &["curve `c`", "weight 1", "0"],
        "greater than 0",
    ),
    (
        "[surfaces.s]\nkind = 'bezier'\npoints = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\nweights = [[1,1],[1,-2]]",
        (5, 21),
        &["surface `s`", "weights[1][1]", "-2"],
        "greater than 0",
    ),
    (
        "[curves.c]\nkind = 'nurbs'\ndegree = 2\npoints = [[0,0,0],[1,0,0],[2,1,0],[3,0,0]]\nknots = [0,0,0,0.5,1,1]",
        (6, 9),
        &["curve `c`", "7 knots", "6 are given"],
        "points + degree + 1",
    ),
    (
        "[curves.c]\nkind = 'nurbs'\ndegree = 1\npoints = [[0,0,0],[1,0,0],[2,1,0],[3,0,0]]\nknots = [0,0,0.7,0.5,1,1]",
        (6, 18),
        &["curve `c`", "knot 3 is 0.5", "0.7"],
        "sort",
    ),
    (
        "[curves.c]\nkind = 'nurbs'\ndegree = 1\npoints = [[0,0,0],[1,0,0],[2,1,0],[3,0,0],[4,0,0]]\nknots = [0,0,0.5,0.5,0.5,1,1]",
        (6, 14),
        &["curve `c`", "0.5", "3 times"],
        "at most degree",
    ),
    (
        "[curves.c]\nkind = 'nurbs'\ndegree = 3\npoints = [[0,0,0],[1,0,0]]",
        (5, 10),
        &["curve `c`", "degree 3", "2"],
        "add points",
    ),
    (
        "[surfaces.s]\nkind = 'nurbs'\ndegree = [1,1]\npoints = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\nknots_v = [0,0,1]",
        (6, 11),
        &["surface `s`", "knots_v", "4 knots"],
        "points + degree + 1",
    ),
    (
        "[surfaces.s]\nkind = 'nurbs'\ndegree = [1,3]\npoints = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]",
        (4, 13),
        &["surface `s`", "2 columns", "degree 3"],
        "4 columns",
    ),
    // Angles.
    (
        "[curves.c]\nkind = 'arc'\ncenter = [0,0,0]\nradius = 1\nfrom = 45\nto = '90deg'",
        (6, 8),
        &["curve `c`", "from", "45", "no unit"],
        "45deg",
    ),
    (
        "[curves.c]\nkind = 'arc'\ncenter = [0,0,0]\nradius = 1\nfrom = '0deg'\nto = '90'",
        (7, 6),
        &["curve `c`", "to", "no unit"],
        "deg",
    ),
    (
        "[curves.c]\nkind = 'arc'\ncenter = [0,0,0]\nradius = -1\nfrom = '0deg'\nto = '90deg'",
        (5, 10),
        &["curve `c`", "semi-axis", "-1"],
        "greater than 0",
    ),
    (
        "[curves.c]\nkind = 'arc'\ncenter = [0,0,0]\nradius = 1\nfrom = '0deg'\nto = '400deg'",
        (7, 6),
        &["curve `c`", "full turn"],
        "one turn",
    ),
    (
        "[surfaces.s]\nkind = 'revolution'\nprofile = { kind = 'line', from = [1,0,0], to = [1,0,1] }\nangle = '400deg'",
        (5, 9),
        &["surface `s`", "400"],
        "360deg",
    ),
    // Revolution.
    (
        "[surfaces.s]\nkind = 'revolution'\nprofile = { kind = 'line', from = [1,0,0], to = [-1,0,1] }",
        (4, 11),
        &["surface `s`", "crosses the axis", "0.5"],
        "trim",
    ),
    (
        "[surfaces.s]\nkind = 'revolution'\nprofile = { kind = 'line', from = [0,0,0], to = [0,0,1] }",
        (4, 11),
        &["surface `s`", "axis"],
        "axis",
    ),
    (
        "[surfaces.s]\nkind = 'revolution'\nprofile = { kind = 'line', from = [1,0,0], to = [1,0,0] }",
        (4, 11),
        &["surface `s`", "single point"],
        "length",
    ),
    (
        "[surfaces.s]\nkind = 'revolution'\nprofile = { kind = 'line', from = [1,0,0], to = [1,0,1] }\nsection = { conic = -1 }",
        (5, 11),
        &["surface `s`", "mu is -1"],
        "conic",
    ),
    // Coons.
    (
        "[surfaces.s]\nkind = 'coons'\nsouth = { kind = 'line', from = [0,0,0], to = [1,0,0] }\nnorth = { kind = 'line', from = [0,1,0], to = [1,1,0.5] }\nwest = { kind = 'line', from = [0,0,0], to = [0,1,0] }\neast = { kind = 'line', from = [1,0,0], to = [1,1,0] }",
        (5, 9),
        &["surface `s`", "north", "east", "5.000000e-1"],
        "ends together",
    ),
    (
        "[surfaces.s]\nkind = 'coons'\nsouth = { kind = 'line', from = [0,0,0], to = [1,0,0] }\nnorth = { kind = 'line', from = [1,1,0], to = [0,1,0] }\nwest = { kind = 'line', from = [0,0,0], to = [0,1,0] }\neast = { kind = 'line', from = [1,0,0], to = [1,1,0] }",
        (5, 9),
        &["surface `s`", "reverse north"],
        "kind = \"reverse\"",
    ),
    (
        "[surfaces.s]\nkind = 'coons'\nsouth = { kind = 'line', from = [0,0,0], to = [1,0,0] }\nnorth = { kind = 'line', from = [0,1,0], to = [1,1,0] }\nwest = { kind = 'line', from = [0,0,0], to = [0,1,0] }\neast = { kind = 'line', from = [1,0,0], to = [1,1,0] }\nblend = { trigonometric = '179.9999999deg' }",
        (8, 9),
        &["surface `s`", "angle"],
        "180deg",
    ),
    (
        "[surfaces.s]\nkind = 'coons'\nsouth = { kind = 'line', from = [0,0,0], to = [1,0,0] }\nnorth = { kind = 'line', from = [0,1,0], to = [1,1,0] }\nwest = { kind = 'line', from = [0,0,0], to = [0,1,0] }\neast = { kind = 'line', from = [1,0,0], to = [1,1,0] }\nblend = { h1 = '1-t', h2 = 't', h3 = '0', h4 = 't' }",
        (8, 16),
        &["surface `s`", "h1'(0)"],
        "h1 is 1 at 0",
    ),
    (
        "[surfaces.s]\nkind = 'coons'\nsouth = { kind = 'line', from = [0,0,0], to = [1,0,0] }\nnorth = { kind = 'line', from = [0,1,0], to = [1,1,0] }\nwest = { kind = 'line', from = [0,0,0], to = [0,1,0] }\neast = { kind = 'line', from = [1,0,0], to = [1,1,0] }\ntwists = [[[0,0,1],[0,0,0]],[[0,0,0],[0,0,0]]]",
        (8, 10),
        &["surface `s`", "twists", "linear"],
        "cubic",
    ),
    // Diagonal-key: a parallelogram of corners whose guides differ.
    (
        "[surfaces.s]\nkind = 'diagonal-key'\nsouth = { kind = 'line', from = [0,0,0], to = [1,0,0] }\nnorth = { kind = 'line', from = [0,1,0], to = [1,1,0] }\nwest = { kind = 'line', from = [0,0,0], to = [0,1,0] }\neast = { kind = 'bezier', points = [[1,0,0], [1,0.5,1], [1,1,0]] }",
        (2, 11),
        &["surface `s`", "parallelogram"],
        "coons",
    ),
    (
        "[surfaces.s]\nkind = 'diagonal-key'\nsouth = { kind = 'line', from = [0,0,0], to = [0,1,0] }\nnorth = { kind = 'line', from = [1,0,0], to = [1,2,1] }\nwest = { kind = 'line', from = [0,0,0], to = [1,0,0] }\neast = { kind = 'line', from = [0,1,0], to = [1,2,1] }\np = '1 + v'",
        (8, 5),
        &["surface `s`", "p(0) is 1"],
        "v*(1 - v)",
    ),
    (
        "[surfaces.s]\nkind = 'diagonal-key'\nsouth = { kind = 'line', from = [0,0,0], to = [0,1,0] }\nnorth = { kind = 'line', from = [1,0,0], to = [1,2,1] }\nwest = { kind = 'line', from = [0,0,0], to = [1,0,0] }\neast = { kind = 'line', from = [0,1,0], to = [1,2,1] }\ngenerators = 'west-east'\ntangent_west = { kind = 'line', from = [0,1,0], to = [0,1,0] }",
        (9, 16),
        &["surface `s`", "`tangent_west` is on a generator"],
        "`tangent_south`",
    ),
    // Rational surfaces and fillets.
    (
        "[surfaces.s]\nkind = 'rational'\nbasis_u = ['1-t', 't']\nbasis_v = ['1-2*t', 't']\npoints = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]",
        (4, 11),
        &["surface `s`", "weight", "must be positive"],
        "sum to 1",
    ),
    (
        "[surfaces.s]\nkind = 'rational'\nbasis_u = ['1-t', 't', 't^2']\nbasis_v = ['1/t', 't']\npoints = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]",
        (4, 11),
        &["surface `s`", "3 functions", "2 rows"],
        "one function for each",
    ),
    (
        "[surfaces.s]\nkind = 'rational'\nbasis_u = ['1-t', 't']\nbasis_v = ['1', '1/t']\npoints = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]",
        (5, 17),
        &["surface `s`", "division by zero at t = 0"],
        "domain",
    ),
    (
        "[surfaces.a]\nkind = 'bilinear'\ncorners = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\n[surfaces.b]\nkind = 'bilinear'\ncorners = [[[0,0,0],[0,0,1]],[[1,0,0],[1,0,1]]]\n[surfaces.s]\nkind = 'fillet'\nbetween = ['a', 'b']\nradius = 3",
        (11, 10),
        &["surface `s`", "radius 3", "too large"],
        "lower the radius",
    ),
    (
        "[surfaces.a]\nkind = 'bilinear'\ncorners = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\n[surfaces.b]\nkind = 'bilinear'\ncorners = [[[0,0,1],[0,1,1]],[[1,0,1],[1,1,1]]]\n[surfaces.s]\nkind = 'fillet'\nbetween = ['a', 'b']\nradius = '0.1 + 1/(u-0.5)'",
        (11, 10),
        &["surface `s`", "division by zero at u = 0.5"],
        "domain",
    ),
    (
        "[surfaces.a]\nkind = 'bilinear'\ncorners = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\n[surfaces.b]\nkind = 'bilinear'\ncorners = [[[0,0,1],[0,1,1]],[[1,0,1],[1,1,1]]]\n[surfaces.s]\nkind = 'fillet'\nbetween = ['a', 'b']\nradius = 0.1",
        (10, 11),
        &["surface `s`", "parallel"],
        "angle",
    ),
    // A ball so large that rounding hides whether it fits: refused at once.
    (
        "[surfaces.a]\nkind = 'bilinear'\ncorners = [[[-30,0,0],[-30,30,0]],[[30,-30,0],[30,30,0]]]\n[surfaces.b]\nkind = 'quadric'\nshape = 'cylinder'\nsemi_axes = [8]\n[surfaces.s]\nkind = 'fillet'\nbetween = ['a', 'b']\nradius = 1e9",
        (12, 10),
        &["surface `s`", "radius 1000000000"],
        "smaller",
    ),
    // Quadrics and tori.
    (
        "[surfaces.s]\nkind = 'quadric'\nshape = 'sphere'\nsemi_axes = [1, 2]",
        (5, 13),
        &["surface `s`", "2 semi-axes"],
        "radius",
    ),
    (
        "[surfaces.s]\nkind = 'quadric'\nshape = 'cone'\nsemi_axes = [1, -2, 3]",
        (5, 17),
        &["semi-axis 1 is -2"],
        "greater than 0",
    ),
    (
        "[surfaces.s]\nkind = 'quadric'\nshape = 'con'\nsemi_axes = [1, 2, 3]",
        (4, 9),
        &["shape", "con"],
        "\"cone\"",
    ),
    (
        "[surfaces.s]\nkind = 'quadric'\nshape = 'sphere'\nsemi_axes = [1]\nrange = { u = [0, 1] }",
        (6, 16),
        &["surface `s`", "range.u", "angle"],
        "90deg",
    ),
    (
        "[surfaces.s]\nkind = 'torus'\nmajor = 3\nminor = 0",
        (5, 9),
        &["surface `s`", "minor", "0"],
        "greater than 0",
    ),
    // Collapsed surfaces.
    (
        "[surfaces.s]\nkind = 'bilinear'\ncorners = [[[1,2,3],[1,2,3]],[[1,2,3],[1,2,3]]]",
        (4, 11),
        &["surface `s`", "collapsed", "[1, 2, 3]"],
        "span",
    ),
    (
        "[curves.c]\nkind = 'line'\nfrom = [0,0,0]\nto = [1,0,0]\n[surfaces.s]\nkind = 'ruled'\nsouth = 'c'\nnorth = 'c'",
        (8, 9),
        &["surface `s`", "collapsed to a curve"],
        "span a surface",
    ),
    (
        "[surfaces.s]\nkind = 'transform'\nsurface = 't'\nscale = [1, 0, 1]\n[surfaces.t]\nkind = 'torus'\nmajor = 3\nminor = 1",
        (5, 9),
        &["surface `s`", "flattens"],
        "other than 0",
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
    // References.
    (
        "[surfaces.s]\nkind = 'revolution'\nprofile = 'profil'\n[curves.profile]\nkind = 'line'\nfrom = [1,0,0]\nto = [1,0,1]",
        (4, 11),
        &["surface `s`", "no curve `profil`"],
        "`profile`",
    ),
    (
        "[surfaces.s]\nkind = 'revolution'\nprofile = 't'\n[surfaces.t]\nkind = 'torus'\nmajor = 3\nminor = 1",
        (4, 11),
        &["surface `s`", "no curve `t`"],
        "\"t.south\"",
    ),
    (
        "[curves.c]\nkind = 'reverse'\ncurve = 't.sooth'\n[surfaces.t]\nkind = 'torus'\nmajor = 3\nminor = 1",
        (4, 12),
        &["curve `c`", "sooth"],
        "t.south",
    ),
    (
        "[curves.a]\nkind = 'reverse'\ncurve = 'b'\n[curves.b]\nkind = 'reverse'\ncurve = 'a'",
        (7, 9),
        &["curve `a` → curve `b` → curve `a`"],
        "points",
    ),
    (
        "[curves.a]\nkind = 'side'\nside = 's.south'\n[surfaces.s]\nkind = 'ruled'\nsouth = 'a'\nnorth = 'a'",
        (7, 9),
        &["curve `a` → surface `s` → curve `a`"],
        "points",
    ),
    (
        "[surfaces.s]\nkind = 'transform'\nsurface = 's'",
        (4, 11),
        &["surface `s` → surface `s`"],
        "points",
    ),
    // Expressions in t.
    (
        "[curves.c]\nkind = 'expression'\nx = '1/(t-0.5)'\ny = '0'\nz = '0'",
        (4, 5),
        &["curve `c`", "division by zero at t = 0.5"],
        "domain",
    ),
    (
        "[curves.c]\nkind = 'expression'\nx = 'u'\ny = '0'\nz = '0'",
        (4, 6),
        &["curve `c`", "`u`"],
        "`t`",
    ),
    (
        "[curves.c]\nkind = 'expression'\nx = 't'\ny = '0'\nz = '0'\ndomain = [1, 1]",
        (7, 10),
        &["curve `c`", "domain runs from 1 to 1"],
        "from < to",
    ),
    (
        "[curves.c]\nkind = 'expression'\nx = 't'\ny = 'sqrt(1-t)'\nz = '0'",
        (5, 5),
        &["curve `c`", "derivative is infinite at t = 1"],
        "parameter",
    ),
    // Other curves.
    (
        "[curves.c]\nkind = 'join'\ncurves = [{ kind = 'line', from = [0,0,0], to = [1,0,0] }, { kind = 'line', from = [1,0,2], to = [3,0,0] }]",
        (4, 60),
        &["curve `c`", "curve 0 ends at", "curve 1"],
        "together",
    ),
    (
        "[curves.c]\nkind = 'arc'\nthrough = [[0,0,0],[1,0,0],[2,0,0]]",
        (4, 20),
        &["curve `c`", "on one line"],
        "line",
    ),
    (
        "[curves.c]\nkind = 'trim'\ncurve = { kind = 'line', from = [0,0,0], to = [1,0,0] }\nfrom = 0.5\nto = 2",
        (6, 6),
        &["curve `c`", "0.5 to 2"],
        "parameters",
    ),
    (
        "[curves.c]\nkind = 'isocurve'\nsurface = 't'\nu = 7\n[surfaces.t]\nkind = 'torus'\nmajor = 3\nminor = 1",
        (5, 5),
        &["curve `c`", "7"],
        "parameter",
    ),
    (
        "[curves.c]\nkind = 'polyline'\npoints = [[0,0,0],[1,0,0],[1,0,0]]",
        (4, 27),
        &["curve `c`", "coincide"],
        "remove",
    ),
    // Joins and checks.
    (
        "[surfaces.j]\nkind = 'join'\nsurfaces = ['a', 'b']\n[surfaces.a]\nkind = 'bilinear'\ncorners = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\n[surfaces.b]\nkind = 'bilinear'\ncorners = [[[5,0,0],[5,1,0]],[[6,0,0],[6,1,0]]]",
        (4, 18),
        &["surface `j`", "b shares no side"],
        "same curve",
    ),
    (
        "[surfaces.j]\nkind = 'join'\nsurfaces = ['a', 'b']\n[surfaces.a]\nkind = 'bilinear'\ncorners = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\n[surfaces.b]\nkind = 'bilinear'\ncorners = [[[1,0,0],[1,1,0.001]],[[2,0,0],[2,1,0]]]",
        (4, 18),
        &["surface `j`", "a.east and b.west gap by 1.000000e-3"],
        "same curve",
    ),
    (
        "[[checks]]\nbetween = ['a.north', 'a.south']\ncontinuity = 'G1'\ntolerance = 0.1\n[surfaces.a]\nkind = 'torus'\nmajor = 3\nminor = 1",
        (5, 13),
        &["check 1", "no unit"],
        "0.1deg",
    ),
    (
        "[[checks]]\nbetween = ['b.north', 'a.south']\ncontinuity = 'G0'\ntolerance = 0.1\n[surfaces.a]\nkind = 'torus'\nmajor = 3\nminor = 1",
        (3, 12),
        &["check 1", "no surface `b`"],
        "surfaces are a",
    ),
    (
        "[[checks]]\nbetween = ['a.north']\ncontinuity = 'G3'",
        (2, 1),
        &["check 1", "tolerance"],
        "angle",
    ),
    (
        "[curves.c]\nkind = 'reverse'\ncurve = 's.south'\n[surfaces.s]\nkind = 'join'\nsurfaces = ['a', 'b']\n\
         [surfaces.a]\nkind = 'bilinear'\ncorners = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\n\
         [surfaces.b]\nkind = 'bilinear'\ncorners = [[[0,1,0],[0,2,0]],[[1,1,0],[1,2,0]]]",
        (4, 9),
        &["curve `c`", "2 surfaces"],
        "\"s/a\"",
    ),
];

#[test]
fn every_fault_has_its_place_its_numbers_and_its_remedy() {
    // All rows are tried, so that a change shows everything that it touches.
    let mut wrong = Vec::new();
    for (text, (line, column), words, remedy) in ROWS {
        let d = faults(&format!("nappe = 1\n{text}"));
        let place = format!("bad.nappe.toml:{line}:{column}");
        let at: Vec<_> = d.list.iter().filter(|x| d.place(x) == place).collect();
        let fits = at.iter().any(|x| {
            let help = x.help.as_deref().unwrap_or_default();
            words.iter().all(|w| x.message.contains(w)) && help.contains(remedy)
        });
        let helped = d
            .list
            .iter()
            .all(|x| x.help.as_ref().is_some_and(|h| !h.is_empty()));
        if !fits || !helped {
            wrong.push(format!(
                "expected {place} with {words:?} and {remedy:?}, got\n{d}\nin\n{text}\n"
            ));
        }
    }
    assert!(
        wrong.is_empty(),
        "{} rows:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
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
            .contains("f:3:1: parameter `radius`")
    );
}

#[test]
fn limits_are_said() {
    let mut many = String::from("nappe = 1\n[params]\n");
    for i in 0..=nappe_model::MAX_PARAMETERS {
        many += &format!("p{i} = {i}\n");
    }
    assert!(faults(&many).to_string().contains("at most 2000"));
    let mut deep =
        String::from("nappe = 1\n[curves.c0]\nkind = 'line'\nfrom = [0,0,0]\nto = [1,0,0]\n");
    for i in 1..500 {
        deep = format!(
            "{deep}[curves.c{i}]\nkind = 'reverse'\ncurve = 'c{}'\n",
            i + 1
        );
    }
    deep += "[curves.c500]\nkind = 'reverse'\ncurve = 'c0'\n";
    assert!(faults(&deep).to_string().contains("nested deeper than 64"));
    let nested = format!(
        "nappe = 1\n[curves]\na = {}1{}",
        "[".repeat(5000),
        "]".repeat(5000)
    );
    assert!(faults(&nested).has_errors());
    let chain: String = (0..1999)
        .map(|i| format!("p{i} = 'p{}'\n", i + 1))
        .collect();
    let model = parse(
        &format!("nappe = 1\n[params]\n{chain}p1999 = 7\n"),
        "f",
        &Overrides::default(),
    )
    .unwrap();
    assert!(model.params.iter().all(|p| p.value == 7.0));
}

#[test]
fn drawings_show_file_line_column_and_the_line() {
    let d = faults("nappe = 1\n[curves.c]\nkind = \"lime\"\n");
    let plain = d.render(RenderStyle::default());
    for words in [
        "bad.nappe.toml:3:8",
        "kind = \"lime\"",
        "there is no kind \"lime\"",
        "did you mean \"line\"?",
        "1 error",
    ] {
        assert!(plain.contains(words), "{words} in\n{plain}");
    }
    assert!(plain.is_ascii(), "{plain}");
    let color = d.render(RenderStyle {
        color: true,
        unicode: true,
        width: 60,
    });
    assert!(color.contains('\u{1b}') && color.contains('╭'));
    assert_eq!(
        plain,
        d.render(RenderStyle::default()),
        "the same input gives the same text"
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
