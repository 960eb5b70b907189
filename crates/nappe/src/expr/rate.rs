//! Derivatives of expressions with respect to values that they were bound with.

use super::error::Fault;
use super::eval::{Outcome, Run};
use super::{Bound, Expr, Func, Meaning, Node, Op};
use crate::interval::Interval;
use crate::series::Series;
use std::ops::Range;

/// How fast a value changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Slope {
    /// At this rate.
    One(f64),
    /// On a kink, or so near to one that rounding hides on which side: at a rate in this range, another on each side.
    Kink(Interval),
}

/// Two rates on a kink that differ by less, relative to their size, are one.
const SAME_RATE: f64 = 1e-12;

impl Bound {
    /// The rate of the value when the variables change, each given by its value and rate.
    ///
    /// Error: the part that has no value or no derivative. Panics if fewer variables are given than were bound.
    pub fn slope(&self, variables: &[[f64; 2]]) -> Result<Slope, Fault> {
        let series = |[x, rate]: &[f64; 2]| Series {
            c: [*x, *rate].into_iter().collect(),
        };
        let numbers: Vec<Series<f64>> = variables.iter().map(series).collect();
        let rate = self.series(&numbers, 1)?.c[1];
        let enclosed: Vec<Series<Interval>> = variables
            .iter()
            .map(|[x, rate]| Series {
                // A switch exactly at the value is seen from both sides.
                c: [Interval::around(*x), Interval::point(*rate)]
                    .into_iter()
                    .collect(),
            })
            .collect();
        // What does not change is a number: rounding must not put a switch of constants in doubt.
        let folded = self.folded();
        let mut run = Run::new(&folded, &enclosed, 1, None);
        let range = run.result()?.c[1];
        let open = run.outcomes.contains(&Outcome::Open);
        let one = range.is_finite() && range.width() <= SAME_RATE * range.mag();
        if open && !one {
            return Ok(Slope::Kink(range));
        }
        Ok(Slope::One(rate))
    }

    /// The same expression with the value of each part without variables in its place.
    fn folded(&self) -> Bound {
        let mut expr = (*self.expr).clone();
        for (i, node) in expr.nodes.iter_mut().enumerate() {
            if node.op.arguments() > 0
                && self.constant[i]
                && let Some(x) = self.constant_value(i as u32)
            {
                node.op = Op::Number(x);
            }
        }
        Bound::new(expr, self.meanings.clone(), self.variables.clone())
    }

    /// The rate of a part in which no variable occurs, from the values that change and their rates. `None`: it is on a kink, or
    /// has none.
    fn part_rate(&self, part: usize, rates: &[(&str, f64)]) -> Option<f64> {
        let mut meanings = self.meanings.clone();
        let (mut variables, mut at) = (Vec::new(), Vec::new());
        for (name, meaning) in self.expr.names.iter().zip(&mut meanings) {
            let rate = rates.iter().find(|(n, _)| n == name);
            if let (Meaning::Value(x), Some((_, rate))) = (*meaning, rate) {
                *meaning = Meaning::Variable(variables.len());
                variables.push(name.clone());
                at.push([x, *rate]);
            }
        }
        let expr = Expr {
            nodes: self.expr.nodes[..=part].to_vec(),
            ..(*self.expr).clone()
        };
        match Bound::new(expr, meanings, variables).slope(&at) {
            Ok(Slope::One(rate)) if rate.is_finite() => Some(rate),
            _ => None,
        }
    }

