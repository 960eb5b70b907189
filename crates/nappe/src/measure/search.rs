//! The extremes of functions on a surface, by branch and bound.

use crate::breaks::{Breaks, Limit};
use crate::interval::Interval;
use crate::mesh::Certainty;
use crate::ranked::Ranked;
use crate::surface::{Dir, Surface, SurfaceJet};
use std::collections::BinaryHeap;

/// How hard to look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchOptions {
    /// The search ends when the proven bound is this close to the value found, relative to the value; of curvatures, to
    /// the greatest principal curvature found (Gaussian curvature: to its square).
    pub relative: f64,
    /// The most boxes that are looked at for each number. If they do not suffice the certainty says what was reached.
    pub budget: usize,
}

impl Default for SearchOptions {
    fn default() -> Self {
        Self {
            relative: 1e-4,
            budget: 4000,
        }
    }
}

/// An extreme value over a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extreme {
    /// The value, taken on at `uv`.
    pub value: f64,
    /// The parameters of the place.
    pub uv: [f64; 2],
    /// How far the true extreme may lie beyond `value`.
    pub certainty: Certainty,
}

/// N functions on a surface.
pub(super) trait Quantities<const N: usize> {
    /// The order of the jets that [`Self::values`] needs.
    const ORDER: usize;
    /// The values at a place; `None` where there are none.
    fn values(&self, jet: &SurfaceJet) -> Option<[f64; N]>;
    /// Enclosures over a box of parameters in one analytic piece, and the direction in which to halve it.
    fn enclose(&self, uv: [Interval; 2]) -> ([Interval; N], usize);
    /// What a tolerance for one of them is relative to, from the greatest absolute value of each that was found.
    fn unit(&self, quantity: usize, greatest: [f64; N]) -> f64;
}

/// A box of parameters. The searches for all extremes share the boxes.
struct Node<const N: usize> {
    uv: [Interval; 2],
    ranges: [Interval; N],
    /// The direction to halve.
    next: usize,
    /// The number of the first half; the second follows.
    halves: Option<usize>,
}

/// Which extreme.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum End {
    Least,
    Greatest,
}

impl End {
    pub(super) fn sign(self) -> f64 {
        match self {
            End::Least => -1.0,
            End::Greatest => 1.0,
        }
    }
}

/// A value and where it was found.
type Found = (f64, [f64; 2]);

/// Looks for extremes piece by piece.
pub(super) struct Search<'a, const N: usize, Q: Quantities<N>> {
    surface: &'a dyn Surface,
    quantities: &'a Q,
    nodes: Vec<Node<N>>,
    roots: usize,
    /// The least and greatest values found.
    found: [Option<[Found; 2]>; N],
}

/// The place beside another one by a share of the domain along a parameter, or at the domain's end.
pub(super) fn beside(domain: [Interval; 2], mut uv: [f64; 2], d: usize, share: f64) -> [f64; 2] {
    let Interval { lo, hi } = domain[d];
    uv[d] = (uv[d] + share * domain[d].width()).clamp(lo, hi);
    uv
}

/// The first step of a climb, in parts of the domain, and the last, which moves a value by rounding only: it errs by the
/// square of the step.
const STEPS: [f64; 2] = [1.0 / 16.0, 1e-8];

/// The most steps of a climb: rounding can go on for ever on level ground.
const CLIMB: usize = 100;

impl<'a, const N: usize, Q: Quantities<N>> Search<'a, N, Q> {
    pub(super) fn new(surface: &'a dyn Surface, quantities: &'a Q) -> Self {
        let mut search = Self {
            surface,
            quantities,
            nodes: Vec::new(),
            roots: 0,
            found: [None; N],
        };
        let (bu, bv) = (surface.breaks(Dir::U), surface.breaks(Dir::V));
        for i in 0..bu.pieces() {
            for j in 0..bv.pieces() {
                search.look([bu.piece(i), bv.piece(j)]);
            }
        }
        search.roots = search.nodes.len();
        search
    }

    /// Bounds a box, and takes samples in its corners and its middle.
    fn look(&mut self, uv: [Interval; 2]) {
        let (ranges, next) = self.quantities.enclose(uv);
        let m = uv.map(Interval::mid);
        for k in 0..5 {
            let p = match k {
                4 => m,
                _ => [[uv[0].lo, uv[0].hi][k & 1], [uv[1].lo, uv[1].hi][k >> 1]],
            };
            let limit = [0, 1].map(|d| {
                if p[d] < uv[d].hi {
                    Limit::Above
                } else {
                    Limit::Below
                }
            });
            self.sample(p, limit);
        }
        self.nodes.push(Node {
            uv,
            ranges,
            next,
            halves: None,
        });
    }

