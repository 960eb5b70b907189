//! Every kind of curve and surface with its keys: the one list from which the reader, its error messages, the
//! documentation and the JSON Schema are made.

/// What a value must look like.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// A number, or an expression over the parameters.
    Number,
    /// A whole number, at least the given one.
    Count(u32),
    /// A text with a number or expression and a unit: deg, rad or turn.
    Angle,
    /// true or false.
    Bool,
    /// Any text.
    Text,
    /// Three numbers.
    Vector,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// An expression in one of these variables and the parameters.
    Formula(&'static [&'static str]),
    /// A curve: its name, a side such as `dome.south`, or a table with `kind`.
    Curve,
    /// The name of a surface.
    Surface,
    /// A side of a surface, such as `dome.south`.
    Side,
    /// A list, of a given length if one is given.
    List(&'static Shape, Option<usize>),
    /// Rows of equal length, of a given size (rows, columns) if one is given.
    Grid(&'static Shape, Option<(usize, usize)>),
    /// A table with these keys.
    Record(&'static [Key]),
    /// One of several.
    Either(&'static [Shape]),
}

/// Whether a key must be there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Need {
    /// It must.
    Required,
    /// It need not; the text says what happens then.
    Optional(&'static str),
    /// It belongs to one of several forms of the kind, of which one must be complete.
    Form(usize),
}

/// A key of a table.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// The name.
    pub name: &'static str,
    /// What its value must look like.
    pub shape: Shape,
    /// Whether it must be there.
    pub need: Need,
    /// What it is.
    pub doc: &'static str,
}

/// A kind of curve or surface.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// The name, the value of the key `kind`.
    pub name: &'static str,
    /// What it is.
    pub doc: &'static str,
    /// Its keys, besides `kind` and `construction_only`.
    pub keys: &'static [Key],
}

use Need::{Form, Optional, Required};
use Shape::*;

const fn key(name: &'static str, shape: Shape, need: Need, doc: &'static str) -> Key {
    Key {
        name,
        shape,
        need,
        doc,
    }
}

const AXES: Shape = Choice(&["x", "y", "z"]);
const DIRECTION: Shape = Either(&[AXES, Vector]);
const POINTS: Shape = List(&Vector, None);
const NUMBERS: Shape = List(&Number, None);
const PAIR: Shape = List(&Number, Some(2));
const NET: Shape = Grid(&Vector, None);
const WEIGHT_NET: Shape = Grid(&Number, None);
const CORNERS: Shape = Grid(&Vector, Some((2, 2)));
const PLANE_KEYS: &[Key] = &[
    key(
        "origin",
        Vector,
        Optional("the origin of space"),
        "a point of the plane",
    ),
    key(
        "normal",
        DIRECTION,
        Required,
        "a direction square to the plane",
    ),
];
/// An axis in space.
pub(crate) const AXIS: Shape = Either(&[
    AXES,
    Record(&[
        key(
            "origin",
            Vector,
            Optional("the origin of space"),
            "a point on the axis",
        ),
        key("direction", DIRECTION, Required, "its direction"),
    ]),
]);

const NORMAL: Key = key(
    "normal",
    DIRECTION,
    Optional("z"),
    "normal of the plane; the turn is counter-clockwise seen from its tip",
);
const X_DIRECTION: Key = key(
    "x_direction",
    DIRECTION,
    Optional("x, or y if the normal is x"),
    "where angles start, projected to the plane",
);
const FROM: Key = key("from", Vector, Required, "the first point");
const TO: Key = key("to", Vector, Required, "the last point");
const WEIGHTS: Key = key(
    "weights",
    NUMBERS,
    Optional("all 1"),
    "one positive number for each point",
);
const SIMILARITY: [Key; 4] = [
    key("translate", Vector, Optional("none"), "moved by this, last"),
    key(
        "rotate",
        Record(&[
            key("axis", AXIS, Required, "turned about this axis"),
            key(
                "angle",
                Angle,
                Required,
                "counter-clockwise seen from the tip of the axis",
            ),
        ]),
        Optional("none"),
        "turned, after mirror and scale",
    ),
    key(
        "scale",
        Either(&[Number, Vector]),
        Optional("1"),
        "one factor, or one for each axis; about the origin",
    ),
    key(
        "mirror",
        Either(&[Choice(&["xy", "yz", "xz"]), Record(PLANE_KEYS)]),
        Optional("none"),
        "mirrored in a plane, first",
    ),
];
const NEIGHBOUR: &[Key] = &[key(
    "from",
    Side,
    Required,
    "the side whose cross-derivative is taken",
)];

/// All kinds of curves.
pub const CURVES: &[Kind] = &[
    Kind {
        name: "line",
        doc: "the segment between two points",
        keys: &[FROM, TO],
    },
    Kind {
        name: "polyline",
        doc: "segments through points",
        keys: &[
            key("points", POINTS, Required, "at least two points"),
            key(
                "parametrization",
                Choice(&["chord", "centripetal", "uniform"]),
                Optional("chord"),
                "which parameters the points get",
            ),
        ],
    },
    Kind {
        name: "bezier",
        doc: "a Bézier curve, rational if weights are given",
        keys: &[
            key("points", POINTS, Required, "the control points"),
            WEIGHTS,
        ],
    },
    Kind {
        name: "nurbs",
        doc: "a non-uniform rational B-spline",
        keys: &[
            key("degree", Count(1), Required, "of the polynomial pieces"),
            key(
                "points",
                POINTS,
                Required,
                "the control points, more than the degree",
            ),
            key(
                "knots",
                NUMBERS,
                Optional("clamped, uniform on [0, 1]"),
                "points + degree + 1 numbers that do not decrease",
            ),
            WEIGHTS,
        ],
    },
    Kind {
        name: "hermite",
        doc: "the cubic with given ends and end tangents",
        keys: &[
            FROM,
            TO,
            key(
                "from_tangent",
                Vector,
                Required,
                "the derivative at the first point",
            ),
            key(
                "to_tangent",
                Vector,
                Required,
                "the derivative at the last point",
            ),
        ],
    },
    Kind {
        name: "arc",
        doc: "an arc of a circle, by centre and angles or through three points",
        keys: &[
            key("center", Vector, Form(0), "the centre"),
            key("radius", Number, Form(0), "the radius"),
            key("from", Angle, Form(0), "where it starts"),
            key(
                "to",
                Angle,
                Form(0),
                "where it ends; less than `from` for clockwise",
            ),
            key(
                "through",
                List(&Vector, Some(3)),
                Form(1),
                "start, a point between, end",
            ),
            NORMAL,
            X_DIRECTION,
        ],
    },
    Kind {
        name: "circle",
        doc: "a full circle",
        keys: &[
            key("center", Vector, Optional("the origin"), "the centre"),
            key("radius", Number, Required, "the radius"),
            NORMAL,
            X_DIRECTION,
        ],
    },
    Kind {
        name: "ellipse",
        doc: "an ellipse or an arc of one",
        keys: &[
            key("center", Vector, Optional("the origin"), "the centre"),
            key(
                "semi_axes",
                PAIR,
                Required,
                "along the x direction and square to it",
            ),
            key(
                "from",
                Angle,
                Optional("0deg"),
                "where it starts (eccentric angle)",
            ),
            key("to", Angle, Optional("360deg"), "where it ends"),
            NORMAL,
            X_DIRECTION,
        ],
    },
    Kind {
        name: "conic",
        doc: "a conic arc by three points: ellipse for a weight below 1, parabola for 1, hyperbola above",
        keys: &[
            key(
                "points",
                List(&Vector, Some(3)),
                Required,
                "start, meeting point of the end tangents, end",
            ),
            key("weight", Number, Required, "of the middle point, positive"),
        ],
    },
    Kind {
        name: "interpolate",
        doc: "a spline through points",
        keys: &[
            key("points", POINTS, Required, "at least two points"),
            key(
                "closed",
                Bool,
                Optional("false"),
                "whether it returns smoothly to the first point",
            ),
            key("degree", Count(2), Optional("3"), "of the pieces, 2 to 5"),
            key(
                "start_tangent",
                Vector,
                Optional("no curvature there"),
                "the derivative at the first point",
            ),
            key(
                "end_tangent",
                Vector,
                Optional("no curvature there"),
                "the derivative at the last point",
            ),
            key(
                "parametrization",
                Choice(&["chord", "centripetal", "uniform"]),
                Optional("chord"),
                "which parameters the points get",
            ),
        ],
    },
    Kind {
        name: "expression",
        doc: "coordinates as expressions in t",
        keys: &[
            key("x", Formula(&["t"]), Required, "x(t)"),
            key("y", Formula(&["t"]), Required, "y(t)"),
            key("z", Formula(&["t"]), Required, "z(t)"),
            key(
                "domain",
                PAIR,
                Optional("[0, 1]"),
                "from where to where t runs",
            ),
        ],
    },
    Kind {
        name: "isocurve",
        doc: "the curve of constant u or v on a surface",
        keys: &[
            key("surface", Surface, Required, "the surface"),
            key("u", Number, Form(0), "constant u; the curve runs along v"),
            key("v", Number, Form(1), "constant v; the curve runs along u"),
        ],
    },
    Kind {
        name: "side",
        doc: "a side of a surface; the same as writing its name",
        keys: &[key("side", Side, Required, "such as \"dome.south\"")],
    },
    Kind {
        name: "reverse",
        doc: "a curve run through backwards",
        keys: &[key("curve", Curve, Required, "the curve")],
    },
    Kind {
        name: "trim",
        doc: "a part of a curve",
        keys: &[
            key("curve", Curve, Required, "the curve"),
            key(
                "from",
                Number,
                Optional("its start"),
                "the parameter where the part starts",
            ),
            key(
                "to",
                Number,
                Optional("its end"),
                "the parameter where the part ends",
            ),
        ],
    },
    Kind {
        name: "join",
        doc: "curves one after the other",
        keys: &[key(
            "curves",
            List(&Curve, None),
            Required,
            "each starts where the one before it ends",
        )],
    },
    Kind {
        name: "transform",
        doc: "a curve mirrored, scaled, turned, moved (in this order)",
        keys: &[
            key("curve", Curve, Required, "the curve"),
            SIMILARITY[0],
            SIMILARITY[1],
            SIMILARITY[2],
            SIMILARITY[3],
        ],
    },
];

const SIDES: [Key; 4] = [
    key("south", Curve, Required, "the side v = 0, along u"),
    key("north", Curve, Required, "the side v = 1, along u"),
    key("west", Curve, Required, "the side u = 0, along v"),
    key("east", Curve, Required, "the side u = 1, along v"),
];
const CROSS: Shape = Either(&[Choice(&["ferguson", "adini"]), Record(NEIGHBOUR), Curve]);
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
                    Choice(&["linear", "cubic"]),
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
                "the cross-derivatives: curves, those of a neighbour, or estimated from the boundary",
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
                "what to do where the cross-derivatives give two twists in a corner",
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
                "a, b, c of the canonical equation, as many as the shape has; one for a sphere",
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
                "two planes, or a plane and a cylinder",
            ),
            key(
                "radius",
                Formula(&["u"]),
                Required,
                "a number, or an expression in u along the edge",
            ),
            key(
                "side",
                List(&Choice(&["front", "back"]), Some(2)),
                Optional("where the planes reach furthest; of a cylinder the front"),
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
                "lengths along the edge, or angles round a cylinder that the plane crosses",
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

/// The keys of a check.
pub(crate) const CHECK: &[Key] = &[
    key(
        "between",
        List(&Side, Some(2)),
        Required,
        "two sides, such as [\"hull.north\", \"deck.south\"]",
    ),
    key(
        "continuity",
        Choice(&["G0", "G1", "G2"]),
        Required,
        "what is claimed",
    ),
    key(
        "tolerance",
        Either(&[Angle, Number]),
        Required,
        "G0: a length; G1: an angle such as \"0.1deg\"; G2: a relative curvature difference",
    ),
];

/// The keys of the file besides `params`, `curves`, `surfaces` and `checks`.
pub(crate) const TOP: &[Key] = &[
    key("nappe", Count(1), Required, "the version of the format: 1"),
    key(
        "title",
        Text,
        Optional("the file's name"),
        "what the model is",
    ),
    key(
        "units",
        Choice(&["mm", "cm", "m", "in", "ft"]),
        Optional("mm"),
        "the unit of length",
    ),
    key(
        "tolerance",
        Number,
        Optional("1e-3 of the box diagonal"),
        "greatest distance of a mesh from the surface, in units",
    ),
];

impl Shape {
    /// The shape in words, for messages: "a point [x, y, z]".
    pub fn describe(&self) -> String {
        match self {
            Number => "a number or an expression".into(),
            Count(n) => format!("a whole number from {n}"),
            Angle => "an angle such as \"45deg\"".into(),
            Bool => "true or false".into(),
            Text => "a text".into(),
            Vector => "three numbers [x, y, z]".into(),
            Choice(words) => {
                let quoted: Vec<String> = words.iter().map(|w| format!("\"{w}\"")).collect();
                quoted.join(" or ")
            }
            Formula(vars) => format!("an expression in {}", vars.join(" and ")),
            Curve => {
                "a curve (a name, a side such as \"dome.south\", or a table with `kind`)".into()
            }
            Surface => "the name of a surface".into(),
            Side => "a side such as \"dome.south\"".into(),
            List(Number, None) => "a list of numbers".into(),
            List(Vector, None) => "a list of points [x, y, z]".into(),
            List(item, None) => format!("a list, each entry {}", item.describe()),
            List(item, Some(n)) => format!("a list of {n}, each {}", item.describe()),
            Grid(item, None) => format!("a list of rows, each entry {}", item.describe()),
            Grid(item, Some((a, b))) => format!("{a} rows of {b}, each entry {}", item.describe()),
            Record(keys) => {
                let names: Vec<&str> = keys.iter().map(|k| k.name).collect();
                format!("a table with {}", names.join(", "))
            }
            Either(shapes) => {
                let all: Vec<String> = shapes.iter().map(Shape::describe).collect();
                all.join(", or ")
            }
        }
    }
}
