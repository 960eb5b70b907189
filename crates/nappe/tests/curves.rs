//! Curve kinds: the laws at all scales, closed forms, and degenerate input.

#![allow(clippy::unwrap_used)]

use nappe::curve::{
    Curve, CurveError, CurveRef, Ellipse, EllipseOptions, Hermite, Line, Spacing, Transformed,
    conic, polyline,
};
use nappe::exact::NurbsError;
use nappe::{DAffine3, DMat3, DVec3, Interval, Limit, laws};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

/// The model scales, each at the origin and a thousand sizes away from it.
fn places() -> Vec<(f64, DVec3)> {
    let far = DVec3::new(1e3, -2e3, 5e2);
    [1e-6, 1.0, 1e6]
        .into_iter()
        .flat_map(|s| [(s, DVec3::ZERO), (s, far * s)])
        .collect()
}

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn hermite(s: f64, o: DVec3) -> Hermite {
    Hermite::new(
        o,
        o + v(1.0, 2.0, 0.5) * s,
        v(3.0, 0.0, 0.0) * s,
        v(0.0, -2.0, 1.0) * s,
    )
    .unwrap()
}

fn ellipse(s: f64, o: DVec3) -> Ellipse {
    let options = EllipseOptions {
        from: -0.4,
        to: 4.0,
        normal: v(1.0, 2.0, 3.0),
        x_direction: Some(DVec3::X),
    };
    Ellipse::new(o, [2.0 * s, 0.5 * s], options).unwrap()
}

fn zigzag(s: f64, o: DVec3) -> Vec<DVec3> {
    let mut random = laws::Random(9);
    (0..7)
        .map(|i| o + v(i as f64, random.unit(), random.unit()) * s)
        .collect()
}

#[test]
fn laws_hold_at_all_scales() {
    for (s, o) in places() {
        laws::curve(&Line::new(o, o + v(1.0, 2.0, 3.0) * s).unwrap());
        laws::curve(&hermite(s, o));
        laws::curve(&ellipse(s, o));
        laws::curve(&Ellipse::circle(o, s, DVec3::Z).unwrap());
        laws::curve(&conic([o, o + DVec3::X * s, o + v(1.0, 1.0, 1.0) * s], 0.7).unwrap());
        for spacing in [Spacing::Chord, Spacing::Centripetal, Spacing::Uniform] {
            laws::curve(&polyline(&zigzag(s, o), spacing).unwrap());
        }
        let map = DAffine3::from_mat3_translation(
            DMat3::from_cols(v(1.0, 0.3, 0.0), v(0.0, -2.0, 0.1), v(0.5, 0.0, 1.0)),
            o,
        );
        laws::curve(&Transformed::new(Arc::new(ellipse(s, o)), map).unwrap());
        laws::curve(
            &Transformed::new(
                Arc::new(conic([o, o + v(s, 0.0, s), o + v(s, s, 0.0)], 2.0).unwrap()),
                map,
            )
            .unwrap(),
        );
    }
}

#[test]
fn many_random_parts_are_enclosed() {
    let (s, o) = (1.0, v(10.0, 20.0, -5.0));
    laws::curve_with(&Line::new(o, o + v(1.0, 2.0, 3.0)).unwrap(), 100_000);
    laws::curve_with(&hermite(s, o), 100_000);
    laws::curve_with(&ellipse(s, o), 100_000);
    laws::curve_with(&polyline(&zigzag(s, o), Spacing::Chord).unwrap(), 100_000);
}

#[test]
fn ends_are_exactly_the_given_points() {
    let (a, b) = (v(0.1, 1e6 + 0.3, -7e-7), v(1.0 / 3.0, -1e-3, 1e6));
    assert_eq!(Line::new(a, b).unwrap().ends(), [a, b]);
    let h = Hermite::new(a, b, v(0.1, 0.2, 0.3), v(-1e3, 7.0, 0.0)).unwrap();
    assert_eq!(h.ends(), [a, b]);
    let jet = |t| h.jet(t, Limit::Above, 1).d[1];
    assert_eq!([jet(0.0), jet(1.0)], [v(0.1, 0.2, 0.3), v(-1e3, 7.0, 0.0)]);
}

#[test]
fn a_collapsed_line_is_legal() {
    let l = Line::new(DVec3::ONE, DVec3::ONE).unwrap();
    laws::curve(&l);
    assert_eq!(
        l.jet(0.3, Limit::Above, 2).d[..],
        [DVec3::ONE, DVec3::ZERO, DVec3::ZERO]
    );
}

