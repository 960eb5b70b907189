//! Centroids and inertia against closed forms.

#![allow(clippy::unwrap_used)]

use nappe::curve::{CurveRef, ExpressionCurve};
use nappe::expr::Expr;
use nappe::measure::{
    Centroid, Inertia, IntegralOptions, Measured, Solid, area, area_centroid, joint_centroid,
    solids,
};
use nappe::mesh::Certainty;
use nappe::surface::{
    Quadric, QuadricOptions, QuadricShape, Revolution, RevolutionOptions, SurfaceRef, Swapped,
    Transformed, bilinear,
};
use nappe::{DAffine3, DMat3, DVec3, Frame};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn revolved(x: &str, z: &str, angle: f64) -> SurfaceRef {
    let bound = |s: &str| Expr::parse(s).unwrap().bind(&["t"], &[]).unwrap();
    let profile: CurveRef =
        Arc::new(ExpressionCurve::new([bound(x), bound("0"), bound(z)], [0.0, 1.0]).unwrap());
    let options = RevolutionOptions {
        angle,
        ..Default::default()
    };
    Arc::new(Revolution::new(profile, Frame::WORLD, options).unwrap())
}

fn placed(s: &SurfaceRef, map: DAffine3) -> SurfaceRef {
    Arc::new(Transformed::new(s.clone(), map).unwrap())
}

fn ellipsoid(axes: [f64; 3]) -> SurfaceRef {
    let shape = QuadricShape::Ellipsoid;
    Arc::new(Quadric::new(shape, &axes, QuadricOptions::default()).unwrap())
}

/// Scales, and places far from the origin.
fn places() -> Vec<(f64, DAffine3)> {
    let turn = DMat3::from_axis_angle(v(1.0, 2.0, -0.5).normalize(), 0.7);
    let map = |scale: f64, far: f64| {
        let shift = v(far, -2.0 * far, 0.5 * far);
        (scale, DAffine3::from_mat3_translation(turn * scale, shift))
    };
    vec![map(1.0, 0.0), map(1e-6, 0.0), map(1e6, 1e3), map(1.0, 1e6)]
}

const MILLIONTH: IntegralOptions = IntegralOptions {
    relative: 1e-6,
    budget: 8000,
};

fn bounded(c: Certainty) -> f64 {
    match c {
        Certainty::Bounded(e) => e,
        _ => panic!("{c:?}"),
    }
}

/// The point lies where the bound says, and the bound is small compared with a size, far away but for rounding.
fn assert_at(c: Centroid, want: DVec3, size: f64) {
    let e = bounded(c.certainty);
    // The expected point is rounded itself.
    let rounding = 4.0 * f64::EPSILON * want.length();
    assert!(c.point.distance(want) <= e + rounding, "{c:?} for {want}");
    assert!(e <= 1e-5 * size + 2.0 * rounding, "{c:?}");
}

fn assert_near(m: Measured, want: f64, unit: f64) {
    let e = bounded(m.certainty);
    assert!(
        (m.value - want).abs() <= e + 1e-12 * unit,
        "{m:?} for {want}"
    );
    assert!(e <= 2e-5 * unit, "{m:?} in {unit}");
}

#[test]
fn centroids_of_areas() {
    // A hemisphere; a cone's coat, two thirds below its tip; half of a turn of a cylinder; a triangle with a side that is
    // a point.
    let triangle: SurfaceRef = Arc::new(
        bilinear([
            [DVec3::ZERO, DVec3::ZERO],
            [v(3.0, 0.0, 0.0), v(0.0, 3.0, 3.0)],
        ])
        .unwrap(),
    );
    let cases = [
        (
            revolved("sin(pi/2*t)", "cos(pi/2*t)", TAU),
            v(0.0, 0.0, 0.5),
            TAU,
        ),
        (
            revolved("2*t", "-3*t", TAU),
            v(0.0, 0.0, -2.0),
            PI * 2.0 * 13f64.sqrt(),
        ),
        (revolved("1", "t", PI), v(0.0, 2.0 / PI, 0.5), PI),
        (triangle, v(1.0, 1.0, 1.0), 0.5 * 9.0 * 2f64.sqrt()),
    ];
    for (s, want, whole) in &cases {
        for (scale, map) in places() {
            let s = placed(s, map);
            let m = area_centroid(s.as_ref(), &MILLIONTH);
            assert_at(m.centroid.unwrap(), map.transform_point3(*want), scale);
            let whole = whole * scale * scale;
            assert_near(m.area, whole, whole);
        }
    }
    // The area is that of the measure for areas alone.
    let alone = area(cases[0].0.as_ref(), &MILLIONTH);
    let both = area_centroid(cases[0].0.as_ref(), &MILLIONTH).area;
    assert!((alone.value - both.value).abs() <= alone.certainty.error() + both.certainty.error());
}

