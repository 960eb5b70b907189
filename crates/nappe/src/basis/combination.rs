//! Linear combinations of functions: differences of curves, splines with number coefficients, bumps.

use super::{BSplineBasis, Functions, FunctionsRef};
use crate::breaks::{Break, Limit};
use crate::exact::PiecewiseRational;
use crate::interval::Interval;
use crate::scalar::{Number, Pack};
use smallvec::SmallVec;
use std::ops::Range;
use std::sync::Arc;

/// The functions `f_k(t) = Σ_i m_ki a_i(t)` made from a list `a`.
#[derive(Clone, Debug)]
pub struct Combination {
    base: FunctionsRef,
    /// Row-major, one row for each function made.
    matrix: Vec<f64>,
    count: usize,
}

impl Combination {
    /// From the list and one row of factors for each new function. Panics if a row has not one factor for each
    /// function of the list.
    pub fn new(base: FunctionsRef, rows: &[&[f64]]) -> Self {
        let n = base.count();
        assert!(rows.iter().all(|r| r.len() == n), "one factor each");
        Self {
            base,
            matrix: rows.concat(),
            count: rows.len(),
        }
    }

    /// `a_k(t) - b_k(t)` for two lists of the same length over the same domain. Panics if the lengths differ.
    pub fn difference(a: FunctionsRef, b: FunctionsRef) -> Self {
        let n = a.count();
        assert_eq!(n, b.count(), "lists of the same length");
        let mut matrix = vec![0.0; n * 2 * n];
        for k in 0..n {
            matrix[k * 2 * n + k] = 1.0;
            matrix[k * 2 * n + n + k] = -1.0;
        }
        Self {
            base: Arc::new(super::Stack::new(vec![a, b])),
            matrix,
            count: n,
        }
    }

    /// A function on `[0, 1]` that vanishes at both ends: `Σ_i c_i B_{i+1}(t)` over the inner Bernstein polynomials
    /// of degree `c.len() + 1`. The coefficients are sliders of a shape. Panics without coefficients, and with more
    /// than [`BSplineBasis::MAX_DEGREE`]` - 1`.
    pub fn bump(c: &[f64]) -> Self {
        assert!(!c.is_empty(), "a bump has at least one coefficient");
        let mut row = vec![0.0];
        row.extend(c);
        row.push(0.0);
        Self::new(Arc::new(BSplineBasis::bernstein(c.len() + 1)), &[&row])
    }

    fn combine<S: Number>(&self, a: &[S], active: Range<usize>, order: usize, out: &mut [S]) {
        let n = active.len();
        for k in 0..=order {
            for r in 0..self.count {
                let row = &self.matrix[r * self.base.count()..][active.clone()];
                out[k * self.count + r] = row
                    .iter()
                    .zip(&a[k * n..][..n])
                    .filter(|(m, _)| **m != 0.0)
                    .fold(S::ZERO, |s, (&m, &x)| s + S::from(m) * x);
            }
        }
    }
}

impl Functions for Combination {
    fn count(&self) -> usize {
        self.count
    }

    fn breaks(&self) -> &[Break] {
        self.base.breaks()
    }

    fn jet_into(&self, t: f64, limit: Limit, order: usize, out: &mut [f64]) {
        let active = self.base.active(t, limit);
        let mut a: SmallVec<[f64; 32]> = SmallVec::from_elem(0.0, (order + 1) * active.len());
        self.base.jet_into(t, limit, order, &mut a);
        self.combine(&a, active, order, out);
    }

    fn pack_into(&self, t: Pack, limit: Limit, order: usize, out: &mut [Pack]) {
        let Some(active) = t.common(|t| self.base.active(t, limit)) else {
            return t.each_lane(out, |t, out| self.jet_into(t, limit, order, out));
        };
        let mut a: SmallVec<[Pack; 16]> =
            SmallVec::from_elem(Pack::ZERO, (order + 1) * active.len());
        self.base.pack_into(t, limit, order, &mut a);
        self.combine(&a, active, order, out);
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, order: usize, out: &mut [Interval]) {
        let active = self.base.active(t.mid(), limit);
        let mut a: SmallVec<[Interval; 32]> =
            SmallVec::from_elem(Interval::ENTIRE, (order + 1) * active.len());
        self.base.enclose_piece(t, limit, order, &mut a);
        self.combine(&a, active, order, out);
    }

    fn to_piecewise(&self) -> Option<PiecewiseRational> {
        let base = self.base.to_piecewise()?;
        let (n, degree) = (self.base.count(), base.degree());
        let (mut num, mut den) = (Vec::new(), Vec::new());
        for piece in 0..base.breaks().len() - 1 {
            for row in self.matrix.chunks_exact(n) {
                let mut sum = vec![0.0; degree + 1];
                for (i, m) in row.iter().enumerate() {
                    for (s, c) in sum.iter_mut().zip(base.numerator(piece, i)) {
                        *s += m * c;
                    }
                }
                num.extend(sum);
            }
            den.extend(base.denominator(piece));
        }
        let breaks = base.breaks().to_vec();
        Some(if base.is_rational() {
            PiecewiseRational::rational(breaks, degree, self.count, num, den)
        } else {
            PiecewiseRational::polynomial(breaks, degree, self.count, num)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bump_vanishes_at_the_ends_and_is_its_polynomial_between() {
        let b = Combination::bump(&[2.0, -1.0]);
        for t in [0.0, 0.3, 0.8, 1.0] {
            let mut out = [0.0; 2];
            b.jet_into(t, Limit::Above, 1, &mut out);
            let s = 1.0 - t;
            let (want, slope) = (
                6.0 * t * s * s - 3.0 * t * t * s,
                6.0 * s * s - 12.0 * t * s - 6.0 * t * s + 3.0 * t * t,
            );
            assert!((out[0] - want).abs() < 1e-15, "{t} {out:?} {want}");
            assert!((out[1] - slope).abs() < 1e-14, "{t} {out:?} {slope}");
            assert!((b.to_piecewise().unwrap().value(t)[0] - want).abs() < 1e-15);
        }
    }

    #[test]
    fn a_difference_encloses_its_values() {
        let a: FunctionsRef = Arc::new(BSplineBasis::bernstein(3));
        let b: FunctionsRef =
            Arc::new(Combination::new(a.clone(), &[&[0.0, 1.0, 0.0, 0.0][..]; 4]));
        let d = Combination::difference(a, b);
        let t = Interval::new(0.2, 0.3);
        let mut boxes = [Interval::ENTIRE; 8];
        d.enclose_piece(t, Limit::Above, 1, &mut boxes);
        let mut out = [0.0; 8];
        d.jet_into(0.25, Limit::Above, 1, &mut out);
        assert!(boxes.iter().zip(out).all(|(b, x)| b.contains(x)));
        assert_eq!(out[1], 0.0);
    }
}
