//! Fillets between any two surfaces, by following the ball: closed forms, agreement with the fillets that have a formula,
//! the certificate, bad input.

#![allow(clippy::unwrap_used)]

use nappe::basis::{ExpressionFunctions, FunctionsRef};
use nappe::expr::Expr;
use nappe::laws::{self, Random};
use nappe::query::{Finder, FinderOptions};
use nappe::surface::{
    Fillet, FilletError, FilletOptions, Quadric, QuadricOptions, QuadricShape, Radius, SurfaceRef,
    bilinear, normal_at,
};
use nappe::{DVec3, Frame, Limit, NurbsSurface, Surface};
use std::sync::Arc;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// The rectangle with a corner, spanned by two vectors.
fn plane(corner: DVec3, a: DVec3, b: DVec3) -> SurfaceRef {
    Arc::new(bilinear([[corner, corner + b], [corner + a, corner + a + b]]).unwrap())
}

fn quadric(
    shape: QuadricShape,
    axes: &[f64],
    frame: Frame,
    heights: Option<[f64; 2]>,
) -> SurfaceRef {
    let options = QuadricOptions {
        frame,
        range: [None, heights],
    };
    Arc::new(Quadric::new(shape, axes, options).unwrap())
}

fn cylinder(frame: Frame, radius: f64, heights: [f64; 2]) -> SurfaceRef {
    quadric(QuadricShape::Cylinder, &[radius], frame, Some(heights))
}

fn expression(text: &str) -> Radius {
    let bound = Expr::parse(text).unwrap().bind(&["u"], &[]).unwrap();
    let f: FunctionsRef = Arc::new(ExpressionFunctions::new([bound], [0.0, 1.0]).unwrap());
    Radius::Along(f)
}

fn sides(side: [bool; 2]) -> FilletOptions {
    FilletOptions {
        side: Some(side),
        ..Default::default()
    }
}

fn traced(s: &[SurfaceRef; 2], radius: Radius, options: FilletOptions) -> Fillet {
    Fillet::traced(&s[0], &s[1], radius, options).unwrap_or_else(|e| panic!("{e}"))
}

fn refused(s: &[SurfaceRef; 2], radius: Radius, options: FilletOptions) -> FilletError {
    Fillet::traced(&s[0], &s[1], radius, options).unwrap_err()
}

/// Every ball touches both supports, by enclosures and by the nearest points of the supports; every point is on its ball, with
/// the ball's normal; the contacts are those of the parameter curves, and the supports have the ball's normals there.
fn certify(f: &Fillet, supports: &[SurfaceRef; 2], size: f64) {
    let finders = [0, 1].map(|k| Finder::new(&supports[k..=k], FinderOptions::default()).unwrap());
    for i in 0..=30 {
        let u = i as f64 / 30.0;
        let (centre, r) = f.ball(u);
        let error = f.contact_error(u).unwrap();
        assert!(error <= 2e-13 * size, "contacts at {u}: {error:e}");
        for (k, finder) in finders.iter().enumerate() {
            let nearest = finder.nearest(centre).unwrap();
            let gap = nearest.distance - r;
            assert!(
                gap.abs() <= nearest.certainty.error() + 1e-13 * size,
                "the ball at {u} is {gap:e} from support {k}"
            );
        }
        for j in 0..=8 {
            let b = j as f64 / 8.0;
            let limit = [
                if u < 1.0 { Limit::Above } else { Limit::Below },
                Limit::Above,
            ];
            let jet = f.jet([u, b], limit, 1);
            let to_centre = centre - jet.point();
            assert!((to_centre.length() - r).abs() <= 1e-13 * size, "{u} {b}");
            let n = jet.normal().unwrap();
            assert!((n - to_centre / r).length() < 1e-8, "normal at {u}, {b}");
        }
        for k in 0..2 {
            let mut uv = [0.0; 2];
            let limit = if u < 1.0 { Limit::Above } else { Limit::Below };
            f.contacts(k).unwrap().jet_into(u, limit, 0, &mut uv);
            let p = f.point([u, k as f64]);
            let there = supports[k].point(uv);
            assert!((p - there).length() <= 1e-13 * size, "contact {k} at {u}");
            let n = normal_at(supports[k].as_ref(), uv, Default::default())
                .vector()
                .unwrap();
            let kink = n.cross((centre - p) / r).length();
            assert!(kink < 1e-9, "contact {k} at {u}: {kink:e}");
        }
    }
}

