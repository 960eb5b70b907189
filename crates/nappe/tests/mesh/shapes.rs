//! Surfaces to mesh, and what every mesh is held to.

use nappe::DVec3;
use nappe::exact::NurbsSurface;
use nappe::laws::Random;
use nappe::mesh::{Certainty, Mesh, MeshOptions, mesh};
use nappe::surface::SurfaceRef;
use std::collections::HashMap;
use std::sync::Arc;

pub(crate) fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

pub(crate) fn bezier(rows: usize, points: &[DVec3]) -> SurfaceRef {
    Arc::new(NurbsSurface::bezier(rows, points, None).unwrap())
}

/// A full turn about z of a rational profile (x, z, w): nine points around, corners of the parametrisation only C0.
pub(crate) fn turned(
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

pub(crate) fn half_circle(major: f64) -> ([[f64; 3]; 5], Vec<f64>) {
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

pub(crate) fn sphere(scale: f64, at: DVec3) -> SurfaceRef {
    let (profile, knots) = half_circle(0.0);
    turned(&profile, knots, 2, scale, at)
}

pub(crate) fn torus(scale: f64, at: DVec3) -> SurfaceRef {
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
pub(crate) fn octants() -> Vec<SurfaceRef> {
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

pub(crate) fn teapot() -> Vec<SurfaceRef> {
    let numbers: Vec<f64> = include_str!("../data/teapot.txt")
        .lines()
        .filter(|l| !l.starts_with('#'))
        .flat_map(str::split_whitespace)
        .map(|x| x.parse().unwrap())
        .collect();
    let points: Vec<DVec3> = numbers.chunks(3).map(DVec3::from_slice).collect();
    points.chunks(16).map(|p| bezier(4, p)).collect()
}

/// A rough bicubic patch.
pub(crate) fn rough(scale: f64, at: DVec3) -> SurfaceRef {
    let mut random = Random(5);
    let p: Vec<DVec3> = (0..16)
        .map(|k| at + v((k / 4) as f64, (k % 4) as f64, 2.0 * random.unit()) * scale)
        .collect();
    bezier(4, &p)
}

pub(crate) fn distance(t: &[DVec3; 3], p: DVec3) -> f64 {
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
pub(crate) fn from_surface(s: &SurfaceRef, q: DVec3, mut uv: [f64; 2]) -> f64 {
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
pub(crate) fn check(surfaces: &[SurfaceRef], mesh: &Mesh, tol: f64) -> usize {
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
pub(crate) fn euler(mesh: &Mesh) -> i64 {
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

pub(crate) fn made(surfaces: &[SurfaceRef], tol: f64) -> Mesh {
    mesh(surfaces, &MeshOptions::with_tol(tol)).unwrap()
}
