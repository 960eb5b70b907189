//! What can be wrong with an expression: in its text, in its names, and at a value.

use super::{CONSTANTS, FUNCTIONS, MAX_DEPTH, MAX_LENGTH};
use std::fmt;
use std::ops::Range;
use thiserror::Error;

/// An error in the text of an expression.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{kind}")]
pub struct ParseError {
    /// The byte range in the text.
    pub span: Range<usize>,
    /// What is wrong.
    pub kind: ParseErrorKind,
}

/// What is wrong with the text of an expression.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ParseErrorKind {
    /// Nothing but blanks.
    #[error("the expression is empty")]
    Empty,
    /// Something else was needed here.
    #[error("expected {expected}, found {found}")]
    Expected {
        /// What was needed.
        expected: &'static str,
        /// What stands there.
        found: String,
    },
    /// Two values without an operator between them, such as `2t`.
    #[error("an operator is missing before `{before}`")]
    MissingOperator {
        /// What stands after the missing operator.
        before: String,
    },
    /// A character that no expression contains.
    #[error("`{0}` has no meaning in an expression")]
    BadCharacter(char),
    /// A number that is not finite as a double.
    #[error("the number `{0}` is too large")]
    NumberTooLarge(String),
    /// A bracket that is not closed.
    #[error("this bracket is not closed")]
    Unclosed,
    /// A call of something that is not a function.
    #[error("there is no function `{name}`")]
    UnknownFunction {
        /// The name.
        name: String,
        /// The nearest function.
        near: Option<&'static str>,
    },
    /// A function without arguments in brackets.
    #[error("the function `{0}` needs its arguments in brackets")]
    FunctionWithoutBrackets(String),
    /// A call with the wrong number of arguments.
    #[error("`{name}` takes {expected} argument(s), not {found}")]
    WrongCount {
        /// The function.
        name: String,
        /// How many it takes.
        expected: usize,
        /// How many are there.
        found: usize,
    },
    /// `a < b < c`.
    #[error("comparisons cannot be chained")]
    ChainedComparison,
    /// More bytes than [`MAX_LENGTH`].
    #[error("the expression is {0} bytes long; at most {MAX_LENGTH} are allowed")]
    TooLong(usize),
    /// More levels than [`MAX_DEPTH`].
    #[error("the expression is nested deeper than {MAX_DEPTH} levels")]
    TooDeep,
}

impl ParseError {
    /// What would be right.
    pub fn help(&self) -> String {
        match &self.kind {
            ParseErrorKind::Empty => "write a number or a formula, such as `2*pi*t`".into(),
            ParseErrorKind::Expected { .. } => {
                "operators are + - * / ^ and comparisons; values are numbers, names, ( ) and function calls".into()
            }
            ParseErrorKind::MissingOperator { before } => {
                format!("write `*` for a product, as in `2*{}`", if before.starts_with('(') { "(…)" } else { before })
            }
            ParseErrorKind::BadCharacter(',') => "a comma only separates arguments; decimals use a point".into(),
            ParseErrorKind::BadCharacter('=') => "equality is written `==`".into(),
            ParseErrorKind::BadCharacter(_) => format!("functions are {}", FUNCTIONS.join(" ")),
            ParseErrorKind::NumberTooLarge(_) => "numbers go up to 1.7e308".into(),
            ParseErrorKind::Unclosed => "add the missing `)`".into(),
            ParseErrorKind::UnknownFunction { near: Some(n), .. } => format!("did you mean `{n}`?"),
            ParseErrorKind::UnknownFunction { near: None, .. } => format!("functions are {}", FUNCTIONS.join(" ")),
            ParseErrorKind::FunctionWithoutBrackets(n) => format!("write `{n}(…)`"),
            ParseErrorKind::WrongCount { name, expected, .. } => {
                let args = ["a", "b", "c"][..(*expected).min(3)].join(", ");
                format!("write `{name}({args})`")
            }
            ParseErrorKind::ChainedComparison => "write `if(a < b, b < c, 0)` for `a < b < c`".into(),
            ParseErrorKind::TooLong(_) => "use parameters for the parts".into(),
            ParseErrorKind::TooDeep => "use parameters for the inner parts; put brackets around parts of long sums".into(),
        }
    }
}

