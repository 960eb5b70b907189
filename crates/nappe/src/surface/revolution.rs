//! Surfaces of revolution.

use super::axis_contact::{self, Contact};
use super::sectors::Sectors;
use super::turned::{net, turned};
use super::{CoonsError, Dir, Elementary, Separable, Surface, SurfaceRef, Swept, elementary};
use crate::basis::{Framed, Functions, Turn};
use crate::breaks::{Break, merge_breaks};
use crate::curve::{Curve, CurveRef};
use crate::exact::{ConicArcs, NurbsCurve, NurbsSurface};
use crate::frame::Frame;
use crate::interval::Interval;
use glam::{DVec2, DVec3, DVec4, Vec3Swizzles, Vec4Swizzles};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;
use thiserror::Error;

/// Relative excess over a whole turn, or distance from a whole number of quarter turns, taken as rounding.
const ANGLE_ROUNDING: f64 = 1e-12;

/// Relative to the largest coordinate: a profile that strays no further from a half-plane of the axis lies in it.
const SAME_PLANE: f64 = 1e-13;

/// What can be wrong with a surface of revolution.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RevolutionError {
    /// The angle is not in (0, 2π].
    #[error(
        "the angle is {} degrees: it must be more than 0 and at most one turn (360 degrees)",
        angle.to_degrees()
    )]
    Angle {
        /// The angle given, in radians.
        angle: f64,
    },
    /// The start is not a finite number.
    #[error("the start angle is {start}: it must be a finite number")]
    Start {
        /// The start given, in radians.
        start: f64,
    },
    /// The parameter μ of a conic section is not positive and finite.
    #[error(
        "the conic parameter mu is {mu}: it must be a positive number (ellipse below 1, parabola 1, hyperbola above)"
    )]
    Mu {
        /// The parameter given.
        mu: f64,
    },
    /// A conic section is not made of whole quarters.
    #[error(
        "the angle is {} degrees: sections other than circles are made of whole quarters (90, 180, 270 or 360 degrees)",
        angle.to_degrees()
    )]
    Quarters {
        /// The angle given, in radians.
        angle: f64,
    },
    /// The profile passes through the axis.
    #[error(
        "the profile crosses the axis at t = {at}, in ({}, {}, {}), and reaches {reach} beyond it: split it there, or move it to one side",
        point.x, point.y, point.z
    )]
    Crosses {
        /// The parameter on the profile.
        at: f64,
        /// The point on the axis.
        point: DVec3,
        /// How far from the axis the shorter part gets.
        reach: f64,
    },
    /// A stretch of the profile lies on the axis.
    #[error(
        "the profile lies on the axis from t = {from} to t = {to}: that part has no surface; leave it out"
    )]
    OnAxis {
        /// The first parameter of the stretch.
        from: f64,
        /// The last parameter of the stretch.
        to: f64,
    },
    /// The profile is one point.
    #[error("the profile is the single point ({}, {}, {})", point.x, point.y, point.z)]
    Point {
        /// The point.
        point: DVec3,
    },
    /// A sector could not be built as a Coons surface.
    #[error(transparent)]
    Coons(#[from] CoonsError),
    /// The profile has coordinates that are not finite.
    #[error("the profile is ({}, {}, {}) at t = {at}: points must be finite", point.x, point.y, point.z)]
    NotFinite {
        /// The parameter.
        at: f64,
        /// The point there.
        point: DVec3,
    },
}

