//! Numbers known within a radius: cheaper than intervals with outward rounding, in sums and products just as sharp.
//!
//! Radii cover the rounding of middles and, by a factor, their own. What is no number or not finite has a radius that is
//! no number or not finite, so no comparison with a bound holds.

use crate::box3::Box3;
use crate::interval::Interval;
use glam::DMat3;
use std::ops::{Add, Mul, Sub};

/// Covers the roundings in the sum that makes a radius, all of whose terms are positive.
const ROUND_UP: f64 = 1.0 + 8.0 * f64::EPSILON;

/// All numbers within a distance of a middle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Ball {
    pub(crate) mid: f64,
    pub(crate) rad: f64,
}

impl Ball {
    pub(crate) fn point(mid: f64) -> Self {
        Self { mid, rad: 0.0 }
    }

    /// With the radius and the rounding of the middle, which is at most half a unit in its last place.
    #[inline]
    fn rounded(mid: f64, rad: f64) -> Self {
        Self {
            mid,
            rad: (rad + f64::EPSILON * mid.abs() + f64::MIN_POSITIVE) * ROUND_UP,
        }
    }

    /// The largest absolute value.
    #[inline]
    pub(crate) fn mag(self) -> f64 {
        (self.mid.abs() + self.rad) * ROUND_UP
    }

    /// A lower bound.
    #[inline]
    pub(crate) fn lo(self) -> f64 {
        (self.mid - self.rad).next_down()
    }
}

impl From<Interval> for Ball {
    #[inline]
    fn from(i: Interval) -> Self {
        let mid = 0.5 * i.lo + 0.5 * i.hi;
        Self::rounded(mid, (i.hi - mid).max(mid - i.lo))
    }
}

impl Add for Ball {
    type Output = Ball;
    #[inline]
    fn add(self, o: Ball) -> Ball {
        Ball::rounded(self.mid + o.mid, self.rad + o.rad)
    }
}

impl Sub for Ball {
    type Output = Ball;
    #[inline]
    fn sub(self, o: Ball) -> Ball {
        Ball::rounded(self.mid - o.mid, self.rad + o.rad)
    }
}

impl Mul for Ball {
    type Output = Ball;
    #[inline]
    fn mul(self, o: Ball) -> Ball {
        let rad = self.mid.abs() * o.rad + self.rad * (o.mid.abs() + o.rad);
        Ball::rounded(self.mid * o.mid, rad)
    }
}

/// A vector of balls.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Ball3 {
    pub(crate) x: Ball,
    pub(crate) y: Ball,
    pub(crate) z: Ball,
}

impl Ball3 {
    pub(crate) fn to_array(self) -> [Ball; 3] {
        [self.x, self.y, self.z]
    }

    #[inline]
    fn map(self, f: impl Fn(Ball) -> Ball) -> Self {
        Self {
            x: f(self.x),
            y: f(self.y),
            z: f(self.z),
        }
    }

    /// Every vector times a number.
    #[inline]
    pub(crate) fn scale(self, s: f64) -> Self {
        self.map(|x| x * Ball::point(s))
    }

    /// The images under a linear map.
    #[inline]
    pub(crate) fn image(self, map: &DMat3) -> Self {
        let row = |k: usize| {
            let [x, y, z] = map.row(k).to_array().map(Ball::point);
            self.x * x + self.y * y + self.z * z
        };
        Self {
            x: row(0),
            y: row(1),
            z: row(2),
        }
    }

    #[inline]
    pub(crate) fn cross(self, o: Self) -> Self {
        Self {
            x: self.y * o.z - self.z * o.y,
            y: self.z * o.x - self.x * o.z,
            z: self.x * o.y - self.y * o.x,
        }
    }

    /// The greatest length.
    #[inline]
    pub(crate) fn length(self) -> f64 {
        let [x, y, z] = self.to_array().map(Ball::mag);
        // Squares may be lost below the smallest number.
        (x * x + y * y + z * z + f64::MIN_POSITIVE).sqrt() * ROUND_UP
    }
}

impl From<Box3> for Ball3 {
    fn from(b: Box3) -> Self {
        let [x, y, z] = b.to_array().map(Ball::from);
        Self { x, y, z }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::Random;

    #[test]
    fn balls_contain_what_intervals_say() {
        let mut random = Random(11);
        for _ in 0..2000 {
            let mut any = || {
                let size = 10f64.powf(8.0 * random.unit() - 4.0);
                let (a, b) = (random.unit() - 0.5, 0.1 * random.unit());
                Interval::new(size * a, size * (a + b * random.unit()))
            };
            let (a, b, c) = (any(), any(), any());
            // At all ends, with exact sums of products as far as intervals tell.
            for k in 0..8usize {
                let end = |i: Interval, bit: usize| if k >> bit & 1 == 0 { i.lo } else { i.hi };
                let [x, y, z] = [end(a, 0), end(b, 1), end(c, 2)];
                let exact = Interval::point(x) * Interval::point(y) - Interval::point(z)
                    + Interval::point(x);
                let ball = Ball::from(a) * Ball::from(b) - Ball::from(c) + Ball::from(a);
                let [lo, hi] = [ball.mid - ball.rad, ball.mid + ball.rad];
                assert!(lo <= exact.hi && exact.lo <= hi, "{ball:?} {exact:?}");
                assert!(ball.mag() >= exact.mig() && ball.lo() <= exact.hi);
            }
        }
    }

    #[test]
    fn what_is_not_known_passes_no_comparison() {
        for b in [
            Ball::from(Interval::ENTIRE) + Ball::point(1.0),
            Ball::from(Interval::ENTIRE) * Ball::point(0.0),
            Ball::point(f64::NAN) * Ball::point(0.0),
        ] {
            assert!(!b.mag().is_finite() && b.lo().is_nan(), "{b:?}");
        }
    }
}
