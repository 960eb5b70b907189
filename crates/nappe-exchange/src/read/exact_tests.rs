//! Exact geometry of small formats: closed forms, public files, and whatever else bytes can be.

use super::{Read, read_bytes};
use crate::document::{Document, ItemForm};
use crate::samples::beside;
use glam::DVec3;
use nappe::{Curve, CurveRef, SurfaceRef};
use std::f64::consts::{PI, TAU};
use std::path::PathBuf;

fn document(ending: &str, bytes: &[u8]) -> Document {
    match read_bytes(ending, bytes) {
        Ok(Read::Document(d)) => d,
        other => panic!("{other:?}"),
    }
}

fn fault(ending: &str, text: &str) -> String {
    read_bytes(ending, text.as_bytes()).unwrap_err().to_string()
}

fn curve(d: &Document, i: usize) -> CurveRef {
    match &d.items[i].form {
        ItemForm::Curve(c) => c.clone(),
        other => panic!("{other:?}"),
    }
}

fn surface(d: &Document, i: usize) -> SurfaceRef {
    match &d.items[i].form {
        ItemForm::Body { body, .. } => {
            body.validate(1.0).unwrap();
            assert_eq!(body.faces.len(), 1);
            body.faces[0].surface.clone()
        }
        other => panic!("{other:?}"),
    }
}

fn points(d: &Document, i: usize) -> &[DVec3] {
    match &d.items[i].form {
        ItemForm::Points(p) => p,
        other => panic!("{other:?}"),
    }
}

/// Points spread over a curve, its ends included.
fn along(c: &CurveRef) -> Vec<DVec3> {
    let d = c.domain();
    let at = |i: u32| d.lo + (d.hi - d.lo) * f64::from(i) / 200.0;
    (0..=200).map(|i| c.point(at(i))).collect()
}

fn over(s: &SurfaceRef) -> Vec<DVec3> {
    let d = s.domain();
    let at = |k: usize, i: u32| d[k].lo + (d[k].hi - d[k].lo) * f64::from(i) / 20.0;
    (0..21 * 21)
        .map(|n| s.point([at(0, n / 21), at(1, n % 21)]))
        .collect()
}

fn near(a: DVec3, b: DVec3, within: f64) {
    assert!(a.distance(b) <= within, "{a} {b}");
}

/// The least and the greatest value.
fn spread(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::MAX, f64::MIN], |[a, b], x| [a.min(x), b.max(x)])
}

const QUARTER: &str = "\n<!-- before -->\n<?xml version=\"1.0\"?>\n<xml>\n<Geometry type=\"Nurbs\" label=\"arc\">\n<Basis type=\"NurbsBasis\"><Basis type=\"BSplineBasis\">\n<KnotVector degree=\"2\">0 0 0 1 1 1</KnotVector></Basis>\n<weights>1 0.70710678118654757 1</weights></Basis>\n<coefs geoDim=\"2\">1 0 1 1\n0 1</coefs>\n</Geometry>\n<Geometry type=\"TensorBSpline3\"/>\n<MultiPatch/></xml>";

const NET: &str = "<xml><Geometry type=\"TensorBSpline2\"><Basis type=\"TensorBSplineBasis2\"><Basis type=\"BSplineBasis\" index=\"0\"><KnotVector degree=\"1\">0 0 1 2 2</KnotVector></Basis><Basis type=\"BSplineBasis\" index=\"1\"><KnotVector degree=\"1\">0 0 3 3</KnotVector></Basis></Basis><coefs geoDim=\"3\">0 0 0 1 0 0 2 0 5 0 3 0 1 3 0 2 3 0</coefs></Geometry></xml>";

#[test]
fn gismo_curves_and_surfaces_are_their_closed_forms() {
    let d = document("xml", QUARTER.as_bytes());
    assert_eq!(d.items[0].name, "arc");
    for p in along(&curve(&d, 0)) {
        assert!((p.length() - 1.0).abs() < 1e-15, "{p}");
    }
    let what: Vec<&str> = d.left_out.iter().map(|l| l.what.as_str()).collect();
    assert_eq!(what, ["Geometry TensorBSpline3", "MultiPatch"]);
    // The first parameter runs fastest.
    let s = surface(&document("xml", NET.as_bytes()), 0);
    near(s.point([2.0, 0.0]), DVec3::new(2.0, 0.0, 5.0), 0.0);
    near(s.point([0.0, 3.0]), DVec3::new(0.0, 3.0, 0.0), 0.0);
    near(
        s.point([1.5, 1.0]),
        DVec3::new(1.5, 1.0, 2.5 * 2.0 / 3.0),
        1e-15,
    );
}

