//! Surfaces that pass through themselves or each other are found, and those that do not are proven apart.

#![allow(clippy::unwrap_used)]

use nappe::curve::{CurveRef, ExpressionCurve};
use nappe::exact::NurbsCurve;
use nappe::expr::{Bound, Expr};
use nappe::measure::{
    JumpOptions, Meeting, Overlap, OverlapOptions, Overlaps, overlaps, pinches, regularity,
};
use nappe::surface::{
    Quadric, QuadricOptions, QuadricShape, Revolution, RevolutionOptions, SurfaceRef, Torus,
    TorusOptions, Transformed, bilinear, ruled,
};
use nappe::{DAffine3, DVec3, Dir, Frame};
use std::f64::consts::TAU;
use std::sync::Arc;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn expr(s: &str) -> Bound {
    Expr::parse(s).unwrap().bind(&["t"], &[]).unwrap()
}

fn curve(x: &str, y: &str, z: &str) -> CurveRef {
    Arc::new(ExpressionCurve::new([expr(x), expr(y), expr(z)], [0.0, 1.0]).unwrap())
}

fn between(a: CurveRef, b: CurveRef) -> SurfaceRef {
    Arc::new(ruled(a, b, Dir::U).unwrap())
}

fn quad(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> SurfaceRef {
    Arc::new(bilinear([[a, d], [b, c]]).unwrap())
}

/// Scales and distances: the answer must not depend on them.
const PLACES: [(f64, f64); 4] = [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e3)];

fn placed(s: &[SurfaceRef], scale: f64, far: f64) -> Vec<SurfaceRef> {
    let map =
        DAffine3::from_translation(v(far, -far, far)) * DAffine3::from_scale(DVec3::splat(scale));
    s.iter()
        .map(|s| Arc::new(Transformed::new(s.clone(), map).unwrap()) as SurfaceRef)
        .collect()
}

fn examined(s: &[SurfaceRef], contact: f64) -> Overlaps {
    let found = overlaps(s, &OverlapOptions::with_contact(contact));
    assert_eq!(found.found.len() + found.apart, s.len() * (s.len() + 1) / 2);
    // The accuracy of points is relative to the greatest coordinate.
    let boxes = s.iter().flat_map(|s| s.bounds(s.domain()).to_array());
    let far = boxes.fold(0.0f64, |m, i| m.max(i.mag()));
    for o in &found.found {
        let [p, q] = [0, 1].map(|k| s[o.surfaces[k]].point(o.uv[k]));
        if !matches!(o.meeting, Meeting::Undecided { .. }) {
            assert!(p.distance(q) <= 1e-12 * far, "{o:?}");
        }
    }
    found
}

fn assert_apart(s: &[SurfaceRef]) {
    for (scale, far) in PLACES {
        let found = examined(&placed(s, scale, far), 1e-4 * scale);
        assert!(
            found.found.is_empty(),
            "scale {scale}, {far} away: {found:?}"
        );
    }
}

/// The only thing found.
fn only(s: &[SurfaceRef], scale: f64, far: f64) -> Overlap {
    let found = examined(&placed(s, scale, far), 1e-4 * scale);
    assert_eq!(found.found.len(), 1, "scale {scale}, {far} away: {found:?}");
    found.found[0]
}

fn assert_crosses(s: &[SurfaceRef], surfaces: [usize; 2], true_angle: Option<f64>) {
    for (scale, far) in PLACES {
        let o = only(s, scale, far);
        assert_eq!(o.surfaces, surfaces);
        let Meeting::Crosses { proven, angle } = o.meeting else {
            panic!("{o:?}")
        };
        assert!(proven, "{o:?}");
        if let Some(want) = true_angle {
            assert!((angle - want).abs() < 1e-6, "{o:?}");
        }
    }
}

#[test]
fn closed_surfaces_with_seams_and_poles_are_apart_from_themselves() {
    let sphere = Quadric::new(QuadricShape::Sphere, &[2.0], QuadricOptions::default()).unwrap();
    let cone = Quadric::new(
        QuadricShape::Cone,
        &[2.0, 1.0, 3.0],
        QuadricOptions::default(),
    )
    .unwrap();
    let cylinder = Quadric::new(
        QuadricShape::Cylinder,
        &[2.0, 1.0],
        QuadricOptions::default(),
    );
    let torus = Torus::new(3.0, 1.0, TorusOptions::default()).unwrap();
    let surfaces: [SurfaceRef; 4] = [
        Arc::new(sphere),
        Arc::new(cone),
        Arc::new(cylinder.unwrap()),
        Arc::new(torus),
    ];
    for s in surfaces {
        assert_apart(&[s]);
    }
    let by_angle = |x: &str, z: &str| -> SurfaceRef {
        let options = RevolutionOptions {
            angle: TAU,
            ..Default::default()
        };
        Arc::new(Revolution::new(curve(x, "0", z), Frame::WORLD, options).unwrap())
    };
    assert_apart(&[by_angle("sin(pi*t)", "cos(pi*t)")]);
    assert_apart(&[by_angle("3+cos(2*pi*t)", "-sin(2*pi*t)")]);
}

