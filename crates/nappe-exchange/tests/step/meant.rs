//! What files mean: units, places, directions, looks.

use crate::{sewn, written};
use nappe::body::{Body, figures, sew};
use nappe::surface::{Quadric, QuadricOptions, QuadricShape, SurfaceRef, bilinear};
use nappe::{CurveRef, DVec3, Frame, Units};
use nappe_exchange::step::{self, Schema, StepOptions};
use nappe_exchange::{Document, Item, ItemForm};
use std::sync::Arc;

/// A file with these entities.
pub(crate) fn file(data: &str) -> String {
    format!("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n{data}\nENDSEC;\nEND-ISO-10303-21;\n")
}

fn read(data: &str) -> Document {
    step::read(file(data).as_bytes()).unwrap().document
}

fn curve(d: &Document, i: usize) -> CurveRef {
    match &d.items[i].form {
        ItemForm::Curve(c) => c.clone(),
        other => panic!("no curve: {other:?}"),
    }
}

fn body(d: &Document) -> &Body {
    match &d.items[0].form {
        ItemForm::Body { body, .. } => body,
        other => panic!("no body: {other:?}"),
    }
}

fn near(a: DVec3, b: [f64; 3]) {
    assert!(a.distance(DVec3::from(b)) < 1e-12, "{a} {b:?}");
}

const LINE: &str = "#1=SHAPE_REPRESENTATION('',(#2),#9);\n#2=GEOMETRIC_SET('',(#5));\n#5=POLYLINE('',(#3,#4));\n\
    #3=CARTESIAN_POINT('',(0.,0.,0.));\n#4=CARTESIAN_POINT('',(1.,0.,0.));\n";

#[test]
fn a_unit_that_cannot_be_read_leaves_the_others() {
    // The solid angle is missing.
    let d = read(&format!(
        "{LINE}#9=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#12,#11,#10))REPRESENTATION_CONTEXT('',''));\n\
         #10=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));\n\
         #11=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));"
    ));
    assert_eq!(d.units, Units::Metre);
    assert_eq!(d.left_out.len(), 1);
    assert_eq!(d.left_out[0].count, 1);
    // A measure of several parts.
    let d = read(&format!(
        "{LINE}#9=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#10))REPRESENTATION_CONTEXT('',''));\n\
         #10=(CONVERSION_BASED_UNIT('INCH',#11)LENGTH_UNIT()NAMED_UNIT(#13));\n\
         #11=(LENGTH_MEASURE_WITH_UNIT()MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#12));\n\
         #12=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n#13=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);"
    ));
    assert_eq!((d.units, d.left_out), (Units::Inch, vec![]));
}

#[test]
fn an_uncertainty_that_cannot_be_is_told_and_not_used() {
    for (x, used) in [("1.E-5", true), ("-1.", false), ("1.E3", false)] {
        let d = read(&format!(
            "{LINE}#9=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#11))\
             GLOBAL_UNIT_ASSIGNED_CONTEXT((#10))REPRESENTATION_CONTEXT('',''));\n\
             #10=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n\
             #11=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({x}),#10,'','');"
        ));
        assert_eq!(d.uncertainty, used.then_some(1e-5));
        assert_eq!(d.left_out.is_empty(), used, "{x}");
        assert_eq!(d.items.len(), 1);
    }
}

#[test]
fn without_a_direction_x_is_the_standards() {
    for (axis, ends) in [
        ("1.,0.,0.", [[0.0, 2.0, 0.0], [0.0, 0.0, 2.0]]),
        ("-1.,0.,0.", [[0.0, 2.0, 0.0], [0.0, 0.0, -2.0]]),
        ("0.,1.,0.", [[2.0, 0.0, 0.0], [0.0, 0.0, -2.0]]),
        ("0.,0.,1.", [[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]]),
    ] {
        let d = read(&format!(
            "#1=SHAPE_REPRESENTATION('',(#2),#9);\n#9=CONTEXT();\n\
             #2=TRIMMED_CURVE('',#3,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(1.5707963267948966)),.T.,.PARAMETER.);\n\
             #3=CIRCLE('',#4,2.);\n#4=AXIS2_PLACEMENT_3D('',#5,#6,$);\n#5=CARTESIAN_POINT('',(0.,0.,0.));\n#6=DIRECTION('',({axis}));"
        ));
        let c = curve(&d, 0);
        for (own, meant) in c.ends().into_iter().zip(ends) {
            near(own, meant);
        }
    }
}

