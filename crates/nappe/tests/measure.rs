//! Area, volume, extent and curvature against closed forms.

#![allow(clippy::unwrap_used)]

use nappe::curve::{CurveRef, ExpressionCurve};
use nappe::exact::NurbsSurface;
use nappe::expr::Expr;
use nappe::measure::{
    Extreme, IntegralOptions, Measured, SearchOptions, Shell, VolumeError, area, curvature,
    curvature_extremes, extent, shells, tear, volume,
};
use nappe::mesh::Certainty;
use nappe::surface::{
    Construction, Quadric, QuadricOptions, QuadricShape, Revolution, RevolutionOptions, Surface,
    SurfaceRef, Swapped, Transformed, bilinear,
};
use nappe::{DAffine3, DVec3, Frame, Limit};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn revolved(x: &str, z: &str, construction: Construction) -> SurfaceRef {
    let bound = |s: &str| Expr::parse(s).unwrap().bind(&["t"], &[]).unwrap();
    let profile: CurveRef =
        Arc::new(ExpressionCurve::new([bound(x), bound("0"), bound(z)], [0.0, 1.0]).unwrap());
    let options = RevolutionOptions {
        construction,
        angle: TAU,
        ..Default::default()
    };
    Arc::new(Revolution::new(profile, Frame::WORLD, options).unwrap())
}

/// Downwards, so that normals point away from the axis.
fn sphere(construction: Construction) -> SurfaceRef {
    revolved("sin(pi*t)", "cos(pi*t)", construction)
}

fn torus(construction: Construction) -> SurfaceRef {
    revolved("3+cos(2*pi*t)", "-sin(2*pi*t)", construction)
}

fn placed(s: &SurfaceRef, scale: f64, shift: DVec3) -> SurfaceRef {
    let map = DAffine3::from_translation(shift) * DAffine3::from_scale(DVec3::splat(scale));
    Arc::new(Transformed::new(s.clone(), map).unwrap())
}

const PLACES: [(f64, f64); 4] = [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e3)];

const MILLIONTH: IntegralOptions = IntegralOptions {
    relative: 1e-6,
    budget: 8000,
};
/// A bound is relative to the value found, not to the true one.
const SLACK: f64 = 1.0 + 1e-5;

#[test]
fn areas_are_proven() {
    for construction in [Construction::Angle, Construction::Rational] {
        for (s, want) in [
            (sphere(construction), 4.0 * PI),
            (torus(construction), 12.0 * PI * PI),
        ] {
            // Each construction at two places, for the time it takes.
            let places = match construction {
                Construction::Angle => &PLACES[..2],
                _ => &PLACES[2..],
            };
            for &(scale, far) in places {
                let s = placed(&s, scale, v(far, -far, far));
                let m = area(s.as_ref(), &MILLIONTH);
                let (want, error) = (want * scale * scale, (m.value - want * scale * scale).abs());
                let Certainty::Bounded(bound) = m.certainty else {
                    panic!("{m:?}")
                };
                assert!(error <= bound, "{error:e} > {bound:e}");
                assert!(bound <= 1e-6 * want * SLACK, "{m:?} for {want}");
            }
        }
    }
}

#[test]
fn volumes_are_those_of_the_closed_forms_and_have_a_sign() {
    for construction in [Construction::Angle, Construction::Rational] {
        for (s, want) in [
            (sphere(construction), 4.0 / 3.0 * PI),
            (torus(construction), 6.0 * PI * PI),
        ] {
            for (scale, far) in PLACES {
                let s = placed(&s, scale, v(far, -far, far));
                let want = want * scale.powi(3);
                let m = volume(std::slice::from_ref(&s), None, &MILLIONTH).unwrap();
                let Certainty::Bounded(bound) = m.certainty else {
                    panic!("{m:?}")
                };
                assert!((m.value - want).abs() <= bound, "{m:?} for {want}");
                // A tenth is left for the strips along the seam.
                assert!(bound <= 1.1e-6 * want * SLACK, "{m:?} for {want}");
                let inside_out: SurfaceRef = Arc::new(Swapped::new(s));
                let n = volume(&[inside_out], None, &MILLIONTH).unwrap();
                assert!((n.value + m.value).abs() <= bound + n.certainty.error());
            }
        }
    }
}

