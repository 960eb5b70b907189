//! A side of a surface and the derivatives across it, as functions.

use super::Functions;
use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit};
use crate::curve::{Curve, Isocurve, Trimmed};
use crate::exact::PiecewiseRational;
use crate::interval::Interval;
use crate::surface::{Dir, Side, SurfaceRef, jet_index, jet_len};
use glam::DVec3;
use smallvec::SmallVec;
use std::sync::Arc;

/// The coordinates of a side of a surface, measured from an origin, and of its derivatives across the side up to an order:
/// `3 (order + 1)` functions on `[0, 1]`. The derivatives are with respect to the surface's own growing parameter. The surface
/// is evaluated once for all of them, so that a blend of blends costs no power of their number.
#[derive(Clone, Debug)]
pub(crate) struct SideJet {
    surface: SurfaceRef,
    side: Side,
    reversed: bool,
    order: usize,
    origin: DVec3,
    /// The side on the unit range: the derivatives across have its breaks.
    line: Trimmed,
}

impl SideJet {
    /// The functions along a side, forwards or backwards.
    pub(crate) fn new(
        (surface, side): (SurfaceRef, Side),
        reversed: bool,
        order: usize,
        origin: DVec3,
    ) -> Self {
        let line =
            Trimmed::on_unit_range(Arc::new(Isocurve::side(surface.clone(), side)), reversed);
        Self {
            line,
            surface,
            side,
            reversed,
            order,
            origin,
        }
    }

    /// The point that positions are measured from.
    pub(crate) fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The parameter that is held, and the limit from the inside of the surface.
    fn held(&self) -> (f64, Limit) {
        let held = self.surface.breaks(self.side.across()).domain();
        if self.side.is_upper() {
            (held.hi, Limit::Below)
        } else {
            (held.lo, Limit::Above)
        }
    }

    /// `(u, v)` from what belongs to the direction along and to the one across.
    fn place<T>(&self, along: T, across: T) -> [T; 2] {
        match self.side.along() {
            Dir::U => [along, across],
            Dir::V => [across, along],
        }
    }

    /// The place in a jet of the surface of the i-th derivative along and the k-th across.
    fn index(&self, i: usize, k: usize) -> usize {
        let [i, j] = self.place(i, k);
        jet_index(i, j)
    }

    /// The derivative of the k-th order across the side, with the derivatives along it up to `order`.
    pub(crate) fn derivatives(&self, t: f64, limit: Limit, order: usize) -> Vec<Vec<DVec3>> {
        let mut out = vec![0.0; self.count() * (order + 1)];
        self.jet_into(t, limit, order, &mut out);
        let vector = |k: usize, i: usize| DVec3::from_slice(&out[i * self.count() + 3 * k..]);
        (0..=self.order)
            .map(|k| (0..=order).map(|i| vector(k, i)).collect())
            .collect()
    }
}

impl Functions for SideJet {
    fn count(&self) -> usize {
        3 * (self.order + 1)
    }

    fn breaks(&self) -> &[Break] {
        self.line.breaks()
    }

    fn jet_into(&self, t: f64, limit: Limit, order: usize, out: &mut [f64]) {
        let (t, limit) = self.line.locate(t, limit);
        let (at, inside) = self.held();
        let total = order + self.order;
        let mut d: SmallVec<[DVec3; 15]> = SmallVec::from_elem(DVec3::ZERO, jet_len(total));
        let limits = self.place(limit, inside);
        self.surface
            .jet_into(self.place(t, at), limits, total, &mut d);
        d[0] -= self.origin;
        let mut factor = 1.0;
        for (i, row) in out.chunks_exact_mut(self.count()).enumerate() {
            for (k, o) in row.chunks_exact_mut(3).enumerate() {
                (d[self.index(i, k)] * factor).write_to_slice(o);
            }
            factor *= self.line.ratio();
        }
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, order: usize, out: &mut [Interval]) {
        let (t, limit) = self.line.locate_piece(t, limit);
        let (at, inside) = self.held();
        let total = order + self.order;
        let mut d: SmallVec<[Box3; 15]> = SmallVec::from_elem(Box3::ENTIRE, jet_len(total));
        let uv = self.place(t, Interval::point(at));
        self.surface
            .enclose_piece(uv, self.place(limit, inside), total, &mut d);
        d[0] = d[0] - Box3::point(self.origin);
        let mut factor = Interval::ONE;
        for (i, row) in out.chunks_exact_mut(self.count()).enumerate() {
            for (k, o) in row.chunks_exact_mut(3).enumerate() {
                o.copy_from_slice(&d[self.index(i, k)].scale(factor).to_array());
            }
            factor = factor * self.line.enclosed_ratio();
        }
    }

    /// With one denominator for all: one by one, the functions would have different powers of it, and their product in
    /// common.
    fn to_piecewise(&self) -> Option<PiecewiseRational> {
        let along = self.side.along();
        let mut nurbs = self.surface.to_nurbs()?;
        if self.reversed {
            nurbs = nurbs.reversed(along).ok()?;
        }
        let held = nurbs.basis(self.side.across()).breaks().domain();
        let (unit, own) = ([0.0, 1.0], [held.lo, held.hi]);
        let [u, v] = match along {
            Dir::U => [unit, own],
            Dir::V => [own, unit],
        };
        let (at, limit) = self.held();
        let nurbs = nurbs.on_domain(u, v).ok()?;
        nurbs
            .cross_derivatives(along, at, limit, self.order, self.origin)
            .ok()
    }
}
