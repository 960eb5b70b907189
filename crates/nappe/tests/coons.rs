//! Coons surfaces: interpolation of all boundary data, the corner report, twists, joins, and the laws.

#![allow(clippy::unwrap_used)]

use nappe::basis::{Blending, ExpressionFunctions};
use nappe::curve::{Curve, CurveRef};
use nappe::exact::{NurbsCurve, NurbsSurface};
use nappe::expr::Expr;
use nappe::laws::{self, Random};
use nappe::series::Series;
use nappe::surface::{
    Coons, CoonsError, CoonsOptions, Corner, Cross, Datum, Dir, Estimate, IncompatibleTwists, Side,
    Source, Surface, SurfaceRef, bilinear, check_not_collapsed,
};
use nappe::{Box3, Break, DAffine3, DMat3, DVec3, Interval, Limit, UNIT_BREAKS};
use proptest::prelude::*;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

const ABOVE: [Limit; 2] = [Limit::Above; 2];

fn vector(random: &mut Random) -> DVec3 {
    DVec3::new(random.unit(), random.unit(), random.unit())
}

/// A Bézier surface whose net is a disturbed grid.
fn patch(seed: u64, degree: [usize; 2], scale: f64, shift: DVec3) -> NurbsSurface {
    let mut random = Random(seed);
    let [p, q] = degree;
    let points: Vec<DVec3> = (0..(p + 1) * (q + 1))
        .map(|k| {
            let grid = DVec3::new((k / (q + 1)) as f64, (k % (q + 1)) as f64, 0.0);
            shift + (grid + vector(&mut random) * 0.6) * scale
        })
        .collect();
    NurbsSurface::bezier(p + 1, &points, None).unwrap()
}

/// A side of a Bézier surface (m = 0) or the derivative across it (m = 1), as a Bézier curve.
fn boundary(s: &NurbsSurface, side: Side, m: usize) -> CurveRef {
    let [rows, columns] = s.size();
    let net = s.control_points();
    let along_u = side.along() == Dir::U;
    let (length, depth) = if along_u {
        (rows, columns)
    } else {
        (columns, rows)
    };
    let at = |k: usize, d: usize| {
        if along_u {
            net[k * columns + d]
        } else {
            net[d * columns + k]
        }
    };
    let points: Vec<DVec3> = (0..length)
        .map(|k| match (m, side.is_upper()) {
            (0, false) => at(k, 0),
            (0, true) => at(k, depth - 1),
            (_, false) => (at(k, 1) - at(k, 0)) * (depth - 1) as f64,
            (_, true) => (at(k, depth - 1) - at(k, depth - 2)) * (depth - 1) as f64,
        })
        .collect();
    Arc::new(NurbsCurve::bezier(&points, None).unwrap())
}

fn sides(s: &NurbsSurface) -> [CurveRef; 4] {
    Side::ALL.map(|side| boundary(s, side, 0))
}

fn given(s: &NurbsSurface) -> [Cross; 4] {
    Side::ALL.map(|side| Cross::Curve(boundary(s, side, 1)))
}

fn coons(sides: &[CurveRef; 4], options: &CoonsOptions) -> Result<Coons, CoonsError> {
    let [s, n, w, e] = sides.clone();
    Coons::new(s, n, w, e, options)
}

fn cubic() -> CoonsOptions {
    CoonsOptions {
        blend: Blending::cubic(),
        ..CoonsOptions::default()
    }
}

fn blendings() -> [Blending; 3] {
    [
        Blending::cubic(),
        Blending::trigonometric(1e-6).unwrap(),
        Blending::trigonometric(1.2).unwrap(),
    ]
}

fn on(side: Side, t: f64) -> [f64; 2] {
    let x = if side.is_upper() { 1.0 } else { 0.0 };
    match side.along() {
        Dir::U => [t, x],
        Dir::V => [x, t],
    }
}

/// The greatest error of the derivative of order m across a side against a curve.
fn error_on(s: &dyn Surface, side: Side, m: usize, want: &dyn Curve) -> f64 {
    (0..=50)
        .map(|k| {
            let t = k as f64 / 50.0;
            let jet = s.jet(on(side, t), ABOVE, m);
            let got = match (m, side.along()) {
                (0, _) => jet.point(),
                (_, Dir::U) => jet.partial(0, 1),
                (_, Dir::V) => jet.partial(1, 0),
            };
            got.distance(want.point(t))
        })
        .fold(0.0, f64::max)
}

