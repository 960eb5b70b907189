//! The part of a surface inside loops, as polygons in the plane of the parameters.
//!
//! On a surface that closes, a loop may go around it: its polygon does not end where it began, but a period beside. Such
//! loops, and poles, are joined by cuts into one polygon that is closed in the unrolled plane. Both banks of a cut have the same points.

use super::chart::{Chart, Pole};
use super::cut::cut;
use glam::DVec3;

/// Why a face has no region.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RegionError {
    /// The ends of neighbouring edges are at different parameters.
    #[error(
        "loop {number} jumps in the parameters of the surface after its edge {after}: from {from:?} to {to:?}"
    )]
    Jump {
        /// The loop.
        number: usize,
        /// The position of the edge in it, seams left out.
        after: usize,
        /// The parameters where it ends.
        from: [f64; 2],
        /// The parameters where the next one starts.
        to: [f64; 2],
    },
    /// Nothing bounds the face.
    #[error("no loop bounds the face, and its surface is not closed")]
    Unbounded,
    /// Loops go around the surface in a way that leaves no region between them.
    #[error(
        "{forward} loops go around the surface one way and {backward} the other: no region is between them"
    )]
    Around {
        /// Loops in the direction of the parameter.
        forward: usize,
        /// Loops against it.
        backward: usize,
    },
    /// A loop goes around in both directions at once.
    #[error(
        "loop {number} goes around the surface {turns:?} times in u and v: that is not supported"
    )]
    Helix {
        /// The loop.
        number: usize,
        /// How often, in u and v.
        turns: [i32; 2],
    },
    /// No cut between the loops is free.
    #[error("the surface cannot be cut open between its loops: they touch or cross")]
    NoCut,
    /// Two points of the loops are at the same parameters.
    #[error("loops touch themselves or each other at (u, v) = ({}, {})", uv[0], uv[1])]
    Touches {
        /// The parameters.
        uv: [f64; 2],
    },
    /// Loops cross.
    #[error("loops cross themselves or each other near (u, v) = ({}, {})", uv[0], uv[1])]
    Crosses {
        /// The parameters.
        uv: [f64; 2],
    },
    /// The loops enclose nothing.
    #[error("the loops enclose no area in the parameters of the surface")]
    Empty,
}

/// How a polygon goes on from a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    /// Along an edge, between two of its parameters.
    Edge { edge: usize, t: [f64; 2] },
    /// Straight in the parameters.
    Straight,
}

/// A corner of a polygon.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// The parameters in the plane that is unrolled along x.
    pub(super) xy: [f64; 2],
    /// The number of the point of space.
    pub(super) id: u32,
    pub(super) step: Step,
}

/// An edge as a loop runs along it: parameters of the curve, of the surface, and numbers of the points.
pub(super) struct Run {
    pub(super) edge: usize,
    pub(super) t: Vec<f64>,
    pub(super) uv: Vec<[f64; 2]>,
    pub(super) ids: Vec<u32>,
}

/// The unrolled plane: the parameters, or turned by a quarter so that x is v.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub(super) turned: bool,
    pub(super) period: [Option<f64>; 2],
}

impl Plane {
    fn new(chart: &Chart, turned: bool) -> Self {
        let [u, v] = chart.period;
        let period = if turned { [v, u] } else { [u, v] };
        Self { turned, period }
    }

    pub(super) fn xy(self, [u, v]: [f64; 2]) -> [f64; 2] {
        if self.turned { [v, -u] } else { [u, v] }
    }

    pub(super) fn uv(self, [x, y]: [f64; 2]) -> [f64; 2] {
        if self.turned { [-y, x] } else { [x, y] }
    }

    /// A side at an end of x (`d` is 0) or y that is one point: its x or y.
    pub(super) fn pole(self, chart: &Chart, d: usize, upper: bool) -> Option<(Pole, f64)> {
        let across = if self.turned { 1 - d } else { d };
        // y is -u in a turned plane.
        let against = self.turned && d == 1;
        let sign = if against { -1.0 } else { 1.0 };
        let end = upper != against;
        let pole = chart
            .poles
            .iter()
            .find(|p| p.d == across && p.upper == end)?;
        Some((*pole, sign * pole.at))
    }
}

/// A loop in the plane.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    pub(super) corners: Vec<Corner>,
    /// By how much it ends beside its beginning.
    pub(super) shift: [f64; 2],
}

