//! Truncated power series: the arithmetic of derivatives of any order, without finite differences and without symbols.
//!
//! A series holds Taylor coefficients `c[k] = f⁽ᵏ⁾(t)/k!`. Sums, products and quotients of series are the Taylor
//! coefficients of sums, products and quotients of functions, so formulas are differentiated by evaluating them.
//! Over [`Interval`](crate::Interval) the coefficients enclose those of every point of the interval.
//!
//! Cost: linear in the length for sums, quadratic for products and the elementary functions.

use crate::scalar::Number;
use smallvec::SmallVec;

/// Taylor coefficients of a one-variable function, order 0 first.
#[derive(Debug, PartialEq)]
pub struct Series<S: Number> {
    /// `c[k] = f⁽ᵏ⁾/k!`.
    pub c: SmallVec<S::Few>,
}

impl<S: Number> Clone for Series<S> {
    fn clone(&self) -> Self {
        Self {
            c: SmallVec::from_slice(&self.c),
        }
    }
}

impl<S: Number> Series<S> {
    /// The constant `x` to the given order.
    pub fn constant(x: S, order: usize) -> Self {
        let mut c = SmallVec::from_elem(S::ZERO, order + 1);
        c[0] = x;
        Self { c }
    }

    /// The variable itself, at `t`.
    pub fn variable(t: S, order: usize) -> Self {
        let mut s = Self::constant(t, order);
        if order > 0 {
            s.c[1] = S::ONE;
        }
        s
    }

    /// From derivatives `d[k] = f⁽ᵏ⁾`.
    pub fn from_derivatives(d: &[S]) -> Self {
        let mut factorial = 1.0;
        let c = d
            .iter()
            .enumerate()
            .map(|(k, &x)| {
                factorial *= k.max(1) as f64;
                if k < 2 { x } else { x / S::from(factorial) }
            })
            .collect();
        Self { c }
    }

    /// Writes the derivatives `f⁽ᵏ⁾ = k! c[k]`.
    pub fn write_derivatives(&self, out: &mut [S]) {
        let mut factorial = 1.0;
        for (k, o) in out.iter_mut().enumerate() {
            factorial *= k.max(1) as f64;
            *o = if k < 2 {
                self.c[k]
            } else {
                self.c[k] * S::from(factorial)
            };
        }
    }

    /// The highest order held.
    pub fn order(&self) -> usize {
        self.c.len() - 1
    }

    /// The value.
    pub fn value(&self) -> S {
        self.c[0]
    }

    /// Every coefficient by `f`, of the first `n`.
    fn each(&self, n: usize, f: impl Fn(usize, S) -> S) -> Self {
        let mut c = SmallVec::from_slice(&self.c[..n]);
        for (k, x) in c.iter_mut().enumerate() {
            *x = f(k, *x);
        }
        Self { c }
    }

    /// `-f`.
    pub fn neg(&self) -> Self {
        self.each(self.c.len(), |_, a| -a)
    }

    /// `f + g`.
    pub fn add(&self, o: &Self) -> Self {
        self.each(self.c.len().min(o.c.len()), |k, a| a + o.c[k])
    }

    /// `f - g`.
    pub fn sub(&self, o: &Self) -> Self {
        self.each(self.c.len().min(o.c.len()), |k, a| a - o.c[k])
    }

    /// `f · x` for a number x.
    pub fn scale(&self, x: S) -> Self {
        self.each(self.c.len(), |_, a| a * x)
    }

    /// `f · g`.
    pub fn mul(&self, o: &Self) -> Self {
        self.each(self.c.len().min(o.c.len()), |k, _| {
            (0..=k).fold(S::ZERO, |acc, j| acc + self.c[j] * o.c[k - j])
        })
    }

    /// `f²`, with the square's tighter enclosure of the value.
    pub fn sqr(&self) -> Self {
        let mut r = self.mul(self);
        r.c[0] = self.c[0].sqr();
        r
    }

    /// `f / g`.
    pub fn div(&self, o: &Self) -> Self {
        let mut c: SmallVec<S::Few> = SmallVec::with_capacity(self.c.len());
        for k in 0..self.c.len() {
            let s = (1..=k).fold(self.c[k], |acc, j| acc - o.c[j] * c[k - j]);
            c.push(s / o.c[0]);
        }
        Self { c }
    }

    /// `√f`.
    pub fn sqrt(&self) -> Self {
        let mut c: SmallVec<S::Few> = SmallVec::with_capacity(self.c.len());
        c.push(self.c[0].sqrt());
        for k in 1..self.c.len() {
            let s = (1..k).fold(self.c[k], |acc, j| acc - c[j] * c[k - j]);
            c.push(s / (c[0] + c[0]));
        }
        Self { c }
    }

