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
use crate::interval::{Interval, greater};
use crate::surface::{jet_index, jet_len};
use glam::DVec4;
use smallvec::SmallVec;

/// The numbers of a point side by side.
type Point = [f64; 4];

/// Half a unit in the last place of 1.
const ROUNDING: f64 = 0.5 * f64::EPSILON;
/// Covers the few roundings in sums and products of errors, all of them positive.
const ROUND_UP: f64 = 1.0 + 1e-13;

/// The matrix from the points of a span to the Bézier points of one derivative over a part of it.
struct Matrix {
    /// A row for each Bézier point. Over a single parameter all of these are one point, and there is one row.
    rows: SmallVec<[f64; 16]>,
    /// No sum of the absolute terms of a row is greater.
    size: f64,
}

/// For one direction and a part of a span: the matrices of all derivatives.
///
/// Each number is wrong by no more than `5 p` half units in the last place of the matrix' size, with the degree p: in
/// each of the p steps, of differences and of polar forms, a product with a quotient of differences of knots (four
/// roundings) and a sum. Differences lose nothing, since the terms of neighbours have opposite signs.
pub(super) struct Part {
    /// The first point of the span.
    first: usize,
    /// The number of points of the span.
    points: usize,
    orders: SmallVec<[Matrix; 4]>,
}

impl Part {
    pub(super) fn new(basis: &BSplineBasis, t: Interval, limit: Limit, order: usize) -> Self {
        let (p, knots) = (basis.degree(), basis.knots());
        let (points, span) = (p + 1, basis.span(t.mid(), limit));
        // The points of the derivative, each as a row of shares of the given points, then the sum of their sizes.
        let wide = points + 1;
        let mut c: SmallVec<[f64; 32]> = SmallVec::from_elem(0.0, points * wide);
        for unit in 0..points {
            c[unit * wide + unit] = 1.0;
            c[unit * wide + points] = 1.0;
        }
        let mut x = c.clone();
        let mut orders = SmallVec::new();
        for i in 0..=order.min(p) {
            let d = p - i;
            let mut matrix = Matrix {
                rows: SmallVec::new(),
                size: 0.0,
            };
            for a in 0..if t.is_point() { 1 } else { d + 1 } {
                // The polar form of degree d at d - a times the lower and a times the upper end.
                x.copy_from_slice(&c);
                for r in 1..=d {
                    let at = if r > d - a { t.hi } else { t.lo };
                    for j in (r..=d).rev() {
                        let [from, to] = [span + j - d, span + j + 1 - r].map(|k| knots[k]);
                        let width = to - from;
                        let (rest, s) = ((to - at) / width, (at - from) / width);
                        let (before, this) = x.split_at_mut(j * wide);
                        let before = &before[(j - 1) * wide..];
                        for unit in 0..points {
                            this[unit] = rest * before[unit] + s * this[unit];
                        }
                        this[points] = rest.abs() * before[points] + s.abs() * this[points];
                        if width.is_infinite() {
                            this[points] = f64::NAN;
                        }
                    }
                }
                let row = &x[d * wide..][..wide];
                matrix.rows.extend_from_slice(&row[..points]);
                matrix.size = greater(matrix.size, row[points]);
            }
            orders.push(matrix);
            // The points of the next derivative.
            for j in 0..d {
                let at = span + 1 + j - d;
                let factor = d as f64 / (knots[at + d] - knots[at]);
                let (this, next) = c[j * wide..].split_at_mut(wide);
                for unit in 0..points {
                    this[unit] = (next[unit] - this[unit]) * factor;
                }
                this[points] = (next[points] + this[points]) * factor;
            }
        }
        Self {
            first: span - p,
            points,
            orders,
        }
    }

