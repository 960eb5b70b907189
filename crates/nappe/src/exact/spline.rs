//! The algorithms on B-splines, written once for curves and for both directions of surfaces: a control point is a row
//! of homogeneous points, one long for a curve, one net line long for a surface.
//!
//! Insertion, splitting and elevation only average points, so they lose nothing beyond rounding.

use crate::basis::BSplineBasis;
use crate::breaks::{Break, Breaks, Limit};
use crate::interval::Interval;
use glam::{DVec4, Vec4Swizzles};

/// Knots nearer than this many units in the last place are one knot to [`compatible`](super::compatible): they come
/// from different roundings of one value. The curves move by as much as rounding their parameters moves them.
pub(crate) const SAME_KNOT: f64 = 4.0 * f64::EPSILON;

/// Some homogeneous points that are averaged together.
pub(crate) type Row = Vec<DVec4>;

/// `a` at `lo` and `b` at `hi`, interpolated linearly at `t`. Both factors are quotients of differences: where `t` is
/// near an end, `1 - s` would lose the digits of the smaller, which counts if its weight is large.
fn between(a: &Row, b: &Row, [lo, hi]: [f64; 2], t: f64) -> Row {
    average(a, b, [(hi - t) / (hi - lo), (t - lo) / (hi - lo)])
}

/// `(1 - s) a + s b`.
fn mix(a: &Row, b: &Row, s: f64) -> Row {
    average(a, b, [1.0 - s, s])
}

/// `l a + r b` for `l + r = 1`. Equal weights stay as they are: rounding would make a polynomial rational.
fn average(a: &Row, b: &Row, [l, r]: [f64; 2]) -> Row {
    let points = a.iter().zip(b);
    points
        .map(|(a, b)| {
            let w = if a.w == b.w { a.w } else { a.w * l + b.w * r };
            (a.xyz() * l + b.xyz() * r).extend(w)
        })
        .collect()
}

/// A B-spline with rows of points as control points.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spline {
    pub(crate) degree: usize,
    pub(crate) knots: Vec<f64>,
    pub(crate) rows: Vec<Row>,
}

impl Spline {
    pub(crate) fn new(basis: &BSplineBasis, rows: Vec<Row>) -> Self {
        Self {
            degree: basis.degree(),
            knots: basis.knots().to_vec(),
            rows,
        }
    }

    pub(crate) fn domain(&self) -> Interval {
        Interval {
            lo: self.knots[self.degree],
            hi: self.knots[self.rows.len()],
        }
    }

    pub(crate) fn multiplicity(&self, t: f64) -> usize {
        self.knots.iter().filter(|&&k| k == t).count()
    }

    /// Inserts one knot. `t` is in the domain and occurs fewer than `degree` times.
    /// Source: Boehm, *Inserting new knots into B-spline curves* (1980).
    fn insert(&mut self, t: f64) {
        let p = self.degree;
        let k = self.knots.partition_point(|&x| x <= t) - 1;
        let m = self.multiplicity(t);
        let new: Vec<Row> = (k + 1 - p..=k - m)
            .map(|i| {
                let ends = [self.knots[i], self.knots[i + p]];
                between(&self.rows[i - 1], &self.rows[i], ends, t)
            })
            .collect();
        self.rows.splice(k + 1 - p..k - m, new);
        self.knots.insert(k + 1, t);
    }

    /// Inserts a knot until it occurs at least `multiplicity` times (at most `degree`).
    pub(crate) fn raise(&mut self, t: f64, multiplicity: usize) {
        for _ in self.multiplicity(t)..multiplicity.min(self.degree) {
            self.insert(t);
        }
    }

    /// Drops what lies below `t`, so that the spline begins there, clamped.
    fn cut_below(&mut self, t: f64) {
        self.raise(t, self.degree);
        let first = self.knots.partition_point(|&x| x < t);
        if self.multiplicity(t) > self.degree {
            self.knots.drain(..first);
            self.rows.drain(..first);
        } else {
            self.knots.drain(..first);
            self.knots.insert(0, t);
            self.rows.drain(..first - 1);
        }
    }

    /// The spline run through backwards, with the parameter `-t`: exact.
    fn mirrored(mut self) -> Self {
        self.rows.reverse();
        self.knots.reverse();
        self.knots.iter_mut().for_each(|k| *k = -*k);
        self
    }

