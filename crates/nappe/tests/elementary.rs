//! What surfaces say they are: plane, cylinder, cone, sphere, torus.

#![allow(clippy::unwrap_used)]

use nappe::curve::{Ellipse, EllipseOptions, Line};
use nappe::surface::{
    Elementary, Quadric, QuadricOptions, QuadricShape, Revolution, RevolutionOptions, Surface,
    SurfaceRef, Torus, TorusOptions, Transformed,
};
use nappe::{CurveRef, DAffine3, DVec3, Frame};
use std::sync::Arc;

/// The distance of a point from the elementary surface, by its definition.
fn distance(form: Elementary, p: DVec3) -> f64 {
    match form {
        Elementary::Plane { origin, normal } => (p - origin).dot(normal),
        Elementary::Cylinder { axis, radius, .. } => {
            axis.coordinates(p).truncate().length() - radius
        }
        Elementary::Cone { axis, slope, .. } => {
            let c = axis.coordinates(p);
            (c.truncate().length() - slope * c.z) / (1.0 + slope * slope).sqrt()
        }
        Elementary::Sphere { frame, radius, .. } => p.distance(frame.origin()) - radius,
        Elementary::Torus {
            axis, major, minor, ..
        } => {
            let c = axis.coordinates(p);
            DVec3::new(c.truncate().length() - major, 0.0, c.z).length() - minor
        }
    }
}

/// Quadrics, tori and turned profiles know what they are, also moved, mirrored and scaled; the normal's side is right.
#[test]
fn round_surfaces_say_what_they_are() {
    let frame = Frame::new(
        DVec3::new(3.0, -2.0, 7.0),
        DVec3::new(1.0, 2.0, 2.0),
        DVec3::X,
    )
    .unwrap();
    let quadric = |shape, axes: &[f64], range| -> SurfaceRef {
        let options = QuadricOptions {
            frame,
            range: [None, range],
        };
        Arc::new(Quadric::new(shape, axes, options).unwrap())
    };
    let turned = |profile: CurveRef| -> SurfaceRef {
        Arc::new(Revolution::new(profile, frame, RevolutionOptions::default()).unwrap())
    };
    let at = |x, z| frame.point(DVec3::new(x, 0.0, z));
    let line = |a, b| -> CurveRef { Arc::new(Line::new(a, b).unwrap()) };
    let arc = |a, b, c| -> CurveRef { Arc::new(Ellipse::through([a, b, c]).unwrap()) };
    let torus = TorusOptions {
        frame,
        ..TorusOptions::default()
    };
    let surfaces: [(&str, SurfaceRef); 10] = [
        ("cylinder", quadric(QuadricShape::Cylinder, &[2.0], None)),
        (
            "cone",
            quadric(QuadricShape::Cone, &[2.0, 2.0, 3.0], Some([1.0, 2.0])),
        ),
        (
            "cone",
            quadric(QuadricShape::Cone, &[2.0, 2.0, 3.0], Some([-2.0, -1.0])),
        ),
        ("sphere", quadric(QuadricShape::Sphere, &[2.5], None)),
        ("torus", Arc::new(Torus::new(3.0, 1.0, torus).unwrap())),
        ("cylinder", turned(line(at(2.0, 5.0), at(2.0, 1.0)))),
        ("cone", turned(line(at(1.0, 1.0), at(2.0, 5.0)))),
        ("cone", turned(line(at(2.0, 1.0), at(0.0, 5.0)))),
        (
            "sphere",
            turned(arc(at(0.0, 5.0), at(2.0, 3.0), at(0.0, 1.0))),
        ),
        (
            "torus",
            turned(arc(at(2.0, 0.0), at(3.0, 1.0), at(4.0, 0.0))),
        ),
    ];
    let name = |e: &Elementary| match e {
        Elementary::Plane { .. } => "plane",
        Elementary::Cylinder { .. } => "cylinder",
        Elementary::Cone { .. } => "cone",
        Elementary::Sphere { .. } => "sphere",
        Elementary::Torus { .. } => "torus",
    };
    let mirror = DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0));
    let maps = [
        DAffine3::IDENTITY,
        mirror,
        DAffine3::from_scale(DVec3::splat(40.0)) * DAffine3::from_axis_angle(DVec3::Y, 0.3),
    ];
    for (expected, surface) in &surfaces {
        for map in maps {
            let moved = Transformed::new(surface.clone(), map).unwrap();
            let form = moved.elementary().expect("a form");
            assert_eq!(name(&form), *expected);
            for uv in [[0.1, 0.2], [0.45, 0.7], [0.8, 0.55]] {
                let jet = moved.jet(uv, Default::default(), 1);
                let (p, n) = (jet.point(), jet.normal().unwrap());
                let size = p.length();
                assert!(distance(form, p).abs() < 1e-13 * size, "{form:?} {uv:?}");
                // The distance grows along the normal where that points outwards.
                let step = 1e-3 * size;
                let outward = match form {
                    Elementary::Plane { .. } => true,
                    Elementary::Cylinder { outward, .. }
                    | Elementary::Cone { outward, .. }
                    | Elementary::Sphere { outward, .. }
                    | Elementary::Torus { outward, .. } => outward,
                };
                assert_eq!(distance(form, p + n * step) > 0.0, outward, "{form:?}");
            }
        }
        // Stretched along x they are none of these.
        let stretched = DAffine3::from_scale(DVec3::new(1.5, 1.0, 1.0));
        let stretched = Transformed::new(surface.clone(), stretched).unwrap();
        assert_eq!(stretched.elementary(), None);
    }
    // A line askew to the axis sweeps a hyperboloid.
    let askew = line(at(2.0, 1.0), frame.point(DVec3::new(2.0, 1.0, 4.0)));
    assert_eq!(turned(askew).elementary(), None);
    // An ellipse that is nearly a circle is none.
    let options = EllipseOptions {
        from: -1.0,
        to: 1.0,
        normal: -frame.y(),
        x_direction: Some(frame.x()),
    };
    let nearly = Ellipse::new(at(3.0, 0.0), [1.0, 1.0 + 1e-9], options).unwrap();
    assert_eq!(turned(Arc::new(nearly)).elementary(), None);
}
