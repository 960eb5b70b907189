//! What expressions need of a number beyond [`Scalar`].

use crate::interval::Interval;
use crate::scalar::Scalar;
use std::f64::consts::E;

/// `f64` or [`Interval`]: decisions are made on the range of a number, which for `f64` is one point.
pub trait Number: Scalar {
    /// All values the number may stand for.
    fn range(self) -> Interval;
    /// A number that may be any in the range. For `f64`, whose ranges are points, that point.
    fn from_range(x: Interval) -> Self;
    /// A number that may be either.
    fn hull(self, o: Self) -> Self;
    /// π.
    fn pi() -> Self;
    /// Euler's number.
    fn euler() -> Self;
    /// The angle of the point (x, y), not near the negative x axis and the origin.
    fn atan2(y: Self, x: Self) -> Self;
}

impl Number for f64 {
    fn range(self) -> Interval {
        Interval::point(self)
    }
    fn from_range(x: Interval) -> Self {
        x.mid()
    }
    fn hull(self, _: Self) -> Self {
        self
    }
    fn pi() -> Self {
        std::f64::consts::PI
    }
    fn euler() -> Self {
        E
    }
    fn atan2(y: Self, x: Self) -> Self {
        y.atan2(x)
    }
}

impl Number for Interval {
    fn range(self) -> Interval {
        self
    }
    fn from_range(x: Interval) -> Self {
        x
    }
    fn hull(self, o: Self) -> Self {
        Interval::hull(self, o)
    }
    fn pi() -> Self {
        Interval::pi()
    }
    fn euler() -> Self {
        Interval::around(E)
    }
    fn atan2(y: Self, x: Self) -> Self {
        let quarter = Interval::pi() / Interval::point(2.0);
        if x.lo > 0.0 {
            (y / x).atan()
        } else if y.lo > 0.0 {
            quarter - (x / y).atan()
        } else if y.hi < 0.0 {
            -quarter - (x / y).atan()
        } else {
            Interval {
                lo: -Interval::pi().hi,
                hi: Interval::pi().hi,
            }
        }
    }
}
