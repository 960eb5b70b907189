//! Certified triangle meshes.
//!
//! A mesh is made in four steps, one file each:
//!
//! 1. `shared`: which sides of the surfaces are the same curve, which are one point;
//! 2. `layout`: each domain is cut into triangles by a net of lines (`roots`) and `bisection`, until bounds prove the
//!    tolerance: those of `partners` for squares, those of `bound` and `slide` for a grid over a whole smooth block;
//! 3. `stitch`: the vertices on a shared side are the union of what its surfaces ask for, as points of the first of them;
//! 4. `patch`: the triangles get their vertices, and those on a side also take in what other surfaces asked for.
//!
//! The layout and the triangles of different surfaces are independent of each other.

use crate::breaks::Breaks;
use crate::surface::{Dir, Side, Surface, SurfaceRef};
use glam::DVec3;
use layout::{Demand, Layout, layout};
use lines::Lines;
use patch::{Builder, Collapsed};
use shared::Edge;
use std::collections::HashMap;

mod bisection;
mod bound;
pub(crate) mod closing;
mod flatten;
mod joints;
mod layout;
mod lines;
mod measured;
mod options;
mod partial;
mod partners;
mod patch;
mod roots;
pub(crate) mod shared;
mod slide;
mod stitch;

pub use flatten::{FlatCurve, FlattenError, flatten};
pub use joints::{Joint, Joints, joints};
pub use options::{MeshError, MeshOptions, Progress};
pub use partial::{PartialJoint, partial_joints};

/// How far an approximating result is from the exact thing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Certainty {
    /// No error beyond rounding.
    Exact,
    /// Proven: the error is at most this length.
    Bounded(f64),
    /// Not proven: sampling found no larger error than this.
    Estimated(f64),
}

impl Certainty {
    /// The error: 0 if exact.
    pub fn error(self) -> f64 {
        match self {
            Certainty::Exact => 0.0,
            Certainty::Bounded(e) | Certainty::Estimated(e) => e,
        }
    }

    /// The certainty of a whole made of two parts: the weaker statement and the larger error.
    pub fn and(self, o: Certainty) -> Certainty {
        let e = self.error().max(o.error());
        match (self, o) {
            (Certainty::Estimated(_), _) | (_, Certainty::Estimated(_)) => Certainty::Estimated(e),
            (Certainty::Exact, Certainty::Exact) => Certainty::Exact,
            _ => Certainty::Bounded(e),
        }
    }
}

/// A triangle mesh of several surfaces. Points are shared across surfaces and along seams, so the mesh is watertight
/// by construction; what differs from patch to patch (parameters, normals) is in the patches' vertices.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// The points. No two triangles meet in an edge without sharing these.
    pub points: Vec<DVec3>,
    /// One patch for each surface, in the order given.
    pub patches: Vec<MeshPatch>,
}

/// The mesh of one surface.
#[derive(Clone, Debug)]
pub struct MeshPatch {
    /// The vertices. Several may share a point: on a seam, and at a pole, where each triangle has its own normal.
    pub vertices: Vec<MeshVertex>,
    /// Indices into `vertices`, counter-clockwise seen from the side the normal points to.
    pub triangles: Vec<[u32; 3]>,
    /// The two-sided Hausdorff distance between this patch and its surface.
    pub deviation: Certainty,
}

/// A corner of mesh triangles on one surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshVertex {
    /// Index into [`Mesh::points`].
    pub point: u32,
    /// The parameters on the surface.
    pub uv: [f64; 2],
    /// The unit normal.
    pub normal: DVec3,
}

/// The relative error of a computed point, as a share of the largest coordinate: what the laws of surfaces allow.
const ROUNDING: f64 = 1e-13;
/// The smallest tolerance is this many rounding errors.
const SMALLEST: f64 = 8.0;
/// The default tolerance as a share of the diagonal of the model's box.
const DEFAULT_TOL: f64 = 1e-3;
/// The default weld distance as a share of the tolerance.
const DEFAULT_WELD: f64 = 0.05;
/// The largest weld distance as a share of the tolerance: twice of it may be lost in joining.
const LARGEST_WELD: f64 = 0.25;
/// More triangles have vertices that do not fit their numbers.
const MOST: usize = 1 << 30;
/// Samples along each direction that measure a surface which cannot bound itself.
const SAMPLES: usize = 16;

