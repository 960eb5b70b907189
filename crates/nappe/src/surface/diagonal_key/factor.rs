//! A vector function freed of its zeros: `d(v) = m(v) g(v)` with `m(v) = ±(v - v₀)ᵏ` on each piece and `g ≠ 0`, so that
//! the direction of `g` is smooth where `d` passes through zero.

use super::DiagonalKeyError;
use crate::basis::{FunctionsRef, Value};
use crate::breaks::{Break, Breaks, Limit};
use crate::curve::MAX_ORDER;
use crate::interval::Interval;
use crate::scalar::{Number, Pack};
use crate::series::Series;
use glam::DVec3;

/// Below this part of its greatest length, `d` (or a scaled derivative) is taken for zero. Larger, and near misses
/// would be forced through zero; smaller, and rounding would hide zeros.
const VANISHES: f64 = 1e-12;
/// The scaled derivative that decides the multiplicity of a zero found by search is at least this large. Smaller, and
/// a double zero found with the accuracy of a simple one would be taken for it.
const SIGNIFICANT: f64 = 1e-7;
/// The highest multiplicity looked for.
const MULTIPLICITY: usize = 6;
/// Samples of each analytic piece in the search for zeros.
const SAMPLES: usize = 64;
/// The integral form is used for values up to this part of a piece away from a zero. Larger, and values cost ten times
/// as much on more of the range; smaller, and the quotient loses digits of high derivatives.
const NEAR: f64 = 0.25;
/// Nodes of the quadrature near a zero: exact for polynomials of degree 19.
const NODES: usize = 10;

/// A zero at an end of a piece.
#[derive(Clone, Debug)]
struct Zero {
    at: f64,
    /// Its multiplicity.
    k: usize,
    /// Up to this distance the integral form is used for values, beyond it the quotient.
    radius: f64,
    /// The rounding left of derivatives 0 to k - 1 at the zero, which the factored form leaves out.
    residual: Vec<[f64; 3]>,
    enclosed: Vec<[Interval; 3]>,
}

/// The vector function, its zeros, and the sign of `m` on each piece.
#[derive(Clone, Debug)]
pub(super) struct Factored {
    d: FunctionsRef,
    breaks: Vec<Break>,
    zeros: Vec<Option<Zero>>,
    signs: Vec<f64>,
    nodes: [(f64, f64); NODES],
}

impl Factored {
    /// Factors three functions on `[0, 1]` that vanish at 0 and not at 1, up to `noise`, the length of rounding.
    pub(super) fn new(d: FunctionsRef, noise: f64) -> Result<Self, DiagonalKeyError> {
        let scale = greatest(&d, Interval::UNIT);
        let tol = noise.max(VANISHES * scale);
        let mut f = Self {
            breaks: Vec::new(),
            zeros: Vec::new(),
            signs: Vec::new(),
            nodes: gauss_legendre(),
            d,
        };
        let breaks = f.d.breaks().to_vec();
        for (i, ends) in breaks.windows(2).enumerate() {
            let piece = Interval::new(ends[0].at, ends[1].at);
            if greatest(&f.d, piece) <= tol {
                return Err(DiagonalKeyError::NoDirection { v: piece });
            }
            let zeros = f.find(i, piece, tol, scale);
            f.split(ends[0], piece, &zeros, tol, scale);
        }
        f.breaks.push(breaks[breaks.len() - 1]);
        f.choose_signs();
        Ok(f)
    }

    /// The breaks of d, its zeros, and points between neighbouring zeros.
    pub(super) fn breaks(&self) -> &[Break] {
        &self.breaks
    }

    fn jet<S: Value>(&self, t: S, limit: Limit, order: usize) -> Vec<[S; 3]> {
        let mut out = vec![[S::ZERO; 3]; order + 1];
        S::jet(self.d.as_ref(), t, limit, order, out.as_flattened_mut());
        out
    }

