//! NURBS tools change the data, not the points.

#![allow(clippy::unwrap_used)]

use nappe::basis::{BSplineBasis, KnotError};
use nappe::curve::Curve;
use nappe::exact::{NurbsCurve, NurbsError, NurbsSurface, compatible};
use nappe::surface::{Dir, Surface};
use nappe::{DAffine3, DVec3, Limit, laws};
use proptest::prelude::*;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Agreement to 10⁻¹³ of the size: the points of [`any_curve`] lie within 2.5 of the origin.
const SAME: f64 = 2.5e-13;

/// The largest distance at parameters over the whole domain of b, knots included.
fn apart(a: &NurbsCurve, b: &NurbsCurve) -> f64 {
    let d = b.domain();
    let knots = b.breaks().iter().map(|b| b.at);
    (0..=200)
        .map(|i| (d.lo + (d.hi - d.lo) * i as f64 / 200.0).min(d.hi))
        .chain(knots)
        .map(|t| a.point(t).distance(b.point(t)))
        .fold(0.0, f64::max)
}

fn surfaces_apart(a: &NurbsSurface, b: &NurbsSurface) -> f64 {
    let [du, dv] = b.domain();
    let mut most = 0.0f64;
    for i in 0..=40 {
        for j in 0..=40 {
            let u = du.lo + (du.hi - du.lo) * i as f64 / 40.0;
            let v = dv.lo + (dv.hi - dv.lo) * j as f64 / 40.0;
            most = most.max(a.point([u, v]).distance(b.point([u, v])));
        }
    }
    most
}

fn surface(rational: bool) -> NurbsSurface {
    let mut random = laws::Random(5);
    let points: Vec<_> = (0..42)
        .map(|i| v((i / 6) as f64, (i % 6) as f64, random.unit()))
        .collect();
    let weights: Vec<_> = (0..42).map(|_| 0.5 + random.unit()).collect();
    let knots = [
        // Unclamped in u.
        (0..11).map(f64::from).collect(),
        vec![0.0, 0.0, 0.0, 1.0, 1.0, 3.0, 4.0, 4.0, 4.0],
    ];
    NurbsSurface::new([3, 2], knots, &points, rational.then_some(&weights[..])).unwrap()
}