#[test]
fn a_ball_on_a_plane_and_a_sphere_sweeps_a_torus() {
    for (scale, shift) in [
        (1.0, DVec3::ZERO),
        (1e-6, DVec3::ZERO),
        (1e6, DVec3::ZERO),
        (1.0, v(1e3, -2e3, 5e2)),
    ] {
        let frame = Frame::along(shift + v(0.1, 0.2, 0.5) * scale, v(0.3, 0.9, 0.2)).unwrap();
        let sphere = quadric(QuadricShape::Sphere, &[2.0 * scale], frame, None);
        let floor = plane(
            shift + v(-5.0, -5.0, 0.0) * scale,
            DVec3::X * 10.0 * scale,
            DVec3::Y * 10.0 * scale,
        );
        let supports = [floor, sphere];
        let r = 0.4 * scale;
        let f = Fillet::new(
            &supports[0],
            &supports[1],
            Radius::Constant(r),
            Default::default(),
        )
        .unwrap();
        let size = 10.0 * scale + shift.length();
        if scale == 1e-6 {
            laws::surface_with(&f, 20);
        }
        certify(&f, &supports, size);
        // The centre is at the height r, at R + r from the sphere's.
        let major = ((2.0 * scale + r).powi(2) - (0.5 * scale - r).powi(2)).sqrt();
        for i in 0..=40 {
            for j in 0..=10 {
                let p = f.point([i as f64 / 40.0, j as f64 / 10.0]) - shift;
                let ring = (p.x - 0.1 * scale).hypot(p.y - 0.2 * scale) - major;
                assert!((ring.hypot(p.z - r) - r).abs() < 1e-14 * size, "{i} {j}");
            }
        }
        let gap = f.point([0.0, 0.3]) - f.point([1.0, 0.3]);
        assert!(gap.length() < 1e-13 * size, "closed");
    }
}

#[test]
fn between_planes_it_is_the_fillet_with_a_formula() {
    // A plane as a cubic net with uneven parameters, so that nothing is straight in them.
    let bent = |corner: DVec3, a: DVec3, b: DVec3| -> SurfaceRef {
        let s = [0.0, 0.2, 0.7, 1.0];
        let points: Vec<DVec3> = s
            .iter()
            .flat_map(|&x| {
                s.iter()
                    .map(move |&y| corner + a * x + b * (y + 0.1 * x * (1.0 - x) * y * (1.0 - y)))
            })
            .collect();
        Arc::new(NurbsSurface::bezier(4, &points, None).unwrap())
    };
    let up = v(0.0, 0.4, 0.8);
    let supports = [
        bent(DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 3.0),
        bent(DVec3::ZERO, up * 3.0, DVec3::X * 4.0),
    ];
    for radius in [
        Radius::Constant(0.3),
        expression("0.3+0.1*sin(3*u)"),
        expression("0.2+0.2*max(u-0.5,0)^2"),
    ] {
        let exact = Fillet::new(
            &supports[0],
            &supports[1],
            radius.clone(),
            Default::default(),
        )
        .unwrap();
        assert!(exact.contacts(0).is_none(), "a formula");
        let f = traced(&supports, radius.clone(), Default::default());
        laws::surface_with(&f, 20);
        certify(&f, &supports, 4.0);
        // A variable radius is here a function of the length of the centre's path, not of the edge.
        let Radius::Constant(_) = radius else {
            continue;
        };
        for i in 0..=40 {
            let u = i as f64 / 40.0;
            let (a, b) = (f.ball(u), exact.ball(u));
            assert!(
                (a.0 - b.0).length() < 1e-13 && (a.1 - b.1).abs() < 1e-14,
                "{u}"
            );
            assert!((f.point([u, 0.4]) - exact.point([u, 0.4])).length() < 1e-13);
        }
    }
}

