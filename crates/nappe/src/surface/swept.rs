//! Surfaces as curves that are carried along, where that is known exactly.

use super::Elementary;
use crate::basis::{BSplineBasis, Functions};
use crate::exact::{NurbsCurve, NurbsSurface};
use crate::frame::Frame;
use glam::{DAffine3, DVec3, DVec4, Vec4Swizzles};

/// Relative to the largest coordinate: the rounding of the points of two rows that were made from each other. Larger would
/// cost the control points digits when they are made from each other again.
const SAME: f64 = 4.0 * f64::EPSILON;
/// Relative to the way between two rows: with more rounding than this it has no direction.
const VAGUE: f64 = 1e-9;

/// A surface as a curve that is turned about an axis or moved along a vector: the whole surface, with all of the curve.
#[derive(Clone, Debug)]
pub enum Swept {
    /// The curve turned about z, counter-clockwise seen from the tip of z.
    Turned {
        /// The curve where the turn begins.
        curve: NurbsCurve,
        /// The axis is the frame's z.
        axis: Frame,
        /// How far it turns, radians, in (0, 2π].
        angle: f64,
        /// Whether the given surface's `r_u × r_v` is the curve's direction × that of the turn, and not opposite.
        same: bool,
    },
    /// The curve moved.
    Moved {
        /// The curve where the way begins.
        curve: NurbsCurve,
        /// The way.
        along: DVec3,
        /// Whether the given surface's `r_u × r_v` is the curve's direction × the way, and not opposite.
        same: bool,
    },
}

impl Swept {
    /// The image under an affine map; `None` if circles do not stay circles.
    pub fn transformed(&self, map: &DAffine3) -> Option<Self> {
        Some(match self {
            Swept::Turned {
                curve,
                axis,
                angle,
                same,
            } => Swept::Turned {
                curve: curve.transformed(map),
                axis: Elementary::turned_axis(map, axis)?,
                angle: *angle,
                same: *same,
            },
            Swept::Moved { curve, along, same } => Swept::Moved {
                curve: curve.transformed(map),
                along: map.matrix3 * *along,
                same: *same,
            },
        })
    }

    /// The same with the normal on the other side.
    pub fn flipped(mut self) -> Self {
        let (Swept::Turned { same, .. } | Swept::Moved { same, .. }) = &mut self;
        *same = !*same;
        self
    }
}

/// A NURBS surface of two rows or two columns that are one curve in two places.
pub(super) fn moved(n: &NurbsSurface) -> Option<Swept> {
    let (u, v) = (n.basis_u(), n.basis_v());
    let points = n.homogeneous();
    let flat = |b: &BSplineBasis| b.degree() == 1 && b.count() == 2 && b.is_clamped();
    let (basis, rows, same): (_, Vec<[DVec4; 2]>, bool) = if flat(v) {
        let pairs = points.chunks_exact(2).map(|p| [p[0], p[1]]);
        (u, pairs.collect(), true)
    } else if flat(u) {
        let (first, second) = points.split_at(v.count());
        let pairs = first.iter().zip(second).map(|(p, q)| [*p, *q]);
        (v, pairs.collect(), false)
    } else {
        return None;
    };
    if !basis.is_clamped() {
        return None;
    }
    let at = |p: DVec4| p.xyz() / p.w;
    let ways: Vec<DVec3> = rows.iter().map(|[p, q]| at(*q) - at(*p)).collect();
    let along = ways.iter().sum::<DVec3>() / ways.len() as f64;
    let size = rows.iter().flatten().map(|p| at(*p).abs().max_element());
    let size = size.fold(0.0, f64::max);
    let off = ways.iter().map(|w| w.distance(along)).fold(0.0, f64::max);
    let weighed = rows
        .iter()
        .all(|[p, q]| (p.w - q.w).abs() <= SAME * p.w.abs());
    if !(weighed && off <= SAME * size && off <= VAGUE * along.length() && along != DVec3::ZERO) {
        return None;
    }
    let curve = rows.iter().map(|[p, _]| *p).collect();
    Some(Swept::Moved {
        curve: NurbsCurve::from_homogeneous(basis.clone(), curve),
        along,
        same,
    })
}
