//! Parametric curves: one trait, one file per kind.

use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit};
use crate::exact::NurbsCurve;
use crate::interval::Interval;
use crate::scalar::{Number, Pack};
use crate::series::binomial;
use glam::DVec3;
use pulp::bytemuck::cast_slice_mut;
use smallvec::SmallVec;
use std::fmt::Debug;
use std::sync::Arc;

mod ellipse;
mod error;
mod expression;
mod hermite;
pub(crate) mod interpolate;
mod isocurve;
mod joined;
mod line;
mod polyline;
mod stretch;
mod transformed;
mod trimmed;

pub use ellipse::{Ellipse, EllipseOptions, conic};
pub use error::CurveError;
pub use expression::{ExpressionCurve, ExpressionCurveError};
pub use hermite::Hermite;
pub use interpolate::{InterpolateOptions, interpolate, interpolate_like};
pub use isocurve::{CrossDerivative, Isocurve};
pub use joined::{JoinOptions, Joined, Share};
pub use line::Line;
pub use polyline::{Spacing, polyline};
pub use transformed::Transformed;
pub use trimmed::{Trimmed, on_unit_domain};

/// The highest order of derivative that callers may rely on, of curves and surfaces. Higher orders work, but their
/// accuracy is not tested.
pub const MAX_ORDER: usize = 8;

/// A shared curve. Geometry is immutable, so sharing is free.
pub type CurveRef = Arc<dyn Curve>;

/// A parametric curve in space (or, as a derivative along an edge, a vector as a function of a parameter).
///
/// Implementors write three methods; the rest is provided. Units: parameters have none, points are lengths.
pub trait Curve: Debug + Send + Sync {
    /// The parameters where analytic pieces meet, with the ends of the domain first and last (strictly increasing).
    fn breaks(&self) -> &[Break];

    /// Writes the point and its derivatives: `out[k]` is the k-th derivative at `t`; the order is `out.len() - 1`.
    /// At a break the piece on the side of `limit` decides. Outside the domain the end pieces are continued.
    fn jet_into(&self, t: f64, limit: Limit, out: &mut [DVec3]);

    /// Writes the coordinates of the same at the parameters of a pack, with the bits of [`Curve::jet_into`]. By default
    /// that is called for each; a formula over [`Number`] is evaluated several times faster with a pack.
    fn pack_into(&self, t: Pack, limit: Limit, out: &mut [[Pack; 3]]) {
        t.each_lane(out.as_flattened_mut(), |t, out| {
            self.jet_into(t, limit, cast_slice_mut(out));
        });
    }

    /// Writes boxes that enclose the point and its derivatives for every parameter in `t`, which must lie in one
    /// piece (if `t` is one point on a break, `limit` selects the piece). The boxes must shrink at first order or
    /// better with `t`; [`Box3::ENTIRE`] says that nothing can be proven.
    fn enclose_piece(&self, t: Interval, limit: Limit, out: &mut [Box3]);

    /// The same curve as a NURBS curve with the same parametrisation, where that exists exactly (within rounding).
    fn to_nurbs(&self) -> Option<NurbsCurve> {
        None
    }

    /// A NURBS curve that is exactly the same set of points, run through in the same direction, perhaps with another
    /// parametrisation: a circle by its angle has no NURBS form, but a rational curve draws the same circle.
    fn to_rational(&self) -> Option<NurbsCurve> {
        self.to_nurbs()
    }

    /// The parameter range.
    fn domain(&self) -> Interval {
        self.breaks().domain()
    }

    /// The point and derivatives up to `order`.
    fn jet(&self, t: f64, limit: Limit, order: usize) -> CurveJet {
        let mut d = SmallVec::from_elem(DVec3::ZERO, order + 1);
        self.jet_into(t, limit, &mut d);
        CurveJet { d }
    }

    /// The point at `t`.
    fn point(&self, t: f64) -> DVec3 {
        let mut d = [DVec3::ZERO];
        self.jet_into(t, Limit::Above, &mut d);
        d[0]
    }

    /// The points at a list of parameters. Panics if the lengths differ.
    fn points(&self, t: &[f64], out: &mut [DVec3]) {
        assert_eq!(t.len(), out.len(), "one point for each parameter");
        for (o, &t) in out.iter_mut().zip(t) {
            *o = self.point(t);
        }
    }

    /// The first and the last point.
    fn ends(&self) -> [DVec3; 2] {
        let d = self.domain();
        [self.point(d.lo), self.point(d.hi)]
    }