    /// `sin f` and `cos f`.
    pub fn sin_cos(&self) -> (Self, Self) {
        let n = self.c.len();
        let mut s: SmallVec<S::Few> = SmallVec::with_capacity(n);
        let mut c: SmallVec<S::Few> = SmallVec::with_capacity(n);
        s.push(self.c[0].sin());
        c.push(self.c[0].cos());
        for k in 1..n {
            let (mut a, mut b) = (S::ZERO, S::ZERO);
            for j in 1..=k {
                let d = self.c[j] * S::from(j as f64);
                a = a + d * c[k - j];
                b = b + d * s[k - j];
            }
            let k = S::from(k as f64);
            s.push(a / k);
            c.push(-(b / k));
        }
        (Self { c: s }, Self { c })
    }

    /// `exp f`.
    pub fn exp(&self) -> Self {
        let mut c: SmallVec<S::Few> = SmallVec::with_capacity(self.c.len());
        c.push(self.c[0].exp());
        for k in 1..self.c.len() {
            let s = (1..=k).fold(S::ZERO, |acc, j| {
                acc + self.c[j] * S::from(j as f64) * c[k - j]
            });
            c.push(s / S::from(k as f64));
        }
        Self { c }
    }

    /// `ln f`.
    pub fn ln(&self) -> Self {
        self.integrate_quotient(self.c[0].ln(), self)
    }

    /// `atan f`.
    pub fn atan(&self) -> Self {
        let one = Self::constant(S::ONE, self.order());
        self.integrate_quotient(self.c[0].atan(), &one.add(&self.sqr()))
    }

    /// `asin f`.
    pub fn asin(&self) -> Self {
        let one = Self::constant(S::ONE, self.order());
        self.integrate_quotient(self.c[0].asin(), &one.sub(&self.sqr()).sqrt())
    }

    /// `acos f`.
    pub fn acos(&self) -> Self {
        let mut r = self.asin().neg();
        r.c[0] = self.c[0].acos();
        r
    }

    /// `tan f`, from `(tan f)' = (1 + tan² f) f' = f' / cos² f`.
    pub fn tan(&self) -> Self {
        // Over a pole that quotient is everything; 1 + tan² would be positive.
        self.tangent(self.c[0].tan(), S::ONE, S::ONE / self.c[0].cos().sqr())
    }

    /// `tanh f`, from `(tanh f)' = (1 - tanh² f) f'`: no overflow, unlike the quotient of sinh and cosh.
    pub fn tanh(&self) -> Self {
        let value = self.c[0].tanh();
        self.tangent(value, -S::ONE, S::ONE - value.sqr())
    }

    /// The series y with the given value and `y' = (1 + sign y²) f'`, of which the value of the factor is given too.
    fn tangent(&self, value: S, sign: S, slope: S) -> Self {
        let n = self.c.len();
        let mut c: SmallVec<S::Few> = SmallVec::with_capacity(n);
        c.push(value);
        for k in 1..n {
            let mut sum = S::ZERO;
            for j in 1..=k {
                // The coefficient of order k - j of 1 + sign y².
                let m = k - j;
                let y2 = (0..=m).fold(S::ZERO, |acc, i| acc + c[i] * c[m - i]);
                let g = if m == 0 { slope } else { sign * y2 };
                sum = sum + S::from(j as f64) * self.c[j] * g;
            }
            c.push(sum / S::from(k as f64));
        }
        Self { c }
    }

    /// `sinh f` and `cosh f`.
    pub fn sinh_cosh(&self) -> (Self, Self) {
        let n = self.c.len();
        let mut s: SmallVec<S::Few> = SmallVec::with_capacity(n);
        let mut c: SmallVec<S::Few> = SmallVec::with_capacity(n);
        s.push(self.c[0].sinh());
        c.push(self.c[0].cosh());
        for k in 1..n {
            let (mut a, mut b) = (S::ZERO, S::ZERO);
            for j in 1..=k {
                let d = self.c[j] * S::from(j as f64);
                a = a + d * c[k - j];
                b = b + d * s[k - j];
            }
            let k = S::from(k as f64);
            s.push(a / k);
            c.push(b / k);
        }
        (Self { c: s }, Self { c })
    }

    /// The angle of the point `(x, self)`, whose value the caller gives: its derivative `(x y' - y x')/(x² + y²)` is
    /// the same on every branch.
    pub fn atan2(&self, x: &Self, value: S) -> Self {
        let mut c: SmallVec<S::Few> = SmallVec::with_capacity(self.c.len());
        c.push(value);
        if self.order() > 0 {
            let r2 = x.sqr().add(&self.sqr());
            let turn = x.mul(&self.derivative()).sub(&self.mul(&x.derivative()));
            let slope = turn.div(&r2);
            c.extend((1..self.c.len()).map(|k| slope.c[k - 1] / S::from(k as f64)));
        }
        Self { c }
    }

