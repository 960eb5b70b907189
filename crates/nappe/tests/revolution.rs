//! Surfaces of revolution: the laws, direct rotation, Grigoriev's table and sections, poles, and profiles that cross.

#![allow(clippy::unwrap_used)]

use nappe::basis::BSplineBasis;
use nappe::curve::{CurveRef, Ellipse, ExpressionCurve, Spacing, polyline};
use nappe::exact::NurbsCurve;
use nappe::expr::Expr;
use nappe::laws;
use nappe::mesh::{Certainty, MeshOptions, mesh};
use nappe::surface::{
    Construction, Elementary, Revolution, RevolutionError, RevolutionOptions, Surface, jet_index,
    normal_at,
};
use nappe::{DVec3, Frame, Limit};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};
use std::sync::Arc;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn bezier(points: &[DVec3], weights: Option<&[f64]>) -> CurveRef {
    Arc::new(NurbsCurve::bezier(points, weights).unwrap())
}

fn expression(x: &str, y: &str, z: &str) -> CurveRef {
    let bound = |s: &str| Expr::parse(s).unwrap().bind(&["t"], &[]).unwrap();
    Arc::new(ExpressionCurve::new([bound(x), bound(y), bound(z)], [0.0, 1.0]).unwrap())
}

fn spline(scale: f64, shift: DVec3) -> CurveRef {
    let mut random = laws::Random(3);
    let points: Vec<_> = (0..8)
        .map(|i| shift + v(0.5 + random.unit(), 0.2 * random.unit(), i as f64) * scale)
        .collect();
    let weights: Vec<_> = (0..8).map(|_| 0.5 + random.unit()).collect();
    let knots = BSplineBasis::clamped_uniform(3, 8);
    Arc::new(NurbsCurve::new(3, knots, &points, Some(&weights)).unwrap())
}

/// A quarter circle of the XZ plane from the equator to the pole.
fn quarter(radius: f64, centre: DVec3) -> CurveRef {
    let p = [v(1.0, 0.0, 0.0), v(1.0, 0.0, 1.0), v(0.0, 0.0, 1.0)].map(|p| centre + p * radius);
    bezier(&p, Some(&[1.0, 0.5f64.sqrt(), 1.0]))
}

/// Every kind of profile: line, spline, rational arc with a pole, expression, and a curve in space.
fn profiles() -> Vec<(&'static str, CurveRef)> {
    vec![
        ("line", bezier(&[v(1.0, 0.0, 0.0), v(2.0, 0.0, 3.0)], None)),
        ("spline", spline(1.0, DVec3::ZERO)),
        ("arc", quarter(1.0, DVec3::ZERO)),
        ("expression", expression("2+cos(5*t)", "0", "3*t")),
        ("in space", expression("2+t", "sin(3*t)", "exp(t)")),
        ("pole", expression("sin(pi*t)", "0", "-cos(pi*t)")),
    ]
}

fn revolve(profile: &CurveRef, axis: Frame, options: RevolutionOptions) -> Revolution {
    Revolution::new(profile.clone(), axis, options).unwrap()
}

fn options(start: f64, angle: f64, construction: Construction) -> RevolutionOptions {
    RevolutionOptions {
        start,
        angle,
        construction,
    }
}

/// A point turned about an axis by Rodrigues' formula: independent of the frame.
fn rotate(p: DVec3, origin: DVec3, axis: DVec3, angle: f64) -> DVec3 {
    let (k, r) = (axis.normalize(), p - origin);
    origin + r * angle.cos() + k.cross(r) * angle.sin() + k * k.dot(r) * (1.0 - angle.cos())
}

#[test]
fn laws_for_every_profile_and_construction() {
    for (_, profile) in profiles() {
        for construction in [
            Construction::Angle,
            Construction::Rational,
            Construction::Coons,
        ] {
            for (start, angle) in [(0.0, TAU), (0.4, 2.0)] {
                laws::surface(&revolve(
                    &profile,
                    Frame::WORLD,
                    options(start, angle, construction),
                ));
            }
        }
        let conic = Construction::Conic { mu: 0.2 };
        laws::surface(&revolve(
            &profile,
            Frame::WORLD,
            options(0.3, 1.5 * PI, conic),
        ));
    }
}