fn apart(a: &dyn Surface, b: impl Fn([f64; 2]) -> DVec3) -> f64 {
    let at = |k: usize| [(k / 11) as f64 / 10.0, (k % 11) as f64 / 10.0];
    (0..121)
        .map(|k| a.point(at(k)).distance(b(at(k))))
        .fold(0.0, f64::max)
}

#[test]
fn linear_blending_keeps_the_boundary_and_is_the_formula_of_the_source() {
    let source = patch(1, [3, 4], 1.0, DVec3::ZERO);
    let [s, n, w, e] = sides(&source);
    let c = coons(&sides(&source), &CoonsOptions::default()).unwrap();
    for side in Side::ALL {
        assert!(error_on(&c, side, 0, boundary(&source, side, 0).as_ref()) <= 4e-15);
    }
    let formula = |[u, v]: [f64; 2]| {
        s.point(u) * (1.0 - v) + n.point(u) * v + w.point(v) * (1.0 - u) + e.point(v) * u
            - s.point(0.0) * (1.0 - u) * (1.0 - v)
            - n.point(0.0) * (1.0 - u) * v
            - s.point(1.0) * u * (1.0 - v)
            - n.point(1.0) * u * v
    };
    assert!(apart(&c, formula) <= 4e-15);
    assert_eq!(c.to_nurbs().unwrap().size(), [4, 5]);
    assert!(c.resolved().is_empty() && c.separable().is_some());
}

#[test]
fn straight_sides_give_the_bilinear_surface() {
    let source = patch(2, [1, 1], 1.0, DVec3::ZERO);
    let p = source.control_points();
    let b = bilinear([[p[0], p[1]], [p[2], p[3]]]).unwrap();
    let c = coons(&sides(&source), &CoonsOptions::default()).unwrap();
    assert!(apart(&c, |uv| b.point(uv)) <= 1e-15);
}

#[test]
fn all_eight_boundary_functions_are_kept() {
    let source = patch(3, [5, 4], 1.0, DVec3::ZERO);
    for blend in blendings() {
        let options = CoonsOptions {
            blend,
            cross: given(&source),
            ..CoonsOptions::default()
        };
        let c = coons(&sides(&source), &options).unwrap();
        for side in Side::ALL {
            for m in [0, 1] {
                let error = error_on(&c, side, m, boundary(&source, side, m).as_ref());
                assert!(error <= 2e-14, "{side} order {m}: {error:e}");
            }
        }
        assert!(
            apart(&c, |uv| source.point(uv)) > 1e-3,
            "degree 5 is no bicubic"
        );
    }
}

#[test]
fn cubic_blending_reproduces_bicubic_surfaces() {
    let source = patch(4, [3, 3], 1.0, DVec3::ZERO);
    let options = CoonsOptions {
        cross: given(&source),
        ..cubic()
    };
    let c = coons(&sides(&source), &options).unwrap();
    assert!(apart(&c, |uv| source.point(uv)) <= 4e-15);
    // The boundary curves and the twists alone determine it as well.
    let twist = |u: usize, v: usize| source.jet([u as f64, v as f64], ABOVE, 2).partial(1, 1);
    let options = CoonsOptions {
        twists: Some([[twist(0, 0), twist(0, 1)], [twist(1, 0), twist(1, 1)]]),
        ..cubic()
    };
    let c = coons(&sides(&source), &options).unwrap();
    assert!(apart(&c, |uv| source.point(uv)) <= 1e-14);
    assert_eq!(c.to_nurbs().unwrap().size(), [4, 4]);
}

#[test]
fn estimated_twists_are_those_of_their_definition() {
    let source = patch(5, [4, 3], 1.0, DVec3::ZERO);
    let linear = coons(&sides(&source), &CoonsOptions::default()).unwrap();
    for blend in blendings() {
        for estimate in [Estimate::Ferguson, Estimate::Adini] {
            let options = CoonsOptions {
                blend: blend.clone(),
                estimate,
                ..CoonsOptions::default()
            };
            let c = coons(&sides(&source), &options).unwrap();
            for corner in Corner::ALL {
                let uv = corner.ends().map(|x| x as f64);
                let got = c.jet(uv, ABOVE, 2).partial(1, 1);
                let want = match estimate {
                    Estimate::Ferguson => DVec3::ZERO,
                    Estimate::Adini => linear.jet(uv, ABOVE, 2).partial(1, 1),
                };
                assert!(got.distance(want) <= 1e-13, "{corner}: {got} {want}");
            }
            for side in Side::ALL {
                assert!(error_on(&c, side, 0, boundary(&source, side, 0).as_ref()) <= 4e-15);
            }
        }
    }
}

