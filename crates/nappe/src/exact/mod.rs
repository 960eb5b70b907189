//! Exact forms: piecewise rational functions, NURBS curves and surfaces, and the tools between them.

mod arcs;
mod curve_tools;
mod nurbs_curve;
mod nurbs_surface;
mod piecewise;
mod spline;
mod surface_tools;

pub use arcs::ConicArcs;
pub use curve_tools::compatible;
pub use nurbs_curve::{NurbsCurve, NurbsError};
pub use nurbs_surface::NurbsSurface;
pub use piecewise::PiecewiseRational;

use crate::basis::{BSplineBasis, Functions};

/// The piecewise form of a B-spline basis, which always exists.
pub(crate) fn piecewise_of(basis: &BSplineBasis) -> PiecewiseRational {
    basis
        .to_piecewise()
        .expect("a B-spline basis is piecewise polynomial")
}
