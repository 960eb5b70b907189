//! One snippet for each kind.

/// What the page begins with.
pub(crate) const WHOLE: &str = r#"nappe = 1                     # the version of the format
title = "Bowl"
units = "mm"
tolerance = 0.01              # the greatest distance of a mesh from the surface

[params]
radius = { value = 60, min = 10, max = 200, doc = "at the brim" }
depth  = "0.7 * radius"

[curves.profile]
kind = "bezier"
points = [["radius", 0, "depth"], ["radius", 0, "0.1*radius"], [0, 0, 0]]

[surfaces.bowl]
kind = "revolution"
profile = "profile"

[surfaces.table]
kind = "bilinear"
corners = [[[-100, -100, 0], [-100, 100, 0]], [[100, -100, 0], [100, 100, 0]]]

[[checks]]
between = ["bowl.south", "bowl.north"]
continuity = "G1"
tolerance = "0.1deg"
"#;

/// What the snippets may refer to.
pub(crate) const SETTING: &str = r#"
[curves]
a = { kind = "line", from = [0, 0, 0], to = [10, 0, 0] }
b = { kind = "bezier", points = [[0, 10, 0], [5, 10, 6], [10, 10, 2]] }
c = { kind = "bezier", points = [[0, 0, 0], [0, 5, 3], [0, 10, 0]] }
d = { kind = "line", from = [10, 0, 0], to = [10, 10, 2] }

[surfaces]
floor = { kind = "bilinear", corners = [[[0, 0, 0], [0, 40, 0]], [[60, 0, 0], [60, 40, 0]]] }
wall = { kind = "bilinear", corners = [[[0, 40, 0], [0, 40, 40]], [[60, 40, 0], [60, 40, 40]]] }
"#;

/// The snippet of a kind.
pub(crate) fn of(table: &str, kind: &str) -> &'static str {
    let list = if table == "curves" { CURVES } else { SURFACES };
    list.iter()
        .find(|(name, _)| *name == kind)
        .unwrap_or_else(|| panic!("{table}: no snippet for {kind}"))
        .1
}

