//! Total curvature, developability, variation of curvature and rolling balls against closed forms.

#![allow(clippy::unwrap_used)]

use nappe::curve::{CurveRef, ExpressionCurve};
use nappe::exact::NurbsSurface;
use nappe::expr::Expr;
use nappe::measure::{
    Developable, IntegralOptions, Measured, RollingBall, SearchOptions, TotalCurvature,
    curvature_derivative, curvature_extremes, curvature_variation, rolling_balls, total_curvature,
};
use nappe::mesh::Certainty;
use nappe::surface::{
    Construction, Dir, Quadric, QuadricOptions, QuadricShape, Revolution, RevolutionOptions,
    Surface, SurfaceRef, Swapped, Transformed, bilinear, ruled,
};
use nappe::{DAffine3, DMat3, DVec3, Frame, Limit};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn curve(x: &str, y: &str, z: &str) -> CurveRef {
    let bound = |s: &str| Expr::parse(s).unwrap().bind(&["t"], &[]).unwrap();
    Arc::new(ExpressionCurve::new([bound(x), bound(y), bound(z)], [0.0, 1.0]).unwrap())
}

fn revolved(x: &str, z: &str, construction: Construction) -> SurfaceRef {
    let options = RevolutionOptions {
        construction,
        angle: TAU,
        ..Default::default()
    };
    Arc::new(Revolution::new(curve(x, "0", z), Frame::WORLD, options).unwrap())
}

fn sphere(construction: Construction) -> SurfaceRef {
    revolved("sin(pi*t)", "cos(pi*t)", construction)
}

fn torus(construction: Construction) -> SurfaceRef {
    revolved("3+cos(2*pi*t)", "-sin(2*pi*t)", construction)
}

fn ellipsoid(axes: [f64; 3]) -> SurfaceRef {
    let shape = QuadricShape::Ellipsoid;
    Arc::new(Quadric::new(shape, &axes, QuadricOptions::default()).unwrap())
}

fn placed(s: &SurfaceRef, scale: f64, shift: DVec3) -> SurfaceRef {
    let turn = DMat3::from_axis_angle(v(1.0, 2.0, -0.5).normalize(), 0.7);
    let map = DAffine3::from_mat3_translation(turn * scale, shift);
    Arc::new(Transformed::new(s.clone(), map).unwrap())
}

const OPTIONS: IntegralOptions = IntegralOptions {
    relative: 1e-3,
    budget: 2000,
};

fn bounded(m: Measured) -> f64 {
    match m.certainty {
        Certainty::Exact => 0.0,
        Certainty::Bounded(e) => e,
        Certainty::Estimated(_) => panic!("{m:?}"),
    }
}

fn assert_near(m: Measured, want: f64, most: f64, name: &str) {
    let e = bounded(m);
    assert!(
        (m.value - want).abs() <= e + 1e-12 * want,
        "{name}: {m:?} for {want}"
    );
    assert!(e <= most, "{name}: {m:?} for {want}");
}

#[test]
fn the_normal_of_closed_surfaces_covers_the_sphere() {
    // By Gauss and Bonnet 4π for what is convex; for a torus once from outside, once from inside.
    for (name, s, want) in [
        ("ellipsoid", ellipsoid([1.0, 2.0, 5.0]), 4.0 * PI),
        ("sphere", sphere(Construction::Angle), 4.0 * PI),
        ("rational sphere", sphere(Construction::Rational), 4.0 * PI),
        ("torus", torus(Construction::Rational), 8.0 * PI),
    ] {
        for (scale, far) in [(1e-6, 0.0), (1.0, 1e3)] {
            let s = placed(&s, scale, v(far, -far, far));
            let TotalCurvature { value, developable } = total_curvature(s.as_ref(), &OPTIONS);
            // Along a line where the sign of K changes only the size of |K| is known.
            assert_near(value, want, 5e-3 * want, name);
            assert_eq!(developable, Developable::No, "{name}");
        }
    }
    // z = xy over a square: the solid angle of (-y, -x, 1), a third of half a sphere.
    let p = [
        [v(-1.0, -1.0, 1.0), v(-1.0, 1.0, -1.0)],
        [v(1.0, -1.0, -1.0), v(1.0, 1.0, 1.0)],
    ];
    let saddle = total_curvature(&bilinear(p).unwrap(), &OPTIONS);
    assert_near(saddle.value, TAU / 3.0, 2.2e-3, "saddle");
}

