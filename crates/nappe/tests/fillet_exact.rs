//! Fillets that are pieces of a torus or a cylinder, since one motion carries both supports into themselves.

#![allow(clippy::unwrap_used)]

use nappe::laws;
use nappe::surface::{
    Elementary, Fillet, FilletOptions, Quadric, QuadricOptions, QuadricShape, Radius, Surface,
    SurfaceRef, Swapped, Torus, TorusOptions, bilinear,
};
use nappe::{DVec3, Frame};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// A frame that is nowhere special.
fn askew(scale: f64) -> Frame {
    Frame::new(
        v(3.0, -5.0, 2.0) * scale,
        v(0.3, -0.2, 1.0),
        v(1.0, 0.4, 0.1),
    )
    .unwrap()
}

fn quadric(
    shape: QuadricShape,
    axes: &[f64],
    frame: Frame,
    range: [Option<[f64; 2]>; 2],
) -> SurfaceRef {
    Arc::new(Quadric::new(shape, axes, QuadricOptions { frame, range }).unwrap())
}

fn sphere(frame: Frame, radius: f64) -> SurfaceRef {
    quadric(QuadricShape::Sphere, &[radius], frame, [None; 2])
}

/// A square about the z axis of a frame, at a height.
fn floor(frame: &Frame, height: f64, half: f64) -> SurfaceRef {
    let at = |x: f64, y: f64| frame.point(v(x * half, y * half, height));
    Arc::new(
        bilinear([
            [at(-1.0, -1.0), at(-1.0, 1.0)],
            [at(1.0, -1.0), at(1.0, 1.0)],
        ])
        .unwrap(),
    )
}

fn lifted(frame: &Frame, height: f64) -> Frame {
    frame.moved_to(frame.point(DVec3::Z * height))
}

/// The distance of a point from the elementary surface, by its definition.
fn distance(form: Elementary, p: DVec3) -> f64 {
    let ring = |f: &Frame| {
        let c = f.coordinates(p);
        v(c.truncate().length(), 0.0, c.z)
    };
    match form {
        Elementary::Plane { origin, normal } => (p - origin).dot(normal).abs(),
        Elementary::Cylinder { axis, radius, .. } => (ring(&axis).x - radius).abs(),
        Elementary::Cone { axis, slope, .. } => {
            ring(&axis).cross(v(slope, 0.0, 1.0).normalize()).length()
        }
        Elementary::Sphere { frame, radius, .. } => (p.distance(frame.origin()) - radius).abs(),
        Elementary::Torus {
            axis, major, minor, ..
        } => (ring(&axis).distance(DVec3::X * major) - minor).abs(),
    }
}

/// The ball touches both, each point is on the torus or cylinder and on its ball, and the proof of the contacts agrees.
fn certify(f: &Fillet, supports: &[SurfaceRef; 2], size: f64) {
    let shape = f.elementary().unwrap();
    let rational = f.to_rational().unwrap();
    for i in 0..=32 {
        let u = f64::from(i) / 32.0;
        let (centre, r) = f.ball(u);
        for s in supports {
            let gap = distance(s.elementary().unwrap(), centre) - r;
            assert!(gap.abs() <= 1e-13 * size, "ball at {u}: {gap:e}");
        }
        let error = f.contact_error(u).unwrap();
        assert!(error <= 1e-12 * size, "contacts at {u}: {error:e}");
        for k in 0..2 {
            let contacts = f.contacts(k).unwrap();
            let mut uv = [0.0; 2];
            let limit = if u < 1.0 {
                nappe::Limit::Above
            } else {
                nappe::Limit::Below
            };
            contacts.jet_into(u, limit, 0, &mut uv);
            let gap = supports[k].point(uv).distance(f.point([u, k as f64]));
            assert!(gap <= 1e-12 * size, "contact {k} at {u}: {gap:e}");
        }
        for j in 0..=8 {
            let uv = [u, f64::from(j) / 8.0];
            let p = f.point(uv);
            assert!((p.distance(centre) - r).abs() <= 1e-13 * size, "{uv:?}");
            for p in [p, rational.point(uv)] {
                assert!(distance(shape, p) <= 1e-13 * size, "{uv:?}");
            }
        }
    }
    for (uv, w) in [([0.0, 0.0], [0.0, 0.0]), ([1.0, 1.0], [1.0, 1.0])] {
        let gap = f.point(uv).distance(rational.point(w));
        assert!(gap <= 1e-12 * size, "{uv:?}: {gap:e}");
    }
}

