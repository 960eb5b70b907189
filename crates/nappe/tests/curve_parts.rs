//! Curves made of curves and of surfaces: the laws, and that they are the parts they say.

#![allow(clippy::unwrap_used)]

use nappe::basis::BSplineBasis;
use nappe::curve::{
    CrossDerivative, Curve, CurveError, CurveRef, Ellipse, EllipseOptions, Isocurve, JoinOptions,
    Joined, Line, Share, Spacing, Trimmed, on_unit_domain, polyline,
};
use nappe::exact::{NurbsCurve, NurbsSurface};
use nappe::surface::{Dir, Side, SurfaceRef, jet_index};
use nappe::{DVec3, Limit, laws};
use proptest::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn places() -> Vec<(f64, DVec3)> {
    let far = v(1e3, -2e3, 5e2);
    [1e-6, 1.0, 1e6]
        .into_iter()
        .flat_map(|s| [(s, DVec3::ZERO), (s, far * s)])
        .collect()
}

/// A rational cubic on [2, 7] with a corner, near and multiple knots.
fn spline(s: f64, o: DVec3) -> CurveRef {
    let mut random = laws::Random(3);
    let points: Vec<_> = (0..9)
        .map(|i| o + v(i as f64, random.unit(), random.unit()) * s)
        .collect();
    let weights: Vec<_> = (0..9).map(|_| 0.5 + random.unit()).collect();
    let knots = vec![
        2.0, 2.0, 2.0, 2.0, 3.0, 3.25, 5.0, 5.0, 5.0, 7.0, 7.0, 7.0, 7.0,
    ];
    Arc::new(NurbsCurve::new(3, knots, &points, Some(&weights)).unwrap())
}

fn net(s: f64, o: DVec3, rational: bool) -> NurbsSurface {
    let mut random = laws::Random(5);
    let points: Vec<_> = (0..42)
        .map(|i| o + v((i / 6) as f64, (i % 6) as f64, random.unit()) * s)
        .collect();
    let weights: Vec<_> = (0..42).map(|_| 0.5 + random.unit()).collect();
    let knots = [
        BSplineBasis::clamped_uniform(3, 7),
        vec![0.0, 0.0, 0.0, 1.0, 1.0, 3.0, 4.0, 4.0, 4.0],
    ];
    NurbsSurface::new([3, 2], knots, &points, rational.then_some(&weights[..])).unwrap()
}

#[test]
fn laws_of_parts_hold_at_all_scales() {
    for (s, o) in places() {
        let c = spline(s, o);
        laws::curve(&Trimmed::new(c.clone(), 2.5, 6.0).unwrap());
        laws::curve(&Trimmed::new(c.clone(), 5.0, 3.25).unwrap());
        laws::curve(&Trimmed::reversed(c.clone()));
        laws::curve(on_unit_domain(c.clone()).as_ref());
        let e = Arc::new(Ellipse::circle(o, s, DVec3::ONE).unwrap());
        laws::curve(&Trimmed::new(e.clone(), 0.1, 0.35).unwrap());
        laws::curve(&Trimmed::reversed(e));
        let line = Arc::new(Line::new(c.ends()[1], o + v(1.0, 5.0, 2.0) * s).unwrap());
        for share in [Share::Equal, Share::Length] {
            let options = JoinOptions {
                share,
                ..Default::default()
            };
            laws::curve(&Joined::new(vec![c.clone(), line.clone()], options).unwrap());
        }
        for rational in [false, true] {
            let surface: SurfaceRef = Arc::new(net(s, o, rational));
            for side in Side::ALL {
                laws::curve(&Isocurve::side(surface.clone(), side));
                laws::curve(&CrossDerivative::side(surface.clone(), side));
            }
            laws::curve(&Isocurve::new(surface.clone(), Dir::U, 1.0).unwrap());
            laws::curve(&Isocurve::new(surface.clone(), Dir::V, 0.4).unwrap());
            laws::curve(&CrossDerivative::new(surface.clone(), Dir::U, 2.0).unwrap());
        }
    }
}

#[test]
fn many_random_parts_are_enclosed() {
    let o = v(1.0, 2.0, 3.0);
    let c = spline(1.0, o);
    laws::curve_with(&Trimmed::new(c.clone(), 6.5, 2.25).unwrap(), 100_000);
    let line = Arc::new(Line::new(c.ends()[1], DVec3::ZERO).unwrap());
    let joined = Joined::new(vec![c, line], JoinOptions::default()).unwrap();
    laws::curve_with(&joined, 100_000);
    let surface: SurfaceRef = Arc::new(net(1.0, o, true));
    laws::curve_with(&Isocurve::side(surface.clone(), Side::East), 100_000);
    laws::curve_with(&CrossDerivative::side(surface, Side::South), 100_000);
}

