//! Parts of curves, backwards and forwards, on `[0, 1]`.

use super::stretch::Stretch;
use super::{Curve, CurveError, CurveRef};
use crate::box3::Box3;
use crate::breaks::{Break, Limit};
use crate::exact::NurbsCurve;
use crate::interval::Interval;
use glam::DVec3;
use std::sync::Arc;

/// A part of a curve, with the parameter mapped linearly to `[0, 1]`: `t ↦ r(from + (to - from) t)`. With
/// `from > to` it runs backwards.
#[derive(Clone, Debug)]
pub struct Trimmed {
    stretch: Stretch,
}

impl Trimmed {
    /// The part between two parameters. Error: a parameter is outside the curve's domain, or both are equal.
    pub fn new(curve: CurveRef, from: f64, to: f64) -> Result<Self, CurveError> {
        let domain = curve.domain();
        if !(domain.contains(from) && domain.contains(to)) || from == to {
            return Err(CurveError::Range { from, to, domain });
        }
        Ok(Self {
            stretch: Stretch::new(curve, [from, to], Interval::UNIT),
        })
    }

    /// The whole curve backwards, on `[0, 1]`.
    pub fn reversed(curve: CurveRef) -> Self {
        let Interval { lo, hi } = curve.domain();
        Self {
            stretch: Stretch::new(curve, [hi, lo], Interval::UNIT),
        }
    }

    /// The whole curve, forwards or backwards, on `[0, 1]`.
    pub(crate) fn on_unit_range(curve: CurveRef, reversed: bool) -> Self {
        if reversed {
            return Self::reversed(curve);
        }
        let Interval { lo, hi } = curve.domain();
        Self {
            stretch: Stretch::new(curve, [lo, hi], Interval::UNIT),
        }
    }

    /// The curve's parameter, and the limit that selects the right piece of it.
    pub(crate) fn locate(&self, t: f64, limit: Limit) -> (f64, Limit) {
        self.stretch.locate(t, limit)
    }

    /// The same for all parameters of a range in one piece.
    pub(crate) fn locate_piece(&self, t: Interval, limit: Limit) -> (Interval, Limit) {
        self.stretch.locate_piece(t, limit)
    }

    /// The derivative of the curve's parameter.
    pub(crate) fn ratio(&self) -> f64 {
        self.stretch.ratio()
    }

    /// An enclosure of the same.
    pub(crate) fn enclosed_ratio(&self) -> Interval {
        self.stretch.enclosed_ratio()
    }
}

impl Curve for Trimmed {
    fn breaks(&self) -> &[Break] {
        self.stretch.breaks()
    }

    fn jet_into(&self, t: f64, limit: Limit, out: &mut [DVec3]) {
        self.stretch.jet_into(t, limit, out);
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, out: &mut [Box3]) {
        self.stretch.enclose_piece(t, limit, out);
    }

    fn to_nurbs(&self) -> Option<NurbsCurve> {
        self.stretch.to_nurbs()
    }

    fn to_rational(&self) -> Option<NurbsCurve> {
        self.stretch.to_rational()
    }
}

/// The curve with its parameter mapped linearly to `[0, 1]`; itself if it is there already. Everything that takes
/// curves for the sides of a surface brings them there.
pub fn on_unit_domain(curve: CurveRef) -> CurveRef {
    let Interval { lo, hi } = curve.domain();
    if (lo, hi) == (0.0, 1.0) {
        return curve;
    }
    Arc::new(Trimmed::on_unit_range(curve, false))
}