/// Curves with repeated and near-equal knots, repeated and collinear points, and weights over many magnitudes.
fn any_curve(spread: f64) -> impl Strategy<Value = NurbsCurve> {
    let step = prop_oneof![Just(0.0), Just(1e-12), Just(1e-6), 0.05f64..2.0];
    let point = prop_oneof![
        Just(v(0.0, 0.0, 0.0)),
        (-1.0f64..1.0).prop_map(|x| v(x, 2.0 * x, -x)),
        prop::array::uniform3(-1.0f64..1.0).prop_map(DVec3::from_array),
    ];
    let weight = prop_oneof![
        Just(1.0),
        (-1.0f64..1.0).prop_map(move |x| 10f64.powf(spread * x))
    ];
    (
        1usize..=5,
        prop::collection::vec(step, 1..8),
        any::<bool>(),
        any::<bool>(),
    )
        .prop_flat_map(move |(p, steps, clamped, rational)| {
            let mut knots = vec![0.0; p + 1];
            if !clamped {
                (0..=p).for_each(|i| knots[i] = i as f64 * 0.3);
            }
            for s in &steps {
                let last = knots[knots.len() - 1];
                let full = knots.iter().filter(|&&k| k == last).count() >= p;
                knots.push(last + if full && *s == 0.0 { 0.5 } else { *s });
            }
            let end = knots[knots.len() - 1] + 0.7;
            (0..=p).for_each(|i| knots.push(if clamped { end } else { end + i as f64 * 0.2 }));
            let n = knots.len() - p - 1;
            let points = prop::collection::vec(point.clone(), n);
            let weights = prop::collection::vec(weight.clone(), n);
            (points, weights).prop_filter_map("knots allowed", move |(points, weights)| {
                let w = rational.then_some(&weights[..]);
                NurbsCurve::new(p, knots.clone(), &points, w).ok()
            })
        })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, ..ProptestConfig::default() })]

    /// Averages only: the points stay to rounding, whatever the knots and weights.
    #[test]
    fn insertion_and_splitting_keep_the_points(c in any_curve(6.0), s in 0.0f64..=1.0) {
        let d = c.domain();
        let t = (d.lo + (d.hi - d.lo) * s).clamp(d.lo, d.hi);
        if c.knots().iter().filter(|&&k| k == t).count() < c.degree() {
            let more = c.insert_knot(t, 1).unwrap();
            prop_assert!(apart(&c, &more) < SAME);
            prop_assert_eq!(more.knots().len(), c.knots().len() + 1);
            // What was inserted can be removed again, and the curve is as before.
            let less = more.without_knot(t, 1e-9);
            // Beside a near knot removal divides by their distance, and may not be sure.
            if c.knots().iter().all(|k| (k - t).abs() > 1e-2) && !c.is_rational() {
                let less = less.unwrap();
                prop_assert!(apart(&c, &less) <= 1e-9);
                prop_assert_eq!(less.knots().len(), c.knots().len());
            }
        }
        let clamped = c.clamped().unwrap();
        prop_assert!(clamped.basis().is_clamped() && apart(&c, &clamped) < SAME);
        if d.lo < t && t < d.hi {
            for part in c.split(t).unwrap() {
                prop_assert!(part.basis().is_clamped() && apart(&c, &part) < SAME);
            }
        }
        for piece in c.bezier_pieces().unwrap() {
            prop_assert_eq!(piece.homogeneous().len(), c.degree() + 1);
            prop_assert!(apart(&c, &piece) < SAME);
        }
    }

    #[test]
    fn elevation_keeps_the_points(c in any_curve(3.0), by in 1usize..=3) {
        let e = c.elevated(c.degree() + by).unwrap();
        prop_assert_eq!(e.degree(), c.degree() + by);
        prop_assert!(apart(&c, &e) < SAME, "{:e}", apart(&c, &e));
        let inner = |c: &NurbsCurve| c.breaks()[1..c.breaks().len() - 1].to_vec();
        prop_assert_eq!(inner(&c), inner(&e));
    }

    #[test]
    fn reversal_and_domains_map_linearly(c in any_curve(6.0)) {
        let d = c.domain();
        let at = |i: usize| (d.lo + (d.hi - d.lo) * i as f64 / 50.0).min(d.hi);
        // Mirrored parameters and knots are rounded: where the curve is steep that moves its points.
        let steep = (0..=50)
            .map(|i| c.jet(at(i), Limit::Above, 1).d[1].length())
            .fold(0.0, f64::max);
        let narrow = c.breaks().windows(2).any(|w| w[1].at - w[0].at < 1e-2);
        if let (Ok(r), false) = (c.reversed(), narrow) {
            for i in 0..=50 {
                let (t, p) = (at(i), c.point(at(i)));
                let q = r.point((d.lo + (d.hi - t)).min(d.hi));
                prop_assert!(q.distance(p) < SAME + 4e-15 * steep);
            }
        }
        if let Ok(unit) = c.on_domain(0.0, 1.0) {
            prop_assert_eq!((unit.domain().lo, unit.domain().hi), (0.0, 1.0));
            prop_assert!(unit.ends()[0].distance(c.ends()[0]) < SAME);
        }
    }

    #[test]
    fn a_common_weight_factor_changes_nothing(c in any_curve(6.0), factor in -6.0f64..6.0) {
        let f = 10f64.powf(factor);
        let w: Vec<f64> = c.weights().iter().map(|w| w * f).collect();
        let scaled = NurbsCurve::new(c.degree(), c.knots().to_vec(), &c.control_points(), Some(&w)).unwrap();
        prop_assert!(apart(&c, &scaled) < SAME);
    }

    #[test]
    fn compatible_curves_share_their_knots(a in any_curve(1.0), b in any_curve(1.0)) {
        let a = a.on_domain(0.0, 1.0);
        let b = b.on_domain(0.0, 1.0);
        prop_assume!(a.is_ok() && b.is_ok());
        let (a, b) = (a.unwrap(), b.unwrap());
        // Knots that differ by rounding become one, which moves points where the curve is very steep.
        let narrow = |c: &NurbsCurve| c.breaks().windows(2).any(|w| w[1].at - w[0].at < 1e-3);
        // Knots apart by rounding only may be too many together: then an error says so.
        if let Ok(c) = compatible(&[a.clone(), b.clone()]) {
            prop_assert_eq!(c[0].knots(), c[1].knots());
            prop_assert_eq!(c[0].degree(), a.degree().max(b.degree()));
            let moved = apart(&a, &c[0]).max(apart(&b, &c[1]));
            prop_assert!(narrow(&a) || narrow(&b) || moved < 1e-12);
        }
    }
}

