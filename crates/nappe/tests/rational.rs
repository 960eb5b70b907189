//! Rational surfaces on any basis, and surfaces that collapse.

#![allow(clippy::unwrap_used)]

use nappe::DVec3;
use nappe::basis::{BSplineBasis, ExpressionFunctions, FunctionsRef, Trigonometric};
use nappe::exact::{NurbsError, NurbsSurface};
use nappe::expr::Expr;
use nappe::laws::{self, Random};
use nappe::surface::{
    CollapsedError, HermiteData, RationalError, Surface, bilinear, check_not_collapsed, hermite,
    rational,
};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

fn functions(texts: &[&str]) -> FunctionsRef {
    let bound = |s: &&str| Expr::parse(s).unwrap().bind(&["t"], &[]).unwrap();
    Arc::new(ExpressionFunctions::new(texts.iter().map(bound), [0.0, 1.0]).unwrap())
}

fn net(seed: u64, count: usize, columns: usize, scale: f64, shift: DVec3) -> Vec<DVec3> {
    let mut random = Random(seed);
    (0..count)
        .map(|k| {
            let grid = DVec3::new((k / columns) as f64, (k % columns) as f64, random.unit());
            shift + grid * scale
        })
        .collect()
}

fn apart(a: &dyn Surface, b: &dyn Surface) -> f64 {
    let at = |k: usize| [(k / 11) as f64 / 10.0, (k % 11) as f64 / 10.0];
    (0..121)
        .map(|k| a.point(at(k)).distance(b.point(at(k))))
        .fold(0.0, f64::max)
}

#[test]
fn bernstein_and_b_spline_bases_are_the_standard_surfaces() {
    let points = net(1, 20, 5, 1.0, DVec3::ZERO);
    let mut random = Random(3);
    let weights: Vec<f64> = (0..20).map(|_| 0.2 + random.unit()).collect();
    let knots = BSplineBasis::clamped_uniform(2, 5);
    let bases = [
        BSplineBasis::bernstein(3),
        BSplineBasis::new(2, knots).unwrap(),
    ];
    let all = bases.each_ref().map(|b| b.knots().to_vec());
    let nurbs = NurbsSurface::new([3, 2], all, &points, Some(&weights)).unwrap();
    let [u, v] = bases.map(|b| Arc::new(b) as FunctionsRef);
    let s = rational(u, v, &points, Some(&weights)).unwrap();
    assert!(apart(&s, &nurbs) <= 4e-15);
    assert!(apart(&s.to_nurbs().unwrap(), &nurbs) <= 4e-15);
    // The same Bernstein polynomials as a user writes them.
    let user = functions(&["(1-t)^3", "3*t*(1-t)^2", "3*t^2*(1-t)", "t^3"]);
    let v = Arc::new(BSplineBasis::new(2, BSplineBasis::clamped_uniform(2, 5)).unwrap());
    let written = rational(user, v, &points, Some(&weights)).unwrap();
    assert!(apart(&written, &nurbs) <= 4e-15);
}

/// A basis that neither sums to one nor is polynomial: with (1, cos, sin) the section is a circle by its angle.
#[test]
fn a_trigonometric_basis_turns_a_line_into_a_cylinder() {
    let circle = functions(&["1", "cos(pi/2*t)", "sin(pi/2*t)"]);
    let line: FunctionsRef = Arc::new(BSplineBasis::bernstein(1));
    // Points of 1, cos, sin: centre, and what is added; in homogeneous form cos and sin carry weight, too.
    let e = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let points: Vec<_> = e.iter().flat_map(|p| [*p, *p + DVec3::Z]).collect();
    let weights = vec![1.0; 6];
    let s = rational(circle, line, &points, Some(&weights)).unwrap();
    for i in 0..=10 {
        for j in 0..=10 {
            let (u, v) = (i as f64 / 10.0, j as f64 / 10.0);
            let (sin, cos) = (FRAC_PI_2 * u).sin_cos();
            let want = DVec3::new(cos, sin, 0.0) / (1.0 + cos + sin) + DVec3::Z * v;
            assert!(s.point([u, v]).distance(want) <= 1e-15);
        }
    }
    laws::surface(&s);
}

#[test]
fn laws_at_all_scales() {
    let user = functions(&["exp(-t)", "t", "1+sin(3*t)^2"]);
    let trigonometric: FunctionsRef = Arc::new(Trigonometric::new(1.3).unwrap());
    let spline: FunctionsRef =
        Arc::new(BSplineBasis::new(2, BSplineBasis::clamped_uniform(2, 5)).unwrap());
    for scale in [1e-6, 1.0, 1e6] {
        for shift in [DVec3::ZERO, DVec3::new(1e3, -2e3, 5e2) * scale] {
            let mut random = Random(8);
            for v in [&spline, &trigonometric] {
                let n = v.count();
                let points = net(5, 3 * n, n, scale, shift);
                let weights: Vec<f64> = (0..3 * n).map(|_| 0.5 + random.unit()).collect();
                let s = rational(user.clone(), v.clone(), &points, Some(&weights));
                match s {
                    Ok(s) => laws::surface(&s),
                    Err(e) => panic!("{e}"),
                }
            }
        }
    }
}

#[test]
fn only_ratios_of_weights_matter() {
    let user = functions(&["exp(-t)", "t", "1+t^2"]);
    let points = net(5, 9, 3, 1.0, DVec3::ZERO);
    let mut random = Random(8);
    let weights: Vec<f64> = (0..9).map(|_| 0.5 + random.unit()).collect();
    let scaled: Vec<f64> = weights.iter().map(|w| w * 7e-9).collect();
    let of = |w: &[f64]| rational(user.clone(), user.clone(), &points, Some(w)).unwrap();
    assert!(apart(&of(&weights), &of(&scaled)) <= 4e-15);
    // A common factor of the functions is one of the weights.
    let twice = functions(&["2*exp(-t)", "2*t", "2+2*t^2"]);
    let other = rational(twice, user.clone(), &points, Some(&weights)).unwrap();
    assert!(apart(&of(&weights), &other) <= 4e-15);
}

