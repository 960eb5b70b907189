//! Circles, ellipses and their arcs, with the angle as parameter.

use super::error::{finite, finite_vector, positive};
use super::{Curve, CurveError, boxes, values};
use crate::box3::Box3;
use crate::breaks::{Break, Limit, UNIT_BREAKS};
use crate::exact::{ConicArcs, NurbsCurve};
use crate::frame::{Frame, cos_sin};
use crate::interval::Interval;
use crate::scalar::{Scalar, Vec3};
use glam::DVec3;
use std::f64::consts::TAU;

/// Below this sine of the angle at the middle one, three points count as collinear: the radius is more than 10⁶
/// times their distance, and rounding errors are relative to the radius.
const COLLINEAR: f64 = 1e-6;

/// The relative distance within which [`cos_sin`] takes an angle for a multiple of an eighth of a turn.
const SNAP: f64 = 4.0 * f64::EPSILON;

/// A turn may exceed 2π by this factor: angles that come from degrees or sums are rounded.
const FULL_TURN: f64 = TAU * (1.0 + 1e-14);

/// An arc of an ellipse (a circle, an arc, a full ellipse): `r(t) = center + a cos φ + b sin φ` with
/// `φ = from + (to - from) t`, t in `[0, 1]`; `a` and `b` are the semi-axis vectors. Angles are in radians,
/// counter-clockwise seen from the tip of `a × b`.
///
/// The parameter is proportional to the angle of the circle (the eccentric anomaly of an ellipse). No rational curve
/// has this parametrisation, so `to_nurbs` gives `None`; [`Curve::to_rational`] gives the same set of points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipse {
    center: DVec3,
    a: DVec3,
    b: DVec3,
    from: f64,
    to: f64,
}

/// Where an ellipse lies and how far it goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EllipseOptions {
    /// The first angle in radians; 0 by default.
    pub from: f64,
    /// The last angle in radians; 2π by default. Smaller than `from`: clockwise.
    pub to: f64,
    /// The normal of the plane; z by default.
    pub normal: DVec3,
    /// The direction of angle 0, projected to the plane. By default that of [`Frame::along`]: for the normals
    /// x, y and z it is y, x and x.
    pub x_direction: Option<DVec3>,
}

impl Default for EllipseOptions {
    fn default() -> Self {
        Self {
            from: 0.0,
            to: TAU,
            normal: DVec3::Z,
            x_direction: None,
        }
    }
}

impl Ellipse {
    /// An ellipse, or an arc of one, from the lengths of its semi-axes. Equal semi-axes: a circle.
    ///
    /// Errors: a number is not finite, a semi-axis is not positive, a direction has no length, the x direction is
    /// parallel to the normal, the turn is 0 or above a full turn.
    pub fn new(
        center: DVec3,
        semi_axes: [f64; 2],
        options: EllipseOptions,
    ) -> Result<Self, CurveError> {
        let [ra, rb] = semi_axes;
        let (ra, rb) = (
            positive("the first semi-axis", ra)?,
            positive("the second semi-axis", rb)?,
        );
        let EllipseOptions { from, to, .. } = options;
        finite("the first angle", from)?;
        finite("the last angle", to)?;
        let center = finite_vector("the center", center)?;
        let frame = match options.x_direction {
            Some(x) => Frame::new(center, options.normal, x)?,
            None => Frame::along(center, options.normal)?,
        };
        Self::from_axes(center, frame.x() * ra, frame.y() * rb, from, to)
    }

    /// An arc of a circle; the turn is counter-clockwise seen from the tip of the normal if `to > from`.
    pub fn arc(
        center: DVec3,
        radius: f64,
        from: f64,
        to: f64,
        normal: DVec3,
    ) -> Result<Self, CurveError> {
        let radius = positive("the radius", radius)?;
        let options = EllipseOptions {
            from,
            to,
            normal,
            ..Default::default()
        };
        Self::new(center, [radius; 2], options)
    }

    /// A full circle.
    pub fn circle(center: DVec3, radius: f64, normal: DVec3) -> Result<Self, CurveError> {
        Self::arc(center, radius, 0.0, TAU, normal)
    }

