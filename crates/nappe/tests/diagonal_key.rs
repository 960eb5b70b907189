//! Diagonal-key surfaces: interpolation of the contour, the operator's identities, closed forms, invariances, smooth
//! stitching, degenerate contours, and errors with their numbers.

#![allow(clippy::unwrap_used)]

use nappe::basis::{Combination, Coordinates, FunctionsRef};
use nappe::curve::CurveRef;
use nappe::exact::{NurbsCurve, NurbsSurface};
use nappe::laws;
use nappe::surface::{
    Contour, Corner, DiagonalKey, DiagonalKeyError, DiagonalKeyOptions, Dir, Free, Particular,
    Side, Surface,
};
use nappe::{DMat3, DVec3, Limit};
use std::sync::Arc;

const ABOVE: [Limit; 2] = [Limit::Above; 2];

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn bezier(points: &[DVec3]) -> CurveRef {
    Arc::new(NurbsCurve::bezier(points, None).unwrap())
}

fn mapped(points: &[DVec3], f: impl Fn(DVec3) -> DVec3) -> CurveRef {
    bezier(&points.iter().map(|p| f(*p)).collect::<Vec<_>>())
}

/// Control points of south, north, west, east.
type Points = [Vec<DVec3>; 4];

fn contour(p: &Points, f: impl Fn(DVec3) -> DVec3) -> Contour {
    let [s, n, w, e] = [0, 1, 2, 3].map(|i| mapped(&p[i], &f));
    Contour::new(s, n, w, e).unwrap()
}

/// South, west and north as given; east so that `d(1, v)` is the Bézier curve with the given points, whose first is 0.
fn with_difference(south: Vec<DVec3>, north: Vec<DVec3>, west: Vec<DVec3>, d: &[DVec3]) -> Points {
    assert_eq!(west.len(), d.len());
    let shift = south[south.len() - 1] - south[0];
    let east = west.iter().zip(d).map(|(w, d)| *w + shift + *d).collect();
    [south, north, west, east]
}

/// A plane-parallel contour, planes square to x, in which d(1, v) passes through zero and turns right round.
fn plane_parallel() -> Points {
    let d = [
        v(0.0, 0.0, 0.0),
        v(0.0, -3.0, 1.0),
        v(0.0, 2.0, -4.0),
        v(0.0, -1.0, 2.0),
        v(0.0, 1.0, 0.5),
    ];
    let west = vec![
        v(0.0, 0.0, 0.0),
        v(1.0, 0.5, 0.2),
        v(2.0, -0.4, 0.4),
        v(3.0, 0.3, 0.1),
        v(4.0, 0.2, 0.3),
    ];
    let south = vec![v(0.0, 0.0, 0.0), v(0.0, 1.0, 2.0), v(0.0, 3.0, 0.3)];
    let corner = west[4] + south[2] + d[4];
    let north = vec![west[4], v(4.0, 1.5, -1.0), v(4.0, 2.5, 1.5), corner];
    with_difference(south, north, west, &d)
}

/// A contour in space; d11 = (1, 0.5, 2), and d(1, v) has the given inner points.
fn spatial(d: &[DVec3]) -> Points {
    let n = d.len() - 1;
    let west: Vec<_> = (0..=n)
        .map(|i| v((i * i) as f64 * 0.1, i as f64, (i % 2) as f64))
        .collect();
    let south = vec![v(0.0, 0.0, 0.0), v(1.0, 0.0, 1.0), v(3.0, 0.2, 0.5)];
    let corner = west[n] + south[2] + d[n];
    let north = vec![
        west[n],
        west[n] + v(1.5, 0.4, -1.0),
        west[n] + v(2.0, -0.7, 2.0),
        corner,
    ];
    with_difference(south, north, west, d)
}

fn tame() -> Points {
    spatial(&[
        v(0.0, 0.0, 0.0),
        v(0.4, 1.0, 0.3),
        v(1.5, -0.5, 1.0),
        v(1.0, 0.5, 2.0),
    ])
}

