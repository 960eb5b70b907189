//! Polynomials of degree 6 in two parameters from 0 to 1, by their Bernstein coefficients.
//!
//! A polynomial is nowhere less than its least coefficient, its second derivatives nowhere less than the least second
//! difference of coefficients, but for a factor. Both are the sharper the less it varies: over a part, by the square of the
//! part's size.
//!
//! Loops are over whole registers and so written that the compiler finds them (see [`vectorized`]).

use crate::simd::vectorized;

/// The degree along each parameter.
pub(super) const DEGREE: usize = 6;
/// The coefficients with the same power of u, of which the last is there twice, as registers have room for.
pub(super) const LANES: usize = 8;
/// Room for one row more, so that differences of neighbours need no other loop at the end.
pub(super) const ROOM: usize = (DEGREE + 2) * LANES;

/// The coefficients, those of v side by side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coefficients(pub(super) [f64; ROOM]);

/// What bounds second derivatives: the least second differences along u and along v, and the size of the largest mixed one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bends {
    uu: f64,
    vv: f64,
    uv: f64,
}

impl Bends {
    /// True if the polynomial is strictly convex, where every coefficient may be off by `off`.
    pub(super) fn is_convex(self, off: f64) -> bool {
        // `f_uu = 30 Δ`, `f_vv = 30 Δ` and `f_uv = 36 Δ` for combinations Δ of differences, of four coefficients each.
        let [uu, vv, uv] = [
            self.uu - 4.0 * off,
            self.vv - 4.0 * off,
            self.uv + 4.0 * off,
        ];
        uu > 0.0 && vv > 0.0 && 900.0 * uu * vv > 1296.0 * (1.0 + 1e-12) * uv * uv
    }
}

impl Coefficients {
    pub(super) const ZERO: Self = Self([0.0; ROOM]);

    /// The coefficients for each pair of numbers.
    pub(super) fn of(at: impl Fn([usize; 2]) -> f64) -> Self {
        let mut out = Self::ZERO;
        for k in 0..=DEGREE {
            for l in 0..LANES {
                out.0[k * LANES + l] = at([k, l.min(DEGREE)]);
            }
        }
        out
    }

    /// The least coefficient.
    #[inline(always)]
    pub(super) fn least(&self) -> f64 {
        let f = &self.0;
        let mut m = [f64::INFINITY; LANES];
        for k in 0..=DEGREE {
            for l in 0..LANES {
                m[l] = lesser(f[k * LANES + l], m[l]);
            }
        }
        least_of(m)
    }

    /// The bounds of second derivatives.
    pub(super) fn bends(&self) -> Bends {
        vectorized(
            #[inline(always)]
            || self.differences(),
        )
    }

