//! Certified meshes: the bound against dense samples, watertightness, poles, adaptivity, determinism, bad input.

#![allow(clippy::unwrap_used)]

use nappe::curve::{CurveRef, ExpressionCurve, Spacing, polyline};
use nappe::exact::NurbsSurface;
use nappe::expr::Expr;
use nappe::laws::Random;
use nappe::mesh::{Certainty, Mesh, MeshError, MeshOptions, mesh};
use nappe::surface::{
    Construction, Dir, Revolution, RevolutionOptions, SurfaceRef, Transformed, ruled,
};
use nappe::{DAffine3, DVec3, Frame};
use std::collections::HashMap;
use std::sync::{Arc, Mutex};

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn bezier(rows: usize, points: &[DVec3]) -> SurfaceRef {
    Arc::new(NurbsSurface::bezier(rows, points, None).unwrap())
}

/// A full turn about z of a rational profile (x, z, w): nine points around, corners of the parametrisation only C0.
fn turned(
    profile: &[[f64; 3]],
    knots: Vec<f64>,
    degree: usize,
    scale: f64,
    at: DVec3,
) -> SurfaceRef {
    let s = 0.5f64.sqrt();
    let around = [
        (1.0, 0.0, 1.0),
        (1.0, 1.0, s),
        (0.0, 1.0, 1.0),
        (-1.0, 1.0, s),
        (-1.0, 0.0, 1.0),
        (-1.0, -1.0, s),
        (0.0, -1.0, 1.0),
        (1.0, -1.0, s),
        (1.0, 0.0, 1.0),
    ];
    let turn = [
        0.0, 0.0, 0.0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1.0, 1.0, 1.0,
    ];
    let mut points = Vec::new();
    let mut weights = Vec::new();
    for (x, y, w) in around {
        for &[r, z, q] in profile {
            points.push(at + v(x * r, y * r, z) * scale);
            weights.push(w * q);
        }
    }
    let surface =
        NurbsSurface::new([2, degree], [turn.to_vec(), knots], &points, Some(&weights)).unwrap();
    Arc::new(surface)
}

fn half_circle(major: f64) -> ([[f64; 3]; 5], Vec<f64>) {
    let s = 0.5f64.sqrt();
    let p = [
        [major, -1.0, 1.0],
        [major + 1.0, -1.0, s],
        [major + 1.0, 0.0, 1.0],
        [major + 1.0, 1.0, s],
        [major, 1.0, 1.0],
    ];
    (p, vec![0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0])
}

fn sphere(scale: f64, at: DVec3) -> SurfaceRef {
    let (profile, knots) = half_circle(0.0);
    turned(&profile, knots, 2, scale, at)
}

fn torus(scale: f64, at: DVec3) -> SurfaceRef {
    let (half, _) = half_circle(3.0);
    let mut profile = half.to_vec();
    let s = 0.5f64.sqrt();
    profile.extend([
        [2.0, 1.0, s],
        [2.0, 0.0, 1.0],
        [2.0, -1.0, s],
        [3.0, -1.0, 1.0],
    ]);
    let knots = vec![
        0.0, 0.0, 0.0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1.0, 1.0, 1.0,
    ];
    turned(&profile, knots, 2, scale, at)
}

/// Eight octants, each with its own pole, after Grigoriev's table; those with an odd number of mirrors are turned inside
/// out by exchanging u and v.
fn octants() -> Vec<SurfaceRef> {
    let s = 0.5f64.sqrt();
    let table = [
        [v(1.0, 0.0, 0.0), v(1.0, 1.0, 0.0), v(0.0, 1.0, 0.0)],
        [v(1.0, 0.0, 1.0), v(1.0, 1.0, 1.0), v(0.0, 1.0, 1.0)],
        [v(0.0, 0.0, 1.0), v(0.0, 0.0, 1.0), v(0.0, 0.0, 1.0)],
    ];
    let weights = [[1.0, s, 1.0], [s, 0.5, s], [1.0, s, 1.0]];
    (0..8)
        .map(|k| {
            let sign = v(
                1.0 - 2.0 * (k & 1) as f64,
                1.0 - 2.0 * (k >> 1 & 1) as f64,
                1.0 - 2.0 * (k >> 2) as f64,
            );
            let odd = sign.x * sign.y * sign.z < 0.0;
            let at = |i: usize, j: usize| if odd { (j, i) } else { (i, j) };
            let (mut p, mut w) = (Vec::new(), Vec::new());
            for i in 0..3 {
                for j in 0..3 {
                    let (a, b) = at(i, j);
                    p.push(table[a][b] * sign);
                    w.push(weights[a][b]);
                }
            }
            Arc::new(NurbsSurface::bezier(3, &p, Some(&w)).unwrap()) as SurfaceRef
        })
        .collect()
}