const CURVES: &[(&str, &str)] = &[
    (
        "line",
        "[curves.edge]\nkind = \"line\"\nfrom = [0, 0, 0]\nto = [100, 0, 20]\n",
    ),
    (
        "polyline",
        "[curves.zigzag]\nkind = \"polyline\"\npoints = [[0, 0, 0], [10, 5, 0], [20, 0, 0]]\n",
    ),
    (
        "bezier",
        "[curves.quarter]\nkind = \"bezier\"\npoints = [[1, 0, 0], [1, 1, 0], [0, 1, 0]]\nweights = [1, \"sqrt(2)/2\", 1]\n",
    ),
    (
        "nurbs",
        "[curves.rail]\nkind = \"nurbs\"\ndegree = 3\npoints = [[0, 0, 0], [10, 0, 5], [20, 5, 5], [30, 5, 0], [40, 0, 0]]\nknots = [0, 0, 0, 0, 0.5, 1, 1, 1, 1]\n",
    ),
    (
        "hermite",
        "[curves.bend]\nkind = \"hermite\"\nfrom = [0, 0, 0]\nto = [40, 0, 40]\nfrom_tangent = [60, 0, 0]\nto_tangent = [0, 0, 60]\n",
    ),
    (
        "arc",
        "[curves.arch]\nkind = \"arc\"\ncenter = [0, 0, 0]\nradius = 20\nfrom = \"0deg\"\nto = \"180deg\"\nnormal = \"y\"\n",
    ),
    (
        "circle",
        "[curves.hole]\nkind = \"circle\"\ncenter = [10, 10, 0]\nradius = 4\n",
    ),
    (
        "ellipse",
        "[curves.oval]\nkind = \"ellipse\"\nsemi_axes = [12, 8]\nto = \"90deg\"\n",
    ),
    (
        "conic",
        "[curves.shoulder]\nkind = \"conic\"\npoints = [[10, 0, 0], [10, 0, 10], [0, 0, 10]]\nweight = 0.6\n",
    ),
    (
        "interpolate",
        "[curves.wall_line]\nkind = \"interpolate\"\npoints = [[14, 0, 0], [20, 0, 9], [11, 0, 22], [13, 0, 42]]\nstart_tangent = [0, 0, 40]\n",
    ),
    (
        "expression",
        "[curves.helix]\nkind = \"expression\"\nx = \"10*cos(t)\"\ny = \"10*sin(t)\"\nz = \"2*t\"\ndomain = [0, \"2*tau\"]\n",
    ),
    (
        "isocurve",
        "[curves.middle]\nkind = \"isocurve\"\nsurface = \"floor\"\nu = 0.5\n",
    ),
    (
        "trace",
        "[curves.oval]\nkind = \"trace\"\nsurface = \"floor\"\nf = \"(u - 0.5)^2 + 2*(v - 0.5)^2 - 0.1\"\n",
    ),
    (
        "section",
        "[surfaces.bead]\nkind = \"quadric\"\nshape = \"sphere\"\nsemi_axes = [2]\n\n[curves.parallel]\nkind = \"section\"\nsurface = \"bead\"\n\
         origin = [0, 0, 0.8]\nnormal = \"z\"\n",
    ),
    (
        "silhouette",
        "[surfaces.bead]\nkind = \"quadric\"\nshape = \"sphere\"\nsemi_axes = [2]\n\n[curves.contour]\nkind = \"silhouette\"\nsurface = \"bead\"\n\
         direction = [1, 2, 5]\n",
    ),
    (
        "isophote",
        "[surfaces.bead]\nkind = \"quadric\"\nshape = \"sphere\"\nsemi_axes = [2]\n\n[curves.lit]\nkind = \"isophote\"\nsurface = \"bead\"\n\
         direction = [1, 2, 5]\nangle = \"40deg\"\n",
    ),
    (
        "isocurvature",
        "[surfaces.ring]\nkind = \"torus\"\nmajor = 3\nminor = 1\n\n[curves.top]\nkind = \"isocurvature\"\nsurface = \"ring\"\n\
         curvature = \"gaussian\"\nvalue = 0\nbranch = 1\n",
    ),
    (
        "intersection",
        "[surfaces.ring]\nkind = \"torus\"\nmajor = 3\nminor = 1\n\n[surfaces.sheet]\nkind = \"bilinear\"\n\
         corners = [[[2, -1, 0.3], [2, 1, 0.3]], [[3, -1, 0.3], [3, 1, 0.4]]]\n\n[curves.seam]\nkind = \"intersection\"\n\
         surfaces = [\"ring\", \"sheet\"]\n",
    ),
    (
        "side",
        "[curves.border]\nkind = \"side\"\nside = \"floor.north\"\n",
    ),
    (
        "reverse",
        "[curves.back]\nkind = \"reverse\"\ncurve = \"a\"\n",
    ),
    (
        "trim",
        "[curves.first_half]\nkind = \"trim\"\ncurve = \"b\"\nto = 0.5\n",
    ),
    (
        "join",
        "[curves.around]\nkind = \"join\"\ncurves = [\"a\", \"d\"]\n",
    ),
    (
        "transform",
        "[curves.raised]\nkind = \"transform\"\ncurve = \"b\"\nrotate = { axis = \"z\", angle = \"30deg\" }\ntranslate = [0, 0, 15]\n",
    ),
    (
        "import",
        "[curves.keel]\nkind = \"import\"\nfile = \"boat.iges\"\ncurve = \"keel\"\n",
    ),
];

