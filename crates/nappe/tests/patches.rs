//! Bilinear, ruled, Hermite, Bézier and biquadratic surfaces: the laws, closed forms and invariances.

#![allow(clippy::unwrap_used)]

use nappe::basis::{BSplineBasis, Functions, Hermite};
use nappe::curve::{Curve, CurveRef, Trimmed, on_unit_domain};
use nappe::exact::{NurbsCurve, NurbsSurface};
use nappe::laws::{self, Random};
use nappe::surface::{
    BilinearError, BiquadraticError, Dir, HermiteData, HermiteError, RuledError, Surface, bilinear,
    biquadratic, hermite, ruled,
};
use nappe::{DAffine3, DMat3, DVec3, Limit};
use std::sync::Arc;

const SCALES: [f64; 3] = [1e-6, 1.0, 1e6];

fn places(scale: f64) -> [DVec3; 2] {
    [DVec3::ZERO, DVec3::new(1e3, -2e3, 5e2) * scale]
}

fn vector(random: &mut Random) -> DVec3 {
    DVec3::new(random.unit(), random.unit(), random.unit())
}

fn table(random: &mut Random, scale: f64, shift: DVec3) -> [[DVec3; 2]; 2] {
    [[(); 2]; 2].map(|r| r.map(|()| shift + vector(random) * scale))
}

/// A rational cubic spline over [-1, 3] with a break.
fn spline(seed: u64, scale: f64, shift: DVec3) -> CurveRef {
    let mut random = Random(seed);
    let points: Vec<_> = (0..6)
        .map(|i| shift + (vector(&mut random) + DVec3::X * i as f64) * scale)
        .collect();
    let weights: Vec<_> = (0..6).map(|_| 0.5 + random.unit()).collect();
    let knots = vec![-1.0, -1.0, -1.0, -1.0, 0.2, 0.7, 3.0, 3.0, 3.0, 3.0];
    Arc::new(NurbsCurve::new(3, knots, &points, Some(&weights)).unwrap())
}

fn assert_same(a: &dyn Surface, b: impl Fn([f64; 2]) -> DVec3, tol: f64) {
    for i in 0..=10 {
        for j in 0..=10 {
            let uv = [i as f64 / 10.0, j as f64 / 10.0];
            let d = (a.point(uv) - b(uv)).length();
            assert!(d <= tol, "{uv:?}: {d:e} apart");
        }
    }
}

#[test]
fn laws_at_all_scales() {
    let mut random = Random(2);
    for scale in SCALES {
        for shift in places(scale) {
            laws::surface(&bilinear(table(&mut random, scale, shift)).unwrap());
            for along in [Dir::U, Dir::V] {
                let up = shift + DVec3::Z * scale;
                let (a, b) = (spline(1, scale, shift), spline(2, scale, up));
                laws::surface(&ruled(a, b, along).unwrap());
            }
            let data = HermiteData {
                corners: table(&mut random, scale, shift),
                tangents_u: table(&mut random, scale, DVec3::ZERO),
                tangents_v: table(&mut random, scale, DVec3::ZERO),
                twists: table(&mut random, scale, DVec3::ZERO),
            };
            laws::surface(&hermite(&data).unwrap());
            let nine = [[(); 3]; 3].map(|r| r.map(|()| shift + vector(&mut random) * scale));
            laws::surface(&biquadratic(&nine, 0.6, 1.7).unwrap());
        }
    }
}

#[test]
fn a_hundred_thousand_boxes_hold_their_samples() {
    let mut random = Random(4);
    let t = |r: &mut Random| table(r, 1.0, DVec3::ZERO);
    laws::surface_with(&bilinear(t(&mut random)).unwrap(), 100_000);
    let (a, b) = (spline(1, 1.0, DVec3::ZERO), spline(2, 1.0, DVec3::Z));
    laws::surface_with(&ruled(a, b, Dir::U).unwrap(), 100_000);
    let data = HermiteData {
        corners: t(&mut random),
        tangents_u: t(&mut random),
        tangents_v: t(&mut random),
        twists: t(&mut random),
    };
    laws::surface_with(&hermite(&data).unwrap(), 100_000);
    let nine = [[(); 3]; 3].map(|r| r.map(|()| vector(&mut random)));
    laws::surface_with(&biquadratic(&nine, 0.6, 1.7).unwrap(), 100_000);
}

