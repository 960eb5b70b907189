//! NURBS forms of surfaces that share sides: the sides are one curve, and the errors of the forms are within their bounds.

#![allow(clippy::unwrap_used)]

use nappe::curve::{CurveRef, ExpressionCurve, Trimmed};
use nappe::exact::{
    Converted, NurbsCurve, NurbsSurface, SharedSide, to_nurbs_or_approximate, to_nurbs_together,
};
use nappe::expr::Expr;
use nappe::mesh::Certainty;
use nappe::surface::{Coons, CoonsOptions, Dir, Side, Surface, SurfaceRef, Transformed, ruled};
use nappe::{DAffine3, DVec3};
use std::sync::Arc;

fn curve(x: &str, y: &str, z: &str) -> CurveRef {
    let expr = |s: &str| Expr::parse(s).unwrap().bind(&["t"], &[]).unwrap();
    Arc::new(ExpressionCurve::new([expr(x), expr(y), expr(z)], [0.0, 1.0]).unwrap())
}

fn coons(sides: [CurveRef; 4]) -> SurfaceRef {
    let [south, north, west, east] = sides;
    Arc::new(Coons::new(south, north, west, east, &CoonsOptions::default()).unwrap())
}

/// Patches over unit squares of the plane, whose sides are on z = sin(2 x) cos(3 y).
fn quilt(n: usize) -> Vec<SurfaceRef> {
    let along_x = |i: usize, j: usize| {
        curve(
            &format!("{i}+t"),
            &format!("0*t+{j}"),
            &format!("sin(2*({i}+t))*cos(3*{j})"),
        )
    };
    let along_y = |i: usize, j: usize| {
        curve(
            &format!("0*t+{i}"),
            &format!("{j}+t"),
            &format!("sin(2*{i})*cos(3*({j}+t))"),
        )
    };
    let patch = |k: usize| {
        let (i, j) = (k / n, k % n);
        let sides = [
            along_x(i, j),
            along_x(i, j + 1),
            along_y(i, j),
            along_y(i + 1, j),
        ];
        let [south, north, west, east] = sides;
        let back = |c: CurveRef| -> CurveRef { Arc::new(Trimmed::reversed(c)) };
        // Every third runs with u and v exchanged, and every fourth against u.
        coons(if k % 3 == 2 {
            [west, east, south, north]
        } else if k % 4 == 1 {
            [back(south), back(north), east, west]
        } else {
            [south, north, west, east]
        })
    };
    (0..n * n).map(patch).collect()
}

fn placed(s: &[SurfaceRef], scale: f64, far: f64) -> Vec<SurfaceRef> {
    let map =
        DAffine3::from_translation(DVec3::splat(far)) * DAffine3::from_scale(DVec3::splat(scale));
    s.iter()
        .map(|s| Arc::new(Transformed::new(s.clone(), map).unwrap()) as SurfaceRef)
        .collect()
}

/// The point at a share of a side.
fn on_side(s: &dyn Surface, side: Side, share: f64) -> DVec3 {
    let d = s.domain().map(|d| [d.lo, d.hi]);
    let at = |k: usize, x: f64| d[k][0] + (d[k][1] - d[k][0]) * x;
    let end = if side.is_upper() { 1.0 } else { 0.0 };
    s.point(match side.along() {
        Dir::U => [at(0, share), at(1, end)],
        Dir::V => [at(0, end), at(1, share)],
    })
}

/// The greatest distance of points of two sides at equal shares, in the direction in which that is less.
fn sampled_gap(a: (&dyn Surface, Side), b: (&dyn Surface, Side)) -> f64 {
    let most = |back: bool| {
        let distance = |k: usize| {
            let t = k as f64 / 500.0;
            on_side(a.0, a.1, t).distance(on_side(b.0, b.1, if back { 1.0 - t } else { t }))
        };
        (0..=500).map(distance).fold(0.0, f64::max)
    };
    most(false).min(most(true))
}

/// The errors of all forms are within their bounds, and these within the tolerance.
fn errors_hold(surfaces: &[SurfaceRef], forms: &[Converted<NurbsSurface>], tol: f64) {
    for (s, form) in surfaces.iter().zip(forms) {
        let mut most = 0.0f64;
        for i in 0..=60 {
            for j in 0..=60 {
                let uv = [i as f64 / 60.0, j as f64 / 60.0];
                most = most.max(s.point(uv).distance(form.nurbs.point(uv)));
            }
        }
        let rounding = 1e-14 * s.point([0.0; 2]).length();
        assert!(
            most <= form.certainty.error() + rounding,
            "{most} {:?}",
            form.certainty
        );
        assert!(form.certainty.error() <= tol);
    }
}

fn gaps(forms: &[Converted<NurbsSurface>], shared: &[SharedSide]) -> f64 {
    let gap = |s: &SharedSide| {
        let [a, b] = s
            .sides
            .map(|(i, side)| (&forms[i].nurbs as &dyn Surface, side));
        let sampled = sampled_gap(a, b);
        assert!(
            matches!(s.gap, Certainty::Bounded(e) if sampled <= e),
            "{sampled} {s:?}"
        );
        s.gap.error()
    };
    shared.iter().map(gap).fold(0.0, f64::max)
}

