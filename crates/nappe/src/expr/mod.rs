//! Expressions: formulas written as text, with derivatives of any order and rigorous enclosures.
//!
//! Grammar, loosest first: comparison (`<`, `<=`, `>`, `>=`, `==`, `!=`, not chained; 1 if true, 0 if false), `+ -`,
//! `* /`, unary `-` and `+`, `^` (right associative, so `-t^2` is `-(t^2)` and `2^3^2` is `2^9`), then numbers, names,
//! `( )` and calls of the functions in [`FUNCTIONS`]. `if(c, a, b)` is a where c is not zero, else b; only the branch
//! that is taken is evaluated. Names are `pi`, `tau`, `e`, and whatever [`Expr::bind`] is given.
//!
//! One text serves three purposes: numbers with typed errors ([`Bound::value`]), [`Series`](crate::series::Series) over `f64`
//! or [`Interval`](crate::Interval) ([`Bound::series`]), and, over a domain, a checked piecewise analytic [`Function`]
//! whose breaks are found. There are no finite differences.
//!
//! A number in the text is the nearest double; `pi`, `tau` and `e` are the real numbers (enclosures hold both them
//! and their doubles). A power with an exponent free of variables whose value is an integer is a product, defined also
//! for a base that is zero or negative.
//!
//! Limits: [`MAX_LENGTH`] bytes and [`MAX_DEPTH`] levels, so that no text exhausts the stack.

mod check;
mod error;
mod eval;
mod function;
mod number;
mod parse;
mod pieces;
mod print;
mod rate;
mod suggest;

pub use check::Finding;
pub use error::{EvalError, Fault, FaultKind, ParseError, ParseErrorKind, UnknownName};
pub use function::{Function, FunctionError};
pub use number::Number;
pub use rate::Slope;
pub use suggest::nearest;

use std::ops::Range;
use std::sync::Arc;

/// The longest text of an expression in bytes.
pub const MAX_LENGTH: usize = 4096;
/// The greatest depth of nesting. Evaluation recurses to this depth; a chain `a + b + …` of n terms is n deep.
pub const MAX_DEPTH: usize = 128;
/// The names every expression knows.
pub const CONSTANTS: [&str; 3] = ["pi", "tau", "e"];

/// A function that may be called.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Func {
    Sqrt,
    Exp,
    Ln,
    Abs,
    Min,
    Max,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Atan2,
    Sinh,
    Cosh,
    Tanh,
    Floor,
    Ceil,
}

/// Name and number of arguments of every function, `if` aside.
pub(crate) const TABLE: [(&str, Func, usize); 18] = [
    ("sqrt", Func::Sqrt, 1),
    ("exp", Func::Exp, 1),
    ("ln", Func::Ln, 1),
    ("abs", Func::Abs, 1),
    ("min", Func::Min, 2),
    ("max", Func::Max, 2),
    ("sin", Func::Sin, 1),
    ("cos", Func::Cos, 1),
    ("tan", Func::Tan, 1),
    ("asin", Func::Asin, 1),
    ("acos", Func::Acos, 1),
    ("atan", Func::Atan, 1),
    ("atan2", Func::Atan2, 2),
    ("sinh", Func::Sinh, 1),
    ("cosh", Func::Cosh, 1),
    ("tanh", Func::Tanh, 1),
    ("floor", Func::Floor, 1),
    ("ceil", Func::Ceil, 1),
];

/// The functions an expression may call.
pub const FUNCTIONS: [&str; 19] = [
    "sqrt", "exp", "ln", "abs", "min", "max", "sin", "cos", "tan", "asin", "acos", "atan", "atan2",
    "sinh", "cosh", "tanh", "floor", "ceil", "if",
];

/// A comparison.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Cmp {
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Equal,
    NotEqual,
}

/// What a node does with its arguments.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Op {
    Number(f64),
    /// An index into the names.
    Name(u32),
    Neg,
    Add,
    Sub,
    Mul,
    Div,
    Pow,
    Compare(Cmp),
    If,
    Call(Func),
}

impl Op {
    pub(crate) fn arguments(self) -> usize {
        match self {
            Op::Number(_) | Op::Name(_) => 0,
            Op::Neg => 1,
            Op::Add | Op::Sub | Op::Mul | Op::Div | Op::Pow | Op::Compare(_) => 2,
            Op::If => 3,
            Op::Call(f) => TABLE.iter().find(|x| x.1 == f).map_or(1, |x| x.2),
        }
    }

    /// True if the value is given by different formulas on different sides of a switch.
    pub(crate) fn is_switch(self) -> bool {
        use Func::*;
        matches!(
            self,
            Op::Compare(_) | Op::If | Op::Call(Abs | Min | Max | Floor | Ceil | Atan2)
        )
    }
}

/// A part of an expression; its arguments come before it in the list.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Node {
    pub(crate) op: Op,
    pub(crate) args: [u32; 3],
    pub(crate) span: Range<usize>,
}

/// A parsed expression, its names not yet given a meaning.
#[derive(Clone, Debug)]
pub struct Expr {
    pub(crate) text: Arc<str>,
    pub(crate) nodes: Vec<Node>,
    /// Each name once, in order of first use.
    pub(crate) names: Vec<String>,
}

impl Expr {
    /// Parses a text. Errors carry the byte range and say what would be right.
    pub fn parse(text: &str) -> Result<Expr, ParseError> {
        parse::parse(text)
    }

