//! On which side of surfaces points are.

use crate::{cube, flat, rough, sphere, torus, within};
use nappe::curve::{CurveRef, ExpressionCurve, Spacing, polyline};
use nappe::expr::Expr;
use nappe::laws::Random;
use nappe::query::{FinderOptions, Sidedness, SignedFinder};
use nappe::surface::{
    Quadric, QuadricOptions, QuadricShape, Revolution, RevolutionOptions, SurfaceRef, Swapped,
    Transformed, ruled,
};
use nappe::{DAffine3, DVec3, Dir, Frame};
use std::sync::Arc;

fn signed(surfaces: &[SurfaceRef]) -> SignedFinder {
    SignedFinder::new(surfaces, FinderOptions::default()).unwrap()
}

#[test]
fn spheres_and_tori_have_an_inside_wherever_their_normals_point() {
    let mut random = Random(51);
    let over = |s: SurfaceRef| -> SurfaceRef { Arc::new(Swapped::new(s)) };
    for surfaces in [[sphere(2.0), torus()], [over(sphere(2.0)), over(torus())]] {
        let finders = surfaces.map(|s| signed(&[s]));
        for _ in 0..300 {
            let p = within(&mut random, 5.0);
            let around = p.truncate().length() - 3.0;
            for (finder, exact) in finders
                .iter()
                .zip([p.length() - 2.0, around.hypot(p.z) - 1.0])
            {
                let distance = finder.nearest(p).unwrap().distance.unwrap();
                assert!((distance - exact).abs() < 1e-7, "{p}: {distance} {exact}");
            }
        }
        // Above the poles, in the middle, and on the axis: where there is no normal, or no single nearest place.
        for (p, exact) in [
            (DVec3::Z * 3.0, 1.0),
            (DVec3::Z * 1.5, -0.5),
            (DVec3::Z * -7.0, 5.0),
            (DVec3::ZERO, -2.0),
        ] {
            let distance = finders[0].nearest(p).unwrap().distance.unwrap();
            assert!((distance - exact).abs() < 1e-7, "{p}: {distance} {exact}");
        }
        for (p, exact) in [
            (DVec3::ZERO, 2.0),
            (DVec3::Z * 4.0, 4.0),
            (DVec3::X * 3.0, -1.0),
        ] {
            let found = finders[1].nearest(p).unwrap();
            // Many points are equally near: not all parts were looked at.
            let error = found.nearest.certainty.error();
            assert!(
                error < 0.05 && (found.distance.unwrap() - exact).abs() <= error,
                "{p}: {found:?}"
            );
        }
    }
}

#[test]
fn the_cube_has_an_inside_at_edges_and_corners_too() {
    let finder = signed(&cube());
    let mut random = Random(52);
    let mut points: Vec<DVec3> = (0..1000).map(|_| within(&mut random, 2.5)).collect();
    // Straight out of corners and edges, and beside the middle.
    points.extend([
        DVec3::splat(2.0),
        DVec3::new(-2.0, 2.0, -2.0),
        DVec3::new(2.0, 0.0, 2.0),
        DVec3::new(1.5, 1.0, 0.3),
        DVec3::splat(0.3),
        DVec3::ZERO,
    ]);
    for p in points {
        let off = p.abs() - DVec3::ONE;
        let exact = off.max(DVec3::ZERO).length() + off.max_element().min(0.0);
        let distance = finder.nearest(p).unwrap().distance.unwrap();
        assert!((distance - exact).abs() < 1e-7, "{p}: {distance} {exact}");
    }
}