    #[inline(always)]
    fn differences(&self) -> Bends {
        // Lanes without a difference.
        const NONE: f64 = f64::INFINITY;
        const BEYOND: [f64; LANES] = [0.0, 0.0, 0.0, 0.0, 0.0, NONE, NONE, NONE];
        const MIXED: [f64; LANES] = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0];
        let f = &self.0;
        let (mut uu, mut vv, mut uv) = ([NONE; LANES], [NONE; LANES], [0.0; LANES]);
        for k in 0..DEGREE - 1 {
            for l in 0..LANES {
                let at = k * LANES + l;
                let second = f[at] - 2.0 * f[at + LANES] + f[at + 2 * LANES];
                uu[l] = lesser(second, uu[l]);
            }
        }
        for k in 0..=DEGREE {
            for l in 0..LANES {
                let at = k * LANES + l;
                let second = f[at] - 2.0 * f[at + 1] + f[at + 2] + BEYOND[l];
                vv[l] = lesser(second, vv[l]);
            }
        }
        for k in 0..DEGREE {
            for l in 0..LANES {
                let at = k * LANES + l;
                let mixed = (f[at + LANES + 1] - f[at + 1]) - (f[at + LANES] - f[at]);
                uv[l] = lesser(-(mixed.abs() * MIXED[l]), uv[l]);
            }
        }
        Bends {
            uu: least_of(uu),
            vv: least_of(vv),
            uv: -least_of(uv),
        }
    }

    /// The polynomial over the lower and over the upper half of a parameter (0 for u), with their least coefficients.
    pub(super) fn halves(&self, d: usize, out: [&mut Self; 2]) -> [f64; 2] {
        let [lower, upper] = out;
        vectorized(
            #[inline(always)]
            || {
                if d == 0 {
                    self.halves_u(lower, upper);
                } else {
                    self.halves_v(lower, upper);
                }
                [lower.least(), upper.least()]
            },
        )
    }

    /// De Casteljau's scheme, all v at once.
    #[inline(always)]
    fn halves_u(&self, lower: &mut Self, upper: &mut Self) {
        let mut rows = *self;
        let row = |k: usize| k * LANES..(k + 1) * LANES;
        for k in 0..=DEGREE {
            let end = DEGREE - k;
            lower.0[row(k)].copy_from_slice(&rows.0[row(0)]);
            upper.0[row(end)].copy_from_slice(&rows.0[row(end)]);
            for at in 0..end * LANES {
                rows.0[at] = 0.5 * (rows.0[at] + rows.0[at + LANES]);
            }
        }
    }

    /// The same as products with the shares of coefficients in those of a half: these add up to 1.
    #[inline(always)]
    fn halves_v(&self, lower: &mut Self, upper: &mut Self) {
        for (shares, out) in SHARES.iter().zip([lower, upper]) {
            for k in 0..=DEGREE {
                let mut sum = [0.0; LANES];
                for (j, shares) in shares.iter().enumerate() {
                    let f = self.0[k * LANES + j];
                    for l in 0..LANES {
                        sum[l] += f * shares[l];
                    }
                }
                out.0[k * LANES..][..LANES].copy_from_slice(&sum);
            }
        }
    }

    /// Parameters where the polynomial is about least, as its least coefficient and those around it tell.
    pub(super) fn lowest(&self, least: f64) -> [f64; 2] {
        let k = self.0.iter().position(|&x| x == least).unwrap_or(0);
        let centre = [k / LANES, k % LANES].map(|i| i.clamp(1, DEGREE - 1));
        let f = |i: usize, j: usize| self.0[(centre[0] + i - 1) * LANES + centre[1] + j - 1];
        let (g, h) = (0.5 * (f(2, 1) - f(0, 1)), 0.5 * (f(1, 2) - f(1, 0)));
        let bend = |a: f64, b: f64| a - 2.0 * f(1, 1) + b;
        let (uu, vv) = (bend(f(0, 1), f(2, 1)), bend(f(1, 0), f(1, 2)));
        let uv = 0.25 * (f(2, 2) - f(2, 0) - f(0, 2) + f(0, 0));
        let det = uu * vv - uv * uv;
        let step = if uu > 0.0 && det > 0.0 {
            [(uv * h - vv * g) / det, (uv * g - uu * h) / det]
        } else {
            [k / LANES, (k % LANES).min(DEGREE)].map(|i| i as f64)
        };
        let from = if uu > 0.0 && det > 0.0 {
            centre
        } else {
            [0; 2]
        };
        [0, 1].map(|d| ((from[d] as f64 + step[d]) / DEGREE as f64).clamp(0.0, 1.0))
    }
}

/// The shares of coefficients in those of the lower and of the upper half.
const SHARES: [[[f64; LANES]; DEGREE + 1]; 2] = shares();

const fn shares() -> [[[f64; LANES]; DEGREE + 1]; 2] {
    let mut out = [[[0.0; LANES]; DEGREE + 1]; 2];
    let mut l = 0;
    while l < LANES {
        let n = if l < DEGREE { l } else { DEGREE };
        // Of the lower half: binomial coefficients of n over 2ⁿ. The upper half is the lower one of the mirror image.
        let (mut share, mut j) = (1.0 / (1u64 << n) as f64, 0);
        while j <= n {
            out[0][j][l] = share;
            share *= (n - j) as f64 / (j + 1) as f64;
            j += 1;
        }
        let (n, mut share, mut j) = (DEGREE - n, 1.0 / (1u64 << (DEGREE - n)) as f64, 0);
        while j <= n {
            out[1][DEGREE - j][l] = share;
            share *= (n - j) as f64 / (j + 1) as f64;
            j += 1;
        }
        l += 1;
    }
    out
}

