//! The second cross-derivative that continues a neighbouring surface over a shared side with equal curvatures.

use super::SurfaceRef;
use super::neighbour::elevated_denominator;
use super::sides::Side;
use crate::basis::{BSplineBasis, Functions, SideJet};
use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit};
use crate::curve::Curve;
use crate::exact::{
    NurbsCurve, Row, bernstein_elevate, bernstein_product, bernstein_restrict, join,
};
use crate::interval::Interval;
use crate::scalar::Scalar;
use glam::{DVec3, DVec4};
use smallvec::SmallVec;

/// `a² n₂ + 2ab n' + b² s'' + c n + d s'` along a side of a surface on `[0, 1]`, where s is the side, n and n₂ the first and
/// second derivatives across it, and a, b, c, d are linear along it. By the chain rule this is the second derivative of a
/// surface that goes on with the parameters of this one, `a v + c v²/2` across and `b v + d v²/2` along: so a surface with
/// the cross-derivative `a n + b s'` and this second one joins with equal curvatures.
#[derive(Clone, Debug)]
pub(super) struct SecondOutOfSide {
    jet: SideJet,
    breaks: Vec<Break>,
    /// The Bernstein coefficients of the factors of [`PARTS`].
    factors: [[f64; 3]; 5],
}

/// The derivatives that are summed up, by their orders across the side and along it.
const PARTS: [(usize, usize); 5] = [(2, 0), (1, 1), (0, 2), (1, 0), (0, 1)];

/// The number of functions of a side and its first and second derivative across.
const COUNT: usize = 9;

/// A part along the side shorter than this, relative to the derivatives it is added to, is what rounding leaves where the
/// parameter lines are followed, and counts as zero. It costs breaks and degrees.
const STRAIGHT: f64 = 1e-11;

impl SecondOutOfSide {
    /// From the factors a and b at both ends, for a parameter along that runs over `[0, 1]`; c and d are chosen so that the
    /// ends come nearest to the two given vectors.
    pub(super) fn new(
        other: (SurfaceRef, Side),
        reversed: bool,
        origin: DVec3,
        [a, mut b]: [[f64; 2]; 2],
        ends: [DVec3; 2],
    ) -> Self {
        let jet = SideJet::new(other, reversed, 2, origin);
        let at = [(0.0, Limit::Above), (1.0, Limit::Below)];
        let d = at.map(|(t, limit)| jet.derivatives(t, limit, 2));
        let (across, along) = ([0, 1].map(|k| d[k][1][0]), [0, 1].map(|k| d[k][0][1]));
        let lengths = [0, 1].map(|k| a[k].abs() * across[k].length());
        if (0..2).all(|k| b[k].abs() * along[k].length() <= STRAIGHT * lengths[k]) {
            b = [0.0; 2];
        }
        let (mut c, mut e) = ([0.0; 2], [0.0; 2]);
        for k in 0..2 {
            let (n, l) = (across[k], along[k]);
            let known = d[k][2][0] * (a[k] * a[k])
                + d[k][1][1] * (2.0 * a[k] * b[k])
                + d[k][0][2] * (b[k] * b[k]);
            let rest = ends[k] - known;
            let (nn, nl, ll) = (n.dot(n), n.dot(l), l.dot(l));
            let determinant = nn * ll - nl * nl;
            // Where the plane is lost to rounding nothing can be fitted; the corner report then tells.
            if determinant > 1e-20 * nn * ll {
                let (rn, rl) = (rest.dot(n), rest.dot(l));
                c[k] = (rn * ll - rl * nl) / determinant;
                e[k] = (rl * nn - rn * nl) / determinant;
            }
        }
        let longest = |k: usize| lengths[k].max(ends[k].length());
        if (0..2).all(|k| e[k].abs() * along[k].length() <= STRAIGHT * longest(k)) {
            e = [0.0; 2];
        }
        let product = |p: [f64; 2], q: [f64; 2], by: f64| {
            [
                by * p[0] * q[0],
                0.5 * by * (p[0] * q[1] + p[1] * q[0]),
                by * p[1] * q[1],
            ]
        };
        let one = [1.0; 2];
        let factors = [
            product(a, a, 1.0),
            product(a, b, 2.0),
            product(b, b, 1.0),
            product(c, one, 1.0),
            product(e, one, 1.0),
        ];
        let mut this = Self {
            breaks: Vec::new(),
            jet,
            factors,
        };
        let lost = this.lost() as i32;
        let breaks = this.jet.breaks().iter();
        this.breaks = breaks.map(|b| Break::new(b.at, b.smooth - lost)).collect();
        this
    }

    /// The parts that count.
    fn parts(&self) -> impl Iterator<Item = ((usize, usize), [f64; 3])> + '_ {
        PARTS
            .into_iter()
            .zip(self.factors)
            .filter(|(_, f)| *f != [0.0; 3])
    }

    /// The highest order of derivatives along the side among them.
    fn lost(&self) -> usize {
        self.parts().map(|(part, _)| part.1).max().unwrap_or(0)
    }

    /// One coordinate of the k-th derivative by Leibniz' rule, from those of the side and its derivatives across, which are
    /// given by their orders across and along.
    fn combine<S: Scalar>(&self, t: S, at: impl Fn(usize, usize) -> S, k: usize) -> S {
        let (s, two) = (S::ONE - t, S::from(2.0));
        let mut sum = S::ZERO;
        for ((across, along), factor) in self.parts() {
            let [p, q, r] = factor.map(S::from);
            let value = s * (s * p + t * q) + t * (s * q + t * r);
            sum = sum + value * at(across, along + k);
            if k > 0 {
                let slope = two * (s * (q - p) + t * (r - q));
                sum = sum + S::from(k as f64) * slope * at(across, along + k - 1);
            }
            if k > 1 {
                let bend = two * ((r - q) - (q - p));
                let pairs = S::from((k * (k - 1) / 2) as f64);
                sum = sum + pairs * bend * at(across, along + k - 2);
            }
        }
        sum
    }
}

