//! What can be wrong with the data of a Diagonal-key surface.

use super::super::{ContourError, Corner, Side};
use crate::interval::Interval;
use glam::DVec3;
use thiserror::Error;

/// What can be wrong with the data of a Diagonal-key surface.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum DiagonalKeyError {
    /// The boundary curves do not close.
    #[error(transparent)]
    Contour(#[from] ContourError),
    /// The corners form a parallelogram, but the guides are not translates of each other.
    #[error(
        "the corners {}, {}, {}, {} form a parallelogram (p11 - p01 - p10 + p00 = {d11}), and the guides differ by more \
         than a translation (by {d} at {v}): no linear operator maps one to the other; move a corner, or use a Coons surface",
        corners[0], corners[1], corners[2], corners[3]
    )]
    Parallelogram {
        /// p00, p10, p01, p11.
        corners: Box<[DVec3; 4]>,
        /// `p11 - p01 - p10 + p00`.
        d11: DVec3,
        /// Where the guides differ most.
        v: f64,
        /// `d(1, v)` there.
        d: DVec3,
    },
    /// The guides differ by a pure translation over a part of their range: d(1, v) has no direction there.
    #[error(
        "the guides differ by a mere translation over v = {} to {}, so that d(1, v) is zero and has no direction there; \
         use a Coons surface, or change a guide",
        v.lo, v.hi
    )]
    NoDirection {
        /// The part.
        v: Interval,
    },
    /// The direction of d(1, v) turns through (nearly) every direction: no rotation can follow it smoothly.
    #[error(
        "the direction of d(1, v) cannot be followed by a smooth rotation near v = {v}: d(1, v) = {d} there; \
         use smooth stitching, a Coons surface, or change a guide"
    )]
    Direction {
        /// Where.
        v: f64,
        /// `d(1, v)`.
        d: DVec3,
    },
    /// p and q are given, but the contour is not plane-parallel.
    #[error(
        "p and q need generators in parallel planes and guides whose difference is parallel to them: a difference \
         vector leaves the plane square to {normal} by {deviation:e} (allowed: {tol:e}); give the free functions of space instead"
    )]
    NotPlane {
        /// The unit normal of the best plane (or of the plane given).
        normal: DVec3,
        /// The greatest distance from it, a length.
        deviation: f64,
        /// The greatest distance allowed.
        tol: f64,
    },
    /// p and q are given, and the plane is not square to a coordinate axis: their directions are not defined.
    #[error(
        "the generators' planes are square to {normal}, not to x, y or z: p and q need plane axes"
    )]
    AxesNeeded {
        /// The unit normal.
        normal: DVec3,
    },
    /// The given plane axes do not span a plane.
    #[error("the plane axes {} and {} do not span a plane", axes[0], axes[1])]
    Axes {
        /// The axes given.
        axes: [DVec3; 2],
    },
    /// A given normal is not square to d11, or the two do not span a plane.
    #[error(
        "the normals {} and {} must span the plane square to d11 = {d11}", normals[0], normals[1]
    )]
    Normals {
        /// The normals given.
        normals: [DVec3; 2],
        /// `p11 - p01 - p10 + p00`.
        d11: DVec3,
    },
    /// A list of free functions has the wrong length.
    #[error("{name} has {count} functions, {expected} are needed")]
    FunctionCount {
        /// p, q, g1, g2 or blend.
        name: &'static str,
        /// How many there are.
        count: usize,
        /// How many there must be.
        expected: usize,
    },
    /// A function or a tangent curve is not given over `[0, 1]`.
    #[error("{name} is given over [{}, {}], it must be given over [0, 1]", domain.lo, domain.hi)]
    FunctionDomain {
        /// p, q, g1, g2, blend, or the side of a tangent.
        name: &'static str,
        /// Its domain.
        domain: Interval,
    },
    /// A free function does not take the value that interpolation of the generators needs.
    #[error("{name}({t}) is {value}, it must be {expected}: the surface would leave the generator")]
    FunctionEnd {
        /// p, q, g1, g2 or blend.
        name: &'static str,
        /// The end, 0 or 1.
        t: f64,
        /// The value there.
        value: f64,
        /// The value it must have.
        expected: f64,
    },
    /// A function is NaN or infinite.
    #[error("{name}({t}) is {value}: it must be finite")]
    FunctionNotFinite {
        /// p, q, g1, g2, blend, or the side of a tangent.
        name: &'static str,
        /// Where.
        t: f64,
        /// The value.
        value: f64,
    },
    /// A prescribed tangent differs from the generator's derivative in a corner.
    #[error(
        "the tangent along {side} is {given} in the corner {corner}, where the generator's derivative is {expected}: \
         they differ by {}", given.distance(*expected)
    )]
    Tangent {
        /// The guide.
        side: Side,
        /// The corner.
        corner: Corner,
        /// The tangent there.
        given: DVec3,
        /// The derivative of the generator there.
        expected: DVec3,
    },
    /// The matrix of smooth stitching is singular.
    #[error(
        "smooth stitching is impossible on this contour: {} are linearly dependent (condition number {condition:e}, \
         at most {most:e} is possible); prescribe the tangent on one side only, or use a Coons surface",
        vectors.iter().map(DVec3::to_string).collect::<Vec<_>>().join(", ")
    )]
    Singular {
        /// d11 (if not zero), and the changes of the generators' end tangents on the prescribed sides.
        vectors: Vec<DVec3>,
        /// The condition number of the matrix of their directions.
        condition: f64,
        /// The greatest condition number allowed.
        most: f64,
    },
    /// Free functions and prescribed tangents exclude each other.
    #[error(
        "free functions and prescribed tangents decide the same operator: give one or the other"
    )]
    FreeAndTangents,
}
