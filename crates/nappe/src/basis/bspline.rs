//! B-spline basis functions; Bernstein polynomials are the case without inner knots.

use super::table::nearest;
use super::{Functions, Table, room};
use crate::breaks::{Break, Breaks, Limit};
use crate::exact::PiecewiseRational;
use crate::interval::Interval;
use crate::scalar::{Number, Pack};
use smallvec::SmallVec;
use std::ops::Range;
use thiserror::Error;

/// What can be wrong with a knot vector.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum KnotError {
    /// The degree is zero or beyond the limit.
    #[error("degree {degree} is not between 1 and {}", BSplineBasis::MAX_DEGREE)]
    Degree {
        /// The degree given.
        degree: usize,
    },
    /// The length does not fit.
    #[error("{points} points of degree {degree} need {} knots, {knots} are given", points.saturating_add(*degree).saturating_add(1))]
    Count {
        /// The number of control points.
        points: usize,
        /// The degree.
        degree: usize,
        /// The number of knots given.
        knots: usize,
    },
    /// Fewer points than the degree needs.
    #[error("degree {degree} needs at least {} points, {points} are given", degree.saturating_add(1))]
    TooFewPoints {
        /// The number of control points.
        points: usize,
        /// The degree.
        degree: usize,
    },
    /// A knot is NaN or infinite.
    #[error("knot {index} is {value}, knots must be finite numbers")]
    NotFinite {
        /// Which knot.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A knot is smaller than the one before.
    #[error(
        "knot {index} is {value}, smaller than the one before it ({before}): knots must not decrease"
    )]
    Unsorted {
        /// Which knot.
        index: usize,
        /// Its value.
        value: f64,
        /// The knot before it.
        before: f64,
    },
    /// An inner knot is repeated so often that the curve would fall apart, or an end knot more than degree + 1 times.
    #[error(
        "knot {value} is repeated {multiplicity} times, at most {most} are possible there for degree {degree}"
    )]
    Multiplicity {
        /// The index of its first occurrence.
        index: usize,
        /// The knot.
        value: f64,
        /// How often it occurs.
        multiplicity: usize,
        /// How often it may occur.
        most: usize,
        /// The degree.
        degree: usize,
    },
    /// The domain is empty.
    #[error("the knots leave no parameter range: knot {degree} and knot {points} are both {value}")]
    EmptyDomain {
        /// The degree, the index of the domain's lower end.
        degree: usize,
        /// The number of points, the index of the domain's upper end.
        points: usize,
        /// Both knots.
        value: f64,
    },
}

/// The B-spline basis of a degree over a knot vector. The functions are positive inside their support and sum to 1 on
/// the domain `[knots[degree], knots[count]]`; p+1 of them are active in each span. Cost: O(p²) a parameter.
/// Source: Piegl and Tiller, *The NURBS Book*, chapter 2.
#[derive(Clone, Debug, PartialEq)]
pub struct BSplineBasis {
    degree: usize,
    knots: Vec<f64>,
    breaks: Vec<Break>,
    /// For each piece the index of the knot at its start.
    spans: Vec<usize>,
    /// Pieces for each unit of the parameter.
    rate: f64,
}

impl BSplineBasis {
    /// The highest degree accepted.
    pub const MAX_DEGREE: usize = 64;

    /// A basis over a full knot vector (`count + degree + 1` knots).
    pub fn new(degree: usize, knots: Vec<f64>) -> Result<Self, KnotError> {
        if degree == 0 || degree > Self::MAX_DEGREE {
            return Err(KnotError::Degree { degree });
        }
        let points = knots.len().saturating_sub(degree + 1);
        if points < degree + 1 {
            return Err(KnotError::TooFewPoints { points, degree });
        }
        if let Some(index) = knots.iter().position(|k| !k.is_finite()) {
            return Err(KnotError::NotFinite {
                index,
                value: knots[index],
            });
        }
        if let Some(i) = (1..knots.len()).find(|&i| knots[i] < knots[i - 1]) {
            return Err(KnotError::Unsorted {
                index: i,
                value: knots[i],
                before: knots[i - 1],
            });
        }
        if knots[degree] >= knots[points] {
            return Err(KnotError::EmptyDomain {
                degree,
                points,
                value: knots[degree],
            });
        }
        let (mut breaks, mut spans) = (Vec::new(), Vec::new());
        let mut i = 0;
        while i < knots.len() {
            let last = i + knots[i..].partition_point(|&k| k == knots[i]) - 1;
            let multiplicity = last - i + 1;
            let inner = knots[i] > knots[degree] && knots[i] < knots[points];
            let most = if inner { degree } else { degree + 1 };
            if multiplicity > most {
                return Err(KnotError::Multiplicity {
                    index: i,
                    value: knots[i],
                    multiplicity,
                    most,
                    degree,
                });
            }
            if knots[i] >= knots[degree] && knots[i] <= knots[points] {
                breaks.push(Break::new(knots[i], degree as i32 - multiplicity as i32));
                if knots[i] < knots[points] {
                    spans.push(last);
                }
            }
            i = last + 1;
        }
        let rate = spans.len() as f64 / breaks.domain().width();
        Ok(Self {
            degree,
            knots,
            breaks,
            spans,
            rate,
        })
    }

