//! Every kind of curve and surface, read from text and compared with closed forms.

mod imports;

use nappe::DVec3;
use nappe_model::{Model, Overrides, registry};
use std::sync::Arc;

/// Curves and surfaces that others refer to.
const SHARED: &str = r#"
nappe = 1
[params]
r = 2
[curves.floor_line]
kind = "line"
from = [1, 0, 0]
to = [3, 0, 4]
[curves.half_circle]
kind = "arc"
center = [0, 0, 0]
radius = 1
from = "0deg"
to = "180deg"
[surfaces.flat]
kind = "bilinear"
corners = [[[0, 0, 0], [0, 2, 0]], [[3, 0, 0], [3, 2, 0]]]
[surfaces.wall]
kind = "bilinear"
corners = [[[0, 0, 0], [0, 0, 2]], [[3, 0, 0], [3, 0, 2]]]
construction_only = true
"#;

fn read(text: &str) -> Model {
    let all = format!("{SHARED}\n{text}");
    let files = Arc::new(imports::Files);
    nappe_model::parse_with(&all, "test.nappe.toml", &Overrides::default(), files)
        .unwrap_or_else(|d| panic!("{d}\nin\n{text}"))
}

fn near(got: DVec3, want: [f64; 3], what: &str) {
    let want = DVec3::from_array(want);
    assert!(
        (got - want).length() <= 1e-13 * want.length().max(1.0),
        "{what}: {got}, not {want}"
    );
}

