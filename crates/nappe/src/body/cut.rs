//! A surface cut open between two loops that go around it.

use super::chart::Chart;
use super::region::{Chain, Corner, Region, RegionError, Step};

/// Corners of each loop between which cuts are tried, and cuts tried for each pair of loops.
const ENDS: usize = 48;
const TRIED: usize = 400;
/// A part of a cut is halved at most this often.
const DEPTH: usize = 20;
/// The lifts of loops that may be in the way.
const LIFTS: [f64; 5] = [-2.0, -1.0, 0.0, 1.0, 2.0];

/// A loop that cuts may end at: its lift, and how it was reached.
struct Node {
    chain: Chain,
    /// The index of the hole that it is a lift of; none for the loops at the ends.
    hole: Option<usize>,
    /// The node it was reached from, the corner there and the corner here.
    from: Option<(usize, usize, usize)>,
}

/// One polygon of the loops at the lower and upper end of a region, and of the holes that the cut passes through, which
/// are taken out of `holes`.
pub(super) fn cut(
    chart: &Chart,
    region: &mut Region,
    [low, high]: [&Chain; 2],
    holes: &mut Vec<Chain>,
    first: u32,
    allowed: f64,
) -> Result<Vec<Corner>, RegionError> {
    let period = low.shift[0];
    let walls = walls(low, high, holes, period);
    let scale = scale(low, high, period);
    let mut nodes = vec![Node {
        chain: low.clone(),
        hole: None,
        from: None,
    }];
    let mut next = 0;
    let mut reached: Vec<bool> = vec![false; holes.len()];
    let end = loop {
        if next == nodes.len() {
            return Err(RegionError::NoCut);
        }
        // The upper end first: most often there is nothing between.
        if let Some((i, j, lift)) = link(&nodes[next].chain, high, &walls, scale, period) {
            break Node {
                chain: high.moved([lift, 0.0]),
                hole: None,
                from: Some((next, i, j)),
            };
        }
        for k in 0..holes.len() {
            if reached[k] {
                continue;
            }
            if let Some((i, j, lift)) = link(&nodes[next].chain, &holes[k], &walls, scale, period) {
                reached[k] = true;
                nodes.push(Node {
                    chain: holes[k].moved([lift, 0.0]),
                    hole: Some(k),
                    from: Some((next, i, j)),
                });
            }
        }
        next += 1;
    };
    // The way from the upper end down to the lower one.
    let mut way = vec![end];
    while let Some((from, ..)) = way[way.len() - 1].from {
        let node = &mut nodes[from];
        let node = Node {
            chain: std::mem::replace(
                &mut node.chain,
                Chain {
                    corners: Vec::new(),
                    shift: [0.0; 2],
                },
            ),
            hole: node.hole,
            from: node.from,
        };
        way.push(node);
    }
    way.reverse();
    let polygon = joined(chart, region, &way, period, first, allowed);
    let mut taken: Vec<usize> = way.iter().filter_map(|n| n.hole).collect();
    taken.sort_unstable();
    for k in taken.into_iter().rev() {
        holes.remove(k);
    }
    Ok(polygon)
}

/// The polygon: along the lower end, up one bank of the cut, along the upper end, down the other bank.
fn joined(
    chart: &Chart,
    region: &mut Region,
    way: &[Node],
    period: f64,
    first: u32,
    allowed: f64,
) -> Vec<Corner> {
    let last = way.len() - 1;
    // Where the cut leaves each loop, and where it comes to it.
    let leaves = |k: usize| way[k + 1].from.map_or(0, |f| f.1);
    let comes = |k: usize| way[k].from.map_or(0, |f| f.2);
    let at = |k: usize, i: usize| way[k].chain.corners[i];
    let cuts: Vec<Vec<([f64; 2], u32)>> = (0..last)
        .map(|k| {
            let (a, b) = (at(k, leaves(k)).xy, at(k + 1, comes(k + 1)).xy);
            line(chart, region, [a, b], first, allowed)
        })
        .collect();
    let mut polygon = Vec::new();
    let mut put = |mut c: Corner, x: f64| {
        c.xy[0] += x;
        polygon.push(c);
    };
    let straight = |(xy, id): ([f64; 2], u32)| Corner {
        xy,
        id,
        step: Step::Straight,
    };
    let end = |c: Corner| straight((c.xy, c.id));
    // A loop from a corner on, all around and beyond its end by its shift; without the last corner.
    let around = |k: usize, from: usize| {
        let chain = &way[k].chain;
        let n = chain.corners.len();
        (0..n).map(move |i| {
            let mut c = chain.corners[(from + i) % n];
            if from + i >= n {
                c.xy = [c.xy[0] + chain.shift[0], c.xy[1] + chain.shift[1]];
            }
            c
        })
    };
    let arc = |k: usize, from: usize, to: usize| {
        let n = way[k].chain.corners.len();
        let count = (to + n - from) % n;
        (0..count).map(move |i| way[k].chain.corners[(from + i) % n])
    };
    around(0, leaves(0)).for_each(|c| put(c, 0.0));
    put(end(at(0, leaves(0))), period);
    for k in 0..last {
        cuts[k].iter().for_each(|&c| put(straight(c), period));
        if k + 1 < last {
            arc(k + 1, comes(k + 1), leaves(k + 1)).for_each(|c| put(c, period));
            put(end(at(k + 1, leaves(k + 1))), period);
        }
    }
    around(last, comes(last)).for_each(|c| put(c, period));
    put(end(at(last, comes(last))), 0.0);
    for k in (0..last).rev() {
        cuts[k].iter().rev().for_each(|&c| put(straight(c), 0.0));
        if k > 0 {
            arc(k, leaves(k), comes(k)).for_each(|c| put(c, 0.0));
            put(end(at(k, comes(k))), 0.0);
        }
    }
    polygon
}

