//! The net of lines that bisection starts from.
//!
//! Bisection treats both directions alike, so the lines have to take care of surfaces that bend more along one of them.
//! Where a uniform grid over a whole block needs hardly more cells than bisection would, it is taken: it has just as many
//! cells as it needs, and the bound for a whole block can slide freely within it. Elsewhere the strips between two lines
//! are halved as long as samples of the second derivatives say that this saves cells.

use super::bound::Bend;
use super::layout::{Demand, grid_bound, parts};
use crate::breaks::{Break, Breaks};
use crate::interval::Interval;
use crate::surface::{Dir, Surface, jet_len};
use glam::DVec3;

/// Samples along each direction of a cell.
const SAMPLES: usize = 6;
/// A strip is halved if that leaves at most this share of its cells.
const GAIN: f64 = 0.85;
/// The most lines that halving may lead to, along each direction.
const MOST: usize = 4096;
/// Lines between pieces are worth while from so many cells across each on.
const ACROSS: usize = 4;
/// Pieces this many times narrower than the mean have no lines of their own.
const NARROW: f64 = 4.0;
/// A grid with so few cells cannot be improved.
const FEW: f64 = 2.0;
/// What bisection needs more cells than the curvature asks for: sizes go in steps.
const STEPS: f64 = 1.5;

/// The parts that grids are tried with, along u and v: a bound that slides needs parts that do not turn too far.
const PARTS: [[usize; 2]; 6] = [[1, 1], [4, 1], [1, 4], [8, 1], [1, 8], [4, 4]];

/// The lines of constant u and v, and the grid of each block that has one (v fastest).
pub(super) struct Roots {
    pub(super) lines: [Vec<f64>; 2],
    pub(super) grids: Vec<Option<Grid>>,
}

/// Equal parts of a block with uniform cells.
pub(super) struct Grid {
    pub(super) parts: [Vec<Interval>; 2],
    /// The bound of each part, v fastest.
    pub(super) bends: Vec<Bend>,
    /// The cells across each part, along u and v.
    cells: [Vec<f64>; 2],
}

impl Grid {
    fn new(
        surface: &dyn Surface,
        uv: [Interval; 2],
        count: [usize; 2],
        demand: &Demand,
    ) -> Option<Self> {
        let parts = [0, 1].map(|d| parts(uv[d], count[d]));
        let mut cells = [0, 1].map(|d| vec![1.0f64; parts[d].len()]);
        let mut bends = Vec::with_capacity(count[0] * count[1]);
        let least = [0, 1].map(|d| (demand.least[d] / count[d] as f64).ceil());
        for (i, &u) in parts[0].iter().enumerate() {
            for (j, &v) in parts[1].iter().enumerate() {
                let (bend, n) = grid_bound(surface, [u, v], least, demand)?;
                bends.push(bend);
                cells[0][i] = cells[0][i].max(n[0]);
                cells[1][j] = cells[1][j].max(n[1]);
            }
        }
        Some(Self {
            parts,
            bends,
            cells,
        })
    }

    fn count(&self) -> f64 {
        let [n, m] = [0, 1].map(|d| self.cells[d].iter().sum::<f64>());
        n * m
    }

    /// The best of those that need hardly more cells than bisection would.
    fn best(surface: &dyn Surface, uv: [Interval; 2], demand: &Demand) -> Option<Self> {
        let samples = sampled(surface, [&[uv[0]], &[uv[1]]])[0];
        let enough = expected(&samples, demand.tol).max(demand.least[0] * demand.least[1]);
        let mut best: Option<Self> = None;
        for parts in PARTS {
            if fewest(&samples, parts, demand.tol) > enough {
                // Not worth its enclosures.
                continue;
            }
            let most = best.as_ref().map_or(f64::INFINITY, |b| GAIN * b.count());
            let grid = Self::new(surface, uv, parts, demand);
            best = grid.filter(|g| g.count() <= most).or(best);
            // Without the steps of bisection, nothing can be much better.
            if best
                .as_ref()
                .is_some_and(|b| STEPS * b.count() <= enough.max(FEW))
            {
                break;
            }
        }
        best.filter(|b| b.count() <= enough)
    }
}

