//! The balls that touch a surface from either side.

use super::crease::sharpest;
use super::curvature::CurvatureExtremes;
use super::search::Extreme;
use crate::surface::Surface;

/// The largest ball that rolls over all of a surface on one side without touching it beside the point of contact, as far as
/// curvature decides: the tool that can mill it. Parts of a surface that face each other may leave less room.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollingBall {
    /// The smallest radius of curvature found where the surface bends towards this side; infinite if it does so nowhere, 0
    /// where curvature is unbounded and in a crease that turns towards this side.
    pub radius: f64,
    /// The parameters of the place where it is.
    pub uv: [f64; 2],
    /// A ball of this radius fits everywhere: proven, but that creases are found by samples (see [`rolling_balls`]). 0
    /// where nothing is known.
    pub at_least: f64,
}

/// The rolling balls on the side of the normal `r_u × r_v`, and on the other side, from the extremes of this surface's
/// curvature. Its sides are not looked at, nor what meets it there.
///
/// The surface bends towards the normal where a principal curvature is positive. So for a closed shell whose normals point
/// outwards the first belongs to what is concave seen from outside, the second to the material inside.
/// A crease leaves room for no ball on the side it turns to. Creases are looked for in nine places of each piece of the
/// breaks: `at_least` is proven inside the analytic pieces, and there rests on these places. Cost: 18 normals for each.
pub fn rolling_balls(surface: &dyn Surface, extremes: &CurvatureExtremes) -> [RollingBall; 2] {
    let [towards, away] = sharpest(surface);
    let sides = [(1.0, extremes.k1, towards), (-1.0, extremes.k2, away)];
    sides.map(|(sign, k, crease)| {
        let ball = ball(sign, k);
        RollingBall {
            radius: if crease.is_some() { 0.0 } else { ball.radius },
            uv: crease.unwrap_or(ball.uv),
            at_least: if crease.is_some() { 0.0 } else { ball.at_least },
        }
    })
}

fn ball(sign: f64, k: Extreme) -> RollingBall {
    let radius = |k: f64| if k > 0.0 { 1.0 / k } else { f64::INFINITY };
    let value = sign * k.value;
    let proven = !matches!(k.certainty, crate::mesh::Certainty::Estimated(_));
    let most = (value + k.certainty.error()).next_up();
    RollingBall {
        radius: radius(value),
        uv: k.uv,
        at_least: if proven {
            let least = radius(most);
            if least.is_finite() {
                least.next_down().max(0.0)
            } else {
                least
            }
        } else {
            0.0
        },
    }
}
