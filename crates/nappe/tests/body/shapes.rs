//! Surfaces that the tests share.

use nappe::surface::{
    Quadric, QuadricOptions, QuadricShape, SurfaceRef, Torus, TorusOptions, Transformed, bilinear,
};
use nappe::{DAffine3, DMat3, DVec3, Frame};
use std::sync::Arc;

pub(crate) fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// The parallelogram at a corner.
pub(crate) fn quad(p: DVec3, u: DVec3, v: DVec3) -> SurfaceRef {
    Arc::new(bilinear([[p, p + v], [p + u, p + u + v]]).unwrap())
}

/// The six faces of the box between the origin and `size`; the normals of some point in, of others out.
pub(crate) fn cuboid(size: DVec3) -> Vec<SurfaceRef> {
    let [x, y, z] = [DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z];
    let o = DVec3::ZERO;
    vec![
        quad(o, x, y),
        quad(z, x, y),
        quad(o, y, z),
        quad(x, z, y),
        quad(o, x, z),
        quad(y, z, x),
    ]
}

pub(crate) fn frame(o: DVec3) -> Frame {
    Frame::new(o, v(1.0, 2.0, 2.0), DVec3::X).unwrap()
}

pub(crate) fn sphere(center: DVec3, radius: f64) -> SurfaceRef {
    let options = QuadricOptions {
        frame: frame(center),
        range: [None; 2],
    };
    Arc::new(Quadric::new(QuadricShape::Sphere, &[radius], options).unwrap())
}

pub(crate) fn torus(center: DVec3, major: f64, minor: f64) -> SurfaceRef {
    let options = TorusOptions {
        frame: frame(center),
        ..TorusOptions::default()
    };
    Arc::new(Torus::new(major, minor, options).unwrap())
}

pub(crate) fn moved(surfaces: &[SurfaceRef], scale: f64, by: DVec3) -> Vec<SurfaceRef> {
    let map = DAffine3::from_mat3_translation(DMat3::from_diagonal(DVec3::splat(scale)), by);
    let image =
        |s: &SurfaceRef| -> SurfaceRef { Arc::new(Transformed::new(s.clone(), map).unwrap()) };
    surfaces.iter().map(image).collect()
}