fn teapot() -> Vec<SurfaceRef> {
    let numbers: Vec<f64> = include_str!("data/teapot.txt")
        .lines()
        .filter(|l| !l.starts_with('#'))
        .flat_map(str::split_whitespace)
        .map(|x| x.parse().unwrap())
        .collect();
    let points: Vec<DVec3> = numbers.chunks(3).map(DVec3::from_slice).collect();
    points.chunks(16).map(|p| bezier(4, p)).collect()
}

/// A rough bicubic patch.
fn rough(scale: f64, at: DVec3) -> SurfaceRef {
    let mut random = Random(5);
    let p: Vec<DVec3> = (0..16)
        .map(|k| at + v((k / 4) as f64, (k % 4) as f64, 2.0 * random.unit()) * scale)
        .collect();
    bezier(4, &p)
}

fn distance(t: &[DVec3; 3], p: DVec3) -> f64 {
    // Nearest point of a triangle: inside, or on one of its edges.
    let [a, b, c] = *t;
    let n = (b - a).cross(c - a);
    let inside = [(a, b), (b, c), (c, a)]
        .iter()
        .all(|&(s, e)| n.cross(e - s).dot(p - s) >= 0.0);
    if inside {
        return ((p - a).dot(n) / n.length()).abs();
    }
    [(a, b), (b, c), (c, a)]
        .iter()
        .map(|&(s, e)| {
            let t = ((p - s).dot(e - s) / (e - s).length_squared()).clamp(0.0, 1.0);
            p.distance(s + (e - s) * t)
        })
        .fold(f64::INFINITY, f64::min)
}

/// The distance of a point from a surface, near a first guess: the step of Gauss and Newton, halved until it is nearer.
fn from_surface(s: &SurfaceRef, q: DVec3, mut uv: [f64; 2]) -> f64 {
    let domain = s.domain();
    let mut best = q.distance(s.point(uv));
    for _ in 0..20 {
        let jet = s.jet(uv, Default::default(), 1);
        let (e, a, b) = (q - jet.d[0], jet.d[1], jet.d[2]);
        let (aa, ab, bb) = (a.dot(a), a.dot(b), b.dot(b));
        let det = aa * bb - ab * ab;
        let mut step = [
            (bb * a.dot(e) - ab * b.dot(e)) / det,
            (aa * b.dot(e) - ab * a.dot(e)) / det,
        ];
        // Along a side that the step would leave, the nearest point of the side.
        for (d, alone) in [(0, b.dot(e) / bb), (1, a.dot(e) / aa)] {
            let next = uv[d] + step[d];
            if uv[d] == next.clamp(domain[d].lo, domain[d].hi) && uv[d] != next {
                step[d] = 0.0;
                step[1 - d] = alone;
            }
        }
        if !(step[0].is_finite() && step[1].is_finite()) {
            break;
        }
        let before = best;
        for _ in 0..8 {
            let next = [0, 1].map(|d| (uv[d] + step[d]).clamp(domain[d].lo, domain[d].hi));
            let d = q.distance(s.point(next));
            if d < best {
                (uv, best) = (next, d);
                break;
            }
            step = step.map(|x| 0.5 * x);
        }
        if best > (1.0 - 1e-6) * before {
            break;
        }
    }
    best
}

