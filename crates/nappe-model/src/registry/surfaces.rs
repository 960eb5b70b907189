//! The kinds of surfaces.

use super::Need::{Form, Optional, Required};
use super::Shape::{self, *};
use super::shared::*;
use super::{Key, Kind};

const SIDES: [Key; 4] = [
    key("south", Curve, Required, "the side v = 0, along u"),
    key("north", Curve, Required, "the side v = 1, along u"),
    key("west", Curve, Required, "the side u = 0, along v"),
    key("east", Curve, Required, "the side u = 1, along v"),
];
const CROSS: Shape = Either(&[Choice(&["ferguson", "adini"]), Record(NEIGHBOUR), Curve]);
const CONTINUITY: Shape = Choice(&["G0", "G1", "G2"]);
const V_FORMULA: Shape = Formula(&["v"]);
const T_FORMULA: Shape = Formula(&["t"]);
const STITCH: Shape = Either(&[Record(NEIGHBOUR), Curve]);

/// All kinds of surfaces.
pub const SURFACES: &[Kind] = &[
    Kind {
        name: "bilinear",
        doc: "the bilinear surface of four corners",
        keys: &[key(
            "corners",
            CORNERS,
            Required,
            "[[P00, P01], [P10, P11]], the first index along u",
        )],
    },
    Kind {
        name: "ruled",
        doc: "straight lines between two curves",
        keys: &[
            key("south", Curve, Form(0), "the side v = 0, along u"),
            key("north", Curve, Form(0), "the side v = 1, along u"),
            key("west", Curve, Form(1), "the side u = 0, along v"),
            key("east", Curve, Form(1), "the side u = 1, along v"),
        ],
    },
    Kind {
        name: "coons",
        doc: "a surface on four boundary curves",
        keys: &[
            SIDES[0],
            SIDES[1],
            SIDES[2],
            SIDES[3],
            key(
                "blend",
                Either(&[
                    Choice(&["linear", "cubic", "quintic"]),
                    Record(&[key(
                        "trigonometric",
                        Angle,
                        Required,
                        "the angle α, more than 0 and less than 180deg",
                    )]),
                    Record(&[
                        key(
                            "h1",
                            T_FORMULA,
                            Required,
                            "1 at 0, flat at both ends, 0 at 1",
                        ),
                        key(
                            "h2",
                            T_FORMULA,
                            Required,
                            "slope 1 at 0, 0 and flat otherwise",
                        ),
                        key(
                            "h3",
                            T_FORMULA,
                            Required,
                            "slope 1 at 1, 0 and flat otherwise",
                        ),
                        key(
                            "h4",
                            T_FORMULA,
                            Required,
                            "1 at 1, flat at both ends, 0 at 0",
                        ),
                    ]),
                ]),
                Optional("linear"),
                "the blending functions",
            ),
            key(
                "cross",
                Either(&[
                    Choice(&["ferguson", "adini"]),
                    Record(&[
                        key(
                            "south",
                            CROSS,
                            Optional("estimated"),
                            "∂r/∂v on the side v = 0",
                        ),
                        key(
                            "north",
                            CROSS,
                            Optional("estimated"),
                            "∂r/∂v on the side v = 1",
                        ),
                        key(
                            "west",
                            CROSS,
                            Optional("estimated"),
                            "∂r/∂u on the side u = 0",
                        ),
                        key(
                            "east",
                            CROSS,
                            Optional("estimated"),
                            "∂r/∂u on the side u = 1",
                        ),
                    ]),
                ]),
                Optional("ferguson, where the blending uses them"),
                "the cross-derivatives: curves, those of a neighbour, or estimated from the boundary; with quintic blending the surface continues a neighbour's curvatures as well",
            ),
            key(
                "second",
                Record(&[
                    key(
                        "south",
                        Curve,
                        Optional("from the neighbour, or estimated"),
                        "∂²r/∂v² on the side v = 0",
                    ),
                    key(
                        "north",
                        Curve,
                        Optional("from the neighbour, or estimated"),
                        "∂²r/∂v² on the side v = 1",
                    ),
                    key(
                        "west",
                        Curve,
                        Optional("from the neighbour, or estimated"),
                        "∂²r/∂u² on the side u = 0",
                    ),
                    key(
                        "east",
                        Curve,
                        Optional("from the neighbour, or estimated"),
                        "∂²r/∂u² on the side u = 1",
                    ),
                ]),
                Optional("from the neighbours, or estimated from the boundary"),
                "the second derivatives across the sides as curves, for quintic blending only",
            ),
            key(
                "twists",
                CORNERS,
                Optional("from the cross-derivatives"),
                "∂²r/∂u∂v in the corners",
            ),
            key(
                "tolerance",
                Number,
                Optional("1e-9 of the size"),
                "how far the boundary curves may miss each other in the corners, a length",
            ),
            key(
                "incompatible_twists",
                Choice(&["error", "gregory", "average"]),
                Optional("error"),
                "what to do where the cross-derivatives give two twists in a corner, or with quintic blending two derivatives of any mixed order; that has no \"gregory\", and \"average\" changes cross-derivatives there",
            ),
        ],
    },
    Kind {
        name: "hermite",
        doc: "the bicubic patch of corner data (Ferguson-Coons)",
        keys: &[
            key("corners", CORNERS, Required, "[[P00, P01], [P10, P11]]"),
            key("tangents_u", CORNERS, Required, "∂r/∂u in the corners"),
            key("tangents_v", CORNERS, Required, "∂r/∂v in the corners"),
            key(
                "twists",
                CORNERS,
                Optional("zero"),
                "∂²r/∂u∂v in the corners",
            ),
        ],
    },
    Kind {
        name: "bezier",
        doc: "a Bézier surface, rational if weights are given",
        keys: &[
            key("points", NET, Required, "rows along u"),
            key(
                "weights",
                WEIGHT_NET,
                Optional("all 1"),
                "one positive number for each point",
            ),
        ],
    },
    Kind {
        name: "biquadratic",
        doc: "the rational biquadratic patch of nine points and two weights",
        keys: &[
            key(
                "points",
                Grid(&Vector, Some((3, 3))),
                Required,
                "rows along u",
            ),
            key(
                "weight_u",
                Number,
                Required,
                "of the middle points of the edges along u",
            ),
            key(
                "weight_v",
                Number,
                Required,
                "of the middle points of the edges along v",
            ),
        ],
    },
    Kind {
        name: "nurbs",
        doc: "a non-uniform rational B-spline surface",
        keys: &[
            key(
                "degree",
                List(&Count(1), Some(2)),
                Required,
                "[along u, along v]",
            ),
            key(
                "points",
                NET,
                Required,
                "rows along u, more than the degree in each direction",
            ),
            key(
                "knots_u",
                NUMBERS,
                Optional("clamped, uniform on [0, 1]"),
                "rows + degree + 1 numbers that do not decrease",
            ),
            key(
                "knots_v",
                NUMBERS,
                Optional("clamped, uniform on [0, 1]"),
                "columns + degree + 1 numbers",
            ),
            key(
                "weights",
                WEIGHT_NET,
                Optional("all 1"),
                "one positive number for each point",
            ),
        ],
    },
    Kind {
        name: "rational",
        doc: "a rational surface on any basis",
        keys: &[
            key(
                "basis_u",
                List(&T_FORMULA, None),
                Required,
                "functions of t on [0, 1], one for each row",
            ),
            key(
                "basis_v",
                List(&T_FORMULA, None),
                Required,
                "functions of t on [0, 1], one for each column",
            ),
            key("points", NET, Required, "rows along u"),
            key(
                "weights",
                WEIGHT_NET,
                Optional("all 1"),
                "one positive number for each point",
            ),
        ],
    },
    Kind {
        name: "revolution",
        doc: "a profile turned about an axis",
        keys: &[
            key(
                "profile",
                Curve,
                Required,
                "in a plane with the axis or not; it must not cross the axis",
            ),
            key("axis", AXIS, Optional("z"), "the axis"),
            key(
                "angle",
                Angle,
                Optional("360deg"),
                "of the turn, counter-clockwise seen from the tip of the axis",
            ),
            key("start", Angle, Optional("0deg"), "where the turn starts"),
            key(
                "construction",
                Choice(&["angle", "rational", "coons"]),
                Optional("angle, or rational if a section is given"),
                "angle: v is proportional to the angle; rational: v is the parameter of rational arcs; coons: by blending",
            ),
            key(
                "section",
                Record(&[key(
                    "conic",
                    Number,
                    Required,
                    "μ: 1/2 circle, below 1 ellipse, 1 parabola, above hyperbola",
                )]),
                Optional("a circle"),
                "Grigoriev's sections",
            ),
        ],
    },
    Kind {
        name: "quadric",
        doc: "a quadric, whole or in part",
        keys: &[
            key(
                "shape",
                Choice(&[
                    "ellipsoid",
                    "sphere",
                    "hyperboloid-1",
                    "hyperboloid-2",
                    "elliptic-paraboloid",
                    "hyperbolic-paraboloid",
                    "cone",
                    "cylinder",
                    "parabolic-cylinder",
                    "hyperbolic-cylinder",
                ]),
                Required,
                "which",
            ),
            key(
                "semi_axes",
                NUMBERS,
                Required,
                "of the canonical equation. Three (a, b, c): ellipsoid x²/a² + y²/b² + z²/c² = 1; hyperboloid-1 and hyperboloid-2 x²/a² + y²/b² - z²/c² = 1 and -1; elliptic-paraboloid and hyperbolic-paraboloid x²/a² ± y²/b² = z/c; cone x²/a² + y²/b² = z²/c². Two: cylinder x²/a² + y²/b² = 1 (or one, the radius); parabolic-cylinder x²/a² = z/c (a, c); hyperbolic-cylinder x²/a² - y²/b² = 1. One: sphere, the radius",
            ),
            key(
                "center",
                Vector,
                Optional("the origin"),
                "where its centre or vertex lies",
            ),
            key("frame", FRAME, Optional("x, y, z"), "its directions"),
            key(
                "range",
                RANGE,
                Optional("the whole, or one semi-axis of an unbounded shape"),
                "the part: u and v are angles round the axis (eccentric) and latitudes, or heights and coordinates",
            ),
        ],
    },
    Kind {
        name: "torus",
        doc: "a torus, whole or in part",
        keys: &[
            key(
                "major",
                Number,
                Required,
                "from the axis to the middle of the tube",
            ),
            key("minor", Number, Required, "the radius of the tube"),
            key("center", Vector, Optional("the origin"), "the centre"),
            key(
                "axis",
                DIRECTION,
                Optional("z"),
                "the direction of the axis",
            ),
            key(
                "range",
                RANGE,
                Optional("the whole"),
                "the part: angles round the axis (u) and round the tube (v, from its outermost circle upwards)",
            ),
        ],
    },
    Kind {
        name: "fillet",
        doc: "the rolling-ball blend between two surfaces",
        keys: &[
            key(
                "between",
                List(&Surface, Some(2)),
                Required,
                "any two; two planes, and a plane and a whole cylinder, have a formula, between others the ball is followed from end to end, or round",
            ),
            key(
                "radius",
                Formula(&["u"]),
                Required,
                "a number, or an expression in u, 0 to 1 along the edge, or nearly in proportion to the length of the ball's path: along the cross product of the normals towards the ball, of the first surface and of the second, so exchanging the two turns u round; equal at 0 and 1 where the path closes",
            ),
            key(
                "side",
                List(&Choice(&["front", "back"]), Some(2)),
                Optional("of planes where both reach furthest; of others the front"),
                "on which side of each surface the ball lies; front is where its normal r_u × r_v points",
            ),
            key(
                "other_line",
                Bool,
                Optional("false"),
                "of the two lines where a ball between a cylinder and a plane along it can lie, the other one",
            ),
            key(
                "range",
                SPAN,
                Optional(
                    "as long as the surfaces lie beside each other; round a cylinder one turn",
                ),
                "lengths along the edge, or angles round a cylinder that the plane crosses; only where there is a formula",
            ),
            key(
                "near",
                Vector,
                Optional("there must be only one"),
                "of several fillets the one whose ball comes nearest to this point; not where there is a formula",
            ),
        ],
    },
    Kind {
        name: "blend",
        doc: "a bridge from a side of one surface to a side of another that continues both smoothly",
        keys: &[
            key(
                "between",
                List(&Side, Some(2)),
                Required,
                "two sides, such as [\"hull.north\", \"deck.south\"]: the first becomes the side v = 0, run through in its own direction, the second the side v = 1; normals are those of the first surface if its side is north or west, else opposite",
            ),
            key(
                "continuity",
                Either(&[CONTINUITY, List(&CONTINUITY, Some(2))]),
                Optional("G2"),
                "how both sides are met, or each: G0 in their points (with straight lines if both are), G1 with their tangent planes, G2 with their curvatures as well",
            ),
            key(
                "bulge",
                Either(&[Number, PAIR]),
                Optional("1"),
                "how far the blend follows both surfaces, or each: the mean length of its tangents there, in units of the mean distance of the sides",
            ),
            key(
                "reverse",
                Bool,
                Optional("whatever leaves the sides nearer to each other"),
                "whether the second side is run through backwards",
            ),
        ],
    },
    Kind {
        name: "diagonal-key",
        doc: "a surface on four boundary curves by a linear operator",
        keys: &[
            SIDES[0],
            SIDES[1],
            SIDES[2],
            SIDES[3],
            key(
                "generators",
                Choice(&["south-north", "west-east"]),
                Optional("south-north"),
                "the two curves that are carried; the other two guide them, and v below is the parameter along the guides",
            ),
            key(
                "p",
                V_FORMULA,
                Optional("0"),
                "free function, plane-parallel case; 0 at both ends",
            ),
            key(
                "q",
                V_FORMULA,
                Optional("0"),
                "free function, plane-parallel case; 0 at both ends",
            ),
            key(
                "plane_axes",
                List(&DIRECTION, Some(2)),
                Optional("(y,z), (z,x) or (x,y)"),
                "the directions of p and q in the planes of the generators",
            ),
            key(
                "free",
                List(&List(&V_FORMULA, Some(3)), Some(2)),
                Optional("zero"),
                "two free vectors g1, g2, in space; 0 at both ends",
            ),
            key(
                "normals",
                List(&DIRECTION, Some(2)),
                Optional("chosen"),
                "two directions square to d11",
            ),
            key(
                "tangent_west",
                STITCH,
                Optional("free"),
                "∂r/∂u on the side u = 0, where it is a guide",
            ),
            key(
                "tangent_east",
                STITCH,
                Optional("free"),
                "∂r/∂u on the side u = 1, where it is a guide",
            ),
            key(
                "tangent_south",
                STITCH,
                Optional("free"),
                "∂r/∂v on the side v = 0, where it is a guide",
            ),
            key(
                "tangent_north",
                STITCH,
                Optional("free"),
                "∂r/∂v on the side v = 1, where it is a guide",
            ),
        ],
    },
    Kind {
        name: "transform",
        doc: "a surface mirrored, scaled, turned, moved (in this order)",
        keys: &[
            key("surface", Surface, Required, "the surface"),
            SIMILARITY[0],
            SIMILARITY[1],
            SIMILARITY[2],
            SIMILARITY[3],
        ],
    },
    Kind {
        name: "join",
        doc: "surfaces that belong together: each must share a side with another, without a gap",
        keys: &[
            key("surfaces", List(&Surface, None), Required, "the members"),
            key(
                "tolerance",
                Number,
                Optional("1e-6 of the size"),
                "the greatest gap along a shared side",
            ),
        ],
    },
    Kind {
        name: "import",
        doc: "the surface of a face in a file of another system, with the normal of the face: u and v are exchanged if \
              that is not the surface's own",
        keys: &[
            key(
                "file",
                Text,
                Required,
                "the file, relative to the model's; its unit is converted",
            ),
            key(
                "face",
                Either(&[Text, Count(1)]),
                Optional("the only one"),
                "its name or its number",
            ),
            key(
                "untrimmed",
                Bool,
                Optional("false"),
                "take the whole surface also where the face is only a part of it",
            ),
        ],
    },
];

const FRAME: Shape = Record(&[
    key(
        "x",
        DIRECTION,
        Optional("square to z"),
        "the first direction, projected square to z",
    ),
    key("z", DIRECTION, Required, "the third direction"),
]);
const SPAN: Shape = Either(&[List(&Angle, Some(2)), PAIR]);
const RANGE: Shape = Record(&[
    key("u", SPAN, Optional("all"), "from, to"),
    key("v", SPAN, Optional("all"), "from, to"),
]);
