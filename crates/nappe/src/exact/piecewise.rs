//! Piecewise rational functions in Bernstein form: what every exact conversion goes through.

use crate::breaks::{Break, Breaks, Limit, merge_breaks};
use crate::interval::Interval;
use crate::series::binomial;

/// A list of functions `n_i(t)/d(t)` over common breaks, all pieces in Bernstein form with one common denominator.
///
/// `breaks[k].smooth` is the continuity of numerators and denominator (of the homogeneous form).
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewiseRational {
    breaks: Vec<Break>,
    degree: usize,
    count: usize,
    /// `[piece][function][coefficient]`.
    num: Vec<f64>,
    /// `[piece][coefficient]`, of the same degree; `None` for the constant 1.
    den: Option<Vec<f64>>,
}

impl PiecewiseRational {
    /// Polynomials: `coefficients[(piece * count + function) * (degree + 1) + k]`.
    pub fn polynomial(
        breaks: Vec<Break>,
        degree: usize,
        count: usize,
        coefficients: Vec<f64>,
    ) -> Self {
        assert_eq!(
            coefficients.len(),
            (breaks.len() - 1) * count * (degree + 1)
        );
        Self {
            breaks,
            degree,
            count,
            num: coefficients,
            den: None,
        }
    }

    /// Rational functions; the denominator has the same degree, `(degree + 1)` coefficients a piece.
    pub fn rational(
        breaks: Vec<Break>,
        degree: usize,
        count: usize,
        num: Vec<f64>,
        den: Vec<f64>,
    ) -> Self {
        assert_eq!(den.len(), (breaks.len() - 1) * (degree + 1));
        Self {
            den: Some(den),
            ..Self::polynomial(breaks, degree, count, num)
        }
    }

    /// The breaks, with the continuity of the homogeneous form.
    pub fn breaks(&self) -> &[Break] {
        &self.breaks
    }

    /// The degree of all numerators and of the denominator.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The number of functions.
    pub fn count(&self) -> usize {
        self.count
    }

    /// True if there is a denominator.
    pub fn is_rational(&self) -> bool {
        self.den.is_some()
    }

    /// The Bernstein coefficients of a numerator on a piece.
    pub fn numerator(&self, piece: usize, function: usize) -> &[f64] {
        &self.num[(piece * self.count + function) * (self.degree + 1)..][..self.degree + 1]
    }

    /// The Bernstein coefficients of the denominator on a piece.
    pub fn denominator(&self, piece: usize) -> Vec<f64> {
        match &self.den {
            Some(d) => d[piece * (self.degree + 1)..][..self.degree + 1].to_vec(),
            None => vec![1.0; self.degree + 1],
        }
    }

    /// The values at `t`.
    pub fn value(&self, t: f64) -> Vec<f64> {
        let piece = self.breaks.find(t, Limit::Above);
        let Interval { lo, hi } = self.breaks.piece(piece);
        let s = (t - lo) / (hi - lo);
        let den = bernstein_blossom(&self.denominator(piece), |_| s);
        (0..self.count)
            .map(|f| bernstein_blossom(self.numerator(piece, f), |_| s) / den)
            .collect()
    }

