//! What a formula needs of a number, so that one text serves values (`f64`, or several at once in a [`Pack`]) and
//! enclosures ([`Interval`]).

use crate::interval::Interval;
use smallvec::SmallVec;
use std::array::from_fn;
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// `f64`, [`Interval`] or [`Pack`]. Kinds write their formula once over this trait: evaluated with `f64` it gives values,
/// with [`Interval`] rigorous enclosures, with [`Pack`] the values at several parameters. It has no comparisons, since
/// the lanes of a pack may disagree: formulas that decide are written over [`Scalar`].
pub trait Number:
    Copy
    + Debug
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Send
    + Sync
    + 'static
{
    /// As many coefficients as a [`Series`](crate::series::Series) holds without memory of its own.
    type Few: smallvec::Array<Item = Self> + Debug;
    /// The number 0.
    const ZERO: Self;
    /// The number 1.
    const ONE: Self;
    /// The square.
    fn sqr(self) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// The exponential.
    fn exp(self) -> Self;
    /// The natural logarithm.
    fn ln(self) -> Self;
    /// The sine of an angle in radians.
    fn sin(self) -> Self;
    /// The cosine of an angle in radians.
    fn cos(self) -> Self;
    /// The inverse sine.
    fn asin(self) -> Self;
    /// The inverse cosine.
    fn acos(self) -> Self;
    /// The inverse tangent.
    fn atan(self) -> Self;
    /// The tangent of an angle in radians.
    fn tan(self) -> Self;
    /// The hyperbolic sine.
    fn sinh(self) -> Self;
    /// The hyperbolic cosine.
    fn cosh(self) -> Self;
    /// The hyperbolic tangent.
    fn tanh(self) -> Self;
}

/// A [`Number`] that is at one place, so that a formula may decide by it: `f64` or [`Interval`].
pub trait Scalar: Number + PartialEq {
    /// The number that decides a branch: the value, or the middle of the enclosure.
    fn mid(self) -> f64;
    /// An integer power. Compilers compute it in more than one way, so that lanes might differ from single numbers.
    fn powi(self, n: i32) -> Self;
    /// True only for exactly zero.
    fn is_zero(self) -> bool {
        self == Self::ZERO
    }
}

macro_rules! forward {
    ($t:ty) => {
        fn sqrt(self) -> Self {
            <$t>::sqrt(self)
        }
        fn exp(self) -> Self {
            <$t>::exp(self)
        }
        fn ln(self) -> Self {
            <$t>::ln(self)
        }
        fn sin(self) -> Self {
            <$t>::sin(self)
        }
        fn cos(self) -> Self {
            <$t>::cos(self)
        }
        fn asin(self) -> Self {
            <$t>::asin(self)
        }
        fn acos(self) -> Self {
            <$t>::acos(self)
        }
        fn atan(self) -> Self {
            <$t>::atan(self)
        }
        fn tan(self) -> Self {
            <$t>::tan(self)
        }
        fn sinh(self) -> Self {
            <$t>::sinh(self)
        }
        fn cosh(self) -> Self {
            <$t>::cosh(self)
        }
        fn tanh(self) -> Self {
            <$t>::tanh(self)
        }
    };
}

impl Number for f64 {
    type Few = [f64; 6];
    const ZERO: f64 = 0.0;
    const ONE: f64 = 1.0;
    fn sqr(self) -> f64 {
        self * self
    }
    forward!(f64);
}

impl Scalar for f64 {
    fn mid(self) -> f64 {
        self
    }
    fn powi(self, n: i32) -> Self {
        f64::powi(self, n)
    }
}

impl Number for Interval {
    type Few = [Interval; 6];
    const ZERO: Interval = Interval::ZERO;
    const ONE: Interval = Interval::ONE;
    fn sqr(self) -> Interval {
        Interval::sqr(self)
    }
    forward!(Interval);
}