#[test]
fn a_band_with_half_a_twist_is_apart_from_itself() {
    let edge = |sign: &str| {
        let r = format!("(3 {sign} cos(pi*t))");
        curve(
            &format!("{r} * cos(2*pi*t)"),
            &format!("{r} * sin(2*pi*t)"),
            &format!("0 {sign} sin(pi*t)"),
        )
    };
    assert_apart(&[between(edge("+"), edge("-"))]);
}

#[test]
fn a_cylinder_over_a_figure_of_eight_crosses_itself() {
    let eight = |z: &str| curve("sin(2*pi*t + 0.4)", "sin(4*pi*t + 0.8)", z);
    let s = between(eight("0"), eight("1"));
    // At the double point x'/y' = ±1/2: the branches meet at 2 atan(1/2).
    assert_crosses(&[s], [0, 0], Some(2.0 * 0.5f64.atan()));
}

#[test]
fn a_crossing_exactly_on_the_seam_is_found() {
    // The double point of the figure of eight is where it begins and ends.
    let eight = |z: &str| curve("sin(4*pi*t)", "sin(2*pi*t)", z);
    let s = between(eight("0"), eight("1"));
    for (scale, far) in PLACES {
        let o = only(std::slice::from_ref(&s), scale, far);
        let Meeting::Crosses { angle, .. } = o.meeting else {
            panic!("{o:?}")
        };
        assert!((angle - 2.0 * 0.5f64.atan()).abs() < 1e-5, "{o:?}");
    }
}

#[test]
fn surfaces_that_touch_themselves_in_a_point_are_apart_elsewhere() {
    let horn = Torus::new(1.0, 1.0, TorusOptions::default()).unwrap();
    let options = RevolutionOptions {
        angle: TAU,
        ..Default::default()
    };
    // Both sheets of a cone, the tip not in the middle of the profile.
    let inner = Revolution::new(curve("abs(3*t-1)", "0*t", "3*t"), Frame::WORLD, options).unwrap();
    for (s, at) in [
        (Arc::new(horn) as SurfaceRef, 0.5),
        (Arc::new(inner), 1.0 / 3.0),
    ] {
        for (scale, far) in PLACES {
            let s = placed(std::slice::from_ref(&s), scale, far);
            let found = pinches(s[0].as_ref());
            assert_eq!(found.len(), 1, "{found:?}");
            assert!((found[0].at - at).abs() < 1e-4, "{found:?}");
            let r = regularity(s[0].as_ref(), &JumpOptions::default());
            assert_eq!((r.pinches, r.folds), (found, Vec::new()));
            assert!(r.degenerate.is_empty(), "{:?}", r.degenerate);
        }
        if at < 0.5 {
            assert_apart(&[s]);
        } else {
            // Close to the point the tube of a horn torus is thinner than any distance: that may stay undecided.
            let found = examined(&[s], 1e-2).found;
            let open = |o: &Overlap| matches!(o.meeting, Meeting::Undecided { .. });
            assert!(found.iter().all(open), "{found:?}");
        }
    }
}

#[test]
fn a_bow_tie_folds_over_in_its_knot() {
    let o = quad(v(0., 0., 0.), v(1., 0., 0.), v(0., 1., 0.), v(1., 1., 0.));
    let r = regularity(o.as_ref(), &JumpOptions::default());
    assert!(!r.folds.is_empty() && !r.regular);
    assert_eq!(r.pinches.len(), 1, "{:?}", r.pinches);
    assert!((r.pinches[0].at - 0.5).abs() < 1e-9);
    assert!(r.pinches[0].point.distance(v(0.5, 0.5, 0.0)) < 1e-9);
}

#[test]
fn sheets_of_a_helicoid_and_of_a_spiral_come_near_but_do_not_touch() {
    // A turn and a half with a pitch of 0.05; the inner edge is a helix of radius 0.2.
    let helix = |r: &str| {
        curve(
            &format!("{r}*cos(3*pi*t)"),
            &format!("{r}*sin(3*pi*t)"),
            "0.075*t",
        )
    };
    assert_apart(&[between(helix("0.2"), helix("1"))]);
    let spiral = |z: &str| curve("(1 + 0.02*t)*cos(4*pi*t)", "(1 + 0.02*t)*sin(4*pi*t)", z);
    assert_apart(&[between(spiral("0"), spiral("1"))]);
}

