//! From text to nodes: a lexer on demand and precedence climbing.

use super::error::{ParseError, ParseErrorKind};
use super::{Cmp, Expr, FUNCTIONS, Func, MAX_DEPTH, MAX_LENGTH, Node, Op, TABLE, nearest};
use std::ops::Range;

#[derive(Clone, Copy, PartialEq, Debug)]
enum Token<'a> {
    Number(f64),
    Name(&'a str),
    /// An operator, bracket or comma.
    Sign(&'static str),
    End,
}

const SIGNS: [&str; 14] = [
    "<=", ">=", "==", "!=", "<", ">", "+", "-", "*", "/", "^", "(", ")", ",",
];

/// Binding strengths: the loosest is 1.
const COMPARE: u8 = 1;
const SUM: u8 = 2;
const PRODUCT: u8 = 3;
const UNARY: u8 = 4;
const POWER: u8 = 5;

struct Parser<'a> {
    text: &'a str,
    /// The token at hand and its place.
    token: Token<'a>,
    span: Range<usize>,
    nodes: Vec<Node>,
    /// The depth of the tree below each node.
    depths: Vec<usize>,
    names: Vec<String>,
    depth: usize,
}

type Parsed = Result<u32, ParseError>;

pub(super) fn parse(text: &str) -> Result<Expr, ParseError> {
    if text.len() > MAX_LENGTH {
        return Err(ParseError {
            span: 0..0,
            kind: ParseErrorKind::TooLong(text.len()),
        });
    }
    if text.trim().is_empty() {
        return Err(ParseError {
            span: 0..text.len(),
            kind: ParseErrorKind::Empty,
        });
    }
    let mut p = Parser {
        text,
        token: Token::End,
        span: 0..0,
        nodes: Vec::new(),
        depths: Vec::new(),
        names: Vec::new(),
        depth: 0,
    };
    p.advance()?;
    p.expression(COMPARE)?;
    if p.token != Token::End {
        return Err(p.unexpected_after_value());
    }
    Ok(Expr {
        text: text.into(),
        nodes: p.nodes,
        names: p.names,
    })
}

impl<'a> Parser<'a> {
    fn error(&self, kind: ParseErrorKind) -> ParseError {
        ParseError {
            span: self.span.clone(),
            kind,
        }
    }

    /// The token at hand, for a message.
    fn found(&self) -> String {
        match self.token {
            Token::End => "the end".into(),
            _ => format!("`{}`", &self.text[self.span.clone()]),
        }
    }

    fn unexpected_after_value(&self) -> ParseError {
        match self.token {
            Token::Number(_) | Token::Name(_) | Token::Sign("(") => {
                self.error(ParseErrorKind::MissingOperator {
                    before: self.text[self.span.clone()].into(),
                })
            }
            _ => self.error(ParseErrorKind::Expected {
                expected: "an operator or the end",
                found: self.found(),
            }),
        }
    }

    fn advance(&mut self) -> Result<(), ParseError> {
        let rest = &self.text[self.span.end..];
        let start = self.span.end + (rest.len() - rest.trim_start().len());
        let rest = &self.text[start..];
        let bytes = rest.as_bytes();
        let Some(first) = rest.chars().next() else {
            self.span = start..start;
            self.token = Token::End;
            return Ok(());
        };
        if first.is_ascii_digit() || (first == '.' && bytes.get(1).is_some_and(u8::is_ascii_digit))
        {
            let len = number_length(bytes);
            self.span = start..start + len;
            let x: f64 = rest[..len].parse().unwrap_or(f64::INFINITY);
            if !x.is_finite() {
                return Err(self.error(ParseErrorKind::NumberTooLarge(rest[..len].into())));
            }
            self.token = Token::Number(x);
        } else if first.is_alphabetic() || first == '_' {
            let len = rest
                .find(|c: char| !(c.is_alphanumeric() || c == '_'))
                .unwrap_or(rest.len());
            self.span = start..start + len;
            self.token = Token::Name(&rest[..len]);
        } else if let Some(sign) = SIGNS.iter().find(|s| rest.starts_with(**s)) {
            self.span = start..start + sign.len();
            self.token = Token::Sign(sign);
        } else {
            self.span = start..start + first.len_utf8();
            return Err(self.error(ParseErrorKind::BadCharacter(first)));
        }
        Ok(())
    }

    fn node(&mut self, op: Op, args: &[u32], span: Range<usize>) -> Parsed {
        let depth = 1 + args
            .iter()
            .map(|&a| self.depths[a as usize])
            .max()
            .unwrap_or(0);
        if depth > MAX_DEPTH {
            return Err(ParseError {
                span,
                kind: ParseErrorKind::TooDeep,
            });
        }
        let mut a = [0; 3];
        a[..args.len()].copy_from_slice(args);
        self.nodes.push(Node { op, args: a, span });
        self.depths.push(depth);
        Ok((self.nodes.len() - 1) as u32)
    }

    fn span_of(&self, node: u32) -> Range<usize> {
        self.nodes[node as usize].span.clone()
    }

