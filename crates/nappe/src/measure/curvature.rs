//! Curvature of a surface at a point, and its extremes over a surface.

use super::search::{Extreme, SearchOptions, largest};
use super::taylor::Taylor;
use crate::box3::Box3;
use crate::interval::Interval;
use crate::surface::{Surface, SurfaceJet};
use glam::DVec3;

/// The curvature of a surface at a point.
///
/// Signs are those of the normal `n = r_u × r_v / |r_u × r_v|`: a normal section that bends towards `n` has positive
/// curvature. So a sphere of radius R whose normals point outwards has `k1 = k2 = mean = -1/R` and Gaussian curvature
/// `1/R²`. Units: 1/length; the Gaussian curvature 1/length².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curvature {
    /// `K = k1 k2 = (LN - M²)/(EG - F²)`.
    pub gaussian: f64,
    /// `H = (k1 + k2)/2 = (EN - 2FM + GL)/(2(EG - F²))`.
    pub mean: f64,
    /// The larger principal curvature.
    pub k1: f64,
    /// The smaller principal curvature.
    pub k2: f64,
    /// The unit tangent vectors along which the normal section has curvature `k1` and `k2`; square to each other. Where
    /// both are equal (an umbilic) every pair would do; then the first is along `r_u`.
    pub directions: [DVec3; 2],
}

/// Below this relative difference of the principal curvatures their directions are rounding errors.
const UMBILIC: f64 = 1e-12;

/// The curvature from a jet of order 2 or more; `None` where the tangents do not span a plane, as at a pole.
///
/// Source: do Carmo, *Differential geometry of curves and surfaces*, §3.3.
pub fn curvature(jet: &SurfaceJet) -> Option<Curvature> {
    let n = jet.normal()?;
    let (ru, rv) = (jet.d[1], jet.d[2]);
    // In an orthonormal basis of the tangent plane the shape operator is a symmetric matrix: no cancellation between
    // the metric and the second form.
    let e1 = ru.normalize();
    let e2 = n.cross(e1);
    let (a, b, c) = (ru.dot(e1), rv.dot(e1), rv.dot(e2));
    let (l, m, k) = (n.dot(jet.d[3]), n.dot(jet.d[4]), n.dot(jet.d[5]));
    // e1 = r_u / a, e2 = (r_v - b e1) / c.
    let p = l / (a * a);
    let q = (m - b * a * p) / (a * c);
    let s = (k - b * b * p - 2.0 * b * c * q) / (c * c);
    let (mean, half) = (0.5 * (p + s), 0.5 * (p - s));
    let radius = half.hypot(q);
    let (k1, k2) = (mean + radius, mean - radius);
    let direction = if radius <= UMBILIC * (mean.abs() + radius) {
        e1
    } else {
        // Half the angle of (half, q), without cancellation.
        let angle = 0.5 * q.atan2(half);
        e1 * angle.cos() + e2 * angle.sin()
    };
    let found = Curvature {
        gaussian: p * s - q * q,
        mean,
        k1,
        k2,
        directions: [direction, n.cross(direction)],
    };
    (found.k1.is_finite() && found.k2.is_finite()).then_some(found)
}

/// `[K, H]` as Taylor polynomials, from a jet two orders higher.
fn gaussian_and_mean(jet: &[Box3], degree: usize) -> [Taylor; 2] {
    let vector = |d: [usize; 2]| Taylor::vector(jet, d, degree);
    let (u, v) = (vector([1, 0]), vector([0, 1]));
    let n = Taylor::cross(&u, &v);
    let square = Taylor::square(&n);
    // The second form times |n|.
    let [l, m, k] = [[2, 0], [1, 1], [0, 2]].map(|d| Taylor::dot(&n, &vector(d)));
    let (e, f, g) = (Taylor::square(&u), Taylor::dot(&u, &v), Taylor::square(&v));
    let two = Interval::point(2.0);
    let gaussian = l.mul(&k).sub(&m.sqr()).div(&square.sqr());
    let mean = e
        .mul(&k)
        .sub(&f.mul(&m).scale(two))
        .add(&g.mul(&l))
        .div(&square.mul(&square.sqrt()).scale(two));
    [gaussian, mean]
}

/// What is looked for over a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Gaussian,
    Mean,
    K1,
    K2,
}

impl Quantity {
    fn value(self, jet: &SurfaceJet) -> Option<f64> {
        let c = curvature(jet)?;
        Some(match self {
            Quantity::Gaussian => c.gaussian,
            Quantity::Mean => c.mean,
            Quantity::K1 => c.k1,
            Quantity::K2 => c.k2,
        })
    }

    fn enclose(self, jet: &[Box3], degree: usize) -> Taylor {
        let [k, h] = gaussian_and_mean(jet, degree);
        match self {
            Quantity::Gaussian => k,
            Quantity::Mean => h,
            Quantity::K1 => h.add(&h.sqr().sub(&k).sqrt()),
            Quantity::K2 => h.sub(&h.sqr().sub(&k).sqrt()),
        }
    }
}

/// The extremes of a surface's curvature. See [`Curvature`] for the signs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvatureExtremes {
    /// The least and greatest Gaussian curvature.
    pub gaussian: [Extreme; 2],
    /// The least and greatest mean curvature.
    pub mean: [Extreme; 2],
    /// The greatest of the larger principal curvature.
    pub k1: Extreme,
    /// The least of the smaller principal curvature.
    pub k2: Extreme,
    /// The smallest radius of curvature of any normal section, `1 / max(|k1|, |k2|)`; infinite for a plane. Its certainty
    /// is in `k1` and `k2`.
    pub smallest_radius: f64,
}

/// The extremes of the curvature over a surface with the places where they are; `None` if there is no place with a
/// normal. They are suprema: where curvature grows without bound nothing is proven and the result is an estimate.
///
/// Cost: branch and bound, limited by `options.budget` boxes for each of the six numbers.
pub fn curvature_extremes(
    surface: &dyn Surface,
    options: &SearchOptions,
) -> Option<CurvatureExtremes> {
    let max = |q: Quantity| {
        largest(
            surface,
            2,
            &|j| q.value(j),
            &|b, n| q.enclose(b, n),
            options,
        )
    };
    let min = |q: Quantity| {
        let minus = Interval::point(-1.0);
        let bound = |b: &[Box3], n: usize| q.enclose(b, n).scale(minus);
        let found = largest(surface, 2, &|j| Some(-q.value(j)?), &bound, options)?;
        Some(Extreme {
            value: -found.value,
            ..found
        })
    };
    let (k1, k2) = (max(Quantity::K1)?, min(Quantity::K2)?);
    Some(CurvatureExtremes {
        gaussian: [min(Quantity::Gaussian)?, max(Quantity::Gaussian)?],
        mean: [min(Quantity::Mean)?, max(Quantity::Mean)?],
        k1,
        k2,
        smallest_radius: 1.0 / k1.value.abs().max(k2.value.abs()),
    })
}