#[test]
fn a_flat_ring_of_more_than_a_turn_overlaps_itself() {
    let arc = |r: &str| curve(&format!("{r}*cos(7*t)"), &format!("{r}*sin(7*t)"), "0*t");
    let ring = [between(arc("1"), arc("2"))];
    for (scale, far) in PLACES {
        let o = only(&ring, scale, far);
        assert_eq!(o.meeting, Meeting::Overlaps, "{o:?}");
        // The place is where the ring has turned by more than 2π - 7 mod 2π.
        let turned = 7.0 * (o.uv[0][0] - o.uv[1][0]).abs();
        assert!((turned - TAU).abs() < 1e-6, "{o:?}");
    }
}

#[test]
fn planes_cross_touch_and_stay_apart() {
    let floor = quad(v(0., 0., 0.), v(2., 0., 0.), v(2., 2., 0.), v(0., 2., 0.));
    let wall = |z: f64| {
        quad(
            v(1., -1., z),
            v(1., 3., z),
            v(1.2, 3., z + 2.),
            v(1.2, -1., z + 2.),
        )
    };
    let angle = 10f64.atan();
    assert_crosses(&[floor.clone(), wall(-1.0)], [0, 1], Some(angle));
    assert_apart(&[floor.clone(), wall(0.01)]);
    // It stands on the floor: a side of the wall lies in it.
    let touch = Meeting::Touches { only: true };
    for (scale, far) in PLACES {
        let o = only(&[floor.clone(), wall(0.0)], scale, far);
        assert_eq!((o.surfaces, o.meeting), ([0, 1], touch), "{o:?}");
    }
    // A little through the floor is not standing on it.
    assert_crosses(&[floor.clone(), wall(-1e-5)], [0, 1], Some(angle));
    // The same surface twice has all in common.
    let o = only(&[floor.clone(), floor], 1.0, 0.0);
    assert_eq!(
        (o.surfaces, o.meeting),
        ([0, 1], Meeting::Overlaps),
        "{o:?}"
    );
}

#[test]
fn a_contact_distance_larger_than_a_part_hides_nothing() {
    // Two unit squares through each other, and a large one that makes a whole model's tolerance large.
    let a = quad(v(0., 0., 0.), v(1., 0., 0.), v(1., 1., 0.), v(0., 1., 0.));
    let b = quad(
        v(0.5, 0.2, -1.),
        v(0.5, 0.8, -1.),
        v(0.5, 0.8, 1.),
        v(0.5, 0.2, 1.),
    );
    let far = 1e3;
    let big = quad(
        v(-far, -far, -5.),
        v(far, -far, -5.),
        v(far, far, -5.),
        v(-far, far, -5.),
    );
    for contact in [1e-3, 1.0, 2.8, 1e3] {
        let found = examined(&[a.clone(), b.clone(), big.clone()], contact);
        let crossing = |o: &Overlap| matches!(o.meeting, Meeting::Crosses { .. });
        assert!(
            found.found.len() == 1 && crossing(&found.found[0]),
            "{contact}: {found:?}"
        );
    }
}

#[test]
fn patches_around_shared_sides_and_corners_are_apart() {
    let height = |x: f64, y: f64| 0.3 * x * x - 0.2 * x * y;
    let at = |x: f64, y: f64| v(x, y, height(x, y));
    let cell = |x: f64, y: f64| quad(at(x, y), at(x + 1., y), at(x + 1., y + 1.), at(x, y + 1.));
    // Four around a corner: neighbours share sides, the others only the corner.
    assert_apart(&[cell(0., 0.), cell(-1., 0.), cell(-1., -1.), cell(0., -1.)]);
    // Two leaves of a book, 1° open; opposite directions along the shared side.
    let open = 1f64.to_radians();
    let leaf = |angle: f64| {
        let d = v(angle.cos(), 0.0, angle.sin());
        quad(v(0., 0., 0.), v(0., 1., 0.), v(0., 1., 0.) + d, d)
    };
    let back = quad(v(0., 1., 0.), v(0., 0., 0.), v(1., 0., 0.), v(1., 1., 0.));
    assert_apart(&[leaf(open), back]);
}

