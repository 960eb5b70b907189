//! Fillets: the laws, and the certificate that every point lies on its ball, with the ball's normal, and every ball
//! touches both supports; exact forms; bad input.

#![allow(clippy::unwrap_used)]

use nappe::basis::{ExpressionFunctions, FunctionsRef};
use nappe::expr::Expr;
use nappe::maps::rotation;
use nappe::surface::{
    Elementary, Fillet, FilletError, FilletOptions, Quadric, QuadricOptions, QuadricShape, Radius,
    Surface, SurfaceRef, Transformed, bilinear,
};
use nappe::{DAffine3, DVec3, Frame, laws};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// The rectangle with a corner, spanned by two vectors.
fn plane(corner: DVec3, a: DVec3, b: DVec3) -> SurfaceRef {
    Arc::new(bilinear([[corner, corner + b], [corner + a, corner + a + b]]).unwrap())
}

/// A floor (normal up) and a wall that leans by an angle from it, both beside the x axis from 0 to 4.
fn corner(angle: f64, scale: f64, shift: DVec3) -> [SurfaceRef; 2] {
    let up = v(0.0, angle.cos(), angle.sin()) * 3.0;
    [
        plane(shift, DVec3::X * 4.0 * scale, DVec3::Y * 3.0 * scale),
        plane(shift, up * scale, DVec3::X * 4.0 * scale),
    ]
}

fn cylinder(frame: Frame, radius: f64, heights: [f64; 2]) -> SurfaceRef {
    let options = QuadricOptions {
        frame,
        range: [None, Some(heights)],
    };
    Arc::new(Quadric::new(QuadricShape::Cylinder, &[radius], options).unwrap())
}

fn expression(text: &str) -> Radius {
    let bound = Expr::parse(text).unwrap().bind(&["u"], &[]).unwrap();
    let f: FunctionsRef = Arc::new(ExpressionFunctions::new([bound], [0.0, 1.0]).unwrap());
    Radius::Along(f)
}

/// The signed distance of a point from a support.
fn distance(s: &dyn Surface, p: DVec3) -> f64 {
    match s.elementary().unwrap() {
        Elementary::Plane { origin, normal } => (p - origin).dot(normal),
        Elementary::Cylinder { axis, radius, .. } => {
            axis.coordinates(p).truncate().length() - radius
        }
        other => panic!("no formula for {other:?}"),
    }
}

/// Every ball touches both supports; every point is on its ball and the surface's normal points to its centre; the ends
/// of a section are on the supports.
fn certify(f: &Fillet, supports: &[SurfaceRef; 2], size: f64) {
    for i in 0..=40 {
        let u = i as f64 / 40.0;
        let (centre, r) = f.ball(u);
        for s in supports {
            let gap = distance(s.as_ref(), centre).abs() - r;
            assert!(gap.abs() <= 1e-13 * size, "ball at {u}: {gap:e}");
        }
        for j in 0..=16 {
            let b = j as f64 / 16.0;
            let jet = f.jet([u, b], Default::default(), 1);
            let to_centre = centre - jet.point();
            assert!((to_centre.length() - r).abs() <= 1e-13 * size, "{u} {b}");
            let n = jet.normal().unwrap();
            assert!(
                (n - to_centre / r).length() < 1e-10,
                "normal at {u}, {b}: {n} but {}",
                to_centre / r
            );
        }
        for (s, b) in supports.iter().zip([0.0, 1.0]) {
            let gap = distance(s.as_ref(), f.point([u, b]));
            assert!(gap.abs() <= 1e-13 * size, "contact at {u}, {b}: {gap:e}");
        }
    }
}

fn fillet(supports: &[SurfaceRef; 2], radius: Radius, options: FilletOptions) -> Fillet {
    Fillet::new(&supports[0], &supports[1], radius, options).unwrap()
}

fn refused(supports: &[SurfaceRef; 2], radius: Radius, options: FilletOptions) -> FilletError {
    Fillet::new(&supports[0], &supports[1], radius, options).unwrap_err()
}