#[test]
fn closed_curves_are_trimmed_through_their_seam() {
    // A square from its corner at the origin; its sides are one long.
    let part = |from: &str, to: &str, sense: &str| {
        let d = read(&format!(
            "#1=SHAPE_REPRESENTATION('',(#2),#9);\n#9=CONTEXT();\n\
             #2=TRIMMED_CURVE('',#3,({from}),({to}),.{sense}.,.PARAMETER.);\n#3=POLYLINE('',(#4,#5,#6,#7,#4));\n\
             #4=CARTESIAN_POINT('',(0.,0.,0.));\n#5=CARTESIAN_POINT('',(1.,0.,0.));\n\
             #6=CARTESIAN_POINT('',(1.,1.,0.));\n#7=CARTESIAN_POINT('',(0.,1.,0.));"
        ));
        assert_eq!(d.left_out, []);
        curve(&d, 0)
    };
    let at = |x: f64| format!("PARAMETER_VALUE({x:?})");
    let (a, b) = ([0.5, 0.0, 0.0], [0.0, 0.5, 0.0]);
    for (from, to, sense, ends, largest) in [
        (3.5, 0.5, "T", [b, a], 0.5),
        (0.5, 3.5, "T", [a, b], 1.0),
        (0.5, 3.5, "F", [a, b], 0.5),
        (3.5, 0.5, "F", [b, a], 1.0),
        (0.0, 0.5, "T", [[0.0; 3], a], 0.5),
        (4.0, 0.5, "T", [[0.0; 3], a], 0.5),
        (0.5, 0.0, "T", [a, [0.0; 3]], 1.0),
        (0.0, 0.0, "T", [[0.0; 3]; 2], 1.0),
        (0.5, 0.5, "F", [a, a], 1.0),
    ] {
        let c = part(&at(from), &at(to), sense);
        let d = c.domain();
        let samples = (0..=400).map(|i| c.point(d.lo + (d.hi - d.lo) * f64::from(i) / 400.0));
        let far = samples.map(|p| p.x.max(p.y)).fold(0.0, f64::max);
        assert!((far - largest).abs() < 1e-12, "{from} {to} {sense}: {far}");
        for (own, meant) in c.ends().into_iter().zip(ends) {
            near(own, meant);
        }
    }
    // Between points, of which the first is the seam.
    let c = part("#4", "#6", "T");
    let middle = c.point(c.domain().mid());
    near(middle, [1.0, 0.0, 0.0]);
    let c = part("#4", "#6", "F");
    near(c.point(c.domain().mid()), [0.0, 1.0, 0.0]);
}

#[test]
fn parts_of_themselves_are_shown_once_and_told() {
    let relation = |id: u32, a: u32, b: u32| {
        format!(
            "#{id}=(REPRESENTATION_RELATIONSHIP('','',#{a},#{b})SHAPE_REPRESENTATION_RELATIONSHIP());\n"
        )
    };
    for data in [
        relation(20, 1, 1),
        format!(
            "{}{}#30=SHAPE_REPRESENTATION('',(),#9);\n",
            relation(20, 1, 30),
            relation(21, 30, 1)
        ),
    ] {
        let d = read(&format!("{LINE}{data}#9=CONTEXT();"));
        assert_eq!(d.items.len(), 1);
        assert_eq!(d.left_out.len(), 1, "{:?}", d.left_out);
        assert!(d.left_out[0].why.contains("a part of itself"));
    }
}

#[test]
fn a_solid_that_no_representation_has_is_told() {
    let d = read("#1=MANIFOLD_SOLID_BREP('',#2);\n#2=CLOSED_SHELL('',());");
    assert_eq!(d.left_out.len(), 1);
    assert_eq!(d.left_out[0].what, "MANIFOLD_SOLID_BREP");
}

#[test]
fn a_part_whose_place_is_not_known_is_not_shown_elsewhere() {
    let d = read(&format!(
        "{LINE}#9=CONTEXT();\n#10=SHAPE_REPRESENTATION('',(),#9);\n\
         #11=(REPRESENTATION_RELATIONSHIP('','',#1,#10)REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#12)SHAPE_REPRESENTATION_RELATIONSHIP());\n\
         #12=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',$,$,#4,1.,$);"
    ));
    assert_eq!(d.items.len(), 0);
    assert_eq!(d.left_out.len(), 1, "{:?}", d.left_out);
}

