//! Questions about surfaces and curves, answered with proofs.
//!
//! [`Finder`] is prepared once for some surfaces, or curves, and then gives the nearest point to any point, one by one or
//! many at once, or all nearest points ([`Locus`]). [`SignedFinder`] also tells on which side of the surfaces a point is.
//! The files: `shape` is what surfaces and curves have in common, `part` bounds the distance over a part of one, `tree` keeps
//! parts of all so that few of them are looked at, `descent` goes down to the nearest place of one, `nearest` searches. `patch` is a
//! polynomial piece, for which the distance is a polynomial too (`bernstein`), and `patches` searches these. `within` finds all that is no farther away than that,
//! for `all` and for `side`.
//!
//! [`trace`] gives all curves on which a function of two parameters is zero ([`Field`]: an expression, a formula, or a
//! [`Figure`] of a surface: a section, a silhouette, an isophote, a curvature), [`meet`] all points where two such functions
//! are zero, [`intersect`] all points where a curve meets a surface, [`intersect_surfaces`] all curves in which two surfaces meet
//! (the folder `surfaces`). The files: `field` and `figure` are the functions,
//! `extended` continues them a little beyond their border, `cells` divides the rectangle and proves what is in each cell,
//! `chains` joins cells, `tube` makes paths with a bound, `path` is the curve, `seams` joins across patches, `solve` finds
//! points.

mod all;
mod bernstein;
mod cells;
mod chains;
mod descent;
mod extended;
mod field;
mod figure;
mod intersect;
mod meet;
mod nearest;
mod part;
mod patch;
mod patches;
mod path;
mod seams;
mod shape;
mod side;
mod solve;
mod surfaces;
mod trace;
mod tree;
mod tube;
mod within;

pub use all::Locus;
pub use field::{ExpressionField, Field, FieldJet, FormulaField};
pub use figure::{Figure, FigureError, SurfaceField};
pub use intersect::{CurveSurface, CurveSurfacePoint, intersect};
pub use meet::{MeetOptions, MeetPoint, Meets, meet};
pub use nearest::{Finder, FinderOptions, Nearest, QueryError};
pub use path::Path;
pub use side::{Sidedness, Signed, SignedFinder};
pub use surfaces::{
    Contact, IntersectOptions, SurfaceCurve, SurfaceSurface, SurfacesError, intersect_surfaces,
};
pub use trace::{Branch, BranchEnd, Trace, TraceError, TraceOptions, Undecided, trace};
