//! What is measured.

use crate::cases;
use crate::clock::{beside_writing, best};
use crate::memory::last_cache;
use nappe::exact::NurbsSurface;
use nappe::laws::Random;
use nappe::mesh::{self, MeshOptions};
use nappe::query::{Finder, FinderOptions};
use nappe::surface::{SurfaceRef, in_parallel, jet_len};
use nappe::{DVec3, Interval};
use pulp::bytemuck::Pod;
use serde_json::{Value, json};
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

/// One figure.
pub(crate) struct Row {
    /// T1 … T6 as in the published targets, or what is done for every kind.
    pub(crate) task: &'static str,
    pub(crate) kind: String,
    pub(crate) n: usize,
    /// Of results that go to memory, where there is a limit.
    pub(crate) ns: f64,
    /// The time to write the same to memory.
    pub(crate) limit: Option<f64>,
    /// Both for results that stay in the last-level cache, if it holds them.
    pub(crate) cached: Option<[f64; 2]>,
    /// The time of a loop over single points.
    pub(crate) plain: Option<f64>,
    pub(crate) peers: Vec<(String, f64)>,
}

impl Row {
    pub(crate) fn json(&self) -> Value {
        let peers: serde_json::Map<String, Value> = self
            .peers
            .iter()
            .map(|(name, ns)| (name.clone(), json!(ns)))
            .collect();
        json!({"task": self.task, "kind": self.kind, "n": self.n, "ns_per_item": self.ns, "limit_ns": self.limit,
            "ratio_to_limit": self.ratio(), "ns_in_cache": self.cached.map(|c| c[0]), "ratio_in_cache": self.ratio_in_cache(),
            "plain_ns": self.plain, "peers": peers})
    }

    /// How often the time to write the result to memory goes into the task that does.
    pub(crate) fn ratio(&self) -> Option<f64> {
        self.limit.map(|l| self.ns / l)
    }

    /// The same in the last-level cache.
    pub(crate) fn ratio_in_cache(&self) -> Option<f64> {
        self.cached.map(|[ns, limit]| ns / limit)
    }
}

/// `n` parameters from end to end.
pub(crate) fn even(d: Interval, n: usize) -> Vec<f64> {
    let at = |i: usize| d.lo + (d.hi - d.lo) * i as f64 / (n - 1) as f64;
    (0..n).map(at).collect()
}

/// `n` parameter pairs, the same in every run.
pub(crate) fn scattered(surface: &SurfaceRef, n: usize) -> Vec<[f64; 2]> {
    let mut random = Random(42);
    let d = surface.domain();
    (0..n).map(|_| d.map(|d| random.within(d))).collect()
}

/// A bicubic spline surface of `points` × `points` points.
pub(crate) fn net(points: usize) -> SurfaceRef {
    let mut random = Random(7);
    let net: Vec<DVec3> = (0..points * points)
        .map(|i| DVec3::new((i / points) as f64, (i % points) as f64, random.unit()))
        .collect();
    let knots = nappe::basis::BSplineBasis::clamped_uniform(3, points);
    Arc::new(NurbsSurface::new([3, 3], [knots.clone(), knots], &net, None).unwrap())
}

/// How much is done.
struct Size {
    side: usize,
    list: usize,
    runs: usize,
}

