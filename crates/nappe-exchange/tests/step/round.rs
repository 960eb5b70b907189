//! What is written is read as what it was.

use crate::{sewn, wave, written};
use nappe::surface::{
    Elementary, Quadric, QuadricOptions, QuadricShape, SurfaceRef, Torus, TorusOptions, bilinear,
};
use nappe::{DVec3, Frame, Units};
use nappe_exchange::step::{self, Schema};
use nappe_exchange::{Document, Item, ItemForm};
use std::sync::Arc;

fn body(d: &Document) -> &nappe::body::Body {
    match &d.items[0].form {
        ItemForm::Body { body, .. } => body,
        other => panic!("no body: {other:?}"),
    }
}

#[test]
fn control_points_knots_names_and_colours_come_back() {
    for (at, size) in [
        (DVec3::ZERO, 1.0),
        (DVec3::new(1e6, -3e5, 7.7), 1e-3),
        (DVec3::ONE, 1e6),
    ] {
        let surface = wave(9, 6, at, size);
        for units in [Units::Millimetre, Units::Inch, Units::Metre] {
            for schema in [Schema::Ap242, Schema::Ap214] {
                let document = sewn(std::slice::from_ref(&surface), units);
                let file = step::read(&written(&document, schema)).unwrap();
                let again = &file.document;
                assert_eq!(again.units, units);
                assert_eq!(again.left_out, []);
                assert_eq!(again.name.as_deref(), Some("name"));
                assert_eq!(again.items[0].name, "it's a \u{3c0}");
                assert_eq!(again.items[0].colour, Some([0.25, 0.5, 0.75]));
                let (old, new) = (surface.to_nurbs().unwrap(), &body(again).faces[0].surface);
                let new = new.to_nurbs().unwrap();
                assert_eq!(old.control_points(), new.control_points());
                assert_eq!(old.basis_u().knots(), new.basis_u().knots());
                assert_eq!(old.basis_v().knots(), new.basis_v().knots());
                assert_eq!(body(again).edges.len(), 4);
                body(again).validate(1e-12 * size.max(1.0)).unwrap();
            }
        }
    }
}

/// Surfaces that close up with their ends, in a frame that is not aligned.
fn primitives() -> Vec<(&'static str, SurfaceRef)> {
    let frame = Frame::new(
        DVec3::new(3.0, -2.0, 5.0),
        DVec3::new(1.0, 2.0, 2.0),
        DVec3::new(2.0, 1.0, -2.0),
    )
    .unwrap();
    let quadric = |shape, axes: &[f64], range| {
        let options = QuadricOptions { frame, range };
        Arc::new(Quadric::new(shape, axes, options).unwrap()) as SurfaceRef
    };
    let options = TorusOptions {
        frame,
        ..TorusOptions::default()
    };
    let [o, x, y] = [frame.origin(), frame.x() * 3.0, frame.y() * 2.0];
    vec![
        ("sphere", quadric(QuadricShape::Sphere, &[2.5], [None; 2])),
        (
            "cylinder",
            quadric(QuadricShape::Cylinder, &[1.5], [None, Some([-1.0, 4.0])]),
        ),
        (
            "half",
            quadric(
                QuadricShape::Cylinder,
                &[1.5],
                [Some([0.3, 2.0]), Some([-1.0, 4.0])],
            ),
        ),
        (
            "cone",
            quadric(
                QuadricShape::Cone,
                &[2.0, 2.0, 3.0],
                [None, Some([0.0, 3.0])],
            ),
        ),
        (
            "cut cone",
            quadric(
                QuadricShape::Cone,
                &[2.0, 2.0, 3.0],
                [None, Some([-3.0, -1.0])],
            ),
        ),
        ("torus", Arc::new(Torus::new(4.0, 1.0, options).unwrap())),
        (
            "plane",
            Arc::new(bilinear([[o, o + y], [o + x, o + x + y]]).unwrap()),
        ),
    ]
}

fn numbers(e: &Elementary) -> (u8, Vec<f64>, DVec3) {
    match e {
        Elementary::Plane { normal, .. } => (0, vec![], *normal),
        Elementary::Cylinder { axis, radius, .. } => (1, vec![*radius], axis.z()),
        Elementary::Cone { axis, slope, .. } => (2, vec![*slope], axis.z()),
        Elementary::Sphere { radius, .. } => (3, vec![*radius], DVec3::ZERO),
        Elementary::Torus {
            axis, major, minor, ..
        } => (4, vec![*major, *minor], axis.z()),
    }
}

