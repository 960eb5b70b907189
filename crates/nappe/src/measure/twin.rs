//! Taylor polynomials over a box and at its centre, computed together: each result over the box is tightened by the one at
//! the centre, so that products and quotients of wide coefficients do not pile up.

use super::taylor::Taylor;
use crate::interval::Interval;
use crate::surface::Dir;

/// Enclosures of the coefficients over a box, and at the centre of expansion.
#[derive(Clone, Debug)]
pub(super) struct Twin {
    pub(super) wide: Taylor,
    pub(super) at: Taylor,
    /// The parameters, measured from the centre.
    offset: [Interval; 2],
}

impl Twin {
    pub(super) fn new([wide, at]: [Taylor; 2], offset: [Interval; 2]) -> Self {
        Self { wide, at, offset }.tight()
    }

    /// The first parameter, measured from the centre.
    pub(super) fn variable(offset: [Interval; 2], degree: usize) -> Self {
        let at = Interval::ZERO;
        let [wide, at] = [offset[0], at].map(|x| Taylor::variable(x, degree));
        Self { wide, at, offset }
    }

    pub(super) fn degree(&self) -> usize {
        self.wide.degree
    }

    fn tight(mut self) -> Self {
        self.wide = self.wide.tightened(&self.at, self.offset);
        self
    }

    /// One operation on both, without tightening.
    fn each(&self, f: impl Fn(&Taylor) -> Taylor) -> Self {
        let [wide, at] = [&self.wide, &self.at].map(f);
        Self {
            wide,
            at,
            offset: self.offset,
        }
    }

    /// An operation on two; both are cut to the lower degree.
    fn with(&self, o: &Self, f: impl Fn(&Taylor, &Taylor) -> Taylor) -> Self {
        let degree = self.degree().min(o.degree());
        let (a, b) = (self.cut(degree), o.cut(degree));
        Self {
            wide: f(&a.wide, &b.wide),
            at: f(&a.at, &b.at),
            offset: self.offset,
        }
    }

    pub(super) fn cut(&self, degree: usize) -> Self {
        self.each(|t| t.truncated(degree))
    }

    pub(super) fn add(&self, o: &Self) -> Self {
        self.with(o, Taylor::add)
    }

    pub(super) fn sub(&self, o: &Self) -> Self {
        self.with(o, Taylor::sub)
    }

    pub(super) fn mul(&self, o: &Self) -> Self {
        self.with(o, Taylor::mul).tight()
    }

    pub(super) fn div(&self, o: &Self) -> Self {
        self.with(o, Taylor::div).tight()
    }

    pub(super) fn sqr(&self) -> Self {
        self.each(Taylor::sqr).tight()
    }

    pub(super) fn scale(&self, x: f64) -> Self {
        self.each(|t| t.scale(Interval::point(x)))
    }

    pub(super) fn derivative(&self, dir: Dir) -> Self {
        self.each(|t| t.derivative(dir))
    }

    /// See [`Taylor::divided`].
    pub(super) fn divided(&self) -> Self {
        self.each(Taylor::divided)
    }

    pub(super) fn into_pair(self) -> [Taylor; 2] {
        [self.wide, self.at]
    }

    pub(super) fn is_finite(&self) -> bool {
        self.wide.is_finite()
    }
}
