//! A million random points: no bound is violated, and nothing is nearer than an answer says. Minutes of work: run it with
//! `cargo test --release -p nappe --test query million -- --ignored`.

use crate::{check, finder, rough, sphere, torus, within};
use nappe::DVec3;
use nappe::laws::Random;
use nappe::query::Nearest;
use nappe::surface::SurfaceRef;

const POINTS: usize = 200_000;
/// Every so many answers are compared with brute force.
const COMPARED: usize = 97;
/// Rows and columns of the samples for that.
const SAMPLES: usize = 120;

/// Nearest points of random points near a surface, within a twentieth of its size and within all of it.
fn answers(seed: u64, surface: &SurfaceRef, tol: f64) -> Vec<(DVec3, Nearest)> {
    let mut random = Random(seed);
    let domain = surface.domain();
    let size = surface.bounds(domain).diagonal();
    let points: Vec<DVec3> = (0..POINTS)
        .map(|k| {
            let p = surface.point(domain.map(|t| random.within(t)));
            p + within(&mut random, size * [0.05, 0.5, 1e-3][k % 3])
        })
        .collect();
    let surfaces = [surface.clone()];
    let found = finder(&surfaces, tol).nearest_many(&points, 2);
    let found = points.into_iter().zip(found);
    found
        .map(|(p, found)| {
            let found = found.unwrap();
            check(&surfaces, p, &found, tol);
            (p, found)
        })
        .collect()
}

#[test]
#[ignore = "minutes"]
fn spheres_and_tori() {
    let ring = |p: DVec3| (p.truncate().length() - 3.0).hypot(p.z) - 1.0;
    for (p, found) in answers(1, &sphere(2.0), 1e-9) {
        assert!(
            (found.distance - (p.length() - 2.0).abs()).abs() <= 1e-9,
            "{p} {found:?}"
        );
    }
    for (p, found) in answers(2, &torus(), 1e-9) {
        assert!(
            (found.distance - ring(p).abs()).abs() <= 1e-9,
            "{p} {found:?}"
        );
    }
}

#[test]
#[ignore = "minutes"]
fn splines_by_brute_force() {
    for (seed, surface) in [
        (3, rough(3, 20, false)),
        (4, rough(2, 6, true)),
        (5, rough(5, 9, false)),
    ] {
        let domain = surface.domain();
        let at = |d: usize, k: usize| domain[d].lo + domain[d].width() * k as f64 / SAMPLES as f64;
        let places: Vec<[f64; 2]> = (0..=SAMPLES)
            .flat_map(|i| (0..=SAMPLES).map(move |j| [i, j]))
            .map(|[i, j]| [at(0, i), at(1, j)])
            .collect();
        let points: Vec<DVec3> = places.iter().map(|&uv| surface.point(uv)).collect();
        let all = answers(seed, &surface, 1e-8);
        for (p, found) in all.iter().step_by(COMPARED) {
            let first = (0..points.len())
                .min_by(|&i, &j| points[i].distance(*p).total_cmp(&points[j].distance(*p)));
            // From the best sample down, by steps that get shorter.
            let (mut uv, mut step) = (places[first.unwrap()], 1.0 / SAMPLES as f64);
            let mut least = surface.point(uv).distance(*p);
            while step > 1e-9 {
                let mut better = false;
                for k in (0..9).filter(|&k| k != 4) {
                    let to = [0, 1].map(|d| {
                        let by = [k % 3, k / 3][d] as f64 - 1.0;
                        let to = uv[d] + by * step * domain[d].width();
                        to.clamp(domain[d].lo, domain[d].hi)
                    });
                    let there = surface.point(to).distance(*p);
                    if there < least {
                        (uv, least, better) = (to, there, true);
                    }
                }
                if !better {
                    step *= 0.5;
                }
            }
            assert!(
                least >= found.distance - found.certainty.error(),
                "{p} {found:?} {uv:?}"
            );
        }
    }
}
