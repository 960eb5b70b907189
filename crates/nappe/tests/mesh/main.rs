//! Certified meshes: the bound against dense samples, watertightness, poles, adaptivity, determinism, bad input.

#![allow(clippy::unwrap_used)]

mod revolution;
mod shapes;

use nappe::DVec3;
use nappe::exact::NurbsSurface;
use nappe::mesh::{Mesh, MeshError, MeshOptions, mesh};
use nappe::surface::SurfaceRef;
use shapes::*;
use std::sync::{Arc, Mutex};

#[test]
fn a_plane_is_two_triangles() {
    let plane = bezier(
        2,
        &[
            v(0.0, 0.0, 0.0),
            v(0.0, 1.0, 0.0),
            v(1.0, 0.0, 0.5),
            v(1.0, 1.0, 0.5),
        ],
    );
    for tol in [1e-1, 1e-6, 1e-11] {
        let m = made(std::slice::from_ref(&plane), tol);
        assert_eq!(m.patches[0].triangles.len(), 2);
        assert_eq!(check(std::slice::from_ref(&plane), &m, tol), 4);
    }
}

#[test]
fn uneven_parameters_of_a_plane_cost_nothing() {
    let at = [0.0, 0.1, 1.0];
    let p: Vec<DVec3> = (0..9).map(|k| v(at[k / 3], at[k % 3], 0.0)).collect();
    let s = [bezier(3, &p)];
    for tol in [1e-2, 1e-6, 1e-11] {
        let m = made(&s, tol);
        assert_eq!(m.patches[0].triangles.len(), 2);
        assert_eq!(check(&s, &m, tol), 4);
    }
}

#[test]
fn numbers_of_triangles_are_near_what_curvature_asks_for() {
    // A sphere of radius 1 within h: cells with sides a, ⅛ (a² + a²) = h, two triangles each, so 2 · 4π / (4 h).
    let s = octants();
    for tol in [1e-2, 2e-3] {
        let m = made(&s, tol);
        let n = m.patches.iter().map(|p| p.triangles.len()).sum::<usize>() as f64;
        let best = std::f64::consts::PI / tol * 2.0;
        assert!(n < 5.0 * best, "{n} triangles instead of {best}");
    }
    // A saddle z = u v: the mixed derivative alone, ¼ / (n m) = h, so 1 / (2 h) triangles.
    let corners = [DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::ONE];
    let s = [bezier(2, &corners)];
    let m = made(&s, 1e-3);
    check(&s, &m, 1e-3);
    assert!(m.patches[0].triangles.len() < 600);
}

/// The area of all triangles.
fn area(mesh: &Mesh) -> f64 {
    let triangle = |patch: &nappe::mesh::MeshPatch, t: &[u32; 3]| {
        let [a, b, c] = t.map(|k| mesh.points[patch.vertices[k as usize].point as usize]);
        0.5 * (b - a).cross(c - a).length()
    };
    let patches = mesh.patches.iter();
    patches
        .flat_map(|p| p.triangles.iter().map(move |t| triangle(p, t)))
        .sum()
}

#[test]
fn areas_and_normals_of_twisted_patches_converge() {
    // Thin strips would keep the distance and neither of these, like Schwarz's lantern. The area of z = u v over the unit
    // square is ∫∫ √(1 + u² + v²) = 1.2807…, here by the midpoint rule, which is exact to 10⁻⁶.
    let corners = [DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::ONE];
    let s = [bezier(2, &corners)];
    let at = |k: usize| (k as f64 + 0.5) / 400.0;
    let terms = (0..160_000).map(|k| (1.0 + at(k % 400).powi(2) + at(k / 400).powi(2)).sqrt());
    let exact = terms.sum::<f64>() / 160_000.0;
    for tol in [1e-2, 1e-3, 1e-4] {
        let m = made(&s, tol);
        let error = (area(&m) - exact).abs();
        assert!(error < 2.0 * tol, "area off by {error:e} at {tol:e}");
        let patch = &m.patches[0];
        let steepest = patch.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|k| patch.vertices[k as usize]);
            let [p, q, r] = [a, b, c].map(|v| m.points[v.point as usize]);
            let n = (q - p).cross(r - p).normalize();
            [a, b, c]
                .map(|v| v.normal.angle_between(n))
                .into_iter()
                .fold(0.0, f64::max)
        });
        let steepest = steepest.fold(0.0, f64::max);
        // A square of side a bends by a, and ¼ a² = tol.
        assert!(
            steepest < 5.0 * tol.sqrt(),
            "normals off by {steepest} at {tol:e}"
        );
    }
}

