//! A list of functions given by expressions: a user's basis, blending or free functions.

use super::Functions;
use crate::breaks::{Break, Limit, merge_breaks};
use crate::expr::{Bound, Function, FunctionError};
use crate::interval::Interval;
use smallvec::SmallVec;
use thiserror::Error;

/// Functions `a_0(t) … a_{n-1}(t)`, each an expression: exact derivatives, rigorous enclosures.
#[derive(Clone, Debug)]
pub struct ExpressionFunctions {
    functions: Vec<Function>,
    breaks: Vec<Break>,
}

/// Why expressions are no list of functions.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ExpressionFunctionsError {
    /// The list is empty.
    #[error("a basis needs at least one function")]
    Empty,
    /// One is no function over the domain.
    #[error("function {index}: {error}")]
    Function {
        /// Its place in the list, from 0.
        index: usize,
        /// What is wrong with it.
        error: FunctionError,
    },
}

impl ExpressionFunctions {
    /// The functions over a common domain `[from, to]`.
    pub fn new(
        functions: impl IntoIterator<Item = Bound>,
        domain: [f64; 2],
    ) -> Result<Self, ExpressionFunctionsError> {
        let functions = functions
            .into_iter()
            .enumerate()
            .map(|(index, b)| {
                Function::new(b, domain)
                    .map_err(|error| ExpressionFunctionsError::Function { index, error })
            })
            .collect::<Result<Vec<_>, _>>()?;
        if functions.is_empty() {
            return Err(ExpressionFunctionsError::Empty);
        }
        let breaks = merge_breaks(functions.iter().map(Function::breaks));
        Ok(Self { functions, breaks })
    }

    /// The single functions.
    pub fn functions(&self) -> &[Function] {
        &self.functions
    }

    /// Writes the list of each function into the rows of all.
    fn rows<T: Copy>(
        &self,
        order: usize,
        zero: T,
        out: &mut [T],
        eval: impl Fn(&Function, &mut [T]),
    ) {
        let n = self.functions.len();
        let mut d: SmallVec<[T; 6]> = SmallVec::from_elem(zero, order + 1);
        for (i, f) in self.functions.iter().enumerate() {
            eval(f, &mut d);
            for (k, &d) in d.iter().enumerate() {
                out[k * n + i] = d;
            }
        }
    }
}

impl Functions for ExpressionFunctions {
    fn count(&self) -> usize {
        self.functions.len()
    }
    fn breaks(&self) -> &[Break] {
        &self.breaks
    }
    fn jet_into(&self, t: f64, limit: Limit, order: usize, out: &mut [f64]) {
        self.rows(order, 0.0, out, |f, d| f.jet_into(t, limit, d));
    }
    fn enclose_piece(&self, t: Interval, limit: Limit, order: usize, out: &mut [Interval]) {
        self.rows(order, Interval::ENTIRE, out, |f, d| {
            f.enclose_piece(t, limit, d)
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::breaks::Breaks;
    use crate::expr::Expr;

    #[test]
    fn bernstein_written_as_expressions_is_a_partition_of_one() {
        let bound = |s: &&str| Expr::parse(s).unwrap().bind(&["t"], &[]).unwrap();
        let texts = ["(1-t)^2", "2*t*(1-t)", "t^2"];
        let b = ExpressionFunctions::new(texts.iter().map(bound), [0.0, 1.0]).unwrap();
        assert_eq!((b.count(), b.breaks().domain()), (3, Interval::UNIT));
        for t in [0.0, 0.2, 1.0] {
            let mut d = [0.0; 9];
            b.jet_into(t, Limit::Above, 2, &mut d);
            for (k, row) in d.chunks(3).enumerate() {
                let sum: f64 = row.iter().sum();
                assert!((sum - if k == 0 { 1.0 } else { 0.0 }).abs() < 1e-14);
            }
            let mut e = [Interval::ENTIRE; 9];
            b.enclose_piece(Interval::UNIT, Limit::Above, 2, &mut e);
            assert!(e.iter().zip(&d).all(|(e, d)| e.contains(*d)));
        }
        assert!(matches!(
            ExpressionFunctions::new([], [0.0, 1.0]),
            Err(ExpressionFunctionsError::Empty)
        ));
        let e = ExpressionFunctions::new(["t", "1/t"].iter().map(bound), [0.0, 1.0]).unwrap_err();
        assert!(
            e.to_string()
                .starts_with("function 1: division by zero at t = 0"),
            "{e}"
        );
    }
}