#[test]
fn public_gismo_files() {
    let file = |name: &str| beside(&format!("gismo/{name}.xml")).map(|b| document("xml", &b));
    let Some(d) = file("quarter_circle") else {
        return;
    };
    for p in along(&curve(&d, 0)) {
        // The weight has nine digits.
        assert!((p.length() - 1.0).abs() < 1e-9 && p.z == 0.0);
    }
    // A whole turn, its circumference as parameter.
    let s = surface(&file("cylinder").unwrap(), 0);
    let radius = s.domain()[0].hi / TAU;
    let axis = (s.point([0.0, 0.0]) + s.point([s.domain()[0].mid(), 0.0])) / 2.0;
    let away = over(&s).into_iter().map(|p| (p - axis).truncate().length());
    let [least, most] = spread(away);
    assert!((least - radius).abs() < 1e-12 && (most - radius).abs() < 1e-12);
    // 40° to either side, radius 25.
    let s = surface(&file("scordelis_lo_roof").unwrap(), 0);
    let (sin, cos) = (40.0 / 180.0 * PI).sin_cos();
    let away = over(&s)
        .into_iter()
        .map(|p| (p.y + 25.0 * sin).hypot(p.z + 25.0 * cos));
    let [least, most] = spread(away);
    assert!(
        (least - 25.0).abs() < 1e-13 && (most - 25.0).abs() < 1e-13,
        "{least} {most}"
    );
    near(s.point([1.0, 0.0]), DVec3::new(50.0, 0.0, 0.0), 1e-14);
    // Not a sphere, which is known of the file.
    let s = surface(&file("quarter_sphere").unwrap(), 0);
    let [least, most] = spread(over(&s).into_iter().map(DVec3::length));
    assert!(
        (10.0 - 1e-5..10.0 + 1e-5).contains(&least) && (most - 10.00247).abs() < 5e-5,
        "{least} {most}"
    );
    let d = file("simple").unwrap();
    assert_eq!(d.items[0].name, "simplesurface");
    near(
        surface(&d, 0).point([1.0, 0.0]),
        DVec3::new(1.0, 0.0, 0.1),
        1e-16,
    );
    let d = file("curve_boundary").unwrap();
    let ends: Vec<[DVec3; 2]> = (0..4).map(|i| curve(&d, i).ends()).collect();
    assert_eq!([ends[0][0], ends[0][1]], [ends[3][0], ends[2][0]]);
    assert_eq!([ends[1][0], ends[1][1]], [ends[3][1], ends[2][1]]);
    let c = curve(&file("bspline3d_curve_01").unwrap(), 0);
    let c = c.to_nurbs().unwrap();
    assert_eq!((c.degree(), c.control_points().len()), (2, 8));
    near(c.control_points()[0], DVec3::new(0.5, 1.875, 0.0), 0.0);
    // Ten points on knots for nine.
    let bytes = beside("gismo/bspline3d_curve_02.xml").unwrap();
    let e = fault("xml", &String::from_utf8(bytes).unwrap());
    assert!(e.contains("line 3") && e.contains("14 knots"), "{e}");
}

#[test]
fn two_teapots_are_one() {
    let (Some(a), Some(b)) = (
        beside("teapot/gismo-teapot.xml"),
        beside("teapot/teapot.bpt"),
    ) else {
        return;
    };
    let (a, b) = (document("xml", &a), document("bpt", &b));
    assert_eq!((a.items.len(), b.items.len()), (32, 32));
    let mut extent = [DVec3::MAX, DVec3::MIN];
    let mut poles = Vec::new();
    for i in 0..32 {
        let [p, q] = [&a, &b].map(|d| surface(d, i).to_nurbs().unwrap());
        assert_eq!(p.control_points(), q.control_points());
        for p in p.control_points() {
            extent = [extent[0].min(p), extent[1].max(p)];
        }
        if let ItemForm::Body { body, .. } = &b.items[i].form
            && body.edges.len() < 4
        {
            poles.push(i + 1);
        }
    }
    near(extent[0], DVec3::new(-3.0, -2.0, 0.0), 0.0);
    near(extent[1], DVec3::new(3.525, 2.0, 3.15), 0.0);
    assert_eq!(poles, [21, 22, 23, 24, 29, 30, 31, 32]);
}