/// `d(1, v) = v (v - 1/2) 2 (1, v/2, 2)`: passes through zero in the middle, where its direction turns over.
fn through_zero() -> Points {
    // v (v - 1/2) and v² (v - 1/2) in Bernstein form of degree 3.
    let (a, b) = ([0.0, -1.0 / 6.0, 0.0, 0.5], [0.0, 0.0, -1.0 / 6.0, 0.5]);
    let d: Vec<_> = (0..4).map(|i| v(2.0 * a[i], b[i], 4.0 * a[i])).collect();
    spatial(&d)
}

/// d(1, v) begins opposite to d11 and turns over in a plane, while the generators are not in it.
fn opposite() -> Points {
    let (a, n) = (v(1.0, 0.5, 2.0), v(0.0, 2.0, -0.5));
    spatial(&[DVec3::ZERO, a * -1.0, a * -0.5 + n * 2.0, a])
}

fn free_plane(p: &[f64], q: &[f64]) -> DiagonalKeyOptions {
    DiagonalKeyOptions {
        free: Free::Plane {
            p: Arc::new(Combination::bump(p)),
            q: Arc::new(Combination::bump(q)),
        },
        ..Default::default()
    }
}

fn free_space() -> Free {
    let g = |s: f64| -> FunctionsRef {
        let points = [DVec3::ZERO, v(s, 0.3, -s), v(0.5, s, 0.2), DVec3::ZERO];
        Arc::new(Coordinates::new(bezier(&points), DVec3::ZERO))
    };
    Free::Space {
        g: [g(0.4), g(-0.7)],
        normals: None,
    }
}

/// r(u,0), r(u,1), r(0,v), r(1,v) are the curves; L(0) = 0, L(1) = I, L[d11] = d(1, v); smooth in between.
fn interpolates(s: &DiagonalKey, size: f64) {
    let c = s.contour();
    for k in 0..=64 {
        let t = k as f64 / 64.0;
        for side in Side::ALL {
            let at = if side.is_upper() { 1.0 } else { 0.0 };
            let uv = if side.along() == Dir::U {
                [t, at]
            } else {
                [at, t]
            };
            let (got, want) = (s.point(uv), c.side(side).point(t));
            assert!(
                (got - want).length() <= 1e-13 * size,
                "{side} at {t}: {got} {want}"
            );
        }
    }
    let error = |m: DMat3, want: DMat3| {
        (m - want)
            .to_cols_array()
            .iter()
            .fold(0.0, |a: f64, x| a.max(x.abs()))
    };
    assert!(error(s.operator(0.0), DMat3::ZERO) <= 1e-14);
    assert!(error(s.operator(1.0), DMat3::IDENTITY) <= 1e-13);
}

const SCALES: [f64; 3] = [1e-6, 1.0, 1e6];

#[test]
fn every_case_keeps_its_sides_and_obeys_the_laws_at_all_scales() {
    let cases = [
        (plane_parallel(), free_plane(&[0.5, -1.0], &[2.0])),
        (plane_parallel(), DiagonalKeyOptions::default()),
        (tame(), DiagonalKeyOptions::default()),
        (through_zero(), DiagonalKeyOptions::default()),
        (opposite(), DiagonalKeyOptions::default()),
        (
            tame(),
            DiagonalKeyOptions {
                free: free_space(),
                exchange: true,
                ..Default::default()
            },
        ),
    ];
    let want = ["Plane", "Plane", "Space", "Space", "SpaceDetour", "Space"];
    for ((points, options), want) in cases.iter().zip(want) {
        for scale in SCALES {
            for shift in [DVec3::ZERO, v(1e3, -2e3, 5e2) * scale] {
                let c = contour(points, |p| p * scale + shift);
                let s = DiagonalKey::new(c, options).unwrap();
                let kind = format!("{:?}", s.particular());
                assert_eq!(kind.split(' ').next().unwrap(), want);
                assert_eq!(s.to_nurbs().is_some(), want == "Plane");
                interpolates(&s, 5.0 * scale + shift.length());
                let whole = s.enclose(s.domain(), 2);
                assert!(
                    whole.iter().all(|b| b.is_finite()),
                    "{want} is bounded with its derivatives"
                );
                laws::surface(&s);
            }
        }
    }
}

