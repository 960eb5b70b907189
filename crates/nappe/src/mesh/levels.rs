//! The fewest bisections that the parts of a square need, a register of parts at a time.
//!
//! That is [`Bound::level`](super::partners::Bound::level) of each part, which is found for all together: parts beside each
//! other need about the same.

use super::bound::ROUND_UP;
use super::partners::{BETWEEN, share};
use super::parts::{Bounds, Tell};
use crate::scalar::Pack;
use crate::simd::{Lanes, Registers};

/// Of parts that need more bisections nothing is said.
pub(super) const DEEPEST: u32 = 24;
/// No number of bisections is enough.
const NEVER: u32 = u32::MAX;

/// What a part needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Level {
    bisections: u32,
    deviation: f64,
    at_best: u32,
    /// The error that could be proven at best for the part without bisections.
    pub(super) best_error: f64,
}

impl Level {
    /// The fewest bisections that keep the tolerance, with the bound after these.
    pub(super) fn settled(&self) -> Option<(u32, f64)> {
        (self.bisections != NEVER).then_some((self.bisections, self.deviation))
    }

    /// Likewise at best.
    pub(super) fn best(&self) -> Option<u32> {
        (self.at_best != NEVER).then_some(self.at_best)
    }
}

/// Asks for what parts need.
pub(super) struct Levels {
    grain: f64,
    tol: f64,
}

impl Levels {
    /// Within a tolerance, if parameters have some grain.
    pub(super) fn new(grain: f64, tol: f64) -> Self {
        Self { grain, tol }
    }
}

impl Tell for Levels {
    type Told = Level;

    #[inline(always)]
    fn tell<R: Registers>(
        &mut self,
        bounds: &Bounds<Lanes<R>>,
        number: usize,
        out: &mut Vec<Level>,
    ) {
        let [bisections, deviation] = fewest(bounds, &bounds.error, self.grain, self.tol);
        let [at_best, _] = fewest(bounds, &bounds.best, 0.0, self.tol);
        let mut all = [[0.0; Pack::LANES]; 4];
        bisections.store(&mut all[0]);
        deviation.store(&mut all[1]);
        at_best.store(&mut all[2]);
        bounds.best[0].store(&mut all[3]);
        for k in 0..number {
            out.push(Level {
                bisections: all[0][k] as u32,
                deviation: all[1][k],
                at_best: all[2][k] as u32,
                best_error: all[3][k],
            });
        }
    }
}

/// The fewest bisections with some errors, infinite where none are enough, and the bound after these.
#[inline(always)]
fn fewest<R: Registers>(
    bounds: &Bounds<Lanes<R>>,
    error: &[Lanes<R>; 2],
    grain: f64,
    tol: f64,
) -> [Lanes<R>; 2] {
    let r = error[0].0;
    // What is at most the limit is less than the next number.
    let most = Lanes::splat(r, tol.next_up());
    let near = Lanes::splat(r, (BETWEEN * tol).next_up());
    let one = Lanes::splat(r, 1.0f64.next_up());
    let never = Lanes::splat(r, f64::INFINITY);
    let enough = Lanes::splat(r, f64::from(DEEPEST + 1));
    let [mut level, mut deviation] = [never; 2];
    let mut here = linear(bounds, error, 0, grain, 4.0 * grain);
    for k in 0..=DEEPEST {
        let (q, odd) = (share(k) + grain, k as usize % 2);
        let away = 1.0 - share(k + 1) + 4.0 * grain;
        let next = linear(bounds, error, k + 1, grain, away);
        let all = linear(bounds, error, k + 2, grain, 1.0 + 4.0 * grain);
        let added = bounds.added[odd] * (q * q * q * q);
        let slip = bounds.slip[odd] * q * q;
        let bound = (here.max(next).max(all) + added) * ROUND_UP;
        let mut found = Lanes::splat(r, f64::from(k));
        found = most.where_greater(bound, [found, never]);
        found = near.where_greater(added, [found, never]);
        found = one.where_greater(slip, [found, never]);
        // NaN is none, also where the greatest has lost it.
        found = never.where_greater(here + next + all, [found, never]);
        deviation = level.where_greater(found, [bound, deviation]);
        level = level.where_greater(found, [found, level]);
        if enough.exceeds(level) {
            break;
        }
        here = next;
    }
    [level, deviation]
}

/// See `Bound::linear`.
#[inline(always)]
fn linear<R: Registers>(
    bounds: &Bounds<Lanes<R>>,
    error: &[Lanes<R>; 2],
    level: u32,
    grain: f64,
    away: f64,
) -> Lanes<R> {
    let (q, odd) = (share(level) + grain, level as usize % 2);
    let [u, v] = bounds.skew[odd];
    let skew = if odd == 0 {
        (u + v) * away
    } else {
        (u + v * away).max(u * away + v) * (1.0 + 4.0 * grain)
    };
    (error[odd] + skew + bounds.cubic * q) * (q * q)
}
