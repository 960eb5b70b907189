//! Fillets: rolling-ball surfaces with circular sections between two supports.

mod contact;
mod error;
mod exact;
mod find;
mod memo;
mod motion;
mod rolling_ball;
mod spine;
mod trace;
mod traced;

use super::{Core, Elementary, Separable, Surface, SurfaceRef, Term};
use crate::basis::{BSplineBasis, FunctionsRef};
use crate::breaks::{Breaks, Limit};
use crate::exact::NurbsSurface;
pub use error::FilletError;
use glam::{DVec3, DVec4};
pub use rolling_ball::Radius;
use rolling_ball::RollingBall;
use spine::{ContactCurve, Spine};
use std::sync::Arc;

/// The sine of the angle below which two supports are parallel: with less, the place of their edge is rounding.
const PARALLEL: f64 = 1e-12;
/// Relative to the radius: how far a contact may lie beyond the end of its support by rounding.
const BEYOND: f64 = 1e-9;

/// Which fillet of several.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct FilletOptions {
    /// For each support whether the ball is on the side its normals `r_u × r_v` point to. `None`: of the four
    /// quadrants between two planes the one in which both supports reach furthest from the edge (at a tie, the sides
    /// the normals point to); for a cylinder, the sides the normals point to.
    pub side: Option<[bool; 2]>,
    /// A plane parallel to a cylinder's axis is touched on one of two lines: this takes the other one. The first is
    /// towards `axis × normal`, the normal pointing to the ball.
    pub other_line: bool,
    /// The part of the fillet: lengths along the edge (the way u runs) or along the axis, from where the supports begin
    /// to lie beside each other (default: as long as they do); or angles in radians in a cylinder's frame where the fillet
    /// goes round it (default: one turn). Not for other pairs.
    pub range: Option<[f64; 2]>,
    /// Of several fillets between two other surfaces: the one whose ball comes nearest to this point.
    pub near: Option<DVec3>,
}

/// A fillet between two supports on `[0, 1]²`: each section u = const is the circular arc
/// `r(u, v) = [B0(v) p0(u) + w(u) B1(v) p1(u) + B2(v) p2(u)] / [B0 + w B1 + B2]`, `w = cos(α/2)`, from the contact p0 on
/// the first support (v = 0) to the contact p2 on the second (v = 1), p1 being the meeting point of the tangents.
///
/// It is the exact envelope of a rolling ball of constant or variable radius; with a variable radius the sections' planes are
/// not square to the edge and the arcs' radius is `r √(1 - r'²/|c'|²)`. It touches both supports. The normals `r_u × r_v`
/// point to the ball's centre; for that u runs along `n0 × n2`, where n0 and n2 are the supports' normals towards the
/// ball.
///
/// Two planes, and a plane with a circular cylinder pierced by it at any angle or parallel to it, have a formula; they are
/// recognised by [`Surface::elementary`]. Between planes the contacts must lie on the given parts; a cylinder that goes all
/// the way round and the plane with it count as unbounded. One that does not (another fillet, say) is a surface like others.
///
/// Between any other two surfaces the ball is followed until a contact reaches the end of its surface or the path closes; a
/// contact may pass seams and breaks where the normal goes on. u is nearly in proportion to the length of the
/// centre's path; where it closes the radius must be the same at both ends, to 1e-9 of it. The contacts are the exact solutions of their equations, with derivatives of any order: for every u they
/// are proven to exist, the ball to be no more curved than either surface, and the sections not to cross. Not proven: that
/// the ball does not meet a surface somewhere else (one of 65 balls that does is refused), and that no further fillet
/// exists, since paths are looked for at samples of both. A variable radius must fit only at its own place, but the middle,
/// the least or the greatest one must go all the way. Surfaces whose enclosures end at their sides (Gregory's twists) are proven only inside of them.
///
/// If both surfaces are planes square to one axis, cylinders, cones and tori about it, or spheres with their centres on it
/// (two spheres always are), a ball of constant radius that was so found and proven goes round a circle, u in proportion to
/// the angle, and the fillet is that piece of a torus. Between parallel cylinders, and a plane along a part of one, it is a piece of a cylinder.
///
/// Exactly a NURBS surface for a constant radius between planes, along a cylinder and between parallel ones; for pieces of a
/// torus [`Surface::to_rational`] gives the same shape. Source: Golovanov, *Geometric modelling*, §3.9 (3.9.3).
#[derive(Clone, Debug)]
pub struct Fillet {
    form: Separable,
    /// The ball's path, where it has a formula.
    ball: Option<Arc<RollingBall>>,
    /// The same path as the solution of the contacts' equations.
    spine: Option<Arc<Spine>>,
    origin: DVec3,
    nurbs: Option<NurbsSurface>,
    rational: Option<NurbsSurface>,
}