#[test]
fn sides_of_approximated_surfaces_become_one_curve() {
    for (scale, far) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e4)] {
        let surfaces = placed(&quilt(3), scale, far);
        let tol = 1e-3 * scale;
        let (forms, shared) = to_nurbs_together(&surfaces, tol, 0.05 * tol).unwrap();
        assert_eq!(shared.len(), 12);
        assert!(shared.iter().all(|s| s.common), "{shared:?}");
        let rounding = 1e-13 * (3.0 * scale + far);
        assert!(gaps(&forms, &shared) <= rounding, "{shared:?}");
        errors_hold(&surfaces, &forms, tol);
        // Which they are not by themselves.
        let alone: Vec<_> = surfaces
            .iter()
            .map(|s| to_nurbs_or_approximate(s.as_ref(), tol).unwrap())
            .collect();
        let apart = shared.iter().map(|s| {
            let [a, b] = s
                .sides
                .map(|(i, side)| (&alone[i].nurbs as &dyn Surface, side));
            sampled_gap(a, b)
        });
        assert!(apart.fold(0.0, f64::max) > 1e-3 * tol);
        // And it does not cost many knots.
        let count = |f: &[Converted<NurbsSurface>]| -> usize {
            f.iter()
                .map(|f| f.nurbs.size()[0] * f.nurbs.size()[1])
                .sum()
        };
        assert!(
            count(&forms) <= 4 * count(&alone),
            "{} {}",
            count(&forms),
            count(&alone)
        );
    }
}

#[test]
fn an_exact_neighbour_keeps_its_side() {
    // A cylinder over a parabola, or over a circular arc, and a patch that goes on from it; in either order.
    for weight in [1.0, 0.5f64.sqrt()] {
        let arc = |z: f64, r: f64| -> CurveRef {
            let points = [[r, 0.0], [r, r], [0.0, r]].map(|[x, y]| DVec3::new(x, y, z));
            Arc::new(NurbsCurve::bezier(&points, Some(&[1.0, weight, 1.0])).unwrap())
        };
        let exact: SurfaceRef = Arc::new(ruled(arc(0.0, 2.0), arc(1.0, 2.0), Dir::U).unwrap());
        let outer = curve("3*cos(pi*t/2)", "3*sin(pi*t/2)", "1+sin(3*t)*t*(1-t)");
        let free = coons([
            arc(1.0, 2.0),
            outer,
            curve("2+t", "0*t", "1+sin(pi*t)"),
            curve("0*t", "2+t", "1+sin(pi*t)"),
        ]);
        for order in [[0, 1], [1, 0]] {
            let both = [exact.clone(), free.clone()];
            let surfaces = order.map(|k| both[k].clone());
            let own = order.iter().position(|&k| k == 0).unwrap();
            let tol = 1e-4;
            let (forms, shared) = to_nurbs_together(&surfaces, tol, 0.05 * tol).unwrap();
            assert_eq!(forms[own].certainty, Certainty::Exact);
            assert_eq!((shared.len(), shared[0].sides[0].0), (1, own));
            // Bounds below 1e-13 of the size, here 2.8, are not sharpened.
            assert!(
                shared[0].common && gaps(&forms, &shared) <= 3e-13,
                "{shared:?}"
            );
            assert_eq!(forms[1 - own].nurbs.is_rational(), weight < 1.0);
            errors_hold(&surfaces, &forms, tol);
        }
    }
}

#[test]
fn sides_with_other_parameters_stay_apart_and_say_so() {
    let line = |y: &str| curve("t", y, "sin(3*t)");
    let uneven = |y: &str| curve("t^2*0.5+0.5*t", y, "sin(3*(t^2*0.5+0.5*t))");
    let surfaces: Vec<SurfaceRef> = vec![
        Arc::new(ruled(line("0*t"), line("0*t+1"), Dir::U).unwrap()),
        Arc::new(ruled(uneven("0*t+1"), uneven("0*t+2"), Dir::U).unwrap()),
    ];
    let tol = 1e-3;
    let (forms, shared) = to_nurbs_together(&surfaces, tol, 0.05 * tol).unwrap();
    assert_eq!(shared.len(), 1);
    assert!(!shared[0].common);
    let gap = shared[0].gap.error();
    assert!(gap > 0.0 && gap < tol, "{gap}");
    errors_hold(&surfaces, &forms, tol);
}

#[test]
fn a_seam_is_one_curve() {
    // A closed strip that rises from its inner to its outer edge; its seam is bent.
    let ring = |t: &str, r: f64| {
        curve(
            &format!("{r}*cos(2*pi*t)+0*{t}"),
            &format!("{r}*sin(2*pi*t)"),
            &format!("{r}*sin(2*pi*t)^2"),
        )
    };
    let across = curve("1+t", "0*t", "sin(pi*t)");
    let surface = coons([ring("t", 1.0), ring("t", 2.0), across.clone(), across]);
    let surfaces = [surface];
    let tol = 1e-3;
    let (forms, shared) = to_nurbs_together(&surfaces, tol, 0.05 * tol).unwrap();
    assert_eq!(shared.len(), 1);
    assert_eq!(shared[0].sides, [(0, Side::West), (0, Side::East)]);
    assert!(shared[0].common && gaps(&forms, &shared) <= 1e-13);
    errors_hold(&surfaces, &forms, tol);
}