#[test]
fn developable_surfaces_are_told_from_others() {
    let helix = |s: f64| {
        let c = |f: &str, d: &str| format!("{f}+({s:?})*({d})");
        curve(
            &c("cos(3*t)", "-3*sin(3*t)"),
            &c("sin(3*t)", "3*cos(3*t)"),
            &c("t", "1"),
        )
    };
    let parabola = |z: &str| curve("t", "t^2+0.3*t^3", z);
    let within = [
        (
            "tangents of a helix",
            Arc::new(ruled(helix(0.4), helix(1.3), Dir::V).unwrap()) as SurfaceRef,
        ),
        (
            "cylinder over a cubic",
            Arc::new(ruled(parabola("0"), parabola("2"), Dir::U).unwrap()),
        ),
        ("cone", revolved("2*t", "-5*t", Construction::Angle)),
        (
            "rational cone",
            revolved("2*t", "-5*t", Construction::Rational),
        ),
        ("cylinder", revolved("2", "5*t", Construction::Angle)),
    ];
    for (name, s) in within {
        for (scale, far) in [(1e-6, 0.0), (1e6, 1e3), (1.0, 1e3)] {
            let found = total_curvature(placed(&s, scale, v(far, far, -far)).as_ref(), &OPTIONS);
            let most = match found.developable {
                Developable::Proven => 0.0,
                Developable::Within(most) => most,
                other => panic!("{name}: {other:?} {found:?}"),
            };
            assert!(most <= 1e-8, "{name} at {scale}, {far}: {found:?}");
            assert!(found.value.value <= most + 1e-300, "{name}: {found:?}");
        }
    }
    let plane = bilinear([[DVec3::ZERO, DVec3::Y], [DVec3::X, v(1.0, 1.0, 0.0)]]).unwrap();
    let found = total_curvature(&plane, &OPTIONS);
    assert_eq!(found.developable, Developable::Proven);
    assert_eq!(found.value.certainty, Certainty::Exact);
    // Ruled but not developable, by little.
    let skew = bilinear([[DVec3::ZERO, DVec3::Y], [DVec3::X, v(1.0, 1.0, 1e-3)]]).unwrap();
    let found = total_curvature(&skew, &OPTIONS);
    assert_eq!(found.developable, Developable::No);
    // K is about -(1e-3)² over a square.
    assert!((found.value.value - 1e-6).abs() < 1e-8, "{found:?}");
}

#[test]
fn what_is_folded_is_developable_in_pieces_only() {
    let fold: SurfaceRef = Arc::new(folded(&[[0.0, 1.0], [1.0, 0.0], [2.0, 1.0]]));
    let profile = "min(t, min(1, 3 - t))";
    let can = Revolution::new(
        Arc::new(
            ExpressionCurve::new(
                [profile, "0", "max(0, min(1, t - 1))"]
                    .map(|s| Expr::parse(s).unwrap().bind(&["t"], &[]).unwrap()),
                [0.0, 3.0],
            )
            .unwrap(),
        ),
        Frame::WORLD,
        RevolutionOptions {
            angle: TAU,
            ..Default::default()
        },
    );
    for (name, s) in [
        ("fold", fold),
        ("can", Arc::new(can.unwrap()) as SurfaceRef),
    ] {
        let found = total_curvature(s.as_ref(), &OPTIONS);
        let Developable::InPieces(most) = found.developable else {
            panic!("{name}: {found:?}")
        };
        assert!(most < 1e-6, "{name}: {found:?}");
    }
}

#[test]
fn a_bound_that_says_little_proves_nothing() {
    let options = IntegralOptions {
        relative: 1e-3,
        budget: 20,
    };
    let found = total_curvature(torus(Construction::Angle).as_ref(), &options);
    assert_eq!(found.developable, Developable::Unknown, "{found:?}");
}

/// The integral of |∇II|² from samples over the unit square.
fn sampled_variation(s: &NurbsSurface) -> f64 {
    let n = 200;
    let mut sum = 0.0;
    for i in 0..n {
        for j in 0..n {
            let p = [i, j].map(|k| (k as f64 + 0.5) / n as f64);
            let jet = s.jet(p, [Limit::Above; 2], 3);
            let [a, b, c, d] = curvature_derivative(&jet).unwrap();
            let area = jet.d[1].cross(jet.d[2]).length();
            sum += (a * a + 3.0 * (b * b + c * c) + d * d) * area / (n * n) as f64;
        }
    }
    sum
}