/// Second derivatives across the surface at a sample, along the sides of a rectangle.
#[derive(Clone, Copy)]
struct Sample {
    uu: f64,
    uv: f64,
    vv: f64,
    /// How much the lines along u and along v bend, also within the surface.
    bent: [f64; 2],
}

impl Sample {
    fn new(jet: &[DVec3], [du, dv]: [f64; 2]) -> Self {
        let normal = jet[1].cross(jet[2]).normalize_or_zero();
        let across = |d: DVec3| {
            let size = if normal == DVec3::ZERO {
                d.length()
            } else {
                normal.dot(d).abs()
            };
            if size.is_finite() { size } else { 0.0 }
        };
        let bent = |first: DVec3, second: DVec3| {
            let size = second.reject_from(first).length();
            if size.is_finite() { size } else { 0.0 }
        };
        Self {
            bent: [
                bent(jet[1], jet[3]) * du * du,
                bent(jet[2], jet[5]) * dv * dv,
            ],
            uu: across(jet[3]) * du * du,
            uv: across(jet[4]) * du * dv,
            vv: across(jet[5]) * dv * dv,
        }
    }

    /// The error over the rectangle, halved along u (0) or v (1) or not (2).
    fn error(&self, halved: usize) -> f64 {
        let [a, b] = [[0.5, 1.0], [1.0, 0.5], [1.0, 1.0]][halved];
        0.125 * (self.uu * a * a + 2.0 * self.uv * a * b + self.vv * b * b)
    }
}

/// The samples of a rectangle, v fastest.
type Samples = [Sample; SAMPLES * SAMPLES];

fn mean(samples: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = samples.fold((0.0, 0), |(s, n), x| (s + x, n + 1));
    sum / f64::from(n.max(1))
}

/// The cells that bisection of a rectangle leads to.
fn cells(errors: impl Iterator<Item = f64>, tol: f64) -> f64 {
    (mean(errors) / tol).max(1.0)
}

fn sampled(surface: &dyn Surface, [us, vs]: [&[Interval]; 2]) -> Vec<Samples> {
    let params = |ranges: &[Interval]| -> Vec<f64> {
        let inside = |r: &Interval, k: usize| r.lo + r.width() * (k as f64 + 0.5) / SAMPLES as f64;
        let all = ranges.iter();
        all.flat_map(|r| (0..SAMPLES).map(move |k| inside(r, k)))
            .collect()
    };
    let (u, v) = (params(us), params(vs));
    let mut jets = vec![DVec3::ZERO; u.len() * v.len() * jet_len(2)];
    surface.grid_jets(&u, &v, 2, &mut jets);
    let jets = jets.as_chunks::<{ jet_len(2) }>().0;
    let mut out = Vec::with_capacity(us.len() * vs.len());
    for (i, a) in us.iter().enumerate() {
        for (j, b) in vs.iter().enumerate() {
            let size = [a.width(), b.width()];
            out.push(std::array::from_fn(|k| {
                let row = i * SAMPLES + k / SAMPLES;
                let column = j * SAMPLES + k % SAMPLES;
                Sample::new(&jets[row * v.len() + column], size)
            }));
        }
    }
    out
}

/// The lines for a surface.
pub(super) fn roots(surface: &dyn Surface, blocks: &[Vec<Interval>; 2], demand: &Demand) -> Roots {
    let grids: Vec<Option<Grid>> = blocks[0]
        .iter()
        .flat_map(|&u| blocks[1].iter().map(move |&v| [u, v]))
        .map(|block| Grid::best(surface, block, demand))
        .collect();
    let mut strips = [0, 1].map(|d| {
        let each = blocks[d].iter().enumerate();
        each.map(|(k, &block)| {
            let columns = blocks[1].len();
            let along: Vec<&Grid> = match d {
                0 => grids[k * columns..][..columns].iter().flatten().collect(),
                _ => grids.iter().skip(k).step_by(columns).flatten().collect(),
            };
            common(block, d, &along, demand.least[d])
        })
        .collect::<Vec<_>>()
    });
    cut_at_pieces(surface, blocks, &grids, &mut strips, demand.tol);
    halve(surface, blocks, &grids, &mut strips, demand.tol);
    // What crosses from other blocks can only make cells smaller.
    Roots {
        lines: strips.map(|strips| {
            let all: Vec<Interval> = strips.into_iter().flatten().collect();
            let last = all.last().map(|i| i.hi);
            all.iter().map(|i| i.lo).chain(last).collect()
        }),
        grids,
    }
}

