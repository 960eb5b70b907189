//! Several curves run through one after the other.

use super::error::positive;
use super::stretch::Stretch;
use super::{Curve, CurveError, CurveRef};
use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit};
use crate::exact::NurbsCurve;
use crate::interval::Interval;
use glam::DVec3;

/// How the parameters are shared among joined curves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Share {
    /// The same for each curve: corners of two joined curves with the same number of parts face each other.
    #[default]
    Equal,
    /// In proportion to the lengths of the curves (computed to some digits; the shares need no more).
    Length,
}

/// How curves are joined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JoinOptions {
    /// How the parameters are shared.
    pub share: Share,
    /// The greatest distance between the end of a curve and the start of the next. Where it is more than rounding,
    /// the curve jumps there (a break of smoothness -1). By default 10⁻⁹ of the size of all curves.
    pub tol: Option<f64>,
}

impl Default for JoinOptions {
    fn default() -> Self {
        Self {
            share: Share::Equal,
            tol: None,
        }
    }
}

/// The default distance allowed at a joint, relative to the size of the curves: data written with ten digits passes.
const DEFAULT_TOL: f64 = 1e-9;
/// More pieces come from joins of joins that double each time, and would take minutes and gigabytes.
const MOST_PIECES: usize = 1 << 16;
/// Relative difference of points that is rounding: such a joint counts as continuous.
const SAME_POINT: f64 = 1e-13;
/// Relative difference of derivatives that is rounding: such a joint counts as smooth.
const SAME_DERIVATIVE: f64 = 1e-11;
/// The number of derivatives compared at a joint.
const COMPARED: usize = 3;

/// Curves joined end to end, on `[0, 1]`, with a break at every joint. How smooth each joint is, is found by comparing
/// the derivatives there (to the third at most) with respect to the common parameter.
#[derive(Clone, Debug)]
pub struct Joined {
    parts: Vec<Stretch>,
    breaks: Vec<Break>,
    /// The number of the last piece of each part, plus one.
    ends: Vec<usize>,
}

impl Joined {
    /// Joins curves in their order.
    ///
    /// Errors: no curves; the tolerance is not positive; a curve does not start where the one before ends (with the
    /// distance, and whether it should be reversed).
    pub fn new(curves: Vec<CurveRef>, options: JoinOptions) -> Result<Self, CurveError> {
        if curves.is_empty() {
            return Err(CurveError::Nothing);
        }
        let pieces = curves.iter().map(|c| c.breaks().pieces()).sum();
        if pieces > MOST_PIECES {
            return Err(CurveError::TooManyPieces {
                pieces,
                most: MOST_PIECES,
            });
        }
        let size = curves
            .iter()
            .map(|c| c.bounds(c.domain()))
            .reduce(Box3::hull)
            .map_or(0.0, |b| b.diagonal());
        let tol = match options.tol {
            Some(t) => positive("the tolerance", t)?,
            None => DEFAULT_TOL * size,
        };
        for (first, pair) in curves.windows(2).enumerate() {
            let (end, [start, other]) = (pair[0].ends()[1], pair[1].ends());
            let distance = end.distance(start);
            if distance.is_nan() || distance > tol {
                return Err(CurveError::Gap {
                    first,
                    second: first + 1,
                    end,
                    start,
                    distance,
                    tol,
                    reversed: end.distance(other) <= tol,
                });
            }
        }
        let shares: Vec<f64> = match options.share {
            Share::Equal => vec![1.0; curves.len()],
            Share::Length => curves.iter().map(|c| length(c.as_ref())).collect(),
        };
        let sum: f64 = shares.iter().sum();
        let (mut at, mut part) = (0.0, Vec::with_capacity(curves.len()));
        for (i, s) in shares.iter().enumerate() {
            let end = if i + 1 == shares.len() {
                1.0
            } else {
                at + s / sum
            };
            if end.partial_cmp(&at) != Some(std::cmp::Ordering::Greater) {
                return Err(CurveError::NotPositive {
                    what: "the length of a curve to be joined",
                    value: *s,
                });
            }
            part.push(Interval { lo: at, hi: end });
            at = end;
        }
        let parts: Vec<Stretch> = curves
            .into_iter()
            .zip(part)
            .map(|(c, outer)| {
                let Interval { lo, hi } = c.domain();
                Stretch::new(c, [lo, hi], outer)
            })
            .collect();
        let (mut breaks, mut ends) = (vec![parts[0].breaks()[0]], Vec::new());
        for (i, p) in parts.iter().enumerate() {
            breaks.extend_from_slice(&p.breaks()[1..]);
            ends.push(breaks.len() - 1);
            if let (Some(next), Some(b)) = (parts.get(i + 1), breaks.last_mut()) {
                b.smooth = smoothness(p, next, b.at, size);
            }
        }
        Ok(Self {
            parts,
            breaks,
            ends,
        })
    }