    /// Parses operators that bind at least as strongly as `least`.
    fn expression(&mut self, least: u8) -> Parsed {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(self.error(ParseErrorKind::TooDeep));
        }
        let start = self.span.start;
        let mut left = self.operand()?;
        while let Token::Sign(sign) = self.token {
            let Some((op, strength, right)) = binary(sign) else {
                break;
            };
            if strength < least {
                break;
            }
            self.advance()?;
            let b = self.expression(right)?;
            let span = start..self.end_of_previous(b);
            left = self.node(op, &[left, b], span)?;
            if let (Op::Compare(_), Token::Sign(next)) = (op, self.token)
                && binary(next).is_some_and(|x| x.1 == COMPARE)
            {
                return Err(self.error(ParseErrorKind::ChainedComparison));
            }
        }
        self.depth -= 1;
        Ok(left)
    }

    /// The end of a node, brackets around it included.
    fn end_of_previous(&self, node: u32) -> usize {
        let end = self.span_of(node).end;
        let between = &self.text[end..self.span.start];
        end + between.rfind(')').map_or(0, |i| i + 1)
    }

    fn operand(&mut self) -> Parsed {
        let span = self.span.clone();
        match self.token {
            Token::Number(x) => {
                self.advance()?;
                self.node(Op::Number(x), &[], span)
            }
            Token::Name(name) => {
                self.advance()?;
                if self.token == Token::Sign("(") {
                    return self.call(name, span);
                }
                if FUNCTIONS.contains(&name) {
                    return Err(ParseError {
                        span,
                        kind: ParseErrorKind::FunctionWithoutBrackets(name.into()),
                    });
                }
                let i = self
                    .names
                    .iter()
                    .position(|n| n == name)
                    .unwrap_or_else(|| {
                        self.names.push(name.to_owned());
                        self.names.len() - 1
                    });
                self.node(Op::Name(i as u32), &[], span)
            }
            Token::Sign("-") => {
                self.advance()?;
                let a = self.expression(UNARY)?;
                let end = self.end_of_previous(a);
                self.node(Op::Neg, &[a], span.start..end)
            }
            Token::Sign("+") => {
                self.advance()?;
                self.expression(UNARY)
            }
            Token::Sign("(") => {
                self.advance()?;
                let inner = self.expression(COMPARE)?;
                self.close(span)?;
                Ok(inner)
            }
            _ => Err(self.error(ParseErrorKind::Expected {
                expected: "a value",
                found: self.found(),
            })),
        }
    }

    fn close(&mut self, open: Range<usize>) -> Result<(), ParseError> {
        match self.token {
            Token::Sign(")") => self.advance(),
            Token::End => Err(ParseError {
                span: open,
                kind: ParseErrorKind::Unclosed,
            }),
            Token::Sign(",") => Err(self.error(ParseErrorKind::BadCharacter(','))),
            _ => Err(self.unexpected_after_value()),
        }
    }

    fn call(&mut self, name: &str, span: Range<usize>) -> Parsed {
        let op = match TABLE.iter().find(|x| x.0 == name) {
            Some(x) => Op::Call(x.1),
            None if name == "if" => Op::If,
            None => {
                let kind = ParseErrorKind::UnknownFunction {
                    name: name.into(),
                    near: nearest(name, FUNCTIONS),
                };
                return Err(ParseError { span, kind });
            }
        };
        let open = self.span.clone();
        self.advance()?;
        let mut args: Vec<u32> = Vec::new();
        while self.token != Token::Sign(")") || !args.is_empty() {
            args.push(self.expression(COMPARE)?);
            if self.token != Token::Sign(",") {
                break;
            }
            self.advance()?;
        }
        let end = self.span.end;
        self.close(open)?;
        if args.len() != op.arguments() {
            let kind = ParseErrorKind::WrongCount {
                name: name.into(),
                expected: op.arguments(),
                found: args.len(),
            };
            return Err(ParseError {
                span: span.start..end,
                kind,
            });
        }
        self.node(op, &args, span.start..end)
    }
}

/// The operation of a sign, its strength, and the least strength of what stands to its right.
fn binary(sign: &str) -> Option<(Op, u8, u8)> {
    Some(match sign {
        "+" => (Op::Add, SUM, PRODUCT),
        "-" => (Op::Sub, SUM, PRODUCT),
        "*" => (Op::Mul, PRODUCT, UNARY),
        "/" => (Op::Div, PRODUCT, UNARY),
        // To the right of ^ stands another power or a signed value: `2^-1`, `2^3^2`.
        "^" => (Op::Pow, POWER, UNARY),
        "<" => (Op::Compare(Cmp::Less), COMPARE, SUM),
        "<=" => (Op::Compare(Cmp::LessEqual), COMPARE, SUM),
        ">" => (Op::Compare(Cmp::Greater), COMPARE, SUM),
        ">=" => (Op::Compare(Cmp::GreaterEqual), COMPARE, SUM),
        "==" => (Op::Compare(Cmp::Equal), COMPARE, SUM),
        "!=" => (Op::Compare(Cmp::NotEqual), COMPARE, SUM),
        _ => return None,
    })
}

/// The length of the decimal number at the beginning: digits, a point, digits, and an exponent if it has digits.
fn number_length(b: &[u8]) -> usize {
    let digits = |mut i: usize| {
        while b.get(i).is_some_and(u8::is_ascii_digit) {
            i += 1;
        }
        i
    };
    let mut i = digits(0);
    if b.get(i) == Some(&b'.') {
        i = digits(i + 1);
    }
    if matches!(b.get(i), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(b.get(i + 1), Some(b'+' | b'-')));
        let end = digits(i + 1 + sign);
        if end > i + 1 + sign {
            i = end;
        }
    }
    i
}

/// The name of a function.
pub(super) fn name_of(f: Func) -> &'static str {
    TABLE.iter().find(|x| x.1 == f).map_or("", |x| x.0)
}
