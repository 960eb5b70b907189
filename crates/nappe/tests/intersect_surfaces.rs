//! Surfaces through surfaces.

#![allow(clippy::unwrap_used)]

use nappe::laws::Random;
use nappe::query::{IntersectOptions, SurfaceSurface, intersect_surfaces};
use nappe::surface::{
    Quadric, QuadricOptions, QuadricShape, SurfaceRef, Torus, TorusOptions, Transformed, bilinear,
};
use nappe::{Certainty, Curve, DAffine3, DVec3, Interval, NurbsSurface, Surface};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;
use std::time::Instant;

fn sphere(radius: f64) -> Quadric {
    Quadric::new(QuadricShape::Sphere, &[radius], QuadricOptions::default()).unwrap()
}

fn moved(s: &SurfaceRef, by: [f64; 3]) -> SurfaceRef {
    let map = DAffine3::from_translation(DVec3::from(by));
    Arc::new(Transformed::new(s.clone(), map).unwrap())
}

fn show(name: &str, f: &SurfaceSurface, t: Instant) {
    println!(
        "{name}: {} branches, {} undecided, {} touches, {} boxes, {:?}",
        f.branches.len(),
        f.undecided.len(),
        f.touches.len(),
        f.boxes,
        t.elapsed()
    );
    for b in &f.branches {
        println!(
            "  closed {} ends {:?} {:?} bounds {:?} pieces {}",
            b.is_closed(),
            b.ends,
            b.certainty,
            b.bounds(0),
            b.on(0).breaks().len()
        );
    }
    for u in f.undecided.iter().take(6) {
        println!("  {u} {} boxes", u.boxes.len());
    }
}

#[test]
fn explore() {
    let go = |name: &str, a: &SurfaceRef, b: &SurfaceRef| {
        let t = Instant::now();
        let f = intersect_surfaces(a, b, &IntersectOptions::default()).unwrap();
        show(name, &f, t);
    };
    let ring: SurfaceRef = Arc::new(Torus::new(3.0, 1.0, TorusOptions::default()).unwrap());
    go("tori", &ring, &moved(&ring, [4.1, 0.2, 0.3]));
    let ball: SurfaceRef = Arc::new(sphere(1.0));
    go("spheres", &ball, &moved(&ball, [1.1, 0.2, 0.3]));
    let nurbs: SurfaceRef = Arc::new(ball.to_nurbs().unwrap());
    go("nurbs spheres", &nurbs, &moved(&nurbs, [1.1, 0.2, 0.3]));
    go("touching", &nurbs, &moved(&nurbs, [1.2, 1.6, 0.0]));
    let plane: SurfaceRef = Arc::new(
        bilinear([
            [DVec3::new(-5.0, -5.0, 0.3), DVec3::new(-5.0, 5.0, 0.3)],
            [DVec3::new(5.0, -5.0, 0.3), DVec3::new(5.0, 5.0, 0.4)],
        ])
        .unwrap(),
    );
    go("ring plane", &ring, &plane);
    go("same", &ball, &ball);
}
