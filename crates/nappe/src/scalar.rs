//! What a formula needs of a number, so that one text serves values (`f64`) and enclosures ([`Interval`]).

use crate::interval::Interval;
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// `f64` or [`Interval`]. Kinds write their formula once over this trait: evaluated with `f64` it gives values, with
/// [`Interval`] it gives rigorous enclosures.
pub trait Scalar:
    Copy
    + Debug
    + PartialEq
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Send
    + Sync
    + 'static
{
    /// The number 0.
    const ZERO: Self;
    /// The number 1.
    const ONE: Self;
    /// The square.
    fn sqr(self) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// The exponential.
    fn exp(self) -> Self;
    /// The natural logarithm.
    fn ln(self) -> Self;
    /// The sine of an angle in radians.
    fn sin(self) -> Self;
    /// The cosine of an angle in radians.
    fn cos(self) -> Self;
    /// The inverse sine.
    fn asin(self) -> Self;
    /// The inverse cosine.
    fn acos(self) -> Self;
    /// The inverse tangent.
    fn atan(self) -> Self;
    /// The tangent of an angle in radians.
    fn tan(self) -> Self;
    /// The hyperbolic sine.
    fn sinh(self) -> Self;
    /// The hyperbolic cosine.
    fn cosh(self) -> Self;
    /// The hyperbolic tangent.
    fn tanh(self) -> Self;
    /// An integer power.
    fn powi(self, n: i32) -> Self;
    /// The number that decides a branch: the value, or the middle of the enclosure.
    fn mid(self) -> f64;
    /// True only for exactly zero.
    fn is_zero(self) -> bool {
        self == Self::ZERO
    }
}

macro_rules! forward {
    ($t:ty) => {
        fn sqrt(self) -> Self {
            <$t>::sqrt(self)
        }
        fn exp(self) -> Self {
            <$t>::exp(self)
        }
        fn ln(self) -> Self {
            <$t>::ln(self)
        }
        fn sin(self) -> Self {
            <$t>::sin(self)
        }
        fn cos(self) -> Self {
            <$t>::cos(self)
        }
        fn asin(self) -> Self {
            <$t>::asin(self)
        }
        fn acos(self) -> Self {
            <$t>::acos(self)
        }
        fn atan(self) -> Self {
            <$t>::atan(self)
        }
        fn tan(self) -> Self {
            <$t>::tan(self)
        }
        fn sinh(self) -> Self {
            <$t>::sinh(self)
        }
        fn cosh(self) -> Self {
            <$t>::cosh(self)
        }
        fn tanh(self) -> Self {
            <$t>::tanh(self)
        }
        fn powi(self, n: i32) -> Self {
            <$t>::powi(self, n)
        }
    };
}

impl Scalar for f64 {
    const ZERO: f64 = 0.0;
    const ONE: f64 = 1.0;
    fn sqr(self) -> f64 {
        self * self
    }
    fn mid(self) -> f64 {
        self
    }
    forward!(f64);
}

impl Scalar for Interval {
    const ZERO: Interval = Interval::ZERO;
    const ONE: Interval = Interval::ONE;
    fn sqr(self) -> Interval {
        Interval::sqr(self)
    }
    fn mid(self) -> f64 {
        Interval::mid(self)
    }
    forward!(Interval);
}

/// A vector over a [`Scalar`], for formulas written once for values and enclosures.
pub type Vec3<S> = [S; 3];

/// The dot product.
pub fn dot<S: Scalar>(a: Vec3<S>, b: Vec3<S>) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The cross product.
pub fn cross<S: Scalar>(a: Vec3<S>, b: Vec3<S>) -> Vec3<S> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
