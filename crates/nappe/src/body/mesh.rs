//! Certified triangles of trimmed faces.

use super::chart::Chart;
use super::flat::{Flat, MOST, Trace, coarse, flat, trace, without_seams};
use super::region::{Region, RegionError, Run, region};
use super::triangulate::{Failure, Triangles, triangulate};
use super::whole::whole;
use super::{Body, BodyError, Coedge};
use crate::box3::Box3;
use crate::breaks::inwards;
use crate::interval::greater;
use crate::measure::tear;
use crate::mesh::{Certainty, Mesh, MeshError, MeshOptions, MeshPatch, MeshVertex};
use crate::parallel;
use crate::surface::{Dir, normal_at};
use glam::DVec3;
use rustc_hash::FxHashMap;
use thiserror::Error;

/// The triangles of a body.
#[derive(Clone, Debug, Default)]
pub struct Meshed {
    /// Patch i is that of face i; empty if the face has no mesh.
    pub mesh: Mesh,
    /// The faces without a mesh, and why.
    pub failed: Vec<(usize, FaceError)>,
    /// Faces of which loops run the wrong way round: they were turned to bound anything.
    pub turned_round: Vec<usize>,
}

/// Why a body has no mesh.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BodyMeshError {
    /// The body is not sound.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// What is asked for cannot be.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// Why a face has no mesh.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FaceError {
    /// The loops bound no region of the surface.
    #[error(transparent)]
    Region(#[from] RegionError),
    /// An edge has no polyline.
    #[error("edge {edge}: {why}")]
    Edge {
        /// The edge.
        edge: usize,
        /// What is wrong with it.
        why: String,
    },
    /// An edge is not on the surface.
    #[error("edge {edge} is {distance:e} away from the surface, more than {allowed:e}")]
    Off {
        /// The edge.
        edge: usize,
        /// How far a point of it is from the surface.
        distance: f64,
        /// How far it may be.
        allowed: f64,
    },
    /// The surface jumps.
    #[error("the surface is torn at {} = {at}: split it there", if *dir == Dir::U { 'u' } else { 'v' })]
    Torn {
        /// Which parameter.
        dir: Dir,
        /// Where.
        at: f64,
    },
    /// A point of the surface is not finite.
    #[error("the surface has no finite point at (u, v) = ({}, {})", uv[0], uv[1])]
    NotFinite {
        /// The parameters.
        uv: [f64; 2],
    },
    /// Too many triangles would be needed.
    #[error("more than {max} triangles are needed: raise the tolerance or the limit")]
    TooMany {
        /// The limit.
        max: usize,
    },
    /// The tolerance is not reached.
    #[error("triangles stay {deviation:e} away from the surface: the surface is too irregular")]
    NotReached {
        /// What is reached.
        deviation: f64,
    },
}

/// Shares of the tolerance: for an edge and its chords, for a surface and chords in it, and for triangles.
const EDGE: f64 = 0.25;
const CHORD: f64 = 0.25;
const TRIANGLE: f64 = 0.9;
/// Rounds in which chords are halved.
const ROUNDS: usize = 40;
/// An edge that is farther from a surface than this share of the surface's size, and than the tolerances, is not on it.
const OFF: f64 = 0.01;
/// As for meshes of surfaces.
const ROUNDING: f64 = 1e-13;
const SMALLEST: f64 = 8.0;
const DEFAULT_TOL: f64 = 1e-3;
const DEFAULT_WELD: f64 = 0.05;
const LARGEST_WELD: f64 = 0.25;

/// Triangles of every face, watertight along shared edges: each edge is one polyline, whose points all its faces share.
///
/// `options` are as for [`mesh`](crate::mesh::mesh), but for `least_cells`, which is not used. Loops may go around
/// surfaces that close, faces may contain poles; seams are no borders. A face without loops is its whole surface, which must be
/// closed. A face that has no mesh is in [`Meshed::failed`], and its patch is empty.
///
/// A body of whole surfaces with the edges that [`sew`](super::sew) gives within the weld distance has the mesh of its surfaces.
///
/// What the deviation of a patch says: triangles and the part of the surface inside the polygon of the border's points,
/// in the parameters, are within it of each other, both ways; and every point of an edge is within it of the
/// border and of the surface. [`Certainty::Bounded`] is a proof from enclosed second derivatives (see `body/bend.rs`), and includes how far
/// the edges are from the surface at their points: it is more than the tolerance only by that. [`Certainty::Estimated`] means
/// that a curve or surface could not enclose itself somewhere, or that sides seem to meet, or to be one point, and no proof was found.
///
/// # Errors
/// See [`BodyMeshError`].
pub fn mesh(body: &Body, options: &MeshOptions) -> Result<Meshed, BodyMeshError> {
    let lengths = Lengths::new(body, options)?;
    match whole(body, options, lengths) {
        Some(meshed) => Ok(meshed),
        None => Ok(Task::new(body, options)?.build()),
    }
}