    /// The series with the given value and derivative `f' / g`: how the inverse functions are built.
    fn integrate_quotient(&self, value: S, g: &Self) -> Self {
        let n = self.c.len();
        let mut c: SmallVec<S::Few> = SmallVec::with_capacity(n);
        c.push(value);
        for k in 1..n {
            // k c_k g_0 = k f_k - Σ_{j=1}^{k-1} j c_j g_{k-j}
            let s = (1..k).fold(self.c[k] * S::from(k as f64), |acc, j| {
                acc - S::from(j as f64) * c[j] * g.c[k - j]
            });
            c.push(s / (g.c[0] * S::from(k as f64)));
        }
        Self { c }
    }

    /// `fⁿ` for an integer n, exact also where f = 0.
    pub fn powi(&self, n: i32) -> Self {
        if n < 0 {
            return Self::constant(S::ONE, self.order()).div(&self.powi(-n));
        }
        let (mut base, mut n, mut acc) =
            (self.clone(), n as u32, Self::constant(S::ONE, self.order()));
        while n > 0 {
            if n & 1 == 1 {
                acc = acc.mul(&base);
            }
            n >>= 1;
            if n > 0 {
                base = base.sqr();
            }
        }
        acc
    }

    /// The series of the derivative, one order shorter.
    pub fn derivative(&self) -> Self {
        Self {
            c: self
                .c
                .iter()
                .enumerate()
                .skip(1)
                .map(|(k, &x)| x * S::from(k as f64))
                .collect(),
        }
    }
}

/// The dot product of two vectors of series.
pub fn series_dot<S: Number>(a: &[Series<S>; 3], b: &[Series<S>; 3]) -> Series<S> {
    a[0].mul(&b[0]).add(&a[1].mul(&b[1])).add(&a[2].mul(&b[2]))
}

/// The cross product of two vectors of series.
pub fn series_cross<S: Number>(a: &[Series<S>; 3], b: &[Series<S>; 3]) -> [Series<S>; 3] {
    let d = |i: usize, j: usize| a[i].mul(&b[j]).sub(&a[j].mul(&b[i]));
    [d(1, 2), d(2, 0), d(0, 1)]
}

/// The square of each coordinate summed: `|a|²`.
pub fn series_norm2<S: Number>(a: &[Series<S>; 3]) -> Series<S> {
    a[0].sqr().add(&a[1].sqr()).add(&a[2].sqr())
}

/// `n!/(k!(n-k)!)` as a double.
pub fn binomial(n: usize, k: usize) -> f64 {
    (0..k.min(n - k)).fold(1.0, |acc, i| acc * (n - i) as f64 / (i + 1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Derivatives of tan at t through sin/cos, against the closed forms.
    #[test]
    fn quotient_of_sine_and_cosine_is_the_tangent() {
        let t = 0.7f64;
        let (s, c) = Series::variable(t, 3).sin_cos();
        let q = s.div(&c);
        let (tan, sec2) = (t.tan(), 1.0 / t.cos().powi(2));
        let mut d = [0.0; 4];
        q.write_derivatives(&mut d);
        for (got, want) in d.iter().zip([
            tan,
            sec2,
            2.0 * sec2 * tan,
            2.0 * sec2 * (sec2 + 2.0 * tan * tan),
        ]) {
            assert!(
                (got - want).abs() < 1e-13 * want.abs().max(1.0),
                "{got} {want}"
            );
        }
    }

    #[test]
    fn inverse_pairs_give_the_identity() {
        let x = Series::variable(0.3f64, 7);
        for y in [
            x.exp().ln(),
            x.sqr().sqrt(),
            x.asin().sin_cos().0,
            x.acos().sin_cos().1,
            {
                let (s, c) = x.atan().sin_cos();
                s.div(&c)
            },
        ] {
            for k in 0..8 {
                assert!((y.c[k] - x.c[k]).abs() < 1e-12, "{k}: {:?}", y.c);
            }
        }
        assert_eq!(binomial(10, 3), 120.0);
    }

    #[test]
    fn hyperbolic_and_angle_series_obey_their_identities() {
        let x = Series::variable(0.4f64, 7);
        let (sh, ch) = x.sinh_cosh();
        let one = ch.sqr().sub(&sh.sqr());
        let (tanh, quotient) = (x.tanh(), sh.div(&ch));
        let (s, c) = x.sin_cos();
        let (tan, ratio) = (x.tan(), s.div(&c));
        let angle = s.atan2(&c, 0.4);
        for k in 0..8 {
            let unit = if k == 0 { 1.0 } else { 0.0 };
            assert!((one.c[k] - unit).abs() < 1e-14, "cosh² - sinh², {k}");
            assert!((tanh.c[k] - quotient.c[k]).abs() < 1e-14, "tanh, {k}");
            assert!((tan.c[k] - ratio.c[k]).abs() < 1e-13, "tan, {k}");
            assert!((angle.c[k] - x.c[k]).abs() < 1e-14, "atan2, {k}");
        }
    }
}
