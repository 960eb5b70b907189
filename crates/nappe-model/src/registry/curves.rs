//! The kinds of curves.

use super::Kind;
use super::Need::{Form, Optional, Required};
use super::Shape::*;
use super::shared::*;

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
                Optional("degree 3: no curvature there; other degrees: what the fewest knots give"),
                "the derivative at the first point",
            ),
            key(
                "end_tangent",
                Vector,
                Optional("degree 3: no curvature there; other degrees: what the fewest knots give"),
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
        name: "trace",
        doc: "the curve on a surface where an expression in its parameters is zero",
        keys: &[
            ON_SURFACE,
            key(
                "f",
                Formula(&["u", "v"]),
                Required,
                "zero on the curve; u and v run over the surface's own ranges, mostly 0 to 1",
            ),
            BRANCH,
            TRACE_TOLERANCE,
        ],
    },
    Kind {
        name: "section",
        doc: "the curve in which a surface meets a plane",
        keys: &[
            ON_SURFACE,
            PLANE_KEYS[0],
            PLANE_KEYS[1],
            BRANCH,
            TRACE_TOLERANCE,
        ],
    },
    Kind {
        name: "silhouette",
        doc: "the curve on which a surface is seen edge-on",
        keys: &[
            ON_SURFACE,
            key("direction", DIRECTION, Form(0), "seen from afar along this"),
            key("eye", Vector, Form(1), "seen from this point"),
            BRANCH,
            TRACE_TOLERANCE,
        ],
    },
    Kind {
        name: "isophote",
        doc: "the curve on which a surface's normal has an angle with a direction",
        keys: &[
            ON_SURFACE,
            key("direction", DIRECTION, Required, "the direction of light"),
            key(
                "angle",
                Angle,
                Required,
                "between it and the normal, 0deg to 180deg",
            ),
            BRANCH,
            TRACE_TOLERANCE,
        ],
    },
    Kind {
        name: "isocurvature",
        doc: "the curve on which a curvature of a surface has a value",
        keys: &[
            ON_SURFACE,
            key(
                "curvature",
                Choice(&["gaussian", "mean", "k1", "k2"]),
                Required,
                "which curvature; k1 is the larger of the principal ones, k2 the smaller",
            ),
            key(
                "value",
                Number,
                Required,
                "in 1/length, gaussian 1/length²; positive where the surface bends towards its normal",
            ),
            BRANCH,
            TRACE_TOLERANCE,
        ],
    },
    Kind {
        name: "intersection",
        doc: "the curve in which two surfaces meet",
        keys: &[
            key(
                "surfaces",
                List(&Surface, Some(2)),
                Required,
                "the two surfaces; u and v of the first one say which branch is which",
            ),
            BRANCH,
            TRACE_TOLERANCE,
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
    Kind {
        name: "import",
        doc: "a curve that stands for itself in a file of another system",
        keys: &[
            key(
                "file",
                Text,
                Required,
                "the file, relative to the model's; its unit is converted",
            ),
            key(
                "curve",
                Either(&[Text, Count(1)]),
                Optional("the only one"),
                "its name or its number",
            ),
        ],
    },
];
