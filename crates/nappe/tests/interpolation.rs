//! Curves through points: they pass through them, are as smooth as they say, and reproduce polynomials.

#![allow(clippy::unwrap_used)]

use nappe::curve::{Curve, CurveError, InterpolateOptions, Spacing, interpolate};
use nappe::{DVec3, Limit, laws};
use proptest::prelude::*;
use std::f64::consts::TAU;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn options(degree: usize, closed: bool) -> InterpolateOptions {
    InterpolateOptions {
        degree,
        closed,
        ..Default::default()
    }
}

fn cloud(n: usize, s: f64, o: DVec3) -> Vec<DVec3> {
    let mut random = laws::Random(n as u64);
    (0..n)
        .map(|i| {
            let a = TAU * i as f64 / n as f64;
            o + v(a.cos() + 0.3 * random.unit(), a.sin(), random.unit()) * s
        })
        .collect()
}

#[test]
fn laws_and_points_at_all_scales() {
    for s in [1e-6, 1.0, 1e6] {
        for o in [DVec3::ZERO, v(1e3, -2e3, 5e2) * s] {
            let points = cloud(12, s, o);
            for degree in 2..=5 {
                for closed in [false, true] {
                    let spacing = [Spacing::Chord, Spacing::Centripetal][degree % 2];
                    let c = interpolate(
                        &points,
                        InterpolateOptions {
                            spacing,
                            ..options(degree, closed)
                        },
                    )
                    .unwrap();
                    laws::curve(&c);
                    let at = spacing.parameters(&points, closed).unwrap();
                    for (p, t) in points.iter().zip(&at) {
                        assert!((c.point(*t) - *p).length() < 1e-13 * (s + o.length()));
                    }
                    let [a, b] = c.ends();
                    let last = if closed { points[0] } else { points[11] };
                    assert!(
                        (a - points[0]).length() + (b - last).length() <= 1e-15 * (s + o.length())
                    );
                    let smooth = c.breaks()[1..c.breaks().len() - 1].iter();
                    assert!(smooth.clone().all(|b| b.smooth == degree as i32 - 1));
                }
            }
        }
    }
}

#[test]
fn closed_curves_close_smoothly() {
    let points = cloud(9, 1.0, DVec3::ZERO);
    for degree in 2..=5 {
        let c = interpolate(&points, options(degree, true)).unwrap();
        let (a, b) = (
            c.jet(0.0, Limit::Above, degree - 1),
            c.jet(1.0, Limit::Below, degree - 1),
        );
        for k in 0..degree {
            assert!(
                (a.d[k] - b.d[k]).length() < 1e-9 * (1.0 + a.d[k].length()),
                "{degree} {k}"
            );
        }
        // The first point repeated at the end changes nothing.
        let mut more = points.clone();
        more.push(points[0]);
        assert_eq!(interpolate(&more, options(degree, true)).unwrap(), c);
    }
}

#[test]
fn a_natural_spline_has_no_curvature_at_its_ends() {
    let c = interpolate(&cloud(8, 1.0, DVec3::ZERO), options(3, false)).unwrap();
    for (t, limit) in [(0.0, Limit::Above), (1.0, Limit::Below)] {
        assert!(c.jet(t, limit, 2).d[2].length() < 1e-10);
    }
    let two = interpolate(&[DVec3::ZERO, DVec3::ONE], options(3, false)).unwrap();
    assert!((two.point(0.25) - DVec3::splat(0.25)).length() < 1e-15);
}

/// A polynomial of the degree, sampled at the parameters, is found again.
#[test]
fn polynomials_are_reproduced() {
    for degree in 2..=5usize {
        let f = |t: f64| v(t, t.powi(degree as i32) - t * t, 1.0 - 2.0 * t.powi(2));
        let slope = |t: f64| {
            let n = degree as f64;
            v(1.0, n * t.powi(degree as i32 - 1) - 2.0 * t, -4.0 * t)
        };
        let points: Vec<_> = (0..=8).map(|i| f(i as f64 / 8.0)).collect();
        let c = interpolate(
            &points,
            InterpolateOptions {
                spacing: Spacing::Uniform,
                start_tangent: Some(slope(0.0)),
                end_tangent: Some(slope(1.0)),
                ..options(degree, false)
            },
        )
        .unwrap();
        for i in 0..=50 {
            let t = i as f64 / 50.0;
            let jet = c.jet(t, Limit::Above, 1);
            assert!((jet.d[0] - f(t)).length() < 1e-13, "{degree} at {t}");
            assert!((jet.d[1] - slope(t)).length() < 1e-11);
        }
    }
}

