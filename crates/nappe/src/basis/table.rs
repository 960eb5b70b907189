//! Functions prepared for evaluation at many parameters.

use super::FunctionsRef;
use super::taylor::Taylor;
use crate::breaks::{Break, Breaks, Limit};
use crate::exact::PiecewiseRational;
use crate::interval::Interval;
use crate::series::binomial;
use crate::simd::{QUAD, Quads};
use smallvec::SmallVec;

/// A list of functions in a form that is quick to evaluate at many parameters: polynomials by powers of the distance
/// from the middle of each piece, other analytic functions by their Taylor polynomials where these are proven to be near
/// enough, everything else as it is.
///
/// Values agree with [`Functions::jet_into`](super::Functions::jet_into) within a few units in the last place of the functions' size; not to the
/// last bit.
#[derive(Clone, Debug)]
pub struct Table {
    parts: Vec<Part>,
    count: usize,
}

#[derive(Clone, Debug)]
enum Part {
    Powers(Powers),
    /// Good in the given domain; beyond it the functions are evaluated as they are.
    Taylor(Powers, Interval, FunctionsRef),
    Exact(FunctionsRef),
}

/// The highest order of derivative that a table gives.
pub(crate) const TABLE_ORDER: usize = 2;

impl Table {
    /// The highest degree that is taken by powers: the coefficients of Bernstein polynomials about the middle of their
    /// piece sum to at most 2^degree, and so many units in the last place can be lost.
    pub const MAX_DEGREE: usize = 5;

    /// The largest number of coefficients of a table that is made of all functions over all pieces.
    const LARGEST: usize = 1 << 20;

    /// The table of a list: its own, or one of Taylor polynomials, or one that evaluates the list as it is. An error of
    /// 1 in a function moves the surface by `effects` of the surface's size.
    pub(crate) fn new(functions: &FunctionsRef, effects: &[f64]) -> Self {
        let own = functions.table(effects);
        match own {
            // Taylor polynomials need no division.
            None => Self::taylor(functions, effects),
            Some(ref table) if table.is_quotient() => Self::taylor(functions, effects).or(own),
            own => own,
        }
        .unwrap_or_else(|| Self {
            parts: vec![Part::Exact(functions.clone())],
            count: functions.count(),
        })
    }

    /// The table of Taylor polynomials, if there is one that is near enough.
    pub(crate) fn taylor(functions: &FunctionsRef, effects: &[f64]) -> Option<Self> {
        let powers = Taylor::new(functions.as_ref(), effects)?.into_powers();
        let part = Part::Taylor(powers, functions.breaks().domain(), functions.clone());
        Some(Self {
            parts: vec![part],
            count: functions.count(),
        })
    }

    /// The tables of several lists, one after the other.
    pub(crate) fn stack(lists: &[FunctionsRef], effects: &[f64]) -> Self {
        let mut rest = effects;
        let table = |l: &FunctionsRef| {
            let (own, others) = rest.split_at(l.count());
            rest = others;
            Self::new(l, own).parts
        };
        Self {
            parts: lists.iter().flat_map(table).collect(),
            count: effects.len(),
        }
    }

    /// From all functions over all pieces.
    pub(crate) fn from_piecewise(p: &PiecewiseRational) -> Option<Self> {
        let (count, degree) = (p.count(), p.degree());
        let width = count + usize::from(p.is_rational());
        let pieces = p.breaks().pieces();
        if degree > Self::MAX_DEGREE || pieces * width * (degree + 1) > Self::LARGEST {
            return None;
        }
        let denominators: Vec<_> = (0..pieces).map(|k| p.denominator(k)).collect();
        let powers =
            Powers::of_bernstein(p.breaks(), degree, width, vec![0; pieces], |piece, f| {
                if f < count {
                    p.numerator(piece, f).to_vec()
                } else {
                    denominators[piece].clone()
                }
            });
        Some(Self::one(powers, count, p.is_rational()))
    }

    /// From the functions that are active in each piece, `first` being the index of the first of them, by their
    /// Bernstein coefficients.
    pub(crate) fn from_active(
        breaks: &[Break],
        degree: usize,
        first: Vec<usize>,
        count: usize,
        bernstein: impl Fn(usize, usize) -> Vec<f64>,
    ) -> Option<Self> {
        (degree <= Self::MAX_DEGREE).then(|| {
            let powers = Powers::of_bernstein(breaks, degree, degree + 1, first, bernstein);
            Self::one(powers, count, false)
        })
    }

