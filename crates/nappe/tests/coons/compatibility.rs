//! Boundary data that does not fit together: the report, and how twists are resolved.

use super::*;

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
