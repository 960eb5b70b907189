//! The form that surfaces of revolution, quadrics and tori share: a profile carried around an axis.

use super::{Core, Separable};
use crate::basis::FunctionsRef;
use glam::{DVec3, DVec4, Vec4Swizzles};

/// `R = Σ_ij a_i b_j (w_i (c_j x + …)…)`: profile coefficients `P_i = (w x, w y, w z, w)` in the frame `e`, section
/// coefficients `(w c, w s, w)`; the point is `(x c - y s) e_x + (x s + y c) e_y + z e_z`. The frame's vectors may have
/// any length: the semi-axes of a quadric.
pub(crate) fn homogeneous(p: DVec4, section: DVec3, e: [DVec3; 3]) -> DVec4 {
    let (c, s, w) = (section.x, section.y, section.z);
    let xyz = e[0] * (p.x * c - p.y * s) + e[1] * (p.x * s + p.y * c) + e[2] * (p.z * w);
    xyz.extend(p.w * w)
}

/// The homogeneous net of a profile along u and a section along v, row-major (v fastest).
pub(crate) fn net(profile: &[DVec4], section: &[DVec3], e: [DVec3; 3]) -> Vec<DVec4> {
    profile
        .iter()
        .flat_map(|&p| section.iter().map(move |&s| homogeneous(p, s, e)))
        .collect()
}

/// The net with the section along u and the profile along v (v fastest), moved to an origin.
pub(crate) fn carried_round(
    profile: &[DVec4],
    section: &[DVec3],
    e: [DVec3; 3],
    origin: DVec3,
) -> Vec<DVec4> {
    section
        .iter()
        .flat_map(|&s| profile.iter().map(move |&p| homogeneous(p, s, e)))
        .map(|p| (p.xyz() + origin * p.w).extend(p.w))
        .collect()
}

/// The separable surface of a profile along u and a section along v.
pub(crate) fn turned(
    (u, profile): (FunctionsRef, &[DVec4]),
    (v, section): (FunctionsRef, &[DVec3]),
    e: [DVec3; 3],
    origin: DVec3,
    rational: bool,
) -> Separable {
    let core = Core::Net(net(profile, section, e));
    if rational {
        Separable::rational(u, v, core, origin)
    } else {
        Separable::polynomial(u, v, core, origin)
    }
}
