//! Surfaces of revolution and extrusions go out as what they are, and come back.

use crate::{sewn, wave, written};
use nappe::body::Body;
use nappe::curve::{Ellipse, EllipseOptions, Line};
use nappe::surface::{
    Construction, Quadric, QuadricOptions, QuadricShape, RevolutionOptions, Surface, SurfaceRef,
    Swapped, Transformed, ruled,
};
use nappe::{CurveRef, DAffine3, DMat3, DVec3, Dir, Frame, NurbsCurve, Revolution, Units};
use nappe_exchange::step::{self, Schema};
use nappe_exchange::{ItemForm, is_whole};
use std::sync::Arc;

/// How far control points may be, relative to the largest coordinate.
const SAME: f64 = 1e-15;

fn frame(at: DVec3, size: f64) -> Frame {
    let [z, x] = [DVec3::new(1.0, 2.0, 2.0), DVec3::new(2.0, 1.0, -2.0)];
    Frame::new(at + DVec3::new(3.0, -2.0, 5.0) * size, z, x).unwrap()
}

/// A cubic spline, rational or not, in the coordinates of a frame.
fn spline(f: &Frame, size: f64, points: &[[f64; 3]], weights: Option<&[f64]>) -> NurbsCurve {
    let knots = nappe::basis::BSplineBasis::clamped_uniform(3, points.len());
    let points: Vec<DVec3> = points
        .iter()
        .map(|p| f.point(DVec3::from(*p) * size))
        .collect();
    NurbsCurve::new(3, knots, &points, weights).unwrap()
}

/// Profiles beside the axis: in a plane with it or not, closed or not, with a pole or not.
fn profiles(f: &Frame, size: f64) -> Vec<(&'static str, CurveRef)> {
    let open = [
        [2.0, 0.0, 0.0],
        [3.5, 0.0, 1.0],
        [1.0, 0.0, 2.0],
        [2.2, 0.0, 3.0],
        [2.0, 0.0, 4.0],
    ];
    let bent = open.map(|[x, _, z]| [x, 0.3 * z * z, z]);
    let pole = [
        [0.0, 0.0, 0.0],
        [1.5, 0.0, 0.0],
        [2.0, 0.0, 1.0],
        [1.7, 0.0, 3.0],
    ];
    let line = Line::new(
        f.point(DVec3::new(2.0, -3.0, 0.0) * size),
        f.point(DVec3::new(2.0, 3.0, 5.0) * size),
    );
    let ring = EllipseOptions {
        normal: f.y(),
        ..EllipseOptions::default()
    };
    let ring = Ellipse::new(
        f.point(DVec3::new(4.0, 0.0, 1.0) * size),
        [2.0, 1.0].map(|x| x * size),
        ring,
    );
    vec![
        ("open", Arc::new(spline(f, size, &open, None))),
        (
            "rational",
            Arc::new(spline(f, size, &bent, Some(&[1.0, 2.0, 0.7, 1.3, 1.0]))),
        ),
        ("pole", Arc::new(spline(f, size, &pole, None))),
        ("skew", Arc::new(line.unwrap())),
        ("ring", Arc::new(ring.unwrap())),
    ]
}

fn turned(at: DVec3, size: f64) -> Vec<(String, SurfaceRef)> {
    let f = frame(at, size);
    let mut all: Vec<(String, SurfaceRef)> = Vec::new();
    for (name, profile) in profiles(&f, size) {
        for (start, angle) in [
            (0.0, 1.0),
            (0.0, 4.0),
            (0.0, 360f64.to_radians()),
            (0.7, 2.5),
        ] {
            for construction in [Construction::Angle, Construction::Rational] {
                let options = RevolutionOptions {
                    start,
                    angle,
                    construction,
                };
                let surface = Revolution::new(profile.clone(), f, options).unwrap();
                let name = format!("{name} from {start} by {angle}, {construction:?}");
                all.push((name, Arc::new(surface)));
            }
        }
    }
    let first = all[0].1.clone();
    all.push(("swapped".into(), Arc::new(Swapped::new(first.clone()))));
    // Mirrored, and another scale along the axis than across.
    let [x, y, z] = f.directions();
    let along = DMat3::from_cols(x, y, z);
    let stretch = along * DMat3::from_diagonal(DVec3::new(1.5, -1.5, 0.5)) * along.transpose();
    let map = DAffine3::from_mat3(stretch);
    all.push((
        "mirrored".into(),
        Arc::new(Transformed::new(first, map).unwrap()),
    ));
    let quadric = |shape, axes: [f64; 3], range| {
        let options = QuadricOptions { frame: f, range };
        Arc::new(Quadric::new(shape, &axes.map(|a| a * size), options).unwrap()) as SurfaceRef
    };
    let heights = |lo: f64, hi: f64| Some([lo * size, hi * size]);
    for turn in [None, Some([0.4, 2.0])] {
        all.push((
            format!("hyperboloid of one sheet {turn:?}"),
            quadric(
                QuadricShape::Hyperboloid1,
                [2.0, 2.0, 1.0],
                [turn, heights(-1.0, 2.0)],
            ),
        ));
        all.push((
            format!("hyperboloid of two sheets {turn:?}"),
            quadric(
                QuadricShape::Hyperboloid2,
                [2.0, 2.0, 1.0],
                [turn, heights(1.0, 2.0)],
            ),
        ));
        all.push((
            format!("paraboloid {turn:?}"),
            quadric(
                QuadricShape::EllipticParaboloid,
                [2.0, 2.0, 1.0],
                [turn, heights(0.0, 2.0)],
            ),
        ));
    }
    all.push((
        "spheroid".into(),
        quadric(QuadricShape::Ellipsoid, [2.0, 2.0, 1.0], [None; 2]),
    ));
    all
}

