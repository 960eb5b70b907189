//! Triangles of a region, each proven to be near the surface.

use super::chart::Chart;
use super::region::{Corner, Region, RegionError};
use crate::interval::{Interval, greater};
use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};
use spade::handles::{FixedFaceHandle, FixedVertexHandle, InnerTag};
use spade::{
    ConstrainedDelaunayTriangulation, HasPosition, HierarchyHintGenerator, Point2,
    PositionInTriangulation, Triangulation,
};
use std::collections::VecDeque;

/// A vertex: its place in the scaled plane, and its index.
struct Node {
    place: Point2<f64>,
    index: usize,
}

impl HasPosition for Node {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.place
    }
}

/// With a hierarchy of hints: places are looked for all over, and a walk through the thin triangles of a long border is long.
type Delaunay = ConstrainedDelaunayTriangulation<Node, (), (), (), HierarchyHintGenerator<f64>>;

/// Triangles with their parameters.
pub(super) struct Triangles {
    /// Parameters in the unrolled plane of u and v, and numbers of points.
    pub(super) vertices: Vec<([f64; 2], u32)>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The greatest distance of a triangle with corners on the surface.
    pub(super) bound: f64,
    pub(super) proven: bool,
}

/// Why there are none.
pub(super) enum Failure {
    Region(RegionError),
    TooMany(usize),
    NotReached(f64),
}

impl From<RegionError> for Failure {
    fn from(e: RegionError) -> Self {
        Failure::Region(e)
    }
}

/// Cells of this share of the tolerance give points inside: triangles between them are about as good.
const SHARE: f64 = 0.5;
/// The most cells: the triangles that are still too far are divided later.
const SEEDS: usize = 1 << 18;
/// Rounds of points put where triangles are too far.
const ROUNDS: usize = 60;
/// The least distance of points inside from the border, in cells.
const CLEAR: f64 = 0.3;
/// Rounds in which triangles that are turned over are divided: they only are where a surface is nearly a point.
const TURNED_ROUNDS: usize = 24;
/// Triangles with a smaller sine at a corner have no side that could be told.
const THIN: f64 = 1e-9;
/// The relative difference of areas that is rounding.
const SAME_AREA: f64 = 1e-7;

struct Work<'a> {
    chart: &'a Chart<'a>,
    region: &'a mut Region,
    origin: [f64; 2],
    scale: [f64; 2],
    nodes: Vec<([f64; 2], u32)>,
    cdt: Delaunay,
    /// How often polygons run along a constraint.
    walls: FxHashMap<[usize; 2], usize>,
    first: u32,
    shared: &'a [DVec3],
}

/// Triangles no farther than `allowed` from the surface, no more than `max`. Own points are added to the region's.
pub(super) fn triangulate(
    chart: &Chart,
    region: &mut Region,
    shared: &[DVec3],
    allowed: f64,
    max: usize,
) -> Result<Triangles, Failure> {
    let polygons = std::mem::take(&mut region.polygons);
    let (seeds, origin, scale) = seeds(chart, region, &polygons, SHARE * allowed, max)?;
    let mut work = Work {
        chart,
        region,
        origin,
        scale,
        nodes: Vec::new(),
        cdt: Delaunay::new(),
        walls: FxHashMap::default(),
        first: shared.len() as u32,
        shared,
    };
    work.border(&polygons)?;
    work.plant(&seeds);
    let triangles = work.refine(allowed, max);
    work.region.polygons = polygons;
    triangles
}

/// Places inside, the lower corner of the box around the polygons, and the scale of a plane whose cells are about square.
type Seeds = (Vec<[f64; 2]>, [f64; 2], [f64; 2]);