    /// The part over `[lo, hi]`, inside the domain, clamped.
    pub(crate) fn part(mut self, lo: f64, hi: f64) -> Self {
        self.cut_below(lo);
        let mut back = self.mirrored();
        back.cut_below(-hi);
        back.mirrored()
    }

    /// The same over the whole domain: both ends get full multiplicity.
    pub(crate) fn clamped(self) -> Self {
        let Interval { lo, hi } = self.domain();
        self.part(lo, hi)
    }

    /// The distinct knots of the domain with the continuity they leave.
    pub(crate) fn breaks(&self) -> Vec<Break> {
        let domain = self.domain();
        let mut breaks: Vec<Break> = Vec::new();
        for &k in self.knots.iter().filter(|&&k| domain.contains(k)) {
            match breaks.last_mut() {
                Some(b) if b.at == k => b.smooth -= 1,
                _ => breaks.push(Break::new(k, self.degree as i32 - 1)),
            }
        }
        breaks
    }

    /// The breaks, and the Bézier points of every piece between them.
    pub(crate) fn pieces(&self) -> (Vec<Break>, Vec<Vec<Row>>) {
        let breaks = self.breaks();
        let mut s = self.clone().clamped();
        for b in &breaks[1..breaks.len() - 1] {
            s.raise(b.at, self.degree);
        }
        let pieces = s.rows[..s.rows.len() - 1]
            .chunks(self.degree)
            .enumerate()
            .map(|(i, c)| {
                let mut piece = c.to_vec();
                piece.push(s.rows[(i + 1) * self.degree].clone());
                piece
            })
            .collect();
        (breaks, pieces)
    }

    /// The same map with a higher degree, clamped. Each knot gains as much multiplicity as the degree grows.
    pub(crate) fn elevated(self, degree: usize) -> Self {
        if degree <= self.degree {
            return self.clamped();
        }
        let (breaks, mut pieces) = self.pieces();
        for piece in &mut pieces {
            for p in self.degree..degree {
                *piece = elevate(piece, p);
            }
        }
        join(&breaks, degree, &pieces)
    }

    /// The spline with its domain mapped to `[lo, hi]`, backwards if `lo > hi`.
    pub(crate) fn on(self, lo: f64, hi: f64) -> Self {
        let d = self.domain();
        if d.lo == lo && d.hi == hi {
            return self;
        }
        let mut s = if lo < hi { self } else { self.mirrored() };
        let (d, to) = (s.domain(), Interval::new(lo, hi));
        let scale = (to.hi - to.lo) / (d.hi - d.lo);
        for k in &mut s.knots {
            // Measured from the nearer end: both ends are exact.
            *k = if *k - d.lo <= d.hi - *k {
                to.lo + (*k - d.lo) * scale
            } else {
                to.hi - (d.hi - *k) * scale
            };
        }
        s
    }

    /// Removes one occurrence of an inner knot if no homogeneous point moves by more than `tol`; `None` if it must
    /// stay. The spline then moves by at most `tol`. Source: Tiller, *Knot-removal algorithms for NURBS curves and
    /// surfaces* (1992).
    pub(crate) fn without(&self, t: f64, tol: f64) -> Option<Self> {
        let (without, moved) = self.removed(t)?;
        (moved <= tol).then_some(without)
    }

    /// As [`Self::without`], with how far homogeneous points move; not a number where nothing fits.
    pub(crate) fn removed(&self, t: f64) -> Option<(Self, f64)> {
        let (p, s) = (self.degree, self.multiplicity(t));
        let domain = self.domain();
        if s == 0 || t <= domain.lo || t >= domain.hi {
            return None;
        }
        let r = self.knots.partition_point(|&x| x <= t) - 1;
        let (first, last) = (r - p, r - s);
        let alpha = |i: usize| (t - self.knots[i]) / (self.knots[i + p + 1] - self.knots[i]);
        // The points of the shorter spline, solved for from the left and from the right until they meet.
        let (mut i, mut j) = (first, last);
        let mut left = vec![self.rows[first - 1].clone()];
        let mut right = vec![self.rows[last + 1].clone()];
        while j > i {
            let (a, b) = (alpha(i), alpha(j));
            let l = mix(&left[left.len() - 1], &self.rows[i], 1.0 / a);
            let n = mix(&right[right.len() - 1], &self.rows[j], 1.0 / (1.0 - b));
            left.push(l);
            right.push(n);
            i += 1;
            j -= 1;
        }
        let (l, n) = (&left[left.len() - 1], &right[right.len() - 1]);
        let moved = if j < i {
            distance(l, n)
        } else {
            distance(&self.rows[i], &mix(l, n, alpha(i)))
        };
        right.reverse();
        let mut new = left;
        if j < i {
            // Both sides have computed the same point: the better conditioned half of each is kept.
            new.pop();
        }
        new.extend(right);
        let mut rows = self.rows[..first - 1].to_vec();
        rows.extend(new);
        rows.extend_from_slice(&self.rows[last + 2..]);
        let mut knots = self.knots.clone();
        knots.remove(r);
        let without = Self {
            degree: p,
            knots,
            rows,
        };
        Some((without, moved))
    }

