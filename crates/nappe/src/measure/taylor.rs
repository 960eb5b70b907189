//! Truncated Taylor polynomials in two variables with enclosed coefficients: what an integrand is computed in.

use crate::box3::Box3;
use crate::breaks::Limit;
use crate::interval::Interval;
use crate::series::binomial;
use crate::surface::{Dir, Surface, jet_index, jet_len};

/// `Σ c_ij du^i dv^j` for `i + j <= degree`, placed by [`jet_index`].
#[derive(Clone, Debug)]
pub(super) struct Taylor {
    pub(super) degree: usize,
    pub(super) c: Vec<Interval>,
}

impl Taylor {
    fn zero(degree: usize) -> Self {
        Self {
            degree,
            c: vec![Interval::ZERO; jet_len(degree)],
        }
    }

    /// The first variable, measured from the centre, over its range.
    pub(super) fn variable(range: Interval, degree: usize) -> Self {
        let mut t = Self::zero(degree);
        t.c[0] = range;
        t.c[jet_index(1, 0)] = Interval::ONE;
        t
    }

    /// One coordinate of `∂ᵃ_u ∂ᵇ_v r`, from a jet of order `degree + a + b` at least.
    pub(super) fn coordinate(jet: &[Box3], axis: usize, [a, b]: [usize; 2], degree: usize) -> Self {
        let mut t = Self::zero(degree);
        let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
        for n in 0..=degree {
            for j in 0..=n {
                let i = n - j;
                let d = jet[jet_index(i + a, j + b)].to_array()[axis];
                t.c[jet_index(i, j)] = d / Interval::point(factorial(i) * factorial(j));
            }
        }
        t
    }

    /// The three coordinates of `∂ᵃ_u ∂ᵇ_v r`.
    pub(super) fn vector(jet: &[Box3], d: [usize; 2], degree: usize) -> [Self; 3] {
        [0, 1, 2].map(|axis| Self::coordinate(jet, axis, d, degree))
    }

    pub(super) fn dot(a: &[Self; 3], b: &[Self; 3]) -> Self {
        a[0].mul(&b[0]).add(&a[1].mul(&b[1])).add(&a[2].mul(&b[2]))
    }