    /// The derivative with respect to a number on which some values depend, as an expression of the same variables; `rates`
    /// gives the rates of these values by name. Switches stay where they are: `Err` is the place of one (`abs`, `min`,
    /// `max`, `floor`, `ceil`, a comparison) that moves along the variables, so that the derivative jumps there, or that is
    /// on its kink whatever the variables are.
    pub fn rate(&self, rates: &[(&str, f64)]) -> Result<Bound, Range<usize>> {
        let moving = |i: usize| {
            let name = self.expr.names[i].as_str();
            let rate = rates.iter().find(|(n, _)| *n == name)?.1;
            matches!(self.meanings[i], Meaning::Value(_)).then_some(rate)
        };
        let mut tree = Tree {
            nodes: self.expr.nodes.clone(),
        };
        let mut derived: Vec<Option<u32>> = Vec::with_capacity(tree.nodes.len());
        for i in 0..self.expr.nodes.len() {
            let node = self.expr.nodes[i].clone();
            let own = match node.op {
                Op::Name(k) => moving(k as usize)
                    .filter(|rate| *rate != 0.0)
                    .map(|rate| tree.number(rate, &node.span)),
                // The same formula holds for all values of the variables.
                op if op.is_switch()
                    && self.constant[i]
                    && node.args[..op.arguments()]
                        .iter()
                        .any(|&a| derived[a as usize].is_some()) =>
                {
                    let rate = self.part_rate(i, rates).ok_or(node.span.clone())?;
                    (rate != 0.0).then(|| tree.number(rate, &node.span))
                }
                _ => tree.derivative(i as u32, &node, &derived)?,
            };
            derived.push(own);
        }
        let Some(Some(root)) = derived.last().copied() else {
            let variable = self.variables.first().map_or("t", String::as_str);
            let mut zero = Bound::constant(0.0, variable);
            zero.variables.clone_from(&self.variables);
            return Ok(zero);
        };
        tree.nodes.truncate(root as usize + 1);
        let expr = Expr {
            nodes: tree.nodes,
            ..(*self.expr).clone()
        };
        Ok(Bound::new(
            expr,
            self.meanings.clone(),
            self.variables.clone(),
        ))
    }
}

/// A list of nodes that grows.
struct Tree {
    nodes: Vec<Node>,
}

impl Tree {
    fn push(&mut self, op: Op, args: &[u32], span: &Range<usize>) -> u32 {
        let mut all = [0; 3];
        all[..args.len()].copy_from_slice(args);
        let span = span.clone();
        self.nodes.push(Node {
            op,
            args: all,
            span,
        });
        (self.nodes.len() - 1) as u32
    }

    fn number(&mut self, x: f64, span: &Range<usize>) -> u32 {
        self.push(Op::Number(x), &[], span)
    }

    /// The derivative of a node from those of its arguments; `None` is zero.
    fn derivative(
        &mut self,
        at: u32,
        node: &Node,
        derived: &[Option<u32>],
    ) -> Result<Option<u32>, Range<usize>> {
        let s = &node.span;
        let [a, b, c] = node.args;
        let d = |i: u32| derived[i as usize];
        let count = node.op.arguments();
        if node.args[..count].iter().all(|&i| d(i).is_none()) {
            return Ok(None);
        }
        let two = |tree: &mut Self, op: Op, x: u32, y: u32| tree.push(op, &[x, y], s);
        Ok(Some(match node.op {
            Op::Number(_) | Op::Name(_) => return Ok(None),
            Op::Neg => match d(a) {
                Some(x) => self.push(Op::Neg, &[x], s),
                None => return Ok(None),
            },
            Op::Add | Op::Sub => match (d(a), d(b)) {
                (Some(x), Some(y)) => two(self, node.op, x, y),
                (None, Some(y)) if node.op == Op::Sub => self.push(Op::Neg, &[y], s),
                (Some(x), None) | (None, Some(x)) => x,
                (None, None) => return Ok(None),
            },
            Op::Mul => {
                let left = d(a).map(|x| two(self, Op::Mul, x, b));
                let right = d(b).map(|y| two(self, Op::Mul, a, y));
                match (left, right) {
                    (Some(x), Some(y)) => two(self, Op::Add, x, y),
                    (x, y) => return Ok(x.or(y)),
                }
            }
            Op::Div => {
                // (a' - (a/b) b') / b
                let less = d(b).map(|y| two(self, Op::Mul, at, y));
                let top = match (d(a), less) {
                    (Some(x), Some(y)) => two(self, Op::Sub, x, y),
                    (None, Some(y)) => self.push(Op::Neg, &[y], s),
                    (x, None) => match x {
                        Some(x) => x,
                        None => return Ok(None),
                    },
                };
                two(self, Op::Div, top, b)
            }
            Op::Pow => {
                // b a^(b-1) a' + a^b ln(a) b'
                let base = d(a).map(|x| {
                    let one = self.number(1.0, s);
                    let less = two(self, Op::Sub, b, one);
                    let power = two(self, Op::Pow, a, less);
                    let slope = two(self, Op::Mul, b, power);
                    two(self, Op::Mul, slope, x)
                });
                let exponent = d(b).map(|y| {
                    let ln = self.push(Op::Call(Func::Ln), &[a], s);
                    let slope = two(self, Op::Mul, at, ln);
                    two(self, Op::Mul, slope, y)
                });
                match (base, exponent) {
                    (Some(x), Some(y)) => two(self, Op::Add, x, y),
                    (x, y) => return Ok(x.or(y)),
                }
            }
            Op::If if d(a).is_none() => {
                let branches = [b, c].map(|i| match d(i) {
                    Some(x) => x,
                    None => self.number(0.0, s),
                });
                self.push(Op::If, &[a, branches[0], branches[1]], s)
            }
            Op::If | Op::Compare(_) => return Err(s.clone()),
            Op::Call(Func::Atan2) => {
                // (b a' - a b') / (a² + b²) for the angle of the point (b, a).
                let left = d(a).map(|x| two(self, Op::Mul, b, x));
                let right = d(b).map(|y| two(self, Op::Mul, a, y));
                let top = match (left, right) {
                    (Some(x), Some(y)) => two(self, Op::Sub, x, y),
                    (Some(x), None) => x,
                    (None, Some(y)) => self.push(Op::Neg, &[y], s),
                    (None, None) => return Ok(None),
                };
                let squares = [a, b].map(|i| two(self, Op::Mul, i, i));
                let below = two(self, Op::Add, squares[0], squares[1]);
                two(self, Op::Div, top, below)
            }
            Op::Call(f) => {
                let Some(x) = d(a) else {
                    return Err(s.clone());
                };
                let slope = self.slope(f, at, a, s)?;
                two(self, Op::Mul, slope, x)
            }
        }))
    }

