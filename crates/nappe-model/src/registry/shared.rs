//! Keys and shapes that several kinds have.

use super::Key;
use super::Need::{self, Optional, Required};
use super::Shape::{self, *};

pub(super) const fn key(name: &'static str, shape: Shape, need: Need, doc: &'static str) -> Key {
    Key {
        name,
        shape,
        need,
        doc,
    }
}

pub(super) const AXES: Shape = Choice(&["x", "y", "z"]);
pub(super) const DIRECTION: Shape = Either(&[AXES, Vector]);
pub(super) const POINTS: Shape = List(&Vector, None);
pub(super) const NUMBERS: Shape = List(&Number, None);
pub(super) const PAIR: Shape = List(&Number, Some(2));
pub(super) const NET: Shape = Grid(&Vector, None);
pub(super) const WEIGHT_NET: Shape = Grid(&Number, None);
pub(super) const CORNERS: Shape = Grid(&Vector, Some((2, 2)));
pub(super) const PLANE_KEYS: &[Key] = &[
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
pub(super) const AXIS: Shape = Either(&[
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

pub(super) const NORMAL: Key = key(
    "normal",
    DIRECTION,
    Optional("z"),
    "normal of the plane; the turn is counter-clockwise seen from its tip",
);
pub(super) const X_DIRECTION: Key = key(
    "x_direction",
    DIRECTION,
    Optional("x, or y if the normal is x"),
    "where angles start, projected to the plane",
);
pub(super) const FROM: Key = key("from", Vector, Required, "the first point");
pub(super) const TO: Key = key("to", Vector, Required, "the last point");
pub(super) const WEIGHTS: Key = key(
    "weights",
    NUMBERS,
    Optional("all 1"),
    "one positive number for each point",
);
pub(super) const SIMILARITY: [Key; 4] = [
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
pub(super) const ON_SURFACE: Key = key("surface", Surface, Required, "the surface");
pub(super) const BRANCH: Key = key(
    "branch",
    Count(1),
    Optional("the only one"),
    "which of several branches, counted from 1 by their least u, then v",
);
pub(super) const TRACE_TOLERANCE: Key = key(
    "tolerance",
    Number,
    Optional("a millionth of the surface's size"),
    "the greatest distance from the exact curve",
);
pub(super) const NEIGHBOUR: &[Key] = &[key(
    "from",
    Side,
    Required,
    "the side whose cross-derivative is taken",
)];
