//! Enclosures of a NURBS surface by the hulls of its control points.
//!
//! A derivative of a spline is a spline of lower degree, whose points are divided differences of the given ones; over a
//! part of a span it is a Bézier curve, whose points are values of the polar form at the ends of the part. It lies in
//! their convex hull. Both steps are linear in the points, so one matrix for each direction and order does them. The
//! hull shrinks to the exact range with the square of the size of the part.
//!
//! Source: Golovanov, *Geometric modelling*, §3.9; Ramshaw, *Blossoms are polar forms*, Computer Aided Geometric Design 6
//! (1989).

use crate::basis::BSplineBasis;
use crate::breaks::Limit;
use crate::interval::Interval;
use crate::surface::{jet_index, jet_len};
use glam::DVec4;
use smallvec::SmallVec;

type Row = SmallVec<[Interval; 4]>;

/// A number known within an error: sums of products of these are quicker than those of intervals.
#[derive(Clone, Copy)]
struct Within {
    value: f64,
    error: f64,
}

/// The factors of a sum.
type Factors = SmallVec<[Within; 4]>;

/// Some numbers side by side, with their errors.
type Within4 = [[f64; 4]; 2];

impl Within {
    /// With what is lost by rounding in a sum of up to `terms` products with this factor: each product is rounded once,
    /// and at most once more for each term after it.
    fn factor(i: Interval, terms: usize) -> Self {
        let Self { value, error } = Self::from(i);
        let error = error + (terms + 2) as f64 * f64::EPSILON * value.abs();
        Self {
            value,
            error: error * ROUND_UP,
        }
    }

    fn from(i: Interval) -> Self {
        let value = i.mid();
        // The middle is rounded, unless the interval is a number.
        let error = if i.is_point() {
            0.0
        } else {
            (0.5 * i.width() + f64::EPSILON * value.abs()) * ROUND_UP
        };
        Self { value, error }
    }
}

/// Covers the few roundings in sums of errors, all of them positive.
const ROUND_UP: f64 = 1.0 + 1e-13;

/// `Σ f x`, with the error of everything.
fn combine(factors: &[Within], x: impl Fn(usize) -> Within4) -> Within4 {
    let [mut value, mut error] = [[0.0; 4]; 2];
    for (k, f) in factors.iter().enumerate() {
        let [v, e] = x(k);
        for c in 0..4 {
            value[c] += f.value * v[c];
            error[c] += f.value.abs() * e[c] + f.error * (v[c].abs() + e[c]);
        }
    }
    [value, error]
}

/// The numbers that are within the error.
fn interval(value: f64, error: f64) -> Interval {
    // Products below the smallest number lose more than their share.
    let error = error * ROUND_UP + f64::MIN_POSITIVE;
    if value.is_finite() && error.is_finite() {
        Interval {
            lo: (value - error).next_down(),
            hi: (value + error).next_up(),
        }
    } else {
        Interval::ENTIRE
    }
}

/// For one direction and a part of a span: the matrices from the points of the span to the Bézier points of each
/// derivative.
pub(super) struct Part {
    /// The first point of the span.
    first: usize,
    /// `orders[i][a]` is the row of the a-th Bézier point of the i-th derivative. Over a single parameter all of these are
    /// one point, and there is one row.
    orders: SmallVec<[SmallVec<[Row; 4]>; 5]>,
}

