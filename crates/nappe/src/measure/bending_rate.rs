//! How integrals of curvature change when a surface moves: differences of the surface moved a little along its velocity,
//! either way. The surface is not built anew, so that nothing but the integrand differs.

use super::fairness::sampled_variation;
use super::gauss::sampled_sweep;
use super::integral::Measured;
use super::rate::Moving;
use super::size;
use crate::mesh::Certainty;
use crate::surface::{Surface, SurfaceRef};
use crate::velocity::{Factor, Sum, Term};
use glam::DVec3;

/// Derivatives of the integrals of curvature of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendingRate {
    /// Of [`total_curvature`](super::total_curvature).
    pub total: Measured,
    /// Of [`curvature_variation`](super::curvature_variation).
    pub variation: Measured,
}

/// How far the surface is moved, relative to its size.
const STEP: f64 = 1e-4;

/// The derivatives of the integrals of curvature by the parameter that moves the surface. Estimated, from differences with two
/// steps; the integrals must be finite. Cost: eight integrals by quadrature.
pub fn bending_rate(part: &Moving) -> BendingRate {
    let still = Measured {
        value: 0.0,
        certainty: Certainty::Exact,
    };
    let Some(velocity) = &part.velocity else {
        return BendingRate {
            total: still,
            variation: still,
        };
    };
    let speed = part.speed();
    if speed == 0.0 {
        let none = Measured {
            value: 0.0,
            certainty: Certainty::Estimated(0.0),
        };
        return BendingRate {
            total: none,
            variation: none,
        };
    }
    let step = STEP * size(part.surface.as_ref()) / speed;
    let of = |figure: fn(&dyn Surface) -> Measured| {
        let moved = |h: f64| figure(&along(&part.surface, velocity, h));
        let slope = |h: f64| {
            let [ahead, behind] = [h, -h].map(moved);
            let value = (ahead.value - behind.value) / (2.0 * h);
            // The two rules of quadrature differ on both sides in much the same way.
            let [a, b] = [ahead, behind].map(|m| m.certainty.error());
            let off = (a - b).abs() / (2.0 * h);
            let size = ahead.value.abs().max(behind.value.abs());
            let share = if size > 0.0 { a.max(b) / size } else { 0.0 };
            (value, off + share * value.abs() + f64::EPSILON * size / h)
        };
        let (coarse, _) = slope(step);
        let (fine, off) = slope(0.5 * step);
        // Without the term of the second order in the step.
        let value = fine + (fine - coarse) / 3.0;
        Measured {
            value,
            certainty: Certainty::Estimated((fine - coarse).abs() / 3.0 + off),
        }
    };
    BendingRate {
        total: of(sampled_sweep),
        variation: of(sampled_variation),
    }
}

/// The surface after it has moved for a while.
fn along(surface: &SurfaceRef, velocity: &SurfaceRef, h: f64) -> Sum {
    let share = Term {
        factor: Factor::Linear {
            constant: h,
            along: [0.0; 2],
        },
        ..Term::new(velocity.clone())
    };
    Sum::new(DVec3::ZERO, vec![Term::new(surface.clone()), share])
}