/// Meshes surfaces together: every point of a surface is within `options.tol` of its patch and every point of the patch
/// within it of the surface (two-sided Hausdorff distance, in the model's unit of length).
///
/// Sides of the surfaces that agree within `options.weld` (whatever their parametrisations and directions, and also two
/// sides of one surface) share their points, so the mesh is watertight there. A side that is one point gives no triangles
/// without area. Triangles are counter-clockwise around `r_u × r_v`. Flat and straight directions are not cut: a plane
/// has two triangles, a cylinder is cut around but not along its axis.
///
/// Each patch states the deviation reached: [`Certainty::Bounded`] is a proof from enclosed second derivatives, see the
/// theorem in `mesh/bound.rs`; [`Certainty::Estimated`] means that a surface could not enclose itself somewhere, and
/// samples were used. Vertices are computed in floating point; for their rounding errors 10⁻¹³ of the largest coordinate
/// is included, the accuracy to which every surface is held. The same input gives the same mesh, byte for byte.
///
/// Errors: see [`MeshError`]. Cost: proportional to the number of triangles, and some enclosures for each leaf.
///
/// Limits: sides are joined whole. Where one side meets only a part of another, or two closed sides start at different
/// points, the mesh has two borders that agree within the tolerance; [`partial_joints`] finds these.
pub fn mesh(surfaces: &[SurfaceRef], options: &MeshOptions) -> Result<Mesh, MeshError> {
    let measures: Vec<Measure> = surfaces.iter().map(|s| Measure::of(s.as_ref())).collect();
    let diagonal = measures
        .iter()
        .map(|m| m.hull)
        .reduce(crate::Box3::hull)
        .map_or(1.0, |b| b.diagonal());
    let tol = options.tol.unwrap_or(DEFAULT_TOL * diagonal);
    if !(tol > 0.0 && tol.is_finite()) {
        return Err(MeshError::Tolerance { tol });
    }
    let rounding: Vec<f64> = measures.iter().map(|m| ROUNDING * m.far).collect();
    let smallest = SMALLEST * rounding.iter().fold(0.0f64, |a, &b| a.max(b));
    if tol < smallest {
        return Err(MeshError::TooFine { tol, smallest });
    }
    let weld = options.weld.unwrap_or(DEFAULT_WELD * tol);
    if !(0.0..=LARGEST_WELD * tol).contains(&weld) {
        return Err(MeshError::Weld { weld, tol });
    }
    let weld = weld.max(2.0 * rounding.iter().fold(0.0f64, |a, &b| a.max(b)));
    let task = Task {
        surfaces,
        options,
        tol,
        weld,
        rounding,
        shared: shared::find(surfaces, weld),
    };
    let mut plain = vec![false; surfaces.len()];
    loop {
        // Each time one surface more is plain, so this ends; nearly always at once.
        if let Some(mesh) = task.attempt(&mut plain)? {
            return Ok(mesh);
        }
    }
}

/// What is to be meshed.
struct Task<'a> {
    surfaces: &'a [SurfaceRef],
    options: &'a MeshOptions,
    tol: f64,
    weld: f64,
    rounding: Vec<f64>,
    shared: shared::Shared,
}

