//! Quadrics and the torus: the laws, the implicit equations to 1e-14, poles, orientation, ranges, bad input.

#![allow(clippy::unwrap_used)]

use nappe::surface::{
    Elementary, Normal, Quadric, QuadricError, QuadricOptions, QuadricShape, Surface, Torus,
    TorusError, TorusOptions, normal_at,
};
use nappe::{DVec3, Frame, Limit, laws};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn frame(scale: f64, shift: DVec3) -> Frame {
    Frame::new(shift * scale, v(1.0, 2.0, 3.0), v(1.0, 0.0, 0.2)).unwrap()
}

fn quadric(shape: QuadricShape, scale: f64, options: QuadricOptions) -> Quadric {
    let axes = [2.0 * scale, 1.5 * scale, 0.7 * scale];
    Quadric::new(shape, &axes[..shape.semi_axes()[1]], options).unwrap()
}

fn placed(frame: Frame) -> QuadricOptions {
    QuadricOptions {
        frame,
        ..Default::default()
    }
}

fn grid(n: usize) -> impl Iterator<Item = [f64; 2]> {
    (0..=n).flat_map(move |i| (0..=n).map(move |j| [i as f64 / n as f64, j as f64 / n as f64]))
}

#[test]
fn laws_of_all_shapes_at_all_scales() {
    for shape in QuadricShape::ALL {
        for scale in [1e-6, 1.0, 1e6] {
            for shift in [DVec3::ZERO, v(1e3, -2e3, 5e2)] {
                laws::surface(&quadric(shape, scale, placed(frame(scale, shift))));
            }
        }
    }
}

#[test]
fn a_hundred_thousand_boxes() {
    laws::surface_with(
        &quadric(QuadricShape::Ellipsoid, 1.0, Default::default()),
        100_000,
    );
    laws::surface_with(&Torus::new(3.0, 1.0, Default::default()).unwrap(), 100_000);
}

#[test]
fn every_shape_satisfies_its_equation() {
    for shape in QuadricShape::ALL {
        for scale in [1e-6, 1.0, 1e6] {
            let q = quadric(shape, scale, placed(frame(scale, DVec3::ZERO)));
            for uv in grid(60) {
                // Relative to the shape's own size: near an apex all terms vanish, the rounding of coordinates does not.
                let (value, terms) = q.equation(q.point(uv));
                assert!(
                    value.abs() <= 1e-14 * terms.max(1.0),
                    "{} at {uv:?}: {value:e} of {terms}",
                    shape.name()
                );
            }
        }
    }
}

