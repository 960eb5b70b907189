//! Sides that run along each other without being joined: found with their ends, and nothing else is.

#![allow(clippy::unwrap_used)]

use nappe::curve::CurveRef;
use nappe::exact::{NurbsCurve, NurbsSurface};
use nappe::measure::{Continuity, JumpOptions, continuity_in_part};
use nappe::mesh::{PartialJoint, joints, near_joints, partial_joint, partial_joints, sides_apart};
use nappe::surface::{
    Construction, Dir, Revolution, RevolutionOptions, Side, Surface, SurfaceRef, Transformed,
    bilinear, ruled,
};
use nappe::{DAffine3, DVec3, Frame, Interval};
use std::f64::consts::{FRAC_PI_4, TAU};
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

/// The continuity along the stretches of a joint.
fn measured(surfaces: &[SurfaceRef], joint: PartialJoint) -> Vec<Continuity> {
    let side = |(i, side): (usize, Side)| (surfaces[i].as_ref(), side);
    let stretches = joint.stretches.iter().flatten();
    let one = |[part, along]: &[Interval; 2]| {
        continuity_in_part(
            (side(joint.along), *along),
            (side(joint.part), *part),
            WELD,
            &JumpOptions::default(),
        )
        .unwrap()
    };
    stretches.map(one).collect()
}

/// A long side with a break, its short neighbours bent away by an angle that grows along it: what is found of a stretch is what
/// is there, not what is beside it.
#[test]
fn continuity_along_stretches() {
    // The neighbour of the part from a to b of the line y = 1 leaves it with the slope k x: the angle is atan(k x).
    let beside = |a: f64, b: f64, k: f64| -> SurfaceRef {
        let edge = |y: f64| v(a, 1.0 + y, k * a * y);
        let other = |y: f64| v(b, 1.0 + y, k * b * y);
        let corners = [[edge(0.0), edge(1.0)], [other(0.0), other(1.0)]];
        Arc::new(bilinear(corners).unwrap())
    };
    let knots = [vec![0.0, 0.0, 0.7, 2.0, 2.0], vec![0.0, 0.0, 1.0, 1.0]];
    let xs = [0.0, 0.7, 2.0];
    let points: Vec<DVec3> = xs
        .iter()
        .flat_map(|&x| [v(x, 0.0, 0.0), v(x, 1.0, 0.0)])
        .collect();
    let long: SurfaceRef = Arc::new(NurbsSurface::new([1, 1], knots, &points, None).unwrap());
    let all = [long.clone(), beside(0.0, 0.5, 0.3), beside(0.5, 2.0, 0.8)];
    let found = found(&all);
    assert_eq!(found.len(), 2);
    for (joint, greatest) in found.iter().zip([0.15f64, 1.6]) {
        let c = measured(&all, *joint);
        let angle = greatest.atan();
        assert_eq!(c.len(), 1);
        assert!(c[0].gap.within(1e-12) == Some(true));
        assert!(c[0].angle.within(0.97 * angle) == Some(false), "{c:?}");
        assert!(c[0].angle.within(1.011 * angle) == Some(true), "{c:?}");
    }
    // Ranges that are none, or outside the side.
    let of = |lo: f64, hi: f64| {
        let side = (all[0].as_ref(), Side::North);
        let own = (side, Interval { lo, hi });
        continuity_in_part(own, own, WELD, &JumpOptions::default())
    };
    assert!(of(0.3, 1.2).is_some());
    for (lo, hi) in [
        (0.3, 0.3),
        (1.0, 0.5),
        (-0.1, 1.0),
        (0.0, 2.1),
        (f64::NAN, 1.0),
    ] {
        assert!(of(lo, hi).is_none(), "{lo} {hi}");
    }
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
    // The stretch ends where either side does.
    let ends = found[0].ends.map(|p| p.x);
    assert!(
        (ends[0] - 1.5).abs() < 1e-12 && (ends[1] - 2.0).abs() < 1e-12,
        "{ends:?}"
    );
    let [Some([part, along]), None] = found[0].stretches else {
        panic!("{:?}", found[0].stretches)
    };
    assert_eq!((part, along.hi), (found[0].range, 1.0));
    assert!((part.lo).abs() < 1e-12 && (part.hi - 0.5 / 1.6).abs() < 1e-12);
    assert!((along.lo - 0.75).abs() < 1e-12);
}