impl Fillet {
    /// The fillet between two surfaces. Cost: a thousand nearest points or more, for each radius tried,
    /// and some hundred enclosures if it has no formula.
    pub fn new(
        first: &SurfaceRef,
        second: &SurfaceRef,
        radius: Radius,
        options: FilletOptions,
    ) -> Result<Self, FilletError> {
        check_radius(&radius)?;
        if let Some([from, to]) = options.range
            && !(from.is_finite() && to.is_finite() && from < to)
        {
            return Err(FilletError::Range { from, to });
        }
        let surfaces = [first.as_ref(), second.as_ref()];
        use Elementary::{Cylinder, Plane};
        match surfaces.map(|s| s.elementary()) {
            [
                Some(Plane { origin, normal }),
                Some(Plane {
                    origin: b,
                    normal: n,
                }),
            ] => exact::between_planes(surfaces, [origin, b], [normal, n], radius, &options),
            [
                Some(Plane { origin, normal }),
                Some(Cylinder {
                    axis,
                    radius: rho,
                    outward,
                }),
            ] if exact::goes_round(surfaces[1], &axis) => {
                let pair = ((origin, normal), (axis, rho, outward));
                exact::at_cylinder(surfaces, pair, false, radius, &options)
            }
            [
                Some(Cylinder {
                    axis,
                    radius: rho,
                    outward,
                }),
                Some(Plane { origin, normal }),
            ] if exact::goes_round(surfaces[0], &axis) => {
                let pair = ((origin, normal), (axis, rho, outward));
                exact::at_cylinder(surfaces, pair, true, radius, &options)
            }
            [Some(a), Some(b)] => Self::followed(first, second, radius, options, Some([a, b])),
            _ => Self::followed(first, second, radius, options, None),
        }
    }

    /// The same without a look for a formula.
    pub fn traced(
        first: &SurfaceRef,
        second: &SurfaceRef,
        radius: Radius,
        options: FilletOptions,
    ) -> Result<Self, FilletError> {
        check_radius(&radius)?;
        Self::followed(first, second, radius, options, None)
    }

    /// The ball is followed. Where the surfaces' forms tell a motion that carries both into themselves, a path of constant
    /// radius has a formula.
    fn followed(
        first: &SurfaceRef,
        second: &SurfaceRef,
        radius: Radius,
        options: FilletOptions,
        forms: Option<[Elementary; 2]>,
    ) -> Result<Self, FilletError> {
        if options.range.is_some() {
            return Err(FilletError::RangeOfTraced);
        }
        let supports = [first.clone(), second.clone()];
        let (spine, carried) = traced::spine(supports, radius.clone(), &options, forms)?;
        if let (Some(carried), Radius::Constant(radius)) = (carried, radius) {
            return exact::carried(carried, spine, radius);
        }
        let (origin, spine) = (spine.supports.origin, Arc::new(spine));
        Ok(Self {
            form: arc_sections(spine.clone(), origin),
            ball: None,
            spine: Some(spine),
            origin,
            nurbs: None,
            rational: None,
        })
    }