impl Task<'_> {
    fn report(&self, done: usize) {
        if let Some(progress) = &self.options.progress {
            progress(done as f64 / (2 * self.surfaces.len()).max(1) as f64);
        }
    }

    /// The fewest cells along u and v in each block of a surface: its share of those across the surface, and two between
    /// lines that are one point.
    fn least_cells(&self, i: usize) -> [f64; 2] {
        let surface = self.surfaces[i].as_ref();
        let mut least = self.shared.least_cells(i);
        for (least, across) in least.iter_mut().zip([Dir::U, Dir::V]) {
            let lines = surface.breaks(across).below(1);
            *least = (*least / (lines.len() + 1) as f64).ceil();
            *least = least.max(self.options.least_cells as f64);
            let mut lines = lines
                .into_iter()
                .map(|at| Edge::inside(surface, across, at));
            if lines.any(|line| line.is_collapsed(self.weld)) {
                *least = least.max(2.0);
            }
        }
        least
    }

    fn layouts(&self, plain: &[bool]) -> Result<Vec<Layout>, MeshError> {
        let max = self.options.max_triangles;
        let mut layouts: Vec<Layout> = Vec::with_capacity(self.surfaces.len());
        let mut left = max.min(MOST);
        for (i, s) in self.surfaces.iter().enumerate() {
            let reserve = if self.shared.touches(i) {
                2.0 * self.weld
            } else {
                0.0
            };
            let demand = Demand {
                surface: i,
                tol: self.tol - self.rounding[i] - reserve,
                least: self.least_cells(i),
                max: left,
                plain: plain[i],
                joined: self.shared.joined(i),
            };
            let done = layout(s.as_ref(), &demand).map_err(|e| match e {
                MeshError::TooMany { needed, .. } => MeshError::TooMany {
                    needed: needed + (max - left) as f64,
                    max,
                },
                other => other,
            })?;
            left = left.saturating_sub(done.triangles());
            layouts.push(done);
            self.report(i + 1);
        }
        Ok(layouts)
    }

    /// A mesh, with the plain bound for the surfaces marked so; `None` if a triangle of another surface was turned over,
    /// which is marked then.
    fn attempt(&self, plain: &mut [bool]) -> Result<Option<Mesh>, MeshError> {
        let Task {
            surfaces,
            tol,
            weld,
            ..
        } = *self;
        let mut layouts = self.layouts(plain)?;
        let mut lines: Vec<Lines> = layouts.iter().map(Lines::new).collect();
        let mut points = Vec::new();
        let mut borders = stitch::stitch(surfaces, &self.shared, weld, &mut lines, &mut points);
        for (i, layout) in layouts.iter().enumerate() {
            for edge in collapsed(surfaces[i].as_ref(), layout, weld) {
                let end = |t| borders[i].get(&lines::key(edge.uv(t))).copied();
                if let (Some(a), Some(b)) = (end(edge.range.lo), end(edge.range.hi)) {
                    let same = borders.iter_mut().flat_map(HashMap::values_mut);
                    same.filter(|id| **id == b).for_each(|id| *id = a);
                }
            }
        }
        let mut again = false;
        let mut patches = Vec::with_capacity(surfaces.len());
        for (i, border) in borders.into_iter().enumerate() {
            let sides = Side::ALL.map(|s| Edge::new(surfaces[i].as_ref(), s).is_collapsed(weld));
            layouts[i].open_corners(self.shared.pinched(i), |side, [from, to]| {
                sides[side as usize] || !lines[i].between(side, from, to).is_empty()
            });
            let layout = &layouts[i];
            let mut builder = Builder {
                index: i,
                surface: surfaces[i].as_ref(),
                layout,
                lines: &lines[i],
                collapsed: collapsed(surfaces[i].as_ref(), layout, weld)
                    .into_iter()
                    .map(|edge| Collapsed {
                        across: lines::index(edge.side.across()),
                        at: edge.at,
                        point: border.get(&lines::key(edge.uv(edge.range.lo))).copied(),
                    })
                    .collect(),
                on_sides: border,
                points: &mut points,
                patch: MeshPatch {
                    vertices: Vec::new(),
                    triangles: Vec::new(),
                    deviation: Certainty::Exact,
                },
                gap: 0.0,
                rounding: self.rounding[i],
                turned_over: false,
            };
            builder.run()?;
            if builder.turned_over {
                plain[i] = true;
                again = true;
            }
            let (mut patch, gap) = (builder.patch, builder.gap);
            if patch.triangles.is_empty() {
                return Err(MeshError::Collapsed { surface: i, weld });
            }
            let deviation = layout.deviation + gap + self.rounding[i];
            if deviation > tol && layout.proven {
                return Err(MeshError::Gap {
                    surface: i,
                    deviation,
                    tol,
                });
            }
            patch.deviation = if layout.proven {
                Certainty::Bounded(deviation)
            } else {
                Certainty::Estimated(deviation)
            };
            patches.push(patch);
            self.report(surfaces.len() + i + 1);
        }
        Ok((!again).then_some(Mesh { points, patches }))
    }
}

/// The lines along which the surface is one point: sides, and corner lines inside where a profile meets its axis.
fn collapsed<'a>(surface: &'a dyn Surface, layout: &Layout, weld: f64) -> Vec<Edge<'a>> {
    let mut found = Vec::new();
    for (d, across) in [Dir::U, Dir::V].into_iter().enumerate() {
        let blocks = &layout.blocks[d];
        let cuts = blocks
            .iter()
            .map(|b| b.lo)
            .chain(blocks.last().map(|b| b.hi));
        let lines = cuts.map(|at| Edge::inside(surface, across, at));
        found.extend(lines.filter(|e| e.is_collapsed(weld)));
    }
    found
}

/// How large a surface is.
struct Measure {
    hull: crate::Box3,
    /// The largest coordinate.
    far: f64,
}

impl Measure {
    fn of(surface: &dyn Surface) -> Self {
        let domain = surface.domain();
        let mut hull = surface.bounds(domain);
        if !hull.is_finite() {
            // Only an estimate is possible; points that are not finite are reported when they are met.
            let at = |d: usize, k: usize| {
                domain[d].lo + (domain[d].hi - domain[d].lo) * (k as f64 + 0.5) / SAMPLES as f64
            };
            let samples = (0..SAMPLES * SAMPLES)
                .map(|k| surface.point([at(0, k / SAMPLES), at(1, k % SAMPLES)]))
                .filter(|p| p.is_finite());
            hull = crate::Box3::around(samples).unwrap_or(crate::Box3::ZERO);
        }
        let far = hull.to_array().iter().fold(0.0f64, |a, i| a.max(i.mag()));
        Self { hull, far }
    }
}
