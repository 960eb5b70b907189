//! The division of a surface's domain into leaves, each a uniform grid of cells that keeps the tolerance.
//!
//! The domain is cut where the surface is not C¹, then bisected as long as that saves cells, because second
//! derivatives vary or because their enclosure is loose. Cells are long where the surface bends little.

use super::bound::{Bend, sampled};
use super::options::MeshError;
use super::slide::slide;
use crate::breaks::Breaks;
use crate::interval::Interval;
use crate::surface::{Dir, Surface};
use glam::DVec3;
use std::collections::HashMap;

/// The deepest bisection along one direction; deeper leaves would be as small as the rounding of parameters.
const MAX_DEPTH: u32 = 30;
/// Bisections after which a surface that cannot bound its position is sampled. Fewer, and surfaces whose enclosures are
/// merely loose over large rectangles are not proven; more, and surfaces that never bound themselves cost much.
const PATIENCE: u32 = 8;
/// A split is worth its enclosures if it leaves at most this share of the cells.
const GAIN: f64 = 0.8;
/// How many bisections one direction may be ahead of the other while nothing can be proven.
const THIN: u32 = 4;
/// A leaf with so few cells is not split.
const FEW: f64 = 2.0;
/// A part with so few cells says no more about what smaller parts would save.
const PROBED: f64 = 8.0;

/// A dyadic part of a block along one direction, cut into equal cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Part {
    /// The index of the part among 2^depth.
    k: u64,
    depth: u32,
    /// The number of cells.
    pub(super) n: usize,
}

impl Part {
    const WHOLE: Part = Part {
        k: 0,
        depth: 0,
        n: 1,
    };

    fn halves(self) -> [Part; 2] {
        [0, 1].map(|h| Part {
            k: 2 * self.k + h,
            depth: self.depth + 1,
            n: 1,
        })
    }

    /// The i-th parameter. Equal fractions give equal numbers, since numerator and denominator are exact and the
    /// division is correctly rounded: neighbours agree on the parameters they share.
    pub(super) fn at(self, block: Interval, i: usize) -> f64 {
        let p = self.k * self.n as u64 + i as u64;
        let q = (1u64 << self.depth) * self.n as u64;
        if p == 0 {
            block.lo
        } else if p == q {
            block.hi
        } else {
            let t = p as f64 / q as f64;
            (block.lo + (block.hi - block.lo) * t).clamp(block.lo, block.hi)
        }
    }

    /// All parameters, ends included.
    pub(super) fn params(self, block: Interval) -> Vec<f64> {
        (0..=self.n).map(|i| self.at(block, i)).collect()
    }

    fn range(self, block: Interval) -> Interval {
        let whole = Part { n: 1, ..self };
        Interval {
            lo: whole.at(block, 0),
            hi: whole.at(block, 1),
        }
    }

    fn can_split(self, block: Interval) -> bool {
        let r = self.range(block);
        let m = self.halves()[1].at(block, 0);
        self.depth < MAX_DEPTH && r.lo < m && m < r.hi
    }
}

/// A rectangle of parameters with a grid of cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaf {
    /// The block along u and v.
    pub(super) block: [usize; 2],
    pub(super) parts: [Part; 2],
    /// The normal around which its triangles must be counter-clockwise, where the bound needs that.
    pub(super) normal: Option<DVec3>,
}

/// The division of one surface.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// The parts of the domain along u and v between corners of the surface.
    pub(super) blocks: [Vec<Interval>; 2],
    pub(super) leaves: Vec<Leaf>,
    /// The deviation of the mesh whose points lie on the surface.
    pub(super) deviation: f64,
    pub(super) proven: bool,
}

impl Layout {
    /// The number of triangles without those that neighbours add.
    pub(super) fn triangles(&self) -> usize {
        self.leaves
            .iter()
            .map(|l| 2 * l.parts[0].n * l.parts[1].n)
            .sum()
    }
}

/// What one leaf must keep to.
pub(super) struct Demand {
    /// The surface's index, for messages.
    pub(super) surface: usize,
    pub(super) tol: f64,
    /// The fewest cells across each block along u and v.
    pub(super) least: [f64; 2],
    /// The largest number of triangles.
    pub(super) max: usize,
    /// True if only partners with the same parameters may be compared, so that the triangles may turn anyhow.
    pub(super) plain: bool,
}

/// What is known about a leaf.
#[derive(Clone, Copy)]
struct Verdict {
    cells: Option<[f64; 2]>,
    deviation: f64,
    /// The size of the piece of surface.
    size: f64,
    proven: bool,
    normal: Option<DVec3>,
}

