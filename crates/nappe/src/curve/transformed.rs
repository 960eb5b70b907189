//! The image of a curve under an affine map.

use super::error::finite_vector;
use super::{Curve, CurveError, CurveRef};
use crate::box3::Box3;
use crate::breaks::{Break, Limit};
use crate::exact::NurbsCurve;
use crate::interval::Interval;
use glam::{DAffine3, DVec3};

/// The curve `map(r(t))`: moved, turned, scaled, mirrored, sheared. The parametrisation stays.
#[derive(Clone, Debug)]
pub struct Transformed {
    curve: CurveRef,
    map: DAffine3,
}

impl Transformed {
    /// The image of a curve. A map onto a plane, a line or a point is allowed: it gives a flat or collapsed curve.
    /// Error: a number of the map is not finite.
    pub fn new(curve: CurveRef, map: DAffine3) -> Result<Self, CurveError> {
        for (what, column) in [
            ("the first column of the map", map.matrix3.x_axis),
            ("the second column of the map", map.matrix3.y_axis),
            ("the third column of the map", map.matrix3.z_axis),
            ("the translation of the map", map.translation),
        ] {
            finite_vector(what, column)?;
        }
        Ok(Self { curve, map })
    }
}

impl Curve for Transformed {
    fn breaks(&self) -> &[Break] {
        self.curve.breaks()
    }

    fn jet_into(&self, t: f64, limit: Limit, out: &mut [DVec3]) {
        self.curve.jet_into(t, limit, out);
        out[0] = self.map.transform_point3(out[0]);
        for d in &mut out[1..] {
            *d = self.map.transform_vector3(*d);
        }
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, out: &mut [Box3]) {
        self.curve.enclose_piece(t, limit, out);
        for b in out.iter_mut() {
            *b = b.linear_image(&self.map.matrix3);
        }
        out[0] = out[0] + Box3::point(self.map.translation);
    }

    fn to_nurbs(&self) -> Option<NurbsCurve> {
        Some(self.curve.to_nurbs()?.transformed(&self.map))
    }

    fn to_rational(&self) -> Option<NurbsCurve> {
        Some(self.curve.to_rational()?.transformed(&self.map))
    }
}
