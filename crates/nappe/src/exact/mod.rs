//! Exact forms: piecewise rational functions, NURBS curves and surfaces, and the tools between them.

mod approximate;
mod arcs;
mod curve_tools;
mod hermite;
mod hull;
mod impose;
mod nurbs_curve;
mod nurbs_surface;
mod piecewise;
mod reduce;
mod share;
mod spline;
mod surface_tools;

pub use approximate::{
    ApproximationError, Converted, approximate_curve, approximate_surface, to_nurbs_or_approximate,
    to_nurbs_or_approximate_curve,
};
pub use arcs::ConicArcs;
pub use curve_tools::compatible;
pub use nurbs_curve::{NurbsCurve, NurbsError, bad_weights};
pub use nurbs_surface::NurbsSurface;
pub use piecewise::PiecewiseRational;
pub use share::{SharedSide, to_nurbs_together};

pub(crate) use nurbs_curve::{homogeneous, middle};
pub(crate) use piecewise::{bernstein_elevate, bernstein_product, bernstein_restrict};
pub(crate) use spline::{Row, join};

use crate::basis::{BSplineBasis, Functions};

/// The piecewise form of a B-spline basis, which always exists.
pub(crate) fn piecewise_of(basis: &BSplineBasis) -> PiecewiseRational {
    basis
        .to_piecewise()
        .expect("a B-spline basis is piecewise polynomial")
}