/// Kind, keys, and some parameters with their points.
type CurveRow = (&'static str, &'static str, &'static [(f64, [f64; 3])]);

const H: f64 = std::f64::consts::FRAC_1_SQRT_2;

const CURVES: &[CurveRow] = &[
    (
        "line",
        "from = [1, 2, 3]\nto = ['r', 2, 7]",
        &[(0.0, [1.0, 2.0, 3.0]), (0.5, [1.5, 2.0, 5.0])],
    ),
    (
        "polyline",
        "points = [[0, 0, 0], [3, 0, 0], [3, 1, 0]]",
        &[
            (0.0, [0.0; 3]),
            (0.75, [3.0, 0.0, 0.0]),
            (1.0, [3.0, 1.0, 0.0]),
        ],
    ),
    (
        "polyline",
        "points = [[0, 0, 0], [3, 0, 0], [3, 1, 0]]\nparametrization = 'uniform'",
        &[(0.5, [3.0, 0.0, 0.0])],
    ),
    (
        "bezier",
        "points = [[0, 0, 0], [1, 2, 0], [2, 0, 0]]",
        &[(0.5, [1.0, 1.0, 0.0])],
    ),
    (
        "bezier",
        "points = [[1, 0, 0], [1, 1, 0], [0, 1, 0]]\nweights = [1, 'sqrt(2)/2', 1]",
        &[(0.5, [H, H, 0.0])],
    ),
    (
        "nurbs",
        "degree = 2\npoints = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]\nknots = [0, 0, 0, 0.5, 1, 1, 1]",
        // The two pieces meet in the middle of the inner points.
        &[(0.5, [1.5, 0.0, 0.0])],
    ),
    (
        "nurbs",
        "degree = 1\npoints = [[0, 0, 0], [1, 0, 0], [1, 5, 0]]",
        &[(0.5, [1.0, 0.0, 0.0])],
    ),
    (
        "hermite",
        "from = [0, 0, 0]\nto = [1, 0, 0]\nfrom_tangent = [1, 4, 0]\nto_tangent = [1, 4, 0]",
        &[
            (0.5, [0.5, 0.0, 0.0]),
            (
                0.25,
                [0.25, 4.0 * (0.25 * 0.75 * 0.75 - 0.0625 * 0.75), 0.0],
            ),
        ],
    ),
    (
        "arc",
        "center = [1, 1, 0]\nradius = 'r'\nfrom = '0deg'\nto = '1/4 turn'",
        &[(0.0, [3.0, 1.0, 0.0]), (1.0, [1.0, 3.0, 0.0])],
    ),
    (
        "arc",
        "through = [[1, 0, 0], [0, 1, 0], [-1, 0, 0]]",
        &[(0.5, [0.0, 1.0, 0.0])],
    ),
    (
        "arc",
        "center = [0, 0, 0]\nradius = 1\nfrom = '0rad'\nto = '(pi/2) rad'\nnormal = 'y'\nx_direction = 'z'",
        &[(0.0, [0.0, 0.0, 1.0]), (1.0, [1.0, 0.0, 0.0])],
    ),
    (
        "circle",
        "radius = 3",
        &[
            (0.0, [3.0, 0.0, 0.0]),
            (0.25, [0.0, 3.0, 0.0]),
            (1.0, [3.0, 0.0, 0.0]),
        ],
    ),
    (
        "ellipse",
        "semi_axes = [3, 1]\nto = '90deg'",
        &[(0.0, [3.0, 0.0, 0.0]), (1.0, [0.0, 1.0, 0.0])],
    ),
    (
        "conic",
        "points = [[1, 0, 0], [1, 1, 0], [0, 1, 0]]\nweight = 1",
        &[(0.5, [0.75, 0.75, 0.0])],
    ),
    (
        "interpolate",
        "points = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]",
        &[(0.5, [1.5, 0.0, 0.0]), (1.0 / 3.0, [1.0, 0.0, 0.0])],
    ),
    (
        "interpolate",
        "points = [[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]]\nclosed = true",
        &[(0.25, [0.0, 1.0, 0.0]), (1.0, [1.0, 0.0, 0.0])],
    ),
    (
        "interpolate",
        "points = [[0, 0, 0], [1, 1, 0]]\nstart_tangent = [1, 0, 0]\nend_tangent = [1, 0, 0]",
        &[(0.5, [0.5, 0.5, 0.0])],
    ),
    (
        "expression",
        "x = 'r*cos(t)'\ny = 'r*sin(t)'\nz = 't'\ndomain = [0, 'tau']",
        &[
            (0.0, [2.0, 0.0, 0.0]),
            (std::f64::consts::PI, [-2.0, 0.0, std::f64::consts::PI]),
        ],
    ),
    (
        "expression",
        "x = 't'\ny = 0\nz = -1.5",
        &[(0.5, [0.5, 0.0, -1.5])],
    ),
    (
        "isocurve",
        "surface = 'flat'\nu = 0.5",
        &[(0.0, [1.5, 0.0, 0.0]), (1.0, [1.5, 2.0, 0.0])],
    ),
    (
        "isocurve",
        "surface = 'flat'\nv = 0.25",
        &[(1.0, [3.0, 0.5, 0.0])],
    ),
    (
        "side",
        "side = 'flat.north'",
        &[(0.0, [0.0, 2.0, 0.0]), (1.0, [3.0, 2.0, 0.0])],
    ),
    (
        "trace",
        "surface = 'flat'\nf = 'u - v'",
        &[(0.0, [3.0, 2.0, 0.0]), (0.5, [1.5, 1.0, 0.0])],
    ),
    (
        "section",
        "surface = 'flat'\norigin = [1.5, 0, 0]\nnormal = 'x'",
        &[(0.25, [1.5, 1.5, 0.0]), (1.0, [1.5, 0.0, 0.0])],
    ),
    (
        // Along the cross product of the normals.
        "intersection",
        "surfaces = ['flat', 'cut']\n[surfaces.cut]\nkind = 'bilinear'\ncorners = [[[1.5, -1, -1], [1.5, -1, 1]], [[1.5, 3, -1], [1.5, 3, 1]]]",
        &[(0.0, [1.5, 0.0, 0.0]), (1.0, [1.5, 2.0, 0.0])],
    ),
    (
        "silhouette",
        "surface = 'ring'\ndirection = 'z'\nbranch = 1\n[surfaces.ring]\nkind = 'torus'\nmajor = 3\nminor = 1",
        &[(0.0, [4.0, 0.0, 0.0]), (0.5, [-4.0, 0.0, 0.0])],
    ),
    (
        "isophote",
        "surface = 'ring'\ndirection = 'z'\nangle = '90deg'\nbranch = 2\n[surfaces.ring]\nkind = 'torus'\nmajor = 3\nminor = 1",
        &[(0.0, [2.0, 0.0, 0.0]), (0.5, [-2.0, 0.0, 0.0])],
    ),
    (
        // The circle on top, where the torus has no curvature along one direction.
        "isocurvature",
        "surface = 'ring'\ncurvature = 'gaussian'\nvalue = 0\nbranch = 1\n[surfaces.ring]\nkind = 'torus'\nmajor = 3\nminor = 1",
        &[(0.0, [3.0, 0.0, 1.0]), (0.5, [-3.0, 0.0, 1.0])],
    ),
    (
        "reverse",
        "curve = 'floor_line'",
        &[(0.0, [3.0, 0.0, 4.0]), (1.0, [1.0, 0.0, 0.0])],
    ),
    ("reverse", "curve = 'flat.east'", &[(0.0, [3.0, 2.0, 0.0])]),
    (
        "trim",
        "curve = 'floor_line'\nfrom = 0.25\nto = 0.75",
        &[(0.0, [1.5, 0.0, 1.0]), (1.0, [2.5, 0.0, 3.0])],
    ),
    (
        "trim",
        "curve = 'floor_line'\nto = 0.5",
        &[(1.0, [2.0, 0.0, 2.0])],
    ),
    (
        "join",
        "curves = ['floor_line', { kind = 'line', from = [3, 0, 4], to = [3, 0, 9] }]",
        &[
            (0.0, [1.0, 0.0, 0.0]),
            (0.5, [3.0, 0.0, 4.0]),
            (1.0, [3.0, 0.0, 9.0]),
        ],
    ),
    (
        "transform",
        "curve = 'floor_line'\nmirror = 'yz'\nscale = 2\nrotate = { axis = 'z', angle = '90deg' }\ntranslate = [0, 0, 1]",
        // (3, 0, 4) → mirrored (-3, 0, 4) → (-6, 0, 8) → turned (0, -6, 8) → moved (0, -6, 9)
        &[(1.0, [0.0, -6.0, 9.0])],
    ),
    (
        "transform",
        "curve = 'floor_line'\nmirror = { origin = [0, 0, 1], normal = [0, 0, 2] }\nscale = [1, 1, 3]",
        &[(0.0, [1.0, 0.0, 6.0])],
    ),
    (
        "import",
        // In centimetres, and the model in millimetres.
        "file = 'rods.cm'\ncurve = 2",
        &[(0.0, [0.0, 0.0, 0.0]), (1.0, [0.0, 30.0, 0.0])],
    ),
    (
        "import",
        "file = 'rods.mm'\ncurve = 'short'",
        &[(1.0, [2.0, 0.0, 0.0])],
    ),
];

#[test]
fn curves_are_what_they_say() {
    for kind in registry::CURVES {
        assert!(
            CURVES.iter().any(|row| row.0 == kind.name),
            "no snippet of the curve kind {}",
            kind.name
        );
    }
    for (kind, keys, points) in CURVES {
        let model = read(&format!("[curves.it]\nkind = '{kind}'\n{keys}"));
        let curve = &model.curve("it").expect("the curve").curve;
        for (t, want) in *points {
            near(curve.point(*t), *want, &format!("{kind} at {t}"));
        }
    }
}

type SurfaceRow = (&'static str, &'static str, &'static [([f64; 2], [f64; 3])]);

const SURFACES: &[SurfaceRow] = &[
    (
        "bilinear",
        // x = u(1-v), y = v, z = u
        "corners = [[[0, 0, 0], [0, 1, 0]], [[1, 0, 1], [0, 1, 1]]]",
        &[([0.25, 0.5], [0.125, 0.5, 0.25])],
    ),
    (
        "ruled",
        "south = 'floor_line'\nnorth = { kind = 'line', from = [1, 2, 0], to = [3, 2, 0] }",
        &[([1.0, 0.5], [3.0, 1.0, 2.0])],
    ),
    (
        "ruled",
        "west = 'flat.north'\neast = 'floor_line'",
        &[([0.0, 1.0], [3.0, 2.0, 0.0]), ([1.0, 0.0], [1.0, 0.0, 0.0])],
    ),
    (
        "coons",
        "south = 'flat.south'\nnorth = 'flat.north'\nwest = 'flat.west'\neast = 'flat.east'",
        &[([0.5, 0.5], [1.5, 1.0, 0.0])],
    ),
    (
        "coons",
        "south = 'flat.south'\nnorth = 'flat.north'\nwest = 'flat.west'\neast = 'flat.east'\nblend = 'cubic'\ncross = 'adini'",
        &[([0.25, 0.75], [0.75, 1.5, 0.0])],
    ),
    (
        "coons",
        "south = 'flat.north'\nnorth = { kind = 'line', from = [0, 4, 0], to = [3, 4, 0] }\nwest = { kind = 'line', from = [0, 2, 0], to = [0, 4, 0] }\neast = { kind = 'line', from = [3, 2, 0], to = [3, 4, 0] }\nblend = { trigonometric = '90deg' }\ncross = { south = { from = 'flat.north' }, north = 'ferguson' }",
        &[([1.0, 0.0], [3.0, 2.0, 0.0]), ([0.5, 1.0], [1.5, 4.0, 0.0])],
    ),
    (
        "coons",
        "south = 'flat.south'\nnorth = 'flat.north'\nwest = 'flat.west'\neast = 'flat.east'\nblend = { h1 = '2*t^3-3*t^2+1', h2 = 't^3-2*t^2+t', h3 = 't^3-t^2', h4 = '3*t^2-2*t^3' }\ntwists = [[[0, 0, 0], [0, 0, 0]], [[0, 0, 0], [0, 0, 0]]]",
        &[([0.5, 0.5], [1.5, 1.0, 0.0])],
    ),
    (
        "coons",
        "south = 'flat.south'\nnorth = 'flat.north'\nwest = 'flat.west'\neast = 'flat.east'\nblend = 'quintic'\ncross = 'adini'\nsecond = { south = { kind = 'bezier', points = [[0, 0, 0], [0, 0, 1], [0, 0, 0]] } }",
        // 2u(1-u) · v²(1-v)³/2
        &[([0.5, 0.5], [1.5, 1.0, 0.0078125])],
    ),
    (
        "coons",
        "south = 'flat.north'\nnorth = { kind = 'line', from = [0, 4, 0], to = [3, 4, 0] }\nwest = { kind = 'line', from = [0, 2, 0], to = [0, 4, 0] }\neast = { kind = 'line', from = [3, 2, 0], to = [3, 4, 0] }\nblend = 'quintic'\ncross = { south = { from = 'flat.north' }, north = 'adini' }",
        &[([0.25, 0.75], [0.75, 3.5, 0.0])],
    ),
    (
        "hermite",
        "corners = [[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0]]]\ntangents_u = [[[1, 0, 0], [1, 0, 0]], [[1, 0, 0], [1, 0, 0]]]\ntangents_v = [[[0, 1, 0], [0, 1, 0]], [[0, 1, 0], [0, 1, 0]]]\ntwists = [[[0, 0, 16], [0, 0, 0]], [[0, 0, 0], [0, 0, 0]]]",
        // H2(1/2)² · 16 = (1/8)² · 16
        &[([0.5, 0.5], [0.5, 0.5, 0.25])],
    ),
    (
        "bezier",
        "points = [[[0, 0, 0], [0, 1, 0]], [[1, 0, 4], [1, 1, 4]], [[2, 0, 0], [2, 1, 0]]]",
        &[([0.5, 0.5], [1.0, 0.5, 2.0])],
    ),
    (
        "bezier",
        "points = [[[1, 0, 0], [1, 0, 1]], [[1, 1, 0], [1, 1, 1]], [[0, 1, 0], [0, 1, 1]]]\nweights = [[1, 1], ['sqrt(2)/2', 'sqrt(2)/2'], [1, 1]]",
        &[([0.5, 1.0], [H, H, 1.0])],
    ),
    (
        "biquadratic",
        "points = [[[0, 0, 0], [0, 1, 0], [0, 2, 0]], [[1, 0, 0], [1, 1, 4], [1, 2, 0]], [[2, 0, 0], [2, 1, 0], [2, 2, 0]]]\nweight_u = 1\nweight_v = 1",
        &[([0.5, 0.5], [1.0, 1.0, 1.0])],
    ),
    (
        "nurbs",
        "degree = [1, 1]\npoints = [[[0, 0, 0], [0, 1, 0]], [[1, 0, 5], [1, 1, 5]], [[2, 0, 0], [2, 1, 0]]]",
        &[([0.5, 0.5], [1.0, 0.5, 5.0])],
    ),
    (
        "nurbs",
        "degree = [1, 1]\npoints = [[[0, 0, 0], [0, 1, 0]], [[1, 0, 5], [1, 1, 5]], [[2, 0, 0], [2, 1, 0]]]\nknots_u = [0, 0, 0.25, 1, 1]\nknots_v = [0, 0, 2, 2]\nweights = [[1, 1], [1, 1], [1, 1]]",
        &[([0.25, 2.0], [1.0, 1.0, 5.0])],
    ),
    (
        "revolution",
        "profile = 'floor_line'",
        &[
            ([0.0, 0.25], [0.0, 1.0, 0.0]),
            ([1.0, 0.5], [-3.0, 0.0, 4.0]),
        ],
    ),
    (
        "revolution",
        "profile = 'floor_line'\naxis = { origin = [0, 0, 0], direction = [0, 0, -1] }\nangle = '90deg'\nstart = '90deg'",
        &[
            ([0.0, 0.0], [0.0, -1.0, 0.0]),
            ([0.0, 1.0], [-1.0, 0.0, 0.0]),
        ],
    ),
    (
        "revolution",
        "profile = 'floor_line'\nangle = '90deg'\nconstruction = 'rational'",
        &[([0.0, 0.5], [H, H, 0.0])],
    ),
    (
        "revolution",
        "profile = 'floor_line'\nangle = '90deg'\nconstruction = 'coons'",
        &[([0.0, 0.5], [H, H, 0.0]), ([0.5, 1.0], [0.0, 2.0, 2.0])],
    ),
    (
        "revolution",
        "profile = 'floor_line'\nsection = { conic = 1 }",
        // The parabola: P0/4 + P1/2 + P2/4.
        &[([0.0, 0.5], [0.75, 0.75, 0.0])],
    ),
    (
        "quadric",
        "shape = 'sphere'\nsemi_axes = [2]\ncenter = [0, 0, 1]",
        &[([0.0, 0.5], [2.0, 0.0, 1.0]), ([0.5, 1.0], [0.0, 0.0, 3.0])],
    ),
    (
        "quadric",
        "shape = 'ellipsoid'\nsemi_axes = [3, 2, 1]\nrange = { u = ['0deg', '90deg'], v = ['0deg', '90deg'] }",
        &[
            ([0.0, 0.0], [3.0, 0.0, 0.0]),
            ([1.0, 0.0], [0.0, 2.0, 0.0]),
            ([0.0, 1.0], [0.0, 0.0, 1.0]),
        ],
    ),
    (
        "quadric",
        "shape = 'cylinder'\nsemi_axes = [2]\nrange = { u = ['0deg', '90deg'], v = [0, 5] }\nframe = { x = 'y', z = 'x' }",
        &[([0.0, 0.0], [0.0, 2.0, 0.0]), ([1.0, 1.0], [5.0, 0.0, 2.0])],
    ),
    (
        "torus",
        "major = 3\nminor = 1",
        &[
            ([0.0, 0.0], [4.0, 0.0, 0.0]),
            ([0.5, 0.0], [-4.0, 0.0, 0.0]),
        ],
    ),
    (
        "torus",
        "major = 3\nminor = 1\naxis = 'z'\ncenter = [0, 0, 1]\nrange = { u = ['0deg', '90deg'], v = ['0deg', '90deg'] }",
        &[([0.0, 1.0], [3.0, 0.0, 2.0]), ([1.0, 0.0], [0.0, 4.0, 1.0])],
    ),
    (
        "diagonal-key",
        // Guides that are translates of each other: the operator is v times the identity.
        "south = 'flat.south'\nnorth = 'flat.north'\nwest = 'flat.west'\neast = 'flat.east'",
        &[([0.5, 0.5], [1.5, 1.0, 0.0])],
    ),
    (
        "diagonal-key",
        // The same contour with generators and guides exchanged.
        "south = 'flat.south'\nnorth = 'flat.north'\nwest = 'flat.west'\neast = 'flat.east'\ngenerators = 'west-east'",
        &[([0.5, 0.25], [1.5, 0.5, 0.0])],
    ),
    (
        "diagonal-key",
        "south = { kind = 'line', from = [0, 0, 0], to = [0, 1, 0] }\nnorth = { kind = 'line', from = [1, 0, 0], to = [1, 2, 0] }\nwest = { kind = 'line', from = [0, 0, 0], to = [1, 0, 0] }\neast = { kind = 'line', from = [0, 1, 0], to = [1, 2, 0] }\nq = '4*v*(1-v)'",
        // Straight generators: the free part vanishes on their common direction d11.
        &[([0.5, 0.5], [0.5, 0.75, 0.0])],
    ),
    (
        "transform",
        "surface = 'flat'\nrotate = { axis = { origin = [0, 0, 1], direction = 'x' }, angle = '90deg' }",
        // (3, 2, 0) is (3, 2, -1) from the axis, turned (3, 1, 2), back (3, 1, 3).
        &[([1.0, 1.0], [3.0, 1.0, 3.0])],
    ),
    (
        "rational",
        "basis_u = ['(1-t)^2', '2*t*(1-t)', 't^2']\nbasis_v = ['1-t', 't']\npoints = [[[1, 0, 0], [1, 0, 1]], [[1, 1, 0], [1, 1, 1]], [[0, 1, 0], [0, 1, 1]]]\nweights = [[1, 1], ['sqrt(2)/2', 'sqrt(2)/2'], [1, 1]]",
        &[([0.5, 1.0], [H, H, 1.0])],
    ),
    (
        "fillet",
        // The planes z = 0 and y = 0: the middle of the arc is r (1 - 1/√2) from both, and u runs along z × y.
        "between = ['flat', 'wall']\nradius = 0.5",
        &[([1.0, 0.5], [0.0, 0.5 - 0.5 * H, 0.5 - 0.5 * H])],
    ),
    (
        "blend",
        // From (0, 2, 0) along y to (0, 0, 2) against z: the sides are √8 apart, and so long are the tangents; the
        // quintic Hermite functions of the slopes are ±5/32 in the middle.
        "between = ['flat.north', 'wall.north']",
        &[([0.5, 0.5], [1.5, 1.0 + 0.625 * H, 1.0 + 0.625 * H])],
    ),
    (
        "blend",
        // The cubic ones are ±1/8; the tangent at the second side is half as long.
        "between = ['flat.north', 'wall.north']\ncontinuity = 'G1'\nbulge = [1, 0.5]\nreverse = false",
        &[([0.5, 0.5], [1.5, 1.0 + 0.5 * H, 1.0 + 0.25 * H])],
    ),
    (
        "blend",
        "between = ['flat.north', 'wall.north']\ncontinuity = ['G0', 'G0']\nreverse = true",
        &[([0.0, 0.75], [2.25, 0.5, 1.5])],
    ),
    ("join", "surfaces = ['flat']", &[]),
    (
        "import",
        "file = 'plates.cm'\nface = 'whole'",
        &[
            ([1.0, 0.0], [10.0, 0.0, 0.0]),
            ([0.0, 1.0], [0.0, 20.0, 0.0]),
        ],
    ),
    (
        "import",
        // Its normal is the opposite of its surface's: u and v are exchanged.
        "file = 'plates.mm'\nface = 2\nuntrimmed = true",
        &[([1.0, 0.0], [0.0, 2.0, 0.0]), ([0.0, 1.0], [1.0, 0.0, 0.0])],
    ),
];

#[test]
fn surfaces_are_what_they_say() {
    for kind in registry::SURFACES {
        assert!(
            SURFACES.iter().any(|row| row.0 == kind.name),
            "no snippet of the surface kind {}",
            kind.name
        );
    }
    for (kind, keys, points) in SURFACES {
        let model = read(&format!("[surfaces.it]\nkind = '{kind}'\n{keys}"));
        if points.is_empty() {
            continue;
        }
        let surface = &model.surface("it").expect("the surface").surface;
        for (uv, want) in *points {
            near(
                surface.point(*uv),
                *want,
                &format!("{kind} at {uv:?}\n{keys}"),
            );
        }
    }
}

#[test]
fn chashnikovs_construction_is_the_surface_of_revolution() {
    let profile = "{ kind = 'interpolate', points = [[14, 0, 0], [20, 1, 9], [11, 0, 22]] }";
    let model = read(&format!(
        "[surfaces.a]\nkind = 'revolution'\nprofile = {profile}\nconstruction = 'coons'\n\
         [surfaces.b]\nkind = 'revolution'\nprofile = {profile}"
    ));
    let names: Vec<&str> = model.surfaces.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["flat", "wall", "a", "b"]);
    let [sectors, turned] = ["a", "b"].map(|name| &model.surface(name).unwrap().surface);
    for i in 0..=8 {
        for j in 0..=32 {
            let uv = [f64::from(i) / 8.0, f64::from(j) / 32.0];
            let (p, q) = (sectors.point(uv), turned.point(uv));
            assert!((p - q).length() < 1e-12, "{p} {q} at {uv:?}");
        }
    }
}

#[test]
fn header_parameters_and_overrides() {
    let text = r#"
nappe = 1
title = "Fairing"
units = "in"
tolerance = "waist/100"
[params]
waist = "radius * 0.6"
radius = 20
height = { value = "radius + 15", min = 10, max = "2*radius + 10", doc = "from the flange to the tip" }
[curves.a]
kind = "line"
from = [0, 0, 0]
to = ["waist", "height", 0]
construction_only = true
"#;
    let model = nappe_model::parse(text, "f", &Overrides::default()).unwrap();
    assert_eq!(
        (model.title.as_str(), model.units.symbol(), model.tolerance),
        ("Fairing", "in", Some(0.12))
    );
    let values: Vec<(&str, f64)> = model
        .params
        .iter()
        .map(|p| (p.name.as_str(), p.value))
        .collect();
    assert_eq!(
        values,
        [("waist", 12.0), ("radius", 20.0), ("height", 35.0)]
    );
    assert_eq!(
        (model.params[2].min, model.params[2].max),
        (Some(10.0), Some(50.0))
    );
    assert_eq!(
        model.params[2].doc.as_deref(),
        Some("from the flange to the tip")
    );
    assert!(model.curves[0].construction_only);
    let mut overrides = Overrides::default();
    overrides.set_from("radius=10*3").unwrap();
    overrides.set_from("height = waist*2").unwrap();
    let model = nappe_model::parse(text, "f", &overrides).unwrap();
    near(
        model.curves[0].curve.point(1.0),
        [18.0, 36.0, 0.0],
        "overrides",
    );
    assert!(overrides.set_from("radius").is_err() && overrides.set_from("=3").is_err());
}

#[test]
fn joins_keep_their_members_and_transform_as_a_whole() {
    let model = read(
        r#"
[surfaces.next]
kind = "ruled"
south = "flat.north"
north = { kind = "transform", curve = "flat.north", translate = [0, 1, 1] }
[surfaces.both]
kind = "join"
surfaces = ["flat", "next"]
[surfaces.moved]
kind = "transform"
surface = "both"
translate = [0, 0, 10]
[[checks]]
between = ["flat.north", "next.south"]
continuity = "G0"
tolerance = 1e-9
[[checks]]
between = ["moved/flat.north", "moved/next.south"]
continuity = "G1"
tolerance = "50deg"
"#,
    );
    let names: Vec<&str> = model.surfaces.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["flat", "wall", "next", "moved/flat", "moved/next"]);
    assert_eq!(model.joins[0].members, ["flat", "next"]);
    near(
        model
            .surface("moved/next")
            .unwrap()
            .surface
            .point([1.0, 1.0]),
        [3.0, 3.0, 11.0],
        "moved",
    );
    assert_eq!(model.checks.len(), 2);
    assert_eq!(model.checks[1].between[0].surface, "moved/flat");
    assert_eq!(
        model.checks[1].tolerance,
        nappe_model::CheckTolerance::Angle(50f64.to_radians())
    );
}

#[test]
fn nets_are_kept_for_pictures() {
    let model = read("[surfaces.it]\nkind = 'transform'\nsurface = 'flat'\ntranslate = [1, 0, 0]");
    let net = model.surface("it").unwrap().control_net.as_ref().unwrap();
    assert_eq!(net[1][1], DVec3::new(4.0, 2.0, 0.0));
}
