//! How near is near enough: the distance within which sides count as one depends on what they belong to.
//!
//! A tolerance fit for a whole model may be larger than one of its surfaces; then all sides of that surface would be one
//! point, and an open sheet would count as closed. So the distance is never more than a small share of the surface itself.

use super::shared::Edge;
use crate::surface::{Dir, Side};

/// The share of a surface, measured across a side, that a gap along the side may have. Larger, and slits would be closed;
/// smaller, and what is joined roughly on purpose would fall apart.
pub(crate) const SHARE: f64 = 0.01;
/// Lines across a side that are measured, and parts of each.
const LINES: usize = 5;
const PARTS: usize = 8;

impl Edge<'_> {
    /// The side counts as one point if it is no larger than this.
    pub(crate) fn point_within(&self, weld: f64) -> f64 {
        weld.min(SHARE * self.across())
    }

    /// The side may be joined to another no farther than this.
    pub(crate) fn join_within(&self, weld: f64) -> f64 {
        weld.min(SHARE * self.across().min(length(self)))
    }

    /// The length of the longest of some lines from the side to the opposite one.
    fn across(&self) -> f64 {
        let across = match self.side.across() {
            Dir::U => Side::South,
            Dir::V => Side::West,
        };
        let line = Edge::new(self.surface, across);
        (0..LINES)
            .map(|k| {
                let at = self.sample(2 * k + 1, 2 * LINES);
                length(&Edge { at, ..line })
            })
            .fold(0.0, f64::max)
    }
}

/// The length of a polygon through points of the line.
fn length(e: &Edge) -> f64 {
    let point = |k: usize| e.point(e.sample(k, PARTS));
    (0..PARTS).map(|k| point(k).distance(point(k + 1))).sum()
}
