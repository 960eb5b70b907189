//! Sides that run along each other but are not joined, because they do not have the same ends.

use super::closing::within;
use super::shared::{Edge, GUESSES, edge, find};
use crate::box3::Box3;
use crate::interval::Interval;
use crate::parallel;
use crate::surface::{Side, SurfaceRef};
use glam::DVec3;
use std::sync::OnceLock;

/// Samples of the shorter side.
const SAMPLES: usize = 32;
/// The fewest steps between samples that have partners one after the other: sides that only meet in a corner have fewer.
const LEAST: usize = 2;
/// In units of the distance within which sides meet: shorter stretches are as good as one point.
const LONG: f64 = 4.0;

/// A stretch of one side that runs along another side without being joined to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartialJoint {
    /// The surface and the side along which the other lies.
    pub along: (usize, Side),
    /// The surface and the side of which a greater part lies on the other.
    pub part: (usize, Side),
    /// The ends of the stretch as parameters of `part`, to a thirty-second of it.
    pub range: Interval,
    /// The partners of these ends on `along`.
    pub partners: [f64; 2],
    /// The points there.
    pub ends: [DVec3; 2],
    /// The greatest distance found between partners (sampled).
    pub gap: f64,
    /// True if both sides are closed and all of `part` lies on the other: they only start at different points.
    pub closed: bool,
}

/// Finds the sides that run along each other within `weld` but are not the same curve from end to end: a long side that
/// two shorter ones meet, or closed sides that start at different points. At least one of the two meets nothing as a
/// whole ([`joints`](super::joints)). [`mesh`](super::mesh) does not join them: it has two borders there.
///
/// Sampled: a stretch shorter than a sixteenth of both sides is not seen, nor one that ends in the middle of both. Cost: a
/// hundred points of each side, and 10³ for each pair whose boxes meet.
pub fn partial_joints(surfaces: &[SurfaceRef], weld: f64) -> Vec<PartialJoint> {
    let threads = parallel::all_threads();
    let shared = find(surfaces, weld, threads);
    let mut open: Vec<bool> = shared.joins.iter().map(Option::is_none).collect();
    for join in shared.joins.iter().flatten() {
        open[join.leader] = false;
    }
    let of_surface = |i: usize| {
        let within = within(surfaces[i].as_ref(), weld);
        let line = |k: usize| Line::new(edge(surfaces, k), k, within[k % 4].join);
        let lines: Vec<Line> = (4 * i..4 * i + 4)
            .filter(|&k| !shared.collapsed[k])
            .map(line)
            .collect();
        lines
    };
    let lines = parallel::each(threads, surfaces.len(), of_surface, |_| false);
    let mut lines: Vec<Line> = lines.into_iter().flatten().collect();
    lines.sort_by(|a, b| a.hull.x.lo.total_cmp(&b.hull.x.lo));
    let is_open = |i: &usize| open[lines[*i].number];
    let all: Vec<usize> = (0..lines.len()).collect();
    let open: Vec<usize> = all.iter().copied().filter(is_open).collect();
    // The stretches along which a line and later ones, of which one is open, lie on each other.
    let along = |i: usize| {
        let a = &lines[i];
        let others = if is_open(&i) { &all } else { &open };
        let later = others[others.partition_point(|&j| j <= i)..].iter();
        let near = later
            .map(|&j| &lines[j])
            .take_while(|b| b.hull.x.lo <= a.hull.x.hi)
            .filter(|b| a.hull.touches(b.hull));
        let joint = |b: &Line| {
            let (first, second) = if a.number < b.number { (a, b) } else { (b, a) };
            let within = a.within.min(b.within);
            let both = [second.on(first, within), first.on(second, within)];
            let share = |s: &Option<(f64, PartialJoint)>| s.as_ref().map_or(0.0, |s| s.0);
            let [x, y] = both;
            let longer = if share(&y) > share(&x) { y } else { x };
            longer.map(|(_, joint)| joint)
        };
        near.filter_map(joint).collect::<Vec<_>>()
    };
    let found = parallel::each(threads, lines.len(), along, |_| false);
    let mut found: Vec<PartialJoint> = found.into_iter().flatten().collect();
    found.sort_by_key(|j| [j.along, j.part].map(|(surface, side)| (surface, side as usize)));
    found
}

