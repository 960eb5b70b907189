//! Faces that are easily taken for what they are not.

use crate::mesh::{Maker, check, near, plane};
use crate::shapes::*;
use nappe::basis::{ExpressionFunctions, FunctionsRef};
use nappe::body::{FaceError, RegionError, mesh};
use nappe::exact::{NurbsCurve, NurbsSurface};
use nappe::expr::Expr;
use nappe::surface::{Core, Elementary, Separable, SurfaceRef, Term};
use nappe::{Certainty, CurveRef, DVec3, Frame, MeshOptions};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

fn functions(texts: &[&str]) -> FunctionsRef {
    let bound = texts
        .iter()
        .map(|t| Expr::parse(t).unwrap().bind(&["t"], &[]).unwrap());
    Arc::new(ExpressionFunctions::new(bound, [0.0, 1.0]).unwrap())
}

/// A sum of products of these: the functions of u, of v, and for each term its two functions and its direction.
fn sum(u: &[&str], v: &[&str], terms: &[(usize, usize, DVec3)]) -> SurfaceRef {
    let terms = terms
        .iter()
        .map(|&(i, j, d)| Term::new(i, j, d.extend(0.0)));
    let core = Core::Terms(terms.collect::<Vec<Term>>());
    Arc::new(Separable::polynomial(
        functions(u),
        functions(v),
        core,
        DVec3::ZERO,
    ))
}

fn options() -> MeshOptions {
    MeshOptions::with_tol(1e-3)
}

/// Eight places where the sides of a tube meet, and gaps between these.
#[test]
fn a_seam_that_is_open_between_samples_is_no_seam() {
    for gap in [0.05, 0.0] {
        let slope = format!("{gap}*sin(8*pi*t)");
        let surface = sum(
            &[
                "cos(2*pi*t)",
                "sin(2*pi*t)",
                "t^2*(3-2*t)*cos(2*pi*t)",
                "t^2*(3-2*t)*sin(2*pi*t)",
                "1",
            ],
            &["1", &slope, "t"],
            &[
                (0, 0, DVec3::X),
                (1, 0, DVec3::Y),
                (2, 1, DVec3::X),
                (3, 1, DVec3::Y),
                (4, 2, DVec3::Z),
            ],
        );
        let mut m = Maker::default();
        m.circle(DVec3::ZERO, DVec3::Z, 1.0);
        m.circle(DVec3::Z, DVec3::Z, 1.0);
        m.on(surface, true, &[&[1], &[-2]]);
        let made = mesh(&m.body, &options()).unwrap();
        if gap > 0.0 {
            assert_eq!(made.failed.len(), 1);
        } else {
            assert_eq!(made.failed, []);
            let Certainty::Bounded(e) = made.mesh.patches[0].deviation else {
                panic!("{:?}", made.mesh.patches[0].deviation)
            };
            assert!(e <= 1e-3);
        }
    }
}

/// A border that runs through one of its own corners would have a vertex that the face beside has not.
#[test]
fn a_loop_that_touches_itself_is_told() {
    let mut m = Maker::default();
    let p = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
    let p = p.map(|[x, y]| v(x, y, 0.0));
    for k in 0..5 {
        m.line(p[k], p[(k + 1) % 5]);
    }
    m.face(plane(DVec3::ZERO, DVec3::Z), true, &[&[1, 2, 3, 4, 5]]);
    let made = mesh(&m.body, &options()).unwrap();
    // By rounding, the corner may also be a little beyond.
    let told = |e: &FaceError| {
        matches!(
            e,
            FaceError::Region(RegionError::Touches { .. } | RegionError::Crosses { .. })
        )
    };
    assert!(
        matches!(&made.failed[..], [(0, e)] if told(e)),
        "{:?}",
        made.failed
    );
    assert!(made.mesh.patches[0].triangles.is_empty());
}

