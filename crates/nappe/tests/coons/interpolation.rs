//! What a Coons surface keeps of its boundary functions, for every blending.

use super::*;

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