#[test]
fn knots_that_matter_stay() {
    let points: Vec<_> = (0..6).map(|i| v(i as f64, (i % 2) as f64, 0.0)).collect();
    let c = NurbsCurve::new(3, BSplineBasis::clamped_uniform(3, 6), &points, None).unwrap();
    assert!(c.without_knot(1.0 / 3.0, 1e-6).is_none());
    assert!(c.without_knot(0.123, 1e-6).is_none() && c.without_knot(0.0, 1.0).is_none());
    // Within a coarse tolerance it may go, and the curve moves by less than that.
    let less = c.without_knot(1.0 / 3.0, 2.0).unwrap();
    let moved = apart(&c, &less);
    assert!(moved > 1e-3 && moved <= 2.0, "{moved}");
}

#[test]
fn inserted_knots_of_rational_curves_can_be_removed() {
    let h = 0.5f64.sqrt();
    let arc = NurbsCurve::bezier(
        &[DVec3::X, v(1.0, 1.0, 0.0), DVec3::Y],
        Some(&[1.0, h, 1.0]),
    );
    let arc = arc.unwrap();
    let more = arc.refined(&[0.3, 0.7, 0.7]).unwrap();
    assert!(apart(&arc, &more) < 1e-15);
    let mut less = more;
    for t in [0.7, 0.3, 0.7] {
        less = less.without_knot(t, 1e-12).unwrap();
    }
    assert_eq!(less.knots(), arc.knots());
    assert!(apart(&arc, &less) < 1e-14);
}

#[test]
fn elevation_of_a_bezier_curve_is_the_table() {
    let c = NurbsCurve::bezier(
        &[v(0.0, 0.0, 0.0), v(3.0, 6.0, 0.0), v(6.0, 0.0, 0.0)],
        None,
    );
    let e = c.unwrap().elevated(3).unwrap();
    let want = [
        v(0.0, 0.0, 0.0),
        v(2.0, 4.0, 0.0),
        v(4.0, 4.0, 0.0),
        v(6.0, 0.0, 0.0),
    ];
    for (p, q) in e.control_points().iter().zip(want) {
        assert!((*p - q).length() < 1e-15);
    }
}

#[test]
fn surface_tools_keep_the_points() {
    for rational in [false, true] {
        let s = surface(rational);
        let same = |t: &NurbsSurface| assert!(surfaces_apart(&s, t) < 1e-13 * 7.0);
        same(&s.insert_knot(Dir::U, 3.5, 3).unwrap());
        same(&s.insert_knot(Dir::V, 0.25, 1).unwrap());
        same(&s.refined(Dir::V, &[2.0, 0.5, 2.0]).unwrap());
        same(&s.elevated([4, 2]).unwrap());
        same(&s.elevated([5, 5]).unwrap());
        let clamped = s.clamped().unwrap();
        same(&clamped);
        assert!(clamped.basis_u().is_clamped() && clamped.basis_v().is_clamped());
        same(&s.part([3.25, 6.5], [0.5, 3.5]).unwrap());
        for dir in [Dir::U, Dir::V] {
            s.split(dir, 3.5).unwrap().iter().for_each(same);
            let [du, dv] = s.domain();
            let r = s.reversed(dir).unwrap();
            let x = s.isocurve(dir, 3.5, Limit::Above);
            for i in 0..=20 {
                let f = i as f64 / 20.0;
                let uv = [du.lo + (du.hi - du.lo) * f, dv.lo + (dv.hi - dv.lo) * f * f];
                let mirrored = match dir {
                    Dir::U => [du.lo + du.hi - uv[0], uv[1]],
                    Dir::V => [uv[0], dv.lo + dv.hi - uv[1]],
                };
                assert!(r.point(mirrored).distance(s.point(uv)) < 1e-12);
                let on = match dir {
                    Dir::U => ([uv[0], 3.5], uv[0]),
                    Dir::V => ([3.5, uv[1]], uv[1]),
                };
                assert!(x.point(on.1).distance(s.point(on.0)) < 1e-13 * 7.0);
            }
        }
        let swapped = s.swapped();
        assert_eq!(swapped.size(), [6, 7]);
        assert!(swapped.point([0.7, 4.0]).distance(s.point([4.0, 0.7])) < 1e-14);
        let pieces = s.bezier_pieces().unwrap();
        assert_eq!(pieces.len(), 4 * 3);
        pieces.iter().for_each(same);
        let unit = s.on_domain([0.0, 1.0], [0.0, 1.0]).unwrap();
        let [du, dv] = s.domain();
        let at = [0.3, 0.6];
        let want = s.point([du.lo + 0.3 * (du.hi - du.lo), dv.lo + 0.6 * (dv.hi - dv.lo)]);
        assert!(unit.point(at).distance(want) < 1e-13);
        let map = DAffine3::from_rotation_z(0.4) * DAffine3::from_scale(v(1.0, -2.0, 3.0));
        let moved = s.transformed(&map);
        assert!(
            moved
                .point([4.0, 1.0])
                .distance(map.transform_point3(s.point([4.0, 1.0])))
                < 1e-13
        );
    }
}

