//! A side of a surface and the derivatives across it, as functions.

use super::{Coordinates, Functions, FunctionsRef, Stack};
use crate::breaks::{Break, Breaks, Limit};
use crate::curve::{CrossDerivative, CurveRef, Isocurve, Trimmed, on_unit_domain};
use crate::exact::PiecewiseRational;
use crate::interval::Interval;
use crate::scalar::Pack;
use crate::surface::{Dir, Side, SurfaceRef};
use glam::DVec3;
use std::sync::Arc;

/// The coordinates of a side of a surface, measured from an origin, and of its derivatives across the side up to an order:
/// `3 (order + 1)` functions on `[0, 1]`. The derivatives are with respect to the surface's own growing parameter.
#[derive(Clone, Debug)]
pub(crate) struct SideJet {
    surface: SurfaceRef,
    side: Side,
    reversed: bool,
    order: usize,
    origin: DVec3,
    functions: Stack,
}

impl SideJet {
    /// The functions along a side, forwards or backwards.
    pub(crate) fn new(
        (surface, side): (SurfaceRef, Side),
        reversed: bool,
        order: usize,
        origin: DVec3,
    ) -> Self {
        let part = |k: usize| -> FunctionsRef {
            let curve: CurveRef = if k == 0 {
                Arc::new(Isocurve::side(surface.clone(), side))
            } else {
                Arc::new(CrossDerivative::side_of_order(surface.clone(), side, k))
            };
            let curve = if reversed {
                Arc::new(Trimmed::reversed(curve))
            } else {
                on_unit_domain(curve)
            };
            let from = if k == 0 { origin } else { DVec3::ZERO };
            Arc::new(Coordinates::new(curve, from))
        };
        let functions = Stack::new((0..=order).map(part).collect());
        Self {
            functions,
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
        self.functions.count()
    }

    fn breaks(&self) -> &[Break] {
        self.functions.breaks()
    }

    fn jet_into(&self, t: f64, limit: Limit, order: usize, out: &mut [f64]) {
        self.functions.jet_into(t, limit, order, out);
    }

    fn pack_into(&self, t: Pack, limit: Limit, order: usize, out: &mut [Pack]) {
        self.functions.pack_into(t, limit, order, out);
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, order: usize, out: &mut [Interval]) {
        self.functions.enclose_piece(t, limit, order, out);
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
        let (at, limit) = if self.side.is_upper() {
            (held.hi, Limit::Below)
        } else {
            (held.lo, Limit::Above)
        };
        let nurbs = nurbs.on_domain(u, v).ok()?;
        nurbs
            .cross_derivatives(along, at, limit, self.order, Some(self.origin))
            .ok()
    }
}
