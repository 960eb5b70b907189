//! Surfaces as curves that are turned or moved, and the exact forms of their sides.

#![allow(clippy::unwrap_used)]

use nappe::curve::{Curve, Isocurve, Line};
use nappe::query::{Finder, FinderOptions};
use nappe::surface::{
    Construction, Dir, Quadric, QuadricOptions, QuadricShape, Revolution, RevolutionOptions, Side,
    Surface, SurfaceRef, Swapped, Swept, Transformed, ruled,
};
use nappe::{DAffine3, DMat3, DVec3, Frame, NurbsCurve};
use std::sync::Arc;

fn frame() -> Frame {
    let [z, x] = [DVec3::new(1.0, 2.0, 2.0), DVec3::new(2.0, 1.0, -2.0)];
    Frame::new(DVec3::new(3.0, -2.0, 5.0), z, x).unwrap()
}

fn profile() -> NurbsCurve {
    let points = [
        [2.0, 0.0, 0.0],
        [3.5, 0.4, 1.0],
        [1.0, -0.2, 2.0],
        [2.2, 0.1, 3.0],
    ];
    let points = points.map(|p| frame().point(DVec3::from(p)));
    NurbsCurve::bezier(&points, Some(&[1.0, 2.0, 0.5, 1.5])).unwrap()
}

fn turned(start: f64, angle: f64, construction: Construction) -> SurfaceRef {
    let options = RevolutionOptions {
        start,
        angle,
        construction,
    };
    Arc::new(Revolution::new(Arc::new(profile()), frame(), options).unwrap())
}

/// A point of what is swept, the curve's direction there × that of the sweep, and whether that is the normal.
fn place(swept: &Swept, share: [f64; 2]) -> (DVec3, DVec3, bool) {
    let at = |c: &NurbsCurve| {
        let d = c.domain();
        let jet = c.jet(d.lo + d.width() * share[0], Default::default(), 1);
        (jet.d[0], jet.d[1])
    };
    match swept {
        Swept::Turned {
            curve,
            axis,
            angle,
            same,
        } => {
            let (p, along) = at(curve);
            let (s, c) = (angle * share[1]).sin_cos();
            let turn = |v: DVec3| {
                let v = axis.components(v);
                let [x, y, z] = axis.directions();
                x * (v.x * c - v.y * s) + y * (v.x * s + v.y * c) + z * v.z
            };
            let q = axis.origin() + turn(p - axis.origin());
            let round = axis.z().cross(q - axis.origin());
            (q, turn(along).cross(round), *same)
        }
        Swept::Moved { curve, along, same } => {
            let (p, tangent) = at(curve);
            (p + *along * share[1], tangent.cross(*along), *same)
        }
    }
}

/// Checks that a surface is what it says that sweeps it, with its normal.
fn check(name: &str, surface: &SurfaceRef) {
    let swept = surface.swept().unwrap_or_else(|| panic!("{name}"));
    let options = FinderOptions {
        tol: Some(1e-12),
        ..FinderOptions::default()
    };
    let finder = Finder::new(std::slice::from_ref(surface), options).unwrap();
    for share in [[0.0, 0.0], [0.1, 0.9], [0.5, 0.4], [0.8, 1.0], [1.0, 0.3]] {
        let (p, normal, same) = place(&swept, share);
        let found = finder.nearest(p).unwrap();
        assert!(found.distance < 1e-11, "{name}: {}", found.distance);
        let own = surface
            .jet(found.uv, Default::default(), 1)
            .normal()
            .unwrap();
        let cosine = own.dot(normal.normalize()) * if same { 1.0 } else { -1.0 };
        assert!(cosine > 1.0 - 1e-9, "{name}: {cosine}");
    }
    // And it goes no farther: the corners are corners.
    let [u, v] = surface.domain();
    for (i, j) in [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)] {
        let corner = surface.point([u.lo + u.width() * i, v.lo + v.width() * j]);
        let near = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]]
            .map(|s| place(&swept, s).0.distance(corner));
        assert!(near.iter().any(|d| *d < 1e-12), "{name}: {near:?}");
    }
}

