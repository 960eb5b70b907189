//! Whole surfaces as bodies: about as many triangles as without edges, near the surface on both sides.

use crate::mesh::{Maker, open_edges, plane};
use crate::shapes::*;
use nappe::body::{Body, Face, Meshed, mesh, sew};
use nappe::query::{Finder, FinderOptions};
use nappe::surface::{Quadric, QuadricOptions, QuadricShape, SurfaceRef};
use nappe::{Certainty, DVec3, MeshOptions};
use std::sync::Arc;

fn quadric(shape: QuadricShape, axes: &[f64]) -> SurfaceRef {
    let options = QuadricOptions {
        frame: frame(v(1.0, 2.0, 3.0)),
        range: [None; 2],
    };
    Arc::new(Quadric::new(shape, axes, options).unwrap())
}

fn all() -> Vec<(&'static str, SurfaceRef)> {
    vec![
        ("sphere", sphere(v(1.0, 2.0, 3.0), 2.0)),
        ("torus", torus(v(1.0, 2.0, 3.0), 3.0, 1.0)),
        (
            "ellipsoid",
            quadric(QuadricShape::Ellipsoid, &[1.0, 2.0, 3.0]),
        ),
        ("cylinder", quadric(QuadricShape::Cylinder, &[1.0])),
        ("cone", quadric(QuadricShape::Cone, &[1.0, 1.0, 1.0])),
    ]
}

/// The distance of a point from a triangle.
fn apart(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let n = (b - a).cross(c - a);
    let sides = [(a, b), (b, c), (c, a)];
    if sides.iter().all(|&(s, e)| n.cross(e - s).dot(p - s) >= 0.0) && n != DVec3::ZERO {
        return ((p - a).dot(n) / n.length()).abs();
    }
    let side = |&(s, e): &(DVec3, DVec3)| {
        let t = (p - s).dot(e - s) / (e - s).length_squared();
        (s + (e - s) * t.clamp(0.0, 1.0)).distance(p)
    };
    sides.iter().map(side).fold(f64::INFINITY, f64::min)
}

fn triangles(m: &Meshed, face: usize) -> Vec<[DVec3; 3]> {
    let patch = &m.mesh.patches[face];
    let point = |k: u32| m.mesh.points[patch.vertices[k as usize].point as usize];
    patch.triangles.iter().map(|t| t.map(point)).collect()
}

/// Points of a whole surface and of its triangles are within the deviation of each other.
fn two_sided(name: &str, m: &Meshed, surface: &SurfaceRef) {
    let Certainty::Bounded(e) = m.mesh.patches[0].deviation else {
        panic!("{name}: {:?}", m.mesh.patches[0].deviation)
    };
    let made = triangles(m, 0);
    const SAMPLES: usize = 17;
    let [u, v] = surface.domain();
    for k in 0..SAMPLES * SAMPLES {
        let at =
            |i: nappe::Interval, k: usize| i.lo + i.width() * (k as f64 + 0.3) / SAMPLES as f64;
        let p = surface.point([at(u, k / SAMPLES), at(v, k % SAMPLES)]);
        let d = made
            .iter()
            .map(|t| apart(p, *t))
            .fold(f64::INFINITY, f64::min);
        assert!(
            d <= e,
            "{name}: {p} is {d:e} from the mesh, more than {e:e}"
        );
    }
    let options = FinderOptions {
        tol: Some(1e-3 * e),
        ..FinderOptions::default()
    };
    let finder = Finder::new(std::slice::from_ref(surface), options).unwrap();
    for t in made.iter().step_by(1 + made.len() / 500) {
        for w in [[1.0, 1.0, 1.0], [1.0, 1.0, 0.0], [0.2, 0.5, 0.3]] {
            let q = (t[0] * w[0] + t[1] * w[1] + t[2] * w[2]) / (w[0] + w[1] + w[2]);
            let d = finder.nearest(q).unwrap().distance;
            assert!(
                d <= 1.01 * e,
                "{name}: {q} is {d:e} from the surface, more than {e:e}"
            );
        }
    }
}

/// With a disc far away, which is no whole surface: nothing is meshed as such.
fn with_disc(body: &Body) -> Body {
    let mut m = Maker { body: body.clone() };
    let o = v(50.0, 0.0, 0.0);
    let edge = m.circle(o, DVec3::Z, 1.0) as i32 + 1;
    m.face(plane(o, DVec3::Z), true, &[&[edge]]);
    m.body
}

#[test]
fn whole_surfaces_need_about_as_many_triangles_as_without_edges() {
    let tol = 3e-2;
    let options = MeshOptions::with_tol(tol);
    for (name, s) in all() {
        let surfaces = [s.clone()];
        let alone = nappe::mesh::mesh(&surfaces, &options).unwrap();
        let body = sew(&surfaces, 1e-6).body;
        let border = body.uses().iter().filter(|u| u.len() == 1).count();
        // As the mesh of the surface, to the last triangle.
        let whole = mesh(&body, &options).unwrap();
        assert_eq!(whole.failed, []);
        let count = alone.patches[0].triangles.len();
        assert_eq!(whole.mesh.patches[0].triangles.len(), count, "{name}");
        // As a trimmed face.
        let trimmed = mesh(&with_disc(&body), &options).unwrap();
        assert_eq!(trimmed.failed, [], "{name}");
        let patches = &trimmed.mesh.patches;
        assert!(patches[0].deviation.error() <= tol, "{name}");
        let made = patches[0].triangles.len();
        println!("{name}: {made} of {count}");
        assert!(made <= 4 * count + 64, "{name}: {made} of {count}");
        for m in [&whole, &trimmed] {
            two_sided(name, m, &s);
        }
        assert_eq!(open_edges(&whole) == 0, border == 0, "{name}");
        let mut only = trimmed.clone();
        only.mesh.patches.truncate(1);
        assert_eq!(open_edges(&only) == 0, border == 0, "{name}");
    }
}

#[test]
fn a_face_without_loops_is_its_closed_surface() {
    for s in [sphere(DVec3::ZERO, 1.0), torus(DVec3::ZERO, 3.0, 1.0)] {
        let mut body = Body::default();
        body.faces.push(Face {
            surface: s.clone(),
            forward: true,
            loops: Vec::new(),
        });
        let m = mesh(&body, &MeshOptions::with_tol(1e-2)).unwrap();
        assert_eq!(m.failed, []);
        assert_eq!(open_edges(&m), 0);
        two_sided("no loops", &m, &s);
    }
}