pub(crate) fn all(quick: bool, names: &[&str]) -> Vec<Row> {
    let size = if quick {
        Size {
            side: 100,
            list: 10_000,
            runs: 2,
        }
    } else {
        Size {
            side: 1000,
            list: 1_000_000,
            runs: 5,
        }
    };
    let wanted = |name: &str| names.is_empty() || names.iter().any(|n| name.contains(n));
    let mut rows = Vec::new();
    let cases = cases::all();
    let find = |name: &str| cases.iter().find(|c| c.0 == name).map(|c| &c.1);
    let bicubic = find("nurbs bicubic 20x20").expect("a case of this name");
    let torus = find("nurbs rational torus").expect("a case of this name");
    if wanted("nurbs bicubic 20x20") {
        rows.push(grid("T1", "nurbs bicubic 20x20", bicubic, &size));
        rows.push(normals("T2", "nurbs bicubic 20x20", bicubic, &size));
        rows.push(list("T3", "nurbs bicubic 20x20", bicubic, 1, &size));
        rows.push(list("T3b", "nurbs bicubic 20x20", bicubic, 2, &size));
    }
    if wanted("nurbs rational torus") {
        rows.push(grid("T4", "nurbs rational torus", torus, &size));
    }
    if wanted("nurbs bicubic 1000x1000") {
        let side = if quick { 200 } else { 1000 };
        let surface = net(side);
        rows.push(list(
            "T3",
            &format!("nurbs bicubic {side}x{side}"),
            &surface,
            1,
            &size,
        ));
    }
    if wanted("two threads") {
        rows.extend(two_threads(bicubic, &size));
        if std::env::var("NOMESH").is_err() {
            rows.extend(certified(bicubic, &size));
        }
    }
    if wanted("nearest points") {
        rows.push(nearest(bicubic, &size));
    }
    if wanted("one point") {
        rows.push(one_point(bicubic, &size));
    }
    for (kind, surface) in cases.iter().filter(|c| wanted(c.0)) {
        rows.push(grid("grid", kind, surface, &size));
        rows.push(normals("normal", kind, surface, &size));
        // Single points of procedural kinds take microseconds.
        let fewer = Size {
            list: size.list / 10,
            ..size
        };
        rows.push(list("list", kind, surface, 0, &fewer));
        rows.push(list("list1", kind, surface, 1, &fewer));
        if std::env::var("NOMESH").is_err() {
            rows.push(triangles(kind, surface));
        }
    }
    rows
}

fn row(task: &'static str, kind: &str, n: usize, ns: f64) -> Row {
    Row {
        task,
        kind: kind.into(),
        n,
        ns,
        limit: None,
        cached: None,
        plain: None,
        peers: Vec::new(),
    }
}

/// Results are written in turns to places that are together this large, and four times as large as the last-level cache:
/// so each goes to memory.
const MEMORY: usize = 256 << 20;
/// But never to more than this.
const MOST: usize = 900 << 20;
/// The last-level cache where the system does not tell it.
const CACHE: usize = 32 << 20;

/// A row for a task that writes `n` items of `each` places, beside the time to write these.
fn row_beside<T: Pod>(
    task: &'static str,
    kind: &str,
    [n, each]: [usize; 2],
    runs: usize,
    mut f: impl FnMut(&mut [T]),
) -> Row {
    let (part, cache) = (n * each, last_cache().unwrap_or(CACHE));
    let bytes = part * size_of::<T>();
    let parts = MEMORY.max(4 * cache).min(MOST).div_ceil(bytes);
    let mut ring = vec![T::zeroed(); parts * part];
    let [ns, limit] = beside_writing(runs, &mut ring, part, n, &mut f);
    let cached = (bytes <= cache).then(|| beside_writing(runs, &mut ring[..part], part, n, &mut f));
    Row {
        limit: Some(limit),
        cached,
        ..row(task, kind, n, ns)
    }
}

/// The time of single points in the order of the list.
fn plain(surface: &SurfaceRef, uv: &[[f64; 2]]) -> f64 {
    let few = &uv[..uv.len().min(2000)];
    best(3, few.len(), || {
        for &uv in few {
            black_box(surface.point(uv));
        }
    })
}

fn grid(task: &'static str, kind: &str, surface: &SurfaceRef, size: &Size) -> Row {
    let [u, v] = surface.domain().map(|d| even(d, size.side));
    let plain = Some(plain(surface, &scattered(surface, 2000)));
    let n = u.len() * v.len();
    Row {
        plain,
        ..row_beside(task, kind, [n, 1], size.runs, |out| {
            surface.grid(&u, &v, out);
        })
    }
}

fn normals(task: &'static str, kind: &str, surface: &SurfaceRef, size: &Size) -> Row {
    let [u, v] = surface.domain().map(|d| even(d, size.side));
    let n = u.len() * v.len();
    row_beside(task, kind, [n, 1], size.runs, |out| {
        surface.grid_normals(&u, &v, out);
    })
}

fn list(task: &'static str, kind: &str, surface: &SurfaceRef, order: usize, size: &Size) -> Row {
    let uv = scattered(surface, size.list);
    let plain = (order == 0).then(|| plain(surface, &uv));
    let shape = [uv.len(), jet_len(order)];
    Row {
        plain,
        ..row_beside(task, kind, shape, size.runs, |out| {
            surface.jets(&uv, order, out);
        })
    }
}

