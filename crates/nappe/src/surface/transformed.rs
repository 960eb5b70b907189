//! Surfaces under affine maps, and with u and v exchanged.

use super::elementary::{Elementary, normal_image};
use super::{Dir, Surface, SurfaceRef, Swept, check_length, jet_index, jet_len};
use crate::box3::Box3;
use crate::breaks::{Break, Limit, Part};
use crate::exact::NurbsSurface;
use crate::interval::Interval;
use glam::{DAffine3, DVec3, Vec4Swizzles};
use thiserror::Error;

/// The smallest volume of the image of the unit cube, relative to the product of its edges, that is a map of space onto
/// space: with less, the image is flat within rounding and its normals are noise.
const FLATTENED: f64 = 1e-12;

/// How many points are evaluated before they are mapped or put in place: their jets stay in the second-level cache.
const PART: usize = 4096;

/// How many rows of a grid make such a part.
fn rows_of(columns: usize) -> usize {
    (PART / columns.max(1)).max(1)
}

/// What can be wrong with a map of a surface.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TransformError {
    /// A coefficient is NaN or infinite.
    #[error("the map has a coefficient that is not a finite number: {map:?}")]
    NotFinite {
        /// The map.
        map: DAffine3,
    },
    /// The map flattens space into a plane, a line or a point.
    #[error(
        "the map takes space into a plane, a line or a point (its determinant is {determinant}): a surface would collapse"
    )]
    Flattens {
        /// The determinant.
        determinant: f64,
    },
}

/// The image of a surface under an affine map: `r(u, v) → A r(u, v) + b`, exact, with the same parameters.
///
/// A map that mirrors (negative determinant) turns the orientation: `r_u × r_v` of the image is on the other side of
/// the image of the normal. [`Swapped`] turns it back.
#[derive(Clone, Debug)]
pub struct Transformed {
    surface: SurfaceRef,
    map: DAffine3,
}

impl Transformed {
    /// The image of a surface. Maps that flatten space are refused.
    pub fn new(surface: SurfaceRef, map: DAffine3) -> Result<Self, TransformError> {
        if !map.is_finite() {
            return Err(TransformError::NotFinite { map });
        }
        let m = map.matrix3;
        let edges = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
        let determinant = m.determinant();
        if determinant.abs() <= FLATTENED * edges || edges == 0.0 {
            return Err(TransformError::Flattens { determinant });
        }
        Ok(Self { surface, map })
    }

    /// The surface before the map.
    pub fn surface(&self) -> &SurfaceRef {
        &self.surface
    }

    /// The map.
    pub fn map(&self) -> &DAffine3 {
        &self.map
    }

    /// True if the orientation is turned.
    pub fn mirrors(&self) -> bool {
        self.map.matrix3.determinant() < 0.0
    }

    /// The unit normal of the image from that of the surface, on the side of the image's `r_u × r_v`.
    pub fn normal(&self, n: DVec3) -> Option<DVec3> {
        normal_image(&self.map.matrix3, n).try_normalize()
    }

    /// Maps jets of some length.
    fn apply(&self, each: usize, out: &mut [DVec3]) {
        for jet in out.chunks_exact_mut(each) {
            for d in jet.iter_mut() {
                *d = self.map.matrix3 * *d;
            }
            jet[0] += self.map.translation;
        }
    }

    fn nurbs(&self, n: NurbsSurface) -> NurbsSurface {
        let points = n
            .homogeneous()
            .iter()
            .map(|p| (self.map.matrix3 * p.xyz() + self.map.translation * p.w).extend(p.w))
            .collect();
        NurbsSurface::from_homogeneous(n.basis_u().clone(), n.basis_v().clone(), points)
    }
}

impl Surface for Transformed {
    fn breaks(&self, dir: Dir) -> &[Break] {
        self.surface.breaks(dir)
    }

    fn jet_into(&self, uv: [f64; 2], limit: [Limit; 2], order: usize, out: &mut [DVec3]) {
        self.surface.jet_into(uv, limit, order, out);
        self.apply(out.len(), out);
    }

    fn enclose_piece(&self, uv: [Interval; 2], limit: [Limit; 2], order: usize, out: &mut [Box3]) {
        let part = |d: usize| [(uv[d], limit[d])];
        self.enclose_pieces([&part(0), &part(1)], order, out);
    }

    fn enclose_pieces(&self, parts: [&[Part]; 2], order: usize, out: &mut [Box3]) {
        self.surface.enclose_pieces(parts, order, out);
        for jet in out.chunks_exact_mut(jet_len(order)) {
            for b in jet.iter_mut() {
                *b = b.linear_image(&self.map.matrix3);
            }
            jet[0] = jet[0] + Box3::point(self.map.translation);
        }
    }

    fn jets(&self, uv: &[[f64; 2]], order: usize, out: &mut [DVec3]) {
        let each = jet_len(order);
        check_length(uv.len() * each, out.len());
        // By parts that stay in the caches between being written and being mapped.
        for (uv, out) in uv.chunks(PART).zip(out.chunks_mut(PART * each)) {
            self.surface.jets(uv, order, out);
            self.apply(each, out);
        }
    }

