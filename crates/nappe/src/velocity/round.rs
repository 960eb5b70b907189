//! What goes round an axis: arcs, tori, surfaces of revolution.

use super::{Extended, Factor, FrameRate, Sum, Term, as_curve, cross_matrix, extended};
use crate::curve::{Curve, CurveRef, Ellipse, on_unit_domain};
use crate::surface::{Construction, Dir, Revolution, SurfaceRef, Torus, TorusError, TorusOptions};
use glam::{DMat3, DVec3};
use std::sync::Arc;

/// `v vᵀ`.
pub(super) fn along(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

/// The velocity of an arc of an ellipse: its frame moves, its semi-axes change by `growth` times themselves, its angles at
/// the rates `angles` (radians).
pub fn arc(at: &Ellipse, frame: &FrameRate, growth: [f64; 2], angles: [f64; 2]) -> CurveRef {
    let [x, y] = at.axes().map(DVec3::normalize_or_zero);
    let map = frame.spin() + along(x) * growth[0] + along(y) * growth[1];
    let of = extended(Arc::new(*at));
    let [from, to] = at.angles();
    let turn = to - from;
    let terms = vec![
        Term::image(of.clone(), map, at.center()),
        Term::slide(of, Dir::U, angles[0] / turn, (angles[1] - angles[0]) / turn),
    ];
    as_curve(Sum::new(frame.origin, terms))
}

/// The velocity of a torus with fixed ranges: its frame moves, its radii change at the rates.
///
/// Without that of the frame it is linear in the radii: what tori with the radii 2, 1 and 3, 1 tell.
pub fn torus(
    at: &Torus,
    frame: &FrameRate,
    [major, minor]: [f64; 2],
) -> Result<SurfaceRef, TorusError> {
    let options = at.options();
    let origin = options.frame.origin();
    let central = TorusOptions {
        frame: options.frame.moved_to(DVec3::ZERO),
        ..*options
    };
    let mut terms = vec![Term::image(Arc::new(at.clone()), frame.spin(), origin)];
    for (radius, share) in [(2.0, 3.0 * minor - major), (3.0, major - 2.0 * minor)] {
        let torus = Arc::new(Torus::new(radius, 1.0, central)?);
        terms.push(Term::image(torus, DMat3::IDENTITY * share, DVec3::ZERO));
    }
    Ok(Arc::new(Sum::new(frame.origin, terms)))
}

/// How a surface of revolution changes.
#[derive(Clone, Debug, Default)]
pub struct TurnRate {
    /// The velocity of the profile, over the profile's domain; `None`: it does not move.
    pub profile: Option<CurveRef>,
    /// That of the axis.
    pub axis: FrameRate,
    /// The rate of the angle at which the turn starts.
    pub start: f64,
    /// The rate of the angle of the turn.
    pub angle: f64,
}

/// The velocity of a surface of revolution. `None` for Grigoriev's sections, and for rational arcs whose angle changes.
///
/// With R the rotation, o a point of the axis, e its direction, w its angular velocity, φ the angle, c the profile:
/// `r' = o' + w × (r - o) + φ' e × (r - o) + R (c' - o' - w × (c - o))`.
pub fn revolution(at: &Revolution, rate: &TurnRate) -> Option<SurfaceRef> {
    let options = at.options();
    let whole = Ellipse::arc(
        DVec3::ZERO,
        1.0,
        options.start,
        options.start + options.angle,
        DVec3::Z,
    );
    let circle = whole.ok()?;
    let (circle, unit): (CurveRef, bool) = match options.construction {
        Construction::Angle => (Arc::new(circle), false),
        Construction::Coons => (Arc::new(circle), true),
        Construction::Rational if rate.angle == 0.0 => (Arc::new(circle.to_rational()?), false),
        Construction::Rational | Construction::Conic { .. } => return None,
    };
    let over = |c: &CurveRef| {
        if unit {
            on_unit_domain(c.clone())
        } else {
            c.clone()
        }
    };
    let profile = over(at.profile());
    let domain = profile.domain();
    let extend =
        |c: CurveRef| -> SurfaceRef { Arc::new(Extended::new(c, Dir::U, circle.domain())) };
    let (origin, e) = (at.axis().origin(), at.axis().z());
    let FrameRate { origin: way, turn } = rate.axis;
    let mut own = vec![Term::image(extend(profile), cross_matrix(-turn), origin)];
    own.extend(rate.profile.as_ref().map(|c| Term::new(extend(over(c)))));
    let own: SurfaceRef = Arc::new(Sum::new(-way, own));
    let round: SurfaceRef = Arc::new(Extended::new(circle, Dir::V, domain));
    let coordinate = |axis: usize| Factor::Coordinate {
        of: round.clone(),
        axis,
    };
    let image = |map: DMat3| Term::image(own.clone(), map, DVec3::ZERO);
    let surface: SurfaceRef = Arc::new(at.clone());
    let turning = Factor::Linear {
        constant: rate.start,
        along: [0.0, rate.angle],
    };
    let terms = vec![
        Term::image(surface.clone(), rate.axis.spin(), origin),
        Term::image(surface, cross_matrix(e), origin).times(turning),
        image(along(e)),
        image(DMat3::IDENTITY - along(e)).times(coordinate(0)),
        image(cross_matrix(e)).times(coordinate(1)),
    ];
    Some(Arc::new(Sum::new(way, terms)))
}