/// A box around the body: points of its edges, and faces without edges.
pub(super) fn hull(body: &Body) -> Box3 {
    const POINTS: usize = 16;
    let on_edges = body.edges.iter().flat_map(|e| {
        let d = e.curve.domain();
        (0..=POINTS).map(move |k| {
            e.curve
                .point(d.lo + (d.hi - d.lo) * k as f64 / POINTS as f64)
        })
    });
    let vertices = body.vertices.iter().map(|v| v.point);
    let all = Box3::around(on_edges.chain(vertices).filter(|p| p.is_finite()));
    let closed = body.faces.iter().filter(|f| without_seams(f).is_empty());
    let boxes = closed.map(|f| f.surface.bounds(f.surface.domain()));
    boxes
        .filter(|b| b.is_finite())
        .chain(all)
        .reduce(Box3::hull)
        .unwrap_or(Box3::ZERO)
}

/// The tolerance, the weld distance in it, and the error of points.
#[derive(Clone, Copy)]
pub(super) struct Lengths {
    pub(super) tol: f64,
    pub(super) weld: f64,
    rounding: f64,
}

impl Lengths {
    fn new(body: &Body, options: &MeshOptions) -> Result<Self, BodyMeshError> {
        body.validate(f64::INFINITY)?;
        let hull = hull(body);
        let tol = options.tol.unwrap_or(DEFAULT_TOL * hull.diagonal());
        if !(tol > 0.0 && tol.is_finite()) {
            return Err(MeshError::Tolerance { tol }.into());
        }
        let far = hull.to_array().iter().fold(0.0f64, |a, i| a.max(i.mag()));
        let rounding = ROUNDING * far;
        let smallest = SMALLEST * rounding;
        if tol < smallest {
            return Err(MeshError::TooFine { tol, smallest }.into());
        }
        let weld = options.weld.unwrap_or(DEFAULT_WELD * tol);
        if !(0.0..=LARGEST_WELD * tol).contains(&weld) {
            return Err(MeshError::Weld { weld, tol }.into());
        }
        let weld = weld.max(2.0 * rounding);
        Ok(Self {
            tol,
            weld,
            rounding,
        })
    }
}

pub(super) struct Task<'a> {
    pub(super) body: &'a Body,
    pub(super) tol: f64,
    weld: f64,
    rounding: f64,
    max: usize,
    pub(super) charts: Vec<Chart<'a>>,
    pub(super) loops: Vec<Vec<Vec<Coedge>>>,
    flats: Vec<Result<Flat, String>>,
    /// For each face its edges on its surface.
    traces: Vec<FxHashMap<usize, Trace>>,
    /// The number of the first point inside each edge.
    starts: Vec<u32>,
    threads: usize,
}

/// The mesh of a face, with its own points numbered after those that are shared.
struct Patch {
    patch: MeshPatch,
    own: Vec<DVec3>,
    turned_round: bool,
}

impl<'a> Task<'a> {
    /// Follows all edges on all their surfaces.
    pub(super) fn new(body: &'a Body, options: &MeshOptions) -> Result<Self, BodyMeshError> {
        let Lengths {
            tol,
            weld,
            rounding,
        } = Lengths::new(body, options)?;
        let threads = options.threads.unwrap_or_else(parallel::all_threads);
        let charts = parallel::each(
            threads,
            body.faces.len(),
            |i| Chart::new(body.faces[i].surface.as_ref(), weld),
            |_| false,
        );
        let mut task = Task {
            body,
            tol,
            weld,
            rounding,
            max: options.max_triangles,
            charts,
            loops: body.faces.iter().map(without_seams).collect(),
            flats: Vec::new(),
            traces: Vec::new(),
            starts: Vec::new(),
            threads,
        };
        task.follow();
        Ok(task)
    }

