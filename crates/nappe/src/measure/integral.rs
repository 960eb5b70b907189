//! Integrals over a surface's domain with proven bounds.
//!
//! Over a box with middle m the integrand is its Taylor polynomial of degree d - 1 at m plus terms of degree d with
//! coefficients enclosed over the whole box; both are integrated exactly. The error of a box of size h is of order
//! `h^(d+3)`. The worst boxes are halved until the sum of errors is small enough.

use super::taylor::{Taylor, tighten};
use crate::box3::Box3;
use crate::breaks::{Breaks, Limit};
use crate::interval::Interval;
use crate::mesh::Certainty;
use crate::surface::{Dir, Surface, jet_index, jet_len};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// How accurately to integrate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegralOptions {
    /// The error aimed at, relative to the result (of a volume: to the box around everything).
    pub relative: f64,
    /// The most boxes for each surface. If they do not suffice the certainty says what was reached.
    pub budget: usize,
}

impl Default for IntegralOptions {
    fn default() -> Self {
        Self {
            relative: 1e-6,
            budget: 8000,
        }
    }
}

/// A number with its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The number.
    pub value: f64,
    /// How far it may be from the truth.
    pub certainty: Certainty,
}

/// The degree d. Higher degrees need fewer boxes but each costs more.
const DEGREE: usize = 6;
/// Radians. Over a box where the normal turns more, no root or quotient can be expanded.
const TURN: f64 = 1.0;
/// The order of jets that a degree-d Taylor polynomial of a function of tangents needs.
const ORDER: usize = DEGREE + 1;

/// The Taylor polynomial of degree [`DEGREE`] of an integrand from enclosures of a jet of order [`ORDER`].
pub(super) type Integrand<'a> = &'a dyn Fn(&[Box3], usize) -> Taylor;

struct Cell {
    uv: [Interval; 2],
    limit: [Limit; 2],
    value: Interval,
    error: f64,
    /// The direction to halve: where the terms of the highest degree weigh more.
    next: usize,
    /// Breaks ties, and orders the final sum.
    number: usize,
}