#[test]
fn laws_at_all_scales_and_far_away() {
    for scale in [1e-6, 1.0, 1e6] {
        for shift in [DVec3::ZERO, v(1e3, -2e3, 5e2) * scale] {
            let axis = Frame::along(shift, v(0.0, 0.0, 1.0)).unwrap();
            for profile in [quarter(scale, shift), spline(scale, shift)] {
                for construction in [
                    Construction::Angle,
                    Construction::Rational,
                    Construction::Coons,
                ] {
                    laws::surface(&revolve(&profile, axis, options(0.1, 5.0, construction)));
                }
            }
        }
    }
}

#[test]
fn a_hundred_thousand_boxes() {
    let profile = expression("sin(pi*t)", "0", "-cos(pi*t)");
    let o = RevolutionOptions::default();
    laws::surface_with(&revolve(&profile, Frame::WORLD, o), 100_000);
}

#[test]
fn every_point_is_the_profiles_point_turned() {
    let (origin, axis) = (v(-4.0, 1.0, 0.5), v(1.0, -0.5, 2.0));
    let frame = Frame::along(origin, axis).unwrap();
    for (name, profile) in profiles() {
        for (start, angle) in [(0.0, TAU), (-1.0, 2.5), (0.2, 1e-3)] {
            let s = revolve(&profile, frame, options(start, angle, Construction::Angle));
            for i in 0..=20 {
                for j in 0..=20 {
                    let (a, b) = (i as f64 / 20.0, j as f64 / 20.0);
                    let d = profile.domain();
                    let u = d.lo + a * (d.hi - d.lo);
                    let want = rotate(profile.point(u), origin, axis, start + angle * b);
                    let gap = (s.point([u, b]) - want).length();
                    assert!(gap < 1e-13 * 10.0, "{name} at {u}, {b}: {gap:e}");
                }
            }
        }
    }
}

#[test]
fn chashnikovs_coons_surface_is_the_surface_of_revolution() {
    let (origin, axis) = (v(-4.0, 1.0, 0.5), v(1.0, -0.5, 2.0));
    let frame = Frame::along(origin, axis).unwrap();
    for (name, profile) in profiles() {
        for (start, angle) in [(0.0, TAU), (-1.0, 2.5), (0.2, FRAC_PI_2), (0.0, 1e-3)] {
            let [coons, direct] = [Construction::Coons, Construction::Angle]
                .map(|c| revolve(&profile, frame, options(start, angle, c)));
            let d = profile.domain();
            for i in 0..=24 {
                for j in 0..=24 {
                    let (a, b) = (i as f64 / 24.0, j as f64 / 24.0);
                    let u = d.lo + a * (d.hi - d.lo);
                    let want = rotate(profile.point(u), origin, axis, start + angle * b);
                    let gap = (coons.point([a, b]) - want).length();
                    assert!(gap < 1e-13 * 10.0, "{name} at {u}, {b}: {gap:e}");
                    let [p, q] = [(&coons, a), (&direct, u)]
                        .map(|(s, u)| s.jet([u, b], Default::default(), 2));
                    for (k, order) in [(1, 1), (2, 0), (3, 2), (4, 1), (5, 0)] {
                        let q = q.d[k] * (d.hi - d.lo).powi(order);
                        let gap = (p.d[k] - q).length();
                        let scale = 10.0 * q.length().max(10.0);
                        assert!(gap < 1e-11 * scale, "{name}: derivative {k} off by {gap:e}");
                    }
                }
            }
            assert!(coons.to_nurbs().is_none());
            assert_eq!(
                coons.to_rational().is_some(),
                direct.to_rational().is_some()
            );
        }
    }
}

