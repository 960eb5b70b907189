//! The functions of uniform rotation.

use super::Functions;
use crate::breaks::{Break, Limit, UNIT_BREAKS};
use crate::frame::cos_sin;
use crate::interval::Interval;
use std::f64::consts::TAU;

/// Relative difference from a whole turn that is taken as rounding of the angle.
const WHOLE_TURN: f64 = 1e-12;

/// The relative distance within which [`cos_sin`] takes an angle for a multiple of an eighth of a turn.
const SNAP: f64 = 4.0 * f64::EPSILON;

/// The list `1, cos θ(t), sin θ(t)` with `θ(t) = start + angle · t` on `[0, 1]`; angles in radians.
///
/// A whole turn (within a relative 1e-12) is one exactly: the rate is the real number 2π in enclosures, and the
/// values at t = 1 are those at t = 0, so closed surfaces close without a gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    start: f64,
    angle: f64,
    whole: bool,
}

impl Turn {
    /// A rotation through `angle`, from `start`.
    pub fn new(start: f64, angle: f64) -> Self {
        Self {
            start,
            angle,
            whole: (angle.abs() - TAU).abs() <= WHOLE_TURN * TAU,
        }
    }

    /// Derivative k of cos and sin of an angle that moves at a unit rate, from its cosine and sine.
    fn derivative<S: Copy + std::ops::Neg<Output = S>>(k: usize, c: S, s: S) -> [S; 2] {
        match k % 4 {
            0 => [c, s],
            1 => [-s, c],
            2 => [-c, -s],
            _ => [s, -c],
        }
    }
}

impl Functions for Turn {
    fn count(&self) -> usize {
        3
    }

    fn breaks(&self) -> &[Break] {
        &UNIT_BREAKS
    }

    fn jet_into(&self, t: f64, _limit: Limit, order: usize, out: &mut [f64]) {
        let t = if self.whole && t == 1.0 { 0.0 } else { t };
        let (c, s) = cos_sin(self.start + self.angle * t);
        let mut rate = 1.0;
        for k in 0..=order {
            let [c, s] = Self::derivative(k, c, s);
            let one = if k == 0 { 1.0 } else { 0.0 };
            out[3 * k..3 * k + 3].copy_from_slice(&[one, rate * c, rate * s]);
            rate *= self.angle;
        }
    }

    fn enclose_piece(&self, t: Interval, _limit: Limit, order: usize, out: &mut [Interval]) {
        let speed = if self.whole {
            let turn = Interval::pi() * Interval::point(2.0);
            if self.angle < 0.0 { -turn } else { turn }
        } else {
            Interval::point(self.angle)
        };
        let theta = Interval::point(self.start) + speed * t;
        let theta = theta.inflate(SNAP * theta.mag());
        let (c, s) = (theta.cos(), theta.sin());
        let mut rate = Interval::ONE;
        for k in 0..=order {
            let [c, s] = Self::derivative(k, c, s);
            let one = if k == 0 {
                Interval::ONE
            } else {
                Interval::ZERO
            };
            out[3 * k..3 * k + 3].copy_from_slice(&[one, rate * c, rate * s]);
            rate = rate * speed;
        }
    }
}
