//! Surfaces through surfaces: closed forms, and random ones against fine grids.

#![allow(clippy::unwrap_used)]

use nappe::laws::Random;
use nappe::query::{
    BranchEnd, IntersectOptions, SurfaceSurface, SurfacesError, intersect_surfaces,
};
use nappe::surface::{
    Quadric, QuadricOptions, QuadricShape, SurfaceRef, Torus, TorusOptions, Transformed, bilinear,
};
use nappe::{Certainty, Curve, DAffine3, DMat3, DVec3, NurbsSurface, Surface};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

fn quadric(shape: QuadricShape, axes: &[f64], range: [Option<[f64; 2]>; 2]) -> SurfaceRef {
    let options = QuadricOptions {
        range,
        ..QuadricOptions::default()
    };
    let q = Quadric::new(shape, axes, options).unwrap();
    // As a net of control points: nothing tells what it is.
    Arc::new(q.to_nurbs().unwrap())
}

fn sphere(radius: f64) -> SurfaceRef {
    quadric(QuadricShape::Sphere, &[radius], [None; 2])
}

/// About z, from -2 to 2.
fn cylinder(radius: f64) -> SurfaceRef {
    let range = [None, Some([-2.0, 2.0])];
    quadric(QuadricShape::Cylinder, &[radius, radius], range)
}

fn torus() -> SurfaceRef {
    Arc::new(Torus::new(3.0, 1.0, TorusOptions::default()).unwrap())
}

fn mapped(s: &SurfaceRef, map: DAffine3) -> SurfaceRef {
    Arc::new(Transformed::new(s.clone(), map).unwrap())
}

fn moved(s: &SurfaceRef, by: [f64; 3]) -> SurfaceRef {
    mapped(s, DAffine3::from_translation(DVec3::from(by)))
}

/// The parallelogram about a point with two half sides.
fn sheet(middle: [f64; 3], u: [f64; 3], v: [f64; 3]) -> SurfaceRef {
    let [m, u, v] = [middle, u, v].map(DVec3::from);
    Arc::new(bilinear([[m - u - v, m - u + v], [m + u - v, m + u + v]]).unwrap())
}

/// All that every answer is held to: both curves are within the bound of each other's surface, which is within the tolerance.
fn meet(a: &SurfaceRef, b: &SurfaceRef) -> SurfaceSurface {
    within(a, b, IntersectOptions::default().budget)
}

fn within(a: &SurfaceRef, b: &SurfaceRef, budget: usize) -> SurfaceSurface {
    let options = IntersectOptions { tol: None, budget };
    let found = intersect_surfaces(a, b, &options).unwrap();
    for branch in &found.branches {
        let Certainty::Bounded(error) = branch.certainty else {
            panic!("{:?}", branch.certainty);
        };
        let stuck = |e: &BranchEnd| matches!(e, BranchEnd::Undecided(_));
        let singular = branch.ends.is_some_and(|e| e.iter().any(stuck));
        assert!(singular || error <= found.tol, "{error:e} {:e}", found.tol);
        let [p, q] = [branch.on(0), branch.on(1)];
        for k in 0..=200 {
            let t = f64::from(k) / 200.0;
            let gap = p.point(t).distance(q.point(t));
            assert!(gap <= 2.0 * error, "{gap:e} {error:e} at {t}");
        }
        for curve in [p, q] {
            let [from, to] = curve.ends();
            let gap = from.distance(to);
            assert!(!branch.is_closed() || gap <= found.tol, "{gap:e}");
        }
    }
    found
}

fn counts(found: &SurfaceSurface) -> (usize, usize) {
    (found.branches.len(), found.undecided.len())
}

#[test]
fn two_spheres_meet_in_a_circle_at_any_scale_and_place() {
    for (scale, far) in [
        (1.0, 0.0),
        (1e-6, 0.0),
        (1e6, 0.0),
        (1.0, 1e4),
        (1e-3, -10.0),
    ] {
        let place = DVec3::new(far, 0.3 * far, -far);
        let put = |by: DVec3| {
            let map = DMat3::from_rotation_z(0.3) * DMat3::from_rotation_x(0.4) * scale;
            mapped(
                &sphere(1.0),
                DAffine3::from_mat3_translation(map, place + by * scale),
            )
        };
        let by = DVec3::new(1.1, 0.2, 0.3);
        let found = meet(&put(DVec3::ZERO), &put(by));
        assert_eq!(counts(&found), (1, 0), "{scale:e} {far:e}");
        let branch = &found.branches[0];
        assert!(branch.is_closed());
        let (half, n) = (0.5 * by.length(), by.normalize());
        let radius = (1.0 - half * half).sqrt();
        let curve = branch.curve();
        for k in 0..500 {
            let p = (curve.point(f64::from(k) / 500.0) - place) / scale;
            let height = p.dot(n) - half;
            let off = height.hypot((p - n * p.dot(n)).length() - radius);
            assert!(off * scale <= branch.certainty.error() * 1.01, "{off:e}");
        }
    }
}