/// Beside a sharp edge or tip the nearest face alone would tell the wrong side.
#[test]
fn sharp_edges_and_apices_mislead_nobody() {
    // Double cones, a steep one and a flat one.
    let profiles: [&[[f64; 2]]; 2] = [
        &[[0.0, 3.0], [0.1, 0.0], [0.0, -3.0]],
        &[[0.0, 0.1], [3.0, 0.0], [0.0, -0.1]],
    ];
    let mut random = Random(53);
    for profile in profiles {
        let corners: Vec<DVec3> = profile
            .iter()
            .map(|&[r, z]| DVec3::new(r, 0.0, z))
            .collect();
        let line = polyline(&corners, Spacing::Uniform).unwrap();
        let options = RevolutionOptions::default();
        let top: SurfaceRef =
            Arc::new(Revolution::new(Arc::new(line), Frame::WORLD, options).unwrap());
        let finder = signed(&[top]);
        let [tip, rim] = [profile[0][1], profile[1][0]];
        let mut points: Vec<DVec3> = (0..300).map(|_| within(&mut random, 4.0)).collect();
        points.extend([
            DVec3::Z * 3.5,
            DVec3::X * 3.5,
            DVec3::new(3.3, 0.1, 0.2),
            DVec3::ZERO,
        ]);
        for p in points {
            let inside = p.truncate().length() / rim + p.z.abs() / tip < 1.0;
            let found = finder.nearest(p).unwrap();
            let distance = found.distance.unwrap_or_else(|| panic!("{p}: {found:?}"));
            assert_eq!(distance < 0.0, inside, "{p}: {found:?}");
        }
    }
}

/// Turned bodies with sharp edges and grooves: polygons in the half plane, seen from the origin star-shaped.
#[test]
fn random_turned_polygons_have_the_inside_of_the_polygon() {
    let mut random = Random(56);
    let mut undecided = 0;
    for _ in 0..12 {
        let corners = 8;
        let polar = |k: usize, radius: f64| {
            let (sin, cos) = (std::f64::consts::PI * k as f64 / f64::from(corners)).sin_cos();
            // From the lower tip on the axis to the upper one.
            DVec3::new(radius * sin, 0.0, -radius * cos)
        };
        let mut profile: Vec<DVec3> = (0..=corners as usize)
            .map(|k| polar(k, 0.4 + 1.6 * random.unit()))
            .collect();
        for tip in [0, corners as usize] {
            profile[tip].x = 0.0;
        }
        let line = polyline(&profile, Spacing::Uniform).unwrap();
        let options = RevolutionOptions::default();
        let body = Revolution::new(Arc::new(line), Frame::WORLD, options).unwrap();
        let finder = signed(&[Arc::new(body)]);
        for _ in 0..60 {
            let p = within(&mut random, 2.2);
            let (r, z) = (p.truncate().length(), p.z);
            // The triangle from the origin that the point is in the angle of; counter-clockwise.
            let cross = |a: DVec3, b: DVec3| a.x * b.z - a.z * b.x;
            let q = DVec3::new(r, 0.0, z);
            let side = profile
                .windows(2)
                .find(|c| cross(c[0], q) >= 0.0 && cross(q, c[1]) >= 0.0);
            let side = side.unwrap();
            let inside = cross(side[1] - side[0], q - side[0]) > 0.0;
            match finder.nearest(p).unwrap().distance {
                Some(distance) => assert_eq!(distance < 0.0, inside, "{p} {profile:?}"),
                None => undecided += 1,
            }
        }
    }
    assert!(undecided <= 3, "{undecided}");
}

#[test]
fn open_surfaces_have_the_side_of_their_normal_and_none_beyond_their_edges() {
    let plane = flat([[DVec3::ZERO, DVec3::Y], [DVec3::X, DVec3::X + DVec3::Y]]);
    let finder = signed(&[plane]);
    let distance = |p: DVec3| finder.nearest(p).unwrap().distance;
    // `r_u × r_v` is z.
    assert!((distance(DVec3::new(0.3, 0.6, 2.0)).unwrap() - 2.0).abs() < 1e-8);
    assert!((distance(DVec3::new(0.3, 0.6, -2.0)).unwrap() + 2.0).abs() < 1e-8);
    // Beyond an edge, at a corner, exactly above an edge, and on the surface.
    for p in [
        DVec3::new(-1.0, 0.5, 0.1),
        DVec3::new(3.0, 3.0, 3.0),
        DVec3::new(0.0, 0.5, 1.0),
        DVec3::new(0.5, 0.5, 0.0),
    ] {
        assert_eq!(distance(p), None, "{p}");
    }
    let mut random = Random(54);
    let surface = rough(3, 7, false);
    let finder = signed(std::slice::from_ref(&surface));
    let mut told = 0;
    for _ in 0..500 {
        let uv = surface.domain().map(|t| random.within(t));
        let jet = surface.jet(uv, Default::default(), 1).d;
        let normal = jet[1].cross(jet[2]).normalize();
        let height = 1e-3 * (2.0 * random.unit() - 1.0);
        if let Some(distance) = finder.nearest(jet[0] + normal * height).unwrap().distance {
            assert!(
                (distance - height).abs() < 1e-7,
                "{uv:?}: {distance} {height}"
            );
            told += 1;
        }
    }
    assert!(told > 480, "{told}");
}