impl Chain {
    /// The same the other way round.
    pub(super) fn reversed(&self) -> Chain {
        let n = self.corners.len();
        let step = |s: Step| match s {
            Step::Edge { edge, t } => Step::Edge {
                edge,
                t: [t[1], t[0]],
            },
            Step::Straight => s,
        };
        let corners = (0..n)
            .map(|k| {
                let mut c = self.corners[n - 1 - k];
                // The way to the corner before.
                c.step = step(self.corners[(2 * n - 2 - k) % n].step);
                c
            })
            .collect();
        Chain {
            corners,
            shift: self.shift.map(|s| -s),
        }
    }

    pub(super) fn moved(&self, by: [f64; 2]) -> Chain {
        let mut new = self.clone();
        for c in &mut new.corners {
            c.xy = [c.xy[0] + by[0], c.xy[1] + by[1]];
        }
        new
    }

    /// Twice the area to the left, less that of the strip below if it goes around.
    fn area(&self) -> f64 {
        let o = self.corners[0].xy;
        let n = self.corners.len();
        let cross = |k: usize| {
            let (a, b) = (self.corners[k].xy, self.corners[(k + 1) % n].xy);
            (a[0] - o[0]) * (b[1] - o[1]) - (b[0] - o[0]) * (a[1] - o[1])
        };
        (0..n).map(cross).sum()
    }

    /// The mean of y over x, of a loop that goes around: how many corners there are says nothing.
    pub(super) fn mean_y(&self) -> f64 {
        let n = self.corners.len();
        let step = |k: usize| {
            let (a, mut b) = (self.corners[k].xy, self.corners[(k + 1) % n].xy);
            if k + 1 == n {
                b = [b[0] + self.shift[0], b[1] + self.shift[1]];
            }
            0.5 * (a[1] + b[1]) * (b[0] - a[0])
        };
        (0..n).map(step).sum::<f64>() / self.shift[0]
    }
}

/// A region of the plane: closed polygons with the inside on the left of them all.
pub(super) struct Region {
    pub(super) plane: Plane,
    pub(super) polygons: Vec<Vec<Corner>>,
    /// Points of the surface on cuts, numbered after those that are shared.
    pub(super) own: Vec<DVec3>,
    /// What is around poles.
    pub(super) fans: Vec<Fan>,
    /// Whether loops were turned round to bound anything.
    pub(super) turned_round: bool,
}

/// The triangles between a pole and a ring around it: polygons end at the ring. In the plane of the parameters
/// triangles with a corner in the pole may lie on the other side than in space; these do not.
pub(super) struct Fan {
    pub(super) pole: Pole,
    /// The y of the pole.
    pub(super) y: f64,
    pub(super) upper: bool,
    /// The ring in the direction of x, its first corner again at the end, a period on.
    pub(super) ring: Vec<([f64; 2], u32)>,
}

/// The region that runs bound; each loop with the region on its left.
///
/// `first` is the number of the first own point, `allowed` how far straight lines may be from the surface. Vertices within
/// `tol` of a pole may be that pole.
pub(super) fn region(
    chart: &Chart,
    loops: &[Vec<Run>],
    first: u32,
    [allowed, tol]: [f64; 2],
) -> Result<Region, RegionError> {
    let chains = |turned: bool| -> Result<(Plane, Vec<Chain>), RegionError> {
        let plane = Plane::new(chart, turned);
        let one = |(number, runs): (usize, &Vec<Run>)| chain(chart, plane, number, runs, tol);
        Ok((
            plane,
            loops
                .iter()
                .enumerate()
                .map(one)
                .collect::<Result<_, _>>()?,
        ))
    };
    let [u, v] = chart.period;
    let (mut plane, mut all) = chains(u.is_none() && v.is_some())?;
    if plane.period[1].is_some() && all.iter().any(|c| c.shift[1] != 0.0) {
        (plane, all) = chains(!plane.turned)?;
    }
    let turns =
        |c: &Chain| [0, 1].map(|d| plane.period[d].map_or(0, |p| (c.shift[d] / p).round() as i32));
    for (number, c) in all.iter().enumerate() {
        let turns = turns(c);
        if turns[1] != 0 || turns[0].abs() > 1 {
            return Err(RegionError::Helix { number, turns });
        }
    }
    let (around, mut flat): (Vec<Chain>, Vec<Chain>) =
        all.into_iter().partition(|c| turns(c)[0] != 0);
    let mut region = Region {
        plane,
        polygons: Vec::new(),
        own: Vec::new(),
        fans: Vec::new(),
        turned_round: false,
    };
    let closed = plane.period[0].is_some()
        && (plane.period[1].is_some()
            || [false, true]
                .iter()
                .all(|&end| plane.pole(chart, 1, end).is_some()));
    let largest = flat
        .iter()
        .map(Chain::area)
        .max_by(|a, b| a.abs().total_cmp(&b.abs()));
    if around.is_empty() && (!closed || largest.is_some_and(|a| a > 0.0)) {
        let largest = largest.ok_or(RegionError::Unbounded)?;
        if largest < 0.0 {
            region.turned_round = true;
            flat.iter_mut().for_each(|c| *c = c.reversed());
        }
        let k = (0..flat.len())
            .max_by(|&a, &b| flat[a].area().total_cmp(&flat[b].area()))
            .ok_or(RegionError::Unbounded)?;
        let outer = flat.swap_remove(k);
        region.polygons.push(outer.corners);
        // A hole that runs as if it were an outer loop.
        for hole in &mut flat {
            if hole.area() > 0.0
                && is_inside(
                    &region.polygons[0],
                    inside(&region, hole.clone()).corners[0].xy,
                )
            {
                region.turned_round = true;
                *hole = hole.reversed();
            }
        }
    } else {
        let [low, high] = ends(chart, around, &mut region, &flat, first, allowed)?;
        let outer = cut(chart, &mut region, [&low, &high], &mut flat, first, allowed)?;
        region.polygons.push(outer);
    }
    for hole in flat {
        let hole = inside(&region, hole);
        region.polygons.push(hole.corners);
    }
    Ok(region)
}

