//! Curves through surfaces, surfaces through surfaces: closed forms.

#![allow(clippy::unwrap_used)]

use nappe::curve::{Ellipse, EllipseOptions, ExpressionCurve, Line};
use nappe::expr::Expr;
use nappe::laws::Random;
use nappe::measure::Implicit;
use nappe::query::{
    CurveSurface, Figure, FigureError, SurfaceField, TraceOptions, intersect, trace,
};
use nappe::surface::{
    Dir, Quadric, QuadricOptions, QuadricShape, SurfaceRef, Torus, TorusOptions, bilinear, ruled,
};
use nappe::{Certainty, Curve, DVec3, Surface};
use std::f64::consts::TAU;
use std::sync::Arc;

fn torus() -> Torus {
    Torus::new(3.0, 1.0, TorusOptions::default()).unwrap()
}

fn line(from: [f64; 3], to: [f64; 3]) -> Line {
    Line::new(DVec3::from(from), DVec3::from(to)).unwrap()
}

/// What every answer is held to; the number of different points in space.
fn distinct(curve: &dyn Curve, surface: &dyn Surface, found: &CurveSurface) -> usize {
    let mut points: Vec<DVec3> = Vec::new();
    for p in &found.points {
        let gap = curve.point(p.t).distance(surface.point(p.uv));
        assert!(gap < 1e-9 * (1.0 + p.point.length()), "{gap:e} {p:?}");
        assert!(p.zero.iter().all(|z| z.width() < 1e-8));
        if !points.iter().any(|q| q.distance(p.point) < 1e-6) {
            points.push(p.point);
        }
    }
    points.len()
}

#[test]
fn a_line_meets_a_torus_up_to_four_times() {
    let torus = torus();
    for (from, to, n) in [
        ([-5.0, 0.1, 0.2], [5.0, 0.3, 0.1], 4),
        ([-5.0, 2.4, 0.2], [5.0, 2.5, 0.1], 2),
        ([-5.0, 4.2, 0.2], [5.0, 4.3, 0.1], 0),
        ([0.1, 0.2, -5.0], [0.2, 0.1, 5.0], 0),
        ([3.1, 0.2, -5.0], [2.9, 0.1, 5.0], 2),
        // From the middle of the tube outwards: once.
        ([3.0, 0.1, 0.1], [9.0, 0.2, 0.3], 1),
    ] {
        let line = line(from, to);
        let found = intersect(&line, &torus, 100_000);
        assert!(found.undecided.is_empty(), "{from:?}");
        assert_eq!(distinct(&line, &torus, &found), n, "{from:?}: {found:?}");
    }
    // Along x through everything: on the seams, in the corners of patches.
    let axis = line([-5.0, 0.0, 0.0], [5.0, 0.0, 0.0]);
    let found = intersect(&axis, &torus, 100_000);
    assert_eq!(
        (distinct(&axis, &torus, &found), found.undecided.len()),
        (4, 0)
    );
    // Touching the outside.
    let tangent = line([4.0, -2.0, 0.0], [4.0, 2.5, 0.0]);
    let found = intersect(&tangent, &torus, 100_000);
    assert!(found.points.is_empty() && !found.undecided.is_empty());
    for b in &found.undecided {
        let t = 2.0 / 4.5;
        assert!(b[0].lo - 0.01 < t && t < b[0].hi + 0.01, "{b:?}");
    }
}