#[test]
fn a_hundred_thousand_boxes_contain_their_samples() {
    for points in [plane_parallel(), tame(), opposite()] {
        let s = DiagonalKey::new(contour(&points, |p| p), &Default::default()).unwrap();
        laws::surface_with(&s, 100_000 / 3);
    }
}

#[test]
fn the_plane_case_is_multiplication_of_complex_numbers() {
    let points = plane_parallel();
    let s = DiagonalKey::new(contour(&points, |p| p), &free_plane(&[1.0], &[-0.5, 0.25])).unwrap();
    let c = s.contour();
    let phi = s.d11().z.atan2(s.d11().y);
    for (u, w) in [(0.3, 0.2), (0.9, 0.5), (0.5, 0.77)] {
        let du =
            c.north().point(u) - c.north().point(0.0) - c.south().point(u) + c.south().point(0.0);
        let dv = c.east().point(w) - c.east().point(0.0) - c.west().point(w) + c.west().point(0.0);
        // |d|/|d11| times the rotation by the signed angle, and Lo as printed in (14).
        let angle = dv.z.atan2(dv.y) - phi;
        let (sin, cos) = angle.sin_cos();
        let k = dv.length() / s.d11().length();
        let p = 2.0 * w * (1.0 - w);
        let q = -0.5 * 3.0 * w * (1.0 - w).powi(2) + 0.25 * 3.0 * w * w * (1.0 - w);
        let y = k * (cos * du.y - sin * du.z) + p * (-phi.sin() * du.y + phi.cos() * du.z);
        let z = k * (sin * du.y + cos * du.z) + q * (-phi.sin() * du.y + phi.cos() * du.z);
        let want = c.west().point(w) - c.west().point(0.0) + c.south().point(u) + v(0.0, y, z);
        assert!((s.point([u, w]) - want).length() < 1e-13 * 5.0);
    }
}

#[test]
fn rotated_axes_rotate_p_and_q_and_leave_the_surface() {
    let points = plane_parallel();
    let (p, q) = ([0.7, -1.0], [0.2, 2.0]);
    let s = DiagonalKey::new(contour(&points, |p| p), &free_plane(&p, &q)).unwrap();
    let alpha = 0.6f64;
    let (sin, cos) = alpha.sin_cos();
    // Axes turned by alpha: the same vector g has the components of (p, q) turned back.
    let turned = |a: [f64; 2], b: [f64; 2], s: f64| {
        [a[0] * cos + s * b[0] * sin, a[1] * cos + s * b[1] * sin]
    };
    let mut options = free_plane(&turned(p, q, 1.0), &turned(q, p, -1.0));
    options.plane_axes = Some([v(0.0, cos, sin), v(0.0, -sin, cos)]);
    let same = DiagonalKey::new(contour(&points, |p| p), &options).unwrap();
    // The contour turned about x, with (p, q) turned, is the surface turned.
    let r = DMat3::from_rotation_x(alpha);
    let options = free_plane(&turned(p, q, -1.0), &turned(q, p, 1.0));
    let moved = DiagonalKey::new(contour(&points, |p| r * p), &options).unwrap();
    for i in 0..=10 {
        for j in 0..=10 {
            let uv = [i as f64 / 10.0, j as f64 / 10.0];
            let at = s.point(uv);
            assert!((same.point(uv) - at).length() < 1e-13 * 5.0);
            assert!((moved.point(uv) - r * at).length() < 1e-13 * 5.0);
        }
    }
}

#[test]
fn similarities_move_every_case_with_its_contour() {
    let r = DMat3::from_axis_angle(v(0.6, 0.0, 0.8), 1.1) * 2.5;
    for points in [plane_parallel(), tame(), through_zero(), opposite()] {
        let s = DiagonalKey::new(contour(&points, |p| p), &Default::default()).unwrap();
        let t = DiagonalKey::new(
            contour(&points, |p| r * p + v(1.0, 2.0, 3.0)),
            &Default::default(),
        )
        .unwrap();
        for i in 0..=12 {
            for j in 0..=12 {
                let uv = [i as f64 / 12.0, j as f64 / 12.0];
                let want = r * s.point(uv) + v(1.0, 2.0, 3.0);
                assert!((t.point(uv) - want).length() < 1e-12, "{uv:?}");
            }
        }
    }
}