    /// The arc of a circle from the first point through the second to the third. Angle 0 is at the first point.
    ///
    /// Errors: a coordinate is not finite, two points coincide, or the points lie on one line (the sine of the angle
    /// at the second is below 10⁻⁶; rounding errors are relative to the radius).
    pub fn through(points: [DVec3; 3]) -> Result<Self, CurveError> {
        for (what, p) in ["the first point", "the second point", "the third point"]
            .into_iter()
            .zip(points)
        {
            finite_vector(what, p)?;
        }
        let [p, q, r] = points;
        for (first, second) in [(0, 1), (1, 2), (0, 2)] {
            if points[first] == points[second] {
                return Err(CurveError::Coincident {
                    first,
                    second,
                    point: points[first],
                });
            }
        }
        // Unit-free: the sides seen from the second point.
        let size = p.distance(q).max(r.distance(q));
        let (d, e) = ((p - q) / size, (r - q) / size);
        let n = e.cross(d);
        let sine = n.length() / (d.length() * e.length());
        if sine.is_nan() || sine <= COLLINEAR {
            return Err(CurveError::Collinear { points, sine });
        }
        let to_center = (e * d.length_squared() - d * e.length_squared()).cross(-n)
            / (2.0 * n.length_squared());
        let center = q + to_center * size;
        let a = (d - to_center) * size;
        let normal = n.normalize();
        let b = normal.cross(a);
        let last = (e - to_center) * size;
        let turn = last.dot(b).atan2(last.dot(a));
        let turn = if turn > 0.0 { turn } else { turn + TAU };
        Self::from_axes(center, a, b, 0.0, turn)
    }

    fn from_axes(
        center: DVec3,
        a: DVec3,
        b: DVec3,
        from: f64,
        to: f64,
    ) -> Result<Self, CurveError> {
        let turn = to - from;
        if turn == 0.0 || turn.abs() > FULL_TURN {
            return Err(CurveError::Turn { from, to, turn });
        }
        Ok(Self {
            center,
            a,
            b,
            from,
            to,
        })
    }

    /// The center.
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// The semi-axis vectors: towards angle 0 and towards angle π/2.
    pub fn axes(&self) -> [DVec3; 2] {
        [self.a, self.b]
    }

    /// The first and the last angle in radians.
    pub fn angles(&self) -> [f64; 2] {
        [self.from, self.to]
    }

    /// The angle at a parameter, measured from the nearer end: both ends are exact.
    fn angle<S: Scalar>(&self, t: S) -> S {
        let (from, to) = (S::from(self.from), S::from(self.to));
        if t.mid() <= 0.5 {
            from + (to - from) * t
        } else {
            to - (to - from) * (S::ONE - t)
        }
    }

    fn eval<S: Scalar>(&self, (c, s): (S, S), out: &mut [Vec3<S>]) {
        let turn = S::from(self.to) - S::from(self.from);
        // The k-th derivatives of cos and sin: a quarter turn each.
        let cycle = [(c, s), (-s, c), (-c, -s), (s, -c)];
        let mut power = S::ONE;
        for (k, o) in out.iter_mut().enumerate() {
            let (x, y) = cycle[k % 4];
            for i in 0..3 {
                o[i] = power * (S::from(self.a[i]) * x + S::from(self.b[i]) * y);
            }
            power = power * turn;
        }
        for i in 0..3 {
            out[0][i] = S::from(self.center[i]) + out[0][i];
        }
    }
}

impl Curve for Ellipse {
    fn breaks(&self) -> &[Break] {
        &UNIT_BREAKS
    }

    fn jet_into(&self, t: f64, _limit: Limit, out: &mut [DVec3]) {
        values(out, |o| self.eval(cos_sin(self.angle(t)), o));
    }

    fn enclose_piece(&self, t: Interval, _limit: Limit, out: &mut [Box3]) {
        let angle = self.angle(t);
        let angle = angle.inflate(SNAP * angle.mag());
        boxes(out, |o| self.eval((angle.cos(), angle.sin()), o));
    }

    /// Rational quadratic arcs of at most a quarter turn each: the middle point of each is where the end tangents
    /// meet, its weight is the cosine of half its turn. Source: Piegl and Tiller, *The NURBS Book*, §7.3.
    fn to_rational(&self) -> Option<NurbsCurve> {
        let arcs = ConicArcs::circle(self.from, self.to);
        let points = arcs
            .points
            .iter()
            .map(|p| (self.center * p.z + self.a * p.x + self.b * p.y).extend(p.z));
        Some(NurbsCurve::from_homogeneous(arcs.basis, points.collect()))
    }
}

/// The conic arc of three poles: `(B0 p0 + w B1 p1 + B2 p2) / (B0 + w B1 + B2)` with the quadratic Bernstein
/// polynomials; it touches the legs p0 p1 and p1 p2 at its ends. Weight below 1: ellipse, 1: parabola, above 1:
/// hyperbola. Errors: a coordinate is not finite, the weight is not positive and finite.
pub fn conic(points: [DVec3; 3], weight: f64) -> Result<NurbsCurve, CurveError> {
    Ok(NurbsCurve::bezier(&points, Some(&[1.0, weight, 1.0]))?)
}