#[test]
fn a_box_of_six_planes_has_its_volume_and_a_wrong_one_is_named() {
    let face = |a: DVec3, b: DVec3, c: DVec3| -> SurfaceRef {
        // From a towards b (u) and c (v).
        Arc::new(bilinear([[a, c], [b, b + c - a]]).unwrap())
    };
    let (o, x, y, z) = (
        DVec3::ZERO,
        v(2.0, 0.0, 0.0),
        v(0.0, 3.0, 0.0),
        v(0.0, 0.0, 5.0),
    );
    let faces = vec![
        face(o, y, x),
        face(o, x, z),
        face(o, z, y),
        face(z, z + x, z + y),
        face(y, y + z, y + x),
        face(x, x + y, x + z),
    ];
    let m = volume(&faces, None, &IntegralOptions::default()).unwrap();
    assert!((m.value - 30.0).abs() <= m.certainty.error() && m.certainty.error() < 1e-6 * 240.0);
    let open = volume(&faces[..5], None, &IntegralOptions::default());
    assert!(matches!(open, Err(VolumeError::Open { .. })), "{open:?}");
    let mut turned = faces.clone();
    turned[5] = face(x, x + z, x + y);
    let wrong = volume(&turned, None, &IntegralOptions::default());
    assert!(
        matches!(wrong, Err(VolumeError::Orientation { .. })),
        "{wrong:?}"
    );
    // As a shell it is turned, whichever surface comes first.
    for first in 0..6 {
        let mut order: Vec<usize> = (0..6).collect();
        order.rotate_left(first);
        let faces: Vec<SurfaceRef> = order.iter().map(|&k| turned[k].clone()).collect();
        let found = shells(&faces, None, &IntegralOptions::default());
        let [Ok(shell)] = found.as_slice() else {
            panic!("{found:?}")
        };
        let m = shell.volume;
        assert!((m.value - 30.0).abs() <= m.certainty.error() && m.certainty.error() < 1e-3);
        let inwards = shell.surfaces.iter().filter(|s| s.1).map(|s| order[s.0]);
        assert_eq!(inwards.collect::<Vec<_>>(), [5]);
    }
}

fn ellipsoid(axes: [f64; 3]) -> SurfaceRef {
    let shape = QuadricShape::Ellipsoid;
    Arc::new(Quadric::new(shape, &axes, QuadricOptions::default()).unwrap())
}

#[test]
fn each_shell_has_its_own_volume() {
    let ball = 4.0 / 3.0 * PI;
    let near = |m: Measured, want: f64| {
        assert!(
            (m.value - want).abs() <= m.certainty.error(),
            "{m:?} for {want}"
        );
        assert!(m.certainty.error() <= 1e-5 * ball, "{m:?}");
    };
    let outer = ellipsoid([1.0; 3]);
    // A hollow: the inner sphere has its normals towards the middle.
    let inner: SurfaceRef = Arc::new(Swapped::new(ellipsoid([0.5; 3])));
    let shells_of = |s: &[SurfaceRef]| shells(s, None, &MILLIONTH);
    let found: Result<Vec<Shell>, _> = shells_of(&[outer.clone(), inner.clone()])
        .into_iter()
        .collect();
    let found = found.unwrap();
    assert_eq!(found.len(), 2);
    near(found[0].volume, ball);
    near(found[1].volume, ball / 8.0);
    assert_eq!(
        (found[0].surfaces[0], found[1].surfaces[0]),
        ((0, false), (1, true))
    );
    near(
        volume(&[outer, inner], None, &MILLIONTH).unwrap(),
        ball * 7.0 / 8.0,
    );
    // What is open beside a shell takes nothing from it.
    let open = revolved("1", "t", Construction::Angle);
    let [Ok(ref shell), Err(VolumeError::Open { surface: 1, .. })] =
        shells_of(&[ellipsoid([1.0; 3]), open])[..]
    else {
        panic!("one shell and one open surface")
    };
    near(shell.volume, ball);
}

#[test]
fn thin_bodies_have_tight_volumes() {
    for axes in [[1.0; 3], [1e3, 1e3, 1e-3], [0.1, 0.1, 1e3], [1.0, 2.0, 5.0]] {
        let m = volume(&[ellipsoid(axes)], None, &MILLIONTH).unwrap();
        let want = 4.0 / 3.0 * PI * axes.iter().product::<f64>();
        assert!(matches!(m.certainty, Certainty::Bounded(_)), "{m:?}");
        assert!(
            (m.value - want).abs() <= m.certainty.error(),
            "{m:?} for {want}"
        );
        assert!(m.certainty.error() <= 1e-4 * want, "{axes:?}: {m:?}");
    }
}

