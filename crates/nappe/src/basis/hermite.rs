//! Hermite bases: polynomials with given values and derivatives at both ends.

use super::{BSplineBasis, Functions};
use crate::breaks::{Break, Limit, UNIT_BREAKS};
use crate::exact::PiecewiseRational;
use crate::interval::Interval;
use crate::scalar::{Number, Pack};
use crate::series::binomial;

/// The Hermite functions of two-point interpolation on `[0, 1]`: for derivatives up to `m` at 0 and up to `n` at 1 the
/// `m + n + 2` polynomials of degree `d = m + n + 1` of which each has one of these derivatives equal to 1 and the others 0.
/// In the order: value, slope, … at 0; then the n-th derivative, …, slope, value at 1.
///
/// The cubic ones, [`Hermite::new`], are `H1 = (1-t)²(1+2t)`, `H2 = t(1-t)²`, `H3 = -t²(1-t)`, `H4 = t²(3-2t)`.
///
/// The function of the i-th derivative at 0 is `(d-i)!/d! Σ_{j=i}^m C(j, i) B_j` with the Bernstein polynomials B of degree
/// d, that at 1 is its mirror image, with the sign of `(-1)ⁱ`; the functions of the two values sum to 1. Through Bernstein
/// polynomials they keep full relative accuracy near both ends.
/// Source: "Description and construction of surfaces in space", (12), where the cubic ones are F1, F3, F4, F2.
#[derive(Clone, Debug)]
pub struct Hermite {
    bernstein: BSplineBasis,
    orders: [usize; 2],
}

impl Hermite {
    /// The highest order of the derivatives that are given at an end.
    pub const MAX_ORDER: usize = 2;

    /// The cubic functions: value and slope at both ends.
    pub fn new() -> Self {
        Self::of_orders([1, 1])
    }

    /// The functions for derivatives up to the given orders, at 0 and at 1: `[2, 2]` are the quintic ones.
    ///
    /// Panics for an order above [`Self::MAX_ORDER`].
    pub fn of_orders(orders: [usize; 2]) -> Self {
        assert!(
            orders.iter().all(|&k| k <= Self::MAX_ORDER),
            "derivatives up to order {}, not {orders:?}",
            Self::MAX_ORDER
        );
        Self {
            bernstein: BSplineBasis::bernstein(orders[0] + orders[1] + 1),
            orders,
        }
    }

    /// Replaces rows of Bernstein polynomials by rows of Hermite functions.
    fn combine<S: Number>(&self, out: &mut [S]) {
        let count = self.count();
        for row in out.chunks_exact_mut(count) {
            let mut b = [S::ZERO; 2 * (Self::MAX_ORDER + 1)];
            b[..count].copy_from_slice(row);
            for (k, o) in row.iter_mut().enumerate() {
                *o = self.function(k, |j| b[j]);
            }
        }
    }

    /// One of the functions from the Bernstein polynomials.
    fn function<S: Number>(&self, k: usize, b: impl Fn(usize) -> S) -> S {
        let degree = self.count() - 1;
        let upper = k > self.orders[0];
        let (i, m) = if upper {
            (degree - k, self.orders[1])
        } else {
            (k, self.orders[0])
        };
        let place = |j: usize| if upper { degree - j } else { j };
        let mut sum = b(place(i));
        for j in i + 1..=m {
            let next = b(place(j));
            // C(j, 0) is 1: nothing is to be rounded.
            sum = sum
                + if i == 0 {
                    next
                } else {
                    S::from(binomial(j, i)) * next
                };
        }
        if i == 0 {
            return sum;
        }
        let divisor: usize = (degree - i + 1..=degree).product();
        let f = sum / S::from(divisor as f64);
        if upper && i % 2 == 1 { -f } else { f }
    }
}

impl Default for Hermite {
    fn default() -> Self {
        Self::new()
    }
}

impl Functions for Hermite {
    fn count(&self) -> usize {
        self.orders[0] + self.orders[1] + 2
    }

    fn breaks(&self) -> &[Break] {
        &UNIT_BREAKS
    }

    fn jet_into(&self, t: f64, limit: Limit, order: usize, out: &mut [f64]) {
        self.bernstein.jet_into(t, limit, order, out);
        self.combine(&mut out[..self.count() * (order + 1)]);
    }

    fn pack_into(&self, t: Pack, limit: Limit, order: usize, out: &mut [Pack]) {
        self.bernstein.pack_into(t, limit, order, out);
        self.combine(&mut out[..self.count() * (order + 1)]);
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, order: usize, out: &mut [Interval]) {
        self.bernstein.enclose_piece(t, limit, order, out);
        self.combine(&mut out[..self.count() * (order + 1)]);
    }

    fn to_piecewise(&self) -> Option<PiecewiseRational> {
        let count = self.count();
        let unit = |at: usize| move |j: usize| if j == at { 1.0 } else { 0.0 };
        let coefficients = (0..count * count).map(|x| self.function(x / count, unit(x % count)));
        Some(PiecewiseRational::polynomial(
            UNIT_BREAKS.to_vec(),
            count - 1,
            count,
            coefficients.collect(),
        ))
    }
}