#[test]
fn the_centroid_of_parts_is_that_of_the_whole() {
    let whole = ["1.5+0.5*t^2-t", "0.3*t+sin(t)"];
    let part = |a: f64, b: f64| {
        let [x, z] = whole.map(|s| s.replace('t', &format!("({a:?}+{:?}*t)", b - a)));
        area_centroid(revolved(&x, &z, 2.0).as_ref(), &MILLIONTH)
    };
    let all = area_centroid(revolved(whole[0], whole[1], 2.0).as_ref(), &MILLIONTH);
    let parts = [part(0.0, 0.3), part(0.3, 0.5), part(0.5, 1.0)];
    let joint = joint_centroid(&parts);
    let (a, b) = (joint.centroid.unwrap(), all.centroid.unwrap());
    let room = bounded(a.certainty) + bounded(b.certainty);
    assert!(
        a.point.distance(b.point) <= room && room < 1e-5,
        "{a:?} {b:?}"
    );
    let difference = (joint.area.value - all.area.value).abs();
    assert!(difference <= joint.area.certainty.error() + all.area.certainty.error());
    assert_eq!(joint_centroid(&[]).centroid, None);
}

#[test]
fn parts_without_area_do_not_hide_the_centroid_of_the_rest() {
    let flat = |p: [[DVec3; 2]; 2]| area_centroid(&bilinear(p).unwrap(), &MILLIONTH);
    for (scale, map) in places() {
        let at = |x: f64, y: f64| map.transform_point3(v(x, y, 0.0));
        let square = flat([[at(0.0, 0.0), at(0.0, 1.0)], [at(1.0, 0.0), at(1.0, 1.0)]]);
        let line = flat([[at(3.0, 0.0); 2], [at(5.0, 1.0); 2]]);
        let point = flat([[at(7.0, 7.0); 2]; 2]);
        // Nothing weighs there, but where it is is known.
        for (thin, middle, reach) in [
            (line, at(4.0, 0.5), 1.2 * scale),
            (point, at(7.0, 7.0), 0.0),
        ] {
            let c = thin.centroid.unwrap();
            let rounding = 1e-14 * middle.length();
            assert!(
                c.point.distance(middle) <= bounded(c.certainty) + rounding,
                "{c:?}"
            );
            assert!(bounded(c.certainty) <= 2.0 * reach + rounding, "{c:?}");
        }
        let all = joint_centroid(&[square, line, point]);
        assert_at(all.centroid.unwrap(), at(0.5, 0.5), scale);
        assert_eq!(joint_centroid(&[line, point]).centroid, None);
    }
}

fn solid(surfaces: &[SurfaceRef]) -> Solid {
    let mut found = solids(surfaces, None, &MILLIONTH);
    assert_eq!(found.len(), 1);
    found.pop().unwrap().unwrap()
}

/// The tensor is this one turned, in units of its trace.
fn assert_tensor(found: &Inertia, diagonal: DVec3, turn: DMat3) {
    let want = turn * DMat3::from_diagonal(diagonal) * turn.transpose();
    let unit = diagonal.element_sum();
    for i in 0..3 {
        for j in 0..3 {
            assert_near(found.tensor[i][j], want.col(j)[i], unit);
        }
    }
    let mut sorted = diagonal.to_array();
    sorted.sort_by(f64::total_cmp);
    for (found, want) in found.principal.iter().zip(sorted) {
        assert_near(*found, want, unit);
    }
}