/// Checks everything that holds for every mesh; returns the number of edges on the border.
fn check(surfaces: &[SurfaceRef], mesh: &Mesh, tol: f64) -> usize {
    let mut edges: HashMap<[u32; 2], [usize; 2]> = HashMap::new();
    let mut random = Random(1);
    for (s, patch) in surfaces.iter().zip(&mesh.patches) {
        let Certainty::Bounded(bound) = patch.deviation else {
            panic!("not proven: {:?}", patch.deviation);
        };
        assert!(bound <= tol, "{bound:e} > {tol:e}");
        for t in &patch.triangles {
            let c = t.map(|k| patch.vertices[k as usize]);
            let p = c.map(|x| mesh.points[x.point as usize]);
            let n = (p[1] - p[0]).cross(p[2] - p[0]);
            let longest = p[0]
                .distance(p[1])
                .max(p[1].distance(p[2]))
                .max(p[2].distance(p[0]));
            assert!(
                n.length() > 1e-9 * longest * longest,
                "a triangle without area: {c:?}"
            );
            for x in &c {
                assert!((x.normal.length() - 1.0).abs() < 1e-9);
                let d = mesh.points[x.point as usize].distance(s.point(x.uv));
                assert!(d <= bound, "vertex {x:?} is {d:e} away");
            }
            for k in 0..3 {
                let (a, b) = (c[k].point, c[(k + 1) % 3].point);
                edges.entry([a.min(b), a.max(b)]).or_default()[usize::from(a > b)] += 1;
            }
            for k in 0..45 {
                // The barycentric lattice of order 8.
                let (mut i, mut j) = (k, 0);
                while i > 8 - j {
                    i -= 9 - j;
                    j += 1;
                }
                let l = [i, j, 8 - i - j].map(|x| x as f64 / 8.0);
                let q = p[0] * l[0] + p[1] * l[1] + p[2] * l[2];
                let uv = [0, 1].map(|d| c[0].uv[d] * l[0] + c[1].uv[d] * l[1] + c[2].uv[d] * l[2]);
                let mut d = q.distance(s.point(uv));
                if d > bound {
                    d = from_surface(s, q, uv);
                }
                assert!(d <= bound, "{d:e} > {bound:e} in {c:?}");
            }
        }
        // The other way: points of the surface are near the patch.
        if patch.triangles.len() < 3000 {
            let triangles: Vec<_> = patch
                .triangles
                .iter()
                .map(|t| t.map(|k| mesh.points[patch.vertices[k as usize].point as usize]))
                .collect();
            for _ in 0..60 {
                let p = s.point(s.domain().map(|d| random.within(d)));
                let d = triangles
                    .iter()
                    .map(|t| distance(t, p))
                    .fold(f64::INFINITY, f64::min);
                assert!(d <= bound, "the surface's point {p} is {d:e} from the mesh");
            }
        }
    }
    let mut border = 0;
    for (e, [forth, back]) in &edges {
        assert!(
            *forth <= 1 && *back <= 1,
            "edge {e:?} is used {forth} and {back} times"
        );
        border += usize::from(forth + back == 1);
    }
    border
}

/// V - E + F.
fn euler(mesh: &Mesh) -> i64 {
    let mut edges: HashMap<[u32; 2], ()> = HashMap::new();
    let mut points: HashMap<u32, ()> = HashMap::new();
    let mut faces = 0;
    for patch in &mesh.patches {
        for t in &patch.triangles {
            let p = t.map(|k| patch.vertices[k as usize].point);
            faces += 1;
            for k in 0..3 {
                let (a, b) = (p[k], p[(k + 1) % 3]);
                edges.insert([a.min(b), a.max(b)], ());
                points.insert(a, ());
            }
        }
    }
    assert_eq!(points.len(), mesh.points.len(), "every point is used");
    points.len() as i64 - edges.len() as i64 + faces
}

fn made(surfaces: &[SurfaceRef], tol: f64) -> Mesh {
    mesh(surfaces, &MeshOptions::with_tol(tol)).unwrap()
}

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

fn expression(x: &str, y: &str, z: &str) -> CurveRef {
    let bound = |s: &str| Expr::parse(s).unwrap().bind(&["t"], &[]).unwrap();
    Arc::new(ExpressionCurve::new([bound(x), bound(y), bound(z)], [0.0, 1.0]).unwrap())
}

fn revolved(profile: CurveRef, angle: f64, construction: Construction) -> SurfaceRef {
    let options = RevolutionOptions {
        angle,
        construction,
        ..Default::default()
    };
    Arc::new(Revolution::new(profile, Frame::WORLD, options).unwrap())
}

