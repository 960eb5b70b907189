//! Meshes with known answers, for this crate's tests and pictures, and public files.

use crate::scene::{Field, Scene};
use glam::DVec3;
use nappe::Units;
use nappe::mesh::{Certainty, Mesh, MeshPatch, MeshVertex};
use std::f64::consts::{PI, TAU};
use std::path::PathBuf;

/// A file that is beside the project on some machines only.
pub(crate) fn beside(name: &str) -> Option<Vec<u8>> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let found = root
        .ancestors()
        .find_map(|a| std::fs::read(a.join("shared/data").join(name)).ok());
    if found.is_none() {
        eprintln!("skipped: {name} is not there");
    }
    found
}

/// A grid of `n × m` cells over `[0, 1]²`. `wrap` says which directions close on themselves; points shared by a
/// seam or a pole (where neighbours coincide) are one.
pub(crate) fn grid(
    n: usize,
    m: usize,
    wrap: [bool; 2],
    f: impl Fn(f64, f64) -> (DVec3, DVec3),
) -> (Vec<DVec3>, MeshPatch) {
    let (mut points, mut vertices, mut triangles): (Vec<DVec3>, Vec<MeshVertex>, Vec<[u32; 3]>) =
        Default::default();
    for i in 0..=n {
        for j in 0..=m {
            let uv = [i as f64 / n as f64, j as f64 / m as f64];
            let (si, sj) = (
                if wrap[0] { i % n } else { i },
                if wrap[1] { j % m } else { j },
            );
            let (p, normal) = f(uv[0], uv[1]);
            let point = if (si, sj) != (i, j) {
                vertices[si * (m + 1) + sj].point
            } else if j > 0
                && (points[vertices[i * (m + 1) + j - 1].point as usize] - p).length() < 1e-12
            {
                vertices[i * (m + 1) + j - 1].point
            } else {
                points.push(p);
                points.len() as u32 - 1
            };
            vertices.push(MeshVertex { point, uv, normal });
        }
    }
    let at = |i: usize, j: usize| (i * (m + 1) + j) as u32;
    for i in 0..n {
        for j in 0..m {
            for t in [
                [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
                [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
            ] {
                let p = t.map(|k| vertices[k as usize].point);
                if p[0] != p[1] && p[1] != p[2] && p[2] != p[0] {
                    triangles.push(t);
                }
            }
        }
    }
    (
        points,
        MeshPatch {
            vertices,
            triangles,
            deviation: Certainty::Bounded(0.0),
        },
    )
}

fn scene(points: Vec<DVec3>, mut patch: MeshPatch, deviation: f64, name: &str) -> Scene {
    patch.deviation = Certainty::Bounded(deviation);
    Scene::from_mesh(
        Mesh {
            points,
            patches: vec![patch],
        },
        [name],
        Units::Millimetre,
    )
}

/// The unit sphere, v around the z axis, outward normals. `n` cells from pole to pole, `m` around.
pub(crate) fn sphere(m: usize, n: usize) -> Scene {
    let (points, patch) = grid(n, m, [false, true], |u, v| {
        // Exact zeros at the poles, so that they are single points.
        let (s, c) = if u == 0.0 {
            (0.0, -1.0)
        } else if u == 1.0 {
            (0.0, 1.0)
        } else {
            ((PI * u).sin(), -(PI * u).cos())
        };
        let p = DVec3::new(s * (TAU * v).cos(), s * (TAU * v).sin(), c);
        (p, p)
    });
    let step = PI / n.min(m / 2).max(1) as f64;
    let mut s = scene(points, patch, step * step / 4.0, "sphere");
    // The grid runs from pole to pole along u, which makes u × v point inward: turn the triangles, not the normals.
    for t in &mut s.mesh.patches[0].triangles {
        t.swap(1, 2);
    }
    s
}

/// A torus about the z axis with its curvatures as fields.
pub(crate) fn torus(major: f64, minor: f64, n: usize, m: usize) -> Scene {
    let (points, patch) = grid(n, m, [true, true], |u, v| {
        let ((su, cu), (sv, cv)) = ((TAU * u).sin_cos(), (TAU * v).sin_cos());
        let normal = DVec3::new(cu * cv, su * cv, sv);
        (DVec3::new(cu, su, 0.0) * major + normal * minor, normal)
    });
    let values = |f: fn(f64, f64, f64) -> f64| {
        vec![
            patch
                .vertices
                .iter()
                .map(|v| f(major, minor, (TAU * v.uv[1]).cos()))
                .collect(),
        ]
    };
    let fields = vec![
        Field {
            name: "Gaussian curvature".into(),
            unit: "1/mm²".into(),
            values: values(|a, b, c| c / (b * (a + b * c))),
            unbounded: [false; 2],
        },
        Field {
            name: "Mean curvature".into(),
            unit: "1/mm".into(),
            values: values(|a, b, c| (a + 2.0 * b * c) / (2.0 * b * (a + b * c))),
            unbounded: [false; 2],
        },
    ];
    Scene {
        fields,
        ..scene(points, patch, 1e-2, "torus")
    }
}

/// The saddle z = xy over `[-1, 1]²`.
pub(crate) fn saddle(n: usize) -> Scene {
    let (points, patch) = grid(n, n, [false, false], |u, v| {
        let (x, y) = (2.0 * u - 1.0, 2.0 * v - 1.0);
        (DVec3::new(x, y, x * y), DVec3::new(-y, -x, 1.0).normalize())
    });
    scene(points, patch, 1e-3, "saddle")
}

/// The unit cube of six surfaces that share their points.
pub(crate) fn cube() -> Scene {
    let points: Vec<DVec3> = (0..8)
        .map(|i| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64))
        .collect();
    let faces: [([u32; 4], DVec3); 6] = [
        ([0, 2, 3, 1], -DVec3::Z),
        ([4, 5, 7, 6], DVec3::Z),
        ([0, 1, 5, 4], -DVec3::Y),
        ([2, 6, 7, 3], DVec3::Y),
        ([0, 4, 6, 2], -DVec3::X),
        ([1, 3, 7, 5], DVec3::X),
    ];
    let uvs = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let patches = faces
        .map(|(q, normal)| MeshPatch {
            vertices: (0..4)
                .map(|k| MeshVertex {
                    point: q[k],
                    uv: uvs[k],
                    normal,
                })
                .collect(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            deviation: Certainty::Exact,
        })
        .to_vec();
    let names = ["bottom", "top", "front", "back", "left", "right"];
    Scene::from_mesh(Mesh { points, patches }, names, Units::Millimetre)
}