#[test]
fn the_parameter_of_an_arc_is_its_angle() {
    let c = v(3.0, 4.0, 5.0);
    let arc = Ellipse::arc(c, 2.0, FRAC_PI_2, PI, DVec3::Z).unwrap();
    for i in 0..=90 {
        let t = i as f64 / 90.0;
        let angle = FRAC_PI_2 * (1.0 + t);
        let want = c + v(angle.cos(), angle.sin(), 0.0) * 2.0;
        assert!((arc.point(t) - want).length() < 4e-15);
        let curvature = arc.jet(t, Limit::Above, 2).curvature().unwrap();
        assert!((curvature - 0.5).abs() < 1e-14);
    }
    assert_eq!(arc.ends(), [c + v(0.0, 2.0, 0.0), c - v(2.0, 0.0, 0.0)]);
}

#[test]
fn a_circle_closes_exactly() {
    for (s, o) in places() {
        let c = Ellipse::circle(o, s, v(1.0, -2.0, 0.3)).unwrap();
        assert_eq!(c.ends()[0], c.ends()[1]);
        let [a, b] = c.to_rational().unwrap().ends();
        assert!((a - b).length() <= 1e-15 * o.length());
    }
}

#[test]
fn the_rational_form_is_the_same_set_of_points_in_the_same_direction() {
    for (from, to) in [(0.0, TAU), (0.3, 0.5), (2.0, -1.7), (-5.0, 1.0), (0.0, PI)] {
        let o = v(1.0, -2.0, 3.0);
        let options = EllipseOptions {
            from,
            to,
            normal: v(0.2, 0.3, 1.0),
            ..Default::default()
        };
        let e = Ellipse::new(o, [3.0, 0.25], options).unwrap();
        let r = e.to_rational().unwrap();
        let [a, b] = e.axes();
        let mut before = from;
        for i in 0..=200 {
            let p = r.point(i as f64 / 200.0) - o;
            let (x, y) = (p.dot(a) / a.length_squared(), p.dot(b) / b.length_squared());
            assert!((x * x + y * y - 1.0).abs() < 1e-14, "on the ellipse");
            assert!(p.cross(a.cross(b)).length() > 0.0 && p.dot(a.cross(b)).abs() < 1e-14);
            let step = (y.atan2(x) - before + PI).rem_euclid(TAU) - PI;
            assert!(
                i == 0 || step * (to - from) > 0.0,
                "runs on from {before} by {step}"
            );
            before += step;
        }
        assert!((before - to).abs() < 1e-13);
        for (p, q) in e.ends().iter().zip(r.ends()) {
            assert!((*p - q).length() < 1e-14);
        }
    }
}

#[test]
fn an_arc_passes_through_its_points() {
    let mut random = laws::Random(4);
    for (s, o) in places() {
        for _ in 0..50 {
            let mut p = || o + v(random.unit(), random.unit(), random.unit()) * s;
            let points = [p(), p(), p()];
            let arc = Ellipse::through(points).unwrap();
            let radius = arc.axes()[0].length();
            let tol = 1e-13 * (radius + o.length());
            let ends = arc.ends();
            assert!((ends[0] - points[0]).length() < tol && (ends[1] - points[2]).length() < tol);
            // The second point lies on the arc, not on the rest of the circle.
            let d = points[1] - arc.center();
            let [a, b] = arc.axes();
            let t = d.dot(b).atan2(d.dot(a)).rem_euclid(TAU) / arc.angles()[1];
            assert!(t < 1.0 && (arc.point(t) - points[1]).length() < tol);
        }
    }
}

#[test]
fn conics_have_their_equation() {
    for (w, mu) in [(0.5f64.sqrt(), 0.5), (1.0, 1.0), (3.0, 9.0)] {
        let c = conic([DVec3::X, v(1.0, 1.0, 0.0), DVec3::Y], w).unwrap();
        for i in 0..=50 {
            let DVec3 { x, y, .. } = c.point(i as f64 / 50.0);
            assert!(((x + y - 1.0).powi(2) - 4.0 * mu * (1.0 - x) * (1.0 - y)).abs() < 1e-14 * mu);
        }
    }
}