    /// The Bernstein polynomials of a degree on `[0, 1]`. Panics for a degree of 0 or above [`Self::MAX_DEGREE`].
    pub fn bernstein(degree: usize) -> Self {
        assert!((1..=Self::MAX_DEGREE).contains(&degree), "degree {degree}");
        let mut knots = vec![0.0; degree + 1];
        knots.resize(2 * degree + 2, 1.0);
        let breaks = vec![Break::new(0.0, 0), Break::new(1.0, 0)];
        Self {
            degree,
            knots,
            breaks,
            spans: vec![degree],
            rate: 1.0,
        }
    }

    /// The clamped knot vector with equal spans on `[0, 1]` for a number of points: the default where a user gives
    /// none.
    pub fn clamped_uniform(degree: usize, points: usize) -> Vec<f64> {
        let spans = points.saturating_sub(degree).max(1);
        let inner = (1..spans).map(|i| i as f64 / spans as f64);
        let mut knots = vec![0.0; degree + 1];
        knots.extend(inner);
        knots.resize(knots.len() + degree + 1, 1.0);
        knots
    }

    /// The degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The full knot vector.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// True if both ends have full multiplicity, so that the first and last points are the ends.
    pub fn is_clamped(&self) -> bool {
        let (p, n) = (self.degree, self.count());
        self.knots[0] == self.knots[p] && self.knots[n] == self.knots[n + p]
    }

    /// The index of the knot at the start of the span that holds `t`.
    #[inline(always)]
    pub fn span(&self, t: f64, limit: Limit) -> usize {
        let breaks = &self.breaks;
        // With equal pieces the first guess is right.
        let last = (self.spans.len() - 1) as f64;
        let guess = nearest((t - breaks[0].at) * self.rate - 0.5, last);
        let (lo, hi) = (breaks[guess].at, breaks[guess + 1].at);
        let found = match limit {
            Limit::Above => lo <= t && t < hi,
            Limit::Below => lo < t && t <= hi,
        };
        self.spans[if found { guess } else { breaks.find(t, limit) }]
    }

    /// The knots near a span that [`Self::eval`] takes.
    fn near(&self, span: usize) -> &[f64] {
        &self.knots[span + 1 - self.degree..][..2 * self.degree]
    }

    /// Values and derivatives of the active functions in a span, for all kinds of numbers alike.
    ///
    /// `near` are the knots that the functions touch, but for the outermost two.
    #[inline(always)]
    fn eval<S: Number>(&self, near: &[S], t: S, order: usize, out: &mut [S]) {
        // With degree and order known the compiler takes all loops apart and keeps everything in registers.
        let (one, share) = (S::ONE, [S::ONE; 2]);
        let (three, six) = (
            (&mut [one; 3], &mut [share; 2]),
            (&mut [one; 6], &mut [share; 3]),
        );
        match [self.degree, order] {
            [2, 0] => eval(2, near, t, 0, three.0, three.1, out),
            [2, 1] => eval(2, near, t, 1, three.0, three.1, out),
            [2, 2] => eval(2, near, t, 2, three.0, three.1, out),
            [3, 0] => eval(3, near, t, 0, six.0, six.1, out),
            [3, 1] => eval(3, near, t, 1, six.0, six.1, out),
            [3, 2] => eval(3, near, t, 2, six.0, six.1, out),
            [p, _] => eval_any(p, near, t, order, out),
        }
    }

    /// The same at the parameters of a pack, each in its span.
    pub(crate) fn pack_in(
        &self,
        spans: [usize; Pack::LANES],
        t: Pack,
        order: usize,
        out: &mut [Pack],
    ) {
        let mut knots: SmallVec<[Pack; 6]> = SmallVec::from_elem(Pack::ZERO, 2 * self.degree);
        for (lane, span) in spans.into_iter().enumerate() {
            for (pack, &knot) in knots.iter_mut().zip(self.near(span)) {
                pack.0[lane] = knot;
            }
        }
        self.eval(&knots, t, order, out);
    }