    /// Makes the polylines fine enough for all faces, and numbers their points.
    fn follow(&mut self) {
        let body = self.body;
        let one = |e: usize| flat(body, e, EDGE * self.tol, self.rounding);
        self.flats = parallel::each(self.threads, body.edges.len(), one, |_| false);
        self.traces = vec![FxHashMap::default(); body.faces.len()];
        let mut changed = vec![true; body.edges.len()];
        for _ in 0..ROUNDS {
            let this = &*self;
            let face = |i: usize| {
                let mut edges: Vec<usize> =
                    this.loops[i].iter().flatten().map(|c| c.edge).collect();
                edges.sort_unstable();
                edges.dedup();
                let fresh = edges
                    .into_iter()
                    .filter(|&e| changed[e] && !this.is_point(e));
                let mut found = Vec::new();
                for e in fresh {
                    if let Ok(flat) = &this.flats[e] {
                        let trace = trace(&this.charts[i], flat);
                        let coarse = if this.is_too_large(i) {
                            Vec::new()
                        } else {
                            coarse(&this.charts[i], &trace, CHORD * this.tol)
                        };
                        found.push((e, trace, coarse));
                    }
                }
                found
            };
            let found = parallel::each(self.threads, body.faces.len(), face, |_| false);
            let mut halve: FxHashMap<usize, Vec<usize>> = FxHashMap::default();
            for (i, edges) in found.into_iter().enumerate() {
                for (e, trace, coarse) in edges {
                    self.traces[i].insert(e, trace);
                    if !coarse.is_empty() {
                        halve.entry(e).or_default().extend(coarse);
                    }
                }
            }
            changed.fill(false);
            if halve.is_empty() {
                break;
            }
            for (e, mut chords) in halve {
                chords.sort_unstable();
                chords.dedup();
                if let Ok(flat) = &mut self.flats[e] {
                    let most = self.max.min(MOST);
                    if flat.points.len() + chords.len() > most {
                        let why =
                            format!("more than {most} points are needed: raise the tolerance");
                        self.flats[e] = Err(why);
                        continue;
                    }
                    flat.halve(&chords, self.body.edges[e].curve.as_ref());
                    changed[e] = true;
                }
            }
        }
        // Edges that were halved in the last round have no new traces.
        for (i, traces) in self.traces.iter_mut().enumerate() {
            for (e, t) in traces.iter_mut() {
                if let Ok(flat) = &self.flats[*e]
                    && flat.points.len() != t.uv.len()
                {
                    *t = trace(&self.charts[i], flat);
                }
            }
        }
        let mut next = body.vertices.len() as u32;
        for flat in &self.flats {
            self.starts.push(next);
            next += flat.as_ref().map_or(0, |f| f.points.len() as u32 - 2);
        }
        self.starts.push(next);
    }

    /// Whether a surface goes so far beyond its face that rounding alone is more than what is allowed.
    fn is_too_large(&self, face: usize) -> bool {
        ROUNDING * self.charts[face].size > CHORD * self.tol
    }

    /// Whether an edge is no more than its vertex.
    fn is_point(&self, edge: usize) -> bool {
        let [a, b] = self.body.edges[edge].vertices;
        a == b && matches!(&self.flats[edge], Ok(f) if f.is_point(self.weld))
    }

    /// The number of the first point of a face's own.
    fn first(&self) -> u32 {
        self.starts[self.body.edges.len()]
    }

    /// The points of all edges.
    pub(super) fn shared(&self) -> Vec<DVec3> {
        let vertices = self.body.vertices.iter().map(|v| v.point);
        let inside = self.flats.iter().filter_map(|f| f.as_ref().ok());
        let inside = inside.flat_map(|f| f.points[1..f.points.len() - 1].iter().copied());
        vertices.chain(inside).collect()
    }

