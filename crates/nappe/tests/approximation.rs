//! Approximation by splines: the proven bound holds against dense sampling, and is not far too large.

#![allow(clippy::unwrap_used)]

use nappe::curve::{Curve, CurveRef, Ellipse, JoinOptions, Joined, Line};
use nappe::exact::{
    ApproximationError, Converted, NurbsCurve, NurbsSurface, approximate_curve,
    approximate_surface, to_nurbs_or_approximate, to_nurbs_or_approximate_curve,
};
use nappe::mesh::Certainty;
use nappe::surface::{Dir, Surface, bilinear, ruled};
use nappe::{Box3, Break, DVec3, Interval, Limit, UNIT_BREAKS};
use std::sync::Arc;

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn bound<T>(c: &Converted<T>) -> f64 {
    match c.certainty {
        Certainty::Bounded(e) => e,
        other => panic!("a proven bound, not {other:?}"),
    }
}

fn curve_error(a: &dyn Curve, b: &dyn Curve) -> f64 {
    (0..=5000)
        .map(|i| i as f64 / 5000.0)
        .map(|t| a.point(t).distance(b.point(t)))
        .fold(0.0, f64::max)
}

fn surface_error(a: &dyn Surface, b: &dyn Surface) -> f64 {
    let mut most = 0.0f64;
    for i in 0..=150 {
        for j in 0..=150 {
            let uv = [i as f64 / 150.0, j as f64 / 150.0];
            most = most.max(a.point(uv).distance(b.point(uv)));
        }
    }
    most
}

#[test]
fn circles_are_followed_within_every_tolerance() {
    for s in [1e-6, 1.0, 1e6] {
        for o in [DVec3::ZERO, v(1e3, -2e3, 5e2) * s] {
            let c = Ellipse::circle(o, s, v(1.0, 2.0, 3.0)).unwrap();
            let mut pieces = Vec::new();
            for tol in [1e-2, 1e-5, 1e-9] {
                let a = approximate_curve(&c, tol * s).unwrap();
                let (proven, found) = (bound(&a), curve_error(&c, &a.nurbs));
                assert!(proven <= tol * s, "{proven:e} for {tol:e}");
                assert!(found <= proven, "{found:e} but {proven:e} is claimed");
                // Not a wild overestimate either.
                assert!(
                    proven <= 10.0 * found + 1e-11 * s,
                    "{proven:e} for {found:e}"
                );
                pieces.push(a.nurbs.breaks().len() - 1);
                assert!((a.nurbs.ends()[0] - c.ends()[0]).length() <= 1e-15 * (s + o.length()));
            }
            // Sixth order: 10³ closer takes about 3.2 times the pieces.
            assert!(pieces[2] <= 64 && pieces[0] <= 8, "{pieces:?}");
        }
    }
}

#[test]
fn corners_stay_corners_and_smooth_curves_stay_smooth() {
    let arc = Arc::new(Ellipse::arc(DVec3::ZERO, 1.0, 0.0, 2.0, DVec3::Z).unwrap());
    let line = Arc::new(Line::new(arc.ends()[1], v(3.0, 0.0, 1.0)).unwrap());
    let c = Joined::new(vec![arc, line], JoinOptions::default()).unwrap();
    let a = approximate_curve(&c, 1e-7).unwrap();
    assert!(curve_error(&c, &a.nurbs) <= bound(&a) && bound(&a) <= 1e-7);
    let at = |b: &&Break| b.at == 0.5;
    let breaks = a.nurbs.breaks();
    assert_eq!(breaks.iter().find(at).unwrap().smooth, 0);
    let inner = breaks[1..breaks.len() - 1].iter();
    assert!(inner.filter(|b| b.at != 0.5).all(|b| b.smooth == 2));
    let exact = v(3.0, 0.0, 1.0) - c.point(0.5);
    let got = a.nurbs.jet(0.5, Limit::Above, 1).d[1];
    assert!((got - exact * 2.0).length() < 1e-11);
}