/// A sheet curved across and extruded along x from 0 to 4, of a degree along x with one inner knot.
fn extruded(degree: usize, knot: f64) -> SurfaceRef {
    let n = degree + 2;
    let mut knots = vec![0.0; degree + 1];
    knots.push(knot);
    knots.extend(vec![1.0; degree + 1]);
    // Greville's abscissae: x is linear in the parameter.
    let along = |i: usize| 4.0 * knots[i + 1..=i + degree].iter().sum::<f64>() / degree as f64;
    let across = [v(0.0, -1.0, 0.3), v(0.0, 1.0, -0.3), v(0.0, 3.0, 0.5)];
    let points: Vec<DVec3> = (0..n)
        .flat_map(|i| across.map(|p| p + DVec3::X * along(i)))
        .collect();
    let bezier = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    Arc::new(NurbsSurface::new([degree, 2], [knots.clone(), bezier], &points, None).unwrap())
}

#[test]
fn a_node_of_the_table_may_lie_on_a_break_of_a_support() {
    let wall = plane(v(0.0, 0.0, -1.0), DVec3::Z * 5.0, DVec3::X * 4.0);
    for degree in 1..=3 {
        for knot in [0.25, 0.3, 0.5, 0.75] {
            let supports = [extruded(degree, knot), wall.clone()];
            let f = traced(&supports, Radius::Constant(0.3), Default::default());
            laws::surface_with(&f, 20);
            certify(&f, &supports, 5.0);
            // Every section is the first one, moved along -x.
            for i in 0..=64 {
                let u = i as f64 / 64.0;
                for b in [0.0, 0.4, 1.0] {
                    let moved = f.point([u, b]) - f.point([0.0, b]);
                    let away = (moved + DVec3::X * 4.0 * u).length();
                    assert!(away < 1e-12, "{degree} {knot}: {moved} at {u}, {b}");
                }
            }
        }
    }
}

#[test]
fn a_contact_that_leaves_between_two_places_of_the_table_is_noticed() {
    let frame = Frame::along(v(0.1, 0.2, 0.5), v(0.3, 0.9, 0.2)).unwrap();
    let sphere = quadric(QuadricShape::Sphere, &[2.0], frame, None);
    // The contacts lie on a circle about (0.1, 0.2).
    let ring = (2.4f64.powi(2) - 0.1f64.powi(2)).sqrt();
    for depth in [1e-5, 6e-6, 1e-6, 1e-8] {
        let end = 0.1 + ring - depth;
        let low = v(-5.0, -5.0, 0.0);
        let floor = plane(low, DVec3::X * (end + 5.0), DVec3::Y * 10.0);
        let supports = [floor, sphere.clone()];
        let made = Fillet::traced(
            &supports[0],
            &supports[1],
            Radius::Constant(0.4),
            Default::default(),
        );
        match made {
            Err(FilletError::Leaves { index, place, .. }) => {
                let top = v(0.1 + ring, 0.2, 0.4);
                assert!(index == 0 && (place - top).length() < 0.02, "{place}");
            }
            // From the end of the floor to the end.
            Ok(f) => {
                for u in [0.0, 1.0] {
                    let p = f.point([u, 0.0]);
                    assert!((p.x - end).abs() < 1e-9, "{depth}: {p} at {u}");
                }
            }
            Err(e) => panic!("{depth}: {e}"),
        }
        // The same line as a knot line.
        let share = (end + 5.0) / 10.0;
        let points: Vec<DVec3> = [0.0, share, 1.0]
            .iter()
            .flat_map(|x| [0.0, 1.0].map(|y| low + v(10.0 * x, 10.0 * y, 0.0)))
            .collect();
        let knots = [vec![0.0, 0.0, share, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]];
        let net = NurbsSurface::new([1, 1], knots, &points, None).unwrap();
        let supports = [Arc::new(net) as SurfaceRef, sphere.clone()];
        let f = traced(&supports, Radius::Constant(0.4), Default::default());
        certify(&f, &supports, 10.0);
        let gap = f.point([0.0, 0.3]) - f.point([1.0, 0.3]);
        assert!(gap.length() < 1e-12, "closed");
        // Beyond the knot line the contact goes as far as the circle.
        let reach = |u: f64| f.point([u, 0.0]).x;
        let n = 2000;
        let at = |i: usize| i as f64 / n as f64;
        let top = (0..=n).max_by(|&a, &b| reach(at(a)).total_cmp(&reach(at(b))));
        let top = at(top.unwrap());
        let [mut lo, mut hi] = [(top - at(1)).max(0.0), (top + at(1)).min(1.0)];
        for _ in 0..80 {
            let [a, b] = [lo + (hi - lo) / 3.0, hi - (hi - lo) / 3.0];
            if reach(a) < reach(b) {
                lo = a;
            } else {
                hi = b;
            }
        }
        let most = reach(0.5 * (lo + hi)).max(reach(0.0));
        let short = 0.1 + ring - most;
        assert!(short.abs() < 1e-10, "{depth}: {short:e} short");
    }
}