#[test]
fn bad_requests_are_named() {
    let c = NurbsCurve::bezier(&[DVec3::ZERO, DVec3::X, DVec3::Y], None).unwrap();
    assert!(matches!(
        c.insert_knot(1.5, 1),
        Err(NurbsError::Outside { .. })
    ));
    assert!(matches!(
        c.insert_knot(f64::NAN, 1),
        Err(NurbsError::Outside { .. })
    ));
    assert!(matches!(
        c.insert_knot(0.5, 3),
        Err(NurbsError::Knots(KnotError::Multiplicity {
            multiplicity: 3,
            most: 2,
            ..
        }))
    ));
    assert!(matches!(
        c.elevated(1),
        Err(NurbsError::Lower { own: 2, degree: 1 })
    ));
    assert!(matches!(
        c.elevated(1000),
        Err(NurbsError::Knots(KnotError::Degree { degree: 1000 }))
    ));
    assert!(matches!(c.part(0.5, 0.5), Err(NurbsError::Empty { .. })));
    assert!(matches!(c.split(0.0), Err(NurbsError::Empty { .. })));
    assert!(matches!(
        c.on_domain(1.0, f64::INFINITY),
        Err(NurbsError::Empty { .. })
    ));
    let s = surface(true);
    assert!(matches!(
        s.part([0.0, 1.0], [0.0, 1.0]),
        Err(NurbsError::Outside { .. })
    ));
    assert!(s.elevated([2, 2]).is_err());
    assert!(compatible(&[]).unwrap().is_empty());
}

/// Of order 0 it is the isoparametric curve, also of a surface far from the origin; of order 1 the derivative.
#[test]
fn the_derivative_across_of_order_zero_is_the_curve() {
    for weights in [None, Some([1.0, 2.0, 0.7, 1.3, 0.9, 1.1])] {
        let points = [
            (0.0, 0.0),
            (0.0, 1.0),
            (0.0, 2.0),
            (2.0, 0.0),
            (2.0, 1.5),
            (2.0, 3.0),
        ];
        let points = points.map(|(x, y)| v(100.0 + x, y - 50.0, x * y));
        let s = NurbsSurface::bezier(2, &points, weights.as_ref().map(|w| w.as_slice())).unwrap();
        let across = |k: usize| s.cross_derivative(Dir::V, 0.3, Limit::Above, k).unwrap();
        let (line, slope) = (across(0), across(1));
        for k in 0..=20 {
            let t = k as f64 / 20.0;
            let d = s.jet([0.3, t], [Limit::Above; 2], 1);
            assert!(line.point(t).distance(d.point()) <= 1e-12);
            assert!(slope.point(t).distance(d.partial(1, 0)) <= 1e-12);
        }
    }
}

/// Averages of equal weights are equal: rounding makes no polynomial rational, which would cost degrees later.
#[test]
fn tools_keep_polynomials() {
    let s = surface(false);
    let [u, v] = s.domain();
    for k in 0..200 {
        let x = 0.003 + 0.0019 * f64::from(k);
        let at = |d: nappe::Interval, x: f64| d.lo + (d.hi - d.lo) * x;
        let part = s
            .part([at(u, x), at(u, 0.9 - x)], [at(v, x), at(v, 0.8 - x)])
            .unwrap();
        assert!(!part.is_rational(), "{x}");
        let raised = part.elevated([5, 4]).unwrap();
        assert!(!raised.is_rational(), "{x}");
    }
}
