//! How near is near enough: the distance within which sides count as one depends on what they belong to.
//!
//! A tolerance fit for a whole model may be larger than one of its surfaces; then all sides of that surface would be one
//! point, and an open sheet would count as closed. So the distance is never more than a small share of the surface itself.

use super::lines::index;
use super::shared::Edge;
use crate::surface::{Dir, Side, Surface};
use glam::DVec3;

/// The share of a surface, measured across a side, that a gap along the side may have. Larger, and slits would be closed;
/// smaller, and what is joined roughly on purpose would fall apart.
pub(crate) const SHARE: f64 = 0.01;
/// Lines across a side that are measured, and parts of each.
const LINES: usize = 5;
const PARTS: usize = 8;

/// For one side of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Within {
    /// The side counts as one point if it is no larger than this.
    pub(crate) point: f64,
    /// The side may be joined to another no farther than this.
    pub(crate) join: f64,
}

/// How near is near enough for the sides of a surface, when `weld` is for the model.
pub(crate) fn within(surface: &dyn Surface, weld: f64) -> [Within; 4] {
    let across = [Dir::U, Dir::V].map(|dir| longest(surface, dir));
    Side::ALL.map(|side| {
        let across = across[index(side.across())];
        let edge = Edge::new(surface, side);
        let along = length(&edge.points(&edge.parts(PARTS)));
        Within {
            point: weld.min(SHARE * across),
            join: weld.min(SHARE * across.min(along)),
        }
    })
}

/// The length of the longest of some lines along a direction.
fn longest(surface: &dyn Surface, dir: Dir) -> f64 {
    let [u, v] = [Side::South, Side::West].map(|side| {
        let edge = Edge::new(surface, side);
        if side.along() == dir {
            edge.parts(PARTS)
        } else {
            (0..LINES)
                .map(|k| edge.sample(2 * k + 1, 2 * LINES))
                .collect()
        }
    });
    let mut points = vec![DVec3::ZERO; u.len() * v.len()];
    surface.grid(&u, &v, &mut points);
    let line = |k: usize| -> Vec<DVec3> {
        match dir {
            Dir::U => points.iter().skip(k).step_by(LINES).copied().collect(),
            Dir::V => points[k * v.len()..][..v.len()].to_vec(),
        }
    };
    (0..LINES).map(|k| length(&line(k))).fold(0.0, f64::max)
}

/// The length of a polygon.
pub(super) fn length(points: &[DVec3]) -> f64 {
    points.windows(2).map(|p| p[0].distance(p[1])).sum()
}
