//! Nearest points: one, all of them, with a sign, and on curves.

#![allow(clippy::unwrap_used)]

mod all;
mod curves;
mod million;
mod nearest;
mod polynomials;
mod side;

use nappe::DVec3;
use nappe::exact::NurbsSurface;
use nappe::laws::Random;
use nappe::query::{Finder, FinderOptions, Nearest};
use nappe::surface::{
    Quadric, QuadricOptions, QuadricShape, SurfaceRef, Torus, TorusOptions, bilinear,
};
use std::sync::Arc;

pub(crate) fn finder(surfaces: &[SurfaceRef], tol: f64) -> Finder {
    let options = FinderOptions {
        tol: Some(tol),
        ..FinderOptions::default()
    };
    Finder::new(surfaces, options).unwrap()
}

pub(crate) fn sphere(radius: f64) -> SurfaceRef {
    let options = QuadricOptions::default();
    Arc::new(Quadric::new(QuadricShape::Sphere, &[radius], options).unwrap())
}

pub(crate) fn torus() -> SurfaceRef {
    Arc::new(Torus::new(3.0, 1.0, TorusOptions::default()).unwrap())
}

/// A net of heights and shifts.
pub(crate) fn rough(degree: usize, points: usize, weights: bool) -> SurfaceRef {
    let mut random = Random(12);
    let net: Vec<DVec3> = (0..points * points)
        .map(|k| {
            let [x, y] = [k / points, k % points].map(|i| i as f64);
            let mut shift = || 0.6 * random.unit();
            DVec3::new(x + shift(), y + shift(), 3.0 * shift())
        })
        .collect();
    let weights: Option<Vec<f64>> =
        weights.then(|| net.iter().map(|_| 0.5 + random.unit()).collect());
    let knots = nappe::basis::BSplineBasis::clamped_uniform(degree, points);
    let knots = [knots.clone(), knots];
    Arc::new(NurbsSurface::new([degree; 2], knots, &net, weights.as_deref()).unwrap())
}

/// A point in a box around the origin.
pub(crate) fn within(random: &mut Random, size: f64) -> DVec3 {
    let mut number = || size * (2.0 * random.unit() - 1.0);
    DVec3::new(number(), number(), number())
}

/// What every answer is held to.
pub(crate) fn check(surfaces: &[SurfaceRef], p: DVec3, found: &Nearest, tol: f64) {
    let point = surfaces[found.surface].point(found.uv);
    assert!(point.distance(found.point) <= 1e-12 * (1.0 + p.length()));
    assert!((found.distance - p.distance(found.point)).abs() <= 1e-12 * (1.0 + p.length()));
    let error = found.certainty.error();
    assert!(error <= tol, "{p}: {error} of {tol}");
}

/// A flat piece, with corners P00, P01, P10 and P11.
pub(crate) fn flat(corners: [[DVec3; 2]; 2]) -> SurfaceRef {
    Arc::new(bilinear(corners).unwrap())
}

/// The six faces of the cube from -1 to 1, every other one with its normal inwards.
pub(crate) fn cube() -> Vec<SurfaceRef> {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    (0..6)
        .map(|k| {
            let [a, b, c] = [0, 1, 2].map(|i| axes[(k / 2 + i) % 3]);
            let n = if k % 2 == 0 { c } else { -c };
            flat([[n - a - b, n - a + b], [n + a - b, n + a + b]])
        })
        .collect()
}