#[test]
fn the_cube_corners_of_the_source_give_its_formula() {
    let [o, y, xz, yz] = [
        DVec3::ZERO,
        DVec3::Y,
        DVec3::new(1.0, 0.0, 1.0),
        DVec3::new(0.0, 1.0, 1.0),
    ];
    let s = bilinear([[o, y], [xz, yz]]).unwrap();
    assert_same(&s, |[u, w]| DVec3::new(u * (1.0 - w), w, u), 1e-15);
    // The hyperbolic paraboloid x = z (1 - y).
    assert_same(
        &s,
        |uv| {
            let p = s.point(uv);
            DVec3::new(p.z * (1.0 - p.y), p.y, p.z)
        },
        1e-15,
    );
    assert_eq!(s.to_nurbs().unwrap().size(), [2, 2]);
}

#[test]
fn rulings_are_straight_and_end_on_the_rails() {
    let (a, b) = (spline(1, 1.0, DVec3::ZERO), spline(2, 1.0, DVec3::Z));
    let along_u = ruled(a.clone(), b.clone(), Dir::U).unwrap();
    let along_v = ruled(a.clone(), b.clone(), Dir::V).unwrap();
    let line = |t: f64, s: f64| a.point(4.0 * t - 1.0) * (1.0 - s) + b.point(4.0 * t - 1.0) * s;
    assert_same(&along_u, |[u, v]| line(u, v), 1e-14);
    assert_same(&along_v, |[u, v]| line(v, u), 1e-14);
    let n = along_u.to_nurbs().unwrap();
    assert_same(&n, |[u, v]| line(u, v), 1e-13);
}

#[test]
fn a_curve_on_the_unit_domain_is_the_same_curve() {
    let c = spline(3, 1.0, DVec3::ZERO);
    let unit = on_unit_domain(c.clone());
    laws::curve(unit.as_ref());
    let reversed = Trimmed::reversed(c.clone());
    laws::curve(&reversed);
    assert!(Arc::ptr_eq(&unit, &on_unit_domain(unit.clone())));
    for b in c.breaks() {
        for limit in [Limit::Below, Limit::Above] {
            let (x, y) = (
                c.jet(b.at, limit, 3),
                unit.jet((b.at + 1.0) / 4.0, limit, 3),
            );
            let opposite = match limit {
                Limit::Below => Limit::Above,
                Limit::Above => Limit::Below,
            };
            let z = reversed.jet((3.0 - b.at) / 4.0, opposite, 3);
            for k in 0..=3 {
                let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
                assert!((z.d[k] * sign - y.d[k]).length() <= 1e-12 * y.d[k].length().max(1.0));
                let want = x.d[k] * 4f64.powi(k as i32);
                assert!((want - y.d[k]).length() <= 1e-12 * want.length().max(1.0));
            }
        }
    }
}

