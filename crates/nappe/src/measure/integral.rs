//! Integrals over a surface's domain with proven bounds.
//!
//! Over a box with middle m the integrand is its Taylor polynomial of degree d - 1 at m plus terms of degree d with
//! coefficients enclosed over the whole box; both are integrated exactly, several integrands at once. The error of a box of size h is of order
//! `h^(d+3)`. The worst boxes are halved until the sum of errors is small enough.

use super::model::Model;
use super::taylor::{Patch, Taylor};
use crate::breaks::{Breaks, Limit};
use crate::interval::Interval;
use crate::mesh::Certainty;
use crate::ranked::Ranked;
use crate::surface::{Dir, Surface, jet_index};
use glam::DVec3;
use std::collections::BinaryHeap;

/// How accurately to integrate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntegralOptions {
    /// The error aimed at, relative to the result.
    pub relative: f64,
    /// The most boxes for each surface, but at least one for each analytic piece. If they do not suffice the certainty says
    /// what was reached.
    pub budget: usize,
}

impl Default for IntegralOptions {
    fn default() -> Self {
        Self {
            relative: 1e-7,
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

impl std::iter::Sum for Measured {
    /// The errors add up, and the sum is no more certain than its parts.
    fn sum<I: Iterator<Item = Measured>>(parts: I) -> Self {
        let none = Measured {
            value: 0.0,
            certainty: Certainty::Exact,
        };
        parts.fold(none, |a, b| {
            let value = a.value + b.value;
            let rounding = (value.next_up() - value).max(value - value.next_down());
            let e = a.certainty.error() + b.certainty.error();
            let e = if a.value == 0.0 || b.value == 0.0 {
                e
            } else {
                (e + rounding).next_up()
            };
            let certainty = match a.certainty.and(b.certainty) {
                Certainty::Exact if e == 0.0 => Certainty::Exact,
                Certainty::Exact | Certainty::Bounded(_) => Certainty::Bounded(e),
                Certainty::Estimated(_) => Certainty::Estimated(e),
            };
            Measured { value, certainty }
        })
    }
}

/// The degree d. Higher degrees need fewer boxes but each costs more.
pub(super) const DEGREE: usize = 8;
/// Radians. Over a box where tangents or normal turn more, no root or quotient can be expanded.
const TURN: f64 = 1.0;
/// The order of jets that a degree-d Taylor polynomial of a function of tangents needs.
pub(super) const ORDER: usize = DEGREE + 1;

/// An integrand over a box.
pub(super) enum Expansion {
    /// A Taylor polynomial: enclosures of the coefficients over the box and at the centre of expansion.
    Enclosed([Taylor; 2]),
    /// A polynomial and what it differs by.
    Model(Model),
}

impl Expansion {
    fn degree(&self) -> usize {
        match self {
            Expansion::Enclosed([wide, _]) => wide.degree,
            Expansion::Model(m) => m.p.degree,
        }
    }

    fn range(&self, offset: [Interval; 2]) -> Interval {
        match self {
            Expansion::Enclosed([wide, at]) => wide.range(at, offset),
            Expansion::Model(m) => m.range(),
        }
    }

    /// What is known where it is not expanded.
    fn plain(&self) -> Option<Interval> {
        match self {
            Expansion::Enclosed([wide, _]) => (!wide.is_finite()).then_some(wide.c[0]),
            Expansion::Model(m) => (!m.is_finite()).then_some(m.known),
        }
    }
}

/// Integrands over a box.
pub(super) struct Form {
    pub(super) integrands: Vec<Expansion>,
    /// The parameters, measured from the centre of expansion.
    pub(super) offset: [Interval; 2],
    /// True if u and v change places in the polynomials.
    pub(super) exchanged: bool,
    /// True if absolute values are integrated.
    pub(super) absolute: bool,
    /// How much u and v add to what keeps the integrands from being narrow; `None`: as their own terms tell.
    pub(super) weight: Option<[f64; 2]>,
}

/// The integrands over a box in one analytic piece; where nothing can be expanded, the direction in which to halve it.
pub(super) type Integrand<'a> = &'a dyn Fn(&dyn Surface, [Interval; 2]) -> Result<Form, usize>;

/// Integrands of degree [`DEGREE`] from a patch of order [`ORDER`].
pub(super) fn of_patch(
    f: impl Fn(&Patch, usize) -> Vec<[Taylor; 2]>,
) -> impl Fn(&dyn Surface, [Interval; 2]) -> Result<Form, usize> {
    move |surface, uv| {
        let patch = Patch::new(surface, uv, ORDER);
        Ok(Form {
            integrands: f(&patch, DEGREE)
                .into_iter()
                .map(Expansion::Enclosed)
                .collect(),
            offset: patch.offset,
            exchanged: false,
            absolute: false,
            weight: None,
        })
    }
}

struct Cell {
    /// The index of the surface.
    surface: usize,
    uv: [Interval; 2],
    parts: Vec<Part>,
    /// The direction to halve: where the terms of the highest degree weigh more.
    next: usize,
}

/// An integral over a box.
#[derive(Clone, Copy)]
struct Part {
    value: Interval,
    error: f64,
    /// The part of the error that is rounding: halving does not lessen it.
    rounding: f64,
}

impl Part {
    fn new(value: Interval, rounding: f64) -> Self {
        let error = if value.is_finite() {
            value.width()
        } else {
            f64::INFINITY
        };
        Self {
            value,
            error,
            rounding: rounding.min(error),
        }
    }
}

/// `∫ xⁿ` and `∫ |x|ⁿ` over an interval that contains 0, for n up to the degree.
fn moments(x: Interval, degree: usize) -> Vec<[Interval; 2]> {
    let (mut low, mut high) = (Interval::point(x.lo), Interval::point(x.hi));
    let each = |n: usize| {
        let over = Interval::point((n + 1) as f64);
        let signed = (high - low) / over;
        let size = if n.is_multiple_of(2) {
            signed
        } else {
            (high + low) / over
        };
        low = low * Interval::point(x.lo);
        high = high * Interval::point(x.hi);
        [signed, size]
    };
    (0..=degree).map(each).collect()
}

/// The integrals over a box, and the direction to halve.
fn over_box(
    surface: &dyn Surface,
    f: Integrand,
    uv: [Interval; 2],
    units: &[f64],
) -> (Vec<Part>, usize) {
    let form = match f(surface, uv) {
        Ok(form) => form,
        Err(next) => return (vec![Part::new(Interval::ENTIRE, 0.0); units.len()], next),
    };
    let size = {
        let [u, v] = uv.map(|t| Interval::point(t.hi) - Interval::point(t.lo));
        u * v
    };
    let degree = form.integrands[0].degree();
    let powers = form.offset.map(|x| moments(x, degree));
    let mut weight = [0.0; 2];
    let mut lost = false;
    let parts = form.integrands.iter().zip(units).map(|(f, unit)| {
        if let Some(plain) = f.plain() {
            lost = true;
            let value = plain * size;
            let value = if form.absolute { value.abs() } else { value };
            return Part::new(value, 0.0);
        }
        let (part, share) = match f {
            Expansion::Enclosed([wide, narrow]) => one(wide, narrow, &powers, size),
            Expansion::Model(m) => (modelled(m, &powers, size), [0.0; 2]),
        };
        for d in 0..2 {
            weight[d] += share[d] / unit;
        }
        if form.absolute {
            absolute(part, f.range(form.offset), size)
        } else {
            part
        }
    });
    let parts = parts.collect();
    let next = match form.weight {
        Some([u, v]) if (u + v).is_finite() => usize::from((v > u) != form.exchanged),
        None if !lost => usize::from((weight[1] > weight[0]) != form.exchanged),
        _ => halved(surface, uv),
    };
    (parts, next)
}

/// The integral of one polynomial, and how much of its error comes from u and from v.
fn one(
    wide: &Taylor,
    narrow: &Taylor,
    [x, y]: &[Vec<[Interval; 2]>; 2],
    size: Interval,
) -> (Part, [f64; 2]) {
    let plain = wide.c[0] * size;
    // Every degree up to the highest gives an enclosure: lower ones are better over large boxes.
    let mut best: Option<(Interval, f64, [f64; 2])> = None;
    let mut lower = Interval::ZERO;
    for n in 0..=wide.degree {
        let mut highest = Interval::ZERO;
        let mut weight = [0.0; 2];
        let mut same = Interval::ZERO;
        for j in 0..=n {
            let i = n - j;
            let ([mx, ax], [my, ay]) = (x[i], y[j]);
            let k = jet_index(i, j);
            same = same + narrow.c[k] * mx * my;
            highest = highest + wide.c[k] * mx * my;
            let spread = wide.c[k].width();
            if i % 2 == 1 || j % 2 == 1 {
                // The monomial changes its sign: half the spread of its factor with either sign.
                highest = highest + Interval::new(-0.5 * spread, 0.5 * spread) * ax * ay;
            }
            let error = spread * (ax * ay).hi;
            weight[0] += error * i as f64;
            weight[1] += error * j as f64;
        }
        let sum = lower + highest;
        if n >= 2 && sum.is_finite() && best.is_none_or(|b| sum.width() < b.0.width()) {
            best = Some((sum, lower.width(), weight));
        }
        lower = lower + same;
    }
    match best {
        Some((sum, rounding, weight)) => (Part::new(sum.meet(plain), rounding), weight),
        None => (Part::new(plain, 0.0), [0.0; 2]),
    }
}

/// The integral of a model.
fn modelled(m: &Model, [x, y]: &[Vec<[Interval; 2]>; 2], size: Interval) -> Part {
    let mut sum = Interval::ZERO;
    for n in 0..=m.p.degree {
        for j in 0..=n {
            let i = n - j;
            sum = sum + m.p.c[jet_index(i, j)] * x[i][0] * y[j][0];
        }
    }
    Part::new((sum + m.rest * size).meet(m.known * size), sum.width())
}

/// The integral of the absolute value, from the integral and the range of the integrand.
fn absolute(part: Part, range: Interval, size: Interval) -> Part {
    let value = part.value.abs();
    if range.contains(0.0) {
        // The sign may change: no integral is greater than that of the greatest value.
        let most = (Interval::point(range.mag()) * size).hi;
        return Part::new(Interval::new(value.lo.min(most), most), 0.0);
    }
    Part::new(value, part.rounding)
}

/// Samples along the middle lines of a box, for the choice of the direction to halve.
const SAMPLES: [f64; 4] = [0.125, 0.375, 0.625, 0.875];

/// Sums of `f` over steps along the middle line in each direction, for `r_u × r_v`, `r_u` and `r_v`.
fn along(
    surface: &dyn Surface,
    uv: [Interval; 2],
    f: impl Fn(DVec3, DVec3) -> f64,
) -> [[f64; 3]; 2] {
    [0, 1].map(|d| {
        let vectors = SAMPLES.map(|t| {
            let mut p = uv.map(Interval::mid);
            p[d] = uv[d].lo + t * (uv[d].hi - uv[d].lo);
            let jet = surface.jet(p, [Limit::Above; 2], 1);
            [jet.d[1].cross(jet.d[2]), jet.d[1], jet.d[2]]
        });
        [0, 1, 2].map(|k| {
            let steps = vectors.windows(2).map(|w| f(w[0][k], w[1][k]));
            steps.filter(|x| x.is_finite()).sum()
        })
    })
}

/// The direction along which tangents or normal turn more, and by how much.
pub(super) fn turning(surface: &dyn Surface, uv: [Interval; 2]) -> (usize, f64) {
    let turn = along(surface, uv, DVec3::angle_between).map(|a| a.into_iter().fold(0.0, f64::max));
    let d = usize::from(turn[1] > turn[0]);
    (d, turn[d])
}

/// The direction to halve where nothing can be expanded: along which the tangents or the normal turn too much, or else
/// the length of the normal varies more, as it does towards a pole.
pub(super) fn halved(surface: &dyn Surface, uv: [Interval; 2]) -> usize {
    let (d, angle) = turning(surface, uv);
    if angle > TURN {
        return d;
    }
    let [u, v] = along(surface, uv, |a, b| (a.length() - b.length()).abs()).map(|g| g[0]);
    if u == v {
        return usize::from(uv[1].width() > uv[0].width());
    }
    usize::from(v > u)
}

/// Sums over cells, for each integrand.
struct Total {
    parts: Vec<Sum>,
}

#[derive(Clone, Copy, Default)]
struct Sum {
    value: f64,
    error: f64,
    rounding: f64,
    infinite: usize,
}

impl Total {
    fn of(cells: &BinaryHeap<Ranked<Cell>>, count: usize) -> Self {
        let mut t = Self {
            parts: vec![Sum::default(); count],
        };
        cells.iter().for_each(|c| t.add(&c.item, 1.0));
        t
    }

    fn add(&mut self, c: &Cell, sign: f64) {
        for (sum, p) in self.parts.iter_mut().zip(&c.parts) {
            if p.error.is_finite() {
                sum.value += sign * p.value.mid();
                sum.error += sign * p.error;
                sum.rounding += sign * p.rounding;
            } else if sign > 0.0 {
                sum.infinite += 1;
            } else {
                sum.infinite -= 1;
            }
        }
    }

    fn is_enough(&self, goal: &Goal) -> bool {
        let sums = || self.parts.iter().zip(goal.units);
        let largest = sums().fold(0.0, |m: f64, (s, unit)| m.max(s.value.abs() / unit));
        let enough = (goal.relative * largest).max(goal.least);
        // Where half of the error is rounding, more boxes are of no use.
        sums().all(|(s, unit)| {
            s.infinite == 0 && (s.error <= enough * unit || s.error <= 2.0 * s.rounding)
        })
    }
}

/// How accurate several integrals are to be.
pub(super) struct Goal<'a> {
    /// The unit of each: errors are measured in it, and relative to the integral that is largest in its unit.
    pub(super) units: &'a [f64],
    /// The error aimed at, relative to the largest.
    pub(super) relative: f64,
    /// An error that is small enough whatever the integrals are, in units.
    pub(super) least: f64,
    /// The most boxes for each surface, but for one for each analytic piece.
    pub(super) budget: usize,
}

impl Goal<'_> {
    /// One integral.
    pub(super) fn one(options: &IntegralOptions) -> Self {
        Self::several(&[1.0], options)
    }

    /// Several, measured in units.
    pub(super) fn several<'a>(units: &'a [f64], options: &IntegralOptions) -> Goal<'a> {
        Goal {
            units,
            relative: options.relative,
            least: 0.0,
            budget: options.budget,
        }
    }
}