#[test]
fn what_is_exact_is_not_approximated() {
    let line = Line::new(DVec3::ZERO, DVec3::ONE).unwrap();
    let c = to_nurbs_or_approximate_curve(&line, 1e-3).unwrap();
    assert_eq!((c.certainty, c.nurbs.degree()), (Certainty::Exact, 1));
    let flat = bilinear([
        [v(0.0, 0.0, 0.0), v(0.0, 1.0, 0.0)],
        [v(1.0, 0.0, 1.0), v(0.0, 1.0, 1.0)],
    ]);
    let s = to_nurbs_or_approximate(&flat.unwrap(), 1e-3).unwrap();
    assert_eq!(s.certainty, Certainty::Exact);
    // A quintic is its own Hermite interpolant: the proven error is rounding alone.
    let p: Vec<_> = (0..6)
        .map(|i| v(i as f64, (i * i % 5) as f64, 0.5))
        .collect();
    let quintic = NurbsCurve::bezier(&p, None).unwrap();
    let a = approximate_curve(&quintic, 1e-9).unwrap();
    assert!(bound(&a) < 1e-12 && a.nurbs.breaks().len() == 2);
    assert!(curve_error(&quintic, &a.nurbs) < 1e-14);
}

/// A surface between two arcs by their angles: no NURBS form.
fn drum(s: f64, o: DVec3) -> impl Surface {
    let arc = |z: f64, r: f64, to: f64| -> CurveRef {
        Arc::new(Ellipse::arc(o + DVec3::Z * z * s, r * s, 0.0, to, DVec3::Z).unwrap())
    };
    ruled(arc(0.0, 1.0, 3.0), arc(2.0, 0.5, 4.0), Dir::U).unwrap()
}

#[test]
fn surfaces_are_followed_within_every_tolerance() {
    for s in [1e-6, 1.0, 1e6] {
        for o in [DVec3::ZERO, v(1e3, -2e3, 5e2) * s] {
            let surface = drum(s, o);
            for tol in [1e-2, 1e-5, 1e-8] {
                let a = to_nurbs_or_approximate(&surface, tol * s).unwrap();
                let (proven, found) = (bound(&a), surface_error(&surface, &a.nurbs));
                assert!(proven <= tol * s, "{proven:e} for {tol:e}");
                assert!(found <= proven, "{found:e} but {proven:e} is claimed");
                assert_eq!(
                    a.nurbs.breaks(Dir::V).len(),
                    2,
                    "straight lines need no split"
                );
            }
        }
    }
}

/// A surface curved in both directions that is a product of sines: all mixed derivatives count.
#[derive(Debug)]
struct Waves {
    enclosed: bool,
}

impl Surface for Waves {
    fn breaks(&self, _: Dir) -> &[Break] {
        &UNIT_BREAKS
    }
    fn jet_into(&self, [u, v]: [f64; 2], _: [Limit; 2], order: usize, out: &mut [DVec3]) {
        out.fill(DVec3::ZERO);
        let d = |t: f64, w: f64, k: usize| {
            w.powi(k as i32) * (w * t + k as f64 * 0.5 * std::f64::consts::PI).sin()
        };
        for n in 0..=order {
            for j in 0..=n {
                let k = nappe::surface::jet_index(n - j, j);
                out[k].z = d(u, 3.0, n - j) * d(v, 5.0, j);
            }
        }
        out[0] += DVec3::new(u, v, 0.0);
        if order > 0 {
            out[1].x = 1.0;
            out[2].y = 1.0;
        }
    }
    fn enclose_piece(&self, [u, v]: [Interval; 2], _: [Limit; 2], order: usize, out: &mut [Box3]) {
        out.fill(if self.enclosed {
            Box3::ZERO
        } else {
            Box3::ENTIRE
        });
        if !self.enclosed {
            return;
        }
        let d = |t: Interval, w: f64, k: usize| {
            let x = Interval::point(w) * t;
            let cycle = [x.sin(), x.cos(), -x.sin(), -x.cos()];
            Interval::point(w).powi(k as i32) * cycle[k % 4]
        };
        for n in 0..=order {
            for j in 0..=n {
                let k = nappe::surface::jet_index(n - j, j);
                out[k].z = d(u, 3.0, n - j) * d(v, 5.0, j);
            }
        }
        (out[0].x, out[0].y) = (u, v);
        if order > 0 {
            (out[1].x, out[2].y) = (Interval::ONE, Interval::ONE);
        }
    }
}