    /// The part of the spline that removing a knot depends on, with the same control points: what lies within `2 degree`
    /// knots.
    pub(crate) fn near(&self, t: f64) -> Self {
        let p = self.degree;
        let first = self
            .knots
            .partition_point(|&k| k < t)
            .saturating_sub(2 * p + 1);
        let last = (self.knots.partition_point(|&k| k <= t) + 2 * p + 1).min(self.knots.len());
        Self {
            degree: p,
            knots: self.knots[first..last].to_vec(),
            rows: self.rows[first..last - p - 1].to_vec(),
        }
    }
}

/// The largest distance of points of two rows.
fn distance(a: &Row, b: &Row) -> f64 {
    a.iter()
        .zip(b)
        .fold(0.0, |d, (a, b)| f64::max(d, a.distance(*b)))
}

/// A Bézier piece with its degree p raised by one.
pub(super) fn elevate(piece: &[Row], p: usize) -> Vec<Row> {
    let n = (p + 1) as f64;
    (0..=p + 1)
        .map(|i| match i {
            0 => piece[0].clone(),
            _ if i == p + 1 => piece[p].clone(),
            _ => mix(&piece[i], &piece[i - 1], i as f64 / n),
        })
        .collect()
}

/// Joins Bézier pieces of one degree into a clamped B-spline. A break that is smooth to order s becomes a knot of
/// multiplicity `degree - s`, or none.
pub(crate) fn join(breaks: &[Break], degree: usize, pieces: &[Vec<Row>]) -> Spline {
    let p = degree;
    let Interval { lo, hi } = breaks.domain();
    let mut knots = vec![lo; p + 1];
    for b in &breaks[1..breaks.len() - 1] {
        let multiplicity = (p as i32).saturating_sub(b.smooth).clamp(0, p as i32) as usize;
        knots.extend(std::iter::repeat_n(b.at, multiplicity));
    }
    knots.extend(std::iter::repeat_n(hi, p + 1));
    let rows = (0..knots.len() - p - 1)
        .map(|i| {
            let arguments = &knots[i + 1..=i + p];
            // Any piece in the support gives the point by its polar form. The one that has to be continued least
            // beyond its ends is taken: each argument outside multiplies rounding errors by |1 - s| + |s|.
            let growth = |k: &usize| -> f64 {
                let r = breaks.piece(*k);
                let outside = |x: f64| (r.lo - x).max(x - r.hi).max(0.0) / (r.hi - r.lo);
                arguments.iter().map(|&x| 1.0 + 2.0 * outside(x)).product()
            };
            let first = breaks.find(knots[i], Limit::Above);
            let last = breaks.find(knots[i + p + 1], Limit::Below);
            let piece = (first..=last)
                .min_by(|a, b| growth(a).total_cmp(&growth(b)))
                .unwrap_or(first);
            polar(&pieces[piece], breaks.piece(piece), arguments)
        })
        .collect();
    Spline {
        degree,
        knots,
        rows,
    }
}

/// The polar form of a Bézier piece.
fn polar(piece: &[Row], range: Interval, arguments: &[f64]) -> Row {
    // An argument at an end of the piece selects points without arithmetic: those at the ends come out exactly.
    let from = arguments.iter().filter(|&&x| x == range.lo).count();
    let to = arguments.iter().filter(|&&x| x == range.hi).count();
    let mut d = piece[to..piece.len() - from].to_vec();
    for &x in arguments
        .iter()
        .filter(|&&x| x != range.lo && x != range.hi)
    {
        for k in 0..d.len() - 1 {
            d[k] = between(&d[k], &d[k + 1], [range.lo, range.hi], x);
        }
        d.pop();
    }
    d.swap_remove(0)
}
