//! Curves on surfaces: sections, silhouettes, isophotes and lines of equal curvature, against closed forms.

#![allow(clippy::unwrap_used)]

use nappe::exact::NurbsSurface;
use nappe::expr::Expr;
use nappe::measure::CurvatureKind;
use nappe::query::{
    Branch, ExpressionField, Figure, FigureError, SurfaceField, Trace, TraceError, TraceOptions,
    trace,
};
use nappe::surface::{
    Quadric, QuadricOptions, QuadricShape, SurfaceRef, Torus, TorusOptions, Transformed, bilinear,
};
use nappe::{Certainty, CurveRef, DAffine3, DVec3, Interval, Limit};
use std::f64::consts::{FRAC_PI_3, PI, TAU};
use std::sync::Arc;

fn torus() -> SurfaceRef {
    Arc::new(Torus::new(3.0, 1.0, TorusOptions::default()).unwrap())
}

fn sphere(radius: f64) -> SurfaceRef {
    let options = QuadricOptions::default();
    Arc::new(Quadric::new(QuadricShape::Sphere, &[radius], options).unwrap())
}

fn traced(surface: &SurfaceRef, figure: Figure) -> Trace {
    traced_to(surface, figure, None)
}

fn traced_to(surface: &SurfaceRef, figure: Figure, tol: Option<f64>) -> Trace {
    let field = SurfaceField::new(surface.clone(), figure).unwrap();
    let options = TraceOptions {
        surface: Some(surface.clone()),
        tol,
        ..Default::default()
    };
    trace(&field, &options).unwrap()
}

/// The curves in space that are not a point, with their proven errors.
fn curves(t: &Trace) -> Vec<(CurveRef, f64)> {
    let error = |b: &Branch| match b.certainty {
        Certainty::Bounded(e) => e,
        other => panic!("{other:?}"),
    };
    t.branches.iter().map(|b| (b.curve(), error(b))).collect()
}

fn length(c: &CurveRef) -> f64 {
    let n = 4000;
    let p: Vec<_> = (0..=n)
        .map(|k| c.point(f64::from(k) / f64::from(n)))
        .collect();
    p.windows(2).map(|w| w[0].distance(w[1])).sum()
}

/// The length of all curves; what is drawn twice, as along a seam, counts once.
fn total(t: &Trace) -> f64 {
    let curves = curves(t);
    let places = |c: &CurveRef, n: i32| -> Vec<DVec3> {
        (0..=n)
            .map(|k| c.point(f64::from(k) / f64::from(n)))
            .collect()
    };
    let repeated = |k: usize| {
        let near = 0.002 * length(&curves[k].0);
        curves[..k].iter().any(|(other, _)| {
            let all = places(other, 2000);
            places(&curves[k].0, 20)
                .iter()
                .all(|p| all.iter().any(|q| p.distance(*q) < near))
        })
    };
    (0..curves.len())
        .filter(|&k| !repeated(k))
        .map(|k| length(&curves[k].0))
        .sum()
}

/// How many closed curves the branches make in space, joined where their ends meet: seams cut them.
fn loops(t: &Trace, tol: f64) -> usize {
    let curves = curves(t);
    let ends: Vec<[DVec3; 2]> = curves.iter().map(|c| c.0.ends()).collect();
    let mut group: Vec<usize> = (0..ends.len()).collect();
    for i in 0..ends.len() {
        for j in 0..i {
            let meet = ends[i]
                .iter()
                .any(|a| ends[j].iter().any(|b| a.distance(*b) < tol));
            if meet {
                let (from, to) = (group[i], group[j]);
                group
                    .iter_mut()
                    .filter(|g| **g == from)
                    .for_each(|g| *g = to);
            }
        }
    }
    let all: Vec<DVec3> = ends.iter().flatten().copied().collect();
    for p in &all {
        assert!(
            all.iter().filter(|q| p.distance(**q) < tol).count() % 2 == 0,
            "a loose end at {p}"
        );
    }
    group.sort_unstable();
    group.dedup();
    group.len()
}