#[test]
fn a_part_is_the_curve_with_another_parameter() {
    let c = spline(1.0, DVec3::ZERO);
    for (from, to) in [(2.0, 7.0), (2.5, 6.0), (6.0, 2.5), (3.25, 5.0), (5.0, 3.0)] {
        let part = Trimmed::new(c.clone(), from, to).unwrap();
        let n = part.to_nurbs().unwrap();
        for i in 0..=50 {
            let s = i as f64 / 50.0;
            let (p, want) = (part.point(s), c.point(from + (to - from) * s));
            assert!((p - want).length() < 1e-13 && (n.point(s) - want).length() < 1e-13);
        }
        assert_eq!(part.ends(), [c.point(from), c.point(to)]);
    }
    // At a corner both limits come from the right piece, also backwards.
    let back = Trimmed::reversed(c.clone());
    let (l, r) = (
        c.jet(5.0, Limit::Below, 1).d[1],
        c.jet(5.0, Limit::Above, 1).d[1],
    );
    assert_eq!(back.breaks()[1].at, 0.4);
    assert!((back.jet(0.4, Limit::Below, 1).d[1] + r * 5.0).length() < 1e-12);
    assert!((back.jet(0.4, Limit::Above, 1).d[1] + l * 5.0).length() < 1e-12);
}

#[test]
fn a_curve_on_the_unit_domain_is_itself() {
    let c: CurveRef = Arc::new(Line::new(DVec3::ZERO, DVec3::X).unwrap());
    assert!(Arc::ptr_eq(&c, &on_unit_domain(c.clone())));
}

#[test]
fn joints_say_how_smooth_they_are() {
    let line = |a, b| -> CurveRef { Arc::new(Line::new(a, b).unwrap()) };
    let join = |c: Vec<CurveRef>, share| {
        let options = JoinOptions { share, tol: None };
        Joined::new(c, options).unwrap()
    };
    let straight = vec![line(DVec3::ZERO, DVec3::X), line(DVec3::X, DVec3::X * 3.0)];
    assert_eq!(join(straight.clone(), Share::Equal).breaks()[1].smooth, 0);
    let even = join(straight, Share::Length);
    assert!((even.breaks()[1].at - 1.0 / 3.0).abs() < 1e-15 && even.breaks()[1].smooth >= 1);
    let corner = vec![line(DVec3::ZERO, DVec3::X), line(DVec3::X, DVec3::ONE)];
    let corner = join(corner, Share::Equal);
    assert_eq!(corner.breaks()[1].smooth, 0);
    assert!(corner.to_nurbs().is_some());
    // A gap within the tolerance is a jump, said so, and has no NURBS form.
    let gap = vec![
        line(DVec3::ZERO, DVec3::X),
        line(v(1.0, 1e-4, 0.0), DVec3::ONE),
    ];
    let options = JoinOptions {
        tol: Some(1e-3),
        ..Default::default()
    };
    let jump = Joined::new(gap, options).unwrap();
    assert_eq!(jump.breaks()[1].smooth, -1);
    assert!(jump.to_nurbs().is_none());
    laws::curve(&jump);
}

#[test]
fn two_halves_of_a_circle_are_a_circle() {
    let half = |from, to| -> CurveRef {
        Arc::new(Ellipse::arc(DVec3::ZERO, 2.0, from, to, DVec3::Z).unwrap())
    };
    let c = Joined::new(
        vec![half(0.0, PI), half(PI, 2.0 * PI)],
        JoinOptions::default(),
    )
    .unwrap();
    assert_eq!(c.breaks()[1].smooth, 3);
    laws::curve(&c);
    let whole = Ellipse::circle(DVec3::ZERO, 2.0, DVec3::Z).unwrap();
    let rational = c.to_rational().unwrap();
    for i in 0..=64 {
        let t = i as f64 / 64.0;
        assert!((c.point(t) - whole.point(t)).length() < 2e-15);
        assert!((rational.point(t).length() - 2.0).abs() < 4e-15);
    }
}