    /// The polar form (blossom) of the spline with the given coefficients, in one span, at `degree` arguments.
    /// With all arguments equal to t it is the value at t.
    fn blossom(&self, span: usize, coefficients: &[f64], arguments: &[f64]) -> f64 {
        let p = self.degree;
        let mut d: SmallVec<[f64; 6]> = SmallVec::from_slice(coefficients);
        for (r, &x) in arguments.iter().enumerate() {
            for j in (r + 1..=p).rev() {
                let i = span + j - p;
                let (lo, hi) = (self.knots[i], self.knots[i + p - r]);
                let s = (x - lo) / (hi - lo);
                d[j] = (1.0 - s) * d[j - 1] + s * d[j];
            }
        }
        d[p]
    }
}

impl BSplineBasis {
    /// The Bernstein coefficients of an active function (from 0) on a piece.
    fn bernstein_of(&self, piece: usize, function: usize) -> SmallVec<[f64; 6]> {
        let (p, Interval { lo, hi }) = (self.degree, self.breaks.piece(piece));
        let mut unit: SmallVec<[f64; 6]> = SmallVec::from_elem(0.0, p + 1);
        unit[function] = 1.0;
        let coefficient = |j: usize| {
            let mut arguments: SmallVec<[f64; 6]> = SmallVec::from_elem(lo, p);
            arguments[p - j..].fill(hi);
            self.blossom(self.spans[piece], &unit, &arguments)
        };
        (0..=p).map(coefficient).collect()
    }
}

/// [`BSplineBasis::eval`] for degree p. There is room for `p (p+1)/2` numbers, which are 1, and for p shares.
#[inline(always)]
fn eval<S: Number>(
    p: usize,
    near: &[S],
    t: S,
    order: usize,
    rows: &mut [S],
    shares: &mut [[S; 2]],
    out: &mut [S],
) {
    // The r-th function of degree q is positive from knot p - 1 - q + r of those near to knot p + r.
    let near = &near[..2 * p];
    let support = |q: usize, r: usize| [near[p - 1 - q + r], near[p + r]];
    // N_{span-q} … N_span of degree q < p, one row after the other: row q starts at q (q+1)/2.
    let row = |q: usize| q * (q + 1) / 2;
    let (values, derivatives) = out.split_at_mut(p + 1);
    for q in 0..p {
        // Each function is divided between two of the next degree, each share by its own quotient: one less the other
        // would lose the digits of small shares, which large weights would show. The quotients come first, since none
        // waits for another and so two or more are one instruction.
        for (r, share) in shares[..=q].iter_mut().enumerate() {
            let [lo, hi] = support(q, r);
            let width = hi - lo;
            *share = [(hi - t) / width, (t - lo) / width];
        }
        let (below, above) = rows.split_at_mut(row(q + 1));
        let below = &below[row(q)..];
        let above = if q + 1 < p { above } else { &mut *values };
        let mut rising = S::ZERO;
        for r in 0..=q {
            above[r] = rising + shares[r][0] * below[r];
            rising = shares[r][1] * below[r];
        }
        above[q + 1] = rising;
    }
    for d in 1..=order {
        let o = &mut derivatives[(d - 1) * (p + 1)..][..p + 1];
        if d > p {
            o.fill(S::ZERO);
            continue;
        }
        // N'_{i,q} = q (N_{i,q-1}/(k_{i+q} - k_i) - N_{i+1,q-1}/(k_{i+q+1} - k_{i+1})), applied d times.
        for q in p - d..p {
            let factor = S::from((q + 1) as f64);
            let mut rising = S::ZERO;
            for r in 0..=q {
                let below = if q == p - d { rows[row(q) + r] } else { o[r] };
                let [lo, hi] = support(q, r);
                let slope = below * factor / (hi - lo);
                o[r] = rising - slope;
                rising = slope;
            }
            o[q + 1] = rising;
        }
    }
}

/// The same for any degree.
#[inline(never)]
fn eval_any<S: Number>(p: usize, near: &[S], t: S, order: usize, out: &mut [S]) {
    let (mut rows, mut more_rows) = ([S::ONE; 21], Vec::new());
    let (mut shares, mut more_shares) = ([[S::ONE; 2]; 6], Vec::new());
    let rows = room(&mut rows, &mut more_rows, p * (p + 1) / 2, S::ONE);
    let shares = room(&mut shares, &mut more_shares, p, [S::ONE; 2]);
    eval(p, near, t, order, rows, shares, out);
}