    fn enclose_d(&self, t: Interval, limit: Limit, order: usize) -> Vec<[Interval; 3]> {
        let mut out = vec![Interval::ENTIRE; 3 * (order + 1)];
        self.d.enclose_piece(t, limit, order, &mut out);
        out.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect()
    }

    /// The zeros in one piece of d, in order.
    fn find(&self, index: usize, piece: Interval, tol: f64, scale: f64) -> Vec<f64> {
        let w = piece.hi - piece.lo;
        let at = |i: usize| piece.lo + w * i as f64 / SAMPLES as f64;
        let inside = |t: f64| {
            if t < piece.hi {
                Limit::Above
            } else {
                Limit::Below
            }
        };
        let length = |t: f64| DVec3::from_array(self.jet(t, inside(t), 0)[0]).length();
        let mut zeros = Vec::new();
        if length(piece.lo) <= tol || index == 0 {
            zeros.push(piece.lo);
        }
        let sampled: Vec<f64> = (0..=SAMPLES).map(|i| length(at(i))).collect();
        for i in 1..SAMPLES {
            if sampled[i] > sampled[i - 1] || sampled[i] > sampled[i + 1] {
                continue;
            }
            let around = Interval::new(at(i - 1), at(i + 1));
            for k in 1..=MULTIPLICITY {
                let t = self.refine(at(i), around, k);
                let d = self.jet(t, Limit::Above, k);
                let size = |j: usize| scaled(&d, j, w);
                let vanishes =
                    (0..k).all(|j| size(j) <= if j == 0 { tol } else { VANISHES * scale });
                if vanishes && size(k) >= SIGNIFICANT * scale {
                    let new = |z: &f64| (t - z).abs() > 1e-9 * w;
                    if zeros.iter().all(new) && new(&piece.hi) {
                        zeros.push(t);
                    }
                    break;
                }
            }
        }
        if length(piece.hi) <= tol {
            zeros.push(piece.hi);
        }
        zeros.sort_by(f64::total_cmp);
        zeros
    }

    /// Gauss-Newton steps to the zero of the derivative of order k - 1.
    fn refine(&self, start: f64, around: Interval, k: usize) -> f64 {
        const STEPS: usize = 60;
        let mut t = start;
        for _ in 0..STEPS {
            let d = self.jet(t, Limit::Above, k);
            let (a, b) = (DVec3::from_array(d[k - 1]), DVec3::from_array(d[k]));
            let step = a.dot(b) / b.length_squared();
            if !step.is_finite() {
                break;
            }
            let next = (t - step).clamp(around.lo, around.hi);
            if next == t {
                break;
            }
            t = next;
        }
        t
    }

    /// Appends the parts of a piece: each has a zero at most at one end.
    fn split(&mut self, first: Break, piece: Interval, zeros: &[f64], tol: f64, scale: f64) {
        // An inner zero or a point between zeros is no break of d: nothing is less smooth there.
        let analytic = |at: f64| Break::new(at, MAX_ORDER as i32);
        let mut cuts = vec![(first, zeros.contains(&piece.lo))];
        for (i, &z) in zeros.iter().enumerate() {
            if i > 0 {
                cuts.push((analytic(0.5 * (zeros[i - 1] + z)), false));
            }
            if piece.lo < z && z < piece.hi {
                cuts.push((analytic(z), true));
            }
        }
        cuts.push((analytic(piece.hi), zeros.contains(&piece.hi)));
        for c in cuts.windows(2) {
            let part = Interval::new(c[0].0.at, c[1].0.at);
            let zero = match (c[0].1, c[1].1) {
                (true, _) => Some(self.zero(part.lo, part, tol, scale)),
                (_, true) => Some(self.zero(part.hi, part, tol, scale)),
                _ => None,
            };
            self.breaks.push(c[0].0);
            self.zeros.push(zero);
            self.signs.push(1.0);
        }
    }

