//! Edges as polylines that all faces share, fine enough for each of them.

use super::chart::Chart;
use super::{Body, Coedge, Face, Loop};
use crate::interval::greater;
use crate::mesh::{Certainty, flatten};
use glam::DVec3;
use rustc_hash::FxHashMap;

/// An edge as a polyline: parameters and points, those at the ends being the vertices.
#[derive(Clone, Debug)]
pub(super) struct Flat {
    pub(super) t: Vec<f64>,
    pub(super) points: Vec<DVec3>,
    /// How far the curve is from its chords and its ends from the vertices.
    pub(super) deviation: Certainty,
}

/// The most points of an edge.
pub(super) const MOST: usize = 1 << 18;
/// The fewest chords of a closed curved edge, and of another one: two arcs may bound a face.
const LEAST: [usize; 2] = [6, 2];

/// An edge within `tol`; in error what is wrong with it.
pub(super) fn flat(body: &Body, edge: usize, tol: f64, rounding: f64) -> Result<Flat, String> {
    let e = &body.edges[edge];
    let curve = e.curve.as_ref();
    let line = flatten(curve, tol, MOST).map_err(|e| e.to_string())?;
    let [a, b] = e.vertices;
    let mut new = Flat {
        t: line.parameters,
        points: line.points,
        deviation: line.deviation,
    };
    let chords = new.t.len() - 1;
    let bent = new.deviation.error() > 16.0 * rounding || chords > 1 || a == b;
    let least = if a == b { LEAST[0] } else { LEAST[1] };
    if bent && chords < least {
        let each = least.div_ceil(chords);
        let old = std::mem::take(&mut new.t);
        for w in old.windows(2) {
            new.t
                .extend((0..each).map(|k| w[0] + (w[1] - w[0]) * k as f64 / each as f64));
        }
        new.t.extend(old.last());
        new.points = new.t.iter().map(|&t| curve.point(t)).collect();
    }
    let last = new.points.len() - 1;
    let ends = [(0, a), (last, b)].map(|(k, v)| {
        let vertex = body.vertices[v].point;
        let off = new.points[k].distance(vertex);
        new.points[k] = vertex;
        off
    });
    let e = new.deviation.error() + ends[0].max(ends[1]);
    new.deviation = match new.deviation {
        Certainty::Estimated(_) => Certainty::Estimated(e),
        _ => Certainty::Bounded(e),
    };
    Ok(new)
}

impl Flat {
    /// Whether all of it is within a distance of its first point, as an edge at a pole.
    pub(super) fn is_point(&self, near: f64) -> bool {
        let far = self.points.iter().map(|p| p.distance(self.points[0]));
        far.fold(self.deviation.error(), greater) <= near
    }

    /// Halves some chords, by increasing index.
    pub(super) fn halve(&mut self, chords: &[usize], curve: &dyn crate::Curve) {
        let mut next = chords.iter().copied().peekable();
        let (mut t, mut points) = (Vec::new(), Vec::new());
        for k in 0..self.t.len() {
            t.push(self.t[k]);
            points.push(self.points[k]);
            if next.next_if_eq(&k).is_some() && k + 1 < self.t.len() {
                let m = 0.5 * (self.t[k] + self.t[k + 1]);
                if self.t[k] < m && m < self.t[k + 1] {
                    t.push(m);
                    points.push(curve.point(m));
                }
            }
        }
        (self.t, self.points) = (t, points);
    }
}

/// The parameters of an edge's points on a surface, one after the other without jumps by periods.
#[derive(Clone, Debug)]
pub(super) struct Trace {
    pub(super) uv: Vec<[f64; 2]>,
    /// The distances of the points from the surface.
    pub(super) off: Vec<f64>,
}

/// A point is looked for anew if it is farther from the surface than its neighbour by this share of the chord.
const LOST: f64 = 0.25;

