//! A checked expression over a domain.

use super::Bound;
use super::check::{Finding, check};
use super::error::EvalError;
use super::pieces::{Pieces, pieces};
use crate::breaks::{Break, Breaks, Limit};
use crate::interval::Interval;
use crate::series::Series;
use std::sync::Arc;
use thiserror::Error;

/// A function of one variable given by an expression, finite with its first derivative everywhere in its domain, and
/// analytic between its breaks.
///
/// Where a switch (`abs`, `if`, …) changes is rounded to a double, as is every number; a condition that holds at
/// single points only (`t == 0.5`) is not seen. Cost of a value: one walk over the nodes.
#[derive(Clone, Debug)]
pub struct Function {
    bound: Arc<Bound>,
    pieces: Arc<Pieces>,
    /// A place near which it is not proven that the value is finite.
    undecided: Option<EvalError>,
}

/// Why an expression is no function over a domain.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FunctionError {
    /// The ends are not finite numbers in increasing order.
    #[error("the domain runs from {0} to {1}; it must run from a number to a larger one")]
    Domain(f64, f64),
    /// More than one free variable.
    #[error("a function has one variable, not {0}")]
    Variables(usize),
    /// No value somewhere.
    #[error(transparent)]
    Value(#[from] EvalError),
}

impl FunctionError {
    /// What would be right.
    pub fn help(&self) -> &'static str {
        match self {
            FunctionError::Domain(..) => "write the domain as [from, to] with from < to",
            FunctionError::Variables(_) => "use one of the variables only",
            FunctionError::Value(e) => e.help(),
        }
    }
}

impl Function {
    /// Finds the breaks, then proves that value and derivative are finite, or says where not.
    /// Cost: some thousand evaluations at most.
    pub fn new(bound: Bound, domain: [f64; 2]) -> Result<Self, FunctionError> {
        let [lo, hi] = domain;
        if !(lo.is_finite() && hi.is_finite() && lo < hi) {
            return Err(FunctionError::Domain(lo, hi));
        }
        if bound.variables.len() != 1 {
            return Err(FunctionError::Variables(bound.variables.len()));
        }
        let pieces = pieces(&bound, Interval { lo, hi });
        let undecided = match check(&bound, &pieces) {
            Finding::Proven => None,
            Finding::Undecided(e) => Some(e),
            Finding::Bad(e) => return Err(e.into()),
        };
        Ok(Self {
            bound: Arc::new(bound),
            pieces: Arc::new(pieces),
            undecided,
        })
    }

    /// The expression.
    pub fn expression(&self) -> &Bound {
        &self.bound
    }

    /// What is known of the value being finite.
    pub fn finding(&self) -> Finding {
        self.undecided
            .clone()
            .map_or(Finding::Proven, Finding::Undecided)
    }

    /// The parameters where formulas change, with the ends of the domain first and last.
    pub fn breaks(&self) -> &[Break] {
        &self.pieces.breaks
    }

    /// Writes the value and derivatives at `t`. A derivative that does not exist (the second of `t^1.5` at 0) is
    /// infinite. Outside the domain the formulas of the end pieces are continued; where they have no value, it is
    /// infinite.
    pub fn jet_into(&self, t: f64, limit: Limit, out: &mut [f64]) {
        let piece = self.breaks().find(t, limit);
        let order = out.len() - 1;
        let run = |order: usize| {
            let variable = [Series::variable(t, order)];
            self.pieces.run(&self.bound, piece, &variable).result()
        };
        out.fill(f64::INFINITY);
        // Where some derivative has no value, as many of the lower ones as are finite are given.
        if let Ok(s) = run(order) {
            s.write_derivatives(out);
        } else if let Some(s) = (0..order).rev().find_map(|k| run(k).ok()) {
            s.write_derivatives(&mut out[..s.c.len()]);
        }
        for x in out.iter_mut().filter(|x| x.is_nan()) {
            *x = f64::INFINITY;
        }
    }

    /// The value at `t`.
    pub fn value(&self, t: f64) -> f64 {
        let mut out = [0.0];
        self.jet_into(t, Limit::Above, &mut out);
        out[0]
    }

    /// Writes enclosures of the value and derivatives for all parameters in `t`, which lies in one piece.
    pub fn enclose_piece(&self, t: Interval, limit: Limit, out: &mut [Interval]) {
        let piece = self.breaks().find(t.mid(), limit);
        let variable = [Series::variable(t, out.len() - 1)];
        match self.pieces.run(&self.bound, piece, &variable).result() {
            Ok(s) => s.write_derivatives(out),
            Err(_) => out.fill(Interval::ENTIRE),
        }
    }
}