#[test]
fn one_given_cross_derivative_decides_its_corner_twists() {
    let source = patch(6, [4, 4], 1.0, DVec3::ZERO);
    for side in Side::ALL {
        let mut options = cubic();
        options.cross[side as usize] = Cross::Curve(boundary(&source, side, 1));
        let c = coons(&sides(&source), &options).unwrap();
        for m in [0, 1] {
            assert!(error_on(&c, side, m, boundary(&source, side, m).as_ref()) <= 2e-14);
        }
    }
}

/// A point turned about z: `(x cos αt, x sin αt, z)`; also the derivative of a turned profile.
#[derive(Clone, Debug)]
struct Turned {
    x: f64,
    z: f64,
    alpha: f64,
}

impl Turned {
    fn jet<S: nappe::scalar::Scalar>(&self, t: S, order: usize) -> [Series<S>; 3] {
        let alpha = S::from(self.alpha);
        let angle = Series::variable(t, order).scale(alpha);
        let (s, c) = angle.sin_cos();
        let x = S::from(self.x);
        [
            c.scale(x),
            s.scale(x),
            Series::constant(S::from(self.z), order),
        ]
    }
}

impl Curve for Turned {
    fn breaks(&self) -> &[Break] {
        &UNIT_BREAKS
    }
    fn jet_into(&self, t: f64, _: Limit, out: &mut [DVec3]) {
        let mut d = [
            vec![0.0; out.len()],
            vec![0.0; out.len()],
            vec![0.0; out.len()],
        ];
        for (s, d) in Turned::jet(self, t, out.len() - 1).iter().zip(&mut d) {
            s.write_derivatives(d);
        }
        for (k, o) in out.iter_mut().enumerate() {
            *o = DVec3::new(d[0][k], d[1][k], d[2][k]);
        }
    }
    fn enclose_piece(&self, t: Interval, _: Limit, out: &mut [Box3]) {
        let mut d = [0; 3].map(|_| vec![Interval::ENTIRE; out.len()]);
        for (s, d) in Turned::jet(self, t, out.len() - 1).iter().zip(&mut d) {
            s.write_derivatives(d);
        }
        for (k, o) in out.iter_mut().enumerate() {
            *o = Box3::from([d[0][k], d[1][k], d[2][k]]);
        }
    }
}

/// Chashnikov's theorem: the Coons surface of (7) with trigonometric blending is the surface of revolution (6).
#[test]
fn a_surface_of_revolution_is_a_coons_surface() {
    let mut random = Random(9);
    for degree in [1, 2, 4, 7] {
        for alpha in [1e-6f64, 0.3, FRAC_PI_2, 2.4, 3.0] {
            let profile: Vec<[f64; 2]> = (0..=degree)
                .map(|k| [0.5 + random.unit(), k as f64 + random.unit()])
                .collect();
            let bezier = |map: &dyn Fn([f64; 2]) -> DVec3| -> CurveRef {
                let points: Vec<_> = profile.iter().map(|&p| map(p)).collect();
                Arc::new(NurbsCurve::bezier(&points, None).unwrap())
            };
            let (s, c) = alpha.sin_cos();
            let g = [
                bezier(&|[x, z]| DVec3::new(x, 0.0, z)),
                bezier(&|[x, _]| DVec3::new(0.0, alpha * x, 0.0)),
                bezier(&|[x, _]| DVec3::new(-alpha * x * s, alpha * x * c, 0.0)),
                bezier(&|[x, z]| DVec3::new(x * c, x * s, z)),
            ];
            let p = &g[0];
            let ends = [p.jet(0.0, Limit::Above, 1).d, p.jet(1.0, Limit::Below, 1).d];
            let turned = |v: DVec3| -> CurveRef {
                let (x, z) = (v.x, v.z);
                Arc::new(Turned { x, z, alpha })
            };
            let f = [ends[0][0], ends[0][1], ends[1][1], ends[1][0]].map(turned);
            let blend = Blending::trigonometric(alpha).unwrap();
            let coons = Coons::from_boundary_functions(f, g.clone(), blend).unwrap();
            let direct = |[u, v]: [f64; 2]| {
                let q = p.point(u);
                let (s, c) = (alpha * v).sin_cos();
                DVec3::new(q.x * c, q.x * s, q.z)
            };
            let error = apart(&coons, direct);
            // Near π the blending functions grow; the data's rounding grows with them.
            let growth = (0.5 * alpha).tan() / alpha;
            assert!(
                error <= 1e-14 * (1.0 + growth),
                "{degree} {alpha}: {error:e}"
            );
        }
    }
}

