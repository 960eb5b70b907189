//! The nearest point: closed forms, and brute force on surfaces without one.

use crate::{check, finder, rough, sphere, torus, within};
use nappe::curve::{CurveRef, ExpressionCurve, Spacing, polyline};
use nappe::exact::NurbsSurface;
use nappe::expr::Expr;
use nappe::laws::Random;
use nappe::query::{Finder, FinderOptions, QueryError};
use nappe::surface::{Quadric, QuadricOptions, QuadricShape, Surface, SurfaceRef, Transformed};
use nappe::{DAffine3, DVec3, Dir};
use std::sync::Arc;

#[test]
fn distances_from_spheres_and_tori_are_the_closed_forms() {
    let mut random = Random(1);
    let (ball, ring) = ([sphere(2.0)], [torus()]);
    let finders = [finder(&ball, 1e-9), finder(&ring, 1e-9)];
    for _ in 0..2000 {
        let p = within(&mut random, 6.0);
        let around = p.truncate().length() - 3.0;
        let exact = [(p.length() - 2.0).abs(), (around.hypot(p.z) - 1.0).abs()];
        for ((finder, exact), surfaces) in finders.iter().zip(exact).zip([&ball, &ring]) {
            let found = finder.nearest(p).unwrap();
            check(surfaces, p, &found, 1e-9);
            assert!(
                (found.distance - exact).abs() <= 1e-9,
                "{p}: {found:?}, {exact}"
            );
        }
    }
}

#[test]
fn no_sample_of_a_rough_surface_is_nearer() {
    let mut random = Random(2);
    for surface in [rough(3, 7, false), rough(2, 5, true), rough(5, 7, false)] {
        let surfaces = [surface];
        let surface = &surfaces[0];
        let finder = finder(&surfaces, 1e-8);
        let domain = surface.domain();
        for round in 0..200 {
            // Near the surface, and farther away.
            let uv = domain.map(|t| random.within(t));
            let p = surface.point(uv) + within(&mut random, [0.05, 1.0, 4.0][round % 3]);
            let found = finder.nearest(p).unwrap();
            check(&surfaces, p, &found, 1e-8);
            let least = found.distance - found.certainty.error();
            for _ in 0..300 {
                let at = domain.map(|t| random.within(t));
                assert!(surface.point(at).distance(p) >= least, "{p} {at:?}");
            }
            // Around the answer too.
            for _ in 0..50 {
                let near = [0, 1].map(|d| {
                    let step = 1e-3 * (2.0 * random.unit() - 1.0) * domain[d].width();
                    (found.uv[d] + step).clamp(domain[d].lo, domain[d].hi)
                });
                assert!(surface.point(near).distance(p) >= least);
            }
        }
    }
}

#[test]
fn points_beyond_edges_and_at_corners_find_these() {
    let flat: SurfaceRef = Arc::new(
        NurbsSurface::bezier(
            2,
            &[DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::X + DVec3::Y],
            None,
        )
        .unwrap(),
    );
    let finder = finder(&[flat], 1e-12);
    for (p, exact) in [
        (DVec3::new(0.3, 0.6, -2.0), DVec3::new(0.3, 0.6, 0.0)),
        (DVec3::new(-1.0, 0.25, 0.5), DVec3::new(0.0, 0.25, 0.0)),
        (DVec3::new(3.0, -2.0, 1.0), DVec3::new(1.0, 0.0, 0.0)),
    ] {
        let found = finder.nearest(p).unwrap();
        assert!(found.point.distance(exact) < 1e-12, "{found:?}");
        assert!((found.distance - p.distance(exact)).abs() < 1e-12);
    }
}