#[test]
fn parts_satisfy_the_equation_and_end_where_they_should() {
    let c = 0.7;
    let parts = [
        (QuadricShape::Ellipsoid, [0.3, 2.0], [-0.2, 1.0]),
        (QuadricShape::Sphere, [-1.0, 4.0], [0.1, FRAC_PI_2]),
        (QuadricShape::Hyperboloid1, [0.3, 2.0], [-5.0, 30.0]),
        (QuadricShape::Hyperboloid2, [0.3, 2.0], [-30.0 * c, -c]),
        (QuadricShape::Hyperboloid2, [0.0, TAU], [1.5 * c, 4.0]),
        (QuadricShape::EllipticParaboloid, [0.3, 2.0], [0.5, 9.0]),
        (QuadricShape::HyperbolicParaboloid, [0.3, 2.0], [-5.0, -1.0]),
        (QuadricShape::Cone, [0.3, 2.0], [-2.0, -0.5]),
        (QuadricShape::Cylinder, [0.3, 2.0], [-2.0, 5.0]),
        (QuadricShape::ParabolicCylinder, [0.3, 2.0], [-2.0, 5.0]),
        (QuadricShape::HyperbolicCylinder, [-20.0, 2.0], [-2.0, 5.0]),
    ];
    for (shape, ru, rv) in parts {
        let options = QuadricOptions {
            range: [Some(ru), Some(rv)],
            ..Default::default()
        };
        let q = quadric(shape, 1.0, options);
        laws::surface(&q);
        for uv in grid(40) {
            let (value, terms) = q.equation(q.point(uv));
            assert!(value.abs() <= 1e-14 * terms, "{} at {uv:?}", shape.name());
        }
        // The four corners, from the definition of the ranges.
        let [a, b, c] = q.semi_axes();
        for (uv, [s, t]) in [
            ([0.0, 0.0], [ru[0], rv[0]]),
            ([1.0, 0.0], [ru[1], rv[0]]),
            ([0.0, 1.0], [ru[0], rv[1]]),
            ([1.0, 1.0], [ru[1], rv[1]]),
        ] {
            let round = |rho: f64, z: f64| v(a * rho * s.cos(), b * rho * s.sin(), z);
            let want = match shape {
                QuadricShape::Ellipsoid | QuadricShape::Sphere => round(t.cos(), c * t.sin()),
                QuadricShape::Hyperboloid1 => round((1.0 + (t / c).powi(2)).sqrt(), t),
                QuadricShape::Hyperboloid2 => round(((t / c).powi(2) - 1.0).sqrt(), t),
                QuadricShape::EllipticParaboloid => round((t / c).sqrt(), t),
                QuadricShape::Cone => round((t / c).abs(), t),
                QuadricShape::Cylinder => round(1.0, t),
                QuadricShape::HyperbolicParaboloid => {
                    v(s, t, c * ((s / a).powi(2) - (t / b).powi(2)))
                }
                QuadricShape::ParabolicCylinder => v(s, t, c * (s / a).powi(2)),
                QuadricShape::HyperbolicCylinder => v(a * (1.0 + (s / b).powi(2)).sqrt(), s, t),
            };
            let gap = (q.point(uv) - want).length();
            assert!(
                gap <= 1e-13 * want.length().max(1.0),
                "{} at {uv:?}: {gap:e}",
                shape.name()
            );
        }
    }
}

#[test]
fn normals_point_away_from_the_axis_and_poles_have_theirs() {
    for shape in QuadricShape::ALL.into_iter().filter(|s| s.is_round()) {
        let q = quadric(shape, 1.0, Default::default());
        for uv in grid(12) {
            let n = normal_at(&q, uv, [Limit::Above; 2]).vector().unwrap();
            let p = q.point(uv);
            if p.truncate().length() > 1e-9 {
                assert!(n.truncate().dot(p.truncate()) > 0.0, "{}", shape.name());
            }
        }
    }
    let sphere = Quadric::new(QuadricShape::Sphere, &[2.0], Default::default()).unwrap();
    for k in 0..=16 {
        let b = k as f64 / 16.0;
        for (t, n) in [(0.0, -DVec3::Z), (1.0, DVec3::Z)] {
            assert_eq!(sphere.point([b, t]), n * 2.0);
            let Normal::Limit(m) = normal_at(&sphere, [b, t], [Limit::Above; 2]) else {
                panic!("a limit at the pole")
            };
            assert!((m - n).length() < 1e-12);
        }
        assert_eq!(sphere.point([0.0, b]), sphere.point([1.0, b]));
    }
    // The apex of a cone keeps the normal of each generator.
    let cone = Quadric::new(QuadricShape::Cone, &[1.0, 1.0, 2.0], Default::default()).unwrap();
    for k in 0..=16 {
        let b = k as f64 / 16.0;
        let apex = normal_at(&cone, [b, 0.0], [Limit::Above; 2])
            .vector()
            .unwrap();
        let along = normal_at(&cone, [b, 0.7], [Limit::Above; 2])
            .vector()
            .unwrap();
        assert!((apex - along).length() < 1e-12);
    }
}

