//! Analytic functions as Taylor polynomials about the middles of parts of their pieces.
//!
//! With m the middle of a part of half width h, `|f(t) - Σ_{k≤n} f⁽ᵏ⁾(m) (t-m)ᵏ/k!| ≤ max|f⁽ⁿ⁺¹⁾| hⁿ⁺¹/(n+1)!`, and so for
//! derivatives with n less. The functions enclose their own derivatives, so the remainder is proven to be below rounding;
//! parts are halved until it is.

use super::Functions;
use super::table::Powers;
use crate::breaks::{Break, Breaks, Limit};
use crate::curve::MAX_ORDER;
use crate::interval::Interval;
use smallvec::SmallVec;

/// The highest degree: its remainder takes the highest derivative that callers may rely on.
const DEGREE: usize = MAX_ORDER - 1;
/// What the remainder may be, relative to the size of a function: half a unit in the last place.
const REMAINDER: f64 = 0.5 * f64::EPSILON;
/// What a function moves the surface by, relative to the surface's size, when it changes by its size: for functions that
/// do less the size is what would do that much. Ten such functions with their greatest remainders move it by little more
/// than a unit in the last place.
const SHARE: f64 = 0.25;
/// How many times more it may be for each derivative, relative to the size over the width of a piece: with less,
/// second derivatives, which lose such digits to rounding anyway, would ask for parts several times smaller.
const LOSS: f64 = 8.0;
/// Where in a piece values are taken to find how large they are: not evenly, or waves would be sampled at their zeros.
const SAMPLES: [f64; 5] = [0.0, 0.29, 0.5, 0.83, 1.0];
/// What rounding may move the surface by, relative to its size, if the differences of all functions at the ends of a part
/// add up: twice what the longest formulas (trigonometric blending, turning operators) bring. More may say that the
/// highest derivatives are wrong.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// The most coefficients: two megabytes, which leave the second-level cache at worst. Functions that need so many cost
/// far more to evaluate than that.
const MOST: usize = 1 << 18;
/// Halvings of a piece. Functions that need more are singular somewhere.
const DEPTH: usize = 16;

/// Functions over parts of their pieces.
pub(super) struct Taylor {
    degree: usize,
    /// The number of active functions, everywhere the same.
    width: usize,
    parts: Vec<Part>,
    end: Break,
}

struct Part {
    start: Break,
    first: usize,
    /// `f⁽ᵏ⁾(m) hᵏ/k!`, row-major by derivative.
    powers: Vec<f64>,
}

/// What is looked at while a list is prepared.
struct Source<'a> {
    functions: &'a dyn Functions,
    width: usize,
    /// What an error of 1 does to the surface, relative to the surface's size.
    effects: &'a [f64],
    /// The greatest absolute values found, or more where that does little to the surface: see [`SHARE`].
    sizes: Vec<f64>,
}

impl Taylor {
    /// `None` if no such polynomials are near enough, or if they are too many. An error of 1 in a function moves the
    /// surface by `effects` of the surface's size.
    pub(super) fn new(functions: &dyn Functions, effects: &[f64]) -> Option<Self> {
        let breaks = functions.breaks();
        let source = Source::new(functions, effects)?;
        let pieces: Vec<Interval> = (0..breaks.pieces()).map(|k| breaks.piece(k)).collect();
        let whole: Vec<_> = pieces.iter().map(|&p| source.enclose(p)).collect();
        // The least degree that needs no halving, else the highest.
        let near = |degree: usize| {
            let mut all = pieces.iter().zip(&whole);
            all.all(|(&p, d)| source.is_near(d, p, p, degree))
        };
        let degree = (1..=DEGREE).find(|&n| near(n)).unwrap_or(DEGREE);
        let most = MOST / (source.width * (degree + 1));
        let mut parts: Vec<Part> = Vec::new();
        for (&piece, start) in pieces.iter().zip(breaks) {
            let mut stack = vec![(piece, 0)];
            while let Some((t, depth)) = stack.pop() {
                if source.is_near(&source.enclose(t), t, piece, degree) {
                    parts.push(Part {
                        start: Break { at: t.lo, ..*start },
                        first: source.functions.active(t.mid(), Limit::Above).start,
                        powers: source.powers(t, degree)?,
                    });
                } else {
                    let m = t.mid();
                    if depth == DEPTH || m <= t.lo || t.hi <= m {
                        return None;
                    }
                    stack.push((Interval { lo: m, ..t }, depth + 1));
                    stack.push((Interval { hi: m, ..t }, depth + 1));
                }
                if parts.len() + stack.len() > most {
                    return None;
                }
            }
        }
        Some(Self {
            degree,
            width: source.width,
            parts,
            end: breaks[breaks.len() - 1],
        })
    }