#[test]
fn a_net_of_unequal_degrees() {
    let text = "1\n2 1\n0 0 0\n1 0 2\n2 0 0\n0 1 0\n1 1 0\n2 1 0\n";
    let s = surface(&document("bpt", text.as_bytes()), 0);
    near(s.point([0.5, 0.0]), DVec3::new(1.0, 0.0, 1.0), 1e-15);
    near(s.point([0.5, 1.0]), DVec3::new(1.0, 1.0, 0.0), 1e-15);
}

/// Half the thickness of NACA 0012, with the open trailing edge of the tables.
fn naca(x: f64) -> f64 {
    0.6 * (0.2969 * x.sqrt() + x * (-0.126 + x * (-0.3516 + x * (0.2843 - 0.1015 * x))))
}

/// Tables of the same aerofoil once round and side by side.
fn aerofoils() -> [String; 2] {
    let xs: Vec<f64> = (0..=40)
        .map(|i| 0.5 - 0.5 * (PI * f64::from(i) / 40.0).cos())
        .collect();
    let row = |x: f64, side: f64| format!("{x:.9} {:.9}\n", side * naca(x.max(0.0)));
    let [upper, lower] =
        [1.0, -1.0].map(|side| xs.iter().map(|x| row(*x, side)).collect::<String>());
    let back: String = xs.iter().rev().map(|x| row(*x, 1.0)).collect();
    [
        format!("NACA 0012\n{back}{lower}"),
        format!("NACA 0012\n 41. 41.\n\n{upper}\n{lower}"),
    ]
}

#[test]
fn aerofoils_in_either_order_are_one_curve() {
    let [selig, lednicer] = aerofoils().map(|t| document("dat", t.as_bytes()));
    assert_eq!(
        (selig.items[0].name.as_str(), selig.items.len()),
        ("NACA 0012", 1)
    );
    let [a, b] = [&selig, &lednicer].map(|d| curve(d, 0).to_nurbs().unwrap());
    assert_eq!(a.control_points(), b.control_points());
    near(a.ends()[0], DVec3::new(1.0, naca(1.0), 0.0), 1e-8);
    near(a.ends()[1], DVec3::new(1.0, -naca(1.0), 0.0), 1e-8);
    let worst = along(&curve(&selig, 0))
        .into_iter()
        .map(|p| (p.y.abs() - naca(p.x.max(0.0))).abs());
    let worst = worst.fold(0.0, f64::max);
    assert!(worst < 1e-4, "{worst}");
}

#[test]
fn public_aerofoils() {
    let Some(bytes) = beside("airfoils/naca0012.dat") else {
        return;
    };
    let text = String::from_utf8(bytes).unwrap();
    let d = document("dat", text.as_bytes());
    assert_eq!(d.items[0].name, "Naca 0012 By Naca.exe D. LEDNICER");
    let c = curve(&d, 0).to_nurbs().unwrap();
    let mut knots = c.knots().to_vec();
    knots.dedup();
    // Each row is a point of the curve, in its order, and on the formula within the seven digits of the table.
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|l| l.split_whitespace().map(|w| w.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), knots.len());
    for (t, row) in knots.iter().zip(&rows) {
        let p = c.point(*t);
        near(p, DVec3::new(row[0], row[1], 0.0), 1e-14);
        assert!((p.y.abs() - naca(p.x.max(0.0))).abs() < 1e-6, "{p}");
    }
    for name in [
        "clarky", "dae11", "e387", "naca2412", "naca4412", "s1223", "sc20714",
    ] {
        let d = document("dat", &beside(&format!("airfoils/{name}.dat")).unwrap());
        let [from, to] = curve(&d, 0).ends();
        assert!(
            (from.x - 1.0).abs() < 0.01 && (to.x - 1.0).abs() < 0.01,
            "{name}: {from} {to}"
        );
    }
    let sol = document("dat", &beside("occt/sol2.dat").unwrap());
    assert_eq!(
        (points(&sol, 0).len(), points(&sol, 0)[7]),
        (36, DVec3::new(10.0, 10.0, 2.6))
    );
    let net = document("cpt", &beside("geomdl/ex_surface01.cpt").unwrap());
    assert_eq!((net.items.len(), points(&net, 5).len()), (6, 6));
    let list = document("cpt", &beside("geomdl/interp_ex_curve3d.cpt").unwrap());
    assert_eq!((list.items.len(), points(&list, 0).len()), (1, 51));
    assert_eq!(points(&list, 0)[0], DVec3::new(-22.9223, 22.989, 2.84126));
}