/// How the turn is made. All but [`Construction::Conic`] give the same point set.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Construction {
    /// v is proportional to the angle: `r(u, v)` is the profile turned by `start + angle · v`. No NURBS surface has this
    /// parametrisation; [`Surface::to_rational`] has the same points and is exact.
    #[default]
    Angle,
    /// Equal rational quadratic arcs of at most a quarter turn with weights `cos(half angle)`; v is their parameter.
    /// An exact NURBS surface if the profile is a NURBS curve.
    Rational,
    /// Equal sectors of at most a quarter turn, each the Coons surface of its boundary functions with trigonometric
    /// blending; v is proportional to the angle, u is the profile's parameter brought to `[0, 1]`. The same map as
    /// [`Construction::Angle`] up to rounding; poles collapse up to rounding. Source: Chashnikov 2007, theorem and §4.
    Coons,
    /// Grigoriev's sections: quarters from P0 to P2 (P0 turned by a right angle) with the middle point P1 = P0 + P2 seen
    /// from the axis and weight √μ; the angle must be a whole number of quarters, the further quarters being the
    /// reflections of the first. `(X+Y-1)² = 4μ(1-X)(1-Y)` on each quarter; μ = 1/2 is the circle.
    /// Source: Grigoriev 2007, §1 (1).
    Conic {
        /// The shape of the section: an ellipse's arc below 1, a parabola's at 1, a hyperbola's above.
        mu: f64,
    },
}

/// Options of a surface of revolution; the default is one whole turn by angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RevolutionOptions {
    /// Where the turn starts, radians: v = 0 is the profile turned so far.
    pub start: f64,
    /// The angle of the turn, radians, in (0, 2π].
    pub angle: f64,
    /// How the turn is made.
    pub construction: Construction,
}

impl Default for RevolutionOptions {
    fn default() -> Self {
        Self {
            start: 0.0,
            angle: TAU,
            construction: Construction::Angle,
        }
    }
}

/// A surface of revolution: u along the profile (over its own domain, or `[0, 1]` by Coons sectors), v along the turn on `[0, 1]`, counter-clockwise
/// seen from the tip of the axis.
///
/// The profile is any curve, in a plane through the axis or not; every point of it is turned as it is. With `e` the unit
/// axis and `φ` the direction of the turn, `r_v` points along `φ`: a profile that runs along the axis upwards has
/// normals (`r_u × r_v`) towards the axis, one that runs downwards has them away from it.
///
/// Where the profile ends on the axis there is a pole: within 1e-12 of the profile's size (and the rounding of its
/// coordinates) an end is moved onto the axis, so that the side collapses to one point. Touching the axis in between
/// pinches the surface in a point and is allowed: that line `u = const` is one point, and counts as a break; crossing the
/// axis, or lying on it, is an error. A contact is a crossing
/// if the directions from the axis before and after it are more than a right angle apart. Contacts are found by
/// excluding the rest of the profile with enclosures.
///
/// Sources: Grigoriev 2007 (rational sections); Chashnikov 2007, (6).
#[derive(Clone, Debug)]
pub struct Revolution {
    form: SurfaceRef,
    profile: CurveRef,
    axis: Frame,
    options: RevolutionOptions,
    poles: [bool; 2],
    pinches: Vec<f64>,
    breaks_u: Vec<Break>,
}

impl Revolution {
    /// Turns a profile about the z axis of a frame.
    pub fn new(
        profile: CurveRef,
        axis: Frame,
        options: RevolutionOptions,
    ) -> Result<Self, RevolutionError> {
        let options = checked(options)?;
        let domain = profile.domain();
        for at in [domain.lo, domain.mid(), domain.hi] {
            let point = profile.point(at);
            if !point.is_finite() {
                return Err(RevolutionError::NotFinite { at, point });
            }
        }
        let bounds = profile.bounds(domain);
        if bounds.diagonal() <= f64::EPSILON * profile.point(domain.lo).length() {
            return Err(RevolutionError::Point {
                point: profile.point(domain.lo),
            });
        }
        let (poles, pinches) = match axis_contact::find(profile.as_ref(), &axis) {
            Contact::Poles { ends, inner } => (ends, inner),
            Contact::Crosses { at, point, reach } => {
                return Err(RevolutionError::Crosses { at, point, reach });
            }
            Contact::Along { from, to } => return Err(RevolutionError::OnAxis { from, to }),
        };
        let form = form(&profile, &axis, &options, poles)?;
        let range = form.domain()[0];
        let pinches: Vec<f64> = pinches
            .into_iter()
            .map(|t| moved(t, domain, range))
            .collect();
        Ok(Self {
            breaks_u: with_pinches(form.as_ref(), &pinches),
            form,
            profile,
            axis,
            options,
            poles,
            pinches,
        })
    }

