//! The bicubic Hermite (Ferguson-Coons) patch of corner data.

use super::bilinear::{centre, not_finite};
use super::{Core, Separable};
use crate::basis::Hermite;
use glam::DVec3;
use std::sync::Arc;
use thiserror::Error;

/// The corner data of a bicubic patch; every table is `[u][v]`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HermiteData {
    /// The points.
    pub corners: [[DVec3; 2]; 2],
    /// `∂r/∂u`, lengths over the whole parameter range.
    pub tangents_u: [[DVec3; 2]; 2],
    /// `∂r/∂v`.
    pub tangents_v: [[DVec3; 2]; 2],
    /// `∂²r/∂u∂v`; zero gives Ferguson's patch.
    pub twists: [[DVec3; 2]; 2],
}

/// What can be wrong with corner data.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum HermiteError {
    /// A vector has a coordinate that is NaN or infinite.
    #[error("{name}[{u}][{v}] is {value}: coordinates must be finite numbers")]
    NotFinite {
        /// Which table.
        name: &'static str,
        /// The index along u.
        u: usize,
        /// The index along v.
        v: usize,
        /// The vector.
        value: DVec3,
    },
}

/// The bicubic patch with the given corner data on `[0, 1]²`: `r = Σ_ij H_i(u) Q_ij H_j(v)`, which is
/// `U N P Nᵀ W` with N the matrix of the cubic Hermite functions (last row `[1 0 0 0]`).
///
/// Exactly a Bézier surface of degree 3 × 3.
/// Source: "Description and construction of surfaces in space", (15) and (16); what it calls curvature vectors are
/// the twists.
pub fn hermite(data: &HermiteData) -> Result<Separable, HermiteError> {
    for (name, table) in [
        ("corners", &data.corners),
        ("tangents_u", &data.tangents_u),
        ("tangents_v", &data.tangents_v),
        ("twists", &data.twists),
    ] {
        if let Some((u, v)) = not_finite(table) {
            let value = table[u][v];
            return Err(HermiteError::NotFinite { name, u, v, value });
        }
    }
    let origin = centre(&data.corners);
    // H1 and H4 belong to values at 0 and 1, H2 and H3 to derivatives there.
    let (end, is_value) = ([0, 0, 1, 1], [true, false, false, true]);
    let net = (0..16).map(|k| {
        let (i, j) = (k / 4, k % 4);
        let (u, v) = (end[i], end[j]);
        let q = match (is_value[i], is_value[j]) {
            (true, true) => data.corners[u][v] - origin,
            (false, true) => data.tangents_u[u][v],
            (true, false) => data.tangents_v[u][v],
            (false, false) => data.twists[u][v],
        };
        q.extend(1.0)
    });
    let basis = Arc::new(Hermite::new());
    Ok(Separable::polynomial(
        basis.clone(),
        basis,
        Core::Net(net.collect()),
        origin,
    ))
}