    /// All functions of several lists over their common breaks, with one common denominator.
    pub fn stack(parts: &[PiecewiseRational]) -> Self {
        let breaks = merge_breaks(parts.iter().map(|p| &p.breaks[..]));
        let parts: Vec<_> = parts.iter().map(|p| p.refined(&breaks)).collect();
        let pieces = breaks.len() - 1;
        let all_dens: Vec<Option<&Vec<f64>>> = parts.iter().map(|p| p.den.as_ref()).collect();
        // Equal denominators count once: four sides of one circle need one factor, not four.
        let mut factors: Vec<usize> = Vec::new();
        for (i, d) in all_dens.iter().enumerate() {
            if d.is_some()
                && !factors
                    .iter()
                    .any(|&j| all_dens[j] == *d && parts[j].degree == parts[i].degree)
            {
                factors.push(i);
            }
        }
        let own = |i: usize| {
            factors
                .iter()
                .copied()
                .find(|&j| all_dens[j] == all_dens[i] && parts[j].degree == parts[i].degree)
        };
        let factor_degree: usize = factors.iter().map(|&j| parts[j].degree).sum();
        let degree = parts
            .iter()
            .enumerate()
            .map(|(i, p)| p.degree + factor_degree - own(i).map_or(0, |j| parts[j].degree))
            .max()
            .unwrap_or(0)
            .max(factor_degree);
        let count = parts.iter().map(|p| p.count).sum();
        let (mut num, mut den) = (Vec::new(), Vec::new());
        for piece in 0..pieces {
            for (i, p) in parts.iter().enumerate() {
                let skip = own(i);
                for f in 0..p.count {
                    let mut c = p.numerator(piece, f).to_vec();
                    for &j in factors.iter().filter(|&&j| Some(j) != skip) {
                        c = bernstein_product(&c, &parts[j].denominator(piece));
                    }
                    num.extend(bernstein_elevate(&c, degree));
                }
            }
            let d = factors.iter().fold(vec![1.0], |acc, &j| {
                bernstein_product(&acc, &parts[j].denominator(piece))
            });
            den.extend(bernstein_elevate(&d, degree));
        }
        Self {
            breaks,
            degree,
            count,
            num,
            den: (!factors.is_empty()).then_some(den),
        }
    }

    /// The same functions with more breaks (a superset of its own).
    pub fn refined(&self, breaks: &[Break]) -> Self {
        if breaks.len() == self.breaks.len() {
            return Self {
                breaks: breaks.to_vec(),
                ..self.clone()
            };
        }
        let (mut num, mut den) = (Vec::new(), Vec::new());
        for piece in 0..breaks.len() - 1 {
            let part = Interval {
                lo: breaks[piece].at,
                hi: breaks[piece + 1].at,
            };
            let own = self.breaks.find(part.mid(), Limit::Above);
            let whole = self.breaks.piece(own);
            let s = |t: f64| (t - whole.lo) / (whole.hi - whole.lo);
            let (a, b) = (s(part.lo), s(part.hi));
            for f in 0..self.count {
                num.extend(bernstein_restrict(self.numerator(own, f), a, b));
            }
            if self.den.is_some() {
                den.extend(bernstein_restrict(&self.denominator(own), a, b));
            }
        }
        // A break that this list did not have is as smooth as its degree allows.
        let breaks = breaks
            .iter()
            .map(|b| {
                let smooth = self
                    .breaks
                    .iter()
                    .find(|o| o.at == b.at)
                    .map_or(i32::MAX, |o| o.smooth);
                Break::new(b.at, smooth.min(b.smooth))
            })
            .collect();
        Self {
            breaks,
            degree: self.degree,
            count: self.count,
            num,
            den: self.den.is_some().then_some(den),
        }
    }
}

/// The polar form of a Bernstein polynomial at the arguments `s(0), s(1), …` (in `[0, 1]` of its piece).
pub(crate) fn bernstein_blossom(c: &[f64], s: impl Fn(usize) -> f64) -> f64 {
    let mut d = c.to_vec();
    for r in 1..d.len() {
        let x = s(r - 1);
        for i in 0..d.len() - r {
            d[i] = (1.0 - x) * d[i] + x * d[i + 1];
        }
    }
    d[0]
}

/// The polynomial on the part `[a, b]` of its piece.
pub(crate) fn bernstein_restrict(c: &[f64], a: f64, b: f64) -> Vec<f64> {
    let p = c.len() - 1;
    (0..=p)
        .map(|j| bernstein_blossom(c, |r| if r < p - j { a } else { b }))
        .collect()
}

/// The product of two polynomials.
pub(crate) fn bernstein_product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let (m, n) = (a.len() - 1, b.len() - 1);
    let mut out = vec![0.0; m + n + 1];
    for i in 0..=m {
        for j in 0..=n {
            out[i + j] += binomial(m, i) * binomial(n, j) * a[i] * b[j];
        }
    }
    for (k, o) in out.iter_mut().enumerate() {
        *o /= binomial(m + n, k);
    }
    out
}

/// The same polynomial with a higher degree.
pub(crate) fn bernstein_elevate(c: &[f64], degree: usize) -> Vec<f64> {
    let p = c.len() - 1;
    if p == degree {
        return c.to_vec();
    }
    bernstein_product(c, &vec![1.0; degree - p + 1])
}
