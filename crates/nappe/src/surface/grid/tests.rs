use super::columns::COLUMNS;
use super::*;
use crate::basis::{BSplineBasis, FunctionsRef};
use crate::exact::NurbsSurface;
use crate::laws::Random;
use crate::surface::{Core, Term, Torus, TorusOptions, jet_len, normal_at, pairs};
use glam::DVec4;
use std::sync::Arc;

const COUNTS: [usize; 2] = [6, 7];

fn net(weights: bool) -> Separable {
    let mut random = Random(3);
    let points: Vec<DVec3> = (0..42)
        .map(|i| DVec3::new((i / 7) as f64, (i % 7) as f64, random.unit()))
        .collect();
    let weights: Option<Vec<f64>> = weights.then(|| (0..42).map(|_| 0.5 + random.unit()).collect());
    let knots = COUNTS.map(|n| BSplineBasis::clamped_uniform(3, n));
    let s = NurbsSurface::new([3, 3], knots, &points, weights.as_deref()).unwrap();
    s.separable().clone()
}

/// The same net as terms, with coordinates that few functions move: a flat sheet, bent once.
fn sparse(weights: bool) -> Separable {
    let [u, v] = COUNTS.map(|n| -> FunctionsRef {
        Arc::new(BSplineBasis::new(3, BSplineBasis::clamped_uniform(3, n)).unwrap())
    });
    let Core::Net(net) = net(weights).core().clone() else {
        unreachable!("a NURBS surface has a net")
    };
    let terms = net.iter().enumerate().map(|(at, &c)| {
        let z = if at % 7 == 3 { c.z } else { 0.0 };
        Term::new(at / 7, at % 7, DVec4::new(c.x, c.y, z, c.w))
    });
    let core = Core::Terms(terms.collect());
    let origin = DVec3::new(0.5, -0.25, -0.0);
    if weights {
        Separable::rational(u, v, core, origin)
    } else {
        Separable::polynomial(u, v, core, origin)
    }
}

fn bits(x: &[DVec3]) -> Vec<[u64; 3]> {
    x.iter().map(|x| x.to_array().map(f64::to_bits)).collect()
}

/// Low degrees have code of their own, and single points of high ones need more room.
#[test]
fn nets_of_all_degrees_give_the_bits_of_single_points() {
    for degrees in [
        [1, 1],
        [2, 2],
        [3, 3],
        [2, 3],
        [7, 7],
        [3, 9],
        [9, 8],
        [25, 1],
    ] {
        let counts = degrees.map(|d| d + 3);
        let knots = [0, 1].map(|k| BSplineBasis::clamped_uniform(degrees[k], counts[k]));
        let mut random = Random(4);
        let n = counts[0] * counts[1];
        let points: Vec<DVec3> = (0..n).map(|_| DVec3::splat(random.unit())).collect();
        let weights: Vec<f64> = (0..n).map(|_| 0.5 + random.unit()).collect();
        let surface = NurbsSurface::new(degrees, knots, &points, Some(&weights)).unwrap();
        let t: Vec<f64> = (0..11).map(|_| random.unit()).collect();
        for order in 0..=3 {
            let each = jet_len(order);
            let mut grid = vec![DVec3::ZERO; each * t.len() * t.len()];
            surface.grid_jets(&t, &t, order, &mut grid);
            let mut single = grid.clone();
            for (jet, uv) in single.chunks_exact_mut(each).zip(pairs(&t, &t)) {
                surface.jet_into(uv, [Limit::Above; 2], order, jet);
            }
            assert_eq!(bits(&grid), bits(&single), "{degrees:?} {order}");
        }
    }
}

/// Rows that are evaluated in parts, the last of which is shorter than a register.
#[test]
fn long_rows_are_single_points() {
    for surface in [net(false), net(true), sparse(false), sparse(true)] {
        let [du, dv] = surface.domain();
        let n = 2 * COLUMNS + 3;
        let v: Vec<f64> = (0..n)
            .map(|j| dv.lo + (dv.hi - dv.lo) * j as f64 / (n - 1) as f64)
            .collect();
        let u = [du.lo, du.mid(), du.hi];
        let mut points = vec![DVec3::ZERO; 3 * n];
        jets(&surface, &u, &v, 0, &mut points);
        let mut pairs = vec![[DVec3::ZERO; 2]; 3 * n];
        normals(&surface, &u, &v, &mut pairs);
        let uv = u.iter().flat_map(|&u| v.iter().map(move |&v| [u, v]));
        for (k, uv) in uv.enumerate() {
            let normal = normal_at(&surface, uv, [Limit::Above; 2]).vector();
            let single = [surface.point(uv), normal.unwrap_or(DVec3::ZERO)];
            assert_eq!([points[k], pairs[k][1]], single, "{uv:?}");
            assert_eq!(pairs[k][0], single[0], "{uv:?}");
        }
    }
}

/// Nets and sparse cores, rational and not, at knots, beside them, and in pieces with fewer columns than lanes.
#[test]
fn all_instruction_sets_give_the_bits_of_single_points() {
    // It touches its axis: normals are limits there.
    let torus = Torus::new(1.0, 1.0, TorusOptions::default()).unwrap();
    let torus = torus.to_nurbs().unwrap();
    let nets = [false, true].map(net);
    let sparse = [false, true].map(sparse);
    let huge = nets[1].transformed(&glam::DAffine3::from_scale(DVec3::splat(1e200)));
    let surfaces = nets.iter().chain(&sparse).chain([torus.separable(), &huge]);
    for (k, surface) in surfaces.enumerate() {
        let of = |dir, n: usize| -> Vec<f64> {
            let d = surface.breaks(dir).domain();
            let even = (0..n).map(|i| d.lo + (d.hi - d.lo) * i as f64 / (n - 1) as f64);
            even.flat_map(|t| [t, t.next_up()])
                .filter(|&t| t <= d.hi)
                .collect()
        };
        for n in [3, 9, 37] {
            let (u, v) = (of(Dir::U, 5), of(Dir::V, n));
            let uv: Vec<[f64; 2]> = u
                .iter()
                .flat_map(|&u| v.iter().map(move |&v| [u, v]))
                .collect();
            for set in InstructionSet::all() {
                for order in 0..=KERNEL_ORDER {
                    let each = crate::surface::jet_len(order);
                    // Through the caches and past them.
                    for large in [usize::MAX, 0] {
                        let mut out = vec![DVec3::ZERO; uv.len() * each];
                        let (u, v) = (&u, &v);
                        Places::of(&mut out, 3 * each, large, |out| {
                            jets_on(set, Grid { surface, u, v, out }, order);
                        });
                        for (out, &uv) in out.chunks_exact(each).zip(&uv) {
                            let single = surface.jet(uv, [Limit::Above; 2], order).d;
                            assert_eq!(bits(out), bits(&single), "{k}, {uv:?}, order {order}");
                        }
                    }
                }
                for large in [usize::MAX, 0] {
                    let mut out = vec![[DVec3::ZERO; 2]; uv.len()];
                    let (u, v) = (&u, &v);
                    Places::of(out.as_flattened_mut(), 6, large, |out| {
                        normals_on(set, Grid { surface, u, v, out });
                    });
                    for (out, &uv) in out.iter().zip(&uv) {
                        let normal = normal_at(surface, uv, [Limit::Above; 2]);
                        let single = [surface.point(uv), normal.vector().unwrap_or(DVec3::ZERO)];
                        assert_eq!(bits(out), bits(&single), "{k}, {uv:?}, normal");
                    }
                }
            }
        }
    }
}