    fn one(mut powers: Powers, count: usize, rational: bool) -> Self {
        powers.rational = rational;
        Self {
            parts: vec![Part::Powers(powers)],
            count,
        }
    }

    /// True if all functions have one denominator.
    fn is_quotient(&self) -> bool {
        matches!(&self.parts[..], [Part::Powers(p)] if p.rational)
    }

    /// The only part, if it is polynomial and without denominator, with the domain where it is good.
    pub(crate) fn powers(&self) -> Option<(&Powers, Interval)> {
        match &self.parts[..] {
            [Part::Powers(p)] if !p.rational => Some((p, Interval::ENTIRE)),
            [Part::Taylor(p, domain, _)] => Some((p, *domain)),
            _ => None,
        }
    }

    /// Writes derivatives 0 to `ROWS - 1` (at most 2) of the active functions at `t`, row-major by derivative, and
    /// returns the first of them and their number. `out` has room for all functions.
    #[inline(always)]
    pub(crate) fn eval<Q: Quads, const ROWS: usize>(
        &self,
        q: Q,
        t: f64,
        out: &mut [f64],
    ) -> (usize, usize) {
        if let Some((p, domain)) = self.powers()
            && domain.contains(t)
        {
            let (piece, s) = p.locate(t);
            p.rows::<Q, ROWS>(q, piece, s, p.width, out);
            return (p.first(piece), p.width);
        }
        let mut start = 0;
        for part in &self.parts {
            start += match part {
                Part::Powers(p) => p.write::<Q, ROWS>(q, t, start, self.count, out),
                Part::Taylor(p, domain, _) if domain.contains(t) => {
                    p.write::<Q, ROWS>(q, t, start, self.count, out)
                }
                Part::Taylor(_, _, f) | Part::Exact(f) => {
                    exact::<ROWS>(f, t, start, self.count, out)
                }
            };
        }
        (0, self.count)
    }
}

/// Writes all functions of a list, evaluated as they are, into the rows of a longer list; returns their number.
fn exact<const ROWS: usize>(
    f: &FunctionsRef,
    t: f64,
    start: usize,
    count: usize,
    out: &mut [f64],
) -> usize {
    let n = f.count();
    let active = f.active(t, Limit::Above);
    let mut rows: SmallVec<[f64; 32]> = SmallVec::from_elem(0.0, ROWS * active.len());
    f.jet_into(t, Limit::Above, ROWS - 1, &mut rows);
    for (k, row) in rows.chunks_exact(active.len()).enumerate() {
        let o = &mut out[k * count + start..][..n];
        o.fill(0.0);
        o[active.clone()].copy_from_slice(row);
    }
    n
}

#[derive(Clone, Copy, Debug)]
struct Piece {
    /// The end; NaN for the last piece, which has none: parameters beyond the domain belong to the end pieces.
    end: f64,
    middle: f64,
    /// `ds/dt`.
    scale: f64,
    /// The first active function.
    first: usize,
}

/// The integer from 0 to `last` that is nearest; 0 for what is no number.
#[inline(always)]
pub(super) fn nearest(x: f64, last: f64) -> usize {
    // 2⁵²: doubles from here on are integers, and so the sum has the nearest integer in its last bits.
    const INTEGERS: f64 = 4503599627370496.0;
    // These comparisons are single instructions; a conversion that saturates is ten.
    let x = if x > 0.0 { x } else { 0.0 };
    let x = if x < last { x } else { last };
    (x + INTEGERS).to_bits() as u32 as usize
}

/// Polynomials over pieces: `f_i(t) = Σ_k c_ki s^k` with `s` from -1 to 1 over the piece.
#[derive(Clone, Debug)]
pub(crate) struct Powers {
    pieces: Vec<Piece>,
    /// The piece to start looking from, for parts of the domain with middles at multiples of a step.
    buckets: Vec<u32>,
    /// The index of the last bucket.
    last: f64,
    lo: f64,
    per_bucket: f64,
    pub(crate) degree: usize,
    /// The number of active functions.
    pub(crate) width: usize,
    /// The number of all functions.
    total: usize,
    /// True if the last one divides the others.
    rational: bool,
    /// For each piece, for each [`QUAD`] functions (filled up), for each power one number a function.
    coefficients: Vec<f64>,
}

