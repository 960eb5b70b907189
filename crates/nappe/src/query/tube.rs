//! A path near an arc of zeros, with a proven bound for the distance between the two.
//!
//! Let the arc be a graph `v = h(u)` and let `f_v` keep away from zero, `|f_v| ≥ m`, over a box that holds the arc and a
//! piece `(u(s), v(s))` of the path between the same parameters u. Then by the mean value theorem
//! `|v(s) - h(u(s))| ≤ |f(u(s), v(s))| / m`: the residual bounds the distance, both ways, along v. Of the residual
//! `g(s) = f(u(s), v(s))` the ends and an enclosure of `g''` are known: `|g| ≤ max(|g(0)|, |g(1)|) + max |g''| / 8`, and
//! likewise on each section of it. On a surface the bound is multiplied by `|r_v|`.

use super::cells::{Arc, Crossing};
use super::extended::{Extended, Slopes};
use super::path::{Cubic, Part, section, value};
use crate::interval::Interval;
use crate::surface::{Surface, enclose_direct};

/// Steps of a search for a zero. Newton's method needs some; halving alone, 60.
const STEPS: usize = 100;
/// The narrowest piece, relative to the rectangle: narrower, and rounding decides the residual.
const NARROWEST: f64 = 1e-12;
/// A quarter of a piece has at most half its error, where that is of the first order.
const STUCK: f64 = 0.9;
/// Pieces that are halved this many times over have found rounding, not shape.
const DEEPEST: usize = 48;

/// How often a cubic is halved before its residual is found too great: its bound is of the third order, the residual of
/// the fourth, so that few cubics with many bounds are better than many cubics.
const SECTIONS: usize = 3;

/// Parts shorter than this, relative to the rectangle, may be left out if they lead no farther than a share of the tolerance.
const SHORTEST: f64 = 1e-7;
const SHORT_SHARE: f64 = 1e-3;

/// A place of the arc.
#[derive(Clone, Copy, Debug)]
struct Knot {
    uv: [f64; 2],
    /// Where the zero is proven to be: one of the two is a point but for the place that stands in for a crossing.
    zero: [Interval; 2],
    /// The tangent in scaled parameters, a unit vector with f growing to the left; zero where there is none.
    tangent: [f64; 2],
    /// The greatest |f| there.
    residual: f64,
}

/// Makes the path of a branch.
pub(super) struct Tube<'a> {
    pub(super) f: Extended<'a>,
    pub(super) surface: Option<&'a dyn Surface>,
    pub(super) tol: f64,
    /// How many pieces may still be looked at.
    pub(super) budget: usize,
    /// What is done.
    pub(super) parts: Vec<Part>,
    /// The greatest error of all parts.
    error: f64,
    /// The widths of the whole rectangle: lengths are measured in them.
    pub(super) scale: [f64; 2],
    last: Option<Knot>,
    /// True if the last part ends with its tangent.
    smooth: bool,
    /// The place where the path begins, if the first part was too short.
    start: Option<[f64; 2]>,
    /// Whether parts may be left out, and how far those that were lead.
    pub(super) absorbs: bool,
    absorbed: f64,
}

impl<'a> Tube<'a> {
    pub(super) fn new(
        f: Extended<'a>,
        surface: Option<&'a dyn Surface>,
        tol: f64,
        budget: usize,
        scale: [f64; 2],
    ) -> Self {
        Self {
            f,
            surface,
            tol,
            budget,
            parts: Vec::new(),
            error: 0.0,
            scale,
            last: None,
            smooth: false,
            start: None,
            absorbs: true,
            absorbed: 0.0,
        }
    }

    /// Goes on through an arc, entered at the crossing with the given number.
    pub(super) fn through(&mut self, arc: &Arc, entry: usize) {
        let from = match self.last {
            Some(knot) => knot,
            None => self.crossing(arc, entry),
        };
        let to = self.crossing(arc, 1 - entry);
        self.between(arc, from, to, 0, [f64::INFINITY; 2]);
        self.last = Some(to);
    }

