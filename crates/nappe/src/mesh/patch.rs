//! The triangles of one surface.
//!
//! On a collapsed line (a side, or a corner line inside that lies on an axis) many vertices share one point. Triangles with
//! two corners there have no area and are left out: what they would cover in space is an edge of a triangle beside them.
//! Each remaining triangle gets its own vertex at that point, with the normal of the middle of its opposite edge, so that
//! the tip of a cone is shaded like its flank.

use super::bisection::Place;
use super::layout::{Layout, Region};
use super::lines::{Key, index, key};
use super::numbered::{MARKED, Numbered, Share};
use super::options::MeshError;
use super::slide::is_turned;
use super::stitch::Border;
use super::{MeshPatch, MeshVertex};
use crate::breaks::{Limit, inwards};
use crate::interval::Interval;
use crate::parallel;
use crate::surface::{PlainNormals, Side, Surface, jet_len, normal_at, normal_from};
use glam::DVec3;
use rustc_hash::FxHashMap;
use std::mem::take;

/// Shares of the way to the middle of a triangle at which a normal is looked for where not even a limit exists.
const INWARD: [f64; 4] = [1e-6, 1e-4, 1e-2, 0.5];
/// From so many vertices on, the preparations of a list are worth while, and so are threads.
const LIST: usize = 4096;
/// About the vertices that are evaluated at once: their derivatives stay in the caches.
const AT_ONCE: usize = 512;
/// About the triangles that a thread hands out at once, if cells have not more.
const SHARE: usize = 2048;

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
    pub(super) on_sides: FxHashMap<Key, u32>,
    /// The points that it shares with others.
    pub(super) shared: &'a [DVec3],
    /// Its own points, numbered after the shared ones; if it is the first, after these themselves.
    pub(super) own: Vec<DVec3>,
    /// The number of points that are ahead of its own ones there.
    pub(super) ahead: usize,
    pub(super) patch: MeshPatch,
    /// True if a vertex may lack a normal.
    pub(super) lacking: bool,
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

/// Some vertices of the patch inside of blocks, with the points of their own.
struct Plain {
    vertices: Vec<MeshVertex>,
    own: Vec<DVec3>,
    /// The parameters of a point that is not finite.
    not_finite: Option<[f64; 2]>,
    /// True if a normal is still to be found.
    lacking: bool,
}

/// A vertex of the net on the surface: the normal is the limit from above, and zero where the tangents do not tell.
struct Site {
    uv: [f64; 2],
    place: DVec3,
    normal: DVec3,
}

/// A vertex of the net on a side or between blocks, marked there: triangles take a closer look.
struct Special {
    place: Place,
    site: Site,
    point: u32,
    /// The vertex of the patch, and the block that it is one for, from 1; blocks differ in the normals on common lines.
    vertex: u32,
    block: u32,
}

/// What is known about the vertices of the net and the block being worked on.
struct Work<'a> {
    net: &'a Numbered<'a>,
    /// The marked vertices.
    special: Vec<Special>,
    block: u32,
    range: [Interval; 2],
    /// The normal around which the triangles must be counter-clockwise, if any.
    normal: Option<DVec3>,
}

impl Work<'_> {
    /// The special vertex of a number, or else the vertex of the patch.
    fn special(&self, number: u32) -> Result<&Special, u32> {
        match number.checked_sub(MARKED) {
            Some(k) => Ok(&self.special[k as usize]),
            None => Err(number),
        }
    }
}

/// The triangles of some cells.
#[derive(Default)]
struct Cells {
    /// Those without special vertices, by the vertices of the patch.
    plain: Vec<[u32; 3]>,
    /// The others, by those of the net, and whether they are halves.
    special: Vec<([u32; 3], bool)>,
    turned_over: bool,
}

