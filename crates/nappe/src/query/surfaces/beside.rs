//! Curves that pass a box of parameters, or meet it only at a side of the rectangles.
//!
//! Where a curve goes through a corner, creases or seams of both surfaces at one point, it enters two of the pairs of rectangles
//! that meet there and only touches the others; where it goes past the corner, there are pairs it does not even touch. Newton's
//! method then leads out of the rectangles from all boxes nearby, however small. Two things settle them:
//!
//! **A point on the side.** If the curve has a point on the side beyond which it was found, within what counts as on it, it is
//! followed from there, out of the rectangles on both ends. The boxes of these steps hold nothing but that curve.
//!
//! **Past.** Let a box B be proven to hold one arc, with one solution for each value of parameter k in its range, and z be a
//! solution in it. If `s_j` encloses the slope of parameter j by k on the arc, then by the mean value theorem all solutions of
//! B lie in the cone `x_j ∈ z_j + s_j (x_k - z_k)`. A smaller box in B that the cone misses holds no solution.

use super::pair::{Box4, Knot, Pair, Place, null, others};
use crate::interval::Interval;
use crate::query::solve::encloses;
use std::array::from_fn;

/// The room around a box, relative to its own longest side and that to the curve, both in space.
const ROOM: f64 = 0.5;
/// How far away a curve may be, in longest sides of the box.
const FAR: f64 = 4.0;
/// How often the cone narrows a box.
const NARROWED: usize = 3;

impl Pair {
    /// The parameter by which a curve is steepest at a place, in space.
    pub(super) fn along(&self, x: &Place) -> usize {
        let (_, g) = self.at(x);
        let null = null(&g);
        let weight: Place = from_fn(|j| null[j].abs() * g[j].length());
        let steepest = (0..4).max_by(|&i, &j| weight[i].total_cmp(&weight[j]));
        steepest.unwrap_or(0)
    }

    /// True if a place counts as in the rectangles.
    pub(super) fn holds(&self, x: &Place) -> bool {
        (0..4).all(|j| self.outer[j].contains(x[j]))
    }

    /// A place on the side beyond which another one of the same curve lies, if it counts as in the rectangles.
    pub(super) fn on_side(&self, beyond: &Place) -> Option<Place> {
        let held = self.held(*beyond);
        let off = |j: usize| (held[j] - beyond[j]).abs() / self.rect[j].width();
        let j = (0..4).max_by(|&i, &j| off(i).total_cmp(&off(j)))?;
        let mut guess = *beyond;
        guess[j] = held[j];
        self.with(guess, j).filter(|x| self.holds(x))
    }

    /// True if a box is proven to hold no solution, by a curve through a place near it.
    pub(super) fn passes(&self, cell: &Box4, near: &Place) -> bool {
        self.passed(cell, near).unwrap_or(false)
    }

    fn passed(&self, cell: &Box4, near: &Place) -> Option<bool> {
        let k = self.along(near);
        let knot = self.knot(*near, k)?;
        let hull: Box4 = from_fn(|j| cell[j].hull(knot.zero[j]));
        let side = |b: &Box4| {
            (0..4)
                .map(|j| knot.scale[j] * b[j].width())
                .fold(0.0, f64::max)
        };
        if side(&hull) > FAR * side(cell) {
            return None;
        }
        let room = ROOM * side(&hull);
        let bounds: Box4 = from_fn(|j| {
            if j == k {
                hull[j]
            } else {
                hull[j].inflate(room / knot.scale[j])
            }
        });
        let mut guess = *near;
        guess[k] = bounds[k].mid();
        let centre = self.with(guess, k)?;
        let arc = self.contraction(&centre, &bounds, k)?;
        if !arc.proves(&bounds) || !encloses(&bounds, &knot.zero) {
            return None;
        }
        Some(is_missed(*cell, &knot, k, arc.slopes()?))
    }
}

/// True if the cone from a solution with these slopes of the other parameters by parameter k misses a box.
fn is_missed(mut cell: Box4, from: &Knot, k: usize, slopes: [Interval; 3]) -> bool {
    let at = Interval::point(from.x[k]);
    for _ in 0..NARROWED {
        for (j, slope) in others(k).into_iter().zip(slopes) {
            let cone = from.zero[j] + slope * (cell[k] - at);
            let Some(part) = cone.intersection(cell[j]) else {
                return true;
            };
            cell[j] = part;
            if slope.contains(0.0) {
                continue;
            }
            let Some(part) = (at + (part - from.zero[j]) / slope).intersection(cell[k]) else {
                return true;
            };
            cell[k] = part;
        }
    }
    false
}