/// The same work by one thread (as `plain`) and by two, for results that fit no cache.
fn two_threads(surface: &SurfaceRef, size: &Size) -> Vec<Row> {
    let [u, v] = surface.domain().map(|d| even(d, 4 * size.side));
    let n = u.len() * v.len();
    let mut out = vec![DVec3::ZERO; n];
    let on = |threads: usize, out: &mut Vec<DVec3>| {
        best(size.runs, n, || {
            in_parallel(threads, &u, v.len(), black_box(out), |u, out| {
                surface.grid(u, &v, out)
            });
        })
    };
    let times = [on(1, &mut out), on(2, &mut out)];
    let uv = scattered(surface, 2 * size.list);
    let mut jets = vec![DVec3::ZERO; 3 * uv.len()];
    let on = |threads: usize, out: &mut Vec<DVec3>| {
        best(size.runs, uv.len(), || {
            in_parallel(threads, &uv, 3, black_box(out), |uv, out| {
                surface.jets(uv, 1, out)
            });
        })
    };
    let list = [on(1, &mut jets), on(2, &mut jets)];
    vec![
        Row {
            plain: Some(times[0]),
            ..row("grid", "bicubic, two threads", n, times[1])
        },
        Row {
            plain: Some(list[0]),
            ..row("list1", "bicubic, two threads", uv.len(), list[1])
        },
    ]
}

fn one_point(surface: &SurfaceRef, size: &Size) -> Row {
    let uv = scattered(surface, 2000);
    row(
        "point",
        "bicubic, one point",
        uv.len(),
        best(size.runs, uv.len(), || {
            for &uv in &uv {
                black_box(surface.point(black_box(uv)));
            }
        }),
    )
}

/// The nearest point to points within a twentieth of the diagonal from the surface, proven, by two threads, and by one (as
/// `plain`).
fn nearest(surface: &SurfaceRef, size: &Size) -> Row {
    let domain = surface.domain();
    let diagonal = surface.bounds(domain).diagonal();
    let mut random = Random(7);
    let points: Vec<DVec3> = (0..10_000)
        .map(|_| {
            let uv = domain.map(|t| random.within(t));
            let jet = surface.jet(uv, Default::default(), 1);
            let normal = jet.normal().expect("a regular surface");
            jet.point() + normal * ((2.0 * random.unit() - 1.0) * 0.05 * diagonal)
        })
        .collect();
    let finder = Finder::new(std::slice::from_ref(surface), FinderOptions::default()).unwrap();
    let on = |threads: usize| {
        best(size.runs, points.len(), || {
            black_box(finder.nearest_many(black_box(&points), threads));
        })
    };
    Row {
        plain: Some(on(1)),
        ..row(
            "T5",
            "nearest points, bicubic, two threads",
            points.len(),
            on(2),
        )
    }
}

/// The triangles of a certified mesh within a share of the diagonal, and the time for each.
fn meshed(surface: &SurfaceRef, share: f64, threads: Option<usize>) -> [f64; 2] {
    let diagonal = surface.bounds(surface.domain()).diagonal();
    let options = MeshOptions {
        threads,
        ..MeshOptions::with_tol(share * diagonal)
    };
    let start = Instant::now();
    let mesh = mesh::mesh(std::slice::from_ref(surface), &options).unwrap();
    let time = start.elapsed().as_secs_f64() * 1e9;
    let triangles = black_box(&mesh).patches[0].triangles.len() as f64;
    [triangles, time / triangles]
}

/// A certified mesh to a thousandth of the diagonal, for each triangle.
fn triangles(kind: &str, surface: &SurfaceRef) -> Row {
    // Once: beside a mesh, warming up is nothing.
    let [triangles, ns] = meshed(surface, 1e-3, None);
    row("mesh", kind, triangles as usize, ns)
}

/// Certified meshes by two threads, and by one (as `plain`).
fn certified(surface: &SurfaceRef, size: &Size) -> Vec<Row> {
    let of = |(share, kind)| {
        let on = |threads: usize| {
            let runs = (0..size.runs).map(|_| meshed(surface, share, Some(threads)));
            runs.fold([0.0, f64::INFINITY], |a, b| [b[0], b[1].min(a[1])])
        };
        let [triangles, ns] = on(2);
        Row {
            plain: Some(on(1)[1]),
            ..row("T6", kind, triangles as usize, ns)
        }
    };
    [
        (1e-3, "mesh of bicubic, 1e-3, two threads"),
        (1e-5, "mesh of bicubic, 1e-5, two threads"),
    ]
    .map(of)
    .into()
}
