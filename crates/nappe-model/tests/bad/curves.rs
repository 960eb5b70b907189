//! Curves.

use crate::{Row, check};

const ROWS: &[Row] = &[
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
        "[curves.c]\nkind = 'section'\nsurface = 't'\nnormal = 'x'\n[surfaces.t]\nkind = 'torus'\nmajor = 3\nminor = 1",
        (2, 9),
        &["curve `c`", "2 branches", "1 in u 0.25"],
        "branch = 1",
    ),
    (
        "[curves.c]\nkind = 'section'\nsurface = 't'\nnormal = 'x'\nbranch = 3\n[surfaces.t]\nkind = 'torus'\nmajor = 3\nminor = 1",
        (6, 10),
        &["curve `c`", "no branch 3", "2 branches"],
        "branch = 1",
    ),
    (
        "[curves.c]\nkind = 'section'\nsurface = 't'\norigin = [9, 0, 0]\nnormal = 'x'\n[surfaces.t]\nkind = 'torus'\nmajor = 3\nminor = 1",
        (2, 9),
        &["curve `c`", "no such curve"],
        "meets the surface",
    ),
    (
        "[curves.c]\nkind = 'trace'\nsurface = 't'\nf = 'u - u'\n[surfaces.t]\nkind = 'torus'\nmajor = 3\nminor = 1",
        (2, 9),
        &["curve `c`", "all over"],
        "elsewhere",
    ),
    (
        "[curves.c]\nkind = 'trace'\nsurface = 't'\nf = 'ln(-1 - u^2)'\n[surfaces.t]\nkind = 'torus'\nmajor = 3\nminor = 1",
        (5, 5),
        &["curve `c`", "no value anywhere"],
        "formula",
    ),
    (
        "[curves.c]\nkind = 'silhouette'\nsurface = 't'\ndirection = [0, 0, 0]\n[surfaces.t]\nkind = 'torus'\nmajor = 3\nminor = 1",
        (5, 13),
        &["curve `c`", "not zero"],
        "change it",
    ),
    (
        "[curves.c]\nkind = 'isophote'\nsurface = 't'\ndirection = 'z'\nangle = '200deg'\n[surfaces.t]\nkind = 'torus'\nmajor = 3\nminor = 1",
        (6, 9),
        &["curve `c`", "angle of the normal"],
        "change it",
    ),
    (
        "[curves.c]\nkind = 'section'\nsurface = 't'\nnormal = 'z'\ntolerance = -1\nbranch = 1\n[surfaces.t]\nkind = 'torus'\nmajor = 3\nminor = 1",
        (6, 13),
        &["curve `c`", "tolerance of the curve is -1"],
        "greater than 0",
    ),
    (
        "[curves.c]\nkind = 'intersection'\nsurfaces = ['t', 'p']\n[surfaces.t]\nkind = 'torus'\nmajor = 3\nminor = 1\n[surfaces.p]\nkind = 'bilinear'\ncorners = [[[-9, -9, 0.5], [-9, 9, 0.5]], [[9, -9, 0.5], [9, 9, 0.5]]]",
        (2, 9),
        &["curve `c`", "2 branches", "closed"],
        "branch = 1",
    ),
    (
        "[curves.c]\nkind = 'intersection'\nsurfaces = ['t', 'p']\nbranch = 3\n[surfaces.t]\nkind = 'torus'\nmajor = 3\nminor = 1\n[surfaces.p]\nkind = 'bilinear'\ncorners = [[[-9, -9, 0.5], [-9, 9, 0.5]], [[9, -9, 0.5], [9, 9, 0.5]]]",
        (5, 10),
        &["curve `c`", "no branch 3"],
        "branch = 1",
    ),
    (
        "[curves.c]\nkind = 'intersection'\nsurfaces = ['t', 'p']\n[surfaces.t]\nkind = 'torus'\nmajor = 3\nminor = 1\n[surfaces.p]\nkind = 'bilinear'\ncorners = [[[-9, -9, 5], [-9, 9, 5]], [[9, -9, 5], [9, 9, 5]]]",
        (2, 9),
        &["curve `c`", "no such curve of the two surfaces"],
        "meets",
    ),
    (
        "[curves.c]\nkind = 'intersection'\nsurfaces = ['t', 'p']\n[surfaces.t]\nkind = 'quadric'\nshape = 'sphere'\nsemi_axes = [2]\n[surfaces.p]\nkind = 'bilinear'\ncorners = [[[-9, -9, 2], [-9, 9, 2]], [[9, -9, 2], [9, 9, 2]]]",
        (2, 9),
        &["curve `c`", "no curve is proven", "may touch"],
        "meets",
    ),
    (
        "[curves.c]\nkind = 'intersection'\nsurfaces = ['t', 'q']\n[surfaces.t]\nkind = 'torus'\nmajor = 3\nminor = 1\n[surfaces.p]\nkind = 'bilinear'\ncorners = [[[-9, -9, 0.5], [-9, 9, 0.5]], [[9, -9, 0.5], [9, 9, 0.5]]]",
        (4, 18),
        &["curve `c`", "no surface `q`"],
        "surfaces are t, p",
    ),
    (
        "[curves.c]\nkind = 'intersection'\nsurfaces = ['t', 'p', 't']\n[surfaces.t]\nkind = 'torus'\nmajor = 3\nminor = 1\n[surfaces.p]\nkind = 'bilinear'\ncorners = [[[-9, -9, 0.5], [-9, 9, 0.5]], [[9, -9, 0.5], [9, 9, 0.5]]]",
        (4, 12),
        &["curve `c`", "surfaces", "2"],
        "",
    ),
    (
        "[curves.c]\nkind = 'intersection'\nsurfaces = ['t', 'p']\ntolerance = -1\nbranch = 1\n[surfaces.t]\nkind = 'torus'\nmajor = 3\nminor = 1\n[surfaces.p]\nkind = 'bilinear'\ncorners = [[[-9, -9, 0.5], [-9, 9, 0.5]], [[9, -9, 0.5], [9, 9, 0.5]]]",
        (5, 13),
        &["curve `c`", "tolerance of the curve is -1"],
        "greater than 0",
    ),
    (
        "[curves.c]\nkind = 'polyline'\npoints = [[0,0,0],[1,0,0],[1,0,0]]",
        (4, 27),
        &["curve `c`", "coincide"],
        "remove",
    ),
    (
        "[curves.c]\nkind = 'conic'\npoints = [[0,0,0],[1,0,0],[1,1,0]]\nweight = -1",
        (5, 10),
        &["curve `c`", "the weight is -1"],
        "greater than 0",
    ),
    (
        "[curves.c]\nkind = 'arc'\ncenter = [0,0,0]\nradius = 1\nfrom = '1e300deg'\nto = '10deg'",
        (6, 8),
        &["curve `c`", "`from`", "turns", "1000"],
        "whole turns",
    ),
    (
        "[curves.c]\nkind = 'expression'\nx = 'exp(100*t)'\ny = '0'\nz = 't'",
        (4, 5),
        &["curve `c`", "t = 1", "±1e30"],
        "smaller numbers",
    ),
];

#[test]
fn every_fault_has_its_place_its_numbers_and_its_remedy() {
    check(ROWS);
}