#[test]
fn an_origin_of_a_map_is_in_the_units_of_what_is_placed() {
    let d = read(
        "#1=SHAPE_REPRESENTATION('',(#2),#30);\n#2=MAPPED_ITEM('',#3,#4);\n#3=REPRESENTATION_MAP(#5,#6);\n\
         #4=AXIS2_PLACEMENT_3D('',#7,$,$);\n#5=AXIS2_PLACEMENT_3D('',#8,$,$);\n#6=SHAPE_REPRESENTATION('',(#11),#31);\n#11=GEOMETRIC_SET('',(#9));\n\
         #7=CARTESIAN_POINT('',(100.,0.,0.));\n#8=CARTESIAN_POINT('',(2.,0.,0.));\n#9=POLYLINE('',(#8,#10));\n\
         #10=CARTESIAN_POINT('',(3.,0.,0.));\n\
         #30=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#32))REPRESENTATION_CONTEXT('',''));\n\
         #31=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#33))REPRESENTATION_CONTEXT('',''));\n\
         #32=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n\
         #33=(CONVERSION_BASED_UNIT('INCH',#34)LENGTH_UNIT()NAMED_UNIT($));\n#34=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#32);",
    );
    assert_eq!(d.left_out, []);
    let [a, b] = curve(&d, 0).ends();
    near(a, [100.0, 0.0, 0.0]);
    near(b, [125.4, 0.0, 0.0]);
}

#[test]
fn a_point_that_cannot_be_read_loses_itself_only() {
    let d = read(
        "#1=SHAPE_REPRESENTATION('',(#2),#9);\n#9=CONTEXT();\n#2=GEOMETRIC_SET('',(#3,#4,#5,#6));\n\
         #3=CARTESIAN_POINT('',(0.,0.,0.));\n#4=CARTESIAN_POINT('',(1.E200,0.,0.));\n\
         #5=CARTESIAN_POINT('',(1.,0.,0.));\n#6=POLYLINE('',(#3,#5));",
    );
    assert_eq!(d.items.len(), 2);
    assert!(
        d.items
            .iter()
            .any(|i| matches!(&i.form, ItemForm::Points(p) if p.len() == 2))
    );
    assert_eq!(d.left_out.len(), 1);
    assert_eq!(d.left_out[0].what, "CARTESIAN_POINT");
}

/// The file of a square.
fn square() -> String {
    let s = bilinear([
        [DVec3::ZERO, DVec3::Y],
        [DVec3::X, DVec3::new(1.0, 1.0, 0.0)],
    ]);
    let surface: SurfaceRef = Arc::new(s.unwrap());
    String::from_utf8(written(&sewn(&[surface], Units::Millimetre), Schema::Ap242)).unwrap()
}

#[test]
fn a_line_that_passes_its_vertices_is_refused() {
    let text = square();
    let at = text.find("=LINE('',#").unwrap() + "=LINE('',".len();
    let end = at + text[at..].find(',').unwrap();
    for z in ["0.5", "0.02"] {
        let moved = format!("{}#99999{}", &text[..at], &text[end..]).replacen(
            "DATA;\n",
            &format!("DATA;\n#99999=CARTESIAN_POINT('',(0.,0.,{z}));\n"),
            1,
        );
        let d = step::read(moved.as_bytes()).unwrap().document;
        assert!(d.items.is_empty(), "{z}");
        let told = d
            .left_out
            .iter()
            .any(|l| l.why.contains("away from its vertex"));
        assert!(told, "{:?}", d.left_out);
    }
}

#[test]
fn the_colour_of_a_body_is_that_of_its_surfaces() {
    let text = square();
    let black = "#90001=CURVE_STYLE('',$,$,#90002);\n#90002=COLOUR_RGB('',0.,0.,0.);\n";
    let text = text
        .replacen("DATA;\n", &format!("DATA;\n{black}"), 1)
        .replace(
            "PRESENTATION_STYLE_ASSIGNMENT((",
            "PRESENTATION_STYLE_ASSIGNMENT((#90001,",
        );
    let d = step::read(text.as_bytes()).unwrap().document;
    assert_eq!(d.items[0].colour, Some([0.25, 0.5, 0.75]));
    let hidden = text.replacen("DATA;\n", "DATA;\n#90003=INVISIBILITY(());\n", 1);
    let d = step::read(hidden.as_bytes()).unwrap().document;
    assert_eq!(d.left_out[0].what, "INVISIBILITY");
}

fn sphere(radius: f64) -> SurfaceRef {
    let options = QuadricOptions {
        frame: Frame::along(DVec3::new(5.0, 1.0, 2.0), DVec3::X).unwrap(),
        range: [None; 2],
    };
    Arc::new(Quadric::new(QuadricShape::Sphere, &[radius], options).unwrap())
}

fn with(form: ItemForm) -> Document {
    Document {
        items: vec![Item {
            name: "a".into(),
            colour: None,
            form,
        }],
        ..Document::default()
    }
}

