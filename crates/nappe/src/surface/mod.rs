//! Parametric surfaces: one trait, one engine for everything separable, one file per kind.

use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit, Part};
use crate::exact::NurbsSurface;
use crate::interval::Interval;
use glam::DVec3;
use smallvec::SmallVec;
use std::fmt::{self, Debug};
use std::sync::Arc;

/// Inside `impl Surface for …`: evaluates through another surface that is the same map. Every method of the trait that
/// evaluates is here, so that a faster one reaches all kinds at once.
macro_rules! evaluate_through {
    ($self:ident => $form:expr) => {
        fn breaks(&$self, dir: $crate::surface::Dir) -> &[$crate::breaks::Break] {
            $form.breaks(dir)
        }
        evaluate_through!($self => $form, but for breaks);
    };
    ($self:ident => $form:expr, but for breaks) => {
        fn jet_into(
            &$self,
            uv: [f64; 2],
            limit: [$crate::breaks::Limit; 2],
            order: usize,
            out: &mut [glam::DVec3],
        ) {
            $form.jet_into(uv, limit, order, out);
        }
        fn enclose_piece(
            &$self,
            uv: [$crate::interval::Interval; 2],
            limit: [$crate::breaks::Limit; 2],
            order: usize,
            out: &mut [$crate::box3::Box3],
        ) {
            $form.enclose_piece(uv, limit, order, out);
        }
        fn enclose_pieces(
            &$self,
            parts: [&[$crate::breaks::Part]; 2],
            order: usize,
            out: &mut [$crate::box3::Box3],
        ) {
            $form.enclose_pieces(parts, order, out);
        }
        fn jets(&$self, uv: &[[f64; 2]], order: usize, out: &mut [glam::DVec3]) {
            $form.jets(uv, order, out);
        }
        fn grid_jets(&$self, u: &[f64], v: &[f64], order: usize, out: &mut [glam::DVec3]) {
            $form.grid_jets(u, v, order, out);
        }
        fn grid_normals(&$self, u: &[f64], v: &[f64], out: &mut [[glam::DVec3; 2]]) {
            $form.grid_normals(u, v, out);
        }
    };
}

mod axis_contact;
mod bilinear;
mod biquadratic;
mod blend;
mod bulk;
mod centred;
mod collapsed;
mod compatibility;
mod contour;
mod coons;
mod coons_data;
pub(crate) mod diagonal_key;
mod effect;
mod elementary;
mod fillet;
mod gregory;
mod grid;
mod hermite;
mod list;
pub(crate) mod neighbour;
mod neighbour_second;
mod normal;
mod quadric;
mod quotient;
mod rational;
mod revolution;
mod ruled;
mod sectors;
mod separable;
mod sides;
mod spans;
mod swept;
mod torus;
mod transformed;
mod turned;

pub(crate) use centred::{enclose_centred, enclose_direct};

pub use bilinear::{BilinearError, bilinear};
pub use biquadratic::{BiquadraticError, biquadratic};
pub use blend::{Blend, BlendError, BlendOptions};
pub use bulk::{grid_blocks, in_parallel};
pub use collapsed::{CollapsedError, check_not_collapsed};
pub use compatibility::{Compatibility, Datum, Disagreement, Source};
pub use contour::{Contour, ContourError, CornerGap};
pub use coons::{Coons, CoonsError, CoonsOptions, Cross, Estimate, IncompatibleTwists};
pub use diagonal_key::{DiagonalKey, DiagonalKeyError, DiagonalKeyOptions, Free, Particular};
pub use elementary::Elementary;
pub use fillet::{Fillet, FilletError, FilletOptions, Radius, arc_sections};
pub use hermite::{HermiteData, HermiteError, hermite};
pub use normal::{Normal, normal_at};
pub(crate) use normal::{PlainNormals, normal_from};
pub use quadric::{Quadric, QuadricError, QuadricOptions, QuadricShape};
pub use rational::{RationalError, rational};
pub use revolution::{Construction, Revolution, RevolutionError, RevolutionOptions};
pub use ruled::{RuledError, ruled};
pub use separable::{Core, Separable, Term};
pub use sides::{Corner, Side};
pub use swept::Swept;
pub use torus::{Torus, TorusError, TorusOptions};
pub use transformed::{Swapped, TransformError, Transformed};

/// A shared surface.
pub type SurfaceRef = Arc<dyn Surface>;

/// A parameter direction.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Dir {
    /// Along u.
    U,
    /// Along v.
    V,
}