/// The loops that go around at the lower and at the upper end of the region, or what stands for them.
fn ends(
    chart: &Chart,
    around: Vec<Chain>,
    region: &mut Region,
    flat: &[Chain],
    first: u32,
    allowed: f64,
) -> Result<[Chain; 2], RegionError> {
    let plane = region.plane;
    let period = plane.period[0].unwrap_or(0.0);
    let (mut plus, mut minus): (Vec<Chain>, Vec<Chain>) =
        around.into_iter().partition(|c| c.shift[0] > 0.0);
    let wrong = RegionError::Around {
        forward: plus.len(),
        backward: minus.len(),
    };
    let has = |upper: bool| plane.pole(chart, 1, upper).is_some();
    // How near the loops come to an end.
    let ys: Vec<f64> = plus
        .iter()
        .chain(&minus)
        .chain(flat)
        .flat_map(|c| &c.corners)
        .map(|c| c.xy[1])
        .collect();
    let line = |region: &mut Region, upper: bool| {
        let (_, y) = plane.pole(chart, 1, upper)?;
        let reach = ys
            .iter()
            .map(|o| (y - o).abs())
            .fold(f64::INFINITY, f64::min);
        ring(chart, region, upper, [period, reach], first, allowed)
    };
    // Two that go the same way: one of them was written the wrong way round.
    for swapped in [false, true] {
        let (from, to) = if swapped {
            (&mut minus, &mut plus)
        } else {
            (&mut plus, &mut minus)
        };
        if from.len() == 2 && to.is_empty() {
            let k = usize::from((from[1].mean_y() > from[0].mean_y()) != swapped);
            to.push(from.remove(k).reversed());
            region.turned_round = true;
        }
    }
    match (plus.pop(), minus.pop()) {
        (Some(low), Some(mut high)) if plus.is_empty() && minus.is_empty() => {
            let mut gap = high.mean_y() - low.mean_y();
            if let Some(p) = plane.period[1] {
                let turns = (gap / p).floor();
                gap -= turns * p;
                high = high.moved([0.0, -turns * p]);
            }
            if gap < 0.0 {
                region.turned_round = true;
                return Ok([high.reversed(), low.reversed()]);
            }
            Ok([low, high])
        }
        (Some(low), None) if plus.is_empty() => {
            if let Some(high) = line(region, true) {
                return Ok([low, high]);
            }
            region.turned_round = has(false);
            Ok([line(region, false).ok_or(wrong)?, low.reversed()])
        }
        (None, Some(high)) if minus.is_empty() => {
            if let Some(low) = line(region, false) {
                return Ok([low, high]);
            }
            region.turned_round = has(true);
            let low = high.reversed();
            Ok([low, line(region, true).ok_or(wrong)?])
        }
        (None, None) => {
            if has(false)
                && has(true)
                && let (Some(low), Some(high)) = (line(region, false), line(region, true))
            {
                return Ok([low, high]);
            }
            let around = plane.period[1].ok_or(RegionError::Unbounded)?;
            circle(chart, region, flat, [period, around], first, allowed)
        }
        _ => Err(wrong),
    }
}

/// The fewest and the most parts of a pole or of a circle that cuts a torus.
const PARTS: [usize; 2] = [8, 1024];