/// All points of all branches fulfil an equation within the proven error.
fn hold(t: &Trace, what: &str, off: impl Fn(DVec3) -> f64) {
    for (c, e) in curves(t) {
        for k in 0..=300 {
            let p = c.point(f64::from(k) / 300.0);
            assert!(
                off(p).abs() <= e + 1e-12 * p.length().max(1.0),
                "{what}: {} at {p}, proven {e}",
                off(p)
            );
        }
    }
}

#[test]
fn plane_sections_of_a_torus() {
    let torus = torus();
    for (a, n) in [
        (0.0, 2),
        (1.3, 2),
        (1.999, 2),
        (2.001, 1),
        (3.1, 1),
        (3.999, 1),
        (4.001, 0),
    ] {
        let t = traced(
            &torus,
            Figure::Section {
                point: DVec3::new(a, 5.0, -7.0),
                normal: DVec3::X,
            },
        );
        assert!(t.undecided.is_empty(), "{a}: {:?}", t.undecided);
        assert_eq!(loops(&t, 1e-4), n, "{a}");
        hold(&t, "plane", |p| p.x - a);
    }
    // The figure eight: one place with four ends.
    let t = traced(
        &torus,
        Figure::Section {
            point: DVec3::new(2.0, 0.0, 0.0),
            normal: DVec3::X,
        },
    );
    // (It lies on the seam, so on both ends of u.)
    assert_eq!(
        t.undecided.iter().map(|u| u.ends).collect::<Vec<_>>(),
        [2, 2]
    );
    // Two circles across the axis.
    let t = traced(
        &torus,
        Figure::Section {
            point: DVec3::ZERO,
            normal: DVec3::Z,
        },
    );
    assert!(t.undecided.is_empty());
    hold(&t, "plane", |p| p.z);
    assert!((total(&t) - TAU * 6.0).abs() < 1e-3);
}

#[test]
fn villarceau_circles() {
    // The plane that touches the torus R = 3, r = 1 twice, through its centre: two circles of radius R.
    let tilt = (1.0f64 / 3.0).asin();
    let normal = DVec3::new(-tilt.sin(), 0.0, tilt.cos());
    let t = traced(
        &torus(),
        Figure::Section {
            point: DVec3::ZERO,
            normal,
        },
    );
    let nodes: Vec<_> = t.undecided.iter().filter(|u| u.ends > 0).collect();
    assert!(
        nodes.iter().map(|u| u.ends).sum::<usize>() == 8,
        "{:?}",
        t.undecided
    );
    assert!((total(&t) - 2.0 * TAU * 3.0).abs() < 1e-3, "{}", total(&t));
    // Centres at (0, ±r, 0).
    hold(&t, "circle", |p| {
        let off = |y: f64| (p - DVec3::new(0.0, y, 0.0)).length() - 3.0;
        off(1.0).abs().min(off(-1.0).abs())
    });
}

#[test]
fn silhouettes_of_a_sphere_are_great_circles() {
    let sphere = sphere(2.0);
    for d in [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        DVec3::new(1.0, 2.0, -0.5),
        DVec3::new(1.0, 1.0, 0.0),
    ] {
        let t = traced_to(&sphere, Figure::Silhouette { direction: d }, Some(1e-4));
        // Through the poles, where the whole side of parameters is on the curve, it is not decided how.
        for u in &t.undecided {
            let v = u.hull[1];
            let at_pole = v.lo == 0.0 || v.hi == 1.0;
            assert!(
                d.z == 0.0 && at_pole && v.width() < 0.02,
                "{d}: {:?}",
                u.hull
            );
        }
        hold(&t, "silhouette", |p| p.dot(d.normalize()));
        let missing: f64 = t
            .undecided
            .iter()
            .map(|u| 2.0 * 2.0 * PI * u.hull[1].width())
            .sum();
        let (l, whole) = (total(&t), TAU * 2.0);
        assert!(l < whole + 1e-3 && l > whole - missing - 1e-3, "{d}: {l}");
    }
    // From a point: a small circle, of half angle acos(r / distance).
    let eye = DVec3::new(0.0, 3.0, 4.0);
    let t = traced(&sphere, Figure::SilhouetteFrom { eye });
    hold(&t, "seen from a point", |p| p.dot(eye / 5.0) - 4.0 / 5.0);
    assert!((total(&t) - TAU * 2.0 * (1.0f64 - 0.16).sqrt()).abs() < 1e-4);
    // From the inside there is none.
    assert!(
        traced(&sphere, Figure::SilhouetteFrom { eye: DVec3::X })
            .branches
            .is_empty()
    );
}

