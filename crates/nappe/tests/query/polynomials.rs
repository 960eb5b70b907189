//! Polynomial surfaces, for which the distance is a polynomial: closed forms, centres of curvature, feet to the last digits.

use crate::{check, finder, rough, within};
use nappe::exact::NurbsSurface;
use nappe::laws::Random;
use nappe::surface::{SurfaceRef, Transformed};
use nappe::{DAffine3, DVec3};
use std::sync::Arc;

/// `z = ½ (x² + y²)` over a square from -1 to 1 in x and y.
fn bowl() -> SurfaceRef {
    // The Bézier ordinates of x² over -1 to 1 are 1, -1 and 1.
    let square = [1.0, -1.0, 1.0];
    let at = |i: usize, j: usize| {
        let [x, y] = [i, j].map(|k| k as f64 - 1.0);
        DVec3::new(x, y, 0.5 * (square[i] + square[j]))
    };
    let net: Vec<DVec3> = (0..9).map(|k| at(k / 3, k % 3)).collect();
    Arc::new(NurbsSurface::bezier(3, &net, None).unwrap())
}

#[test]
fn points_on_the_axis_of_a_bowl_below_and_at_and_above_the_centre_of_curvature() {
    let surfaces = [bowl()];
    for tol in [1e-7, 1e-9] {
        let finder = finder(&surfaces, tol);
        for h in [-3.0, -1e-3, 0.0, 0.5, 0.9, 0.999_999, 1.0, 1.0 + 1e-9] {
            let p = DVec3::Z * h;
            let found = finder.nearest(p).unwrap();
            check(&surfaces, p, &found, tol);
            assert!((found.distance - h.abs()).abs() <= tol, "{h} {found:?}");
        }
    }
    // Above, a circle is nearest: of `½ r² = h - 1` by `r (1 + ½ r² - h) = 0`, at the distance `sqrt(2 h - 1)`.
    for h in [1.1, 1.3] {
        let found = finder(&surfaces, 1e-3).nearest(DVec3::Z * h).unwrap();
        let exact = (2.0 * h - 1.0f64).sqrt();
        assert!((found.distance - exact).abs() <= 1e-9, "{h} {found:?}");
        assert!(found.distance - found.certainty.error() <= exact + 1e-12);
        assert!(found.certainty.error() <= 1e-3, "{h} {found:?}");
    }
}

#[test]
fn feet_are_exact_to_rounding() {
    let mut random = Random(41);
    for (scale, shift) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e4)] {
        let map = DAffine3::from_scale_rotation_translation(
            DVec3::splat(scale),
            Default::default(),
            DVec3::splat(shift),
        );
        let surface: SurfaceRef = Arc::new(Transformed::new(rough(3, 7, false), map).unwrap());
        // A tolerance that says little about where feet are.
        let tol = 1e-5 * scale;
        let finder = finder(std::slice::from_ref(&surface), tol);
        for _ in 0..200 {
            let uv = surface.domain().map(|t| random.within(t));
            let jet = surface.jet(uv, Default::default(), 1);
            let height = 1e-3 * scale * (2.0 * random.unit() - 1.0);
            let p = jet.point() + jet.normal().unwrap() * height;
            let found = finder.nearest(p).unwrap();
            let off = found.point.distance(jet.point());
            assert!(off <= 1e-11 * scale + 1e-13 * shift, "{uv:?} {off:e}");
            assert!(found.certainty.error() <= tol);
        }
    }
}

#[test]
fn answers_do_not_depend_on_how_a_surface_is_made() {
    // The same points by a polynomial piece, and by one that is none in name: with weights that are not all equal in a degree
    // raised by a factor of w.
    let mut random = Random(42);
    let net: Vec<DVec3> = (0..9)
        .map(|k| DVec3::new((k / 3) as f64, (k % 3) as f64, 2.0 * random.unit()))
        .collect();
    let plain: SurfaceRef = Arc::new(NurbsSurface::bezier(3, &net, None).unwrap());
    // Times `1 + u`: of degree 3 along u, with rows `w_i`.
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for i in 0..4 {
        for j in 0..3 {
            let (mut sum, mut w) = (DVec3::ZERO, 0.0);
            for (k, f) in [1.0, 2.0].into_iter().enumerate() {
                if i >= k && i - k < 3 {
                    let share = f * [1.0, 2.0, 1.0][i - k] / [1.0, 3.0, 3.0, 1.0][i];
                    sum += net[3 * (i - k) + j] * share;
                    w += share;
                }
            }
            points.push(sum / w);
            weights.push(w);
        }
    }
    let raised: SurfaceRef = Arc::new(NurbsSurface::bezier(4, &points, Some(&weights)).unwrap());
    let both = [&plain, &raised].map(|s| finder(std::slice::from_ref(s), 1e-9));
    for _ in 0..500 {
        let uv = [random.unit(), random.unit()];
        assert!(plain.point(uv).distance(raised.point(uv)) < 1e-13);
        let p = plain.point(uv) + within(&mut random, 1.5);
        let [a, b] = [&both[0], &both[1]].map(|f| f.nearest(p).unwrap());
        assert!((a.distance - b.distance).abs() <= 2e-9, "{p} {a:?} {b:?}");
    }
}