    fn run(&self, face: usize, c: Coedge) -> Result<Run, FaceError> {
        let edge = c.edge;
        let flat = match &self.flats[edge] {
            Ok(flat) => flat,
            Err(why) => {
                let why = why.clone();
                return Err(FaceError::Edge { edge, why });
            }
        };
        let trace = &self.traces[face][&edge];
        let distance = trace
            .off
            .iter()
            .copied()
            .fold(0.0, crate::interval::greater);
        let tolerance = self.body.edges[edge].tolerance;
        let allowed = (OFF * self.charts[face].size).max(self.tol).max(tolerance);
        if distance > allowed || distance.is_nan() {
            return Err(FaceError::Off {
                edge,
                distance,
                allowed,
            });
        }
        let last = flat.points.len() - 1;
        let [a, b] = self.body.edges[edge].vertices.map(|v| v as u32);
        let id = |k: usize| match k {
            0 => a,
            _ if k == last => b,
            _ => self.starts[edge] + k as u32 - 1,
        };
        let mut run = Run {
            edge,
            t: flat.t.clone(),
            uv: trace.uv.clone(),
            ids: (0..=last).map(id).collect(),
        };
        if !c.forward {
            run.t.reverse();
            run.uv.reverse();
            run.ids.reverse();
        }
        Ok(run)
    }

    /// The region of a face.
    pub(super) fn region(&self, face: usize) -> Result<Region, FaceError> {
        let chart = &self.charts[face];
        if let Some((dir, at)) = tear(chart.surface) {
            return Err(FaceError::Torn { dir, at });
        }
        let runs = |l: &Vec<Coedge>| -> Result<Vec<Run>, FaceError> {
            let edges = l.iter().filter(|c| !self.is_point(c.edge));
            edges.map(|&c| self.run(face, c)).collect()
        };
        let mut loops: Vec<Vec<Run>> = self.loops[face]
            .iter()
            .map(runs)
            .collect::<Result<_, _>>()?;
        loops.retain(|l| !l.is_empty());
        let first = self.first();
        Ok(region(chart, &loops, first, [CHORD * self.tol, self.tol])?)
    }

    /// Puts the triangles around poles to the others.
    fn fans(&self, face: usize, region: &mut Region, to: &mut Triangles, allowed: f64) {
        let chart = &self.charts[face];
        for fan in std::mem::take(&mut region.fans) {
            let pole = self.vertex_at(face, fan.pole.point).unwrap_or_else(|| {
                region.own.push(fan.pole.point);
                self.first() + region.own.len() as u32 - 1
            });
            for w in fan.ring.windows(2) {
                let top = [0.5 * (w[0].0[0] + w[1].0[0]), fan.y];
                let [a, b, c] = [w[0].0, w[1].0, top].map(|xy| region.plane.uv(xy));
                // What is over the whole rectangle up to the pole: two triangles, one of which is only a side in space.
                let [p, q] = [a, b].map(|p| {
                    let d = fan.pole.d;
                    if d == 0 { [c[0], p[1]] } else { [p[0], c[1]] }
                });
                for t in [[a, b, q], [a, q, p]] {
                    let bend = chart.triangle(t, allowed);
                    // The side is not one point to the last bit, nor need the tip be on it.
                    to.bound = greater(to.bound, bend.bound + 2.0 * fan.pole.size);
                    to.proven &= bend.proven;
                }
                let k = to.vertices.len() as u32;
                to.vertices.extend([(a, w[0].1), (b, w[1].1), (c, pole)]);
                to.triangles.push(if fan.upper {
                    [k, k + 1, k + 2]
                } else {
                    [k + 1, k, k + 2]
                });
            }
        }
    }

    /// The vertex of a face at a point.
    fn vertex_at(&self, face: usize, p: DVec3) -> Option<u32> {
        let loops = self.body.faces[face].loops.iter();
        let mut vertices = loops.flat_map(|l| match l {
            super::Loop::Vertex(v) => vec![*v],
            super::Loop::Edges(c) => c.iter().map(|&c| self.body.ends(c)[0]).collect(),
        });
        let near = |v: &usize| self.body.vertices[*v].point.distance(p) <= self.weld;
        vertices.find(near).map(|v| v as u32)
    }

    fn build(&self) -> Meshed {
        let mut points = self.shared();
        let one = |i: usize| self.face(i, &points);
        let patches = parallel::each(self.threads, self.body.faces.len(), one, |_| false);
        let mut out = Meshed::default();
        let first = self.first();
        for (i, patch) in patches.into_iter().enumerate() {
            let mut patch = patch.unwrap_or_else(|e| {
                out.failed.push((i, e));
                Patch {
                    patch: MeshPatch {
                        vertices: Vec::new(),
                        triangles: Vec::new(),
                        deviation: Certainty::Estimated(f64::INFINITY),
                    },
                    own: Vec::new(),
                    turned_round: false,
                }
            });
            let shift = points.len() as u32 - first;
            for v in &mut patch.patch.vertices {
                if v.point >= first {
                    v.point += shift;
                }
            }
            points.append(&mut patch.own);
            if patch.turned_round {
                out.turned_round.push(i);
            }
            out.mesh.patches.push(patch.patch);
        }
        out.mesh.points = points;
        out
    }