#[test]
fn the_rational_form_has_the_same_points() {
    for (name, profile) in profiles() {
        for (start, angle) in [(0.0, TAU), (0.7, 2.5), (0.0, FRAC_PI_2)] {
            let by_angle = revolve(
                &profile,
                Frame::WORLD,
                options(start, angle, Construction::Angle),
            );
            let rational = by_angle.with_arcs();
            for i in 0..=10 {
                let d = profile.domain();
                let u = d.lo + (d.hi - d.lo) * i as f64 / 10.0;
                for j in 0..=24 {
                    let b = j as f64 / 24.0;
                    // The angle of a rational point, measured, is where the angle form has the same point.
                    let at = rational.point([u, b]);
                    let (p, q) = (profile.point(u), at);
                    if p.truncate().length() < 1e-12 {
                        assert!((p - q).length() < 1e-15);
                        continue;
                    }
                    let turned = (q.y.atan2(q.x) - p.y.atan2(p.x) - start).rem_euclid(TAU);
                    // An angle a little below 0 stands for 0 and one a little below a turn may be a whole one.
                    let t = [turned, turned - TAU, turned + TAU]
                        .into_iter()
                        .map(|t| t / angle)
                        .min_by(|x, y| (x - b).abs().total_cmp(&(y - b).abs()))
                        .unwrap();
                    assert!((-1e-12..=1.0 + 1e-12).contains(&t), "{name}: {t}");
                    let gap = (by_angle.point([u, t.clamp(0.0, 1.0)]) - q).length();
                    assert!(gap < 1e-13 * 5.0, "{name} at {u}, {b}: {gap:e}");
                }
            }
        }
    }
}

#[test]
fn a_nurbs_profile_gives_an_exact_nurbs_surface() {
    let n = spline(1.0, DVec3::ZERO).to_nurbs().unwrap();
    let s = revolve(
        &spline(1.0, DVec3::ZERO),
        Frame::WORLD,
        options(0.0, TAU, Construction::Rational),
    );
    let surface = s.to_nurbs().unwrap();
    assert_eq!(
        [surface.basis_u().degree(), surface.basis_v().degree()],
        [3, 2]
    );
    assert_eq!(surface.size(), [8, 9]);
    // The control net is the profile's turned, in the corners of a square.
    for (i, p) in n.control_points().into_iter().enumerate() {
        let row = &surface.control_points()[9 * i..9 * i + 9];
        assert!((row[0] - p).length() < 1e-14 && row[8] == row[0]);
        assert!((row[1] - v(p.x - p.y, p.x + p.y, p.z)).length() < 1e-14);
    }
    let by_angle = revolve(
        &spline(1.0, DVec3::ZERO),
        Frame::WORLD,
        RevolutionOptions::default(),
    );
    assert!(by_angle.to_nurbs().is_none());
    assert!(by_angle.with_arcs().to_nurbs().is_some());
}

#[test]
fn grigorievs_octant_of_the_sphere() {
    let o = options(0.0, FRAC_PI_2, Construction::Conic { mu: 0.5 });
    let octant = revolve(&quarter(1.0, DVec3::ZERO), Frame::WORLD, o);
    let n = octant.to_nurbs().unwrap();
    let points = [
        [1, 0, 0],
        [1, 1, 0],
        [0, 1, 0],
        [1, 0, 1],
        [1, 1, 1],
        [0, 1, 1],
        [0, 0, 1],
        [0, 0, 1],
        [0, 0, 1],
    ]
    .map(|[x, y, z]| v(x as f64, y as f64, z as f64));
    let h = 0.5f64.sqrt();
    let weights = [1.0, h, 1.0, h, 0.5, h, 1.0, h, 1.0];
    for k in 0..9 {
        assert!((n.control_points()[k] - points[k]).length() <= 2.0 * f64::EPSILON);
        assert!((n.weights()[k] - weights[k]).abs() <= f64::EPSILON);
    }
    assert_eq!(octant.poles(), [false, true]);
    for i in 0..=30 {
        for j in 0..=30 {
            let p = octant.point([i as f64 / 30.0, j as f64 / 30.0]);
            assert!((p.length() - 1.0).abs() < 1e-15 * 4.0);
        }
    }
}