#[test]
fn isophotes_of_a_sphere_are_circles() {
    let sphere = sphere(2.0);
    let inwards = sphere.jet([0.5, 0.5], [Limit::Above; 2], 1);
    let sign = inwards.normal().unwrap().dot(inwards.point()).signum();
    for d in [DVec3::Z, DVec3::new(1.0, -2.0, 0.3).normalize()] {
        let t = traced_to(
            &sphere,
            Figure::Isophote {
                direction: d,
                angle: FRAC_PI_3,
            },
            Some(1e-5),
        );
        assert!(t.undecided.is_empty(), "{:?}", t.undecided);
        hold(&t, "isophote", |p| sign * p.dot(d) - 1.0);
        assert!(
            (total(&t) - TAU * 3f64.sqrt()).abs() < 1e-4,
            "{}",
            total(&t)
        );
    }
}

#[test]
fn silhouettes_of_a_torus() {
    let t = traced(
        &torus(),
        Figure::Silhouette {
            direction: DVec3::Z,
        },
    );
    assert!(t.undecided.is_empty());
    hold(&t, "equator", |p| p.z);
    assert!((total(&t) - TAU * 6.0).abs() < 1e-3);
    // From the side: the outer contour and the rim of the hole, which meets itself nowhere.
    let d = DVec3::new(1.0, 0.0, 0.2).normalize();
    let t = traced(&torus(), Figure::Silhouette { direction: d });
    assert!(t.undecided.is_empty());
    assert_eq!(loops(&t, 1e-4), 2);
    // The normal points from the circle of centres to the point.
    hold(&t, "silhouette", |p| {
        let centre = DVec3::new(p.x, p.y, 0.0).normalize() * 3.0;
        (p - centre).dot(d)
    });
}

#[test]
fn lines_of_equal_curvature_of_a_torus() {
    // K = cos φ / (r (R + r cos φ)): zero on top and at the bottom.
    let torus = torus();
    let gaussian = |value| {
        traced_to(
            &torus,
            Figure::Curvature {
                kind: CurvatureKind::Gaussian,
                value,
            },
            Some(1e-4),
        )
    };
    let t = gaussian(0.0);
    assert!(t.undecided.is_empty(), "{:?}", t.undecided);
    hold(&t, "K = 0", |p| p.z.abs() - 1.0);
    assert!((total(&t) - 2.0 * TAU * 3.0).abs() < 1e-3);
    let t = gaussian(0.5 / 3.5);
    hold(&t, "K at 60°", |p| {
        DVec3::new(p.x, p.y, 0.0).length() - 3.5
    });
    assert!((total(&t) - 2.0 * TAU * 3.5).abs() < 1e-3);
    assert!(gaussian(0.3).branches.is_empty());
    let n = torus.jet([0.3, 0.3], [Limit::Above; 2], 2);
    let sign = nappe::measure::curvature(&n).unwrap().mean.signum();
    // |H| = (R + 2 r cos φ) / (2 r (R + r cos φ)).
    let value = sign * 4.0 / 7.0;
    let t = traced_to(
        &torus,
        Figure::Curvature {
            kind: CurvatureKind::Mean,
            value,
        },
        Some(1e-4),
    );
    hold(&t, "H at 60°", |p| {
        DVec3::new(p.x, p.y, 0.0).length() - 3.5
    });
    assert!((total(&t) - 2.0 * TAU * 3.5).abs() < 1e-3);
}

