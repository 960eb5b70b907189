//! Proof that an expression has a finite value and derivative everywhere in a domain, or the place where it has not.

use super::Bound;
use super::error::{EvalError, Fault, FaultKind};
use super::pieces::Pieces;
use crate::interval::Interval;
use crate::series::Series;

/// Cells examined in all. More proves more; the rest is sampled.
const MAX_CELLS: usize = 4096;
/// Cells this narrow, relative to the largest parameter, are not divided: they are a few doubles wide.
const NARROW: f64 = 1e-15;

/// What is known of an expression over a domain.
#[derive(Clone, Debug, PartialEq)]
pub enum Finding {
    /// Proven: value and first derivative are finite everywhere.
    Proven,
    /// There is no finite value or derivative at the place that the error names.
    Bad(EvalError),
    /// The budget of subdivision ran out near a part of the expression; all samples were finite. The error names the
    /// part and a place near which nothing could be proven.
    Undecided(EvalError),
}

/// Checks the pieces of an expression of one variable.
pub(super) fn check(bound: &Bound, pieces: &Pieces) -> Finding {
    let mut budget = MAX_CELLS;
    let mut undecided: Option<EvalError> = None;
    for (i, range) in pieces.ranges().enumerate() {
        // The ends first: they are the usual culprits, and a cell's corner may never be sampled exactly.
        for t in [range.lo, range.hi] {
            if let Some(e) = sample(bound, pieces, i, t) {
                return Finding::Bad(e);
            }
        }
        let narrow = range.mag() * NARROW;
        let mut level = vec![range];
        while !level.is_empty() {
            let mut next = Vec::new();
            for cell in level {
                let Some(doubt) = doubt(bound, pieces, i, cell) else {
                    continue;
                };
                let m = cell.mid();
                if let Some(e) = sample(bound, pieces, i, m) {
                    return Finding::Bad(e);
                }
                if budget > 0 && cell.hi - cell.lo > narrow {
                    budget -= 1;
                    next.extend([
                        Interval { lo: cell.lo, hi: m },
                        Interval { lo: m, hi: cell.hi },
                    ]);
                    continue;
                }
                // In a few doubles around m a denominator or pole cannot be told from zero.
                let vanishing = matches!(
                    doubt.kind,
                    FaultKind::DivisionByZero(_) | FaultKind::Pole(_)
                );
                let error = bound.located(doubt, &[m]);
                if vanishing && cell.hi - cell.lo <= narrow {
                    return Finding::Bad(error);
                }
                undecided.get_or_insert(error);
            }
            level = next;
        }
    }
    undecided.map_or(Finding::Proven, Finding::Undecided)
}

/// The part that may have no value or derivative in a range.
fn doubt(bound: &Bound, pieces: &Pieces, piece: usize, t: Interval) -> Option<Fault> {
    let variable = [Series::variable(t, 1)];
    let mut run = pieces.run(bound, piece, &variable);
    match run.result() {
        Err(fault) => Some(fault),
        Ok(s) => run.doubt.take().or_else(|| {
            (!s.c[1].is_finite()).then(|| Fault {
                span: 0..bound.text().len(),
                kind: FaultKind::NoDerivative,
            })
        }),
    }
}

/// What is wrong at one parameter.
fn sample(bound: &Bound, pieces: &Pieces, piece: usize, t: f64) -> Option<EvalError> {
    let variable = [Series::variable(t, 1)];
    let fault = match pieces.run(bound, piece, &variable).result() {
        Err(fault) => fault,
        Ok(s) if s.c.iter().all(|c| c.is_finite()) => return None,
        Ok(_) => Fault {
            span: 0..bound.text().len(),
            kind: FaultKind::NoDerivative,
        },
    };
    Some(bound.located(fault, &[t]))
}