impl Builder<'_> {
    /// Makes all triangles.
    pub(super) fn run(&mut self) -> Result<(), MeshError> {
        let layout = self.layout;
        let cuts = [0, 1].map(|d| -> Vec<bool> {
            let blocks = &layout.blocks[d];
            let is_cut = |t: &f64| {
                let above = blocks.partition_point(|b| b.hi < *t);
                blocks.get(above).is_none_or(|b| b.lo >= *t || b.hi <= *t)
            };
            layout.net.lines[d].iter().map(is_cut).collect()
        });
        // Rounding may put others on a line that is one point.
        let is_tip = |place: Place| self.tip(layout.net.uv(place)).is_some();
        let is_tip = (!self.collapsed.is_empty()).then_some(is_tip);
        let net = Numbered::new(&layout.net, &cuts, is_tip);
        let mut work = self.vertices(&net)?;
        self.patch.triangles.reserve(2 * layout.net.count());
        for region in &layout.regions {
            let [i, j] = region.block;
            work.block = 1 + (i * layout.blocks[1].len() + j) as u32;
            work.range = [0, 1].map(|d| layout.blocks[d][region.block[d]]);
            work.normal = region.normal;
            self.region(region, &mut work)?;
        }
        if self.lacking {
            self.find_normals(net.plain);
            self.complete_normals();
        }
        Ok(())
    }

    /// Makes the vertices of the patch that are inside of blocks, and gives the others their points.
    fn vertices<'n>(&mut self, net: &'n Numbered) -> Result<Work<'n>, MeshError> {
        let few = net.plain + net.marked.len() < LIST;
        self.plain(net, few)?;
        let mut work = Work {
            net,
            special: Vec::with_capacity(net.marked.len()),
            range: [Interval::ZERO; 2],
            normal: None,
            block: 0,
        };
        for places in net.marked.chunks(AT_ONCE) {
            let uv = places.iter().map(|&p| self.layout.net.uv(p)).collect();
            for (&place, site) in places.iter().zip(self.sites(uv, few)) {
                work.special.push(Special {
                    point: self.point(site.uv, self.is_on_side(place), site.place)?,
                    place,
                    site,
                    vertex: 0,
                    block: 0,
                });
            }
        }
        Ok(work)
    }

    /// Makes the vertices of the patch, and points of its own, at places inside of blocks.
    fn plain(&mut self, net: &Numbered, few: bool) -> Result<(), MeshError> {
        let all = net.plain + net.marked.len();
        let mut vertices = Vec::with_capacity(all);
        let mut own = Vec::with_capacity(self.own.len() + all);
        own.append(&mut self.own);
        let shares = net.shares(AT_ONCE);
        let threads = if few { 1 } else { self.threads };
        let normals = (!few).then(|| PlainNormals::new(self.surface));
        let (mut not_finite, mut lacking) = (None, false);
        // Memory is touched for the first time while others evaluate.
        parallel::in_order(
            threads,
            shares.len(),
            |k| self.plain_share(net, &shares[k], normals.as_ref()),
            |_| false,
            |share| {
                own.extend_from_slice(&share.own);
                vertices.extend_from_slice(&share.vertices);
                not_finite = not_finite.or(share.not_finite);
                lacking |= share.lacking;
            },
        );
        if let Some(uv) = not_finite {
            return Err(self.not_finite(uv));
        }
        self.patch.vertices = vertices;
        self.own = own;
        self.lacking = lacking;
        Ok(())
    }

    /// Some of them; with `normals` as a list.
    fn plain_share(&self, net: &Numbered, share: &Share, normals: Option<&PlainNormals>) -> Plain {
        let mut uv = Vec::new();
        net.uv(share, &mut uv);
        let first = self.shared.len() + share.first;
        let mut out = Plain {
            vertices: Vec::with_capacity(uv.len()),
            own: Vec::with_capacity(uv.len()),
            not_finite: None,
            lacking: false,
        };
        let jets = self.jets(&uv, normals.is_none());
        for (k, (&uv, jet)) in uv.iter().zip(&jets).enumerate() {
            let known = normals.and_then(|n| n.of(jet));
            let normal = known.unwrap_or_else(|| self.normal_above(uv, jet));
            if !jet[0].is_finite() {
                out.not_finite.get_or_insert(uv);
            }
            out.lacking |= normal == DVec3::ZERO;
            out.own.push(jet[0]);
            out.vertices.push(MeshVertex {
                point: (first + k) as u32,
                uv,
                normal,
            });
        }
        out
    }

    /// The points and first derivatives of vertices.
    fn jets(&self, uv: &[[f64; 2]], few: bool) -> Vec<[DVec3; jet_len(1)]> {
        let mut jets = vec![[DVec3::ZERO; jet_len(1)]; uv.len()];
        if few {
            for (uv, jet) in uv.iter().zip(&mut jets) {
                self.surface.jet_into(*uv, [Limit::Above; 2], 1, jet);
            }
        } else {
            self.surface.jets(uv, 1, jets.as_flattened_mut());
        }
        jets
    }

    /// The normal as the limit from above, zero where the tangents do not tell.
    fn normal_above(&self, uv: [f64; 2], jet: &[DVec3; jet_len(1)]) -> DVec3 {
        let normal = normal_from(self.surface, uv, [Limit::Above; 2], jet);
        normal.vector().unwrap_or(DVec3::ZERO)
    }

    /// Evaluates vertices of the net.
    fn sites(&self, uv: Vec<[f64; 2]>, few: bool) -> Vec<Site> {
        let jets = self.jets(&uv, few);
        let sites = uv.into_iter().zip(jets).map(|(uv, jet)| Site {
            uv,
            place: jet[0],
            normal: self.normal_above(uv, &jet),
        });
        sites.collect()
    }

    fn not_finite(&self, uv: [f64; 2]) -> MeshError {
        MeshError::NotFinite {
            surface: self.index,
            uv,
        }
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
            return Err(self.not_finite(uv));
        }
        let line = self.tip(uv);
        let shared = on_side.then(|| self.on_sides.get(&key(uv)).copied());
        let known = shared
            .flatten()
            .or_else(|| self.collapsed[line?].point)
            .inspect(|&point| self.gap = self.gap.max(self.place_of(point).distance(p)));
        let point = known.unwrap_or_else(|| {
            self.own.push(p);
            (self.shared.len() + self.own.len() - self.ahead) as u32 - 1
        });
        if let Some(l) = line {
            self.collapsed[l].point.get_or_insert(point);
        }
        Ok(point)
    }

    fn place_of(&self, point: u32) -> DVec3 {
        let point = point as usize;
        let own = || self.own_point(point - self.shared.len());
        self.shared.get(point).copied().unwrap_or_else(own)
    }

    /// A point of its own.
    fn own_point(&self, k: usize) -> DVec3 {
        self.own[self.ahead + k]
    }

    /// Makes the triangles of a rectangle of cells.
    fn region(&mut self, region: &Region, work: &mut Work) -> Result<(), MeshError> {
        let cells: Vec<[usize; 2]> = region.each().collect();
        let count = self.layout.net.count();
        let threads = if count < LIST { 1 } else { self.threads };
        let each = 2 * count / cells.len().max(1);
        let share = (SHARE / each.max(1)).max(1);
        let shares: Vec<_> = cells.chunks(share).collect();
        let mut triangles = take(&mut self.patch.triangles);
        let (mut turned_over, mut special) = (false, Vec::new());
        parallel::in_order(
            threads,
            shares.len(),
            |k| self.cells(shares[k], work),
            |_| false,
            |share| {
                turned_over |= share.turned_over;
                triangles.extend(share.plain);
                special.extend(share.special);
            },
        );
        self.turned_over |= turned_over;
        self.patch.triangles = triangles;
        for (t, halved) in special {
            self.special(t, halved, work)?;
        }
        Ok(())
    }

    /// The triangles of some cells.
    fn cells(&self, cells: &[[usize; 2]], work: &Work) -> Cells {
        let mut out = Cells::default();
        for &cell in cells {
            work.net.triangles(cell, |t, halved| {
                if t.iter().any(|&v| v >= MARKED) {
                    return out.special.push((t, halved));
                }
                // Those that are not halved have the edges along u and v that the bound is for.
                if let Some(normal) = work.normal.filter(|_| halved) {
                    let at = t.map(|v| self.own_point(v as usize));
                    out.turned_over |= !is_turned(at, normal, self.rounding);
                }
                out.plain.push(t);
            });
        }
        out
    }

    /// Makes a triangle that may have further vertices on an edge, or two corners at one point, or the wrong orientation.
    fn special(&mut self, t: [u32; 3], halved: bool, work: &mut Work) -> Result<(), MeshError> {
        let corners = t.map(|k| {
            let (uv, point) = match work.special(k) {
                Ok(special) => (special.site.uv, special.point),
                Err(vertex) => {
                    let MeshVertex { uv, point, .. } = self.patch.vertices[vertex as usize];
                    (uv, point)
                }
            };
            self.spot(uv, point, Some(k))
        });
        // All vertices on sides are special.
        let places = t.map(|k| work.special(k).ok().map(|special| special.place));
        // Further vertices are on one side at most, see `Layout::open_corners`.
        let further = (0..3).find_map(|k| {
            let ends = [places[k]?, places[(k + 1) % 3]?];
            let (from, to) = (corners[k].uv, corners[(k + 1) % 3].uv);
            let (side, params) = self.further(ends, from, to)?;
            Some((k, side, params))
        });
        let Some((k, side, params)) = further else {
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
                Some(k) => match work.special(k) {
                    Ok(special) => special.site.place,
                    Err(vertex) => self.own_point(vertex as usize),
                },
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
    fn net_vertex(&mut self, k: u32, middle: impl Fn() -> [f64; 2], work: &mut Work) -> u32 {
        let &Special {
            ref site,
            point,
            vertex,
            block,
            ..
        } = match work.special(k) {
            Ok(special) => special,
            Err(vertex) => return vertex,
        };
        if block == work.block {
            return vertex;
        }
        let above = inwards(site.uv, work.range) == [Limit::Above; 2];
        let normal = if above && site.normal != DVec3::ZERO {
            site.normal
        } else {
            self.normal(site.uv, middle(), work.range)
        };
        let vertex = self.new_vertex(point, site.uv, normal);
        let special = &mut work.special[(k - MARKED) as usize];
        (special.vertex, special.block) = (vertex, work.block);
        vertex
    }

    fn new_vertex(&mut self, point: u32, uv: [f64; 2], normal: DVec3) -> u32 {
        self.lacking |= normal == DVec3::ZERO;
        self.patch.vertices.push(MeshVertex { point, uv, normal });
        self.patch.vertices.len() as u32 - 1
    }

    /// The unit normal, as the limit from inside the block; zero where none is found.
    fn normal(&self, uv: [f64; 2], middle: [f64; 2], range: [Interval; 2]) -> DVec3 {
        let limit = inwards(uv, range);
        let normal = normal_at(self.surface, uv, limit).vector();
        normal.unwrap_or_else(|| self.normal_near(uv, middle, limit))
    }

    /// The unit normal near a place where there is none, towards the middle of a triangle; zero where none is found.
    fn normal_near(&self, uv: [f64; 2], middle: [f64; 2], limit: [Limit; 2]) -> DVec3 {
        let near = INWARD.map(|f| [0, 1].map(|d| uv[d] + f * (middle[d] - uv[d])));
        let normal = |uv: [f64; 2]| normal_at(self.surface, uv, limit).vector();
        near.into_iter().find_map(normal).unwrap_or(DVec3::ZERO)
    }

    /// Looks for normals near those of the first vertices that have none; for special ones that has been done.
    fn find_normals(&mut self, plain: usize) {
        for k in 0..self.patch.triangles.len() {
            let t = self.patch.triangles[k].map(|v| v as usize);
            for v in t {
                if v < plain && self.patch.vertices[v].normal == DVec3::ZERO {
                    let middle = middle(t.map(|v| self.patch.vertices[v].uv));
                    let uv = self.patch.vertices[v].uv;
                    self.patch.vertices[v].normal = self.normal_near(uv, middle, [Limit::Above; 2]);
                }
            }
        }
    }

    /// Gives vertices without a normal the mean of those of their triangles, weighted by area.
    fn complete_normals(&mut self) {
        let lacks = |v: &MeshVertex| v.normal == DVec3::ZERO;
        if !self.patch.vertices.iter().any(lacks) {
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
            if v.normal == DVec3::ZERO {
                v.normal = sum.normalize_or(DVec3::Z);
            }
        }
    }
}

/// The middle of a triangle.
fn middle(corners: [[f64; 2]; 3]) -> [f64; 2] {
    [0, 1].map(|d| (corners[0][d] + corners[1][d] + corners[2][d]) / 3.0)
}