    /// The zero at an end of a part: its multiplicity, and how far the integral form is good.
    fn zero(&self, at: f64, part: Interval, tol: f64, scale: f64) -> Zero {
        let limit = inward(at, part);
        let w = part.hi - part.lo;
        let d = self.jet(at, limit, MULTIPLICITY);
        let k = (1..MULTIPLICITY)
            .find(|&j| scaled(&d, j, w) > tol.max(VANISHES * scale))
            .unwrap_or(MULTIPLICITY);
        let mut zero = Zero {
            at,
            k,
            radius: NEAR * w,
            residual: d[..k].to_vec(),
            enclosed: self.enclose_d(Interval::point(at), limit, k - 1),
        };
        const HALVINGS: usize = 12;
        const ACCURACY: f64 = 1e-13;
        for _ in 0..HALVINGS {
            let r = zero.radius;
            let v = if at == part.lo { at + r } else { at - r };
            let (whole, halves) = (
                self.integral(&zero, v, limit, 3, 1),
                self.integral(&zero, v, limit, 3, 2),
            );
            let size: Vec<f64> = halves
                .iter()
                .map(|x| DVec3::from_array(*x).length())
                .collect();
            let good = (0..=3).all(|j| {
                let e = DVec3::from_array(whole[j]).distance(DVec3::from_array(halves[j]));
                let unit = (0..=3)
                    .map(|i| size[i] * r.powi(i as i32))
                    .fold(0.0, f64::max);
                e * r.powi(j as i32) <= ACCURACY * unit
            });
            if good {
                break;
            }
            zero.radius *= 0.5;
        }
        zero
    }

    /// Derivatives of `(d - residual)/(v - v₀)ᵏ` by
    /// `g⁽ʲ⁾(v) = 1/(k-1)! ∫₀¹ (1-τ)ᵏ⁻¹ τʲ d⁽ᵏ⁺ʲ⁾(v₀ + τ(v - v₀)) dτ`: no cancellation near v₀.
    fn integral<S: Value>(
        &self,
        z: &Zero,
        v: S,
        limit: Limit,
        order: usize,
        panels: usize,
    ) -> Vec<[S; 3]> {
        let factorial: f64 = (1..z.k).map(|i| i as f64).product();
        let at = S::from(z.at);
        let mut g = vec![[S::ZERO; 3]; order + 1];
        for panel in 0..panels {
            for (x, w) in self.nodes {
                let tau = (panel as f64 + x) / panels as f64;
                let d = self.jet(at + S::from(tau) * (v - at), limit, z.k + order);
                let mut f = w / panels as f64 * (1.0 - tau).powi(z.k as i32 - 1) / factorial;
                for (j, g) in g.iter_mut().enumerate() {
                    for c in 0..3 {
                        g[c] = g[c] + S::from(f) * d[z.k + j][c];
                    }
                    f *= tau;
                }
            }
        }
        g
    }

    /// The sign of m on every part, so that the direction of g continues across the breaks as far as it can; at
    /// v = 1 the factor m is positive.
    fn choose_signs(&mut self) {
        for i in (0..self.signs.len() - 1).rev() {
            let at = self.breaks[i + 1].at;
            let [below, above] = [Limit::Below, Limit::Above].map(|l| {
                let (_, g) = self.value(at, l, 0);
                DVec3::from_array([g[0].c[0], g[1].c[0], g[2].c[0]])
            });
            if below.dot(above) < 0.0 {
                self.signs[i] = -1.0;
            }
        }
    }

    /// The part that holds `v`, if it has a zero, and whether the integral form is good there.
    fn place(&self, v: f64, limit: Limit) -> Option<(usize, bool)> {
        let i = self.breaks.find(v, limit);
        let z = self.zeros[i].as_ref()?;
        Some((i, (v - z.at).abs() <= z.radius))
    }