#[test]
fn in_space_the_operator_is_a_scaled_rotation_that_follows_the_difference() {
    for points in [tame(), through_zero(), opposite()] {
        let s = DiagonalKey::new(contour(&points, |p| p), &Default::default()).unwrap();
        let c = s.contour();
        let mut before = s.operator(0.0);
        for k in 0..=400 {
            let w = k as f64 / 400.0;
            let l = s.operator(w);
            let d =
                c.east().point(w) - c.east().point(0.0) - c.west().point(w) + c.west().point(0.0);
            assert!((l * s.d11() - d).length() < 1e-13 * 5.0, "L[d11] at {w}");
            let k2 = d.length_squared() / s.d11().length_squared();
            let square = l.transpose() * l - DMat3::IDENTITY * k2;
            assert!(
                square
                    .to_cols_array()
                    .iter()
                    .all(|x| x.abs() < 1e-13 * k2.max(1.0))
            );
            let step = (l - before)
                .to_cols_array()
                .iter()
                .fold(0.0, |a: f64, x| a.max(x.abs()));
            assert!(step < 0.1, "no jump at {w}: {step}");
            before = l;
        }
    }
}

#[test]
fn a_zero_of_the_difference_is_passed_smoothly() {
    let s = DiagonalKey::new(contour(&through_zero(), |p| p), &Default::default()).unwrap();
    assert!(s.breaks(Dir::V).iter().any(|b| (b.at - 0.5).abs() < 1e-12));
    assert!(
        s.operator(0.5)
            .to_cols_array()
            .iter()
            .all(|x| x.abs() < 1e-15)
    );
    for u in [0.2, 0.6, 1.0] {
        let [a, b] = [Limit::Below, Limit::Above].map(|l| s.jet([u, 0.5], [Limit::Above, l], 4));
        for (x, y) in a.d.iter().zip(&b.d) {
            assert!((*x - *y).length() < 1e-9 * (1.0 + x.length()), "{x} {y}");
        }
        // And derivatives near the zero agree with those at it, to first order.
        let (near, at) = (s.jet([u, 0.5 + 1e-7], ABOVE, 3), b);
        for (k, x) in near.d.iter().enumerate() {
            assert!((*x - at.d[k]).length() < 1e-4, "{k}: {x} {}", at.d[k]);
        }
    }
}

/// Translates: the surface of translation for the default blend, any b otherwise.
#[test]
fn guides_that_are_translates_need_no_direction() {
    let west = vec![v(0.0, 0.0, 0.0), v(0.0, 1.0, 1.0), v(0.0, 3.0, 0.0)];
    let south = vec![v(0.0, 0.0, 0.0), v(1.0, 0.0, 1.0), v(2.0, 0.0, 0.0)];
    let north = vec![
        v(0.0, 3.0, 0.0),
        v(1.0, 3.0, -1.0),
        v(1.5, 3.0, 0.0),
        v(2.0, 3.0, 0.0),
    ];
    let points = with_difference(south, north, west, &[DVec3::ZERO; 3]);
    for scale in SCALES {
        let c = contour(&points, |p| p * scale + v(1.0, 2.0, 3.0) * scale);
        let s = DiagonalKey::new(c, &Default::default()).unwrap();
        assert_eq!(s.particular(), Particular::Translation);
        interpolates(&s, 5.0 * scale);
        laws::surface(&s);
        assert!(s.to_nurbs().is_some());
    }
    let square: FunctionsRef = Arc::new(Combination::new(
        Arc::new(nappe::basis::BSplineBasis::bernstein(2)),
        &[&[0.0, 0.0, 1.0]],
    ));
    let options = DiagonalKeyOptions {
        blend: Some(square),
        ..Default::default()
    };
    let s = DiagonalKey::new(contour(&points, |p| p), &options).unwrap();
    interpolates(&s, 5.0);
    assert!(
        (s.operator(0.3) - DMat3::IDENTITY * 0.09)
            .to_cols_array()
            .iter()
            .all(|x| x.abs() < 1e-15)
    );
}

