//! Sides that run along each other without being joined: found with their ends, and nothing else is.

#![allow(clippy::unwrap_used)]

use nappe::curve::CurveRef;
use nappe::exact::NurbsCurve;
use nappe::mesh::{PartialJoint, joints, near_joints, partial_joints};
use nappe::surface::{
    Construction, Dir, Revolution, RevolutionOptions, Side, SurfaceRef, bilinear, ruled,
};
use nappe::{DVec3, Frame};
use std::sync::Arc;

const WELD: f64 = 1e-4;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// The rectangle from (x, y, 0) of some width and depth.
fn rectangle(x: f64, y: f64, width: f64, depth: f64) -> SurfaceRef {
    let p = |i: f64, j: f64| v(x + i * width, y + j * depth, 0.0);
    Arc::new(bilinear([[p(0.0, 0.0), p(0.0, 1.0)], [p(1.0, 0.0), p(1.0, 1.0)]]).unwrap())
}

fn found(surfaces: &[SurfaceRef]) -> Vec<PartialJoint> {
    partial_joints(surfaces, &joints(surfaces, WELD), WELD)
}

#[test]
fn two_short_sides_along_a_long_one() {
    // The long side is the first or the last, so that its number does not decide.
    for long in [0, 2] {
        let mut all = vec![
            rectangle(0.0, 1.0, 0.75, 1.0),
            rectangle(0.75, 1.0, 1.25, 1.0),
        ];
        all.insert(long, rectangle(0.0, 0.0, 2.0, 1.0));
        let found = found(&all);
        assert_eq!(found.len(), 2, "{found:?}");
        for (joint, [from, to]) in found.iter().zip([[0.0, 0.75], [0.75, 2.0]]) {
            assert_eq!(joint.along, (long, Side::North));
            assert_eq!(joint.part.1, Side::South);
            assert_eq!((joint.range.lo, joint.range.hi), (0.0, 1.0));
            assert!(joint.ends[0].distance(v(from, 1.0, 0.0)) < 1e-12);
            assert!(joint.ends[1].distance(v(to, 1.0, 0.0)) < 1e-12);
            // Of the long side, 2 long, these are the shares.
            assert!((joint.partners[0] - from / 2.0).abs() < 1e-9);
            assert!((joint.partners[1] - to / 2.0).abs() < 1e-9);
            assert!(joint.gap < 1e-12 && !joint.closed);
        }
    }
}

#[test]
fn sides_that_overlap_in_a_stretch() {
    // One reaches from 0 to 2, the other, beside it, from 1.5 to 3.1: half of 2 - 1.5 is not common.
    let found = found(&[rectangle(0.0, 0.0, 2.0, 1.0), rectangle(1.5, 1.0, 1.6, 1.0)]);
    assert_eq!(found.len(), 1, "{found:?}");
    let ends = found[0].ends.map(|p| p.x);
    // To a thirty-second of the side.
    assert!(
        (ends[0] - 1.5).abs() < 1e-9 && (ends[1] - 2.0).abs() <= 1.6 / 32.0,
        "{ends:?}"
    );
}

#[test]
fn closed_sides_with_other_starts() {
    let ring = |from: DVec3, to: DVec3, start: f64| -> SurfaceRef {
        let line: CurveRef = Arc::new(NurbsCurve::bezier(&[from, to], None).unwrap());
        let options = RevolutionOptions {
            start,
            construction: Construction::Angle,
            ..RevolutionOptions::default()
        };
        Arc::new(Revolution::new(line, Frame::WORLD, options).unwrap())
    };
    let [low, middle, high] = [v(1.0, 0.0, 0.0), v(1.0, 0.0, 1.0), v(2.0, 0.0, 2.0)];
    let turned = [ring(low, middle, 0.0), ring(middle, high, 0.5)];
    let found_turned = found(&turned);
    assert_eq!(found_turned.len(), 1, "{found_turned:?}");
    let joint = found_turned[0];
    assert!(joint.closed && joint.gap < 1e-9);
    assert_eq!(
        [joint.along, joint.part],
        [(0, Side::East), (1, Side::West)]
    );
    // With the same start they are joined, and there is nothing to tell.
    let alike = [ring(low, middle, 0.5), ring(middle, high, 0.5)];
    assert!(joints(&alike, WELD).joints.len() == 3 && found(&alike).is_empty());
}

#[test]
fn what_only_touches_or_crosses_is_not_taken_for_a_part() {
    let arc = |end: DVec3| -> CurveRef {
        // Leaves (2, 1, 0) along -x, the direction of the first rectangle's north side, and bends upwards.
        Arc::new(NurbsCurve::bezier(&[v(2.0, 1.0, 0.0), v(1.0, 1.0, 0.0), end], None).unwrap())
    };
    let tangent: SurfaceRef =
        Arc::new(ruled(arc(v(0.0, 2.0, 1.0)), arc(v(0.0, 3.0, 1.0)), Dir::U).unwrap());
    // Bends so little that an eighth of it is within the distance: 1e-4 = 0.0064 · (1/8)².
    let near: SurfaceRef =
        Arc::new(ruled(arc(v(0.0, 1.0064, 0.0)), arc(v(0.0, 3.0, 1.0)), Dir::U).unwrap());
    for (name, other) in [
        ("corner to corner", rectangle(2.0, 1.0, 1.0, 1.0)),
        ("joined", rectangle(0.0, 1.0, 2.0, 1.0)),
        ("apart", rectangle(0.5, 1.0 + 2.0 * WELD, 1.0, 1.0)),
        ("across", rectangle(0.5, 0.5, 1.0, 1.0)),
        ("tangent in a corner", tangent),
        ("tangent in a corner, long as if along", near),
    ] {
        let found = found(&[rectangle(0.0, 0.0, 2.0, 1.0), other]);
        assert!(found.is_empty(), "{name}: {found:?}");
    }
}

#[test]
fn sides_near_open_ones_are_found_and_joined_ones_are_left_alone() {
    let gap = 5.0 * WELD;
    let beside = |z: f64, y: f64| -> SurfaceRef {
        let p = |i: f64, j: f64| v(i, y + j, z);
        Arc::new(bilinear([[p(0.0, 0.0), p(0.0, 1.0)], [p(1.0, 0.0), p(1.0, 1.0)]]).unwrap())
    };
    // Two sheets of two squares each, one above the other.
    let sheets = [
        beside(0.0, 0.0),
        beside(0.0, 1.0),
        beside(gap, 0.0),
        beside(gap, 1.0),
    ];
    let joined = joints(&sheets, WELD);
    assert_eq!(joined.joints.len(), 2);
    assert!(
        joined
            .joints
            .iter()
            .all(|j| j.gap == 0.0 && j.length == 1.0)
    );
    let near = near_joints(&sheets, &joined, 10.0 * WELD);
    let middle = [Side::North, Side::South];
    for j in &near.joints {
        assert_eq!((j.first.0 + 2, j.first.1), j.second);
        assert!(j.first.1 != middle[j.first.0]);
        assert!((j.gap - gap).abs() < 1e-15 && (j.length - 1.0).abs() < 1e-12);
    }
    assert_eq!(near.joints.len(), 6);
    assert!(near.open.iter().all(Vec::is_empty));
    // Farther apart than that, they stay open.
    let far = near_joints(&sheets, &joined, 4.0 * WELD);
    assert!(far.joints.is_empty() && far.open == joined.open);
}
