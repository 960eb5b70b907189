//! Continuity along shared sides and regularity, against closed forms: dihedral angles, folds, cylinders, spheres, poles.

#![allow(clippy::unwrap_used)]

use nappe::exact::{NurbsCurve, NurbsSurface};
use nappe::laws;
use nappe::measure::{Continuity, JumpOptions, Smoothness, continuity, regularity};
use nappe::mesh::{Certainty, joints};
use nappe::surface::{
    Quadric, QuadricOptions, QuadricShape, Revolution, RevolutionOptions, Side, Surface, SurfaceRef,
};
use nappe::{DMat3, DVec3, Frame};
use std::f64::consts::PI;
use std::sync::Arc;

const SCALES: [f64; 3] = [1e-6, 1.0, 1e6];

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// A Bézier surface from rows along u.
fn net(rows: &[&[DVec3]], weights: Option<&[f64]>) -> NurbsSurface {
    NurbsSurface::bezier(rows.len(), &rows.concat(), weights).unwrap()
}

fn measure(a: &dyn Surface, sa: Side, b: &dyn Surface, sb: Side, tol: f64) -> Continuity {
    continuity((a, sa), (b, sb), tol, &JumpOptions::default()).unwrap()
}

fn bounded(c: Certainty) -> f64 {
    match c {
        Certainty::Bounded(e) => e,
        other => panic!("{other:?}"),
    }
}

/// The eight nets with the same surface: exchanged and reversed parameters, with the side that was the given one.
fn turned(rows: &[Vec<DVec3>], side: Side) -> Vec<(NurbsSurface, Side)> {
    let mut all = Vec::new();
    for k in 0..8 {
        let mut r: Vec<Vec<DVec3>> = rows.to_vec();
        let mut s = side;
        if k & 1 == 1 {
            r.reverse();
            s = match s {
                Side::West => Side::East,
                Side::East => Side::West,
                other => other,
            };
        }
        if k & 2 == 2 {
            r.iter_mut().for_each(|row| row.reverse());
            s = match s {
                Side::South => Side::North,
                Side::North => Side::South,
                other => other,
            };
        }
        if k & 4 == 4 {
            r = (0..r[0].len())
                .map(|j| r.iter().map(|row| row[j]).collect())
                .collect();
            s = match s {
                Side::South => Side::West,
                Side::West => Side::South,
                Side::North => Side::East,
                Side::East => Side::North,
            };
        }
        let flat: Vec<&[DVec3]> = r.iter().map(Vec::as_slice).collect();
        all.push((net(&flat, None), s));
    }
    all
}

#[test]
fn two_planes_meet_at_their_angle_in_every_orientation() {
    for scale in SCALES {
        for theta in [0.0f64, 0.3, 1.5, 2.8, PI] {
            // The first plane ends at x = 0; the second goes on from there, turned by theta about y.
            let far = v(-1.0, 0.0, 0.0) * scale;
            let up = v(0.0, 2.0, 0.0) * scale;
            let out = v(theta.cos(), 0.0, theta.sin()) * scale;
            let a = net(&[&[far, far + up], &[DVec3::ZERO, up]], None);
            let rows = vec![vec![DVec3::ZERO, up], vec![out, out + up * 0.7]];
            for (b, side) in turned(&rows, Side::West) {
                let c = measure(&a, Side::East, &b, side, 1e-9 * scale);
                assert!(
                    (c.angle.found - theta).abs() < 1e-12,
                    "{theta} {side}: {c:?}"
                );
                // Near π the sine says little and the bound is that of the cosine.
                let slack = if theta > 3.0 {
                    1e-6
                } else {
                    0.011 * theta + 1e-10
                };
                assert!(
                    bounded(c.angle.greatest) <= theta + slack,
                    "{theta} {side}: {c:?}"
                );
                assert!(bounded(c.gap.greatest) <= 1e-13 * scale);
                assert!(bounded(c.curvature.greatest) <= 1e-9);
                let want = if theta == 0.0 {
                    Smoothness::G2
                } else {
                    Smoothness::G0
                };
                assert_eq!(c.proven(1e-12 * scale, 1e-8, 1e-6), Some(want));
                if theta < 1.5 {
                    let n = |s: &NurbsSurface| {
                        s.jet([0.5, 0.5], [nappe::Limit::Above; 2], 1)
                            .normal()
                            .unwrap()
                    };
                    assert_eq!(c.same_orientation, n(&a).dot(n(&b)) > 0.0, "{theta} {side}");
                }
            }
        }
    }
}

