//! Surfaces.

use crate::{Row, check};

const ROWS: &[Row] = &[
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
        "[surfaces.s]\nkind = 'revolution'\nprofile = { kind = 'polyline', points = [[1,0,0], [0,0,0], [0,0,1], [1,0,1]] }",
        (4, 11),
        &[
            "surface `s`",
            "lies on the axis from t = 0.3333",
            "to t = 0.6666",
        ],
        "leave out",
    ),
    (
        "[surfaces.s]\nkind = 'revolution'\nprofile = { kind = 'bezier', points = [[1,0,0], [-1.1,0,1], [1,0,2]] }",
        (4, 11),
        &[
            "surface `s`",
            "crosses the axis at t = 0.3908",
            "reaches 0.05",
        ],
        "trim",
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
        &["surface `s`", "north", "east", "0.5 apart"],
        "ends together",
    ),
    (
        "[surfaces.s]\nkind = 'coons'\nsouth = { kind = 'line', from = [0,0,0], to = [1,0,0] }\nnorth = { kind = 'line', from = [1,1,0], to = [0,1,0] }\nwest = { kind = 'line', from = [0,0,0], to = [0,1,0] }\neast = { kind = 'line', from = [1,0,0], to = [1,1,0] }",
        (5, 9),
        &["surface `s`", "reverse north"],
        "kind = \"reverse\"",
    ),
    (
        "[surfaces.s]\nkind = 'coons'\nsouth = { kind = 'line', from = [0,0,0], to = [1,0,0] }\nnorth = { kind = 'line', from = [0,1,0], to = [4,1,0] }\nwest = { kind = 'line', from = [0,1,0], to = [0,0,0] }\neast = { kind = 'line', from = [1,0,0], to = [1,1,0] }",
        (6, 8),
        &[
            "south-west",
            "north-west",
            "north-east",
            "reverse west, which leaves a gap of 3",
        ],
        "reverse west",
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
    // Second derivatives without quintic blending, against the boundary, and against the estimates.
    (
        "[surfaces.s]\nkind = 'coons'\nsouth = { kind = 'line', from = [0,0,0], to = [1,0,0] }\nnorth = { kind = 'line', from = [0,1,0], to = [1,1,0] }\nwest = { kind = 'line', from = [0,0,0], to = [0,1,0] }\neast = { kind = 'line', from = [1,0,0], to = [1,1,0] }\nblend = 'cubic'\nsecond = { west = { kind = 'line', from = [0,0,0], to = [0,0,0] } }",
        (9, 19),
        &["surface `s`", "second.west", "no second derivatives"],
        "blend = \"quintic\"",
    ),
    (
        "[surfaces.s]\nkind = 'coons'\nsouth = { kind = 'line', from = [0,0,0], to = [1,0,0] }\nnorth = { kind = 'line', from = [0,1,0], to = [1,1,0] }\nwest = { kind = 'line', from = [0,0,0], to = [0,1,0] }\neast = { kind = 'line', from = [1,0,0], to = [1,1,0] }\nblend = 'quintic'\nsecond = { west = { kind = 'line', from = [0,0,1], to = [0,0,0] } }",
        (4, 9),
        &["surface `s`", "second derivative along u", "second.west"],
        "second derivatives of the boundary curves",
    ),
    (
        "[surfaces.s]\nkind = 'coons'\nsouth = { kind = 'line', from = [0,0,0], to = [1,0,0] }\nnorth = { kind = 'line', from = [0,1,0], to = [1,1,0] }\nwest = { kind = 'line', from = [0,0,0], to = [0,1,0] }\neast = { kind = 'line', from = [1,0,0], to = [1,1,0] }\nblend = 'quintic'\nincompatible_twists = 'gregory'",
        (9, 23),
        &["surface `s`", "quintic", "Gregory"],
        "average",
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
    // Blends.
    (
        "[surfaces.a]\nkind = 'bilinear'\ncorners = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\n[surfaces.b]\nkind = 'quadric'\nshape = 'sphere'\nsemi_axes = [1]\ncenter = [0, 5, 0]\n[surfaces.s]\nkind = 'blend'\nbetween = ['a.north', 'a.north']",
        (12, 23),
        &["surface `s`", "same curve"],
        "room between",
    ),
    (
        "[surfaces.a]\nkind = 'bilinear'\ncorners = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\n[surfaces.b]\nkind = 'quadric'\nshape = 'sphere'\nsemi_axes = [1]\ncenter = [0, 5, 0]\n[surfaces.s]\nkind = 'blend'\nbetween = ['a.north', 'b.south']",
        (12, 23),
        &["surface `s`", "one point"],
        "G0",
    ),
    (
        "[surfaces.a]\nkind = 'bilinear'\ncorners = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\n[surfaces.b]\nkind = 'quadric'\nshape = 'sphere'\nsemi_axes = [1]\ncenter = [0, 5, 0]\n[surfaces.s]\nkind = 'blend'\nbetween = ['a.north', 'b.west']",
        (12, 23),
        &["surface `s`", "no tangent plane at 0 "],
        "smaller range",
    ),
    (
        "[surfaces.a]\nkind = 'bilinear'\ncorners = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\n[surfaces.b]\nkind = 'quadric'\nshape = 'sphere'\nsemi_axes = [1]\ncenter = [0, 5, 0]\n[surfaces.s]\nkind = 'blend'\nbetween = ['a.north', 'b.east']\nbulge = 0",
        (13, 9),
        &["surface `s`", "bulge is 0 at the first side"],
        "greater than 0",
    ),
    (
        "[surfaces.a]\nkind = 'bilinear'\ncorners = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\n[surfaces.b]\nkind = 'quadric'\nshape = 'sphere'\nsemi_axes = [1]\ncenter = [0, 5, 0]\n[surfaces.s]\nkind = 'blend'\nbetween = ['a.north', 'b.east']\nbulge = [1, -2]",
        (13, 13),
        &["surface `s`", "bulge is -2 at the second side"],
        "greater than 0",
    ),
    (
        "[surfaces.a]\nkind = 'bilinear'\ncorners = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\n[surfaces.b]\nkind = 'quadric'\nshape = 'sphere'\nsemi_axes = [1]\ncenter = [0, 5, 0]\n[surfaces.s]\nkind = 'blend'\nbetween = ['a.north', 'b.east']\ncontinuity = 'G3'",
        (13, 14),
        &["surface `s`", "\"G3\" is not one of G0, G1, G2"],
        "did you mean",
    ),
    (
        "[surfaces.a]\nkind = 'bilinear'\ncorners = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\n[surfaces.b]\nkind = 'quadric'\nshape = 'sphere'\nsemi_axes = [1]\ncenter = [0, 5, 0]\n[surfaces.s]\nkind = 'blend'\nbetween = ['a.north', 'a']",
        (12, 23),
        &["surface `s`", "expected a side"],
        "dome.south",
    ),
    (
        "[surfaces.a]\nkind = 'bilinear'\ncorners = [[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]]\n[surfaces.b]\nkind = 'quadric'\nshape = 'sphere'\nsemi_axes = [1]\ncenter = [0, 5, 0]\n[surfaces.s]\nkind = 'blend'\nbetween = ['s.north', 'a.south']",
        (12, 12),
        &["depend on each other: surface `s`"],
        "points",
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
    // Sizes.
    (
        "[surfaces.s]\nkind = 'torus'\nmajor = 1e-200\nminor = 1e-200",
        (4, 9),
        &["surface `s`", "too small", "1e-30"],
        "smaller unit",
    ),
    (
        "[surfaces.s]\nkind = 'transform'\nsurface = 'a'\nscale = 1e29\n[surfaces.a]\nkind = 'torus'\nmajor = 20\nminor = 7",
        (5, 9),
        &["surface `s`", "too large", "±1e30"],
        "larger unit",
    ),
    // Ranges point at the one that is wrong.
    (
        "[surfaces.s]\nkind = 'torus'\nmajor = 20\nminor = 7\nrange = { u = ['0deg', '90deg'], v = ['50deg', '10deg'] }",
        (6, 38),
        &["surface `s`", "range of v", "50", "10"],
        "one turn",
    ),
    (
        "[surfaces.s]\nkind = 'torus'\nmajor = 20\nminor = 7\nrange = { u = [5, '90deg'] }",
        (6, 16),
        &["surface `s`", "range.u[0]", "5 has no unit"],
        "5deg",
    ),
    (
        "[surfaces.s]\nkind = 'torus'\nmajor = 2\nminor = 7",
        (4, 9),
        &["surface `s`", "crosses the axis", "7", "2"],
        "raise `major`",
    ),
    // Nets without points.
    (
        "[surfaces.s]\nkind = 'bezier'\npoints = [[], [[0,0,0]]]",
        (4, 11),
        &["surface `s`", "`points`", "no entries"],
        "rows",
    ),
    (
        "[surfaces.s]\nkind = 'rational'\nbasis_u = ['1-t', 't']\nbasis_v = ['1-t', 't']\npoints = []",
        (6, 10),
        &["surface `s`", "`points`", "no entries"],
        "rows",
    ),
    (
        "[surfaces.s]\nkind = 'coons'\nsouth = { kind = 'line', from = [0,0,0], to = [1,0,0] }\nnorth = { kind = 'line', from = [0,1,0], to = [1,1,0] }\nwest = { kind = 'line', from = [0,0,0], to = [0,1,0] }\neast = { kind = 'line', from = [1,0,0], to = [1,1,0] }\ncross = 'adini'",
        (8, 9),
        &["surface `s`", "`cross`", "positions only"],
        "blend = \"cubic\"",
    ),
    (
        "[surfaces.s]\nkind = 'diagonal-key'\nsouth = { kind = 'line', from = [0,0,0], to = [1,0,0] }\nnorth = { kind = 'line', from = [0,1,0], to = [1,1,0] }\nwest = { kind = 'line', from = [0,0,0], to = [0,1,0] }\neast = { kind = 'line', from = [1,0,0], to = [1,1,0] }\nnormals = ['x', 'x']",
        (8, 11),
        &["surface `s`", "`normals`", "no `free`"],
        "remove normals",
    ),
];

#[test]
fn every_fault_has_its_place_its_numbers_and_its_remedy() {
    check(ROWS);
}