#[test]
fn conic_sections_satisfy_grigorievs_equation() {
    let profile = expression("2+cos(5*t)", "0", "3*t");
    for mu in [0.1, 0.5, 1.0, 3.0] {
        let o = options(0.0, FRAC_PI_2, Construction::Conic { mu });
        let s = revolve(&profile, Frame::WORLD, o);
        for i in 0..=20 {
            let f = profile.point(i as f64 / 20.0);
            for j in 0..=20 {
                let p = s.point([i as f64 / 20.0, j as f64 / 20.0]);
                let (x, y) = (p.x / f.x, p.y / f.x);
                let (l, r) = ((x + y - 1.0).powi(2), 4.0 * mu * (1.0 - x) * (1.0 - y));
                assert!((l - r).abs() < 1e-14 * mu.max(1.0) && (p.z - f.z).abs() < 1e-14);
            }
        }
        // The whole surface is closed and is its own reflection in both planes.
        let o = options(0.0, TAU, Construction::Conic { mu });
        let whole = revolve(&profile, Frame::WORLD, o);
        assert_eq!(whole.point([0.3, 0.0]), whole.point([0.3, 1.0]));
        for j in 0..=40 {
            let b = j as f64 / 40.0;
            let (p, q) = (whole.point([0.3, b]), whole.point([0.3, 1.0 - b]));
            assert!((p - v(q.x, -q.y, q.z)).length() < 1e-14, "{mu} {b}");
            let q = whole.point([0.3, (1.5 - b).rem_euclid(1.0)]);
            assert!((p - v(-q.x, q.y, q.z)).length() < 1e-14, "{mu} {b}");
        }
    }
}

#[test]
fn the_turn_is_counter_clockwise_seen_from_the_tip() {
    let profile = bezier(&[v(1.0, 0.0, 0.0), v(1.0, 0.0, 1.0)], None);
    let o = options(0.0, FRAC_PI_2, Construction::Angle);
    let s = revolve(&profile, Frame::WORLD, o);
    assert!((s.point([0.0, 1.0]) - DVec3::Y).length() < 1e-15);
    // Upwards along the axis: the normal points to the axis.
    let jet = s.jet([0.5, 0.0], Default::default(), 1);
    assert!((jet.normal().unwrap() + DVec3::X).length() < 1e-15);
    assert!((jet.d[jet_index(0, 1)] - DVec3::Y * FRAC_PI_2).length() < 1e-15);
    let down = Frame::along(DVec3::ZERO, -DVec3::Z).unwrap();
    assert!((revolve(&profile, down, o).point([0.0, 1.0]) + DVec3::Y).length() < 1e-15);
}

#[test]
fn poles_collapse_exactly_and_whole_turns_close() {
    // sin(pi) is 1.2e-16, not 0: the end is moved onto the axis.
    let profile = expression("3*sin(pi*t)", "0", "-3*cos(pi*t)");
    let s = revolve(&profile, Frame::WORLD, RevolutionOptions::default());
    assert_eq!(s.poles(), [true, true]);
    for k in 0..=50 {
        let b = k as f64 / 50.0;
        assert_eq!(s.point([0.0, b]), v(0.0, 0.0, -3.0));
        assert_eq!(s.point([1.0, b]), v(0.0, 0.0, 3.0));
        assert_eq!(s.point([b, 0.0]), s.point([b, 1.0]));
    }
    let tilted = Frame::along(v(1.0, 2.0, 3.0), v(1.0, 1.0, 1.0)).unwrap();
    let p = [
        tilted.point(v(0.0, 0.0, -1.0)),
        tilted.point(v(2.0, 0.0, 0.0)),
        tilted.point(v(0.0, 0.0, 1.0)),
    ];
    let s = revolve(
        &bezier(&p, Some(&[1.0, 0.3, 2.0])),
        tilted,
        RevolutionOptions::default(),
    );
    assert_eq!(s.poles(), [true, true]);
    for u in [0.0, 1.0] {
        for k in 1..=50 {
            assert_eq!(s.point([u, 0.0]), s.point([u, k as f64 / 50.0]));
        }
    }
}

