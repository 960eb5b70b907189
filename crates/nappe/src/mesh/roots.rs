//! The net of lines that bisection starts from.
//!
//! Bisection treats both directions alike, so the lines have to take care of surfaces that bend more along one of them.
//! Where a uniform grid over a whole block needs hardly more cells than bisection would, it is taken: it has just as many
//! cells as it needs, and the bound for a whole block can slide freely within it. Elsewhere the strips between two lines
//! are halved as long as samples of the second derivatives say that this saves cells.

use super::bound::Bend;
use super::layout::{Demand, Range, grid_bound};
use crate::interval::Interval;
use crate::surface::{Surface, jet_len};
use glam::DVec3;

/// Samples along each direction of a cell.
const SAMPLES: usize = 6;
/// A strip is halved if that leaves at most this share of its cells.
const GAIN: f64 = 0.85;
/// The most lines that halving may lead to, along each direction.
const MOST: usize = 4096;
/// What bisection needs more cells than the curvature asks for: sizes go in steps.
const STEPS: f64 = 1.5;

/// The lines of constant u and v, and the bound of each block that they cut into small enough cells (v fastest).
pub(super) struct Roots {
    pub(super) lines: [Vec<f64>; 2],
    pub(super) grids: Vec<Option<Bend>>,
}

/// Second derivatives across the surface at a sample, along the sides of a rectangle.
#[derive(Clone, Copy)]
struct Sample {
    uu: f64,
    uv: f64,
    vv: f64,
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
        Self {
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
    let mut count = [0, 1].map(|d| vec![demand.least[d].max(1.0); blocks[d].len()]);
    let each = || {
        let all = blocks[0].iter().enumerate();
        all.flat_map(|(i, u)| {
            blocks[1]
                .iter()
                .enumerate()
                .map(move |(j, v)| ([i, j], [*u, *v]))
        })
    };
    let mut grids: Vec<Option<Bend>> = Vec::new();
    for (block, uv) in each() {
        let grid = grid_bound(surface, uv, demand).filter(|(_, [n, m])| {
            n * m <= demand.least[0] * demand.least[1] || n * m <= expected(surface, uv, demand.tol)
        });
        if let Some((_, cells)) = grid {
            for d in 0..2 {
                count[d][block[d]] = count[d][block[d]].max(cells[d]);
            }
        }
        grids.push(grid.map(|(bend, _)| bend));
    }
    let mut strips: [Vec<Vec<Interval>>; 2] = [0, 1].map(|d| {
        let blocks = blocks[d].iter().zip(&count[d]);
        blocks
            .map(|(&block, &n)| Range::new(block).parts(n as usize))
            .collect()
    });
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

/// About the number of cells that bisection of a block needs.
fn expected(surface: &dyn Surface, [u, v]: [Interval; 2], tol: f64) -> f64 {
    let samples = &sampled(surface, [&[u], &[v]])[0];
    let both = mean(samples.iter().map(|s| 0.25 * ((s.uu * s.vv).sqrt() + s.uv))) / tol;
    let one = |f: fn(&Sample) -> f64| mean(samples.iter().map(|s| (0.125 * f(s) / tol).sqrt()));
    STEPS * both.max(one(|s| s.uu)).max(one(|s| s.vv)).max(1.0)
}

/// Halves strips of the blocks that have no grid.
fn halve(
    surface: &dyn Surface,
    blocks: &[Vec<Interval>; 2],
    grids: &[Option<Bend>],
    strips: &mut [Vec<Vec<Interval>>; 2],
    tol: f64,
) {
    for d in [0, 1, 0, 1] {
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
            let mut todo: Vec<Interval> = strips[d][k].iter().rev().copied().collect();
            let mut done = Vec::with_capacity(todo.len());
            while let Some(strip) = todo.pop() {
                let room = done.len() + todo.len() < MOST;
                match halves(surface, strip, &open, d, tol).filter(|_| room) {
                    Some([a, b]) => todo.extend([b, a]),
                    None => done.push(strip),
                }
            }
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