/// A quarter of a cylinder of radius r about the y axis, which begins at the top with tangent x; u along the arc. The
/// weights `1, k/√2, k²` change the parametrisation and not the shape.
fn quarter(r: f64, k: f64) -> NurbsSurface {
    let h = 0.5f64.sqrt() * k;
    let row = |x: f64, z: f64| [v(x * r, 0.0, z * r), v(x * r, 2.0 * r, z * r)];
    let (a, b, c) = (row(0.0, 1.0), row(1.0, 1.0), row(1.0, 0.0));
    net(&[&a, &b, &c], Some(&[1.0, 1.0, h, h, k * k, k * k]))
}

#[test]
fn a_plane_goes_on_smoothly_into_a_cylinder_but_not_its_curvature() {
    for r in SCALES {
        let plane = net(
            &[
                &[v(-1.0, 0.0, 1.0) * r, v(-1.0, 2.0, 1.0) * r],
                &[v(0.0, 0.0, 1.0) * r, v(0.0, 2.0, 1.0) * r],
            ],
            None,
        );
        let c = measure(&plane, Side::East, &quarter(r, 1.0), Side::West, 1e-9 * r);
        assert!(bounded(c.angle.greatest) < 1e-9);
        assert!((c.curvature_scale * r - 1.0).abs() < 1e-12);
        assert!((c.curvature.found - 1.0).abs() < 1e-12);
        assert!(bounded(c.curvature.greatest) < 1.011);
        assert_eq!(c.proven(1e-12 * r, 1e-8, 1e-3), Some(Smoothness::G1));
        assert_eq!(c.curvature.within(0.5), Some(false));
    }
}

/// Sections of one surface with different parametrisations along their common arc.
#[test]
fn arcs_with_different_parametrisations_are_one_curve() {
    let r = 3.0;
    let (a, b) = (quarter(r, 1.0), quarter(r, 2.0));
    // The second on the other side of the plane y = 2r: mirrored.
    let points: Vec<DVec3> = b
        .control_points()
        .iter()
        .map(|p| v(p.x, 4.0 * r - p.y, p.z))
        .collect();
    let b = NurbsSurface::bezier(3, &points, Some(&b.weights())).unwrap();
    let c = measure(&a, Side::North, &b, Side::North, 1e-9);
    assert!(bounded(c.gap.greatest) < 1e-7, "{:?}", c.gap);
    assert!(c.gap.found < 1e-9, "{:?}", c.gap);
    assert!(bounded(c.angle.greatest) < 1e-7, "{:?}", c.angle);
    // Along the axis a cylinder is straight.
    assert!(bounded(c.curvature.greatest) < 1e-6, "{:?}", c.curvature);
    assert!(!c.same_orientation);
}

/// Octants of a sphere meet with all curvatures, along a meridian that ends in the pole and along the equator.
#[test]
fn octants_of_a_sphere_join_smoothly_up_to_the_pole() {
    let h = 0.5f64.sqrt();
    let octant = |turn: f64, up: f64| {
        let points = [
            v(1.0, 0.0, 0.0),
            v(1.0, 1.0, 0.0),
            v(0.0, 1.0, 0.0),
            v(1.0, 0.0, up),
            v(1.0, 1.0, up),
            v(0.0, 1.0, up),
            v(0.0, 0.0, up),
            v(0.0, 0.0, up),
            v(0.0, 0.0, up),
        ]
        .map(|p| DMat3::from_rotation_z(turn) * p * 5.0);
        NurbsSurface::bezier(3, &points, Some(&[1.0, h, 1.0, h, 0.5, h, 1.0, h, 1.0])).unwrap()
    };
    let (a, b, below) = (octant(0.0, 1.0), octant(PI / 2.0, 1.0), octant(0.0, -1.0));
    let meridian = measure(&a, Side::North, &b, Side::South, 1e-9);
    assert!(bounded(meridian.gap.greatest) < 1e-11);
    assert!(
        bounded(meridian.angle.greatest) < 1e-9,
        "{:?}",
        meridian.angle
    );
    assert!(meridian.same_orientation);
    let equator = measure(&a, Side::West, &below, Side::West, 1e-9);
    assert!(bounded(equator.angle.greatest) < 1e-9);
    assert!(
        bounded(equator.curvature.greatest) < 1e-8,
        "{:?}",
        equator.curvature
    );
    assert!(!equator.same_orientation);
    assert_eq!(equator.proven(1e-9, 1e-8, 1e-6), Some(Smoothness::G2));
    let r = regularity(&a, &JumpOptions::default());
    assert_eq!(r.collapsed, [Side::East]);
    assert!(r.regular, "{r:?}");
}

