//! A curve followed both ways from a point of it, by proven steps.
//!
//! The end of each step is a proven point, and the next box holds it with all that it may be: as that box holds one arc only,
//! the arcs of both boxes are parts of one curve. A curve is closed where a box holds the point it was begun at, ahead.

use super::pair::{Box4, Knot, Place};
use super::step::{Leads, Part4, Step, Stepper, Tube};
use crate::interval::Interval;
use crate::query::solve::{encloses, intersection};

/// The first step, relative to the size; the longest one.
const FIRST: f64 = 1.0 / 32.0;
const LONGEST: f64 = 0.5;
/// No shorter steps are tried, relative to the size: such curves are about to meet.
const SHORTEST: f64 = 1.0 / (1u64 << 18) as f64;
/// Steps below this are made whatever their error.
const FINE: f64 = 1.0 / (1u64 << 16) as f64;
/// How much longer the next step is.
const LONGER: f64 = 1.7;

/// Where a strand ends.
#[derive(Clone, Copy, Debug)]
pub(super) enum End {
    /// On a side of a rectangle.
    Side(Knot),
    /// Where no step could be proven.
    Stuck(Knot),
}

impl End {
    pub(super) fn knot(&self) -> &Knot {
        match self {
            End::Side(knot) | End::Stuck(knot) => knot,
        }
    }
}

/// A curve in one pair of rectangles, or a point of it where it only touches their sides.
#[derive(Debug)]
pub(super) struct Strand {
    pub(super) parts: Vec<Part4>,
    /// Its start and its end; `None` if it is closed.
    pub(super) ends: Option<[End; 2]>,
    pub(super) error: f64,
    /// Boxes in which this curve is all there is.
    pub(super) covers: Vec<Box4>,
}

/// Follows the curve through a point; `known` are boxes of other curves. The number of steps tried is taken from the budget.
pub(super) fn follow(
    stepper: &Stepper,
    start: &Knot,
    known: &[Box4],
    budget: &mut usize,
) -> Strand {
    let forward = run(stepper, start, 1.0, known, budget);
    if forward.closed {
        let covers = covers(&forward.steps, None, true);
        return Strand::new(forward.steps, None, covers);
    }
    let back = run(stepper, start, -1.0, known, budget);
    let mut covered = covers(&forward.steps, back.steps.first(), false);
    covered.extend(covers(&back.steps, forward.steps.first(), false));
    let ends = Some([back.end, forward.end]);
    let mut steps: Vec<Step> = back.steps.into_iter().rev().map(reversed).collect();
    steps.extend(forward.steps);
    Strand::new(steps, ends, covered)
}

impl Strand {
    fn new(steps: Vec<Step>, ends: Option<[End; 2]>, covers: Vec<Box4>) -> Self {
        let mut parts: Vec<Part4> = steps.iter().filter_map(|s| s.part).collect();
        if let (Some(first), true) = (parts.first_mut(), ends.is_some()) {
            first.smooth = false;
        }
        Self {
            parts,
            ends,
            error: steps.iter().map(|s| s.error).fold(0.0, f64::max),
            covers,
        }
    }

    /// True if one of its ends is where no step could be proven.
    pub(super) fn is_stuck(&self) -> bool {
        let stuck = |end: &End| matches!(end, End::Stuck(_));
        self.ends.is_some_and(|ends| ends.iter().any(stuck))
    }

    /// Its length in space, about.
    pub(super) fn length(&self, stepper: &Stepper) -> f64 {
        let ends = |p: &Part4| {
            let [a, b] = [p.points[0], p.points[3]].map(|x| stepper.pair.point(x));
            a.distance(b)
        };
        self.parts.iter().map(ends).sum()
    }
}

/// The steps in one direction.
struct Run {
    steps: Vec<Step>,
    closed: bool,
    end: End,
}

