//! Cells of a rectangle over each of which the zeros of a function are proven to be nothing or one arc.
//!
//! **Theorem.** Let f be continuous on a closed cell with `f_v ≠ 0` throughout, not zero in the four corners, and on each
//! edge not zero or strictly monotone. Then the zeros of f in the cell are none, or one arc, a graph over u, that joins the
//! two edges at whose ends f has different signs. (Likewise with u and v exchanged.)
//!
//! *Proof.* By the implicit function theorem (or, where derivatives jump, by strict monotony in v) the zeros are a graph
//! over a closed set of parameters u, whose relative ends inside the cell's range lie on the lower or upper edge. Each
//! edge has at most one zero, none in a corner, and f changes its sign there: an edge has a zero exactly if its ends differ.
//! Say f grows with v. Were there four zeros, the signs would alternate around the cell; then the lower left and the upper
//! right corner would be positive, say, though the corner below the latter is negative and the one above the former too:
//! impossible. The number of changes around the cell is even. With none, the graph meets no edge: it has no end and does
//! not reach the left edge, so it is empty. With two, it has two ends, so it is one arc. ∎
//!
//! Cells are halved until that is proven or f is proven not to be zero. The arcs of neighbours join in the zeros
//! on their common edge, of which there is at most one for each cell: so nothing is lost and nothing is joined wrongly.
//! Cells that are still open when they are as small as it makes sense are given back: there the curve may
//! have a node, a cusp, a point by itself, or be double.

use super::extended::Extended;
use super::field::Field;
use crate::interval::Interval;
use crate::surface::Dir;
use std::collections::{HashMap, VecDeque};

/// Where a cell is cut: not where models like to have their symmetries. One for each attempt.
const CUTS: [f64; 4] = [0.487_163_9, 0.513_892_7, 0.479_331_1, 0.521_974_3];
/// The smallest width of a cell, relative to the rectangle. At a node the function is of the order of its square:
/// smaller, and rounding would decide.
const SMALLEST: f64 = 1.0 / (1u64 << 26) as f64;
/// Cells up to this width with a corner where rounding hides the sign are not halved.
const HIDDEN: f64 = 1.0 / 1024.0;
/// The greatest ratio of the relative widths of a cell.
const ASPECT: f64 = 16.0;
/// How often a cell has been halved when it is looked at whether f is zero all over it. Sooner, and a few places would
/// have to speak for much; later, and where a function vanishes to a high order rounding would look the same.
const ZERO_TRIED: std::ops::Range<u32> = 6..17;

/// An edge of a cell on which the curve crosses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// The parameter that is constant along the edge, and its value.
    pub(super) d: usize,
    pub(super) at: f64,
    /// The range of the other parameter: one zero is inside, f is monotone or has one change of sign there.
    pub(super) along: Interval,
    /// True if the cell lies below the edge.
    pub(super) upper: bool,
}

/// A cell with one arc.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arc {
    pub(super) uv: [Interval; 2],
    /// The arc is a graph over this parameter.
    pub(super) over: usize,
    pub(super) crossings: [Crossing; 2],
}

/// What is known of all cells.
#[derive(Debug, Default)]
pub(super) struct Cells {
    pub(super) arcs: Vec<Arc>,
    pub(super) open: Vec<[Interval; 2]>,
    /// How many cells were looked at.
    pub(super) looked: usize,
}

/// Why there are no cells.
pub(super) enum CellsError {
    /// f has no value anywhere.
    NoValue,
    /// f is zero all over a cell.
    Zero([Interval; 2]),
}

enum Verdict {
    Nothing,
    Arc(Arc),
    /// The sign in a corner is not known, all else is proven. True if that corner is not on the border: then it is chance,
    /// and other cuts are better.
    Corner(bool),
    Open,
}

struct Cell {
    uv: [Interval; 2],
    halved: u32,
}

struct Division<'a> {
    f: Extended<'a>,
    /// The signs in the corners, by the bits of their parameters.
    signs: HashMap<[u64; 2], Option<bool>>,
}