#[test]
fn curves_move_and_grow_with_the_surface() {
    let plain = torus();
    let normal = DVec3::new(0.3, -0.2, 0.9);
    let point = DVec3::new(0.1, 0.2, 0.3);
    let section = |s: &SurfaceRef, p: DVec3| traced(s, Figure::Section { point: p, normal });
    let expected = section(&plain, point);
    for (scale, shift) in [
        (1e-6, DVec3::ZERO),
        (1e6, DVec3::ZERO),
        (1.0, DVec3::new(1e5, -3e5, 2e4)),
        (1e-3, DVec3::splat(100.0)),
    ] {
        let map = DAffine3::from_translation(shift) * DAffine3::from_scale(DVec3::splat(scale));
        let moved: SurfaceRef = Arc::new(Transformed::new(plain.clone(), map).unwrap());
        let t = section(&moved, map.transform_point3(point));
        assert_eq!(t.branches.len(), expected.branches.len(), "{scale} {shift}");
        assert!(t.undecided.is_empty());
        let (a, b) = (total(&t), total(&expected) * scale);
        assert!((a - b).abs() < 1e-4 * b, "{scale} {shift}: {a} {b}");
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let plane: SurfaceRef =
        Arc::new(bilinear([[DVec3::ZERO, DVec3::Y], [DVec3::X, DVec3::X + DVec3::Y]]).unwrap());
    let field = SurfaceField::new(
        plane.clone(),
        Figure::Section {
            point: DVec3::ZERO,
            normal: DVec3::Z,
        },
    )
    .unwrap();
    assert!(matches!(
        trace(&field, &TraceOptions::default()),
        Err(TraceError::Zero(_))
    ));
    let error = |figure| SurfaceField::new(plane.clone(), figure).unwrap_err();
    assert!(matches!(
        error(Figure::Silhouette {
            direction: DVec3::ZERO
        }),
        FigureError::Direction(_)
    ));
    assert!(matches!(
        error(Figure::SilhouetteFrom { eye: DVec3::NAN }),
        FigureError::Point(_)
    ));
    assert!(matches!(
        error(Figure::Isophote {
            direction: DVec3::X,
            angle: 2.0 * PI
        }),
        FigureError::Angle(_)
    ));
    let value = f64::INFINITY;
    assert!(matches!(
        error(Figure::Curvature {
            kind: CurvatureKind::K1,
            value
        }),
        FigureError::Value(_)
    ));
}

#[test]
fn a_rectangle_beyond_the_surface_is_refused() {
    let square = [Interval::new(-1.0, 100.0); 2];
    let bound = Expr::parse("u - 0.1*v")
        .unwrap()
        .bind(&["u", "v"], &[])
        .unwrap();
    let options = TraceOptions {
        surface: Some(torus()),
        ..Default::default()
    };
    let error = trace(&ExpressionField::new(bound, square), &options).unwrap_err();
    let TraceError::Rectangle { within, domain } = error else {
        panic!("{error}")
    };
    assert_eq!((within, domain), (square, torus().domain()));
}

#[test]
fn a_traced_curve_keeps_the_laws_of_curves() {
    let t = traced(
        &torus(),
        Figure::Section {
            point: DVec3::new(0.4, 0.0, 0.1),
            normal: DVec3::new(1.0, 0.4, 2.0),
        },
    );
    assert!(!t.branches.is_empty());
    for b in &t.branches {
        nappe::laws::curve(b.curve().as_ref());
        nappe::laws::curve(&b.in_parameters());
    }
}

#[test]
fn a_crease_at_the_parameter_zero_is_seen_from_both_sides() {
    // A roof: the normal leans to one side before the ridge and to the other one after it.
    for (from, to) in [(-1.0, 1.0), (-1e-6, 1e-3), (-3.0, 1e6)] {
        let points: Vec<DVec3> = [(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)]
            .iter()
            .flat_map(|&(x, z)| [0.0, 1.0].map(|y| DVec3::new(x, y, z)))
            .collect();
        let knots = [vec![from, from, 0.0, to, to], vec![0.0, 0.0, 1.0, 1.0]];
        let roof: SurfaceRef = Arc::new(NurbsSurface::new([1, 1], knots, &points, None).unwrap());
        for figure in [
            Figure::Silhouette {
                direction: DVec3::X,
            },
            Figure::Isophote {
                direction: DVec3::X,
                angle: 1.2,
            },
        ] {
            let t = traced(&roof, figure);
            assert!(
                t.branches.is_empty() && t.undecided.is_empty() && t.touches.is_empty(),
                "{from} {to}: {t:?}"
            );
        }
    }
}