#[test]
fn random_lines_meet_a_torus_as_a_quartic_has_roots() {
    let torus = torus();
    let mut random = Random(3);
    let mut counts = [0; 5];
    for _ in 0..60 {
        let mut p = || {
            DVec3::new(
                random.unit() - 0.5,
                random.unit() - 0.5,
                0.5 * (random.unit() - 0.5),
            )
        };
        let (a, b) = (p() * 12.0, p() * 12.0);
        let d = (b - a).normalize();
        let line = Line::new(a - d * 20.0, a + d * 20.0).unwrap();
        let found = intersect(&line, &torus, 100_000);
        if !found.undecided.is_empty() {
            continue;
        }
        let f = |t: f64| {
            let p = line.point(t);
            let q = p.length_squared() + 8.0;
            q * q - 36.0 * (p.x * p.x + p.y * p.y)
        };
        let steps = 40_000;
        let signs: Vec<bool> = (0..=steps)
            .map(|k| f(f64::from(k) / f64::from(steps)) > 0.0)
            .collect();
        let roots = signs.windows(2).filter(|w| w[0] != w[1]).count();
        assert_eq!(distinct(&line, &torus, &found), roots, "{a} {b}");
        counts[roots] += 1;
    }
    assert!(
        counts[0] > 0 && counts[2] > 0 && counts[4] > 0,
        "{counts:?}"
    );
}

#[test]
fn a_circle_meets_a_plane_and_lines_meet_borders() {
    let corners = [[0.0, 1.0], [-1.0, 0.0]];
    let at = |i: usize, j: usize| DVec3::new(i as f64, j as f64, corners[i][j]);
    let plane = bilinear([[at(0, 0), at(0, 1)], [at(1, 0), at(1, 1)]]).unwrap();
    // z = y - x: the circle round its middle meets it twice.
    let circle = Ellipse::new(
        DVec3::new(0.5, 0.5, 0.0),
        [0.3, 0.3],
        EllipseOptions {
            from: 0.1,
            to: 0.1 + TAU,
            normal: DVec3::X,
            x_direction: None,
        },
    )
    .unwrap();
    let found = intersect(&circle, &plane, 100_000);
    assert_eq!(
        (distinct(&circle, &plane, &found), found.undecided.len()),
        (2, 0)
    );
    // Through a corner and through a side, from an end on it.
    for p in [
        DVec3::ZERO,
        DVec3::new(0.5, 0.0, -0.5),
        DVec3::new(0.3, 0.4, 0.1),
    ] {
        for end in [2.0, 0.0] {
            let l = Line::new(p + DVec3::Z * end, p - DVec3::Z * 3.0).unwrap();
            let found = intersect(&l, &plane, 100_000);
            assert_eq!(
                (distinct(&l, &plane, &found), found.undecided.len()),
                (1, 0),
                "{p} {end}"
            );
        }
    }
}

#[test]
fn surfaces_meet_spheres_cylinders_cones_and_tori() {
    let options = QuadricOptions::default();
    let sphere: SurfaceRef = Arc::new(Quadric::new(QuadricShape::Sphere, &[2.0], options).unwrap());
    let curves = |surface: &SurfaceRef, other: Implicit| {
        let field = SurfaceField::new(surface.clone(), Figure::Meets(other)).unwrap();
        let options = TraceOptions {
            surface: Some(surface.clone()),
            ..Default::default()
        };
        trace(&field, &options).unwrap()
    };
    let hold = |t: &nappe::query::Trace, off: &dyn Fn(DVec3) -> f64| {
        assert!(!t.branches.is_empty() && t.undecided.is_empty());
        for b in &t.branches {
            let Certainty::Bounded(e) = b.certainty else {
                panic!()
            };
            let c = b.curve();
            for k in 0..=200 {
                let p = c.point(f64::from(k) / 200.0);
                assert!(off(p).abs() <= e + 1e-12, "{p}: {} {e}", off(p));
            }
        }
    };
    // Two spheres: a circle in a plane. A sphere of the same radius at distance 2: z = 1 along the line of centres.
    let center = DVec3::new(0.0, 0.0, 2.0);
    let t = curves(
        &sphere,
        Implicit::Sphere {
            center,
            radius: 2.0,
        },
    );
    hold(&t, &|p| p.z - 1.0);
    // A cylinder through a sphere: two loops.
    let t = curves(
        &sphere,
        Implicit::Cylinder {
            point: DVec3::new(0.3, -0.2, 9.0),
            axis: DVec3::Z,
            radius: 0.7,
        },
    );
    hold(&t, &|p| (p - DVec3::new(0.3, -0.2, p.z)).length() - 0.7);
    // A point of the axis that is far away says the same.
    let axis = DVec3::new(1.0, 2.0, 3.0);
    let far = DVec3::new(0.1, 0.2, -0.1) + axis * 2e5;
    let t = curves(
        &sphere,
        Implicit::Cylinder {
            point: far,
            axis,
            radius: 0.7,
        },
    );
    assert!(t.branches.iter().all(|b| b.certainty.error() < 1e-5));
    hold(&t, &|p| {
        // Rounding of the far point is no error of the curve.
        let off = (p - far).cross(axis).length() / axis.length() - 0.7;
        off.signum() * (off.abs() - 1e-9).max(0.0)
    });
    let t = curves(
        &sphere,
        Implicit::Cone {
            apex: DVec3::ZERO,
            axis: DVec3::X,
            half_angle: 0.5,
        },
    );
    hold(&t, &|p| p.x.abs() - 2.0 * 0.5f64.cos());
    // A torus of the same tube: in the plane of symmetry.
    let shifted = Implicit::Torus {
        center: DVec3::Z * 1.2,
        axis: DVec3::Z,
        major: 3.0,
        minor: 1.0,
    };
    let tube: SurfaceRef = Arc::new(torus());
    let t = curves(&tube, shifted);
    hold(&t, &|p| p.z - 0.6);
    let error = SurfaceField::new(
        sphere,
        Figure::Meets(Implicit::Sphere {
            center,
            radius: -1.0,
        }),
    )
    .unwrap_err();
    assert!(matches!(error, FigureError::Size { .. }));
}