fn run(stepper: &Stepper, start: &Knot, sign: f64, known: &[Box4], budget: &mut usize) -> Run {
    let size = stepper.pair.size;
    let mut run = Run {
        steps: Vec::new(),
        closed: false,
        end: End::Stuck(*start),
    };
    let (mut at, mut length) = (*start, FIRST * size);
    while *budget > 0 {
        *budget -= 1;
        let back = (!run.steps.is_empty() && sign > 0.0).then_some(start);
        let Some(step) = stepper.step(&at, sign, length, back, length <= FINE * size) else {
            length *= 0.5;
            if length < SHORTEST * size {
                break;
            }
            continue;
        };
        length = (length * LONGER).min(LONGEST * size);
        let leads = step.leads;
        run.steps.push(step);
        match leads {
            Leads::To(knot) => {
                at = knot;
                run.end = End::Stuck(at);
                // Beside a singular point a curve may lead to where another one came from.
                if known.iter().any(|b| encloses(b, &knot.zero)) {
                    break;
                }
            }
            Leads::Out(knot) => {
                run.end = End::Side(knot);
                break;
            }
            Leads::Back => {
                run.closed = true;
                break;
            }
        }
    }
    run
}

/// The boxes of steps in which the path is all there is. A box reaches beyond its step as far as the steps beside it are sure to
/// follow the same arc: half their way; out of the rectangles, as far as it is proven.
fn covers(steps: &[Step], before: Option<&Step>, closed: bool) -> Vec<Box4> {
    let n = steps.len();
    let mut covers = Vec::with_capacity(n);
    for (i, step) in steps.iter().enumerate() {
        let tube = &step.tube;
        let last = if closed { steps.last() } else { before };
        let next = if closed { steps.first() } else { None };
        let before = if i > 0 { steps.get(i - 1) } else { last };
        let after = if i + 1 < n { steps.get(i + 1) } else { next };
        let whole = tube.bounds[tube.k];
        let forward = tube.to > tube.from;
        let far = if forward { whole.hi } else { whole.lo };
        // Half the way of the step beside this one.
        let half = |at: f64, beside: Option<&Step>| {
            let part = beside.and_then(|s| s.part);
            part.map_or(at, |p| {
                let [a, b] = [p.points[0][tube.k], p.points[3][tube.k]];
                let away = if (a - at).abs() > (b - at).abs() {
                    a
                } else {
                    b
                };
                0.5 * (at + away)
            })
        };
        let low = half(tube.from, before);
        let high = match step.leads {
            Leads::Out(_) => far,
            _ => match after {
                Some(s) if s.part.is_none() => far,
                _ => half(tube.to, after),
            },
        };
        let range = if forward {
            Interval::new(low.min(tube.from), high.max(tube.to))
        } else {
            Interval::new(high.min(tube.to), low.max(tube.from))
        };
        let mut bounds = tube.bounds;
        bounds[tube.k] = range.intersection(whole).unwrap_or(whole);
        covers.push(bounds);
    }
    covers
}

/// A step of the way back, as one of the way forward.
fn reversed(step: Step) -> Step {
    let part = step.part.map(|p| {
        let [a, b, c, d] = p.points;
        Part4 {
            points: [d, c, b, a],
            ..p
        }
    });
    Step {
        tube: Tube {
            from: step.tube.to,
            to: step.tube.from,
            ..step.tube
        },
        part,
        ..step
    }
}

/// True if each solution in a box lies in one of the others: these take off one end after the other of what is left.
pub(super) fn is_covered(cell: Box4, covers: &[Box4]) -> bool {
    let near: Vec<&Box4> = covers
        .iter()
        .filter(|c| intersection(c, &cell).is_some())
        .collect();
    let mut left = cell;
    loop {
        let mut changed = false;
        for c in &near {
            let mut out = (0..4).filter(|&j| !c[j].encloses(left[j]));
            let Some(d) = out.next() else { return true };
            if out.next().is_some() {
                continue;
            }
            if c[d].lo <= left[d].lo && c[d].hi > left[d].lo {
                left[d].lo = c[d].hi;
                changed = true;
            } else if c[d].hi >= left[d].hi && c[d].lo < left[d].hi {
                left[d].hi = c[d].lo;
                changed = true;
            }
        }
        if !changed {
            return false;
        }
    }
}

/// The place of a strand that has no length.
pub(super) fn only_place(strand: &Strand) -> Option<Place> {
    strand.ends.map(|e| e[0].knot().x)
}