/// A name that nothing stands for.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("there is no parameter or variable `{name}`")]
pub struct UnknownName {
    /// The name.
    pub name: String,
    /// The byte range of its first use.
    pub span: Range<usize>,
    /// The nearest known name.
    pub near: Option<String>,
    /// All known names.
    pub known: Vec<String>,
}

impl UnknownName {
    /// What would be right.
    pub fn help(&self) -> String {
        if FUNCTIONS.contains(&self.name.as_str()) {
            return format!("`{0}` is a function: write `{0}(…)`", self.name);
        }
        match &self.near {
            Some(n) => format!("did you mean `{n}`?"),
            None if self.known.len() <= CONSTANTS.len() => {
                "no parameters are defined; known are pi, tau and e".to_owned()
            }
            None => format!("known are {}", self.known.join(", ")),
        }
    }
}

/// Why a part of an expression has no value.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// The byte range of the part.
    pub span: Range<usize>,
    /// What is wrong.
    pub kind: FaultKind,
}

/// Why there is no value. Numbers are the offending arguments.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FaultKind {
    /// The denominator vanishes; the numerator is given.
    DivisionByZero(f64),
    /// The square root of a negative number.
    RootOfNegative(f64),
    /// The logarithm of zero or a negative number.
    LogOfNonPositive(f64),
    /// The inverse sine or cosine of a number beyond 1.
    ArcOutOfRange(f64),
    /// A negative base with an exponent that is not an integer: base, exponent.
    PowerOfNegative(f64, f64),
    /// `atan2(0, 0)`.
    NoDirection,
    /// The tangent at a pole.
    Pole(f64),
    /// The result is not a finite double.
    Overflow,
    /// The value exists, its derivative is infinite or does not exist.
    NoDerivative,
}

impl fmt::Display for FaultKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            FaultKind::DivisionByZero(_) => write!(f, "division by zero"),
            FaultKind::RootOfNegative(x) => write!(f, "square root of the negative number {x}"),
            FaultKind::LogOfNonPositive(x) => write!(f, "logarithm of {x}, which is not positive"),
            FaultKind::ArcOutOfRange(x) => {
                write!(f, "inverse sine or cosine of {x}, which is beyond 1")
            }
            FaultKind::PowerOfNegative(a, b) => {
                write!(f, "the number {a} to the power {b}, which is not real")
            }
            FaultKind::NoDirection => write!(f, "atan2 of two zeros"),
            FaultKind::Pole(x) => write!(f, "tangent at its pole {x}"),
            FaultKind::Overflow => write!(f, "result too large for a double"),
            FaultKind::NoDerivative => write!(f, "the derivative is infinite"),
        }
    }
}

/// A place where an expression has no value.
#[derive(Clone, Debug, PartialEq)]
pub struct EvalError {
    /// The part at fault.
    pub fault: Fault,
    /// The text of that part.
    pub part: String,
    /// The variables and their values.
    pub at: Vec<(String, f64)>,
}

impl fmt::Display for EvalError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.fault.kind)?;
        for (i, (name, x)) in self.at.iter().enumerate() {
            write!(f, "{} {name} = {x}", if i == 0 { " at" } else { "," })?;
        }
        write!(f, " in `{}`", self.part)
    }
}

impl std::error::Error for EvalError {}

impl EvalError {
    /// What would be right.
    pub fn help(&self) -> &'static str {
        match self.fault.kind {
            FaultKind::DivisionByZero(_) => {
                "change the formula or its domain so that the denominator keeps away from zero, or use if(c, a, b)"
            }
            FaultKind::RootOfNegative(_)
            | FaultKind::LogOfNonPositive(_)
            | FaultKind::ArcOutOfRange(_) => {
                "keep the argument in range, for example with max(…, 0), or shorten the domain"
            }
            FaultKind::PowerOfNegative(..) => "use an integer exponent, or abs(…) for the base",
            FaultKind::NoDirection | FaultKind::Pole(_) => {
                "shorten the domain, or change the formula there"
            }
            FaultKind::Overflow => "check the units and exponents",
            FaultKind::NoDerivative => {
                "choose another parameter: cos and sin of t for an arc written with a root, a power for t"
            }
        }
    }
}
