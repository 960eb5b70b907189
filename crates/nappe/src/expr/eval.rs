//! Evaluation, written once for numbers and enclosures.

use super::error::{EvalError, Fault, FaultKind};
use super::{Bound, Cmp, Func, Meaning, Number, Op};
use crate::interval::Interval;
use crate::series::Series;

/// What a switch did in a run.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) enum Outcome {
    /// The value does not depend on it (it was not reached).
    #[default]
    Free,
    /// One formula holds throughout; the number says which.
    Known(f64),
    /// Both sides may occur.
    Open,
}

/// One evaluation.
pub(super) struct Run<'a, S: Number> {
    bound: &'a Bound,
    variables: &'a [Series<S>],
    order: usize,
    /// For each switch, the formula that holds in a piece, whatever the value.
    forced: Option<&'a [Option<f64>]>,
    /// For each switch, what happened.
    pub(super) outcomes: Vec<Outcome>,
    /// The first part that may have no value somewhere in the range; it has one at some places.
    pub(super) doubt: Option<Fault>,
}

type Value<S> = Result<Series<S>, Fault>;

impl<'a, S: Number> Run<'a, S> {
    pub(super) fn new(
        bound: &'a Bound,
        variables: &'a [Series<S>],
        order: usize,
        forced: Option<&'a [Option<f64>]>,
    ) -> Self {
        Self {
            bound,
            variables,
            order,
            forced,
            outcomes: vec![Outcome::Free; bound.switches],
            doubt: None,
        }
    }

    /// The value of the whole, or the part that has none anywhere in the range.
    pub(super) fn result(&mut self) -> Value<S> {
        self.node((self.bound.expr.nodes.len() - 1) as u32)
    }

    fn constant(&self, x: S) -> Series<S> {
        Series::constant(x, self.order)
    }

    fn fault(&self, node: u32, kind: FaultKind) -> Fault {
        Fault {
            span: self.bound.expr.nodes[node as usize].span.clone(),
            kind,
        }
    }

    /// Something that cannot be (`never`) or may not be (otherwise).
    fn object(&mut self, node: u32, never: bool, kind: FaultKind) -> Result<(), Fault> {
        let fault = self.fault(node, kind);
        if never {
            return Err(fault);
        }
        self.doubt.get_or_insert(fault);
        Ok(())
    }

    /// A value whose derivative is infinite, if its argument moves: certain only for numbers.
    fn no_derivative(&mut self, node: u32, certain: bool) -> Result<(), Fault> {
        let never = certain && self.is_number();
        self.object(node, never, FaultKind::NoDerivative)
    }

    /// The formula that holds at a switch: that of the piece, or what the values say.
    fn decide(&mut self, node: u32, by_value: Option<f64>) -> Option<f64> {
        let Some(i) = self.bound.switch[node as usize] else {
            return by_value;
        };
        if let Some(x) = self.forced.and_then(|f| f[i as usize]) {
            return Some(x);
        }
        self.outcomes[i as usize] = by_value.map_or(Outcome::Open, Outcome::Known);
        by_value
    }

    /// Everything that either formula may give, if the two meet where they switch (`continuous`) or jump.
    /// Beyond a switch the second derivative (the first, at a jump) is not that of either formula.
    fn either(&self, a: &Series<S>, b: &Series<S>, continuous: bool) -> Series<S> {
        let bounded = if continuous { 2 } else { 1 };
        let c = (0..=self.order).map(|k| {
            let (x, y) = (a.c[k], b.c[k]);
            if k < bounded {
                x.hull(y)
            } else {
                S::from_range(Interval::ENTIRE)
            }
        });
        Series { c: c.collect() }
    }

    fn node(&mut self, at: u32) -> Value<S> {
        let node = &self.bound.expr.nodes[at as usize];
        let [a, b, c] = node.args;
        let r = match node.op {
            Op::Number(x) => return Ok(self.constant(S::from(x))),
            Op::Name(i) => {
                return Ok(match self.bound.meanings[i as usize] {
                    Meaning::Variable(k) => self.variables[k].clone(),
                    Meaning::Value(x) => self.constant(S::from(x)),
                    Meaning::Pi => self.constant(S::pi()),
                    Meaning::Tau => self.constant(S::pi() + S::pi()),
                    Meaning::E => self.constant(S::euler()),
                });
            }
            Op::If => return self.choose(at, a, b, c),
            Op::Neg => self.node(a)?.neg(),
            Op::Add => self.node(a)?.add(&self.node(b)?),
            Op::Sub => self.node(a)?.sub(&self.node(b)?),
            Op::Mul if self.same(a, b) => self.node(a)?.sqr(),
            Op::Mul => self.node(a)?.mul(&self.node(b)?),
            Op::Div => {
                let (x, y) = (self.node(a)?, self.node(b)?);
                self.divide(at, &x, &y)?
            }
            Op::Pow => self.power(at, a, b)?,
            Op::Compare(cmp) => {
                let (x, y) = (self.node(a)?.value().range(), self.node(b)?.value().range());
                self.compare(at, cmp, x, y)
            }
            Op::Call(f) => {
                let x = self.node(a)?;
                self.call(at, f, x, b)?
            }
        };
        let range = r.value().range();
        if !range.is_finite() {
            let never = range.is_point() || range == Interval::ENTIRE && self.is_number();
            self.object(at, never, FaultKind::Overflow)?;
        }
        Ok(r)
    }