    pub(super) fn into_powers(self) -> Powers {
        let starts = self.parts.iter().map(|p| p.start);
        let breaks: Vec<Break> = starts.chain([self.end]).collect();
        let first = self.parts.iter().map(|p| p.first).collect();
        Powers::new(&breaks, self.degree, self.width, first, |part, f| {
            let all = self.parts[part].powers.iter();
            all.skip(f).step_by(self.width).copied().collect()
        })
    }
}

impl<'a> Source<'a> {
    /// Finds how many functions are active and how large they are; `None` if the number differs from piece to piece or
    /// a value is not finite.
    fn new(functions: &'a dyn Functions, effects: &'a [f64]) -> Option<Self> {
        let breaks = functions.breaks();
        let width_of = |piece| {
            let t = breaks.piece(piece).mid();
            functions.active(t, Limit::Above).len()
        };
        let width = width_of(0);
        let mut sizes = greatest(functions);
        if !(1..breaks.pieces()).all(|k| width_of(k) == width)
            || !sizes.iter().all(|s| s.is_finite())
        {
            return None;
        }
        for (size, &effect) in sizes.iter_mut().zip(effects) {
            if effect > 0.0 {
                *size = size.max(SHARE / effect);
            }
        }
        Some(Self {
            functions,
            width,
            effects,
            sizes,
        })
    }

    /// Derivatives 0 to `DEGREE + 1` over a part.
    fn enclose(&self, t: Interval) -> Vec<Interval> {
        let mut d = vec![Interval::ENTIRE; (DEGREE + 2) * self.width];
        self.functions
            .enclose_piece(t, Limit::Above, DEGREE + 1, &mut d);
        d
    }

    /// True if the remainders over the part t of a piece, with its derivatives d, are small enough for values and two
    /// derivatives.
    fn is_near(&self, d: &[Interval], t: Interval, piece: Interval, degree: usize) -> bool {
        let (h, w) = (0.5 * (t.hi - t.lo), piece.hi - piece.lo);
        let first = self.functions.active(t.mid(), Limit::Above).start;
        let highest = &d[(degree + 1) * self.width..][..self.width];
        highest.iter().zip(&self.sizes[first..]).all(|(d, size)| {
            let greatest = d.mag();
            (0..=2.min(degree)).all(|k| {
                let n = degree + 1 - k;
                let remainder = (1..=n).fold(greatest, |r, i| r * h / i as f64);
                // A remainder that is not a number is not near.
                remainder <= REMAINDER * size * (LOSS / w).powi(k as i32)
            })
        })
    }

    /// The coefficients over a part; `None` if they are not those of the functions up to rounding.
    fn powers(&self, t: Interval, degree: usize) -> Option<Vec<f64>> {
        let (m, h) = (t.mid(), 0.5 * (t.hi - t.lo));
        let mut powers = vec![0.0; (degree + 1) * self.width];
        self.functions
            .jet_into(m, Limit::Above, degree, &mut powers);
        let mut factor = 1.0;
        for (k, row) in powers.chunks_exact_mut(self.width).enumerate() {
            if k > 0 {
                factor *= h / k as f64;
            }
            row.iter_mut().for_each(|x| *x *= factor);
        }
        let first = self.functions.active(m, Limit::Above).start;
        let mut values: SmallVec<[f64; 32]> = SmallVec::from_elem(0.0, self.width);
        for (at, s, limit) in [(t.lo, -1.0, Limit::Above), (t.hi, 1.0, Limit::Below)] {
            self.functions.jet_into(at, limit, 0, &mut values);
            let mut moved = 0.0;
            for (f, x) in values.iter().enumerate() {
                let rows = powers.iter().skip(f).step_by(self.width);
                let p = rows.rev().fold(0.0, |p, c| c + p * s);
                moved += self.effects[first + f] * (p - x).abs();
            }
            if moved.is_nan() || moved > ROUNDING {
                return None;
            }
        }
        Some(powers)
    }
}