#[test]
fn crossing_profiles_are_refused_and_touching_ones_are_not() {
    let refuse = |profile: &CurveRef, axis: Frame| {
        Revolution::new(profile.clone(), axis, RevolutionOptions::default()).unwrap_err()
    };
    let line = bezier(&[v(-1.0, 0.0, 0.0), v(3.0, 0.0, 4.0)], None);
    let RevolutionError::Crosses { at, point, reach } = refuse(&line, Frame::WORLD) else {
        panic!("not a crossing")
    };
    assert!((at - 0.25).abs() < 1e-9 && (point - DVec3::Z).length() < 1e-9);
    assert!((reach - 1.0).abs() < 1e-9);
    // A crossing with three equal derivatives, and one on a tilted, distant axis.
    let cubic = expression("(t-0.6)^3", "0", "t");
    assert!(
        matches!(refuse(&cubic, Frame::WORLD), RevolutionError::Crosses { at, .. } if (at - 0.6).abs() < 1e-3)
    );
    let tilted = Frame::along(v(100.0, 200.0, 300.0), v(1.0, 1.0, 1.0)).unwrap();
    let p = [
        tilted.point(v(1.0, 1.0, 0.0)),
        tilted.point(v(-2.0, -2.0, 1.0)),
    ];
    assert!(matches!(
        refuse(&bezier(&p, None), tilted),
        RevolutionError::Crosses { .. }
    ));
    // On the axis.
    let straight = bezier(&[v(0.0, 0.0, 0.0), v(0.0, 0.0, 4.0)], None);
    assert!(matches!(
        refuse(&straight, Frame::WORLD),
        RevolutionError::OnAxis { from: 0.0, to: 1.0 }
    ));
    // Touching in between: allowed, and known.
    let touching = expression("(t-0.4)^2", "0", "t");
    let s = revolve(&touching, Frame::WORLD, RevolutionOptions::default());
    assert!(s.pinches().len() == 1 && (s.pinches()[0] - 0.4).abs() < 1e-4);
    // A stretch, with its ends: the distance 2t - 1 is below the tolerance 1e-12 a little after t = 1/2, too.
    let stretch = Arc::new(
        polyline(
            &[v(1.0, 0.0, 0.0), v(0.0, 0.0, 0.0), v(0.0, 0.0, 1.0)],
            Spacing::Uniform,
        )
        .unwrap(),
    );
    let refused = refuse(&(stretch as CurveRef), Frame::WORLD);
    assert!(
        matches!(refused, RevolutionError::OnAxis { from, to: 1.0 } if (from - 0.5).abs() < 1e-9),
        "{refused}"
    );
    // Two crossings: the part between them is what lies beyond, (1 - 4.2 t + 4.2 t²) is -0.05 at its least.
    let twice = bezier(
        &[v(1.0, 0.0, 0.0), v(-1.1, 0.0, 1.0), v(1.0, 0.0, 2.0)],
        None,
    );
    let RevolutionError::Crosses { at, reach, .. } = refuse(&twice, Frame::WORLD) else {
        panic!("not a crossing")
    };
    let root = 0.5 - (0.05f64 / 4.2).sqrt();
    assert!(
        (at - root).abs() < 1e-9 && (reach - 0.05).abs() < 1e-4,
        "{at} {reach}"
    );
    // Past the axis in space without meeting it.
    let passing = expression("2*t-1", "0.01", "t");
    let s = revolve(&passing, Frame::WORLD, RevolutionOptions::default());
    assert!(s.pinches().is_empty() && s.poles() == [false; 2]);
}

/// Profiles that touch the axis smoothly: at one place, t = 1/2; or at two, with a needle between them.
fn touching() -> Vec<(&'static str, CurveRef, Vec<f64>)> {
    let parabola = [v(2.0, 0.0, -1.0), v(-2.0, 0.0, 1.0), v(2.0, 0.0, 3.0)];
    let arc = [v(2.0, 0.0, -1.0), v(0.0, 0.0, 1.0), v(2.0, 0.0, 3.0)];
    vec![
        ("parabola", bezier(&parabola, None), vec![0.5]),
        ("arc", Arc::new(Ellipse::through(arc).unwrap()), vec![0.5]),
        (
            "needle",
            expression("((t-0.25)*(t-0.75))^2", "0", "4*t"),
            vec![0.25, 0.75],
        ),
    ]
}