/// A side with samples.
struct Line<'a> {
    number: usize,
    edge: Edge<'a>,
    /// Samples, once another line is near: all of them together would be larger than the mesh.
    points: OnceLock<Vec<DVec3>>,
    /// A box around it, wide enough for whatever meets it.
    hull: Box3,
    within: f64,
    closed: bool,
}

impl<'a> Line<'a> {
    fn new(edge: Edge<'a>, number: usize, within: f64) -> Self {
        let points = edge.points(&edge.parts(SAMPLES));
        // Between samples the side may leave the box of its samples, by about as much as they are apart.
        let steps = points.windows(2).map(|p| p[0].distance(p[1]));
        let margin = within + steps.fold(0.0, f64::max);
        let hull = Box3::around(points.iter().copied()).unwrap_or(Box3::ZERO);
        Self {
            hull: hull.inflate(margin),
            closed: points[0].distance(points[points.len() - 1]) <= within,
            number,
            edge,
            points: OnceLock::new(),
            within,
        }
    }

    fn points(&self) -> &[DVec3] {
        self.points
            .get_or_init(|| self.edge.points(&self.edge.parts(GUESSES)))
    }

    fn name(&self) -> (usize, Side) {
        (self.number / 4, self.edge.side)
    }

    /// The parameter of the nearest point.
    fn nearest(&self, p: DVec3) -> f64 {
        let points = self.points();
        let distance = |k: &usize| points[*k].distance_squared(p);
        let best = (0..points.len())
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .unwrap_or(0);
        let at = |k: usize| self.edge.sample(k.min(GUESSES), GUESSES);
        let range = Interval::new(at(best.saturating_sub(1)), at(best + 1));
        self.edge.nearest(p, at(best), range)
    }

    /// The longest stretch of this side that lies on another one, and its share of this side.
    fn on(&self, other: &Line, within: f64) -> Option<(f64, PartialJoint)> {
        let samples: Vec<(f64, DVec3, f64, f64)> = (0..=SAMPLES)
            .map(|k| {
                let t = self.edge.sample(k, SAMPLES);
                let p = self.edge.point(t);
                let partner = other.nearest(p);
                (t, p, partner, other.edge.point(partner).distance(p))
            })
            .collect();
        let runs = samples.chunk_by(|a, b| (a.3 <= within) == (b.3 <= within));
        let mut first = 0;
        let (from, stretch) = runs
            .map(|run| {
                first += run.len();
                (first - run.len(), run)
            })
            .filter(|(_, run)| run[0].3 <= within && run.len() > LEAST)
            .max_by_key(|(_, run)| run.len())?;
        // Sides that touch part in the middle of both; those that run along each other do so until one of them ends.
        let ends_there = |next: Option<&(f64, DVec3, f64, f64)>| {
            next.is_none_or(|s| s.2 <= other.edge.range.lo || s.2 >= other.edge.range.hi)
        };
        let before = from.checked_sub(1).and_then(|k| samples.get(k));
        if !ends_there(before) || !ends_there(samples.get(from + stretch.len())) {
            return None;
        }
        let length: f64 = stretch.windows(2).map(|s| s[0].1.distance(s[1].1)).sum();
        if length <= LONG * within {
            return None;
        }
        let [a, b] = [stretch[0], stretch[stretch.len() - 1]];
        let joint = PartialJoint {
            along: other.name(),
            part: self.name(),
            range: Interval::new(a.0, b.0),
            partners: [a.2, b.2],
            ends: [a.1, b.1],
            gap: stretch.iter().fold(0.0, |gap, s| s.3.max(gap)),
            closed: self.closed && other.closed && stretch.len() == samples.len(),
        };
        Some((stretch.len() as f64 / samples.len() as f64, joint))
    }
}