#[test]
fn a_weight_that_is_not_positive_is_found_with_its_place() {
    let line: FunctionsRef = Arc::new(BSplineBasis::bernstein(1));
    let points = net(5, 4, 2, 1.0, DVec3::ZERO);
    let of = |texts: &[&str]| rational(functions(texts), line.clone(), &points, None);
    // 1 - 4t(1-t) + e touches -1e-6 at t = 1/2; only a narrow range is negative.
    let e = of(&["1", "-4*t*(1-t) - 1e-6"]).unwrap_err();
    let RationalError::NotPositive { u, value, .. } = e else {
        panic!("{e}")
    };
    assert!((u - 0.5).abs() <= 1e-3 && value <= 0.0);
    assert!(of(&["1", "-4*t*(1-t) + 1e-6"]).is_ok());
    // A zero that is no double is not found by samples, and positivity is not proven either.
    let e = of(&["(t-1/3)^2", "0*t"]).unwrap_err();
    assert!(
        matches!(e, RationalError::Unproven { u, .. } | RationalError::NotPositive { u, .. }
        if (u - 1.0 / 3.0).abs() < 1e-6),
        "{e}"
    );
    assert!(matches!(
        of(&["t", "t^2"]).unwrap_err(),
        RationalError::NotPositive { u: 0.0, .. }
    ));
    for value in [0.0, -1.0, f64::NAN] {
        let weights = [1.0, 1.0, value, 1.0];
        let e = rational(line.clone(), line.clone(), &points, Some(&weights)).unwrap_err();
        assert!(matches!(
            e,
            RationalError::Net(NurbsError::Weight { index: 2, .. })
        ));
    }
    let e = rational(line.clone(), functions(&["1", "t", "t"]), &points, None).unwrap_err();
    assert!(matches!(
        e,
        RationalError::Net(NurbsError::NetSize {
            rows: 2,
            columns: 3,
            points: 4
        })
    ));
}

#[test]
fn collapsed_surfaces_are_refused_and_poles_are_not() {
    for scale in [1e-6, 1.0, 1e6] {
        for shift in [DVec3::ZERO, DVec3::new(1e3, -2e3, 5e2) * scale] {
            let p = |x: f64, y: f64| shift + DVec3::new(x, y, x * y) * scale;
            let of = |c: [[DVec3; 2]; 2]| check_not_collapsed(&bilinear(c).unwrap());
            let [o, x, y, d] = [p(0.0, 0.0), p(1.0, 0.0), p(0.0, 1.0), p(1.0, 1.0)];
            assert_eq!(of([[o, y], [x, d]]), Ok(()));
            // Two corners in one point: a pole.
            assert_eq!(of([[o, o], [x, y]]), Ok(()));
            // A thin strip is a surface.
            let thin = DVec3::Y * (1e-9 * scale);
            assert_eq!(of([[o, o + thin], [x, x + thin]]), Ok(()));
            let e = of([[o, o], [o, o]]).unwrap_err();
            assert!(matches!(e, CollapsedError::Point { .. }), "{e}");
            for line in [[[o, o], [x, x]], [[o, x], [o, x]], [[o, x], [x, o]]] {
                let e = of(line).unwrap_err();
                assert!(matches!(e, CollapsedError::Curve { .. }), "{e}");
            }
        }
    }
    let flat = HermiteData {
        corners: [[DVec3::ZERO, DVec3::X], [DVec3::ZERO, DVec3::X]],
        twists: [[DVec3::X; 2]; 2],
        ..HermiteData::default()
    };
    let e = check_not_collapsed(&hermite(&flat).unwrap()).unwrap_err();
    assert!(matches!(e, CollapsedError::Curve { .. }));
}

/// Beyond the sizes where products of lengths overflow or underflow the reason is the size, not the shape.
#[test]
fn sizes_that_cannot_be_computed_with_are_refused_as_such() {
    let sheet = |size: f64| {
        let p = |x: f64, y: f64| DVec3::new(x, y, x * y) * size;
        let corners = [[p(0.0, 0.0), p(0.0, 1.0)], [p(1.0, 0.0), p(1.0, 1.0)]];
        check_not_collapsed(&bilinear(corners).unwrap())
    };
    for size in [nappe::LARGEST_LENGTH, 10.0 * nappe::SMALLEST_EXTENT] {
        assert_eq!(sheet(size), Ok(()));
    }
    for size in [1e31, 1e160, 1e300] {
        let e = sheet(size).unwrap_err();
        assert!(matches!(e, CollapsedError::TooLarge { .. }), "{e}");
    }
    for size in [1e-31, 1e-160, 1e-300] {
        let e = sheet(size).unwrap_err();
        assert!(matches!(e, CollapsedError::TooSmall { .. }), "{e}");
    }
}

#[test]
fn a_hundred_thousand_boxes_hold_their_samples() {
    let user = functions(&["exp(-t)", "t", "1+sin(3*t)^2"]);
    let trigonometric: FunctionsRef = Arc::new(Trigonometric::new(1.3).unwrap());
    let points = net(5, 12, 4, 1.0, DVec3::ZERO);
    let mut random = Random(8);
    let weights: Vec<f64> = (0..12).map(|_| 0.5 + random.unit()).collect();
    let s = rational(user, trigonometric, &points, Some(&weights)).unwrap();
    laws::surface_with(&s, 100_000);
}
