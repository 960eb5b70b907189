//! What can be wrong with the data of a curve.

use crate::exact::NurbsError;
use crate::frame::FrameError;
use crate::interval::Interval;
use glam::DVec3;
use thiserror::Error;

/// What can be wrong with the data of a curve.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CurveError {
    /// Control points, weights or knots are wrong.
    #[error(transparent)]
    Nurbs(#[from] NurbsError),
    /// The curves to join have too many pieces together.
    #[error("the curves have {pieces} pieces together, at most {most} can be joined")]
    TooManyPieces {
        /// The number of pieces.
        pieces: usize,
        /// The most.
        most: usize,
    },
    /// A point or vector has a coordinate that is NaN or infinite.
    #[error("{what} is {value}: coordinates must be finite numbers")]
    VectorNotFinite {
        /// Which point or vector.
        what: &'static str,
        /// Its value.
        value: DVec3,
    },
    /// A number is NaN or infinite.
    #[error("{what} is {value}: it must be a finite number")]
    NotFinite {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A number that must be positive is not.
    #[error("{what} is {value}: it must be greater than 0")]
    NotPositive {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The plane of an ellipse is not determined.
    #[error("the plane is not determined: {0}")]
    Plane(#[from] FrameError),
    /// An arc has no extent, or goes round more than once.
    #[error(
        "the arc turns by {turn} rad, from {from} to {to}: the turn must be neither 0 nor more than a full turn"
    )]
    Turn {
        /// The first angle in radians.
        from: f64,
        /// The last angle.
        to: f64,
        /// `to - from`.
        turn: f64,
    },
    /// Three points do not determine a circle.
    #[error(
        "the points {}, {} and {} lie on one line (the sine of the angle between them is {sine:e}): no circle passes through them; use a line",
        points[0], points[1], points[2]
    )]
    Collinear {
        /// The points.
        points: [DVec3; 3],
        /// The sine of the angle at the middle point.
        sine: f64,
    },
    /// Points that follow each other are equal where they must differ.
    #[error("points {first} and {second} coincide at {point}: remove one of them")]
    Coincident {
        /// The index of one point.
        first: usize,
        /// The index of the other.
        second: usize,
        /// The place.
        point: DVec3,
    },
    /// Fewer points than needed.
    #[error("{given} points are given, at least {needed} are needed")]
    TooFewPoints {
        /// The number given.
        given: usize,
        /// The number needed.
        needed: usize,
    },
    /// A degree out of range.
    #[error("degree {degree} is not between {least} and {most}")]
    Degree {
        /// The degree given.
        degree: usize,
        /// The lowest possible.
        least: usize,
        /// The highest possible.
        most: usize,
    },
    /// End tangents are given for a closed curve, which has no ends.
    #[error("a closed curve has no ends: remove the end tangents or do not close it")]
    TangentOfClosed,
    /// The equations of an interpolation cannot be solved with enough digits.
    #[error(
        "no curve of this degree passes through the points reliably (point {index} is missed by {distance:e}): the points are too unevenly spaced; use degree 3 or another spacing"
    )]
    IllConditioned {
        /// The point that is missed.
        index: usize,
        /// By how much.
        distance: f64,
    },
    /// A part of a curve has no extent or leaves the curve.
    #[error(
        "the part from {from} to {to} is not a part of positive length of the curve, which runs from {} to {}",
        domain.lo, domain.hi
    )]
    Range {
        /// Where the part begins.
        from: f64,
        /// Where it ends.
        to: f64,
        /// The domain of the curve.
        domain: Interval,
    },
    /// A parameter of a surface is outside its domain.
    #[error("the parameter {value} is not between {} and {}", domain.lo, domain.hi)]
    Outside {
        /// The parameter.
        value: f64,
        /// The domain.
        domain: Interval,
    },
    /// Curves to be joined do not meet.
    #[error(
        "curve {first} ends at {end}, but curve {second} starts at {start}, {distance:e} away (allowed: {tol:e}){}",
        if *reversed { "; its other end fits: reverse it" } else { "" }
    )]
    Gap {
        /// The index of the curve that ends.
        first: usize,
        /// The index of the curve that starts.
        second: usize,
        /// Where the first ends.
        end: DVec3,
        /// Where the second starts.
        start: DVec3,
        /// The distance between.
        distance: f64,
        /// The distance allowed.
        tol: f64,
        /// True if the end of the second curve would fit.
        reversed: bool,
    },
    /// Nothing to join.
    #[error("no curves are given to join")]
    Nothing,
}

/// The vector, or an error if it has a coordinate that is not finite.
pub(crate) fn finite_vector(what: &'static str, value: DVec3) -> Result<DVec3, CurveError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(CurveError::VectorNotFinite { what, value })
    }
}

/// The number, or an error if it is not finite.
pub(crate) fn finite(what: &'static str, value: f64) -> Result<f64, CurveError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(CurveError::NotFinite { what, value })
    }
}

/// The number, or an error if it is not finite and positive.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<f64, CurveError> {
    if finite(what, value)? > 0.0 {
        Ok(value)
    } else {
        Err(CurveError::NotPositive { what, value })
    }
}