/// The cells along direction `d` that are small enough for several grids.
fn common(block: Interval, d: usize, grids: &[&Grid], least: f64) -> Vec<Interval> {
    // The numbers of parts divide each other.
    let count = grids.iter().map(|g| g.cells[d].len()).fold(1, usize::max);
    let part = |(k, part): (usize, Interval)| {
        let share = |g: &&Grid| {
            let together = count / g.cells[d].len();
            (g.cells[d][(k / together).min(g.cells[d].len() - 1)] / together as f64).ceil()
        };
        let n = grids
            .iter()
            .map(share)
            .fold((least / count as f64).ceil(), f64::max);
        parts(part, n as usize)
    };
    parts(block, count)
        .into_iter()
        .enumerate()
        .flat_map(part)
        .collect()
}

/// Cuts strips between the pieces of a surface that needs several cells across each: squares in one piece are known better
/// than those in several.
fn cut_at_pieces(
    surface: &dyn Surface,
    blocks: &[Vec<Interval>; 2],
    grids: &[Option<Grid>],
    strips: &mut [Vec<Vec<Interval>>; 2],
    tol: f64,
) {
    let breaks = [Dir::U, Dir::V].map(|d| surface.breaks(d));
    if grids.iter().any(Option::is_some) || breaks.iter().any(|b| b.pieces() > MOST) {
        return;
    }
    if (0..2).all(|d| breaks[d].pieces() == blocks[d].len()) {
        // There are lines already.
        return;
    }
    // The cells along a line, in the mean over lines.
    let mut needed = [0.0; 2];
    for &u in &blocks[0] {
        for &v in &blocks[1] {
            let samples = &sampled(surface, [&[u], &[v]])[0];
            needed[0] += along(samples, tol, |s| s.uu) / blocks[1].len() as f64;
            needed[1] += along(samples, tol, |s| s.vv) / blocks[0].len() as f64;
        }
    }
    let each = |d: usize| needed[d] >= (ACROSS * breaks[d].pieces()) as f64;
    if !(each(0) && each(1)) {
        return;
    }
    for d in 0..2 {
        for strip in strips[d].iter_mut() {
            *strip = strip
                .iter()
                .flat_map(|&s| at_pieces(breaks[d], s))
                .collect();
        }
    }
}

/// The parts of a range in one piece each; a piece that is much narrower than the others shares one with its neighbours.
fn at_pieces(breaks: &[Break], range: Interval) -> Vec<Interval> {
    let parts = breaks.parts(range);
    let narrow = range.width() / (NARROW * parts.len() as f64);
    let mut from = range.lo;
    let mut cuts = vec![from];
    for (part, _) in parts.iter().skip(1) {
        if part.lo - from > narrow && range.hi - part.lo > narrow {
            from = part.lo;
            cuts.push(from);
        }
    }
    cuts.push(range.hi);
    cuts.windows(2).map(|w| Interval::new(w[0], w[1])).collect()
}

/// The fewest cells of a grid over so many parts of a block: each strip of parts has the cells of its most curved one.
fn fewest(samples: &Samples, parts: [usize; 2], tol: f64) -> f64 {
    let across = |d: usize| -> f64 {
        let strip = |part: usize| {
            let of = samples.iter().enumerate().filter(|(k, _)| {
                let at = [k / SAMPLES, k % SAMPLES][d];
                at * parts[d] / SAMPLES == part
            });
            let curved = |s: &Sample| (0.125 * [s.uu, s.vv][d] / tol).sqrt() / parts[d] as f64;
            of.map(|(_, s)| curved(s)).fold(1.0, f64::max)
        };
        (0..parts[d]).map(strip).sum()
    };
    across(0) * across(1)
}