/// The greatest absolute values of functions found at samples of each piece; infinite where a value is not finite.
fn greatest(functions: &dyn Functions) -> Vec<f64> {
    let breaks = functions.breaks();
    let mut sizes = vec![0.0f64; functions.count()];
    let mut values: SmallVec<[f64; 32]> = SmallVec::new();
    for k in 0..breaks.pieces() {
        let Interval { lo, hi } = breaks.piece(k);
        for share in SAMPLES {
            let t = lo + (hi - lo) * share;
            let limit = if share < 1.0 {
                Limit::Above
            } else {
                Limit::Below
            };
            let active = functions.active(t, limit);
            values.resize(active.len(), 0.0);
            functions.jet_into(t, limit, 0, &mut values);
            for (size, x) in sizes[active].iter_mut().zip(&values) {
                *size = if x.is_finite() {
                    size.max(x.abs())
                } else {
                    f64::INFINITY
                };
            }
        }
    }
    sizes
}

#[cfg(test)]
mod tests {
    use super::super::{BSplineBasis, ExpressionFunctions, FunctionsRef, Stack, Table};
    use super::super::{Trigonometric, Turn};
    use super::*;
    use crate::expr::Expr;
    use crate::laws::Random;
    use crate::simd::Plain;
    use std::sync::Arc;

    fn expression(text: &str, domain: [f64; 2]) -> FunctionsRef {
        let bound = Expr::parse(text).unwrap().bind(&["t"], &[]).unwrap();
        Arc::new(ExpressionFunctions::new([bound], domain).unwrap())
    }

    /// As if every function had the same share of a surface.
    fn taylor(f: &FunctionsRef) -> Option<Table> {
        let effect = |size: f64| 1.0 / (size * f.count() as f64);
        let effects: Vec<f64> = greatest(f.as_ref()).into_iter().map(effect).collect();
        Table::taylor(f, &effects)
    }

    fn both(table: &Table, f: &FunctionsRef, t: f64) -> [Vec<f64>; 2] {
        let mut out = [(); 2].map(|()| vec![0.0; 3 * f.count()]);
        table.eval::<_, 3>(Plain, t, &mut out[0]);
        f.jet_into(t, Limit::Above, 2, &mut out[1]);
        out
    }

    /// The greatest differences of values and derivatives from those of the list itself, relative to their own greatest
    /// values and those of the functions over powers of the width of a piece, in units in the last place.
    fn worst(f: &FunctionsRef) -> [f64; 3] {
        let (table, n) = (taylor(f).unwrap(), f.count());
        let values = greatest(f.as_ref());
        let (breaks, mut random) = (f.breaks(), Random(4));
        let (mut off, mut sizes) = (vec![0.0f64; 3 * n], vec![0.0f64; 3 * n]);
        let inside: Vec<f64> = (0..2000).map(|_| random.within(breaks.domain())).collect();
        for t in inside.into_iter().chain(breaks.iter().map(|b| b.at)) {
            let w = breaks.piece(breaks.find(t, Limit::Above)).width();
            let [out, want] = both(&table, f, t);
            for k in 0..3 * n {
                off[k] = off[k].max((out[k] - want[k]).abs());
                let least = values[k % n] / w.powi((k / n) as i32);
                sizes[k] = sizes[k].max(want[k].abs()).max(least);
            }
        }
        let relative: Vec<f64> = off.iter().zip(sizes).map(|(o, s)| o / s).collect();
        [0, 1, 2].map(|k| {
            relative[k * n..][..n]
                .iter()
                .fold(0.0, |a: f64, b| a.max(*b))
                / f64::EPSILON
        })
    }