#[test]
fn between_planes_at_all_angles_and_scales() {
    for angle in [0.3, FRAC_PI_2, 2.0, 3.0] {
        for scale in [1e-6, 1.0, 1e6] {
            for shift in [DVec3::ZERO, v(1e3, -2e3, 5e2) * scale] {
                let supports = corner(angle, scale, shift);
                let size = scale * if shift == DVec3::ZERO { 5.0 } else { 3e3 };
                let f = fillet(&supports, Radius::Constant(0.2 * scale), Default::default());
                laws::surface(&f);
                certify(&f, &supports, size);
                let n = f.to_nurbs().unwrap();
                assert_eq!([n.basis_u().degree(), n.basis_v().degree()], [1, 2]);
                assert!((n.weights()[1] - (angle / 2.0).sin()).abs() < 1e-14);
                // u runs along n0 × n2, here against x.
                assert!((f.point([1.0, 0.0]).x - shift.x).abs() < 1e-13 * size);
            }
        }
    }
}

#[test]
fn a_quarter_round_is_the_textbook_one() {
    let f = fillet(
        &corner(FRAC_PI_2, 1.0, DVec3::ZERO),
        Radius::Constant(0.5),
        Default::default(),
    );
    for i in 0..=20 {
        for j in 0..=20 {
            let p = f.point([i as f64 / 20.0, j as f64 / 20.0]);
            assert!(((p.y - 0.5).hypot(p.z - 0.5) - 0.5).abs() < 1e-15 * 4.0);
            assert!((p.x - 4.0 + 4.0 * i as f64 / 20.0).abs() < 1e-15 * 8.0);
        }
    }
}

#[test]
fn variable_radius_between_planes() {
    for (text, angle) in [
        ("0.2+0.3*u", FRAC_PI_2),
        ("0.5+0.2*sin(6*u)", 1.0),
        ("0.3+0.1*u^2", 2.5),
        ("0.4-0.3*u", 0.8),
        // Two pieces that meet with equal slopes.
        ("0.3+0.4*max(u-0.5, 0)^2", 1.2),
    ] {
        let supports = corner(angle, 1.0, v(1.0, 2.0, 3.0));
        let f = fillet(&supports, expression(text), Default::default());
        laws::surface(&f);
        certify(&f, &supports, 6.0);
        assert!(f.to_nurbs().is_none());
    }
}

#[test]
fn a_hundred_thousand_boxes() {
    let supports = corner(1.2, 1.0, DVec3::ZERO);
    let f = fillet(
        &supports,
        expression("0.5+0.2*sin(6*u)"),
        Default::default(),
    );
    laws::surface_with(&f, 100_000);
}

#[test]
fn sides_choose_the_quadrant() {
    // Two planes that cross: all four quadrants.
    let supports = [
        plane(v(0.0, -2.0, 0.0), DVec3::X, DVec3::Y * 4.0),
        plane(v(0.0, 0.0, -2.0), DVec3::Z * 4.0, DVec3::X),
    ];
    for side in [[true, true], [true, false], [false, true], [false, false]] {
        let options = FilletOptions {
            side: Some(side),
            ..Default::default()
        };
        let f = fillet(&supports, Radius::Constant(0.5), options);
        certify(&f, &supports, 4.0);
        let p = f.point([0.5, 0.5]);
        assert_eq!([p.z > 0.0, p.y > 0.0], side);
    }
    let by_default = fillet(&supports, Radius::Constant(0.5), Default::default());
    let p = by_default.point([0.5, 0.5]);
    assert!(p.y > 0.0 && p.z > 0.0);
    // The quadrant that both reach is found.
    let supports = [
        plane(v(0.0, -2.0, 0.0), DVec3::X, DVec3::Y * 2.0),
        plane(v(0.0, 0.0, -2.0), DVec3::Z * 2.0, DVec3::X),
    ];
    let p = fillet(&supports, Radius::Constant(0.5), Default::default()).point([0.5, 0.5]);
    assert!(p.y < 0.0 && p.z < 0.0);
    let options = FilletOptions {
        side: Some([true, true]),
        ..Default::default()
    };
    assert!(matches!(
        refused(&supports, Radius::Constant(0.5), options),
        FilletError::Side { .. }
    ));
}

fn tilted_floor(normal: DVec3) -> SurfaceRef {
    let f = Frame::along(DVec3::ZERO, normal).unwrap();
    plane(f.point(v(-9.0, -9.0, 0.0)), f.x() * 18.0, f.y() * 18.0)
}