#[test]
fn what_is_apart_has_no_curve_and_what_touches_is_told() {
    let ball = sphere(1.0);
    let apart = meet(&ball, &moved(&ball, [1.3, 1.6, 0.2]));
    assert_eq!(counts(&apart), (0, 0));
    // One inside the other.
    assert_eq!(counts(&meet(&ball, &sphere(0.9))), (0, 0));
    let touching = meet(&ball, &moved(&ball, [1.2, 1.6, 0.0]));
    assert_eq!(counts(&touching), (0, 1));
    let place = &touching.undecided[0];
    assert!(
        place.size < 1e-3 && !place.overlaps && place.ends == 0,
        "{place}"
    );
    assert!(place.point.distance(DVec3::new(0.6, 0.8, 0.0)) < 1e-3);
}

/// Four branches that cross at a point and at the one opposite to it, and all that is not decided is there.
fn crossings(found: &SurfaceSurface, at: DVec3) {
    let told: Vec<String> = found.undecided.iter().map(ToString::to_string).collect();
    assert_eq!(counts(found), (4, 2), "{told:?}");
    for place in &found.undecided {
        assert_eq!(place.ends, 4, "{place}");
        let off = place.point.distance(at).min(place.point.distance(-at));
        assert!(off < 0.01 && place.size < 0.01, "{place}");
    }
}

#[test]
fn cylinders_meet_in_two_loops_and_equal_ones_in_crossing_ellipses() {
    let turned = |s: &SurfaceRef| {
        let turn = DMat3::from_rotation_x(FRAC_PI_2) * DMat3::from_rotation_z(0.2);
        mapped(s, DAffine3::from_mat3(turn))
    };
    let thin = meet(&cylinder(1.0), &turned(&cylinder(0.7)));
    assert_eq!(counts(&thin), (2, 0));
    assert!(
        thin.branches
            .iter()
            .all(nappe::query::SurfaceCurve::is_closed)
    );
    // Axes z and y: x² + y² = 1 = x² + z², so y = ±z; they cross at x = ±1.
    let first = mapped(&cylinder(1.0), DAffine3::from_rotation_z(0.4));
    let equal = meet(&first, &turned(&cylinder(1.0)));
    crossings(&equal, DVec3::X);
    for branch in &equal.branches {
        let curve = branch.curve();
        for k in 0..=100 {
            let p = curve.point(f64::from(k) / 100.0);
            let off = (p.y.abs() - p.z.abs())
                .abs()
                .max((p.x.hypot(p.y) - 1.0).abs());
            assert!(off < 1e-5, "{off:e} {p}");
        }
    }
}

#[test]
fn a_plane_cuts_a_ring_in_loops_and_touching_it_twice_in_circles_that_cross() {
    let cut = meet(
        &torus(),
        &sheet([0.0, 0.0, 0.3], [5.0, 0.0, 0.1], [0.0, 5.0, 0.2]),
    );
    assert_eq!(counts(&cut), (2, 0));
    assert!(
        cut.branches
            .iter()
            .all(nappe::query::SurfaceCurve::is_closed)
    );
    // Only a part of the ring is over a small sheet.
    let part = meet(
        &torus(),
        &sheet([3.0, 0.0, 0.3], [1.5, 0.0, 0.0], [0.0, 1.0, 0.0]),
    );
    assert_eq!(counts(&part), (2, 0));
    assert!(
        part.branches
            .iter()
            .all(|b| b.ends == Some([BranchEnd::Border; 2]))
    );
    // Villarceau's circles, of radius 3, through the middle of the ring.
    let steep = (8f64).sqrt();
    let v = meet(
        &mapped(&torus(), DAffine3::from_rotation_z(0.3)),
        &sheet(
            [0.0; 3],
            [5.0 * steep / 3.0, 0.0, 5.0 / 3.0],
            [0.0, 5.0, 0.0],
        ),
    );
    crossings(&v, DVec3::new(steep * steep / 3.0, 0.0, steep / 3.0));
    for branch in &v.branches {
        let curve = branch.curve();
        for k in 0..=100 {
            let p = curve.point(f64::from(k) / 100.0);
            let circle = |y: f64| (p.distance(DVec3::new(0.0, y, 0.0)) - 3.0).abs();
            assert!(circle(1.0).min(circle(-1.0)) < 1e-4);
        }
    }
}

