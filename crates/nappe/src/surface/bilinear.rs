//! The bilinear surface of four corners.

use super::{Core, Separable};
use crate::basis::BSplineBasis;
use glam::DVec3;
use std::sync::Arc;
use thiserror::Error;

/// What can be wrong with a bilinear surface.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum BilinearError {
    /// A corner has a coordinate that is NaN or infinite.
    #[error("corners[{u}][{v}] is {point}: coordinates must be finite numbers")]
    NotFinite {
        /// Its index along u.
        u: usize,
        /// Its index along v.
        v: usize,
        /// The corner.
        point: DVec3,
    },
}

/// The bilinear surface with the given corners, `corners[u][v]`:
/// `r(u, v) = (1-u)(1-v) P00 + (1-u) v P01 + u (1-v) P10 + u v P11` on `[0, 1]²`.
///
/// In general a part of a hyperbolic paraboloid; a parallelogram if `P00 + P11 = P01 + P10`. Exactly a Bézier surface
/// of degree 1 × 1. Source: "Description and construction of surfaces in space", (1).
pub fn bilinear(corners: [[DVec3; 2]; 2]) -> Result<Separable, BilinearError> {
    if let Some((u, v)) = not_finite(&corners) {
        let point = corners[u][v];
        return Err(BilinearError::NotFinite { u, v, point });
    }
    let origin = centre(&corners);
    let net = corners.as_flattened().iter();
    let line = Arc::new(BSplineBasis::bernstein(1));
    Ok(Separable::polynomial(
        line.clone(),
        line,
        Core::Net(net.map(|p| (*p - origin).extend(1.0)).collect()),
        origin,
    ))
}

/// The indices of the first vector that is not finite.
pub(super) fn not_finite(vectors: &[[DVec3; 2]; 2]) -> Option<(usize, usize)> {
    let at = vectors.as_flattened().iter().position(|p| !p.is_finite())?;
    Some((at / 2, at % 2))
}

/// The middle of four corners: measured from there, a surface far from the origin of space loses no digits.
pub(super) fn centre(corners: &[[DVec3; 2]; 2]) -> DVec3 {
    let m = corners.as_flattened().iter().map(|p| *p * 0.25).sum();
    if DVec3::is_finite(m) { m } else { DVec3::ZERO }
}