    /// The slope of a function of one argument `a` with the value `at`.
    fn slope(&mut self, f: Func, at: u32, a: u32, s: &Range<usize>) -> Result<u32, Range<usize>> {
        let one = self.number(1.0, s);
        let call = |tree: &mut Self, f: Func, x: u32| tree.push(Op::Call(f), &[x], s);
        let square = |tree: &mut Self, x: u32| tree.push(Op::Mul, &[x, x], s);
        Ok(match f {
            Func::Sqrt => {
                let two = self.number(2.0, s);
                let below = self.push(Op::Mul, &[two, at], s);
                self.push(Op::Div, &[one, below], s)
            }
            Func::Exp => at,
            Func::Ln => self.push(Op::Div, &[one, a], s),
            Func::Sin => call(self, Func::Cos, a),
            Func::Cos => {
                let sine = call(self, Func::Sin, a);
                self.push(Op::Neg, &[sine], s)
            }
            Func::Tan => {
                let q = square(self, at);
                self.push(Op::Add, &[one, q], s)
            }
            Func::Asin | Func::Acos => {
                let q = square(self, a);
                let rest = self.push(Op::Sub, &[one, q], s);
                let root = call(self, Func::Sqrt, rest);
                let slope = self.push(Op::Div, &[one, root], s);
                match f {
                    Func::Asin => slope,
                    _ => self.push(Op::Neg, &[slope], s),
                }
            }
            Func::Atan => {
                let q = square(self, a);
                let below = self.push(Op::Add, &[one, q], s);
                self.push(Op::Div, &[one, below], s)
            }
            Func::Sinh => call(self, Func::Cosh, a),
            Func::Cosh => call(self, Func::Sinh, a),
            Func::Tanh => {
                let q = square(self, at);
                self.push(Op::Sub, &[one, q], s)
            }
            Func::Abs | Func::Min | Func::Max | Func::Floor | Func::Ceil | Func::Atan2 => {
                return Err(s.clone());
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bound(text: &str, variables: &[&str], values: &[(&str, f64)]) -> Bound {
        Expr::parse(text).unwrap().bind(variables, values).unwrap()
    }

    #[test]
    fn derivatives_are_those_of_series() {
        let texts = [
            "p*t^3 - t/p + p^2",
            "(p + t)^p",
            "sqrt(1 + p*t) / (2 + sin(p*t))",
            "exp(-p*t)*cos(p + t) + ln(3 + p*t)",
            "tan(p*t/4) + asin(p*t/8) - acos(t/(4 + p)) + atan(p/(1 + t))",
            "sinh(p*t) - cosh(t/p) + tanh(p - t) + atan2(p*t, 1 + p)",
            "if(t < 0.5, p*t, t*t*p^3)",
            "-(p - t)*(t - q)",
            "abs(t - 0.3)*p",
        ];
        let values = [("p", 1.3), ("q", 0.7)];
        for text in texts {
            let rate = bound(text, &["t"], &values)
                .rate(&[("p", 2.0), ("q", -0.5)])
                .unwrap();
            let both = bound(text, &["t", "p", "q"], &[]);
            for t in [0.11, 0.47, 0.83] {
                let want = both.slope(&[[t, 0.0], [1.3, 2.0], [0.7, -0.5]]).unwrap();
                let got = rate.value(&[t]).unwrap();
                let Slope::One(want) = want else {
                    panic!("{text}: {want:?}")
                };
                assert!(
                    (got - want).abs() <= 1e-13 * (1.0 + want.abs()),
                    "{text}: {got} {want}"
                );
            }
        }
    }

    #[test]
    fn what_does_not_depend_is_zero_and_moving_switches_are_refused() {
        let values = [("p", 1.0)];
        let zero = bound("t^2 + p", &["t"], &values).rate(&[]).unwrap();
        assert_eq!(zero.value(&[0.4]).unwrap(), 0.0);
        for (text, place) in [
            ("abs(t - p)", 0..10),
            ("2*max(t, p)", 2..11),
            ("if(t < p, 1, 2)", 3..8),
        ] {
            assert_eq!(
                bound(text, &["t"], &values)
                    .rate(&[("p", 1.0)])
                    .unwrap_err(),
                place
            );
        }
    }

    #[test]
    fn a_switch_that_does_not_move_along_the_variables_is_none() {
        let at = |text: &str, p: f64| bound(text, &["t"], &[("p", p)]).rate(&[("p", 2.0)]);
        for (text, p, want) in [
            ("abs(p)*t", -3.0, -2.0 * 0.4),
            ("max(p, 3)*t", 4.0, 2.0 * 0.4),
            ("max(p, 3)*t", 2.0, 0.0),
            ("if(p < 3, t, 2*t)*p", 2.0, 2.0 * 0.4),
            ("if(p < 3, t, p*t)", 4.0, 2.0 * 0.4),
            ("floor(p)*t + p", 2.5, 2.0),
            ("abs(p - t/t)*p*t", 4.0, f64::NAN),
        ] {
            match at(text, p) {
                Ok(rate) => assert!((rate.value(&[0.4]).unwrap() - want).abs() < 1e-14, "{text}"),
                Err(_) => assert!(want.is_nan(), "{text}"),
            }
        }
        assert_eq!(at("2*max(p, 3)*t", 3.0).unwrap_err(), 2..11);
    }

    #[test]
    fn constants_at_a_switch_are_no_kinks() {
        // 4/2 is 2, whatever enclosures of quotients say.
        for (text, want) in [
            ("floor(n/2)", 0.0),
            ("p*floor(n/2)", 2.0),
            ("if(n/2 < 2, p^2, 3*p)", 3.0),
            ("max(n/2, 2)*p", 2.0),
        ] {
            let slope = bound(text, &["p"], &[("n", 4.0)]).slope(&[[5.0, 1.0]]);
            assert_eq!(slope.unwrap(), Slope::One(want), "{text}");
        }
    }

    #[test]
    fn kinks_are_told() {
        let on = |text: &str, p: f64| bound(text, &["p"], &[]).slope(&[[p, 1.0]]);
        assert_eq!(on("max(p, 3)", 2.0).unwrap(), Slope::One(0.0));
        assert_eq!(on("max(p, 3)", 4.0).unwrap(), Slope::One(1.0));
        let Ok(Slope::Kink(range)) = on("max(p, 3)", 3.0) else {
            panic!("a kink")
        };
        assert!(range.contains(0.0) && range.contains(1.0) && range.width() < 1.01);
        // Hidden by rounding: 0.1 + 0.2 is not 0.3.
        assert!(matches!(on("abs(p + 0.2 - 0.3)", 0.1), Ok(Slope::Kink(_))));
        assert!(matches!(on("floor(p)", 3.0), Ok(Slope::Kink(_))));
        assert_eq!(on("floor(p)", 3.5).unwrap(), Slope::One(0.0));
        assert!(on("sqrt(p)", 0.0).is_err());
    }
}