fn at_places(check: impl Fn(f64, DVec3)) {
    for scale in [1e-6, 1.0, 1e6] {
        for shift in [DVec3::ZERO, DVec3::new(1e3, -2e3, 5e2) * scale] {
            check(scale, shift);
        }
    }
}

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

/// Cross-derivatives of one surface on south and north and of another, changed inside, on west and east.
fn incompatible(scale: f64, shift: DVec3, twists: IncompatibleTwists) -> Result<Coons, CoonsError> {
    let source = patch(8, [4, 4], scale, shift);
    let mut options = CoonsOptions {
        cross: given(&source),
        incompatible_twists: twists,
        ..cubic()
    };
    for side in [Side::West, Side::East] {
        options.cross[side as usize] = Cross::Curve(changed(&source, side, scale));
    }
    coons(&sides(&source), &options)
}

/// The cross-derivative with other derivatives at its ends.
fn changed(source: &NurbsSurface, side: Side, scale: f64) -> CurveRef {
    let c = boundary(source, side, 1).to_nurbs().unwrap();
    let mut points = c.control_points();
    points[1] += DVec3::new(0.3, -0.2, 0.5) * scale;
    Arc::new(NurbsCurve::bezier(&points, None).unwrap())
}

fn gregory(scale: f64, shift: DVec3) -> Coons {
    incompatible(scale, shift, IncompatibleTwists::Gregory).unwrap()
}

#[test]
fn gregory_keeps_every_cross_derivative() {
    let source = patch(8, [4, 4], 1.0, DVec3::ZERO);
    let c = gregory(1.0, DVec3::ZERO);
    assert_eq!(c.resolved().len(), 2);
    assert!(c.separable().is_none() && c.to_nurbs().is_none());
    for side in Side::ALL {
        assert!(error_on(&c, side, 0, boundary(&source, side, 0).as_ref()) <= 4e-15);
        let want = match side {
            Side::South | Side::North => boundary(&source, side, 1),
            _ => changed(&source, side, 1.0),
        };
        let error = error_on(&c, side, 1, want.as_ref());
        assert!(error <= 2e-14, "{side}: {error:e}");
    }
}

#[test]
fn gregory_enclosures_hold_towards_the_corner() {
    let c = gregory(1.0, DVec3::ZERO);
    laws::surface_with(&c, 100_000);
    for k in 2..60 {
        let w = 0.5f64.powi(k);
        let boxes = c.enclose([Interval::new(0.0, w), Interval::new(0.0, w)], 2);
        assert!(
            boxes.iter().all(|b| b.is_finite() && b.diagonal() < 1e3),
            "{w}: {boxes:?}"
        );
        for (x, y) in [(1.0, 1.0), (0.0, 1.0), (1.0, 0.0), (0.3, 0.9), (0.9, 1e-9)] {
            let jet = c.jet([x * w, y * w], ABOVE, 2);
            for (b, d) in boxes.iter().zip(&jet.d) {
                assert!(b.inflate(1e-13).contains(*d), "{w} {x} {y}: {d} {b:?}");
            }
        }
    }
}

#[test]
fn average_twists_change_cross_derivatives_by_no_more_than_stated() {
    let source = patch(8, [4, 4], 1.0, DVec3::ZERO);
    let c = incompatible(1.0, DVec3::ZERO, IncompatibleTwists::Average).unwrap();
    for side in Side::ALL {
        assert!(error_on(&c, side, 0, boundary(&source, side, 0).as_ref()) <= 4e-15);
    }
    for d in c.resolved() {
        let uv = d.corner.ends().map(|x| x as f64);
        let mean = (d.values[0] + d.values[1]) * 0.5;
        assert!(c.jet(uv, ABOVE, 2).partial(1, 1).distance(mean) <= 1e-13);
        assert!(d.to_string().contains("the twist is"), "{d}");
    }
    // max |H2| = 4/27 for cubic blending.
    let error = error_on(
        &c,
        Side::South,
        1,
        boundary(&source, Side::South, 1).as_ref(),
    );
    let most = 0.5 * c.resolved()[0].distance * 4.0 / 27.0;
    assert!(error > 0.5 * most && error <= most * 1.01, "{error} {most}");
}

#[test]
fn incompatible_twists_are_refused_by_default() {
    let e = incompatible(1.0, DVec3::ZERO, IncompatibleTwists::Error).unwrap_err();
    let CoonsError::Incompatible(report) = &e else {
        panic!("{e}")
    };
    assert_eq!(report.disagreements.len(), 2);
    assert!(report.disagreements.iter().all(|d| d.datum == Datum::Twist));
    assert!(e.to_string().contains("\"gregory\" or \"average\""), "{e}");
    assert!(e.to_string().contains("cross.south"), "{e}");
}

