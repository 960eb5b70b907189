//! Every kind of curve and surface with its keys: the one list from which the reader, its error messages, the
//! documentation and the JSON Schema are made.

mod curves;
mod shared;
mod surfaces;

pub use curves::CURVES;
pub use surfaces::SURFACES;

use Need::{Optional, Required};
use Shape::*;
use shared::key;

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

/// The keys of a check.
pub const CHECK: &[Key] = &[
    key(
        "between",
        List(&Side, Some(2)),
        Required,
        "two sides, such as [\"hull.north\", \"deck.south\"]; where one lies along a part of the other, the claim is about that part",
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
    key(
        "in_part",
        Bool,
        Optional("false"),
        "whether the claim is about what the two sides have in common, however short; else one of them must lie on the other from end to end",
    ),
];

/// The keys of the file besides `params`, `curves`, `surfaces` and `checks`.
pub const TOP: &[Key] = &[
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
