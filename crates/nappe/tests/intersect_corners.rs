//! Surfaces that meet in curves through corners of their pieces: knots, creases and seams of both at one point.

#![allow(clippy::unwrap_used)]

use nappe::curve::{CurveRef, Line};
use nappe::query::{IntersectOptions, SurfaceSurface, intersect_surfaces};
use nappe::surface::{
    Quadric, QuadricOptions, QuadricShape, Revolution, RevolutionOptions, SurfaceRef, Transformed,
};
use nappe::{Curve, DAffine3, DMat3, DVec3, Frame, NurbsSurface, Surface};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

fn mapped(s: &SurfaceRef, map: DAffine3) -> SurfaceRef {
    Arc::new(Transformed::new(s.clone(), map).unwrap())
}

/// About z, from -2 to 2: with a formula, as a net of control points, and as a line that is turned.
fn cylinders(radius: f64) -> [SurfaceRef; 3] {
    let options = QuadricOptions {
        range: [None, Some([-2.0, 2.0])],
        ..QuadricOptions::default()
    };
    let q = Quadric::new(QuadricShape::Cylinder, &[radius, radius], options).unwrap();
    let net: SurfaceRef = Arc::new(q.to_nurbs().unwrap());
    let at = |z: f64| DVec3::new(radius, 0.0, z);
    let line: CurveRef = Arc::new(Line::new(at(-2.0), at(2.0)).unwrap());
    let turned = Revolution::new(line, Frame::WORLD, RevolutionOptions::default()).unwrap();
    [Arc::new(q), net, Arc::new(turned)]
}

fn meet(a: &SurfaceRef, b: &SurfaceRef, tol: Option<f64>) -> SurfaceSurface {
    let options = IntersectOptions {
        tol,
        ..IntersectOptions::default()
    };
    intersect_surfaces(a, b, &options).unwrap()
}

/// Two closed curves and nothing else.
fn assert_loops(found: &SurfaceSurface, what: &str) {
    let told: Vec<String> = found.undecided.iter().map(ToString::to_string).collect();
    let closed = found.branches.iter().filter(|b| b.is_closed()).count();
    assert_eq!(
        (closed, found.branches.len(), found.touches.len()),
        (2, 2, 0),
        "{what}"
    );
    assert!(told.is_empty(), "{what}: {told:?}");
}

/// Points at the ends of the parts of each branch lie on both pipes, of radius 1 about z and of 0.7 about another axis.
fn assert_on_pipes(found: &SurfaceSurface, axis: DVec3, quarters: bool) {
    for branch in &found.branches {
        let curve = branch.curve();
        let mut corners = 0;
        for b in curve.breaks() {
            for p in [curve.point(b.at), branch.on(1).point(b.at)] {
                let off = [
                    p.truncate().length() - 1.0,
                    p.reject_from(axis).length() - 0.7,
                ];
                assert!(off.iter().all(|x| x.abs() < 1e-12), "{off:?} at {p}");
            }
            // Quarters of the lesser pipe where those of the wider one are: the curve goes on there.
            let p = curve.point(b.at);
            corners += usize::from(
                (p.z.abs() - 0.7).hypot(p.with_z(0.0).reject_from(axis).length()) < 1e-12,
            );
        }
        // A line that is turned has a seam, and no quarters.
        assert!(
            !quarters || corners >= 2,
            "{corners} of {}",
            curve.breaks().len()
        );
    }
}

#[test]
fn pipes_whose_seams_and_quarters_meet_have_two_loops() {
    // The lesser one about y or x, so that a quarter and a quarter, a seam and a quarter, or both seams meet.
    let about = [
        (DVec3::Y, DMat3::from_rotation_x(FRAC_PI_2)),
        (DVec3::X, DMat3::from_rotation_y(FRAC_PI_2)),
    ];
    let quarter = |k: usize| DMat3::from_rotation_z(k as f64 * FRAC_PI_2);
    for (kind, (wide, thin)) in cylinders(1.0).iter().zip(&cylinders(0.7)).enumerate() {
        for (axis, turn) in about {
            for [k, l] in [[0, 0], [0, 1], [1, 0], [1, 1]] {
                let a = mapped(wide, DAffine3::from_mat3(quarter(k)));
                let b = mapped(thin, DAffine3::from_mat3(turn * quarter(l)));
                let [a, b] = if k == l { [&a, &b] } else { [&b, &a] };
                let found = meet(a, b, None);
                assert_loops(&found, &format!("{kind} {axis} {k} {l}"));
                assert_on_pipes(&found, axis, kind < 2);
            }
        }
    }
}