    fn sample(&mut self, p: [f64; 2], limit: [Limit; 2]) {
        let jet = self.surface.jet(p, limit, Q::ORDER);
        let values = self.quantities.values(&jet);
        for (x, found) in values.into_iter().flatten().zip(&mut self.found) {
            if !x.is_finite() {
                continue;
            }
            let [least, greatest] = found.get_or_insert([(x, p); 2]);
            if x < least.0 {
                *least = (x, p);
            }
            if x > greatest.0 {
                *greatest = (x, p);
            }
        }
    }

    fn best(&self, quantity: usize, end: End) -> Option<Found> {
        let [least, greatest] = self.found[quantity]?;
        Some(match end {
            End::Least => least,
            End::Greatest => greatest,
        })
    }

    /// Walks from the best place to better ones beside it.
    fn climb(&mut self, quantity: usize, end: End) {
        let domain = self.surface.domain();
        let mut step = STEPS[0];
        for _ in 0..CLIMB {
            if step <= STEPS[1] {
                break;
            }
            let Some((_, from)) = self.best(quantity, end) else {
                return;
            };
            for (d, sign) in [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)] {
                self.sample(beside(domain, from, d, sign * step), [Limit::Above; 2]);
            }
            if self.best(quantity, end).is_some_and(|b| b.1 == from) {
                step *= 0.5;
            }
        }
    }

    /// How much more than the value found is near enough.
    fn slack(&self, quantity: usize, relative: f64) -> f64 {
        let greatest = self
            .found
            .map(|f| f.map_or(0.0, |[a, b]| a.0.abs().max(b.0.abs())));
        relative * self.quantities.unit(quantity, greatest)
    }

    /// An extreme, and how far the true one may be beyond it; `None` if no value was found anywhere.
    pub(super) fn extreme(
        &mut self,
        quantity: usize,
        end: End,
        options: &SearchOptions,
    ) -> Option<Extreme> {
        let sign = end.sign();
        self.climb(quantity, end);
        // The search looks where the bound is greatest.
        let bound = |nodes: &[Node<N>], node: usize| {
            let r = nodes[node].ranges[quantity];
            let upper = match end {
                End::Greatest => r.hi,
                End::Least => -r.lo,
            };
            Ranked {
                rank: upper,
                number: node,
                item: (),
            }
        };
        let mut heap: BinaryHeap<Ranked<()>> =
            (0..self.roots).map(|k| bound(&self.nodes, k)).collect();
        let mut looks = heap.len();
        // What the search can no longer split.
        let mut floor = f64::NEG_INFINITY;
        while let Some(top) = heap.pop() {
            let enough = self.best(quantity, end).is_some_and(|(x, _)| {
                top.rank <= sign * x + self.slack(quantity, options.relative)
            });
            if enough || looks >= options.budget {
                floor = floor.max(top.rank);
                break;
            }
            let Some(first) = self.halve(top.number) else {
                floor = floor.max(top.rank);
                continue;
            };
            for node in [first, first + 1] {
                heap.push(bound(&self.nodes, node));
            }
            looks += 2;
        }
        let (value, uv) = self.best(quantity, end)?;
        let certainty = if floor.is_finite() {
            Certainty::Bounded((floor - sign * value).max(0.0).next_up())
        } else {
            Certainty::Estimated(self.slack(quantity, options.relative))
        };
        Some(Extreme {
            value,
            uv,
            certainty,
        })
    }

    /// The number of the first half; `None` if the box is too narrow to halve.
    fn halve(&mut self, node: usize) -> Option<usize> {
        let Node {
            uv, next, halves, ..
        } = self.nodes[node];
        if halves.is_some() {
            return halves;
        }
        let m = uv[next].mid();
        if m <= uv[next].lo || m >= uv[next].hi {
            return None;
        }
        let first = self.nodes.len();
        for (lo, hi) in [(uv[next].lo, m), (m, uv[next].hi)] {
            let mut half = uv;
            half[next] = Interval::new(lo, hi);
            self.look(half);
        }
        self.nodes[node].halves = Some(first);
        Some(first)
    }
}
