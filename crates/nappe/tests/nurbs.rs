//! NURBS curves and surfaces and the separable engine: the laws, closed forms, and exact conversion.

#![allow(clippy::unwrap_used)]

use nappe::basis::{BSplineBasis, Coordinates, One, Stack};
use nappe::curve::Curve;
use nappe::exact::{NurbsCurve, NurbsSurface};
use nappe::laws;
use nappe::surface::{Core, Separable, Surface, Term};
use nappe::{DVec3, DVec4};
use std::sync::Arc;

fn circle(radius: f64, centre: DVec3) -> NurbsCurve {
    let p =
        [(1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| centre + DVec3::new(x, y, 0.0) * radius);
    NurbsCurve::bezier(&p, Some(&[1.0, 0.5f64.sqrt(), 1.0])).unwrap()
}

fn spline(scale: f64, shift: DVec3) -> NurbsCurve {
    let mut random = laws::Random(3);
    let points: Vec<_> = (0..9)
        .map(|i| shift + DVec3::new(i as f64, random.unit(), random.unit()) * scale)
        .collect();
    let weights: Vec<_> = (0..9).map(|_| 0.5 + random.unit()).collect();
    NurbsCurve::new(
        3,
        BSplineBasis::clamped_uniform(3, 9),
        &points,
        Some(&weights),
    )
    .unwrap()
}

#[test]
fn laws_of_curves_at_all_scales() {
    for scale in [1e-6, 1.0, 1e6] {
        for shift in [DVec3::ZERO, DVec3::new(1e3, -2e3, 5e2) * scale] {
            laws::curve(&circle(scale, shift));
            laws::curve(&spline(scale, shift));
        }
    }
}

#[test]
fn a_rational_quadratic_is_a_circle() {
    let c = circle(2.0, DVec3::new(5.0, 0.0, 1.0));
    for i in 0..=100 {
        let p = c.point(i as f64 / 100.0) - DVec3::new(5.0, 0.0, 1.0);
        assert!((p.length() - 2.0).abs() < 1e-15 * 8.0);
    }
}

#[test]
fn a_ruled_surface_between_rational_curves_converts_exactly() {
    let (a, b) = (
        Arc::new(circle(1.0, DVec3::ZERO)),
        Arc::new(spline(1.0, DVec3::new(0.0, 0.0, 2.0))),
    );
    let rails = Stack::new(vec![
        Arc::new(Coordinates::new(a, DVec3::ZERO)),
        Arc::new(Coordinates::new(b, DVec3::ZERO)),
        Arc::new(One),
    ]);
    let e = [DVec4::X, DVec4::Y, DVec4::Z];
    let terms = (0..6).map(|k| Term::new(k, k / 3, e[k % 3])).collect();
    let ruled = Separable::polynomial(
        Arc::new(rails),
        Arc::new(BSplineBasis::bernstein(1)),
        Core::Terms(terms),
        DVec3::new(1.0, 2.0, 3.0),
    );
    laws::surface(&ruled);
    let nurbs = ruled.to_nurbs().unwrap();
    assert_eq!([nurbs.basis_u().degree(), nurbs.basis_v().degree()], [5, 1]);
    laws::surface(&nurbs);
}

#[test]
fn laws_of_surfaces_at_all_scales() {
    let mut random = laws::Random(5);
    for scale in [1e-6, 1.0, 1e6] {
        for shift in [DVec3::ZERO, DVec3::new(1e3, -2e3, 5e2) * scale] {
            let points: Vec<_> = (0..42)
                .map(|i| {
                    let (x, y) = ((i / 6) as f64, (i % 6) as f64);
                    shift + DVec3::new(x, y, random.unit()) * scale
                })
                .collect();
            let weights: Vec<_> = (0..42).map(|_| 0.5 + random.unit()).collect();
            let knots = [
                BSplineBasis::clamped_uniform(3, 7),
                vec![0.0, 0.0, 0.0, 1.0, 1.0, 3.0, 4.0, 4.0, 4.0],
            ];
            for w in [None, Some(&weights[..])] {
                laws::surface(&NurbsSurface::new([3, 2], knots.clone(), &points, w).unwrap());
            }
        }
    }
}
