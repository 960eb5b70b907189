#![allow(clippy::unwrap_used)]
use nappe::measure::CurvatureKind;
use nappe::query::*;
use nappe::surface::*;
use nappe::*;
use std::sync::Arc;
use std::time::Instant;
#[test]
fn dbg() {
    let sphere: SurfaceRef = Arc::new(Quadric::new(QuadricShape::Sphere, &[2.0], QuadricOptions::default()).unwrap());
    let torus: SurfaceRef = Arc::new(Torus::new(3.0, 1.0, TorusOptions::default()).unwrap());
    println!("sphere {:?} {:?}", sphere.breaks(Dir::U), sphere.breaks(Dir::V));
    println!("torus {:?}", torus.breaks(Dir::U));
    let cases: Vec<(&str, SurfaceRef, Figure)> = vec![
        ("sph X", sphere.clone(), Figure::Silhouette { direction: DVec3::X }),
        ("sph Z", sphere.clone(), Figure::Silhouette { direction: DVec3::Z }),
        ("sph 110", sphere.clone(), Figure::Silhouette { direction: DVec3::new(1.0, 1.0, 0.0) }),
        ("sph gen", sphere.clone(), Figure::Silhouette { direction: DVec3::new(1.0, 2.0, -0.5) }),
        ("sph eye", sphere.clone(), Figure::SilhouetteFrom { eye: DVec3::new(0.0, 3.0, 4.0) }),
        ("tor Z", torus.clone(), Figure::Silhouette { direction: DVec3::Z }),
        ("tor gen", torus.clone(), Figure::Silhouette { direction: DVec3::new(1.0, 0.0, 0.2) }),
        ("tor x=0", torus.clone(), Figure::Section { point: DVec3::ZERO, normal: DVec3::X }),
        ("tor x=2", torus.clone(), Figure::Section { point: DVec3::X * 2.0, normal: DVec3::X }),
        ("tor z=0", torus.clone(), Figure::Section { point: DVec3::ZERO, normal: DVec3::Z }),
        ("tor K0", torus.clone(), Figure::Curvature { kind: CurvatureKind::Gaussian, value: 0.0 }),
        ("tor K", torus.clone(), Figure::Curvature { kind: CurvatureKind::Gaussian, value: 0.5 / 3.5 }),
        ("tor H", torus.clone(), Figure::Curvature { kind: CurvatureKind::Mean, value: -4.0 / 7.0 }),
    ];
    for (name, s, fig) in cases {
        let t0 = Instant::now();
        let f = SurfaceField::new(s.clone(), fig).unwrap();
        let t = trace(&f, &TraceOptions { surface: Some(s), tol: Some(1e-3), budget: 20000, ..Default::default() }).unwrap();
        println!("{name}: {} branches, {} undecided, {} touches, {} cells, {:.2}s", t.branches.len(), t.undecided.len(), t.touches.len(), t.cells, t0.elapsed().as_secs_f64());
        for b in t.branches.iter().take(6) {
            let c = b.curve();
            println!("   {:?} {:?} {:?} {:?} pieces {}", b.bounds().map(|i| (i.lo, i.hi)), b.ends, b.certainty, c.ends(), c.breaks().len());
        }
        for u in t.undecided.iter().take(4) {
            println!("   und {} cells {:?} ends {}", u.cells.len(), u.hull.map(|i| (i.lo, i.hi)), u.ends);
        }
    }
}