#[test]
fn the_pole_is_found_and_the_middle_of_a_sphere_is_told_honestly() {
    let surfaces = [sphere(1.0)];
    let up = finder(&surfaces, 1e-7).nearest(DVec3::Z * 3.0).unwrap();
    assert!((up.distance - 2.0).abs() <= 1e-7 && up.certainty.error() <= 1e-7);
    // All points are equally near: the answer is one of them, with what is known.
    let middle = finder(&surfaces, 1e-7).nearest(DVec3::ZERO).unwrap();
    assert!((middle.distance - 1.0).abs() < 1e-12);
    assert!(middle.distance - middle.certainty.error() <= 1.0 && middle.certainty.error() < 0.05);
}

#[test]
fn scale_and_place_change_nothing() {
    let mut random = Random(3);
    let plain = rough(3, 6, false);
    for (scale, shift) in [(1e-6, 0.0), (1e6, 0.0), (1.0, 1e5)] {
        let map = DAffine3::from_scale_rotation_translation(
            DVec3::splat(scale),
            Default::default(),
            DVec3::splat(shift),
        );
        let moved: SurfaceRef = Arc::new(Transformed::new(plain.clone(), map).unwrap());
        let surfaces = [moved];
        let tol = 1e-7 * scale;
        let finder = finder(&surfaces, tol);
        for _ in 0..50 {
            let p = map.transform_point3(within(&mut random, 8.0));
            check(&surfaces, p, &finder.nearest(p).unwrap(), tol);
        }
    }
}

#[test]
fn of_several_surfaces_the_nearest_is_named_and_batches_are_the_same() {
    let mut random = Random(4);
    let shift = |by: DVec3| -> SurfaceRef {
        let map = DAffine3::from_translation(by);
        Arc::new(Transformed::new(sphere(1.0), map).unwrap())
    };
    let centres = [DVec3::ZERO, DVec3::X * 5.0, DVec3::Y * 7.0];
    let surfaces = centres.map(shift);
    let finder = finder(&surfaces, 1e-9);
    let mut points: Vec<DVec3> = (0..500).map(|_| within(&mut random, 9.0)).collect();
    points[17].y = f64::NAN;
    let one = finder.nearest_many(&points, 1);
    assert_eq!(
        format!("{one:?}"),
        format!("{:?}", finder.nearest_many(&points, 3))
    );
    for (k, (p, found)) in points.iter().zip(&one).enumerate() {
        if k == 17 {
            assert!(matches!(found, Err(QueryError::Point { .. })));
            continue;
        }
        let distance = |c: &DVec3| (p.distance(*c) - 1.0).abs();
        let exact = centres.iter().map(distance).fold(f64::INFINITY, f64::min);
        let found = found.unwrap();
        assert!((found.distance - exact).abs() <= 1e-9);
        assert!((distance(&centres[found.surface]) - exact).abs() <= 1e-9);
    }
}

#[test]
fn surfaces_with_corners_and_empty_requests() {
    let folded = polyline(
        &[DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Z],
        Spacing::Uniform,
    )
    .unwrap();
    let far = polyline(
        &[DVec3::Y, DVec3::X + DVec3::Y, DVec3::ONE],
        Spacing::Uniform,
    )
    .unwrap();
    let ruled: SurfaceRef =
        Arc::new(nappe::surface::ruled(Arc::new(folded), Arc::new(far), Dir::U).unwrap());
    let finder = finder(&[ruled], 1e-10);
    // The edge of the fold is nearest from outside.
    let found = finder.nearest(DVec3::new(2.0, 0.5, -1.0)).unwrap();
    assert!(found.point.distance(DVec3::new(1.0, 0.5, 0.0)) < 1e-10);
    assert!(matches!(
        Finder::new(&[], FinderOptions::default()),
        Err(QueryError::NoSurface)
    ));
    assert!(matches!(
        finder.nearest(DVec3::splat(1e300)),
        Err(QueryError::NoDistance { .. })
    ));
    let tol = Some(-1.0);
    let options = FinderOptions {
        tol,
        ..FinderOptions::default()
    };
    assert!(matches!(
        Finder::new(&[sphere(1.0)], options),
        Err(QueryError::Tolerance { .. })
    ));
}

