//! Where an expression changes from one formula to another.
//!
//! Every switch (`abs`, `min`, `max`, a comparison, `if`, `floor`, `ceil`, `atan2`) chooses a formula. The domain is
//! subdivided until each cell is proven to use one formula throughout, or is a few doubles wide: there lies a break.
//! In a piece between two breaks the formulas are then fixed, so that values, one-sided limits and enclosures are
//! those of analytic functions, right up to the ends of the piece.

use super::eval::{Outcome, Run};
use super::{Bound, Number};
use crate::breaks::{Break, Breaks};
use crate::curve::MAX_ORDER;
use crate::interval::Interval;
use crate::series::Series;

/// Cells on one level of subdivision. A switch that changes often, or touches without crossing, costs cells; when
/// they run out, the formula stays open there (enclosures are then wide but right).
const MAX_CELLS: usize = 512;
/// Levels of subdivision: enough to come from any domain to neighbouring doubles.
const MAX_LEVELS: usize = 64;
/// Cells this narrow, relative to the largest parameter, are not divided: they are a few doubles wide.
const NARROW: f64 = 1e-15;
/// Derivatives on the two sides of a break that differ by less than this, relative to their size over the domain,
/// count as equal. Larger hides small corners, smaller finds corners that are rounding.
const AGREE: f64 = 1e-10;

/// The formulas chosen at the switches in one piece; `None` where the value decides.
pub(super) type Choice = Vec<Option<f64>>;

/// The breaks of an expression over a domain, and what holds between them.
#[derive(Clone, Debug)]
pub(super) struct Pieces {
    pub(super) breaks: Vec<Break>,
    pub(super) choices: Vec<Choice>,
}

/// The part of the domain over which something is known.
struct Cell {
    t: Interval,
    /// What is known of each switch; the flag says whether some switch is open.
    choice: Vec<Outcome>,
}

impl Cell {
    fn is_open(&self) -> bool {
        self.choice.contains(&Outcome::Open)
    }
}

/// Finds the pieces of an expression of one variable.
pub(super) fn pieces(bound: &Bound, domain: Interval) -> Pieces {
    if bound.switches == 0 {
        return Pieces {
            breaks: vec![Break::new(domain.lo, 0), Break::new(domain.hi, 0)],
            choices: vec![Vec::new()],
        };
    }
    let mut merged: Vec<Cell> = Vec::new();
    for cell in cells(bound, domain) {
        match merged
            .last_mut()
            .and_then(|last| Some((join(last, &cell)?, last)))
        {
            Some((choice, last)) => {
                last.choice = choice;
                last.t.hi = cell.t.hi;
            }
            None => merged.push(cell),
        }
    }
    let cells = absorb_narrow(bound, merged, domain);
    let choices: Vec<Choice> = cells
        .iter()
        .map(|c| c.choice.iter().map(known).collect())
        .collect();
    let mut breaks = vec![Break::new(domain.lo, 0)];
    for (i, cell) in cells.iter().enumerate().skip(1) {
        let smooth = smoothness(bound, domain, cell.t.lo, [&choices[i - 1], &choices[i]]);
        breaks.push(Break::new(cell.t.lo, smooth));
    }
    breaks.push(Break::new(domain.hi, 0));
    Pieces { breaks, choices }
}

fn known(o: &Outcome) -> Option<f64> {
    match o {
        Outcome::Known(x) => Some(*x),
        Outcome::Free | Outcome::Open => None,
    }
}

/// What each switch does over a range or at a number.
fn outcomes<S: Number>(bound: &Bound, t: S) -> Vec<Outcome> {
    let variable = [Series::variable(t, 0)];
    let mut run = Run::new(bound, &variable, 0, None);
    // A part without a value decides nothing; the check of the expression reports it.
    let _ = run.result();
    run.outcomes
}

/// Subdivides the domain: cells in order, open ones only where they are narrow or the budget ran out.
fn cells(bound: &Bound, domain: Interval) -> Vec<Cell> {
    let narrow = domain.mag() * NARROW;
    let mut done = Vec::new();
    let mut level = vec![Cell {
        t: domain,
        choice: outcomes(bound, domain),
    }];
    for _ in 0..MAX_LEVELS {
        let (open, closed): (Vec<Cell>, Vec<Cell>) = level
            .into_iter()
            .partition(|c| c.is_open() && c.t.hi - c.t.lo > narrow);
        done.extend(closed);
        if open.is_empty() || open.len() > MAX_CELLS {
            done.extend(open);
            break;
        }
        level = open
            .into_iter()
            .flat_map(|c| {
                let m = c.t.mid();
                [
                    Interval { lo: c.t.lo, hi: m },
                    Interval { lo: m, hi: c.t.hi },
                ]
            })
            .map(|t| Cell {
                t,
                choice: outcomes(bound, t),
            })
            .collect();
    }
    done.sort_by(|a, b| a.t.lo.total_cmp(&b.t.lo));
    done
}