#[test]
fn two_halves_of_a_thin_body_never_lie_back_to_back() {
    // Two sheets over the unit square that meet in all four sides, as the halves of a lens, and two that meet in a corner.
    // The lower one has u and v exchanged, so that both face outwards.
    let sheet = |h: f64, full: bool| {
        let row = |s: f64| {
            [0.0, 0.5, 1.0].map(|t| {
                let (x, y) = if h > 0.0 { (s, t) } else { (t, s) };
                let rim = x == 0.0 || y == 0.0 || (full && (x == 1.0 || y == 1.0));
                v(x, y, if rim { 0.0 } else { h })
            })
        };
        bezier(3, &[row(0.0), row(0.5), row(1.0)].concat())
    };
    for full in [true, false] {
        let s = [sheet(0.3, full), sheet(-0.3, full)];
        for tol in [0.2, 0.05, 1e-2, 1e-3, 1e-4] {
            let m = made(&s, tol);
            let border = check(&s, &m, tol);
            assert_eq!(border == 0, full, "{border} open edges at {tol}");
            if full {
                assert_eq!(euler(&m), 2);
            }
        }
    }
}

#[test]
fn a_cylinder_is_not_cut_along_its_axis() {
    let c = turned(
        &[[1.0, 0.0, 1.0], [1.0, 5.0, 1.0]],
        vec![0.0, 0.0, 1.0, 1.0],
        1,
        1.0,
        DVec3::ZERO,
    );
    let m = made(std::slice::from_ref(&c), 1e-3);
    assert!(
        m.patches[0]
            .vertices
            .iter()
            .all(|x| x.uv[1] == 0.0 || x.uv[1] == 1.0)
    );
    let n = m.patches[0].triangles.len() / 2;
    assert_eq!(check(&[c], &m, 1e-3), 2 * n);
    // A polygon of n sides deviates by 1 - cos(π/n); the parameters are uneven, the proof has a margin.
    let best = std::f64::consts::PI / (1.0f64 - 1e-3).acos();
    assert!((n as f64) < 3.0 * best, "{n} sides instead of {best}");
}

#[test]
fn closed_surfaces_are_watertight_at_every_scale_and_place() {
    for scale in [1e-6, 1.0, 1e6] {
        for at in [DVec3::ZERO, v(1e3, -2e3, 500.0) * scale] {
            for tol in [0.3, 0.03, 0.002] {
                for (s, chi) in [(sphere(scale, at), 2), (torus(scale, at), 0)] {
                    let m = made(std::slice::from_ref(&s), tol * scale);
                    assert_eq!(check(&[s], &m, tol * scale), 0, "closed");
                    assert_eq!(euler(&m), chi);
                }
            }
        }
    }
}

#[test]
fn a_sphere_of_octants_is_closed_and_its_normals_are_right() {
    let s = octants();
    for tol in [0.2, 0.01, 1e-3] {
        let m = made(&s, tol);
        assert_eq!(check(&s, &m, tol), 0);
        assert_eq!(euler(&m), 2);
        for patch in &m.patches {
            for x in &patch.vertices {
                let p = m.points[x.point as usize];
                let out = x.normal.dot(p);
                assert!((out.abs() - 1.0).abs() < 1e-5, "normal {} at {p}", x.normal);
            }
        }
    }
}

#[test]
fn the_tip_of_a_cone_is_shaded_like_its_flank() {
    let c = turned(
        &[[1.0, 0.0, 1.0], [0.0, 1.0, 1.0]],
        vec![0.0, 0.0, 1.0, 1.0],
        1,
        1.0,
        DVec3::ZERO,
    );
    let m = made(std::slice::from_ref(&c), 1e-3);
    check(&[c], &m, 1e-3);
    for t in &m.patches[0].triangles {
        let n = t.map(|k| m.patches[0].vertices[k as usize].normal);
        assert!(n[0].dot(n[1]) > 0.9 && n[1].dot(n[2]) > 0.9, "{n:?}");
        assert!(
            n.iter().all(|n| (n.z - 0.5f64.sqrt()).abs() < 1e-6),
            "{n:?}"
        );
    }
}