impl Verdict {
    fn cost(&self) -> f64 {
        self.cells.map_or(f64::INFINITY, |[n, m]| n * m)
    }
}

type Judged = (Leaf, Verdict);

/// Judges the leaves of one block, each once: what a split promises is asked of parts that come up again.
struct Judge<'a> {
    surface: &'a dyn Surface,
    demand: &'a Demand,
    /// The block along u and v.
    range: [Interval; 2],
    known: HashMap<[(u64, u32); 2], Verdict>,
}

impl Judge<'_> {
    fn uv(&self, leaf: &Leaf) -> [Interval; 2] {
        [0, 1].map(|d| leaf.parts[d].range(self.range[d]))
    }

    fn can_split(&self, leaf: &Leaf, d: usize) -> bool {
        leaf.parts[d].can_split(self.range[d])
    }

    fn verdict(&mut self, leaf: &Leaf) -> Verdict {
        let uv = self.uv(leaf);
        let place = leaf.parts.map(|p| (p.k, p.depth));
        let Judge {
            surface, demand, ..
        } = *self;
        *self
            .known
            .entry(place)
            .or_insert_with(|| judge(surface, leaf, uv, demand))
    }

    /// The halves of a leaf along a direction.
    fn halves(&mut self, leaf: &Leaf, d: usize) -> (Judged, Judged) {
        let [a, b] = leaf.parts[d].halves().map(|part| {
            let mut l = *leaf;
            l.parts[d] = part;
            (l, self.verdict(&l))
        });
        (a, b)
    }
}

fn judge(surface: &dyn Surface, leaf: &Leaf, uv: [Interval; 2], demand: &Demand) -> Verdict {
    let least = [0, 1].map(|d| (demand.least[d] / (1u64 << leaf.parts[d].depth) as f64).ceil());
    let jet = surface.enclose(uv, 2);
    let depth = leaf.parts[0].depth + leaf.parts[1].depth;
    let (jet, proven, size) = if jet[0].is_finite() {
        let size = jet[0].diagonal();
        (Some(jet), true, size)
    } else if depth < PATIENCE {
        (None, true, f64::INFINITY)
    } else {
        (sampled(surface, uv), false, f64::INFINITY)
    };
    if size <= demand.tol {
        // All points of the leaf are that close to each other, whatever the derivatives.
        return Verdict {
            cells: Some(least),
            deviation: size,
            size,
            proven,
            normal: None,
        };
    }
    let grid = |bend: Bend| Some((bend.cells(demand.tol, least)?, bend));
    let cells = |found: &Option<([f64; 2], Bend)>| found.map_or(f64::INFINITY, |([n, m], _)| n * m);
    let mut found = None;
    if let Some(jet) = jet {
        let plain = Bend::new(&jet, uv);
        found = grid(plain);
        // The sharper bound is worth its enclosures if it could save cells.
        if proven && !demand.plain && cells(&found) > FEW {
            let worth = |bend: &Bend| cells(&grid(*bend)) < cells(&found);
            let sharper = slide(surface, uv, &jet, &plain, demand.tol, worth).and_then(grid);
            if cells(&sharper) < cells(&found) {
                found = sharper;
            }
        }
    }
    Verdict {
        cells: found.map(|(cells, _)| cells),
        deviation: found.map_or(f64::INFINITY, |([n, m], bend)| bend.deviation(n, m)),
        size,
        proven,
        normal: found.and_then(|(_, bend)| bend.normal),
    }
}

/// Cuts the domain along a direction where the surface is not C¹.
fn blocks(surface: &dyn Surface, dir: Dir, index: usize) -> Result<Vec<Interval>, MeshError> {
    let breaks = surface.breaks(dir);
    if let Some(at) = breaks.tear() {
        return Err(MeshError::Torn {
            surface: index,
            dir,
            at,
        });
    }
    let domain = breaks.domain();
    let mut cuts = vec![domain.lo];
    cuts.extend(breaks.below(1));
    cuts.push(domain.hi);
    Ok(cuts.windows(2).map(|w| Interval::new(w[0], w[1])).collect())
}

