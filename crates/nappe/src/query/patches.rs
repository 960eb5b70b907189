//! The search in polynomial pieces.
//!
//! The Bernstein coefficients of half the squared distance bound it over a piece, and tell whether it is convex there; where they
//! are not sharp enough, the piece is halved, for no evaluation. What they leave open, as rounding hides it, is left to the
//! parts of the piece.

use super::bernstein::Coefficients;
use super::descent::{Local, descend};
use super::nearest::{Item, Search};
use super::part::{Part, length};
use super::patch::Patch;
use crate::interval::Interval;
use smallvec::SmallVec;

/// How many cells of a piece are looked at, and their smallest size beside it.
const CELLS: usize = 96;
const SMALLEST: f64 = 1.0 / 4096.0;

/// A part of a piece.
struct Cell {
    half_square: Coefficients,
    /// No point is nearer.
    lower: f64,
    /// Its share of the piece's parameters: multiples of powers of ½, without rounding.
    share: [[f64; 2]; 2],
}

impl Cell {
    /// Its parameters in a piece, not beyond its borders inside the piece, or not short of them.
    fn uv(&self, piece: [Interval; 2], inwards: bool) -> [Interval; 2] {
        [0, 1].map(|d| {
            let (t, [from, to]) = (piece[d], self.share[d]);
            let rounding = 4.0 * f64::EPSILON * t.mag();
            let off = if inwards { rounding } else { -rounding };
            let at = |x: f64| t.lo + x * (t.hi - t.lo);
            Interval {
                lo: if from > 0.0 { at(from) + off } else { t.lo },
                hi: if to < 1.0 { at(to) - off } else { t.hi },
            }
        })
    }
}

/// What came of a cell where the distance is convex.
enum Convex {
    /// No place of it is nearer.
    Settled(f64),
    Open,
}

