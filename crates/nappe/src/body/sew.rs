//! Surfaces that are sewn along their sides.

use super::{Body, Coedge, Edge, Face, Loop, Vertex};
use crate::clusters::Sets;
use crate::curve::{CurveRef, Isocurve, Trimmed};
use crate::interval::Interval;
use crate::measure::{inside_out, tear};
use crate::mesh::shared::{Edge as Line, ends};
use crate::mesh::{Joints, PartialJoint, joints, partial_joints};
use crate::surface::{Side, SurfaceRef};
use glam::DVec3;
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// Surfaces sewn to a body.
#[derive(Clone, Debug, Default)]
pub struct Sewn {
    /// The body: face i is surface i.
    pub body: Body,
    /// The greatest distance between partners along shared edges (sampled); each edge's tolerance says its own.
    pub gap: f64,
    /// Sides that run along each other but do not share an edge, as more than two do there.
    pub unsewn: Vec<PartialJoint>,
    /// The shells whose faces cannot agree, as on a Möbius strip.
    pub one_sided: Vec<usize>,
}

/// Sews whole surfaces: sides that agree within `weld` (as [`joints`] finds them, so never more than a share of the
/// surfaces themselves, and at least within rounding) become one edge, the curve of the first of them. A seam is an edge
/// that its face uses twice; a side that is one point is no edge, and only a vertex. Where a side meets
/// parts of others, edges end there.
///
/// Shells are what hangs together along edges of two faces. Faces are turned (`forward` is false, loops run backwards) to
/// agree with the first of their shell, and so that normals point out of closed shells. Shells inside each other are not
/// looked for: the normals of a hollow point into it only if that is asked for elsewhere.
///
/// Sampled: which sides agree, and how well. Cost: some hundred points for each side, and a volume for closed shells.
pub fn sew(surfaces: &[SurfaceRef], weld: f64) -> Sewn {
    let far = surfaces
        .iter()
        .flat_map(|s| s.bounds(s.domain()).to_array());
    let far = far
        .map(Interval::mag)
        .filter(|m| m.is_finite())
        .fold(0.0, f64::max);
    let weld = weld.max(ROUNDING * far);
    let joined = joints(surfaces, weld);
    let partial = partial_joints(surfaces, &joined, weld);
    let mut sides = Sides::new(surfaces, &joined);
    let unsewn = sides.join_parts(partial, weld);
    let mut gap = joined.joints.iter().map(|j| j.gap).fold(0.0, f64::max);
    gap = sides.twins.values().map(|t| t.gap).fold(gap, f64::max);
    let mut sewn = Sewn {
        body: sides.body(),
        gap,
        unsewn,
        one_sided: Vec::new(),
    };
    let shells = super::shells(&sewn.body);
    for (k, found) in shells.into_iter().enumerate() {
        if found.one_sided {
            sewn.one_sided.push(k);
        }
        let mut shell = found.shell;
        let own = || shell.faces.iter().map(|&(f, kept)| (&surfaces[f], !kept));
        shell.closed &= own().all(|(s, _)| tear(s.as_ref()).is_none());
        let inward = shell.closed && inside_out(own());
        for (face, kept) in &mut shell.faces {
            if *kept == inward {
                sewn.body.faces[*face].turn();
            }
            *kept = true;
        }
        sewn.body.shells.push(shell);
    }
    sewn
}

/// What [`sew`] makes of surfaces that meet along whole sides only, without shells: the mesh of the surfaces joins the same.
pub(super) fn sides(surfaces: &[SurfaceRef], weld: f64) -> Body {
    Sides::new(surfaces, &joints(surfaces, weld)).body()
}

/// The relative error of two points, as a share of the largest coordinate.
const ROUNDING: f64 = 2e-13;

/// A part of a side, between two of its cuts: the side's number and the cut's.
type Segment = (usize, usize);

/// What leads a segment.
#[derive(Clone, Copy)]
struct Twin {
    leader: Segment,
    reversed: bool,
    gap: f64,
}

/// Where a side is cut.
#[derive(Clone, Copy)]
struct Cut {
    t: f64,
    node: usize,
}

/// The sides of all surfaces, numbered 4 × surface + side, cut into segments.
struct Sides<'a> {
    surfaces: &'a [SurfaceRef],
    collapsed: Vec<bool>,
    /// Whether a side meets nothing as a whole.
    open: Vec<bool>,
    /// The ends of each side and what is between, increasing.
    cuts: Vec<Vec<Cut>>,
    /// The points of corners (4 × surface + corner) and of cuts.
    points: Vec<DVec3>,
    /// Pairs of these that are the same.
    same: Vec<[usize; 2]>,
    twins: FxHashMap<Segment, Twin>,
}