fn seeds(
    chart: &Chart,
    region: &Region,
    polygons: &[Vec<Corner>],
    allowed: f64,
    max: usize,
) -> Result<Seeds, Failure> {
    let plane = region.plane;
    let corners = || polygons.iter().flatten().map(|c| plane.uv(c.xy));
    let [us, vs] = [0, 1].map(|d| {
        let (lo, hi) = corners().fold((f64::MAX, f64::MIN), |(a, b), c| (a.min(c[d]), b.max(c[d])));
        let mut at = vec![lo];
        let lifts = match chart.period[d] {
            Some(p) => (-3..=3).map(|k| f64::from(k) * p).collect(),
            None => vec![0.0],
        };
        for c in chart.creases(d) {
            at.extend(lifts.iter().map(|l| c + l).filter(|&c| lo < c && c < hi));
        }
        at.push(hi);
        at.sort_by(f64::total_cmp);
        at.dedup();
        at
    });
    if us.len() < 2 || vs.len() < 2 {
        return Err(RegionError::Empty.into());
    }
    let whole = [[us[0], us[us.len() - 1]], [vs[0], vs[vs.len() - 1]]];
    let mut waiting: VecDeque<[Interval; 2]> = VecDeque::new();
    for u in us.windows(2) {
        for v in vs.windows(2) {
            waiting.push_back([Interval::new(u[0], u[1]), Interval::new(v[0], v[1])]);
        }
    }
    let (mut places, mut leaves, mut logs) = (FxHashSet::default(), 0usize, [0.0; 2]);
    let extent = whole.map(|[lo, hi]| hi - lo);
    // Level by level: what is left out is finer everywhere.
    while let Some(cell) = waiting.pop_front() {
        let enough = leaves + waiting.len() >= SEEDS.min(max);
        let bend = chart.cell(cell, allowed);
        let [a, b] = bend.terms;
        let fine = cell.map(|i| i.width() <= 1e-9 * (1.0 + i.mag()));
        if bend.bound > allowed && !(fine[0] || fine[1]) && !enough {
            let d = if a.is_finite() && b.is_finite() {
                usize::from(b > a)
            } else {
                // Nothing is known: by the shape.
                let [x, y] = [0, 1].map(|d| cell[d].width() / extent[d]);
                usize::from(y > x)
            };
            let mid = cell[d].mid();
            let mut halves = [cell; 2];
            halves[0][d].hi = mid;
            halves[1][d].lo = mid;
            waiting.extend(halves);
        } else {
            leaves += 1;
            logs = [0, 1].map(|d| logs[d] + cell[d].width().ln());
            for u in [cell[0].lo, cell[0].hi] {
                for v in [cell[1].lo, cell[1].hi] {
                    let p = [u, v];
                    if (0..2).all(|d| whole[d][0] < p[d] && p[d] < whole[d][1]) {
                        places.insert(p.map(f64::to_bits));
                    }
                }
            }
        }
    }
    let mut cell = logs.map(|l| (l / leaves as f64).exp());
    if leaves == (us.len() - 1) * (vs.len() - 1) {
        // Flat: triangles are shaped in space.
        let jet = chart.jet([0, 1].map(|d| 0.5 * (whole[d][0] + whole[d][1])), 1);
        let [a, b] = [jet[1].length(), jet[2].length()];
        if a > 0.0 && b > 0.0 {
            let unit = (cell[0] * a).max(cell[1] * b);
            cell = [unit / a, unit / b];
        }
    }
    let cell = plane.xy(cell).map(f64::abs);
    let mut places: Vec<[f64; 2]> = places
        .into_iter()
        .map(|p| plane.xy(p.map(f64::from_bits)))
        .collect();
    // A set has no order of its own.
    places.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let origin = plane.xy([whole[0][0], whole[1][0]]);
    Ok((places, origin, cell.map(|c| 1.0 / c)))
}