impl Search<'_> {
    /// Looks at all pieces below a node, which are patches; the nearer of two nodes first: that soon leads to a place, beside which
    /// few others need a look.
    pub(super) fn patches(&mut self, node: u32, lower: f64) {
        let tree = &self.finder.tree;
        // By squares of distances.
        let square = |x: f64| x.max(0.0) * x.max(0.0);
        let mut open: SmallVec<[(f64, u32); 32]> = SmallVec::new();
        open.push((square(lower), node));
        let mut limit = square(self.limit);
        let mut least = f64::INFINITY;
        while let Some((lower, k)) = open.pop() {
            if lower >= limit {
                least = least.min(lower);
                continue;
            }
            let node = &tree.nodes[k as usize];
            if let (Some(part), Some(patch)) = (node.part, node.patch) {
                let part = &tree.parts[part as usize];
                let patch = &tree.patches[patch as usize];
                if let Some(lower) = self.patch(part, patch, lower.sqrt()) {
                    self.leave(part, node.below, lower);
                }
                limit = square(self.limit);
            } else if let Some(first) = node.below {
                let bound = |k: u32| tree.nodes[k as usize].hull.distance2(self.p).max(lower);
                let [a, b] = [first, first + 1].map(|k| (bound(k), k));
                let (near, far) = if b.0 < a.0 { (b, a) } else { (a, b) };
                for child in [far, near] {
                    if child.0 >= limit {
                        least = least.min(child.0);
                    } else {
                        open.push(child);
                    }
                }
            }
        }
        self.lower = self.lower.min(least.sqrt());
    }

    /// Leaves a piece to the search in its parts.
    #[cold]
    fn leave(&mut self, part: &Part, below: Option<u32>, lower: f64) {
        match below {
            Some(first) => {
                for k in [first, first + 1] {
                    let lower = self.bound(k, lower);
                    self.push(lower, Item::Node(k));
                }
            }
            None => self.part(part, lower),
        }
    }

    /// Looks at a piece. `None` if that settles it, or else a lower bound.
    fn patch(&mut self, part: &Part, patch: &Patch, lower: f64) -> Option<f64> {
        let p = self.p;
        let off = patch.rounding(p);
        if off.is_infinite() {
            return Some(lower);
        }
        let distance = |half_square: f64| part.distance(half_square - off, p).max(lower);
        let mut whole = Cell {
            half_square: Coefficients::ZERO,
            lower,
            share: [[0.0, 1.0]; 2],
        };
        let least = patch.half_square(p, &mut whole.half_square);
        whole.lower = distance(least);
        let mut settled = f64::INFINITY;
        if whole.lower >= self.limit {
            self.lower = self.lower.min(whole.lower);
            return None;
        }
        let foot = self.best.is_none().then(|| {
            let start = whole.half_square.lowest(least);
            self.first(part, patch, start)
        });
        let mut cells: SmallVec<[Cell; 12]> = SmallVec::new();
        cells.push(whole);
        let mut looked = 0;
        while let Some(cell) = cells.pop() {
            if cell.lower >= self.limit {
                settled = settled.min(cell.lower);
                continue;
            }
            looked += 1;
            if cell.half_square.bends().is_convex(off)
                && let Convex::Settled(lower) = self.convex_cell(part, patch, &cell, foot)
            {
                settled = settled.min(lower);
                continue;
            }
            let widths = cell.share.map(|[from, to]| to - from);
            if looked > CELLS || widths[0].max(widths[1]) <= SMALLEST {
                return Some(lower);
            }
            let size = [0, 1].map(|d| widths[d] * part.first[d].length());
            let d = usize::from(size[1] > size[0]);
            let mut halves = [&cell, &cell].map(|c| Cell {
                half_square: Coefficients::ZERO,
                ..*c
            });
            let [a, b] = &mut halves;
            let least = cell
                .half_square
                .halves(d, [&mut a.half_square, &mut b.half_square]);
            let middle = 0.5 * (cell.share[d][0] + cell.share[d][1]);
            (a.share[d][1], b.share[d][0]) = (middle, middle);
            (a.lower, b.lower) = (
                distance(least[0]).max(cell.lower),
                distance(least[1]).max(cell.lower),
            );
            let [a, b] = halves;
            // The nearer one next.
            let order = if b.lower < a.lower { [a, b] } else { [b, a] };
            cells.extend(order);
        }
        self.lower = self.lower.min(settled);
        None
    }

    /// The first place: down from a share of a piece's parameters, on the whole surface.
    fn first(&mut self, part: &Part, patch: &Patch, start: [f64; 2]) -> Local {
        let shape = &self.finder.shapes[part.surface as usize];
        let domain = shape.domain();
        let start = [0, 1].map(|d| {
            let t = part.uv[d];
            (t.lo + start[d] * (t.hi - t.lo)).clamp(t.lo, t.hi)
        });
        let from = Local::new(shape, self.p, start, domain);
        let foot = descend(shape, self.p, from, [domain; 2], patch.radius(), |_| false);
        self.improve(part, part.place(&foot));
        foot
    }

    /// Looks for the nearest place of a cell over which the distance is convex; `foot` is a place that may be it.
    fn convex_cell(
        &mut self,
        part: &Part,
        patch: &Patch,
        cell: &Cell,
        foot: Option<Local>,
    ) -> Convex {
        let p = self.p;
        // In the cell without doubt, and all of it.
        let [inner, outer] = [true, false].map(|inwards| cell.uv(part.uv, inwards));
        if (0..2).any(|d| inner[d].lo > inner[d].hi) {
            return Convex::Open;
        }
        let shape = &self.finder.shapes[part.surface as usize];
        let best = self.best.filter(|b| b.surface == part.surface);
        let near = best.map_or(part.uv.map(Interval::mid), |b| b.uv);
        let start = [0, 1].map(|d| near[d].clamp(inner[d].lo, inner[d].hi));
        // At the upper end of the piece derivatives may be those of the next one.
        let known = foot.filter(|f| f.uv == start && (0..2).all(|d| start[d] < part.uv[d].hi));
        let from = known.unwrap_or_else(|| Local::new(shape, p, start, part.uv));
        let best = self.best.map_or(f64::INFINITY, |b| b.half_square);
        let tol = self.finder.gap(part.rounding(p));
        let mut lower = cell.lower;
        let at = descend(shape, p, from, [inner, part.uv], patch.radius(), |at| {
            lower = lower.max(part.distance(at.least(outer), p));
            lower >= length(best.min(at.half_square)) - tol
        });
        // The distance is as good as asked for; a place that is nearer than others has to be so too.
        let at = if at.half_square < best {
            descend(shape, p, at, [inner, part.uv], patch.radius(), |_| false)
        } else {
            at
        };
        self.improve(part, part.place(&at));
        if lower >= self.limit {
            Convex::Settled(lower)
        } else {
            Convex::Open
        }
    }
}