/// The integral of a smooth function by Simpson's rule.
fn simpson(f: impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    const N: usize = 4000;
    let h = (b - a) / N as f64;
    let weight = |k: usize| match k {
        0 | N => 1.0,
        _ => [2.0, 4.0][k % 2],
    };
    (0..=N)
        .map(|k| weight(k) * f(a + h * k as f64))
        .sum::<f64>()
        * h
        / 3.0
}

/// `∫ |∇II|² dA` of a torus: `|∇II|² = 3 (dk/ds)²` with the curvature k across the meridian.
fn torus_variation(major: f64, minor: f64) -> f64 {
    let f = |t: f64| t.sin().powi(2) / (major + minor * t.cos()).powi(3);
    6.0 * PI * major * major / minor * simpson(f, 0.0, TAU)
}

/// Of an ellipsoid with half axes a, a, c: `(dk₁/ds)² + 3 (dk₂/ds)²`.
fn spheroid_variation(a: f64, c: f64) -> f64 {
    let f = |t: f64| {
        let m = (a * a * t.cos().powi(2) + c * c * t.sin().powi(2)).sqrt();
        let dm = (c * c - a * a) * t.sin() * t.cos() / m;
        let k1 = -3.0 * a * c * dm / m.powi(4);
        let k2 = -c * dm / (a * m * m);
        (k1 * k1 + 3.0 * k2 * k2) / m * TAU * a * t.sin()
    };
    simpson(f, 0.0, PI)
}

#[test]
fn the_variation_of_curvature_is_that_of_the_closed_forms() {
    let stretched = DAffine3::from_scale(v(1.0, 1.0, 2.0));
    let by_angle: SurfaceRef =
        Arc::new(Transformed::new(sphere(Construction::Angle), stretched).unwrap());
    for (name, s, want) in [
        (
            "torus",
            torus(Construction::Angle),
            torus_variation(3.0, 1.0),
        ),
        (
            "rational torus",
            torus(Construction::Rational),
            torus_variation(3.0, 1.0),
        ),
        (
            "spheroid",
            ellipsoid([1.0, 1.0, 2.0]),
            spheroid_variation(1.0, 2.0),
        ),
        (
            "flat spheroid",
            ellipsoid([2.0, 2.0, 1.0]),
            spheroid_variation(2.0, 1.0),
        ),
        ("spheroid by angle", by_angle, spheroid_variation(1.0, 2.0)),
    ] {
        for (scale, far) in [(1e-6, 0.0), (1.0, 1e3)] {
            let turned: SurfaceRef = Arc::new(Swapped::new(placed(&s, scale, v(far, -far, far))));
            let found = curvature_variation(turned.as_ref(), &OPTIONS);
            let want = want / (scale * scale);
            assert_near(found, want, 1.1e-2 * want, name);
        }
    }
}

#[test]
fn it_vanishes_for_spheres_cylinders_and_planes() {
    let plane: SurfaceRef =
        Arc::new(bilinear([[DVec3::ZERO, DVec3::Y], [DVec3::X, v(1.0, 1.0, 0.0)]]).unwrap());
    for (name, s) in [
        ("sphere", sphere(Construction::Angle)),
        ("rational sphere", sphere(Construction::Rational)),
        ("cylinder", revolved("2", "5*t", Construction::Rational)),
        ("plane", plane),
    ] {
        for scale in [1e-6, 1e6] {
            let found = curvature_variation(placed(&s, scale, DVec3::ZERO).as_ref(), &OPTIONS);
            assert_near(found, 0.0, 1e-5 / (scale * scale), name);
        }
    }
}

#[test]
fn it_does_not_depend_on_where_the_poles_are() {
    // One ellipsoid with its poles in the ends of each axis in turn. None of these is an umbilic.
    let found = [[1.0, 2.0, 3.0], [2.0, 3.0, 1.0], [3.0, 1.0, 2.0]]
        .map(|axes| curvature_variation(ellipsoid(axes).as_ref(), &OPTIONS));
    for m in &found {
        let room = bounded(*m) + bounded(found[0]);
        assert!((m.value - found[0].value).abs() <= room, "{found:?}");
        assert!(room <= 0.1 * m.value, "{found:?}");
    }
}

