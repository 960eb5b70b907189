//! The area of a surface.

use super::integral::{IntegralOptions, Measured, estimate, integrate, measured};
use super::taylor::{Patch, Taylor};
use crate::box3::Box3;
use crate::surface::Surface;

/// `r_u × r_v` as Taylor polynomials.
pub(super) fn normal(jet: &[Box3], degree: usize) -> [Taylor; 3] {
    let [u, v] = [[1, 0], [0, 1]].map(|d| Taylor::vector(jet, d, degree));
    Taylor::cross(&u, &v)
}

/// The area `∫∫ |r_u × r_v| du dv`, in the square of the unit of length.
///
/// `options.relative` is relative to the area. A torn surface (see [`tear`](super::tear)) has the area of its pieces. The
/// result is proven unless the surface cannot enclose its derivatives.
pub fn area(surface: &dyn Surface, options: &IntegralOptions) -> Measured {
    let integrand = |patch: &Patch, degree: usize| {
        let [wide, at] = [&patch.wide, &patch.at].map(|j| Taylor::square(&normal(j, degree)));
        [wide.tightened(&at, patch.offset).sqrt(), at.sqrt()]
    };
    let found = integrate(&[surface], &integrand, options)[0];
    if found.is_finite() {
        measured(found)
    } else {
        estimate(surface, &|d| d[1].cross(d[2]).length())
    }
}