/// Two steep loops around a cylinder, the upper one of many edges where it is low.
#[test]
fn loops_around_are_ordered_by_where_they_are() {
    let axis = Frame::WORLD;
    // z = 3 cos a + h on the unit cylinder: an ellipse.
    let ellipse = |h: f64, from: f64, to: f64| -> CurveRef {
        let options = nappe::curve::EllipseOptions {
            from,
            to,
            normal: v(-3.0, 0.0, 1.0),
            x_direction: Some(v(1.0, 0.0, 3.0)),
        };
        let axes = [10f64.sqrt(), 1.0];
        Arc::new(nappe::curve::Ellipse::new(DVec3::Z * h, axes, options).unwrap())
    };
    let mut m = Maker::default();
    m.edge(ellipse(0.0, 0.0, TAU));
    let count = 60;
    let mut at = vec![0.0];
    at.extend((0..=count).map(|k| PI - 0.5 + k as f64 / count as f64));
    at.push(TAU);
    for w in at.windows(2) {
        m.edge(ellipse(1.0, w[0], w[1]));
    }
    let side = Elementary::Cylinder {
        axis,
        radius: 1.0,
        outward: true,
    };
    let upper: Vec<i32> = (0..at.len() as i32 - 1).rev().map(|k| -(k + 2)).collect();
    m.face(side, true, &[&[1], &upper]);
    let made = check(&m.body, 1e-3, |_, q| q.truncate().length() - 1.0);
    assert_eq!(made.turned_round, []);
    near(crate::mesh::area(&made), TAU, 3e-3);
}

/// An edge of no length at the pole, as some files have it, and a tip that is a little off.
#[test]
fn degenerate_edges_and_tips_that_are_a_little_off() {
    let f = Frame::WORLD;
    let ball = Elementary::Sphere {
        frame: f,
        radius: 1.0,
        outward: true,
    };
    for (off, point) in [(0.0, true), (0.0, false), (1e-5, false)] {
        let mut m = Maker::default();
        let tip = v(off, 0.0, 1.0);
        let east = |a: f64| v(a.cos(), a.sin(), 0.0);
        m.arc(DVec3::ZERO, DVec3::Z, DVec3::X, 1.0, [0.0, 1.0]);
        let meridian = |m: &mut Maker, a: f64| {
            let normal = east(a).cross(DVec3::Z);
            m.arc(DVec3::ZERO, normal, east(a), 1.0, [0.0, 0.5 * PI])
        };
        meridian(&mut m, 1.0);
        meridian(&mut m, 0.0);
        let top = m.body.edges[1].vertices[1];
        assert_eq!(top, m.body.edges[2].vertices[1]);
        m.body.vertices[top].point = tip;
        let loops: &[i32] = if point {
            let knots = vec![0.0, 0.0, 1.0, 1.0];
            let line = NurbsCurve::new(1, knots, &[tip, tip], None).unwrap();
            m.edge(Arc::new(line));
            &[1, 2, 4, -3]
        } else {
            &[1, 2, -3]
        };
        m.face(ball, true, &[loops]);
        let made = mesh(&m.body, &options()).unwrap();
        assert_eq!(made.failed, [], "{off} {point}");
        near(crate::mesh::area(&made), 1.0, 3e-3);
        let error = made.mesh.patches[0].deviation.error();
        assert!((off..=1e-3 + 4.0 * off).contains(&error), "{error:e}");
    }
}

/// A folded sheet whose face ends at a fold, at a scale at which parameters are rounded.
#[test]
fn a_border_along_a_crease_is_not_divided() {
    for s in [1.0, 1e6 / 3.0, 1e-6 / 3.0] {
        let profile = [[0.0, 0.0], [1.0, 0.3], [2.0, 0.0], [3.0, 0.3]];
        let at = |k: usize, y: f64| v(profile[k][0], y, profile[k][1]) * s;
        let points: Vec<DVec3> = (0..4).flat_map(|k| [at(k, 0.0), at(k, 7.0)]).collect();
        let third = 1.0 / 3.0;
        let knots = vec![0.0, 0.0, third, 2.0 * third, 1.0, 1.0];
        let line = vec![0.0, 0.0, 1.0, 1.0];
        let sheet = NurbsSurface::new([1, 1], [knots, line], &points, None).unwrap();
        let mut m = Maker::default();
        let p = [at(1, 1.0), at(2, 1.0), at(2, 6.0), at(1, 6.0)];
        for k in 0..4 {
            m.line(p[k], p[(k + 1) % 4]);
        }
        m.on(Arc::new(sheet), true, &[&[1, 2, 3, 4]]);
        let made = mesh(&m.body, &MeshOptions::with_tol(1e-3 * s)).unwrap();
        assert_eq!(made.failed, []);
        let patch = &made.mesh.patches[0];
        assert!(patch.triangles.len() < 60, "{}", patch.triangles.len());
        let Certainty::Bounded(e) = patch.deviation else {
            panic!("{:?}", patch.deviation)
        };
        assert!(e <= 1e-3 * s);
        near(crate::mesh::area(&made), 5.0 * 1.09f64.sqrt() * s * s, 1e-9);
    }
}