#[test]
fn bounds_hold_for_all_samples_and_are_close() {
    let mut random = laws::Random(4);
    for _ in 0..5 {
        let mut p = || v(random.unit(), random.unit(), random.unit()) * 0.2;
        let base = |i: usize, j: usize| v(i as f64, j as f64, 0.0);
        let a: Vec<Vec<DVec3>> = (0..4)
            .map(|i| (0..4).map(|j| base(i, j) + p()).collect())
            .collect();
        // The same edge up to a gap of 1e-4, and independent rows beyond it.
        let b: Vec<Vec<DVec3>> = (0..3)
            .map(|i| {
                (0..4)
                    .map(|j| {
                        if i == 0 {
                            a[3][j] + p() * 5e-4
                        } else {
                            base(3 + i, j) + p()
                        }
                    })
                    .collect()
            })
            .collect();
        let slices = |r: &[Vec<DVec3>]| net(&r.iter().map(Vec::as_slice).collect::<Vec<_>>(), None);
        let (a, b) = (slices(&a), slices(&b));
        let c = measure(&a, Side::East, &b, Side::West, 1e-3);
        let above = [nappe::Limit::Above; 2];
        let (mut gap, mut angle) = (0.0f64, 0.0f64);
        for k in 0..=2000 {
            let t = k as f64 / 2000.0;
            let (x, y) = (a.jet([1.0, t], above, 1), b.jet([0.0, t], above, 1));
            gap = gap.max(x.point().distance(y.point()));
            angle = angle.max(x.normal().unwrap().angle_between(y.normal().unwrap()));
        }
        for (jump, sampled) in [(c.gap, gap), (c.angle, angle)] {
            let bound = bounded(jump.greatest);
            assert!(
                sampled <= bound && bound <= 1.02 * sampled,
                "{sampled} {bound}"
            );
            assert!(jump.found <= sampled * (1.0 + 1e-5));
        }
        assert!(c.curvature.found <= bounded(c.curvature.greatest));
        assert_eq!(c.gap.within(gap * 1.05), Some(true));
        assert_eq!(c.gap.within(gap * 0.9), Some(false));
    }
}

#[test]
fn sides_that_do_not_coincide_are_not_measured() {
    let a = quarter(1.0, 1.0);
    let none =
        |s: Side, t: Side| continuity((&a, s), (&a, t), 1e-9, &JumpOptions::default()).is_none();
    assert!(none(Side::South, Side::North) && none(Side::South, Side::West));
}

#[test]
fn folds_and_degenerate_points_are_told_apart() {
    let o = JumpOptions::default();
    // A crossed quadrilateral turns over along a line.
    let bow = net(
        &[
            &[v(0.0, 0.0, 0.0), v(0.0, 1.0, 0.0)],
            &[v(1.0, 1.0, 0.0), v(1.0, 0.0, 0.0)],
        ],
        None,
    );
    let r = regularity(&bow, &o);
    assert!(!r.regular && r.degenerate.is_empty(), "{r:?}");
    for [u, _] in &r.folds {
        assert!((u - 0.5).abs() < 1e-2, "{r:?}");
    }
    // A corner where both sides leave in one direction.
    let corner = net(
        &[
            &[v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(2.0, 1.0, 0.0)],
            &[v(-1.0, 0.0, 0.0), v(0.5, 0.7, 0.0), v(2.0, 2.0, 0.0)],
            &[v(-2.0, 1.0, 0.0), v(0.0, 2.0, 0.0), v(1.0, 3.0, 0.0)],
        ],
        None,
    );
    let r = regularity(&corner, &o);
    assert!(!r.regular && r.folds.is_empty(), "{r:?}");
    assert!(r.degenerate.iter().all(|[u, v]| u.max(*v) < 1e-2), "{r:?}");
    // A surface that is a line.
    let line = net(
        &[&[DVec3::ZERO, DVec3::X], &[DVec3::X, DVec3::X * 2.0]],
        None,
    );
    let r = regularity(&line, &o);
    assert!(!r.regular && r.least == 0.0, "{r:?}");
    let plain = quarter(2.0, 1.0);
    let r = regularity(&plain, &o);
    assert!(
        r.regular && r.collapsed.is_empty() && r.least > 0.5,
        "{r:?}"
    );
}

