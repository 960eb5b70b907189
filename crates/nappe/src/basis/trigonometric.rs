//! Chashnikov's trigonometric blending functions.

use super::Functions;
use crate::breaks::{Break, Limit, UNIT_BREAKS};
use crate::interval::Interval;
use crate::scalar::{Number, Pack};
use crate::series::Series;
use smallvec::SmallVec;
use std::f64::consts::PI;
use thiserror::Error;

/// The angle is outside the range of trigonometric blending.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum TrigonometricError {
    /// Not a positive number.
    #[error(
        "the angle of trigonometric blending is {alpha} rad: it must lie between 0 and π (180°), at least {:e}",
        Trigonometric::MIN
    )]
    TooSmall {
        /// The angle given, in radians.
        alpha: f64,
    },
    /// Too near π, or above.
    #[error(
        "the angle of trigonometric blending is {alpha} rad ({}°): towards π (180°) the blending functions of the \
         tangents grow without bound, it must be at most {} rad; use a smaller angle, or several surfaces",
        alpha.to_degrees(),
        Trigonometric::MAX
    )]
    TooLarge {
        /// The angle given, in radians.
        alpha: f64,
    },
}

/// The blending functions of an angle `0 < α < π` for which the Coons surface of a rotated profile is the surface of
/// revolution: on `[0, 1]`, with `c = cos α, s = sin α, c_t = cos αt, s_t = sin αt`,
///
/// - `H1 = ((c - c_t)/(1 - c))²` and `H4 = 1 - H1`,
/// - `H2 = (s_t - s)/α + (c - c_t)(c² - c_t)/(α s (1 - c))`,
/// - `H3 = (1 - c_t)(c - c_t)/(α s (1 - c))`,
///
/// in the order value and derivative at 0, derivative and value at 1: `L_i(H_j) = δ_ij`. They satisfy
/// `H1 - α s H3 + c H4 = c_t` and `α H2 + α c H3 + s H4 = s_t`. For α → 0 the limit is
/// `(1-t²)², t(1-t)²(1+t/2), -t²(1-t²)/2, 1-(1-t²)²`.
///
/// Evaluated in products without cancellation. With `p = sin(α(1+t)/2) sin(α(1-t)/2)/sin²(α/2)` and
/// `q = sin²(αt/2)/sin²(α/2) = 1 - p`:
/// `H1 = p²`, `H4 = q(1+p)`, `H3 = -(tan(α/2)/α) p q`,
/// `H2 = 2 sin(αt/2) sin²(α(1-t)/2) sin(α(1+t/2)) / (α s sin²(α/2))`,
/// and derivatives from the factors, so that all orders keep 13 digits of the functions' size for every α accepted.
///
/// Source: Chashnikov, "A surface of revolution as a Coons surface" (2007), §3, (8) to (10).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trigonometric {
    factors: Factors<f64>,
    enclosed: Factors<Interval>,
}

/// What the formulas take from the angle alone.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Factors<S> {
    alpha: S,
    half: S,
    sin_half: S,
    cos_half: S,
    cos: S,
}

impl<S: Number> Factors<S> {
    fn new(alpha: f64) -> Self {
        let half = S::from(0.5 * alpha);
        let alpha = S::from(alpha);
        Self {
            alpha,
            half,
            sin_half: half.sin(),
            cos_half: half.cos(),
            cos: alpha.cos(),
        }
    }

    fn map<T>(self, f: impl Fn(S) -> T) -> Factors<T> {
        Factors {
            alpha: f(self.alpha),
            half: f(self.half),
            sin_half: f(self.sin_half),
            cos_half: f(self.cos_half),
            cos: f(self.cos),
        }
    }
}

impl Trigonometric {
    /// The smallest angle: squares of smaller ones would leave the range of doubles. Long before, the functions agree
    /// with their limit for α → 0 in all digits.
    pub const MIN: f64 = 1e-100;
    /// The largest angle. H2 and H3 are as large as `tan(α/2)/(4α)`, here 1.6·10⁵: nearer to π, errors in tangents
    /// would be magnified so far that boundary data of ten digits gives no surface.
    pub const MAX: f64 = PI - 1e-6;