#[test]
fn profiles_that_touch_the_axis_have_poles_inside() {
    let constructions = [
        Construction::Angle,
        Construction::Rational,
        Construction::Coons,
    ];
    for ((name, profile, places), construction) in touching()
        .into_iter()
        .flat_map(|t| constructions.map(|c| (t.clone(), c)))
    {
        let s = revolve(&profile, Frame::WORLD, options(0.0, TAU, construction));
        let [domain, _] = s.domain();
        assert_eq!(s.pinches().len(), places.len(), "{name}");
        for (u, place) in s.pinches().iter().zip(&places) {
            let share = (u - domain.lo) / (domain.hi - domain.lo);
            assert!((share - place).abs() < 1e-6, "{name}: {share}");
            let z = profile
                .point(profile.domain().lo + place * profile.domain().width())
                .z;
            for k in 0..8 {
                let uv = [*u, k as f64 / 8.0];
                assert!(s.point(uv).distance(DVec3::Z * z) < 1e-5, "{name}");
                // The limit of the normals is square to the axis, and the same from both sides.
                let [a, b] = [Limit::Below, Limit::Above]
                    .map(|l| normal_at(&s, uv, [l, Limit::Above]).vector().unwrap());
                assert!(
                    a.z.abs() < 1e-3 && a.distance(b) < 1e-3,
                    "{name} {construction:?}: {a} {b}"
                );
            }
        }
        let by_angle = construction == Construction::Angle;
        if by_angle {
            laws::surface(&s);
        }
        // A tolerance wider than the needle must not lose it.
        let tolerances: &[f64] = if by_angle { &[0.02, 0.002] } else { &[0.02] };
        for &tol in tolerances {
            let mesh = mesh(&[Arc::new(s.clone())], &MeshOptions::with_tol(tol)).unwrap();
            let patch = &mesh.patches[0];
            assert!(
                matches!(patch.deviation, Certainty::Bounded(e) if e <= tol),
                "{name}"
            );
            let mut edges = std::collections::HashMap::new();
            let mut heights = Vec::new();
            for t in &patch.triangles {
                let id = t.map(|v| patch.vertices[v as usize].point);
                let [a, b, c] = id.map(|i| mesh.points[i as usize]);
                let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
                let area = (b - a).cross(c - a).length();
                assert!(
                    area > 1e-9 * longest * longest,
                    "{name} {construction:?}: {a} {b} {c}"
                );
                heights.push([a.z.min(b.z).min(c.z), a.z.max(b.z).max(c.z)]);
                for (p, q) in [(id[0], id[1]), (id[1], id[2]), (id[2], id[0])] {
                    *edges.entry((p, q)).or_insert(0) += 1;
                }
            }
            // Every edge is used once in each sense, but for those of the two rims.
            assert!(edges.values().all(|&n| n == 1), "{name}");
            let ends = [profile.ends()[0].z, profile.ends()[1].z];
            for (p, q) in edges.keys().filter(|(p, q)| !edges.contains_key(&(*q, *p))) {
                let z = [p, q].map(|&i| mesh.points[i as usize].z);
                assert!(
                    ends.iter().any(|e| z.iter().all(|z| (z - e).abs() < 1e-9)),
                    "{name}: {z:?}"
                );
            }
            // Some triangle at every height.
            for k in 1..50 {
                let z = ends[0] + (ends[1] - ends[0]) * k as f64 / 50.0;
                assert!(
                    heights.iter().any(|[lo, hi]| *lo <= z && z <= *hi),
                    "{name}: none at {z}"
                );
            }
        }
    }
}