/// The seam of a full turn joins smoothly, up to the poles at both ends of the profile; where it is found by matching.
#[test]
fn the_seam_of_a_full_turn_is_smooth() {
    let profile = NurbsCurve::bezier(
        &[
            v(0.0, 0.0, 0.0),
            v(2.0, 0.0, 0.0),
            v(1.0, 0.0, 2.0),
            v(0.0, 0.0, 2.0),
        ],
        None,
    )
    .unwrap();
    let axis = Frame::along(DVec3::ZERO, DVec3::Z).unwrap();
    let turned = Revolution::new(Arc::new(profile), axis, RevolutionOptions::default()).unwrap();
    let surfaces: Vec<SurfaceRef> = vec![Arc::new(turned)];
    let found = joints(&surfaces, 1e-9).joints;
    assert_eq!(found.len(), 1, "{found:?}");
    let side = |(i, s): (usize, Side)| (surfaces[i].as_ref(), s);
    let c = continuity(
        side(found[0].first),
        side(found[0].second),
        1e-9,
        &JumpOptions::default(),
    )
    .unwrap();
    assert!(bounded(c.gap.greatest) < 1e-12, "{:?}", c.gap);
    assert!(bounded(c.angle.greatest) < 1e-8, "{:?}", c.angle);
    assert!(c.curvature.found < 1e-9, "{:?}", c.curvature);
    assert!(c.same_orientation);
    let r = regularity(surfaces[0].as_ref(), &JumpOptions::default());
    assert_eq!(r.collapsed.len(), 2);
    assert!(r.regular, "{r:?}");
}

#[test]
fn no_seam_that_ends_in_poles_has_an_angle_or_a_jump() {
    // Also flat and thin ones, far from the origin: towards the poles there are rounding errors only.
    for (axes, far) in [
        ([1.0, 1.0, 1.0], 0.0),
        ([2.0, 1.0, 30.0], 0.0),
        ([200.0, 1.0, 0.03], 1e4),
        ([1e3, 1e3, 1e-3], 0.0),
        ([1e-6, 1e-6, 1e3], 0.0),
    ] {
        let options = QuadricOptions {
            frame: Frame::along(v(0.09, 0.07, 1.0) * far, DVec3::Z).unwrap(),
            ..Default::default()
        };
        let s = Quadric::new(QuadricShape::Ellipsoid, &axes, options).unwrap();
        let c = measure(&s, Side::West, &s, Side::East, 1e-6);
        assert!(
            c.angle.found < 1e-6 && c.curvature.found < 1e-6,
            "{axes:?}: {c:?}"
        );
        assert!(c.curvature.greatest.error() < 1e3, "{axes:?}: {c:?}");
    }
}

#[test]
fn a_corner_of_the_profile_is_a_crease_of_its_angle() {
    use nappe::curve::{Spacing, polyline};
    use nappe::measure::creases;
    use nappe::surface::{Dir, ruled};
    let rail = |z: f64| -> nappe::curve::CurveRef {
        let p = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)].map(|(x, y)| nappe::DVec3::new(x, y, z));
        std::sync::Arc::new(polyline(&p, Spacing::Chord).unwrap())
    };
    let bent = ruled(rail(0.0), rail(1.0), Dir::U).unwrap();
    let found = creases(&bent);
    assert_eq!(found.len(), 1);
    assert_eq!((found[0].dir, found[0].at), (Dir::U, 0.5));
    assert!((found[0].angle - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    let flat = nappe::surface::bilinear([
        [nappe::DVec3::ZERO, nappe::DVec3::Y],
        [nappe::DVec3::X, nappe::DVec3::ONE],
    ]);
    assert!(creases(&flat.unwrap()).is_empty());
}