impl Functions for BSplineBasis {
    fn count(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    fn sums_to_one(&self) -> bool {
        true
    }

    fn breaks(&self) -> &[Break] {
        &self.breaks
    }

    fn active(&self, t: f64, limit: Limit) -> Range<usize> {
        let s = self.span(t, limit);
        s - self.degree..s + 1
    }

    fn jet_into(&self, t: f64, limit: Limit, order: usize, out: &mut [f64]) {
        self.eval(self.near(self.span(t, limit)), t, order, out);
    }

    fn pack_into(&self, t: Pack, limit: Limit, order: usize, out: &mut [Pack]) {
        self.pack_in(t.0.map(|t| self.span(t, limit)), t, order, out);
    }

    fn active_jet(&self, t: f64, limit: Limit, order: usize, out: &mut [f64]) -> Range<usize> {
        let span = self.span(t, limit);
        if let Some(out) = out.get_mut(..(order + 1) * (self.degree + 1)) {
            self.eval(self.near(span), t, order, out);
        }
        span - self.degree..span + 1
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, order: usize, out: &mut [Interval]) {
        let near = self.near(self.span(t.mid(), limit));
        let near: SmallVec<[Interval; 6]> = near.iter().map(|&k| Interval::point(k)).collect();
        self.eval(&near, t, order, out);
        // The values are between 0 and 1 wherever t stays inside its span.
        let piece = self.breaks.piece(self.breaks.find(t.mid(), limit));
        if piece.encloses(t) {
            for v in &mut out[..=self.degree] {
                *v = v.meet(Interval::UNIT);
            }
        }
    }

    fn to_piecewise(&self) -> Option<PiecewiseRational> {
        let (p, n) = (self.degree, self.count());
        let mut coefficients = vec![0.0; self.spans.len() * n * (p + 1)];
        for (piece, &span) in self.spans.iter().enumerate() {
            for f in 0..=p {
                let at = (piece * n + span - p + f) * (p + 1);
                coefficients[at..at + p + 1].copy_from_slice(&self.bernstein_of(piece, f));
            }
        }
        Some(PiecewiseRational::polynomial(
            self.breaks.clone(),
            p,
            n,
            coefficients,
        ))
    }

    fn table(&self, _effects: &[f64]) -> Option<Table> {
        let first = self.spans.iter().map(|s| s - self.degree).collect();
        let bernstein = |piece, f| self.bernstein_of(piece, f).to_vec();
        Table::from_active(&self.breaks, self.degree, first, self.count(), bernstein)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> BSplineBasis {
        BSplineBasis::new(
            3,
            vec![0.0, 0.0, 0.0, 0.0, 1.0, 2.5, 2.5, 4.0, 4.0, 4.0, 4.0],
        )
        .unwrap()
    }

    #[test]
    fn functions_sum_to_one_and_derivatives_to_zero() {
        let b = example();
        for i in 0..=80 {
            let t = 4.0 * i as f64 / 80.0;
            let mut out = [0.0; 20];
            b.jet_into(t, Limit::Above, 4, &mut out);
            for d in 0..=4 {
                let sum: f64 = out[d * 4..d * 4 + 4].iter().sum();
                assert!(
                    (sum - if d == 0 { 1.0 } else { 0.0 }).abs() < 1e-12,
                    "{t} {d} {sum}"
                );
            }
        }
    }

    #[test]
    fn bernstein_values_are_binomial() {
        let b = BSplineBasis::bernstein(4);
        let (t, mut out) = (0.3f64, [0.0; 5]);
        b.jet_into(t, Limit::Above, 0, &mut out);
        for (i, v) in out.iter().enumerate() {
            let want =
                crate::series::binomial(4, i) * t.powi(i as i32) * (1.0 - t).powi(4 - i as i32);
            assert!((v - want).abs() < 1e-15);
        }
    }

    #[test]
    fn the_piecewise_form_has_the_same_values() {
        let b = example();
        let pieces = b.to_piecewise().unwrap();
        for i in 0..=40 {
            let t = 4.0 * i as f64 / 40.0;
            let mut out = [0.0; 4];
            b.jet_into(t, Limit::Above, 0, &mut out);
            let all = pieces.value(t);
            for (f, v) in b.active(t, Limit::Above).zip(out) {
                assert!((all[f] - v).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn bad_knots_are_named() {
        let new = |d, k: &[f64]| BSplineBasis::new(d, k.to_vec()).unwrap_err();
        assert!(matches!(
            new(2, &[0.0, 0.0, 0.0, 1.0, 0.5, 1.0, 1.0]),
            KnotError::Unsorted { index: 4, .. }
        ));
        assert!(matches!(
            new(2, &[0.0, 0.0, 1.0, 1.0]),
            KnotError::TooFewPoints { points: 1, .. }
        ));
        assert!(matches!(
            new(2, &[0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 1.0, 1.0, 1.0]),
            KnotError::Multiplicity {
                index: 3,
                multiplicity: 3,
                most: 2,
                ..
            }
        ));
        assert!(matches!(
            new(1, &[0.0, f64::NAN, 1.0, 1.0]),
            KnotError::NotFinite { index: 1, .. }
        ));
        assert!(matches!(
            new(1, &[0.0, 1.0, 1.0, 2.0]),
            KnotError::EmptyDomain { .. }
        ));
        assert!(matches!(
            new(0, &[0.0, 1.0]),
            KnotError::Degree { degree: 0 }
        ));
    }
}