    /// Boxes that enclose the point and its derivatives up to `order` for every parameter in `t`, from both sides at
    /// breaks inside; at the ends of `t` from the inside, or from both sides if `t` is one parameter.
    /// Converges at second order: a centred Taylor form is intersected with the direct enclosure.
    fn enclose(&self, t: Interval, order: usize) -> Vec<Box3> {
        let mut hull: Option<Vec<Box3>> = None;
        for (part, limit) in self.breaks().parts(t) {
            let boxes = enclose_centred(self, part, limit, order);
            hull = Some(match hull {
                None => boxes,
                Some(h) => h.into_iter().zip(boxes).map(|(a, b)| a.hull(b)).collect(),
            });
        }
        hull.unwrap_or_default()
    }

    /// A box that contains the curve over `t`.
    fn bounds(&self, t: Interval) -> Box3 {
        self.enclose(t, 0)[0]
    }
}

/// Orders beyond the one asked for that the centred form uses.
const CENTRED: usize = 2;

fn enclose_centred<C: Curve + ?Sized>(
    curve: &C,
    t: Interval,
    limit: Limit,
    order: usize,
) -> Vec<Box3> {
    let mut raw = vec![Box3::ENTIRE; order + 1 + CENTRED];
    curve.enclose_piece(t, limit, &mut raw);
    if t.is_point() {
        raw.truncate(order + 1);
        return raw;
    }
    let m = t.mid();
    let mut at = vec![Box3::ENTIRE; order + CENTRED];
    // The middle of a part with positive width is never a break, unless the part is a few doubles wide.
    curve.enclose_piece(Interval::point(m), limit, &mut at);
    let h = t - Interval::point(m);
    let h2 = h.sqr() * Interval::point(0.5);
    (0..=order)
        .map(|k| {
            let centred = at[k] + at[k + 1].scale(h) + raw[k + 2].scale(h2);
            if centred.is_finite() {
                centred.meet(raw[k])
            } else {
                raw[k]
            }
        })
        .collect()
}

/// A point of a curve with its derivatives.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveJet {
    /// `d[k]` is the k-th derivative.
    pub d: SmallVec<[DVec3; 4]>,
}

impl CurveJet {
    /// The point.
    pub fn point(&self) -> DVec3 {
        self.d[0]
    }

    /// The curvature vector's length `|r' × r''| / |r'|³`; `None` where the tangent vanishes. Needs order 2.
    pub fn curvature(&self) -> Option<f64> {
        let (a, b) = (self.d[1], self.d[2]);
        let n = a.length();
        (n > 0.0).then(|| a.cross(b).length() / (n * n * n))
    }
}

/// Evaluates a formula written over [`Number`] with numbers; orders it does not write are 0.
pub(crate) fn values(out: &mut [DVec3], formula: impl FnOnce(&mut [[f64; 3]])) {
    let mut buffer: SmallVec<[[f64; 3]; 6]> = SmallVec::from_elem([0.0; 3], out.len());
    formula(&mut buffer);
    for (o, b) in out.iter_mut().zip(&buffer) {
        *o = DVec3::from_array(*b);
    }
}

/// Evaluates a formula written over [`Number`] with intervals; orders it does not write are 0.
pub(crate) fn boxes(out: &mut [Box3], formula: impl FnOnce(&mut [[Interval; 3]])) {
    let mut buffer: SmallVec<[[Interval; 3]; 6]> =
        SmallVec::from_elem([Interval::ZERO; 3], out.len());
    formula(&mut buffer);
    for (o, b) in out.iter_mut().zip(&buffer) {
        *o = Box3::from(*b);
    }
}

/// Writes the derivatives of `num / den` given those of a vector function and a number function:
/// `(n/d)⁽ᵏ⁾ = (n⁽ᵏ⁾ - Σ_{j<k} C(k, j) (n/d)⁽ʲ⁾ d⁽ᵏ⁻ʲ⁾) / d`.
pub(crate) fn quotient_rule<S: Number>(num: &[[S; 4]], out: &mut [[S; 3]]) {
    for k in 0..out.len() {
        for c in 0..3 {
            let s = (0..k).fold(num[k][c], |acc, j| {
                acc - S::from(binomial(k, j)) * out[j][c] * num[k - j][3]
            });
            out[k][c] = s / num[0][3];
        }
    }
}
