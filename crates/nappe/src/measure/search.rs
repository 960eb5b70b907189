//! The greatest value of a function of a surface's jet, by branch and bound.

use super::integral::turning;
use super::taylor::{Taylor, tighten};
use crate::box3::Box3;
use crate::breaks::{Breaks, Limit};
use crate::interval::Interval;
use crate::mesh::Certainty;
use crate::surface::{Dir, Surface, SurfaceJet, jet_len};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// How hard to look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchOptions {
    /// The search ends when the proven bound is this close to the value found, relative to the value.
    pub relative: f64,
    /// The most boxes that are looked at. If they do not suffice the certainty says what was reached.
    pub budget: usize,
}

impl Default for SearchOptions {
    fn default() -> Self {
        Self {
            relative: 1e-6,
            budget: 10_000,
        }
    }
}

/// An extreme value over a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extreme {
    /// The value, taken on at `uv`.
    pub value: f64,
    /// The parameters of the place.
    pub uv: [f64; 2],
    /// How far the true extreme may lie beyond `value`.
    pub certainty: Certainty,
}

struct Candidate {
    uv: [Interval; 2],
    upper: f64,
    /// The direction to halve.
    next: usize,
    /// Breaks ties, for one result whatever the heap does.
    number: usize,
}

impl PartialEq for Candidate {
    fn eq(&self, o: &Self) -> bool {
        self.cmp(o) == Ordering::Equal
    }
}
impl Eq for Candidate {}
impl PartialOrd for Candidate {
    fn partial_cmp(&self, o: &Self) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl Ord for Candidate {
    fn cmp(&self, o: &Self) -> Ordering {
        self.upper
            .total_cmp(&o.upper)
            .then(o.number.cmp(&self.number))
    }
}

/// The value of a function at a place; `None` where it has none.
pub(super) type Value<'a> = &'a dyn Fn(&SurfaceJet) -> Option<f64>;
/// The Taylor polynomial of the function, of the given degree, from enclosures of a jet.
pub(super) type Bound<'a> = &'a dyn Fn(&[Box3], usize) -> Taylor;

/// The degree of the Taylor polynomials that bound the function: with 2 the error over a box of size h is of order h³
/// beyond the function's own range.
const DEGREE: usize = 2;

/// The largest value of a function of the jet of the given order, searched piece by piece; `None` if the function has no value anywhere it was
/// looked for.
pub(super) fn largest(
    surface: &dyn Surface,
    order: usize,
    value: Value,
    bound: Bound,
    options: &SearchOptions,
) -> Option<Extreme> {
    let mut best: Option<(f64, [f64; 2])> = None;
    let mut number = 0;
    let mut look = |uv: [Interval; 2], best: &mut Option<(f64, [f64; 2])>| {
        number += 1;
        let m = uv.map(Interval::mid);
        let total = order + DEGREE;
        let mut jet = vec![Box3::ENTIRE; jet_len(total)];
        let mut at = jet.clone();
        let above = [Limit::Above; 2];
        surface.enclose_piece(uv, above, total, &mut jet);
        surface.enclose_piece(m.map(Interval::point), above, total, &mut at);
        let offset = [0, 1].map(|d| uv[d] - Interval::point(m[d]));
        tighten(&mut jet, &at, offset, total);
        let wide = bound(&jet, DEGREE);
        let upper = wide.range(&bound(&at, DEGREE), offset).hi;
        // Halved next: where the remainder weighs more, or where the normal turns too much for any remainder.
        let weight = |k: usize, d: usize| wide.c[k].width() * offset[d].mag().powi(2);
        let next = if wide.is_finite() {
            usize::from(weight(5, 1) > weight(3, 0))
        } else {
            turning(surface, uv).unwrap_or(usize::from(uv[1].width() > uv[0].width()))
        };
        let ends = |k: usize| [[uv[0].lo, uv[0].hi][k & 1], [uv[1].lo, uv[1].hi][k >> 1]];
        for k in 0..5 {
            let p = if k == 4 { m } else { ends(k) };
            let limit = [0, 1].map(|d| {
                if p[d] < m[d] {
                    Limit::Above
                } else {
                    Limit::Below
                }
            });
            if let Some(x) = value(&surface.jet(p, limit, order)).filter(|x| x.is_finite())
                && best.is_none_or(|(b, _)| x > b)
            {
                *best = Some((x, p));
            }
        }
        Candidate {
            uv,
            upper,
            next,
            number,
        }
    };
    let mut heap = BinaryHeap::new();
    let (bu, bv) = (surface.breaks(Dir::U), surface.breaks(Dir::V));
    for i in 0..bu.pieces() {
        for j in 0..bv.pieces() {
            heap.push(look([bu.piece(i), bv.piece(j)], &mut best));
        }
    }
    let mut looks = heap.len();
    // What the search can no longer split.
    let mut floor = f64::NEG_INFINITY;
    while let Some(top) = heap.pop() {
        let good = best.map_or(f64::INFINITY, |(b, _)| b + options.relative * b.abs());
        if best.is_some() && top.upper <= good || looks >= options.budget {
            heap.push(top);
            break;
        }
        let d = top.next;
        let m = top.uv[d].mid();
        if m <= top.uv[d].lo || m >= top.uv[d].hi {
            floor = floor.max(top.upper);
            continue;
        }
        let parts = [
            Interval::new(top.uv[d].lo, m),
            Interval::new(m, top.uv[d].hi),
        ];
        for part in parts {
            let mut uv = top.uv;
            uv[d] = part;
            heap.push(look(uv, &mut best));
        }
        looks += 2;
    }
    let (value, uv) = best?;
    let upper = heap.peek().map_or(floor, |c| c.upper.max(floor));
    let certainty = if upper.is_finite() {
        Certainty::Bounded((upper - value).max(0.0).next_up())
    } else {
        Certainty::Estimated(options.relative * value.abs())
    };
    Some(Extreme {
        value,
        uv,
        certainty,
    })
}