/// Points between the ends of a straight line in the plane, as many as the surface is bent.
fn line(
    chart: &Chart,
    region: &mut Region,
    [a, b]: [[f64; 2]; 2],
    first: u32,
    allowed: f64,
) -> Vec<([f64; 2], u32)> {
    let at = |s: f64| [0, 1].map(|d| a[d] + (b[d] - a[d]) * s);
    let mut parts = Vec::new();
    let mut waiting = vec![(0.0, 1.0, 0)];
    while let Some((s, t, depth)) = waiting.pop() {
        let [p, q] = [at(s), at(t)].map(|xy| region.plane.uv(xy));
        if depth < 1 || (depth < DEPTH && chart.chord([p, q], allowed).bound > allowed) {
            let m = 0.5 * (s + t);
            waiting.push((m, t, depth + 1));
            waiting.push((s, m, depth + 1));
        } else if t < 1.0 {
            parts.push(t);
        }
    }
    let mut points = Vec::with_capacity(parts.len());
    for s in parts {
        let xy = at(s);
        points.push((xy, first + region.own.len() as u32));
        region.own.push(chart.point(region.plane.uv(xy)));
    }
    points
}

type Segment = [[f64; 2]; 2];

/// All sides of all loops, in all lifts that may be in the way.
fn walls(low: &Chain, high: &Chain, holes: &[Chain], period: f64) -> Vec<Segment> {
    let mut walls = Vec::new();
    for chain in [low, high].into_iter().chain(holes) {
        let n = chain.corners.len();
        for k in 0..n {
            let a = chain.corners[k].xy;
            let mut b = chain.corners[(k + 1) % n].xy;
            if k + 1 == n {
                b = [b[0] + chain.shift[0], b[1] + chain.shift[1]];
            }
            for lift in LIFTS {
                walls.push([a, b].map(|p| [p[0] + lift * period, p[1]]));
            }
        }
    }
    walls
}

/// What lengths along x and y are measured in.
fn scale(low: &Chain, high: &Chain, period: f64) -> [f64; 2] {
    let ys = low.corners.iter().chain(&high.corners).map(|c| c.xy[1]);
    let (lo, hi) = ys.fold((f64::MAX, f64::MIN), |(a, b), y| (a.min(y), b.max(y)));
    [1.0 / period, 1.0 / (hi - lo).max(1e-12 * period)]
}

/// The shortest free way between some corners of two loops, with the lift of the second.
fn link(
    a: &Chain,
    b: &Chain,
    walls: &[Segment],
    scale: [f64; 2],
    period: f64,
) -> Option<(usize, usize, f64)> {
    let few = |n: usize| (0..n.min(ENDS)).map(move |k| k * n / n.min(ENDS));
    let mut ways = Vec::new();
    for i in few(a.corners.len()) {
        for j in few(b.corners.len()) {
            let (p, q) = (a.corners[i].xy, b.corners[j].xy);
            let lift = ((p[0] - q[0]) / period).round() * period;
            let d = [scale[0] * (q[0] + lift - p[0]), scale[1] * (q[1] - p[1])];
            ways.push((d[0] * d[0] + d[1] * d[1], i, j, lift));
        }
    }
    ways.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    let free = |&&(_, i, j, lift): &&(f64, usize, usize, f64)| {
        let (p, q) = (a.corners[i].xy, b.corners[j].xy);
        let way = [p, [q[0] + lift, q[1]]];
        let inside = leaves_left(a, i, way[1]) && leaves_left(b, j, [p[0] - lift, p[1]]);
        inside && !walls.iter().any(|w| meets(way, *w))
    };
    let found = ways.iter().take(TRIED).find(free)?;
    Some((found.1, found.2, found.3))
}

/// Whether a way from a corner of a loop goes to its left.
fn leaves_left(chain: &Chain, i: usize, to: [f64; 2]) -> bool {
    let n = chain.corners.len();
    let p = chain.corners[i].xy;
    let mut next = chain.corners[(i + 1) % n].xy;
    if i + 1 == n {
        next = [next[0] + chain.shift[0], next[1] + chain.shift[1]];
    }
    let mut before = chain.corners[(i + n - 1) % n].xy;
    if i == 0 {
        before = [before[0] - chain.shift[0], before[1] - chain.shift[1]];
    }
    let [ahead, back] = [side([p, next], to), side([before, p], to)];
    if side([before, p], next) >= 0.0 {
        // A corner that sticks out: inside of both sides.
        ahead > 0.0 && back > 0.0
    } else {
        ahead > 0.0 || back > 0.0
    }
}

/// On which side of a line a point is: positive on the left.
fn side([a, b]: Segment, p: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
}

/// Whether a way meets a wall other than with its own ends.
fn meets(way: Segment, wall: Segment) -> bool {
    let near = |p: [f64; 2], q: [f64; 2]| {
        (0..2).all(|d| (p[d] - q[d]).abs() <= 1e-12 * (p[d].abs() + q[d].abs()))
    };
    if way.iter().any(|&p| wall.iter().any(|&q| near(p, q))) {
        return false;
    }
    let [a, b] = wall.map(|p| side(way, p));
    let [c, d] = way.map(|p| side(wall, p));
    // What only touches is in the way too.
    let apart = |a: f64, b: f64| (a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0);
    !apart(a, b) && !apart(c, d)
}