#[test]
fn bodies_have_the_inertia_of_the_closed_forms() {
    let half_ball = vec![
        revolved("sin(pi/2*t)", "cos(pi/2*t)", TAU),
        revolved("1-t", "0", TAU),
    ];
    let torus = vec![revolved("3+cos(2*pi*t)", "-sin(2*pi*t)", TAU)];
    let (ball, ring) = (4.0 / 3.0 * PI, 6.0 * PI * PI);
    let cases = [
        (
            vec![ellipsoid([1.0, 2.0, 5.0])],
            ball * 10.0,
            DVec3::ZERO,
            ball * 2.0 * v(29.0, 26.0, 5.0),
        ),
        (
            half_ball,
            ball / 2.0,
            v(0.0, 0.0, 0.375),
            ball / 2.0 * v(83.0 / 320.0, 83.0 / 320.0, 0.4),
        ),
        (
            torus,
            ring,
            DVec3::ZERO,
            ring * v(4.5 + 0.625, 4.5 + 0.625, 9.75),
        ),
    ];
    for (surfaces, volume, centre, inertia) in cases {
        for (scale, map) in places() {
            let surfaces: Vec<_> = surfaces.iter().map(|s| placed(s, map)).collect();
            let s = solid(&surfaces);
            let volume = volume * scale.powi(3);
            assert_near(s.shell.volume, volume, volume);
            assert_at(
                s.centroid.unwrap(),
                map.transform_point3(centre),
                scale * 5.0,
            );
            let turn = map.matrix3 * (1.0 / scale);
            assert_tensor(&s.inertia.unwrap(), inertia * scale.powi(5), turn);
        }
    }
}

/// The faces of a box with three edges from a corner, normals outwards.
fn block(o: DVec3, [x, y, z]: [DVec3; 3]) -> Vec<SurfaceRef> {
    let face = |a: DVec3, b: DVec3, c: DVec3| -> SurfaceRef {
        Arc::new(bilinear([[a, a + c], [a + b, a + b + c]]).unwrap())
    };
    vec![
        face(o, y, x),
        face(o, x, z),
        face(o, z, y),
        face(o + z, x, y),
        face(o + y, z, x),
        face(o + x, y, z),
    ]
}

#[test]
fn a_brick_turned_anyhow_has_its_principal_axes() {
    for (scale, map) in places() {
        let edges = [v(2.0, 0.0, 0.0), v(0.0, 3.0, 0.0), v(0.0, 0.0, 5.0)];
        let faces = block(
            map.transform_point3(DVec3::ZERO),
            edges.map(|e| map.transform_vector3(e)),
        );
        let s = solid(&faces);
        assert_at(
            s.centroid.unwrap(),
            map.transform_point3(v(1.0, 1.5, 2.5)),
            scale,
        );
        let found = s.inertia.unwrap();
        let mass = 30.0 * scale.powi(3);
        let moments = v(34.0, 29.0, 13.0) * (mass * scale * scale / 12.0);
        let turn = map.matrix3 * (1.0 / scale);
        assert_tensor(&found, moments, turn);
        // Increasing moments: the long edge first.
        for (k, edge) in [2, 1, 0].into_iter().enumerate() {
            let edge = turn.col(edge);
            let turned = bounded(found.turned[k]);
            let off = found.axes[k].cross(edge).length().asin();
            assert!(off <= turned + 1e-14 && turned < 1e-3, "{off:e} {turned:e}");
        }
        let [x, y, z] = found.axes;
        assert!(x.cross(y).dot(z) > 0.999);
    }
    // A cube has no axes of its own.
    let cube = solid(&block(DVec3::ZERO, [DVec3::X, DVec3::Y, DVec3::Z]));
    let turned = cube.inertia.unwrap().turned.map(bounded);
    assert!(turned.iter().all(|t| *t > 1.57), "{turned:?}");
}