impl Powers {
    /// From the Bernstein coefficients of the active functions over each piece.
    fn of_bernstein(
        breaks: &[Break],
        degree: usize,
        width: usize,
        first: Vec<usize>,
        bernstein: impl Fn(usize, usize) -> Vec<f64>,
    ) -> Self {
        let to_powers = powers_of_bernstein(degree);
        let power = |b: &[f64], k: usize| b.iter().zip(&to_powers).map(|(b, m)| b * m[k]).sum();
        let powers = |piece, f| {
            let b = bernstein(piece, f);
            (0..=degree).map(|k| power(&b, k)).collect()
        };
        Self::new(breaks, degree, width, first, powers)
    }

    /// From the coefficients of the powers of s of the active functions over each piece, lowest first.
    pub(super) fn new(
        breaks: &[Break],
        degree: usize,
        width: usize,
        first: Vec<usize>,
        powers: impl Fn(usize, usize) -> Vec<f64>,
    ) -> Self {
        let (count, domain) = (breaks.pieces(), breaks.domain());
        let padded = width.next_multiple_of(QUAD);
        let mut coefficients = Vec::with_capacity(count * padded * (degree + 1));
        let mut pieces = Vec::with_capacity(count);
        for (piece, &first) in first.iter().enumerate() {
            let range = breaks.piece(piece);
            pieces.push(Piece {
                end: if piece + 1 < count {
                    range.hi
                } else {
                    f64::NAN
                },
                middle: range.mid(),
                scale: 2.0 / (range.hi - range.lo),
                first,
            });
            let all: Vec<_> = (0..width).map(|f| powers(piece, f)).collect();
            for four in all.chunks(QUAD) {
                for k in 0..=degree {
                    let mut row = [0.0; QUAD];
                    for (c, p) in row.iter_mut().zip(four) {
                        *c = p[k];
                    }
                    coefficients.extend(row);
                }
            }
        }
        // Twice as many buckets as pieces: with equal pieces a step or none leads from the bucket to the piece.
        let step = (domain.hi - domain.lo) / (2 * count) as f64;
        let buckets = (0..=2 * count).map(|i| {
            // A little before the bucket's start, since a parameter may be rounded into the bucket.
            let start = domain.lo + (i as f64 - 0.501) * step;
            breaks.find(start, Limit::Above) as u32
        });
        Self {
            pieces,
            buckets: buckets.collect(),
            last: (2 * count) as f64,
            lo: domain.lo,
            per_bucket: 1.0 / step,
            total: first.last().map_or(0, |f| f + width),
            degree,
            width,
            rational: false,
            coefficients,
        }
    }

    /// The number of pieces.
    pub(crate) fn pieces(&self) -> usize {
        self.pieces.len()
    }

    /// The coefficient of a power of s in an active function over a piece.
    pub(crate) fn coefficient(&self, piece: usize, function: usize, power: usize) -> f64 {
        let powers = self.degree + 1;
        let quads = piece * self.width.div_ceil(QUAD) + function / QUAD;
        self.coefficients[(quads * powers + power) * QUAD + function % QUAD]
    }

    /// `ds/dt` in a piece.
    #[inline(always)]
    pub(crate) fn scale(&self, piece: usize) -> f64 {
        self.pieces[piece].scale
    }

    /// The first active function of a piece.
    #[inline(always)]
    pub(crate) fn first(&self, piece: usize) -> usize {
        self.pieces[piece].first
    }

    /// The piece of a parameter and the parameter in it, from -1 to 1.
    #[inline(always)]
    pub(crate) fn locate(&self, t: f64) -> (usize, f64) {
        let bucket = nearest((t - self.lo) * self.per_bucket, self.last);
        let mut piece = self.buckets[bucket] as usize;
        // Without a branch, since nothing could predict it.
        piece += usize::from(self.pieces[piece].end <= t);
        if self.pieces[piece].end <= t {
            piece = self.pieces.partition_point(|p| p.end <= t);
        }
        let p = &self.pieces[piece];
        (piece, (t - p.middle) * p.scale)
    }

    /// The derivatives 0 to `ROWS - 1` of at most [`QUAD`] active functions.
    #[inline(always)]
    pub(crate) fn four<Q: Quads, const N: usize, const ROWS: usize>(
        &self,
        q: Q,
        piece: usize,
        s: f64,
    ) -> [[f64; QUAD]; ROWS] {
        const { assert!(N <= QUAD) };
        let c = &self.coefficients[piece * N * QUAD..][..N * QUAD];
        horner(q, c.as_chunks().0, s, self.pieces[piece].scale)
    }