    /// True if an arc is entered at the crossing with the given number when f is positive to the left.
    pub(super) fn enters(&self, arc: &Arc, number: usize) -> bool {
        let [from, to] = [number, 1 - number].map(|c| self.crossing(arc, c));
        let d = arc.over;
        let middle = self.f.slopes(arc.uv).map_or(0.0, |s| s[2 - d].mid());
        // The tangent is (f_v, -f_u).
        let forward = if d == 0 { middle > 0.0 } else { middle < 0.0 };
        forward == (to.uv[d] >= from.uv[d])
    }

    /// Where it is.
    pub(super) fn place(&self) -> Option<[f64; 2]> {
        self.last.map(|knot| knot.uv)
    }

    /// Ends a loop where it began.
    pub(super) fn close(&mut self) {
        if let ([first, ..], true) = (&mut self.parts[..], self.smooth) {
            first.smooth = true;
        }
        let Some(first) = self.parts.first().map(|p| p.points[0]) else {
            return;
        };
        // The same zero, found twice: within rounding.
        if let Some(last) = self.parts.last_mut() {
            self.absorbed += displacement(self.surface, &last.points, last.points[3], first);
            end_at(last, first);
        }
    }

    /// The place where the arc crosses an edge.
    fn crossing(&self, arc: &Arc, number: usize) -> Knot {
        let Crossing { d, at, along, .. } = arc.crossings[number];
        let held = at.clamp(self.f.rect[d].lo, self.f.rect[d].hi);
        // Within the margin the place on the border is meant, if the arc reaches it.
        let zero = if held != at && arc.over == d {
            self.changes(d, held, along)
                .then(|| self.zero(d, held, along))
        } else {
            None
        };
        match zero {
            Some(zero) => self.knot(d, held, zero),
            None => self.knot(d, at, self.zero(d, at, along)),
        }
    }

    /// True if f has different signs at the ends of a segment on which the parameter d is constant.
    fn changes(&self, d: usize, at: f64, along: Interval) -> bool {
        let sign = |t: f64| self.f.sign(place(d, at, t));
        matches!((sign(along.lo), sign(along.hi)), (Some(a), Some(b)) if a != b)
    }

    /// A narrow range that holds the zero of f on a segment on which the parameter d is constant and f changes sign once.
    fn zero(&self, d: usize, at: f64, along: Interval) -> Interval {
        let mut t = along;
        let Some(first) = self.f.sign(place(d, at, t.lo)) else {
            return t;
        };
        for _ in 0..STEPS {
            let m = t.mid();
            if m <= t.lo || m >= t.hi {
                break;
            }
            let width = t.hi - t.lo;
            let value = self.f.slopes(place(d, at, m).map(Interval::point));
            let Some([value, ..]) = value else { break };
            let slope = self
                .f
                .slopes(place(d, Interval::point(at), t))
                .map_or(Interval::ENTIRE, |s| s[2 - d]);
            let newton = Interval::point(m) - value / slope;
            if !slope.contains(0.0)
                && let Some(narrow) = newton.intersection(t)
            {
                t = narrow;
            }
            if t.hi - t.lo > 0.5 * width {
                if value.contains(0.0) {
                    break;
                }
                if (value.lo > 0.0) == first {
                    t.lo = t.lo.max(m);
                } else {
                    t.hi = t.hi.min(m);
                }
            }
        }
        t
    }

    /// The knot at a zero on a line of constant parameter d.
    fn knot(&self, d: usize, at: f64, zero: Interval) -> Knot {
        let uv = self.f.clamp(place(d, at, zero.mid()));
        let s = self.f.slopes(uv.map(Interval::point));
        let s = s.unwrap_or([Interval::ENTIRE; 3]);
        let slope = [0, 1].map(|k| s[1 + k].mid() * self.scale[k]);
        let length = slope[0].hypot(slope[1]);
        let tangent = if length > 0.0 && length.is_finite() {
            [slope[1] / length, -slope[0] / length]
        } else {
            [0.0; 2]
        };
        Knot {
            uv,
            zero: place(d, Interval::point(at), zero),
            tangent,
            residual: s[0].mag(),
        }
    }

