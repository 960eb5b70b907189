//! How curves and surfaces move when a number that they are made of changes: forward mode.
//!
//! The velocity of a curve `r(t; p)` is the vector-valued curve `∂r/∂p` at fixed t, that of a surface `r(u, v; p)` the
//! vector-valued surface `∂r/∂p` at fixed (u, v). Both are curves and surfaces like any other: they have derivatives
//! of any order and enclose themselves, so that integrals over them are proven.
//!
//! Most kinds are linear in their data (splines with fixed knots, ruled and Coons surfaces, Hermite patches, images,
//! parts and sides of others): their velocity is the same construction with velocities for data, and needs no code
//! here. What is left is a [`Sum`]: a kind that is moved as a whole and stretched, that slides along its parameters, or
//! whose weights change moves by linear images of itself and its derivatives, times numbers that vary over it.

mod continuation;
mod diagonal_key;
mod extended;
mod interpolation;
mod net;
mod quadric;
mod rigid;
mod round;
mod sum;

pub use continuation::continuation;
pub use diagonal_key::{DiagonalKeyRate, diagonal_key};
pub use extended::Extended;
pub use interpolation::interpolation;
pub use net::Net;
pub use quadric::{QuadricRate, quadric};
pub use rigid::{FrameRate, cross_matrix};
pub use round::{TurnRate, arc, revolution, torus};
pub use sum::{Factor, Sum, Term};

use crate::breaks::{Break, UNIT_BREAKS};
use crate::curve::{CurveRef, Isocurve};
use crate::interval::Interval;
use crate::surface::{Dir, Side, SurfaceRef};
use std::sync::Arc;

/// The curve that a sum of curves extended by [`extended`] is: its south side.
pub fn as_curve(sum: Sum) -> CurveRef {
    let surface: SurfaceRef = Arc::new(sum);
    Arc::new(Isocurve::side(surface, Side::South))
}

/// A curve as a surface with u along it, for a sum that is a curve.
pub fn extended(curve: CurveRef) -> SurfaceRef {
    Arc::new(Extended::new(curve, Dir::U, Interval::UNIT))
}

/// The velocity of a curve that does not move.
pub fn still_curve(breaks: &[Break]) -> CurveRef {
    as_curve(Sum::still([breaks, &UNIT_BREAKS]))
}