/// Parts of a line along x over one period, no part of which bends by more than allowed, nor does what is beside it.
fn parts(chart: &Chart, plane: Plane, x: f64, y: [f64; 2], period: f64, allowed: f64) -> usize {
    let fits = |n: usize| {
        let all = n.min(RING);
        (0..all).all(|k| {
            let x = x + period * k as f64 / all as f64;
            let [a, b] = [[x, y[0]], [x + period / n as f64, y[1]]].map(|p| plane.uv(p));
            let over = [0, 1].map(|d| crate::Interval::new(a[d].min(b[d]), a[d].max(b[d])));
            chart.cell(over, allowed).bound <= allowed
        })
    };
    let mut n = PARTS[0];
    while n < PARTS[1] && !fits(n) {
        n *= 2;
    }
    n
}

/// The most parts of a ring around a pole; nearer to it fewer are enough.
const RING: usize = 64;

/// A ring around the side that is a point, as a chain: below in the direction of x, above against it. No loop is nearer
/// than `reach`.
fn ring(
    chart: &Chart,
    region: &mut Region,
    upper: bool,
    [period, reach]: [f64; 2],
    first: u32,
    allowed: f64,
) -> Option<Chain> {
    let plane = region.plane;
    let (pole, y) = plane.pole(chart, 1, upper)?;
    let x = plane.xy([chart.domain[0].lo, chart.domain[1].lo])[0];
    let mut height = 0.5 * reach.min(0.5 * chart.domain[pole.d].width());
    let inwards = if upper { -1.0 } else { 1.0 };
    let mut n = PARTS[1];
    for _ in 0..HALVINGS {
        n = parts(chart, plane, x, [y, y + inwards * height], period, allowed);
        if n <= RING {
            break;
        }
        height *= 0.5;
    }
    let at = y + inwards * height;
    let mut corners = Vec::with_capacity(n);
    for i in 0..n {
        let xy = [x + period * i as f64 / n as f64, at];
        let id = first + region.own.len() as u32;
        region.own.push(chart.point(plane.uv(xy)));
        corners.push(Corner {
            xy,
            id,
            step: Step::Straight,
        });
    }
    let mut around: Vec<([f64; 2], u32)> = corners.iter().map(|c| (c.xy, c.id)).collect();
    around.push(([x + period, at], corners[0].id));
    region.fans.push(Fan {
        pole,
        y,
        upper,
        ring: around,
    });
    let low = Chain {
        corners,
        shift: [period, 0.0],
    };
    Some(if upper {
        low.reversed().moved([period, 0.0])
    } else {
        low
    })
}

/// A ring is brought nearer to its pole at most this often.
const HALVINGS: usize = 40;

/// A circle around a torus on which no loop is, twice.
fn circle(
    chart: &Chart,
    region: &mut Region,
    flat: &[Chain],
    [period, around]: [f64; 2],
    first: u32,
    allowed: f64,
) -> Result<[Chain; 2], RegionError> {
    let plane = region.plane;
    let start = plane.xy([0, 1].map(|d| chart.domain[d].lo));
    let mut taken: Vec<[f64; 2]> = Vec::new();
    for c in flat {
        let ys = c.corners.iter().map(|c| c.xy[1]);
        let (lo, hi) = ys.fold((f64::MAX, f64::MIN), |(a, b), y| (a.min(y), b.max(y)));
        if hi - lo >= around {
            return Err(RegionError::NoCut);
        }
        let at = (lo - start[1]).rem_euclid(around);
        taken.push([at, at + hi - lo]);
    }
    taken.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let y = match taken.first().copied() {
        None => 0.0,
        Some(lowest) => {
            // Between the highest end so far and the next start.
            let mut best = (0.0, 0.0);
            let mut end = taken.iter().map(|t| t[1] - around).fold(f64::MIN, f64::max);
            for t in taken.iter().chain([&[lowest[0] + around; 2]]) {
                if t[0] - end > best.0 {
                    best = (t[0] - end, 0.5 * (t[0] + end));
                }
                end = end.max(t[1]);
            }
            if best.0 <= 1e-6 * around {
                return Err(RegionError::NoCut);
            }
            best.1
        }
    };
    let (x, y) = (start[0], start[1] + y);
    let n = parts(chart, plane, x, [y, y], period, allowed);
    let corner = |i: usize| {
        let xy = [x + period * i as f64 / n as f64, y];
        (xy, chart.point(plane.uv(xy)))
    };
    let mut corners = Vec::new();
    for (xy, p) in (0..n).map(corner) {
        let id = first + region.own.len() as u32;
        region.own.push(p);
        corners.push(Corner {
            xy,
            id,
            step: Step::Straight,
        });
    }
    let low = Chain {
        corners,
        shift: [period, 0.0],
    };
    let high = low.reversed().moved([period, around]);
    Ok([low, high])
}