    /// The pieces between two places of an arc; `above` are the errors of the piece of which this is a half, and of that of
    /// which it is a quarter.
    fn between(&mut self, arc: &Arc, from: Knot, to: Knot, depth: usize, above: [f64; 2]) {
        let d = arc.over;
        // Those that are left out count too: where no error is known all of them are.
        self.budget = self.budget.saturating_sub(1);
        let cubic = self
            .cubic(&from, &to)
            .map(|c| (self.error_of(arc, &from, &to, &c.points), c));
        let (error, part) = match cubic {
            Some(c) if c.0 <= self.tol => c,
            _ => {
                let straight = self.straight(&from, &to);
                let chord = (self.error_of(arc, &from, &to, &straight.points), straight);
                cubic.filter(|c| c.0 <= chord.0).unwrap_or(chord)
            }
        };
        let width = (to.uv[d] - from.uv[d]).abs();
        // Rounding, if a quarter is as far off as the whole.
        let rounding = above[1].is_finite() && error > STUCK * above[1];
        let last = depth >= DEEPEST
            || rounding
            || width <= NARROWEST * self.f.rect[d].width()
            || self.budget == 0;
        if error <= self.tol || last {
            self.error = if error.is_nan() {
                f64::INFINITY
            } else {
                self.error.max(error)
            };
            self.push(part);
            return;
        }
        let middle = 0.5 * (from.uv[d] + to.uv[d]);
        if !self.changes(d, middle, arc.uv[1 - d]) {
            // Where rounding hides the sign.
            self.error = self.error.max(error);
            self.push(part);
            return;
        }
        let knot = self.knot(d, middle, self.zero(d, middle, arc.uv[1 - d]));
        for (from, to) in [(from, knot), (knot, to)] {
            self.between(arc, from, to, depth + 1, [error, above[0]]);
        }
    }

    fn push(&mut self, part: Part) {
        if part.length <= 0.0 || self.is_absorbed(&part) {
            return;
        }
        let curved = part.smooth;
        let mut points = part.points;
        if let Some(start) = self.start.take() {
            points[1] = moved(points[1], points[0], start);
            points[0] = start;
        }
        self.parts.push(Part {
            points,
            smooth: curved && self.smooth,
            ..part
        });
        self.smooth = curved;
    }

    /// A part that is too short to have a shape is left out: its neighbours meet at one of its ends. Where cells are cut
    /// just beside the curve there are such parts, and their higher derivatives would be rounding errors.
    fn is_absorbed(&mut self, part: &Part) -> bool {
        if !self.absorbs || part.length > SHORTEST {
            return false;
        }
        let stretch = self.stretch(part.points[0].map(Interval::point));
        let off = part.length * (self.scale[0] * stretch[0] + self.scale[1] * stretch[1]);
        if off.is_nan() || off > self.tol * SHORT_SHARE {
            return false;
        }
        match self.parts.last_mut() {
            Some(last) => end_at(last, part.points[3]),
            None => {
                self.start.get_or_insert(part.points[0]);
            }
        }
        self.absorbed += off;
        true
    }

    /// The bound for all parts.
    pub(super) fn bound(&self) -> f64 {
        self.error + self.absorbed
    }

    fn length(&self, from: &Knot, to: &Knot) -> f64 {
        let d = [0, 1].map(|k| (to.uv[k] - from.uv[k]) / self.scale[k]);
        d[0].hypot(d[1])
    }

    fn straight(&self, from: &Knot, to: &Knot) -> Part {
        let at = |s: f64| [0, 1].map(|k| from.uv[k] + s * (to.uv[k] - from.uv[k]));
        Part {
            points: [from.uv, at(1.0 / 3.0), at(2.0 / 3.0), to.uv],
            length: self.length(from, to),
            smooth: false,
        }
    }