impl fmt::Display for Dir {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Dir::U => "u",
            Dir::V => "v",
        })
    }
}

/// The place of `∂ⁱᵤ∂ʲᵥ` in a surface jet: by total order, then by j. So 0: r; 1, 2: r_u, r_v; 3, 4, 5: r_uu, r_uv,
/// r_vv; and so on. A jet of a lower order is the beginning of a jet of a higher order.
pub const fn jet_index(i: usize, j: usize) -> usize {
    (i + j) * (i + j + 1) / 2 + j
}

/// The number of derivatives in a jet of the given order.
pub const fn jet_len(order: usize) -> usize {
    (order + 1) * (order + 2) / 2
}

/// A parametric surface `r(u, v)`. Object safe, immutable, shared between threads.
///
/// Implementors write three methods; the rest is provided, and overridden only for speed. The orientation is that of
/// `r_u × r_v`. South is v = 0, north v = 1, west u = 0, east u = 1 (the ends of the domain).
pub trait Surface: Debug + Send + Sync {
    /// The parameters where analytic pieces meet in a direction, the ends of the domain first and last.
    fn breaks(&self, dir: Dir) -> &[Break];

    /// Writes the point and its partial derivatives up to a total `order`, placed by [`jet_index`];
    /// `out.len() == jet_len(order)`. At a break the piece on the side of `limit` (for u and for v) decides.
    fn jet_into(&self, uv: [f64; 2], limit: [Limit; 2], order: usize, out: &mut [DVec3]);

    /// Writes boxes that enclose the same for every parameter pair in `uv`, which lies in one analytic piece.
    /// [`Box3::ENTIRE`] says that nothing can be proven.
    fn enclose_piece(&self, uv: [Interval; 2], limit: [Limit; 2], order: usize, out: &mut [Box3]);

    /// The same surface as a NURBS surface with the same parametrisation, where that exists exactly (within rounding).
    fn to_nurbs(&self) -> Option<NurbsSurface> {
        None
    }

    /// A NURBS surface that is exactly the same set of points, with the same orientation and the same sides, perhaps
    /// with another parametrisation: a surface of revolution by angle has no NURBS form, but rational arcs sweep the
    /// same surface.
    fn to_rational(&self) -> Option<NurbsSurface> {
        self.to_nurbs()
    }

    /// The plane, cylinder, cone, sphere or torus that this surface is a part of, where that is known exactly (within rounding).
    fn elementary(&self) -> Option<Elementary> {
        elementary::plane_of(&self.to_nurbs()?)
    }

    /// The NURBS curve that sweeps this surface, turned or moved, where the surface is made so and that is known exactly
    /// (within rounding). `None` for surfaces that are given as splines.
    fn swept(&self) -> Option<Swept> {
        None
    }

    /// The parameter ranges of u and v.
    fn domain(&self) -> [Interval; 2] {
        [self.breaks(Dir::U).domain(), self.breaks(Dir::V).domain()]
    }

    /// The point and partial derivatives up to `order`.
    fn jet(&self, uv: [f64; 2], limit: [Limit; 2], order: usize) -> SurfaceJet {
        let mut d = SmallVec::from_elem(DVec3::ZERO, jet_len(order));
        self.jet_into(uv, limit, order, &mut d);
        SurfaceJet { d }
    }

    /// The point at `(u, v)`.
    fn point(&self, uv: [f64; 2]) -> DVec3 {
        let mut d = [DVec3::ZERO];
        self.jet_into(uv, [Limit::Above; 2], 0, &mut d);
        d[0]
    }

    /// The points at a list of parameter pairs: [`Surface::jets`] of order 0.
    fn points(&self, uv: &[[f64; 2]], out: &mut [DVec3]) {
        self.jets(uv, 0, out);
    }

    /// The points of a grid: `out[i * v.len() + j]` is the point at `(u[i], v[j])`; [`Surface::grid_jets`] of order 0.
    fn grid(&self, u: &[f64], v: &[f64], out: &mut [DVec3]) {
        self.grid_jets(u, v, 0, out);
    }

