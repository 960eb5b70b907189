//! Surfaces that are no surfaces: collapsed to a point or a line.

use super::{Dir, Surface};
use crate::box3::Box3;
use crate::breaks::{Breaks, Limit};
use crate::interval::Interval;
use crate::size::{LARGEST_LENGTH, SMALLEST_EXTENT};
use glam::DVec3;
use thiserror::Error;

/// Why a surface encloses no area.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum CollapsedError {
    /// All of it is one point.
    #[error("the surface is collapsed to the point {point}: all its points are the same")]
    Point {
        /// The point.
        point: DVec3,
    },
    /// All of it is one line.
    #[error(
        "the surface is collapsed to a curve: its derivatives along u and v are parallel, or zero, everywhere (for example at u = {u}, v = {v} they are {along_u} and {along_v})"
    )]
    Curve {
        /// A parameter u.
        u: f64,
        /// A parameter v.
        v: f64,
        /// `∂r/∂u` there.
        along_u: DVec3,
        /// `∂r/∂v` there.
        along_v: DVec3,
    },
    /// A point or a derivative is NaN or infinite.
    #[error("the surface is not finite at u = {u}, v = {v}: the point is {point}")]
    NotFinite {
        /// The parameter u.
        u: f64,
        /// The parameter v.
        v: f64,
        /// The point there.
        point: DVec3,
    },
    /// A point is farther from the origin of space than [`LARGEST_LENGTH`].
    #[error(
        "the surface is too large: at u = {u}, v = {v} it is at ({:e}, {:e}, {:e}), beyond ±{LARGEST_LENGTH:e}, where products of lengths overflow", point.x, point.y, point.z
    )]
    TooLarge {
        /// The parameter u.
        u: f64,
        /// The parameter v.
        v: f64,
        /// The point there.
        point: DVec3,
    },
    /// It is smaller than [`SMALLEST_EXTENT`], and not one point.
    #[error(
        "the surface is too small: its extent is {size:e}, below {SMALLEST_EXTENT:e}, where products of lengths underflow"
    )]
    TooSmall {
        /// The extent.
        size: f64,
    },
}

/// An area element below this part of the squared size is taken for none: data rounded to doubles leaves less.
const NEGLIGIBLE: f64 = 1e-13;

/// An extent below this part of the distance from the origin of space is rounding of one point.
const ROUNDING: f64 = 1e-15;

/// Places inside a piece that no symmetric surface singles out.
const PLACES: [f64; 5] = [0.1131, 0.3271, 0.5417, 0.7293, 0.9179];

/// Refuses a surface that has no area: all points the same, or `r_u × r_v` zero everywhere. A side that is collapsed to
/// a point (a pole) is no fault. Nor are surfaces accepted that are too large or too small for products of lengths.
///
/// A point with a normal is looked for in every piece; it is proven by an enclosure where the surface can enclose
/// itself. That there is none is concluded from 25 points a piece, which for analytic pieces cannot all be zeros of
/// `r_u × r_v` by accident.
pub fn check_not_collapsed(surface: &dyn Surface) -> Result<(), CollapsedError> {
    let domain = surface.domain();
    let widths = domain.map(|d| d.hi - d.lo);
    let places = [Dir::U, Dir::V].map(|dir| {
        let breaks = surface.breaks(dir);
        (0..breaks.pieces())
            .map(|i| breaks.piece(i))
            .flat_map(|p| PLACES.map(|s| p.lo + (p.hi - p.lo) * s))
            .collect::<Vec<f64>>()
    });
    let limit = [Limit::Above; 2];
    let mut samples = Vec::with_capacity(places[0].len() * places[1].len());
    for &u in &places[0] {
        for &v in &places[1] {
            let jet = surface.jet([u, v], limit, 1);
            let point = jet.point();
            if point.is_finite() && point.abs().max_element() > LARGEST_LENGTH {
                return Err(CollapsedError::TooLarge { u, v, point });
            }
            if !jet.d.iter().all(|d| d.is_finite()) {
                return Err(CollapsedError::NotFinite { u, v, point });
            }
            let along = [jet.partial(1, 0) * widths[0], jet.partial(0, 1) * widths[1]];
            samples.push(([u, v], point, along));
        }
    }
    let extent = |from: DVec3| {
        let distances = samples.iter().map(|s| s.1.distance(from));
        distances.fold(0.0, f64::max)
    };
    let size = samples.first().map_or(0.0, |s| extent(s.1));
    // Not by lengths, which underflow themselves.
    let first = samples.first().map_or(DVec3::ZERO, |s| s.1);
    let spreads = samples.iter().map(|s| (s.1 - first).abs().max_element());
    let spread = spreads.fold(0.0, f64::max);
    if spread > 0.0 && spread < SMALLEST_EXTENT {
        return Err(CollapsedError::TooSmall { size: spread });
    }
    let has_area = |n: f64| n > NEGLIGIBLE * size * size;
    for ([u, v], _, [a, b]) in &samples {
        if !has_area(a.cross(*b).length()) {
            continue;
        }
        let mut boxes = [Box3::ENTIRE; 3];
        surface.enclose_piece([*u, *v].map(Interval::point), limit, 1, &mut boxes);
        let normal = boxes[1].cross(boxes[2]).norm();
        if !normal.is_finite() || normal.lo > 0.0 {
            return Ok(());
        }
    }
    let ([u, v], point, [a, b]) = samples[samples.len() / 2];
    if size <= ROUNDING * extent(DVec3::ZERO) {
        return Err(CollapsedError::Point { point });
    }
    Err(CollapsedError::Curve {
        u,
        v,
        along_u: a / widths[0],
        along_v: b / widths[1],
    })
}
