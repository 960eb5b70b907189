//! All that is within some distance of a point.

use super::nearest::Finder;
use super::part::{Part, Place, length};
use crate::interval::Interval;
use crate::ranked::Ranked;
use glam::DVec3;
use std::collections::BinaryHeap;

/// A part that could not be told to be farther away.
pub(super) struct Within {
    pub(super) surface: u32,
    /// All of its places within reach have these parameters.
    pub(super) uv: [Interval; 2],
    /// The nearest place that was found; it may be out of reach.
    pub(super) place: Place,
    /// None of its places is nearer.
    pub(super) lower: f64,
    /// The rounding errors of its distances.
    pub(super) rounding: f64,
    /// The distance is strictly convex over it: it has one nearest place.
    pub(super) convex: bool,
}

/// How far to go into parts over which the distance is not convex.
pub(super) struct Effort {
    /// Those no larger than this are kept as they are.
    pub(super) size: f64,
    /// How many are halved at most; the largest first.
    pub(super) halvings: usize,
}

/// Parts that together hold all places of all surfaces that are no farther away than `reach`.
pub(super) fn within(finder: &Finder, p: DVec3, reach: f64, effort: &Effort) -> Vec<Within> {
    let mut search = Search {
        finder,
        p,
        reach,
        found: Vec::new(),
        heap: BinaryHeap::new(),
        pushed: 0,
    };
    let (tree, mut open) = (&finder.tree, Vec::new());
    if !tree.nodes.is_empty() {
        open.push(0);
    }
    while let Some(k) = open.pop() {
        let node = &tree.nodes[k as usize];
        if node.hull.distance2(p).sqrt() > reach {
            continue;
        }
        let part = node.part.map(|part| &tree.parts[part as usize]);
        if let Some(part) = part
            && (part.lower(p) > reach || search.convex(part))
        {
            continue;
        }
        match (node.below, part) {
            (Some(first), _) => open.extend([first + 1, first]),
            (None, Some(part)) => search.push(Item::Prepared(part)),
            (None, None) => {}
        }
    }
    search.halve(effort);
    search.found
}

/// A part that is still to be halved.
enum Item<'a> {
    Prepared(&'a Part),
    Made(Box<Part>),
}

impl Item<'_> {
    fn part(&self) -> &Part {
        match self {
            Item::Prepared(part) => part,
            Item::Made(part) => part,
        }
    }
}

struct Search<'a> {
    finder: &'a Finder,
    p: DVec3,
    reach: f64,
    found: Vec<Within>,
    /// The largest first.
    heap: BinaryHeap<Ranked<Item<'a>>>,
    pushed: usize,
}

impl<'a> Search<'a> {
    fn push(&mut self, item: Item<'a>) {
        let hull = item.part().hull;
        self.pushed += 1;
        self.heap.push(Ranked {
            rank: (hull.hi - hull.lo).length(),
            number: self.pushed,
            item,
        });
    }

    /// True if the part is settled: the distance is convex over it.
    fn convex(&mut self, part: &Part) -> bool {
        let (p, reach) = (self.p, self.reach);
        if !part.is_convex(p) {
            return false;
        }
        let shape = &self.finder.shapes[part.surface as usize];
        let rounding = part.rounding(p);
        let (place, lower) = part.nearest(shape, p, |best, lower| {
            lower > reach || lower >= length(best) - 2.0 * rounding
        });
        if lower > reach {
            return true;
        }
        if let Some(uv) = part.within(shape, p, place.uv, reach) {
            self.found.push(Within {
                surface: part.surface,
                uv,
                place,
                lower: lower.max(part.lower(p)),
                rounding,
                convex: true,
            });
        }
        true
    }

    /// Halves what is not convex.
    fn halve(&mut self, effort: &Effort) {
        let mut budget = effort.halvings;
        while let Some(Ranked { rank, item, .. }) = self.heap.pop() {
            let part = item.part();
            let halves = if budget > 0 && rank > effort.size {
                part.halves(&self.finder.shapes)
            } else {
                None
            };
            let Some(halves) = halves else {
                self.keep(part);
                continue;
            };
            budget -= 1;
            for half in halves {
                if half.lower(self.p) <= self.reach && !self.convex(&half) {
                    self.push(Item::Made(Box::new(half)));
                }
            }
        }
    }

    fn keep(&mut self, part: &Part) {
        let p = self.p;
        let shape = &self.finder.shapes[part.surface as usize];
        // Newton's method leads down here too, but its bounds hold for convex parts alone.
        let (place, _) = part.nearest(shape, p, |_, _| false);
        self.found.push(Within {
            surface: part.surface,
            uv: part.uv,
            place,
            lower: part.lower(p),
            rounding: part.rounding(p),
            convex: false,
        });
    }
}
