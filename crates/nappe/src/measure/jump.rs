//! The greatest value of a quantity over a parameter range, by subdivision: a proven bound and a witness.

use crate::interval::Interval;
use crate::mesh::Certainty;
use glam::DVec3;

/// How much work a measurement may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JumpOptions {
    /// The most parts that a range (an edge, a domain) is divided into for one quantity. More parts give closer bounds.
    pub parts: usize,
    /// The proven bound need not be closer to the witness than this fraction of it.
    pub closeness: f64,
}

impl Default for JumpOptions {
    /// 512 parts, bounds 1 % above what was found.
    fn default() -> Self {
        Self {
            parts: 512,
            closeness: 0.01,
        }
    }
}

/// The greatest value of a quantity that is not negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// The greatest value anywhere is at most this (bounded), or sampling found no larger one (estimated).
    pub greatest: Certainty,
    /// The greatest value found at a sample: the true maximum is at least this, up to rounding.
    pub found: f64,
    /// Where it was found: the parameter along the first side.
    pub at: f64,
    /// The point there.
    pub point: DVec3,
}

impl Jump {
    /// Whether the quantity is proven to stay within `tol` (`true`), found to exceed it (`false`), or neither.
    pub fn within(&self, tol: f64) -> Option<bool> {
        match self.greatest {
            Certainty::Exact => Some(true),
            Certainty::Bounded(e) if e <= tol => Some(true),
            _ if self.found > tol => Some(false),
            _ => None,
        }
    }
}

/// What is known about a part of the range.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// An upper bound over the part; infinite if nothing could be proven.
    pub(super) upper: f64,
    /// The value at a sample inside; NaN if it says nothing, as an angle where there is no normal.
    pub(super) found: f64,
    /// The sample.
    pub(super) at: f64,
}

/// An estimate holds for a range of which samples say nothing about more than this share: beside a pole.
const BLIND: f64 = 1e-3;

/// The maximum over some parts. The one with the greatest bound is halved until the bound is close to the greatest
/// sample, or below `enough`, or the parts are used up. Where neither a bound nor samples
/// say anything, the estimate is infinite.
pub(super) fn greatest(
    start: &[Interval],
    mut eval: impl FnMut(Interval) -> Part,
    enough: f64,
    options: &JumpOptions,
) -> (Certainty, Part) {
    let mut parts: Vec<(Interval, Part)> = start.iter().map(|&t| (t, eval(t))).collect();
    let mut best = Part {
        upper: f64::INFINITY,
        found: 0.0,
        at: start.first().map_or(0.0, |t| t.lo),
    };
    let note = |p: &Part, best: &mut Part| {
        if p.found > best.found {
            *best = *p;
        }
    };
    for (_, p) in &parts {
        note(p, &mut best);
    }
    loop {
        let widest = (0..parts.len()).fold(0, |b, i| {
            // A NaN bound says as little as an infinite one.
            if parts[i].1.upper <= parts[b].1.upper {
                b
            } else {
                i
            }
        });
        let Some(&(t, worst)) = parts.get(widest) else {
            return (Certainty::Exact, best);
        };
        let near = best.found * (1.0 + options.closeness);
        let done = worst.upper <= near.max(enough);
        let m = t.mid();
        if done || parts.len() >= options.parts || m <= t.lo || m >= t.hi {
            let certainty = if worst.upper.is_finite() {
                Certainty::Bounded(worst.upper.max(best.found))
            } else {
                let width = |parts: &mut dyn Iterator<Item = &(Interval, Part)>| -> f64 {
                    parts.map(|(t, _)| t.width()).sum()
                };
                let is_blind = |p: &&(Interval, Part)| !p.1.upper.is_finite() && p.1.found.is_nan();
                let blind = width(&mut parts.iter().filter(is_blind));
                let estimated = blind <= BLIND * width(&mut parts.iter());
                Certainty::Estimated(if estimated { best.found } else { f64::INFINITY })
            };
            return (certainty, best);
        }
        let halves = [Interval { hi: m, ..t }, Interval { lo: m, ..t }].map(|h| (h, eval(h)));
        for h in &halves {
            note(&h.1, &mut best);
        }
        parts[widest] = halves[0];
        parts.push(halves[1]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_closes_in_on_the_maximum() {
        // t (1 - t) has its maximum 1/4 at 1/2.
        let eval = |t: Interval| {
            let m = t.mid();
            Part {
                upper: (t * (Interval::ONE - t)).hi,
                found: m * (1.0 - m),
                at: m,
            }
        };
        let (c, best) = greatest(&[Interval::UNIT], eval, 0.0, &JumpOptions::default());
        assert!(
            matches!(c, Certainty::Bounded(b) if (0.25..0.2526).contains(&b)),
            "{c:?}"
        );
        assert!((best.at - 0.5).abs() < 1e-2);
        let nothing = |_| Part {
            upper: f64::NAN,
            found: 2.0,
            at: 0.5,
        };
        let (c, _) = greatest(&[Interval::UNIT], nothing, 0.0, &JumpOptions::default());
        assert_eq!(c, Certainty::Estimated(2.0));
        let blind = |_| Part {
            upper: f64::INFINITY,
            found: f64::NAN,
            at: 0.5,
        };
        let (c, _) = greatest(&[Interval::UNIT], blind, 0.0, &JumpOptions::default());
        assert_eq!(c, Certainty::Estimated(f64::INFINITY));
    }
}
