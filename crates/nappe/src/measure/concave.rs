//! The balls that touch a surface from either side.

use super::curvature::CurvatureExtremes;
use super::search::Extreme;

/// The largest ball that rolls over all of a surface on one side without touching it beside the point of contact, as far as
/// curvature decides: the tool that can mill it. Parts of a surface that face each other may leave less room.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollingBall {
    /// The smallest radius of curvature found where the surface bends towards this side; infinite if it does so nowhere, 0
    /// where curvature is unbounded.
    pub radius: f64,
    /// The parameters of the place where it is.
    pub uv: [f64; 2],
    /// Proven: a ball of this radius fits everywhere. 0 where nothing is known.
    pub at_least: f64,
}

/// The rolling balls on the side of the normal `r_u × r_v`, and on the other side.
///
/// The surface bends towards the normal where a principal curvature is positive. So for a closed shell whose normals point
/// outwards the first belongs to what is concave seen from outside, the second to the material inside.
pub fn rolling_balls(extremes: &CurvatureExtremes) -> [RollingBall; 2] {
    [(1.0, extremes.k1), (-1.0, extremes.k2)].map(|(sign, k)| ball(sign, k))
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
