//! Quintic Hermite interpolation: the one-variable scheme of certified approximation, and its proven bounds.
//!
//! `P f` is the polynomial of degree 5 on `[0, h]` that has the values and first two derivatives of f at both ends.
//! For six times differentiable f, the Cauchy remainder is
//!
//!   `f(t) - P f(t) = f⁽⁶⁾(ξ)/6! · t³ (t - h)³`, so `|f - P f| <= max|f⁽⁶⁾| h⁶ / (6! · 64)`,
//!
//! for each coordinate, and with the coordinates' maxima for the length of a vector. `P` itself, applied to end data
//! bounded by `|f| <= a, |f'| <= b, |f''| <= c`, gives at most `a + 5/16 h b + 1/32 h² c`: the basis functions of the
//! values are positive and sum to 1, those of the first derivatives sum in absolute value to
//! `h s(1-s)(1 + s - s²) <= 5/16 h` with s = t/h, those of the second to `h² s²(1-s)²/2 <= h²/32`.
//!
//! Source: Davis, *Interpolation and Approximation*, theorem 3.5.1.

use super::spline::Row;
use crate::interval::Interval;
use glam::DVec4;

/// The degree of the pieces.
pub(crate) const DEGREE: usize = 5;
/// How smoothly pieces join where the function is smooth enough.
pub(crate) const SMOOTH: i32 = 2;
/// The order of the derivative that bounds the error.
pub(crate) const ORDER: usize = 6;
/// The number of data at each end: the value and two derivatives.
pub(crate) const DATA: usize = 3;

/// An upper bound of `m h⁶ / 46080`.
pub(crate) fn remainder(m: f64, h: f64) -> f64 {
    let n = Interval::point;
    (n(m) * n(h).powi(6) / n(46080.0)).hi
}

/// An upper bound of `|P f|` for end data bounded by `data`: the norm of the operator, derivative by derivative.
pub(crate) fn operator_bound(data: [f64; DATA], h: f64) -> f64 {
    let n = Interval::point;
    let (a, b, c) = (n(data[0]), n(data[1]), n(data[2]));
    (a + n(0.3125) * n(h) * b + n(h).sqr() * c / n(32.0)).hi
}

/// The Bézier points of `P f` on an interval of length h, from the derivatives 0 to 2 at its start and its end.
pub(crate) fn bezier(start: &[Row; DATA], end: &[Row; DATA], h: f64) -> Vec<Row> {
    let sum = |data: &[Row; DATA], c: [f64; DATA]| -> Row {
        (0..data[0].len())
            .map(|i| data[0][i] * c[0] + data[1][i] * c[1] + data[2][i] * c[2])
            .collect::<Vec<DVec4>>()
    };
    vec![
        start[0].clone(),
        sum(start, [1.0, h / 5.0, 0.0]),
        sum(start, [1.0, 2.0 * h / 5.0, h * h / 20.0]),
        sum(end, [1.0, -2.0 * h / 5.0, h * h / 20.0]),
        sum(end, [1.0, -h / 5.0, 0.0]),
        end[0].clone(),
    ]
}