/// The lift of a hole that is inside the first polygon; itself if there is none.
fn inside(region: &Region, hole: Chain) -> Chain {
    let lifts = |d: usize| match region.plane.period[d] {
        Some(p) => (-3..=3).map(|k| f64::from(k) * p).collect(),
        None => vec![0.0],
    };
    for x in lifts(0) {
        for y in lifts(1) {
            let lift = hole.moved([x, y]);
            if is_inside(&region.polygons[0], lift.corners[0].xy) {
                return lift;
            }
        }
    }
    hole
}

/// Whether a ray upwards leaves a polygon an odd number of times.
fn is_inside(polygon: &[Corner], p: [f64; 2]) -> bool {
    let n = polygon.len();
    let crossings = (0..n).filter(|&k| {
        let (a, b) = (polygon[k].xy, polygon[(k + 1) % n].xy);
        (a[0] > p[0]) != (b[0] > p[0])
            && p[1] < a[1] + (b[1] - a[1]) * (p[0] - a[0]) / (b[0] - a[0])
    });
    crossings.count() % 2 == 1
}

/// Ends of neighbouring edges may differ by this share of the domain.
const JUMP: f64 = 0.02;
/// Within this share of the domain of a side that is a point, a vertex is that point.
const AT_POLE: f64 = 1e-6;

/// A loop in the plane.
fn chain(
    chart: &Chart,
    plane: Plane,
    number: usize,
    runs: &[Run],
    tol: f64,
) -> Result<Chain, RegionError> {
    let domain = chart.domain.map(|d| d.width());
    let width = if plane.turned {
        [domain[1], domain[0]]
    } else {
        domain
    };
    let mut corners: Vec<Corner> = Vec::new();
    let mut shift = [0.0; 2];
    for (after, run) in runs.iter().enumerate() {
        let last = run.uv.len() - 1;
        for k in 0..last {
            let xy = plane.xy(run.uv[k]);
            corners.push(Corner {
                xy: [xy[0] + shift[0], xy[1] + shift[1]],
                id: run.ids[k],
                step: Step::Edge {
                    edge: run.edge,
                    t: [run.t[k], run.t[k + 1]],
                },
            });
        }
        let end = plane.xy(run.uv[last]);
        let end = [end[0] + shift[0], end[1] + shift[1]];
        let next = plane.xy(runs.get(after + 1).map_or(runs[0].uv[0], |r| r.uv[0]));
        let mut to = [0, 1].map(|d| match plane.period[d] {
            Some(p) => next[d] + ((end[d] - next[d]) / p).round() * p,
            None => next[d],
        });
        let jumps = (0..2).any(|d| (to[d] - end[d]).abs() > JUMP * width[d]);
        // Where x has a period only y ends in poles; without one either may.
        let ends = [(1, false), (1, true), (0, false), (0, true)];
        let pole = ends.into_iter().find_map(|(d, upper)| {
            let (pole, at) = plane.pole(chart, d, upper)?;
            let near = (end[d] - at).abs() <= AT_POLE * width[d];
            // A vertex that is a little off, from where edges go on in different directions.
            let far = || chart.point(plane.uv(end)).distance(pole.point);
            (near || (jumps && far() <= tol)).then_some((d, upper, at))
        });
        if let Some((d, upper, at)) = pole {
            let along = 1 - d;
            if let Some(p) = plane.period[along] {
                // The face is on the left, so a pole above it is passed against x.
                let way = if upper { -1.0 } else { 1.0 };
                let by = (way * (next[along] - end[along])).rem_euclid(p);
                let by = if by <= AT_POLE * p { p } else { by };
                to[along] = end[along] + way * by;
            }
            let way = to[along] - end[along];
            let steps = ((way.abs() / width[along] * 16.0).ceil() as usize).max(1);
            for i in 0..steps {
                let mut xy = [at; 2];
                xy[along] = end[along] + way * i as f64 / steps as f64;
                corners.push(Corner {
                    xy,
                    id: run.ids[last],
                    step: Step::Straight,
                });
            }
        } else if jumps {
            return Err(RegionError::Jump {
                number,
                after,
                from: plane.uv(end),
                to: plane.uv(to),
            });
        }
        // By whole periods only: what ends differ by is no move of the rest.
        shift =
            [0, 1].map(|d| plane.period[d].map_or(0.0, |p| ((to[d] - next[d]) / p).round() * p));
    }
    Ok(Chain { corners, shift })
}
