//! Files of other programs, and short ones with known geometry.

use super::write::{self, IgesOptions, IgesReport};
use crate::document::{Document, Item, ItemForm};
use crate::read::Fault;
use crate::report::Progress;
use crate::samples::beside;
use glam::DVec3;
use nappe::body::{Body, Coedge, Edge, Face, Loop, Shell, Vertex};
use nappe::curve::{Ellipse, Line};
use nappe::surface::bilinear;
use nappe::{Curve, CurveRef};
use std::f64::consts::{PI, TAU};
use std::path::Path;
use std::sync::Arc;

fn read(bytes: &[u8]) -> Result<Document, Fault> {
    super::read(bytes, Progress::default())
}

fn text(document: &Document, options: &IgesOptions) -> Result<(Vec<u8>, IgesReport), String> {
    write::text(document, options, Progress::default())
}

/// A file of the project's own test data.
fn own(name: &str) -> Vec<u8> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data");
    std::fs::read(Path::new(folder).join(name)).unwrap()
}

/// Directory and parameter lines of a file: kind, form, matrix, status and parameters of each entity.
fn file(entities: &[(u32, u32, u32, &str, &str)]) -> Vec<u8> {
    let mut directory = String::new();
    let mut data = String::new();
    let mut line = 1;
    for (i, (kind, form, matrix, status, params)) in entities.iter().enumerate() {
        let d = 2 * i + 1;
        let text = format!("{kind},{params};");
        let chunks: Vec<&[u8]> = text.as_bytes().chunks(64).collect();
        directory += &format!(
            "{kind:8}{line:8}{0:8}{0:8}{0:8}{0:8}{matrix:8}{0:8}{status:>8}D{d:7}\n",
            0
        );
        directory += &format!(
            "{kind:8}{0:8}{0:8}{1:8}{form:8}{0:8}{0:8}{3:8}{0:8}D{2:7}\n",
            0,
            chunks.len(),
            d + 1,
            ""
        );
        for c in &chunks {
            data += &format!("{:<64}{d:8}P{line:7}\n", String::from_utf8_lossy(c));
            line += 1;
        }
    }
    let global = "1H,,1H;,4Htest,,,,32,38,6,308,15,,1.,2,2HMM,1,0.01,,1.D-6;";
    format!(
        "{:<72}S      1\n{global:<72}G      1\n{directory}{data}",
        ""
    )
    .into_bytes()
}

fn curve(d: &Document, i: usize) -> CurveRef {
    match &d.items[i].form {
        ItemForm::Curve(c) => c.clone(),
        other => panic!("{other:?}"),
    }
}

