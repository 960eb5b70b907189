//! The shapes of a vector picture: triangles split where their colour changes, and joined where it does not.

use super::Paint;
use super::colour::encoded;
use super::light::{phase, striped};
use super::pixels::{facing, place_at, shade_share};
use super::raster::Shown;
use super::stage::Stage;
use glam::{DVec2, DVec3, Vec3};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Coordinates are whole tenths of a pixel: edges that two pieces share are equal numbers and cancel.
const GRID: f64 = 10.0;
/// Edges shorter than this many pixels are not split for a change of colour.
const SHORTEST: f64 = 5.0;
/// Edges longer than this are split under stripes.
const STRIPED: f64 = 14.0;
/// Shorter edges are split, down to this length, while the phase of the stripes at their middle is not the mean of that
/// at their ends to within this share of a stripe: stripes are then straight within a piece.
const SHORTEST_STRIPED: f64 = 1.5;
const STRAIGHT: f64 = 0.03;
/// A triangle is split at most this often: 2¹² pieces along an edge.
const DEEPEST: usize = 12;

/// A shape of one colour.
pub(crate) struct Shape {
    /// In linear light.
    pub(crate) colour: [f32; 3],
    /// The path data, with coordinates in pixels.
    pub(crate) path: String,
}

/// A corner of a piece.
#[derive(Clone, Copy)]
struct Corner {
    share: DVec3,
    at: DVec2,
    light: Vec3,
    /// Where in the stripes it is; 0 without stripes.
    phase: f64,
}

type Point = [i32; 2];
/// Directed edges of the pieces of one colour.
type Edges = Vec<(Point, Point)>;

/// The shapes of all layers, in the order in which they must be painted.
pub(crate) fn shapes(stage: &Stage<'_>, shown: &[Shown], layers: &[Vec<u32>]) -> Vec<Shape> {
    let step = stage.options.colour_step as f32;
    let mut out = Vec::new();
    for layer in layers {
        // Ordered, so that files are the same each time.
        let mut by_colour: BTreeMap<[i32; 3], (Edges, Vec3, f32)> = BTreeMap::new();
        for &number in layer {
            let s = &shown[number as usize];
            split(
                stage,
                s,
                whole(stage, s),
                0,
                &mut |outline: &[DVec2], light: Vec3| {
                    let key = light.to_array().map(|c| (encoded(c) / step).round() as i32);
                    let entry = by_colour.entry(key).or_default();
                    let area = add_outline(outline, &mut entry.0);
                    entry.1 += light * area;
                    entry.2 += area;
                },
            );
        }
        for (edges, sum, area) in by_colour.into_values() {
            let path = outline_path(edges);
            if area > 0.0 && !path.is_empty() {
                out.push(Shape {
                    colour: (sum / area).to_array(),
                    path,
                });
            }
        }
    }
    out
}

fn corner(stage: &Stage<'_>, shown: &Shown, share: DVec3) -> Corner {
    let place = stage
        .camera
        .project(place_at(stage, shown, share.to_array()));
    Corner {
        share,
        at: DVec2::new(place.x, place.y),
        light: shade_share(stage, shown, share.to_array()),
        phase: phase_at(stage, shown, share),
    }
}

fn phase_at(stage: &Stage<'_>, shown: &Shown, share: DVec3) -> f64 {
    match stage.options.paint {
        Paint::Zebra { stripes } => phase(
            &facing(stage, shown, share.to_array()),
            &stage.camera.axes(),
            f64::from(stripes),
        ),
        _ => 0.0,
    }
}

fn whole(stage: &Stage<'_>, shown: &Shown) -> [Corner; 3] {
    [DVec3::X, DVec3::Y, DVec3::Z].map(|share| corner(stage, shown, share))
}

