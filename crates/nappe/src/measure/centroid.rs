//! Centroids: of the area of surfaces. Those of volumes are in [`solid`](super::solid).

use super::area::element;
use super::integral::{
    Goal, IntegralOptions, Measured, best, estimate, integrate, is_close, measured, of_patch,
};
use super::taylor::{Patch, Taylor};
use crate::box3::Box3;
use crate::interval::Interval;
use crate::mesh::Certainty;
use crate::surface::{Dir, Surface};
use glam::DVec3;

/// A centroid with its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Centroid {
    /// The point.
    pub point: DVec3,
    /// How far it may be from the true one, a length.
    pub certainty: Certainty,
}

impl Centroid {
    /// From a reference point and an enclosure of the way from there.
    pub(super) fn enclosed(reference: DVec3, offset: Box3, proven: bool) -> Self {
        let place = Box3::point(reference) + offset;
        let point = place.mid();
        let error = (place - Box3::point(point)).norm().hi;
        let certainty = if proven && error.is_finite() {
            Certainty::Bounded(error)
        } else {
            Certainty::Estimated(error)
        };
        Self { point, certainty }
    }
}

/// The area of a surface and where its middle is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaCentroid {
    /// The area.
    pub area: Measured,
    /// The centroid `∫ r dA / ∫ dA`. If the area is not known to be more than 0 it may be anywhere in a box around the
    /// surface; `None` if that is not bounded, or the area of several surfaces together not known to be more than 0.
    pub centroid: Option<Centroid>,
}

/// Half the extents of points of a surface, and their middle: what first moments are measured in and from.
pub(super) fn reach(surface: &dyn Surface) -> (DVec3, DVec3) {
    const POINTS: usize = 5;
    let places = |dir: Dir| -> Vec<f64> {
        let breaks = surface.breaks(dir);
        let between = |w: &[crate::breaks::Break]| {
            let (a, b) = (w[0].at, w[1].at);
            (0..POINTS).map(move |k| a + (b - a) * k as f64 / (POINTS - 1) as f64)
        };
        breaks.windows(2).flat_map(between).collect()
    };
    let (us, vs) = (places(Dir::U), places(Dir::V));
    let points = us.iter().flat_map(|&u| vs.iter().map(move |&v| [u, v]));
    let hull = Box3::around(points.map(|p| surface.point(p)).filter(|p| p.is_finite()));
    let hull = hull.unwrap_or(Box3::ZERO);
    let half = hull.to_array().map(|i| 0.5 * i.width());
    (hull.mid(), units(DVec3::from_array(half)))
}

/// Of a flat thing the extent across is rounding: moments across are measured in no less than this share of the largest.
const THIN: f64 = 1e-6;

/// Extents as units: none is 0.
pub(super) fn units(half: DVec3) -> DVec3 {
    let most = half.max_element();
    if most.is_finite() && most > 0.0 {
        half.max(DVec3::splat(THIN * most))
    } else {
        DVec3::ONE
    }
}

/// The area of a surface with its centroid `∫ r dA / ∫ dA`, by one integration.
///
/// `options.relative` is relative to the area, and to the area times the surface's extent for the moments: so the centroid
/// is known to that share of the extent, however far from the origin the surface is. Both are proven unless the surface
/// cannot enclose its derivatives. Cost: about twice that of the area.
pub fn area_centroid(surface: &dyn Surface, options: &IntegralOptions) -> AreaCentroid {
    let (reference, half) = reach(surface);
    let moments = |patch: &Patch, degree: usize| {
        let w = element(patch, degree);
        let moment = |axis: usize| {
            let jets = [(&patch.wide, &w[0]), (&patch.at, &w[1])];
            jets.map(|(jet, w)| from(reference, jet, axis, degree).mul(w))
        };
        let [x, y, z] = [0, 1, 2].map(moment);
        vec![w, x, y, z]
    };
    let integrand = of_patch(moments);
    let goal_units = [1.0, half.x, half.y, half.z];
    let goal = Goal::several(&goal_units, options);
    let found = integrate(&[surface], &integrand, &goal);
    let [area, x, y, z] = [0, 1, 2, 3].map(|k| found[0][k]);
    let sampled = || {
        estimate(surface, 1, &|d| {
            let w = d[1].cross(d[2]).length();
            let r = (d[0] - reference) * w;
            [w, r.x, r.y, r.z]
        })
    };
    let anywhere = || {
        let hull = surface.bounds(surface.domain());
        (hull.is_finite())
            .then(|| Centroid::enclosed(hull.mid(), hull - Box3::point(hull.mid()), true))
    };
    if area.is_finite() && is_close(area) {
        return AreaCentroid {
            area: measured(area, best(area, options.relative, || sampled()[0])),
            centroid: quotient(reference, area, [x, y, z], true).or_else(anywhere),
        };
    }
    let sampled = sampled();
    let [a, x, y, z] = sampled.map(|m| Interval::point(m.value).inflate(m.certainty.error()));
    AreaCentroid {
        area: if area.is_finite() {
            measured(area, sampled[0].value)
        } else {
            sampled[0]
        },
        centroid: quotient(reference, a, [x, y, z], false).or_else(anywhere),
    }
}

/// A coordinate, measured from a reference point.
pub(super) fn from(reference: DVec3, jet: &[Box3], axis: usize, degree: usize) -> Taylor {
    let mut r = Taylor::coordinate(jet, axis, [0, 0], degree);
    r.c[0] = r.c[0] - Interval::point(reference.to_array()[axis]);
    r
}

/// The centroid from first moments about a reference point.
pub(super) fn quotient(
    reference: DVec3,
    whole: Interval,
    moments: [Interval; 3],
    proven: bool,
) -> Option<Centroid> {
    let offset = Box3::from(moments.map(|m| m / whole));
    (whole.lo > 0.0 && offset.is_finite()).then(|| Centroid::enclosed(reference, offset, proven))
}

/// The area and centroid of several surfaces together.
pub fn joint_centroid(parts: &[AreaCentroid]) -> AreaCentroid {
    let area: Measured = parts.iter().map(|p| p.area).sum();
    let first = parts.iter().find_map(|p| p.centroid);
    let together = |reference: DVec3| {
        let mut whole = Interval::ZERO;
        let mut moment = Box3::ZERO;
        let mut proven = true;
        for part in parts {
            let a = Interval::point(part.area.value).inflate(part.area.certainty.error());
            let c = part.centroid?;
            proven &= ![part.area.certainty, c.certainty]
                .iter()
                .any(|c| matches!(c, Certainty::Estimated(_)));
            let off = (Box3::point(c.point) - Box3::point(reference)).inflate(c.certainty.error());
            let a = Interval::new(a.lo.max(0.0), a.hi);
            whole = whole + a;
            moment = moment + off.scale(a);
        }
        quotient(reference, whole, moment.to_array(), proven)
    };
    AreaCentroid {
        area,
        centroid: first.and_then(|c| together(c.point)),
    }
}