impl Scalar for Interval {
    fn mid(self) -> f64 {
        Interval::mid(self)
    }
    fn powi(self, n: i32) -> Self {
        Interval::powi(self, n)
    }
}

/// Values at several parameters at once. Every lane has the bits that an `f64` would have; what is the same for all
/// lanes, and the steps of a formula, cost once.
#[derive(Clone, Copy, Debug)]
pub struct Pack(pub [f64; Pack::LANES]);

impl Pack {
    /// How many values there are: a register of the widest kernels.
    pub const LANES: usize = 8;

    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self(self.0.map(f))
    }

    /// Evaluates one lane after the other what is not a formula of packs: `eval` gets a parameter and the places for
    /// its numbers. A lane that repeats the one before costs nothing.
    pub(crate) fn each_lane(self, out: &mut [Self], mut eval: impl FnMut(f64, &mut [f64])) {
        let mut one: SmallVec<[f64; 32]> = SmallVec::from_elem(0.0, out.len());
        for (lane, t) in self.0.into_iter().enumerate() {
            if lane == 0 || t.to_bits() != self.0[lane - 1].to_bits() {
                eval(t, &mut one);
            }
            for (out, x) in out.iter_mut().zip(&one) {
                out.0[lane] = *x;
            }
        }
    }

    /// What `f` gives for all lanes, if it is the same.
    pub(crate) fn common<T: PartialEq>(self, f: impl Fn(f64) -> T) -> Option<T> {
        let first = f(self.0[0]);
        self.0[1..].iter().all(|&t| f(t) == first).then_some(first)
    }
}

impl From<f64> for Pack {
    fn from(x: f64) -> Self {
        Self([x; Self::LANES])
    }
}

macro_rules! lanes {
    ($trait:ident $method:ident) => {
        impl $trait for Pack {
            type Output = Self;
            fn $method(self, o: Self) -> Self {
                Self(from_fn(|l| self.0[l].$method(o.0[l])))
            }
        }
    };
}

lanes!(Add add);
lanes!(Sub sub);
lanes!(Mul mul);
lanes!(Div div);

impl Neg for Pack {
    type Output = Self;
    fn neg(self) -> Self {
        self.map(Neg::neg)
    }
}

macro_rules! map_lanes {
    ($($method:ident)*) => {
        $(fn $method(self) -> Self {
            self.map(f64::$method)
        })*
    };
}

impl Number for Pack {
    type Few = [Pack; 1];
    const ZERO: Self = Self([0.0; Self::LANES]);
    const ONE: Self = Self([1.0; Self::LANES]);
    fn sqr(self) -> Self {
        self * self
    }
    map_lanes!(sqrt exp ln sin cos asin acos atan tan sinh cosh tanh);
}

/// A vector over a [`Number`], for formulas written once for values and enclosures.
pub type Vec3<S> = [S; 3];

/// The dot product.
pub fn dot<S: Number>(a: Vec3<S>, b: Vec3<S>) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The cross product.
pub fn cross<S: Number>(a: Vec3<S>, b: Vec3<S>) -> Vec3<S> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_lane_has_the_bits_of_a_single_number() {
        fn formula<S: Number>(x: S) -> [S; 16] {
            let y = x + S::ONE;
            [
                (x - y) * S::from(0.3),
                y / x,
                -x,
                x.sqr(),
                x.sqrt(),
                x.exp(),
                y.ln(),
                x.sin(),
                x.cos(),
                x.asin(),
                x.acos(),
                x.atan(),
                x.tan(),
                x.sinh(),
                x.cosh(),
                x.tanh(),
            ]
        }
        let x = Pack(from_fn(|lane| 0.11 * lane as f64));
        let packs = formula(x);
        for (lane, x) in x.0.into_iter().enumerate() {
            let bits = packs.map(|pack| pack.0[lane].to_bits());
            assert_eq!(bits, formula(x).map(f64::to_bits), "lane {lane}");
        }
    }
}