    /// The same points by rational arcs: a NURBS surface if the profile is a NURBS curve. Only v runs differently; at
    /// the ends, the joints and the middles of the arcs the parameters agree.
    pub fn with_arcs(&self) -> Self {
        let options = with_arcs(&self.options);
        let form = by_arcs(&self.profile, &self.axis, &options, self.poles);
        let [from, to] = [self.domain()[0], form.domain()[0]];
        let pinches: Vec<f64> = self.pinches.iter().map(|&u| moved(u, from, to)).collect();
        Self {
            breaks_u: with_pinches(form.as_ref(), &pinches),
            form,
            options,
            pinches,
            ..self.clone()
        }
    }

    /// The profile as given.
    pub fn profile(&self) -> &CurveRef {
        &self.profile
    }

    /// The frame whose z is the axis.
    pub fn axis(&self) -> &Frame {
        &self.axis
    }

    /// The options.
    pub fn options(&self) -> &RevolutionOptions {
        &self.options
    }

    /// Whether the west side (the profile's start) and the east side (its end) are poles.
    pub fn poles(&self) -> [bool; 2] {
        self.poles
    }

    /// The parameters u between the ends where the profile touches the axis.
    pub fn pinches(&self) -> &[f64] {
        &self.pinches
    }
}

/// A parameter of one domain at the same place in another.
fn moved(t: f64, from: Interval, to: Interval) -> f64 {
    if from == to {
        t
    } else {
        to.lo + (to.hi - to.lo) * ((t - from.lo) / (from.hi - from.lo))
    }
}

/// The breaks along u. At a pinch, where all of a line is one point, the surface is cut like at a corner, although its
/// derivatives are continuous.
fn with_pinches(form: &dyn Surface, pinches: &[f64]) -> Vec<Break> {
    let pinches: Vec<Break> = pinches.iter().map(|&u| Break::new(u, 0)).collect();
    merge_breaks([form.breaks(Dir::U), &pinches])
}

/// The options for the same points by rational arcs.
fn with_arcs(o: &RevolutionOptions) -> RevolutionOptions {
    let construction = match o.construction {
        Construction::Angle | Construction::Coons | Construction::Rational => {
            Construction::Rational
        }
        conic @ Construction::Conic { .. } => conic,
    };
    RevolutionOptions { construction, ..*o }
}

/// Checks the numbers and takes away their rounding.
fn checked(mut o: RevolutionOptions) -> Result<RevolutionOptions, RevolutionError> {
    let angle = o.angle;
    if !(angle > 0.0 && angle <= TAU * (1.0 + ANGLE_ROUNDING)) {
        return Err(RevolutionError::Angle { angle });
    }
    if (angle - TAU).abs() <= TAU * ANGLE_ROUNDING {
        o.angle = TAU;
    }
    if !o.start.is_finite() {
        return Err(RevolutionError::Start { start: o.start });
    }
    if let Construction::Conic { mu } = o.construction {
        if !(mu > 0.0 && mu.is_finite()) {
            return Err(RevolutionError::Mu { mu });
        }
        let quarters = (angle / FRAC_PI_2).round();
        if quarters < 1.0 || (angle - quarters * FRAC_PI_2).abs() > ANGLE_ROUNDING * TAU {
            return Err(RevolutionError::Quarters { angle });
        }
        o.angle = quarters * FRAC_PI_2;
    }
    Ok(o)
}

