//! Questions about surfaces and curves, answered with proofs.
//!
//! [`Finder`] is prepared once for some surfaces, or curves, and then gives the nearest point to any point, one by one or
//! many at once, or all nearest points ([`Locus`]). [`SignedFinder`] also tells on which side of the surfaces a point is.
//!
//! The files: `shape` is what surfaces and curves have in common, `part` bounds the distance over a part of one, `tree` keeps
//! parts of all so that few of them are looked at, `nearest` searches. `within` finds all that is no farther away than that,
//! for `all` and for `side`.

mod all;
mod nearest;
mod part;
mod shape;
mod side;
mod tree;
mod within;

pub use all::Locus;
pub use nearest::{Finder, FinderOptions, Nearest, QueryError};
pub use side::{Sidedness, Signed, SignedFinder};
