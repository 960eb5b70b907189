//! How cost grows with the number of points, the size of a net and the number of surfaces.

use crate::clock::best;
use crate::memory;
use crate::tasks::{even, net, scattered};
use nappe::DVec3;
use nappe::exact::NurbsSurface;
use nappe::mesh::{Mesh, MeshOptions, mesh};
use nappe::surface::{SurfaceRef, grid_blocks};
use std::hint::black_box;
use std::process::Command;
use std::sync::Arc;
use std::time::Instant;

/// A measurement: its place on the x axis, nanoseconds an item, bytes of memory, and bytes of the result if the memory is
/// to be compared with it.
pub(crate) struct Point {
    pub(crate) x: f64,
    pub(crate) ns: f64,
    pub(crate) bytes: f64,
    pub(crate) result: Option<f64>,
}

/// A line of a plot.
pub(crate) struct Line {
    pub(crate) name: &'static str,
    pub(crate) points: Vec<Point>,
}

/// A plot: its file name, the name of x, and its lines.
pub(crate) struct Plot {
    pub(crate) file: &'static str,
    pub(crate) x: &'static str,
    pub(crate) lines: Vec<Line>,
}

/// What was measured at one place: nanoseconds an item, bytes, and bytes of the result.
type Cost = (f64, f64, Option<f64>);

fn line(name: &'static str, xs: &[usize], f: impl Fn(usize) -> Cost) -> Line {
    let point = |&x: &usize| {
        let (ns, bytes, result) = f(x);
        let x = x as f64;
        Point {
            x,
            ns,
            bytes,
            result,
        }
    };
    Line {
        name,
        points: xs.iter().map(point).collect(),
    }
}

/// A grid of about n points, whole.
fn grid(surface: &SurfaceRef, n: usize) -> Cost {
    let side = (n as f64).sqrt() as usize;
    let [u, v] = surface.domain().map(|d| even(d, side));
    let mut out = vec![DVec3::ZERO; side * side];
    let ns = best(3, side * side, || surface.grid(&u, &v, black_box(&mut out)));
    let bytes = 24.0 * (side * side) as f64;
    (ns, bytes, Some(bytes))
}

/// The same through a block that stays in the caches.
fn blocks(surface: &SurfaceRef, n: usize) -> Cost {
    let side = (n as f64).sqrt() as usize;
    let [u, v] = surface.domain().map(|d| even(d, side));
    let mut buffer = vec![DVec3::ZERO; 16 * side];
    let ns = best(3, side * side, || {
        grid_blocks(surface.as_ref(), &u, &v, &mut buffer, |_, block| {
            black_box(block);
        });
    });
    let result = 24.0 * (side * side) as f64;
    (ns, 24.0 * buffer.len() as f64, Some(result))
}

fn list(surface: &SurfaceRef, n: usize) -> Cost {
    let uv = scattered(surface, n);
    let mut out = vec![DVec3::ZERO; 3 * n];
    let ns = best(3, n, || surface.jets(&uv, 1, black_box(&mut out)));
    (ns, 88.0 * n as f64, Some(72.0 * n as f64))
}

/// About n bicubic patches side by side over a square: hills and valleys seven patches long.
fn heights(n: usize) -> Vec<SurfaceRef> {
    let side = (n as f64).sqrt() as usize;
    let height = |x: f64, y: f64| DVec3::new(x, y, 0.6 * (0.9 * x).sin() * (0.7 * y).cos());
    let patch = |k: usize| {
        let at = |start: usize, i: usize| start as f64 + i as f64 / 3.0;
        let net: Vec<DVec3> = (0..16)
            .map(|i| height(at(k / side, i / 4), at(k % side, i % 4)))
            .collect();
        Arc::new(NurbsSurface::bezier(4, &net, None).unwrap()) as SurfaceRef
    };
    (0..side * side).map(patch).collect()
}

fn size(mesh: &Mesh) -> f64 {
    let bytes = |p: &nappe::mesh::MeshPatch| {
        size_of_val(p) + size_of_val(&p.vertices[..]) + size_of_val(&p.triangles[..])
    };
    (size_of_val(&mesh.points[..]) + mesh.patches.iter().map(bytes).sum::<usize>()) as f64
}