#[test]
fn curves_that_do_not_meet_are_named() {
    let line = |a, b| -> CurveRef { Arc::new(Line::new(a, b).unwrap()) };
    let curves = vec![
        line(DVec3::ZERO, DVec3::X),
        line(DVec3::X, DVec3::ONE),
        line(DVec3::Z, DVec3::ONE),
    ];
    let Err(CurveError::Gap {
        first: 1,
        second: 2,
        distance,
        reversed: true,
        ..
    }) = Joined::new(curves, JoinOptions::default())
    else {
        panic!("the gap between curves 1 and 2");
    };
    assert!((distance - 2f64.sqrt()).abs() < 1e-15);
    assert_eq!(
        Joined::new(Vec::new(), JoinOptions::default()).unwrap_err(),
        CurveError::Nothing
    );
    // A collapsed curve has no share by length.
    let point = vec![line(DVec3::ZERO, DVec3::X), line(DVec3::X, DVec3::X)];
    let options = JoinOptions {
        share: Share::Length,
        tol: None,
    };
    assert!(Joined::new(point, options).is_err());
    let c = line(DVec3::ZERO, DVec3::X);
    for (from, to) in [(0.5, 0.5), (-0.1, 1.0), (0.0, 1.5), (f64::NAN, 1.0)] {
        assert!(matches!(
            Trimmed::new(c.clone(), from, to),
            Err(CurveError::Range { .. })
        ));
    }
    let surface: SurfaceRef = Arc::new(net(1.0, DVec3::ZERO, false));
    assert!(matches!(
        Isocurve::new(surface, Dir::U, 4.5),
        Err(CurveError::Outside { .. })
    ));
}

#[test]
fn curves_on_a_surface_are_its_partial_maps() {
    for rational in [false, true] {
        let s: SurfaceRef = Arc::new(net(1.0, v(5.0, 0.0, 1.0), rational));
        let place = |dir, t, at| match dir {
            Dir::U => [t, at],
            Dir::V => [at, t],
        };
        for (dir, at, end) in [(Dir::U, 2.5, 1.0), (Dir::V, 0.25, 4.0)] {
            let c = Isocurve::new(s.clone(), dir, at).unwrap();
            let x = CrossDerivative::new(s.clone(), dir, at).unwrap();
            let n = [c.to_nurbs().unwrap(), x.to_nurbs().unwrap()];
            for i in 0..=30 {
                let t = end * i as f64 / 30.0;
                let jet = s.jet(place(dir, t, at), [Limit::Above; 2], 2);
                let across = match dir {
                    Dir::U => jet_index(0, 1),
                    Dir::V => jet_index(1, 0),
                };
                for (got, want) in [
                    (c.point(t), jet.d[0]),
                    (n[0].point(t), jet.d[0]),
                    (x.point(t), jet.d[across]),
                    (n[1].point(t), jet.d[across]),
                ] {
                    assert!((got - want).length() < 1e-12, "{got} {want}");
                }
                // The derivative along the curve of the derivative across is the twist.
                let twist = x.jet(t, Limit::Above, 1).d[1];
                assert_eq!(twist, jet.d[jet_index(1, 1)]);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Parts of polylines with near corners: what the parameters say, the laws hold.
    #[test]
    fn parts_of_curves_with_near_breaks_obey_the_laws(
        steps in prop::collection::vec(prop_oneof![Just(1e-9), Just(1e-4), 0.1f64..2.0], 2..7),
        cut in prop::collection::vec(0.0f64..=1.0, 2),
    ) {
        // Long first and last steps: rounding errors are relative to the whole polyline.
        let mut p = vec![DVec3::ZERO, v(2.0, 1.0, 0.0)];
        for (i, s) in steps.iter().enumerate() {
            let angle = i as f64 * 2.4;
            p.push(p[i + 1] + v(angle.cos(), angle.sin(), 0.3) * *s);
        }
        p.push(v(0.0, 4.0, 1.0));
        let step = 0.5 / (p.len() - 1) as f64;
        let cut = [cut[0] * step, 1.0 - cut[1] * step];
        let c: CurveRef = Arc::new(polyline(&p, Spacing::Uniform).unwrap());
        laws::curve_with(&Trimmed::new(c.clone(), cut[1], cut[0]).unwrap(), 50);
        let back: CurveRef = Arc::new(Trimmed::reversed(c.clone()));
        let there_and_back = Joined::new(vec![c, back], JoinOptions::default()).unwrap();
        laws::curve_with(&there_and_back, 50);
    }

    /// Arcs of any turn: radius, ends and enclosures.
    #[test]
    fn arcs_obey_the_laws(
        from in -10.0f64..10.0,
        turn in prop_oneof![Just(1e-6), Just(2.0 * PI), -6.2f64..6.2],
        ratio in prop_oneof![Just(1.0), Just(1e-3), 0.1f64..10.0],
    ) {
        prop_assume!(turn != 0.0);
        let options = EllipseOptions { from, to: from + turn, ..Default::default() };
        let e = Ellipse::new(DVec3::ONE, [1.0, ratio], options).unwrap();
        laws::curve_with(&e, 50);
    }
}