#[test]
fn a_torn_surface_has_no_volume() {
    // A tube whose radius jumps half way, closed to a ring: without the jump it would be a torus.
    let s = revolved(
        "3 + if(t < 0.5, 1, 1.1)*cos(2*pi*t)",
        "-if(t < 0.5, 1, 1.1)*sin(2*pi*t)",
        Construction::Angle,
    );
    let found = volume(std::slice::from_ref(&s), Some(1.0), &MILLIONTH);
    let Err(VolumeError::Torn { surface: 0, at, .. }) = found else {
        panic!("{found:?}")
    };
    assert!((at - 0.5).abs() < 1e-12);
    assert_eq!(tear(s.as_ref()).unwrap().1, at);
}

#[test]
fn a_needle_has_the_curvature_of_its_tips_and_waist() {
    let options = SearchOptions {
        budget: 200,
        ..Default::default()
    };
    for a in [1e-2, 1e-6] {
        let e = curvature_extremes(ellipsoid([a, a, 1e3]).as_ref(), &options);
        let e = e.unwrap();
        // At the waist K = 1/c², the least; samples find at least a curvature as strong as that of the waist.
        assert!(
            e.gaussian[0].value <= 1.001e-6 && e.gaussian[0].value >= 0.999e-6,
            "{e:?}"
        );
        assert!(e.k2.value <= -0.999 / a, "{e:?}");
    }
}

#[test]
fn extents_are_tight() {
    for (scale, far) in PLACES {
        let shift = v(far, -far, 2.0 * far);
        let s = placed(&torus(Construction::Angle), scale, shift);
        let e = extent(s.as_ref(), &SearchOptions::default()).unwrap();
        let want = v(4.0, 4.0, 1.0) * scale;
        let Certainty::Bounded(bound) = e.certainty else {
            panic!("{e:?}")
        };
        assert!(bound < 1e-4 * scale, "{bound:e}");
        let (lo, hi) = (
            v(e.hull.x.lo, e.hull.y.lo, e.hull.z.lo) - shift,
            v(e.hull.x.hi, e.hull.y.hi, e.hull.z.hi) - shift,
        );
        let slack = bound + 1e-12 * (scale + far);
        assert!((lo + want).abs().max_element() <= slack, "{lo}");
        assert!((hi - want).abs().max_element() <= slack, "{hi}");
    }
}

#[test]
fn curvatures_of_sphere_torus_saddle_and_catenoid() {
    let at = |s: &dyn Surface, uv| curvature(&s.jet(uv, [Limit::Above; 2], 2)).unwrap();
    for (scale, far) in PLACES {
        let s = placed(&sphere(Construction::Rational), scale, DVec3::splat(far));
        for uv in [[0.3, 0.1], [0.77, 0.9], [0.5, 0.5]] {
            let c = at(s.as_ref(), uv);
            // Far away the derivatives are unchanged, so only the scale matters.
            for k in [c.k1, c.k2, c.mean] {
                assert!((k * scale + 1.0).abs() < 1e-11, "{c:?}");
            }
            assert!((c.gaussian * scale * scale - 1.0).abs() < 1e-11);
        }
        let t = placed(&torus(Construction::Angle), scale, DVec3::splat(far));
        for (u, want) in [(0.0, 1.0 / 4.0), (0.5, -1.0 / 2.0), (0.25, 0.0)] {
            let c = at(t.as_ref(), [u, 0.37]);
            assert!((c.gaussian * scale * scale - want).abs() < 1e-11, "{c:?}");
            assert!((c.k2 * scale + 1.0).abs() < 1e-11);
            // The tube bends most along the profile, square to the parallel.
            let jet = t.jet([u, 0.37], [Limit::Above; 2], 1);
            assert!(c.directions[1].dot(jet.d[2]).abs() < 1e-9 * jet.d[2].length());
        }
    }
    // z = xy at the origin: K = -1, H = 0, principal directions on the diagonals.
    let p = [
        [v(-1.0, -1.0, 1.0), v(-1.0, 1.0, -1.0)],
        [v(1.0, -1.0, -1.0), v(1.0, 1.0, 1.0)],
    ];
    let saddle = bilinear(p).unwrap();
    let c = at(&saddle, [0.5, 0.5]);
    assert!((c.gaussian + 1.0).abs() < 1e-13 && c.mean.abs() < 1e-13);
    assert!((c.k1 - 1.0).abs() < 1e-13 && (c.k2 + 1.0).abs() < 1e-13);
    let diagonal = v(1.0, 1.0, 0.0).normalize();
    assert!((c.directions[0].dot(diagonal).abs() - 1.0).abs() < 1e-12);
    // The catenoid is minimal.
    let catenoid = revolved("cosh(2*t-1)", "2*t-1", Construction::Angle);
    for u in [0.1, 0.4, 0.9] {
        let c = at(catenoid.as_ref(), [u, 0.2]);
        let want = -1.0 / (2.0 * u - 1.0f64).cosh().powi(4);
        assert!(
            c.mean.abs() < 1e-13 && (c.gaussian - want).abs() < 1e-12,
            "{c:?}"
        );
    }
    // No normal at a pole; beside it the curvature is that of the sphere.
    for construction in [Construction::Angle, Construction::Rational] {
        let s = sphere(construction);
        let pole = s.jet([0.0, 0.3], [Limit::Above; 2], 2);
        assert_eq!(curvature(&pole), None);
        let c = at(s.as_ref(), [1e-3, 0.3]);
        assert!(
            (c.k1 + 1.0).abs() < 1e-9 && (c.k2 + 1.0).abs() < 1e-9,
            "{c:?}"
        );
    }
}