/// A thick pipe and a thin one out of it, both whole, with seams.
fn pipes() -> [SurfaceRef; 2] {
    let along = |axis| Frame::along(DVec3::ZERO, axis).unwrap();
    [
        cylinder(along(DVec3::X), 2.0, [-5.0, 5.0]),
        cylinder(along(DVec3::Z), 1.2, [0.0, 5.0]),
    ]
}

#[test]
fn a_closed_path_needs_a_closed_radius() {
    let supports = pipes();
    // The sine of the rounded 2π is not 0.
    let radius = expression("0.2+0.1*sin(2*pi*u)");
    let f = traced(&supports, radius, sides([true, true]));
    let [a, b] = [(0.0, Limit::Above), (1.0, Limit::Below)].map(|(u, limit)| {
        assert!((f.ball(u).1 - 0.2).abs() < 1e-15);
        f.jet([u, 0.3], [limit, Limit::Above], 1).d
    });
    assert_ne!(f.ball(0.0).1, f.ball(1.0).1, "closed by rounding only");
    for k in 0..3 {
        assert!((a[k] - b[k]).length() < 1e-10, "{k}: {} and {}", a[k], b[k]);
    }
    // The contacts jump where they pass the seam of their cylinder, and only there.
    for k in 0..2 {
        let contacts = f.contacts(k).unwrap();
        let inner = &contacts.breaks()[1..contacts.breaks().len() - 1];
        let at = |u: f64, limit: Limit| {
            let mut uv = [0.0; 2];
            contacts.jet_into(u, limit, 0, &mut uv);
            uv
        };
        for b in inner {
            let [p, q] = [at(b.at, Limit::Below), at(b.at, Limit::Above)];
            let jump = (p[0] - q[0]).abs().max((p[1] - q[1]).abs());
            assert_eq!(b.smooth == -1, jump > 1e-9, "{k}: {jump} at {}", b.at);
        }
    }
    let e = refused(&supports, expression("0.4+0.1*u"), sides([true, true]));
    assert_eq!(e, FilletError::Unclosed { from: 0.4, to: 0.5 });
    let nowhere = FilletOptions {
        near: Some(DVec3::NAN),
        ..sides([true, true])
    };
    let e = refused(&supports, Radius::Constant(0.4), nowhere);
    assert!(matches!(e, FilletError::Near { .. }), "{e}");
}

#[test]
fn round_a_cylinder_it_is_the_fillet_with_a_formula() {
    let frame = Frame::along(v(0.5, -0.2, 0.0), DVec3::Z).unwrap();
    let f = Frame::along(DVec3::ZERO, v(0.3, -0.1, 1.0)).unwrap();
    let floor = plane(f.point(v(-6.0, -6.0, 0.0)), f.x() * 12.0, f.y() * 12.0);
    let supports = [floor, cylinder(frame, 2.0, [-4.0, 4.0])];
    for side in [[true, true], [true, false], [false, true]] {
        let radius = Radius::Constant(0.3);
        let exact = Fillet::new(&supports[0], &supports[1], radius.clone(), sides(side)).unwrap();
        let f = traced(&supports, radius, sides(side));
        laws::surface_with(&f, 20);
        certify(&f, &supports, 12.0);
        let options = FinderOptions {
            tol: Some(1e-13),
            ..Default::default()
        };
        let finder = Finder::new(&[Arc::new(exact) as SurfaceRef], options).unwrap();
        for i in 0..=40 {
            let p = f.point([i as f64 / 40.0, 0.3]);
            let d = finder.nearest(p).unwrap();
            assert!(d.distance <= 1e-12, "{i}: {}", d.distance);
        }
    }
}