/// Q = U N P Nᵀ W of the source, with its corrected matrix.
#[test]
fn hermite_is_the_matrix_form_of_the_source() {
    let mut random = Random(8);
    let mut t = || table(&mut random, 1.0, DVec3::ZERO);
    let (c, tu, tv, tw) = (t(), t(), t(), t());
    let s = hermite(&HermiteData {
        corners: c,
        tangents_u: tu,
        tangents_v: tv,
        twists: tw,
    })
    .unwrap();
    let p = [
        [c[0][0], c[0][1], tv[0][0], tv[0][1]],
        [c[1][0], c[1][1], tv[1][0], tv[1][1]],
        [tu[0][0], tu[0][1], tw[0][0], tw[0][1]],
        [tu[1][0], tu[1][1], tw[1][0], tw[1][1]],
    ];
    let n = [
        [2.0, -2.0, 1.0, 1.0],
        [-3.0, 3.0, -2.0, -1.0],
        [0.0, 0.0, 1.0, 0.0],
        [1.0, 0.0, 0.0, 0.0],
    ];
    let row = |t: f64| {
        let powers = [t * t * t, t * t, t, 1.0];
        [0, 1, 2, 3].map(|j| (0..4).map(|k| powers[k] * n[k][j]).sum::<f64>())
    };
    let source = |[u, w]: [f64; 2]| {
        let (f, g) = (row(u), row(w));
        (0..16)
            .map(|k| p[k / 4][k % 4] * (f[k / 4] * g[k % 4]))
            .sum()
    };
    assert_same(&s, source, 1e-14);
    for (u, v) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let jet = s.jet([u as f64, v as f64], [Limit::Above; 2], 2);
        for (got, want) in [
            (jet.point(), c[u][v]),
            (jet.partial(1, 0), tu[u][v]),
            (jet.partial(0, 1), tv[u][v]),
            (jet.partial(1, 1), tw[u][v]),
        ] {
            assert!((got - want).length() <= 1e-14);
        }
    }
    assert_eq!(s.to_nurbs().unwrap().size(), [4, 4]);
}

#[test]
fn hermite_functions_are_the_shape_functions_of_the_source() {
    let h = Hermite::new();
    for i in 0..=20 {
        let t = i as f64 / 20.0;
        let mut d = [0.0; 16];
        h.jet_into(t, Limit::Above, 3, &mut d);
        let (t2, t3) = (t * t, t * t * t);
        let want = [
            2.0 * t3 - 3.0 * t2 + 1.0,
            t3 - 2.0 * t2 + t,
            t3 - t2,
            3.0 * t2 - 2.0 * t3,
            6.0 * t2 - 6.0 * t,
            3.0 * t2 - 4.0 * t + 1.0,
            3.0 * t2 - 2.0 * t,
            6.0 * t - 6.0 * t2,
            12.0 * t - 6.0,
            6.0 * t - 4.0,
            6.0 * t - 2.0,
            6.0 - 12.0 * t,
            12.0,
            6.0,
            6.0,
            -12.0,
        ];
        for (got, want) in d.iter().zip(want) {
            assert!((got - want).abs() <= 2e-14, "{t}: {got} {want}");
        }
        let all = h.to_piecewise().unwrap().value(t);
        assert!(all.iter().zip(d).all(|(a, b)| (a - b).abs() <= 1e-15));
    }
}

