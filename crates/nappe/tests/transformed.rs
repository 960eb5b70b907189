//! Surfaces under maps, exchanged parameters, and the elementary surfaces that are recognised through both.

#![allow(clippy::unwrap_used)]

use nappe::curve::{CurveRef, Ellipse};
use nappe::exact::NurbsCurve;
use nappe::maps::{mirror, rotation, scaling};
use nappe::surface::{
    Elementary, Revolution, RevolutionOptions, Surface, SurfaceRef, Swapped, TransformError,
    Transformed, bilinear, normal_at,
};
use nappe::{DAffine3, DMat3, DVec3, Frame, Limit, laws};
use std::sync::Arc;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn vase() -> SurfaceRef {
    let p = [v(1.0, 0.0, 0.0), v(3.0, 0.5, 1.0), v(0.0, 0.0, 2.0)];
    let profile: CurveRef = Arc::new(NurbsCurve::bezier(&p, Some(&[1.0, 0.4, 2.0])).unwrap());
    Arc::new(Revolution::new(profile, Frame::WORLD, RevolutionOptions::default()).unwrap())
}

fn maps() -> Vec<DAffine3> {
    let tilted = Frame::along(v(1.0, -2.0, 0.5), v(1.0, 2.0, 3.0)).unwrap();
    vec![
        DAffine3::from_translation(v(1e3, 2e3, -5.0)),
        rotation(&tilted, 1.1),
        mirror(&tilted),
        scaling(&tilted, v(1.0, 0.2, 7.0)),
        DAffine3::from_scale(v(1e-6, 1e-6, 1e-6)),
        DAffine3::from_scale(v(1e6, -1e6, 1e6)),
    ]
}

#[test]
fn laws_under_every_map() {
    let rational = vase().to_rational().unwrap();
    for map in maps() {
        laws::surface(&Transformed::new(vase(), map).unwrap());
        laws::surface(&Transformed::new(Arc::new(rational.clone()), map).unwrap());
    }
    laws::surface(&Swapped::new(vase()));
    laws::surface(&Swapped::new(Arc::new(rational)));
    laws::surface_with(&Transformed::new(vase(), maps()[3]).unwrap(), 100_000);
}

#[test]
fn normals_follow_the_map() {
    let s = vase();
    for map in maps() {
        let image = Transformed::new(s.clone(), map).unwrap();
        for uv in [[0.0, 0.0], [0.3, 0.7], [1.0, 0.2]] {
            let n = normal_at(s.as_ref(), uv, [Limit::Above; 2])
                .vector()
                .unwrap();
            let m = normal_at(&image, uv, [Limit::Above; 2]).vector().unwrap();
            assert!(
                (image.normal(n).unwrap() - m).length() < 1e-9,
                "{map} {uv:?}"
            );
        }
    }
    let swapped = Swapped::new(s.clone());
    let n = normal_at(s.as_ref(), [0.3, 0.7], [Limit::Above; 2]).vector();
    let m = normal_at(&swapped, [0.7, 0.3], [Limit::Above; 2]).vector();
    assert!((n.unwrap() + m.unwrap()).length() < 1e-14);
}

#[test]
fn maps_that_flatten_are_refused() {
    let flat = DAffine3::from_scale(v(1.0, 1.0, 0.0));
    assert!(matches!(
        Transformed::new(vase(), flat),
        Err(TransformError::Flattens { determinant: 0.0 })
    ));
    let nan = DAffine3::from_scale(v(1.0, f64::NAN, 1.0));
    assert!(matches!(
        Transformed::new(vase(), nan),
        Err(TransformError::NotFinite { .. })
    ));
    let sheared = DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::X, DVec3::Z));
    assert!(Transformed::new(vase(), sheared).is_err());
}

#[test]
fn planes_are_recognised_with_their_side() {
    let corners = [
        [v(0.0, 0.0, 1.0), v(0.0, 2.0, 1.0)],
        [v(3.0, 0.0, 1.0), v(3.0, 3.0, 1.0)],
    ];
    let flat: SurfaceRef = Arc::new(bilinear(corners).unwrap());
    let up = Some(DVec3::Z);
    let normal = |s: &dyn Surface| match s.elementary() {
        Some(Elementary::Plane { normal, .. }) => Some(normal),
        _ => None,
    };
    assert_eq!(normal(flat.as_ref()), up);
    assert_eq!(normal(&Swapped::new(flat.clone())), up.map(|n| -n));
    for map in maps() {
        let image = Transformed::new(flat.clone(), map).unwrap();
        let want = normal_at(&image, [0.4, 0.4], [Limit::Above; 2])
            .vector()
            .unwrap();
        assert!((normal(&image).unwrap() - want).length() < 1e-12);
    }
    let mut bent = corners;
    bent[1][1].z = 1.0 + 1e-9;
    assert_eq!(bilinear(bent).unwrap().elementary(), None);
    assert_eq!(vase().elementary(), None);
}

#[test]
fn a_profile_by_angle_gives_the_same_points_rationally() {
    // A half circle by its angle: no NURBS form, but a sphere all the same.
    let arc = Ellipse::arc(DVec3::ZERO, 2.0, 0.0, std::f64::consts::PI, -DVec3::Y).unwrap();
    let s = Revolution::new(
        Arc::new(arc),
        Frame::along(DVec3::ZERO, DVec3::X).unwrap(),
        RevolutionOptions::default(),
    )
    .unwrap();
    assert_eq!(s.poles(), [true, true]);
    assert!(s.to_nurbs().is_none());
    let n = s.to_rational().unwrap();
    for i in 0..=40 {
        for j in 0..=40 {
            let uv = [i as f64 / 40.0, j as f64 / 40.0];
            assert!((n.point(uv).length() - 2.0).abs() < 1e-14);
            assert!((s.point(uv).length() - 2.0).abs() < 1e-14);
        }
    }
    assert_eq!(n.point([1.0, 0.3]), n.point([1.0, 0.8]));
}
