//! A stretch of a curve laid over a range of another parameter: what trimming, reversal and joining share.

use super::CurveRef;
use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit};
use crate::exact::NurbsCurve;
use crate::interval::Interval;
use glam::DVec3;

/// The curve from `inner[0]` to `inner[1]` (backwards if that is smaller) over the parameters from `outer.lo` to
/// `outer.hi`, mapped linearly.
///
/// A parameter between two own breaks is always evaluated in the piece of the curve that belongs there, whatever the
/// rounding of the map: so one-sided limits and enclosures are those of the right piece.
#[derive(Clone, Debug)]
pub(super) struct Stretch {
    curve: CurveRef,
    inner: [f64; 2],
    outer: Interval,
    /// The breaks, the ends of the stretch included.
    breaks: Vec<Break>,
    /// For each piece between two breaks the piece of the curve that lies there.
    pieces: Vec<Interval>,
}

impl Stretch {
    pub(super) fn new(curve: CurveRef, inner: [f64; 2], outer: Interval) -> Self {
        let [from, to] = inner;
        let (lo, hi) = (from.min(to), from.max(to));
        let between = |b: &&Break| lo < b.at && b.at < hi;
        let mut marks = vec![Break::new(lo, 0)];
        marks.extend(curve.breaks().iter().filter(between).copied());
        marks.push(Break::new(hi, 0));
        if from > to {
            marks.reverse();
        }
        let mut stretch = Self {
            curve,
            inner,
            outer,
            breaks: vec![Break::new(outer.lo, 0)],
            pieces: Vec::new(),
        };
        let mut start = outer.lo;
        for pair in marks.windows(2) {
            let end = if pair[1].at == to {
                outer.hi
            } else {
                let s = (pair[1].at - from) / (to - from);
                (outer.lo + s * (outer.hi - outer.lo)).min(outer.hi)
            };
            if end > start {
                stretch.breaks.push(Break::new(end, pair[1].smooth));
                stretch.pieces.push(Interval::new(pair[0].at, pair[1].at));
                start = end;
            } else if let Some(b) = stretch.breaks.last_mut() {
                // A piece too short for doubles on the new range: its breaks are one.
                b.smooth = b.smooth.min(pair[1].smooth);
            }
        }
        stretch
    }

    pub(super) fn breaks(&self) -> &[Break] {
        &self.breaks
    }

    /// The curve's parameter over the outer one.
    pub(super) fn ratio(&self) -> f64 {
        (self.inner[1] - self.inner[0]) / (self.outer.hi - self.outer.lo)
    }

    /// The curve's parameter and the limit that selects the right piece of it.
    pub(super) fn locate(&self, t: f64, limit: Limit) -> (f64, Limit) {
        let i = self.breaks.find(t, limit);
        let piece = self.pieces[i];
        let Interval { lo, hi } = self.outer;
        let x = if t - lo <= hi - t {
            self.inner[0] + (t - lo) * self.ratio()
        } else {
            self.inner[1] - (hi - t) * self.ratio()
        };
        let own = self.breaks.piece(i);
        let x = if own.contains(t) {
            x.clamp(piece.lo, piece.hi)
        } else {
            x
        };
        (x, nearer_end(piece, x))
    }

    pub(super) fn jet_into(&self, t: f64, limit: Limit, out: &mut [DVec3]) {
        let (x, limit) = self.locate(t, limit);
        self.curve.jet_into(x, limit, out);
        let (ratio, mut factor) = (self.ratio(), 1.0);
        for d in &mut out[1..] {
            factor *= ratio;
            *d *= factor;
        }
    }

    pub(super) fn enclosed_ratio(&self) -> Interval {
        let n = Interval::point;
        let [from, to] = self.inner.map(n);
        (to - from) / (n(self.outer.hi) - n(self.outer.lo))
    }

    /// An enclosure of the curve's parameters for `t`, which lies in one piece, and the limit that selects the right piece of
    /// the curve.
    pub(super) fn locate_piece(&self, t: Interval, limit: Limit) -> (Interval, Limit) {
        let i = self.breaks.find(t.mid(), limit);
        let piece = self.pieces[i];
        let n = Interval::point;
        let [from, to] = self.inner.map(n);
        let ratio = self.enclosed_ratio();
        let x = if t.mid() <= self.outer.mid() {
            from + (t - n(self.outer.lo)) * ratio
        } else {
            to - (n(self.outer.hi) - t) * ratio
        };
        let x = if self.breaks.piece(i).encloses(t) {
            // Beyond the piece there is only rounding of the map.
            Interval {
                lo: x.lo.clamp(piece.lo, piece.hi),
                hi: x.hi.clamp(piece.lo, piece.hi),
            }
        } else {
            x
        };
        (x, nearer_end(piece, x.mid()))
    }

    pub(super) fn enclose_piece(&self, t: Interval, limit: Limit, out: &mut [Box3]) {
        let (x, limit) = self.locate_piece(t, limit);
        self.curve.enclose_piece(x, limit, out);
        let ratio = self.enclosed_ratio();
        let mut factor = Interval::ONE;
        for d in &mut out[1..] {
            factor = factor * ratio;
            *d = d.scale(factor);
        }
    }

    pub(super) fn to_nurbs(&self) -> Option<NurbsCurve> {
        let [from, to] = self.inner;
        let part = self.curve.to_nurbs()?;
        self.laid(part.part(from.min(to), from.max(to)).ok()?)
    }

    /// Only of a whole curve: where a part of it would begin in the other parametrisation is not known.
    pub(super) fn to_rational(&self) -> Option<NurbsCurve> {
        let [from, to] = self.inner;
        if self.curve.domain() != Interval::new(from, to) {
            return self.to_nurbs();
        }
        self.laid(self.curve.to_rational()?)
    }

    /// The NURBS form of the part, turned and brought to the outer range.
    fn laid(&self, part: NurbsCurve) -> Option<NurbsCurve> {
        let part = if self.inner[0] > self.inner[1] {
            part.reversed().ok()?
        } else {
            part
        };
        part.on_domain(self.outer.lo, self.outer.hi).ok()
    }
}

/// The limit that keeps an evaluation at `x` inside a piece.
fn nearer_end(piece: Interval, x: f64) -> Limit {
    if x - piece.lo <= piece.hi - x {
        Limit::Above
    } else {
        Limit::Below
    }
}
