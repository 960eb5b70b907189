//! The triangles of one surface.
//!
//! On a collapsed line (a side, or a corner line inside that lies on an axis) many vertices share one point. Triangles with
//! two corners there have no area and are left out: what they would cover in space is an edge of a triangle beside them.
//! Each remaining triangle gets its own vertex at that point, with the normal of the middle of its opposite edge, so that
//! the tip of a cone is shaded like its flank.

use super::bisection::{Numbered, Place};
use super::layout::{Layout, Region};
use super::lines::{Key, index, inwards, key};
use super::options::MeshError;
use super::slide::is_turned;
use super::stitch::Border;
use super::{MeshPatch, MeshVertex};
use crate::breaks::Limit;
use crate::interval::Interval;
use crate::parallel;
use crate::surface::{Side, Surface, in_parallel, jet_len, normal_at, normal_from};
use glam::DVec3;
use std::collections::HashMap;

/// Shares of the way to the middle of a triangle at which a normal is looked for where not even a limit exists.
const INWARD: [f64; 4] = [1e-6, 1e-4, 1e-2, 0.5];
/// From so many vertices on, the preparations of a list are worth while, and so are threads.
const LIST: usize = 4096;
/// The vertices that are evaluated at once: their derivatives stay in the caches.
const AT_ONCE: usize = 4096;
/// About the triangles that a thread hands out at once, if cells have not more.
const SHARE: usize = 2048;
/// The shares of cells that wait to be made triangles.
const SHARES: usize = 64;

/// A line of constant parameter that is one point.
pub(super) struct Collapsed {
    /// The constant parameter: 0 for u, 1 for v.
    pub(super) across: usize,
    pub(super) at: f64,
    /// The point, once it is known.
    pub(super) point: Option<u32>,
}

pub(super) struct Builder<'a> {
    pub(super) index: usize,
    pub(super) surface: &'a dyn Surface,
    pub(super) layout: &'a Layout,
    pub(super) border: &'a Border,
    /// The lines that are one point each.
    pub(super) collapsed: Vec<Collapsed>,
    /// The points on the sides.
    pub(super) on_sides: HashMap<Key, u32>,
    /// The points that it shares with others.
    pub(super) shared: &'a [DVec3],
    /// Its own points, numbered after the shared ones.
    pub(super) own: Vec<DVec3>,
    pub(super) patch: MeshPatch,
    /// The largest distance of a vertex' point from the surface.
    pub(super) gap: f64,
    /// The rounding errors of points.
    pub(super) rounding: f64,
    /// True if a triangle turned out clockwise where the bound needs it counter-clockwise.
    pub(super) turned_over: bool,
    /// The threads that may work on it at once.
    pub(super) threads: usize,
}

/// A corner of a triangle.
#[derive(Clone, Copy)]
struct Spot {
    uv: [f64; 2],
    point: u32,
    /// The parameter along the collapsed line that it lies on.
    tip: Option<usize>,
    /// The number of the vertex of the net; further ones on a side belong to one triangle edge alone.
    number: Option<u32>,
}

/// A vertex of the net.
#[derive(Clone, Copy, Default)]
struct Site {
    uv: [f64; 2],
    /// The place on the surface, with the normal as the limit from above; zero where the tangents do not tell.
    place: DVec3,
    normal: DVec3,
}

/// A vertex of the net in the patch.
#[derive(Clone, Copy, Default)]
struct Slot {
    point: u32,
    /// True on sides and on lines that are one point: triangles there take a closer look.
    special: bool,
    /// The vertex of the patch, and the block that it is one for, from 1; blocks differ in the normals on common lines.
    vertex: u32,
    block: u32,
}

/// What is known about the block being worked on.
struct Work<'a> {
    net: &'a Numbered<'a>,
    sites: &'a [Site],
    slots: Vec<Slot>,
    block: u32,
    range: [Interval; 2],
    /// The normal around which the triangles must be counter-clockwise, if any.
    normal: Option<DVec3>,
}