#[test]
fn it_does_not_depend_on_which_side_is_a_pole_nor_on_the_parameters() {
    // x = ρ (1 - t²), y = ρ (2t - t²), z = ρ³ b(t) with a cubic b: level at the pole ρ = 0, where ∇II is not 0.
    let plan = [[1.0, 0.0], [1.0, 2.0 / 3.0], [2.0 / 3.0, 1.0], [0.0, 1.0]];
    let cubic = [1.0, -0.5, 0.7, -1.0];
    let net: Vec<[DVec3; 4]> = (0..4)
        .map(|i| {
            let rho = f64::from(i) / 3.0;
            std::array::from_fn(|j| {
                let z = if i == 3 { cubic[j] } else { 0.0 };
                v(rho * plan[j][0], rho * plan[j][1], z)
            })
        })
        .collect();
    let over = |lo: f64, hi: f64, upper: bool| {
        let rows: Vec<&[DVec3; 4]> = if upper {
            net.iter().rev().collect()
        } else {
            net.iter().collect()
        };
        let points: Vec<DVec3> = rows.into_iter().flatten().copied().collect();
        let knots = |lo: f64, hi: f64| [[lo; 4], [hi; 4]].concat();
        NurbsSurface::new([3, 3], [knots(lo, hi), knots(0.0, 1.0)], &points, None).unwrap()
    };
    let s = over(0.0, 1.0, false);
    let want = sampled_variation(&s);
    let options = IntegralOptions {
        relative: 1e-4,
        budget: 2000,
    };
    for [lo, hi] in [[0.0, 1.0], [1.0, 2.0], [-3.0, -2.0], [-1.0, 0.0]] {
        for upper in [false, true] {
            let found = curvature_variation(&over(lo, hi, upper), &options);
            let name = format!("{upper} over {lo} to {hi}");
            assert!(
                (found.value - want).abs() <= bounded(found) + 1e-3 * want,
                "{name}: {found:?} {want}"
            );
            assert!(bounded(found) <= 1e-3 * want, "{name}: {found:?}");
        }
    }
}

#[test]
fn it_is_infinite_at_the_tip_of_a_cone_and_open_where_nothing_is_known() {
    let cone = revolved("2*t", "-5*t", Construction::Angle);
    let found = curvature_variation(cone.as_ref(), &OPTIONS);
    assert_eq!(
        (found.value, found.certainty),
        (f64::INFINITY, Certainty::Exact)
    );
    // Without its tip: k = cos α / ρ, so |∇II|² = (3 sin² α) k² / ρ², with the sine and cosine of half the angle.
    let cut = revolved("2*(t+1)", "-5*(t+1)", Construction::Angle);
    let found = curvature_variation(cut.as_ref(), &OPTIONS);
    let slope = 29f64.sqrt();
    let (sin, cos) = (2.0 / slope, 5.0 / slope);
    // dA = 2π ρ dρ / sin α
    let want = 3.0 * sin * cos * cos * TAU * 0.5 * (1.0 / 4.0 - 1.0 / 16.0);
    assert_near(found, want, 1e-2 * want, "frustum");
    let root = revolved("1+t^2.5", "t", Construction::Angle);
    let found = curvature_variation(root.as_ref(), &OPTIONS);
    assert!(
        matches!(found.certainty, Certainty::Estimated(_)),
        "{found:?}"
    );
}

/// The graph of a polynomial of degree 3 in x and in y over [-1, 1]², as a Bézier surface.
fn graph(terms: &[(usize, usize, f64)]) -> NurbsSurface {
    let third = 1.0 / 3.0;
    let powers = [
        [1.0; 4],
        [-1.0, -third, third, 1.0],
        [1.0, -third, -third, 1.0],
        [-1.0, 1.0, -1.0, 1.0],
    ];
    let points: Vec<DVec3> = (0..16)
        .map(|k| {
            let (a, b) = (k / 4, k % 4);
            let z = terms
                .iter()
                .map(|&(i, j, c)| c * powers[i][a] * powers[j][b]);
            v(powers[1][a], powers[1][b], z.sum())
        })
        .collect();
    NurbsSurface::bezier(4, &points, None).unwrap()
}

#[test]
fn the_derivative_of_the_second_form_is_that_of_a_graph() {
    // Where a graph is level, its third derivatives are the components.
    let terms = [
        (2, 0, 0.4),
        (1, 1, -0.3),
        (0, 2, -0.7),
        (3, 0, 0.5),
        (2, 1, -0.2),
        (1, 2, 0.9),
        (0, 3, 0.35),
    ];
    let jet = graph(&terms).jet([0.5, 0.5], [Limit::Above; 2], 3);
    let found = curvature_derivative(&jet).unwrap();
    for (found, want) in found.iter().zip([3.0, -0.4, 1.8, 2.1]) {
        assert!((found - want).abs() < 1e-12, "{found} {want}");
    }
    // And the integral is that of samples of it.
    let s = graph(&terms);
    let sum = sampled_variation(&s);
    let found = curvature_variation(&s, &OPTIONS);
    assert!(
        (found.value - sum).abs() <= bounded(found) + 1e-3 * sum,
        "{found:?} {sum}"
    );
    assert!(bounded(found) <= 1e-2 * sum, "{found:?}");
}