fn moved(at: DVec3, size: f64) -> Vec<(String, SurfaceRef)> {
    let f = frame(at, size);
    let mut all: Vec<(String, SurfaceRef)> = Vec::new();
    for (name, profile) in profiles(&f, size) {
        if name == "skew" {
            continue;
        }
        for way in [DVec3::new(0.1, 5.0, 1.0), DVec3::new(-0.3, -2.0, 0.2)] {
            let n = profile.to_rational().unwrap();
            let other = n.transformed(&DAffine3::from_translation(way * size));
            for dir in [Dir::U, Dir::V] {
                let rails: [CurveRef; 2] = [Arc::new(n.clone()), Arc::new(other.clone())];
                let [a, b] = rails;
                let surface = Arc::new(ruled(a, b, dir).unwrap());
                all.push((format!("{name} {dir} {way}"), surface));
            }
        }
    }
    let first = all[0].1.clone();
    let shear = DMat3::from_cols(DVec3::X * 2.0, DVec3::new(0.7, -1.0, 0.0), DVec3::Z);
    let map = DAffine3::from_mat3(shear);
    all.push((
        "sheared".into(),
        Arc::new(Transformed::new(first, map).unwrap()),
    ));
    let quadric = |shape, axes: &[f64], range| {
        let axes: Vec<f64> = axes.iter().map(|a| a * size).collect();
        let options = QuadricOptions { frame: f, range };
        Arc::new(Quadric::new(shape, &axes, options).unwrap()) as SurfaceRef
    };
    let range = |lo: f64, hi: f64| Some([lo * size, hi * size]);
    let high = range(-1.0, 3.0);
    for (name, shape, axes, range) in [
        ("elliptic", QuadricShape::Cylinder, [2.0, 1.0], [None, high]),
        (
            "part of elliptic",
            QuadricShape::Cylinder,
            [2.0, 1.0],
            [Some([0.5, 2.0]), high],
        ),
        (
            "parabolic",
            QuadricShape::ParabolicCylinder,
            [2.0, 1.0],
            [range(-1.0, 3.0), high],
        ),
        (
            "hyperbolic",
            QuadricShape::HyperbolicCylinder,
            [2.0, 1.0],
            [range(-1.0, 2.0), high],
        ),
    ] {
        all.push((name.into(), quadric(shape, &axes, range)));
    }
    all
}

/// How far the control points of two surfaces are, in the best of all ways to go through them, relative to the largest
/// coordinate.
fn apart(a: &dyn Surface, b: &dyn Surface) -> f64 {
    let [a, b] = [a, b].map(|s| s.to_rational().unwrap());
    let ([rows, columns], points) = (a.size(), a.control_points());
    let size = points
        .iter()
        .map(|p| p.abs().max_element())
        .fold(0.0, f64::max);
    let other = b.control_points();
    let ways = (0..8).filter_map(|way| {
        let (swap, back_u, back_v) = (way & 1 > 0, way & 2 > 0, way & 4 > 0);
        let n = if swap {
            [columns, rows]
        } else {
            [rows, columns]
        };
        if b.size() != n {
            return None;
        }
        let far = (0..rows * columns).map(|k| {
            let (i, j) = (k / columns, k % columns);
            let i2 = if back_u { rows - 1 - i } else { i };
            let j2 = if back_v { columns - 1 - j } else { j };
            let at = if swap {
                j2 * rows + i2
            } else {
                i2 * columns + j2
            };
            points[k].distance(other[at])
        });
        Some(far.fold(0.0, f64::max) / size)
    });
    ways.fold(f64::INFINITY, f64::min)
}

