//! Certified triangle meshes.
//!
//! A mesh is made in four steps, one file each:
//!
//! 1. `shared`: which sides of the surfaces are the same curve, which are one point;
//! 2. `layout`: each domain is cut into triangles by a net of lines (`roots`) and `bisection`, until bounds prove the
//!    tolerance: those of `partners`, `parts` (for a `division` of all parts at once) and `measured` for squares, those of
//!    `bound` and `slide` for a grid over a smooth part;
//! 3. `stitch`: the vertices on a shared side are the union of what its surfaces ask for, as points of the first of them;
//! 4. `patch`: the triangles get their vertices, and those on a side also take in what other surfaces asked for.
//!
//! The layout and the triangles of different surfaces are independent of each other, and are made on several threads, as
//! are the squares of one; in between, one thread finds and numbers the points on their sides.

use crate::breaks::Breaks;
use crate::parallel;
use crate::surface::{Dir, Side, Surface, SurfaceRef};
use glam::DVec3;
use layout::{Demand, Layout, layout};
use patch::{Builder, Collapsed};
use shared::Edge;
use std::collections::HashMap;
use std::mem::take;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use stitch::Border;

mod bisection;
mod bound;
pub(crate) mod closing;
mod division;
mod flatten;
mod joints;
mod layout;
mod levels;
mod lines;
mod measured;
mod numbered;
mod options;
mod partial;
mod partners;
mod parts;
mod patch;
mod pieces;
mod roots;
pub(crate) mod shared;
mod slide;
mod stitch;