#[test]
fn round_a_cylinder_square_to_the_plane_it_is_a_torus() {
    let frame = Frame::along(v(0.5, -0.2, 1.0), DVec3::Z).unwrap();
    let supports = [tilted_floor(DVec3::Z), cylinder(frame, 2.0, [-3.0, 3.0])];
    for (side, major) in [
        ([true, true], 2.5),
        ([true, false], 1.5),
        ([false, true], 2.5),
    ] {
        let options = FilletOptions {
            side: Some(side),
            ..Default::default()
        };
        let f = fillet(&supports, Radius::Constant(0.5), options);
        laws::surface(&f);
        certify(&f, &supports, 4.0);
        let n = f.to_rational().unwrap();
        let z = if side[0] { 0.5 } else { -0.5 };
        for i in 0..=40 {
            for j in 0..=10 {
                let uv = [i as f64 / 40.0, j as f64 / 10.0];
                for p in [f.point(uv), n.point(uv)] {
                    let ring = (p.x - 0.5).hypot(p.y + 0.2) - major;
                    assert!((ring.hypot(p.z - z) - 0.5).abs() < 1e-14, "{side:?} {uv:?}");
                }
                let (a, b) = (
                    f.jet(uv, Default::default(), 1),
                    n.jet(uv, Default::default(), 1),
                );
                if i % 10 == 0 {
                    assert!((a.point() - b.point()).length() < 1e-14);
                    assert!(a.normal().unwrap().dot(b.normal().unwrap()) > 0.999);
                }
            }
        }
    }
}

#[test]
fn round_a_cylinder_at_any_angle() {
    let frame = Frame::along(v(0.5, -0.2, 4.0), DVec3::Z).unwrap();
    for normal in [v(0.5, 0.0, 1.0), v(-0.3, 0.4, 1.0), v(1.0, 0.0, 1.0)] {
        let supports = [tilted_floor(normal), cylinder(frame, 2.0, [-9.0, 9.0])];
        for side in [[true, true], [true, false], [false, true], [false, false]] {
            for radius in [Radius::Constant(0.3), expression("0.3+0.05*cos(2*pi*u)")] {
                let options = FilletOptions {
                    side: Some(side),
                    ..Default::default()
                };
                let f = fillet(&supports, radius.clone(), options);
                certify(&f, &supports, 9.0);
                let gap = f.point([0.0, 0.3]) - f.point([1.0, 0.3]);
                assert!(gap.length() < 1e-13);
                if side == [true, true] {
                    laws::surface(&f);
                }
                // The other way round it is the same surface with the sides exchanged.
                let swapped = [supports[1].clone(), supports[0].clone()];
                let options = FilletOptions {
                    side: Some([side[1], side[0]]),
                    ..Default::default()
                };
                let g = fillet(&swapped, radius, options);
                certify(&g, &swapped, 9.0);
            }
        }
    }
}

#[test]
fn along_a_cylinder_parallel_to_the_plane() {
    for height in [0.0, 0.7, -0.7, 2.3] {
        let frame = Frame::new(v(0.0, 0.0, height), DVec3::X, DVec3::Y).unwrap();
        let supports = [tilted_floor(DVec3::Z), cylinder(frame, 2.0, [-3.0, 3.0])];
        for other_line in [false, true] {
            for radius in [Radius::Constant(0.4), expression("0.4+0.2*sin(3*u)")] {
                let options = FilletOptions {
                    other_line,
                    ..Default::default()
                };
                let f = fillet(&supports, radius.clone(), options);
                laws::surface(&f);
                certify(&f, &supports, 6.0);
                assert_eq!(
                    f.to_nurbs().is_some(),
                    matches!(radius, Radius::Constant(_))
                );
                let y = f.point([0.5, 0.0]).y;
                assert!((y > 0.0) == other_line, "{y}");
            }
        }
        let inside = FilletOptions {
            side: Some([true, false]),
            ..Default::default()
        };
        if height.abs() < 2.0 {
            let f = fillet(&supports, Radius::Constant(0.4), inside);
            laws::surface(&f);
            certify(&f, &supports, 6.0);
            let largest = 0.5 * (2.0 + height);
            assert!(matches!(
                refused(&supports, Radius::Constant(1.5), inside),
                FilletError::TooLarge { largest: l, .. } if (l - largest).abs() < 1e-14
            ));
        } else {
            assert!(matches!(
                refused(&supports, Radius::Constant(0.4), inside),
                FilletError::NoContact { .. }
            ));
            assert!(matches!(
                refused(&supports, Radius::Constant(0.1), Default::default()),
                FilletError::TooSmall { least, .. } if (least - 0.15).abs() < 1e-14
            ));
        }
    }
}