impl<'a> Sides<'a> {
    fn new(surfaces: &'a [SurfaceRef], joined: &Joints) -> Self {
        let count = 4 * surfaces.len();
        let mut new = Self {
            surfaces,
            collapsed: vec![false; count],
            open: vec![false; count],
            cuts: Vec::with_capacity(count),
            points: vec![DVec3::ZERO; count],
            same: Vec::new(),
            twins: FxHashMap::default(),
        };
        for k in 0..count {
            let (line, [a, b]) = (new.line(k), ends(k));
            let cut = |t: f64, node: usize| (Cut { t, node }, line.point(t));
            let [(first, p), (last, q)] = [cut(line.range.lo, a), cut(line.range.hi, b)];
            new.points[a] = p;
            new.points[b] = q;
            new.cuts.push(vec![first, last]);
            let (surface, side) = (k / 4, Side::ALL[k % 4]);
            new.collapsed[k] = joined.collapsed[surface].contains(&side);
            new.open[k] = joined.open[surface].contains(&side);
            if new.collapsed[k] {
                new.same.push([a, b]);
            }
        }
        for j in &joined.joints {
            let [a, b] = [j.first, j.second].map(|(surface, side)| 4 * surface + side as usize);
            new.share((a, 0), (b, 0), j.reversed, j.gap);
        }
        new
    }

