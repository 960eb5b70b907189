//! The starting line: grid, list and mesh of every kind beside a plain loop over points, in one run.
//!
//! `cargo xtask bench [--quick] [--json FILE] [NAME…]`. Each figure is the best of several runs. `limit` is the time to
//! write the result to memory that is already mapped. Only ratios mean something: machines and minutes differ.

#![allow(clippy::unwrap_used, missing_docs)]

mod cases;

use nappe::mesh::{self, MeshOptions};
use nappe::surface::SurfaceRef;
use nappe::{DVec3, laws::Random};
use serde_json::json;
use std::hint::black_box;
use std::io::Write;
use std::time::Instant;

/// The best time of `runs` runs, in nanoseconds for each of `n` items.
fn best(runs: usize, n: usize, mut f: impl FnMut()) -> f64 {
    let once = |f: &mut dyn FnMut()| {
        let start = Instant::now();
        f();
        start.elapsed().as_secs_f64()
    };
    (0..runs)
        .map(|_| once(&mut f))
        .fold(f64::INFINITY, f64::min)
        * 1e9
        / n as f64
}

struct Row {
    task: &'static str,
    kind: &'static str,
    n: usize,
    ns: f64,
    plain: f64,
    limit: f64,
}

fn measure(kind: &'static str, surface: &SurfaceRef, side: usize, runs: usize) -> Vec<Row> {
    let [du, dv] = surface.domain();
    let at = |d: nappe::Interval, i: usize| d.lo + (d.hi - d.lo) * i as f64 / (side - 1) as f64;
    let us: Vec<f64> = (0..side).map(|i| at(du, i)).collect();
    let vs: Vec<f64> = (0..side).map(|i| at(dv, i)).collect();
    let n = side * side;
    let mut out = vec![DVec3::ZERO; n];
    let limit = best(runs + 2, n, || {
        black_box(&mut out).fill(black_box(DVec3::ONE))
    });
    let grid = best(runs, n, || surface.grid(&us, &vs, black_box(&mut out)));
    let plain_grid = best(runs, n, || {
        for (row, &u) in out.chunks_exact_mut(side).zip(&us) {
            for (o, &v) in row.iter_mut().zip(&vs) {
                *o = surface.point([u, v]);
            }
        }
        black_box(&mut out);
    });
    let mut random = Random(42);
    let uv: Vec<[f64; 2]> = (0..n)
        .map(|_| [random.within(du), random.within(dv)])
        .collect();
    let list = best(runs, n, || surface.points(&uv, black_box(&mut out)));
    let plain_list = best(runs, n, || {
        for (o, &uv) in out.iter_mut().zip(&uv) {
            *o = surface.point(uv);
        }
        black_box(&mut out);
    });
    let diagonal = surface.bounds(surface.domain()).diagonal();
    let options = MeshOptions::with_tol(1e-3 * diagonal);
    let mut triangles = 0;
    let time = best(runs, 1, || {
        let mesh = mesh::mesh(std::slice::from_ref(surface), &options).unwrap();
        triangles = mesh.patches[0].triangles.len();
        black_box(&mesh);
    });
    // The plain loop beside a mesh: as many single points as it has triangles.
    let points = uv.iter().cycle().take(triangles);
    let plain_mesh = best(runs, triangles, || {
        points.clone().for_each(|&uv| {
            black_box(surface.point(uv));
        })
    });
    let row = |task, n, ns, plain| Row {
        task,
        kind,
        n,
        ns,
        plain,
        limit,
    };
    vec![
        row("grid", n, grid, plain_grid),
        row("list", n, list, plain_list),
        row("mesh", triangles, time / triangles as f64, plain_mesh),
    ]
}

fn main() {
    let args: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    let quick = args.iter().any(|a| a == "--quick");
    let json_file = args
        .iter()
        .position(|a| a == "--json")
        .map(|i| args.get(i + 1).expect("--json FILE").clone());
    let names: Vec<&String> = args
        .iter()
        .filter(|a| !a.starts_with("--") && Some(*a) != json_file.as_ref())
        .collect();
    let (side, runs) = if quick { (60, 2) } else { (400, 5) };
    let mut json = json_file.map(|f| std::io::BufWriter::new(std::fs::File::create(f).unwrap()));
    println!(
        "{:6} {:24} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "task", "kind", "n", "ns/item", "plain", "×plain", "×limit"
    );
    for (kind, surface) in cases::all() {
        if !(names.is_empty() || names.iter().any(|n| kind.contains(n.as_str()))) {
            continue;
        }
        for r in measure(kind, &surface, side, runs) {
            let (speed, above) = (r.plain / r.ns, r.ns / r.limit);
            println!(
                "{:6} {:24} {:9} {:9.1} {:9.1} {:9.2} {:9.1}",
                r.task, r.kind, r.n, r.ns, r.plain, speed, above
            );
            if let Some(j) = &mut json {
                let row = json!({"task": r.task, "kind": r.kind, "n": r.n, "ns_per_item": r.ns, "plain_ns": r.plain,
                    "limit_ns": r.limit, "ratio_to_limit": above});
                writeln!(j, "{row}").unwrap();
            }
        }
    }
}