#[test]
fn the_teapot_is_watertight_within_tolerance() {
    let s = teapot();
    assert_eq!(s.len(), 32);
    let mut counts = Vec::new();
    for tol in [0.1, 0.01, 0.001] {
        let m = made(&s, tol);
        check(&s, &m, tol);
        counts.push(m.patches.iter().map(|p| p.triangles.len()).sum::<usize>());
    }
    assert!(counts[0] < counts[1] && counts[1] < counts[2], "{counts:?}");
    assert!(counts[2] < 110_000, "{counts:?}");
}

#[test]
fn shared_sides_with_other_parameters_and_directions_are_one() {
    // Two patches over a common cubic side. The second has it with another parametrisation (a rational one of the same
    // curve), from the other end, and as another side.
    let side = [
        v(0.0, 0.0, 0.0),
        v(1.0, 0.0, 2.0),
        v(2.0, 0.0, -1.0),
        v(3.0, 0.0, 0.5),
    ];
    let mut a: Vec<DVec3> = Vec::new();
    for p in side {
        a.extend([p, p + v(0.0, 1.0, 0.7), p + v(0.0, 2.0, 0.0)]);
    }
    let a = bezier(4, &a);
    // t -> t / (t + c (1 - t)) multiplies weight i by c^(n - i).
    let c = 3.0f64;
    let (mut q, mut w) = (Vec::new(), Vec::new());
    for row in [-3.0f64, -1.0, 0.0] {
        for (i, p) in side.iter().enumerate().rev() {
            q.push(*p + v(0.0, row, 0.3 * row * row * i as f64));
            w.push(c.powi(3 - i as i32));
        }
    }
    let b: SurfaceRef = Arc::new(NurbsSurface::bezier(3, &q, Some(&w)).unwrap());
    let both = [a, b];
    for tol in [0.1, 0.01, 1e-3] {
        let m = made(&both, tol);
        let border = check(&both, &m, tol);
        let first: std::collections::HashSet<u32> =
            m.patches[0].vertices.iter().map(|x| x.point).collect();
        let common: std::collections::HashSet<u32> = m.patches[1]
            .vertices
            .iter()
            .map(|x| x.point)
            .filter(|p| first.contains(p))
            .collect();
        assert!(common.len() > 2, "the side is shared");
        // Border vertices: of both patches, without those inside the common side.
        let on_border: std::collections::HashSet<u32> = m
            .patches
            .iter()
            .flat_map(|p| &p.vertices)
            .filter(|x| x.uv.iter().any(|&t| t == 0.0 || t == 1.0))
            .map(|x| x.point)
            .collect();
        assert_eq!(border, on_border.len() - (common.len() - 2));
    }
}

#[test]
fn rough_surfaces_at_many_tolerances_and_scales() {
    for scale in [1e-6, 1.0, 1e6] {
        for at in [DVec3::ZERO, v(-3e3, 1e3, 2e3) * scale] {
            let s = rough(scale, at);
            let mut last = 0;
            for tol in [1.0, 0.1, 0.01, 0.001] {
                let m = made(std::slice::from_ref(&s), tol * scale);
                check(std::slice::from_ref(&s), &m, tol * scale);
                let n = m.patches[0].triangles.len();
                assert!(n > last, "finer is more: {n} {last}");
                last = n;
            }
        }
    }
}

#[test]
fn corners_inside_a_surface_are_kept_and_have_two_normals() {
    // A roof: degree 1 along u with a ridge at u = 1/2.
    let p = [
        v(0.0, 0.0, 0.0),
        v(0.0, 1.0, 0.0),
        v(1.0, 0.0, 1.0),
        v(1.0, 1.0, 1.0),
        v(2.0, 0.0, 0.0),
        v(2.0, 1.0, 0.0),
    ];
    let knots = [vec![0.0, 0.0, 0.5, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]];
    let s: SurfaceRef = Arc::new(NurbsSurface::new([1, 1], knots, &p, None).unwrap());
    let m = made(std::slice::from_ref(&s), 1e-6);
    assert_eq!(check(&[s], &m, 1e-6), 6);
    assert_eq!(m.patches[0].triangles.len(), 4);
    assert_eq!(m.points.len(), 6);
    let ridge: Vec<_> = m.patches[0]
        .vertices
        .iter()
        .filter(|x| x.uv[0] == 0.5)
        .collect();
    assert_eq!(ridge.len(), 4, "two vertices at each end of the ridge");
    assert!(ridge.iter().any(|x| x.normal.x > 0.7) && ridge.iter().any(|x| x.normal.x < -0.7));
}

