//! The triangles of one surface.
//!
//! On a collapsed line (a side, or a corner line inside that lies on an axis) many vertices share one point. Triangles with
//! two corners there have no area and are left out: what they would cover in space is an edge of a triangle beside them.
//! Each remaining triangle gets its own vertex at that point, with the normal of the middle of its opposite edge, so that
//! the tip of a cone is shaded like its flank.

use super::bisection::Place;
use super::layout::Layout;
use super::lines::{Key, index, inwards, key};
use super::options::MeshError;
use super::slide::is_turned;
use super::stitch::Border;
use super::{MeshPatch, MeshVertex};
use crate::breaks::Limit;
use crate::interval::Interval;
use crate::surface::{Side, Surface, jet_len, normal_at, normal_from};
use glam::DVec3;
use std::collections::HashMap;

/// Shares of the way to the middle of a triangle at which a normal is looked for where not even a limit exists.
const INWARD: [f64; 4] = [1e-6, 1e-4, 1e-2, 0.5];
/// From so many vertices on, the preparations of a list are worth while.
const LIST: usize = 4096;

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

/// What is known about the block being worked on.
struct Work {
    block: [usize; 2],
    range: [Interval; 2],
    /// The normal around which the triangles must be counter-clockwise, if any.
    normal: Option<DVec3>,
    /// Parameters and points of all vertices of the net.
    spots: Vec<Spot>,
    /// The derivatives there.
    jets: Vec<[DVec3; 3]>,
    /// The vertices of the patch, with their block: blocks differ in the normals on their common lines.
    vertices: Vec<Option<([usize; 2], u32)>>,
}

impl Builder<'_> {
    /// Makes all triangles.
    pub(super) fn run(&mut self) -> Result<(), MeshError> {
        let layout = self.layout;
        let jets = self.jets();
        let spots = self.spots(&jets)?;
        let mut work = Work {
            range: [Interval::ZERO; 2],
            normal: None,
            block: [0; 2],
            vertices: vec![None; spots.len()],
            spots,
            jets,
        };
        for region in &layout.regions {
            work.block = region.block;
            work.range = [0, 1].map(|d| layout.blocks[d][region.block[d]]);
            work.normal = region.normal;
            for cell in region.each() {
                self.cell(cell, &mut work)?;
            }
        }
        self.complete_normals();
        Ok(())
    }

    /// The points of all vertices of the net with their first derivatives.
    fn jets(&self) -> Vec<[DVec3; 3]> {
        let net = &self.layout.net;
        let uv: Vec<[f64; 2]> = net.places.iter().map(|&p| net.uv(p)).collect();
        let mut out = vec![[DVec3::ZERO; jet_len(1)]; uv.len()];
        if uv.len() < LIST {
            for (uv, out) in uv.iter().zip(&mut out) {
                self.surface.jet_into(*uv, [Limit::Above; 2], 1, out);
            }
        } else {
            self.surface.jets(&uv, 1, out.as_flattened_mut());
        }
        out
    }

    /// Gives each vertex of the net its point.
    fn spots(&mut self, jets: &[[DVec3; 3]]) -> Result<Vec<Spot>, MeshError> {
        let layout = self.layout;
        let mut spots = Vec::with_capacity(jets.len());
        for (number, (&place, jet)) in layout.net.places.iter().zip(jets).enumerate() {
            let mut spot = self.spot(layout.net.uv(place), self.is_on_side(place), jet[0])?;
            spot.number = Some(number as u32);
            spots.push(spot);
        }
        Ok(spots)
    }

    fn is_on_side(&self, place: Place) -> bool {
        let last = self.layout.net.last();
        (0..2).any(|d| place[d] == 0 || place[d] == last[d])
    }

    /// A spot whose point is that of other surfaces if it is shared; `p` is the surface's own.
    fn spot(&mut self, uv: [f64; 2], on_side: bool, p: DVec3) -> Result<Spot, MeshError> {
        let line = (0..self.collapsed.len())
            .find(|&l| uv[self.collapsed[l].across] == self.collapsed[l].at);
        let known = if on_side {
            self.on_sides.get(&key(uv)).copied()
        } else {
            None
        };
        if !p.is_finite() {
            return Err(MeshError::NotFinite {
                surface: self.index,
                uv,
            });
        }
        let point = match known.or_else(|| self.collapsed[line?].point) {
            Some(point) => point,
            None => {
                self.own.push(p);
                (self.shared.len() + self.own.len()) as u32 - 1
            }
        };
        if let Some(l) = line {
            self.collapsed[l].point.get_or_insert(point);
        }
        self.gap = self.gap.max(self.place_of(point).distance(p));
        Ok(Spot {
            uv,
            point,
            tip: line.map(|l| 1 - self.collapsed[l].across),
            number: None,
        })
    }

    fn place_of(&self, point: u32) -> DVec3 {
        let point = point as usize;
        let own = || self.own[point - self.shared.len()];
        self.shared.get(point).copied().unwrap_or_else(own)
    }

    fn cell(&mut self, cell: [usize; 2], work: &mut Work) -> Result<(), MeshError> {
        let layout = self.layout;
        let mut triangles = Vec::new();
        layout.net.triangles(cell, |t| triangles.push(t));
        for t in triangles {
            let corners = t.map(|k| work.spots[k as usize]);
            let places = t.map(|k| layout.net.places[k as usize]);
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
                continue;
            };
            let mut chain = vec![corners[k]];
            for t in params {
                let mut uv = corners[k].uv;
                uv[index(side.along())] = t;
                chain.push(self.spot(uv, true, self.surface.point(uv))?);
            }
            chain.push(corners[(k + 1) % 3]);
            for ends in chain.windows(2) {
                self.triangle([ends[0], ends[1], corners[(k + 2) % 3]], true, work);
            }
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
            let at = corners.map(|c| self.surface.point(c.uv));
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
        if let (Some(number), None) = (spot.number, spot.tip) {
            match work.vertices[number as usize] {
                Some((block, vertex)) if block == work.block => return vertex,
                _ => {}
            }
        }
        let mut uv = spot.uv;
        if let Some(along) = spot.tip {
            uv[along] = 0.5 * (others[0][along] + others[1][along]);
        }
        let middle = [0, 1].map(|d| (spot.uv[d] + others[0][d] + others[1][d]) / 3.0);
        let jet = spot.number.filter(|_| spot.tip.is_none());
        let normal = self.normal(uv, middle, jet.map(|n| &work.jets[n as usize]), work.range);
        let next = self.patch.vertices.len() as u32;
        self.patch.vertices.push(MeshVertex {
            point: spot.point,
            uv,
            normal,
        });
        if let (Some(number), None) = (spot.number, spot.tip) {
            work.vertices[number as usize] = Some((work.block, next));
        }
        next
    }

    /// The unit normal, as the limit from inside the block; zero where none is found.
    fn normal(
        &self,
        uv: [f64; 2],
        middle: [f64; 2],
        jet: Option<&[DVec3; 3]>,
        range: [Interval; 2],
    ) -> DVec3 {
        let limit = inwards(uv, range);
        // Those of a list are limits from above.
        if let Some(jet) = jet.filter(|_| limit == [Limit::Above; 2])
            && let Some(n) = normal_from(self.surface, uv, limit, jet).vector()
        {
            return n;
        }
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
