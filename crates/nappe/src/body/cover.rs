//! Bounded pieces of elementary surfaces, as large as the edges of a face ask for.

use crate::box3::Box3;
use crate::breaks::{Breaks, Limit};
use crate::curve::{CurveError, CurveRef, Ellipse, EllipseOptions, Line};
use crate::frame::{Frame, FrameError};
use crate::interval::Interval;
use crate::surface::{
    BilinearError, Elementary, Revolution, RevolutionError, RevolutionOptions, SurfaceRef, bilinear,
};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;
use thiserror::Error;

/// Why an elementary surface cannot be covered.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CoverError {
    /// Planes, cylinders and cones have no end without edges.
    #[error("the face of a {kind} has no edges that bound it")]
    Unbounded {
        /// What it is.
        kind: &'static str,
    },
    /// An edge has no finite box.
    #[error("edge {edge} of the face has no finite box")]
    NotFinite {
        /// Its index in the list.
        edge: usize,
    },
    /// The numbers of the elementary surface describe none.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// The axis has no direction.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The surface cannot be turned, as a torus that passes through itself.
    #[error(transparent)]
    Revolution(#[from] RevolutionError),
    /// The rectangle of a plane is not finite.
    #[error(transparent)]
    Bilinear(#[from] BilinearError),
}

/// The share of the extent by which a cover is larger than its edges on each side: their points must lie inside it also
/// if they are a little off.
const MARGIN: f64 = 0.05;
/// Parts of each piece of an edge whose boxes are taken.
const PARTS: usize = 8;
/// Points of each piece of an edge where its angles are looked at.
const POINTS: usize = 16;

/// A surface with the normal of the elementary one that contains all of it that a face with these edges may use: of a
/// plane a rectangle, of a cylinder a stretch of its height, of a cone all from the apex to beyond the edges, the
/// whole sphere or torus. Round surfaces make a whole turn that starts where fewest edges are; the poles of a
/// sphere are moved away from edges. Cost: some boxes and points for each edge.
///
/// # Errors
/// See [`CoverError`].
pub fn cover(elementary: &Elementary, edges: &[CurveRef]) -> Result<SurfaceRef, CoverError> {
    match *elementary {
        Elementary::Plane { origin, normal } => {
            let frame = Frame::along(origin, normal)?;
            let [x, y, _] = extent("plane", &frame, edges)?.to_array();
            let margin = MARGIN * x.width().max(y.width());
            let at = |x: f64, y: f64| frame.point(DVec3::new(x, y, 0.0));
            let [x, y] = [x, y].map(|i| [i.lo - margin, i.hi + margin]);
            let corners = x.map(|x| y.map(|y| at(x, y)));
            Ok(Arc::new(bilinear(corners)?))
        }
        Elementary::Cylinder {
            axis,
            radius,
            outward,
        } => {
            let z = extent("cylinder", &axis, edges)?.z;
            let margin = MARGIN * (z.width() + radius);
            let at = |z: f64| axis.point(DVec3::new(radius, 0.0, z));
            let profile = Line::new(at(z.lo - margin), at(z.hi + margin))?;
            turned(Arc::new(profile), &axis, edges, !outward)
        }
        Elementary::Cone {
            axis,
            slope,
            outward,
        } => {
            let z = extent("cone", &axis, edges)?.z;
            let height = z.hi + MARGIN * (z.width() + slope.min(1.0) * z.hi.abs());
            let top = axis.point(DVec3::new(slope * height, 0.0, height));
            let profile = Line::new(axis.origin(), top)?;
            turned(Arc::new(profile), &axis, edges, !outward)
        }
        Elementary::Sphere {
            frame,
            radius,
            outward,
        } => {
            let axis = clear_axis(&frame, edges)?;
            let half = |from: f64, to: f64| {
                let options = EllipseOptions {
                    from,
                    to,
                    normal: -axis.y(),
                    x_direction: Some(axis.x()),
                };
                Ellipse::new(axis.origin(), [radius; 2], options)
            };
            let profile = half(-FRAC_PI_2, FRAC_PI_2)?;
            turned(Arc::new(profile), &axis, edges, !outward)
        }
        Elementary::Torus {
            axis,
            major,
            minor,
            outward,
        } => {
            // The profile starts where the fewest edges are, as the turn does.
            let around = |p: DVec3| {
                let c = axis.coordinates(p);
                c.z.atan2(c.x.hypot(c.y) - major)
            };
            let from = clear_angle(points(edges).map(around));
            let options = EllipseOptions {
                from,
                to: from + TAU,
                normal: -axis.y(),
                x_direction: Some(axis.x()),
            };
            let center = axis.point(DVec3::X * major);
            let profile = Ellipse::new(center, [minor; 2], options)?;
            turned(Arc::new(profile), &axis, edges, !outward)
        }
    }
}

/// The whole turn of a profile. Profiles above run upwards where they are farthest from the axis: their turn
/// has its normal inwards there.
fn turned(
    profile: CurveRef,
    axis: &Frame,
    edges: &[CurveRef],
    inward: bool,
) -> Result<SurfaceRef, CoverError> {
    let angle = |p: DVec3| {
        let c = axis.coordinates(p);
        c.y.atan2(c.x)
    };
    let options = RevolutionOptions {
        start: clear_angle(points(edges).map(angle)),
        ..RevolutionOptions::default()
    };
    let profile: CurveRef = if inward {
        profile
    } else {
        Arc::new(crate::curve::Trimmed::reversed(profile))
    };
    Ok(Arc::new(Revolution::new(profile, *axis, options)?))
}

/// A box around the edges in the coordinates of a frame.
fn extent(kind: &'static str, frame: &Frame, edges: &[CurveRef]) -> Result<Box3, CoverError> {
    let mut hull: Option<Box3> = None;
    for (edge, curve) in edges.iter().enumerate() {
        let breaks = curve.breaks();
        for piece in (0..breaks.pieces()).map(|k| breaks.piece(k)) {
            for part in (0..PARTS).map(|k| part(piece, k, PARTS)) {
                let mut own = frame.enclose_coordinates(curve.bounds(part));
                if !own.is_finite() {
                    let ends =
                        [part.lo, part.mid(), part.hi].map(|t| frame.coordinates(curve.point(t)));
                    own = Box3::around(ends).unwrap_or(Box3::ENTIRE);
                }
                if !own.is_finite() {
                    return Err(CoverError::NotFinite { edge });
                }
                hull = Some(hull.map_or(own, |h| h.hull(own)));
            }
        }
    }
    hull.ok_or(CoverError::Unbounded { kind })
}

fn part(piece: Interval, k: usize, of: usize) -> Interval {
    let at = |k: usize| {
        if k == of {
            piece.hi
        } else {
            piece.lo + (piece.hi - piece.lo) * k as f64 / of as f64
        }
    };
    Interval::new(at(k), at(k + 1))
}

/// Points of the edges.
fn points(edges: &[CurveRef]) -> impl Iterator<Item = DVec3> + '_ {
    edges.iter().flat_map(|curve| {
        let pieces = curve.breaks().pieces();
        let piece = move |k: usize| curve.breaks().piece(k);
        let ends =
            (0..pieces).flat_map(move |k| (0..POINTS).map(move |i| part(piece(k), i, POINTS).lo));
        let last = curve.domain().hi;
        let all = ends.chain([last]);
        all.map(|t| curve.jet(t, Limit::Above, 0).point())
            .filter(|p| p.is_finite())
    })
}

