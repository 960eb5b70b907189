//! Gregory's rational twists: the part of a Coons surface that is no sum of products.

use super::{Dir, Separable, Surface, jet_index, jet_len};
use crate::basis::FunctionsRef;
use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit};
use crate::interval::Interval;
use crate::scalar::Scalar;
use crate::series::binomial;
use glam::DVec3;
use smallvec::SmallVec;

/// Nearer to a corner than this (in parameters) is the corner: powers of smaller distances leave the range of doubles.
const CORNER: f64 = 1e-60;

/// A corner with two twists A (of the side across u) and B (of the side across v).
#[derive(Clone, Debug)]
pub(super) struct GregoryCorner {
    /// 0 or 1 for the lower or upper end of u and v.
    ends: [usize; 2],
    /// `(A - B)/2`.
    half: DVec3,
}

impl GregoryCorner {
    pub(super) fn new(ends: [usize; 2], half: DVec3) -> Self {
        Self { ends, half }
    }

    /// Which blending function of u and of v belongs to the twist.
    fn functions(&self) -> [usize; 2] {
        self.ends.map(|e| e + 1)
    }

    /// The sign of the distance from the corner along u and v, per unit of the parameter.
    fn signs(&self) -> [f64; 2] {
        self.ends.map(|e| if e == 0 { 1.0 } else { -1.0 })
    }
}

/// A Coons surface with the mean twists (the base), less `H_i(u) H_j(v) (A - B)/2 · (û - v̂)/(û + v̂)` for every corner
/// with two twists, where û and v̂ are the distances from the corner in u and v.
///
/// The twist is then A where v̂ = 0 and B where û = 0, which keeps the cross-derivatives of both sides. Second derivatives
/// are bounded but jump in the corner itself (there those of the base are given); higher ones are unbounded near it.
///
/// Source: Gregory, "Smooth interpolation without twist constraints" (1974).
#[derive(Clone, Debug)]
pub(super) struct Gregory {
    base: Separable,
    functions: FunctionsRef,
    corners: Vec<GregoryCorner>,
}

impl Gregory {
    pub(super) fn new(
        base: Separable,
        functions: FunctionsRef,
        corners: Vec<GregoryCorner>,
    ) -> Self {
        Self {
            base,
            functions,
            corners,
        }
    }

    /// Derivatives 0 to `order` of every function with respect to the parameter: `[order][function]`.
    fn rows(&self, t: f64, limit: Limit, order: usize) -> Vec<f64> {
        let (n, active) = (self.functions.count(), self.functions.active(t, limit));
        let mut part = vec![0.0; (order + 1) * active.len()];
        self.functions.jet_into(t, limit, order, &mut part);
        spread(n, active.start, active.len(), &part, 0.0)
    }

    fn enclosed_rows(&self, t: Interval, limit: Limit, order: usize) -> Vec<Interval> {
        let (n, active) = (
            self.functions.count(),
            self.functions.active(t.mid(), limit),
        );
        let mut part = vec![Interval::ENTIRE; (order + 1) * active.len()];
        self.functions.enclose_piece(t, limit, order, &mut part);
        spread(n, active.start, active.len(), &part, Interval::ZERO)
    }

    /// Enclosures of the derivatives of `h(x) = H(x)/x`, where x is the distance from the corner's end, for x in a part
    /// of the first piece; `None` where the functions are not analytic down to the corner, or not proven to vanish there.
    fn quotient(
        &self,
        corner: &GregoryCorner,
        dir: usize,
        x: Interval,
        order: usize,
    ) -> Option<Vec<Interval>> {
        let from_corner = Interval {
            lo: 0.0,
            hi: x.hi.max(0.0),
        };
        let n = self.functions.count();
        let (f, sign) = (corner.functions()[dir], corner.signs()[dir]);
        let (t, limit, end) = if corner.ends[dir] == 0 {
            (from_corner, Limit::Above, Interval::ZERO)
        } else {
            (Interval::ONE - from_corner, Limit::Below, Interval::ONE)
        };
        let breaks = self.functions.breaks();
        let piece = breaks.piece(breaks.find(end.lo, limit));
        let vanishes = self.enclosed_rows(end, limit, 0)[f] == Interval::ZERO;
        if !piece.encloses(t.meet(Interval::UNIT)) || !vanishes {
            return None;
        }
        let rows = self.enclosed_rows(t.meet(Interval::UNIT), limit, order + 1);
        // h(x) = ∫ H'(s x) ds over [0, 1], since H(0) = 0, and so h⁽ᵏ⁾ is a mean of H⁽ᵏ⁺¹⁾/(k+1) over [0, x].
        let signed = |k: usize| {
            let d = rows[k * n + f];
            if sign < 0.0 && k % 2 == 1 { -d } else { d }
        };
        Some(
            (0..=order)
                .map(|k| signed(k + 1) / Interval::point((k + 1) as f64))
                .collect(),
        )
    }
}