#[test]
fn a_polyline_by_chords_has_even_speed_and_ignores_points_on_a_line() {
    let p = [v(0.0, 0.0, 0.0), v(3.0, 0.0, 0.0), v(3.0, 1.0, 0.0)];
    let more = [p[0], v(1.0, 0.0, 0.0), p[1], v(3.0, 0.25, 0.0), p[2]];
    let a = polyline(&p, Spacing::Chord).unwrap();
    let b = polyline(&more, Spacing::Chord).unwrap();
    assert_eq!(a.breaks()[1].at, 0.75);
    for i in 0..=40 {
        let t = i as f64 / 40.0;
        assert!((a.point(t) - b.point(t)).length() < 1e-15 * 4.0);
        assert!((a.jet(t, Limit::Above, 1).d[1].length() - 4.0).abs() < 1e-13);
    }
    let u = polyline(&p, Spacing::Uniform).unwrap();
    assert_eq!(u.point(0.5), p[1]);
    assert_eq!(u.breaks()[1].smooth, 0);
}

#[test]
fn maps_commute_with_evaluation_also_mirrored() {
    let map = DAffine3::from_scale(v(1.0, -1.0, 1.0)) * DAffine3::from_rotation_x(0.3);
    let e: CurveRef = Arc::new(ellipse(1.0, DVec3::ONE));
    let m = Transformed::new(e.clone(), map).unwrap();
    for i in 0..=20 {
        let t = i as f64 / 20.0;
        assert_eq!(m.point(t), map.transform_point3(e.point(t)));
        let r = m.to_rational().unwrap().point(t);
        let back = map.inverse().transform_point3(r);
        assert!((back - e.to_rational().unwrap().point(t)).length() < 1e-14);
    }
    let flat = DAffine3::from_scale(v(1.0, 1.0, 0.0));
    laws::curve(&Transformed::new(e, flat).unwrap());
}

#[test]
fn bad_data_is_named() {
    let nan = v(0.0, f64::NAN, 0.0);
    assert!(matches!(
        Line::new(DVec3::ZERO, nan),
        Err(CurveError::VectorNotFinite {
            what: "the end of the line",
            ..
        })
    ));
    assert!(Hermite::new(DVec3::ZERO, DVec3::X, DVec3::X * f64::INFINITY, DVec3::X).is_err());
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Ellipse::circle(DVec3::ZERO, radius, DVec3::Z).is_err());
    }
    let circle = |n| Ellipse::circle(DVec3::ZERO, 1.0, n);
    assert!(matches!(circle(DVec3::ZERO), Err(CurveError::Plane(_))));
    let arc = |a, b| Ellipse::arc(DVec3::ZERO, 1.0, a, b, DVec3::Z);
    assert!(matches!(arc(1.0, 1.0), Err(CurveError::Turn { .. })));
    assert!(matches!(arc(0.0, 6.3), Err(CurveError::Turn { .. })));
    assert!(arc(0.0, f64::NAN).is_err());
    let line = [DVec3::ZERO, DVec3::X, DVec3::X * 2.5];
    assert!(matches!(
        Ellipse::through(line),
        Err(CurveError::Collinear { .. })
    ));
    let twice = [DVec3::ZERO, DVec3::X, DVec3::ZERO];
    assert!(matches!(
        Ellipse::through(twice),
        Err(CurveError::Coincident {
            first: 0,
            second: 2,
            ..
        })
    ));
    assert!(matches!(
        polyline(&[DVec3::ZERO, DVec3::X, DVec3::X], Spacing::Chord),
        Err(CurveError::Coincident {
            first: 1,
            second: 2,
            ..
        })
    ));
    assert!(matches!(
        polyline(&[DVec3::ZERO, nan], Spacing::Uniform),
        Err(CurveError::Nurbs(NurbsError::PointNotFinite {
            index: 1,
            ..
        }))
    ));
    assert!(matches!(
        polyline(&[DVec3::ZERO], Spacing::Uniform),
        Err(CurveError::TooFewPoints {
            given: 1,
            needed: 2
        })
    ));
    assert!(matches!(
        conic([DVec3::ZERO, DVec3::X, DVec3::Y], -1.0),
        Err(CurveError::Nurbs(NurbsError::Weight { index: 1, .. }))
    ));
    assert!(Transformed::new(Arc::new(circle(DVec3::Z).unwrap()), DAffine3::NAN).is_err());
    let whole = circle(DVec3::Z).unwrap().bounds(Interval::UNIT);
    assert!(whole.x.encloses(Interval::new(-1.0, 1.0)) && whole.x.width() < 2.0 + 1e-12);
}