#[test]
fn creases_have_a_side_where_both_faces_agree() {
    // A roof over the y axis with its ridge at z = 1; the normals point up.
    let [l, r, top] = [-DVec3::X, DVec3::X, DVec3::Z];
    let along = |p: DVec3| [p, p + DVec3::Y];
    let roof = [flat([along(l), along(top)]), flat([along(top), along(r)])];
    let both = signed(&roof);
    let above = both.nearest(DVec3::new(0.0, 0.5, 2.0)).unwrap();
    assert!((above.distance.unwrap() - 1.0).abs() < 1e-8);
    let below = both.nearest(DVec3::new(0.0, 0.5, 0.5)).unwrap();
    assert!(below.distance.unwrap() < 0.0);
    // One of them turned over: at the ridge they disagree, beside it each has its own.
    let turned: SurfaceRef = Arc::new(Swapped::new(roof[1].clone()));
    let mixed = signed(&[roof[0].clone(), turned]);
    assert_eq!(
        mixed.nearest(DVec3::new(0.0, 0.5, 2.0)).unwrap().distance,
        None
    );
    assert!(
        mixed
            .nearest(DVec3::new(-1.0, 0.5, 1.0))
            .unwrap()
            .distance
            .unwrap()
            > 0.0
    );
    assert!(
        mixed
            .nearest(DVec3::new(1.0, 0.5, 1.0))
            .unwrap()
            .distance
            .unwrap()
            < 0.0
    );
}

/// A sheet with a step at x = 0.5.
#[test]
fn tears_are_open_edges() {
    let rail = |y: &str| -> CurveRef {
        let of = |text: &str| Expr::parse(text).unwrap().bind(&["t"], &[]).unwrap();
        let all = [of("t"), of(y), of("if(t < 0.5, 0, 1)")];
        Arc::new(ExpressionCurve::new(all, [0.0, 1.0]).unwrap())
    };
    let step: SurfaceRef = Arc::new(ruled(rail("0"), rail("1"), Dir::U).unwrap());
    let finder = signed(&[step]);
    let at = |x, z| finder.nearest(DVec3::new(x, 0.5, z)).unwrap().distance;
    assert_eq!(at(0.45, 1.2), None);
    assert_eq!(at(0.6, -0.05), None);
    assert!(at(0.3, 0.1).unwrap() > 0.0 && at(0.8, 0.8).unwrap() < 0.0);
}