impl Builder<'_> {
    /// Makes all triangles.
    pub(super) fn run(&mut self) -> Result<(), MeshError> {
        let layout = self.layout;
        let net = layout.net.numbered();
        let sites = self.sites(&net);
        let mut work = Work {
            slots: self.slots(&net, &sites)?,
            net: &net,
            sites: &sites,
            range: [Interval::ZERO; 2],
            normal: None,
            block: 0,
        };
        self.patch.vertices.reserve(net.places.len());
        self.patch.triangles.reserve(2 * net.places.len());
        for region in &layout.regions {
            let [i, j] = region.block;
            work.block = 1 + (i * layout.blocks[1].len() + j) as u32;
            work.range = [0, 1].map(|d| layout.blocks[d][region.block[d]]);
            work.normal = region.normal;
            self.region(region, &mut work)?;
        }
        self.complete_normals();
        Ok(())
    }

    /// The threads for so many vertices.
    fn threads_for(&self, count: usize) -> usize {
        if count < LIST { 1 } else { self.threads }
    }

    /// Evaluates all vertices of the net.
    fn sites(&self, net: &Numbered) -> Vec<Site> {
        let count = net.places.len();
        let mut sites = vec![Site::default(); count];
        let fill = |places: &[Place], out: &mut [Site]| {
            let mut jets = vec![[DVec3::ZERO; jet_len(1)]; AT_ONCE.min(places.len())];
            for (places, out) in places.chunks(AT_ONCE).zip(out.chunks_mut(AT_ONCE)) {
                let uv: Vec<[f64; 2]> = places.iter().map(|&p| self.layout.net.uv(p)).collect();
                let jets = &mut jets[..uv.len()];
                if count < LIST {
                    for (uv, jet) in uv.iter().zip(&mut *jets) {
                        self.surface.jet_into(*uv, [Limit::Above; 2], 1, jet);
                    }
                } else {
                    self.surface.jets(&uv, 1, jets.as_flattened_mut());
                }
                for ((uv, jet), out) in uv.into_iter().zip(&*jets).zip(out) {
                    let normal = normal_from(self.surface, uv, [Limit::Above; 2], jet);
                    *out = Site {
                        uv,
                        place: jet[0],
                        normal: normal.vector().unwrap_or(DVec3::ZERO),
                    };
                }
            }
        };
        in_parallel(self.threads_for(count), &net.places, 1, &mut sites, fill);
        sites
    }

    /// Gives each vertex of the net its point.
    fn slots(&mut self, net: &Numbered, sites: &[Site]) -> Result<Vec<Slot>, MeshError> {
        let mut slots = Vec::with_capacity(sites.len());
        self.own.reserve(sites.len());
        for (&place, site) in net.places.iter().zip(sites) {
            let on_side = self.is_on_side(place);
            slots.push(Slot {
                point: self.point(site.uv, on_side, site.place)?,
                special: on_side || self.tip(site.uv).is_some(),
                ..Slot::default()
            });
        }
        Ok(slots)
    }

    fn is_on_side(&self, place: Place) -> bool {
        let last = self.layout.net.last();
        (0..2).any(|d| place[d] == 0 || place[d] == last[d])
    }

    /// The collapsed line on which a place lies.
    fn tip(&self, uv: [f64; 2]) -> Option<usize> {
        let on = |l: &Collapsed| uv[l.across] == l.at;
        self.collapsed.iter().position(on)
    }

    fn spot(&self, uv: [f64; 2], point: u32, number: Option<u32>) -> Spot {
        Spot {
            uv,
            point,
            tip: self.tip(uv).map(|l| 1 - self.collapsed[l].across),
            number,
        }
    }

    /// The point for a place, that of other surfaces if it is shared; `p` is the surface's own.
    fn point(&mut self, uv: [f64; 2], on_side: bool, p: DVec3) -> Result<u32, MeshError> {
        if !p.is_finite() {
            return Err(MeshError::NotFinite {
                surface: self.index,
                uv,
            });
        }
        let line = self.tip(uv);
        let shared = on_side.then(|| self.on_sides.get(&key(uv)).copied());
        let known = shared
            .flatten()
            .or_else(|| self.collapsed[line?].point)
            .inspect(|&point| self.gap = self.gap.max(self.place_of(point).distance(p)));
        let point = known.unwrap_or_else(|| {
            self.own.push(p);
            (self.shared.len() + self.own.len()) as u32 - 1
        });
        if let Some(l) = line {
            self.collapsed[l].point.get_or_insert(point);
        }
        Ok(point)
    }

    fn place_of(&self, point: u32) -> DVec3 {
        let point = point as usize;
        let own = || self.own[point - self.shared.len()];
        self.shared.get(point).copied().unwrap_or_else(own)
    }

    /// Makes the triangles of a rectangle of cells.
    fn region(&mut self, region: &Region, work: &mut Work) -> Result<(), MeshError> {
        let cells: Vec<[usize; 2]> = region.each().collect();
        let threads = self.threads_for(work.sites.len());
        let each = 2 * work.sites.len() / cells.len().max(1);
        let share = (SHARE / each.max(1)).max(1);
        // So many at a time that what they wait in stays small, but for cells of very many triangles.
        for cells in cells.chunks(share * SHARES) {
            let shares: Vec<_> = cells.chunks(share).collect();
            let of = |k: usize| {
                let mut all = Vec::new();
                for &cell in shares[k] {
                    work.net.triangles(cell, |t| all.push(t));
                }
                all
            };
            let all = parallel::each(threads, shares.len(), of, |_| false);
            for t in all.into_iter().flatten() {
                let special = |k: u32| work.slots[k as usize].special;
                if work.normal.is_some() || t.into_iter().any(special) {
                    self.special(t, work)?;
                } else {
                    let middle = || middle(t.map(|k| work.sites[k as usize].uv));
                    let vertices = t.map(|k| self.net_vertex(k, middle, work));
                    self.patch.triangles.push(vertices);
                }
            }
        }
        Ok(())
    }

    /// Makes a triangle that may have further vertices on an edge, or two corners at one point, or the wrong orientation.
    fn special(&mut self, t: [u32; 3], work: &mut Work) -> Result<(), MeshError> {
        let corners = t.map(|k| {
            let (site, slot) = (&work.sites[k as usize], &work.slots[k as usize]);
            self.spot(site.uv, slot.point, Some(k))
        });
        let places = t.map(|k| work.net.places[k as usize]);
        // Further vertices are on one side at most, see `Layout::open_corners`.
        let further = (0..3).find_map(|k| {
            let ends = [places[k], places[(k + 1) % 3]];
            let (from, to) = (corners[k].uv, corners[(k + 1) % 3].uv);
            let (side, params) = self.further(ends, from, to)?;
            Some((k, side, params))
        });
        let Some((k, side, params)) = further else {
            // The edges of triangles of the net of lines run along u and v.
            let halved = places
                .iter()
                .flatten()
                .any(|x| x % super::bisection::CELL != 0);
            self.triangle(corners, halved, work);
            return Ok(());
        };
        let mut chain = vec![corners[k]];
        for t in params {
            let mut uv = corners[k].uv;
            uv[index(side.along())] = t;
            let point = self.point(uv, true, self.surface.point(uv))?;
            chain.push(self.spot(uv, point, None));
        }
        chain.push(corners[(k + 1) % 3]);
        for ends in chain.windows(2) {
            self.triangle([ends[0], ends[1], corners[(k + 2) % 3]], true, work);
        }
        Ok(())
    }

    /// The vertices on an edge beyond its ends, if it lies on a side that has some there, in its direction.
    fn further(&self, ends: [Place; 2], from: [f64; 2], to: [f64; 2]) -> Option<(Side, Vec<f64>)> {
        let last = self.layout.net.last();
        Side::ALL.into_iter().find_map(|side| {
            let d = index(side.across());
            let at = if side.is_upper() { last[d] } else { 0 };
            if ends.iter().any(|p| p[d] != at) {
                return None;
            }
            let along = 1 - d;
            let [a, b] = [from[along], to[along]];
            let between = self.border.between(side, a.min(b), a.max(b));
            let mut params: Vec<f64> = between.iter().map(|v| v.0).collect();
            if a > b {
                params.reverse();
            }
            (!params.is_empty()).then_some((side, params))
        })
    }

    fn triangle(&mut self, corners: [Spot; 3], check: bool, work: &mut Work) {
        let p = corners.map(|c| c.point);
        if p[0] == p[1] || p[1] == p[2] || p[2] == p[0] {
            return;
        }
        if let Some(normal) = work.normal.filter(|_| check) {
            // The bound is for triangles with their corners on the surface.
            let at = corners.map(|c| match c.number {
                Some(k) => work.sites[k as usize].place,
                None => self.surface.point(c.uv),
            });
            self.turned_over |= !is_turned(at, normal, self.rounding);
        }
        let triangle = [0, 1, 2].map(|k| {
            let others = [corners[(k + 1) % 3].uv, corners[(k + 2) % 3].uv];
            self.vertex(corners[k], others, work)
        });
        self.patch.triangles.push(triangle);
    }

    /// The vertex of the patch for a corner of a triangle.
    fn vertex(&mut self, spot: Spot, others: [[f64; 2]; 2], work: &mut Work) -> u32 {
        let middle = || middle([spot.uv, others[0], others[1]]);
        if let (Some(number), None) = (spot.number, spot.tip) {
            return self.net_vertex(number, middle, work);
        }
        let mut uv = spot.uv;
        if let Some(along) = spot.tip {
            uv[along] = 0.5 * (others[0][along] + others[1][along]);
        }
        let normal = self.normal(uv, middle(), work.range);
        self.new_vertex(spot.point, uv, normal)
    }

    /// The vertex of the patch for a vertex of the net, in this block; `middle` is that of a triangle there.
    #[inline]
    fn net_vertex(&mut self, k: u32, middle: impl Fn() -> [f64; 2], work: &mut Work) -> u32 {
        let slot = work.slots[k as usize];
        if slot.block == work.block {
            return slot.vertex;
        }
        let site = &work.sites[k as usize];
        let above = inwards(site.uv, work.range) == [Limit::Above; 2];
        let normal = if above && site.normal != DVec3::ZERO {
            site.normal
        } else {
            self.normal(site.uv, middle(), work.range)
        };
        let vertex = self.new_vertex(slot.point, site.uv, normal);
        work.slots[k as usize] = Slot {
            vertex,
            block: work.block,
            ..slot
        };
        vertex
    }

    fn new_vertex(&mut self, point: u32, uv: [f64; 2], normal: DVec3) -> u32 {
        self.patch.vertices.push(MeshVertex { point, uv, normal });
        self.patch.vertices.len() as u32 - 1
    }

    /// The unit normal, as the limit from inside the block; zero where none is found.
    fn normal(&self, uv: [f64; 2], middle: [f64; 2], range: [Interval; 2]) -> DVec3 {
        let limit = inwards(uv, range);
        let at = |uv: [f64; 2]| normal_at(self.surface, uv, limit).vector();
        at(uv)
            .or_else(|| {
                INWARD
                    .into_iter()
                    .find_map(|f| at([0, 1].map(|d| uv[d] + f * (middle[d] - uv[d]))))
            })
            .unwrap_or(DVec3::ZERO)
    }

    /// Gives vertices without a normal the mean of those of their triangles, weighted by area.
    fn complete_normals(&mut self) {
        let missing = |v: &MeshVertex| v.normal == DVec3::ZERO;
        if !self.patch.vertices.iter().any(missing) {
            return;
        }
        let mut sums = vec![DVec3::ZERO; self.patch.vertices.len()];
        for t in &self.patch.triangles {
            let [a, b, c] = t.map(|v| self.place_of(self.patch.vertices[v as usize].point));
            let n = (b - a).cross(c - a);
            for &v in t {
                sums[v as usize] += n;
            }
        }
        for (v, sum) in self.patch.vertices.iter_mut().zip(sums) {
            if missing(v) {
                v.normal = sum.normalize_or(DVec3::Z);
            }
        }
    }
}

/// The middle of a triangle.
fn middle(corners: [[f64; 2]; 3]) -> [f64; 2] {
    [0, 1].map(|d| (corners[0][d] + corners[1][d] + corners[2][d]) / 3.0)
}