#[test]
fn composites_are_smooth() {
    // Across every joint the unit normal and the curvature of the sphere agree; the joints are C0 as maps only.
    let q = quadric(QuadricShape::Ellipsoid, 1.0, Default::default());
    for k in 1..4 {
        for t in [0.2, 0.5, 0.9] {
            let at = [k as f64 / 4.0, t];
            let n = normal_at(&q, at, [Limit::Below, Limit::Above]).vector();
            let m = normal_at(&q, at, [Limit::Above, Limit::Above]).vector();
            assert!((n.unwrap() - m.unwrap()).length() < 1e-13);
        }
    }
}

#[test]
fn cylinders_are_recognised() {
    let f = frame(1.0, v(1.0, 2.0, 3.0));
    let q = Quadric::new(QuadricShape::Cylinder, &[2.0], placed(f)).unwrap();
    assert_eq!(
        q.elementary(),
        Some(Elementary::Cylinder {
            axis: f,
            radius: 2.0,
            outward: true
        })
    );
    assert_eq!(
        quadric(QuadricShape::Cylinder, 1.0, Default::default()).elementary(),
        None
    );
}

#[test]
fn tori_satisfy_their_equation() {
    for (major, minor, range) in [
        (3.0, 1.0, [[0.0, TAU]; 2]),
        (3.0, 1.0, [[0.3, 1.0], [-1.0, 4.0]]),
        (1.0, 1.0, [[0.0, TAU]; 2]),
        (0.5, 1.0, [[0.0, TAU], [-2.0, 2.0]]),
        (0.0, 1.0, [[0.0, TAU], [-FRAC_PI_2, FRAC_PI_2]]),
    ] {
        for scale in [1e-6, 1.0, 1e6] {
            let f = frame(scale, DVec3::ONE);
            let options = TorusOptions { frame: f, range };
            let t = Torus::new(major * scale, minor * scale, options).unwrap();
            laws::surface(&t);
            for uv in grid(40) {
                let p = f.coordinates(t.point(uv)) / scale;
                let gap = p.truncate().length() - major;
                let tube = gap.hypot(p.z);
                assert!(
                    (tube - minor).abs() < 1e-14 * (major + minor),
                    "{uv:?}: {tube}"
                );
            }
            let corner = |a: f64, b: f64| {
                f.point(
                    v(
                        (major + minor * b.cos()) * a.cos(),
                        (major + minor * b.cos()) * a.sin(),
                        minor * b.sin(),
                    ) * scale,
                )
            };
            let gap = t.point([1.0, 1.0]) - corner(range[0][1], range[1][1]);
            assert!(gap.length() < 1e-14 * scale * (1.0 + major + minor));
        }
    }
}

#[test]
fn torus_pieces_have_golovanovs_weights_and_outward_normals() {
    let (alpha, beta) = (1.1, 0.6);
    let options = TorusOptions {
        range: [[0.0, alpha], [0.0, beta]],
        ..Default::default()
    };
    let t = Torus::new(3.0, 1.0, options).unwrap();
    let (wu, wv) = ((alpha / 2.0).cos(), (beta / 2.0).cos());
    let want = [1.0, wv, 1.0, wu, wu * wv, wu, 1.0, wv, 1.0];
    for (w, want) in t.nurbs().weights().iter().zip(want) {
        assert!((w - want).abs() < 1e-15);
    }
    let n = t.jet([0.5, 0.5], Default::default(), 1).normal().unwrap();
    let (a, b) = (alpha / 2.0, beta / 2.0);
    let out = v(b.cos() * a.cos(), b.cos() * a.sin(), b.sin());
    assert!((n - out).length() < 1e-14);
}