#[test]
fn primitives_come_back_as_primitives() {
    for (name, surface) in primitives() {
        let document = sewn(std::slice::from_ref(&surface), Units::Millimetre);
        let bytes = written(&document, Schema::Ap242);
        let text = String::from_utf8_lossy(&bytes);
        assert!(!text.contains("B_SPLINE_SURFACE"), "{name}");
        assert!(!text.contains("B_SPLINE_CURVE"), "{name}");
        let file = step::read(&bytes).unwrap();
        assert_eq!(file.document.left_out, [], "{name}");
        let (old, new) = (body(&document), body(&file.document));
        assert_eq!(old.edges.len(), new.edges.len(), "{name}");
        assert_eq!(old.shells[0].closed, new.shells[0].closed, "{name}");
        let (face, again) = (&old.faces[0], &new.faces[0]);
        assert_eq!(face.loops.len(), again.loops.len(), "{name}");
        let [a, b] = [face, again].map(|f| f.surface.elementary().unwrap());
        let ((ka, na, za), (kb, nb, zb)) = (numbers(&a), numbers(&b));
        assert_eq!(ka, kb, "{name}");
        for (x, y) in na.iter().zip(&nb) {
            assert!((x - y).abs() <= 4e-15 * x.abs(), "{name}: {x} {y}");
        }
        assert!(za.cross(zb).length() <= 4e-15, "{name}");
        // The normal of the face at points of the old one.
        for uv in [[0.2, 0.3], [0.7, 0.6]] {
            let p = face.surface.point(uv);
            let finder =
                nappe::query::Finder::new(std::slice::from_ref(&again.surface), Default::default());
            let found = finder.unwrap().nearest(p).unwrap();
            assert!(
                found.distance <= found.certainty.error() + 1e-13,
                "{name}: {}",
                found.distance
            );
            let normal = |f: &nappe::body::Face, uv| {
                let n = f.surface.jet(uv, Default::default(), 1).normal().unwrap();
                if f.forward { n } else { -n }
            };
            let cosine = normal(face, uv).dot(normal(again, found.uv));
            assert!((cosine - 1.0).abs() < 1e-9, "{name}: {cosine}");
        }
        for e in &new.edges {
            assert!(e.curve.bounds(e.curve.domain()).diagonal() > 0.1, "{name}");
        }
    }
}

/// A cubic spline in a plane.
fn spline(points: &[[i32; 2]]) -> nappe::CurveRef {
    let knots = nappe::basis::BSplineBasis::clamped_uniform(3, points.len());
    let points: Vec<DVec3> = points
        .iter()
        .map(|p| DVec3::new(f64::from(p[0]), f64::from(p[1]), 0.0))
        .collect();
    Arc::new(nappe::NurbsCurve::new(3, knots, &points, None).unwrap())
}

#[test]
fn curves_come_back() {
    use nappe::curve::{Ellipse, EllipseOptions, Line};
    let options = EllipseOptions {
        from: 0.4,
        to: 4.0,
        normal: DVec3::new(1.0, 1.0, 3.0),
        x_direction: None,
    };
    let curves: Vec<nappe::CurveRef> = vec![
        Arc::new(Line::new(DVec3::ONE, DVec3::new(4.0, 5.0, 6.0)).unwrap()),
        Arc::new(Ellipse::circle(DVec3::ONE, 2.0, DVec3::X).unwrap()),
        Arc::new(Ellipse::new(DVec3::ONE, [1.0, 3.0], options).unwrap()),
        // A closed one, and one that ends in its own middle.
        spline(&[[0, 0], [4, 1], [5, 6], [-3, 4], [0, 0]]),
        spline(&[[0, -4], [3, 0], [3, 3], [-3, 3], [-3, 0], [0, -1], [1, 0]]),
    ];
    let item = |c: &nappe::CurveRef| Item {
        name: "c".into(),
        colour: Some([1.0, 0.0, 0.0]),
        form: ItemForm::Curve(c.clone()),
    };
    let document = Document {
        items: curves.iter().map(item).collect(),
        ..Document::default()
    };
    let bytes = written(&document, Schema::Ap214);
    let text = String::from_utf8_lossy(&bytes);
    assert!(text.contains("=LINE(") && text.contains("=CIRCLE(") && text.contains("=ELLIPSE("));
    let file = step::read(&bytes).unwrap();
    assert_eq!(file.document.left_out, []);
    assert_eq!(file.document.items.len(), 5);
    for (old, item) in curves.iter().zip(&file.document.items) {
        assert_eq!(item.colour, Some([1.0, 0.0, 0.0]));
        assert_eq!(item.name, "c");
        let ItemForm::Curve(new) = &item.form else {
            panic!()
        };
        let finder =
            nappe::query::Finder::on_curves(std::slice::from_ref(new), Default::default()).unwrap();
        let d = old.domain();
        for i in 0..=20 {
            let p = old.point(d.lo + (d.hi - d.lo) * f64::from(i) / 20.0);
            let found = finder.nearest(p).unwrap();
            assert!(found.distance <= found.certainty.error() + 1e-13);
        }
        for (a, b) in old.ends().into_iter().zip(new.ends()) {
            assert!(a.distance(b) < 1e-13);
        }
    }
}
