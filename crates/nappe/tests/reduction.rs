//! Fewer knots and lower degrees: what comes back, and that no bound is violated.

#![allow(clippy::unwrap_used)]

use nappe::curve::{Curve, ExpressionCurve};
use nappe::exact::{
    ApproximationError, NurbsCurve, NurbsSurface, approximate_curve, approximate_surface,
};
use nappe::expr::Expr;
use nappe::mesh::Certainty;
use nappe::surface::{
    Dir, Quadric, QuadricOptions, QuadricShape, Revolution, RevolutionOptions, Surface,
};
use nappe::{DVec3, Frame};
use std::f64::consts::TAU;
use std::sync::Arc;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn curve(x: &str, y: &str, z: &str) -> ExpressionCurve {
    let bound = |s: &str| Expr::parse(s).unwrap().bind(&["t"], &[]).unwrap();
    ExpressionCurve::new([bound(x), bound(y), bound(z)], [0.0, 1.0]).unwrap()
}

fn error(c: Certainty) -> f64 {
    match c {
        Certainty::Exact => 0.0,
        Certainty::Bounded(e) => e,
        Certainty::Estimated(_) => panic!("{c:?}"),
    }
}

/// The largest distance at equal parameters that samples find.
fn apart(a: &dyn Curve, b: &dyn Curve) -> f64 {
    let d = a.domain();
    (0..=2000)
        .map(|k| d.lo + (d.hi - d.lo) * k as f64 / 2000.0)
        .map(|t| a.point(t).distance(b.point(t)))
        .fold(0.0, f64::max)
}

fn surfaces_apart(a: &dyn Surface, b: &dyn Surface) -> f64 {
    let d = a.domain();
    let n = 120;
    let at = |k: usize, i: usize| d[k].lo + (d[k].hi - d[k].lo) * i as f64 / n as f64;
    let places = (0..=n).flat_map(|i| (0..=n).map(move |j| [i, j]));
    places
        .map(|[i, j]| [at(0, i), at(1, j)])
        .map(|p| a.point(p).distance(b.point(p)))
        .fold(0.0, f64::max)
}