const SURFACES: &[(&str, &str)] = &[
    (
        "bilinear",
        "[surfaces.saddle]\nkind = \"bilinear\"\ncorners = [[[0, 0, 0], [0, 1, 0]], [[1, 0, 1], [0, 1, 1]]]\n",
    ),
    (
        "ruled",
        "[surfaces.strip]\nkind = \"ruled\"\nsouth = \"a\"\nnorth = \"b\"\n",
    ),
    (
        "coons",
        "[surfaces.panel]\nkind = \"coons\"\nsouth = \"a\"\nnorth = \"b\"\nwest = \"c\"\neast = \"d\"\nblend = \"cubic\"\ncross = \"adini\"\n",
    ),
    (
        "hermite",
        "[surfaces.patch]\nkind = \"hermite\"\ncorners    = [[[0, 0, 0], [0, 40, 0]], [[40, 0, 0], [40, 40, 0]]]\ntangents_u = [[[40, 0, 50], [40, 0, 30]], [[40, 0, -50], [40, 0, -30]]]\ntangents_v = [[[0, 40, 20], [0, 40, -20]], [[0, 40, 20], [0, 40, -20]]]\n",
    ),
    (
        "bezier",
        "[surfaces.cap]\nkind = \"bezier\"\npoints = [\n  [[0, 0, 0], [0, 5, 4], [0, 10, 0]],\n  [[10, 0, 4], [10, 5, 9], [10, 10, 4]],\n]\n",
    ),
    (
        "biquadratic",
        "[surfaces.octant]\nkind = \"biquadratic\"\npoints = [\n  [[1, 0, 0], [1, 1, 0], [0, 1, 0]],\n  [[1, 0, 1], [1, 1, 1], [0, 1, 1]],\n  [[0, 0, 1], [0, 0, 1], [0, 0, 1]],\n]\nweight_u = \"sqrt(2)/2\"\nweight_v = \"sqrt(2)/2\"\n",
    ),
    (
        "nurbs",
        "[surfaces.sheet]\nkind = \"nurbs\"\ndegree = [2, 1]\npoints = [\n  [[0, 0, 0], [0, 20, 0]],\n  [[10, 0, 8], [10, 20, 4]],\n  [[20, 0, 8], [20, 20, 4]],\n  [[30, 0, 0], [30, 20, 0]],\n]\n",
    ),
    (
        "rational",
        "[surfaces.vault]\nkind = \"rational\"\nbasis_u = [\"1 - sin(pi/2*t)\", \"sin(pi/2*t) + cos(pi/2*t) - 1\", \"1 - cos(pi/2*t)\"]\nbasis_v = [\"1 - t\", \"t\"]\npoints = [\n  [[30, 0, 0], [30, 60, 0]],\n  [[30, 0, 30], [30, 60, 30]],\n  [[0, 0, 30], [0, 60, 30]],\n]\n",
    ),
    (
        "revolution",
        "[surfaces.ring]\nkind = \"revolution\"\nprofile = { kind = \"arc\", center = [20, 0, 0], radius = 5, from = \"0deg\", to = \"180deg\", normal = \"y\" }\naxis = \"z\"\nangle = \"270deg\"\nconstruction = \"rational\"\n",
    ),
    (
        "quadric",
        "[surfaces.egg]\nkind = \"quadric\"\nshape = \"ellipsoid\"\nsemi_axes = [10, 7, 5]\ncenter = [0, 0, 5]\n",
    ),
    (
        "torus",
        "[surfaces.tyre]\nkind = \"torus\"\nmajor = 20\nminor = 7\nrange = { u = [\"0deg\", \"250deg\"] }\n",
    ),
    (
        "fillet",
        "[surfaces.seam]\nkind = \"fillet\"\nbetween = [\"floor\", \"wall\"]\nradius = \"8 + 4*u\"\n",
    ),
    (
        "blend",
        "[surfaces.shelf]\nkind = \"bilinear\"\ncorners = [[[0, 70, 15], [0, 90, 15]], [[60, 70, 25], [60, 90, 25]]]\n\n[surfaces.ramp]\nkind = \"blend\"\nbetween = [\"floor.north\", \"shelf.south\"]\ncontinuity = [\"G2\", \"G1\"]\nbulge = [1, 0.8]\n",
    ),
    (
        "diagonal-key",
        "[surfaces.key]\nkind = \"diagonal-key\"\nsouth = { kind = \"bezier\", points = [[0, 0, 0], [0, 12, 26], [0, 40, 4]] }\nnorth = { kind = \"bezier\", points = [[60, 4, 6], [60, 10, 2], [60, 34, 22]] }\nwest = { kind = \"bezier\", points = [[0, 0, 0], [30, 4, 12], [60, 4, 6]] }\neast = { kind = \"bezier\", points = [[0, 40, 4], [30, 46, 2], [60, 34, 22]] }\nq = \"2*v*(1 - v)\"\n",
    ),
    (
        "transform",
        "[surfaces.ceiling]\nkind = \"transform\"\nsurface = \"floor\"\nmirror = { origin = [0, 0, 20], normal = \"z\" }\n",
    ),
    (
        "join",
        "[surfaces.corner]\nkind = \"join\"\nsurfaces = [\"floor\", \"wall\"]\n",
    ),
    (
        "import",
        "[surfaces.hull]\nkind = \"import\"\nfile = \"boat.step\"\nface = \"hull\"\n",
    ),
];
