//! Surfaces of revolution: discs, creases, points on the axis; ruled and transformed surfaces.

use crate::shapes::*;
use nappe::curve::{CurveRef, ExpressionCurve, Spacing, polyline};
use nappe::expr::Expr;
use nappe::surface::{
    Construction, Dir, Revolution, RevolutionOptions, SurfaceRef, Transformed, ruled,
};
use nappe::{DAffine3, DVec3, Frame};
use std::sync::Arc;

fn expression(x: &str, y: &str, z: &str) -> CurveRef {
    let bound = |s: &str| Expr::parse(s).unwrap().bind(&["t"], &[]).unwrap();
    Arc::new(ExpressionCurve::new([bound(x), bound(y), bound(z)], [0.0, 1.0]).unwrap())
}

fn revolved(profile: CurveRef, angle: f64, construction: Construction) -> SurfaceRef {
    let options = RevolutionOptions {
        angle,
        construction,
        ..Default::default()
    };
    Arc::new(Revolution::new(profile, Frame::WORLD, options).unwrap())
}

#[test]
fn surfaces_of_revolution_are_closed_where_their_profiles_are() {
    let sphere = || expression("sin(pi*t)", "0", "-cos(pi*t)");
    let ring = || expression("3+cos(2*pi*t)", "0", "sin(2*pi*t)");
    for construction in [Construction::Angle, Construction::Rational] {
        for tol in [0.1, 0.01] {
            for (profile, chi) in [(sphere(), 2), (ring(), 0)] {
                let s = [revolved(profile, std::f64::consts::TAU, construction)];
                let m = made(&s, tol);
                assert_eq!(check(&s, &m, tol), 0, "closed");
                assert_eq!(euler(&m), chi);
            }
            let part = [revolved(sphere(), 2.0, construction)];
            let m = made(&part, tol);
            assert!(check(&part, &m, tol) > 0);
            assert_eq!(euler(&m), 1);
        }
    }
}

/// The fewest chords of a unit circle within `tol`.
fn chords(tol: f64) -> f64 {
    std::f64::consts::PI / (1.0 - tol).acos()
}

fn revolved_polyline(points: &[DVec3], construction: Construction) -> [SurfaceRef; 1] {
    let profile = Arc::new(polyline(points, Spacing::Uniform).unwrap());
    [revolved(profile, std::f64::consts::TAU, construction)]
}

const ROUND: [Construction; 2] = [Construction::Angle, Construction::Rational];

#[test]
fn a_flat_disc_is_a_fan() {
    let (centre, rim) = (v(0.0, 0.0, 0.5), v(1.0, 0.0, 0.5));
    for (ends, scale) in [([centre, rim], 1.0), ([rim, centre], 1e4)] {
        for (construction, tol) in ROUND
            .into_iter()
            .flat_map(|c| [1e-2, 1e-3, 1e-5].map(|t| (c, t)))
        {
            let s = revolved_polyline(&ends.map(|p| p * scale), construction);
            let m = made(&s, tol * scale);
            let border = check(&s, &m, tol * scale);
            let triangles = m.patches[0].triangles.len();
            assert_eq!(
                border, triangles,
                "each triangle has one edge on the rim: {construction:?}"
            );
            let fewest = chords(tol);
            assert!(
                triangles as f64 <= 1.5 * fewest + 8.0,
                "{triangles}, not {fewest}: {construction:?}"
            );
        }
    }
}

#[test]
fn creases_do_not_spoil_the_bound_beside_them() {
    let can = [
        v(0.0, 0.0, 0.0),
        v(1.0, 0.0, 0.0),
        v(1.0, 0.0, 2.0),
        v(0.0, 0.0, 2.0),
    ];
    for (construction, tol) in ROUND
        .into_iter()
        .flat_map(|c| [1e-2, 1e-3, 1e-4].map(|t| (c, t)))
    {
        let s = revolved_polyline(&can, construction);
        let m = made(&s, tol);
        assert_eq!(check(&s, &m, tol), 0);
        assert_eq!(euler(&m), 2);
        // Two fans and a belt; the rims may have the vertices of both sides.
        let (triangles, fewest) = (m.patches[0].triangles.len(), 4.0 * chords(tol));
        assert!(
            triangles as f64 <= 3.0 * fewest + 32.0,
            "{triangles}, not {fewest}: {construction:?}"
        );
    }
}

#[test]
fn a_waist_on_the_axis_is_one_point() {
    let p = [v(1.0, 0.0, -1.0), v(0.0, 0.0, 0.0), v(1.0, 0.0, 1.0)];
    let profile = || Arc::new(polyline(&p, Spacing::Uniform).unwrap());
    for angle in [1.0, std::f64::consts::TAU] {
        let s = [revolved(profile(), angle, Construction::Angle)];
        let m = made(&s, 0.01);
        check(&s, &m, 0.01);
        let tips: std::collections::HashSet<u32> = m.patches[0]
            .vertices
            .iter()
            .filter(|x| x.uv[0] == 0.5)
            .map(|x| x.point)
            .collect();
        assert_eq!(tips.len(), 1);
    }
}

#[test]
fn ruled_and_transformed_surfaces_keep_the_bound() {
    let (a, b) = (
        expression("cos(3*t)", "sin(3*t)", "0"),
        expression("2*t", "exp(t)", "1+t^2"),
    );
    let r: SurfaceRef = Arc::new(ruled(a, b, Dir::U).unwrap());
    let map = DAffine3::from_scale(v(1.0, -2.0, 0.5));
    let t: SurfaceRef = Arc::new(Transformed::new(r.clone(), map).unwrap());
    for tol in [0.1, 0.01, 0.001] {
        for s in [&r, &t] {
            let m = made(std::slice::from_ref(s), tol);
            check(std::slice::from_ref(s), &m, tol);
        }
    }
}