#[test]
fn surfaces_of_revolution_are_closed_where_their_profiles_are() {
    let sphere = || expression("sin(pi*t)", "0", "-cos(pi*t)");
    let ring = || expression("3+cos(2*pi*t)", "0", "sin(2*pi*t)");
    for construction in [Construction::Angle, Construction::Rational] {
        for tol in [0.1, 0.01] {
            for (profile, chi) in [(sphere(), 2), (ring(), 0)] {
                let s = [revolved(profile, std::f64::consts::TAU, construction)];
                let m = made(&s, tol);
                assert_eq!(check(&s, &m, tol), 0, "closed");
                assert_eq!(euler(&m), chi);
            }
            let part = [revolved(sphere(), 2.0, construction)];
            let m = made(&part, tol);
            assert!(check(&part, &m, tol) > 0);
            assert_eq!(euler(&m), 1);
        }
    }
}

/// The fewest chords of a unit circle within `tol`.
fn chords(tol: f64) -> f64 {
    std::f64::consts::PI / (1.0 - tol).acos()
}

fn revolved_polyline(points: &[DVec3], construction: Construction) -> [SurfaceRef; 1] {
    let profile = Arc::new(polyline(points, Spacing::Uniform).unwrap());
    [revolved(profile, std::f64::consts::TAU, construction)]
}

const ROUND: [Construction; 2] = [Construction::Angle, Construction::Rational];

#[test]
fn a_flat_disc_is_a_fan() {
    let (centre, rim) = (v(0.0, 0.0, 0.5), v(1.0, 0.0, 0.5));
    for (ends, scale) in [([centre, rim], 1.0), ([rim, centre], 1e4)] {
        for (construction, tol) in ROUND
            .into_iter()
            .flat_map(|c| [1e-2, 1e-3, 1e-5].map(|t| (c, t)))
        {
            let s = revolved_polyline(&ends.map(|p| p * scale), construction);
            let m = made(&s, tol * scale);
            let border = check(&s, &m, tol * scale);
            let triangles = m.patches[0].triangles.len();
            assert_eq!(
                border, triangles,
                "each triangle has one edge on the rim: {construction:?}"
            );
            let fewest = chords(tol);
            assert!(
                triangles as f64 <= 1.5 * fewest + 8.0,
                "{triangles}, not {fewest}: {construction:?}"
            );
        }
    }
}

#[test]
fn creases_do_not_spoil_the_bound_beside_them() {
    let can = [
        v(0.0, 0.0, 0.0),
        v(1.0, 0.0, 0.0),
        v(1.0, 0.0, 2.0),
        v(0.0, 0.0, 2.0),
    ];
    for (construction, tol) in ROUND
        .into_iter()
        .flat_map(|c| [1e-2, 1e-3, 1e-4].map(|t| (c, t)))
    {
        let s = revolved_polyline(&can, construction);
        let m = made(&s, tol);
        assert_eq!(check(&s, &m, tol), 0);
        assert_eq!(euler(&m), 2);
        // Two fans and a belt; the rims may have the vertices of both sides.
        let (triangles, fewest) = (m.patches[0].triangles.len(), 4.0 * chords(tol));
        assert!(
            triangles as f64 <= 3.0 * fewest + 32.0,
            "{triangles}, not {fewest}: {construction:?}"
        );
    }
}

#[test]
fn a_waist_on_the_axis_is_one_point() {
    let p = [v(1.0, 0.0, -1.0), v(0.0, 0.0, 0.0), v(1.0, 0.0, 1.0)];
    let profile = || Arc::new(polyline(&p, Spacing::Uniform).unwrap());
    for angle in [1.0, std::f64::consts::TAU] {
        let s = [revolved(profile(), angle, Construction::Angle)];
        let m = made(&s, 0.01);
        check(&s, &m, 0.01);
        let tips: std::collections::HashSet<u32> = m.patches[0]
            .vertices
            .iter()
            .filter(|x| x.uv[0] == 0.5)
            .map(|x| x.point)
            .collect();
        assert_eq!(tips.len(), 1);
    }
}

#[test]
fn ruled_and_transformed_surfaces_keep_the_bound() {
    let (a, b) = (
        expression("cos(3*t)", "sin(3*t)", "0"),
        expression("2*t", "exp(t)", "1+t^2"),
    );
    let r: SurfaceRef = Arc::new(ruled(a, b, Dir::U).unwrap());
    let map = DAffine3::from_scale(v(1.0, -2.0, 0.5));
    let t: SurfaceRef = Arc::new(Transformed::new(r.clone(), map).unwrap());
    for tol in [0.1, 0.01, 0.001] {
        for s in [&r, &t] {
            let m = made(std::slice::from_ref(s), tol);
            check(std::slice::from_ref(s), &m, tol);
        }
    }
}