/// Each of the 16 conditions is broken alone, through the boundary function that states it.
#[test]
fn every_one_of_the_16_conditions_is_checked_and_named() {
    let source = patch(3, [4, 4], 1.0, DVec3::ZERO);
    let delta = DVec3::new(0.01, -0.02, 0.005);
    for side in Side::ALL {
        for m in [0, 1] {
            for (index, ends) in [(0, 0), (1, 0), (3, 1), (4, 1)] {
                let c = boundary(&source, side, m).to_nurbs().unwrap();
                let mut points = c.control_points();
                points[index] += delta;
                let broken: CurveRef = Arc::new(NurbsCurve::bezier(&points, None).unwrap());
                let (mut curves, mut cross) = (sides(&source), given(&source));
                if m == 0 {
                    curves[side as usize] = broken;
                } else {
                    cross[side as usize] = Cross::Curve(broken);
                }
                let e = coons(&curves, &CoonsOptions { cross, ..cubic() }).unwrap_err();
                let CoonsError::Incompatible(report) = e else {
                    panic!("{e}")
                };
                let along_u = side.along() == Dir::U;
                let derivative = index == 1 || index == 3;
                let datum = match (m, derivative) {
                    (0, false) => Datum::Position,
                    (0, true) if along_u => Datum::TangentU,
                    (0, true) => Datum::TangentV,
                    (_, true) => Datum::Twist,
                    (_, false) if along_u => Datum::TangentV,
                    (_, false) => Datum::TangentU,
                };
                let own = if m == 0 {
                    Source::Side(side)
                } else {
                    Source::Cross(side)
                };
                // Moving an end point changes the derivative there by degree times as much.
                let (first, by) = (&report.disagreements[0], if derivative { 4.0 } else { 1.0 });
                assert_eq!(
                    (first.datum, report.disagreements.len()),
                    (datum, if derivative { 1 } else { 2 })
                );
                for d in &report.disagreements {
                    assert!(d.sources.contains(&own));
                    let uv = d.corner.ends();
                    assert_eq!(uv[if along_u { 0 } else { 1 }], ends);
                    assert!(d.corner.sides().contains(&side));
                }
                assert!((first.distance - by * delta.length()).abs() <= 1e-13);
            }
        }
    }
}

#[test]
fn boundaries_in_the_wrong_direction_are_named() {
    let source = patch(3, [3, 3], 1.0, DVec3::ZERO);
    for side in Side::ALL {
        let mut curves = sides(&source);
        let mut points = curves[side as usize].to_nurbs().unwrap().control_points();
        points.reverse();
        curves[side as usize] = Arc::new(NurbsCurve::bezier(&points, None).unwrap());
        for options in [CoonsOptions::default(), cubic()] {
            let e = coons(&curves, &options).unwrap_err();
            let CoonsError::Incompatible(report) = &e else {
                panic!("{e}")
            };
            assert_eq!(report.reverse, [side]);
            assert_eq!(report.remaining, 0.0);
            let end = format!("reverse {side}");
            assert!(e.to_string().ends_with(&end), "{e}");
        }
    }
}

#[test]
fn tolerance_is_relative_to_the_size() {
    at_places(|scale, shift| {
        let source = patch(3, [3, 3], scale, shift);
        let mut curves = sides(&source);
        let mut points = curves[0].to_nurbs().unwrap().control_points();
        points[0].z += 1e-5 * scale;
        curves[0] = Arc::new(NurbsCurve::bezier(&points, None).unwrap());
        assert!(coons(&curves, &CoonsOptions::default()).is_err());
        let options = CoonsOptions {
            tol: 1e-5,
            ..CoonsOptions::default()
        };
        let c = coons(&curves, &options).unwrap();
        assert!(error_on(&c, Side::South, 0, curves[0].as_ref()) <= 1e-5 * scale);
    });
}