#[test]
fn areas_and_volumes_can_be_had_to_eight_digits() {
    let options = IntegralOptions {
        relative: 1e-8,
        ..Default::default()
    };
    let t = torus(Construction::Angle);
    for (m, want) in [
        (area(t.as_ref(), &options), 12.0 * PI * PI),
        (volume(&[t], None, &options).unwrap(), 6.0 * PI * PI),
    ] {
        let Certainty::Bounded(bound) = m.certainty else {
            panic!("{m:?}")
        };
        assert!((m.value - want).abs() <= bound && bound <= 1.1e-8 * want * SLACK);
    }
}

#[test]
fn the_volume_of_a_body_with_gaps_is_proven_with_what_they_may_hold() {
    // Two halves of a cube; one is moved away from the other by a gap that the weld distance bridges.
    let gap = 1e-4;
    let cube = |shift: DVec3, skip: usize| -> Vec<SurfaceRef> {
        let face = |a: DVec3, b: DVec3, c: DVec3| -> SurfaceRef {
            Arc::new(bilinear([[a, c], [b, b + c - a]]).unwrap())
        };
        let (o, x, y, z) = (shift, DVec3::X, DVec3::Y, DVec3::Z);
        let faces = [
            face(o, o + y, o + x),
            face(o, o + x, o + z),
            face(o, o + z, o + y),
            face(o + z, o + z + x, o + z + y),
            face(o + y, o + y + z, o + y + x),
            face(o + x, o + x + y, o + x + z),
        ];
        let kept = faces.into_iter().enumerate().filter(|f| f.0 != skip);
        kept.map(|f| f.1).collect()
    };
    // The lower cube without its top, the upper without its bottom.
    let mut faces = cube(DVec3::ZERO, 3);
    faces.extend(cube(v(0.0, 0.0, 1.0 + gap), 0));
    let m = volume(&faces, Some(10.0 * gap), &MILLIONTH).unwrap();
    let Certainty::Bounded(bound) = m.certainty else {
        panic!("{m:?}")
    };
    // Closed by strips it is a box of height 2 + gap.
    let want = 2.0 + gap;
    assert!((m.value - want).abs() <= bound, "{m:?} for {want}");
    assert!(bound > 0.5 * gap && bound < 10.0 * gap, "{bound:e}");
}