/// z over the unit square by a net of heights.
fn heights(net: &[[f64; 4]; 4], flipped: bool) -> SurfaceRef {
    let at = |i: usize| i as f64 / 3.0;
    let points: Vec<DVec3> = (0..16)
        .map(|k| {
            let (i, j) = if flipped {
                (3 - k % 4, k / 4)
            } else {
                (k / 4, k % 4)
            };
            DVec3::new(at(i), at(j), net[i][j])
        })
        .collect();
    let knots = vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let s = NurbsSurface::new([3, 3], [knots.clone(), knots], &points, None);
    Arc::new(s.unwrap())
}

/// The number of connected sets of cells of a fine grid in which a net of heights changes its sign, and the smallest size of
/// its gradient near its zeros.
fn components(net: &[[f64; 4]; 4]) -> usize {
    const N: usize = 300;
    let b = |t: f64| {
        let r = 1.0 - t;
        [r * r * r, 3.0 * r * r * t, 3.0 * r * t * t, t * t * t]
    };
    let value = |i: usize, j: usize| -> f64 {
        let (p, q) = (b(i as f64 / N as f64), b(j as f64 / N as f64));
        (0..4)
            .map(|k| (0..4).map(|l| p[k] * net[k][l] * q[l]).sum::<f64>())
            .sum()
    };
    let signs: Vec<bool> = (0..(N + 1) * (N + 1))
        .map(|k| value(k / (N + 1), k % (N + 1)) > 0.0)
        .collect();
    let mixed = |i: usize, j: usize| {
        let s = |i: usize, j: usize| signs[i * (N + 1) + j];
        let all = [s(i, j), s(i + 1, j), s(i, j + 1), s(i + 1, j + 1)];
        all.iter().any(|&x| x != all[0])
    };
    let mut seen = vec![false; N * N];
    let mut count = 0;
    for start in 0..N * N {
        if seen[start] || !mixed(start / N, start % N) {
            continue;
        }
        count += 1;
        let mut open = vec![start];
        seen[start] = true;
        while let Some(k) = open.pop() {
            let (i, j) = (k / N, k % N);
            for (di, dj) in (0..9).map(|m| (m / 3, m % 3)) {
                let (x, y) = (i + di, j + dj);
                if x < 1 || y < 1 || x > N || y > N {
                    continue;
                }
                let n = (x - 1) * N + y - 1;
                if !seen[n] && mixed(x - 1, y - 1) {
                    seen[n] = true;
                    open.push(n);
                }
            }
        }
    }
    count
}

#[test]
fn random_nets_have_the_branches_of_a_fine_grid() {
    let mut random = Random(11);
    let mut sum = 0;
    for _ in 0..25 {
        let mut net = || [[0; 4]; 4].map(|row| row.map(|_: i32| random.unit() - 0.5));
        let (a, b) = (net(), net());
        let mut difference = a;
        for i in 0..4 {
            for j in 0..4 {
                difference[i][j] -= b[i][j];
            }
        }
        let found = meet(&heights(&a, false), &heights(&b, true));
        assert_eq!(counts(&found), (components(&difference), 0));
        sum += found.branches.len();
    }
    assert!(sum > 25, "{sum}");
}

#[test]
fn tiny_loops_are_found() {
    // z = h - r² just above the plane z = 0: a loop of radius √h.
    for radius in [1e-2, 1e-3, 1e-4] {
        let mut net = [[0.0; 4]; 4];
        for (i, row) in net.iter_mut().enumerate() {
            for (j, z) in row.iter_mut().enumerate() {
                // (x - 1/2)² by its control points of degree 3.
                let square = |i: usize| [0.25, -0.25 / 3.0, -0.25 / 3.0, 0.25][i];
                *z = radius * radius - square(i) - square(j);
            }
        }
        let plane = sheet([0.5, 0.5, 0.0], [0.7, 0.1, 0.0], [0.0, 0.7, 0.0]);
        let found = meet(&heights(&net, false), &plane);
        assert_eq!(found.branches.len(), 1, "{radius:e}");
        assert!(found.branches[0].is_closed());
        // The smallest one is near what can be told from a contact.
        assert!(radius < 1e-3 || found.undecided.is_empty());
        for place in &found.undecided {
            assert!(place.size < 4.0 * radius, "{place}");
        }
        let p = found.branches[0].curve().point(0.3) - DVec3::new(0.5, 0.5, 0.0);
        assert!((p.length() / radius - 1.0).abs() < 0.02, "{p}");
    }
}