    /// The points and derivatives at a list of parameter pairs, `jet_len(order)` vectors a point, placed by
    /// [`jet_index`]; at a break the piece above decides.
    ///
    /// Positions agree with [`Surface::jet`] within 4 units in the last place of the surface's size, derivatives
    /// likewise relative to that size over the width of a piece. Each depends on its own
    /// parameters alone, not on the rest of the list. The first list of a surface prepares its sides, which costs some
    /// microseconds, and up to some tenths of a second where they are no polynomials; pieces are prepared when the first
    /// point falls there. A surface keeps some hundred kilobytes for that, at most some tens of
    /// megabytes. Panics if `out` has another length.
    fn jets(&self, uv: &[[f64; 2]], order: usize, out: &mut [DVec3]) {
        let each = jet_len(order);
        check_length(uv.len() * each, out.len());
        for (out, &uv) in out.chunks_exact_mut(each).zip(uv) {
            self.jet_into(uv, [Limit::Above; 2], order, out);
        }
    }

    /// The points and derivatives of a grid: `jet_len(order)` vectors for each point, points in the order of
    /// [`Surface::grid`]. The same to the last bit as [`Surface::jet`]. Panics if `out` has another length.
    fn grid_jets(&self, u: &[f64], v: &[f64], order: usize, out: &mut [DVec3]) {
        let each = jet_len(order);
        check_length(u.len() * v.len() * each, out.len());
        for (out, uv) in out.chunks_exact_mut(each).zip(pairs(u, v)) {
            self.jet_into(uv, [Limit::Above; 2], order, out);
        }
    }

    /// The points of a grid with the unit normals of [`normal_at`], points in the order of [`Surface::grid`]. Where
    /// there is no normal, the vector is zero; never NaN. Panics if `out` has another length.
    fn grid_normals(&self, u: &[f64], v: &[f64], out: &mut [[DVec3; 2]]) {
        check_length(u.len() * v.len(), out.len());
        for (out, uv) in out.iter_mut().zip(pairs(u, v)) {
            let normal = normal::normal_of(self, uv, [Limit::Above; 2]);
            *out = [self.point(uv), normal.vector().unwrap_or(DVec3::ZERO)];
        }
    }

    /// [`Surface::enclose_piece`] for every pair of a part of u and a part of v, each part in one analytic piece:
    /// `jet_len(order)` boxes a pair, v fastest. Separable surfaces evaluate each part once. Panics if `out` has another
    /// length.
    fn enclose_pieces(&self, parts: [&[Part]; 2], order: usize, out: &mut [Box3]) {
        let each = jet_len(order);
        let [us, vs] = parts;
        check_length(us.len() * vs.len() * each, out.len());
        let pairs = us.iter().flat_map(|u| vs.iter().map(move |v| (u, v)));
        for (out, (&(u, in_u), &(v, in_v))) in out.chunks_exact_mut(each).zip(pairs) {
            self.enclose_piece([u, v], [in_u, in_v], order, out);
        }
    }

    /// Boxes that enclose the point and its derivatives up to `order` over a rectangle, placed by [`jet_index`]: from
    /// both sides at breaks inside; at its ends from the inside, or from both sides in a direction of width zero. Converges at second order: a centred Taylor form is intersected with the direct enclosure.
    fn enclose(&self, uv: [Interval; 2], order: usize) -> Vec<Box3> {
        enclose_centred(self, uv, order)
    }

    /// A box that contains the surface over a rectangle of parameters.
    fn bounds(&self, uv: [Interval; 2]) -> Box3 {
        self.enclose(uv, 0)[0]
    }
}

/// Panics if the caller's room is not what the result needs.
pub(crate) fn check_length(needed: usize, given: usize) {
    assert_eq!(needed, given, "room for exactly the points asked for");
}

/// The parameter pairs of a grid, v fastest.
fn pairs<'a>(u: &'a [f64], v: &'a [f64]) -> impl Iterator<Item = [f64; 2]> + 'a {
    u.iter().flat_map(|&u| v.iter().map(move |&v| [u, v]))
}

/// A point of a surface with its partial derivatives.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceJet {
    /// Derivatives placed by [`jet_index`].
    pub d: SmallVec<[DVec3; 6]>,
}

impl SurfaceJet {
    /// The point.
    pub fn point(&self) -> DVec3 {
        self.d[0]
    }

    /// `∂ⁱᵤ∂ʲᵥ r`.
    pub fn partial(&self, i: usize, j: usize) -> DVec3 {
        self.d[jet_index(i, j)]
    }

    /// The unit normal `r_u × r_v / |r_u × r_v|`; `None` where the tangents do not span a plane (within rounding).
    /// Needs order 1.
    pub fn normal(&self) -> Option<DVec3> {
        let (a, b) = (self.d[1], self.d[2]);
        let n = a.cross(b);
        let l = n.length();
        (l > 1e-14 * a.length() * b.length() && l > f64::MIN_POSITIVE).then(|| n / l)
    }
}