    /// True for `f64`, whose ranges are points; a NaN has the range of everything.
    fn is_number(&self) -> bool {
        S::from_range(Interval::UNIT).range().is_point()
    }

    /// True if both nodes are the same name: `t*t` is a square.
    fn same(&self, a: u32, b: u32) -> bool {
        let op = |i: u32| self.bound.expr.nodes[i as usize].op;
        matches!(op(a), Op::Name(_)) && op(a) == op(b)
    }

    fn choose(&mut self, at: u32, c: u32, a: u32, b: u32) -> Value<S> {
        let cond = self.node(c)?.value().range();
        let by_value = if cond == Interval::ZERO {
            Some(0.0)
        } else if cond.contains(0.0) {
            None
        } else {
            Some(1.0)
        };
        match self.decide(at, by_value) {
            Some(x) => self.node(if x == 0.0 { b } else { a }),
            None => match (self.node(a), self.node(b)) {
                (Ok(x), Ok(y)) => Ok(self.either(&x, &y, false)),
                // One branch has no value anywhere: it may be the one that is never taken.
                (Ok(x), Err(fault)) | (Err(fault), Ok(x)) => {
                    self.doubt.get_or_insert(fault);
                    let all = self.constant(S::from_range(Interval::ENTIRE));
                    Ok(self.either(&x, &all, false))
                }
                (Err(fault), Err(_)) => Err(fault),
            },
        }
    }

    fn compare(&mut self, at: u32, cmp: Cmp, x: Interval, y: Interval) -> Series<S> {
        let less = |x: Interval, y: Interval| {
            if x.hi < y.lo {
                Some(true)
            } else if x.lo >= y.hi {
                Some(false)
            } else {
                None
            }
        };
        let equal = || {
            if x.is_point() && x == y {
                Some(true)
            } else if x.intersection(y).is_none() {
                Some(false)
            } else {
                None
            }
        };
        let truth = match cmp {
            Cmp::Less => less(x, y),
            Cmp::Greater => less(y, x),
            Cmp::LessEqual => less(y, x).map(|t| !t),
            Cmp::GreaterEqual => less(x, y).map(|t| !t),
            Cmp::Equal => equal(),
            Cmp::NotEqual => equal().map(|t| !t),
        };
        match self.decide(at, truth.map(|t| if t { 1.0 } else { 0.0 })) {
            Some(x) => self.constant(S::from(x)),
            None => self.either(&self.constant(S::ZERO), &self.constant(S::ONE), false),
        }
    }

    fn divide(&mut self, at: u32, x: &Series<S>, y: &Series<S>) -> Value<S> {
        let d = y.value().range();
        if d.contains(0.0) {
            self.object(
                at,
                d == Interval::ZERO,
                FaultKind::DivisionByZero(x.value().mid()),
            )?;
        }
        Ok(x.div(y))
    }

    fn power(&mut self, at: u32, a: u32, b: u32) -> Value<S> {
        let x = self.node(a)?;
        let base = x.value().range();
        if let Some(n) = self.bound.integer[at as usize] {
            if n < 0 && base.contains(0.0) {
                self.object(at, base == Interval::ZERO, FaultKind::DivisionByZero(1.0))?;
            }
            let mut r = x.powi(n);
            // The value's own power is tighter than repeated products, and for f64 more accurate.
            r.c[0] = x.value().powi(n);
            return Ok(r);
        }
        let y = self.node(b)?;
        let exponent = y.value().range();
        if base.lo < 0.0 {
            let kind = FaultKind::PowerOfNegative(base.lo, exponent.mid());
            self.object(at, base.hi < 0.0, kind)?;
        }
        let zero = base.lo <= 0.0;
        if self.bound.constant[b as usize] {
            if zero && exponent.lo <= 0.0 {
                self.object(
                    at,
                    base == Interval::ZERO && exponent.hi <= 0.0,
                    FaultKind::DivisionByZero(1.0),
                )?;
            }
            if zero && self.order > 0 && exponent.lo < 1.0 && !self.bound.constant[a as usize] {
                self.no_derivative(at, base == Interval::ZERO)?;
            }
            return Ok(real_power(&x, y.value(), self.order));
        }
        if zero {
            self.object(at, base.hi <= 0.0, FaultKind::LogOfNonPositive(base.lo))?;
        }
        Ok(y.mul(&x.ln()).exp())
    }