    #[test]
    fn values_and_derivatives_are_near() {
        let mut lists: Vec<FunctionsRef> = vec![
            Arc::new(Turn::new(0.3, 5.0)),
            expression("exp(t) * sin(7 * t)", [-1.0, 2.0]),
            expression("1 / (1 + 25 * t^2)", [-1.0, 1.0]),
            expression("1e-200 * cosh(t)", [0.0, 2.0]),
            expression("sin(2 * pi * t)", [0.0, 1.0]),
            // Corners, where the piece above decides.
            expression("abs(t - 0.3) * exp(t)", [0.0, 1.0]),
        ];
        for alpha in [1e-3, 0.5, 1.5, 2.5, 3.0] {
            lists.push(Arc::new(Trigonometric::new(alpha).unwrap()));
        }
        for f in lists {
            let [value, first, second] = worst(&f);
            // Both sides of the comparison have the rounding of the functions' own formulas.
            assert!(
                value < 8.0 && first < 16.0 && second < 64.0,
                "{value} {first} {second} for {f:?}"
            );
        }
    }

    #[test]
    fn polynomials_need_no_halving_and_share_their_pieces() {
        let spline = |n| -> FunctionsRef {
            let knots = BSplineBasis::clamped_uniform(3, n);
            let basis: FunctionsRef = Arc::new(BSplineBasis::new(3, knots).unwrap());
            let row: Vec<f64> = (0..n).map(|i| (i * i % 5) as f64).collect();
            Arc::new(super::super::Combination::new(basis, &[&row]))
        };
        let list = Stack::new(vec![
            spline(5),
            spline(7),
            Arc::new(BSplineBasis::bernstein(2)),
        ]);
        let taylor = Taylor::new(&list, &[1.0; 5]).unwrap();
        // Knots at halves and at quarters.
        assert_eq!((taylor.degree, taylor.parts.len(), taylor.width), (3, 4, 5));
        let [value, first, second] = worst(&(Arc::new(list) as FunctionsRef));
        assert!(
            value < 4.0 && first < 32.0 && second < 64.0,
            "{value} {first} {second}"
        );
    }

    #[test]
    fn a_remainder_counts_by_what_it_does() {
        let f = expression("1e-8 * exp(sin(9 * t))", [0.0, 1.0]);
        let parts = |effect| Taylor::new(f.as_ref(), &[effect]).unwrap().parts.len();
        // A function that moves the surface by its size needs what it needs alone.
        assert_eq!(parts(1e7), parts(0.0));
        assert!(parts(1.0) < parts(1e7) / 4);
    }

    #[test]
    fn what_is_singular_is_refused() {
        // Almost: where the root's derivatives are infinite, expressions themselves are refused.
        for (text, domain) in [
            ("sqrt(t)", [1e-12, 1.0]),
            ("sqrt(1 - t)", [0.0, 1.0 - 1e-12]),
        ] {
            assert!(taylor(&expression(text, domain)).is_none(), "{text}");
        }
        // It has a table all the same: the functions as they are.
        let f = expression("sqrt(t)", [1e-12, 1.0]);
        let [out, want] = both(&Table::new(&f, &[1.0]), &f, 0.3);
        assert_eq!(out, want);
    }

    #[test]
    fn beyond_the_domain_functions_are_evaluated_as_they_are() {
        let f: FunctionsRef = Arc::new(Trigonometric::new(1.0).unwrap());
        let table = taylor(&f).unwrap();
        for t in [-1.0, -1e-17, 1.0f64.next_up(), 9.0, 1e300] {
            let [out, want] = both(&table, &f, t);
            assert_eq!(out, want, "{t}");
        }
        let [out, _] = both(&table, &f, f64::NAN);
        assert!(out.iter().all(|x| x.is_nan()));
    }
}