fn spread<T: Copy>(n: usize, start: usize, len: usize, part: &[T], zero: T) -> Vec<T> {
    let orders = part.len() / len.max(1);
    let mut out = vec![zero; orders * n];
    for k in 0..orders {
        out[k * n + start..][..len].copy_from_slice(&part[k * len..][..len]);
    }
    out
}

/// The partial derivatives of `v̂/(û + v̂)`, given its value ρ and the sum s, for all orders of a jet.
fn share<S: Scalar>(rho: S, s: S, order: usize) -> SmallVec<[S; 6]> {
    let mut out = SmallVec::from_elem(rho, jet_len(order));
    let mut factorial = S::ONE;
    let mut power = S::ONE;
    for n in 1..=order {
        // ∂ᵖ∂ᑫ = (-1)ⁿ s⁻ⁿ (n! ρ - q (n-1)!), n = p + q.
        let lower = factorial;
        factorial = factorial * S::from(n as f64);
        power = -(power / s);
        for q in 0..=n {
            let x = factorial * rho - S::from(q as f64) * lower;
            out[jet_index(n - q, q)] = power * x;
        }
    }
    out
}

/// The partial derivatives of `K = û v̂ (û - v̂)/(û + v̂) = û v̂ - 2 v̂² + 2 v̂³/(û + v̂)`: homogeneous of degree two, so those of
/// order two are bounded functions of ρ alone.
fn homogeneous(
    u: Interval,
    v: Interval,
    rho: Interval,
    s: Interval,
    order: usize,
) -> Vec<Interval> {
    let point = |x: f64| Interval::point(x);
    let mut out = vec![Interval::ENTIRE; jet_len(order)];
    for n in 0..=order {
        for q in 0..=n {
            let p = n - q;
            // ∂ᵖᵤ∂ᑫᵥ v̂³/s = Σ_m C(q, m) (v̂³)⁽ᵐ⁾ (-1)ⁿ⁻ᵐ (n-m)! s^(-1-n+m), and v̂^(3-m) s^(-1-n+m) = ρ^(3-m) s^(2-n).
            let mut sum = Interval::ZERO;
            for m in 0..=q.min(3) {
                let cubic = [1.0, 3.0, 6.0, 6.0][m];
                let factorial: f64 = (1..=n - m).map(|k| k as f64).product();
                let sign = if (n - m) % 2 == 0 { 1.0 } else { -1.0 };
                let c = 2.0 * binomial(q, m) * cubic * factorial * sign;
                sum = sum + point(c) * rho.powi(3 - m as i32);
            }
            let power = match n {
                0 | 1 => s.powi(2 - n as i32),
                2 => Interval::ONE,
                _ => Interval::ONE / s.powi(n as i32 - 2),
            };
            let polynomial = match (p, q) {
                (0, 0) => u * v - point(2.0) * v.sqr(),
                (1, 0) => v,
                (0, 1) => u - point(4.0) * v,
                (1, 1) => Interval::ONE,
                (0, 2) => point(-4.0),
                _ => Interval::ZERO,
            };
            out[jet_index(p, q)] = polynomial + power * sum;
        }
    }
    out
}

/// The partial derivatives of a product `a(u) b(v) φ(u, v)`.
fn leibniz<S: Scalar>(a: &[S], b: &[S], phi: &[S], p: usize, q: usize) -> S {
    let mut sum = S::ZERO;
    for i in 0..=p {
        for j in 0..=q {
            let c = S::from(binomial(p, i) * binomial(q, j));
            sum = sum + c * a[i] * b[j] * phi[jet_index(p - i, q - j)];
        }
    }
    sum
}

