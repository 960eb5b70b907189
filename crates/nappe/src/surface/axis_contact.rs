//! Where a profile meets the axis of revolution: in poles, or across it.

use crate::box3::Box3;
use crate::breaks::Breaks;
use crate::curve::Curve;
use crate::frame::Frame;
use crate::interval::Interval;
use glam::{DVec2, DVec3, Vec3Swizzles};

/// Relative to the profile's size: what is nearer to the axis lies on it. Larger would close real holes, smaller would
/// keep needle holes that are only rounding.
const ON_AXIS: f64 = 1e-12;
/// Rounding of coordinates far from the origin, in units in the last place of the largest coordinate.
const FAR_ULPS: f64 = 8.0;
/// A stretch that is nowhere farther than this many tolerances is on the axis. With 1, the places where the profile is
/// as far as the tolerance could not be decided in rounding, and a profile that touches has many of them.
const SLACK: f64 = 4.0;
/// Halvings of the parameter range after which a place that cannot be told from a contact is one.
const DEPTH: u32 = 48;
/// More undecided intervals of one length are not halved further: a profile with a few contacts has some tens.
const UNDECIDED: usize = 4096;
/// The longest contact, relative to the parameter range, that counts as a point. A curve that touches the axis with
/// five equal derivatives stays within the distance above for this long.
const LONGEST_TOUCH: f64 = 1e-2;
/// Samples for the figure in a message.
const SAMPLES: usize = 256;

/// How a profile meets the axis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Contact {
    /// Not at all, or only in poles: at the first or last parameter, or touching in between.
    Poles { ends: [bool; 2], inner: Vec<f64> },
    /// From one side to the other at a parameter; the shorter part reaches so far from the axis.
    Crosses { at: f64, point: DVec3, reach: f64 },
    /// Along the axis over a range of parameters.
    Along { from: f64, to: f64 },
}

/// Finds every contact by excluding the rest of the parameter range with enclosures.
pub(crate) fn find(curve: &dyn Curve, axis: &Frame) -> Contact {
    let domain = curve.domain();
    let tolerance = tolerance(curve, axis);
    let touches: Vec<Interval> = clusters(curve, axis, tolerance);
    let at = |t: f64| axis.coordinates(curve.point(t));
    let breaks = curve.breaks();
    let (mut ends, mut inner) = ([false; 2], Vec::new());
    for (k, &t) in touches.iter().enumerate() {
        let whole_piece = (0..breaks.pieces()).any(|i| t.encloses(breaks.piece(i)));
        if whole_piece || t.hi - t.lo > LONGEST_TOUCH * (domain.hi - domain.lo) {
            return Contact::Along {
                from: t.lo,
                to: t.hi,
            };
        }
        if t.lo <= domain.lo {
            ends[0] = true;
        } else if t.hi >= domain.hi {
            ends[1] = true;
        } else if at(t.lo).xy().dot(at(t.hi).xy()) < 0.0 {
            let reach = |part: Interval| {
                (0..=SAMPLES)
                    .map(|i| part.lo + (part.hi - part.lo) * i as f64 / SAMPLES as f64)
                    .map(|t| at(t).xy().length())
                    .fold(0.0, f64::max)
            };
            let middle = halved(t, |m| at(m).xy().dot(at(t.lo).xy()) > 0.0);
            // To the next contact, or to the end.
            let before = k.checked_sub(1).map_or(domain.lo, |k| touches[k].hi);
            let after = touches.get(k + 1).map_or(domain.hi, |t| t.lo);
            return Contact::Crosses {
                at: middle,
                point: axis.point(DVec3::Z * at(middle).z),
                reach: reach(Interval::new(before, t.lo)).min(reach(Interval::new(t.hi, after))),
            };
        } else {
            let corner = breaks.iter().map(|b| b.at).find(|&at| t.contains(at));
            inner.push(corner.unwrap_or(t.mid()));
        }
    }
    Contact::Poles { ends, inner }
}

/// Where a condition that holds at the start of an interval ends to hold, by halving.
fn halved(t: Interval, holds: impl Fn(f64) -> bool) -> f64 {
    let mut t = t;
    loop {
        let m = t.mid();
        if m <= t.lo || m >= t.hi {
            return m;
        }
        if holds(m) {
            t.lo = m;
        } else {
            t.hi = m;
        }
    }
}

/// The distance from the axis below which a point is on it.
fn tolerance(curve: &dyn Curve, axis: &Frame) -> f64 {
    let bounds = curve.bounds(curve.domain());
    let b = axis.enclose_coordinates(bounds);
    let size = b.x.mag().max(b.y.mag()).max(b.z.width());
    let far = magnitude(bounds).max(magnitude(Box3::point(axis.origin())));
    let tol = ON_AXIS * size + FAR_ULPS * f64::EPSILON * far;
    if tol.is_finite() { tol } else { 0.0 }
}

fn magnitude(b: Box3) -> f64 {
    b.x.mag().max(b.y.mag()).max(b.z.mag())
}

/// The maximal parameter ranges that may be within the tolerance of the axis, in order: halved all together, so that
/// where the halving ends early all that is left is short.
fn clusters(curve: &dyn Curve, axis: &Frame, tolerance: f64) -> Vec<Interval> {
    let mut found: Vec<Interval> = Vec::new();
    let mut open = vec![curve.domain()];
    for _ in 0..DEPTH {
        if open.len() > UNDECIDED {
            break;
        }
        for t in std::mem::take(&mut open) {
            let b = axis.enclose_coordinates(curve.bounds(t));
            let nearest = DVec2::new(b.x.mig(), b.y.mig()).length();
            let farthest = DVec2::new(b.x.mag(), b.y.mag()).length();
            let m = t.mid();
            if nearest > tolerance {
                continue;
            }
            if farthest <= SLACK * tolerance || m <= t.lo || m >= t.hi {
                found.push(t);
            } else {
                open.extend([Interval::new(t.lo, m), Interval::new(m, t.hi)]);
            }
        }
    }
    found.extend(open);
    found.sort_by(|a, b| a.lo.total_cmp(&b.lo));
    let mut joined: Vec<Interval> = Vec::with_capacity(found.len());
    for t in found {
        match joined.last_mut() {
            Some(last) if last.hi >= t.lo => last.hi = t.hi,
            _ => joined.push(t),
        }
    }
    joined
}
