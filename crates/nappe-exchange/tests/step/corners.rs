//! What the standard says and few files use.

use crate::written;
use nappe::body::{Body, figures, sew};
use nappe::surface::{Quadric, QuadricOptions, QuadricShape, SurfaceRef};
use nappe::{CurveRef, DVec3, NurbsCurve, Units};
use nappe_exchange::step::{self, Schema};
use nappe_exchange::{Document, Item, ItemForm, iges};
use std::f64::consts::PI;
use std::sync::Arc;

/// A file with a set of curves, in millimetres and radians unless `units` says otherwise.
fn read(units: &str, data: &str) -> Document {
    let text = format!(
        "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNIT_ASSIGNED_CONTEXT((#2,#3,#4)) REPRESENTATION_CONTEXT('',''));\n{units}\n#5=SHAPE_REPRESENTATION('',(#6),#1);\n#6=GEOMETRIC_CURVE_SET('',(#7));\n{data}\nENDSEC;\nEND-ISO-10303-21;\n"
    );
    step::read(text.as_bytes()).unwrap().document
}

const UNITS: &str = "#2=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.));\n#3=(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.));\n#4=(NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT());";

fn curve(d: &Document, i: usize) -> CurveRef {
    match &d.items[i].form {
        ItemForm::Curve(c) => c.clone(),
        other => panic!("{other:?}"),
    }
}

fn near(a: DVec3, b: DVec3) {
    assert!(a.distance(b) < 1e-14, "{a} {b}");
}

#[test]
fn an_axis_along_x_has_y_as_its_first_direction() {
    let d = read(
        UNITS,
        "#7=TRIMMED_CURVE('',#8,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(1.5707963267948966)),.T.,.PARAMETER.);\n#8=CIRCLE('',#9,2.);\n#9=AXIS2_PLACEMENT_3D('',#10,#11,$);\n#10=CARTESIAN_POINT('',(5.,0.,0.));\n#11=DIRECTION('',(1.,0.,0.));",
    );
    let [a, b] = curve(&d, 0).ends();
    near(a, DVec3::new(5.0, 2.0, 0.0));
    near(b, DVec3::new(5.0, 0.0, 2.0));
}

#[test]
fn one_bad_unit_leaves_the_others_and_is_told() {
    let inches = "#2=(CONVERSION_BASED_UNIT('INCH',#20) LENGTH_UNIT() NAMED_UNIT(#21));\n#20=(LENGTH_MEASURE_WITH_UNIT() MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#22));\n#21=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\n#22=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.));\n#3=(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.));";
    let d = read(
        inches,
        "#7=TRIMMED_CURVE('',#8,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(3.)),.T.,.PARAMETER.);\n#8=LINE('',#9,#10);\n#9=CARTESIAN_POINT('',(0.,0.,0.));\n#10=VECTOR('',#11,1.);\n#11=DIRECTION('',(1.,0.,0.));",
    );
    assert_eq!(d.units, Units::Inch);
    near(curve(&d, 0).ends()[1], DVec3::X * 3.0);
    assert!(d.left_out[0].why.contains("units"), "{:?}", d.left_out);
    let bad = UNITS.replace(".MILLI.", ".MILLO.");
    let d = read(&bad, "#7=CARTESIAN_POINT('',(0.,0.,0.));");
    assert!(d.left_out[0].why.contains("prefix"), "{:?}", d.left_out);
}

#[test]
fn closed_splines_are_trimmed_through_their_end() {
    // A closed polygon of degree 1: the parameter tells where a point is.
    let ring = "#8=B_SPLINE_CURVE_WITH_KNOTS('',1,(#9,#10,#11,#12,#9),.UNSPECIFIED.,.T.,.F.,(2,1,1,1,2),(0.,1.,2.,3.,4.),.UNSPECIFIED.);\n#9=CARTESIAN_POINT('',(0.,0.,0.));\n#10=CARTESIAN_POINT('',(1.,0.,0.));\n#11=CARTESIAN_POINT('',(1.,1.,0.));\n#12=CARTESIAN_POINT('',(0.,1.,0.));";
    let at = |t: f64| {
        let n = NurbsCurve::new(
            1,
            vec![0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0],
            &[
                DVec3::ZERO,
                DVec3::X,
                DVec3::new(1.0, 1.0, 0.0),
                DVec3::Y,
                DVec3::ZERO,
            ],
            None,
        );
        nappe::Curve::point(&n.unwrap(), t)
    };
    for (from, to, same, middle) in [
        (3.5, 0.5, ".T.", 0.0),
        (0.5, 3.5, ".T.", 2.0),
        (0.5, 3.5, ".F.", 0.0),
        (3.5, 0.5, ".F.", 2.0),
        (0.0, 4.0, ".T.", 2.0),
        (4.0, 0.0, ".F.", 2.0),
        (0.5, 0.5, ".T.", 2.5),
    ] {
        let d = read(
            UNITS,
            &format!(
                "#7=TRIMMED_CURVE('',#8,(PARAMETER_VALUE({from:?})),(PARAMETER_VALUE({to:?})),{same},.PARAMETER.);\n{ring}"
            ),
        );
        assert!(d.left_out.is_empty(), "{:?}", d.left_out);
        let c = curve(&d, 0);
        let [a, b] = c.ends();
        near(a, at(from));
        near(b, at(to));
        let least = (0..=1000)
            .map(|i| c.domain().lo + f64::from(i) / 1000.0 * (c.domain().hi - c.domain().lo))
            .map(|t| c.point(t).distance(at(middle)))
            .fold(f64::MAX, f64::min);
        assert!(least < 0.01, "{from} {to} {same}: {least}");
    }
}