    /// The ball's centre, and its radius, at a parameter u.
    pub fn ball(&self, u: f64) -> (DVec3, f64) {
        let (centre, radius) = match (&self.ball, &self.spine) {
            (Some(ball), _) => ball.centre(u),
            (None, Some(spine)) => {
                let ball = spine.ball(u, inner_limit(spine, u), 0);
                let centre = ball.centre.each_ref().map(|x| x.value());
                (DVec3::from_array(centre), ball.radius.value())
            }
            (None, None) => (DVec3::NAN, f64::NAN),
        };
        (self.origin + centre, radius)
    }

    /// The curve of contacts in the parameter plane of the first or second surface (index 0 or 1), two functions of the
    /// fillet's u: where that surface is trimmed. `None` between two planes, and between a plane and a whole cylinder. The curves
    /// in space are the fillet's sides south and north. Panics for another index.
    pub fn contacts(&self, index: usize) -> Option<FunctionsRef> {
        assert!(index < 2, "there are two supports");
        let spine = self.spine.as_ref()?;
        Some(Arc::new(ContactCurve::new(spine.clone(), index)))
    }

    /// The certificate at a parameter: a proven bound of how far the distances of [`Self::ball`]'s centre from both
    /// contacts, which are enclosed, are from the radius. `None` between two planes, and between a plane and a whole cylinder.
    pub fn contact_error(&self, u: f64) -> Option<f64> {
        let spine = self.spine.as_ref()?;
        Some(spine.contact_error(u, self.ball(u).0 - spine.supports.origin))
    }
}

/// The limit from inside the domain.
fn inner_limit(spine: &Spine, u: f64) -> Limit {
    if u >= spine.breaks.domain().hi {
        Limit::Below
    } else {
        Limit::Above
    }
}

/// The general rational surface of sections: functions `p0 (3), w p1 (3), p2 (3), 1, w` of u, measured from an origin, and
/// v the parameter of the quadratic arcs `[B0 p0 + w B1 p1 + B2 p2] / [B0 + w B1 + B2]`.
///
/// Whoever can state contact curves, apex curve and weight as functions, for any pair of supports, has the surface
/// with its derivatives and enclosures. Panics unless there are eleven functions. Source: Golovanov, §3.9 (3.9.3).
pub fn arc_sections(functions: FunctionsRef, origin: DVec3) -> Separable {
    let e = [DVec4::X, DVec4::Y, DVec4::Z];
    let mut terms: Vec<Term> = (0..9).map(|k| Term::new(k, k / 3, e[k % 3])).collect();
    terms.extend([
        Term::new(9, 0, DVec4::W),
        Term::new(10, 1, DVec4::W),
        Term::new(9, 2, DVec4::W),
    ]);
    let arc = Arc::new(BSplineBasis::bernstein(2));
    Separable::rational(functions, arc, Core::Terms(terms), origin)
}

fn check_radius(radius: &Radius) -> Result<(), FilletError> {
    match radius {
        Radius::Constant(r) if !(*r > 0.0 && r.is_finite()) => {
            Err(FilletError::Radius { at: 0.0, value: *r })
        }
        Radius::Constant(_) => Ok(()),
        Radius::Along(f) => {
            let breaks = f.breaks();
            let (from, to) = (breaks[0].at, breaks[breaks.len() - 1].at);
            if f.count() != 1 || from != 0.0 || to != 1.0 {
                let count = f.count();
                return Err(FilletError::RadiusFunction { count, from, to });
            }
            Ok(())
        }
    }
}

impl Surface for Fillet {
    evaluate_through!(self => self.form);

    fn to_nurbs(&self) -> Option<NurbsSurface> {
        self.nurbs.clone()
    }

    fn to_rational(&self) -> Option<NurbsSurface> {
        self.rational.clone()
    }

    fn elementary(&self) -> Option<Elementary> {
        self.ball.as_ref()?.elementary(self.origin)
    }
}
