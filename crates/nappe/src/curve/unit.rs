//! The same curve over the parameters `[0, 1]`.

use super::{Curve, CurveRef};
use crate::basis::BSplineBasis;
use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit};
use crate::exact::NurbsCurve;
use crate::interval::Interval;
use glam::DVec3;
use std::sync::Arc;

/// The curve reparametrised linearly to `[0, 1]`: `s ↦ curve(lo + (hi - lo) s)`. A curve that already runs over
/// `[0, 1]` is returned as it is.
pub fn on_unit_domain(curve: CurveRef) -> CurveRef {
    if curve.domain() == Interval::UNIT {
        return curve;
    }
    Arc::new(OnUnitDomain::new(curve))
}

#[derive(Clone, Debug)]
struct OnUnitDomain {
    curve: CurveRef,
    /// The breaks of the curve, mapped to `[0, 1]`; piece by piece they belong together.
    breaks: Vec<Break>,
}

impl OnUnitDomain {
    fn new(curve: CurveRef) -> Self {
        let Interval { lo, hi } = curve.domain();
        let mut breaks: Vec<Break> = curve
            .breaks()
            .iter()
            .map(|b| Break::new((b.at - lo) / (hi - lo), b.smooth))
            .collect();
        if let Some(last) = breaks.last_mut() {
            last.at = 1.0;
        }
        Self { curve, breaks }
    }

    /// The curve's parameter and limit for `s`. The piece is chosen by `s`: rounding must not carry the parameter
    /// across a break.
    fn parameter(&self, s: f64, limit: Limit) -> (f64, Limit) {
        let Interval { lo, hi } = self.curve.domain();
        let i = self.breaks.find(s, limit);
        let piece = self.curve.breaks().piece(i);
        let t = lo + (hi - lo) * s;
        if t <= piece.lo && i > 0 {
            (piece.lo, Limit::Above)
        } else if t >= piece.hi && i + 1 < self.breaks.pieces() {
            (piece.hi, Limit::Below)
        } else {
            (t, limit)
        }
    }
}

impl Curve for OnUnitDomain {
    fn breaks(&self) -> &[Break] {
        &self.breaks
    }

    fn jet_into(&self, t: f64, limit: Limit, out: &mut [DVec3]) {
        let Interval { lo, hi } = self.curve.domain();
        let (t, limit) = self.parameter(t, limit);
        self.curve.jet_into(t, limit, out);
        let mut factor = 1.0;
        for d in &mut out[1..] {
            factor *= hi - lo;
            *d *= factor;
        }
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, out: &mut [Box3]) {
        let Interval { lo, hi } = self.curve.domain();
        let i = self.breaks.find(t.mid(), limit);
        let width = Interval::point(hi) - Interval::point(lo);
        // Rounding outwards may leave the piece by a little; the true parameters do not.
        let inner = (Interval::point(lo) + width * t).meet(self.curve.breaks().piece(i));
        let (_, limit) = self.parameter(t.mid(), limit);
        self.curve.enclose_piece(inner, limit, out);
        let mut factor = Interval::ONE;
        for d in &mut out[1..] {
            factor = factor * width;
            *d = d.scale(factor);
        }
    }

    fn to_nurbs(&self) -> Option<NurbsCurve> {
        let n = self.curve.to_nurbs()?;
        let Interval { lo, hi } = n.domain();
        let knots = n.knots().iter().map(|k| (k - lo) / (hi - lo)).collect();
        let basis = BSplineBasis::new(n.degree(), knots).ok()?;
        Some(NurbsCurve::from_homogeneous(
            basis,
            n.homogeneous().to_vec(),
        ))
    }
}