    /// The cubic with the tangents of both ends, if it stays in the rectangle.
    fn cubic(&self, from: &Knot, to: &Knot) -> Option<Part> {
        let length = self.length(from, to);
        let step = |knot: &Knot, sign: f64| {
            [0, 1].map(|k| knot.uv[k] + sign * knot.tangent[k] * self.scale[k] * length / 3.0)
        };
        let inner = [step(from, 1.0), step(to, -1.0)];
        let inside = |p: &[f64; 2]| (0..2).all(|k| self.f.rect[k].contains(p[k]));
        let known = from.tangent != [0.0; 2] && to.tangent != [0.0; 2];
        (known && inner.iter().all(inside)).then_some(Part {
            points: [from.uv, inner[0], inner[1], to.uv],
            length,
            smooth: true,
        })
    }

    /// A bound for the distance between a piece of the path and of the arc; infinite where none is known.
    fn error_of(&self, arc: &Arc, from: &Knot, to: &Knot, b: &Cubic) -> f64 {
        self.try_error(arc, from, to, b).unwrap_or(f64::INFINITY)
    }

    fn try_error(&self, arc: &Arc, from: &Knot, to: &Knot, b: &Cubic) -> Option<f64> {
        let (d, o) = (arc.over, 1 - arc.over);
        let span = from.zero[d]
            .hull(to.zero[d])
            .hull(Interval::new(from.uv[d], to.uv[d]));
        // The path must not turn back: its Bézier points run one way.
        let forward = to.uv[d] >= from.uv[d];
        if b.windows(2)
            .any(|w| (w[1][d] - w[0][d] < 0.0) == forward && w[1][d] != w[0][d])
        {
            return None;
        }
        // The arc over the span: in its cell, and as steep as the slopes allow from both ends.
        let mut height = arc.uv[o];
        for _ in 0..2 {
            let s = self.f.slopes(place(d, span, height))?;
            let slope = -s[1 + d] / s[1 + o];
            for knot in [from, to] {
                let way = slope * (span - knot.zero[d]);
                if slope.is_finite()
                    && let Some(h) = height.intersection(knot.zero[o] + way)
                {
                    height = h;
                }
            }
        }
        let path = b.iter().fold(Interval::point(b[0][o]), |h, p| {
            h.hull(Interval::point(p[o]))
        });
        let all = place(d, span, height.hull(path));
        let all = [0, 1].map(|k| Interval {
            lo: all[k].lo.max(self.f.outer[k].lo),
            hi: all[k].hi.min(self.f.outer[k].hi),
        });
        let slopes = self.f.slopes(all)?;
        let steep = slopes[1 + o].mig();
        if steep.is_nan() || steep <= 0.0 {
            return None;
        }
        let stretch = self.stretch(all);
        let enough = self.tol * steep / stretch[o].max(f64::MIN_POSITIVE);
        let residual = self.residual(b, [from.residual, to.residual], &slopes, enough, SECTIONS)?;
        let off = residual / steep;
        // At the ends path and arc may begin a rounding apart.
        let late = [from, to].map(|k| (k.zero[d] - Interval::point(k.uv[d])).mag());
        let late = late[0].max(late[1]);
        let climb = (slopes[1 + d] / slopes[1 + o]).mag();
        let error = stretch[o] * off + late * (stretch[d] + stretch[o] * climb);
        (error * (1.0 + 1e-14))
            .is_finite()
            .then_some(error * (1.0 + 1e-14))
    }

