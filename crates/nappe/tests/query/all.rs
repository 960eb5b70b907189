//! All nearest points.

use crate::{finder, flat, sphere, torus};
use nappe::laws::Random;
use nappe::query::{Finder, FinderOptions, QueryError};
use nappe::surface::{Quadric, QuadricOptions, QuadricShape, SurfaceRef, Transformed};
use nappe::{DAffine3, DVec3};
use std::sync::Arc;

fn ellipsoid(axes: [f64; 3]) -> SurfaceRef {
    let options = QuadricOptions::default();
    Arc::new(Quadric::new(QuadricShape::Ellipsoid, &axes, options).unwrap())
}

#[test]
fn the_middle_of_an_ellipsoid_has_two_nearest_points() {
    // Those of the shortest axis: on the equator, across a seam, and at the poles.
    for axes in [[1.0, 2.0, 3.0], [2.0, 1.0, 3.0], [2.0, 3.0, 1.0]] {
        let finder = finder(&[ellipsoid(axes)], 1e-9);
        let loci = finder.all_nearest(DVec3::ZERO, 1e-7).unwrap();
        assert_eq!(loci.len(), 2, "{axes:?}: {loci:#?}");
        let shortest = DVec3::from_array(axes.map(|a| if a == 1.0 { 1.0 } else { 0.0 }));
        for locus in &loci {
            assert!(locus.isolated, "{axes:?}: {locus:?}");
            assert!((locus.nearest.distance - 1.0).abs() <= 1e-7);
            // A place that is farther along the axis by δ is nearer to the middle by about δ² / 2.
            let off = locus.nearest.point.abs().distance(shortest);
            assert!(off < 2e-3, "{axes:?}: {locus:?}");
        }
        assert!(loci[0].nearest.point.dot(loci[1].nearest.point) < 0.0);
        assert!(
            [shortest, -shortest]
                .iter()
                .all(|&p| loci.iter().any(|l| l.hull.inflate(1e-12).contains(p)))
        );
    }
}

#[test]
fn the_middle_of_a_cube_sees_six_faces_and_an_edge_is_one_place() {
    let finder = finder(&crate::cube(), 1e-9);
    let loci = finder.all_nearest(DVec3::ZERO, 1e-7).unwrap();
    assert_eq!(loci.len(), 6);
    assert!(
        loci.iter()
            .all(|l| l.isolated && (l.nearest.distance - 1.0).abs() < 1e-9)
    );
    // Four of them from the middle of a diagonal between two edges' middles.
    let three = finder.all_nearest(DVec3::splat(0.5), 1e-7).unwrap();
    assert_eq!(three.len(), 3);
    // Two faces meet in the edge: one place.
    let edge = finder.all_nearest(DVec3::new(2.0, 0.3, 2.0), 1e-7).unwrap();
    assert_eq!(edge.len(), 1);
    assert!(edge[0].isolated && edge[0].nearest.point.distance(DVec3::new(1.0, 0.3, 1.0)) < 1e-6);
}

#[test]
fn loci_that_are_no_points_are_told() {
    let whole = |loci: &[nappe::query::Locus], lo: DVec3, hi: DVec3| {
        assert_eq!(loci.len(), 1, "{loci:#?}");
        assert!(!loci[0].isolated);
        let hull = loci[0].hull.inflate(1e-9);
        assert!(hull.contains(lo) && hull.contains(hi), "{hull:?}");
    };
    // The whole sphere.
    let ball = finder(&[sphere(2.0)], 1e-7);
    let loci = ball.all_nearest(DVec3::ZERO, 1e-6).unwrap();
    whole(&loci, DVec3::splat(-1.1), DVec3::splat(1.1));
    // The inner equator of the torus, and from above the circle on which the axis' point looks at the tube.
    let ring = finder(&[torus()], 1e-7);
    let loci = ring.all_nearest(DVec3::ZERO, 1e-6).unwrap();
    whole(&loci, DVec3::new(-2.0, 0.0, 0.0), DVec3::new(2.0, 0.0, 0.0));
    assert!(loci[0].hull.z.mag() < 0.1, "{loci:?}");
    assert!((loci[0].nearest.distance - 2.0).abs() < 1e-9);
    let loci = ring.all_nearest(DVec3::Z * 4.0, 1e-6).unwrap();
    whole(&loci, DVec3::new(2.4, 0.0, 0.8), DVec3::new(0.0, -2.4, 0.8));
    assert!((loci[0].nearest.distance - 4.0).abs() < 1e-9);
    // A line of a cylinder seen from elsewhere is one point.
    let options = QuadricOptions::default();
    let tube = Quadric::new(QuadricShape::Cylinder, &[1.0], options).unwrap();
    let tube = finder(&[Arc::new(tube)], 1e-9);
    let loci = tube.all_nearest(DVec3::new(3.0, 0.0, 1.0), 1e-8).unwrap();
    assert!(loci.len() == 1 && loci[0].isolated, "{loci:?}");
}