/// The surface itself.
fn form(
    profile: &CurveRef,
    axis: &Frame,
    o: &RevolutionOptions,
    poles: [bool; 2],
) -> Result<SurfaceRef, CoonsError> {
    Ok(match o.construction {
        Construction::Angle => {
            let nurbs = profile.to_nurbs().map(|n| {
                let points = in_frame(&n, axis, poles);
                (n, points)
            });
            let section = [DVec3::Z, DVec3::X, DVec3::Y];
            let v = Arc::new(Turn::new(o.start, o.angle));
            let profile = (profile, axis, poles);
            Arc::new(separable(nurbs, profile, v, &section, false))
        }
        Construction::Coons => Arc::new(Sectors::new(profile, axis, o.start, o.angle)?),
        Construction::Rational | Construction::Conic { .. } => by_arcs(profile, axis, o, poles),
    })
}

/// The surface by arcs: a NURBS surface if the profile is a NURBS curve, else a separable one.
fn by_arcs(
    profile: &CurveRef,
    axis: &Frame,
    o: &RevolutionOptions,
    poles: [bool; 2],
) -> SurfaceRef {
    let arcs = match o.construction {
        Construction::Conic { mu } => {
            let quarters = (o.angle / FRAC_PI_2).round() as usize;
            turned_by(ConicArcs::grigoriev(mu, quarters), o.start)
        }
        _ => ConicArcs::circle(o.start, o.start + o.angle),
    };
    let Some(n) = profile.to_nurbs() else {
        let profile = (profile, axis, poles);
        return Arc::new(separable(
            None,
            profile,
            Arc::new(arcs.basis),
            &arcs.points,
            true,
        ));
    };
    let points = in_frame(&n, axis, poles);
    let points = net(&points, &arcs.points, axis.directions())
        .into_iter()
        .map(|p| (p.xyz() + axis.origin() * p.w).extend(p.w))
        .collect();
    Arc::new(NurbsSurface::from_homogeneous(
        n.basis().clone(),
        arcs.basis,
        points,
    ))
}

/// A profile, given as NURBS coefficients or through its coordinate functions, with a section.
fn separable(
    nurbs: Option<(NurbsCurve, Vec<DVec4>)>,
    (profile, axis, poles): (&CurveRef, &Frame, [bool; 2]),
    v: crate::basis::FunctionsRef,
    section: &[DVec3],
    rational_section: bool,
) -> Separable {
    let (e, origin) = (axis.directions(), axis.origin());
    match nurbs {
        Some((n, mut points)) => {
            let rational = n.is_rational();
            if !rational {
                let w = points[0].w;
                points.iter_mut().for_each(|p| *p /= w);
            }
            let u = Arc::new(n.basis().clone());
            turned(
                (u, &points),
                (v, section),
                e,
                origin,
                rational || rational_section,
            )
        }
        None => {
            let u = Arc::new(Framed::new(profile.clone(), *axis, poles));
            let points = [DVec4::W, DVec4::X, DVec4::Y, DVec4::Z];
            turned((u, &points), (v, section), e, origin, rational_section)
        }
    }
}

/// The homogeneous points of a NURBS profile in the frame, the ends that are poles exactly on its axis.
fn in_frame(n: &NurbsCurve, axis: &Frame, poles: [bool; 2]) -> Vec<DVec4> {
    let mut points: Vec<DVec4> = n
        .homogeneous()
        .iter()
        .map(|p| axis.components(p.xyz() - axis.origin() * p.w).extend(p.w))
        .collect();
    if n.basis().is_clamped() {
        let last = points.len() - 1;
        for (pole, i) in poles.into_iter().zip([0, last]) {
            if pole {
                (points[i].x, points[i].y) = (0.0, 0.0);
            }
        }
    }
    points
}

/// Arcs turned about the origin.
fn turned_by(mut arcs: ConicArcs, angle: f64) -> ConicArcs {
    let (c, s) = crate::frame::cos_sin(angle);
    for p in &mut arcs.points {
        (p.x, p.y) = (p.x * c - p.y * s, p.x * s + p.y * c);
    }
    arcs
}