    /// The text it was parsed from.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The names used, except `pi`, `tau` and `e`, each once, with the byte range of its first use.
    pub fn names(&self) -> impl Iterator<Item = (&str, Range<usize>)> {
        self.names
            .iter()
            .enumerate()
            .filter(|(_, n)| !CONSTANTS.contains(&n.as_str()))
            .map(|(i, n)| {
                let first = self.nodes.iter().find(|x| x.op == Op::Name(i as u32));
                (n.as_str(), first.map_or(0..0, |x| x.span.clone()))
            })
    }

    /// True if the two have the same structure (texts and places may differ).
    pub fn same(&self, other: &Expr) -> bool {
        self.names == other.names
            && self.nodes.len() == other.nodes.len()
            && self
                .nodes
                .iter()
                .zip(&other.nodes)
                .all(|(a, b)| a.op == b.op && a.args == b.args)
    }

    /// Gives every name a meaning: one of the free `variables` (by position), or the value that `value` knows.
    /// Variables come first, so a value of the same name is hidden. All unknown names are reported at once, each with
    /// the nearest of the known names.
    pub fn bind(
        &self,
        variables: &[&str],
        values: &[(&str, f64)],
    ) -> Result<Bound, Vec<UnknownName>> {
        let mut meanings = Vec::with_capacity(self.names.len());
        let mut unknown = Vec::new();
        for (i, name) in self.names.iter().enumerate() {
            let meaning = if let Some(k) = variables.iter().position(|v| v == name) {
                Meaning::Variable(k)
            } else if let Some((_, x)) = values.iter().find(|(n, _)| n == name) {
                Meaning::Value(*x)
            } else if let Some(k) = CONSTANTS.iter().position(|c| c == name) {
                [Meaning::Pi, Meaning::Tau, Meaning::E][k]
            } else {
                let span = self
                    .nodes
                    .iter()
                    .find(|x| x.op == Op::Name(i as u32))
                    .map_or(0..0, |x| x.span.clone());
                let known = || {
                    variables
                        .iter()
                        .copied()
                        .chain(values.iter().map(|v| v.0))
                        .chain(CONSTANTS)
                };
                unknown.push(UnknownName {
                    name: name.clone(),
                    span,
                    near: nearest(name, known()).map(str::to_owned),
                    known: known().map(str::to_owned).collect(),
                });
                continue;
            };
            meanings.push(meaning);
        }
        if !unknown.is_empty() {
            return Err(unknown);
        }
        Ok(Bound::new(
            self.clone(),
            meanings,
            variables.iter().map(|v| (*v).to_owned()).collect(),
        ))
    }
}

/// What a name stands for.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Meaning {
    Variable(usize),
    Value(f64),
    Pi,
    Tau,
    E,
}

/// An expression whose names have a meaning: it can be evaluated.
#[derive(Clone, Debug)]
pub struct Bound {
    pub(crate) expr: Arc<Expr>,
    pub(crate) meanings: Vec<Meaning>,
    pub(crate) variables: Vec<String>,
    /// For each node, its place in the list of switches.
    pub(crate) switch: Vec<Option<u32>>,
    pub(crate) switches: usize,
    /// For each power, its exponent where that is an integer free of variables.
    pub(crate) integer: Vec<Option<i32>>,
    /// For each node, whether no variable occurs in it.
    pub(crate) constant: Vec<bool>,
}

/// Integer exponents up to this size are products; beyond, the general power loses nothing.
const MAX_INTEGER_POWER: f64 = 1024.0;

impl Bound {
    fn new(expr: Expr, meanings: Vec<Meaning>, variables: Vec<String>) -> Self {
        let n = expr.nodes.len();
        let mut switches = 0;
        let mut switch = Vec::with_capacity(n);
        let mut constant = Vec::with_capacity(n);
        for node in &expr.nodes {
            switch.push(node.op.is_switch().then(|| {
                switches += 1;
                switches - 1
            }));
            let own = match node.op {
                Op::Name(i) => !matches!(meanings[i as usize], Meaning::Variable(_)),
                _ => true,
            };
            let args = &node.args[..node.op.arguments()];
            constant.push(own && args.iter().all(|&a| constant[a as usize]));
        }
        let mut bound = Self {
            expr: Arc::new(expr),
            meanings,
            variables,
            switch,
            switches: switches as usize,
            integer: vec![None; n],
            constant,
        };
        // In order, so that the powers inside an exponent are ready when the exponent is evaluated.
        for i in 0..n {
            let node = &bound.expr.nodes[i];
            if node.op == Op::Pow && bound.constant[node.args[1] as usize] {
                let x = bound.constant_value(node.args[1]);
                bound.integer[i] = x
                    .filter(|x| x.fract() == 0.0 && x.abs() <= MAX_INTEGER_POWER)
                    .map(|x| x as i32);
            }
        }
        bound
    }

    /// The constant `x`, as a function of `variable`.
    pub fn constant(x: f64, variable: &str) -> Self {
        let nodes = vec![Node {
            op: Op::Number(x),
            args: [0; 3],
            span: 0..0,
        }];
        let expr = Expr {
            text: format!("{x:?}").into(),
            nodes,
            names: Vec::new(),
        };
        Self::new(expr, Vec::new(), vec![variable.to_owned()])
    }

    /// The text it was parsed from.
    pub fn text(&self) -> &str {
        &self.expr.text
    }

    /// The free variables, in the order of [`Expr::bind`].
    pub fn variables(&self) -> &[String] {
        &self.variables
    }

    /// True if no variable occurs.
    pub fn is_constant(&self) -> bool {
        self.constant.last().copied().unwrap_or(true)
    }
}

#[cfg(test)]
mod tests;