/// A patch whose east side is the contour's west, and the derivative across it.
fn neighbour(random: &mut laws::Random) -> (NurbsSurface, CurveRef, Vec<DVec3>, Vec<DVec3>) {
    let net: Vec<Vec<DVec3>> = (0..4)
        .map(|i| {
            (0..4)
                .map(|j| v(i as f64 - 3.0, j as f64, 0.6 * random.unit()))
                .collect()
        })
        .collect();
    let flat: Vec<DVec3> = net.iter().flatten().copied().collect();
    let patch = NurbsSurface::bezier(4, &flat, None).unwrap();
    let tangent: Vec<DVec3> = (0..4).map(|j| (net[3][j] - net[2][j]) * 3.0).collect();
    (patch, bezier(&tangent), net[3].clone(), tangent)
}

#[test]
fn stitching_takes_over_the_neighbours_tangents() {
    let mut random = laws::Random(1);
    let (patch, t0, west, tangent) = neighbour(&mut random);
    let last = tangent[3];
    // Generators start with the neighbour's tangents (degree 3: the second point is a third of it away).
    let south = vec![
        west[0],
        west[0] + tangent[0] / 3.0,
        v(2.0, 0.3, 0.5),
        v(3.0, 0.0, 0.0),
    ];
    let north = vec![
        west[3],
        west[3] + last / 3.0,
        v(2.5, 3.5, 1.0),
        v(3.0, 4.0, 1.0),
    ];
    let east = vec![south[3], v(3.5, 1.0, 0.7), v(3.2, 2.0, -0.4), north[3]];
    let t1 = {
        let (a, b) = ((south[3] - south[2]) * 3.0, (north[3] - north[2]) * 3.0);
        bezier(&[a, a + v(0.3, 0.0, 0.4), b + v(0.0, 0.2, 0.1), b])
    };
    let points: Points = [south, north, west, east];
    for (one, two) in [(true, false), (false, true), (true, true)] {
        let options = DiagonalKeyOptions {
            tangents: [one.then(|| t0.clone()), two.then(|| t1.clone())],
            ..Default::default()
        };
        let s = DiagonalKey::new(contour(&points, |p| p), &options).unwrap();
        assert_eq!(s.particular() == Particular::Stitched, one && two);
        assert_eq!(s.to_nurbs().is_some(), one && two);
        interpolates(&s, 5.0);
        laws::surface(&s);
        for k in 0..=32 {
            let w = k as f64 / 32.0;
            if one {
                let jet = s.jet([0.0, w], ABOVE, 1);
                assert!(
                    (jet.partial(1, 0) - t0.point(w)).length() < 1e-12,
                    "west at {w}"
                );
                let n = patch.jet([1.0, w], ABOVE, 1).normal().unwrap();
                assert!(jet.normal().unwrap().dot(n) > 1.0 - 1e-12, "G1 at {w}");
            }
            if two {
                let jet = s.jet([1.0, w], ABOVE, 1);
                assert!(
                    (jet.partial(1, 0) - t1.point(w)).length() < 1e-12,
                    "east at {w}"
                );
            }
        }
    }
    // The same with u and v exchanged.
    let c = contour(&points, |p| p).exchanged();
    let options = DiagonalKeyOptions {
        exchange: true,
        tangents: [Some(t0.clone()), None],
        ..Default::default()
    };
    let s = DiagonalKey::new(c, &options).unwrap();
    assert!((s.jet([0.4, 0.0], ABOVE, 1).partial(0, 1) - t0.point(0.4)).length() < 1e-12);
}

#[test]
fn exchange_is_the_surface_of_the_exchanged_contour() {
    let points = tame();
    let a = DiagonalKey::new(
        contour(&points, |p| p),
        &DiagonalKeyOptions {
            exchange: true,
            ..Default::default()
        },
    )
    .unwrap();
    let b = DiagonalKey::new(contour(&points, |p| p).exchanged(), &Default::default()).unwrap();
    for (u, w) in [(0.1, 0.9), (0.5, 0.4), (0.8, 0.3)] {
        assert_eq!(a.point([u, w]), b.point([w, u]));
    }
    interpolates(&a, 5.0);
}

