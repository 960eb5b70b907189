//! Which triangle is seen at each sample of a picture.

use super::view::{Camera, Pixel};
use crate::scene::Scene;
use glam::DVec3;

/// A triangle on the picture.
#[derive(Clone, Debug)]
pub(crate) struct Shown {
    pub(crate) corners: [Pixel; 3],
    /// Index of the part and of the triangle in its patch.
    pub(crate) part: u32,
    pub(crate) triangle: u32,
    /// Whether its back is seen: its corners go clockwise.
    pub(crate) back: bool,
}

/// No triangle.
pub(crate) const NONE: u32 = u32::MAX;

/// Twice the area in square pixels below which a triangle covers no sample anyone would miss.
const NO_AREA: f64 = 1e-12;

/// All triangles of a scene on the picture, in the order of the scene.
pub(crate) fn project(scene: &Scene, camera: &Camera) -> Vec<Shown> {
    let points: Vec<Pixel> = scene
        .mesh
        .points
        .iter()
        .map(|p| camera.project(*p))
        .collect();
    let mut shown = Vec::with_capacity(scene.triangles());
    for (part, (_, patch)) in scene.patches().enumerate() {
        for (triangle, t) in patch.triangles.iter().enumerate() {
            let corners = t.map(|i| points[patch.vertices[i as usize].point as usize]);
            // y is downward on the picture: counter-clockwise in space has a negative area here.
            let area = area2(&corners);
            if area.abs() > NO_AREA {
                shown.push(Shown {
                    corners,
                    part: part as u32,
                    triangle: triangle as u32,
                    back: area > 0.0,
                });
            }
        }
    }
    shown
}

fn area2([a, b, c]: &[Pixel; 3]) -> f64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// The shares of a triangle's corners at a place of the picture; they sum to 1 and are negative outside.
pub(crate) fn shares(corners: &[Pixel; 3], x: f64, y: f64) -> [f64; 3] {
    let [a, b, c] = corners;
    let inverse = 1.0 / area2(corners);
    let at = |p: &Pixel, q: &Pixel| ((q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x)) * inverse;
    let (s, t) = (at(b, c), at(c, a));
    [s, t, 1.0 - s - t]
}

/// A band of rows of a picture at sample resolution.
pub(crate) struct Band {
    /// Samples in a row and rows.
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// The number in the list of the triangle that is seen, or [`NONE`].
    pub(crate) seen: Vec<u32>,
    /// Its nearness.
    pub(crate) near: Vec<f64>,
}

/// Rasterises the listed triangles into rows `top..top + height` of samples; `per` samples make a pixel's side.
///
/// A sample on a common edge is taken by both triangles, so no gap opens; at equal nearness the first one stays.
pub(crate) fn band(
    shown: &[Shown],
    listed: &[u32],
    width: usize,
    top: usize,
    height: usize,
    per: usize,
) -> Band {
    let mut out = Band {
        width,
        height,
        seen: vec![NONE; width * height],
        near: vec![f64::NEG_INFINITY; width * height],
    };
    for &number in listed {
        each_sample(
            &shown[number as usize].corners,
            width,
            top,
            height,
            per,
            |index, near| {
                if near > out.near[index] {
                    out.near[index] = near;
                    out.seen[index] = number;
                }
            },
        );
    }
    out
}

/// Calls `visit` with the index in the band and the nearness at every sample inside a triangle.
pub(crate) fn each_sample(
    corners: &[Pixel; 3],
    width: usize,
    top: usize,
    height: usize,
    per: usize,
    mut visit: impl FnMut(usize, f64),
) {
    let per = per as f64;
    let span = |f: fn(&Pixel) -> f64| {
        let v = corners.each_ref().map(f);
        (
            v[0].min(v[1]).min(v[2]) * per - 0.5,
            v[0].max(v[1]).max(v[2]) * per - 0.5,
        )
    };
    let ((x0, x1), (y0, y1)) = (span(|p| p.x), span(|p| p.y));
    let (left, right) = (
        x0.ceil().max(0.0) as usize,
        x1.floor().min(width as f64 - 1.0),
    );
    let (first, last) = (
        y0.ceil().max(top as f64) as usize,
        y1.floor().min((top + height) as f64 - 1.0),
    );
    if right < 0.0 || last < 0.0 {
        return;
    }
    let near = corners.each_ref().map(|c| c.near);
    let step = 1.0 / per;
    for row in first..=last as usize {
        let y = (row as f64 + 0.5) * step;
        let at = |column: usize| shares(corners, (column as f64 + 0.5) * step, y);
        let base = at(left);
        let next = at(left + 1);
        let slope = [next[0] - base[0], next[1] - base[1], next[2] - base[2]];
        // Only the columns between the edges: a thin triangle that lies askew has a large box and few samples.
        let (mut from, mut to) = (0.0f64, right - left as f64);
        for (b, s) in base.iter().zip(slope) {
            let crossing = (-EDGE - b) / s;
            if s > 0.0 {
                from = from.max(crossing - 1.0);
            } else if s < 0.0 {
                to = to.min(crossing + 1.0);
            } else if *b < -EDGE {
                to = -1.0;
            }
        }
        if from > to {
            continue;
        }
        for column in left + from.max(0.0) as usize..=left + to as usize {
            let k = (column - left) as f64;
            let b = [
                base[0] + k * slope[0],
                base[1] + k * slope[1],
                base[2] + k * slope[2],
            ];
            if b.iter().all(|&s| s >= -EDGE) {
                visit(
                    (row - top) * width + column,
                    b[0] * near[0] + b[1] * near[1] + b[2] * near[2],
                );
            }
        }
    }
}

/// Samples this far outside, in shares of the triangle, still count: rounding must not open gaps between neighbours.
const EDGE: f64 = 1e-9;

/// The triangles that touch each band of `rows` pixel rows.
pub(crate) fn by_band(shown: &[Shown], height: usize, rows: usize) -> Vec<Vec<u32>> {
    let mut lists = vec![Vec::new(); height.div_ceil(rows)];
    for (number, s) in shown.iter().enumerate() {
        let y = s.corners.each_ref().map(|c| c.y);
        let (lo, hi) = (y[0].min(y[1]).min(y[2]), y[0].max(y[1]).max(y[2]));
        if hi < 0.0 || lo >= height as f64 {
            continue;
        }
        let last = (hi as usize / rows).min(lists.len() - 1);
        for list in &mut lists[lo.max(0.0) as usize / rows..=last] {
            list.push(number as u32);
        }
    }
    lists
}

/// The normal at shares of a triangle, turned to the side that is seen and never away from the eye.
pub(crate) fn seen_normal(normals: [DVec3; 3], share: [f64; 3], back: bool, eye: DVec3) -> DVec3 {
    let mut n = normals[0] * share[0] + normals[1] * share[1] + normals[2] * share[2];
    if back {
        n = -n;
    }
    let n = n.normalize_or(eye);
    // A smooth normal may point past the outline of a faceted surface.
    let away = n.dot(eye);
    if away < 0.0 {
        (n - eye * away).normalize_or(eye)
    } else {
        n
    }
}
