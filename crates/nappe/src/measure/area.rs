//! The area of a surface.

use super::integral::{
    Goal, IntegralOptions, Measured, best, estimate, integrate, measured, of_patch,
};
use super::taylor::{Patch, Taylor};
use crate::box3::Box3;
use crate::surface::Surface;

/// `r_u × r_v` as Taylor polynomials.
pub(super) fn normal(jet: &[Box3], degree: usize) -> [Taylor; 3] {
    let [u, v] = [[1, 0], [0, 1]].map(|d| Taylor::vector(jet, d, degree));
    Taylor::cross(&u, &v)
}

/// `|r_u × r_v|` as Taylor polynomials, over a box and at its centre.
pub(super) fn element(patch: &Patch, degree: usize) -> [Taylor; 2] {
    let [wide, at] = [&patch.wide, &patch.at].map(|j| Taylor::square(&normal(j, degree)));
    [wide.tightened(&at, patch.offset).sqrt(), at.sqrt()]
}

/// The area `∫∫ |r_u × r_v| du dv`, in the square of the unit of length.
///
/// `options.relative` is relative to the area. A torn surface (see [`tear`](super::tear)) has the area of its pieces. The
/// result is proven unless the surface cannot enclose its derivatives. [`area_centroid`](super::area_centroid) gives it
/// together with the centroid.
pub fn area(surface: &dyn Surface, options: &IntegralOptions) -> Measured {
    let integrand = of_patch(|patch, degree| vec![element(patch, degree)]);
    let found = integrate(&[surface], &integrand, &Goal::one(options))[0][0];
    let sampled = || estimate(surface, 1, &|d| [d[1].cross(d[2]).length()])[0];
    if found.is_finite() {
        measured(found, best(found, options.relative, sampled))
    } else {
        sampled()
    }
}