fn body(d: &Document, i: usize) -> &Body {
    match &d.items[i].form {
        ItemForm::Body { body, .. } => body,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_hull_is_within_3e_4_of_its_formula() {
    let d = read(&own("wigley.iges")).unwrap();
    assert!(d.left_out.is_empty(), "{:?}", d.left_out);
    assert_eq!((d.units, d.items.len()), (nappe::Units::Metre, 1));
    let b = body(&d, 0);
    b.validate(1e-9).unwrap();
    assert_eq!((b.faces.len(), b.edges.len()), (1, 4));
    let s = &b.faces[0].surface;
    let [u, v] = s.domain();
    let (mut worst, mut below) = (0.0f64, 0);
    for i in 0..=40 {
        for j in 0..=40 {
            let at = |r: nappe::Interval, k: i32| r.lo + (r.hi - r.lo) * f64::from(k) / 40.0;
            let p = s.point([at(u, i), at(v, j)]);
            if p.z <= 0.0 {
                below += 1;
                let y = 0.125 * (1.0 - (p.x / 1.25).powi(2)) * (1.0 - (p.z / 0.15625).powi(2));
                worst = worst.max((p.y.abs() - y).abs());
            }
        }
    }
    assert!(below > 500 && worst < 3.0e-4, "{below} {worst}");
}

#[test]
fn files_of_other_programs_are_read() {
    // Faces, curves, edges.
    for (name, wanted) in [
        ("hulls-and-wing/goteborg.iges", [3, 0]),
        ("hulls-and-wing/line.iges", [0, 1]),
        ("hulls-and-wing/side.iges", [1, 0]),
        ("hulls-and-wing/wigley.iges", [1, 0]),
        ("hulls-and-wing/wing.iges", [4, 0]),
        ("tigl/D150WithGuides_wing.igs", [8, 0]),
    ] {
        let Some(bytes) = beside(name) else { continue };
        let d = read(&bytes).unwrap();
        let (mut faces, mut curves) = (0, 0);
        for i in &d.items {
            match &i.form {
                ItemForm::Body { body, .. } => {
                    body.validate(1e-5 * size(body)).unwrap();
                    faces += body.faces.len();
                }
                ItemForm::Curve(_) => curves += 1,
                ItemForm::Points(_) => {}
            }
        }
        assert_eq!(
            ([faces, curves], d.left_out.len()),
            (wanted, 0),
            "{name}: {:?}",
            d.left_out
        );
    }
}

fn size(b: &Body) -> f64 {
    let far = b
        .vertices
        .iter()
        .map(|v| v.point.distance(b.vertices[0].point));
    far.fold(0.0, f64::max)
}

#[test]
fn curves_have_their_closed_forms() {
    let d = read(&file(&[
        // A quarter of a circle, turned from z to y by a matrix, and moved.
        (100, 0, 9, "00000000", "0.5,1.,2.,3.,2.,1.,4."),
        (104, 1, 0, "00000000", "0.25,0.,1.,0.,0.,-1.,0.,2.,0.,-2.,0."),
        (104, 2, 0, "00000000", "1.,0.,-1.,0.,0.,-1.,0.,1.25,-0.75,1.25,0.75"),
        (104, 3, 0, "00000000", "1.,0.,0.,0.,-1.,0.,2.,-1.,1.,2.,4."),
        (124, 0, 0, "00010000", "1.,0.,0.,1D1,0.,0.,-1.,0.,0.,1.,0.,0."),
        (112, 0, 0, "00000000", "3,1,3,2,0.,1.,3.,0.,1.,0.,0.,1.,0.,1.,0.,0.,0.,0.,2.,1.,1.,0.,0.,2.,2.,1.,0.,2.,6.,6.,2."),
        (106, 12, 0, "00000000", "2,3,0.,0.,0.,1.,0.,0.,1.,1.,0."),
    ]))
    .unwrap();
    assert!(d.left_out.is_empty(), "{:?}", d.left_out);
    assert_eq!(d.items.len(), 6);
    let at = |i: usize, share: f64| {
        let c = curve(&d, i);
        let r = c.domain();
        c.point(r.lo + share * (r.hi - r.lo))
    };
    for k in 0..=10 {
        let t = f64::from(k) / 10.0;
        let (s, c) = (t * PI / 2.0).sin_cos();
        let p = DVec3::new(11.0 + 2.0 * c, -0.5, 2.0 + 2.0 * s);
        assert!(at(0, t).distance(p) < 1e-14, "{}", at(0, t));
        let p = at(1, t);
        assert!(((p.x / 2.0).powi(2) + p.y * p.y - 1.0).abs() < 1e-14 && p.y >= -1e-15);
        let p = at(2, t);
        assert!((p.x * p.x - p.y * p.y - 1.0).abs() < 1e-14 && p.x >= 1.0);
        let p = at(3, t);
        assert!((p.x * p.x - p.y).abs() < 1e-14 && p.z == 2.0);
        // The spline is x = t, y = 1 + t², z = 2 t³ over [0, 1], then the same cubics expanded at 1.
        let x = 3.0 * t;
        if x <= 1.0 {
            let p = at(4, t);
            assert!(
                p.distance(DVec3::new(x, 1.0 + x * x, 2.0 * x * x * x)) < 1e-13,
                "{p}"
            );
        }
    }
    assert!(at(2, 0.5).distance(DVec3::X) < 1e-14);
    assert!(at(5, 1.0).distance(DVec3::new(1.0, 1.0, 0.0)) < 1e-15);
}

#[test]
fn surfaces_have_their_closed_forms() {
    let d = read(&file(&[
        (110, 0, 0, "00010000", "0.,0.,0.,0.,0.,1."),
        (110, 0, 0, "00010000", "2.,0.,0.,2.,0.,3."),
        (120, 0, 0, "00000000", "1,3,0.,3.14159265358979"),
        (110, 0, 0, "00010000", "0.,0.,0.,1.,0.,0."),
        (110, 0, 0, "00010000", "0.,1.,1.,1.,1.,0."),
        (118, 0, 0, "00000000", "7,9,0,0"),
        (100, 0, 0, "00010000", "0.,0.,0.,1.,0.,1.,0."),
        (122, 0, 0, "00000000", "13,1.,0.,2."),
    ]))
    .unwrap();
    assert!(d.left_out.is_empty(), "{:?}", d.left_out);
    assert_eq!(d.items.len(), 3);
    let surface = |i: usize| body(&d, i).faces[0].surface.clone();
    let grid = |i: usize, check: &dyn Fn(DVec3, f64, f64)| {
        let s = surface(i);
        let [u, v] = s.domain();
        for a in 0..=6 {
            for b in 0..=6 {
                let (a, b) = (f64::from(a) / 6.0, f64::from(b) / 6.0);
                let p = s.point([u.lo + a * (u.hi - u.lo), v.lo + b * (v.hi - v.lo)]);
                check(p, a, b);
            }
        }
    };
    grid(0, &|p, a, b| {
        let (s, c) = (b * PI).sin_cos();
        assert!(
            p.distance(DVec3::new(2.0 * c, 2.0 * s, 3.0 * a)) < 1e-13,
            "{p}"
        );
    });
    grid(1, &|p, a, b| {
        assert!(p.distance(DVec3::new(a, b, b * (1.0 - a))) < 1e-14);
    });
    grid(2, &|p, a, b| {
        let (s, c) = (a * TAU).sin_cos();
        assert!(p.distance(DVec3::new(c + b * 0.0, s, 2.0 * b)) < 1e-13);
    });
}

#[test]
fn parts_are_shown_once_and_subfigures_as_often_as_they_are_placed() {
    let d = read(&file(&[
        (110, 0, 0, "00020200", "0.,0.,0.,1.,0.,0."),
        (308, 0, 0, "00000200", "0,4Hpart,1,1"),
        (408, 0, 0, "00000000", "3,10.,0.,0.,2."),
        (408, 0, 0, "00000000", "3,0.,5.,0."),
        (110, 0, 0, "01000000", "0.,0.,0.,1.,0.,0."),
        (230, 0, 0, "00000000", "0"),
    ]))
    .unwrap();
    assert_eq!(d.items.len(), 2);
    assert_eq!(curve(&d, 0).ends(), [DVec3::X * 10.0, DVec3::X * 12.0]);
    assert_eq!(
        curve(&d, 1).ends(),
        [DVec3::Y * 5.0, DVec3::new(1.0, 5.0, 0.0)]
    );
    assert_eq!(d.items[0].name, "part");
    let left: Vec<&str> = d.left_out.iter().map(|l| l.what.as_str()).collect();
    assert_eq!(left, ["entity 110", "entity 230"]);
    // A subfigure that contains itself ends.
    let d = read(&file(&[
        (308, 0, 0, "00000200", "0,4Hpart,2,3,3"),
        (408, 0, 0, "00000000", "1,1.,0.,0."),
        (408, 0, 0, "00000000", "1,1.,0.,0."),
    ]))
    .unwrap();
    assert!(d.items.is_empty() && !d.left_out.is_empty());
}

#[test]
fn changed_files_end_with_a_result() {
    let bytes = own("side.iges");
    for at in (0..bytes.len()).step_by(7) {
        let _ = read(&bytes[..at]);
        for value in [b' ', b'9', b',', b'-', b'H'] {
            let mut changed = bytes.clone();
            changed[at] = value;
            let _ = read(&changed);
        }
    }
    // Other line ends, and none at all.
    let wanted = format!("{:?}", read(&bytes).unwrap());
    let text = String::from_utf8(bytes).unwrap();
    for other in [
        text.replace('\n', "\r\n"),
        text.replace('\n', "\r"),
        text.replace('\n', ""),
    ] {
        assert_eq!(format!("{:?}", read(other.as_bytes()).unwrap()), wanted);
    }
}

/// Everything of a document that can be compared: kinds of items with names, and all control points, to the bit.
fn told(d: &Document) -> Vec<String> {
    let curve = |c: &CurveRef| {
        let n = c.to_nurbs().unwrap();
        format!("{:?} {:?} {:?}", n.knots(), n.homogeneous(), n.degree())
    };
    let form = |f: &ItemForm| match f {
        ItemForm::Curve(c) => curve(c),
        ItemForm::Points(p) => format!("{p:?}"),
        ItemForm::Body { body, faces } => {
            let surfaces: Vec<String> = body
                .faces
                .iter()
                .map(|f| {
                    let n = f.surface.to_nurbs().unwrap();
                    format!("{:?} {:?} {:?}", n.homogeneous(), n.basis_u(), n.basis_v())
                })
                .collect();
            let edges: Vec<String> = body.edges.iter().map(|e| curve(&e.curve)).collect();
            format!(
                "{surfaces:?} {edges:?} {:?} {:?} {faces:?}",
                body.vertices, body.shells
            )
        }
    };
    d.items
        .iter()
        .map(|i| format!("{} {:?} {}", i.name, i.colour, form(&i.form)))
        .collect()
}

#[test]
fn what_is_written_comes_back_to_the_bit() {
    let options = |trimmed| IgesOptions {
        tolerance: 1e-6,
        trimmed,
    };
    let mut d = read(&own("wigley.iges")).unwrap();
    d.items[0].name =
        "a hull, named at such length that its name goes on in the next line; and more".into();
    d.items[0].colour = Some([0.25, 0.5, 1.0]);
    let (file, report) = text(&d, &options(false)).unwrap();
    assert_eq!(
        (report.certainty, report.bodies),
        (nappe::Certainty::Exact, [0, 1, 0])
    );
    assert!(
        file.split(|b| *b == b'\n')
            .all(|l| l.is_empty() || l.len() == 80)
    );
    let back = read(&file).unwrap();
    assert_eq!((back.units, back.left_out.len()), (d.units, 0));
    assert_eq!(told(&back), told(&d));
    // As single trimmed surfaces the same faces and edges, each edge for itself.
    let (file, report) = text(&d, &options(true)).unwrap();
    assert_eq!(report.bodies, [0, 0, 1]);
    let trimmed = read(&file).unwrap();
    let (a, b) = (body(&trimmed, 0), body(&d, 0));
    assert!(trimmed.left_out.is_empty(), "{:?}", trimmed.left_out);
    assert_eq!((a.faces.len(), a.edges.len()), (1, 4));
    assert_eq!(
        a.faces[0].surface.to_nurbs().unwrap().homogeneous(),
        b.faces[0].surface.to_nurbs().unwrap().homogeneous()
    );
    assert_eq!(trimmed.items[0].name, d.items[0].name);
}

#[test]
fn a_sphere_is_a_solid_and_comes_back_as_one() {
    use nappe::surface::{Quadric, QuadricOptions, QuadricShape};
    let sphere = Quadric::new(QuadricShape::Sphere, &[3.0], QuadricOptions::default()).unwrap();
    let body_of = nappe::body::sew(&[std::sync::Arc::new(sphere)], 1e-6).body;
    assert!(body_of.shells[0].closed);
    let item = |form| crate::Item {
        name: "ball".into(),
        colour: None,
        form,
    };
    let d = Document {
        items: vec![item(ItemForm::Body {
            body: body_of,
            faces: Vec::new(),
        })],
        ..Document::default()
    };
    let options = IgesOptions {
        tolerance: 1e-6,
        trimmed: true,
    };
    let (file, report) = text(&d, &options).unwrap();
    assert_eq!(report.bodies, [1, 0, 0]);
    let back = read(&file).unwrap();
    assert!(back.left_out.is_empty(), "{:?}", back.left_out);
    let b = body(&back, 0);
    b.validate(1e-12).unwrap();
    assert!(b.shells[0].closed);
    assert_eq!(back.items[0].name, "ball");
    assert_eq!(
        b.faces[0].surface.to_nurbs().unwrap().homogeneous(),
        body(&d, 0).faces[0]
            .surface
            .to_nurbs()
            .unwrap()
            .homogeneous()
    );
    // The normal still points out of it.
    let outward = b.faces[0].forward == b.shells[0].faces[0].1;
    let s = &b.faces[0].surface;
    let [u, v] = s.domain();
    let jet = s.jet([u.mid(), v.mid()], [nappe::Limit::Above; 2], 1);
    let normal = jet.d[1].cross(jet.d[2]) * if outward { 1.0 } else { -1.0 };
    assert!(normal.dot(jet.d[0]) > 0.0);
}

#[test]
fn a_mirrored_solid_keeps_its_inside() {
    let volume = |matrix: u32| {
        let d = read(&file(&[
            (110, 0, 0, "00010000", "0.,0.,0.,0.,1.,0."),
            (100, 0, 0, "00010000", "0.,3.,0.,4.,0.,4.,0."),
            (120, 0, 0, "00010000", "1,3,0.,6.28318530717959"),
            (510, 1, 0, "00010000", "5,0,0"),
            (514, 1, 0, "00010000", "1,7,1"),
            (186, 0, matrix, "00000000", "9,1,0"),
            (
                124,
                0,
                0,
                "00010000",
                "-1.,0.,0.,9.,0.,1.,0.,0.,0.,0.,1.,0.",
            ),
        ]))
        .unwrap();
        assert!(d.left_out.is_empty(), "{:?}", d.left_out);
        let found = nappe::body::figures(body(&d, 0)).unwrap();
        found.volumes[0].as_ref().unwrap().value
    };
    let (plain, mirrored) = (volume(0), volume(13));
    // Pappus: the area of the circle times the way of its centre.
    assert!((plain.abs() - 6.0 * PI * PI).abs() < 1e-6, "{plain}");
    assert!((mirrored - plain).abs() < 1e-6, "{mirrored} {plain}");
}

#[test]
fn what_is_cut_short_unused_or_unknown_is_told() {
    let lines = [
        (
            126,
            0,
            0,
            "00000000",
            "1,1,0,0,1,0,0.,0.,1.,1.,1.,1.,0.,0.,0.,1.",
        ),
        (110, 0, 0, "00000300", "0.,0.,0.,1.,0.,0."),
        (100, 0, 0, "00000000", "0.,0.,0.,1.,0.,5.,0."),
        (100, 0, 0, "00000000", "0.,0.,0.,1.,0.,1.,1D-17"),
    ];
    let d = read(&file(&lines)).unwrap();
    let why: Vec<&str> = d.left_out.iter().map(|l| l.why.as_str()).collect();
    assert!(why.len() == 3 && why[0].contains("10 of 12"), "{why:?}");
    assert!(why[1].contains("nothing uses it") && why[2].contains("from its centre"));
    // Ends that differ by rounding are those of a whole circle.
    assert!(
        curve(&d, 0)
            .point(curve(&d, 0).domain().mid())
            .distance(-DVec3::X)
            < 1e-14
    );
    let text = String::from_utf8(file(&lines)).unwrap();
    let other = text.replace("2,2HMM,1,0.01,,", "3,3HFOO,1,.01,,");
    assert_ne!(text, other);
    let d = read(other.as_bytes()).unwrap();
    assert_eq!(
        (d.left_out[0].what.as_str(), d.units),
        ("unit `FOO`", nappe::Units::Inch)
    );
}

#[test]
fn large_entities_placed_many_times_are_refused() {
    let count = 2000;
    let mut spline = format!("{},1,0,0,1,0,0.", count - 1);
    (0..count).for_each(|i| spline += &format!(",{i}."));
    spline += &format!(",{}.", count - 1);
    spline += &",1.".repeat(count);
    (0..count).for_each(|i| spline += &format!(",{i}.,0.,0."));
    let mut texts = vec![(126, spline, "00020200")];
    // Each subfigure places the one before it twice: 2²⁰ curves.
    for level in 0..20 {
        let d = texts.len() * 2 + 1;
        let part = if level == 0 {
            "1,1".to_owned()
        } else {
            format!("2,{},{}", d - 4, d - 2)
        };
        texts.push((308, format!("0,1Ha,{part}"), "00000200"));
        texts.push((408, format!("{d},0.,0.,0."), "00010000"));
        texts.push((
            408,
            format!("{d},0.,0.,1."),
            if level == 19 { "00000000" } else { "00010000" },
        ));
    }
    let entities: Vec<_> = texts
        .iter()
        .map(|(kind, text, status)| (*kind, 0, 0, *status, text.as_str()))
        .collect();
    let d = read(&file(&entities)).unwrap();
    assert!(d.items.len() < 1000, "{}", d.items.len());
    assert!(
        d.left_out
            .iter()
            .any(|l| l.why.contains("out of proportion")),
        "{:?}",
        d.left_out
    );
}

/// A sector of a ring, more than a third of a turn: its arcs are several rational pieces.
#[test]
fn boundaries_of_arcs_come_back() {
    let at = |r: f64, angle: f64| r * DVec3::new(angle.cos(), angle.sin(), 0.0);
    let corners = [at(1.0, 0.0), at(1.0, 2.0), at(0.5, 2.0), at(0.5, 0.0)];
    let arc = |p: [DVec3; 3]| -> CurveRef { Arc::new(Ellipse::through(p).unwrap()) };
    let line = |a, b| -> CurveRef { Arc::new(Line::new(a, b).unwrap()) };
    let curves = [
        arc([corners[0], at(1.0, 1.0), corners[1]]),
        line(corners[1], corners[2]),
        arc([corners[2], at(0.5, 1.0), corners[3]]),
        line(corners[3], corners[0]),
    ];
    let v = |x, y| DVec3::new(x, y, 0.0);
    let plane = bilinear([[v(-2.0, -2.0), v(-2.0, 2.0)], [v(2.0, -2.0), v(2.0, 2.0)]]).unwrap();
    let body = Body {
        vertices: corners.map(|point| Vertex { point }).to_vec(),
        edges: (0..4)
            .map(|i| Edge {
                curve: curves[i].clone(),
                vertices: [i, (i + 1) % 4],
                tolerance: 0.0,
            })
            .collect(),
        faces: vec![Face {
            surface: Arc::new(plane),
            forward: true,
            loops: vec![Loop::Edges(
                (0..4)
                    .map(|edge| Coedge {
                        edge,
                        forward: true,
                    })
                    .collect(),
            )],
        }],
        shells: vec![Shell {
            faces: vec![(0, true)],
            closed: false,
        }],
    };
    let back = trimmed(body);
    let figures = nappe::body::figures(self::body(&back, 0)).unwrap();
    let area = figures.areas[0].as_ref().unwrap().value;
    assert!((area - 0.75).abs() < 1e-9, "{area}");
}

/// A body written as trimmed surfaces and read again.
fn trimmed(body: Body) -> Document {
    let form = ItemForm::Body {
        body,
        faces: Vec::new(),
    };
    let item = Item {
        name: String::new(),
        colour: None,
        form,
    };
    let d = Document {
        items: vec![item],
        ..Document::default()
    };
    let options = IgesOptions {
        tolerance: 1e-9,
        trimmed: true,
    };
    let back = read(&text(&d, &options).unwrap().0).unwrap();
    assert!(back.left_out.is_empty(), "{:?}", back.left_out);
    back
}

/// 144 has no mark for a face against its surface, and takes the first border as the outer one: area, normal and hole of
/// a plate come back however its face is turned and its loops are listed.
#[test]
fn trimmed_surfaces_keep_their_side_and_their_holes() {
    let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
    let corners = corners.map(|[x, y]| DVec3::new(x, y, 0.0));
    let radius = 0.47;
    for (forward, kept, hole_first) in [
        (true, true, false),
        (true, true, true),
        (false, true, true),
        (false, true, false),
        (true, false, true),
        (false, false, true),
    ] {
        let plate = bilinear([[corners[0], corners[3]], [corners[1], corners[2]]]).unwrap();
        let mut vertices: Vec<Vertex> = corners.iter().map(|&point| Vertex { point }).collect();
        let circle = Ellipse::circle(DVec3::new(0.6, 0.5, 0.0), radius, DVec3::Z).unwrap();
        vertices.push(Vertex {
            point: circle.ends()[0],
        });
        let mut edges: Vec<Edge> = (0..4)
            .map(|k| Edge {
                curve: Arc::new(Line::new(corners[k], corners[(k + 1) % 4]).unwrap()),
                vertices: [k, (k + 1) % 4],
                tolerance: 0.0,
            })
            .collect();
        edges.push(Edge {
            curve: Arc::new(circle),
            vertices: [4, 4],
            tolerance: 0.0,
        });
        let coedge = |edge, forward| Coedge { edge, forward };
        let mut loops = vec![
            Loop::Edges((0..4).map(|k| coedge(k, true)).collect()),
            Loop::Edges(vec![coedge(4, false)]),
        ];
        if hole_first {
            loops.reverse();
        }
        let mut face = Face {
            surface: Arc::new(plate),
            forward: true,
            loops,
        };
        if !forward {
            face.turn();
        }
        let back = trimmed(Body {
            vertices,
            edges,
            faces: vec![face],
            shells: vec![Shell {
                faces: vec![(0, kept)],
                closed: false,
            }],
        });
        let b = body(&back, 0);
        let figures = nappe::body::figures(b).unwrap();
        assert!(figures.turned_round.is_empty());
        let area = figures.areas[0].as_ref().unwrap().value;
        let exact = 2.0 - PI * radius * radius;
        assert!((area - exact).abs() < 1e-8, "{area}, not {exact}");
        let face = &b.faces[0];
        let [u, v] = face.surface.domain();
        let jet = face
            .surface
            .jet([u.mid(), v.mid()], [nappe::Limit::Above; 2], 1);
        let up = jet.d[1].cross(jet.d[2]).z > 0.0;
        let seen = (up == face.forward) == b.shells[0].faces[0].1;
        assert_eq!(seen, forward == kept);
    }
}