fn balls(s: &dyn Surface) -> [RollingBall; 2] {
    rolling_balls(
        s,
        &curvature_extremes(s, &SearchOptions::default()).unwrap(),
    )
}

/// Folded along lines y = const, through these points (y, z) at parameters 0, 1, 2 …
fn folded(profile: &[[f64; 2]]) -> NurbsSurface {
    let points: Vec<DVec3> = [0.0, 1.0]
        .iter()
        .flat_map(|&x| profile.iter().map(move |p| v(x, p[0], p[1])))
        .collect();
    let mut knots = vec![0.0];
    knots.extend((0..profile.len()).map(|k| k as f64));
    knots.push((profile.len() - 1) as f64);
    NurbsSurface::new([1, 1], [vec![0.0, 0.0, 1.0, 1.0], knots], &points, None).unwrap()
}

#[test]
fn no_ball_fits_into_a_crease() {
    // The normal points to larger z. A groove, a ridge, and both in one.
    let groove = [[0.0, 1.0], [1.0, 0.0], [2.0, 1.0]];
    let ridge = [[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]];
    let both = [[0.0, 0.0], [1.0, 1.0], [2.0, 0.0], [3.0, 1.0]];
    let inf = f64::INFINITY;
    for (profile, want) in [
        (&groove[..], [0.0, inf]),
        (&ridge, [inf, 0.0]),
        (&both, [0.0, 0.0]),
    ] {
        for scale in [1e-6, 1.0, 1e6] {
            let s: SurfaceRef = Arc::new(folded(profile));
            for s in [
                placed(&s, scale, v(1e3, -1e3, 0.0)),
                Arc::new(Swapped::new(placed(&s, scale, DVec3::ZERO))) as SurfaceRef,
            ] {
                let found = balls(s.as_ref());
                // Exchanged parameters turn the normal over.
                let turned = s.breaks(Dir::U).len() > 2;
                for (k, ball) in found.iter().enumerate() {
                    let want = want[if turned { 1 - k } else { k }];
                    assert_eq!(ball.radius, want, "{profile:?} {found:?}");
                    let enough = if want == 0.0 {
                        ball.at_least == 0.0
                    } else {
                        ball.at_least > 1e3 * scale
                    };
                    assert!(enough, "{profile:?} {found:?}");
                }
                if want == [0.0, 0.0] {
                    let across = usize::from(!turned);
                    let places = found.map(|b| b.uv[across]);
                    assert_eq!(places, if turned { [1.0, 2.0] } else { [2.0, 1.0] });
                }
            }
        }
    }
}

#[test]
fn balls_roll_on_both_sides() {
    // Normals away from the tube: from outside the smallest concave radius is that of the throat, 2, from inside 1.
    for scale in [1.0, 1e-6, 1e6] {
        let t = placed(&torus(Construction::Angle), scale, DVec3::ZERO);
        let [outside, inside] = balls(t.as_ref());
        for (ball, want) in [(outside, 2.0 * scale), (inside, scale)] {
            assert!((ball.radius - want).abs() < 1e-6 * want, "{ball:?}");
            assert!(
                ball.at_least <= want * (1.0 + 1e-12) && ball.at_least > 0.999 * want,
                "{ball:?}"
            );
        }
    }
    let [outside, inside] = balls(ellipsoid([1.0, 1.0, 2.0]).as_ref());
    assert!(
        outside.radius.is_infinite() && outside.at_least > 1.0,
        "{outside:?}"
    );
    assert!(
        (inside.radius - 0.5).abs() < 1e-6 && inside.at_least > 0.49,
        "{inside:?}"
    );
    // Curvature without bound leaves room for no ball; on the other side nothing is known.
    let cone = revolved("2*t", "-5*t", Construction::Angle);
    let [above, below] = balls(cone.as_ref());
    assert_eq!((below.radius, below.at_least), (0.0, 0.0));
    assert_eq!(above.at_least, 0.0);
}
