//! The laws of surfaces, and that construction commutes with maps.

use super::*;

#[test]
fn laws_at_all_scales() {
    at_places(|scale, shift| {
        let source = patch(7, [3, 4], scale, shift);
        laws::surface(&coons(&sides(&source), &CoonsOptions::default()).unwrap());
        let options = CoonsOptions {
            cross: given(&source),
            ..cubic()
        };
        laws::surface(&coons(&sides(&source), &options).unwrap());
        let options = CoonsOptions {
            blend: Blending::trigonometric(1.2).unwrap(),
            estimate: Estimate::Adini,
            ..CoonsOptions::default()
        };
        laws::surface(&coons(&sides(&source), &options).unwrap());
        laws::surface(&gregory(scale, shift));
    });
}

#[test]
fn a_hundred_thousand_boxes_hold_their_samples() {
    let source = patch(7, [3, 4], 1.0, DVec3::ZERO);
    let options = CoonsOptions {
        cross: given(&source),
        ..cubic()
    };
    laws::surface_with(&coons(&sides(&source), &options).unwrap(), 100_000);
}

#[test]
fn a_hundred_thousand_boxes_hold_with_trigonometric_blending() {
    let source = patch(7, [3, 4], 1.0, DVec3::ZERO);
    let options = CoonsOptions {
        blend: Blending::trigonometric(2.0).unwrap(),
        ..CoonsOptions::default()
    };
    laws::surface_with(&coons(&sides(&source), &options).unwrap(), 100_000);
}

#[test]
fn affine_maps_commute_with_construction() {
    let source = patch(9, [3, 4], 1.0, DVec3::ZERO);
    let mut random = Random(3);
    let map = DAffine3::from_mat3_translation(
        DMat3::from_cols(
            vector(&mut random),
            vector(&mut random),
            vector(&mut random),
        ),
        DVec3::new(3.0, -1.0, 2.0),
    );
    let points: Vec<_> = source
        .control_points()
        .iter()
        .map(|p| map.transform_point3(*p))
        .collect();
    let image = NurbsSurface::bezier(4, &points, None).unwrap();
    for blend in blendings() {
        let of = |s: &NurbsSurface| {
            let options = CoonsOptions {
                blend: blend.clone(),
                cross: given(s),
                ..CoonsOptions::default()
            };
            coons(&sides(s), &options).unwrap()
        };
        let (a, b) = (of(&source), of(&image));
        assert!(apart(&b, |uv| map.transform_point3(a.point(uv))) <= 2e-14);
        assert!(apart(&a.separable().unwrap().transformed(&map), |uv| b.point(uv)) <= 2e-14);
    }
}

#[test]
fn exchange_of_u_and_v_commutes_with_construction() {
    let c = gregory(1.0, DVec3::ZERO);
    let source = patch(8, [4, 4], 1.0, DVec3::ZERO);
    let [s, n, w, e] = sides(&source);
    let cross = [
        changed(&source, Side::West, 1.0),
        changed(&source, Side::East, 1.0),
        boundary(&source, Side::South, 1),
        boundary(&source, Side::North, 1),
    ];
    let options = CoonsOptions {
        cross: cross.map(Cross::Curve),
        incompatible_twists: IncompatibleTwists::Gregory,
        ..cubic()
    };
    let exchanged = Coons::new(w, e, s, n, &options).unwrap();
    assert!(apart(&exchanged, |[u, v]| c.point([v, u])) <= 4e-15);
}
