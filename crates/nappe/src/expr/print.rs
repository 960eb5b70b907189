//! From nodes back to text, with as few brackets as the grammar allows.

use super::parse::name_of;
use super::{Cmp, Expr, Op};
use std::fmt;

/// How tightly a node's text holds together: comparison 1 … atom 6.
fn strength(op: Op) -> u8 {
    match op {
        Op::Compare(_) => 1,
        Op::Add | Op::Sub => 2,
        Op::Mul | Op::Div => 3,
        Op::Neg => 4,
        Op::Pow => 5,
        Op::Number(_) | Op::Name(_) | Op::If | Op::Call(_) => 6,
    }
}

impl Expr {
    fn write(&self, node: u32, least: u8, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let n = &self.nodes[node as usize];
        let own = strength(n.op);
        if own < least {
            write!(f, "(")?;
        }
        let [a, b, c] = n.args;
        let mut infix = |sign: &str, left: u8, right: u8| {
            self.write(a, left, f)?;
            write!(f, "{sign}")?;
            self.write(b, right, f)
        };
        match n.op {
            Op::Number(x) => write!(f, "{x:?}")?,
            Op::Name(i) => write!(f, "{}", self.names[i as usize])?,
            Op::Neg => {
                write!(f, "-")?;
                self.write(a, 4, f)?;
            }
            Op::Add => infix(" + ", 2, 3)?,
            Op::Sub => infix(" - ", 2, 3)?,
            Op::Mul => infix("*", 3, 4)?,
            Op::Div => infix("/", 3, 4)?,
            Op::Pow => infix("^", 6, 4)?,
            Op::Compare(cmp) => {
                let sign = match cmp {
                    Cmp::Less => " < ",
                    Cmp::LessEqual => " <= ",
                    Cmp::Greater => " > ",
                    Cmp::GreaterEqual => " >= ",
                    Cmp::Equal => " == ",
                    Cmp::NotEqual => " != ",
                };
                infix(sign, 2, 2)?;
            }
            Op::If | Op::Call(_) => {
                let name = if let Op::Call(g) = n.op {
                    name_of(g)
                } else {
                    "if"
                };
                write!(f, "{name}(")?;
                for (i, x) in [a, b, c].into_iter().take(n.op.arguments()).enumerate() {
                    if i > 0 {
                        write!(f, ", ")?;
                    }
                    self.write(x, 1, f)?;
                }
                write!(f, ")")?;
            }
        }
        if own < least {
            write!(f, ")")?;
        }
        Ok(())
    }
}

impl fmt::Display for Expr {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.nodes.len() {
            0 => Ok(()),
            n => self.write((n - 1) as u32, 1, f),
        }
    }
}