    fn call(&mut self, at: u32, f: Func, x: Series<S>, second: u32) -> Value<S> {
        let range = x.value().range();
        Ok(match f {
            Func::Sqrt => {
                if range.lo < 0.0 {
                    self.object(at, range.hi < 0.0, FaultKind::RootOfNegative(range.lo))?;
                }
                if x.c.iter().all(|c| c.is_zero()) {
                    return Ok(x);
                }
                if range.lo <= 0.0 && self.order > 0 {
                    self.no_derivative(at, range == Interval::ZERO)?;
                }
                x.sqrt()
            }
            Func::Exp => x.exp(),
            Func::Ln => {
                if range.lo <= 0.0 {
                    self.object(at, range.hi <= 0.0, FaultKind::LogOfNonPositive(range.lo))?;
                }
                x.ln()
            }
            Func::Sin => x.sin_cos().0,
            Func::Cos => x.sin_cos().1,
            Func::Tan => {
                let r = x.tan();
                if r.value().range() == Interval::ENTIRE {
                    self.object(at, range.is_point(), FaultKind::Pole(range.mid()))?;
                }
                r
            }
            Func::Asin | Func::Acos => {
                if range.mag() > 1.0 {
                    let worst = if range.hi > 1.0 { range.hi } else { range.lo };
                    self.object(at, range.mig() > 1.0, FaultKind::ArcOutOfRange(worst))?;
                }
                if range.mag() >= 1.0 && self.order > 0 && x.c[1..].iter().any(|c| !c.is_zero()) {
                    self.no_derivative(at, range.mig() >= 1.0)?;
                }
                if f == Func::Asin { x.asin() } else { x.acos() }
            }
            Func::Atan => x.atan(),
            Func::Sinh => x.sinh_cosh().0,
            Func::Cosh => x.sinh_cosh().1,
            Func::Tanh => x.tanh(),
            Func::Abs => match self.decide(at, sign(range)) {
                Some(s) if s >= 0.0 => x,
                Some(_) => x.neg(),
                None => {
                    let mut r = self.either(&x, &x.neg(), true);
                    r.c[0] = S::from_range(range.abs());
                    r
                }
            },
            Func::Min | Func::Max => {
                let y = self.node(second)?;
                let other = y.value().range();
                // The sign of first - second, from the ranges: no rounding enters the decision.
                let order = if range.lo >= other.hi {
                    Some(1.0)
                } else if range.hi <= other.lo {
                    Some(-1.0)
                } else {
                    None
                };
                match self.decide(at, order) {
                    Some(s) if (s > 0.0) == (f == Func::Max) => x,
                    Some(_) => y,
                    None => {
                        let mut r = self.either(&x, &y, true);
                        let value = if f == Func::Max {
                            range.max(other)
                        } else {
                            range.min(other)
                        };
                        r.c[0] = S::from_range(value);
                        r
                    }
                }
            }
            Func::Floor | Func::Ceil => {
                let round = if f == Func::Floor {
                    f64::floor
                } else {
                    f64::ceil
                };
                let (lo, hi) = (round(range.lo), round(range.hi));
                match self.decide(at, (lo == hi).then_some(lo)) {
                    Some(level) => self.constant(S::from(level)),
                    None => self.either(
                        &self.constant(S::from(lo)),
                        &self.constant(S::from(hi)),
                        false,
                    ),
                }
            }
            Func::Atan2 => {
                let cos = self.node(second)?;
                self.angle(at, &x, &cos)?
            }
        })
    }

    /// `atan2(y, x)`, which jumps by one turn where y changes sign left of the origin.
    fn angle(&mut self, at: u32, y: &Series<S>, x: &Series<S>) -> Value<S> {
        let (ry, rx) = (y.value().range(), x.value().range());
        if ry.contains(0.0) && rx.contains(0.0) {
            self.object(
                at,
                ry == Interval::ZERO && rx == Interval::ZERO,
                FaultKind::NoDirection,
            )?;
        }
        let mut r = y.atan2(x, S::atan2(y.value(), x.value()));
        if rx.hi >= 0.0 {
            if rx.lo <= 0.0 && ry.contains(0.0) {
                // The jump may lie inside.
                self.decide(at, None);
                for c in &mut r.c[1..] {
                    *c = S::from_range(Interval::ENTIRE);
                }
            }
            return Ok(r);
        }
        match self.decide(at, sign(ry)) {
            Some(s) => {
                let half = if s >= 0.0 { S::pi() } else { -S::pi() };
                r.c[0] = half + (y.value() / x.value()).atan();
                // Where y reaches 0 from below the angle is that of the other side, unless a piece ends there.
                if s < 0.0 && ry.hi >= 0.0 && self.forced.is_none() {
                    r.c[0] = r.c[0].hull(S::pi());
                    for c in &mut r.c[1..] {
                        *c = S::from_range(Interval::ENTIRE);
                    }
                }
            }
            None => {
                for c in &mut r.c[1..] {
                    *c = S::from_range(Interval::ENTIRE);
                }
            }
        }
        Ok(r)
    }
}

