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

/// A bound wider than this share says less about the area than samples do: they give the number, the bound its error.
const LOOSE: f64 = 0.01;

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
    let sampled = || estimate(surface, &|d| d[1].cross(d[2]).length());
    if found.is_finite() {
        let close = found.width() <= LOOSE * found.mag();
        measured(found, if close { f64::NAN } else { sampled().value })
    } else {
        sampled()
    }
}