/// The integrals over the domains of all surfaces together: for each surface its parts. The boxes go where the errors
/// are.
pub(super) fn integrate(
    surfaces: &[&dyn Surface],
    f: Integrand,
    goal: &Goal,
) -> Vec<Vec<Interval>> {
    let count = goal.units.len();
    let mut number = 0;
    let mut cell = |surface: usize, uv: [Interval; 2]| {
        number += 1;
        let (parts, next) = over_box(surfaces[surface], f, uv, goal.units);
        let lessened = parts.iter().zip(goal.units);
        Ranked {
            // What halving can lessen.
            rank: lessened
                .map(|(p, unit)| (p.error - p.rounding) / unit)
                .sum(),
            number,
            item: Cell {
                surface,
                uv,
                parts,
                next,
            },
        }
    };
    let mut heap = BinaryHeap::new();
    for (k, surface) in surfaces.iter().enumerate() {
        let (bu, bv) = (surface.breaks(Dir::U), surface.breaks(Dir::V));
        for i in 0..bu.pieces() {
            for j in 0..bv.pieces() {
                heap.push(cell(k, [bu.piece(i), bv.piece(j)]));
            }
        }
    }
    let mut looks = heap.len();
    let budget = goal.budget.saturating_mul(surfaces.len());
    let mut total = Total::of(&heap, count);
    // The differences of sums of large early errors are not trusted for ever.
    let mut recount = 2 * looks;
    while looks < budget {
        if looks >= recount || total.is_enough(goal) {
            recount = 2 * looks;
            total = Total::of(&heap, count);
            if total.is_enough(goal) {
                break;
            }
        }
        let Some(ranked) = heap.pop() else { break };
        let top = &ranked.item;
        let d = top.next;
        let m = top.uv[d].mid();
        if m <= top.uv[d].lo || m >= top.uv[d].hi {
            heap.push(ranked);
            break;
        }
        total.add(top, -1.0);
        for (lo, hi) in [(top.uv[d].lo, m), (m, top.uv[d].hi)] {
            let mut uv = top.uv;
            uv[d] = Interval::new(lo, hi);
            let half = cell(top.surface, uv);
            total.add(&half.item, 1.0);
            heap.push(half);
        }
        looks += 2;
    }
    let mut cells = heap.into_vec();
    cells.sort_by_key(|c| c.number);
    let mut sums = vec![vec![Interval::ZERO; count]; surfaces.len()];
    for Ranked { item: c, .. } in &cells {
        for (sum, part) in sums[c.surface].iter_mut().zip(&c.parts) {
            *sum = *sum + part.value;
        }
    }
    sums
}