#[test]
fn jumps_of_the_curve_and_of_the_surface() {
    let curve = |z: &str| {
        let bound = |text: &str| Expr::parse(text).unwrap().bind(&["t"], &[]).unwrap();
        ExpressionCurve::new([bound("t"), bound("0.5"), bound(z)], [0.0, 1.0]).unwrap()
    };
    let square = |z: f64| {
        let at = |i: i32, j: i32| DVec3::new(f64::from(i), f64::from(j), z);
        bilinear([[at(0, 0), at(0, 1)], [at(1, 0), at(1, 1)]]).unwrap()
    };
    let near = |found: &CurveSurface, t: f64| {
        found.points.iter().any(|p| (p.t - t).abs() < 1e-9)
            || found.undecided.iter().any(|b| b[0].contains(t))
    };
    // A zero before the jump.
    let c = curve("if(t < 0.45, t - 0.3, t + 10)");
    let found = intersect(&c, &square(0.0), 100_000);
    assert_eq!(
        (distinct(&c, &square(0.0), &found), found.undecided.len()),
        (1, 0),
        "{found:?}"
    );
    assert!(near(&found, 0.3));
    // Over the jump, without a zero.
    let c = curve("t - 0.5 + if(t < 0.5, -0.005, 0.005)");
    let found = intersect(&c, &square(0.0), 100_000);
    assert!(found.points.is_empty(), "{found:?}");
    assert!(found.undecided.iter().all(|b| b[0].contains(0.5)));
    // A surface that is torn at x = 1/2: a line goes through the gap, or through a side of it.
    let rail = |y: &str| {
        let bound = |text: &str| Expr::parse(text).unwrap().bind(&["t"], &[]).unwrap();
        let z = "t + if(t < 0.5, -0.01, 0.01)";
        let c = ExpressionCurve::new([bound("t"), bound(y), bound(z)], [0.0, 1.0]).unwrap();
        Arc::new(c)
    };
    let torn = ruled(rail("0"), rail("1"), Dir::U).unwrap();
    let level = line([-1.0, 0.3, 0.5], [2.0, 0.4, 0.5]);
    let found = intersect(&level, &torn, 100_000);
    assert!(found.points.is_empty(), "{found:?}");
    let low = line([-1.0, 0.3, 0.4], [2.0, 0.4, 0.4]);
    let found = intersect(&low, &torn, 100_000);
    assert_eq!(distinct(&low, &torn, &found), 1, "{found:?}");
    assert!((found.points[0].point.x - 0.41).abs() < 1e-9);
}