#[test]
fn a_horn_torus_pinches_and_a_spindle_is_refused() {
    let horn = Torus::new(1.0, 1.0, Default::default()).unwrap();
    for k in 0..=8 {
        assert!(horn.point([k as f64 / 8.0, 0.5]).length() < 1e-15);
        // The tube touches the axis along it: its normal is square to it and turns with u.
        let n = normal_at(&horn, [k as f64 / 8.0, 0.5], [Limit::Above; 2]);
        let (sin, cos) = (k as f64 * TAU / 8.0).sin_cos();
        assert!(matches!(n, Normal::Limit(n) if (n + v(cos, sin, 0.0)).length() < 1e-12));
    }
    let Err(TorusError::CrossesAxis { limit, .. }) = Torus::new(0.5, 1.0, Default::default())
    else {
        panic!("a spindle crosses its axis")
    };
    assert!((limit - (-0.5f64).acos()).abs() < 1e-15);
    let options = TorusOptions {
        range: [[0.0, TAU], [-limit, limit]],
        ..Default::default()
    };
    let apple = Torus::new(0.5, 1.0, options).unwrap();
    assert!((apple.point([0.1, 0.0]) - apple.point([0.7, 0.0])).length() < 1e-15);
    for range in [[-limit - 1e-3, 0.0], [0.0, limit + 1e-3], [3.0, 3.2]] {
        let options = TorusOptions {
            range: [[0.0, TAU], range],
            ..Default::default()
        };
        assert!(Torus::new(0.5, 1.0, options).is_err(), "{range:?}");
    }
}

#[test]
fn bad_input_is_named() {
    let plain = QuadricOptions::default;
    let new = |shape, axes: &[f64], o| Quadric::new(shape, axes, o).unwrap_err();
    let ranged = |u, v| QuadricOptions {
        range: [u, v],
        ..Default::default()
    };
    assert!(matches!(
        new(QuadricShape::Sphere, &[1.0, 2.0], plain()),
        QuadricError::SemiAxisCount { given: 2, .. }
    ));
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            new(QuadricShape::Ellipsoid, &[1.0, bad, 1.0], plain()),
            QuadricError::SemiAxis { index: 1, .. }
        ));
        assert!(Torus::new(1.0, bad, Default::default()).is_err());
    }
    let abc = [1.0, 1.0, 1.0];
    assert!(matches!(
        new(QuadricShape::Cone, &abc, ranged(None, Some([-1.0, 1.0]))),
        QuadricError::TwoHalves { gap: 0.0, .. }
    ));
    assert!(matches!(
        new(
            QuadricShape::Hyperboloid2,
            &abc,
            ranged(None, Some([0.5, 2.0]))
        ),
        QuadricError::TwoHalves { gap: 1.0, .. }
    ));
    assert!(matches!(
        new(
            QuadricShape::EllipticParaboloid,
            &abc,
            ranged(None, Some([-0.1, 2.0]))
        ),
        QuadricError::Outside { parameter: 'v', .. }
    ));
    assert!(matches!(
        new(QuadricShape::Ellipsoid, &abc, ranged(None, Some([0.0, PI]))),
        QuadricError::Outside { parameter: 'v', .. }
    ));
    assert!(matches!(
        new(
            QuadricShape::Ellipsoid,
            &abc,
            ranged(Some([0.0, 7.0]), None)
        ),
        QuadricError::Outside { parameter: 'u', .. }
    ));
    for bad in [[1.0, 1.0], [2.0, 1.0], [0.0, f64::NAN]] {
        assert!(matches!(
            new(QuadricShape::Cylinder, &[1.0], ranged(Some(bad), None)),
            QuadricError::Range { parameter: 'u', .. }
        ));
    }
    assert!(matches!(
        new(
            QuadricShape::Hyperboloid1,
            &abc,
            ranged(None, Some([0.0, 1e300]))
        ),
        QuadricError::Overflow { .. }
    ));
    let twice = TorusOptions {
        range: [[0.0, 7.0], [0.0, 1.0]],
        ..Default::default()
    };
    assert!(matches!(
        Torus::new(3.0, 1.0, twice),
        Err(TorusError::Range { parameter: 'u', .. })
    ));
}