/// Straight profiles to the axis, so that the lines of a cell that meet in the pole are straight: discs and cones, with
/// neighbouring leaves of other sizes. No triangle may lose its area, also after rounding to single precision as in files.
#[test]
fn no_triangle_at_a_pole_is_without_area() {
    let line =
        |points: &[DVec3]| -> CurveRef { Arc::new(polyline(points, Spacing::Uniform).unwrap()) };
    let profiles = [
        line(&[
            v(0.0, 0.0, 0.0),
            v(1.0, 0.0, 0.0),
            v(1.0, 0.0, 2.0),
            v(0.0, 0.0, 2.0),
        ]),
        line(&[v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.5), v(0.0, 0.0, 2.0)]),
        quarter(1.0, DVec3::ZERO),
    ];
    for (profile, construction) in profiles.iter().flat_map(|p| {
        [
            Construction::Angle,
            Construction::Rational,
            Construction::Coons,
        ]
        .map(|c| (p, c))
    }) {
        let s = revolve(profile, Frame::WORLD, options(0.0, TAU, construction));
        for tol in [0.1, 0.01] {
            let mesh = mesh(&[Arc::new(s.clone())], &MeshOptions::with_tol(tol)).unwrap();
            let patch = &mesh.patches[0];
            for t in &patch.triangles {
                let corners = t.map(|v| mesh.points[patch.vertices[v as usize].point as usize]);
                for [a, b, c] in [corners, corners.map(|p| p.as_vec3().as_dvec3())] {
                    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
                    let area = (b - a).cross(c - a).length();
                    assert!(
                        area > 1e-5 * longest * longest,
                        "{construction:?} {tol}: {a} {b} {c}"
                    );
                }
            }
        }
    }
}

#[test]
fn planes_and_cylinders_are_recognised() {
    let axis = Frame::along(v(1.0, 2.0, 3.0), v(1.0, 1.0, 1.0)).unwrap();
    let about = |a: DVec3, b: DVec3| {
        let profile = bezier(&[axis.point(a), axis.point(b)], None);
        revolve(&profile, axis, RevolutionOptions::default()).elementary()
    };
    let wall = |z| about(v(2.0, 0.5, 0.0), v(2.0, 0.5, z));
    for (z, side) in [(1.0, false), (-1.0, true)] {
        let Some(Elementary::Cylinder {
            radius, outward, ..
        }) = wall(z)
        else {
            panic!("a cylinder")
        };
        assert!((radius - 4.25f64.sqrt()).abs() < 1e-14 && outward == side);
    }
    let Some(Elementary::Plane { normal, .. }) = about(v(1.0, 0.0, 0.7), v(3.0, 0.0, 0.7)) else {
        panic!("a plane")
    };
    assert!((normal - axis.z()).length() < 1e-13);
    assert_eq!(about(v(1.0, 0.0, 0.0), v(1.0 + 1e-9, 0.0, 1.0)), None);
}

#[test]
fn bad_numbers_are_refused() {
    let line = bezier(&[v(1.0, 0.0, 0.0), v(2.0, 0.0, 3.0)], None);
    let refuse = |o: RevolutionOptions| Revolution::new(line.clone(), Frame::WORLD, o).unwrap_err();
    for angle in [0.0, -1.0, 7.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            refuse(options(0.0, angle, Construction::Angle)),
            RevolutionError::Angle { .. }
        ));
    }
    assert!(matches!(
        refuse(options(f64::NAN, 1.0, Construction::Angle)),
        RevolutionError::Start { .. }
    ));
    for mu in [0.0, -1.0, f64::NAN] {
        assert!(matches!(
            refuse(options(0.0, TAU, Construction::Conic { mu })),
            RevolutionError::Mu { .. }
        ));
    }
    assert!(matches!(
        refuse(options(0.0, FRAC_PI_4, Construction::Conic { mu: 0.5 })),
        RevolutionError::Quarters { .. }
    ));
    let point = bezier(&[DVec3::ONE, DVec3::ONE], None);
    let refused = Revolution::new(point, Frame::WORLD, RevolutionOptions::default());
    assert!(matches!(refused, Err(RevolutionError::Point { .. })));
}