#[test]
fn domes_and_touching_bodies_are_not_guessed_at() {
    // The upper half of a sphere: its pole has no normal, and nothing closes it.
    let range = [None, Some([0.0, std::f64::consts::FRAC_PI_2])];
    let options = QuadricOptions {
        range,
        ..QuadricOptions::default()
    };
    let dome = Quadric::new(QuadricShape::Sphere, &[1.0], options).unwrap();
    let finder = signed(&[Arc::new(dome)]);
    assert_eq!(finder.nearest(DVec3::Z * 2.0).unwrap().distance, None);
    assert!(
        finder
            .nearest(DVec3::new(0.1, 0.2, 2.0))
            .unwrap()
            .distance
            .unwrap()
            > 0.0
    );
    assert!(
        finder
            .nearest(DVec3::new(0.1, 0.2, 0.5))
            .unwrap()
            .distance
            .unwrap()
            < 0.0
    );
    assert_eq!(
        finder.nearest(DVec3::new(0.3, 0.2, -1.0)).unwrap().distance,
        None
    );
    // Two spheres that touch: seen from outside both agree; where they touch, one says in and the other out.
    let shift = |x: f64| -> SurfaceRef {
        let map = DAffine3::from_translation(DVec3::X * x);
        Arc::new(Transformed::new(sphere(1.0), map).unwrap())
    };
    let pair = signed(&[shift(-1.0), shift(1.0)]);
    assert!(
        pair.nearest(DVec3::new(0.0, 1.0, 1.0))
            .unwrap()
            .distance
            .unwrap()
            > 0.0
    );
    assert!(
        pair.nearest(DVec3::new(-0.9, 0.3, 0.2))
            .unwrap()
            .distance
            .unwrap()
            < 0.0
    );
    assert_eq!(pair.nearest(DVec3::X * -0.5).unwrap().distance, None);
    assert_eq!(pair.nearest(DVec3::ZERO).unwrap().distance, None);
}

#[test]
fn scale_and_place_change_no_sign_and_batches_are_the_same() {
    let mut random = Random(55);
    for (scale, shift) in [(1e-6, 0.0), (1e6, 0.0), (1.0, 1e5)] {
        let map = DAffine3::from_scale_rotation_translation(
            DVec3::splat(scale),
            Default::default(),
            DVec3::splat(shift),
        );
        let moved: Vec<SurfaceRef> = cube()
            .into_iter()
            .map(|s| -> SurfaceRef { Arc::new(Transformed::new(s, map).unwrap()) })
            .collect();
        let finder = signed(&moved);
        let points: Vec<DVec3> = (0..100).map(|_| within(&mut random, 2.0)).collect();
        let there: Vec<DVec3> = points.iter().map(|&p| map.transform_point3(p)).collect();
        let found = finder.nearest_many(&there, 1);
        assert_eq!(
            format!("{found:?}"),
            format!("{:?}", finder.nearest_many(&there, 3))
        );
        for (p, found) in points.iter().zip(found) {
            let outside = p.abs().max_element() > 1.0;
            assert_eq!(
                found.unwrap().distance.unwrap() > 0.0,
                outside,
                "{scale} {shift} {p}"
            );
        }
    }
}

/// Two cubes that share an edge, where four faces meet, a sphere beside them, and a plate.
#[test]
fn what_branches_has_no_signs_and_says_so() {
    let moved = |s: SurfaceRef, by: DVec3| -> SurfaceRef {
        Arc::new(Transformed::new(s, DAffine3::from_translation(by)).unwrap())
    };
    let mut all = cube();
    let second = cube()
        .into_iter()
        .map(|s| moved(s, DVec3::new(2.0, 2.0, 0.0)));
    all.extend(second);
    all.push(moved(sphere(1.0), DVec3::X * 8.0));
    all.push(flat([
        [DVec3::Z * 8.0, DVec3::new(0.0, 1.0, 8.0)],
        [DVec3::new(1.0, 0.0, 8.0), DVec3::new(1.0, 1.0, 8.0)],
    ]));
    let finder = signed(&all);
    let mut told = vec![Sidedness::Unknown; 12];
    told.extend([Sidedness::Closed, Sidedness::Open]);
    assert_eq!(finder.sidedness(), told);
    let at = |p: DVec3| finder.nearest(p).unwrap().distance;
    for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
        for p in [axis * 0.8, axis * -0.8, axis * 1.2, axis * -1.2] {
            assert_eq!((at(p), at(p + DVec3::new(2.0, 2.0, 0.0))), (None, None));
        }
    }
    assert!((at(DVec3::X * 7.5).unwrap() + 0.5).abs() < 1e-7);
    assert!((at(DVec3::new(0.5, 0.5, 8.5)).unwrap() - 0.5).abs() < 1e-7);
}