/// Divides the rectangle of a field; `budget` limits how many cells are looked at, in all attempts together.
pub(super) fn divide(f: Extended, budget: usize) -> Result<Cells, CellsError> {
    let mut best: Option<(usize, Cells)> = None;
    let mut looked = 0;
    for cut in CUTS {
        let mut division = Division {
            f,
            signs: HashMap::new(),
        };
        let (cells, corners) = division.run(cut, budget - looked)?;
        // Another attempt looks at about as many.
        let last = corners == 0 || looked + 2 * cells.looked > budget;
        looked += cells.looked;
        if best.as_ref().is_none_or(|b| corners < b.0) {
            best = Some((corners, cells));
        }
        if last {
            break;
        }
    }
    let mut cells = best.map(|b| b.1).unwrap_or_default();
    cells.looked = looked;
    Ok(cells)
}

impl Division<'_> {
    /// All cells, and how many are open for a corner alone: then other cuts are better.
    fn run(&mut self, cut: f64, budget: usize) -> Result<(Cells, usize), CellsError> {
        let mut cells = Cells::default();
        let mut corners = 0;
        // The largest come first: when the budget ends, what is left is as small everywhere.
        let mut queue = VecDeque::from([Cell {
            uv: self.f.outer,
            halved: 0,
        }]);
        while let Some(cell) = queue.pop_front() {
            cells.looked += 1;
            let verdict = self.verdict(cell.uv, cell.halved == 0)?;
            match verdict {
                Verdict::Nothing => continue,
                Verdict::Arc(arc) => {
                    cells.arcs.push(arc);
                    continue;
                }
                Verdict::Corner(inner) => corners += usize::from(inner),
                Verdict::Open => {}
            }
            if self.is_hidden(cell.uv) {
                cells.open.push(cell.uv);
                continue;
            }
            if ZERO_TRIED.contains(&cell.halved) && self.f.is_zero(self.inside(cell.uv)) {
                return Err(CellsError::Zero(self.inside(cell.uv)));
            }
            match self.halves(&cell, cut) {
                Some(halves) if cells.looked + queue.len() < budget => queue.extend(halves),
                _ => cells.open.push(cell.uv),
            }
        }
        Ok((cells, corners))
    }

    fn verdict(&mut self, uv: [Interval; 2], first: bool) -> Result<Verdict, CellsError> {
        let Some(s) = self.f.slopes(uv) else {
            return if first {
                Err(CellsError::NoValue)
            } else {
                Ok(Verdict::Nothing)
            };
        };
        if !s[0].contains(0.0) {
            return Ok(Verdict::Nothing);
        }
        // The steeper direction across the cell is the one the curve is a graph over the other of.
        let steep = [0, 1].map(|d| s[1 + d].mig() * self.relative(uv, d));
        let across = usize::from(steep[1] >= steep[0]);
        if steep[across].is_nan() || steep[across] <= 0.0 {
            return Ok(Verdict::Open);
        }
        let known = [0, 1].map(|d| !s[1 + d].contains(0.0));
        for d in 0..2 {
            // The two edges along d.
            if !known[d] && !self.edges_are_simple(uv, d) {
                return Ok(Verdict::Open);
            }
        }
        Ok(self.arc(uv, 1 - across))
    }

    /// True if on both edges along d f is not zero or monotone.
    fn edges_are_simple(&self, uv: [Interval; 2], d: usize) -> bool {
        [uv[1 - d].lo, uv[1 - d].hi].into_iter().all(|at| {
            let mut edge = uv;
            edge[1 - d] = Interval::point(at);
            self.f
                .slopes(edge)
                .is_none_or(|s| !s[0].contains(0.0) || !s[1 + d].contains(0.0))
        })
    }

    /// The arc of a cell by the signs in its corners.
    fn arc(&mut self, uv: [Interval; 2], over: usize) -> Verdict {
        let mut signs = [[false; 2]; 2];
        for (i, row) in signs.iter_mut().enumerate() {
            for (j, sign) in row.iter_mut().enumerate() {
                let p = [[uv[0].lo, uv[0].hi][i], [uv[1].lo, uv[1].hi][j]];
                match self.sign(p) {
                    Some(s) => *sign = s,
                    None => {
                        let outer = self.f.outer;
                        let inner = (0..2).all(|d| outer[d].lo < p[d] && p[d] < outer[d].hi);
                        return Verdict::Corner(inner);
                    }
                }
            }
        }
        let mut crossings = Vec::with_capacity(2);
        for d in 0..2 {
            for (k, at) in [uv[d].lo, uv[d].hi].into_iter().enumerate() {
                let ends = [0, 1].map(|l| if d == 0 { signs[k][l] } else { signs[l][k] });
                if ends[0] != ends[1] {
                    crossings.push(Crossing {
                        d,
                        at,
                        along: uv[1 - d],
                        upper: k == 1,
                    });
                }
            }
        }
        match crossings[..] {
            [] => Verdict::Nothing,
            [a, b] => Verdict::Arc(Arc {
                uv,
                over,
                crossings: [a, b],
            }),
            // Not with a field that keeps its word.
            _ => Verdict::Open,
        }
    }

    /// True if rounding hides the sign of f in a corner of a small cell: smaller cells would not help. So it is where f
    /// grows slowly from a border that it is zero on. A corner where f has no value hides nothing.
    fn is_hidden(&mut self, uv: [Interval; 2]) -> bool {
        let small = (0..2).all(|d| self.relative(uv, d) <= HIDDEN);
        small
            && (0..4).any(|k| {
                let p = [[uv[0].lo, uv[0].hi][k & 1], [uv[1].lo, uv[1].hi][k >> 1]];
                self.sign(p).is_none() && self.f.slopes(p.map(Interval::point)).is_some()
            })
    }

    fn sign(&mut self, p: [f64; 2]) -> Option<bool> {
        let f = self.f;
        *self
            .signs
            .entry(p.map(f64::to_bits))
            .or_insert_with(|| f.sign(p))
    }

    fn relative(&self, uv: [Interval; 2], d: usize) -> f64 {
        uv[d].width() / self.f.outer[d].width()
    }

    /// The halves of a cell across the direction along which the slopes change more; `None` if it is too small.
    fn halves(&self, cell: &Cell, cut: f64) -> Option<[Cell; 2]> {
        let width = [0, 1].map(|d| self.relative(cell.uv, d));
        let bend = self.f.jet(self.inside(cell.uv)).map_or([f64::NAN; 2], |j| {
            [
                j[3].mag() * cell.uv[0].width().powi(2),
                j[5].mag() * cell.uv[1].width().powi(2),
            ]
        });
        let d = if width[0] > ASPECT * width[1] {
            0
        } else if width[1] > ASPECT * width[0] {
            1
        } else if bend.iter().all(|b| b.is_finite())
            && bend[0].max(bend[1]) > 4.0 * bend[0].min(bend[1])
        {
            usize::from(bend[1] > bend[0])
        } else {
            usize::from(width[1] > width[0])
        };
        let t = cell.uv[d];
        let at = t.lo + cut * (t.hi - t.lo);
        if width[0].max(width[1]) <= SMALLEST || at <= t.lo || at >= t.hi {
            return None;
        }
        let half = |range: Interval| {
            let mut uv = cell.uv;
            uv[d] = range;
            Cell {
                uv,
                halved: cell.halved + 1,
            }
        };
        Some([
            half(Interval { lo: t.lo, hi: at }),
            half(Interval { lo: at, hi: t.hi }),
        ])
    }

    /// The part of a cell that is in the rectangle, or the side of the rectangle beside it.
    fn inside(&self, uv: [Interval; 2]) -> [Interval; 2] {
        let r = self.f.rect;
        [0, 1].map(|d| Interval {
            lo: uv[d].lo.clamp(r[d].lo, r[d].hi),
            hi: uv[d].hi.clamp(r[d].lo, r[d].hi),
        })
    }
}

/// A rectangle divided where fields jump.
pub(super) fn rectangles(fields: &[&dyn Field], within: [Interval; 2]) -> Vec<[Interval; 2]> {
    let ranges = [Dir::U, Dir::V].map(|dir| {
        let w = within[dir as usize];
        let jumps = fields.iter().flat_map(|f| f.jumps(dir));
        let mut at: Vec<f64> = jumps.filter(|&x| w.lo < x && x < w.hi).collect();
        at.extend([w.lo, w.hi]);
        at.sort_by(f64::total_cmp);
        at.dedup();
        at.windows(2)
            .map(|w| Interval { lo: w[0], hi: w[1] })
            .collect::<Vec<_>>()
    });
    let pairs = ranges[0]
        .iter()
        .flat_map(|&u| ranges[1].iter().map(move |&v| [u, v]));
    pairs.collect()
}