#[test]
fn two_pipes_have_closed_fillets() {
    let supports = pipes();
    let thick = supports[0].clone();
    for (radius, side) in [
        (Radius::Constant(0.4), [true, true]),
        (Radius::Constant(0.3), [false, true]),
        (expression("0.4+0.1*cos(2*pi*u)"), [true, true]),
    ] {
        let f = traced(&supports, radius, sides(side));
        laws::surface_with(&f, 20);
        certify(&f, &supports, 5.0);
        let gap = f.point([0.0, 0.3]) - f.point([1.0, 0.3]);
        assert!(gap.length() < 1e-12);
        // The ball's centre is at both distances from both axes.
        for i in 0..=50 {
            let (c, r) = f.ball(i as f64 / 50.0);
            let sign = if side[0] { 1.0 } else { -1.0 };
            assert!((c.y.hypot(c.z) - 2.0 - sign * r).abs() < 1e-13);
            assert!((c.x.hypot(c.y) - 1.2 - r).abs() < 1e-13);
        }
    }
    // A pipe through the thick one: two fillets.
    let through = cylinder(
        Frame::along(DVec3::ZERO, DVec3::Z).unwrap(),
        1.2,
        [-5.0, 5.0],
    );
    let supports = [thick, through];
    let FilletError::Several { count, places } =
        refused(&supports, Radius::Constant(0.4), Default::default())
    else {
        panic!("two fillets")
    };
    assert_eq!((count, places.len()), (2, 2));
    for z in [-2.0, 2.0] {
        let near = FilletOptions {
            near: Some(v(0.0, 0.0, z)),
            ..Default::default()
        };
        let f = traced(&supports, Radius::Constant(0.4), near);
        assert!(f.ball(0.3).0.z * z > 0.0);
    }
}

/// A wavy sheet over a rectangle, from a net of heights.
fn wavy(random: &mut Random, corner: DVec3, a: DVec3, b: DVec3, height: f64) -> SurfaceRef {
    let n = 6;
    let normal = a.cross(b).normalize();
    let share = |i: usize| i as f64 / (n - 1) as f64;
    let points: Vec<DVec3> = (0..n * n)
        .map(|k| {
            let h = height * (random.unit() - 0.5);
            corner + a * share(k / n) + b * share(k % n) + normal * h
        })
        .collect();
    let mut knots = vec![0.0; 4];
    knots.extend([1.0 / 3.0, 2.0 / 3.0]);
    knots.extend([1.0; 4]);
    Arc::new(NurbsSurface::new([3, 3], [knots.clone(), knots], &points, None).unwrap())
}

#[test]
fn fifty_random_pairs_have_their_certificate() {
    let mut random = Random(5);
    let mut made = 0;
    for k in 0..50 {
        let tilt = 0.6 + 0.8 * random.unit();
        let floor = wavy(
            &mut random,
            v(-1.0, -2.0, 0.0),
            DVec3::X * 6.0,
            DVec3::Y * 6.0,
            0.5,
        );
        let up = v(0.0, tilt.cos(), tilt.sin());
        let wall = wavy(&mut random, up * -2.0, up * 5.0, DVec3::X * 4.0, 0.5);
        let supports = [floor, wall];
        let radius = if k % 2 == 0 {
            Radius::Constant(0.2 + 0.2 * random.unit())
        } else {
            expression("0.25+0.1*sin(4*u)")
        };
        let f = traced(&supports, radius, sides([true, true]));
        certify(&f, &supports, 6.0);
        if k < 2 {
            laws::surface_with(&f, 20);
        }
        made += 1;
    }
    assert_eq!(made, 50);
}