    /// The share of each point of the span in the mean of the Bézier points of the part.
    fn mean(&self) -> SmallVec<[f64; 4]> {
        let rows = &self.orders[0].rows;
        let count = (rows.len() / self.points) as f64;
        let share = |k: usize| rows[k..].iter().step_by(self.points).sum::<f64>() / count;
        (0..self.points).map(share).collect()
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

/// The Bézier points over the part, those of the first row of u first.
pub(super) fn bezier_points(net: &[DVec4], columns: usize, [u, v]: [&Part; 2]) -> Vec<DVec4> {
    let rows = |part: &Part| part.orders[0].rows.clone();
    let (of_u, of_v) = (rows(u), rows(v));
    let mut out = Vec::new();
    for f in of_u.chunks(u.points) {
        for g in of_v.chunks(v.points) {
            let mut sum = DVec4::ZERO;
            for (k, f) in f.iter().enumerate() {
                for (l, g) in g.iter().enumerate() {
                    sum += net[(u.first + k) * columns + v.first + l] * (f * g);
                }
            }
            out.push(sum);
        }
    }
    out
}

/// `Σ f x`.
#[inline(always)]
fn combine(factors: &[f64], x: &[Point]) -> Point {
    let mut sum = [0.0; 4];
    for (f, x) in factors.iter().zip(x) {
        for c in 0..4 {
            sum[c] += f * x[c];
        }
    }
    sum
}

/// Encloses the homogeneous derivatives up to `order`, of a net whose points `point` takes from the given ones, with how
/// much each of their numbers may be off.
pub(super) fn derivatives(
    net: &[DVec4],
    columns: usize,
    [u, v]: [&Part; 2],
    point: impl Fn(DVec4) -> [Point; 2],
    order: usize,
) -> SmallVec<[[Interval; 4]; 16]> {
    let mut out: SmallVec<[[Interval; 4]; 16]> =
        SmallVec::from_elem([Interval::ZERO; 4], jet_len(order));
    let (nu, nv) = (u.points, v.points);
    // By columns, so that the points that a row of u takes lie side by side.
    let mut local: SmallVec<[Point; 16]> = SmallVec::with_capacity(nu * nv);
    let (mut size, mut off) = ([0.0f64; 4], [0.0f64; 4]);
    for l in 0..nv {
        for k in 0..nu {
            let [x, e] = point(net[(u.first + k) * columns + v.first + l]);
            for c in 0..4 {
                size[c] = greater(size[c], x[c].abs());
                off[c] = greater(off[c], e[c]);
            }
            local.push(x);
        }
    }
    let mut half: SmallVec<[Point; 4]> = SmallVec::from_elem([0.0; 4], nv);
    for (i, a) in u.orders.iter().enumerate() {
        let mut hulls: SmallVec<[[Point; 2]; 4]> =
            SmallVec::from_elem([[f64::INFINITY; 4], [f64::NEG_INFINITY; 4]], order + 1 - i);
        for row in a.rows.chunks_exact(nu) {
            for (half, column) in half.iter_mut().zip(local.chunks_exact(nu)) {
                *half = combine(row, column);
            }
            for ([lo, hi], b) in hulls.iter_mut().zip(&v.orders) {
                for row in b.rows.chunks_exact(nv) {
                    let x = combine(row, &half);
                    for c in 0..4 {
                        lo[c] = if x[c] < lo[c] { x[c] } else { lo[c] };
                        hi[c] = if x[c] > hi[c] { x[c] } else { hi[c] };
                    }
                }
            }
        }
        // The numbers of both matrices, and for each sum as many roundings as it has terms.
        let roundings = (6 * (nu + nv)) as f64 * ROUNDING;
        for (j, ([lo, hi], b)) in hulls.iter().zip(&v.orders).enumerate() {
            for c in 0..4 {
                // Where a sum may overflow, this does.
                let reach = b.size * (a.size * size[c]);
                let error = (reach * roundings + b.size * (a.size * off[c])) * ROUND_UP;
                // Products below the smallest number lose more than their share.
                let factors = (1.0 + size[c]) * (1.0 + a.size) * (1.0 + b.size);
                let least = f64::MIN_POSITIVE * factors;
                out[jet_index(i, j)][c] = interval(lo[c], hi[c], error + least);
            }
        }
    }
    out
}

/// The numbers between two others that are off by an error.
fn interval(lo: f64, hi: f64, error: f64) -> Interval {
    let (lo, hi) = ((lo - error).next_down(), (hi + error).next_up());
    if lo.is_finite() && hi.is_finite() {
        Interval { lo, hi }
    } else {
        Interval::ENTIRE
    }
}

#[cfg(test)]
mod tests {
    use crate::exact::NurbsSurface;
    use crate::interval::Interval;
    use crate::surface::{Surface, jet_index};
    use glam::DVec3;

    /// A bicubic patch over `u` and the unit interval with these heights along u.
    fn patch(heights: [f64; 4], u: [f64; 2]) -> NurbsSurface {
        let points: Vec<DVec3> = (0..16)
            .map(|k| DVec3::new(0.0, (k % 4) as f64 / 3.0, heights[k / 4]))
            .collect();
        let knots = [u, [0.0, 1.0]].map(|t| t.into_iter().flat_map(|t| [t; 4]).collect());
        NurbsSurface::new([3, 3], knots, &points, None).expect("a patch")
    }

    #[test]
    fn sums_that_overflow_are_not_left_out() {
        let z = 5e307;
        let patch = patch([-z, z, z, -z], [0.0, 1.0]);
        let jet = patch.enclose([Interval::new(0.0, 1.0); 2], 1);
        let slope = |u: f64| 3.0 * ((2.0 * z) * (1.0 - u).powi(2) - (2.0 * z) * u.powi(2));
        for u in [0.0, 0.3, 1.0] {
            assert!(jet[jet_index(1, 0)].z.contains(slope(u)), "{u}");
        }
    }

    #[test]
    fn derivatives_beyond_all_numbers_have_no_bound() {
        let w = 7e-154;
        let patch = patch([5.0, -5.0, 5.0, 15.0], [0.0, w]);
        let jet = patch.enclose([Interval::new(0.0, w), Interval::new(0.0, 1.0)], 2);
        assert!(!jet[jet_index(2, 0)].z.is_finite());
    }

    #[test]
    fn domains_wider_than_all_numbers_have_no_bound() {
        let patch = patch([0.0, 1.0, 2.0, 3.0], [-1e308, 1e308]);
        let jet = patch.enclose([Interval::new(-1.0, 1.0), Interval::new(0.0, 1.0)], 1);
        assert!(!jet[0].is_finite() || jet[0].z.contains(1.5));
    }
}