    /// A bound for |f| on a cubic, given that at its ends and enclosures of the slopes around it. Where that is more than
    /// `enough` the cubic is halved some times.
    fn residual(
        &self,
        b: &Cubic,
        ends: [f64; 2],
        slopes: &Slopes,
        enough: f64,
        halvings: usize,
    ) -> Option<f64> {
        let path = [0, 1].map(|k| {
            let (lo, hi) = b
                .iter()
                .fold((b[0][k], b[0][k]), |(l, h), p| (l.min(p[k]), h.max(p[k])));
            let r = self.f.rect[k];
            Interval {
                lo: lo.clamp(r.lo, r.hi),
                hi: hi.clamp(r.lo, r.hi),
            }
        });
        let j = self.f.jet(path)?;
        let three = Interval::point(3.0);
        let difference =
            |i: usize, k: usize| Interval::point(b[i + 1][k]) - Interval::point(b[i][k]);
        let first = [0, 1].map(|k| {
            let [x, y, z] = [0, 1, 2].map(|i| three * difference(i, k));
            x.hull(y).hull(z)
        });
        let second = [0, 1].map(|k| {
            let at = |i: usize| Interval::point(6.0) * (difference(i + 1, k) - difference(i, k));
            at(0).hull(at(1))
        });
        let (fu, fv) = (slopes[1].meet(j[1]), slopes[2].meet(j[2]));
        let bend = j[3] * first[0].sqr()
            + Interval::point(2.0) * j[4] * first[0] * first[1]
            + j[5] * first[1].sqr()
            + fu * second[0]
            + fv * second[1];
        let way = fu * first[0] + fv * first[1];
        let known = ends[0].max(ends[1]);
        let bound = known + (bend.mag() / 8.0).min(way.mag() / 2.0);
        if bound <= enough || halvings == 0 || known > 0.5 * enough {
            return Some(bound);
        }
        let middle = self
            .f
            .jet(self.f.clamp(value(b, 0.5)).map(Interval::point))?[0]
            .mag();
        if middle > 0.5 * enough {
            return Some(bound);
        }
        let half = |from: f64, to: f64, ends: [f64; 2]| {
            self.residual(&section(b, from, to), ends, slopes, enough, halvings - 1)
        };
        let first = half(0.0, 0.5, [ends[0], middle])?;
        let second = if first <= enough {
            half(0.5, 1.0, [middle, ends[1]])?
        } else {
            first
        };
        Some(if first <= enough {
            first.max(second)
        } else {
            bound
        })
    }

    /// How far a step of the parameters goes at most.
    fn stretch(&self, uv: [Interval; 2]) -> [f64; 2] {
        stretch(self.surface, uv)
    }
}

/// How far a step of the parameters goes at most on a surface, or in the plane.
fn stretch(surface: Option<&dyn Surface>, uv: [Interval; 2]) -> [f64; 2] {
    let Some(surface) = surface else {
        return [1.0; 2];
    };
    let domain = surface.domain();
    let uv = [0, 1].map(|k| Interval {
        lo: uv[k].lo.clamp(domain[k].lo, domain[k].hi),
        hi: uv[k].hi.clamp(domain[k].lo, domain[k].hi),
    });
    let jet = enclose_direct(surface, uv, 1);
    [jet[1].norm().hi, jet[2].norm().hi]
}

/// How far a cubic moves at most when one end of it, and its tangent perhaps, is moved.
pub(super) fn displacement(
    surface: Option<&dyn Surface>,
    b: &Cubic,
    from: [f64; 2],
    to: [f64; 2],
) -> f64 {
    if from == to {
        return 0.0;
    }
    let around = [0, 1].map(|k| {
        let way = Interval::point(to[k]) - Interval::point(from[k]);
        let hull = b
            .iter()
            .fold(Interval::point(to[k]), |h, p| h.hull(Interval::point(p[k])));
        // The tangent is moved as the end is.
        hull.hull(hull + way)
    });
    let stretch = stretch(surface, around);
    (0..2).map(|k| (to[k] - from[k]).abs() * stretch[k]).sum()
}

/// Moves the end of a part, with its tangent.
fn end_at(part: &mut Part, to: [f64; 2]) {
    part.points[2] = moved(part.points[2], part.points[3], to);
    part.points[3] = to;
}

/// A point moved as another one is.
fn moved(p: [f64; 2], from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|d| p[d] + (to[d] - from[d]))
}

/// The pair with `at` in the place of parameter d.
fn place<T>(d: usize, at: T, other: T) -> [T; 2] {
    if d == 0 { [at, other] } else { [other, at] }
}
