//! The rational biquadratic patch of nine points and two weights.

use crate::exact::NurbsSurface;
use glam::DVec3;
use thiserror::Error;

/// What can be wrong with a biquadratic patch.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum BiquadraticError {
    /// A point has a coordinate that is NaN or infinite.
    #[error("points[{row}][{column}] is {point}: coordinates must be finite numbers")]
    NotFinite {
        /// Its index along u.
        row: usize,
        /// Its index along v.
        column: usize,
        /// The point.
        point: DVec3,
    },
    /// A weight is not positive and finite.
    #[error("{name} is {value}: weights must be positive, finite numbers")]
    Weight {
        /// `weight_u` or `weight_v`.
        name: &'static str,
        /// Its value.
        value: f64,
    },
}

/// The rational Bézier patch of degree 2 × 2 with nine points, `points[u][v]`: the corners have weight 1, the middle
/// points of the edges along u have `weight_u`, those of the edges along v `weight_v`, the middle `weight_u·weight_v`.
///
/// All four sides are conic arcs: elliptic for a weight below 1, parabolic for 1, hyperbolic above. Parts of all
/// quadrics and of the torus are such patches; for a torus piece with opening angles α along u and β along v the
/// weights are cos(α/2) and cos(β/2). Source: Golovanov, *Geometric modelling*, §3.9 (3.9.2).
pub fn biquadratic(
    points: &[[DVec3; 3]; 3],
    weight_u: f64,
    weight_v: f64,
) -> Result<NurbsSurface, BiquadraticError> {
    for (name, value) in [("weight_u", weight_u), ("weight_v", weight_v)] {
        if !(value.is_finite() && value > 0.0) {
            return Err(BiquadraticError::Weight { name, value });
        }
    }
    let flat = points.as_flattened();
    if let Some(at) = flat.iter().position(|p| !p.is_finite()) {
        return Err(BiquadraticError::NotFinite {
            row: at / 3,
            column: at % 3,
            point: flat[at],
        });
    }
    let (u, v) = ([1.0, weight_u, 1.0], [1.0, weight_v, 1.0]);
    let weights: Vec<f64> = (0..9).map(|k| u[k / 3] * v[k % 3]).collect();
    // What remains is a product of weights that leaves the range of doubles.
    NurbsSurface::bezier(3, flat, Some(&weights)).map_err(|_| BiquadraticError::Weight {
        name: "weight_u * weight_v",
        value: weight_u * weight_v,
    })
}