impl Curve for SecondOutOfSide {
    fn breaks(&self) -> &[Break] {
        &self.breaks
    }

    fn jet_into(&self, t: f64, limit: Limit, out: &mut [DVec3]) {
        let order = out.len() - 1 + self.lost();
        let mut d: SmallVec<[f64; 64]> = SmallVec::from_elem(0.0, COUNT * (order + 1));
        self.jet.jet_into(t, limit, order, &mut d);
        for (k, o) in out.iter_mut().enumerate() {
            let x = |c: usize| self.combine(t, |i, j| d[COUNT * j + 3 * i + c], k);
            *o = DVec3::new(x(0), x(1), x(2));
        }
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, out: &mut [Box3]) {
        let order = out.len() - 1 + self.lost();
        let mut d: SmallVec<[Interval; 64]> =
            SmallVec::from_elem(Interval::ENTIRE, COUNT * (order + 1));
        self.jet.enclose_piece(t, limit, order, &mut d);
        for (k, o) in out.iter_mut().enumerate() {
            let x = |c: usize| self.combine(t, |i, j| d[COUNT * j + 3 * i + c], k);
            *o = Box3::from([x(0), x(1), x(2)]);
        }
    }

    /// Of two degrees more than the side. None for a rational surface, unless the parameter lines across are followed:
    /// derivatives along would have a denominator of another power.
    fn to_nurbs(&self) -> Option<NurbsCurve> {
        let whole = self.jet.to_piecewise()?;
        let degree = whole.degree() + 2;
        if degree > BSplineBasis::MAX_DEGREE || (whole.is_rational() && self.lost() > 0) {
            return None;
        }
        let lost = self.lost() as i32;
        let smooth = |b: &Break| Break::new(b.at, b.smooth - lost);
        let breaks: Vec<Break> = whole.breaks().iter().map(smooth).collect();
        let pieces: Vec<Vec<Row>> = (0..breaks.pieces())
            .map(|i| {
                let piece = breaks.piece(i);
                let mut points = vec![vec![DVec4::ZERO]; degree + 1];
                for ((across, along), factor) in self.parts() {
                    let factor = bernstein_restrict(&factor, piece.lo, piece.hi);
                    for c in 0..3 {
                        let mut n = whole.numerator(i, 3 * across + c).to_vec();
                        for _ in 0..along {
                            n = slope(&n, piece.width());
                        }
                        let n = bernstein_elevate(&bernstein_product(&n, &factor), degree);
                        points.iter_mut().zip(n).for_each(|(p, n)| p[0][c] += n);
                    }
                }
                let w = elevated_denominator(&whole.denominator(i), degree);
                points.iter_mut().zip(w).for_each(|(p, w)| p[0].w = w);
                points
            })
            .collect();
        NurbsCurve::from_spline(join(&breaks, degree, &pieces)).ok()
    }
}

/// The derivative of a polynomial over a piece of some width.
fn slope(c: &[f64], width: f64) -> Vec<f64> {
    if c.len() == 1 {
        return vec![0.0];
    }
    let rate = (c.len() - 1) as f64 / width;
    c.windows(2).map(|p| (p[1] - p[0]) * rate).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::NurbsSurface;
    use crate::laws::{self, Random};
    use std::sync::Arc;

    /// A spline surface with breaks, over [0, 4] × [0, 3].
    fn surface(rational: bool) -> SurfaceRef {
        let mut random = Random(5);
        let points: Vec<_> = (0..42)
            .map(|k| DVec3::new((k / 6) as f64, (k % 6) as f64, random.unit()))
            .collect();
        let weights: Vec<_> = (0..42).map(|_| 0.5 + random.unit()).collect();
        let scaled = |p: usize, n: usize, f: f64| {
            let knots = BSplineBasis::clamped_uniform(p, n);
            knots.into_iter().map(|k| k * f).collect()
        };
        let knots = [scaled(4, 7, 4.0), scaled(4, 6, 3.0)];
        let weights = rational.then_some(&weights[..]);
        Arc::new(NurbsSurface::new([4, 4], knots, &points, weights).unwrap())
    }

    #[test]
    fn laws_of_the_second_continuation() {
        for rational in [false, true] {
            let s = surface(rational);
            for (side, reversed) in Side::ALL.into_iter().flat_map(|s| [(s, false), (s, true)]) {
                for b in [[0.0, 0.0], [0.4, -0.7]] {
                    let ends = [DVec3::new(1.0, 2.0, 0.5), DVec3::new(-0.5, 1.0, 2.0)];
                    let ab = [[0.7, 1.3], b];
                    let other = (s.clone(), side);
                    let c = SecondOutOfSide::new(other, reversed, s.point([0.0; 2]), ab, ends);
                    laws::curve(&c);
                    assert_eq!(c.to_nurbs().is_some(), !rational);
                }
            }
        }
    }
}