    fn face(&self, face: usize, shared: &[DVec3]) -> Result<Patch, FaceError> {
        let chart = &self.charts[face];
        if self.is_too_large(face) {
            let deviation = ROUNDING * chart.size;
            return Err(FaceError::NotReached { deviation });
        }
        let mut region = self.region(face)?;
        let allowed = TRIANGLE * self.tol - self.rounding - chart.slit;
        let made = triangulate(chart, &mut region, shared, allowed, self.max);
        let mut triangles = made.map_err(|f| match f {
            Failure::Region(e) => FaceError::Region(e),
            Failure::TooMany(max) => FaceError::TooMany { max },
            Failure::NotReached(deviation) => FaceError::NotReached { deviation },
        })?;
        self.fans(face, &mut region, &mut triangles, allowed);
        if triangles.bound.is_nan() || triangles.bound > allowed {
            let deviation = triangles.bound;
            return Err(FaceError::NotReached { deviation });
        }
        let forward = self.body.faces[face].forward;
        let deviation = self.deviation(face, &region, &triangles, shared);
        for &(uv, id) in &triangles.vertices {
            let own = id.checked_sub(self.first());
            let p = own.map_or_else(|| shared[id as usize], |k| region.own[k as usize]);
            if !p.is_finite() {
                let uv = chart.wrapped(uv);
                return Err(FaceError::NotFinite { uv });
            }
        }
        let vertices: Vec<MeshVertex> = triangles
            .vertices
            .iter()
            .map(|&(uv, id)| {
                let uv = chart.wrapped(uv);
                let normal = normal_at(chart.surface, uv, inwards(uv, chart.domain));
                let normal = normal.vector().unwrap_or(DVec3::ZERO);
                MeshVertex {
                    point: id,
                    uv,
                    normal: if forward { normal } else { -normal },
                }
            })
            .collect();
        let mut list = Vec::with_capacity(triangles.triangles.len());
        for mut t in triangles.triangles {
            let ids = t.map(|k| vertices[k as usize].point);
            if ids[0] == ids[1] || ids[1] == ids[2] || ids[2] == ids[0] {
                // At a pole: no area.
                continue;
            }
            if !forward {
                t.swap(1, 2);
            }
            list.push(t);
        }
        Ok(Patch {
            patch: MeshPatch {
                vertices,
                triangles: list,
                deviation,
            },
            own: std::mem::take(&mut region.own),
            turned_round: region.turned_round,
        })
    }

    /// What is known of the distance of a face from its triangles and edges.
    fn deviation(
        &self,
        face: usize,
        region: &Region,
        triangles: &Triangles,
        shared: &[DVec3],
    ) -> Certainty {
        let chart = &self.charts[face];
        let mut proven = triangles.proven && chart.proven;
        // Own points are on the surface; those of the border may be off.
        let off = triangles.vertices.iter().filter_map(|&(uv, id)| {
            let p = shared.get(id as usize)?;
            Some(chart.point(uv).distance(*p))
        });
        let off = off.fold(0.0, greater);
        let mut border = 0.0f64;
        for polygon in &region.polygons {
            for (k, c) in polygon.iter().enumerate() {
                if let super::region::Step::Edge { edge, .. } = c.step {
                    let next = polygon[(k + 1) % polygon.len()];
                    let ends = [c.xy, next.xy].map(|p| region.plane.uv(p));
                    let bend = chart.chord(ends, CHORD * self.tol);
                    proven &= bend.proven;
                    let Ok(flat) = &self.flats[edge] else {
                        continue;
                    };
                    proven &= !matches!(flat.deviation, Certainty::Estimated(_));
                    border = greater(border, bend.bound + flat.deviation.error());
                }
            }
        }
        let e = greater(triangles.bound, border) + off + chart.slit + self.rounding;
        if proven {
            Certainty::Bounded(e)
        } else {
            Certainty::Estimated(e)
        }
    }
}