/// Pseudo-random numbers in [-1, 1].
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut x = seed;
    move || {
        x = x
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (x >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

fn knots(degree: usize, inner: &[f64]) -> Vec<f64> {
    let mut knots = vec![0.0; degree + 1];
    knots.extend(inner);
    knots.extend(vec![1.0; degree + 1]);
    knots
}

fn random_curve(seed: u64, rational: bool, far: f64, scale: f64) -> NurbsCurve {
    let inner = [0.2, 0.35, 0.5, 0.5, 0.5, 0.8];
    let mut next = noise(seed);
    let points: Vec<DVec3> = (0..inner.len() + 4)
        .map(|_| v(next() + far, next(), next() - far) * scale)
        .collect();
    let weights: Vec<f64> = points.iter().map(|_| 1.0 + 0.4 * next()).collect();
    let weights = rational.then_some(&weights[..]);
    NurbsCurve::new(3, knots(3, &inner), &points, weights).unwrap()
}

#[test]
fn inserted_knots_go_again() {
    for (seed, rational, far, scale) in [
        (1, false, 0.0, 1.0),
        (2, true, 0.0, 1.0),
        (3, false, 1e3, 1.0),
        (4, true, 10.0, 1e-6),
        (5, true, 0.0, 1e6),
    ] {
        let c = random_curve(seed, rational, far, scale);
        let size = scale * (1.0 + far);
        let more = c
            .refined(&[0.1, 0.1, 0.2, 0.4, 0.6, 0.61, 0.62, 0.9])
            .unwrap();
        let back = more.with_fewer_knots(1e-10 * size).unwrap();
        assert_eq!(back.nurbs.basis().knots(), c.basis().knots(), "{seed}");
        let e = error(back.certainty);
        assert!(
            apart(&c, &back.nurbs) <= e && e <= 1e-10 * size,
            "{seed}: {e:e}"
        );
        let points = back.nurbs.control_points();
        for (p, q) in points.iter().zip(c.control_points()) {
            assert!(p.distance(q) <= 1e-11 * size, "{seed}: {p} {q}");
        }
    }
}

#[test]
fn elevated_curves_come_back() {
    for (seed, rational) in [(1, false), (2, true), (3, false), (4, true)] {
        let c = random_curve(seed, rational, 1.0, 1.0);
        for degree in [4, 5, 6] {
            let back = c.elevated(degree).unwrap().with_lower_degree(3).unwrap();
            assert_eq!(back.nurbs.basis().knots(), c.basis().knots());
            let e = error(back.certainty);
            assert!(
                apart(&c, &back.nurbs) <= e && e < 1e-12,
                "{seed} {degree}: {e:e}"
            );
        }
    }
    let c = random_curve(7, false, 0.0, 1.0);
    for degree in [0, 4] {
        let found = c.with_lower_degree(degree);
        assert!(
            matches!(found, Err(ApproximationError::Degree { own: 3, .. })),
            "{found:?}"
        );
    }
    assert!(matches!(
        c.with_fewer_knots(f64::NAN),
        Err(ApproximationError::Tolerance { .. })
    ));
}

#[test]
fn bounds_of_lower_degrees_hold_and_are_not_far_off() {
    for (seed, rational) in [(1, false), (2, true), (3, true), (4, false)] {
        let c = random_curve(seed, rational, 0.0, 1.0);
        let low = c.with_lower_degree(2).unwrap();
        let (e, found) = (error(low.certainty), apart(&c, &low.nurbs));
        assert!(found <= e && e <= 20.0 * found, "{seed}: {e:e} {found:e}");
        // The crease at 1/2 and the ends stay.
        for t in [0.0, 0.5, 1.0] {
            assert!(c.point(t).distance(low.nurbs.point(t)) < 1e-12);
        }
    }
}

#[test]
fn approximations_need_few_knots() {
    let helix = curve("cos(2*pi*t)", "sin(2*pi*t)", "t");
    let corner = curve("t", "abs(t-0.4)", "sin(3*t)");
    for (name, c) in [("helix", &helix), ("corner", &corner)] {
        for tol in [1e-3, 1e-6, 1e-9] {
            let first = approximate_curve(c, 0.5 * tol).unwrap();
            let room = tol - error(first.certainty);
            let few = first.nurbs.with_fewer_knots(room).unwrap();
            let bound = error(first.certainty) + error(few.certainty);
            let found = apart(c, &few.nurbs);
            let (n, m) = (
                first.nurbs.control_points().len(),
                few.nurbs.control_points().len(),
            );
            println!("{name} {tol:e}: {n} -> {m} points, {found:e} of {bound:e}");
            assert!(
                found <= bound + 1e-15 && bound <= tol,
                "{name}: {found:e} {bound:e}"
            );
            assert!(m <= n);
            // Six data at each end of a piece; a smooth curve needs about one for a piece.
            assert!(n < 12 || 2 * m <= n + 12, "{name} {tol:e}: {n} {m}");
        }
    }
}

#[test]
fn surfaces_need_few_knots_and_keep_poles_and_corners() {
    let shape = QuadricShape::Ellipsoid;
    let axes = [1.0, 2.0, 3.0];
    let ellipsoid = Quadric::new(shape, &axes, QuadricOptions::default()).unwrap();
    let options = RevolutionOptions {
        angle: TAU,
        ..Default::default()
    };
    let profile = Arc::new(curve("sin(pi*t)", "0", "cos(pi*t)"));
    let sphere = Revolution::new(profile, Frame::WORLD, options).unwrap();
    for (name, s) in [
        ("ellipsoid", &ellipsoid as &dyn Surface),
        ("sphere", &sphere),
    ] {
        for tol in [1e-2, 1e-4] {
            let first = approximate_surface(s, 0.5 * tol).unwrap();
            let few = first
                .nurbs
                .with_fewer_knots(tol - error(first.certainty))
                .unwrap();
            let bound = error(first.certainty) + error(few.certainty);
            let found = surfaces_apart(s, &few.nurbs);
            let (n, m) = (first.nurbs.size(), few.nurbs.size());
            println!("{name} {tol:e}: {n:?} -> {m:?}, {found:e} of {bound:e}");
            assert!(
                found <= bound && bound <= tol,
                "{name}: {found:e} {bound:e}"
            );
            assert!(bound <= 100.0 * found, "{name}: {found:e} {bound:e}");
            assert!(
                n[0] * n[1] < 200 || 2 * m[0] * m[1] <= n[0] * n[1],
                "{name}: {n:?} {m:?}"
            );
        }
    }
    let few = approximate_surface(&sphere, 1e-3).unwrap();
    let few = few.nurbs.with_fewer_knots(1e-3).unwrap().nurbs;
    let [rows, columns] = few.size();
    let points = few.control_points();
    for row in [0, rows - 1] {
        let pole = points[row * columns];
        assert!((0..columns).all(|k| points[row * columns + k] == pole));
    }
}

#[test]
fn surfaces_come_back() {
    let mut next = noise(11);
    let (ku, kv) = (knots(3, &[0.3, 0.6]), knots(2, &[0.5, 0.5, 0.7]));
    let points: Vec<DVec3> = (0..36).map(|_| v(next(), next(), next())).collect();
    let weights: Vec<f64> = points.iter().map(|_| 1.0 + 0.3 * next()).collect();
    for weights in [None, Some(&weights[..])] {
        let s = NurbsSurface::new([3, 2], [ku.clone(), kv.clone()], &points, weights).unwrap();
        let more = s.refined(Dir::U, &[0.1, 0.3, 0.45]).unwrap();
        let more = more.refined(Dir::V, &[0.2, 0.6, 0.7]).unwrap();
        let back = more.with_fewer_knots(1e-10).unwrap();
        assert_eq!(back.nurbs.basis_u().knots(), ku);
        assert_eq!(back.nurbs.basis_v().knots(), kv);
        assert!(surfaces_apart(&s, &back.nurbs) <= error(back.certainty));
        let back = s
            .elevated([5, 4])
            .unwrap()
            .with_lower_degrees([3, 2])
            .unwrap();
        let e = error(back.certainty);
        assert!(surfaces_apart(&s, &back.nurbs) <= e && e < 1e-11, "{e:e}");
    }
}

#[test]
fn a_rational_side_that_is_one_point_stays_one() {
    // A pole far from the origin; weights differ along it.
    let pole = v(0.1, 700.3, -0.7);
    let kv = knots(3, &[0.25, 0.5, 0.75]);
    let n = kv.len() - 4;
    let mut next = noise(5);
    let mut points = vec![pole; n];
    points.extend((0..2 * n).map(|_| pole + v(next(), next(), next())));
    let line: Vec<f64> = (0..n).map(|_| 1.0 + 0.3 * next()).collect();
    let weights = [&line[..], &line, &line].concat();
    let s = NurbsSurface::new([2, 3], [knots(2, &[]), kv], &points, Some(&weights)).unwrap();
    let more = s.refined(Dir::V, &[0.1, 0.3, 0.6]).unwrap();
    let few = more.with_fewer_knots(1e-9).unwrap();
    let low = s.with_lower_degrees([2, 2]).unwrap();
    assert_eq!(few.nurbs.size(), [3, n]);
    for found in [few, low] {
        let columns = found.nurbs.size()[1];
        for p in &found.nurbs.control_points()[..columns] {
            // Products with weights, divided again.
            assert!(
                p.distance(pole) <= 4.0 * f64::EPSILON * pole.length(),
                "{p}"
            );
        }
        assert!(surfaces_apart(&s, &found.nurbs) <= error(found.certainty) + 1e-12);
    }
}

#[test]
fn what_cannot_go_is_given_back_exactly() {
    let mut next = noise(3);
    let points: Vec<DVec3> = (0..25).map(|_| v(next(), next(), next())).collect();
    let k = knots(3, &[0.4]);
    let s = NurbsSurface::new([3, 3], [k.clone(), k], &points, None).unwrap();
    for found in [s.with_fewer_knots(1e-9), s.with_lower_degrees([3, 3])] {
        let found = found.unwrap();
        assert_eq!(found.certainty, Certainty::Exact);
        assert_eq!(found.nurbs.control_points(), s.control_points());
        assert_eq!(found.nurbs.basis_u().knots(), s.basis_u().knots());
    }
}