impl PartialEq for Cell {
    fn eq(&self, o: &Self) -> bool {
        self.cmp(o) == Ordering::Equal
    }
}
impl Eq for Cell {}
impl PartialOrd for Cell {
    fn partial_cmp(&self, o: &Self) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl Ord for Cell {
    fn cmp(&self, o: &Self) -> Ordering {
        self.error
            .total_cmp(&o.error)
            .then(o.number.cmp(&self.number))
    }
}

/// `∫ x^n` and `∫ |x|^n` over an interval that contains 0 near its middle.
fn moments(x: Interval, n: usize) -> [Interval; 2] {
    let power = |e: f64| Interval::point(e).powi(n as i32 + 1);
    let over = Interval::point((n + 1) as f64);
    let (low, high) = (power(x.lo), power(x.hi));
    let signed = (high - low) / over;
    let size = if n.is_multiple_of(2) {
        signed
    } else {
        (high + low) / over
    };
    [signed, size]
}

fn over_box(
    surface: &dyn Surface,
    f: Integrand,
    uv: [Interval; 2],
    limit: [Limit; 2],
) -> (Interval, usize) {
    let mut jet = vec![Box3::ENTIRE; jet_len(ORDER)];
    let mut at = jet.clone();
    surface.enclose_piece(uv, limit, ORDER, &mut jet);
    let m = uv.map(Interval::mid);
    surface.enclose_piece(m.map(Interval::point), limit, ORDER, &mut at);
    tighten(
        &mut jet,
        &at,
        [0, 1].map(|d| uv[d] - Interval::point(m[d])),
        ORDER,
    );
    let wide = f(&jet, DEGREE);
    let [x, y] = [0, 1].map(|d| uv[d] - Interval::point(m[d]));
    let whole = [0, 1].map(|d| Interval::point(uv[d].hi) - Interval::point(uv[d].lo));
    let plain = wide.c[0] * whole[0] * whole[1];
    let wider = usize::from(uv[1].width() > uv[0].width());
    if !wide.is_finite() {
        return (plain, turning(surface, uv).unwrap_or(wider));
    }
    let narrow = f(&at, DEGREE);
    // Every degree up to the highest gives an enclosure: lower ones are better over large boxes.
    let mut best = (plain, wider);
    for degree in (2..=DEGREE).step_by(2) {
        let mut sum = Interval::ZERO;
        let mut weight = [0.0; 2];
        for n in 0..=degree {
            for j in 0..=n {
                let i = n - j;
                let ([mx, ax], [my, ay]) = (moments(x, i), moments(y, j));
                let k = jet_index(i, j);
                if n < degree {
                    sum = sum + narrow.c[k] * mx * my;
                    continue;
                }
                let error = wide.c[k].width() * (ax * ay).hi;
                weight[0] += error * i as f64;
                weight[1] += error * j as f64;
                sum = sum + wide.c[k] * mx * my;
                if i % 2 == 1 || j % 2 == 1 {
                    // The monomial changes its sign: half its weight with either sign.
                    let w = 0.5 * wide.c[k].width();
                    sum = sum + Interval::new(-w, w) * ax * ay;
                }
            }
        }
        if sum.is_finite() && sum.width() < best.0.width() {
            best = (sum.meet(best.0), usize::from(weight[1] > weight[0]));
        }
    }
    best
}

/// The direction along which the normal turns by more than [`TURN`] over the box, if any.
pub(super) fn turning(surface: &dyn Surface, uv: [Interval; 2]) -> Option<usize> {
    let turn = [0, 1].map(|d| {
        let normals = [0.125, 0.375, 0.625, 0.875].map(|t| {
            let mut p = uv.map(Interval::mid);
            p[d] = uv[d].lo + t * (uv[d].hi - uv[d].lo);
            surface.jet(p, [Limit::Above; 2], 1).normal()
        });
        let angle = |w: &[Option<glam::DVec3>]| Some(w[0]?.angle_between(w[1]?));
        normals.windows(2).filter_map(angle).sum::<f64>()
    });
    let d = usize::from(turn[1] > turn[0]);
    (turn[d] > TURN).then_some(d)
}

/// The integral over the domain; `enough` says which error is small enough for a value.
pub(super) fn integrate(
    surface: &dyn Surface,
    f: Integrand,
    enough: impl Fn(f64) -> f64,
    budget: usize,
) -> Interval {
    let mut number = 0;
    let mut cell = |uv: [Interval; 2], limit: [Limit; 2]| {
        number += 1;
        let (value, next) = over_box(surface, f, uv, limit);
        let error = if value.is_finite() {
            value.width()
        } else {
            f64::INFINITY
        };
        Cell {
            uv,
            limit,
            value,
            error,
            next,
            number,
        }
    };
    let mut heap = BinaryHeap::new();
    let in_v = surface.breaks(Dir::V);
    let in_u = surface.breaks(Dir::U);
    for i in 0..in_u.pieces() {
        for j in 0..in_v.pieces() {
            heap.push(cell([in_u.piece(i), in_v.piece(j)], [Limit::Above; 2]));
        }
    }
    let mut looks = heap.len();
    let total = |heap: &BinaryHeap<Cell>| {
        let finite = |c: &&Cell| c.error.is_finite();
        let error: f64 = heap.iter().filter(finite).map(|c| c.error).sum();
        let value: f64 = heap.iter().filter(finite).map(|c| c.value.mid()).sum();
        (value, error, heap.iter().filter(|c| !finite(c)).count())
    };
    let (mut value, mut error, mut infinite) = total(&heap);
    let mut done: Vec<Cell> = Vec::new();
    while looks < budget && (infinite > 0 || error > enough(value)) {
        let Some(top) = heap.pop() else { break };
        let d = top.next;
        let m = top.uv[d].mid();
        if m <= top.uv[d].lo || m >= top.uv[d].hi {
            done.push(top);
            break;
        }
        let parts = [
            Interval::new(top.uv[d].lo, m),
            Interval::new(m, top.uv[d].hi),
        ];
        let halves = parts.map(|part| {
            let mut uv = top.uv;
            uv[d] = part;
            cell(uv, top.limit)
        });
        looks += 2;
        let mut count = |c: &Cell, sign: f64| {
            if c.error.is_finite() {
                value += sign * c.value.mid();
                error += sign * c.error;
            } else {
                infinite = if sign > 0.0 {
                    infinite + 1
                } else {
                    infinite - 1
                };
            }
        };
        count(&top, -1.0);
        halves.iter().for_each(|h| count(h, 1.0));
        heap.extend(halves);
    }
    let mut cells = heap.into_vec();
    cells.extend(done);
    cells.sort_by_key(|c| c.number);
    cells.iter().fold(Interval::ZERO, |s, c| s + c.value)
}

/// Nodes of Gauss's rule with four points on [-1, 1], and their weights.
const GAUSS: [[f64; 2]; 4] = [
    [-0.861_136_311_594_052_6, 0.347_854_845_137_453_85],
    [-0.339_981_043_584_856_26, 0.652_145_154_862_546_2],
    [0.339_981_043_584_856_26, 0.652_145_154_862_546_2],
    [0.861_136_311_594_052_6, 0.347_854_845_137_453_85],
];
/// Subdivisions of each analytic piece, along each direction, for an estimate.
const COARSE: usize = 8;

/// The integral of a function of the jet of order 1 without proof: the difference of two rules estimates the error.
pub(super) fn estimate(surface: &dyn Surface, f: &dyn Fn(&[glam::DVec3]) -> f64) -> Measured {
    let rule = |n: usize| {
        let mut sum = 0.0;
        let (bu, bv) = (surface.breaks(Dir::U), surface.breaks(Dir::V));
        for a in 0..bu.pieces() * n {
            for b in 0..bv.pieces() * n {
                let part = |piece: Interval, k: usize| {
                    let h = (piece.hi - piece.lo) / n as f64;
                    [piece.lo + h * (k as f64 + 0.5), 0.5 * h]
                };
                let [um, uh] = part(bu.piece(a / n), a % n);
                let [vm, vh] = part(bv.piece(b / n), b % n);
                for [s, ws] in GAUSS {
                    for [t, wt] in GAUSS {
                        let jet = surface.jet([um + s * uh, vm + t * vh], [Limit::Above; 2], 1);
                        sum += ws * wt * uh * vh * f(&jet.d);
                    }
                }
            }
        }
        sum
    };
    let (coarse, fine) = (rule(COARSE), rule(2 * COARSE));
    Measured {
        value: fine,
        certainty: Certainty::Estimated((fine - coarse).abs()),
    }
}

/// A proven result as a number and its error.
pub(super) fn measured(i: Interval) -> Measured {
    let value = i.mid();
    Measured {
        value,
        certainty: Certainty::Bounded((i.hi - value).max(value - i.lo).next_up()),
    }
}