/// A quarter by a half of the torus with radii 3 and 1: opening angles 90° along u (around the axis) and v.
#[test]
fn biquadratic_weights_make_a_torus_piece() {
    let arc = [(1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let points = arc.map(|(c, s)| {
        arc.map(|(x, z)| {
            let r = 3.0 + x;
            DVec3::new(r * c, r * s, z)
        })
    });
    let w = std::f64::consts::FRAC_PI_4.cos();
    let s = biquadratic(&points, w, w).unwrap();
    for i in 0..=20 {
        for j in 0..=20 {
            let p = s.point([i as f64 / 20.0, j as f64 / 20.0]);
            let ring = p.x.hypot(p.y) - 3.0;
            assert!((ring.hypot(p.z) - 1.0).abs() <= 4e-15);
        }
    }
}

#[test]
fn affine_maps_exchange_and_reversal_commute_with_construction() {
    let mut random = Random(6);
    let map = DAffine3::from_mat3_translation(
        DMat3::from_cols(
            vector(&mut random),
            vector(&mut random),
            vector(&mut random),
        ),
        DVec3::new(3.0, -1.0, 2.0),
    );
    let c = table(&mut random, 1.0, DVec3::ZERO);
    let s = bilinear(c).unwrap();
    let image = bilinear(c.map(|r| r.map(|p| map.transform_point3(p)))).unwrap();
    assert_same(&image, |uv| map.transform_point3(s.point(uv)), 1e-14);
    assert_same(&s.transformed(&map), |uv| image.point(uv), 1e-14);
    let exchanged = bilinear([[c[0][0], c[1][0]], [c[0][1], c[1][1]]]).unwrap();
    assert_same(&exchanged, |[u, v]| s.point([v, u]), 1e-15);
    let reversed = bilinear([c[1], c[0]]).unwrap();
    assert_same(&reversed, |[u, v]| s.point([1.0 - u, v]), 1e-15);
}

#[test]
fn a_common_factor_of_the_weights_changes_nothing() {
    let mut random = Random(7);
    let points: Vec<_> = (0..12).map(|_| vector(&mut random)).collect();
    let weights: Vec<_> = (0..12).map(|_| 0.5 + random.unit()).collect();
    let scaled: Vec<_> = weights.iter().map(|w| w * 3e5).collect();
    let a = NurbsSurface::bezier(3, &points, Some(&weights)).unwrap();
    let b = NurbsSurface::bezier(3, &points, Some(&scaled)).unwrap();
    assert_same(&a, |uv| b.point(uv), 1e-15);
}

#[test]
fn bad_data_is_named_with_its_place() {
    let mut c = [[DVec3::ZERO, DVec3::Y], [DVec3::X, DVec3::ONE]];
    c[1][0].z = f64::NAN;
    let e = bilinear(c).unwrap_err();
    assert!(matches!(e, BilinearError::NotFinite { u: 1, v: 0, .. }));
    assert!(
        e.to_string().starts_with("corners[1][0] is [1, 0, NaN]"),
        "{e}"
    );
    let mut data = HermiteData::default();
    data.tangents_v[0][1].x = f64::INFINITY;
    assert!(matches!(
        hermite(&data).unwrap_err(),
        HermiteError::NotFinite {
            name: "tangents_v",
            u: 0,
            v: 1,
            ..
        }
    ));
    let mut nine = [[DVec3::ZERO; 3]; 3];
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            biquadratic(&nine, 1.0, value).unwrap_err(),
            BiquadraticError::Weight {
                name: "weight_v",
                ..
            }
        ));
    }
    assert!(matches!(
        biquadratic(&nine, 1e200, 1e200).unwrap_err(),
        BiquadraticError::Weight {
            value: f64::INFINITY,
            ..
        }
    ));
    nine[2][1].y = f64::NAN;
    assert!(matches!(
        biquadratic(&nine, 1.0, 1.0).unwrap_err(),
        BiquadraticError::NotFinite {
            row: 2,
            column: 1,
            ..
        }
    ));
    let far = [DVec3::ZERO, DVec3::splat(f64::MAX)];
    let good: CurveRef = Arc::new(NurbsCurve::bezier(&far[..1].repeat(2), None).unwrap());
    let huge = NurbsCurve::from_homogeneous(
        BSplineBasis::bernstein(1),
        vec![far[0].extend(1.0), (far[1] * 2.0).extend(1.0)],
    );
    assert!(matches!(
        ruled(good, Arc::new(huge), Dir::U).unwrap_err(),
        RuledError::NotFinite { rail: 1, .. }
    ));
}

/// The source's contraction: `P_i = Σ_j B_j(w) b_ij` are the points of the Bézier curve w = const.
#[test]
fn an_isoparametric_curve_of_a_bezier_surface_is_its_contracted_net() {
    let mut random = Random(12);
    let net: Vec<_> = (0..16).map(|_| vector(&mut random)).collect();
    let s = NurbsSurface::bezier(4, &net, None).unwrap();
    for w in [0.0, 0.3, 0.75, 1.0] {
        let b = [
            (1.0 - w) * (1.0 - w) * (1.0 - w),
            3.0 * (1.0 - w) * (1.0 - w) * w,
            3.0 * (1.0 - w) * w * w,
            w * w * w,
        ];
        let row = s.isocurve(Dir::U, w, Limit::Above).control_points();
        let column = s.isocurve(Dir::V, w, Limit::Above).control_points();
        for i in 0..4 {
            let along_u: DVec3 = (0..4).map(|j| net[4 * i + j] * b[j]).sum();
            let along_v: DVec3 = (0..4).map(|j| net[4 * j + i] * b[j]).sum();
            assert!(row[i].distance(along_u) <= 4e-16 * 4.0);
            assert!(column[i].distance(along_v) <= 4e-16 * 4.0);
        }
    }
}