#[test]
fn curvature_extremes_of_a_torus_are_proven() {
    for scale in [1e-6, 1e6] {
        let t = placed(&torus(Construction::Angle), scale, DVec3::ZERO);
        let e = curvature_extremes(t.as_ref(), &SearchOptions::default()).unwrap();
        let s2 = scale * scale;
        for (found, want, unit) in [
            (e.gaussian[0], -0.5, s2),
            (e.gaussian[1], 0.25, s2),
            (e.mean[0], -0.5 * (1.0 + 0.25), scale),
            (e.mean[1], -0.5 * (1.0 - 0.5), scale),
            (e.k1, 0.5, scale),
            (e.k2, -1.0, scale),
        ] {
            let Certainty::Bounded(bound) = found.certainty else {
                panic!("{found:?}")
            };
            let (value, bound) = (found.value * unit, bound * unit);
            assert!(
                (value - want).abs() <= bound + 1e-11,
                "{found:?} for {want}"
            );
            // Relative to the greatest curvature, 1. As k2 is the same everywhere, no box can be left out.
            let most = if found == e.k2 { 2e-4 } else { 1e-4 };
            assert!(bound <= most * SLACK, "{found:?} for {want}");
        }
        assert!((e.smallest_radius / scale - 1.0).abs() < 1e-9);
    }
}

#[test]
fn curvature_extremes_are_proven_up_to_poles_and_umbilics() {
    // Half axes 1, 1, 2: at the poles, where the axis pierces it, both curvatures are 2; around the equator 1 and 1/4.
    let stretched = DAffine3::from_scale(v(1.0, 1.0, 2.0));
    let spheroid = Transformed::new(sphere(Construction::Angle), stretched).unwrap();
    let saddle = bilinear([
        [v(-1.0, -1.0, 1.0), v(-1.0, 1.0, -1.0)],
        [v(1.0, -1.0, -1.0), v(1.0, 1.0, 1.0)],
    ])
    .unwrap();
    let sphere = sphere(Construction::Angle);
    let cylinder = revolved("2", "-5*t", Construction::Angle);
    let surfaces: [(&dyn Surface, [f64; 4]); 4] = [
        (sphere.as_ref(), [1.0, 1.0, -1.0, -1.0]),
        (&spheroid, [0.25, 4.0, -0.25, -2.0]),
        (&saddle, [-1.0, -1.0 / 9.0, 1.0, -1.0]),
        (cylinder.as_ref(), [0.0, 0.0, 0.0, -0.5]),
    ];
    for (surface, [least, greatest, k1, k2]) in surfaces {
        let e = curvature_extremes(surface, &SearchOptions::default()).unwrap();
        let unit = e.k1.value.abs().max(e.k2.value.abs());
        for (found, want, unit) in [
            (e.gaussian[0], least, unit * unit),
            (e.gaussian[1], greatest, unit * unit),
            (e.k1, k1, unit),
            (e.k2, k2, unit),
        ] {
            let Certainty::Bounded(bound) = found.certainty else {
                panic!("{found:?}")
            };
            let error = (found.value - want).abs();
            assert!(error <= bound + 1e-9 * unit, "{found:?} for {want}");
            assert!(bound <= 1.1e-4 * unit, "{found:?} for {want}");
        }
    }
}

#[test]
fn curvature_beside_an_apex_is_unbounded() {
    let few = SearchOptions {
        budget: 200,
        ..Default::default()
    };
    let unbounded =
        |e: &Extreme, sign: f64| e.value == sign * f64::INFINITY && e.certainty == Certainty::Exact;
    // A cone whose normals point away from the axis, upwards: it bends away from them.
    for (scale, far) in PLACES {
        for construction in [Construction::Angle, Construction::Rational] {
            let cone = placed(
                &revolved("2*t", "-5*t", construction),
                scale,
                v(far, -far, far),
            );
            let e = curvature_extremes(cone.as_ref(), &few).unwrap();
            assert!(
                unbounded(&e.k2, -1.0) && unbounded(&e.mean[0], -1.0),
                "{e:?}"
            );
            assert_eq!(e.smallest_radius, 0.0);
            // A cone is flat in the sense of Gauss, and its rulings are straight; but no bound is known beside the apex.
            assert!(e.k1.value.abs() * scale < 1e-6, "{e:?}");
            assert_eq!(e.gaussian[1].certainty, Certainty::Estimated(f64::INFINITY));
            // The apex at the upper end, and the normals turned over by exchanging u and v.
            let down: SurfaceRef = Arc::new(Swapped::new(revolved("2-2*t", "5*t", construction)));
            let e = curvature_extremes(down.as_ref(), &few).unwrap();
            let up = revolved("2-2*t", "5*t", construction);
            let other = curvature_extremes(up.as_ref(), &few).unwrap();
            assert!(
                unbounded(&e.k1, 1.0) != unbounded(&other.k1, 1.0),
                "{e:?} {other:?}"
            );
        }
    }
    // A spindle: its meridians bend towards the axis like its parallels, so K is unbounded. A trumpet: K has the other sign.
    for (x, sign) in [("t*(2-t)", 1.0), ("t*(1+t)", -1.0)] {
        let s = revolved(x, "t", Construction::Angle);
        let e = curvature_extremes(s.as_ref(), &few).unwrap();
        let [least, greatest] = &e.gaussian;
        assert!(
            unbounded(if sign > 0.0 { greatest } else { least }, sign),
            "{e:?}"
        );
        assert!(
            !unbounded(if sign > 0.0 { least } else { greatest }, -sign),
            "{e:?}"
        );
    }
    // A smooth pole has none of this.
    for construction in [Construction::Angle, Construction::Rational] {
        let e = curvature_extremes(sphere(construction).as_ref(), &few).unwrap();
        assert!(
            e.mean
                .iter()
                .chain(&e.gaussian)
                .all(|x| x.value.is_finite()),
            "{e:?}"
        );
    }
}