/// A file of edges, one for each curve, each with its range; placed by `place` in the compound.
fn brep(curves: &[(&str, [f64; 2])], locations: &[&str], place: usize) -> String {
    let n = curves.len();
    let mut text = format!(
        "DBRep_DrawableShape\n\nCASCADE Topology V1, (c) Matra-Datavision\nLocations {}\n",
        locations.len()
    );
    for l in locations {
        text += &format!("{l}\n");
    }
    text += &format!("Curve2ds 0\nCurves {n}\n");
    for c in curves {
        text += &format!("{}\n", c.0);
    }
    text += "Polygon3D 0\nPolygonOnTriangulations 0\nSurfaces 0\nTriangulations 0\n\n";
    text += &format!("TShapes {}\n", n + 1);
    for (i, (_, [a, b])) in curves.iter().enumerate() {
        text += &format!(
            "Ed\n 1e-007 1 1 0\n1  {} 0 {a:?} {b:?}\n0\n\n0101000\n*\n",
            i + 1
        );
    }
    text += "Co\n\n1100000\n";
    for i in 0..n {
        text += &format!("+{} 0 ", n + 1 - i);
    }
    text + &format!("*\n\n+1 {place} \n")
}

const FRAME: &str = "1 2 3 0 0 1 1 0 0 0 1 0";

#[test]
fn every_kind_of_brep_curve() {
    let conic = |kind: u32, lengths: &str| format!("{kind} {FRAME} {lengths}");
    let [circle, ellipse, parabola, hyperbola] =
        [(2, "5"), (3, "5 2"), (4, "0.5"), (5, "3 4")].map(|(k, l)| conic(k, l));
    let kinds = [
        ("1 1 1 1 0 0.6 0.8", [-5.0, 10.0]),
        (&circle, [0.5, 2.0]),
        (&ellipse, [0.0, TAU]),
        (&parabola, [-2.0, 3.0]),
        (&hyperbola, [-1.0, 2.0]),
        (
            "6 1 2 1 0 0 1 1 1 0 0.70710678118654757 0 1 0 1",
            [0.0, 1.0],
        ),
        (
            "7 0 1 2 4 5 0 0 0 2 0 0 2 2 0 0 2 0 0 1 1 1 2 1 3 1 4 1",
            [0.0, 4.0],
        ),
        ("7 0 0 1 3 3 0 0 0 1 0 0 1 1 0 0 2 1 1 2 2", [0.5, 1.5]),
        ("8 0 1 1 0 0 0 1 0 0", [0.25, 0.75]),
        ("9 1.5 0 0 1 1 0 0 0 1 0 0", [0.0, 1.0]),
        ("8 0 1 1 0 0 0 1 0 0", [0.25, 1.75]),
    ];
    let d = document("brep", brep(&kinds, &[], 0).as_bytes());
    assert_eq!(d.items.len(), 9, "{:?}", d.left_out);
    let why: Vec<&str> = d.left_out.iter().map(|l| l.why.as_str()).collect();
    assert!(
        why.len() == 2 && why[0].contains("offset") && why[1].contains("0.25 to 1.75"),
        "{why:?}"
    );
    let c = DVec3::new(1.0, 2.0, 3.0);
    let ends = |i: usize, a: DVec3, b: DVec3| {
        let [p, q] = curve(&d, i).ends();
        near(p, a, 1e-14);
        near(q, b, 1e-14);
    };
    ends(0, DVec3::new(1.0, -2.0, -3.0), DVec3::new(1.0, 7.0, 9.0));
    let on = |a: f64, b: f64| c + DVec3::new(a, b, 0.0);
    ends(
        1,
        on(5.0 * 0.5f64.cos(), 5.0 * 0.5f64.sin()),
        on(5.0 * 2f64.cos(), 5.0 * 2f64.sin()),
    );
    for p in along(&curve(&d, 2)) {
        let q = p - c;
        assert!(((q.x / 5.0).powi(2) + (q.y / 2.0).powi(2) - 1.0).abs() < 1e-14);
    }
    // p + t² / 4f x + t y.
    ends(3, on(2.0, -2.0), on(4.5, 3.0));
    for p in along(&curve(&d, 3)) {
        let q = p - c;
        assert!((q.y * q.y - 2.0 * q.x).abs() < 1e-13);
    }
    ends(
        4,
        on(3.0 * 1f64.cosh(), -4.0 * 1f64.sinh()),
        on(3.0 * 2f64.cosh(), 4.0 * 2f64.sinh()),
    );
    for p in along(&curve(&d, 4)) {
        let q = p - c;
        assert!(((q.x / 3.0).powi(2) - (q.y / 4.0).powi(2) - 1.0).abs() < 1e-12);
    }
    for p in along(&curve(&d, 5)) {
        assert!((p.length() - 1.0).abs() < 1e-15);
    }
    // A uniform quadratic spline passes through the middles between its poles.
    ends(6, DVec3::X, DVec3::X);
    near(curve(&d, 6).point(1.0), DVec3::new(2.0, 1.0, 0.0), 1e-15);
    near(curve(&d, 6).point(3.0), DVec3::new(0.0, 1.0, 0.0), 1e-15);
    ends(7, DVec3::new(0.5, 0.0, 0.0), DVec3::new(1.0, 0.5, 0.0));
    ends(8, DVec3::new(0.25, 0.0, 0.0), DVec3::new(0.75, 0.0, 0.0));
}