/// 1 if no number is negative, -1 if none is positive.
fn sign(x: Interval) -> Option<f64> {
    if x.lo >= 0.0 {
        Some(1.0)
    } else if x.hi <= 0.0 {
        Some(-1.0)
    } else {
        None
    }
}

/// `xᵇ` for a number b and x ≥ 0, from `(xᵇ)' = b xᵇ⁻¹ x'`: also where x = 0, for the orders that are finite there.
fn real_power<S: Number>(x: &Series<S>, b: S, order: usize) -> Series<S> {
    let range = x.value().range();
    let value = if b.is_zero() {
        S::ONE
    } else if range.lo > 0.0 {
        (b * x.value().ln()).exp()
    } else if b.range().lo > 0.0 {
        let top = (b.range() * Interval::point(range.hi.max(0.0)).ln()).exp();
        let top = if range.hi <= 0.0 { 0.0 } else { top.hi };
        S::from_range(Interval { lo: 0.0, hi: top })
    } else {
        S::from_range(Interval::ENTIRE)
    };
    if x.c[1..].iter().all(|c| c.is_zero()) {
        return Series::constant(value, order);
    }
    let mut c = smallvec::smallvec![value];
    if order > 0 {
        // A zero base is one number for f64; what is not finite there is infinite.
        let below = if range == Interval::ZERO && b.range().hi < 1.0 {
            Series::constant(S::from(f64::INFINITY), order - 1)
        } else {
            real_power(x, b - S::ONE, order - 1)
        };
        let slope = below.mul(&x.derivative()).scale(b);
        c.extend((1..=order).map(|k| slope.c[k - 1] / S::from(k as f64)));
    }
    Series { c }
}

impl Bound {
    /// The value for the given variables (in the order of [`Expr::bind`](super::Expr::bind)).
    pub fn value(&self, variables: &[f64]) -> Result<f64, EvalError> {
        self.derivatives(variables, None, 0).map(|s| s.value())
    }

    /// The Taylor series over one number: in the direction of the variable `along`, or just the value.
    /// Panics if fewer variables are given than were bound.
    pub fn derivatives(
        &self,
        variables: &[f64],
        along: Option<usize>,
        order: usize,
    ) -> Result<Series<f64>, EvalError> {
        let series: Vec<Series<f64>> = variables
            .iter()
            .enumerate()
            .map(|(i, &x)| {
                if Some(i) == along {
                    Series::variable(x, order)
                } else {
                    Series::constant(x, order)
                }
            })
            .collect();
        self.series(&series, order)
            .map_err(|fault| self.located(fault, variables))
    }

    /// The expression of series: derivatives over `f64`, enclosures of them over [`Interval`]. Where an enclosure
    /// cannot be given it is [`Interval::ENTIRE`]; the error says that there is no value anywhere in the range.
    /// Panics if fewer variables are given than were bound.
    pub fn series<S: Number>(
        &self,
        variables: &[Series<S>],
        order: usize,
    ) -> Result<Series<S>, Fault> {
        self.doubtful_series(variables, order).map(|s| s.0)
    }

    /// The same, and whether some part may have no value at places in the range: then the enclosures are of the rest.
    pub(crate) fn doubtful_series<S: Number>(
        &self,
        variables: &[Series<S>],
        order: usize,
    ) -> Result<(Series<S>, bool), Fault> {
        assert!(
            variables.len() >= self.variables.len(),
            "one series for each variable"
        );
        let mut run = Run::new(self, variables, order, None);
        let series = run.result()?;
        Ok((series, run.doubt.is_some()))
    }

    /// The value of an inner node without variables.
    pub(super) fn constant_value(&self, node: u32) -> Option<f64> {
        Run::<f64>::new(self, &[], 0, None)
            .node(node)
            .ok()
            .map(|s| s.value())
    }

    /// A fault with its text and the place where it was found.
    pub(super) fn located(&self, fault: Fault, variables: &[f64]) -> EvalError {
        let used = |i: &usize| self.meanings.contains(&Meaning::Variable(*i));
        EvalError {
            part: self
                .text()
                .get(fault.span.clone())
                .unwrap_or_default()
                .to_owned(),
            at: (0..self.variables.len())
                .filter(used)
                .map(|i| (self.variables[i].clone(), variables[i]))
                .collect(),
            fault,
        }
    }
}
