//! Questions about surfaces, answered with proofs.
//!
//! [`Finder`] is prepared once for some surfaces and then gives the nearest point to any point, one by one or many at once.
//! The files: `part` bounds the distance over a part of a surface, `tree` keeps parts of all surfaces so that few of them
//! are looked at, `nearest` searches.

mod cells;
mod chains;
mod extended;
mod field;
mod figure;
mod meet;
mod nearest;
mod part;
mod path;
mod seams;
mod solve;
mod trace;
mod tree;
mod tube;

pub use field::{ExpressionField, Field, FieldJet, FormulaField};
pub use figure::{Figure, FigureError, SurfaceField};
pub use meet::{MeetOptions, MeetPoint, Meets, meet};
pub use path::Path;
pub use trace::{Branch, BranchEnd, Trace, TraceError, TraceOptions, Undecided, trace};
pub use nearest::{Finder, FinderOptions, Nearest, QueryError};
