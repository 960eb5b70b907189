//! The straight line.

use super::error::finite_vector;
use super::{Curve, CurveError, boxes, values};
use crate::box3::Box3;
use crate::breaks::{Break, Limit, UNIT_BREAKS};
use crate::exact::NurbsCurve;
use crate::interval::Interval;
use crate::scalar::{Scalar, Vec3};
use glam::DVec3;

/// The line `r(t) = (1 - t) from + t to`, t in `[0, 1]`. Its ends are exactly the given points.
///
/// Both points may be equal: that is a collapsed side, such as the apex of a cone, which surfaces accept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    from: DVec3,
    to: DVec3,
}

impl Line {
    /// The line between two points. Error: a coordinate is not finite.
    pub fn new(from: DVec3, to: DVec3) -> Result<Self, CurveError> {
        Ok(Self {
            from: finite_vector("the start of the line", from)?,
            to: finite_vector("the end of the line", to)?,
        })
    }

    fn eval<S: Scalar>(&self, t: S, out: &mut [Vec3<S>]) {
        for c in 0..3 {
            let (a, b) = (S::from(self.from[c]), S::from(self.to[c]));
            let d = b - a;
            // Measured from the nearer end: both ends are exact.
            out[0][c] = if t.mid() <= 0.5 {
                a + d * t
            } else {
                b - d * (S::ONE - t)
            };
            if out.len() > 1 {
                out[1][c] = d;
            }
        }
    }
}

impl Curve for Line {
    fn breaks(&self) -> &[Break] {
        &UNIT_BREAKS
    }

    fn jet_into(&self, t: f64, _limit: Limit, out: &mut [DVec3]) {
        values(out, |o| self.eval(t, o));
    }

    fn enclose_piece(&self, t: Interval, _limit: Limit, out: &mut [Box3]) {
        boxes(out, |o| self.eval(t, o));
    }

    fn to_nurbs(&self) -> Option<NurbsCurve> {
        NurbsCurve::bezier(&[self.from, self.to], None).ok()
    }
}
