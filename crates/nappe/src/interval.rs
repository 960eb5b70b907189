//! Closed intervals with outward rounding: the arithmetic behind every proof.
//!
//! Each operation returns an interval that contains every real result for arguments in the operands. The four basic
//! operations and the square root are correctly rounded in IEEE 754, so one step outwards is enough; for the
//! elementary functions of the system library, whose documented error is at most two units in the last place,
//! [`LIBM_ULPS`] steps are taken. Where no finite statement can be made (division by an interval that contains zero,
//! an argument outside a function's domain) the result is [`Interval::ENTIRE`], never a NaN.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Steps outwards after a library function. Two are documented for the worst common library; four leaves a margin.
const LIBM_ULPS: u32 = 4;

/// A closed interval `[lo, hi]` of real numbers, possibly unbounded.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Interval {
    /// The lower end.
    pub lo: f64,
    /// The upper end.
    pub hi: f64,
}

impl Interval {
    /// The whole line: "nothing is known".
    pub const ENTIRE: Interval = Interval {
        lo: f64::NEG_INFINITY,
        hi: f64::INFINITY,
    };
    /// The number 0.
    pub const ZERO: Interval = Interval { lo: 0.0, hi: 0.0 };
    /// The number 1.
    pub const ONE: Interval = Interval { lo: 1.0, hi: 1.0 };
    /// `[0, 1]`, the usual parameter range.
    pub const UNIT: Interval = Interval { lo: 0.0, hi: 1.0 };

    /// The interval between two numbers in either order. A NaN gives [`Interval::ENTIRE`].
    pub fn new(a: f64, b: f64) -> Self {
        if a <= b {
            Self { lo: a, hi: b }
        } else if b <= a {
            Self { lo: b, hi: a }
        } else {
            Self::ENTIRE
        }
    }

    /// The interval that holds one number. A NaN gives [`Interval::ENTIRE`].
    pub const fn point(x: f64) -> Self {
        if x.is_nan() {
            Self::ENTIRE
        } else {
            Self { lo: x, hi: x }
        }
    }

    /// The number itself, rounded in the decimal system, is within half a unit in the last place of `x`:
    /// the interval of `x` and its two neighbours.
    pub fn around(x: f64) -> Self {
        out(x, x, 1)
    }

    /// `hi - lo`, rounded up.
    pub fn width(self) -> f64 {
        (self.hi - self.lo).next_up().max(0.0)
    }

    /// A number inside, near the middle; finite when both ends are.
    pub fn mid(self) -> f64 {
        if self.lo == self.hi {
            return self.lo;
        }
        (0.5 * self.lo + 0.5 * self.hi).clamp(self.lo, self.hi)
    }