    fn line(&self, k: usize) -> Line<'a> {
        Line::new(self.surfaces[k / 4].as_ref(), Side::ALL[k % 4])
    }

    /// The nodes at the ends of a segment.
    fn nodes(&self, (side, k): Segment) -> [usize; 2] {
        [self.cuts[side][k].node, self.cuts[side][k + 1].node]
    }

    /// Makes two segments one edge.
    fn share(&mut self, leader: Segment, follower: Segment, reversed: bool, gap: f64) {
        let ([a, b], [p, q]) = (self.nodes(leader), self.nodes(follower));
        let [p, q] = if reversed { [q, p] } else { [p, q] };
        self.same.extend([[a, p], [b, q]]);
        let twin = Twin {
            leader,
            reversed,
            gap,
        };
        self.twins.insert(follower, twin);
    }

    /// Cuts sides where parts of them meet, and joins the parts; returns what cannot be joined so.
    fn join_parts(&mut self, partial: Vec<PartialJoint>, weld: f64) -> Vec<PartialJoint> {
        let number = |(surface, side): (usize, Side)| 4 * surface + side as usize;
        // Cuts first, all of them: a long side may meet many.
        for j in &partial {
            let [part, along] = [number(j.part), number(j.along)];
            if self.open[part] && self.open[along] {
                for [on_part, on_along] in j.stretches.iter().flatten() {
                    for t in [on_part.lo, on_part.hi] {
                        self.cut(part, t, weld);
                    }
                    for t in [on_along.lo, on_along.hi] {
                        self.cut(along, t, weld);
                    }
                }
            }
        }
        let mut taken: FxHashMap<Segment, ()> = FxHashMap::default();
        let mut left = Vec::new();
        for j in partial {
            let [part, along] = [number(j.part), number(j.along)];
            let pair = |&[on_part, on_along]: &[Interval; 2]| {
                let pair = [
                    (part, self.segment(part, on_part, weld)?),
                    (along, self.segment(along, on_along, weld)?),
                ];
                (!pair.iter().any(|s| taken.contains_key(s))).then_some(pair)
            };
            let open = self.open[part] && self.open[along] && part != along;
            let pairs: Option<Vec<[Segment; 2]>> = j.stretches.iter().flatten().map(pair).collect();
            match pairs.filter(|p| open && !p.is_empty()) {
                None => left.push(j),
                Some(pairs) => {
                    for pair in pairs {
                        taken.extend(pair.map(|s| (s, ())));
                        let [leader, follower] = if part < along {
                            pair
                        } else {
                            [pair[1], pair[0]]
                        };
                        let reversed = self.is_reversed(leader, follower);
                        self.share(leader, follower, reversed, j.gap);
                    }
                }
            }
        }
        left
    }

    /// Cuts a side, unless there is a cut no farther than `weld`.
    fn cut(&mut self, side: usize, t: f64, weld: f64) {
        if self.near(side, t, weld).is_some() {
            return;
        }
        let node = self.points.len();
        self.points.push(self.line(side).point(t));
        let cuts = &mut self.cuts[side];
        let k = cuts.partition_point(|c| c.t < t);
        cuts.insert(k, Cut { t, node });
    }

    /// The cut of a side at a parameter: its points are no farther than `weld` from that.
    fn near(&self, side: usize, t: f64, weld: f64) -> Option<usize> {
        let (p, cuts) = (self.line(side).point(t), &self.cuts[side]);
        let after = cuts.partition_point(|c| c.t < t).min(cuts.len() - 1);
        let both = [after.saturating_sub(1), after];
        // Of a closed side both ends are near: the parameters decide.
        let near = both
            .into_iter()
            .filter(|&k| self.points[cuts[k].node].distance(p) <= weld);
        near.min_by(|&a, &b| (cuts[a].t - t).abs().total_cmp(&(cuts[b].t - t).abs()))
    }

    /// The segment that is a range of a side.
    fn segment(&self, side: usize, range: Interval, weld: f64) -> Option<usize> {
        let [a, b] = [range.lo, range.hi].map(|t| self.near(side, t, weld));
        let (a, b) = (a?, b?);
        (a + 1 == b).then_some(a)
    }

    /// Whether two segments along each other run in opposite directions.
    fn is_reversed(&self, a: Segment, b: Segment) -> bool {
        let points = |(side, k): Segment| {
            let ([from, to], line) = (
                [self.cuts[side][k].t, self.cuts[side][k + 1].t],
                self.line(side),
            );
            let at = move |i: usize| from + (to - from) * i as f64 / WAY as f64;
            (0..=WAY)
                .map(move |i| line.point(at(i)))
                .collect::<Vec<_>>()
        };
        let (a, b) = (points(a), points(b));
        let nearest = |p: DVec3| {
            let distance = |k: &usize| b[*k].distance_squared(p);
            (0..=WAY).min_by(|x, y| distance(x).total_cmp(&distance(y)))
        };
        nearest(a[WAY / 4]) > nearest(a[3 * WAY / 4])
    }

    /// The vertices, edges and faces.
    fn body(&self) -> Body {
        let mut sets = Sets::new(self.points.len());
        self.same.iter().for_each(|&[a, b]| sets.unite(a, b));
        let mut body = Body::default();
        let mut vertices: FxHashMap<usize, usize> = FxHashMap::default();
        let mut edges: FxHashMap<Segment, usize> = FxHashMap::default();
        // Leaders come before what follows them.
        for side in (0..self.collapsed.len()).filter(|&k| !self.collapsed[k]) {
            for k in 0..self.cuts[side].len() - 1 {
                let segment = (side, k);
                let nodes = self.nodes(segment);
                if let Some(twin) = self.twins.get(&segment) {
                    let edge = edges[&twin.leader];
                    body.edges[edge].tolerance = body.edges[edge].tolerance.max(twin.gap);
                    edges.insert(segment, edge);
                    continue;
                }
                let ends = nodes.map(|node| {
                    *vertices.entry(sets.leader(node)).or_insert_with(|| {
                        let point = self.points[sets.leader(node)];
                        body.vertices.push(Vertex { point });
                        body.vertices.len() - 1
                    })
                });
                let curve = self.curve(segment);
                let off = [0, 1].map(|e| curve.ends()[e].distance(body.vertices[ends[e]].point));
                edges.insert(segment, body.edges.len());
                body.edges.push(Edge {
                    curve,
                    vertices: ends,
                    tolerance: off[0].max(off[1]),
                });
            }
        }
        for (i, surface) in self.surfaces.iter().enumerate() {
            let mut coedges = Vec::new();
            // Counter-clockwise in the plane of the parameters.
            for (side, forward) in [
                (Side::South, true),
                (Side::East, true),
                (Side::North, false),
                (Side::West, false),
            ] {
                let side = 4 * i + side as usize;
                if self.collapsed[side] {
                    continue;
                }
                let along = (0..self.cuts[side].len() - 1).map(|k| {
                    let reversed = self.twins.get(&(side, k)).is_some_and(|t| t.reversed);
                    Coedge {
                        edge: edges[&(side, k)],
                        forward: forward != reversed,
                    }
                });
                if forward {
                    coedges.extend(along);
                } else {
                    coedges.extend(along.rev());
                }
            }
            // All sides points: the whole surface is closed.
            let loops = if coedges.is_empty() {
                Vec::new()
            } else {
                vec![Loop::Edges(coedges)]
            };
            body.faces.push(Face {
                surface: surface.clone(),
                forward: true,
                loops,
            });
        }
        body
    }

    fn curve(&self, (side, k): Segment) -> CurveRef {
        let cuts = &self.cuts[side];
        let whole: CurveRef = Arc::new(Isocurve::side(
            self.surfaces[side / 4].clone(),
            Side::ALL[side % 4],
        ));
        if cuts.len() == 2 {
            return whole;
        }
        match Trimmed::new(whole.clone(), cuts[k].t, cuts[k + 1].t) {
            Ok(part) => Arc::new(part),
            // Cuts are different parameters of the side.
            Err(_) => whole,
        }
    }
}

/// Parts in which the direction of segments is looked for.
const WAY: usize = 32;
