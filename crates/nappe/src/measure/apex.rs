//! Poles where curvature grows without bound, like the tip of a cone.
//!
//! Let `r_v = r_vv = 0` in a place of the side u = u₀, as where it is one point: beside it `r_v = δρ`, `r_vv = δρ_v` with
//! `δ = u - u₀`, `ρ → r_uv` and `ρ_v → r_uvv`. With `N = r_u × ρ` the normal is
//! `±N/|N|`, and the normal curvature square to r_u is `ρ_v·N / (δ |N| |w|²)` plus what stays bounded, w being the part
//! of ρ square to r_u: if `ρ_v·N ≠ 0` somewhere on the side, it is unbounded, and so is the mean curvature. If the
//! curvature along r_u is not zero there, that of Gauss is unbounded too.

use super::shape::{PLANE, POINT};
use crate::box3::Box3;
use crate::breaks::{Breaks, Limit};
use crate::interval::Interval;
use crate::surface::{Dir, Surface, jet_index, jet_len};

/// A place in a pole beside which curvature is proven to be unbounded.
pub(super) struct Apex {
    pub(super) uv: [f64; 2],
    /// The sign of the unbounded principal curvature, and of the mean curvature.
    pub(super) principal: f64,
    /// The sign of the Gaussian curvature; 0 if that is not shown to be unbounded.
    pub(super) gaussian: f64,
}

/// Which curvatures of a surface are proven to grow without bound towards a pole, as at the tip of a cone: for each
/// whether to -∞ and whether to +∞. Only poles in sides are looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UnboundedCurvature {
    /// The Gaussian curvature.
    pub gaussian: [bool; 2],
    /// The mean curvature.
    pub mean: [bool; 2],
}

/// Which curvatures are unbounded. Cost: a few enclosures of order 3 for each piece of a side.
pub fn unbounded_curvature(surface: &dyn Surface) -> UnboundedCurvature {
    let mut found = UnboundedCurvature::default();
    for apex in apexes(surface, super::size(surface)) {
        for (which, sign) in [
            (&mut found.gaussian, apex.gaussian),
            (&mut found.mean, apex.principal),
        ] {
            which[0] |= sign < 0.0;
            which[1] |= sign > 0.0;
        }
    }
    found
}

/// Where a piece of a side is looked at: away from symmetries.
const PLACES: [f64; 3] = [0.21, 0.53, 0.83];

/// The places in all poles. Cost: a few enclosures of order 3 for each.
pub(super) fn apexes(surface: &dyn Surface, size: f64) -> Vec<Apex> {
    let mut found = Vec::new();
    for (d, across, along) in [(0, Dir::U, Dir::V), (1, Dir::V, Dir::U)] {
        let (across, along) = (surface.breaks(across), surface.breaks(along));
        for upper in [false, true] {
            let beside = across.piece(if upper { across.pieces() - 1 } else { 0 });
            for k in 0..along.pieces() {
                let mut uv = [beside, along.piece(k)];
                if d == 1 {
                    uv.swap(0, 1);
                }
                let place = |s: &f64| apex(surface, uv, d, upper, *s, size);
                found.extend(PLACES.iter().filter_map(place));
            }
        }
    }
    found
}

fn apex(
    surface: &dyn Surface,
    uv: [Interval; 2],
    d: usize,
    upper: bool,
    s: f64,
    size: f64,
) -> Option<Apex> {
    let other = uv[1 - d];
    let mut p = [other.lo + (other.hi - other.lo) * s; 2];
    p[d] = if upper { uv[d].hi } else { uv[d].lo };
    let mut limit = [Limit::Above; 2];
    if upper {
        limit[d] = Limit::Below;
    }
    let mut jet = [Box3::ENTIRE; jet_len(3)];
    surface.enclose_piece(p.map(Interval::point), limit, 3, &mut jet);
    // `a` derivatives across and `b` along.
    let of = |a: usize, b: usize| {
        jet[if d == 0 {
            jet_index(a, b)
        } else {
            jet_index(b, a)
        }]
    };
    let width = other.width();
    let is_point = of(0, 1).norm().hi * width <= POINT * size
        && of(0, 2).norm().hi * width * width <= POINT * size;
    if !is_point {
        return None;
    }
    let normal = if d == 0 {
        of(1, 0).cross(of(1, 1))
    } else {
        of(1, 1).cross(of(1, 0))
    };
    let sign = |v: Box3| -> f64 {
        let product = v.dot(normal);
        let least = PLANE * v.norm().hi * normal.norm().hi;
        if !(normal.norm().lo > 0.0 && product.is_finite() && product.mig() > least) {
            0.0
        } else {
            product.lo.signum()
        }
    };
    let principal = sign(of(1, 2));
    let turned = if upper { -1.0 } else { 1.0 };
    (principal != 0.0).then(|| Apex {
        uv: p,
        principal,
        gaussian: principal * turned * sign(of(2, 0)),
    })
}