    /// The largest absolute value.
    pub fn mag(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// The smallest absolute value.
    pub fn mig(self) -> f64 {
        if self.contains(0.0) {
            0.0
        } else {
            self.lo.abs().min(self.hi.abs())
        }
    }

    /// True if `x` lies inside or on an end.
    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    /// True if `other` lies inside.
    pub fn encloses(self, other: Interval) -> bool {
        self.lo <= other.lo && other.hi <= self.hi
    }

    /// True if both ends are finite.
    pub fn is_finite(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    /// True if the interval is one number.
    pub fn is_point(self) -> bool {
        self.lo == self.hi
    }

    /// The smallest interval that contains both.
    pub fn hull(self, other: Interval) -> Self {
        Self {
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
        }
    }

    /// The common part of two enclosures of the same value. If rounding made them disjoint, the first is kept.
    pub fn meet(self, other: Interval) -> Self {
        let (lo, hi) = (self.lo.max(other.lo), self.hi.min(other.hi));
        if lo <= hi { Self { lo, hi } } else { self }
    }

    /// The common part, `None` if there is none.
    pub fn intersection(self, other: Interval) -> Option<Self> {
        let (lo, hi) = (self.lo.max(other.lo), self.hi.min(other.hi));
        (lo <= hi).then_some(Self { lo, hi })
    }

    /// Widened by `r >= 0` at both ends.
    pub fn inflate(self, r: f64) -> Self {
        out(self.lo - r, self.hi + r, 1)
    }

    /// `{|x|}`.
    pub fn abs(self) -> Self {
        Self {
            lo: self.mig(),
            hi: self.mag(),
        }
    }

    /// `{x²}`: tighter than the product of the interval with itself.
    pub fn sqr(self) -> Self {
        if self == Self::ZERO {
            return self;
        }
        let (a, b) = (self.mig(), self.mag());
        let r = out(a * a, b * b, 1);
        Self {
            lo: r.lo.max(0.0),
            hi: r.hi,
        }
    }

    /// `{xⁿ}` for an integer n.
    pub fn powi(self, n: i32) -> Self {
        if n < 0 {
            return Self::ONE / self.powi(-n);
        }
        let (mut base, mut n, mut acc) = (self, n as u32, Self::ONE);
        let even_sign = n % 2 == 0;
        while n > 0 {
            if n & 1 == 1 {
                acc = acc * base;
            }
            n >>= 1;
            if n > 0 {
                base = base.sqr();
            }
        }
        if even_sign {
            Self {
                lo: acc.lo.max(0.0),
                hi: acc.hi,
            }
        } else {
            acc
        }
    }

    /// `{√x}` over the part of the interval where it is defined; [`Interval::ENTIRE`] if there is none.
    pub fn sqrt(self) -> Self {
        if self.hi < 0.0 || self == Self::ENTIRE {
            return Self::ENTIRE;
        }
        if self == Self::ZERO || self == Self::ONE {
            return self;
        }
        let r = out(self.lo.max(0.0).sqrt(), self.hi.sqrt(), 1);
        Self {
            lo: r.lo.max(0.0),
            hi: r.hi,
        }
    }

    /// `{eˣ}`.
    pub fn exp(self) -> Self {
        if self == Self::ZERO {
            return Self::ONE;
        }
        let r = out(self.lo.exp(), self.hi.exp(), LIBM_ULPS);
        Self {
            lo: r.lo.max(0.0),
            hi: r.hi,
        }
    }

    /// `{ln x}` over the part where it is defined; [`Interval::ENTIRE`] if there is none.
    pub fn ln(self) -> Self {
        if self.hi <= 0.0 {
            return Self::ENTIRE;
        }
        if self == Self::ONE {
            return Self::ZERO;
        }
        out(self.lo.max(0.0).ln(), self.hi.ln(), LIBM_ULPS)
    }

    /// `{sin x}`.
    pub fn sin(self) -> Self {
        if self == Self::ZERO {
            return self;
        }
        // The sine increases up to ±π/2 = ±1.5707…; near 0 this keeps relative accuracy.
        if self.mag() <= 1.57 {
            return out(self.lo.sin(), self.hi.sin(), LIBM_ULPS);
        }
        (self - Self::half_pi()).cos()
    }

    /// `{cos x}`. Beyond 2⁴⁰ nothing better than `[-1, 1]` is said.
    pub fn cos(self) -> Self {
        if self == Self::ZERO {
            return Self::ONE;
        }
        const LIMIT: f64 = 1.0995e12;
        let full = Self { lo: -1.0, hi: 1.0 };
        if !self.is_finite() || self.mag() > LIMIT || self.width() >= TAU {
            return full;
        }
        // Which multiples of π lie inside? The quotient is widened, so an extremum is never missed.
        let turns = self / Self::pi();
        let (first, last) = (turns.lo.ceil() as i64, turns.hi.floor() as i64);
        let (a, b) = (self.lo.cos(), self.hi.cos());
        let mut r = out(a.min(b), a.max(b), LIBM_ULPS).meet(full);
        for k in first..=last {
            if k % 2 == 0 {
                r.hi = 1.0;
            } else {
                r.lo = -1.0;
            }
        }
        r
    }

    /// `{tan x}`; [`Interval::ENTIRE`] where a pole may lie inside.
    pub fn tan(self) -> Self {
        if self == Self::ZERO {
            return self;
        }
        if self.width() < PI && !self.cos().contains(0.0) {
            return out(self.lo.tan(), self.hi.tan(), LIBM_ULPS);
        }
        Self::ENTIRE
    }

    /// `{asin x}` over the part where it is defined; [`Interval::ENTIRE`] if there is none.
    pub fn asin(self) -> Self {
        if self == Self::ZERO {
            return self;
        }
        match self.intersection(Self { lo: -1.0, hi: 1.0 }) {
            Some(x) => out(x.lo.asin(), x.hi.asin(), LIBM_ULPS),
            None => Self::ENTIRE,
        }
    }

    /// `{acos x}` over the part where it is defined; [`Interval::ENTIRE`] if there is none.
    pub fn acos(self) -> Self {
        match self.intersection(Self { lo: -1.0, hi: 1.0 }) {
            Some(x) => out(x.hi.acos(), x.lo.acos(), LIBM_ULPS),
            None => Self::ENTIRE,
        }
    }

    /// `{atan x}`.
    pub fn atan(self) -> Self {
        if self == Self::ZERO {
            return self;
        }
        out(self.lo.atan(), self.hi.atan(), LIBM_ULPS)
    }

    /// `{sinh x}`.
    pub fn sinh(self) -> Self {
        if self == Self::ZERO {
            return self;
        }
        out(self.lo.sinh(), self.hi.sinh(), LIBM_ULPS)
    }

    /// `{cosh x}`.
    pub fn cosh(self) -> Self {
        if self == Self::ZERO {
            return Self::ONE;
        }
        let r = out(self.mig().cosh(), self.mag().cosh(), LIBM_ULPS);
        Self {
            lo: r.lo.max(1.0),
            hi: r.hi,
        }
    }

    /// `{tanh x}`.
    pub fn tanh(self) -> Self {
        if self == Self::ZERO {
            return self;
        }
        out(self.lo.tanh(), self.hi.tanh(), LIBM_ULPS).meet(Self { lo: -1.0, hi: 1.0 })
    }

    /// `{min(x, y)}`.
    pub fn min(self, o: Self) -> Self {
        Self {
            lo: self.lo.min(o.lo),
            hi: self.hi.min(o.hi),
        }
    }

    /// `{max(x, y)}`.
    pub fn max(self, o: Self) -> Self {
        Self {
            lo: self.lo.max(o.lo),
            hi: self.hi.max(o.hi),
        }
    }

    /// An enclosure of π.
    pub fn pi() -> Self {
        // The double nearest to π lies below it.
        Self {
            lo: PI,
            hi: PI.next_up(),
        }
    }

    fn half_pi() -> Self {
        Self {
            lo: FRAC_PI_2,
            hi: FRAC_PI_2.next_up(),
        }
    }
}

/// The greater of two numbers; NaN if one is none, which [`f64::max`] would lose.
#[inline(always)]
pub(crate) fn greater(a: f64, b: f64) -> f64 {
    if a.is_nan() || b <= a { a } else { b }
}

/// `[lo, hi]` with both ends moved at least `ulps` steps outwards; the whole line if an end is not a number.
///
/// A step without branches is `x ± (φ|x| + η)` with `φ = u (1 + 2u)`, u half a unit in the last place of 1, and η the
/// smallest positive number: it is the neighbour of x, or for tiny x the one after it. Source: Rump, Zimmermann, Boldo,
/// Melquiond, *Computing predecessor and successor in rounding to nearest*, BIT 49 (2009).
#[inline]
fn out(mut lo: f64, mut hi: f64, ulps: u32) -> Interval {
    const PHI: f64 = 0.5 * f64::EPSILON * (1.0 + f64::EPSILON);
    const ETA: f64 = f64::from_bits(1);
    for _ in 0..ulps {
        lo -= lo.abs() * PHI + ETA;
        hi += hi.abs() * PHI + ETA;
    }
    // Also where the lower end is +∞ or the upper end -∞, which no enclosure of numbers has.
    if lo.is_nan() || hi.is_nan() {
        return Interval::ENTIRE;
    }
    Interval { lo, hi }
}

/// The range of four products or quotients, rounded outwards. Their sum is not a number if one of them is none, or if
/// they reach from -∞ to ∞.
#[inline]
fn range(p: [f64; 4]) -> Interval {
    if (p[0] + p[1] + p[2] + p[3]).is_nan() {
        return Interval::ENTIRE;
    }
    // Unlike `f64::min`, these are one instruction each.
    let least = |a: f64, b: f64| if a < b { a } else { b };
    let most = |a: f64, b: f64| if a > b { a } else { b };
    out(
        least(least(p[0], p[1]), least(p[2], p[3])),
        most(most(p[0], p[1]), most(p[2], p[3])),
        1,
    )
}

impl From<f64> for Interval {
    fn from(x: f64) -> Self {
        Self::point(x)
    }
}

impl Neg for Interval {
    type Output = Interval;
    fn neg(self) -> Interval {
        Interval {
            lo: -self.hi,
            hi: -self.lo,
        }
    }
}

// Exact zeros and ones stay exact: a plane in a model is then proven to be one.

impl Add for Interval {
    type Output = Interval;
    fn add(self, o: Interval) -> Interval {
        if self == Interval::ZERO {
            return o;
        }
        if o == Interval::ZERO {
            return self;
        }
        out(self.lo + o.lo, self.hi + o.hi, 1)
    }
}

impl Sub for Interval {
    type Output = Interval;
    fn sub(self, o: Interval) -> Interval {
        if o == Interval::ZERO {
            return self;
        }
        if self.is_point() && self == o {
            return Interval::ZERO;
        }
        out(self.lo - o.hi, self.hi - o.lo, 1)
    }
}

impl Mul for Interval {
    type Output = Interval;
    fn mul(self, o: Interval) -> Interval {
        if self == Interval::ZERO || o == Interval::ZERO {
            return Interval::ZERO;
        }
        if self == Interval::ONE {
            return o;
        }
        if o == Interval::ONE {
            return self;
        }
        range([
            self.lo * o.lo,
            self.lo * o.hi,
            self.hi * o.lo,
            self.hi * o.hi,
        ])
    }
}

impl Div for Interval {
    type Output = Interval;
    fn div(self, o: Interval) -> Interval {
        if o.contains(0.0) {
            return Interval::ENTIRE;
        }
        if o == Interval::ONE || self == Interval::ZERO {
            return self;
        }
        range([
            self.lo / o.lo,
            self.lo / o.hi,
            self.hi / o.lo,
            self.hi / o.hi,
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn any_interval() -> impl Strategy<Value = (Interval, f64)> {
        (-20.0f64..20.0, 0.0f64..8.0, 0.0f64..=1.0).prop_map(|(lo, w, s)| {
            let i = Interval::new(lo, lo + w);
            (i, (lo + w * s).clamp(i.lo, i.hi))
        })
    }

    proptest! {
        #[test]
        fn results_contain_the_results_of_members((a, x) in any_interval(), (b, y) in any_interval()) {
            prop_assert!((a + b).contains(x + y));
            prop_assert!((a - b).contains(x - y));
            prop_assert!((a * b).contains(x * y));
            if y != 0.0 { prop_assert!((a / b).contains(x / y)); }
            prop_assert!(a.sin().contains(x.sin()) && a.cos().contains(x.cos()));
            prop_assert!(a.exp().contains(x.exp()) && a.atan().contains(x.atan()));
            prop_assert!(a.sqr().contains(x * x) && a.powi(3).contains(x * x * x) && a.powi(4).contains(x.powi(4)));
            prop_assert!(a.sinh().contains(x.sinh()) && a.cosh().contains(x.cosh()) && a.tanh().contains(x.tanh()));
            prop_assert!(a.tan().contains(x.tan()) && a.abs().contains(x.abs()));
            prop_assert!(a.min(b).contains(x.min(y)) && a.max(b).contains(x.max(y)));
            if x > 0.0 { prop_assert!(a.ln().contains(x.ln()) && a.sqrt().contains(x.sqrt())); }
            let (s, t) = (x / 30.0, a * Interval::point(1.0) / Interval::point(30.0));
            prop_assert!(t.asin().contains(s.asin()) && t.acos().contains(s.acos()));
        }
    }

    #[test]
    fn one_step_outwards_reaches_the_neighbours() {
        let largest = [f64::MAX, f64::INFINITY];
        let tiny = [0.0, f64::from_bits(1), f64::from_bits(7), f64::MIN_POSITIVE];
        let powers = (-1022..1023).flat_map(|k| {
            let x = 2f64.powi(k);
            [x.next_down(), x, x.next_up(), 1.5 * x, 1.9 * x]
        });
        for x in powers.chain(tiny).chain(largest).flat_map(|x| [x, -x]) {
            let r = Interval::around(x);
            assert!(r.lo <= x.next_down() && x.next_up() <= r.hi, "{x:e} {r:?}");
            if x.abs() > 1e-290 && x.is_finite() {
                assert_eq!(
                    r,
                    Interval {
                        lo: x.next_down(),
                        hi: x.next_up()
                    },
                    "{x:e}"
                );
            }
        }
    }

    #[test]
    fn cosine_finds_its_extrema() {
        assert_eq!(Interval::new(-0.5, 0.5).cos().hi, 1.0);
        assert_eq!(Interval::new(3.0, 3.3).cos().lo, -1.0);
        assert_eq!(Interval::new(0.0, 7.0).cos(), Interval::new(-1.0, 1.0));
        let narrow = Interval::new(1.0, 1.1).sin();
        assert!(narrow.lo > 0.84 && narrow.hi < 0.892);
    }

    #[test]
    fn what_cannot_be_said_is_entire() {
        assert_eq!(Interval::ONE / Interval::new(-1.0, 1.0), Interval::ENTIRE);
        assert_eq!(Interval::new(-2.0, -1.0).sqrt(), Interval::ENTIRE);
        assert_eq!(Interval::ENTIRE - Interval::ENTIRE, Interval::ENTIRE);
        assert_eq!(Interval::point(f64::NAN), Interval::ENTIRE);
        assert_eq!(Interval::ENTIRE * Interval::ZERO, Interval::ZERO);
    }
}