#[test]
fn supports_may_be_moved_and_parts_taken() {
    let map = rotation(
        &Frame::along(v(1.0, 0.0, 2.0), v(1.0, 1.0, 0.3)).unwrap(),
        1.0,
    ) * DAffine3::from_scale(DVec3::splat(2.0));
    let moved = corner(1.0, 1.0, DVec3::ZERO)
        .map(|s| -> SurfaceRef { Arc::new(Transformed::new(s, map).unwrap()) });
    certify(
        &fillet(&moved, Radius::Constant(0.3), Default::default()),
        &moved,
        12.0,
    );
    let supports = corner(1.0, 1.0, DVec3::ZERO);
    let part = FilletOptions {
        range: Some([1.0, 2.5]),
        ..Default::default()
    };
    let f = fillet(&supports, Radius::Constant(0.3), part);
    // Measured the way u runs: against x, from x = 4.
    assert!((f.point([0.0, 0.2]).x - 3.0).abs() < 1e-14);
    assert!((f.point([1.0, 0.2]).x - 1.5).abs() < 1e-14);
    let frame = Frame::along(DVec3::ZERO, DVec3::Z).unwrap();
    let supports = [tilted_floor(DVec3::Z), cylinder(frame, 2.0, [-3.0, 3.0])];
    let part = FilletOptions {
        range: Some([0.0, PI / 3.0]),
        ..Default::default()
    };
    let f = fillet(&supports, Radius::Constant(0.3), part);
    assert!((f.point([0.0, 1.0]) - v(2.0, 0.0, 0.3)).length() < 1e-14);
    let end = v(2.0 * (PI / 3.0).cos(), 2.0 * (PI / 3.0).sin(), 0.3);
    assert!((f.point([1.0, 1.0]) - end).length() < 1e-14);
}

#[test]
fn bad_input_is_named() {
    let supports = corner(FRAC_PI_2, 1.0, DVec3::ZERO);
    let plain = FilletOptions::default;
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            refused(&supports, Radius::Constant(bad), plain()),
            FilletError::Radius { .. }
        ));
    }
    assert!(matches!(
        refused(&supports, expression("u-0.5"), plain()),
        FilletError::Radius { value, .. } if value <= 0.0
    ));
    assert!(matches!(
        refused(&supports, Radius::Constant(3.1), plain()),
        FilletError::TooLarge { largest, .. } if (largest - 3.0).abs() < 1e-14
    ));
    let parallel = [
        plane(DVec3::ZERO, DVec3::X, DVec3::Y),
        plane(DVec3::Z, DVec3::X, DVec3::Y),
    ];
    assert!(matches!(
        refused(&parallel, Radius::Constant(0.1), plain()),
        FilletError::Parallel { .. }
    ));
    let apart = [
        plane(DVec3::ZERO, DVec3::X, DVec3::Y),
        plane(DVec3::X * 2.0, DVec3::Z, DVec3::X),
    ];
    assert!(matches!(
        refused(&apart, Radius::Constant(0.1), plain()),
        FilletError::Apart { gap } if (gap - 1.0).abs() < 1e-14
    ));
    let tube = cylinder(Frame::WORLD, 2.0, [-3.0, 3.0]);
    let inside = FilletOptions {
        side: Some([true, false]),
        ..Default::default()
    };
    assert!(matches!(
        refused(
            &[tilted_floor(DVec3::Z), tube.clone()],
            Radius::Constant(2.0),
            inside
        ),
        FilletError::TooLarge { largest: 2.0, .. }
    ));
    // A radius that jumps up and down too fast for the ball to follow.
    assert!(matches!(
        refused(&supports, expression("0.5+0.2*sin(200*u)"), plain()),
        FilletError::SectionsCross { .. }
    ));
}