#[test]
fn doubly_curved_surfaces_are_followed_and_more_so_where_needed() {
    for tol in [1e-2, 1e-4, 1e-7] {
        let s = Waves { enclosed: true };
        let a = approximate_surface(&s, tol).unwrap();
        let (proven, found) = (bound(&a), surface_error(&s, &a.nurbs));
        assert!(
            found <= proven && proven <= tol,
            "{found:e} {proven:e} {tol:e}"
        );
        assert!(proven <= 60.0 * found, "{proven:e} for {found:e}");
        let n = |d| a.nurbs.breaks(d).len();
        assert!(n(Dir::U) <= n(Dir::V), "five waves need more than three");
    }
}

#[test]
fn what_cannot_be_enclosed_is_estimated() {
    let s = Waves { enclosed: false };
    let a: Converted<NurbsSurface> = approximate_surface(&s, 1e-5).unwrap();
    let Certainty::Estimated(e) = a.certainty else {
        panic!("{:?}", a.certainty)
    };
    assert!(e <= 1e-5 && surface_error(&s, &a.nurbs) <= 2e-5);
}

/// `(t, √t)`: no derivative at 0.
#[derive(Debug)]
struct Nose;

impl Curve for Nose {
    fn breaks(&self) -> &[Break] {
        &UNIT_BREAKS
    }
    fn jet_into(&self, t: f64, _: Limit, out: &mut [DVec3]) {
        let mut c = 1.0;
        for (k, o) in out.iter_mut().enumerate() {
            let x = [t, 1.0, 0.0][k.min(2)];
            *o = v(x, c * t.powf(0.5 - k as f64), 0.0);
            c *= 0.5 - k as f64;
        }
    }
    fn enclose_piece(&self, t: Interval, _: Limit, out: &mut [Box3]) {
        let mut c = Interval::ONE;
        let mut power = t.sqrt();
        for (k, o) in out.iter_mut().enumerate() {
            let x = [t, Interval::ONE, Interval::ZERO][k.min(2)];
            *o = Box3 {
                x,
                y: c * power,
                z: Interval::ZERO,
            };
            c = c * Interval::point(0.5 - k as f64);
            power = power / t;
        }
    }
}

#[test]
fn a_nose_without_derivative_is_followed_and_estimated() {
    let a = approximate_curve(&Nose, 1e-3).unwrap();
    let Certainty::Estimated(e) = a.certainty else {
        panic!("{:?}", a.certainty)
    };
    assert!(e <= 1e-3 && curve_error(&Nose, &a.nurbs) <= 1e-3, "{e:e}");
    assert!(a.nurbs.breaks().len() < 60);
}

#[test]
fn bad_requests_are_named() {
    let line = Line::new(DVec3::ZERO, DVec3::ONE).unwrap();
    for tol in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            approximate_curve(&line, tol),
            Err(ApproximationError::Tolerance { .. })
        ));
    }
    let other = Line::new(v(1.0, 1.0, 1.001), DVec3::ZERO).unwrap();
    let options = JoinOptions {
        tol: Some(0.1),
        ..Default::default()
    };
    let jump = Joined::new(vec![Arc::new(line), Arc::new(other)], options).unwrap();
    assert_eq!(
        approximate_curve(&jump, 1e-3).unwrap_err(),
        ApproximationError::Jump { at: 0.5 }
    );
    // A tolerance below rounding: the result says what it is.
    let far = Ellipse::circle(v(1e9, 0.0, 0.0), 1.0, DVec3::Z).unwrap();
    let a = approximate_curve(&far, 1e-12).unwrap();
    assert!(bound(&a) > 1e-12 && bound(&a) < 1e-4);
}