/// Nodes of Gauss's rule with four points on [-1, 1], and their weights.
const GAUSS: [[f64; 2]; 4] = [
    [-0.861_136_311_594_052_6, 0.347_854_845_137_453_85],
    [-0.339_981_043_584_856_26, 0.652_145_154_862_546_2],
    [0.339_981_043_584_856_26, 0.652_145_154_862_546_2],
    [0.861_136_311_594_052_6, 0.347_854_845_137_453_85],
];
/// Subdivisions along each direction for an estimate; each analytic piece has at least one.
const COARSE: usize = 8;

/// Integrals of functions of the jet of this order without proof: the difference of two rules estimates the errors.
pub(super) fn estimate<const N: usize>(
    surface: &dyn Surface,
    order: usize,
    f: &dyn Fn(&[DVec3]) -> [f64; N],
) -> [Measured; N] {
    let (bu, bv) = (surface.breaks(Dir::U), surface.breaks(Dir::V));
    let coarse = [bu, bv].map(|b| COARSE.div_ceil(b.pieces()));
    let rule = |[nu, nv]: [usize; 2]| {
        let mut sum = [0.0; N];
        for a in 0..bu.pieces() * nu {
            for b in 0..bv.pieces() * nv {
                let part = |piece: Interval, k: usize, n: usize| {
                    let h = (piece.hi - piece.lo) / n as f64;
                    [piece.lo + h * (k as f64 + 0.5), 0.5 * h]
                };
                let [um, uh] = part(bu.piece(a / nu), a % nu, nu);
                let [vm, vh] = part(bv.piece(b / nv), b % nv, nv);
                for [s, ws] in GAUSS {
                    for [t, wt] in GAUSS {
                        let p = [um + s * uh, vm + t * vh];
                        let values = f(&surface.jet(p, [Limit::Above; 2], order).d);
                        for (sum, value) in sum.iter_mut().zip(values) {
                            *sum += ws * wt * uh * vh * value;
                        }
                    }
                }
            }
        }
        sum
    };
    let (coarse, fine) = (rule(coarse), rule(coarse.map(|n| 2 * n)));
    std::array::from_fn(|k| Measured {
        value: fine[k],
        certainty: Certainty::Estimated((fine[k] - coarse[k]).abs()),
    })
}