#[test]
fn a_ball_that_does_not_fit_is_refused_with_the_place() {
    let floor = plane(v(-5.0, -5.0, 0.0), DVec3::X * 10.0, DVec3::Y * 10.0);
    // Inside a cylinder of radius 2.
    let tube = cylinder(Frame::WORLD, 2.0, [-4.0, 4.0]);
    let inside = sides([true, false]);
    let supports = [floor, tube];
    traced(&supports, Radius::Constant(1.0), inside);
    // Beyond the axis a larger ball would touch it as well, from the wrong side of its curvature.
    let e = refused(&supports, Radius::Constant(2.5), inside);
    let FilletError::CutsIn {
        index: 1, largest, ..
    } = e
    else {
        panic!("{e}")
    };
    assert!((largest - 2.0).abs() < 1e-9, "{largest}");
    // Inside an elliptic one, whose radius of curvature is 0.5 at the ends of its long axis.
    let oval = quadric(
        QuadricShape::Cylinder,
        &[2.0, 1.0],
        Frame::WORLD,
        Some([-4.0, 4.0]),
    );
    let supports = [supports[0].clone(), oval];
    traced(&supports, Radius::Constant(0.4), inside);
    let e = refused(&supports, Radius::Constant(0.6), inside);
    let FilletError::CutsIn {
        index,
        place,
        largest,
        ..
    } = e
    else {
        panic!("{e}")
    };
    assert_eq!(index, 1);
    assert!((0.5 - 1e-9..0.55).contains(&largest), "{largest}");
    assert!(
        place.x.abs() > 1.0 && (place.z - 0.6).abs() < 1e-9,
        "{place}"
    );
    // Two spheres with a gap of 1: the ball between them has a radius of at least 0.5.
    let ball = |x: f64| {
        let frame = Frame::along(v(x, 0.0, 0.0), DVec3::X).unwrap();
        quadric(QuadricShape::Sphere, &[1.0], frame, None)
    };
    let spheres = [ball(0.0), ball(3.0)];
    let e = refused(&spheres, Radius::Constant(0.3), Default::default());
    let FilletError::NoBall {
        fits: Some((r, _)), ..
    } = e
    else {
        panic!("{e}")
    };
    assert!((0.5..0.52).contains(&r), "{r}");
    // A sheet with a crease across the path of the ball.
    let points = [
        v(0.0, 0.0, 0.0),
        v(0.0, 4.0, 0.0),
        v(2.0, 0.0, 0.0),
        v(2.0, 4.0, 0.0),
        v(4.0, 0.0, 0.7),
        v(4.0, 4.0, 0.7),
    ];
    let knots = [vec![0.0, 0.0, 0.5, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]];
    let bent = NurbsSurface::new([1, 1], knots, &points, None).unwrap();
    let wall = plane(v(-1.0, 0.0, -1.0), DVec3::Z * 5.0, DVec3::X * 6.0);
    let supports = [Arc::new(bent) as SurfaceRef, wall];
    let e = refused(&supports, Radius::Constant(0.3), Default::default());
    assert!(
        matches!(e, FilletError::Crease { .. } | FilletError::Lost { .. }),
        "{e}"
    );
    let place = match e {
        FilletError::Crease { place, .. } | FilletError::Lost { place, .. } => place,
        _ => DVec3::NAN,
    };
    assert!((place.x - 2.0).abs() < 0.1, "{place}");
}

#[test]
fn bad_input_is_named() {
    let floor = plane(v(-5.0, -5.0, 0.0), DVec3::X * 10.0, DVec3::Y * 10.0);
    let sphere = quadric(QuadricShape::Sphere, &[2.0], Frame::WORLD, None);
    let supports = [floor, sphere];
    let part = FilletOptions {
        range: Some([0.0, 1.0]),
        ..Default::default()
    };
    assert_eq!(
        refused(&supports, Radius::Constant(0.3), part),
        FilletError::RangeOfTraced
    );
    for bad in [0.0, -1.0, f64::NAN] {
        let e = refused(&supports, Radius::Constant(bad), Default::default());
        assert!(matches!(e, FilletError::Radius { .. }), "{e}");
    }
    let e = refused(&supports, expression("u-0.5"), Default::default());
    assert!(matches!(e, FilletError::Radius { .. }), "{e}");
    // A surface with itself, and with one far away: no fillet, said without a crash.
    for pair in [
        [supports[1].clone(), supports[1].clone()],
        [
            supports[1].clone(),
            plane(v(-5.0, -5.0, 900.0), DVec3::X * 10.0, DVec3::Y * 10.0),
        ],
    ] {
        let e = refused(&pair, Radius::Constant(0.3), Default::default());
        assert!(!e.to_string().is_empty());
    }
}

