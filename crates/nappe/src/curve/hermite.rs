//! The cubic curve of two ends and two tangents.

use super::error::finite_vector;
use super::{Curve, CurveError, boxes, values};
use crate::box3::Box3;
use crate::breaks::{Break, Limit, UNIT_BREAKS};
use crate::exact::NurbsCurve;
use crate::interval::Interval;
use crate::scalar::{Scalar, Vec3};
use glam::DVec3;

/// The cubic `r(t) = F1 p0 + F2 p1 + F3 p0' + F4 p1'` on `[0, 1]` with `F1 = 2t³ - 3t² + 1`, `F2 = -2t³ + 3t²`,
/// `F3 = t³ - 2t² + t`, `F4 = t³ - t²`. The ends are exactly the given points.
///
/// Source: "Description and construction of surfaces in space", the cubic from ends and end tangents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hermite {
    from: DVec3,
    to: DVec3,
    from_tangent: DVec3,
    to_tangent: DVec3,
}

impl Hermite {
    /// The cubic with `r(0) = from`, `r(1) = to`, `r'(0) = from_tangent`, `r'(1) = to_tangent`.
    /// Error: a coordinate is not finite.
    pub fn new(
        from: DVec3,
        to: DVec3,
        from_tangent: DVec3,
        to_tangent: DVec3,
    ) -> Result<Self, CurveError> {
        Ok(Self {
            from: finite_vector("the start", from)?,
            to: finite_vector("the end", to)?,
            from_tangent: finite_vector("the tangent at the start", from_tangent)?,
            to_tangent: finite_vector("the tangent at the end", to_tangent)?,
        })
    }

    fn eval<S: Scalar>(&self, t: S, out: &mut [Vec3<S>]) {
        let n = |x: f64| S::from(x);
        let r = S::ONE - t;
        let first_half = t.mid() <= 0.5;
        // Of the end points only their difference counts, measured from the nearer one: both ends are exact.
        let rows: [[S; 3]; 4] = [
            [
                if first_half {
                    t.sqr() * (n(3.0) - n(2.0) * t)
                } else {
                    -(r.sqr() * (S::ONE + n(2.0) * t))
                },
                t * r.sqr(),
                -(t.sqr() * r),
            ],
            [
                n(6.0) * t * r,
                r * (S::ONE - n(3.0) * t),
                t * (n(3.0) * t - n(2.0)),
            ],
            [
                n(6.0) - n(12.0) * t,
                n(6.0) * t - n(4.0),
                n(6.0) * t - n(2.0),
            ],
            [n(-12.0), n(6.0), n(6.0)],
        ];
        for c in 0..3 {
            let (a, b) = (n(self.from[c]), n(self.to[c]));
            let (d, ta, tb) = (b - a, n(self.from_tangent[c]), n(self.to_tangent[c]));
            for (o, f) in out.iter_mut().zip(&rows) {
                o[c] = d * f[0] + ta * f[1] + tb * f[2];
            }
            out[0][c] = if first_half { a } else { b } + out[0][c];
        }
    }
}

impl Curve for Hermite {
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
        let points = [
            self.from,
            self.from + self.from_tangent / 3.0,
            self.to - self.to_tangent / 3.0,
            self.to,
        ];
        NurbsCurve::bezier(&points, None).ok()
    }
}