/// The derivatives of one function with respect to the distance from its end.
fn column<S: Scalar>(rows: &[S], n: usize, f: usize, sign: f64) -> SmallVec<[S; 6]> {
    let column = rows.chunks_exact(n).map(|r| r[f]).enumerate();
    column
        .map(|(k, d)| if sign < 0.0 && k % 2 == 1 { -d } else { d })
        .collect()
}

/// True if the derivative changes sign when distances become parameters again.
fn flips(signs: [f64; 2], p: usize, q: usize) -> bool {
    (signs[0] < 0.0 && p % 2 == 1) != (signs[1] < 0.0 && q % 2 == 1)
}

/// ρ = v̂/(û + v̂) over a rectangle of distances: it grows with v̂ and falls with û.
fn share_range(u: Interval, v: Interval) -> Interval {
    let at = |u: f64, v: f64| {
        if u <= 0.0 && v <= 0.0 {
            Interval::UNIT
        } else {
            let v = Interval::point(v);
            v / (Interval::point(u) + v)
        }
    };
    at(u.hi, v.lo).hull(at(u.lo, v.hi)).meet(Interval::UNIT)
}

impl Surface for Gregory {
    fn breaks(&self, dir: Dir) -> &[Break] {
        self.base.breaks(dir)
    }

    fn jet_into(&self, uv: [f64; 2], limit: [Limit; 2], order: usize, out: &mut [DVec3]) {
        self.base.jet_into(uv, limit, order, out);
        let n = self.functions.count();
        let rows = [0, 1].map(|d| self.rows(uv[d], limit[d], order));
        for corner in &self.corners {
            let distance = [0, 1].map(|d| (uv[d] - corner.ends[d] as f64).abs());
            let s = distance[0] + distance[1];
            if s < CORNER {
                continue;
            }
            // Every term of the product rule is bounded as the product is: nothing cancels on the way to the corner.
            let mut phi = share(distance[1] / s, s, order);
            phi.iter_mut().for_each(|x| *x *= -2.0);
            phi[0] = (distance[0] - distance[1]) / s;
            let (signs, f) = (corner.signs(), corner.functions());
            let [a, b] = [0, 1].map(|d| column(&rows[d], n, f[d], signs[d]));
            for m in 0..=order {
                for q in 0..=m {
                    let x = leibniz(&a, &b, &phi, m - q, q);
                    let x = if flips(signs, m - q, q) { -x } else { x };
                    out[jet_index(m - q, q)] -= corner.half * x;
                }
            }
        }
    }

    fn enclose_piece(&self, uv: [Interval; 2], limit: [Limit; 2], order: usize, out: &mut [Box3]) {
        self.base.enclose_piece(uv, limit, order, out);
        let n = self.functions.count();
        let rows = [0, 1].map(|d| self.enclosed_rows(uv[d], limit[d], order));
        for corner in &self.corners {
            let [u, v] = [0, 1].map(|d| {
                let x = if corner.ends[d] == 0 {
                    uv[d]
                } else {
                    Interval::ONE - uv[d]
                };
                x.meet(Interval { lo: 0.0, hi: 1.0 })
            });
            let (rho, s) = (share_range(u, v), u + v);
            let (signs, f) = (corner.signs(), corner.functions());
            let [a, b] = [0, 1].map(|d| column(&rows[d], n, f[d], signs[d]));
            let mut phi = share(rho, s, order);
            phi.iter_mut().for_each(|x| *x = -(*x + *x));
            phi[0] = Interval::ONE + phi[0];
            // Towards the corner the derivatives of φ alone are unbounded: there û v̂ φ is taken together.
            let together = (|| {
                let a = self.quotient(corner, 0, u, order)?;
                let b = self.quotient(corner, 1, v, order)?;
                Some((a, b, homogeneous(u, v, rho, s, order)))
            })();
            for m in 0..=order {
                for q in 0..=m {
                    let p = m - q;
                    let mut x = leibniz(&a, &b, &phi, p, q);
                    if let Some((a, b, k)) = &together {
                        x = x.meet(leibniz(a, b, k, p, q));
                    }
                    let x = if flips(signs, p, q) { x } else { -x };
                    let o = &mut out[jet_index(p, q)];
                    *o = *o + Box3::point(corner.half).scale(x);
                }
            }
        }
    }
}