    pub(super) fn cross(a: &[Self; 3], b: &[Self; 3]) -> [Self; 3] {
        [0, 1, 2].map(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            a[i].mul(&b[j]).sub(&a[j].mul(&b[i]))
        })
    }

    /// `|a|²`, a sum of squares.
    pub(super) fn square(a: &[Self; 3]) -> Self {
        a[0].sqr().add(&a[1].sqr()).add(&a[2].sqr())
    }

    pub(super) fn add(&self, o: &Self) -> Self {
        let c = self.c.iter().zip(&o.c).map(|(&a, &b)| a + b).collect();
        Self { c, ..*self }
    }

    pub(super) fn sub(&self, o: &Self) -> Self {
        let c = self.c.iter().zip(&o.c).map(|(&a, &b)| a - b).collect();
        Self { c, ..*self }
    }

    pub(super) fn scale(&self, x: Interval) -> Self {
        let c = self.c.iter().map(|&a| a * x).collect();
        Self { c, ..*self }
    }

    pub(super) fn mul(&self, o: &Self) -> Self {
        let mut t = Self::zero(self.degree);
        t.each(|i, j, t| {
            let mut s = Interval::ZERO;
            for p in 0..=i {
                for q in 0..=j {
                    s = s + self.c[jet_index(p, q)] * o.c[jet_index(i - p, j - q)];
                }
            }
            t[jet_index(i, j)] = s;
        });
        t
    }

    /// `f²`, whose value is never negative. Each product of two different terms is taken once.
    pub(super) fn sqr(&self) -> Self {
        let mut t = Self::zero(self.degree);
        let two = Interval::point(2.0);
        t.each(|i, j, t| {
            let mut s = Interval::ZERO;
            for p in 0..=i {
                for q in 0..=j {
                    let (a, b) = (jet_index(p, q), jet_index(i - p, j - q));
                    if a < b {
                        s = s + two * self.c[a] * self.c[b];
                    } else if a == b {
                        s = s + self.c[a].sqr();
                    }
                }
            }
            t[jet_index(i, j)] = s;
        });
        t
    }

    /// `f / g` by `g_00 q_ij = f_ij - Σ' g_pq q_{i-p,j-q}`. Nothing finite where g may vanish.
    pub(super) fn div(&self, o: &Self) -> Self {
        let mut t = Self::zero(self.degree);
        t.each(|i, j, t| {
            let mut s = self.c[jet_index(i, j)];
            for p in 0..=i {
                for q in 0..=j {
                    if (p, q) != (0, 0) {
                        s = s - o.c[jet_index(p, q)] * t[jet_index(i - p, j - q)];
                    }
                }
            }
            t[jet_index(i, j)] = s / o.c[0];
        });
        t
    }

    /// `√f` by `2 f_00 s_ij = f_ij - Σ' s_pq s_{i-p,j-q}`. Nothing finite where f may vanish.
    pub(super) fn sqrt(&self) -> Self {
        let mut t = Self::zero(self.degree);
        let root = self.c[0].sqrt();
        t.each(|i, j, t| {
            if i + j == 0 {
                t[0] = root;
                return;
            }
            let mut s = self.c[jet_index(i, j)];
            for p in 0..=i {
                for q in 0..=j {
                    if (p, q) != (0, 0) && (p, q) != (i, j) {
                        s = s - t[jet_index(p, q)] * t[jet_index(i - p, j - q)];
                    }
                }
            }
            t[jet_index(i, j)] = s / (root + root);
        });
        t
    }

    /// The terms of one degree: coefficients, and the ranges of their monomials.
    pub(super) fn terms(
        &self,
        n: usize,
        [x, y]: [Interval; 2],
    ) -> impl Iterator<Item = (Interval, Interval)> {
        (0..=n).map(move |j| {
            let monomial = x.powi((n - j) as i32) * y.powi(j as i32);
            (self.c[jet_index(n - j, j)], monomial)
        })
    }

    /// Calls `f(i, j, coefficients)` by increasing degree.
    fn each(&mut self, mut f: impl FnMut(usize, usize, &mut [Interval])) {
        for n in 0..=self.degree {
            for j in 0..=n {
                f(n - j, j, &mut self.c);
            }
        }
    }

    /// The terms up to a lower degree.
    pub(super) fn truncated(&self, degree: usize) -> Self {
        let c = self.c[..jet_len(degree)].to_vec();
        Self { degree, c }
    }

    /// `f / u` where f vanishes for u = 0 (measured from there): `(f/u)(u) = ∫ f_u(su) ds`, so the coefficients move by
    /// one place, and enclosures over a box that touches u = 0 move likewise. One degree lower.
    pub(super) fn divided(&self) -> Self {
        let mut t = Self::zero(self.degree - 1);
        t.each(|i, j, c| c[jet_index(i, j)] = self.c[jet_index(i + 1, j)]);
        t
    }

    /// The same where f vanishes for the parameter `d` = 0.
    pub(super) fn divided_along(&self, d: usize) -> Self {
        if d == 0 {
            return self.divided();
        }
        let mut t = Self::zero(self.degree - 1);
        t.each(|i, j, c| c[jet_index(i, j)] = self.c[jet_index(i, j + 1)]);
        t
    }

    /// The derivative, one degree lower.
    pub(super) fn derivative(&self, dir: Dir) -> Self {
        let mut t = Self::zero(self.degree - 1);
        t.each(|i, j, c| {
            let (k, n) = match dir {
                Dir::U => (jet_index(i + 1, j), i + 1),
                Dir::V => (jet_index(i, j + 1), j + 1),
            };
            c[jet_index(i, j)] = self.c[k] * Interval::point(n as f64);
        });
        t
    }

    /// Narrower enclosures of the coefficients over a box by Taylor's formula from those `at` the centre; see
    /// [`Self::range`]. It pays before a root or quotient: there wide coefficients multiply.
    pub(super) fn tightened(mut self, at: &Self, offset: [Interval; 2]) -> Self {
        let powers = offset.map(|x| {
            let mut p = vec![Interval::ONE];
            for k in 0..self.degree {
                p.push(p[k] * x);
            }
            p
        });
        let monomials = products(&powers, self.degree);
        for n in 0..self.degree {
            for j in 0..=n {
                let i = n - j;
                let mut sum = Interval::ZERO;
                for a in 0..=self.degree - n {
                    for b in 0..=self.degree - n - a {
                        let k = jet_index(i + a, j + b);
                        let top = a + b == self.degree - n;
                        let c = if top { self.c[k] } else { at.c[k] };
                        let times = Interval::point(binomial(i + a, a) * binomial(j + b, b));
                        sum = sum + c * times * monomials[jet_index(a, b)];
                    }
                }
                if sum.is_finite() {
                    let k = jet_index(i, j);
                    self.c[k] = sum.meet(self.c[k]);
                }
            }
        }
        self
    }

    /// How much of the range comes from u and from v; see [`Self::range`].
    pub(super) fn weight(&self, at: &Self, [x, y]: [Interval; 2]) -> [f64; 2] {
        let mut weight = [0.0; 2];
        for n in 1..=self.degree {
            for j in 0..=n {
                let i = n - j;
                let k = jet_index(i, j);
                let c = if n < self.degree { at.c[k] } else { self.c[k] };
                let share = c.mag() * x.mag().powi(i as i32) * y.mag().powi(j as i32) / n as f64;
                weight[0] += share * i as f64;
                weight[1] += share * j as f64;
            }
        }
        weight
    }

    /// The range over a box, whose offsets from its middle are `x` and `y`: `self` holds enclosures over the box, of
    /// which only the highest degree is used, `at` those in the middle.
    pub(super) fn range(&self, at: &Self, [x, y]: [Interval; 2]) -> Interval {
        let mut sum = Interval::ZERO;
        for n in 0..=self.degree {
            for j in 0..=n {
                let k = jet_index(n - j, j);
                let c = if n < self.degree { at.c[k] } else { self.c[k] };
                sum = sum + c * x.powi((n - j) as i32) * y.powi(j as i32);
            }
        }
        if sum.is_finite() {
            sum.meet(self.c[0])
        } else {
            self.c[0]
        }
    }

    pub(super) fn is_finite(&self) -> bool {
        self.c.iter().all(|c| c.is_finite())
    }
}