/// A sheet swept along x from 0 to 4 over a polygon in (y, z).
fn folded(polygon: &[[f64; 2]]) -> SurfaceRef {
    let n = polygon.len();
    let points: Vec<DVec3> = [0.0, 4.0]
        .iter()
        .flat_map(|&x| polygon.iter().map(move |p| v(x, p[0], p[1])))
        .collect();
    let inner = (1..n - 1).map(|i| i as f64 / (n - 1) as f64);
    let knots: Vec<f64> = [0.0, 0.0]
        .into_iter()
        .chain(inner)
        .chain([1.0, 1.0])
        .collect();
    let knots = [vec![0.0, 0.0, 1.0, 1.0], knots];
    Arc::new(NurbsSurface::new([1, 1], knots, &points, None).unwrap())
}

#[test]
fn a_ball_that_cuts_through_another_part_is_refused() {
    // A gutter of width 0.8 beside a wall at y = 0.
    let supports = [
        folded(&[[-1.0, 0.0], [0.8, 0.0], [0.8, 2.0]]),
        plane(v(0.0, 0.0, -1.0), DVec3::Z * 4.0, DVec3::X * 4.0),
    ];
    let f = traced(&supports, Radius::Constant(0.35), Default::default());
    certify(&f, &supports, 4.0);
    let e = refused(&supports, Radius::Constant(0.5), Default::default());
    let FilletError::CutsThrough {
        index,
        place,
        radius,
        depth,
        ..
    } = e
    else {
        panic!("{e}")
    };
    // The centre is at y = 0.5, the far side of the gutter 0.3 from it.
    assert!(
        index == 0 && radius == 0.5 && (depth - 0.2).abs() < 1e-3,
        "{depth}"
    );
    assert!((place - v(place.x, 0.5, 0.5)).length() < 1e-9, "{place}");
}

#[test]
fn a_small_surface_beside_a_large_one_is_found() {
    let floor = plane(v(-50.0, -50.0, 0.0), DVec3::X * 100.0, DVec3::Y * 100.0);
    let frame = Frame::along(v(7.13, -3.37, 0.0), DVec3::Z).unwrap();
    let pin = quadric(QuadricShape::Cylinder, &[0.2], frame, Some([0.0, 1.0]));
    for supports in [[floor.clone(), pin.clone()], [pin, floor]] {
        let f = traced(&supports, Radius::Constant(0.05), Default::default());
        certify(&f, &supports, 100.0);
        for i in 0..=8 {
            let c = frame.coordinates(f.ball(f64::from(i) / 8.0).0);
            assert!((c.x.hypot(c.y) - 0.25).abs() < 1e-12 && (c.z - 0.05).abs() < 1e-12);
        }
    }
}

#[test]
fn a_variable_radius_need_fit_only_at_its_own_place() {
    let floor = plane(v(-5.0, -5.0, 0.0), DVec3::X * 10.0, DVec3::Y * 10.0);
    // Half of an elliptic tube: the radius of curvature is 0.5 at both ends, 4 in the middle.
    let options = QuadricOptions {
        frame: Frame::WORLD,
        range: [Some([0.0, std::f64::consts::PI]), Some([-4.0, 4.0])],
    };
    let tube = Quadric::new(QuadricShape::Cylinder, &[2.0, 1.0], options).unwrap();
    let supports = [floor, Arc::new(tube) as SurfaceRef];
    let inside = sides([true, false]);
    let e = refused(&supports, Radius::Constant(0.6), inside);
    assert!(matches!(e, FilletError::CutsIn { index: 1, .. }), "{e}");
    let f = traced(&supports, expression("0.3+0.3*sin(pi*u)"), inside);
    certify(&f, &supports, 10.0);
    assert!((f.ball(0.5).1 - 0.6).abs() < 1e-15);
    for u in [0.0, 1.0] {
        let (c, r) = f.ball(u);
        assert!((r - 0.3).abs() < 1e-15, "{r}");
        assert!((c.x.abs() - 1.7).abs() < 1e-9 && c.y.abs() < 1e-9, "{c}");
    }
}
