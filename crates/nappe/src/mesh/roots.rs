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
use crate::parallel;
use crate::surface::{Dir, Surface, jet_len};
use glam::DVec3;
use rustc_hash::FxHashMap;

/// Samples along each direction of a cell.
const SAMPLES: usize = 6;
/// Samples along each direction of a block with many pieces, and how many these are: the greatest curvature counts.
const MANY_SAMPLES: usize = 16;
const MANY_PIECES: usize = 8;
/// What more cells would need is not kept.
const KEPT: usize = 1 << 16;
/// From so many cells on, threads are worth while.
const SHARED: usize = 64;
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

/// The cells of a grid with so many across its parts.
fn count(cells: &[Vec<f64>; 2]) -> f64 {
    let [n, m] = cells.each_ref().map(|c| c.iter().sum::<f64>());
    n * m
}

impl Grid {
    /// `None` if it needs more than so many cells.
    fn new(
        surface: &dyn Surface,
        uv: [Interval; 2],
        number: [usize; 2],
        demand: &Demand,
        most: f64,
    ) -> Option<Self> {
        let parts = [0, 1].map(|d| parts(uv[d], number[d]));
        let mut cells = [0, 1].map(|d| vec![1.0f64; parts[d].len()]);
        let mut bends = Vec::with_capacity(number[0] * number[1]);
        let least = [0, 1].map(|d| (demand.least[d] / number[d] as f64).ceil());
        for (i, &u) in parts[0].iter().enumerate() {
            for (j, &v) in parts[1].iter().enumerate() {
                let (bend, n) = grid_bound(surface, [u, v], least, demand)?;
                bends.push(bend);
                cells[0][i] = cells[0][i].max(n[0]);
                cells[1][j] = cells[1][j].max(n[1]);
                if count(&cells) > most {
                    return None;
                }
            }
        }
        Some(Self {
            parts,
            bends,
            cells,
        })
    }

    fn count(&self) -> f64 {
        count(&self.cells)
    }