/// What holds over both cells, if they use the same formulas.
fn join(a: &Cell, b: &Cell) -> Option<Vec<Outcome>> {
    a.choice
        .iter()
        .zip(&b.choice)
        .map(|(&x, &y)| match (x, y) {
            (Outcome::Free, z) | (z, Outcome::Free) => Some(z),
            _ => (x == y).then_some(x),
        })
        .collect()
}

/// Gives the narrow open cells to their neighbours: between different formulas they become one break, at the first
/// double where the values choose the formulas to the right.
fn absorb_narrow(bound: &Bound, cells: Vec<Cell>, domain: Interval) -> Vec<Cell> {
    // Several narrow cells side by side are still narrow.
    let narrow = 16.0 * domain.mag() * NARROW;
    let mut out: Vec<Cell> = Vec::new();
    let mut pending: Option<Interval> = None;
    for mut cell in cells {
        if cell.is_open() && cell.t.hi - cell.t.lo <= narrow {
            let from = pending.map_or(cell.t.lo, |p| p.lo);
            pending = Some(Interval {
                lo: from,
                hi: cell.t.hi,
            });
            continue;
        }
        match (pending.take(), out.last_mut()) {
            (Some(gap), Some(last)) => match join(last, &cell) {
                Some(choice) => {
                    last.choice = choice;
                    last.t.hi = cell.t.hi;
                    continue;
                }
                None => {
                    let at = first_of(bound, last, gap);
                    last.t.hi = at;
                    cell.t.lo = at;
                }
            },
            (Some(gap), None) => cell.t.lo = gap.lo,
            (None, Some(last)) => {
                if let Some(choice) = join(last, &cell) {
                    last.choice = choice;
                    last.t.hi = cell.t.hi;
                    continue;
                }
            }
            (None, None) => {}
        }
        out.push(cell);
    }
    if let Some(gap) = pending {
        match out.last_mut() {
            Some(last) => last.t.hi = gap.hi,
            None => out.push(Cell {
                t: gap,
                choice: outcomes(bound, gap),
            }),
        }
    }
    out
}

/// The first double of the gap, or its end, that no longer uses the formulas to the left.
fn first_of(bound: &Bound, left: &Cell, gap: Interval) -> f64 {
    let (mut lo, mut hi) = (gap.lo, gap.hi);
    // Half the gap each time, until the doubles are neighbours (or near zero, where they are dense, very near).
    for _ in 0..128 {
        let m = Interval { lo, hi }.mid();
        if m <= lo || m >= hi {
            break;
        }
        let here = Cell {
            t: Interval::point(m),
            choice: outcomes(bound, m),
        };
        if join(left, &here).is_some() {
            lo = m;
        } else {
            hi = m;
        }
    }
    hi
}

/// How many derivatives agree on the two sides of a break: -1 if not even the values do.
fn smoothness(bound: &Bound, domain: Interval, at: f64, choices: [&Choice; 2]) -> i32 {
    let variable = [Series::variable(at, MAX_ORDER)];
    let side = |c: &Choice| Run::<f64>::new(bound, &variable, MAX_ORDER, Some(c)).result();
    let (Ok(a), Ok(b)) = (side(choices[0]), side(choices[1])) else {
        return -1;
    };
    let h = domain.hi - domain.lo;
    let mut scale = 0.0f64;
    let mut power = 1.0;
    for k in 0..=MAX_ORDER {
        scale = scale.max(a.c[k].abs() * power).max(b.c[k].abs() * power);
        power *= h;
    }
    let mut power = 1.0;
    for k in 0..=MAX_ORDER {
        let gap = (a.c[k] - b.c[k]).abs() * power;
        // A NaN does not agree.
        if gap.is_nan() || gap > AGREE * scale {
            return k as i32 - 1;
        }
        power *= h;
    }
    MAX_ORDER as i32
}

impl Pieces {
    /// The Taylor series at a number or over a range, by the formulas of a piece.
    pub(super) fn run<'a, S: Number>(
        &'a self,
        bound: &'a Bound,
        piece: usize,
        variable: &'a [Series<S>; 1],
    ) -> Run<'a, S> {
        let order = variable[0].order();
        Run::new(bound, variable, order, Some(&self.choices[piece]))
    }

    /// The pieces with their ranges.
    pub(super) fn ranges(&self) -> impl Iterator<Item = Interval> + '_ {
        (0..self.breaks.pieces()).map(|i| self.breaks.piece(i))
    }
}