/// The middle of the widest gap between angles.
fn clear_angle(angles: impl Iterator<Item = f64>) -> f64 {
    let mut all: Vec<f64> = angles.collect();
    all.sort_by(f64::total_cmp);
    let (Some(&first), Some(&last)) = (all.first(), all.last()) else {
        return 0.0;
    };
    let around = (last, first + TAU);
    let gaps = all.windows(2).map(|w| (w[0], w[1])).chain([around]);
    let widest = gaps.max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)));
    widest.map_or(0.0, |(a, b)| 0.5 * (a + b))
}

/// The frame itself if no edge comes near its poles, or one with the axis that is farthest from them.
fn clear_axis(frame: &Frame, edges: &[CurveRef]) -> Result<Frame, CoverError> {
    let ways: Vec<DVec3> = points(edges)
        .filter_map(|p| (p - frame.origin()).try_normalize())
        .collect();
    // The cosine of the angle to the nearest edge, from either pole.
    let near = |axis: DVec3| ways.iter().map(|w| w.dot(axis).abs()).fold(0.0, f64::max);
    if near(frame.z()) <= CLEAR {
        return Ok(*frame);
    }
    // Directions spread evenly over half a sphere.
    let golden = PI * (3.0 - 5.0f64.sqrt());
    let candidates = (0..AXES).map(|k| {
        let z = (k as f64 + 0.5) / AXES as f64;
        let (s, c) = (golden * k as f64).sin_cos();
        let r = (1.0 - z * z).sqrt();
        frame.x() * (r * c) + frame.y() * (r * s) + frame.z() * z
    });
    let best = candidates.min_by(|a, b| near(*a).total_cmp(&near(*b)));
    let axis = best.unwrap_or(frame.z());
    Ok(Frame::along(frame.origin(), axis)?)
}

/// Edges that stay away from a pole by an angle with this cosine are far enough.
const CLEAR: f64 = 0.95;
/// The axes that are tried.
const AXES: usize = 64;
