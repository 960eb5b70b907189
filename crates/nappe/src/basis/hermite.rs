//! The cubic Hermite basis.

use super::{BSplineBasis, Functions};
use crate::breaks::{Break, Limit, UNIT_BREAKS};
use crate::exact::PiecewiseRational;
use crate::interval::Interval;
use crate::scalar::{Number, Pack};

/// The four cubic Hermite functions on `[0, 1]`, in the order value and derivative at 0, derivative and value at 1:
/// `H1 = (1-t)²(1+2t)`, `H2 = t(1-t)²`, `H3 = -t²(1-t)`, `H4 = t²(3-2t)`.
///
/// `L_i(H_j) = δ_ij` for `L1 f = f(0), L2 f = f'(0), L3 f = f'(1), L4 f = f(1)`, and `H1 + H4 = 1`.
/// Evaluated through Bernstein polynomials of degree 3, which keeps full relative accuracy near both ends.
/// Source: "Description and construction of surfaces in space", (12), where they are F1, F3, F4, F2.
#[derive(Clone, Debug)]
pub struct Hermite {
    bernstein: BSplineBasis,
}

/// The Bernstein coefficients of H1 … H4.
const COEFFICIENTS: [[f64; 4]; 4] = [
    [1.0, 1.0, 0.0, 0.0],
    [0.0, 1.0 / 3.0, 0.0, 0.0],
    [0.0, 0.0, -1.0 / 3.0, 0.0],
    [0.0, 0.0, 1.0, 1.0],
];

impl Hermite {
    /// The basis.
    pub fn new() -> Self {
        Self {
            bernstein: BSplineBasis::bernstein(3),
        }
    }

    /// Replaces rows of Bernstein polynomials by rows of Hermite functions.
    fn combine<S: Number>(out: &mut [S]) {
        let three = S::from(3.0);
        for row in out.chunks_exact_mut(4) {
            let [b0, b1, b2, b3] = [row[0], row[1], row[2], row[3]];
            row.copy_from_slice(&[b0 + b1, b1 / three, -(b2 / three), b2 + b3]);
        }
    }
}

impl Default for Hermite {
    fn default() -> Self {
        Self::new()
    }
}

impl Functions for Hermite {
    fn count(&self) -> usize {
        4
    }

    fn breaks(&self) -> &[Break] {
        &UNIT_BREAKS
    }

    fn jet_into(&self, t: f64, limit: Limit, order: usize, out: &mut [f64]) {
        self.bernstein.jet_into(t, limit, order, out);
        Self::combine(&mut out[..4 * (order + 1)]);
    }

    fn pack_into(&self, t: Pack, limit: Limit, order: usize, out: &mut [Pack]) {
        self.bernstein.pack_into(t, limit, order, out);
        Self::combine(&mut out[..4 * (order + 1)]);
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, order: usize, out: &mut [Interval]) {
        self.bernstein.enclose_piece(t, limit, order, out);
        Self::combine(&mut out[..4 * (order + 1)]);
    }

    fn to_piecewise(&self) -> Option<PiecewiseRational> {
        Some(PiecewiseRational::polynomial(
            UNIT_BREAKS.to_vec(),
            3,
            4,
            COEFFICIENTS.as_flattened().to_vec(),
        ))
    }
}