#[test]
fn degrees_beyond_reason_are_refused_before_knots_are_written_out() {
    let d = read(
        UNITS,
        "#7=B_SPLINE_CURVE_WITH_KNOTS('',4000000000,(#8,#9),.UNSPECIFIED.,.F.,.F.,(2000000002,2000000001),(0.,1.),.UNSPECIFIED.);\n#8=CARTESIAN_POINT('',(0.,0.,0.));\n#9=CARTESIAN_POINT('',(1.,0.,0.));",
    );
    assert!(d.items.is_empty());
    assert!(d.left_out[0].why.contains("degree"), "{:?}", d.left_out);
}

#[test]
fn closed_and_looped_splines_come_back() {
    let loops = [
        // Closed, and one that touches itself with its end.
        vec![DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::Y, DVec3::ZERO],
        vec![
            DVec3::ZERO,
            DVec3::X * 2.0,
            DVec3::new(2.0, 1.0, 0.0),
            DVec3::X,
        ],
    ];
    for points in loops {
        let n = points.len();
        let mut knots = vec![0.0, 0.0];
        knots.extend((1..n - 1).map(|i| i as f64));
        knots.extend([(n - 1) as f64; 2]);
        let old = NurbsCurve::new(1, knots, &points, None).unwrap();
        let d = Document {
            items: vec![Item {
                name: "a".into(),
                colour: None,
                form: ItemForm::Curve(Arc::new(old.clone())),
            }],
            ..Document::default()
        };
        let again = step::read(&written(&d, Schema::Ap242)).unwrap().document;
        assert!(again.left_out.is_empty(), "{:?}", again.left_out);
        assert_eq!(again.items[0].name, "a");
        assert_eq!(curve(&again, 0).to_nurbs().unwrap(), old);
    }
}

/// A ball of radius 3 with a hole of radius 1, whose faces say each other way of turning it.
fn hollow(turn_faces: bool) -> Body {
    let ball = |r: f64| {
        let s = Quadric::new(QuadricShape::Sphere, &[r], QuadricOptions::default()).unwrap();
        Arc::new(s) as SurfaceRef
    };
    let mut body = sew(&[ball(3.0), ball(1.0)], 1e-9).body;
    assert_eq!(body.shells.len(), 2);
    if turn_faces {
        let face = body.shells[1].faces[0].0;
        body.faces[face].turn();
    } else {
        body.shells[1].faces.iter_mut().for_each(|f| f.1 = !f.1);
    }
    body
}

fn volumes(d: &Document) -> Vec<Vec<f64>> {
    let mut all = Vec::new();
    for item in &d.items {
        if let ItemForm::Body { body, .. } = &item.form {
            let f = figures(body).unwrap();
            all.push(f.volumes.into_iter().map(|v| v.unwrap().value).collect());
        }
    }
    all
}

#[test]
fn a_hollow_solid_stays_one_in_both_formats() {
    for turn_faces in [false, true] {
        let d = Document {
            items: vec![Item {
                name: String::new(),
                colour: None,
                form: ItemForm::Body {
                    body: hollow(turn_faces),
                    faces: Vec::new(),
                },
            }],
            ..Document::default()
        };
        let bytes = written(&d, Schema::Ap242);
        assert!(String::from_utf8_lossy(&bytes).contains("=BREP_WITH_VOIDS("));
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.igs");
        let options = iges::IgesOptions {
            tolerance: 1e-9,
            trimmed: true,
        };
        iges::write(&path, &d, &options).unwrap();
        let nappe_exchange::Read::Document(igs) = nappe_exchange::read(&path).unwrap() else {
            panic!("no document");
        };
        for again in [step::read(&bytes).unwrap().document, igs] {
            let v = volumes(&again);
            assert_eq!((v.len(), v[0].len()), (1, 2), "{v:?}");
            assert!((v[0][0] - 36.0 * PI).abs() < 1e-5, "{v:?}");
            assert!((v[0][1] + 4.0 / 3.0 * PI).abs() < 1e-6, "{v:?}");
        }
    }
}