impl Surface for Revolution {
    fn breaks(&self, dir: Dir) -> &[Break] {
        match dir {
            Dir::U => &self.breaks_u,
            Dir::V => self.form.breaks(dir),
        }
    }

    evaluate_through!(self => self.form, but for breaks);

    fn to_nurbs(&self) -> Option<NurbsSurface> {
        self.form.to_nurbs()
    }

    fn to_rational(&self) -> Option<NurbsSurface> {
        let profile: CurveRef = Arc::new(self.profile.to_rational()?);
        let options = with_arcs(&self.options);
        by_arcs(&profile, &self.axis, &options, self.poles).to_nurbs()
    }

    /// A plane, cylinder or cone if the profile is straight and in a plane with the axis; a sphere or torus if it is an arc
    /// there.
    fn elementary(&self) -> Option<Elementary> {
        if let Some(plane) = elementary::plane_of(&self.to_rational()?) {
            return Some(plane);
        }
        if matches!(self.options.construction, Construction::Conic { .. }) {
            return None;
        }
        let pieces = self.profile.to_rational()?.bezier_pieces().ok()?;
        let mut points = Vec::new();
        for piece in &pieces {
            // The square of the distance from a point is a polynomial of twice the degree over one of twice the degree.
            let n = 2 * piece.degree();
            let domain = piece.domain();
            points.extend((0..=n).map(|i| {
                let t = domain.lo + domain.width() * i as f64 / n as f64;
                self.axis.coordinates(piece.point(t))
            }));
        }
        let far = points
            .iter()
            .copied()
            .max_by(|a, b| a.xy().length().total_cmp(&b.xy().length()))?;
        let way = far.xy().try_normalize()?;
        let size = points.iter().map(|p| p.length()).fold(0.0, f64::max);
        let in_half_plane = |p: &DVec3| way.perp_dot(p.xy()).abs() <= SAME_PLANE * size;
        if !points.iter().all(in_half_plane) {
            return None;
        }
        let meridian: Vec<DVec2> = points
            .iter()
            .map(|p| DVec2::new(way.dot(p.xy()), p.z))
            .collect();
        let jet = self.jet(self.domain().map(Interval::mid), Default::default(), 1);
        let at = self.axis.coordinates(jet.point());
        let normal = self.axis.coordinates(self.axis.origin() + jet.normal()?);
        let outwards = at.xy().try_normalize()?;
        let in_meridian = |p: DVec3| DVec2::new(outwards.dot(p.xy()), p.z);
        Elementary::swept(
            &self.axis,
            &meridian,
            [in_meridian(at), in_meridian(normal)],
        )
    }

    /// Turned, if the profile has a rational form.
    fn swept(&self) -> Option<Swept> {
        let o = &self.options;
        if matches!(o.construction, Construction::Conic { .. }) {
            return None;
        }
        let profile = self.profile.to_rational()?;
        let (mut points, last) = (profile.homogeneous().to_vec(), profile.basis().count() - 1);
        for (i, p) in points.iter_mut().enumerate() {
            let pole = profile.basis().is_clamped()
                && [(0, self.poles[0]), (last, self.poles[1])].contains(&(i, true));
            // Points that stay keep all their digits.
            if pole || o.start != 0.0 {
                let (c, s) = crate::frame::cos_sin(o.start);
                let own = self.axis.components(p.xyz() - self.axis.origin() * p.w);
                let turned = DVec3::new(own.x * c - own.y * s, own.x * s + own.y * c, own.z);
                let kept = if pole { own * DVec3::Z } else { turned };
                let [x, y, z] = self.axis.directions();
                let moved = x * kept.x + y * kept.y + z * kept.z + self.axis.origin() * p.w;
                *p = moved.extend(p.w);
            }
        }
        Some(Swept::Turned {
            curve: NurbsCurve::from_homogeneous(profile.basis().clone(), points),
            axis: self.axis,
            angle: o.angle,
            same: true,
        })
    }
}
