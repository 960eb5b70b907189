//! Nearest points of curves.

use crate::within;
use nappe::DVec3;
use nappe::curve::{CurveRef, Ellipse, ExpressionCurve, Line, Spacing, polyline};
use nappe::exact::NurbsCurve;
use nappe::expr::Expr;
use nappe::laws::Random;
use nappe::query::{Finder, FinderOptions, QueryError};
use std::sync::Arc;

fn finder(curves: &[CurveRef], tol: f64) -> Finder {
    let options = FinderOptions {
        tol: Some(tol),
        ..FinderOptions::default()
    };
    Finder::on_curves(curves, options).unwrap()
}

fn circle() -> CurveRef {
    Arc::new(Ellipse::circle(DVec3::ZERO, 2.0, DVec3::Z).unwrap())
}

/// A wild spline.
fn rough(degree: usize, points: usize, weights: bool) -> CurveRef {
    let mut random = Random(5);
    let net: Vec<DVec3> = (0..points).map(|_| within(&mut random, 2.0)).collect();
    let weights: Option<Vec<f64>> =
        weights.then(|| net.iter().map(|_| 0.5 + random.unit()).collect());
    let knots = nappe::basis::BSplineBasis::clamped_uniform(degree, points);
    Arc::new(NurbsCurve::new(degree, knots, &net, weights.as_deref()).unwrap())
}

#[test]
fn circles_and_lines_are_as_far_as_the_closed_forms_say() {
    let mut random = Random(41);
    let (a, b) = (DVec3::new(-1.0, 0.5, 2.0), DVec3::new(2.0, 1.0, -1.0));
    let line: CurveRef = Arc::new(Line::new(a, b).unwrap());
    let (round, straight) = (
        finder(&[circle()], 1e-9),
        finder(std::slice::from_ref(&line), 1e-9),
    );
    for _ in 0..2000 {
        let p = within(&mut random, 5.0);
        let found = round.nearest(p).unwrap();
        let exact = (p.truncate().length() - 2.0).hypot(p.z);
        assert!((found.distance - exact).abs() <= 1e-9, "{p}: {found:?}");
        assert!(found.certainty.error() <= 1e-9 && found.uv[1] == 0.0);
        let found = straight.nearest(p).unwrap();
        let s = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        assert!(
            (found.distance - p.distance(a + (b - a) * s)).abs() <= 1e-9,
            "{p}"
        );
        assert!(line.point(found.uv[0]).distance(found.point) <= 1e-14);
    }
}

#[test]
fn no_sample_of_a_rough_curve_is_nearer() {
    let mut random = Random(42);
    for curve in [rough(3, 9, false), rough(2, 6, true), rough(6, 12, false)] {
        let finder = finder(std::slice::from_ref(&curve), 1e-9);
        let domain = curve.domain();
        for _ in 0..200 {
            let p = within(&mut random, 3.0);
            let found = finder.nearest(p).unwrap();
            assert!(found.certainty.error() <= 1e-9, "{p}");
            let samples = (0..=4000).map(|k| domain.lo + domain.width() * f64::from(k) / 4000.0);
            let best = samples
                .map(|t| curve.point(t).distance(p))
                .fold(f64::INFINITY, f64::min);
            assert!(best >= found.distance - found.certainty.error(), "{p}");
            // The best of the samples is at most half a step away from the nearest place.
            assert!(found.distance >= best - 0.01, "{p}");
        }
    }
}

#[test]
fn corners_ends_and_several_curves() {
    let points = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y];
    let corner: CurveRef = Arc::new(polyline(&points, Spacing::Uniform).unwrap());
    let far: CurveRef = Arc::new(Line::new(DVec3::Z * 5.0, DVec3::Z * 6.0).unwrap());
    let finder = finder(&[corner, far], 1e-10);
    for (p, curve, exact) in [
        (DVec3::new(2.0, -1.0, 0.0), 0, DVec3::X),
        (DVec3::new(-1.0, 0.2, 0.0), 0, DVec3::ZERO),
        (DVec3::new(0.9, 0.5, 0.1), 0, DVec3::new(1.0, 0.5, 0.0)),
        (DVec3::new(0.3, 0.0, 9.0), 1, DVec3::Z * 6.0),
    ] {
        let found = finder.nearest(p).unwrap();
        assert_eq!(found.surface, curve);
        assert!(found.point.distance(exact) < 1e-9, "{p}: {found:?}");
    }
    assert!(matches!(
        Finder::on_curves(&[], FinderOptions::default()),
        Err(QueryError::NoCurve)
    ));
}

#[test]
fn all_nearest_points_of_curves() {
    let ellipse = Ellipse::new(DVec3::ZERO, [3.0, 1.0], Default::default()).unwrap();
    let loci = finder(&[Arc::new(ellipse)], 1e-9)
        .all_nearest(DVec3::ZERO, 1e-7)
        .unwrap();
    assert_eq!(loci.len(), 2, "{loci:#?}");
    assert!(
        loci.iter()
            .all(|l| l.isolated && (l.nearest.distance - 1.0).abs() < 1e-7)
    );
    let loci = finder(&[circle()], 1e-9)
        .all_nearest(DVec3::Z, 1e-7)
        .unwrap();
    assert!(loci.len() == 1 && !loci[0].isolated, "{loci:?}");
    assert!(loci[0].hull.diagonal() > 5.6);
}

/// The enclosure of the whole denominator contains 0, though the curve is finite: no box around it is known beforehand.
#[test]
fn the_tolerance_needs_no_box_around_the_whole() {
    let of = |text: &str| Expr::parse(text).unwrap().bind(&["t"], &[]).unwrap();
    let all = [of("1/(t*t - t + 0.3)"), of("t"), of("0")];
    let hump: CurveRef = Arc::new(ExpressionCurve::new(all, [0.0, 1.0]).unwrap());
    let tiny: CurveRef = Arc::new(Line::new(DVec3::ZERO, DVec3::X * 1e-9).unwrap());
    // From (10/3, 0) to (20, 1/2) and to (10/3, 1).
    for curves in [vec![hump.clone()], vec![tiny, hump.clone()]] {
        let finder = Finder::on_curves(&curves, FinderOptions::default()).unwrap();
        assert!(
            finder.tol() > 1e-8 && finder.tol() < 1e-6,
            "{}",
            finder.tol()
        );
        let p = DVec3::new(25.0, 0.5, 0.0);
        let found = finder.nearest(p).unwrap();
        assert!((found.distance - 5.0).abs() < 1e-6 && found.certainty.error() <= finder.tol());
        let loci = finder.all_nearest(p, finder.tol()).unwrap();
        assert!(loci.len() == 1 && loci[0].isolated, "{loci:?}");
    }
}