impl Part {
    pub(super) fn new(basis: &BSplineBasis, t: Interval, limit: Limit, order: usize) -> Self {
        let (p, knots) = (basis.degree(), basis.knots());
        let span = basis.span(t.mid(), limit);
        let k = |i: usize| Interval::point(knots[i]);
        let [lo, hi] = [t.lo, t.hi].map(Interval::point);
        let zero: Row = SmallVec::from_elem(Interval::ZERO, p + 1);
        // The points of the derivative, each as a row of shares of the given points.
        let mut c: SmallVec<[Row; 4]> = (0..=p)
            .map(|unit| {
                let mut row = zero.clone();
                row[unit] = Interval::ONE;
                row
            })
            .collect();
        let mut orders: SmallVec<[SmallVec<[Row; 4]>; 5]> = SmallVec::new();
        for i in 0..=order.min(p) {
            let d = p - i;
            let rows = if t.is_point() { 1 } else { d + 1 };
            let bezier = (0..rows).map(|a| {
                // The polar form of degree d at d - a times lo and a times hi.
                let mut x = c.clone();
                for r in 1..=d {
                    let at = if r > d - a { hi } else { lo };
                    for j in (r..=d).rev() {
                        let from = span + j - d;
                        let s = (at - k(from)) / (k(from + d + 1 - r) - k(from));
                        let rest = Interval::ONE - s;
                        for unit in 0..=p {
                            x[j][unit] = rest * x[j - 1][unit] + s * x[j][unit];
                        }
                    }
                }
                x[d].clone()
            });
            orders.push(bezier.collect());
            // The points of the next derivative.
            for j in 0..d {
                let at = span + 1 + j - d;
                let factor = Interval::point(d as f64) / (k(at + d) - k(at));
                for unit in 0..=p {
                    c[j][unit] = (c[j + 1][unit] - c[j][unit]) * factor;
                }
            }
            c.truncate(d.max(1));
        }
        Self {
            first: span - p,
            orders,
        }
    }

    /// The share of each point of the span in the mean of the Bézier points of the part.
    fn mean(&self) -> SmallVec<[f64; 4]> {
        let rows = &self.orders[0];
        let share = |k: usize| rows.iter().map(|row| row[k].mid()).sum::<f64>() / rows.len() as f64;
        (0..rows[0].len()).map(share).collect()
    }
}

/// A point in the middle of the part, to measure from: near it a quotient loses least.
pub(super) fn middle(net: &[DVec4], columns: usize, [u, v]: [&Part; 2]) -> DVec4 {
    let (mean_u, mean_v) = (u.mean(), v.mean());
    let mut sum = DVec4::ZERO;
    for (k, f) in mean_u.iter().enumerate() {
        for (l, g) in mean_v.iter().enumerate() {
            sum += net[(u.first + k) * columns + v.first + l] * (f * g);
        }
    }
    if sum.is_finite() { sum } else { DVec4::ZERO }
}

/// Encloses the homogeneous derivatives up to `order`, of a net whose points `point` takes from the given ones.
pub(super) fn derivatives(
    net: &[DVec4],
    columns: usize,
    [u, v]: [&Part; 2],
    point: impl Fn(DVec4) -> [Interval; 4],
    order: usize,
) -> SmallVec<[[Interval; 4]; 16]> {
    let mut out: SmallVec<[[Interval; 4]; 16]> =
        SmallVec::from_elem([Interval::ZERO; 4], jet_len(order));
    let [nu, nv] = [u, v].map(|part| part.orders[0][0].len());
    let local: SmallVec<[Within4; 16]> = (0..nu * nv)
        .map(|k| {
            let p = point(net[(u.first + k / nv) * columns + v.first + k % nv]);
            let p = p.map(Within::from);
            [p.map(|x| x.value), p.map(|x| x.error)]
        })
        .collect();
    let factors =
        |row: &Row| -> Factors { row.iter().map(|&i| Within::factor(i, row.len())).collect() };
    let along_v: SmallVec<[SmallVec<[Factors; 4]>; 5]> = v
        .orders
        .iter()
        .map(|rows| rows.iter().map(factors).collect())
        .collect();
    for (i, rows) in u.orders.iter().enumerate() {
        let mut first = true;
        for row in rows {
            let row = factors(row);
            let half: SmallVec<[Within4; 4]> = (0..nv)
                .map(|l| combine(&row, |k| local[k * nv + l]))
                .collect();
            for (j, columns) in along_v.iter().enumerate().take(order + 1 - i) {
                let o = &mut out[jet_index(i, j)];
                for (b, column) in columns.iter().enumerate() {
                    let [value, error] = combine(column, |l| half[l]);
                    for c in 0..4 {
                        let p = interval(value[c], error[c]);
                        o[c] = if first && b == 0 { p } else { o[c].hull(p) };
                    }
                }
            }
            first = false;
        }
    }
    out
}