fn fillet(s: &[SurfaceRef; 2], r: f64, side: [bool; 2], near: Option<DVec3>) -> Fillet {
    let options = FilletOptions {
        side: Some(side),
        near,
        ..Default::default()
    };
    Fillet::new(&s[0], &s[1], Radius::Constant(r), options).unwrap_or_else(|e| panic!("{e}"))
}

fn major(f: &Fillet) -> f64 {
    match f.elementary() {
        Some(Elementary::Torus { major, .. }) => major,
        other => panic!("{other:?}"),
    }
}

#[test]
fn surfaces_about_one_axis_have_tori() {
    for scale in [1.0, 1e-6, 1e6] {
        let frame = askew(scale);
        let at = |z: f64| lifted(&frame, z * scale);
        let size = 12.0 * scale;
        let ball = |z: f64, r: f64| sphere(at(z), r * scale);
        let ground = floor(&frame, 0.0, 9.0 * scale);
        let r = 0.5 * scale;
        // Closed forms of the ring on which the centre goes.
        let out = [true, true];
        let cone = quadric(
            QuadricShape::Cone,
            &[scale, scale, scale],
            at(0.0),
            [None, Some([1.0 * scale, 4.0 * scale])],
        );
        let pipe = quadric(
            QuadricShape::Cylinder,
            &[1.5 * scale],
            at(0.0),
            [None, Some([-5.0 * scale, 5.0 * scale])],
        );
        let ring = Torus::new(
            4.0 * scale,
            scale,
            TorusOptions {
                frame,
                ..Default::default()
            },
        );
        let ring: SurfaceRef = Arc::new(ring.unwrap());
        let top = floor(&frame, 2.0 * scale, 9.0 * scale);
        let near = |x: f64, z: f64| Some(frame.point(v(x * scale, 0.0, z * scale)));
        type Case = (&'static str, [SurfaceRef; 2], [bool; 2], Option<DVec3>, f64);
        let cases: [Case; 6] = [
            // (2 + ½)² = ρ² + ½².
            (
                "plane, sphere",
                [ground.clone(), ball(0.0, 2.0)],
                out,
                None,
                6f64.sqrt(),
            ),
            // Radii 2 and 1.5, centres 2.5 apart: x of the intersection of circles of radii 2.5 and 2.
            ("spheres", [ball(0.0, 2.0), ball(2.5, 1.5)], out, None, {
                let x: f64 = (2.5f64.powi(2) - 2f64.powi(2) + 2.5f64.powi(2)) / 5.0;
                (2.5f64.powi(2) - x * x).sqrt()
            }),
            (
                "sphere, cylinder",
                [ball(0.0, 2.0), pipe.clone()],
                out,
                near(2.0, 1.5),
                2.0,
            ),
            // Under the plane z = 2, outside of the cone ρ = z: height 1.5, (ρ - 1.5)/√2 = ½.
            (
                "plane, cone",
                [top, cone],
                [false, true],
                None,
                1.5 + 0.5f64.sqrt(),
            ),
            // Outwards of the tube: (ρ - 4)² + ½² = 1.5².
            (
                "plane, torus",
                [ground.clone(), ring.clone()],
                out,
                near(6.0, 0.0),
                4.0 + 2f64.sqrt(),
            ),
            // Between the pipe of radius 1.5 and the tube, whose innermost radius is 3: ρ = 2 is too far in.
            (
                "torus, sphere",
                [ring, ball(0.0, 3.0)],
                out,
                near(4.0, 2.0),
                {
                    // Circles of radius 1.5 about (4, 0) and 3.5 about (0, 0).
                    (4f64.powi(2) + 3.5f64.powi(2) - 1.5f64.powi(2)) / 8.0
                },
            ),
        ];
        for (name, supports, side, near, expected) in cases {
            let f = fillet(&supports, r, side, near);
            certify(&f, &supports, size);
            let gap = major(&f) / scale - expected;
            assert!(gap.abs() < 1e-13 * 12.0, "{name}: {gap:e}");
            let closed = f.point([0.0, 0.3]).distance(f.point([1.0, 0.3]));
            assert!(closed < 1e-14 * size, "{name}: {closed:e}");
            if scale == 1.0 {
                laws::surface(&f);
            }
            if scale != 1.0 {
                continue;
            }
            let swapped = [supports[1].clone(), supports[0].clone()];
            let g = fillet(&swapped, r, [side[1], side[0]], near);
            certify(&g, &swapped, size);
            assert!((major(&g) - major(&f)).abs() < 1e-13 * size, "{name}");
            let flipped: [SurfaceRef; 2] = [
                Arc::new(Swapped::new(supports[0].clone())),
                supports[1].clone(),
            ];
            certify(
                &fillet(&flipped, r, [!side[0], side[1]], near),
                &flipped,
                size,
            );
        }
    }
}

#[test]
fn a_part_of_a_support_has_its_part_of_the_torus() {
    let frame = askew(1.0);
    // A quarter of a sphere's turn.
    let part = quadric(
        QuadricShape::Sphere,
        &[2.0],
        frame,
        [Some([0.3, 0.3 + FRAC_PI_2]), None],
    );
    let supports = [floor(&frame, 0.0, 9.0), part];
    let f = fillet(&supports, 0.5, [true, true], None);
    certify(&f, &supports, 12.0);
    laws::surface(&f);
    let angle = |u: f64| {
        let c = frame.coordinates(f.ball(u).0);
        c.y.atan2(c.x)
    };
    let mut ends = [angle(0.0), angle(1.0)];
    ends.sort_by(f64::total_cmp);
    assert!((ends[0] - 0.3).abs() < 1e-12 && (ends[1] - 0.3 - FRAC_PI_2).abs() < 1e-12);
    // u is in proportion to the angle.
    assert!((angle(0.5) - 0.3 - FRAC_PI_2 / 2.0).abs() < 1e-12);
    // A floor that ends beside the circle: one arc is left, as far as the contact stays on the floor.
    let at = |x: f64, y: f64| frame.point(v(x, y, 0.0));
    let narrow = bilinear([
        [at(-9.0, -9.0), at(-9.0, 9.0)],
        [at(1.0, -9.0), at(1.0, 9.0)],
    ]);
    let supports = [Arc::new(narrow.unwrap()) as SurfaceRef, sphere(frame, 2.0)];
    let f = fillet(&supports, 0.5, [true, true], None);
    certify(&f, &supports, 12.0);
    for u in [0.0, 1.0] {
        assert!((frame.coordinates(f.point([u, 0.0])).x - 1.0).abs() < 1e-12);
    }
    let turn = TAU - 2.0 * (1.0 / 6f64.sqrt()).acos();
    let sector = major(&f) * turn;
    let n = 400;
    let centre = |i: i32| f.ball(f64::from(i) / f64::from(n)).0;
    let length: f64 = (0..n).map(|i| centre(i).distance(centre(i + 1))).sum();
    assert!((length - sector).abs() < 1e-4 * sector, "{length} {sector}");
}

#[test]
fn parallel_cylinders_have_cylinders() {
    let frame = askew(1.0);
    let beside = frame.moved_to(frame.point(v(3.0, 0.0, 0.5)));
    let tube =
        |f: Frame, r: f64, z: [f64; 2]| quadric(QuadricShape::Cylinder, &[r], f, [None, Some(z)]);
    let supports = [tube(frame, 2.0, [0.0, 4.0]), tube(beside, 1.5, [-1.0, 2.0])];
    for y in [-1.0, 1.0] {
        let f = fillet(
            &supports,
            0.5,
            [true, true],
            Some(frame.point(v(2.0, 2.0 * y, 1.0))),
        );
        certify(&f, &supports, 12.0);
        laws::surface(&f);
        assert!(f.to_nurbs().is_some());
        // Circles of radii 2.5 and 2 about points 3 apart.
        let x = (2.5f64.powi(2) - 4.0 + 9.0) / 6.0;
        let h = y * (2.5f64.powi(2) - x * x).sqrt();
        let mut ends = [0.0, 1.0].map(|u| frame.coordinates(f.ball(u).0));
        ends.sort_by(|a, b| a.z.total_cmp(&b.z));
        assert!(ends[0].distance(v(x, h, 0.0)) < 1e-12, "{}", ends[0]);
        assert!(ends[1].distance(v(x, h, 2.5)) < 1e-12, "{}", ends[1]);
    }
}

#[test]
fn nearly_one_axis_is_not_one() {
    let frame = askew(1.0);
    let supports = [
        floor(&frame, 0.0, 9.0),
        quadric(
            QuadricShape::Cone,
            &[1.0, 1.0, 1.0],
            Frame::along(frame.point(DVec3::Z * -1.0), frame.z() + frame.x() * 1e-7).unwrap(),
            [None, Some([0.2, 4.0])],
        ),
    ];
    let f = fillet(&supports, 0.3, [true, true], None);
    assert_eq!(f.elementary(), None);
    let error = f.contact_error(0.3).unwrap();
    assert!(error < 1e-12, "{error:e}");
}

/// A quarter of a cylinder of radius 2 about the line x = y = 2 from z = 0 to 10, as the fillet between two walls.
fn quarter() -> SurfaceRef {
    let wall = |x: DVec3, y: DVec3| -> SurfaceRef {
        Arc::new(bilinear([[DVec3::ZERO, y], [x, x + y]]).unwrap())
    };
    let walls = [
        wall(DVec3::Y * 10.0, DVec3::Z * 10.0),
        wall(DVec3::Z * 10.0, DVec3::X * 10.0),
    ];
    let f: SurfaceRef = Arc::new(fillet(&walls, 2.0, [true, true], None));
    assert!(matches!(f.elementary(), Some(Elementary::Cylinder { .. })));
    f
}

#[test]
fn along_a_part_of_a_cylinder_the_ball_ends_where_it_ends() {
    let strip = quarter();
    // Onto a floor: a quarter of a torus, whose centre line is a quarter of a circle of radius 2 - 1/2.
    let supports = [strip.clone(), floor(&Frame::WORLD, 0.0, 10.0)];
    let f = fillet(&supports, 0.5, [true, true], None);
    certify(&f, &supports, 10.0);
    assert!((major(&f) - 1.5).abs() < 1e-12);
    let mut length = 0.0;
    let n = 256;
    for i in 0..=n {
        let u = f64::from(i) / f64::from(n);
        let (c, _) = f.ball(u);
        assert!(c.x < 2.0 + 1e-9 && c.y < 2.0 + 1e-9, "{c}");
        if i > 0 {
            length += f.ball(u - 1.0 / f64::from(n)).0.distance(c);
        }
    }
    assert!((length - 1.5 * FRAC_PI_2).abs() < 1e-4, "{length}");
    // The same as an image, and with the supports exchanged.
    let swapped = [supports[1].clone(), supports[0].clone()];
    let g = fillet(&swapped, 0.5, [true, true], None);
    for e in [0.0, 1.0] {
        let ends = [f.ball(0.0).0, f.ball(1.0).0];
        let c = g.ball(e).0;
        assert!(ends.iter().any(|p| p.distance(c) < 1e-9), "{c}");
    }
}

#[test]
fn a_plane_along_a_part_of_a_cylinder_is_touched_where_that_part_is() {
    let strip = quarter();
    // A wall y = 1 whose normal is -y: the ball's centre is at y = 0.7, 1.7 from the axis, on the side of the strip.
    let plane = |y: f64| -> SurfaceRef {
        let at = |x: f64, z: f64| v(x, y, z);
        Arc::new(
            bilinear([
                [at(-9.0, 0.0), at(-9.0, 10.0)],
                [at(9.0, 0.0), at(9.0, 10.0)],
            ])
            .unwrap(),
        )
    };
    let wall = plane(1.0);
    assert!(matches!(
        wall.elementary(),
        Some(Elementary::Plane { normal, .. }) if normal.y < -0.5
    ));
    let supports = [wall, strip.clone()];
    let f = fillet(&supports, 0.3, [true, true], None);
    certify(&f, &supports, 10.0);
    let x = 2.0 - (1.7f64 * 1.7 - 1.3 * 1.3).sqrt();
    for u in [0.0, 0.3, 1.0] {
        let (c, _) = f.ball(u);
        assert!(v(c.x - x, c.y - 0.7, 0.0).length() < 1e-12, "{c}");
    }
    // Exactly a NURBS surface, as along a whole cylinder.
    assert!(f.to_nurbs().is_some());
    // At y = 3.6 the ball would touch the cylinder only where the strip is not.
    let beyond = [plane(3.6), strip];
    let options = FilletOptions {
        side: Some([true, true]),
        ..Default::default()
    };
    assert!(Fillet::new(&beyond[0], &beyond[1], Radius::Constant(0.3), options).is_err());
}