#[test]
fn a_hollow_whose_faces_point_into_it_is_one_solid_with_its_shell() {
    let mut hollow = sew(&[sphere(3.0), sphere(1.0)], 1e-9).body;
    let volume = |b: &Body| -> Vec<f64> {
        let volumes = figures(b).unwrap().volumes;
        volumes.into_iter().map(|v| v.unwrap().value).collect()
    };
    for (i, sign) in [1.0, -1.0].into_iter().enumerate() {
        // By the faces alone: the shells take them as they are.
        let (face, _) = hollow.shells[i].faces[0];
        hollow.shells[i].faces[0].1 = true;
        if volume(&hollow)[i] * sign < 0.0 {
            hollow.faces[face].turn();
        }
    }
    let before = volume(&hollow);
    let ball = 4.0 / 3.0 * std::f64::consts::PI;
    assert!((before[0] - 27.0 * ball).abs() < 1e-6 && (before[1] + ball).abs() < 1e-6);
    let faces = Vec::new();
    let mut d = with(ItemForm::Body {
        body: hollow,
        faces,
    });
    // Also once more, from what was read.
    for _ in 0..2 {
        let text = String::from_utf8(written(&d, Schema::Ap242)).unwrap();
        assert!(text.contains("=BREP_WITH_VOIDS(") && !text.contains("MANIFOLD_SOLID_BREP"));
        d = step::read(text.as_bytes()).unwrap().document;
        assert_eq!((d.items.len(), &d.left_out[..]), (1, &[][..]));
        let after = volume(body(&d));
        for (a, b) in before.iter().zip(&after) {
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
        // Those who look at the shells alone see the hollow too.
        assert!(body(&d).shells[1].faces.iter().all(|f| !f.1));
    }
}

#[test]
fn numbers_that_are_not_finite_and_nothing_are_not_written() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.step");
    let options = StepOptions {
        schema: Schema::Ap242,
        tolerance: 1e-6,
    };
    for points in [vec![], vec![DVec3::NAN], vec![DVec3::X, DVec3::INFINITY]] {
        let d = with(ItemForm::Points(points));
        assert!(step::write(&path, &d, &options).is_err());
        assert!(!path.exists());
    }
}

#[test]
fn a_face_without_loops_gets_a_bound() {
    let bare = |surface: SurfaceRef| {
        let mut body = sew(&[surface], 1e-9).body;
        body.faces[0].loops.clear();
        with(ItemForm::Body {
            body,
            faces: Vec::new(),
        })
    };
    let d = bare(sphere(2.0));
    let text = String::from_utf8(written(&d, Schema::Ap242)).unwrap();
    assert!(!text.contains("ADVANCED_FACE('',(),"));
    let again = step::read(text.as_bytes()).unwrap().document;
    let area = figures(body(&again)).unwrap().areas[0].clone().unwrap();
    assert!((area.value - 16.0 * std::f64::consts::PI).abs() < 1e-6);
    // An open one has no such bound.
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.step");
    let s = bilinear([[DVec3::ZERO, DVec3::Y], [DVec3::X, DVec3::ONE]]);
    let options = StepOptions {
        schema: Schema::Ap242,
        tolerance: 1e-6,
    };
    assert!(step::write(&path, &bare(Arc::new(s.unwrap())), &options).is_err());
}

#[test]
fn a_circle_of_another_radius_is_refused_whatever_the_uncertainty() {
    let options = QuadricOptions {
        range: [None, Some([-1.0, 4.0])],
        ..QuadricOptions::default()
    };
    let surface = Quadric::new(QuadricShape::Cylinder, &[1.5], options).unwrap();
    let document = sewn(&[Arc::new(surface)], Units::Millimetre);
    let text = String::from_utf8(written(&document, Schema::Ap242)).unwrap();
    let at = text.find("LENGTH_MEASURE(").unwrap() + "LENGTH_MEASURE(".len();
    let end = at + text[at..].find(')').unwrap();
    let vague = format!("{}0.01{}", &text[..at], &text[end..]);
    for (radius, faces) in [("1.5);", 1), ("1.505);", 1), ("1.9);", 0), ("9.);", 0)] {
        let text = vague
            .lines()
            .map(|l| {
                if l.contains("=CIRCLE(") {
                    format!("{},{radius}", &l[..l.rfind(',').unwrap()])
                } else {
                    l.to_owned()
                }
            })
            .collect::<Vec<_>>()
            .join("\n");
        let d = step::read(text.as_bytes()).unwrap().document;
        assert_eq!(d.items.len(), faces, "{radius} {:?}", d.left_out);
    }
}