#[test]
fn placements_of_a_brep_file_are_applied_in_their_order() {
    // A quarter turn about z, a shift, and the turn after twice the shift.
    let places = [
        "1\n 0 -1 0 0\n 1 0 0 0\n 0 0 1 0",
        "1\n 1 0 0 10\n 0 1 0 0\n 0 0 1 0",
        "2 2 2 1 1 0",
        "2 3 -1 0",
    ];
    let line = [("1 0 0 0 1 0 0", [0.0, 1.0])];
    for (place, from, to) in [
        (1, DVec3::ZERO, DVec3::Y),
        (2, DVec3::X * 10.0, DVec3::X * 11.0),
        (3, DVec3::Y * 20.0, DVec3::Y * 21.0),
        (4, DVec3::X * -20.0, DVec3::new(-20.0, -1.0, 0.0)),
    ] {
        let d = document("brep", brep(&line, &places, place).as_bytes());
        let [a, b] = curve(&d, 0).ends();
        near(a, from, 1e-14);
        near(b, to, 1e-14);
    }
}

#[test]
fn public_networks_of_curves() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let folder = root
        .ancestors()
        .map(|a| a.join("shared/data/curve-networks"))
        .find(|f| f.is_dir());
    let Some(folder) = folder else {
        eprintln!("skipped: curve-networks is not there");
        return;
    };
    let mut files = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "brep") {
            continue;
        }
        files += 1;
        let text = std::fs::read_to_string(&path).unwrap();
        let d = document("brep", text.as_bytes());
        assert!(d.left_out.is_empty(), "{path:?}: {:?}", d.left_out);
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        let edges = lines.iter().filter(|l| **l == "Ed").count();
        assert_eq!(d.items.len(), edges, "{path:?}");
        let announced = lines.iter().find_map(|l| l.strip_prefix("Curves "));
        assert!(edges >= announced.unwrap().trim().parse().unwrap());
        // The vertices that the file states for the edges are the ends of the curves.
        let vertices: Vec<DVec3> = (0..lines.len())
            .filter(|i| lines[*i] == "Ve")
            .map(|i| {
                let xs: Vec<f64> = lines[i + 2]
                    .split(' ')
                    .map(|w| w.parse().unwrap())
                    .collect();
                DVec3::new(xs[0], xs[1], xs[2])
            })
            .collect();
        for i in 0..d.items.len() {
            for end in curve(&d, i).ends() {
                let apart = vertices
                    .iter()
                    .map(|v| v.distance(end))
                    .fold(f64::MAX, f64::min);
                assert!(
                    apart < 1e-6,
                    "{path:?}: curve {i} ends {apart} from a vertex"
                );
            }
        }
    }
    assert_eq!(files, 18);
    let wing = document("brep", &beside("occt/wing.brep").unwrap());
    assert_eq!((wing.items.len(), wing.left_out[0].count), (0, 4));
}