    fn grid_jets(&self, u: &[f64], v: &[f64], order: usize, out: &mut [DVec3]) {
        let each = jet_len(order);
        check_length(u.len() * v.len() * each, out.len());
        let rows = rows_of(v.len());
        for (u, out) in u
            .chunks(rows)
            .zip(out.chunks_mut(rows * (v.len() * each).max(1)))
        {
            self.surface.grid_jets(u, v, order, out);
            self.apply(each, out);
        }
    }

    fn to_nurbs(&self) -> Option<NurbsSurface> {
        Some(self.nurbs(self.surface.to_nurbs()?))
    }

    fn to_rational(&self) -> Option<NurbsSurface> {
        Some(self.nurbs(self.surface.to_rational()?))
    }

    fn elementary(&self) -> Option<Elementary> {
        self.surface.elementary()?.transformed(&self.map)
    }

    fn swept(&self) -> Option<Swept> {
        self.surface.swept()?.transformed(&self.map)
    }
}

/// A surface with u and v exchanged: `r(v, u)`. The points are the same, the orientation is turned.
#[derive(Clone, Debug)]
pub struct Swapped {
    surface: SurfaceRef,
}

impl Swapped {
    /// Exchanges u and v.
    pub fn new(surface: SurfaceRef) -> Self {
        Self { surface }
    }

    /// The surface before the exchange.
    pub fn surface(&self) -> &SurfaceRef {
        &self.surface
    }
}

/// Exchanges the places of `∂ⁱᵤ∂ʲᵥ` and `∂ʲᵤ∂ⁱᵥ` in a jet.
fn swap_jet<T>(order: usize, out: &mut [T]) {
    for n in 1..=order {
        for j in 0..n.div_ceil(2) {
            out.swap(jet_index(n - j, j), jet_index(j, n - j));
        }
    }
}

fn swap_nurbs(n: &NurbsSurface) -> NurbsSurface {
    let [rows, columns] = n.size();
    let h = n.homogeneous();
    let points = (0..columns)
        .flat_map(|j| (0..rows).map(move |i| h[i * columns + j]))
        .collect();
    NurbsSurface::from_homogeneous(n.basis_v().clone(), n.basis_u().clone(), points)
}

impl Surface for Swapped {
    fn breaks(&self, dir: Dir) -> &[Break] {
        self.surface.breaks(match dir {
            Dir::U => Dir::V,
            Dir::V => Dir::U,
        })
    }

    fn jet_into(&self, uv: [f64; 2], limit: [Limit; 2], order: usize, out: &mut [DVec3]) {
        let ([u, v], [a, b]) = (uv, limit);
        self.surface.jet_into([v, u], [b, a], order, out);
        swap_jet(order, out);
    }

    fn enclose_piece(&self, uv: [Interval; 2], limit: [Limit; 2], order: usize, out: &mut [Box3]) {
        let ([u, v], [a, b]) = (uv, limit);
        self.surface.enclose_piece([v, u], [b, a], order, out);
        swap_jet(order, out);
    }

    fn enclose(&self, uv: [Interval; 2], order: usize) -> Vec<Box3> {
        let [u, v] = uv;
        let mut boxes = self.surface.enclose([v, u], order);
        swap_jet(order, &mut boxes);
        boxes
    }

    fn jets(&self, uv: &[[f64; 2]], order: usize, out: &mut [DVec3]) {
        let each = jet_len(order);
        check_length(uv.len() * each, out.len());
        let vu: Vec<[f64; 2]> = uv.iter().map(|&[u, v]| [v, u]).collect();
        self.surface.jets(&vu, order, out);
        for jet in out.chunks_exact_mut(each) {
            swap_jet(order, jet);
        }
    }

    fn grid_jets(&self, u: &[f64], v: &[f64], order: usize, out: &mut [DVec3]) {
        let each = jet_len(order);
        check_length(u.len() * v.len() * each, out.len());
        // Rows of the inner grid are columns of this one.
        let rows = rows_of(u.len());
        let mut part = vec![DVec3::ZERO; rows.min(v.len()) * u.len() * each];
        for (k, vs) in v.chunks(rows).enumerate() {
            let part = &mut part[..vs.len() * u.len() * each];
            self.surface.grid_jets(vs, u, order, part);
            for (i, row) in out.chunks_exact_mut(v.len() * each).enumerate() {
                let row = &mut row[k * rows * each..][..vs.len() * each];
                for (j, jet) in row.chunks_exact_mut(each).enumerate() {
                    jet.copy_from_slice(&part[(j * u.len() + i) * each..][..each]);
                    swap_jet(order, jet);
                }
            }
        }
    }

    fn to_nurbs(&self) -> Option<NurbsSurface> {
        Some(swap_nurbs(&self.surface.to_nurbs()?))
    }

    fn to_rational(&self) -> Option<NurbsSurface> {
        Some(swap_nurbs(&self.surface.to_rational()?))
    }

    fn elementary(&self) -> Option<Elementary> {
        Some(self.surface.elementary()?.flipped())
    }

    fn swept(&self) -> Option<Swept> {
        Some(self.surface.swept()?.flipped())
    }
}