#[test]
fn derivatives_need_blending_that_keeps_them() {
    let source = patch(3, [3, 3], 1.0, DVec3::ZERO);
    let options = CoonsOptions {
        cross: given(&source),
        ..CoonsOptions::default()
    };
    let e = coons(&sides(&source), &options).unwrap_err();
    assert!(matches!(
        e,
        CoonsError::PositionsOnly {
            source_name: Source::Cross(Side::South)
        }
    ));
    let twists = CoonsOptions {
        twists: Some(Default::default()),
        ..CoonsOptions::default()
    };
    assert!(matches!(
        coons(&sides(&source), &twists).unwrap_err(),
        CoonsError::PositionsOnly {
            source_name: Source::Twists
        }
    ));
    let mut twists = [[DVec3::ZERO; 2]; 2];
    twists[1][0].y = f64::NAN;
    let options = CoonsOptions {
        twists: Some(twists),
        ..cubic()
    };
    assert!(matches!(
        coons(&sides(&source), &options).unwrap_err(),
        CoonsError::TwistNotFinite { u: 1, v: 0, .. }
    ));
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

/// For every pair of sides and both directions: a surface whose boundary leaves the common side in the tangent plane of
/// the neighbour, with lengths and directions of its own, has the neighbour's normals along it.
#[test]
fn a_surface_joins_its_neighbour_without_a_crease() {
    let neighbour = patch(11, [3, 4], 1.0, DVec3::ZERO);
    let shared: SurfaceRef = Arc::new(neighbour.clone());
    for own in Side::ALL {
        for other in Side::ALL {
            for reversed in [false, true] {
                let (curves, _) = beside(&neighbour, own, other, reversed, 0.0);
                let mut options = CoonsOptions {
                    estimate: Estimate::Adini,
                    ..cubic()
                };
                let side = other;
                let surface = shared.clone();
                options.cross[own as usize] = Cross::Neighbour { surface, side };
                let c = coons(&curves, &options).unwrap();
                let nurbs = c.to_nurbs().unwrap();
                assert!(apart(&c, |uv| nurbs.point(uv)) <= 2e-14);
                for k in 1..40 {
                    let t = k as f64 / 40.0;
                    let s = if reversed { 1.0 - t } else { t };
                    let (a, b) = (
                        c.jet(on(own, t), ABOVE, 1),
                        neighbour.jet(on(other, s), ABOVE, 1),
                    );
                    assert!(a.point().distance(b.point()) <= 4e-15);
                    let sine = a.normal().unwrap().cross(b.normal().unwrap()).length();
                    assert!(sine <= 1e-13, "{own} {other} {reversed} {t}: {sine:e}");
                    // It goes on, not back.
                    let out = |side: Side, j: &nappe::surface::SurfaceJet| {
                        let d = match side.across() {
                            Dir::U => j.partial(1, 0),
                            Dir::V => j.partial(0, 1),
                        };
                        if side.is_upper() { d } else { -d }
                    };
                    let edge = b.partial(
                        (other.along() == Dir::U) as usize,
                        (other.along() == Dir::V) as usize,
                    );
                    let flat = |d: DVec3| d - edge * (d.dot(edge) / edge.length_squared());
                    assert!(flat(out(own, &a)).dot(flat(out(other, &b))) < 0.0);
                }
            }
        }
    }
}

/// Boundary curves of a surface beside another, meeting its side `other` in the side `own`; `fold` turns the first of
/// the meeting curves back, and the second value is its corner.
fn beside(
    neighbour: &NurbsSurface,
    own: Side,
    other: Side,
    reversed: bool,
    fold: f64,
) -> ([CurveRef; 4], Corner) {
    let mut line = boundary(neighbour, other, 0)
        .to_nurbs()
        .unwrap()
        .control_points();
    if reversed {
        line.reverse();
    }
    let common: CurveRef = Arc::new(NurbsCurve::bezier(&line, None).unwrap());
    let frame = |t: f64| {
        let s = if reversed { 1.0 - t } else { t };
        let jet = neighbour.jet(on(other, s), ABOVE, 1);
        let (u, v) = (jet.partial(1, 0), jet.partial(0, 1));
        let (across, along) = if other.across() == Dir::U {
            (u, v)
        } else {
            (v, u)
        };
        (if other.is_upper() { across } else { -across }, along)
    };
    let leave = |t: f64, a: f64, b: f64| {
        let (n, l) = frame(t);
        let start = common.point(t);
        let inward = n * a + l * b;
        [
            start,
            start + inward,
            start + inward * 2.0 + DVec3::Z,
            start + inward * 3.0,
        ]
    };
    let (first, second) = (leave(0.0, 1.7 - fold, 0.3), leave(1.0, 0.6, -0.2));
    let far = [first[3], second[3]];
    let bezier = |mut p: Vec<DVec3>, turn: bool| -> CurveRef {
        if turn {
            p.reverse();
        }
        Arc::new(NurbsCurve::bezier(&p, None).unwrap())
    };
    let upper = own.is_upper();
    let first = bezier(first.to_vec(), upper);
    let second = bezier(second.to_vec(), upper);
    let opposite = bezier(far.to_vec(), false);
    let (low, high) = if upper {
        (opposite, common)
    } else {
        (common, opposite)
    };
    let curves = match own.along() {
        Dir::U => [low, high, first, second],
        Dir::V => [first, second, low, high],
    };
    let corner = match own {
        Side::South | Side::West => Corner::SouthWest,
        Side::North => Corner::NorthWest,
        Side::East => Corner::SouthEast,
    };
    (curves, corner)
}

#[test]
fn joins_that_cannot_be_are_refused() {
    let neighbour = patch(11, [3, 4], 1.0, DVec3::ZERO);
    let surface: SurfaceRef = Arc::new(neighbour.clone());
    for own in Side::ALL {
        let (curves, corner) = beside(&neighbour, own, Side::North, false, 5.0);
        let mut options = cubic();
        let side = Side::North;
        let surface = surface.clone();
        options.cross[own as usize] = Cross::Neighbour {
            surface: surface.clone(),
            side,
        };
        let e = coons(&curves, &options).unwrap_err();
        let CoonsError::NeighbourFolds { corner: at, .. } = &e else {
            panic!("{e}")
        };
        assert_eq!(*at, corner);
        let side = Side::East;
        options.cross[own as usize] = Cross::Neighbour { surface, side };
        let e = coons(&curves, &options).unwrap_err();
        assert!(matches!(e, CoonsError::NeighbourApart { .. }), "{e}");
    }
    // A boundary that leaves the tangent plane is a disagreement of tangents.
    let (mut curves, _) = beside(&neighbour, Side::South, Side::North, false, 0.0);
    let mut points = curves[2].to_nurbs().unwrap().control_points();
    points[1].z += 0.5;
    curves[2] = Arc::new(NurbsCurve::bezier(&points, None).unwrap());
    let mut options = cubic();
    options.cross[0] = Cross::Neighbour {
        surface,
        side: Side::North,
    };
    let e = coons(&curves, &options).unwrap_err();
    let CoonsError::Incompatible(report) = &e else {
        panic!("{e}")
    };
    assert_eq!(report.disagreements[0].datum, Datum::TangentV);
    assert_eq!(report.disagreements[0].corner, Corner::SouthWest);
}

#[test]
fn curves_over_other_domains_and_with_breaks_are_taken() {
    let source = patch(12, [3, 3], 1.0, DVec3::ZERO);
    let mut curves = sides(&source);
    let ends = curves[0].ends();
    let knots = vec![2.0, 2.0, 3.0, 5.0, 5.0];
    let points = [ends[0], ends[0].midpoint(ends[1]) + DVec3::Z, ends[1]];
    let bent: CurveRef = Arc::new(NurbsCurve::new(1, knots, &points, None).unwrap());
    curves[0] = bent.clone();
    for options in [CoonsOptions::default(), cubic()] {
        let c = coons(&curves, &options).unwrap();
        laws::surface(&c);
        for k in 0..=30 {
            let t = k as f64 / 30.0;
            assert!(c.point([t, 0.0]).distance(bent.point(2.0 + 3.0 * t)) <= 1e-14);
        }
    }
}

fn expressions(texts: &[&str]) -> Blending {
    let bound = |s: &&str| Expr::parse(s).unwrap().bind(&["t"], &[]).unwrap();
    let functions = ExpressionFunctions::new(texts.iter().map(bound), [0.0, 1.0]).unwrap();
    Blending::user(Arc::new(functions)).unwrap()
}

/// Blending written by a user: quintic, and one that does not sum to 1 (then the formula is taken as it stands).
#[test]
fn user_blending_keeps_all_boundary_functions() {
    let quintic = expressions(&[
        "1 - t^3*(10 - 15*t + 6*t^2)",
        "t*(1-t)^3*(1+3*t)",
        "-t^3*(1-t)*(4-3*t)",
        "t^3*(10 - 15*t + 6*t^2)",
    ]);
    let odd = expressions(&[
        "(1-t)^2*(1+2*t) + 3*(t*(1-t))^2",
        "t*(1-t)^2",
        "-t^2*(1-t)",
        "t^2*(3-2*t)",
    ]);
    assert!(quintic.is_affine() && !odd.is_affine());
    let source = patch(13, [4, 5], 1.0, DVec3::new(5.0, -3.0, 2.0));
    for (blend, twists) in [
        (quintic.clone(), IncompatibleTwists::Error),
        (odd, IncompatibleTwists::Error),
        (quintic, IncompatibleTwists::Gregory),
    ] {
        let mut options = CoonsOptions {
            blend,
            cross: given(&source),
            incompatible_twists: twists,
            ..CoonsOptions::default()
        };
        let mut want = Side::ALL.map(|side| boundary(&source, side, 1));
        if twists == IncompatibleTwists::Gregory {
            want[2] = changed(&source, Side::West, 1.0);
            options.cross[2] = Cross::Curve(want[2].clone());
        }
        let c = coons(&sides(&source), &options).unwrap();
        laws::surface(&c);
        for side in Side::ALL {
            assert!(error_on(&c, side, 0, boundary(&source, side, 0).as_ref()) <= 2e-14);
            assert!(error_on(&c, side, 1, want[side as usize].as_ref()) <= 5e-14);
        }
    }
}

#[test]
fn a_side_may_be_a_point() {
    let p = [
        DVec3::ZERO,
        DVec3::new(1.0, 0.2, 0.0),
        DVec3::new(0.3, 1.0, 0.4),
    ];
    let line = |a: DVec3, b: DVec3| -> CurveRef {
        let m = a.midpoint(b) + DVec3::Z * (a.distance(b) * 0.3);
        Arc::new(NurbsCurve::bezier(&[a, m, b], None).unwrap())
    };
    let curves = [
        line(p[0], p[1]),
        line(p[2], p[2]),
        line(p[0], p[2]),
        line(p[1], p[2]),
    ];
    for options in [CoonsOptions::default(), cubic()] {
        let c = coons(&curves, &options).unwrap();
        assert_eq!(check_not_collapsed(&c), Ok(()));
        laws::surface(&c);
        for k in 0..=20 {
            assert!(c.point([k as f64 / 20.0, 1.0]).distance(p[2]) <= 1e-15);
        }
    }
}

/// Points of a small lattice, so that corners, whole sides and tangents often coincide.
fn lattice() -> impl Strategy<Value = DVec3> {
    (-1i32..=1, -1i32..=1, 0i32..=1).prop_map(|(x, y, z)| DVec3::new(x as f64, y as f64, z as f64))
}

proptest! {
    /// Whatever the data, the answer is a surface on its boundary, or an error that says where it fails.
    #[test]
    fn degenerate_data_gives_a_surface_or_a_located_error(
        corners in prop::array::uniform4(lattice()),
        inner in prop::collection::vec(lattice(), 8),
        cross in prop::collection::vec(lattice(), 4),
        broken in 0usize..12,
        mode in 0usize..3,
        scale in prop::sample::select(vec![1e-6, 1.0, 1e6]),
    ) {
        let [a, b, c, d] = corners.map(|p| p * scale);
        let ends = [[a, b], [c, d], [a, c], [b, d]];
        let mut curves: Vec<CurveRef> = Vec::new();
        for (k, [p, q]) in ends.into_iter().enumerate() {
            let mut points = [p, inner[2 * k] * scale, inner[2 * k + 1] * scale, q];
            if broken == k {
                points.reverse();
            }
            curves.push(Arc::new(NurbsCurve::bezier(&points, None).unwrap()));
        }
        let curves: [CurveRef; 4] = curves.try_into().unwrap();
        let mut options = if mode == 0 { CoonsOptions::default() } else { cubic() };
        options.estimate = Estimate::Adini;
        options.incompatible_twists =
            [IncompatibleTwists::Error, IncompatibleTwists::Gregory, IncompatibleTwists::Average][mode];
        if mode > 0 && broken > 8 {
            let points = [cross[0] * scale, cross[1] * scale, cross[2] * scale];
            let curve: CurveRef = Arc::new(NurbsCurve::bezier(&points, None).unwrap());
            options.cross[broken - 8] = Cross::Curve(curve);
        }
        match coons(&curves, &options) {
            Ok(s) => {
                for side in Side::ALL {
                    let error = error_on(&s, side, 0, curves[side as usize].as_ref());
                    prop_assert!(error <= 1e-8 * scale, "{side}: {error:e}");
                }
                let jet = s.jet([0.3, 0.6], ABOVE, 3);
                prop_assert!(jet.d.iter().all(|d| d.is_finite()));
                let unit = s.enclose([Interval::UNIT; 2], 1);
                prop_assert!(unit.iter().all(|b| b.is_finite()));
                prop_assert!(unit[0].inflate(1e-13 * scale).contains(jet.point()));
            }
            Err(CoonsError::Incompatible(report)) => {
                prop_assert!(!report.is_compatible());
                for d in &report.disagreements {
                    prop_assert!(d.distance > d.limit && d.distance.is_finite());
                }
            }
            Err(e) => prop_assert!(false, "{e}"),
        }
    }
}