#[test]
fn faults_of_small_formats_say_where() {
    let line = "1 0 0 0 1 0 0";
    let good = brep(&[(line, [0.0, 1.0])], &[], 0);
    let brep = |from: &str, to: &str| {
        assert!(good.contains(from));
        good.replacen(from, to, 1)
    };
    for (ending, text, place, word) in [
        (
            "xml",
            QUARTER.replace("1 0 1 1", "1 0 1 x"),
            "line 9",
            "`x`",
        ),
        (
            "xml",
            QUARTER.replace("0 0 0 1 1 1", "0 0 0 1 1"),
            "line 5",
            "knots",
        ),
        (
            "xml",
            QUARTER.replace("1 0.7", "1 -0.7"),
            "line 5",
            "weight",
        ),
        (
            "xml",
            QUARTER.replace("</Geometry>\n<Geometry", "<Geometry"),
            "line 12",
            "XML",
        ),
        (
            "xml",
            QUARTER.replace("<weights>1", "<weights>nan"),
            "line 8",
            "nan",
        ),
        (
            "xml",
            QUARTER.replace("<weights>1", "<weights>"),
            "line 5",
            "2 weights",
        ),
        (
            "xml",
            NET.replace("2 0 5", "2 0"),
            "line 1",
            "17 coefficients",
        ),
        (
            "xml",
            NET.replace("0 0 1 2 2", "0 0 2 2"),
            "line 1",
            "2 × 2 points",
        ),
        ("xml", "<model/>".into(), "", "`model`"),
        (
            "bpt",
            "2\n1 1\n0 0 0 1 0 0 0 1 0 1 1 0\nx 1 0 0 0 0 0 0 0 0 0 0 0 0 0".into(),
            "line 4",
            "`x` should be a degree",
        ),
        (
            "bpt",
            "1\n1 1\n0 0 0 1 0 0 0 1 0 1 1 inf\n".into(),
            "line 3",
            "`inf`",
        ),
        (
            "bpt",
            "1\n1 1\n0 0 0 1 0 0 0 0 0 1 0 0\n".into(),
            "line 2",
            "patch 1",
        ),
        (
            "bpt",
            "1\n1 1\n0 0 0 1 0 0 0 1 0 1 1 0\n7".into(),
            "line 4",
            "more",
        ),
        ("bpt", "9999999999999\n".into(), "line 1", "bytes follow"),
        (
            "bpt",
            "1\n99999999999 99999999999\n0".into(),
            "line 2",
            "bytes",
        ),
        ("dat", "name\n1 0\n0 x\n".into(), "line 3", "0 x"),
        ("dat", "name\n1 0\n0 1 2\n".into(), "line 3", "3 numbers"),
        (
            "dat",
            "name\n3. 3.\n0 0\n1 0\n".into(),
            "line 2",
            "announced",
        ),
        ("dat", "name\n".into(), "", "no points"),
        ("cpt", "0,0,0;1,0,0\n0,1,0\n".into(), "line 2", "a row of 1"),
        ("cpt", "0,0,0;1,0,0\n0,1,0;1,,1".into(), "line 2", "x,y,z"),
        ("brep", "text".into(), "line 1", "CASCADE"),
        ("brep", brep("V1", "V9"), "line 3", "V9"),
        (
            "brep",
            brep("Curves 1", "Curves 99999999"),
            "line 6",
            "bytes follow",
        ),
        ("brep", brep("1 0 0 0", "1 0 y 0"), "line 7", "`y`"),
        ("brep", brep("1 0 0 0", "17 0 0 0"), "line 7", "kind 17"),
        ("brep", brep("+2 0 *", "+3 0 *"), "line 24", "`+3`"),
        ("brep", brep("+2 0 *", "+1 0 *"), "line 24", "later"),
        ("brep", brep("+1 0", "+1 1"), "line 26", "location 1"),
        ("brep", brep("+1 0 \n", ""), "line 24", "ends"),
        (
            "brep",
            "CASCADE Topology V1\nLocations 0\nCurves 0".into(),
            "line 3",
            "TShapes",
        ),
    ] {
        let e = fault(ending, &text);
        assert!(
            e.contains(place) && e.contains(word),
            "{ending}: {e}\n{text}"
        );
    }
}