    /// Writes derivatives 0 to `ROWS - 1`, each `stride` after the last.
    #[inline(always)]
    fn rows<Q: Quads, const ROWS: usize>(
        &self,
        q: Q,
        piece: usize,
        s: f64,
        stride: usize,
        out: &mut [f64],
    ) {
        let powers = self.degree + 1;
        let size = self.width.next_multiple_of(QUAD) * powers;
        let c = &self.coefficients[piece * size..][..size];
        // Four functions at a time; all their coefficients stand together.
        let fours = c.as_chunks().0.chunks_exact(powers);
        for (start, c) in (0..self.width).step_by(QUAD).zip(fours) {
            let d: [_; ROWS] = horner(q, c, s, self.pieces[piece].scale);
            for (k, d) in d.iter().enumerate() {
                let n = (self.width - start).min(QUAD);
                let o = &mut out[k * stride + start..][..n];
                for (o, d) in o.iter_mut().zip(d) {
                    *o = *d;
                }
            }
        }
    }

    /// Writes all functions into the rows of a longer list and returns their number.
    #[inline(always)]
    fn write<Q: Quads, const ROWS: usize>(
        &self,
        q: Q,
        t: f64,
        start: usize,
        count: usize,
        out: &mut [f64],
    ) -> usize {
        let (piece, s) = self.locate(t);
        if !self.rational {
            for k in 0..ROWS {
                if self.total > self.width {
                    out[k * count + start..][..self.total].fill(0.0);
                }
            }
            let at = start + self.first(piece);
            self.rows::<Q, ROWS>(q, piece, s, count, &mut out[at..]);
            return self.total;
        }
        let (w, n) = (self.width, self.width - 1);
        let mut buffer: SmallVec<[f64; 32]> = SmallVec::from_elem(0.0, ROWS * w);
        self.rows::<Q, ROWS>(q, piece, s, w, &mut buffer);
        for k in 0..ROWS {
            for i in 0..n {
                // The quotient rule; the denominator is the last of a row.
                let mut x = buffer[k * w + i];
                for l in 0..k {
                    let lower = out[l * count + start + i];
                    x -= binomial(k, l) * lower * buffer[(k - l) * w + n];
                }
                out[k * count + start + i] = x / buffer[n];
            }
        }
        n
    }
}

/// Derivatives 0 to `ROWS - 1` (at most 2) of four polynomials by Horner's scheme, from their coefficients of powers of
/// s, lowest first, and `ds/dt`.
#[inline(always)]
fn horner<Q: Quads, const ROWS: usize>(
    q: Q,
    coefficients: &[[f64; QUAD]],
    s: f64,
    scale: f64,
) -> [[f64; QUAD]; ROWS] {
    let (zero, s) = (q.splat(0.0), q.splat(s));
    let mut d = [zero; ROWS];
    for c in coefficients.iter().rev() {
        // Values, first derivatives, halves of second derivatives.
        for k in (1..ROWS).rev() {
            d[k] = q.add_product(d[k - 1], d[k], s);
        }
        d[0] = q.add_product(q.load(*c), d[0], s);
    }
    let mut out = [[0.0; QUAD]; ROWS];
    let mut factor = 1.0;
    for k in 0..ROWS {
        out[k] = q.store(q.add_product(zero, d[k], q.splat(factor)));
        factor *= scale * (k + 1) as f64;
    }
    out
}

/// The coefficients of s^k in every Bernstein polynomial of a degree over -1 … 1: exact.
fn powers_of_bernstein(degree: usize) -> Vec<Vec<f64>> {
    let product = |p: &[f64], [a, b]: [f64; 2]| -> Vec<f64> {
        let mut out = vec![0.0; p.len() + 1];
        for (k, p) in p.iter().enumerate() {
            out[k] += a * p;
            out[k + 1] += b * p;
        }
        out
    };
    (0..=degree)
        .map(|j| {
            let mut p = vec![binomial(degree, j)];
            for i in 0..degree {
                p = product(&p, if i < j { [0.5, 0.5] } else { [0.5, -0.5] });
            }
            p
        })
        .collect()
}