#[test]
fn faces_that_look_inwards_are_turned() {
    for (scale, map) in places() {
        let edges = [v(2.0, 0.0, 0.0), v(0.0, 3.0, 0.0), v(0.0, 0.0, 5.0)];
        let corner = map.transform_point3(DVec3::ZERO);
        let mut faces = block(corner, edges.map(|e| map.transform_vector3(e)));
        // The first too, which the others are turned to agree with.
        for k in [0, 2, 3] {
            faces[k] = Arc::new(Swapped::new(faces[k].clone()));
        }
        let s = solid(&faces);
        let inwards: Vec<_> = s.shell.surfaces.iter().filter(|f| f.1).collect();
        assert_eq!(inwards.len(), 3);
        assert!(inwards.iter().all(|f| [0, 2, 3].contains(&f.0)));
        assert_near(s.shell.volume, 30.0 * scale.powi(3), 30.0 * scale.powi(3));
        let centre = map.transform_point3(v(1.0, 1.5, 2.5));
        assert_at(s.centroid.unwrap(), centre, scale);
        let moments = v(34.0, 29.0, 13.0) * (30.0 * scale.powi(5) / 12.0);
        let turn = map.matrix3 * (1.0 / scale);
        assert_tensor(&s.inertia.unwrap(), moments, turn);
    }
}

#[test]
fn what_gaps_may_hold_counts_in_all_moments() {
    // A cube whose lid lies a little above it.
    let gap = 1e-4;
    let mut faces = block(DVec3::ZERO, [DVec3::X, DVec3::Y, DVec3::Z]);
    faces[3] = block(v(0.0, 0.0, gap), [DVec3::X, DVec3::Y, DVec3::Z]).swap_remove(3);
    let found = solids(&faces, Some(10.0 * gap), &MILLIONTH);
    let [Ok(s)] = found.as_slice() else {
        panic!("{found:?}")
    };
    let centroid = s.centroid.unwrap();
    let e = bounded(centroid.certainty);
    let want = v(0.5, 0.5, 0.5 * (1.0 + gap));
    assert!(centroid.point.distance(want) <= e, "{centroid:?}");
    assert!(e > 0.1 * gap && e < 20.0 * gap, "{e:e}");
    let h = 1.0 + gap;
    let want = h * (1.0 + h * h) / 12.0;
    let xx = s.inertia.as_ref().unwrap().tensor[0][0];
    assert!((xx.value - want).abs() <= bounded(xx.certainty), "{xx:?}");
    assert!(xx.certainty.error() > 0.01 * gap);
}

#[test]
fn a_small_body_in_a_large_model_has_its_moments() {
    let small = placed(
        &ellipsoid([1.0; 3]),
        DAffine3::from_mat3_translation(
            DMat3::from_diagonal(DVec3::splat(1e-3)),
            v(1.0, -2.0, 3.0),
        ),
    );
    // Sides of the model count as one within a distance larger than the body.
    let found = solids(&[small], Some(0.1), &MILLIONTH);
    let [Ok(s)] = found.as_slice() else {
        panic!("{found:?}")
    };
    assert_at(s.centroid.unwrap(), v(1.0, -2.0, 3.0), 1e-3);
    let want = 0.4 * s.shell.volume.value * 1e-6;
    assert_near(s.inertia.as_ref().unwrap().tensor[0][0], want, want);
}

#[test]
fn thin_bodies_have_their_moments() {
    for axes in [[1e3, 1e3, 1e-3], [0.1, 0.1, 1e3], [1e-6, 2e-6, 1e-6]] {
        let s = solid(&[ellipsoid(axes)]);
        let [a, b, c] = axes;
        let volume = 4.0 / 3.0 * PI * a * b * c;
        assert_near(s.shell.volume, volume, volume);
        let want = v(b * b + c * c, c * c + a * a, a * a + b * b) * (volume / 5.0);
        let found = s.inertia.unwrap();
        for (k, want) in want.to_array().into_iter().enumerate() {
            // The smallest moment too, to a share of itself.
            let m = found.tensor[k][k];
            let e = bounded(m.certainty);
            assert!(
                (m.value - want).abs() <= e && e <= 1e-4 * want,
                "{axes:?}: {m:?} for {want}"
            );
        }
    }
}