#[test]
fn small_offsets_along_normals_are_the_distances() {
    let mut random = Random(6);
    for surface in [rough(3, 7, false), rough(2, 5, true)] {
        let surfaces = [surface];
        let surface = &surfaces[0];
        let finder = finder(&surfaces, 1e-10);
        for _ in 0..300 {
            let uv = surface.domain().map(|t| random.within(t));
            let jet = surface.jet(uv, Default::default(), 1).d;
            let normal = jet[1].cross(jet[2]).normalize();
            let height = 1e-3 * (2.0 * random.unit() - 1.0);
            let found = finder.nearest(jet[0] + normal * height).unwrap();
            assert!((found.distance - height.abs()).abs() <= 1e-10, "{uv:?}");
            assert!(found.certainty.error() <= 1e-10);
        }
    }
}

#[test]
fn no_budget_and_equal_surfaces_are_answered_honestly() {
    let mut random = Random(8);
    let surfaces: Vec<SurfaceRef> = (0..20).map(|_| torus()).collect();
    let options = FinderOptions {
        budget: 0,
        ..FinderOptions::default()
    };
    let finder = Finder::new(&surfaces, options).unwrap();
    for _ in 0..100 {
        let p = within(&mut random, 5.0);
        let found = finder.nearest(p).unwrap();
        let exact = ((p.truncate().length() - 3.0).hypot(p.z) - 1.0).abs();
        assert!(found.distance >= exact - 1e-12);
        assert!(found.distance - found.certainty.error() <= exact, "{p}");
    }
}

#[test]
fn surfaces_whose_whole_enclosure_is_infinite_are_found() {
    // Over the whole range the denominator is enclosed with zero.
    let curve = |y: f64| -> CurveRef {
        let of = |text: &str| Expr::parse(text).unwrap().bind(&["t"], &[]).unwrap();
        let curve =
            ExpressionCurve::new([of("t"), of(&y.to_string()), of("1/(1+t*t-t)")], [0.0, 1.0]);
        Arc::new(curve.unwrap())
    };
    let ruled: SurfaceRef =
        Arc::new(nappe::surface::ruled(curve(0.0), curve(1.0), Dir::U).unwrap());
    let found = finder(&[ruled], 1e-9)
        .nearest(DVec3::new(0.5, 0.5, 3.0))
        .unwrap();
    // The highest place.
    assert!(
        (found.distance - (3.0 - 4.0 / 3.0)).abs() <= 1e-9,
        "{found:?}"
    );
    assert!(found.certainty.error() <= 1e-9);
}

#[test]
fn cones_find_their_apex_and_cylinders_their_edges() {
    let options = QuadricOptions::default();
    let of = |shape, axes: &[f64]| -> SurfaceRef {
        Arc::new(Quadric::new(shape, axes, options).unwrap())
    };
    // Upwards from the apex in the origin, 45 degrees steep, up to z = 1.
    let cone = finder(&[of(QuadricShape::Cone, &[1.0, 1.0, 1.0])], 1e-9);
    // Of radius 1, from z = 0 to z = 2.
    let cylinder = finder(&[of(QuadricShape::Cylinder, &[1.0])], 1e-9);
    let mut random = Random(21);
    for _ in 0..500 {
        let p = within(&mut random, 3.0);
        let (r, z) = (p.truncate().length(), p.z);
        // The segment from (0, 0) to (1, 1).
        let s = (0.5 * (r + z)).clamp(0.0, 1.0);
        let found = cone.nearest(p).unwrap();
        assert!((found.distance - (r - s).hypot(z - s)).abs() <= 1e-9, "{p}");
        assert!(found.certainty.error() <= 1e-9, "{p}: {found:?}");
        let exact = (r - 1.0).hypot(z - z.clamp(0.0, 2.0));
        let found = cylinder.nearest(p).unwrap();
        assert!((found.distance - exact).abs() <= 1e-9, "{p}");
    }
    // Straight below the apex, where all directions meet.
    let found = cone.nearest(-2.0 * DVec3::Z).unwrap();
    assert!((found.distance - 2.0).abs() <= 1e-9 && found.certainty.error() <= 1e-9);
}