/// Splits a piece until its colour is even, then calls `put` with its outline and light.
///
/// Whether an edge is split depends on the edge alone, so neighbours split it alike.
fn split(
    stage: &Stage<'_>,
    shown: &Shown,
    [a, b, c]: [Corner; 3],
    depth: usize,
    put: &mut dyn FnMut(&[DVec2], Vec3),
) {
    let striped = matches!(stage.options.paint, Paint::Zebra { .. });
    let step = stage.options.colour_step as f32;
    let must = |p: &Corner, q: &Corner| {
        let length = (p.at - q.at).length();
        if striped {
            let middle = || phase_at(stage, shown, (p.share + q.share) / 2.0);
            return length > STRIPED
                || length > SHORTEST_STRIPED
                    && (middle() - (p.phase + q.phase) / 2.0).abs() > STRAIGHT;
        }
        let differ = (p.light.map(encoded) - q.light.map(encoded))
            .abs()
            .max_element()
            > step;
        length > SHORTEST && differ
    };
    let edges = [must(&a, &b), must(&b, &c), must(&c, &a)];
    if depth >= DEEPEST || edges == [false; 3] {
        if striped {
            stripes(stage, shown, [a, b, c], put);
        } else {
            put(&[a.at, b.at, c.at], (a.light + b.light + c.light) / 3.0);
        }
        return;
    }
    let middle = |p: &Corner, q: &Corner| corner(stage, shown, (p.share + q.share) / 2.0);
    let mut go = |piece: [Corner; 3]| split(stage, shown, piece, depth + 1, put);
    // Turned so that the marked edges come first.
    match edges {
        [true, true, true] => {
            let (ab, bc, ca) = (middle(&a, &b), middle(&b, &c), middle(&c, &a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
                .into_iter()
                .for_each(&mut go);
        }
        [true, false, false] => two(a, b, c, middle(&a, &b), &mut go),
        [false, true, false] => two(b, c, a, middle(&b, &c), &mut go),
        [false, false, true] => two(c, a, b, middle(&c, &a), &mut go),
        [true, true, false] => three(a, b, c, middle(&a, &b), middle(&b, &c), &mut go),
        [false, true, true] => three(b, c, a, middle(&b, &c), middle(&c, &a), &mut go),
        _ => three(c, a, b, middle(&c, &a), middle(&a, &b), &mut go),
    }
}

/// Splits at the middle of the first edge.
fn two(a: Corner, b: Corner, c: Corner, ab: Corner, go: &mut dyn FnMut([Corner; 3])) {
    go([a, ab, c]);
    go([ab, b, c]);
}

/// Splits at the middles of the first two edges.
fn three(a: Corner, b: Corner, c: Corner, ab: Corner, bc: Corner, go: &mut dyn FnMut([Corner; 3])) {
    go([ab, b, bc]);
    go([a, ab, bc]);
    go([a, bc, c]);
}

/// Cuts a piece along the edges of the stripes, on which the phase is a whole number.
fn stripes(
    stage: &Stage<'_>,
    shown: &Shown,
    corners: [Corner; 3],
    put: &mut dyn FnMut(&[DVec2], Vec3),
) {
    let axes = stage.camera.axes();
    let phase = corners.map(|c| c.phase);
    let (lo, hi) = (
        phase[0].min(phase[1]).min(phase[2]),
        phase[0].max(phase[1]).max(phase[2]),
    );
    let (first, last) = (lo.floor() as i64, hi.floor() as i64);
    // The shade changes little within a piece; which of the two colours, the stripe's middle tells.
    for k in first..=last {
        let mut outline: Vec<(DVec2, f64, DVec3)> = (0..3)
            .map(|i| (corners[i].at, phase[i], corners[i].share))
            .collect();
        if first < last {
            outline = clip(&outline, |f| f - k as f64);
            outline = clip(&outline, |f| (k + 1) as f64 - f);
        }
        if outline.len() < 3 {
            continue;
        }
        let share = outline.iter().map(|o| o.2).sum::<DVec3>() / outline.len() as f64;
        let points: Vec<DVec2> = outline.iter().map(|o| o.0).collect();
        put(
            &points,
            striped(
                &facing(stage, shown, share.to_array()),
                &axes,
                k.rem_euclid(2) == 1,
            ),
        );
    }
}

/// The part of a polygon where a linear function of the phase is not negative.
fn clip(polygon: &[(DVec2, f64, DVec3)], f: impl Fn(f64) -> f64) -> Vec<(DVec2, f64, DVec3)> {
    let mut out = Vec::with_capacity(polygon.len() + 1);
    for (i, p) in polygon.iter().enumerate() {
        let q = &polygon[(i + 1) % polygon.len()];
        let (fp, fq) = (f(p.1), f(q.1));
        if fp >= 0.0 {
            out.push(*p);
        }
        if (fp > 0.0 && fq < 0.0) || (fp < 0.0 && fq > 0.0) {
            let t = fp / (fp - fq);
            out.push((
                p.0 + (q.0 - p.0) * t,
                p.1 + (q.1 - p.1) * t,
                p.2 + (q.2 - p.2) * t,
            ));
        }
    }
    out
}

/// Adds the edges of an outline, turned clockwise, and returns its area in square pixels.
fn add_outline(outline: &[DVec2], edges: &mut Edges) -> f32 {
    let points: Vec<Point> = outline
        .iter()
        .map(|p| [(p.x * GRID).round() as i32, (p.y * GRID).round() as i32])
        .collect();
    let next = |i: usize| points[(i + 1) % points.len()];
    let double = |i: usize| {
        i64::from(points[i][0]) * i64::from(next(i)[1])
            - i64::from(points[i][1]) * i64::from(next(i)[0])
    };
    let area: i64 = (0..points.len()).map(double).sum();
    if area == 0 {
        return 0.0;
    }
    for i in (0..points.len()).filter(|&i| points[i] != next(i)) {
        edges.push(if area > 0 {
            (points[i], next(i))
        } else {
            (next(i), points[i])
        });
    }
    (area.unsigned_abs() as f64 / (2.0 * GRID * GRID)) as f32
}

/// The outline of all pieces together: edges that two pieces run in opposite directions vanish.
fn outline_path(mut edges: Edges) -> String {
    edges.sort_unstable_by_key(|&(a, b)| (a.min(b), a.max(b), a < b));
    let mut next: BTreeMap<Point, Vec<Point>> = BTreeMap::new();
    for run in edges.chunk_by(|e, f| (e.0.min(e.1), e.0.max(e.1)) == (f.0.min(f.1), f.0.max(f.1))) {
        let forward = run.iter().filter(|e| e.0 < e.1).count();
        let backward = run.len() - forward;
        let (lo, hi) = (run[0].0.min(run[0].1), run[0].0.max(run[0].1));
        let (from, to) = if forward > backward {
            (lo, hi)
        } else {
            (hi, lo)
        };
        for _ in 0..forward.abs_diff(backward) {
            next.entry(from).or_default().push(to);
        }
    }
    let mut path = String::new();
    while let Some((&start, _)) = next.first_key_value() {
        let (mut ring, mut at) = (Vec::new(), start);
        while let Some(ways) = next.get_mut(&at) {
            let to = ways.pop();
            if ways.is_empty() {
                next.remove(&at);
            }
            let Some(to) = to else { break };
            ring.push(at);
            at = to;
        }
        write_ring(&ring, &mut path);
    }
    path
}

/// Writes a ring without the points that lie on the line between their neighbours.
fn write_ring(ring: &[Point], path: &mut String) {
    let n = ring.len();
    let corners: Vec<Point> = (0..n)
        .filter(|&i| {
            let (p, q, r) = (ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]);
            let d = |a: Point, b: Point| [i64::from(b[0] - a[0]), i64::from(b[1] - a[1])];
            let (u, v) = (d(p, q), d(q, r));
            u[0] * v[1] != u[1] * v[0]
        })
        .map(|i| ring[i])
        .collect();
    if corners.len() < 3 {
        return;
    }
    let mut last = [0, 0];
    for (k, p) in corners.iter().enumerate() {
        path.push_str(match k {
            0 => "M",
            1 => "l",
            _ => " ",
        });
        let _ = write!(
            path,
            "{} {}",
            coordinate(p[0] - last[0]),
            coordinate(p[1] - last[1])
        );
        last = *p;
    }
    path.push('z');
}

/// Tenths as a decimal number.
fn coordinate(tenths: i32) -> String {
    let (whole, part, sign) = (
        tenths.abs() / 10,
        tenths.abs() % 10,
        if tenths < 0 { "-" } else { "" },
    );
    match (whole, part) {
        (w, 0) => format!("{}{w}", if w == 0 { "" } else { sign }),
        (0, p) => format!("{sign}.{p}"),
        (w, p) => format!("{sign}{w}.{p}"),
    }
}
