//! Surfaces that continue their neighbours, on the contours of a real model: every patch of the Utah teapot is taken out and
//! made anew from its four sides and the surfaces around it.

#![allow(clippy::unwrap_used)]

use nappe::DVec3;
use nappe::basis::Blending;
use nappe::curve::{CrossDerivative, CurveRef, Isocurve};
use nappe::exact::NurbsSurface;
use nappe::measure::{JumpOptions, continuity};
use nappe::mesh::Certainty;
use nappe::surface::{
    Blend, BlendOptions, Contour, Coons, CoonsOptions, Cross, DiagonalKey, DiagonalKeyError,
    DiagonalKeyOptions, IncompatibleTwists, Side, Surface, SurfaceRef,
};
use std::sync::Arc;

/// The 32 bicubic patches, in units of about the teapot's radius.
fn teapot() -> Vec<SurfaceRef> {
    let numbers: Vec<f64> = include_str!("data/teapot.txt")
        .lines()
        .filter(|l| !l.starts_with('#'))
        .flat_map(str::split_whitespace)
        .map(|x| x.parse().unwrap())
        .collect();
    let points: Vec<DVec3> = numbers.chunks_exact(3).map(DVec3::from_slice).collect();
    let patch = |p: &[DVec3]| Arc::new(NurbsSurface::bezier(4, p, None).unwrap()) as SurfaceRef;
    points.chunks_exact(16).map(patch).collect()
}

/// The greatest angle that is proven along two sides that meet; infinite if they do not, or nothing is proven.
fn angle(a: (&dyn Surface, Side), b: (&dyn Surface, Side), parts: usize) -> f64 {
    let options = JumpOptions {
        parts,
        ..JumpOptions::default()
    };
    match continuity(a, b, 1e-9, &options).map(|c| c.angle.greatest) {
        Some(Certainty::Bounded(e)) => e,
        _ => f64::INFINITY,
    }
}

fn side(s: &SurfaceRef, side: Side) -> CurveRef {
    Arc::new(Isocurve::side(s.clone(), side))
}

/// Enough parts to prove a small angle closely, and enough to prove that it is small.
const CLOSELY: usize = 512;
const ROUGHLY: usize = 64;

/// The neighbour across each side, if the patch is proven to meet it within a hundredth of a degree.
fn smooth_neighbours(all: &[SurfaceRef], patch: usize) -> [Option<(SurfaceRef, Side)>; 4] {
    Side::ALL.map(|own| {
        let others = (0..all.len()).filter(|&k| k != patch);
        let sides = others.flat_map(|k| Side::ALL.map(|s| (all[k].clone(), s)));
        sides.into_iter().find(|(s, other)| {
            angle((all[patch].as_ref(), own), (s.as_ref(), *other), ROUGHLY) < 1.7e-4
        })
    })
}

/// A Coons surface on the sides of a patch, with the cross-derivatives from all neighbours that the patch itself meets
/// smoothly, meets each of these with an angle of rounding.
#[test]
fn a_coons_surface_takes_the_place_of_a_patch() {
    let all = teapot();
    let (mut made, mut joints, mut worst) = (0, 0, 0.0f64);
    for (k, patch) in all.iter().enumerate() {
        let around = smooth_neighbours(&all, k);
        if around.iter().all(Option::is_none) {
            continue;
        }
        let [south, north, west, east] = Side::ALL.map(|s| side(patch, s));
        let cross = around.clone().map(|n| match n {
            Some((surface, side)) => Cross::Neighbour { surface, side },
            None => Cross::Estimated,
        });
        let options = CoonsOptions {
            blend: Blending::cubic(),
            cross,
            incompatible_twists: IncompatibleTwists::Gregory,
            ..CoonsOptions::default()
        };
        let coons = match Coons::new(south, north, west, east, &options) {
            Ok(c) => c,
            Err(e) => panic!("patch {k}: {e}"),
        };
        made += 1;
        for (own, other) in Side::ALL.into_iter().zip(&around) {
            let Some((surface, other)) = other else {
                continue;
            };
            let greatest = angle((&coons, own), (surface.as_ref(), *other), CLOSELY);
            joints += 1;
            worst = worst.max(greatest);
        }
    }
    println!("{made} surfaces, {joints} joints, at most {worst:e}");
    // No patch has a fault that would keep it from being made.
    assert!(made == 32 && joints >= 100);
    assert!(worst <= 1e-9);
}