/// Follows an edge on a surface, from its middle: ends may be at poles, where one parameter says nothing.
pub(super) fn trace(chart: &Chart, flat: &Flat) -> Trace {
    let count = flat.points.len();
    let middle = count / 2;
    let mut uv = vec![[0.0; 2]; count];
    let mut off = vec![0.0; count];
    (uv[middle], off[middle]) = if count == 2 {
        // Both are vertices: one inside tells where the parameters are.
        chart.find(0.5 * (flat.points[0] + flat.points[1]))
    } else {
        chart.find(flat.points[middle])
    };
    let mut follow = |k: usize, from: usize, before: Option<usize>| {
        let p = flat.points[k];
        let last = uv[from];
        // Along the same way, as far as the points go.
        let guess = before.map_or(last, |b| {
            let steps = [
                p.distance(flat.points[from]),
                flat.points[from].distance(flat.points[b]),
            ];
            let share = if steps[1] > 0.0 {
                (steps[0] / steps[1]).min(2.0)
            } else {
                0.0
            };
            [0, 1].map(|d| last[d] + share * (last[d] - uv[b][d]))
        });
        let mut best = chart.nearest(p, guess);
        let mut distance = chart.point(best).distance(p);
        let step = p.distance(flat.points[from]);
        if distance > off[from] + LOST * step + 1e-12 * chart.size {
            for other in [chart.nearest(p, last), chart.find(p).0] {
                let d = chart.point(other).distance(p);
                if d < distance {
                    (best, distance) = (other, d);
                }
            }
        }
        uv[k] = [0, 1].map(|d| match chart.period[d] {
            Some(period) => best[d] + ((last[d] - best[d]) / period).round() * period,
            None => best[d],
        });
        off[k] = distance;
    };
    if count == 2 {
        follow(0, 1, None);
        follow(1, 0, None);
        follow(0, 1, None);
    } else {
        for k in middle + 1..count {
            follow(k, k - 1, (k >= middle + 2).then(|| k - 2));
        }
        for k in (0..middle).rev() {
            follow(k, k + 1, Some(k + 2));
        }
    }
    Trace { uv, off }
}

/// The chords over which a surface bends by more than allowed.
pub(super) fn coarse(chart: &Chart, trace: &Trace, allowed: f64) -> Vec<usize> {
    let far = |k: &usize| {
        let ends = [trace.uv[*k], trace.uv[*k + 1]];
        chart.chord(ends, allowed).bound > allowed
    };
    (0..trace.uv.len() - 1).filter(far).collect()
}

/// The loops of a face as it lies in the parameters, without seams: edges that it uses twice, in both directions. Its
/// surface goes on across them.
pub(super) fn without_seams(face: &Face) -> Vec<Vec<Coedge>> {
    let mut face = face.clone();
    if !face.forward {
        face.turn();
    }
    let mut places: FxHashMap<usize, Vec<(usize, usize, bool)>> = FxHashMap::default();
    for (i, l) in face.loops.iter().enumerate() {
        if let Loop::Edges(coedges) = l {
            for (k, c) in coedges.iter().enumerate() {
                places.entry(c.edge).or_default().push((i, k, c.forward));
            }
        }
    }
    let list = |i: usize| match &face.loops[i] {
        Loop::Edges(coedges) => &coedges[..],
        Loop::Vertex(_) => &[],
    };
    // The other use of a seam.
    let twin = |i: usize, k: usize| match places[&list(i)[k].edge][..] {
        [a, b] if a.2 != b.2 => Some(if (a.0, a.1) == (i, k) { b } else { a }),
        _ => None,
    };
    let next = |i: usize, k: usize| (i, (k + 1) % list(i).len());
    let mut done: Vec<Vec<bool>> = (0..face.loops.len())
        .map(|i| vec![false; list(i).len()])
        .collect();
    let mut loops = Vec::new();
    for i in 0..face.loops.len() {
        for k in 0..list(i).len() {
            if done[i][k] || twin(i, k).is_some() {
                continue;
            }
            let mut own = Vec::new();
            let mut at = (i, k);
            while !done[at.0][at.1] {
                done[at.0][at.1] = true;
                own.push(list(at.0)[at.1]);
                at = next(at.0, at.1);
                // Over a seam, the loop goes on where the other bank ends.
                while let Some((i, k, _)) = twin(at.0, at.1) {
                    at = next(i, k);
                }
            }
            loops.push(own);
        }
    }
    loops
}