    /// The series of m and of g at `v`.
    pub(super) fn value(
        &self,
        v: f64,
        limit: Limit,
        order: usize,
    ) -> (Series<f64>, [Series<f64>; 3]) {
        let sign = self.signs[self.breaks.find(v, limit)];
        self.value_at(self.place(v, limit), sign, v, limit, order)
    }

    /// The same for a pack, if one formula is good for all lanes.
    pub(super) fn values(
        &self,
        v: Pack,
        limit: Limit,
        order: usize,
    ) -> Option<(Series<Pack>, [Series<Pack>; 3])> {
        let place = v.common(|v| self.place(v, limit))?;
        let sign = Pack(v.0.map(|v| self.signs[self.breaks.find(v, limit)]));
        Some(self.value_at(place, sign, v, limit, order))
    }

    fn value_at<S: Value>(
        &self,
        place: Option<(usize, bool)>,
        sign: S,
        v: S,
        limit: Limit,
        order: usize,
    ) -> (Series<S>, [Series<S>; 3]) {
        let at_zero = place.and_then(|(i, near)| Some((i, self.zeros[i].as_ref()?, near)));
        let Some((i, z, near)) = at_zero else {
            return (
                Series::constant(sign, order),
                times(&self.jet(v, limit, order), sign),
            );
        };
        let m = factor(z, v, sign, order);
        let limit = inward(z.at, self.breaks.piece(i));
        let g = if near {
            times(&self.integral(z, v, limit, order, 1), sign)
        } else {
            let residual: Vec<_> = z.residual.iter().map(|r| r.map(S::from)).collect();
            quotient(&self.jet(v, limit, order), &residual, z.at, v, &m)
        };
        (m, g)
    }

    /// Enclosures of the same over `v`, which lies in one piece.
    pub(super) fn enclose(
        &self,
        v: Interval,
        limit: Limit,
        order: usize,
    ) -> (Series<Interval>, [Series<Interval>; 3]) {
        let i = self.breaks.find(v.mid(), limit);
        let sign = Interval::point(self.signs[i]);
        let Some(z) = &self.zeros[i] else {
            let d = self.enclose_d(v, limit, order);
            return (Series::constant(sign, order), times(&d, sign));
        };
        let m = factor(z, v, sign, order);
        let limit = inward(z.at, self.breaks.piece(i));
        // The integral form with d⁽ᵏ⁺ʲ⁾ enclosed over the hull: its weights sum to j!/(k+j)!.
        let mut d = self.enclose_d(v.hull(Interval::point(z.at)), limit, z.k + order);
        d.drain(..z.k);
        for (j, d) in d.iter_mut().enumerate() {
            let weight: f64 = (j + 1..=j + z.k).map(|i| i as f64).product();
            *d = d.map(|x| x / Interval::point(weight));
        }
        let mut g = times(&d, sign);
        if !v.contains(z.at) {
            let own = self.enclose_d(v, limit, order);
            for (g, q) in g.iter_mut().zip(quotient(&own, &z.enclosed, z.at, v, &m)) {
                for (g, q) in g.c.iter_mut().zip(q.c) {
                    if q.is_finite() {
                        *g = g.meet(q);
                    }
                }
            }
        }
        (m, g)
    }
}

/// The limit that selects the part at its end `at`.
fn inward(at: f64, part: Interval) -> Limit {
    if at <= part.lo {
        Limit::Above
    } else {
        Limit::Below
    }
}

/// `|d⁽ʲ⁾| wʲ/j!`: what a Taylor term contributes over a width.
fn scaled(d: &[[f64; 3]], j: usize, w: f64) -> f64 {
    let factor: f64 = (1..=j).map(|i| w / i as f64).product();
    DVec3::from_array(d[j]).length() * factor
}

/// The greatest length at samples of a range.
fn greatest(d: &FunctionsRef, range: Interval) -> f64 {
    let mut out = [0.0; 3];
    (0..=SAMPLES)
        .map(|i| {
            let t = range.lo + (range.hi - range.lo) * i as f64 / SAMPLES as f64;
            let limit = if i < SAMPLES {
                Limit::Above
            } else {
                Limit::Below
            };
            d.jet_into(t, limit, 0, &mut out);
            DVec3::from_array(out).length()
        })
        .fold(0.0, f64::max)
}