#[test]
fn free_functions_in_space_act_square_to_d11() {
    let plain = DiagonalKey::new(contour(&tame(), |p| p), &Default::default()).unwrap();
    let normals = [v(2.0, 0.0, -1.0), v(0.5, -1.0, 0.0)];
    let options = DiagonalKeyOptions {
        free: match free_space() {
            Free::Space { g, .. } => Free::Space {
                g,
                normals: Some(normals),
            },
            other => other,
        },
        ..Default::default()
    };
    let s = DiagonalKey::new(contour(&tame(), |p| p), &options).unwrap();
    interpolates(&s, 5.0);
    let Free::Space { g, .. } = options.free else {
        unreachable!()
    };
    let n1 = normals[0].normalize();
    let w = 0.37;
    let mut g1 = [0.0; 3];
    g[0].jet_into(w, Limit::Above, 0, &mut g1);
    let lo = s.operator(w) - plain.operator(w);
    assert!((lo * n1 - DVec3::from_array(g1)).length() < 1e-14);
    assert!((lo * s.d11()).length() < 1e-13);
}

fn refused(points: &Points, options: &DiagonalKeyOptions) -> DiagonalKeyError {
    match DiagonalKey::new(contour(points, |p| p), options) {
        Err(e) => e,
        Ok(s) => panic!("accepted as {:?}", s.particular()),
    }
}

#[test]
fn errors_name_what_is_wrong_and_by_how_much() {
    let none = DiagonalKeyOptions::default();
    // A parallelogram of corners whose guides are no translates.
    let mut points = tame();
    points = with_difference(
        points[0].clone(),
        vec![
            points[2][3],
            points[2][3] + v(1.0, 1.0, 1.0),
            points[2][3] + v(3.0, 0.2, 0.5),
        ],
        points[2].clone(),
        &[DVec3::ZERO, v(0.0, 0.0, 1.0), v(0.0, 1.0, 0.0), DVec3::ZERO],
    );
    let e = refused(&points, &none);
    assert!(
        matches!(&e, DiagonalKeyError::Parallelogram { d, .. } if d.length() > 0.3),
        "{e}"
    );
    assert!(e.to_string().contains("Coons"), "{e}");

    // p does not vanish at an end.
    let one: FunctionsRef = Arc::new(nappe::basis::One);
    let zero: FunctionsRef = Arc::new(Combination::bump(&[0.0]));
    let options = DiagonalKeyOptions {
        free: Free::Plane { p: one, q: zero },
        ..Default::default()
    };
    assert!(matches!(
        refused(&plane_parallel(), &options),
        DiagonalKeyError::FunctionEnd {
            name: "p",
            t: 0.0,
            value: 1.0,
            ..
        }
    ));
    // p and q in space.
    let e = refused(&tame(), &free_plane(&[1.0], &[1.0]));
    assert!(
        matches!(e, DiagonalKeyError::NotPlane { deviation, .. } if deviation > 0.1),
        "{e}"
    );
    // p and q in an oblique plane without axes.
    let r = DMat3::from_rotation_y(0.5);
    let oblique = plane_parallel().map(|c| c.into_iter().map(|p| r * p).collect());
    let e = refused(&oblique, &free_plane(&[1.0], &[1.0]));
    let DiagonalKeyError::AxesNeeded { normal } = e else {
        panic!("{e}")
    };
    assert!(normal.cross(r * DVec3::X).length() < 1e-12);
    // Axes that span no plane; normals that are not square to d11.
    let options = DiagonalKeyOptions {
        plane_axes: Some([DVec3::Y, DVec3::Y]),
        ..Default::default()
    };
    assert!(matches!(
        refused(&plane_parallel(), &options),
        DiagonalKeyError::Axes { .. }
    ));
    let Free::Space { g, .. } = free_space() else {
        unreachable!()
    };
    let options = DiagonalKeyOptions {
        free: Free::Space {
            g,
            normals: Some([DVec3::X, DVec3::Y]),
        },
        ..Default::default()
    };
    assert!(matches!(
        refused(&tame(), &options),
        DiagonalKeyError::Normals { .. }
    ));
    // A tangent that misses the generator's in a corner.
    let t = bezier(&[(tame()[0][1] - tame()[0][0]) * 2.0, v(1.0, 0.0, 0.0)]);
    let options = DiagonalKeyOptions {
        tangents: [Some(t.clone()), None],
        ..Default::default()
    };
    let e = refused(&tame(), &options);
    assert!(
        matches!(
            e,
            DiagonalKeyError::Tangent {
                side: Side::West,
                corner: Corner::NorthWest,
                ..
            }
        ),
        "{e}"
    );
    // Free functions and tangents together; guides that differ by a translation on a part.
    let options = DiagonalKeyOptions {
        tangents: [
            Some(bezier(&[
                (tame()[0][1] - tame()[0][0]) * 2.0,
                (tame()[1][1] - tame()[1][0]) * 3.0,
            ])),
            None,
        ],
        free: free_space(),
        ..Default::default()
    };
    assert!(matches!(
        refused(&tame(), &options),
        DiagonalKeyError::FreeAndTangents
    ));
}