/// An open side along a closed one: it begins, ends or passes where the closed one begins.
#[test]
fn open_sides_along_closed_ones() {
    let turned = |from: DVec3, to: DVec3, start: f64, angle: f64| -> SurfaceRef {
        let line: CurveRef = Arc::new(NurbsCurve::bezier(&[from, to], None).unwrap());
        let options = RevolutionOptions {
            start,
            angle,
            construction: Construction::Angle,
        };
        Arc::new(Revolution::new(line, Frame::WORLD, options).unwrap())
    };
    let [low, middle, high] = [v(1.0, 0.0, 0.0), v(1.0, 0.0, 1.0), v(2.0, 0.0, 2.0)];
    let pipe = turned(low, middle, 0.0, TAU);
    let quarter = TAU / 4.0;
    // The start and the sweep in quarters (negative: backwards), and the stretches of the pipe, first those at the start.
    type Ranges<'a> = &'a [[f64; 2]];
    let cases: [(f64, f64, Ranges); 9] = [
        (3.0, 2.0, &[[0.75, 1.0], [0.0, 0.25]]),
        (3.0, 1.0, &[[0.75, 1.0]]),
        (0.0, 1.0, &[[0.0, 0.25]]),
        (1.0, 1.0, &[[0.25, 0.5]]),
        (1.0, -2.0, &[[0.0, 0.25], [0.75, 1.0]]),
        (1.0, -1.0, &[[0.0, 0.25]]),
        (0.0, -1.0, &[[0.75, 1.0]]),
        // The last samples lie just before and just after the seam.
        (2.999, 1.0, &[[0.74975, 0.99975]]),
        (3.001, 1.0, &[[0.75025, 1.0], [0.0, 0.00025]]),
    ];
    for (start, sweep, expected) in cases {
        let mirror = DAffine3::from_scale(v(1.0, sweep.signum(), 1.0));
        let start_angle = start * sweep.signum() * quarter;
        let flap = turned(middle, high, start_angle, sweep.abs() * quarter);
        let flap: SurfaceRef = Arc::new(Transformed::new(flap, mirror).unwrap());
        let all = [pipe.clone(), flap];
        let found = found(&all);
        assert_eq!(found.len(), 1, "{start} {sweep}: {found:?}");
        let joint = found[0];
        assert_eq!(
            [joint.along, joint.part],
            [(0, Side::East), (1, Side::West)]
        );
        let stretches: Vec<[Interval; 2]> = joint.stretches.into_iter().flatten().collect();
        assert_eq!(
            stretches.len(),
            expected.len(),
            "{start} {sweep}: {joint:?}"
        );
        let mut from = 0.0;
        for ([part, along], ends) in stretches.iter().zip(expected) {
            assert!(
                (along.lo - ends[0]).abs() < 1e-9,
                "{start} {sweep}: {joint:?}"
            );
            assert!(
                (along.hi - ends[1]).abs() < 1e-9,
                "{start} {sweep}: {joint:?}"
            );
            assert!((part.lo - from).abs() < 1e-9);
            assert!((part.width() - along.width() * 4.0 / sweep.abs()).abs() < 1e-8);
            from = part.hi;
        }
        assert!((from - 1.0).abs() < 1e-9);
        let measured = measured(&all, joint);
        assert_eq!(measured.len(), expected.len());
        for c in measured {
            assert!(c.gap.within(1e-9) == Some(true), "{start} {sweep}: {c:?}");
            assert!((c.angle.found - FRAC_PI_4).abs() < 1e-9);
        }
    }
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
    // Two stretches: from the start of the second to that of the first, and from there on; v is the angle.
    let [Some(first), Some(second)] = joint.stretches else {
        panic!("{joint:?}")
    };
    let start = 0.5 / TAU;
    for ([part, along], [p, a]) in [
        (first, [[0.0, 1.0 - start], [start, 1.0]]),
        (second, [[1.0 - start, 1.0], [0.0, start]]),
    ] {
        for (range, ends) in [(part, p), (along, a)] {
            assert!((range.lo - ends[0]).abs() < 1e-9 && (range.hi - ends[1]).abs() < 1e-9);
        }
    }
    // The cylinder and the cone turn by 45° all along.
    for c in measured(&turned, joint) {
        assert!(c.gap.within(1e-9) == Some(true));
        assert!((c.angle.found - FRAC_PI_4).abs() < 1e-9);
        assert!(c.angle.within(FRAC_PI_4 * 1.011) == Some(true));
    }
    // Run through in opposite directions.
    let mirror = DAffine3::from_scale(v(1.0, -1.0, 1.0));
    let back: SurfaceRef = Arc::new(Transformed::new(turned[1].clone(), mirror).unwrap());
    let opposite = [turned[0].clone(), back];
    let joint = partial_joints(&opposite, &joints(&opposite, WELD), WELD)[0];
    let all = measured(&opposite, joint);
    assert_eq!(all.len(), 2);
    for c in all {
        assert!(c.gap.within(1e-9) == Some(true), "{c:?}");
        assert!((c.angle.found - FRAC_PI_4).abs() < 1e-9);
    }
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

/// Two given sides, at every scale and far from the origin: the part in common is that of the shorter one, the distance
/// that is asked for need not be small beside the surfaces, and without a common part the distances are those of geometry.
#[test]
fn two_given_sides() {
    for scale in [1e-6, 1.0, 1e6] {
        for far in [0.0, 1e5] {
            let placed = |x: f64, y: f64, width: f64, depth: f64| {
                let to = DAffine3::from_translation(DVec3::splat(far * scale))
                    * DAffine3::from_scale(DVec3::splat(scale));
                Transformed::new(rectangle(x, y, width, depth), to).unwrap()
            };
            let long = placed(0.0, 0.0, 9.0, 1.0);
            let short = placed(2.0, 1.25, 4.0, 1.0);
            let (north, south) = (
                (&long as &dyn Surface, Side::North),
                (&short as &dyn Surface, Side::South),
            );
            let rounding = (1e-12 + 1e-15 * far) * scale;
            for (a, b, own) in [(north, south, 1), (south, north, 0)] {
                let joint = partial_joint(a, b, 0.3 * scale).unwrap();
                assert_eq!((joint.part.0, joint.along.0), (own, 1 - own));
                assert_eq!((joint.range.lo, joint.range.hi), (0.0, 1.0));
                let partners = joint.partners.map(|t| 9.0 * t);
                for (t, x) in partners.into_iter().zip([2.0, 6.0]) {
                    assert!((t - x).abs() <= 1e-6, "{t} {x}");
                }
                assert!(partial_joint(a, b, 0.2 * scale).is_none());
                // The short side is 0.25 away all along; the long one more, but that is not what keeps them apart.
                for distance in sides_apart(a, b) {
                    assert!((distance - 0.25 * scale).abs() <= rounding, "{distance}");
                }
            }
            // From x = 0 … 9 at y = 0 to x = 2 … 6 at y = 2.25.
            let apart = sides_apart((&long, Side::South), (&short, Side::North));
            assert!(apart.iter().all(|d| (d - 2.25 * scale).abs() <= rounding));
            // A side that stands off: from 0.25 at its near end to 1.25.
            let apart = sides_apart(north, (&short, Side::West));
            assert!((apart[0] - 0.25 * scale).abs() <= rounding, "{apart:?}");
            assert!((apart[1] - 1.25 * scale).abs() <= rounding, "{apart:?}");
        }
    }
}