/// The series of `sign (v - v₀)ᵏ`.
fn factor<S: Number>(z: &Zero, v: S, sign: S, order: usize) -> Series<S> {
    Series::variable(v - S::from(z.at), order)
        .powi(z.k as i32)
        .scale(sign)
}

/// Three series from derivatives, times a sign.
fn times<S: Number>(d: &[[S; 3]], sign: S) -> [Series<S>; 3] {
    [0, 1, 2].map(|c| {
        let column: Vec<S> = d.iter().map(|x| x[c]).collect();
        Series::from_derivatives(&column).scale(sign)
    })
}

/// `(d - Σ_j residual_j (v - v₀)ʲ/j!) / m`.
fn quotient<S: Number>(
    d: &[[S; 3]],
    residual: &[[S; 3]],
    at: f64,
    v: S,
    m: &Series<S>,
) -> [Series<S>; 3] {
    let order = d.len() - 1;
    let x = Series::variable(v - S::from(at), order);
    let mut s = times(d, S::ONE);
    for (c, s) in s.iter_mut().enumerate() {
        let mut factorial = 1.0;
        for (j, r) in residual.iter().enumerate() {
            factorial *= j.max(1) as f64;
            *s = s.sub(&x.powi(j as i32).scale(r[c] / S::from(factorial)));
        }
        *s = s.div(m);
    }
    s
}

