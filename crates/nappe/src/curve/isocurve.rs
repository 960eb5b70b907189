//! Curves on surfaces: isoparametric lines, sides, and the derivative across them.

use super::{Curve, CurveError};
use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit};
use crate::exact::NurbsCurve;
use crate::interval::Interval;
use crate::surface::{Dir, Side, Surface, SurfaceRef, jet_index, jet_len};
use glam::DVec3;
use smallvec::SmallVec;

/// A curve on a surface with one parameter held: the point, or the derivative across.
#[derive(Clone, Debug)]
struct OnSurface {
    surface: SurfaceRef,
    along: Dir,
    at: f64,
    limit: Limit,
    /// How often the surface is differentiated in the other direction.
    across: usize,
}

impl OnSurface {
    fn new(surface: SurfaceRef, along: Dir, at: f64, across: usize) -> Result<Self, CurveError> {
        let held = match along {
            Dir::U => Dir::V,
            Dir::V => Dir::U,
        };
        let domain = surface.breaks(held).domain();
        if !domain.contains(at) {
            return Err(CurveError::Outside { value: at, domain });
        }
        // At the upper end the last piece is meant, elsewhere the one that begins.
        let limit = if at == domain.hi {
            Limit::Below
        } else {
            Limit::Above
        };
        Ok(Self {
            surface,
            along,
            at,
            limit,
            across,
        })
    }

    fn on_side(surface: SurfaceRef, side: Side, across: usize) -> Self {
        let domain = surface.breaks(side.across()).domain();
        let (at, limit) = if side.is_upper() {
            (domain.hi, Limit::Below)
        } else {
            (domain.lo, Limit::Above)
        };
        Self {
            surface,
            along: side.along(),
            at,
            limit,
            across,
        }
    }

    /// `(u, v)` from the parameter along the curve and the one held.
    fn place<T>(&self, along: T, held: T) -> [T; 2] {
        match self.along {
            Dir::U => [along, held],
            Dir::V => [held, along],
        }
    }

    /// The place of the k-th derivative along the curve in a jet of the surface.
    fn index(&self, k: usize) -> usize {
        let [i, j] = self.place(k, self.across);
        jet_index(i, j)
    }

    fn jet_into(&self, t: f64, limit: Limit, out: &mut [DVec3]) {
        let order = out.len() - 1 + self.across;
        let mut d: SmallVec<[DVec3; 10]> = SmallVec::from_elem(DVec3::ZERO, jet_len(order));
        let limits = self.place(limit, self.limit);
        self.surface
            .jet_into(self.place(t, self.at), limits, order, &mut d);
        for (k, o) in out.iter_mut().enumerate() {
            *o = d[self.index(k)];
        }
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, out: &mut [Box3]) {
        let order = out.len() - 1 + self.across;
        let mut d: SmallVec<[Box3; 10]> = SmallVec::from_elem(Box3::ENTIRE, jet_len(order));
        let uv = self.place(t, Interval::point(self.at));
        self.surface
            .enclose_piece(uv, self.place(limit, self.limit), order, &mut d);
        for (k, o) in out.iter_mut().enumerate() {
            *o = d[self.index(k)];
        }
    }
}

/// An isoparametric curve of a surface: one parameter is held, the other runs over its range.
#[derive(Clone, Debug)]
pub struct Isocurve(OnSurface);

impl Isocurve {
    /// The curve that runs along `along` with the other parameter held at `at`.
    /// Error: `at` is outside the surface's domain.
    pub fn new(surface: SurfaceRef, along: Dir, at: f64) -> Result<Self, CurveError> {
        Ok(Self(OnSurface::new(surface, along, at, 0)?))
    }

    /// A side of a surface; south and north run along u, west and east along v.
    pub fn side(surface: SurfaceRef, side: Side) -> Self {
        Self(OnSurface::on_side(surface, side, 0))
    }
}

impl Curve for Isocurve {
    fn breaks(&self) -> &[Break] {
        self.0.surface.breaks(self.0.along)
    }

    fn jet_into(&self, t: f64, limit: Limit, out: &mut [DVec3]) {
        self.0.jet_into(t, limit, out);
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, out: &mut [Box3]) {
        self.0.enclose_piece(t, limit, out);
    }

    /// The surface's net contracted with one basis.
    fn to_nurbs(&self) -> Option<NurbsCurve> {
        let s = self.0.surface.to_nurbs()?;
        Some(s.isocurve(self.0.along, self.0.at, self.0.limit))
    }

    /// Of a side also that of a surface with other parameters: its sides are the same.
    fn to_rational(&self) -> Option<NurbsCurve> {
        let across = match self.0.along {
            Dir::U => Dir::V,
            Dir::V => Dir::U,
        };
        let own = self.0.surface.breaks(across).domain();
        if ![own.lo, own.hi].contains(&self.0.at) {
            return self.to_nurbs();
        }
        let s = self.0.surface.to_rational()?;
        let range = s.breaks(across).domain();
        let at = if self.0.at == own.lo {
            range.lo
        } else {
            range.hi
        };
        Some(s.isocurve(self.0.along, at, self.0.limit))
    }
}

/// The derivative across an isoparametric curve as a vector-valued curve: `∂r/∂v` along u, `∂r/∂u` along v, or one of
/// higher order. On all four sides the derivative is with respect to the growing parameter: on south and west the first
/// one points inwards, on north and east outwards.
#[derive(Clone, Debug)]
pub struct CrossDerivative(OnSurface);

impl CrossDerivative {
    /// The derivative across the curve that runs along `along` with the other parameter held at `at`.
    /// Error: `at` is outside the surface's domain.
    pub fn new(surface: SurfaceRef, along: Dir, at: f64) -> Result<Self, CurveError> {
        Ok(Self(OnSurface::new(surface, along, at, 1)?))
    }

    /// The derivative across a side.
    pub fn side(surface: SurfaceRef, side: Side) -> Self {
        Self::side_of_order(surface, side, 1)
    }

    /// The derivative of the given order across a side: `∂ᵏr/∂vᵏ` or `∂ᵏr/∂uᵏ`.
    pub fn side_of_order(surface: SurfaceRef, side: Side, order: usize) -> Self {
        Self(OnSurface::on_side(surface, side, order))
    }
}

impl Curve for CrossDerivative {
    fn breaks(&self) -> &[Break] {
        self.0.surface.breaks(self.0.along)
    }

    fn jet_into(&self, t: f64, limit: Limit, out: &mut [DVec3]) {
        self.0.jet_into(t, limit, out);
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, out: &mut [Box3]) {
        self.0.enclose_piece(t, limit, out);
    }

    /// Of `order + 1` times the degree if the surface is rational.
    fn to_nurbs(&self) -> Option<NurbsCurve> {
        let s = self.0.surface.to_nurbs()?;
        s.cross_derivative(self.0.along, self.0.at, self.0.limit, self.0.across)
            .ok()
    }
}