pub(crate) use bound::sampled;
pub use flatten::{FlatCurve, FlattenError, flatten};
pub use joints::{Joint, Joints, joints, near_joints};
pub use options::{MeshError, MeshOptions, Progress};
pub use partial::{PartialJoint, partial_joint, partial_joints, sides_apart};

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
/// Each patch states the deviation reached: [`Certainty::Bounded`] is a proof from enclosed derivatives, see the theorems
/// in `mesh/partners.rs`, `measured.rs` and `slide.rs`; [`Certainty::Estimated`] means that a surface could not enclose itself somewhere, and
/// samples were used. Vertices are computed in floating point; for their rounding errors 10⁻¹³ of the largest coordinate
/// is included, the accuracy to which every surface is held. The same input gives the same mesh, byte for byte, on any
/// number of threads; each works on one surface at a time, or on a share of the squares where there are few surfaces.
///
/// Errors: see [`MeshError`]; of several surfaces with errors the first is named. Cost: proportional to the number of
/// surfaces and of triangles, and some enclosures for every few triangles.
///
/// Limits: sides are joined whole. Where one side meets only a part of another, or two closed sides start at different
/// points, the mesh has two borders that agree within the tolerance; [`partial_joints`] finds these.
pub fn mesh(surfaces: &[SurfaceRef], options: &MeshOptions) -> Result<Mesh, MeshError> {
    let threads = options.threads.unwrap_or_else(parallel::all_threads);
    let measure = |i: usize| Measure::of(surfaces[i].as_ref());
    let measures = parallel::each(threads, surfaces.len(), measure, |_| false);
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
        shared: shared::find(surfaces, weld, threads),
        threads,
        done: Mutex::new(0),
    };
    let all: Vec<usize> = (0..surfaces.len()).collect();
    let mut laid = task.lay(&all, 0, false)?;
    loop {
        // Each time one surface more is plain, so this ends; nearly always at once.
        match task.build(&mut laid)? {
            Built::Whole(mesh) => return Ok(mesh),
            Built::TurnedOver(which) => {
                let others = laid.iter().map(|l| l.layout.triangles()).sum::<usize>();
                let replaced = which.iter().map(|&i| laid[i].layout.triangles());
                let plain = task.lay(&which, others - replaced.sum::<usize>(), true)?;
                for (i, plain) in which.into_iter().zip(plain) {
                    laid[i] = plain;
                }
            }
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
    threads: usize,
    /// How many times a surface was divided or built.
    done: Mutex<usize>,
}

/// The division of a surface.
struct Laid {
    layout: Layout,
    /// The lines along which the surface is one point, sides and corner lines inside where a profile meets its axis: the
    /// direction across them and their parameter.
    collapsed: Vec<(Dir, f64)>,
}

/// What became of the triangles.
enum Built {
    Whole(Mesh),
    /// The surfaces that have triangles which their bounds do not allow.
    TurnedOver(Vec<usize>),
}

/// The triangles of one surface.
struct Patch {
    patch: MeshPatch,
    /// The points that are not shared, numbered after those that are; of the first patch these come first.
    own: Vec<DVec3>,
    turned_over: bool,
}

impl Task<'_> {
    /// Tells that a surface was divided or built. Where some are built again, nothing is left to tell.
    fn report(&self) {
        if let Some(progress) = &self.options.progress {
            let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
            *done += 1;
            progress((*done as f64 / (2 * self.surfaces.len()) as f64).min(1.0));
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

    /// The threads for each surface while all are worked on.
    fn threads_each(&self) -> usize {
        (self.threads / self.surfaces.len()).max(1)
    }

    /// Divides some surfaces, when the others have that many triangles. With the same error as one after the other: the
    /// first surface that cannot be divided or is over the limit of triangles is named.
    fn lay(&self, which: &[usize], others: usize, plain: bool) -> Result<Vec<Laid>, MeshError> {
        let max = self.options.max_triangles;
        let limit = max.min(MOST);
        let total = AtomicUsize::new(others);
        let enough = |laid: &Result<Laid, MeshError>| match laid {
            Ok(laid) => {
                let own = laid.layout.triangles();
                total.fetch_add(own, Ordering::Relaxed) + own > limit
            }
            Err(_) => true,
        };
        let work = |k: usize| {
            let laid = self.lay_one(which[k], plain);
            self.report();
            laid
        };
        let mut needed = others as f64;
        let mut all = Vec::with_capacity(which.len());
        for laid in parallel::each(self.threads, which.len(), work, enough) {
            needed += match &laid {
                Ok(laid) => laid.layout.triangles() as f64,
                Err(MeshError::TooMany { needed, .. }) => *needed,
                Err(e) => return Err(e.clone()),
            };
            if needed > limit as f64 {
                return Err(MeshError::TooMany { needed, max });
            }
            all.push(laid?);
        }
        Ok(all)
    }

    fn lay_one(&self, i: usize, plain: bool) -> Result<Laid, MeshError> {
        let surface = self.surfaces[i].as_ref();
        let reserve = if self.shared.touches(i) {
            2.0 * self.weld
        } else {
            0.0
        };
        let demand = Demand {
            surface: i,
            tol: self.tol - self.rounding[i] - reserve,
            rounding: self.rounding[i],
            least: self.least_cells(i),
            max: self.options.max_triangles.min(MOST),
            threads: self.threads_each(),
            plain,
            joined: self.shared.joined(i),
        };
        let layout = layout(surface, &demand)?;
        Ok(Laid {
            collapsed: collapsed(surface, &layout, self.weld),
            layout,
        })
    }

    /// Makes the triangles.
    fn build(&self, laid: &mut [Laid]) -> Result<Built, MeshError> {
        let mut points = Vec::new();
        let mut borders = stitch::stitch(self.surfaces, laid, &self.shared, self.weld, &mut points);
        self.pull_together(laid, &mut borders);
        self.open_corners(laid, &borders);
        let laid = &*laid;
        let work = |i: usize| {
            let patch = self.build_one(i, &laid[i], &borders[i], &points);
            self.report();
            patch
        };
        let patches = parallel::each(self.threads, laid.len(), work, Result::is_err);
        let mut patches: Vec<Patch> = patches.into_iter().collect::<Result<_, _>>()?;
        let turned_over = |i: &usize| patches[*i].turned_over;
        let turned_over: Vec<usize> = (0..patches.len()).filter(turned_over).collect();
        if !turned_over.is_empty() {
            return Ok(Built::TurnedOver(turned_over));
        }
        let shared = points.len();
        let count = patches.iter().map(|p| p.own.len()).sum::<usize>();
        // Those of the first patch are after the shared ones and have their numbers already.
        let mut all = patches.first_mut().map_or(points, |p| take(&mut p.own));
        all.reserve_exact(count - all.len());
        for p in patches.iter_mut().skip(1) {
            let shift = (all.len() - shared) as u32;
            let own = |v: &&mut MeshVertex| v.point as usize >= shared;
            let vertices = p.patch.vertices.iter_mut();
            vertices.filter(own).for_each(|v| v.point += shift);
            all.append(&mut p.own);
        }
        Ok(Built::Whole(Mesh {
            points: all,
            patches: patches.into_iter().map(|p| p.patch).collect(),
        }))
    }

    /// Makes the two ends of each line that is one point the same point, wherever they are used.
    fn pull_together(&self, laid: &[Laid], borders: &mut [Border]) {
        let mut renamed: HashMap<u32, u32> = HashMap::new();
        let name = |renamed: &HashMap<u32, u32>, mut id: u32| {
            while let Some(&other) = renamed.get(&id) {
                id = other;
            }
            id
        };
        for ((surface, laid), border) in self.surfaces.iter().zip(laid).zip(borders.iter()) {
            if laid.collapsed.is_empty() {
                continue;
            }
            let on_border = border.points(surface.as_ref());
            for &(across, at) in &laid.collapsed {
                let edge = Edge::inside(surface.as_ref(), across, at);
                let end = |t| on_border.get(&lines::key(edge.uv(t))).copied();
                if let (Some(a), Some(b)) = (end(edge.range.lo), end(edge.range.hi)) {
                    let (a, b) = (name(&renamed, a), name(&renamed, b));
                    if a != b {
                        renamed.insert(b, a);
                    }
                }
            }
        }
        if !renamed.is_empty() {
            borders
                .iter_mut()
                .for_each(|b| b.rename(|id| name(&renamed, id)));
        }
    }

    /// See [`Layout::open_corners`].
    fn open_corners(&self, laid: &mut [Laid], borders: &[Border]) {
        for (i, (laid, border)) in laid.iter_mut().zip(borders).enumerate() {
            let domain = self.surfaces[i].domain();
            let collapsed = &laid.collapsed;
            let is_open = |side: Side, [from, to]: [f64; 2]| {
                let across = domain[lines::index(side.across())];
                let at = if side.is_upper() {
                    across.hi
                } else {
                    across.lo
                };
                collapsed.contains(&(side.across(), at))
                    || !border.between(side, from, to).is_empty()
            };
            laid.layout.open_corners(self.shared.pinched(i), is_open);
        }
    }

    fn build_one(
        &self,
        i: usize,
        laid: &Laid,
        border: &Border,
        shared: &[DVec3],
    ) -> Result<Patch, MeshError> {
        let (surface, layout) = (self.surfaces[i].as_ref(), &laid.layout);
        let on_border = border.points(surface);
        let collapsed = laid.collapsed.iter().map(|&(across, at)| {
            let edge = Edge::inside(surface, across, at);
            Collapsed {
                across: lines::index(across),
                at,
                point: on_border.get(&lines::key(edge.uv(edge.range.lo))).copied(),
            }
        });
        let own = if i == 0 { shared.to_vec() } else { Vec::new() };
        let ahead = own.len();
        let mut builder = Builder {
            index: i,
            surface,
            layout,
            border,
            collapsed: collapsed.collect(),
            on_sides: on_border,
            shared,
            own,
            ahead,
            lacking: false,
            patch: MeshPatch {
                vertices: Vec::new(),
                triangles: Vec::new(),
                deviation: Certainty::Exact,
            },
            gap: 0.0,
            rounding: self.rounding[i],
            turned_over: false,
            threads: self.threads_each(),
        };
        builder.run()?;
        let (mut patch, gap) = (builder.patch, builder.gap);
        if patch.triangles.is_empty() {
            let weld = self.weld;
            return Err(MeshError::Collapsed { surface: i, weld });
        }
        let (tol, deviation) = (self.tol, layout.deviation + gap + self.rounding[i]);
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
        patch.vertices.shrink_to_fit();
        patch.triangles.shrink_to_fit();
        Ok(Patch {
            patch,
            own: builder.own,
            turned_over: builder.turned_over,
        })
    }
}

/// The lines along which a surface is one point.
fn collapsed(surface: &dyn Surface, layout: &Layout, weld: f64) -> Vec<(Dir, f64)> {
    let mut found = Vec::new();
    for (d, across) in [Dir::U, Dir::V].into_iter().enumerate() {
        let blocks = &layout.blocks[d];
        let cuts = blocks
            .iter()
            .map(|b| b.lo)
            .chain(blocks.last().map(|b| b.hi));
        let is_point = |at: &f64| Edge::inside(surface, across, *at).is_collapsed(weld);
        found.extend(cuts.filter(is_point).map(|at| (across, at)));
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