/// Nodes and weights of Gauss–Legendre quadrature on `[0, 1]`, by Newton's method on the Legendre polynomial.
fn gauss_legendre() -> [(f64, f64); NODES] {
    let n = NODES as f64;
    std::array::from_fn(|i| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        const STEPS: usize = 8;
        for _ in 0..STEPS {
            let (mut p, mut before) = (1.0, 0.0);
            for k in 0..NODES {
                let k = k as f64;
                (p, before) = (((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0), p);
            }
            slope = n * (before - x * p) / (1.0 - x * x);
            x -= p / slope;
        }
        (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::Coordinates;
    use crate::exact::NurbsCurve;
    use std::sync::Arc;

    fn factored(points: &[[f64; 3]]) -> Factored {
        let p: Vec<_> = points.iter().map(|p| DVec3::from_array(*p)).collect();
        let curve = Arc::new(NurbsCurve::bezier(&p, None).unwrap());
        Factored::new(Arc::new(Coordinates::new(curve, DVec3::ZERO)), 0.0).unwrap()
    }

    #[test]
    fn quadrature_is_exact_for_polynomials() {
        let nodes = gauss_legendre();
        for k in 0..2 * NODES as i32 {
            let sum: f64 = nodes.iter().map(|(x, w)| w * x.powi(k)).sum();
            assert!((sum - 1.0 / (k + 1) as f64).abs() < 1e-15, "{k}: {sum}");
        }
    }

    #[test]
    fn a_polynomial_with_an_inner_zero_is_factored() {
        // v (v - 1/2) (1, v, 2): zeros at 0 and 1/2. v² - v/2 in Bernstein form of degree 3:
        let x = [0.0, -1.0 / 6.0, 0.0, 0.5];
        // v²(v - 1/2) = v³ - v²/2 has Bernstein coefficients 0, 0, -1/6, 1/2.
        let y = [0.0, 0.0, -1.0 / 6.0, 0.5];
        let points: Vec<_> = (0..4).map(|i| [x[i], y[i], 2.0 * x[i]]).collect();
        let f = factored(&points);
        let at: Vec<f64> = f.breaks.iter().map(|b| b.at).collect();
        assert_eq!(at.len(), 4, "{at:?}");
        assert!(
            (at[1] - 0.25).abs() < 1e-9 && (at[2] - 0.5).abs() < 1e-9,
            "{at:?}"
        );
        for v in [0.0, 0.1, 0.25, 0.4, 0.499999, 0.5, 0.7, 1.0] {
            let (m, g) = f.value(v, Limit::Above, 3);
            let d = f.jet(v, Limit::Above, 3);
            let e = DVec3::new(1.0, v, 2.0).normalize();
            let got = DVec3::new(g[0].c[0], g[1].c[0], g[2].c[0]).normalize();
            assert!((got - e).length() < 1e-12, "{v}: {got} {e}");
            for c in 0..3 {
                let mut back = [0.0; 4];
                m.mul(&g[c]).write_derivatives(&mut back);
                for k in 0..4 {
                    assert!((back[k] - d[k][c]).abs() < 1e-11, "{v} {c} {k}");
                }
            }
        }
    }

    #[test]
    fn packs_near_a_zero_beside_it_and_across_parts_are_single_values() {
        // v (v - 1/2) (1, v, 2) as above.
        let f = factored(&[
            [0.0; 3],
            [-1.0 / 6.0, 0.0, -1.0 / 3.0],
            [0.0, -1.0 / 6.0, 0.0],
            [0.5, 0.5, 1.0],
        ]);
        let pack = |from: f64, step: f64| Pack(std::array::from_fn(|l| from + step * l as f64));
        for (t, one_formula) in [
            (pack(0.0, 1e-3), true),
            (pack(0.1, 0.01), true),
            (pack(0.2, 0.02), false),
            (pack(0.9, 0.01), true),
        ] {
            let values = f.values(t, Limit::Above, 2);
            assert_eq!(values.is_some(), one_formula, "{t:?}");
            let Some((m, g)) = values else { continue };
            for (lane, &v) in t.0.iter().enumerate() {
                let (m1, g1) = f.value(v, Limit::Above, 2);
                for (pack, one) in [&m].into_iter().chain(&g).zip([&m1].into_iter().chain(&g1)) {
                    let pack: Vec<u64> = pack.c.iter().map(|c| c.0[lane].to_bits()).collect();
                    let one: Vec<u64> = one.c.iter().map(|c| c.to_bits()).collect();
                    assert_eq!(pack, one, "{v}");
                }
            }
        }
    }

    #[test]
    fn a_double_zero_keeps_its_sign() {
        // (v - 1/2)² v (1, 0, 0) + (v - 1/2)² v² (0, 1, 0): Bernstein forms of degree 4.
        let x = [0.0, 0.0625, -1.0 / 24.0, -0.0625, 0.25];
        let y = [0.0, 0.0, 1.0 / 24.0, -0.125, 0.25];
        let points: Vec<_> = (0..5).map(|i| [x[i], y[i], 0.0]).collect();
        let f = factored(&points);
        for (v, limit) in [
            (0.2, Limit::Above),
            (0.5, Limit::Below),
            (0.5, Limit::Above),
            (0.9, Limit::Above),
        ] {
            let (m, g) = f.value(v, limit, 0);
            let got = DVec3::new(g[0].c[0], g[1].c[0], g[2].c[0]).normalize();
            let e = DVec3::new(1.0, v, 0.0).normalize();
            assert!((got - e).length() < 1e-10, "{v}: {got} {e}");
            assert!(m.c[0] >= 0.0);
        }
    }

    #[test]
    fn a_part_without_direction_is_an_error() {
        let p: Vec<_> = [0.0, 0.0, 1.0].map(|x| DVec3::X * x).to_vec();
        let c = NurbsCurve::new(1, vec![0.0, 0.0, 0.5, 1.0, 1.0], &p, None).unwrap();
        let e = Factored::new(Arc::new(Coordinates::new(Arc::new(c), DVec3::ZERO)), 0.0);
        assert!(matches!(e, Err(DiagonalKeyError::NoDirection { v }) if v.hi == 0.5));
    }
}
