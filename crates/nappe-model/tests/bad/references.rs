//! References, joins and checks.

use crate::{Row, check};

const ROWS: &[Row] = &[
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
    // Near names are also those of parameters that failed themselves, or that come later.
    (
        "[params]\nradius = '1/0'\n[surfaces.s]\nkind = 'torus'\nmajor = 'radus'\nminor = 1",
        (6, 10),
        &["surface `s`", "there is no parameter or variable `radus`"],
        "did you mean `radius`?",
    ),
    (
        "[params]\nradius = 'heigth'\nheight = 3",
        (3, 11),
        &[
            "parameter `radius`",
            "there is no parameter or variable `heigth`",
        ],
        "did you mean `height`?",
    ),
    (
        "[params]\nradius = '1/0'\n[surfaces.s]\nkind = 'torus'\nmajor = 'width'\nminor = 1",
        (6, 10),
        &["there is no parameter or variable `width`"],
        "radius",
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
        &["surface `j`", "a.east and b.west gap by 0.001"],
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
    check(ROWS);
}
