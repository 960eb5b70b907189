//! The triangles of one surface.
//!
//! On a collapsed line (a side, or a corner line inside that lies on an axis) many vertices share one point. Triangles with two corners there have no area and are left out:
//! what they would cover in space is an edge of a triangle beside them. Each remaining triangle gets its own vertex at
//! that point, with the normal of the middle of its opposite edge, so that the tip of a cone is shaded like its flank.

use super::layout::{Layout, Leaf};
use super::lines::{Key, Lines, key};
use super::options::MeshError;
use super::slide::is_turned;
use super::zip::Cell;
use super::{MeshPatch, MeshVertex};
use crate::breaks::Limit;
use crate::interval::Interval;
use crate::surface::{Corner, Dir, Side, Surface, normal_at};
use glam::DVec3;
use std::collections::HashMap;

/// Marks the number of a vertex on a collapsed line, until its triangle is known.
const POLE: u32 = 1 << 31;
/// Shares of the way to the middle of a leaf at which a normal is looked for where not even a limit exists.
const INWARD: [f64; 4] = [1e-6, 1e-4, 1e-2, 0.5];

/// A vertex on a collapsed line.
#[derive(Clone, Copy)]
struct Pole {
    point: u32,
    uv: [f64; 2],
    /// The parameter that runs along the collapsed line: 0 for u, 1 for v.
    along: usize,
}

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
    pub(super) lines: Lines,
    /// The lines that are one point each.
    pub(super) collapsed: Vec<Collapsed>,
    /// The points on the borders of leaves.
    pub(super) on_lines: HashMap<Key, u32>,
    /// The points that it shares with others.
    pub(super) shared: &'a [DVec3],
    /// Its own points, numbered after the shared ones.
    pub(super) own: Vec<DVec3>,
    /// The vertices on the borders of leaves, one for each block: blocks differ in the normal.
    pub(super) vertex_of: HashMap<([usize; 2], Key), u32>,
    pub(super) patch: MeshPatch,
    /// The corners of the domain whose triangle may not be made, see [`Shared::pinched`](super::shared::Shared::pinched).
    pub(super) pinched: [bool; 4],
    /// The largest distance of a vertex' point from the surface.
    pub(super) gap: f64,
    /// The rounding errors of points.
    pub(super) rounding: f64,
    /// True if a triangle turned out clockwise where the bound needs it counter-clockwise.
    pub(super) turned_over: bool,
}

/// What is known about the leaf being worked on.
struct Place {
    block: [usize; 2],
    range: [Interval; 2],
    middle: [f64; 2],
    /// The normal around which the triangles must be counter-clockwise, if any.
    normal: Option<DVec3>,
}