/// Divides a surface.
pub(super) fn layout(surface: &dyn Surface, demand: &Demand) -> Result<Layout, MeshError> {
    let blocks = [
        blocks(surface, Dir::U, demand.surface)?,
        blocks(surface, Dir::V, demand.surface)?,
    ];
    let mut out = Layout {
        blocks,
        leaves: Vec::new(),
        deviation: 0.0,
        proven: true,
    };
    let mut cells = 0.0;
    for bu in 0..out.blocks[0].len() {
        for bv in 0..out.blocks[1].len() {
            let whole = Leaf {
                block: [bu, bv],
                parts: [Part::WHOLE; 2],
                normal: None,
            };
            let mut judge = Judge {
                surface,
                demand,
                range: [out.blocks[0][bu], out.blocks[1][bv]],
                known: HashMap::new(),
            };
            let verdict = judge.verdict(&whole);
            let mut stack = vec![(whole, verdict)];
            while let Some((leaf, verdict)) = stack.pop() {
                let over = cells + stack.len() as f64;
                if 2.0 * over > demand.max as f64 {
                    return Err(MeshError::TooMany {
                        needed: 2.0 * over,
                        max: demand.max,
                    });
                }
                if let Some((a, b)) = split(&mut judge, &leaf, &verdict) {
                    stack.push(b);
                    stack.push(a);
                    continue;
                }
                let (n, deviation, proven) = match verdict.cells {
                    Some(n) => (n, verdict.deviation, verdict.proven),
                    // Nothing can be said, even about the smallest leaf.
                    None => ([1.0; 2], verdict.size, false),
                };
                cells += n[0] * n[1];
                out.proven &= proven;
                if deviation.is_finite() {
                    out.deviation = out.deviation.max(deviation);
                }
                let parts = [0, 1].map(|d| Part {
                    n: n[d] as usize,
                    ..leaf.parts[d]
                });
                let normal = verdict.normal;
                out.leaves.push(Leaf {
                    parts,
                    normal,
                    ..leaf
                });
            }
        }
    }
    if 2.0 * cells > demand.max as f64 {
        return Err(MeshError::TooMany {
            needed: 2.0 * cells,
            max: demand.max,
        });
    }
    Ok(out)
}

/// The two halves of a leaf if they need clearly fewer cells, or if nothing is proven about the whole.
fn split(judge: &mut Judge, leaf: &Leaf, verdict: &Verdict) -> Option<(Judged, Judged)> {
    if verdict.cost() <= FEW {
        return None;
    }
    let can = [0, 1].map(|d| judge.can_split(leaf, d));
    if verdict.cells.is_none() && can == [true; 2] {
        // Nothing is known yet: the direction that samples say is bent more, but no very thin leaves.
        let [du, dv] = [0, 1].map(|d| leaf.parts[d].depth);
        let uv = judge.uv(leaf);
        let bent_u = sampled(judge.surface, uv).is_none_or(|jet| Bend::new(&jet, uv).is_along_u());
        let d = usize::from(du >= dv + THIN || (!bent_u && dv < du + THIN));
        return Some(judge.halves(leaf, d));
    }
    let mut best: Option<(f64, f64, u32, (Judged, Judged))> = None;
    for d in 0..2 {
        if !can[d] {
            continue;
        }
        let (a, b) = judge.halves(leaf, d);
        let mut cost = a.1.cost() + b.1.cost();
        if cost > FEW {
            cost = cost.min(promised(judge, leaf, d));
        }
        let size = a.1.size.max(b.1.size);
        let depth = leaf.parts[d].depth;
        let better = match &best {
            None => true,
            Some((c, s, n, _)) => (cost, size, depth)
                .partial_cmp(&(*c, *s, *n))
                .is_some_and(|o| o.is_lt()),
        };
        if better {
            best = Some((cost, size, depth, (a, b)));
        }
    }
    let (cost, _, _, halves) = best?;
    (verdict.cells.is_none() || cost <= GAIN * verdict.cost()).then_some(halves)
}

/// The number of cells to be expected after a split along `d` and some more, if the smaller parts, one on the way down,
/// are like all others. One split alone may not be worth it where the second derivatives of a large piece vary in all
/// its parts alike, or where only small pieces have a plane to slide in.
fn promised(judge: &mut Judge, leaf: &Leaf, mut d: usize) -> f64 {
    let mut leaf = *leaf;
    let mut parts = 1.0;
    let mut best = f64::INFINITY;
    while judge.can_split(&leaf, d) {
        // Lower and upper halves in turn: parts from all over the piece.
        leaf.parts[d] = leaf.parts[d].halves()[usize::from(leaf.parts[d].depth.is_multiple_of(2))];
        let at = judge.verdict(&leaf);
        parts *= 2.0;
        best = best.min(parts * at.cost());
        let Some([n, m]) = at.cells.filter(|_| at.cost() > PROBED) else {
            break;
        };
        d = usize::from(m > n);
    }
    best
}