/// The same with the Diagonal-key surface, whose tangents along both guides, south and north, are the neighbours'
/// derivatives: where the generators begin and end with these, as those of a patch do whose neighbours have equal ones.
#[test]
fn a_diagonal_key_surface_takes_the_place_of_a_patch() {
    let all = teapot();
    let (mut joints, mut worst) = (0, 0.0f64);
    for (k, patch) in all.iter().enumerate() {
        let around = smooth_neighbours(&all, k);
        let [Some((first, Side::North)), Some((second, Side::South)), ..] = &around else {
            continue;
        };
        let derivative = |s: &SurfaceRef, side: Side| -> CurveRef {
            Arc::new(CrossDerivative::side(s.clone(), side))
        };
        let [south, north, west, east] = Side::ALL.map(|s| side(patch, s));
        let make = |both: [bool; 2]| {
            let [south, north, west, east] = [&south, &north, &west, &east].map(Arc::clone);
            let contour = Contour::new(south, north, west, east).unwrap();
            let tangents = [
                both[0].then(|| derivative(first, Side::North)),
                both[1].then(|| derivative(second, Side::South)),
            ];
            let exchange = true;
            let options = DiagonalKeyOptions {
                exchange,
                tangents,
                ..DiagonalKeyOptions::default()
            };
            DiagonalKey::new(contour, &options)
        };
        // Both at once are impossible where the generators lie in parallel planes: then one after the other.
        let made = match make([true; 2]) {
            Ok(s) => vec![([true; 2], s)],
            Err(DiagonalKeyError::Singular { .. }) => {
                let one = [[true, false], [false, true]];
                one.map(|both| (both, make(both).unwrap())).into()
            }
            Err(e) => panic!("patch {k}: {e}"),
        };
        for (both, surface) in made {
            for (is_met, (own, (other, side))) in both.into_iter().zip([
                (Side::South, (first, Side::North)),
                (Side::North, (second, Side::South)),
            ]) {
                if is_met {
                    joints += 1;
                    worst = worst.max(angle((&surface, own), (other.as_ref(), side), CLOSELY));
                }
            }
        }
    }
    println!("{joints} joints, at most {worst:e}");
    assert!(joints >= 40);
    assert!(worst <= 1e-8);
}

/// A blend from neighbour to neighbour in the place of a patch meets both with the curvatures of the neighbours.
#[test]
fn a_blend_takes_the_place_of_a_patch() {
    let all = teapot();
    let (mut joints, mut worst) = (0, [0.0f64; 3]);
    for k in 0..all.len() {
        let around = smooth_neighbours(&all, k);
        for pair in [[0, 1], [2, 3]] {
            let [Some(first), Some(second)] = pair.map(|i| around[i].clone()) else {
                continue;
            };
            // Round the handle and the spout both sides are sides of one patch.
            let ends = [first.clone(), second.clone()];
            let Ok(blend) = Blend::new(first, second, &BlendOptions::default()) else {
                continue;
            };
            for ((s, other), own) in ends.iter().zip([Side::South, Side::North]) {
                let options = JumpOptions::default();
                let c = continuity((s.as_ref(), *other), (&blend, own), 1e-9, &options).unwrap();
                joints += 1;
                for (w, j) in worst.iter_mut().zip([c.gap, c.angle, c.curvature]) {
                    let Certainty::Bounded(e) = j.greatest else {
                        panic!("{k}: {j:?}")
                    };
                    *w = w.max(e);
                }
            }
        }
    }
    println!("{joints} joints, at most {worst:?}");
    assert!(joints >= 40);
    assert!(
        worst[0] <= 1e-12 && worst[1] <= 1e-8 && worst[2] <= 1e-5,
        "{worst:?}"
    );
}