impl Work<'_> {
    fn place(&self, xy: [f64; 2]) -> Point2<f64> {
        let [x, y] = [0, 1].map(|d| {
            let x = (xy[d] - self.origin[d]) * self.scale[d];
            if x.abs() < 1e-30 { 0.0 } else { x }
        });
        Point2::new(x, y)
    }

    fn uv(&self, xy: [f64; 2]) -> [f64; 2] {
        self.region.plane.uv(xy)
    }

    /// Adds a vertex; `None` if another point is there, or no number.
    fn put(&mut self, xy: [f64; 2], id: u32) -> Option<FixedVertexHandle> {
        let index = self.nodes.len();
        let place = self.place(xy);
        let handle = self.cdt.insert(Node { place, index }).ok()?;
        if handle.index() == index {
            self.nodes.push((xy, id));
        } else {
            // The old vertex was replaced by the new one.
            self.cdt.vertex_data_mut(handle).index = handle.index();
            if self.nodes[handle.index()].1 != id {
                return None;
            }
        }
        Some(handle)
    }

    /// Puts the polygons in.
    fn border(&mut self, polygons: &[Vec<Corner>]) -> Result<(), Failure> {
        let mut area = 0.0;
        for polygon in polygons {
            let mut handles = Vec::with_capacity(polygon.len());
            for c in polygon {
                let uv = self.uv(c.xy);
                handles.push(self.put(c.xy, c.id).ok_or(RegionError::Touches { uv })?);
            }
            for (k, &a) in handles.iter().enumerate() {
                let b = handles[(k + 1) % handles.len()];
                let [p, q] = [a, b].map(|h| self.cdt.vertex(h).position());
                area += 0.5 * (p.x * q.y - q.x * p.y);
                if a == b {
                    continue;
                }
                let along = self.cdt.try_add_constraint(a, b);
                if along.is_empty() {
                    let uv = self.uv(polygon[k].xy);
                    return Err(RegionError::Crosses { uv }.into());
                }
                // Through another vertex: the neighbour's chord has none there.
                if along.len() > 1 {
                    let e = self.cdt.directed_edge(along[0]);
                    let ends = [e.from(), e.to()].map(|v| (v.fix(), v.index()));
                    let inner = ends
                        .iter()
                        .find(|(v, _)| *v != a)
                        .map_or(a.index(), |v| v.1);
                    let uv = self.uv(self.nodes[inner].0);
                    return Err(RegionError::Touches { uv }.into());
                }
                for e in along {
                    let e = self.cdt.directed_edge(e);
                    let [p, q] = [e.from().index(), e.to().index()];
                    *self.walls.entry([p.min(q), p.max(q)]).or_insert(0) += 1;
                }
            }
        }
        let inside = self.inside();
        let twice: f64 = self
            .cdt
            .inner_faces()
            .filter(|f| inside[f.index()])
            .map(|f| f.area())
            .sum();
        let uv = self.uv(polygons[0][0].xy);
        if area <= 0.0 || twice <= 0.0 {
            return Err(RegionError::Empty.into());
        }
        if (twice - area).abs() > SAME_AREA * (twice + area) {
            return Err(RegionError::Crosses { uv }.into());
        }
        Ok(())
    }

    /// For each face, numbered by its handle, whether it is in the region.
    fn inside(&self) -> Vec<bool> {
        let count = self.cdt.num_all_faces();
        let mut label: Vec<Option<bool>> = vec![None; count];
        label[self.cdt.outer_face().index()] = Some(false);
        let mut waiting: Vec<(FixedFaceHandle<InnerTag>, bool)> = Vec::new();
        let enter = |from: [usize; 2], own: bool| {
            let key = [from[0].min(from[1]), from[0].max(from[1])];
            own != (self.walls.get(&key).copied().unwrap_or(0) % 2 == 1)
        };
        for e in self.cdt.convex_hull() {
            // Outside is on the left of it.
            if let Some(f) = e.rev().face().as_inner() {
                let k = f.index();
                if label[k].is_none() {
                    label[k] = Some(enter([e.from().index(), e.to().index()], false));
                    waiting.push((f.fix(), label[k] == Some(true)));
                }
            }
        }
        while let Some((k, own)) = waiting.pop() {
            let face = self.cdt.face(k);
            for e in face.adjacent_edges() {
                if let Some(next) = e.rev().face().as_inner() {
                    let n = next.index();
                    if label[n].is_none() {
                        let side = enter([e.from().index(), e.to().index()], own);
                        label[n] = Some(side);
                        waiting.push((next.fix(), side));
                    }
                }
            }
        }
        label.into_iter().map(|l| l == Some(true)).collect()
    }

    /// Adds a point of the surface inside.
    fn add(&mut self, xy: [f64; 2]) {
        let point = self.chart.point(self.uv(xy));
        if !point.is_finite() {
            return;
        }
        let id = self.first + self.region.own.len() as u32;
        if self.put(xy, id).is_some() {
            self.region.own.push(point);
        }
    }

    /// Puts points inside that are not too near the border.
    fn plant(&mut self, seeds: &[[f64; 2]]) {
        let inside = self.inside();
        let clear = |&&xy: &&[f64; 2]| {
            let p = self.place(xy);
            let PositionInTriangulation::OnFace(face) = self.cdt.locate(p) else {
                return false;
            };
            let face = self.cdt.face(face);
            inside[face.index()]
                && face.adjacent_edges().iter().all(|e| {
                    let wall = e.is_constraint_edge();
                    let near = if wall {
                        e.distance_2(p)
                    } else {
                        let q = e.from().position();
                        (q.x - p.x).powi(2) + (q.y - p.y).powi(2)
                    };
                    near > CLEAR * CLEAR
                })
        };
        let seeds: Vec<[f64; 2]> = seeds.iter().filter(clear).copied().collect();
        for xy in seeds {
            self.add(xy);
        }
    }

    /// Whether a triangle is seen from behind where the normal of the surface in its middle points.
    fn is_turned_over(&self, t: [usize; 3]) -> bool {
        let p = t.map(|k| {
            let id = self.nodes[k].1;
            let own = id.checked_sub(self.first);
            own.map_or_else(|| self.shared[id as usize], |k| self.region.own[k as usize])
        });
        let normal = (p[1] - p[0]).cross(p[2] - p[0]);
        let [a, b] = [p[1] - p[0], p[2] - p[0]].map(DVec3::length);
        if normal.length() <= THIN * a * b {
            return false;
        }
        let uv = t.map(|k| self.uv(self.nodes[k].0));
        let middle = [0, 1].map(|d| (uv[0][d] + uv[1][d] + uv[2][d]) / 3.0);
        let jet = self.chart.jet(middle, 1);
        normal.dot(jet[1].cross(jet[2])) < 0.0
    }

    /// Adds points until all triangles are near enough.
    fn refine(&mut self, allowed: f64, max: usize) -> Result<Triangles, Failure> {
        let mut known: FxHashMap<[usize; 3], (f64, bool)> = FxHashMap::default();
        let mut turned: FxHashMap<[usize; 3], bool> = FxHashMap::default();
        for round in 0..ROUNDS {
            let inside = self.inside();
            let mut out = Triangles {
                vertices: Vec::new(),
                triangles: Vec::new(),
                bound: 0.0,
                proven: true,
            };
            let mut wanted: Vec<[f64; 2]> = Vec::new();
            // What is known of triangles that are no more is forgotten.
            let before = (std::mem::take(&mut known), std::mem::take(&mut turned));
            let mut halved: FxHashSet<[usize; 2]> = FxHashSet::default();
            for face in self.cdt.inner_faces().filter(|f| inside[f.index()]) {
                let t = face.vertices().map(|v| v.index());
                let mut key = t;
                key.sort_unstable();
                let corners = t.map(|k| self.nodes[k].0);
                let (bound, proven) = before.0.get(&key).copied().unwrap_or_else(|| {
                    let uv = corners.map(|c| self.region.plane.uv(c));
                    let bend = self.chart.triangle(uv, allowed);
                    (bend.bound, bend.proven)
                });
                known.insert(key, (bound, proven));
                out.proven &= proven;
                out.bound = greater(out.bound, bound);
                let is_turned = bound <= allowed && round < TURNED_ROUNDS && {
                    let again = before.1.get(&key).copied();
                    let again = again.unwrap_or_else(|| self.is_turned_over(t));
                    turned.insert(key, again);
                    again
                };
                if bound <= allowed && !is_turned {
                    out.triangles.push(t.map(|k| k as u32));
                    continue;
                }
                let longest = face
                    .adjacent_edges()
                    .into_iter()
                    .filter(|e| !e.is_constraint_edge())
                    .max_by(|a, b| a.length_2().total_cmp(&b.length_2()));
                let ends = match longest {
                    Some(e) => {
                        let [a, b] = [e.from().index(), e.to().index()];
                        if !halved.insert([a.min(b), a.max(b)]) {
                            continue;
                        }
                        vec![self.nodes[a].0, self.nodes[b].0]
                    }
                    None => corners.to_vec(),
                };
                let n = ends.len() as f64;
                wanted.push([0, 1].map(|d| ends.iter().map(|c| c[d]).sum::<f64>() / n));
            }
            if wanted.is_empty() {
                out.vertices = self
                    .nodes
                    .iter()
                    .map(|&(xy, id)| (self.uv(xy), id))
                    .collect();
                return Ok(out);
            }
            if out.triangles.len() + 2 * wanted.len() > max {
                return Err(Failure::TooMany(max));
            }
            let count = self.nodes.len();
            for xy in wanted {
                let free = match self.cdt.locate(self.place(xy)) {
                    PositionInTriangulation::OnFace(_) => true,
                    PositionInTriangulation::OnEdge(e) => {
                        !self.cdt.directed_edge(e).is_constraint_edge()
                    }
                    _ => false,
                };
                if free {
                    self.add(xy);
                }
            }
            if self.nodes.len() == count {
                return Err(Failure::NotReached(out.bound));
            }
        }
        Err(Failure::NotReached(f64::INFINITY))
    }
}
