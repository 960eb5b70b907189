//! What is missing between two sides that meet within a gap: a proven bound of its area.
//!
//! Let a and b be the sides and φ any correspondence of their parameters. The ruled strip `(1-s) a(t) + s b(φ(t))` closes
//! the gap; its area is at most `∫ |a - b∘φ| ½ (|a'| + |(b∘φ)'|) dt`. The border that is left consists of the segments
//! from `a` to `b∘φ` at the ends, and of what φ leaves out of b or passes twice where its pieces do not meet exactly.

use super::along::{Along, ORDER, Vector, taylor};
use super::continuity::{Pair, SideOf, enclose};
use crate::box3::Box3;
use crate::breaks::Limit;
use crate::interval::Interval;
use crate::mesh::shared::{Edge, matching};

/// The most parts of a joint, and the parts of a whole side where its length is bounded.
const PARTS: usize = 512;
const LENGTH_PARTS: usize = 16;

/// The order of the Taylor forms of a side's speed: a pole of a rational surface is all the closer a point.
const LENGTH_ORDER: usize = 10;

/// Proven bounds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Strip {
    /// The area of the strip.
    pub(super) area: f64,
    /// The length of the border that the strip leaves open.
    pub(super) border: f64,
}

/// The strip between sides that agree within `tol`, bounded more closely until the area is at most `enough` or the work
/// is done. `None` if nothing can be proven.
pub(super) fn strip(a: SideOf, b: SideOf, tol: f64, enough: f64) -> Option<Strip> {
    let [a, b] = [a, b].map(|(surface, side)| Along {
        edge: Edge::new(surface, side),
    });
    let map = matching(&a.edge, &b.edge, tol)?;
    let speed = greatest_speed(&b);
    let range = b.edge.range;
    let pair = Pair::new(a, b, &map);
    let mut parts: Vec<(Interval, [f64; 2])> = pair
        .cells
        .iter()
        .map(|c| (c.t, between(&pair, c.t)))
        .collect();
    loop {
        let area: f64 = parts.iter().map(|p| p.1[1]).sum();
        let widest = (0..parts.len()).max_by(|&i, &j| parts[i].1[1].total_cmp(&parts[j].1[1]))?;
        let t = parts[widest].0;
        let m = t.mid();
        if area <= enough || parts.len() >= PARTS || m <= t.lo || m >= t.hi {
            break;
        }
        let halves = [Interval { hi: m, ..t }, Interval { lo: m, ..t }];
        parts[widest] = (halves[0], between(&pair, halves[0]));
        parts.push((halves[1], between(&pair, halves[1])));
    }
    let gap = parts.iter().map(|p| p.1[0]).fold(0.0, f64::max);
    let mut area: f64 = parts.iter().map(|p| p.1[1]).sum();
    // Where pieces of φ do not meet, an arc of b is seen from one point of a: a cone over it closes the hole.
    let arc = |from: Interval, to: Interval| (speed * (to - from)).mag();
    let ends = |k: usize| {
        let c = &pair.cells[k];
        [c.t.lo, c.t.hi].map(|t| c.series(Interval::point(t)).c[0])
    };
    let last = pair.cells.len() - 1;
    for k in 0..last {
        let missed = arc(ends(k)[1], ends(k + 1)[0]);
        area += 0.5 * missed * (gap + missed);
    }
    let [start, end] = if pair.is_reversed() {
        [range.hi, range.lo]
    } else {
        [range.lo, range.hi]
    }
    .map(Interval::point);
    let border = 2.0 * gap + arc(ends(0)[0], start) + arc(ends(last)[1], end);
    let found = Strip {
        area: area * ROUND_UP,
        border: border * ROUND_UP,
    };
    (found.area.is_finite() && found.border.is_finite()).then_some(found)
}

/// Covers the roundings of the sums of some hundred positive numbers.
const ROUND_UP: f64 = 1.0 + 1e-12;

/// Bounds of the distance and of the area over a part.
fn between(pair: &Pair, t: Interval) -> [f64; 2] {
    let form = pair.vectors(t, t.mid(), Limit::Above, 0, |f| f.series(0, 0));
    let difference = |[a, b]: &[Vector; 2]| -> Vector { [0, 1, 2].map(|i| a[i].sub(&b[i])) };
    let gap = enclose(&difference(&form.at), &difference(&form.over), form.x, 0);
    let speed = |v: &Vector| Box3::from([0, 1, 2].map(|i| v[i].c[1])).norm();
    let speeds = form.over.each_ref().map(speed);
    let width = Interval::point(t.hi) - Interval::point(t.lo);
    let half = Interval::point(0.5);
    let area = gap.norm() * (speeds[0] + speeds[1]) * half * width;
    [gap.norm().hi, area.hi]
}

/// The greatest speed along a side.
fn greatest_speed(a: &Along) -> Interval {
    let parts = speeds(a, LENGTH_PARTS);
    parts.iter().fold(Interval::ZERO, |s, p| s.hull(p.1))
}

/// An upper bound of the length of a side, bounded more closely until it is at most `enough` or the work is done.
pub(super) fn length(side: SideOf, enough: f64) -> f64 {
    let a = Along {
        edge: Edge::new(side.0, side.1),
    };
    let mut parts = LENGTH_PARTS;
    loop {
        let sum = speeds(&a, parts).iter().fold(Interval::ZERO, |s, &(t, v)| {
            s + v * (Interval::point(t.hi) - Interval::point(t.lo))
        });
        if sum.hi <= enough || parts >= PARTS {
            return sum.hi;
        }
        parts *= 2;
    }
}

/// Parts of a side, so many for each analytic piece, with their speeds.
fn speeds(a: &Along, parts: usize) -> Vec<(Interval, Interval)> {
    let breaks = a.breaks();
    let mut out = Vec::new();
    for w in breaks.windows(2) {
        let at = |k: usize| {
            if k == parts {
                w[1]
            } else {
                w[0] + (w[1] - w[0]) * k as f64 / parts as f64
            }
        };
        for k in 0..parts {
            let t = Interval::new(at(k), at(k + 1));
            out.push((t, speed(a, t)));
        }
    }
    out
}

/// The speed along a part, by Taylor's formula from its middle: beside a pole of a rational surface the terms of an
/// enclosure over the whole part would not cancel.
fn speed(a: &Along, t: Interval) -> Interval {
    let m = t.mid();
    let series = |t: Interval| {
        let fields = a.fields(t, Limit::Above, LENGTH_ORDER - ORDER);
        fields.series_to(LENGTH_ORDER, 0, 0)
    };
    let (at, over) = (series(Interval::point(m)), series(t));
    let x = t - Interval::point(m);
    let tangent = [0, 1, 2].map(|i| {
        let (at, over) = (at[i].derivative(), over[i].derivative());
        taylor(&at, &over, x, 0).meet(over.c[0])
    });
    Box3::from(tangent).norm()
}