#[test]
fn a_wide_tolerance_takes_in_more() {
    let shift = |x: f64| -> SurfaceRef {
        let map = DAffine3::from_translation(DVec3::X * x);
        Arc::new(Transformed::new(sphere(1.0), map).unwrap())
    };
    // At the distances 1, 1.5 and 3 from the origin.
    let finder = finder(&[shift(2.0), shift(-2.5), shift(4.0)], 1e-9);
    for (tol, count) in [(1e-6, 1), (0.4, 1), (0.6, 2)] {
        let loci = finder.all_nearest(DVec3::ZERO, tol).unwrap();
        assert_eq!(loci.len(), count, "{tol}: {loci:#?}");
    }
    let loci = finder.all_nearest(DVec3::ZERO, 0.6).unwrap();
    assert_eq!(
        loci.iter().map(|l| l.nearest.surface).collect::<Vec<_>>(),
        [0, 1]
    );
}

/// Below a ridge both sides of the roof are as near; with a wide tolerance also all in between.
#[test]
fn two_places_of_one_locus_are_not_called_one() {
    let along = |p: DVec3| [p, p + DVec3::Y];
    let roof = [
        flat([along(-DVec3::X), along(DVec3::Z)]),
        flat([along(DVec3::Z), along(DVec3::X)]),
    ];
    let finder = finder(&roof, 1e-9);
    let p = DVec3::new(0.0, 0.5, 0.2);
    let two = finder.all_nearest(p, 1e-6).unwrap();
    assert!(two.len() == 2 && two.iter().all(|l| l.isolated), "{two:#?}");
    let one = finder.all_nearest(p, 0.3).unwrap();
    assert!(one.len() == 1 && !one[0].isolated, "{one:#?}");
}

/// No place outside of the boxes is as near, and each locus has a place that is.
#[test]
fn no_sample_outside_of_the_boxes_is_as_near() {
    let mut random = Random(31);
    for surface in [crate::rough(3, 7, false), crate::rough(2, 5, true)] {
        let finder = finder(std::slice::from_ref(&surface), 1e-9);
        let domain = surface.domain();
        for round in 0..60 {
            let uv = domain.map(|t| random.within(t));
            let p = surface.point(uv) + crate::within(&mut random, [0.2, 1.0, 3.0][round % 3]);
            let tol = [1e-6, 1e-2, 0.2][round / 3 % 3];
            let loci = finder.all_nearest(p, tol).unwrap();
            let least = loci[0].nearest.distance;
            let found = finder.nearest(p).unwrap();
            assert!((found.distance - least).abs() <= 1e-9);
            for _ in 0..2000 {
                let at = surface.point(domain.map(|t| random.within(t)));
                if at.distance(p) <= least - 1e-9 + tol {
                    let boxed = |l: &nappe::query::Locus| l.hull.inflate(1e-12).contains(at);
                    assert!(loci.iter().any(boxed), "{p} {tol}");
                }
            }
        }
    }
}

#[test]
fn scale_and_place_change_no_count() {
    for (scale, shift) in [(1e-6, 0.0), (1e6, 0.0), (1.0, 1e6)] {
        let map = DAffine3::from_scale_rotation_translation(
            DVec3::splat(scale),
            Default::default(),
            DVec3::splat(shift),
        );
        let moved: SurfaceRef =
            Arc::new(Transformed::new(ellipsoid([1.0, 2.0, 3.0]), map).unwrap());
        let finder = Finder::new(&[moved], FinderOptions::default()).unwrap();
        let middle = map.transform_point3(DVec3::ZERO);
        let loci = finder.all_nearest(middle, 1e-5 * scale).unwrap();
        assert_eq!(loci.len(), 2, "{scale} {shift}: {loci:#?}");
        assert!(loci.iter().all(|l| l.isolated));
    }
}

#[test]
fn bad_requests_are_refused() {
    let plane = flat([[DVec3::ZERO, DVec3::Y], [DVec3::X, DVec3::X + DVec3::Y]]);
    let finder = finder(&[plane], 1e-9);
    for tol in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = finder.all_nearest(DVec3::ZERO, tol);
        assert!(matches!(refused, Err(QueryError::Tolerance { .. })));
    }
    let refused = finder.all_nearest(DVec3::NAN, 1e-3);
    assert!(matches!(refused, Err(QueryError::Point { .. })));
    // On the surface: one place.
    let on = finder.all_nearest(DVec3::new(0.5, 0.5, 0.0), 1e-6).unwrap();
    assert!(on.len() == 1 && on[0].isolated);
}

/// From far away minima are found as well as rounding allows, here on both sides of the side that two faces share.
#[test]
fn one_place_is_one_from_far_away() {
    let half = |x: f64| {
        let corner = |x, y| DVec3::new(x, y, 0.0);
        flat([
            [corner(x, -1.0), corner(x, 1.0)],
            [corner(x + 1.0, -1.0), corner(x + 1.0, 1.0)],
        ])
    };
    let finder = finder(&[half(-1.0), half(0.0)], 1e-9);
    for height in [1e-3, 1.0, 1e3, 1e6, 1e7, 1e8, 1e9] {
        let loci = finder
            .all_nearest(DVec3::new(0.0, 0.3, height), 1e-9)
            .unwrap();
        assert!(loci.len() == 1 && loci[0].isolated, "{height:e}: {loci:#?}");
        assert!(loci[0].hull.inflate(1e-9).contains(DVec3::Y * 0.3));
    }
    // The axis of a torus sees a circle, while its width can be told from afar.
    let ring = Finder::new(&[torus()], FinderOptions::default()).unwrap();
    for height in [1e3, 1e6] {
        let loci = ring.all_nearest(DVec3::Z * height, 1e-9).unwrap();
        assert!(!loci[0].isolated, "{height:e}: {loci:#?}");
    }
}
