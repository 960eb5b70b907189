//! Whole surfaces as bodies: about as many triangles as without edges.

use crate::mesh::{area, check, near, open_edges, volume};
use crate::shapes::*;
use nappe::body::{Body, mesh, sew};
use nappe::curve::{Ellipse, EllipseOptions, Line};
use nappe::exact::NurbsSurface;
use nappe::surface::{
    Construction, Quadric, QuadricOptions, QuadricShape, Revolution, RevolutionOptions, SurfaceRef,
};
use nappe::{CurveRef, DVec3, Frame, MeshOptions};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

fn quadric(shape: QuadricShape, axes: &[f64], range: [Option<[f64; 2]>; 2]) -> SurfaceRef {
    let options = QuadricOptions {
        frame: frame(v(1.0, 2.0, 3.0)),
        range,
    };
    Arc::new(Quadric::new(shape, axes, options).unwrap())
}

#[test]
fn probe() {
    let all: Vec<(&str, SurfaceRef)> = vec![
        ("sphere", sphere(v(1.0, 2.0, 3.0), 2.0)),
        ("torus", torus(v(1.0, 2.0, 3.0), 3.0, 1.0)),
        (
            "cylinder",
            quadric(QuadricShape::Cylinder, &[1.0], [None; 2]),
        ),
        (
            "cone",
            quadric(QuadricShape::Cone, &[1.0, 1.0, 1.0], [None; 2]),
        ),
        (
            "ellipsoid",
            quadric(QuadricShape::Ellipsoid, &[1.0, 2.0, 3.0], [None; 2]),
        ),
    ];
    let filter = std::env::var("PROBE").unwrap_or_default();
    for (name, s) in all.iter().filter(|(n, _)| n.contains(&filter)) {
        let whole = nappe::mesh::mesh(&[s.clone()], &MeshOptions::with_tol(1e-3)).unwrap();
        let t = std::time::Instant::now();
        let m = mesh(&sew(&[s.clone()], 1e-6).body, &MeshOptions::with_tol(1e-3)).unwrap();
        println!(
            "{name}: {} of {}, {:?} of {:?}, open {}, failed {:?}, {:?}",
            m.mesh.patches[0].triangles.len(),
            whole.patches[0].triangles.len(),
            m.mesh.patches[0].deviation,
            whole.patches[0].deviation,
            open_edges(&m),
            m.failed,
            t.elapsed()
        );
    }
}