#[test]
fn what_sweeps_a_surface_sweeps_it_with_its_normal() {
    for construction in [
        Construction::Angle,
        Construction::Rational,
        Construction::Coons,
    ] {
        for (start, angle) in [(0.0, 1.2), (0.7, 4.0), (-2.0, 360f64.to_radians())] {
            let surface = turned(start, angle, construction);
            let name = format!("{construction:?} from {start} by {angle}");
            check(&name, &surface);
            check(
                "swapped",
                &(Arc::new(Swapped::new(surface.clone())) as SurfaceRef),
            );
            let [x, y, z] = frame().directions();
            let along = DMat3::from_cols(x, y, z);
            // About the axis circles stay circles, mirrored or not.
            for scale in [DVec3::new(2.0, 2.0, 0.5), DVec3::new(-2.0, 2.0, 3.0)] {
                let m = along * DMat3::from_diagonal(scale) * along.transpose();
                let map = DAffine3::from_mat3_translation(m, DVec3::ONE);
                let image = Transformed::new(surface.clone(), map).unwrap();
                check(
                    &format!("{name}, {scale}"),
                    &(Arc::new(image) as SurfaceRef),
                );
            }
            let map = DAffine3::from_scale(DVec3::new(1.0, 2.0, 3.0));
            let image = Transformed::new(surface, map).unwrap();
            assert!(image.swept().is_none());
        }
    }
    let conic = turned(0.0, 90f64.to_radians(), Construction::Conic { mu: 0.3 });
    assert!(conic.swept().is_none());
}

#[test]
fn quadrics_and_ruled_surfaces_tell_what_sweeps_them() {
    let quadric = |shape, axes: &[f64], range| -> SurfaceRef {
        let options = QuadricOptions {
            frame: frame(),
            range,
        };
        Arc::new(Quadric::new(shape, axes, options).unwrap())
    };
    let part = [Some([0.3, 2.0]), Some([0.5, 2.0])];
    for (shape, axes) in [
        (QuadricShape::EllipticParaboloid, &[2.0, 2.0, 1.0][..]),
        (QuadricShape::Hyperboloid1, &[2.0, 2.0, 1.0]),
        (QuadricShape::Cylinder, &[2.0, 1.0]),
        (QuadricShape::ParabolicCylinder, &[2.0, 1.0]),
        (QuadricShape::HyperbolicCylinder, &[2.0, 1.0]),
    ] {
        check(&format!("{shape:?}"), &quadric(shape, axes, part));
    }
    let uneven = quadric(QuadricShape::Hyperboloid1, &[2.0, 1.0, 1.0], part);
    assert!(uneven.swept().is_none());
    let way = DVec3::new(1.0, -4.0, 0.5);
    let other = profile().transformed(&DAffine3::from_translation(way));
    for dir in [Dir::U, Dir::V] {
        let surface = ruled(Arc::new(profile()), Arc::new(other.clone()), dir).unwrap();
        check(&format!("{dir}"), &(Arc::new(surface) as SurfaceRef));
    }
    let larger = profile().transformed(&DAffine3::from_scale(DVec3::splat(1.001)));
    let surface = ruled(Arc::new(profile()), Arc::new(larger), Dir::U).unwrap();
    assert!(surface.swept().is_none() && surface.to_nurbs().unwrap().swept().is_none());
}

#[test]
fn sides_of_a_turn_by_angle_are_rational_arcs() {
    let surface = turned(0.4, 2.5, Construction::Angle);
    for side in Side::ALL {
        let curve = Isocurve::side(surface.clone(), side);
        let exact = curve.to_rational().unwrap();
        for (a, b) in curve.ends().into_iter().zip(exact.ends()) {
            assert!(a.distance(b) < 1e-14, "{side}");
        }
        // Round the axis all points have the height and the radius of the first.
        if side.along() == Dir::V {
            let d = exact.domain();
            let at = |t: f64| {
                let c = frame().coordinates(exact.point(d.lo + d.width() * t));
                [c.truncate().length(), c.z]
            };
            let [radius, height] = at(0.0);
            for k in 1..=16 {
                let [r, z] = at(f64::from(k) / 16.0);
                assert!((r - radius).abs() < 1e-14 && (z - height).abs() < 1e-14);
            }
        }
    }
    // Between the sides a parameter of the turn is not known in the other form.
    let inside = Isocurve::new(surface, Dir::V, 0.5).unwrap();
    assert!(inside.to_rational().is_none());
    let line = Line::new(DVec3::ZERO, DVec3::X).unwrap();
    assert!(line.to_rational().is_some());
}