/// One of each.
pub(crate) fn all() -> Vec<(String, SurfaceRef)> {
    let (at, size) = PLACES[0];
    let mut all = turned(at, size);
    all.extend(moved(at, size));
    all
}

fn comes_back(name: &str, surface: &SurfaceRef, entity: &str, size: f64) {
    let document = sewn(std::slice::from_ref(surface), Units::Millimetre);
    let bytes = written(&document, Schema::Ap242);
    let text = String::from_utf8_lossy(&bytes);
    assert!(text.contains(entity), "{name}");
    assert!(!text.contains("B_SPLINE_SURFACE"), "{name}");
    let file = step::read(&bytes).unwrap();
    assert_eq!(file.document.left_out, [], "{name}");
    let body = |d: &nappe_exchange::Document| -> Body {
        match &d.items[0].form {
            ItemForm::Body { body, .. } => body.clone(),
            other => panic!("no body: {other:?}"),
        }
    };
    let (old, new) = (body(&document), body(&file.document));
    assert_eq!(old.edges.len(), new.edges.len(), "{name}");
    assert_eq!(old.vertices.len(), new.vertices.len(), "{name}");
    assert_eq!(old.shells[0].closed, new.shells[0].closed, "{name}");
    assert!(is_whole(&new, 0, 1e-8 * size), "{name}");
    let (face, again) = (&old.faces[0], &new.faces[0]);
    let far = apart(surface.as_ref(), again.surface.as_ref());
    assert!(far <= SAME, "{name}: {far:e}");
    // The normal of the face at points of the old one.
    let finder =
        nappe::query::Finder::new(std::slice::from_ref(&again.surface), Default::default());
    let finder = finder.unwrap();
    for share in [[0.2, 0.3], [0.7, 0.6]] {
        let [u, v] = face.surface.domain();
        let uv = [u.lo + u.width() * share[0], v.lo + v.width() * share[1]];
        let found = finder.nearest(face.surface.point(uv)).unwrap();
        let normal = |f: &nappe::body::Face, uv| {
            let n = f.surface.jet(uv, Default::default(), 1).normal().unwrap();
            if f.forward { n } else { -n }
        };
        let cosine = normal(face, uv).dot(normal(again, found.uv));
        assert!((cosine - 1.0).abs() < 1e-9, "{name}: {cosine}");
    }
}

/// Places and sizes: far away as far as ten digits are left for the shape.
const PLACES: [(DVec3, f64); 4] = [
    (DVec3::ZERO, 1.0),
    (DVec3::ZERO, 1e-6),
    (DVec3::ZERO, 1e6),
    (DVec3::new(1e3, -3e3, 2e3), 1.0),
];

#[test]
fn surfaces_of_revolution_come_back_with_their_control_points() {
    for (at, size) in PLACES {
        for (name, surface) in turned(at, size) {
            let name = format!("{name} at {at}, {size}");
            comes_back(&name, &surface, "=SURFACE_OF_REVOLUTION(", size);
        }
    }
}

#[test]
fn extrusions_come_back_with_their_control_points() {
    for (at, size) in PLACES {
        for (name, surface) in moved(at, size) {
            let name = format!("{name} at {at}, {size}");
            comes_back(&name, &surface, "=SURFACE_OF_LINEAR_EXTRUSION(", size);
        }
    }
}

#[test]
fn what_is_given_as_a_spline_or_only_nearly_swept_stays_a_spline() {
    let curve = profiles(&frame(DVec3::ZERO, 1.0), 1.0)[0]
        .1
        .to_nurbs()
        .unwrap();
    let other = |by: f64| {
        let mut points = curve.homogeneous().to_vec();
        points.iter_mut().for_each(|p| p.y += 2.0);
        points[1].x += by;
        Arc::new(NurbsCurve::from_homogeneous(curve.basis().clone(), points)) as CurveRef
    };
    let first: CurveRef = Arc::new(curve.clone());
    let between = |by: f64| ruled(first.clone(), other(by), Dir::U).unwrap();
    assert!(between(0.0).swept().is_some());
    let nets: [SurfaceRef; 3] = [
        Arc::new(between(1e-12)),
        Arc::new(between(0.0).to_nurbs().unwrap()),
        wave(6, 5, DVec3::ZERO, 1.0),
    ];
    for surface in nets {
        assert!(surface.swept().is_none());
        let bytes = written(&sewn(&[surface], Units::Millimetre), Schema::Ap242);
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.contains("B_SPLINE_SURFACE") && !text.contains("SURFACE_OF"));
    }
}