/// What the argument of the program is that makes it measure one mesh only, see [`mesh_alone`].
pub(crate) const ALONE: &str = "--mesh";

/// Prints the cost of a mesh of many patches: nanoseconds a triangle, by how many bytes the memory grew at most, and the
/// bytes of the mesh.
pub(crate) fn mesh_alone(n: usize, tol: f64) {
    let surfaces = heights(n);
    let options = MeshOptions::with_tol(tol);
    let before = memory::now();
    let start = Instant::now();
    let made = mesh(&surfaces, &options).unwrap();
    let ns = start.elapsed().as_secs_f64() * 1e9;
    let grown = memory::peak() - before;
    let triangles: usize = made.patches.iter().map(|p| p.triangles.len()).sum();
    println!("{} {grown} {}", ns / triangles as f64, size(&made));
}

/// The same in a process of its own, whose memory is that of no other measurement.
fn meshed(n: usize, tol: f64) -> Cost {
    let program = std::env::current_exe().unwrap();
    let args = [ALONE.to_owned(), n.to_string(), tol.to_string()];
    let out = Command::new(program).args(args).output().unwrap();
    let out = String::from_utf8(out.stdout).unwrap();
    let numbers: Vec<f64> = out.split_whitespace().map(|x| x.parse().unwrap()).collect();
    (numbers[0], numbers[1], Some(numbers[2]))
}

/// The plots whose files are named, or all.
pub(crate) fn measure(quick: bool, names: &[&str]) -> Vec<Plot> {
    ["points", "nets", "patches"]
        .into_iter()
        .filter(|file| names.is_empty() || names.contains(file))
        .map(|file| match file {
            "points" => points(quick),
            "nets" => nets(quick),
            _ => patches(quick),
        })
        .collect()
}

fn points(quick: bool) -> Plot {
    let most = if quick { 5 } else { 8 };
    let decades: Vec<usize> = (3..=most).map(|k| 10usize.pow(k)).collect();
    // 10⁸ parameters with their derivatives would take 9 GB.
    let listed = &decades[..decades.len().min(5)];
    let small = net(20);
    Plot {
        file: "points",
        x: "points",
        lines: vec![
            line("grid", &decades, |n| grid(&small, n)),
            line("grid by blocks", &decades, |n| blocks(&small, n)),
            line("list with first derivatives", listed, |n| list(&small, n)),
        ],
    }
}

fn net_bytes(points: usize) -> f64 {
    32.0 * (points * points) as f64
}

fn nets(quick: bool) -> Plot {
    let nets: &[usize] = if quick {
        &[20, 100]
    } else {
        &[10, 20, 50, 100, 200, 500, 1000]
    };
    let of_net = |ns: f64, k: usize| (ns, net_bytes(k), None);
    Plot {
        file: "nets",
        x: "points of the net along each side",
        lines: vec![
            line("grid, 10⁶ points", nets, |k| {
                of_net(grid(&net(k), 1_000_000).0, k)
            }),
            line("list, 10⁶ points, first derivatives", nets, |k| {
                of_net(list(&net(k), 1_000_000).0, k)
            }),
        ],
    }
}

fn patches(quick: bool) -> Plot {
    let most = if quick { 2 } else { 5 };
    let decades: Vec<usize> = (0..=most).map(|k| 10usize.pow(k)).collect();
    Plot {
        file: "patches",
        x: "surfaces",
        lines: vec![
            line("grid of 100 points each", &decades, |k| {
                let surfaces: Vec<SurfaceRef> = (0..k).map(|_| net(4)).collect();
                let t = even(nappe::Interval::UNIT, 10);
                let mut out = vec![DVec3::ZERO; 100];
                let ns = best(3, 100 * k, || {
                    for s in &surfaces {
                        s.grid(&t, &t, black_box(&mut out));
                    }
                });
                (ns, net_bytes(4) * k as f64, None)
            }),
            line("mesh within 1e-2, a triangle", &decades, |n| {
                meshed(n, 1e-2)
            }),
            line("mesh within 1e-3, a triangle", &decades, |n| {
                meshed(n, 1e-3)
            }),
        ],
    }
}