    /// The best of those that need hardly more cells than bisection would.
    fn best(surface: &dyn Surface, uv: [Interval; 2], demand: &Demand) -> Option<Self> {
        let pieces = [0, 1].map(|d| surface.breaks([Dir::U, Dir::V][d]).parts(uv[d]).len());
        let many = pieces.into_iter().any(|n| n >= MANY_PIECES);
        let along = if many { MANY_SAMPLES } else { SAMPLES };
        let samples = &sampled(surface, [&[uv[0]], &[uv[1]]], along)[0];
        let enough = expected(samples, demand.tol).max(demand.least[0] * demand.least[1]);
        let mut best: Option<Self> = None;
        for parts in PARTS {
            if fewest(samples, parts, demand.tol) > enough {
                // Not worth its enclosures.
                continue;
            }
            let most = best.as_ref().map_or(f64::INFINITY, |b| GAIN * b.count());
            let grid = Self::new(surface, uv, parts, demand, enough);
            best = grid.filter(|g| g.count() <= most).or(best);
            // Without the steps of bisection, nothing can be much better.
            if best
                .as_ref()
                .is_some_and(|b| STEPS * b.count() <= enough.max(FEW))
            {
                break;
            }
        }
        best
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
struct Samples {
    /// Along each direction.
    along: usize,
    all: Vec<Sample>,
}

impl Samples {
    /// Each with its number along a direction.
    fn numbered(&self, d: usize) -> impl Iterator<Item = (usize, &Sample)> {
        let n = self.along;
        let number = move |k| if d == 0 { k / n } else { k % n };
        self.all
            .iter()
            .enumerate()
            .map(move |(k, s)| (number(k), s))
    }
}

fn mean(samples: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = samples.fold((0.0, 0), |(s, n), x| (s + x, n + 1));
    sum / f64::from(n.max(1))
}

/// The cells that bisection of a rectangle leads to.
fn cells(errors: impl Iterator<Item = f64>, tol: f64) -> f64 {
    (mean(errors) / tol).max(1.0)
}

/// So many samples along each direction for each pair of ranges, v fastest.
fn sampled(surface: &dyn Surface, [us, vs]: [&[Interval]; 2], along: usize) -> Vec<Samples> {
    let params = |ranges: &[Interval]| -> Vec<f64> {
        let inside = |r: &Interval, k: usize| r.lo + r.width() * (k as f64 + 0.5) / along as f64;
        let all = ranges.iter();
        all.flat_map(|r| (0..along).map(move |k| inside(r, k)))
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
            let rows = jets.chunks_exact(v.len()).skip(i * along).take(along);
            let all = rows.flat_map(|row| &row[j * along..(j + 1) * along]);
            out.push(Samples {
                along,
                all: all.map(|jet| Sample::new(jet, size)).collect(),
            });
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
    halve(surface, blocks, &grids, &mut strips, demand);
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
            let samples = &sampled(surface, [&[u], &[v]], SAMPLES)[0];
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
            let n = samples.along;
            let of = samples
                .numbered(d)
                .filter(|&(at, _)| at * parts[d] / n == part);
            let curved = |s: &Sample| (0.125 * [s.uu, s.vv][d] / tol).sqrt() / parts[d] as f64;
            of.map(|(_, s)| curved(s)).fold(1.0, f64::max)
        };
        (0..parts[d]).map(strip).sum()
    };
    across(0) * across(1)
}

/// The cells along a line for some second derivatives, in the mean.
fn along(samples: &Samples, tol: f64, second: fn(&Sample) -> f64) -> f64 {
    let all = samples.all.iter();
    mean(all.map(|s| (0.125 * second(s) / tol).sqrt()))
}

/// About the number of cells that bisection of a block needs.
fn expected(samples: &Samples, tol: f64) -> f64 {
    let all = samples.all.iter();
    let both = mean(all.map(|s| 0.25 * ((s.uu * s.vv).sqrt() + s.uv))) / tol;
    let one = |f| along(samples, tol, f);
    // The chords along the sides.
    let side = |d: usize, upper: bool| {
        let end = if upper { samples.along - 1 } else { 0 };
        let on = samples.numbered(1 - d).filter(|s| s.0 == end);
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

/// What bisection of a cell needs.
#[derive(Clone, Copy)]
struct Need {
    cells: f64,
    /// Of both halves along u and along v together.
    halved: [f64; 2],
}

impl Need {
    fn new(samples: &Samples, tol: f64) -> Self {
        let middle = samples.along / 2;
        let half = |d: usize, upper: bool| {
            let of = samples.numbered(d).filter(|s| (s.0 >= middle) == upper);
            cells(of.map(|(_, s)| s.error(d)), tol)
        };
        Self {
            cells: cells(samples.all.iter().map(|s| s.error(2)), tol),
            halved: [0, 1].map(|d| half(d, false) + half(d, true)),
        }
    }
}

/// What cells need, as far as it is known.
struct Needs<'a> {
    surface: &'a dyn Surface,
    tol: f64,
    known: FxHashMap<[u64; 4], Need>,
}

impl<'a> Needs<'a> {
    fn key([u, v]: [Interval; 2]) -> [u64; 4] {
        [u.lo, u.hi, v.lo, v.hi].map(f64::to_bits)
    }

    /// To begin with, that of all pairs of strips.
    fn new(surface: &'a dyn Surface, [us, vs]: [&[Interval]; 2], demand: &Demand) -> Self {
        let mut new = Self {
            surface,
            tol: demand.tol,
            known: FxHashMap::default(),
        };
        let count = us.len() * vs.len();
        if (SHARED..KEPT).contains(&count) {
            let row = |k: usize| new.of_cells([&us[k..=k], vs]);
            let rows = parallel::each(demand.threads, us.len(), row, |_| false);
            let pairs = us
                .iter()
                .flat_map(|&u| vs.iter().map(move |&v| Self::key([u, v])));
            new.known = pairs.zip(rows.into_iter().flatten()).collect();
        }
        new
    }

    fn of_cells(&self, ranges: [&[Interval]; 2]) -> Vec<Need> {
        let all = sampled(self.surface, ranges, SAMPLES);
        all.iter().map(|s| Need::new(s, self.tol)).collect()
    }

    /// The halves of a strip across direction `d`, if they need fewer cells.
    fn halves(&mut self, strip: Interval, across: &[Interval], d: usize) -> Option<[Interval; 2]> {
        let middle = strip.lo + 0.5 * strip.width();
        if !(strip.lo < middle && middle < strip.hi) {
            return None;
        }
        let cell = |c: Interval| Self::key(if d == 0 { [strip, c] } else { [c, strip] });
        let known = across.iter().map(|&c| self.known.get(&cell(c)).copied());
        let needs: Vec<Need> = match known.collect() {
            Some(needs) => needs,
            None => {
                let strips = [strip];
                let needs = self.of_cells(if d == 0 {
                    [&strips, across]
                } else {
                    [across, &strips]
                });
                if self.known.len() + across.len() <= KEPT {
                    let cells = across.iter().map(|&c| cell(c));
                    self.known.extend(cells.zip(needs.iter().copied()));
                }
                needs
            }
        };
        let whole: f64 = needs.iter().map(|n| n.cells).sum();
        let halved: f64 = needs.iter().map(|n| n.halved[d]).sum();
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
}

/// Halves strips of the blocks that have no grid.
fn halve(
    surface: &dyn Surface,
    blocks: &[Vec<Interval>; 2],
    grids: &[Option<Grid>],
    strips: &mut [Vec<Vec<Interval>>; 2],
    demand: &Demand,
) {
    // All blocks across the k-th one along `d` that have no grid.
    let open = |strips: &[Vec<Vec<Interval>>; 2], d: usize, k: usize| -> Vec<Interval> {
        let across = (0..blocks[1 - d].len()).filter(|&l| {
            let [i, j] = if d == 0 { [k, l] } else { [l, k] };
            grids[i * blocks[1].len() + j].is_none()
        });
        across
            .flat_map(|l| strips[1 - d][l].iter().copied())
            .collect()
    };
    let all_open = grids.iter().all(Option::is_none);
    let all = [0, 1].map(|d| {
        if all_open {
            strips[d].concat()
        } else {
            Vec::new()
        }
    });
    let mut needs = Needs::new(surface, [&all[0], &all[1]], demand);
    for d in [0, 1, 0, 1] {
        let mut total = strips[d].iter().map(Vec::len).sum::<usize>();
        for k in 0..blocks[d].len() {
            let open = open(strips, d, k);
            if open.is_empty() {
                continue;
            }
            total -= strips[d][k].len();
            let mut todo: Vec<Interval> = strips[d][k].iter().rev().copied().collect();
            let mut done = Vec::with_capacity(todo.len());
            while let Some(strip) = todo.pop() {
                let room = total + done.len() + todo.len() < MOST;
                match needs.halves(strip, &open, d).filter(|_| room) {
                    Some([a, b]) => todo.extend([b, a]),
                    None => done.push(strip),
                }
            }
            total += done.len();
            strips[d][k] = done;
        }
    }
}