#[test]
fn sheets_that_share_a_side_meet_along_it_and_those_that_overlap_say_so() {
    let floor = sheet([0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let wall = sheet([1.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]);
    let side = meet(&floor, &wall);
    let told: Vec<String> = side.undecided.iter().map(ToString::to_string).collect();
    assert_eq!(counts(&side), (1, 0), "{told:?}");
    let ends = side.branches[0].curve().ends();
    assert!((ends[0].distance(ends[1]) - 2.0).abs() < 1e-6);
    // A corner on a sheet.
    let corner = sheet([0.0, 0.0, 2.0], [1.0, 0.0, 1.0], [-1.0, 0.3, 1.0]);
    let touch = meet(&floor, &corner);
    assert!(touch.branches.is_empty() && touch.touches.len() + touch.undecided.len() == 1);
    let shifted = sheet([0.7, 0.6, 0.0], [1.0, 0.0, 0.0], [0.2, 1.0, 0.0]);
    let flat = meet(&floor, &shifted);
    assert!(flat.branches.is_empty());
    assert!(
        flat.undecided.len() == 1 && flat.undecided[0].overlaps,
        "{:?}",
        flat.undecided.len()
    );
    let same = within(&sphere(1.0), &sphere(1.0), 1000);
    assert!(same.undecided.iter().any(|c| c.overlaps));
}

#[test]
fn a_meridian_reaches_the_poles_which_are_not_decided() {
    let ball = sphere(1.0);
    let found = meet(&ball, &sheet([0.0; 3], [2.0, 1.0, 0.0], [0.0, 0.0, 2.0]));
    assert_eq!(found.branches.len(), 2);
    for place in &found.undecided {
        assert!(place.point.z.abs() > 0.99 && place.size < 0.1, "{place}");
    }
}

#[test]
fn a_tolerance_must_be_positive() {
    let ball = sphere(1.0);
    for tol in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let options = IntersectOptions {
            tol: Some(tol),
            ..IntersectOptions::default()
        };
        let refused = intersect_surfaces(&ball, &ball, &options).unwrap_err();
        assert!(matches!(refused, SurfacesError::Tolerance(_)));
    }
}

/// A net of n by n flat cells of bilinear patches over the unit square, with heights.
fn facets(n: usize, height: impl Fn(f64, f64) -> f64) -> SurfaceRef {
    let at = |i: usize| i as f64 / n as f64;
    let points: Vec<DVec3> = (0..=n)
        .flat_map(|i| (0..=n).map(move |j| (at(i), at(j))))
        .map(|(x, y)| DVec3::new(x, y, height(x, y)))
        .collect();
    let mut knots: Vec<f64> = (0..=n).map(at).collect();
    knots.insert(0, 0.0);
    knots.push(1.0);
    Arc::new(NurbsSurface::new([1, 1], [knots.clone(), knots], &points, None).unwrap())
}

#[test]
fn the_budget_is_one_for_all_pairs_of_cells_and_what_it_does_not_reach_is_not_decided() {
    let n = 48;
    let wave = |x: f64, y: f64| 0.1 * (5.0 * x).sin() * (4.0 * y).cos();
    let net = facets(n, wave);
    // About 9 n² pairs of cells touch: each has common points.
    let budget = 1500;
    let found = within(&net, &net, budget);
    assert!(found.boxes <= 10 * budget, "{}", found.boxes);
    for k in 0..n * n {
        let [u, v] = [k / n, k % n].map(|i| (i as f64 + 0.37) / n as f64);
        let place = [u, v, u, v];
        let told = |b: &[nappe::Interval; 4]| (0..4).all(|j| b[j].contains(place[j]));
        let known = found.undecided.iter().flat_map(|c| &c.boxes).any(told);
        assert!(known, "({u}, {v})");
    }
}

#[test]
fn a_net_of_many_cells_is_crossed_from_end_to_end() {
    // z = x - 0.3 in every cell, with cells that are no plane's.
    let net = facets(40, |x, y| (x - 0.303) * (1.0 + 0.5 * (9.0 * y).sin()));
    let found = meet(
        &net,
        &sheet([0.5, 0.5, 0.0], [0.7, 0.0, 0.0], [0.0, 0.7, 0.0]),
    );
    let told: Vec<String> = found.undecided.iter().map(ToString::to_string).collect();
    assert_eq!(counts(&found), (1, 0), "{told:?}");
    let ends = found.branches[0].curve().ends();
    assert!((ends[0].distance(ends[1]) - 1.0).abs() < 1e-5, "{ends:?}");
}
