//! Where surfaces that move leave each other.

use super::rate::Moving;
use crate::breaks::Limit;
use crate::mesh::Joints;
use crate::mesh::shared::{Edge, matching};
use crate::surface::{Dir, Side, jet_index};
use glam::DVec3;
use std::fmt;

/// Places that are looked at along a side.
const SAMPLES: usize = 64;
/// Relative to the greatest speed: what is less is rounding, or a joint of sides that are not exactly one curve.
const PARTS: f64 = 1e-6;

/// A joint of a shell that opens as its surfaces move, so that beside this place nothing is closed: the volume, its
/// centroid and its inertia have no derivatives.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub struct Opening {
    /// The surface and side that lead.
    pub first: (usize, Side),
    /// The surface and side that leave them; `None` where a side that is one point becomes a curve.
    pub second: Option<(usize, Side)>,
    /// How fast, square to the joint: units of length for each unit of the parameter. The greatest found at samples.
    pub speed: f64,
}

impl fmt::Display for Opening {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let speed = crate::significant(self.speed, 3);
        let (k, side) = self.first;
        match self.second {
            Some((l, other)) => write!(
                f,
                "the {side} side of surface {k} and the {other} side of surface {l} part at a speed of {speed}"
            ),
            None => write!(
                f,
                "the {side} side of surface {k} is one point and opens at a speed of {speed}"
            ),
        }
    }
}

/// The joint among those of some surfaces that opens the fastest; sides slide along each other as they like. `weld` is the
/// distance within which sides were joined.
pub(super) fn opening(
    parts: &[Moving],
    joined: &Joints,
    own: impl Fn(usize) -> bool,
    weld: f64,
) -> Option<Opening> {
    let fastest = (0..parts.len()).filter(|&k| own(k));
    let fastest = fastest.map(|k| parts[k].speed()).fold(0.0, f64::max);
    let edge = |(k, side): (usize, Side)| Edge::new(parts[k].surface.as_ref(), side);
    let velocity = |(k, side): (usize, Side), t: f64| match &parts[k].velocity {
        Some(v) => v.point(edge((k, side)).uv(t)),
        None => DVec3::ZERO,
    };
    let joints = joined.joints.iter().filter(|j| own(j.first.0));
    let seams = joints.filter_map(|j| {
        let [a, b] = [edge(j.first), edge(j.second)];
        let map = matching(&a, &b, weld)?;
        let speeds = (0..=SAMPLES).map(|k| {
            let t = a.sample(k, SAMPLES);
            let s = map.partner(0, t, a.point(t), &b);
            let apart = velocity(j.first, t) - velocity(j.second, s);
            match along(&a, t).try_normalize() {
                Some(tangent) => apart.cross(tangent).length(),
                None => apart.length(),
            }
        });
        Some(Opening {
            first: j.first,
            second: Some(j.second),
            speed: speeds.fold(0.0, f64::max),
        })
    });
    let own_points = (0..parts.len()).filter(|&k| own(k) && parts[k].velocity.is_some());
    let points = own_points.flat_map(|k| joined.collapsed[k].iter().map(move |&s| (k, s)));
    let points = points.map(|side| {
        let e = edge(side);
        let at = |k: usize| velocity(side, e.sample(k, SAMPLES));
        let speeds = (1..=SAMPLES).map(|k| at(k).distance(at(0)));
        Opening {
            first: side,
            second: None,
            speed: speeds.fold(0.0, f64::max),
        }
    });
    seams
        .chain(points)
        .filter(|o| o.speed > PARTS * fastest)
        .max_by(|a, b| a.speed.total_cmp(&b.speed))
}

/// The derivative along a side.
fn along(edge: &Edge, t: f64) -> DVec3 {
    let at = match edge.side.along() {
        Dir::U => jet_index(1, 0),
        Dir::V => jet_index(0, 1),
    };
    let limit = |upper: bool| if upper { Limit::Below } else { Limit::Above };
    let across = limit(edge.side.is_upper());
    let here = limit(t >= edge.range.hi);
    let limits = match edge.side.along() {
        Dir::U => [here, across],
        Dir::V => [across, here],
    };
    edge.surface.jet(edge.uv(t), limits, 1).d[at]
}