/// The lesser number in a form that is one instruction.
#[inline(always)]
fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline(always)]
fn least_of(m: [f64; LANES]) -> f64 {
    m.into_iter().fold(f64::INFINITY, lesser)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::Random;

    fn power(x: f64, n: usize) -> f64 {
        (0..n).fold(1.0, |p, _| p * x)
    }

    fn value(f: &Coefficients, [u, v]: [f64; 2]) -> f64 {
        let binomial = [1.0, 6.0, 15.0, 20.0, 15.0, 6.0, 1.0];
        let b = |t: f64, k: usize| binomial[k] * power(t, k) * power(1.0 - t, DEGREE - k);
        let all = (0..=DEGREE).flat_map(|k| (0..=DEGREE).map(move |l| [k, l]));
        all.map(|[k, l]| f.0[k * LANES + l] * b(u, k) * b(v, l))
            .sum()
    }

    fn any(random: &mut Random) -> Coefficients {
        let x: Vec<f64> = (0..64).map(|_| random.unit()).collect();
        Coefficients::of(|[k, l]| x[8 * k + l])
    }

    #[test]
    fn halves_are_the_same_polynomial_and_nowhere_less_than_their_least_coefficient() {
        let mut random = Random(31);
        for _ in 0..50 {
            let f = any(&mut random);
            for d in 0..2 {
                let mut halves = [Coefficients::ZERO; 2];
                let [a, b] = &mut halves;
                let least = f.halves(d, [a, b]);
                for _ in 0..20 {
                    let uv = [random.unit(), random.unit()];
                    for h in 0..2 {
                        let mut whole = uv;
                        whole[d] = 0.5 * (uv[d] + h as f64);
                        let (half, whole) = (value(&halves[h], uv), value(&f, whole));
                        assert!((half - whole).abs() < 1e-14 && half >= least[h] - 1e-15);
                    }
                }
            }
        }
    }

    #[test]
    fn second_differences_decide_convexity() {
        // `a (u - ½)² + b (v - ½)² + c (u - ½) (v - ½)` has the determinant `4 a b - c²`, and its differences are exact.
        let of = |a: f64, b: f64, c: f64| {
            let x = |k: usize| (k as f64 - 3.0) / 6.0;
            // Coefficients of `(t - ½)²` are a quadratic in their number, with the second difference 1/15.
            let square = |k: usize| 0.25 - (k * (6 - k)) as f64 / 30.0;
            Coefficients::of(|[k, l]| a * square(k) + b * square(l) + c * x(k) * x(l))
        };
        assert!((value(&of(1.0, 0.0, 0.0), [0.2, 0.9]) - 0.09).abs() < 1e-15);
        for (a, b, c, convex) in [
            (1.0, 1.0, 1.99, true),
            (1.0, 1.0, -1.99, true),
            (1.0, 1.0, 2.01, false),
            (4.0, 0.25, 1.99, true),
            (4.0, -0.25, 0.0, false),
            (-1.0, 1.0, 0.0, false),
            (0.0, 1.0, 0.0, false),
        ] {
            assert_eq!(of(a, b, c).bends().is_convex(1e-16), convex, "{a} {b} {c}");
        }
    }

    #[test]
    fn the_lowest_place_of_a_bowl_is_near() {
        let square = |k: usize, at: f64| {
            // Of `(t - at)²`.
            let t = k as f64;
            t * (t - 1.0) / 30.0 - 2.0 * at * t / 6.0 + at * at
        };
        let f = Coefficients::of(|[k, l]| square(k, 0.3) + square(l, 0.8));
        let [u, v] = f.lowest(f.least());
        assert!((u - 0.3).abs() < 0.1 && (v - 0.8).abs() < 0.1, "{u} {v}");
    }
}