#[test]
fn a_nearly_collapsed_side_is_no_trouble() {
    // A quarter of a sphere whose pole is a tiny edge (after the file quarter_sphere.xml of the G+Smo library).
    let e = 1e-3;
    let rows = [[e, -1.0], [1.0, -1.0], [1.0, 0.0], [1.0, 1.0], [e, 1.0]];
    // The file's weights are rounded too: not quite a sphere.
    let s = 0.5f64.sqrt() + 3e-6;
    let (mut p, mut w) = (Vec::new(), Vec::new());
    for (i, [r, z]) in rows.into_iter().enumerate() {
        for (j, (x, y)) in [(1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].into_iter().enumerate() {
            p.push(v(x * r, y * r, z));
            w.push([1.0, s][i % 2] * [1.0, s][j % 2]);
        }
    }
    let knots = [
        vec![0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0],
        vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
    ];
    let s: SurfaceRef = Arc::new(NurbsSurface::new([2, 2], knots, &p, Some(&w)).unwrap());
    for tol in [1e-2, 1e-3, 1e-4] {
        let m = made(std::slice::from_ref(&s), tol);
        check(std::slice::from_ref(&s), &m, tol);
    }
}

#[test]
fn any_number_of_threads_gives_the_same_mesh_and_the_same_error() {
    let s = teapot();
    let on = |threads, max_triangles| {
        let options = MeshOptions {
            threads: Some(threads),
            max_triangles,
            ..MeshOptions::with_tol(0.01)
        };
        mesh(&s, &options)
    };
    let most = 10_000_000;
    let (one, few) = (on(1, most).unwrap(), on(1, 500).unwrap_err());
    assert!(matches!(few, MeshError::TooMany { max: 500, .. }));
    for threads in [1, 2, 3, 64] {
        let same = format!("{:?}", on(threads, most).unwrap()) == format!("{one:?}");
        assert!(same, "{threads} threads");
        assert_eq!(on(threads, 500).unwrap_err(), few, "{threads} threads");
    }
}

#[test]
fn progress_grows_to_one() {
    let shares = Arc::new(Mutex::new(Vec::new()));
    let heard = shares.clone();
    let options = MeshOptions {
        threads: Some(3),
        progress: Some(Arc::new(move |share| heard.lock().unwrap().push(share))),
        ..MeshOptions::with_tol(0.05)
    };
    mesh(&teapot(), &options).unwrap();
    let shares = shares.lock().unwrap();
    assert!(shares.is_sorted() && shares[0] > 0.0);
    assert_eq!(shares.last(), Some(&1.0));
}

#[test]
fn bad_requests_are_named() {
    let s = [rough(1.0, DVec3::ZERO)];
    for tol in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let e = mesh(&s, &MeshOptions::with_tol(tol)).unwrap_err();
        assert!(matches!(e, MeshError::Tolerance { .. }), "{e}");
    }
    let e = mesh(&s, &MeshOptions::with_tol(1e-16)).unwrap_err();
    let MeshError::TooFine { smallest, .. } = e else {
        panic!("{e}")
    };
    assert!(smallest < 1e-11);
    let few = MeshOptions {
        max_triangles: 1000,
        ..MeshOptions::with_tol(1e-6)
    };
    let MeshError::TooMany { needed, max } = mesh(&s, &few).unwrap_err() else {
        panic!("too many")
    };
    assert!(needed > 1000.0 && max == 1000);
    let wide = MeshOptions {
        weld: Some(0.5),
        ..MeshOptions::with_tol(1.0)
    };
    assert!(matches!(mesh(&s, &wide), Err(MeshError::Weld { .. })));
    let point = bezier(2, &[DVec3::ONE; 4]);
    let e = mesh(&[s[0].clone(), point], &MeshOptions::with_tol(1e-3)).unwrap_err();
    assert!(matches!(e, MeshError::Collapsed { surface: 1, .. }), "{e}");
    assert!(
        mesh(&[], &MeshOptions::default())
            .unwrap()
            .points
            .is_empty()
    );
}