/// What is known of a surface over a box of parameters in one analytic piece.
pub(super) struct Patch {
    /// Enclosures of the jet over the box.
    pub(super) wide: Vec<Box3>,
    /// Enclosures of the jet at the centre of expansion.
    pub(super) at: Vec<Box3>,
    /// The parameters, measured from the centre.
    pub(super) offset: [Interval; 2],
}

impl Patch {
    /// The jets of the given order, expanded in the middle.
    pub(super) fn new(surface: &dyn Surface, uv: [Interval; 2], order: usize) -> Self {
        Self::about(surface, uv, uv.map(Interval::mid), order)
    }

    /// The jets of the given order, expanded at `centre`.
    pub(super) fn about(
        surface: &dyn Surface,
        uv: [Interval; 2],
        centre: [f64; 2],
        order: usize,
    ) -> Self {
        let mut wide = vec![Box3::ENTIRE; jet_len(order)];
        let mut at = wide.clone();
        // The piece is the one that holds the box, also where the centre is a break.
        let limit = [0, 1].map(|d| {
            if centre[d] >= uv[d].hi {
                Limit::Below
            } else {
                Limit::Above
            }
        });
        surface.enclose_piece(uv, [Limit::Above; 2], order, &mut wide);
        surface.enclose_piece(centre.map(Interval::point), limit, order, &mut at);
        let offset = [0, 1].map(|d| uv[d] - Interval::point(centre[d]));
        tighten(&mut wide, &at, offset, order);
        Self { wide, at, offset }
    }
}

/// `xᵃ yᵇ` from the powers of both, placed by [`jet_index`].
fn products([px, py]: &[Vec<Interval>; 2], degree: usize) -> Vec<Interval> {
    let mut out = Vec::with_capacity(jet_len(degree));
    for n in 0..=degree {
        out.extend((0..=n).map(|b| px[n - b] * py[b]));
    }
    out
}

/// Makes the enclosures `wide` of a jet over a box narrower by Taylor's formula from those `at` its middle, to
/// the highest degree there is; `x` and `y` are the offsets from the middle.
fn tighten(wide: &mut [Box3], at: &[Box3], [x, y]: [Interval; 2], order: usize) {
    let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
    let powers = |x: Interval| {
        (0..=order)
            .map(|k| x.powi(k as i32) / Interval::point(factorial(k)))
            .collect::<Vec<_>>()
    };
    let monomials = products(&[x, y].map(powers), order);
    for n in 0..order {
        for j in 0..=n {
            let i = n - j;
            let mut sum = Box3::ZERO;
            for a in 0..=order - n {
                for b in 0..=order - n - a {
                    let k = jet_index(i + a, j + b);
                    let d = if a + b == order - n { wide[k] } else { at[k] };
                    sum = sum + d.scale(monomials[jet_index(a, b)]);
                }
            }
            if sum.is_finite() {
                wide[jet_index(i, j)] = sum.meet(wide[jet_index(i, j)]);
            }
        }
    }
}