#[test]
fn degrees_as_large_as_a_number_can_be_are_refused() {
    let most = format!("degree=\"{}\"", u64::MAX);
    let second = NET.replacen("degree=\"1\"", "degree=\"?\"", 1);
    let second = second.replace("degree=\"1\"", &most);
    for text in [
        QUARTER.replace("degree=\"2\"", &most),
        NET.replacen("degree=\"1\"", &most, 1),
        second.replace("degree=\"?\"", "degree=\"1\""),
    ] {
        assert!(text.contains(&most));
        let told = match read_bytes("xml", text.as_bytes()) {
            Err(e) => e.to_string(),
            Ok(Read::Document(d)) => {
                assert!(d.items.is_empty(), "{text}");
                format!("{:?}", d.left_out)
            }
            Ok(Read::Mesh(_)) => panic!("a mesh"),
        };
        assert!(told.contains("degree") || told.contains("points"), "{told}");
    }
}

#[test]
fn any_change_ends_with_a_result() {
    let curves = [
        (format!("3 {FRAME} 5 2"), [0.0, 2.0]),
        (format!("8 -2 2 5 {FRAME} 3 4"), [-1.0, 1.0]),
        (
            "7 1 1 2 4 5 0 0 0 1 2 0 0 1 2 2 0 1 0 2 0 1 0 1 1 1 2 1 3 1 4 1".into(),
            [0.0, 4.0],
        ),
    ];
    let curves: Vec<(&str, [f64; 2])> = curves.iter().map(|c| (c.0.as_str(), c.1)).collect();
    let places = ["1 0 -1 0 0 1 0 0 0 0 0 1 0", "2 1 3 0"];
    let bpt = "1\n2 1\n0 0 0\n1 0 2\n2 0 0\n0 1 0\n1 1 0\n2 1 0\n";
    for (ending, text) in [
        ("xml", QUARTER.to_owned()),
        ("xml", NET.to_owned()),
        ("bpt", bpt.to_owned()),
        ("dat", aerofoils()[1].chars().take(300).collect()),
        ("cpt", "\"a\"\n0,0,0;1,0,0\n0,1,0;1,2,1\n".to_owned()),
        ("brep", brep(&curves, &places, 2)),
    ] {
        let bytes = text.as_bytes();
        for at in 0..bytes.len() {
            let _ = read_bytes(ending, &bytes[..at]);
            for value in [0, 0xff, b' ', b'9', b'-', b'e'] {
                let mut changed = bytes.to_vec();
                changed[at] = value;
                if let Ok(Read::Document(d)) = read_bytes(ending, &changed) {
                    for item in &d.items {
                        match &item.form {
                            ItemForm::Body { body, .. } => {
                                let _ = body.validate(1.0);
                            }
                            ItemForm::Curve(c) => assert!(c.ends().iter().all(|p| p.is_finite())),
                            ItemForm::Points(p) => assert!(p.iter().all(|p| p.is_finite())),
                        }
                    }
                }
            }
        }
    }
    // Elements in elements, and placements of placements.
    let deep = format!(
        "<xml>{}{}</xml>",
        "<a>".repeat(100_000),
        "</a>".repeat(100_000)
    );
    assert!(document("xml", deep.as_bytes()).items.is_empty());
    let mut bomb = "CASCADE Topology V1\nLocations 0\nCurves 0\nTShapes 41\nCo 1 *\n".to_owned();
    for i in 1..41 {
        bomb += &format!("Co 1 +{0} 0 +{0} 0 *\n", 42 - i);
    }
    bomb += "+1 0";
    assert!(fault("brep", &bomb).contains("out of proportion"));
}
