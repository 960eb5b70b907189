//! Taylor models: a polynomial in two variables and an enclosure of what it differs by over a box.
//!
//! Unlike the coefficients of [`Taylor`], enclosed over the whole box, they have no derivatives, but quotients and roots keep
//! them narrow: the polynomial is found by the recurrence of power series, and the rest from what is then missing to
//! `f = q g` or `f = s²`. Source: Makino and Berz, *Taylor models and other validated functional inclusion methods*
//! (2003).

use super::taylor::Taylor;
use crate::interval::Interval;

/// `Σ c_ij x^i y^j + rest`, x and y from a box around 0.
#[derive(Clone, Debug)]
pub(super) struct Model {
    pub(super) p: Taylor,
    pub(super) rest: Interval,
    /// All values lie here too: over wide boxes the polynomial tells less than the ranges of what it was made of.
    pub(super) known: Interval,
    offset: [Interval; 2],
}

impl Model {
    /// Of degree `degree`, from enclosures over the box and at the centre of one degree more.
    pub(super) fn new(wide: &Taylor, at: &Taylor, offset: [Interval; 2], degree: usize) -> Self {
        let p = at.truncated(degree);
        let mut rest = Interval::ZERO;
        for (c, x) in wide.terms(degree + 1, offset) {
            rest = rest + c * x;
        }
        Self {
            p,
            rest,
            known: wide.c[0],
            offset,
        }
    }

    fn with(&self, p: Taylor, rest: Interval, known: Interval) -> Self {
        Self {
            p,
            rest,
            known,
            ..*self
        }
    }

    /// The sizes of the terms of each degree.
    fn sizes(&self) -> Vec<f64> {
        let size = |n| {
            let terms = self.p.terms(n, self.offset);
            terms.map(|(c, x)| (c * x).mag()).sum::<f64>() * ROUND_UP
        };
        (0..=self.p.degree).map(size).collect()
    }

    /// All values over the box.
    pub(super) fn range(&self) -> Interval {
        let sum = (0..=self.p.degree)
            .flat_map(|n| self.p.terms(n, self.offset))
            .fold(self.rest, |sum, (c, x)| sum + c * x);
        self.known.meet(sum)
    }

    pub(super) fn add(&self, o: &Self) -> Self {
        self.with(
            self.p.add(&o.p),
            self.rest + o.rest,
            self.range() + o.range(),
        )
    }

    pub(super) fn sub(&self, o: &Self) -> Self {
        self.with(
            self.p.sub(&o.p),
            self.rest - o.rest,
            self.range() - o.range(),
        )
    }

    pub(super) fn scale(&self, x: f64) -> Self {
        let x = Interval::point(x);
        self.with(self.p.scale(x), self.rest * x, self.range() * x)
    }

    pub(super) fn mul(&self, o: &Self) -> Self {
        let (a, b) = (self.sizes(), o.sizes());
        // Products of terms whose degree is too high.
        let mut high = 0.0;
        for (i, a) in a.iter().enumerate() {
            high += a * b[b.len() - i..].iter().sum::<f64>();
        }
        let high = high * ROUND_UP;
        let [all_a, all_b] = [&a, &b].map(|s| s.iter().sum::<f64>() * ROUND_UP);
        let sized = |size: f64| Interval::new(-size, size);
        let rest =
            sized(high) + self.rest * sized(all_b) + o.rest * sized(all_a) + self.rest * o.rest;
        self.with(self.p.mul(&o.p), rest, self.range() * o.range())
    }

    pub(super) fn sqr(&self) -> Self {
        let product = self.mul(self);
        self.with(self.p.sqr(), product.rest, self.range().sqr())
    }

    /// `f / g = q + (f - q g) / g`. Nothing finite where g may vanish.
    pub(super) fn div(&self, g: &Self) -> Self {
        let q = self.with(self.p.div(&g.p), Interval::ZERO, Interval::ENTIRE);
        let missing = self.sub(&q.mul(g)).range();
        let range = g.range();
        self.with(q.p, missing / range, self.range() / range)
    }

    /// `√f = s + (f - s²) / (√f + s)`. Nothing finite where f may vanish.
    pub(super) fn sqrt(&self) -> Self {
        let s = self.with(self.p.sqrt(), Interval::ZERO, Interval::ENTIRE);
        let missing = self.sub(&s.sqr()).range();
        let root = self.range().sqrt();
        let sum = root + s.range();
        self.with(s.p, missing / sum, root)
    }

    /// How much the values vary along u and along v.
    pub(super) fn weight(&self) -> [f64; 2] {
        let mut weight = [0.0; 2];
        for n in 1..=self.p.degree {
            for (j, (c, x)) in self.p.terms(n, self.offset).enumerate() {
                let share = (c * x).mag() / n as f64;
                weight[0] += share * (n - j) as f64;
                weight[1] += share * j as f64;
            }
        }
        weight
    }

    pub(super) fn is_finite(&self) -> bool {
        self.rest.is_finite() && self.p.is_finite()
    }
}

/// Covers the roundings of sums of a few dozen positive numbers.
const ROUND_UP: f64 = 1.0 + 1e-13;

pub(super) fn dot(a: &[Model; 3], b: &[Model; 3]) -> Model {
    let [x, y, z] = [0, 1, 2].map(|k| a[k].mul(&b[k]));
    x.add(&y).add(&z)
}

pub(super) fn cross(a: &[Model; 3], b: &[Model; 3]) -> [Model; 3] {
    [0, 1, 2].map(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i].mul(&b[j]).sub(&a[j].mul(&b[i]))
    })
}

pub(super) fn square(a: &[Model; 3]) -> Model {
    let [x, y, z] = a.each_ref().map(Model::sqr);
    x.add(&y).add(&z)
}

/// How much some vectors vary along u and along v, each relative to its length in the middle.
pub(super) fn weight(vectors: [&[Model; 3]; 3]) -> [f64; 2] {
    let mut sum = [0.0; 2];
    for a in vectors {
        let length = a.iter().map(|m| m.p.c[0].mag().powi(2)).sum::<f64>().sqrt();
        for w in a.each_ref().map(Model::weight) {
            sum[0] += w[0] / length;
            sum[1] += w[1] / length;
        }
    }
    sum
}