impl Builder<'_> {
    /// Makes all triangles.
    pub(super) fn run(&mut self) -> Result<(), MeshError> {
        let mut poles = Vec::new();
        let layout = self.layout;
        for leaf in &layout.leaves {
            self.leaf(leaf, &mut poles)?;
        }
        self.complete_normals();
        Ok(())
    }

    fn leaf(&mut self, leaf: &Leaf, poles: &mut Vec<Pole>) -> Result<(), MeshError> {
        let range = [0, 1].map(|d| self.layout.blocks[d][leaf.block[d]]);
        let [us, vs] = [0, 1].map(|d| leaf.parts[d].params(range[d]));
        let (n, m) = (us.len() - 1, vs.len() - 1);
        let place = Place {
            block: leaf.block,
            range,
            middle: [0.5 * (us[0] + us[n]), 0.5 * (vs[0] + vs[m])],
            normal: leaf.normal,
        };
        let mut grid = vec![DVec3::ZERO; us.len() * vs.len()];
        self.surface.grid(&us, &vs, &mut grid);
        let mut ids = Vec::with_capacity(grid.len());
        for (i, &u) in us.iter().enumerate() {
            for (j, &v) in vs.iter().enumerate() {
                let (uv, p) = ([u, v], grid[i * (m + 1) + j]);
                ids.push(if i == 0 || j == 0 || i == n || j == m {
                    self.on_border(&place, uv, p, poles)?
                } else {
                    let point = self.add_point(uv, p)?;
                    self.add_vertex(&place, uv, point)
                });
            }
        }
        let id = |i: usize, j: usize| ids[i * (m + 1) + j];
        let mut chain: [Vec<u32>; 4] = Default::default();
        for i in 0..n {
            for j in 0..m {
                let corner = [id(i, j), id(i + 1, j), id(i, j + 1), id(i + 1, j + 1)];
                let ends = [[0, 1], [2, 3], [0, 2], [1, 3]];
                let outer = [j == 0, j + 1 == m, i == 0, i + 1 == n];
                for (s, side) in Side::ALL.into_iter().enumerate() {
                    chain[s].clear();
                    chain[s].push(corner[ends[s][0]]);
                    if outer[s] {
                        let (at, from, to) = match side.along() {
                            Dir::U => (vs[j + usize::from(side.is_upper())], us[i], us[i + 1]),
                            Dir::V => (us[i + usize::from(side.is_upper())], vs[j], vs[j + 1]),
                        };
                        for t in self.lines.between(side.across(), at, from, to).to_vec() {
                            let uv = match side.along() {
                                Dir::U => [t, at],
                                Dir::V => [at, t],
                            };
                            let p = self.surface.point(uv);
                            chain[s].push(self.on_border(&place, uv, p, poles)?);
                        }
                    }
                    chain[s].push(corner[ends[s][1]]);
                }
                let cell = Cell {
                    south: &chain[0],
                    north: &chain[1],
                    west: &chain[2],
                    east: &chain[3],
                };
                let mut triangles = Vec::with_capacity(2);
                if self.is_pinched([us[i], us[i + 1]], [vs[j], vs[j + 1]]) {
                    let uv = [0.5 * (us[i] + us[i + 1]), 0.5 * (vs[j] + vs[j + 1])];
                    let point = self.add_point(uv, self.surface.point(uv))?;
                    let middle = self.add_vertex(&place, uv, point);
                    cell.fan(middle, |t| triangles.push(t));
                } else if let Some(side) = self.collapsed_side(&cell, poles) {
                    cell.around_tip(
                        side,
                        |t| self.quality(&place, t, poles),
                        |t| triangles.push(t),
                    );
                } else {
                    cell.triangles(|t| self.quality(&place, t, poles), |t| triangles.push(t));
                }
                // Those of a cell without further vertices have edges along u and v.
                let further = triangles.len() > 2;
                if let Some(normal) = place.normal.filter(|_| further) {
                    self.turned_over |= !triangles.iter().all(|t| {
                        let p = t.map(|v| self.surface.point(self.uv_of(v, poles)));
                        is_turned(p, normal, self.rounding)
                    });
                }
                for t in triangles {
                    self.add_triangle(&place, t, poles);
                }
            }
        }
        Ok(())
    }

    /// The side of a cell that lies on a collapsed line.
    fn collapsed_side(&self, cell: &Cell, poles: &[Pole]) -> Option<Side> {
        Side::ALL.into_iter().find(|&side| {
            let chain = cell.side(side);
            chain.iter().all(|v| v & POLE != 0)
                && self.point_of(chain[0], poles) == self.point_of(chain[chain.len() - 1], poles)
        })
    }

    /// True if a cell is at a corner of the domain whose triangle may not be made.
    fn is_pinched(&self, u: [f64; 2], v: [f64; 2]) -> bool {
        let [du, dv] = self.surface.domain();
        let at = |[lo, hi]: [f64; 2], d: Interval, end| [lo == d.lo, hi == d.hi][end];
        Corner::ALL
            .into_iter()
            .zip(self.pinched)
            .any(|(c, pinched)| {
                let [i, j] = c.ends();
                pinched && at(u, du, i) && at(v, dv, j)
            })
    }

    fn add_point(&mut self, uv: [f64; 2], p: DVec3) -> Result<u32, MeshError> {
        if !p.is_finite() {
            return Err(MeshError::NotFinite {
                surface: self.index,
                uv,
            });
        }
        self.own.push(p);
        Ok((self.shared.len() + self.own.len()) as u32 - 1)
    }

    fn add_vertex(&mut self, place: &Place, uv: [f64; 2], point: u32) -> u32 {
        let normal = self.normal(place, uv);
        self.patch.vertices.push(MeshVertex { point, uv, normal });
        self.patch.vertices.len() as u32 - 1
    }

    /// The vertex on the border of a leaf; `p` is the surface's point there.
    fn on_border(
        &mut self,
        place: &Place,
        uv: [f64; 2],
        p: DVec3,
        poles: &mut Vec<Pole>,
    ) -> Result<u32, MeshError> {
        let at = (place.block, key(uv));
        if let Some(&v) = self.vertex_of.get(&at) {
            return Ok(v);
        }
        let line = (0..self.collapsed.len())
            .find(|&l| uv[self.collapsed[l].across] == self.collapsed[l].at);
        let known = self.on_lines.get(&at.1).copied();
        let point = match known.or_else(|| self.collapsed[line?].point) {
            Some(point) => point,
            None => self.add_point(uv, p)?,
        };
        self.on_lines.insert(at.1, point);
        if let Some(l) = line {
            self.collapsed[l].point.get_or_insert(point);
        }
        let gap = self.place_of(point).distance(p);
        if gap.is_nan() {
            return Err(MeshError::NotFinite {
                surface: self.index,
                uv,
            });
        }
        self.gap = self.gap.max(gap);
        let vertex = match line {
            Some(l) => {
                let along = 1 - self.collapsed[l].across;
                poles.push(Pole { point, uv, along });
                POLE | (poles.len() as u32 - 1)
            }
            None => self.add_vertex(place, uv, point),
        };
        self.vertex_of.insert(at, vertex);
        Ok(vertex)
    }

    fn place_of(&self, point: u32) -> DVec3 {
        let point = point as usize;
        let own = || self.own[point - self.shared.len()];
        self.shared.get(point).copied().unwrap_or_else(own)
    }

    fn point_of(&self, vertex: u32, poles: &[Pole]) -> u32 {
        if vertex & POLE == 0 {
            self.patch.vertices[vertex as usize].point
        } else {
            poles[(vertex & !POLE) as usize].point
        }
    }

    fn uv_of(&self, vertex: u32, poles: &[Pole]) -> [f64; 2] {
        if vertex & POLE == 0 {
            self.patch.vertices[vertex as usize].uv
        } else {
            poles[(vertex & !POLE) as usize].uv
        }
    }

    /// Twice the area over the square of the longest edge, negative if the triangle must turn the other way.
    fn quality(&self, place: &Place, t: [u32; 3], poles: &[Pole]) -> f64 {
        let [a, b, c] = t.map(|v| self.place_of(self.point_of(v, poles)));
        let (x, y) = (b - a, c - a);
        let longest = x
            .length_squared()
            .max(y.length_squared())
            .max(c.distance_squared(b));
        if longest > 0.0 {
            let area = x.cross(y);
            place.normal.map_or(area.length(), |n| n.dot(area)) / longest
        } else {
            0.0
        }
    }

    fn add_triangle(&mut self, place: &Place, mut t: [u32; 3], poles: &[Pole]) {
        let p = t.map(|v| self.point_of(v, poles));
        if p[0] == p[1] || p[1] == p[2] || p[2] == p[0] {
            return;
        }
        for k in 0..3 {
            if t[k] & POLE == 0 {
                continue;
            }
            let pole = poles[(t[k] & !POLE) as usize];
            let mut uv = pole.uv;
            let others = [t[(k + 1) % 3], t[(k + 2) % 3]];
            let at = others.map(|v| self.uv_of(v, poles)[pole.along]);
            uv[pole.along] = 0.5 * (at[0] + at[1]);
            t[k] = self.add_vertex(place, uv, pole.point);
        }
        self.patch.triangles.push(t);
    }

    /// The unit normal, as the limit from inside the block; zero where none is found.
    fn normal(&self, place: &Place, uv: [f64; 2]) -> DVec3 {
        let limit = [0, 1].map(|d| {
            if uv[d] >= place.range[d].hi {
                Limit::Below
            } else {
                Limit::Above
            }
        });
        let at = |uv: [f64; 2]| normal_at(self.surface, uv, limit).vector();
        at(uv)
            .or_else(|| {
                INWARD
                    .into_iter()
                    .find_map(|f| at([0, 1].map(|d| uv[d] + f * (place.middle[d] - uv[d]))))
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
