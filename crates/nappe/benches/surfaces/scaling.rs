//! How cost grows with the number of points, the size of a net and the number of surfaces.

use crate::clock::best;
use crate::tasks::{even, net, scattered};
use nappe::DVec3;
use nappe::surface::{SurfaceRef, grid_blocks};
use std::hint::black_box;

/// A line of a plot: what, and (x, nanoseconds an item, bytes in all).
pub(crate) struct Line {
    pub(crate) name: &'static str,
    pub(crate) points: Vec<(f64, f64, f64)>,
}

/// A plot: its file name, the name of x, and its lines.
pub(crate) struct Plot {
    pub(crate) file: &'static str,
    pub(crate) x: &'static str,
    pub(crate) lines: Vec<Line>,
}

fn line(name: &'static str, xs: &[usize], f: impl Fn(usize) -> (f64, f64)) -> Line {
    let points = xs
        .iter()
        .map(|&x| {
            let (ns, bytes) = f(x);
            (x as f64, ns, bytes)
        })
        .collect();
    Line { name, points }
}

/// A grid of about n points, whole.
fn grid(surface: &SurfaceRef, n: usize) -> (f64, f64) {
    let side = (n as f64).sqrt() as usize;
    let [u, v] = surface.domain().map(|d| even(d, side));
    let mut out = vec![DVec3::ZERO; side * side];
    let ns = best(3, side * side, || surface.grid(&u, &v, black_box(&mut out)));
    (ns, 24.0 * (side * side) as f64)
}

/// The same through a block that stays in the caches.
fn blocks(surface: &SurfaceRef, n: usize) -> (f64, f64) {
    let side = (n as f64).sqrt() as usize;
    let [u, v] = surface.domain().map(|d| even(d, side));
    let mut buffer = vec![DVec3::ZERO; 16 * side];
    let ns = best(3, side * side, || {
        grid_blocks(surface.as_ref(), &u, &v, &mut buffer, |_, block| {
            black_box(block);
        });
    });
    (ns, 24.0 * buffer.len() as f64)
}

fn list(surface: &SurfaceRef, n: usize) -> (f64, f64) {
    let uv = scattered(surface, n);
    let mut out = vec![DVec3::ZERO; 3 * n];
    let ns = best(3, n, || surface.jets(&uv, 1, black_box(&mut out)));
    (ns, 88.0 * n as f64)
}

pub(crate) fn measure(quick: bool) -> Vec<Plot> {
    let most = if quick { 5 } else { 8 };
    let decades: Vec<usize> = (3..=most).map(|k| 10usize.pow(k)).collect();
    // 10⁸ parameters with their derivatives would take 9 GB.
    let listed = &decades[..decades.len().min(5)];
    let small = net(20);
    let nets: &[usize] = if quick {
        &[20, 100]
    } else {
        &[10, 20, 50, 100, 200, 500, 1000]
    };
    let net_bytes = |points: usize| 32.0 * (points * points) as f64;
    let patches: &[usize] = if quick {
        &[1, 100]
    } else {
        &[1, 10, 100, 1000, 10_000]
    };
    vec![
        Plot {
            file: "points",
            x: "points",
            lines: vec![
                line("grid", &decades, |n| grid(&small, n)),
                line("grid by blocks", &decades, |n| blocks(&small, n)),
                line("list with first derivatives", listed, |n| list(&small, n)),
            ],
        },
        Plot {
            file: "nets",
            x: "points of the net along each side",
            lines: vec![
                line("grid, 10⁶ points", nets, |k| {
                    (grid(&net(k), 1_000_000).0, net_bytes(k))
                }),
                line("list, 10⁶ points, first derivatives", nets, |k| {
                    (list(&net(k), 1_000_000).0, net_bytes(k))
                }),
            ],
        },
        Plot {
            file: "patches",
            x: "surfaces",
            lines: vec![line("grid of 100 points each", patches, |k| {
                let surfaces: Vec<SurfaceRef> = (0..k).map(|_| net(4)).collect();
                let t = even(nappe::Interval::UNIT, 10);
                let mut out = vec![DVec3::ZERO; 100];
                let ns = best(3, 100 * k, || {
                    for s in &surfaces {
                        s.grid(&t, &t, black_box(&mut out));
                    }
                });
                (ns, net_bytes(4) * k as f64)
            })],
        },
    ]
}