/// A proven result as a number and its error; the number is as near to `best` as the proof allows.
pub(super) fn measured(i: Interval, best: f64) -> Measured {
    let value = if best.is_nan() {
        i.mid()
    } else {
        best.clamp(i.lo, i.hi)
    };
    Measured {
        value,
        certainty: Certainty::Bounded((i.hi - value).max(value - i.lo).next_up()),
    }
}

/// The number for a proven result: the middle of the bound, or samples where the bound has missed its goal and they promise to
/// be nearer.
pub(super) fn best(i: Interval, relative: f64, sampled: impl FnOnce() -> Measured) -> f64 {
    if i.width() <= 2.0 * relative * i.mag() {
        return f64::NAN;
    }
    let sampled = sampled();
    let is_nearer = !is_close(i) || sampled.certainty.error() < 0.5 * i.width();
    if is_nearer { sampled.value } else { f64::NAN }
}

/// A bound wider than this share says less about an integral than samples do: they give the number, the bound its error.
const LOOSE: f64 = 0.01;

/// True if the middle of a bound is a better guess than samples.
pub(super) fn is_close(i: Interval) -> bool {
    i.width() <= LOOSE * i.mag()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::bilinear;

    #[test]
    fn absolute_values_of_what_is_not_expanded_are_not_negative() {
        let plane = bilinear([
            [DVec3::ZERO, DVec3::Y],
            [DVec3::X, DVec3::new(1.0, 1.0, 0.0)],
        ]);
        for absolute in [false, true] {
            let integrand = |_: &dyn Surface, uv: [Interval; 2]| {
                let mut wide = Taylor {
                    degree: DEGREE,
                    c: vec![Interval::ENTIRE; crate::surface::jet_len(DEGREE)],
                };
                wide.c[0] = Interval::new(-2.0, -1.0);
                Ok(Form {
                    integrands: vec![Expansion::Enclosed([wide.clone(), wide])],
                    offset: uv.map(|t| t - Interval::point(t.mid())),
                    exchanged: false,
                    absolute,
                    weight: None,
                })
            };
            let options = IntegralOptions {
                budget: 1,
                ..Default::default()
            };
            let plane = plane.as_ref().unwrap();
            let found = integrate(&[plane], &integrand, &Goal::one(&options))[0][0];
            let [lo, hi] = if absolute { [1.0, 2.0] } else { [-2.0, -1.0] };
            assert!(found.lo <= lo && found.hi >= hi, "{found:?}");
            assert!(found.width() < 1.0 + 1e-12, "{found:?}");
        }
    }
}