#[test]
fn a_small_open_surface_beside_a_large_one_is_not_called_closed() {
    let closed = |s: &[SurfaceRef]| volume(s, None, &MILLIONTH);
    for small in [1e-5, 1e-7, 1.0] {
        let large = placed(&sphere(Construction::Angle), 1e6, DVec3::ZERO);
        let sheet: SurfaceRef = Arc::new(
            bilinear([
                [v(3e6, 0.0, 0.0), v(3e6, small, 0.0)],
                [v(3e6 + small, 0.0, 0.0), v(3e6 + small, small, small)],
            ])
            .unwrap(),
        );
        let found = closed(&[large.clone(), sheet]);
        let Err(VolumeError::Open {
            surface: 1, weld, ..
        }) = found
        else {
            panic!("{found:?}")
        };
        assert!(weld <= 0.011 * small, "{weld}");
        // Closed ones still are.
        assert!(closed(std::slice::from_ref(&large)).is_ok());
        let ball = placed(
            &sphere(Construction::Angle),
            small.max(1e-3),
            v(0.0, 0.0, 0.0),
        );
        assert!(closed(&[large, ball]).is_ok());
    }
    // A strip narrower than the distance within which sides are joined is no tube.
    let strip: SurfaceRef = Arc::new(
        bilinear([
            [v(0.0, 0.0, 0.0), v(0.0, 1e-8, 0.0)],
            [v(1.0, 0.0, 0.0), v(1.0, 1e-8, 0.0)],
        ])
        .unwrap(),
    );
    assert!(matches!(closed(&[strip]), Err(VolumeError::Open { .. })));
}

#[test]
fn numbers_do_not_depend_on_the_parametrisation() {
    // A quarter of a cylinder of height 2, by two rational parametrisations.
    let s = 0.5f64.sqrt();
    let arc = |z: f64| [v(1.0, 0.0, z), v(1.0, 1.0, z), v(0.0, 1.0, z)];
    let quarter = |c: f64| -> SurfaceRef {
        let w = [1.0, s * c, c * c, 1.0, s * c, c * c];
        let p: Vec<DVec3> = arc(0.0).into_iter().chain(arc(2.0)).collect();
        Arc::new(NurbsSurface::bezier(2, &p, Some(&w)).unwrap())
    };
    for c in [1.0, 2.5] {
        let q = quarter(c);
        let m = area(q.as_ref(), &IntegralOptions::default());
        assert!((m.value - PI).abs() <= m.certainty.error() && m.certainty.error() < 1e-5);
        let e = curvature_extremes(q.as_ref(), &SearchOptions::default()).unwrap();
        assert!((e.smallest_radius - 1.0).abs() < 1e-9, "{e:?}");
        let box_ = extent(q.as_ref(), &SearchOptions::default()).unwrap();
        assert!((box_.hull.z.hi - 2.0).abs() < 1e-12 && (box_.hull.x.hi - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_budget_that_is_too_small_is_admitted() {
    let s = sphere(Construction::Angle);
    let few = IntegralOptions {
        budget: 10,
        ..Default::default()
    };
    let m = area(s.as_ref(), &few);
    assert!(m.certainty.error() > 1e-3);
    assert!((m.value - 4.0 * PI).abs() <= m.certainty.error());
}