#[test]
fn guides_that_part_late_have_no_direction_before() {
    let p = tame();
    let knots = vec![0.0, 0.0, 0.5, 1.0, 1.0];
    let shift = p[0][2] - p[0][0];
    let west = [p[2][0], v(0.0, 1.0, 0.0), p[2][3]];
    let east = [west[0] + shift, west[1] + shift, p[3][3]];
    let poly =
        |q: &[DVec3]| -> CurveRef { Arc::new(NurbsCurve::new(1, knots.clone(), q, None).unwrap()) };
    let c = Contour::new(bezier(&p[0]), bezier(&p[1]), poly(&west), poly(&east)).unwrap();
    let Err(e) = DiagonalKey::new(c, &Default::default()) else {
        panic!("accepted")
    };
    assert!(
        matches!(e, DiagonalKeyError::NoDirection { v } if v.hi == 0.5),
        "{e}"
    );
    assert!(e.to_string().contains("0.5"));
}

#[test]
fn singular_stitching_is_refused_with_its_condition() {
    // Both end tangents of the generators change by the same vector.
    let p = tame();
    let west = p[2].clone();
    let south = vec![
        west[0],
        v(1.0, 0.0, 0.0),
        v(2.0, 0.0, 0.0),
        v(3.0, 0.0, 0.0),
    ];
    let north = vec![
        west[3],
        west[3] + v(1.0, 1.0, 0.0),
        west[3] + v(2.0, 0.0, 0.5),
        west[3] + v(3.0, 1.0, 0.5),
    ];
    let east = vec![south[3], v(3.0, 1.0, 0.4), v(3.0, 2.0, 0.0), north[3]];
    let t = |i: usize| {
        bezier(&[
            (south[i + 1] - south[i]) * 3.0,
            (north[i + 1] - north[i]) * 3.0,
        ])
    };
    let options = DiagonalKeyOptions {
        tangents: [Some(t(0)), Some(t(2))],
        ..Default::default()
    };
    let points = [south.clone(), north.clone(), west, east];
    let e = refused(&points, &options);
    assert!(
        matches!(e, DiagonalKeyError::Singular { condition, .. } if condition > 1e6),
        "{e}"
    );
}

/// Helical guides about a common axis, half a turn: d(1, v) turns against d11.
#[test]
fn helical_guides_turn_the_generators() {
    let n = 12;
    let helix = |radius: f64, phase: f64, rise: f64| -> Vec<DVec3> {
        (0..=n)
            .map(|i| {
                let a = std::f64::consts::PI * i as f64 / n as f64 + phase;
                v(
                    radius * a.cos(),
                    radius * a.sin(),
                    rise * i as f64 / n as f64,
                )
            })
            .collect()
    };
    let (west, east) = (helix(1.0, 0.0, 2.0), helix(2.0, 0.3, 3.0));
    let south = vec![west[0], v(1.5, 0.0, 0.3), east[0]];
    let north = vec![west[n], v(-1.5, 0.3, 2.2), east[n]];
    let s = DiagonalKey::new(
        contour(&[south, north, west, east], |p| p),
        &Default::default(),
    )
    .unwrap();
    interpolates(&s, 5.0);
    laws::surface(&s);
}
