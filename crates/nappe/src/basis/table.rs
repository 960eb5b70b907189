//! Functions prepared for evaluation at many parameters.

use super::FunctionsRef;
use crate::breaks::{Break, Breaks, Limit};
use crate::exact::PiecewiseRational;
use crate::series::binomial;

/// A list of functions in a form that is quick to evaluate at many parameters: polynomials by powers of the distance
/// from the middle of each piece, everything else as it is.
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

    /// The table of a list: its own, or one that evaluates the list as it is.
    pub(crate) fn new(functions: &FunctionsRef) -> Self {
        functions.table().unwrap_or_else(|| Self {
            parts: vec![Part::Exact(functions.clone())],
            count: functions.count(),
        })
    }

    /// The tables of several lists, one after the other.
    pub(crate) fn stack(lists: &[FunctionsRef]) -> Self {
        Self {
            parts: lists.iter().flat_map(|l| Self::new(l).parts).collect(),
            count: lists.iter().map(|l| l.count()).sum(),
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
        let powers = Powers::new(p.breaks(), degree, width, vec![0; pieces], |piece, f| {
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
            let powers = Powers::new(breaks, degree, degree + 1, first, bernstein);
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

    /// The polynomial part, if it is the only one and without denominator.
    pub(crate) fn powers(&self) -> Option<&Powers> {
        match &self.parts[..] {
            [Part::Powers(p)] if !p.rational => Some(p),
            _ => None,
        }
    }

    /// Writes derivatives 0 to `order` (at most 2) of the active functions at `t`, row-major by derivative, and
    /// returns the first of them and their number. `out` has room for all functions.
    #[inline(always)]
    pub(crate) fn eval(&self, t: f64, order: usize, out: &mut [f64]) -> (usize, usize) {
        match &self.parts[..] {
            [Part::Powers(p)] if !p.rational => {
                let (piece, s) = p.locate(t);
                p.row(piece, s, order, p.width, out);
                (p.first[piece], p.width)
            }
            parts => {
                let mut start = 0;
                for part in parts {
                    start += part.write(t, order, start, self.count, out);
                }
                (0, self.count)
            }
        }
    }
}

impl Part {
    /// Writes all functions of the part into the rows of a longer list, and returns their number.
    fn write(&self, t: f64, order: usize, start: usize, count: usize, out: &mut [f64]) -> usize {
        let mut buffer = [0.0; 64];
        match self {
            Part::Powers(p) if p.first.iter().all(|&f| f == 0) && 3 * p.width <= buffer.len() => {
                let (piece, s) = p.locate(t);
                p.row(piece, s, order, p.width, &mut buffer);
                let n = p.width - usize::from(p.rational);
                for k in 0..=order {
                    for i in 0..n {
                        let mut x = buffer[k * p.width + i];
                        if p.rational {
                            // The quotient rule; the denominator is the last of the row.
                            for l in 0..k {
                                let lower = out[l * count + start + i];
                                x -= binomial(k, l) * lower * buffer[(k - l) * p.width + n];
                            }
                            x /= buffer[n];
                        }
                        out[k * count + start + i] = x;
                    }
                }
                n
            }
            Part::Powers(p) => {
                let (piece, s) = p.locate(t);
                let mut row = vec![0.0; (order + 1) * p.width];
                p.row(piece, s, order, p.width, &mut row);
                for k in 0..=order {
                    let o = &mut out[k * count + start..][..p.total];
                    o.fill(0.0);
                    o[p.first[piece]..][..p.width].copy_from_slice(&row[k * p.width..][..p.width]);
                }
                p.total
            }
            Part::Exact(f) => {
                let n = f.count();
                let active = f.active(t, Limit::Above);
                let mut row: smallvec::SmallVec<[f64; 32]> =
                    smallvec::SmallVec::from_elem(0.0, (order + 1) * active.len());
                f.jet_into(t, Limit::Above, order, &mut row);
                for (k, row) in row.chunks_exact(active.len()).enumerate() {
                    let o = &mut out[k * count + start..][..n];
                    o.fill(0.0);
                    o[active.clone()].copy_from_slice(row);
                }
                n
            }
        }
    }
}

/// Polynomials over pieces: `f_i(t) = Σ_k c_ki s^k` with `s` from -1 to 1 over the piece.
#[derive(Clone, Debug)]
pub(crate) struct Powers {
    /// The ends of the pieces, without the first and the last.
    inner: Vec<f64>,
    /// The piece to start looking from, for equal parts of the domain.
    buckets: Vec<u32>,
    lo: f64,
    per_bucket: f64,
    /// The middle of each piece, and `ds/dt`.
    local: Vec<[f64; 2]>,
    /// The first active function of each piece.
    pub(crate) first: Vec<usize>,
    pub(crate) degree: usize,
    /// The number of active functions.
    pub(crate) width: usize,
    /// The number of all functions.
    total: usize,
    /// True if the last one divides the others.
    rational: bool,
    /// For each piece and each power one number a function.
    coefficients: Vec<f64>,
}

impl Powers {
    fn new(
        breaks: &[Break],
        degree: usize,
        width: usize,
        first: Vec<usize>,
        bernstein: impl Fn(usize, usize) -> Vec<f64>,
    ) -> Self {
        let pieces = breaks.pieces();
        let domain = breaks.domain();
        let to_powers = powers_of_bernstein(degree);
        let mut coefficients = Vec::with_capacity(pieces * width * (degree + 1));
        let mut local = Vec::with_capacity(pieces);
        for piece in 0..pieces {
            let range = breaks.piece(piece);
            local.push([range.mid(), 2.0 / (range.hi - range.lo)]);
            let all: Vec<_> = (0..width).map(|f| bernstein(piece, f)).collect();
            for k in 0..=degree {
                for b in &all {
                    coefficients.push(b.iter().zip(&to_powers).map(|(b, m)| b * m[k]).sum());
                }
            }
        }
        // Twice as many buckets as pieces: with equal pieces a step or none leads from the bucket to the piece.
        let count = 2 * pieces;
        let step = (domain.hi - domain.lo) / count as f64;
        let buckets = (0..count).map(|i| {
            // A little before the bucket's start, since a parameter may be rounded into the bucket.
            let start = domain.lo + (i as f64 - 1e-3) * step;
            breaks.find(start, Limit::Above) as u32
        });
        Self {
            inner: breaks[1..pieces].iter().map(|b| b.at).collect(),
            buckets: buckets.collect(),
            lo: domain.lo,
            per_bucket: 1.0 / step,
            local,
            total: first.last().map_or(0, |f| f + width),
            first,
            degree,
            width,
            rational: false,
            coefficients,
        }
    }

    /// The number of pieces.
    pub(crate) fn pieces(&self) -> usize {
        self.local.len()
    }

    /// The piece of a parameter and the parameter in it, from -1 to 1.
    #[inline(always)]
    pub(crate) fn locate(&self, t: f64) -> (usize, f64) {
        /// More pieces than this in a bucket are searched by halving.
        const FEW: usize = 4;
        // The conversion saturates, and takes NaN to 0.
        let bucket = ((t - self.lo) * self.per_bucket) as usize;
        let mut piece = self.buckets[bucket.min(self.buckets.len() - 1)] as usize;
        let mut steps = 0;
        while piece < self.inner.len() && self.inner[piece] <= t {
            piece += 1;
            steps += 1;
            if steps > FEW {
                piece = self.inner.partition_point(|&b| b <= t);
                break;
            }
        }
        let [middle, scale] = self.local[piece];
        (piece, (t - middle) * scale)
    }

    /// The derivatives 0 to `ROWS - 1` of `N` functions of degree `N - 1`.
    #[inline(always)]
    pub(crate) fn square<const N: usize, const ROWS: usize>(
        &self,
        piece: usize,
        s: f64,
    ) -> [[f64; N]; ROWS] {
        let mut d = [[0.0; N]; ROWS];
        let rows = &self.coefficients[piece * N * N..][..N * N];
        for k in (0..N).rev() {
            if let Some(c) = rows[k * N..].first_chunk() {
                step(&mut d, s, c);
            }
        }
        let scale = self.local[piece][1];
        for i in 0..N {
            if ROWS > 1 {
                d[1][i] *= scale;
            }
            if ROWS > 2 {
                d[2][i] *= 2.0 * scale * scale;
            }
        }
        d
    }

    /// Writes derivatives 0 to `order`, each `stride` after the last.
    #[inline(always)]
    fn row(&self, piece: usize, s: f64, order: usize, stride: usize, out: &mut [f64]) {
        let (w, scale) = (self.width, self.local[piece][1]);
        let c = &self.coefficients[piece * w * (self.degree + 1)..][..w * (self.degree + 1)];
        // Four functions at a time, so that they stay in registers.
        let mut start = 0;
        while start < w {
            let n = (w - start).min(4);
            let mut d = [[0.0; 4]; 3];
            for row in c.chunks_exact(w).rev() {
                let mut four = [0.0; 4];
                four[..n].copy_from_slice(&row[start..start + n]);
                step(&mut d, s, &four);
            }
            let mut factor = 1.0;
            for (k, d) in d.iter().enumerate().take(order + 1) {
                for i in 0..n {
                    out[k * stride + start + i] = d[i] * factor;
                }
                factor *= scale * (k + 1) as f64;
            }
            start += n;
        }
    }
}

/// One step of Horner's scheme for values, first derivatives and halves of second derivatives.
#[inline(always)]
fn step<const N: usize, const ROWS: usize>(d: &mut [[f64; N]; ROWS], s: f64, c: &[f64; N]) {
    for i in 0..N {
        if ROWS > 2 {
            d[2][i] = d[2][i] * s + d[1][i];
        }
        if ROWS > 1 {
            d[1][i] = d[1][i] * s + d[0][i];
        }
        d[0][i] = d[0][i] * s + c[i];
    }
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