#[test]
fn smooth_patches_with_rounded_shared_sides_are_apart() {
    // A quarter of a tube in two halves, cut by de Casteljau's rule in thirds: the sides agree within rounding only.
    let p = [v(1., 0., 0.), v(1., 0., 0.7), v(0.6, 0., 1.), v(0., 0., 1.)];
    let cut = |t: f64| {
        let mid = |a: DVec3, b: DVec3| a * (1.0 - t) + b * t;
        let q = [mid(p[0], p[1]), mid(p[1], p[2]), mid(p[2], p[3])];
        let r = [mid(q[0], q[1]), mid(q[1], q[2])];
        let s = mid(r[0], r[1]);
        ([p[0], q[0], r[0], s], [s, r[1], q[2], p[3]])
    };
    let (a, b) = cut(1.0 / 3.0);
    let wall = |p: [DVec3; 4]| {
        let rail = |y: f64| -> CurveRef {
            Arc::new(NurbsCurve::bezier(&p.map(|q| q + v(0.0, y, 0.1 * y)), None).unwrap())
        };
        between(rail(0.0), rail(1.0))
    };
    assert_apart(&[wall(a), wall(b)]);
}

#[test]
fn a_tangent_sphere_touches() {
    let floor = quad(
        v(-1., -1., 0.),
        v(2., -1., 0.),
        v(2., 2., 0.),
        v(-1., 2., 0.),
    );
    let options = QuadricOptions::default();
    let ball = |z: f64| -> SurfaceRef {
        let s = Quadric::new(QuadricShape::Sphere, &[0.5], options).unwrap();
        let map = DAffine3::from_translation(v(0.2, 0.1, z))
            * DAffine3::from_axis_angle(v(1., 2., 3.).normalize(), 1.0);
        Arc::new(Transformed::new(Arc::new(s), map).unwrap())
    };
    assert_apart(&[floor.clone(), ball(0.501)]);
    assert_crosses(&[floor.clone(), ball(0.4)], [0, 1], Some(0.8f64.acos()));
    let o = only(&[floor, ball(0.5)], 1.0, 0.0);
    assert!(
        matches!(
            o.meeting,
            Meeting::Touches { .. }
                | Meeting::Undecided {
                    distance: 0.0..1e-4
                }
        ),
        "{o:?}"
    );
}

/// A quarter of a cylinder of radius 1 that comes down to the height `z` at its side `v = 0`, tilted there by an angle.
fn quarter(z: f64, tilt: f64) -> SurfaceRef {
    let w = 0.5f64.sqrt();
    let arc = |y: f64| -> CurveRef {
        let turned = |x: f64, h: f64| {
            let (s, c) = tilt.sin_cos();
            v(c * x - s * h, y, z + s * x + c * h)
        };
        let points = [turned(0., 0.), turned(1., 0.), turned(1., 1.)];
        Arc::new(NurbsCurve::bezier(&points, Some(&[1.0, w, 1.0])).unwrap())
    };
    between(arc(-0.5), arc(0.5))
}

#[test]
fn a_fillet_is_tangent_to_its_floor_and_does_not_pass_through_it() {
    let floor = |y: f64| quad(v(-1., -y, 0.), v(2., -y, 0.), v(2., y, 0.), v(-1., y, 0.));
    for (scale, far) in PLACES {
        let o = only(&[floor(1.0), quarter(0.0, 0.0)], scale, far);
        assert_eq!(o.meeting, Meeting::Touches { only: true }, "{o:?}");
    }
    assert_apart(&[floor(1.0), quarter(0.01, 0.0)]);
    // Pushed through the floor, or tilted down so that it dips below and comes up again beside the side.
    for through in [quarter(-0.01, 0.0), quarter(0.0, -0.05)] {
        for (scale, far) in PLACES {
            let o = only(&[floor(1.0), through.clone()], scale, far);
            let passes = matches!(o.meeting, Meeting::Crosses { .. });
            assert!(
                passes || o.meeting == Meeting::Touches { only: false },
                "{o:?}"
            );
            assert!(passes || through.point([0.0, 0.0]).z == 0.0, "{o:?}");
        }
    }
}

#[test]
fn a_rib_stands_on_a_line_of_a_curved_surface() {
    let bow = |y: &str, z: &str| curve("2*t - 1", y, &format!("0.3*cos(3*t) + {z}"));
    let skin = between(bow("-1", "0"), bow("2", "0.2"));
    let foot = |z: f64| -> SurfaceRef {
        let line = |h: f64| bow("0.1 + 0*t", &format!("({})", 0.2 * 1.1 / 3.0 + h));
        between(line(z), line(z + 0.5))
    };
    for (scale, far) in PLACES {
        let o = only(&[skin.clone(), foot(0.0)], scale, far);
        assert_eq!(o.meeting, Meeting::Touches { only: true }, "{o:?}");
    }
    assert_apart(&[skin.clone(), foot(0.01)]);
    // It begins a little below: that it stands on the surface must not be said.
    assert_crosses(&[skin, foot(-0.05)], [0, 1], None);
}