#[test]
fn newtons_method_from_many_starts_finds_nothing_nearer() {
    let mut random = Random(22);
    for (degree, points, weights) in [(3, 6, false), (2, 7, true), (4, 8, false)] {
        let surface = rough(degree, points, weights);
        let finder = finder(std::slice::from_ref(&surface), 1e-10);
        let domain = surface.domain();
        for _ in 0..40 {
            let uv = domain.map(|t| random.within(t));
            let p = surface.point(uv) + within(&mut random, 1.5);
            let found = finder.nearest(p).unwrap();
            let mut best = f64::INFINITY;
            for i in 0..=24 {
                for j in 0..=24 {
                    let start = [(0, i), (1, j)]
                        .map(|(d, k)| domain[d].lo + domain[d].width() * f64::from(k) / 24.0);
                    best = best.min(descended(surface.as_ref(), p, start));
                }
            }
            // Nothing nearer than is proven, and the answer itself is no worse than the best of all starts.
            assert!(best >= found.distance - found.certainty.error(), "{p}");
            assert!(found.distance <= best + 1e-10, "{p}: {found:?}, {best}");
        }
    }
}

/// The distance after some steps of Gauss and Newton from a place, within the domain.
fn descended(surface: &dyn Surface, p: DVec3, mut uv: [f64; 2]) -> f64 {
    let domain = surface.domain();
    let mut best = surface.point(uv).distance(p);
    for _ in 0..25 {
        let d = surface.jet(uv, Default::default(), 1).d;
        let (e, a, b) = (d[0] - p, d[1], d[2]);
        let (aa, ab, bb) = (a.dot(a), a.dot(b), b.dot(b));
        let (g, h, det) = (e.dot(a), e.dot(b), aa * bb - ab * ab);
        let step = [(ab * h - bb * g) / det, (ab * g - aa * h) / det];
        let mut share = 1.0;
        loop {
            let to = [0, 1].map(|k| (uv[k] + share * step[k]).clamp(domain[k].lo, domain[k].hi));
            let distance = surface.point(to).distance(p);
            if distance < best {
                (uv, best) = (to, distance);
                break;
            }
            share *= 0.5;
            if share < 1e-6 {
                return best;
            }
        }
    }
    best
}

/// Many points of all kinds on a few surfaces: every answer is on the surface, and no bound is above what is known.
#[test]
fn no_bound_is_violated_by_many_random_points() {
    let mut random = Random(23);
    let (ball, ring) = (finder(&[sphere(2.0)], 1e-8), finder(&[torus()], 1e-8));
    let surface = rough(3, 7, false);
    let net = finder(std::slice::from_ref(&surface), 1e-8);
    let domain = surface.domain();
    for k in 0..6_000 {
        let p = within(&mut random, [1.0, 4.0, 50.0][k % 3]);
        for (finder, exact) in [
            (&ball, (p.length() - 2.0).abs()),
            (
                &ring,
                ((p.truncate().length() - 3.0).hypot(p.z) - 1.0).abs(),
            ),
        ] {
            let found = finder.nearest(p).unwrap();
            let rounding = 1e-13 * (3.0 + p.length());
            assert!(found.distance >= exact - rounding, "{p}");
            assert!(
                found.distance - found.certainty.error() <= exact + rounding,
                "{p}"
            );
        }
        let uv = domain.map(|t| random.within(t));
        let way = within(&mut random, 0.5);
        let found = net.nearest(surface.point(uv) + way).unwrap();
        assert!(
            found.distance - found.certainty.error() <= way.length(),
            "{uv:?}"
        );
    }
}