    /// The functions for an angle in radians.
    pub fn new(alpha: f64) -> Result<Self, TrigonometricError> {
        if alpha > Self::MAX {
            Err(TrigonometricError::TooLarge { alpha })
        } else if alpha >= Self::MIN {
            Ok(Self {
                factors: Factors::new(alpha),
                enclosed: Factors::new(alpha),
            })
        } else {
            Err(TrigonometricError::TooSmall { alpha })
        }
    }

    /// The angle in radians.
    pub fn alpha(&self) -> f64 {
        self.factors.alpha
    }

    fn series<S: Number>(factors: Factors<S>, t: S, order: usize) -> [Series<S>; 4] {
        let Factors {
            alpha: a,
            half,
            sin_half,
            cos_half,
            cos: c,
        } = factors;
        let two = S::from(2.0);
        let sin_cos = |angle: S, rate: S| {
            let mut x = Series::constant(angle, order);
            if order > 0 {
                x.c[1] = rate;
            }
            x.sin_cos()
        };
        let unit = S::ONE / sin_half;
        let (sin_x, cos_x) = sin_cos(half * t, half);
        let near0 = sin_x.scale(unit);
        let (sin_y, cos_y) = sin_cos(half * (S::ONE - t), -half);
        let near1 = sin_y.scale(unit);
        // With x = αt/2 and y = α(1-t)/2 the sines of α(1+t)/2 = α - y and α(1+t/2) = α + x by the addition theorem:
        // near π the sums would round away what is left of sin α = 2 sin(α/2) cos(α/2).
        let s = two * sin_half * cos_half;
        let far0 = (s * cos_y.c[0] - c * sin_y.c[0]) * unit;
        let zero = cos_x.scale(s).add(&sin_x.scale(c));
        // p' = -(α²/(2 sin²(α/2))) sin(αt)/α: differentiating the product instead would cancel.
        let factor = two * (half * unit).sqr();
        let mut p = Series::constant(far0 * near1.c[0], order);
        let mut q = Series::constant(near0.c[0].sqr(), order);
        if order > 0 {
            let slope = sin_cos(a * t, a).0.scale(factor / a);
            for k in 1..=order {
                let d = slope.c[k - 1] / S::from(k as f64);
                p.c[k] = -d;
                q.c[k] = d;
            }
        }
        let mut p1 = p.clone();
        p1.c[0] = p1.c[0] + S::ONE;
        let h3 = p.mul(&q).scale(-(sin_half / cos_half) / a);
        let h2 = near0
            .mul(&near1.sqr())
            .mul(&zero)
            .scale(S::ONE / (a * cos_half));
        [p.sqr(), h2, h3, q.mul(&p1)]
    }

    fn write<S: Number>(factors: Factors<S>, t: S, order: usize, out: &mut [S]) {
        let mut d: SmallVec<[S; 6]> = SmallVec::from_elem(S::ZERO, order + 1);
        for (i, h) in Self::series(factors, t, order).iter().enumerate() {
            h.write_derivatives(&mut d);
            for (k, &d) in d.iter().enumerate() {
                out[4 * k + i] = d;
            }
        }
    }
}

impl Functions for Trigonometric {
    fn count(&self) -> usize {
        4
    }

    fn breaks(&self) -> &[Break] {
        &UNIT_BREAKS
    }

    fn jet_into(&self, t: f64, _limit: Limit, order: usize, out: &mut [f64]) {
        Self::write(self.factors, t, order, out);
    }

    fn pack_into(&self, t: Pack, _limit: Limit, order: usize, out: &mut [Pack]) {
        Self::write(self.factors.map(Pack::from), t, order, out);
    }

    fn enclose_piece(&self, t: Interval, _limit: Limit, order: usize, out: &mut [Interval]) {
        Self::write(self.enclosed, t, order, out);
    }
}