#[test]
fn pipes_meet_alike_at_any_scale_and_place() {
    let [_, wide, _] = cylinders(1.0);
    let [_, thin, _] = cylinders(0.7);
    let about_x = DMat3::from_rotation_y(FRAC_PI_2);
    for (scale, far) in [(1e-6, 0.0), (1e6, 0.0), (1.0, 1e3), (1e-3, -10.0)] {
        let turn = DMat3::from_rotation_z(0.3) * DMat3::from_rotation_x(0.4) * scale;
        let place = DVec3::new(far, 0.3 * far, -far);
        let put = |m: DMat3| DAffine3::from_mat3_translation(turn * m, place);
        let found = meet(
            &mapped(&wide, put(DMat3::IDENTITY)),
            &mapped(&thin, put(about_x)),
            None,
        );
        assert_loops(&found, &format!("{scale:e} {far:e}"));
    }
}

#[test]
fn pipes_whose_curve_passes_a_corner_by_anything_have_two_loops() {
    let [_, wide, _] = cylinders(1.0);
    let [_, thin, _] = cylinders(0.7);
    let thin = mapped(
        &thin,
        DAffine3::from_mat3(DMat3::from_rotation_y(FRAC_PI_2)),
    );
    for k in 2..16 {
        let by = 10f64.powi(-k);
        let along = DAffine3::from_translation(DVec3::Y * by);
        assert_loops(
            &meet(&mapped(&wide, along), &thin, None),
            &format!("{by:e}"),
        );
        let tilt = DAffine3::from_rotation_x(by);
        assert_loops(
            &meet(&mapped(&wide, tilt), &thin, None),
            &format!("tilted {by:e}"),
        );
    }
}

#[test]
fn equal_pipes_cross_at_their_seams_in_two_places() {
    let turn = DAffine3::from_mat3(DMat3::from_rotation_x(FRAC_PI_2));
    for pipe in cylinders(1.0) {
        let found = meet(&pipe, &mapped(&pipe, turn), None);
        assert_eq!((found.branches.len(), found.touches.len()), (4, 0));
        // A place on two seams is one place, not four.
        let ends: Vec<usize> = found.undecided.iter().map(|c| c.ends).collect();
        assert_eq!(ends, [4, 4]);
        for place in &found.undecided {
            assert!((place.point.abs() - DVec3::X).length() < 1e-3, "{place}");
        }
    }
}

/// z over the unit square as a bicubic net of 4 by 4 pieces, with simple, double or triple knots between them.
fn heights(multiplicity: usize, turned: bool, height: impl Fn(f64, f64) -> f64) -> SurfaceRef {
    let inner = (1..4).flat_map(|i| vec![f64::from(i) / 4.0; multiplicity]);
    let knots: Vec<f64> = [0.0; 4].into_iter().chain(inner).chain([1.0; 4]).collect();
    let n = knots.len() - 4;
    let at = |i: usize| (knots[i + 1] + knots[i + 2] + knots[i + 3]) / 3.0;
    let points: Vec<DVec3> = (0..n * n)
        .map(|k| {
            let (i, j) = (k / n, k % n);
            let [x, y] = if turned {
                [at(n - 1 - j), at(i)]
            } else {
                [at(i), at(j)]
            };
            DVec3::new(x, y, height(x, y))
        })
        .collect();
    Arc::new(NurbsSurface::new([3, 3], [knots.clone(), knots], &points, None).unwrap())
}

#[test]
fn nets_meet_along_the_diagonal_through_all_corners_of_their_pieces() {
    for multiplicity in 1..=3 {
        // Control points at Greville's places: a net of linear heights is that plane.
        let slope = |s: f64, turned| heights(multiplicity, turned, move |x, y| s * (x - y));
        for other in [0.0, 0.5, -2.0] {
            let found = meet(&slope(1.0, false), &slope(other, true), None);
            assert!(found.undecided.is_empty() && found.touches.is_empty());
            assert_eq!(found.branches.len(), 1, "{multiplicity} {other}");
            let curve = found.branches[0].curve();
            let [from, to] = curve.ends();
            assert!(
                (from.distance(to) - 2f64.sqrt()).abs() < 1e-9,
                "{from} {to}"
            );
            for k in 0..=100 {
                let p = curve.point(f64::from(k) / 100.0);
                assert!((p.x - p.y).abs().max(p.z.abs()) < 1e-11, "{p}");
            }
        }
        // Curved, and through the middle, where four pieces of each meet.
        let wave = |x: f64, y: f64| {
            let (x, y) = (x - 0.5, y - 0.5);
            x + 0.3 * y + 0.3 * (6.0 * x).sin()
        };
        let found = meet(
            &heights(multiplicity, false, wave),
            &heights(multiplicity, true, |_, _| 0.0),
            None,
        );
        assert!(found.undecided.is_empty() && found.touches.is_empty());
        assert_eq!(found.branches.len(), 1, "{multiplicity}");
    }
}