    fn part(&self, t: f64, limit: Limit) -> &Stretch {
        let piece = self.breaks.find(t, limit);
        &self.parts[self.ends.partition_point(|&e| e <= piece)]
    }
}

/// How many derivatives agree where one stretch ends and the next begins, of curves of a size.
fn smoothness(a: &Stretch, b: &Stretch, at: f64, size: f64) -> i32 {
    let (mut l, mut r) = ([DVec3::ZERO; COMPARED + 1], [DVec3::ZERO; COMPARED + 1]);
    a.jet_into(at, Limit::Below, &mut l);
    b.jet_into(at, Limit::Above, &mut r);
    let same = (0..=COMPARED).take_while(|&k| {
        let scale = l[k].length().max(r[k].length());
        let allowed = if k == 0 {
            SAME_POINT * (size + scale)
        } else {
            SAME_DERIVATIVE * scale
        };
        l[k].distance(r[k]) <= allowed
    });
    same.count() as i32 - 1
}

/// The length of a curve by Gauss's rule of three points on sixteen parts of every piece.
fn length(c: &dyn Curve) -> f64 {
    const PARTS: usize = 16;
    let x = 0.6f64.sqrt();
    let rule = [(-x, 5.0 / 18.0), (0.0, 8.0 / 18.0), (x, 5.0 / 18.0)];
    let mut sum = 0.0;
    for w in c.breaks().windows(2) {
        let h = (w[1].at - w[0].at) / PARTS as f64;
        for i in 0..PARTS {
            for (x, weight) in rule {
                let t = w[0].at + h * (i as f64 + 0.5 + 0.5 * x);
                sum += h * weight * c.jet(t, Limit::Above, 1).d[1].length();
            }
        }
    }
    sum
}

impl Curve for Joined {
    fn breaks(&self) -> &[Break] {
        &self.breaks
    }

    fn jet_into(&self, t: f64, limit: Limit, out: &mut [DVec3]) {
        self.part(t, limit).jet_into(t, limit, out);
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, out: &mut [Box3]) {
        self.part(t.mid(), limit).enclose_piece(t, limit, out);
    }

    fn to_nurbs(&self) -> Option<NurbsCurve> {
        self.joined(Stretch::to_nurbs)
    }

    fn to_rational(&self) -> Option<NurbsCurve> {
        self.joined(Stretch::to_rational)
    }
}

impl Joined {
    /// The NURBS forms of the parts, joined; none if the curve jumps.
    fn joined(&self, form: impl Fn(&Stretch) -> Option<NurbsCurve>) -> Option<NurbsCurve> {
        if self.breaks[1..self.breaks.len() - 1]
            .iter()
            .any(|b| b.smooth < 0)
        {
            return None;
        }
        let parts: Option<Vec<_>> = self.parts.iter().map(form).collect();
        NurbsCurve::joined(&parts?).ok()
    }
}