/// A closed cubic through n points of a circle deviates by O(n⁻⁴).
#[test]
fn circles_are_approached_at_fourth_order() {
    let error = |n: usize| {
        let points: Vec<_> = (0..n)
            .map(|i| TAU * i as f64 / n as f64)
            .map(|a| v(a.cos(), a.sin(), 0.0))
            .collect();
        let c = interpolate(&points, options(3, true)).unwrap();
        (0..1000)
            .map(|i| (c.point(i as f64 / 1000.0).length() - 1.0).abs())
            .fold(0.0, f64::max)
    };
    let ratio = error(16) / error(32);
    assert!((13.0..19.0).contains(&ratio), "{ratio}");
}

#[test]
fn many_points_are_quick() {
    let n = 20_000;
    let points: Vec<_> = (0..n)
        .map(|i| i as f64 / n as f64 * 30.0)
        .map(|a| v(a.cos(), a.sin(), a))
        .collect();
    for closed in [false, true] {
        let c = interpolate(&points, options(3, closed)).unwrap();
        assert!((c.point(0.0) - points[0]).length() < 1e-13);
    }
}

#[test]
fn bad_data_is_named() {
    let p = cloud(5, 1.0, DVec3::ZERO);
    let run = |p: &[DVec3], o| interpolate(p, o).unwrap_err();
    assert!(matches!(
        run(&p, options(1, false)),
        CurveError::Degree { degree: 1, .. }
    ));
    assert!(matches!(
        run(&p, options(6, false)),
        CurveError::Degree { degree: 6, .. }
    ));
    assert!(matches!(
        run(&p[..1], options(3, false)),
        CurveError::TooFewPoints {
            given: 1,
            needed: 2
        }
    ));
    assert!(matches!(
        run(&p, options(5, false)),
        CurveError::TooFewPoints {
            given: 5,
            needed: 6
        }
    ));
    assert!(matches!(
        run(&p[..2], options(3, true)),
        CurveError::TooFewPoints {
            given: 2,
            needed: 3
        }
    ));
    let twice = [p[0], p[1], p[1], p[2]];
    assert!(matches!(
        run(&twice, options(3, false)),
        CurveError::Coincident {
            first: 1,
            second: 2,
            ..
        }
    ));
    let nan = [p[0], DVec3::NAN, p[1]];
    assert!(matches!(run(&nan, options(3, false)), CurveError::Nurbs(_)));
    let tangent = |t| InterpolateOptions {
        start_tangent: Some(t),
        ..options(3, true)
    };
    assert!(matches!(
        run(&p, tangent(DVec3::X)),
        CurveError::TangentOfClosed
    ));
    let open = InterpolateOptions {
        closed: false,
        ..tangent(DVec3::INFINITY)
    };
    assert!(matches!(run(&p, open), CurveError::VectorNotFinite { .. }));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// Very uneven and collinear points: the curve passes through all of them, or says that it cannot.
    #[test]
    fn uneven_points_are_met_or_refused(
        steps in prop::collection::vec(
            (prop_oneof![Just(1e-7), Just(1e-3), 0.1f64..2.0], prop_oneof![Just(0.0), -1.5f64..1.5]),
            5..14,
        ),
        degree in 2usize..=5,
        closed in any::<bool>(),
        centripetal in any::<bool>(),
    ) {
        let mut points = vec![DVec3::ZERO];
        for (i, (s, turn)) in steps.iter().enumerate() {
            points.push(points[i] + v(turn.cos(), turn.sin(), 0.0) * *s);
        }
        let spacing = if centripetal { Spacing::Centripetal } else { Spacing::Chord };
        let o = InterpolateOptions { spacing, ..options(degree, closed) };
        match interpolate(&points, o) {
            Ok(c) => {
                let at = spacing.parameters(&points, closed).unwrap();
                for (p, t) in points.iter().zip(&at) {
                    prop_assert!((c.point(*t) - *p).length() < 1e-8);
                }
            }
            Err(CurveError::IllConditioned { .. }) => prop_assert!(degree != 3),
            Err(e) => prop_assert!(false, "{e}"),
        }
    }
}