/// The cells along a line for some second derivatives, in the mean.
fn along(samples: &Samples, tol: f64, second: fn(&Sample) -> f64) -> f64 {
    mean(samples.iter().map(|s| (0.125 * second(s) / tol).sqrt()))
}

/// About the number of cells that bisection of a block needs.
fn expected(samples: &Samples, tol: f64) -> f64 {
    let both = mean(samples.iter().map(|s| 0.25 * ((s.uu * s.vv).sqrt() + s.uv))) / tol;
    let one = |f| along(samples, tol, f);
    // The chords along the sides.
    let side = |d: usize, upper: bool| {
        let on = samples.iter().enumerate().filter(move |(k, _)| {
            let across = [k % SAMPLES, k / SAMPLES][d];
            across == if upper { SAMPLES - 1 } else { 0 }
        });
        mean(on.map(|(_, s)| (0.125 * s.bent[d] / tol).sqrt()))
    };
    [
        both,
        one(|s| s.uu),
        one(|s| s.vv),
        side(0, false),
        side(0, true),
        side(1, false),
        side(1, true),
    ]
    .into_iter()
    .fold(1.0, f64::max)
        * STEPS
}

/// Halves strips of the blocks that have no grid.
fn halve(
    surface: &dyn Surface,
    blocks: &[Vec<Interval>; 2],
    grids: &[Option<Grid>],
    strips: &mut [Vec<Vec<Interval>>; 2],
    tol: f64,
) {
    for d in [0, 1, 0, 1] {
        let mut total = strips[d].iter().map(Vec::len).sum::<usize>();
        for k in 0..blocks[d].len() {
            // All blocks across this one that have no grid.
            let open: Vec<Interval> = (0..blocks[1 - d].len())
                .filter(|&l| {
                    let [i, j] = if d == 0 { [k, l] } else { [l, k] };
                    grids[i * blocks[1].len() + j].is_none()
                })
                .flat_map(|l| strips[1 - d][l].iter().copied())
                .collect();
            if open.is_empty() {
                continue;
            }
            total -= strips[d][k].len();
            let mut todo: Vec<Interval> = strips[d][k].iter().rev().copied().collect();
            let mut done = Vec::with_capacity(todo.len());
            while let Some(strip) = todo.pop() {
                let room = total + done.len() + todo.len() < MOST;
                match halves(surface, strip, &open, d, tol).filter(|_| room) {
                    Some([a, b]) => todo.extend([b, a]),
                    None => done.push(strip),
                }
            }
            total += done.len();
            strips[d][k] = done;
        }
    }
}

/// The halves of a strip across direction `d`, if they need fewer cells.
fn halves(
    surface: &dyn Surface,
    strip: Interval,
    across: &[Interval],
    d: usize,
    tol: f64,
) -> Option<[Interval; 2]> {
    let middle = strip.lo + 0.5 * strip.width();
    if !(strip.lo < middle && middle < strip.hi) {
        return None;
    }
    let strips = [strip];
    let ranges: [&[Interval]; 2] = if d == 0 {
        [&strips, across]
    } else {
        [across, &strips]
    };
    let (mut whole, mut halved) = (0.0, 0.0);
    for samples in sampled(surface, ranges) {
        whole += cells(samples.iter().map(|s| s.error(2)), tol);
        for upper in [false, true] {
            let half = samples.iter().enumerate().filter(|(k, _)| {
                let at = if d == 0 { k / SAMPLES } else { k % SAMPLES };
                (at >= SAMPLES / 2) == upper
            });
            halved += cells(half.map(|(_, s)| s.error(d)), tol);
        }
    }
    (halved <= GAIN * whole).then_some([
        Interval {
            hi: middle,
            ..strip
        },
        Interval {
            lo: middle,
            ..strip
        },
    ])
}
