//! Lines: the borders of surfaces, and what of a line is seen.

use super::raster::{Band, NONE};
use super::view::{Camera, Pixel};
use crate::scene::Scene;
use glam::{DVec2, DVec3};
use std::collections::BTreeMap;

/// The borders of all parts as chains of points: edges that only one triangle of the part has. A seam, where a surface
/// meets itself, is none.
pub(crate) fn borders(scene: &Scene) -> Vec<Vec<DVec3>> {
    let mut chains = Vec::new();
    for (_, patch) in scene.patches() {
        let mut edges: Vec<(u32, u32, bool)> = Vec::with_capacity(3 * patch.triangles.len());
        for t in &patch.triangles {
            let p = t.map(|i| patch.vertices[i as usize].point);
            for k in 0..3 {
                let (a, b) = (p[k], p[(k + 1) % 3]);
                if a != b {
                    edges.push((a.min(b), a.max(b), a < b));
                }
            }
        }
        edges.sort_unstable();
        // From each point of the border to the next ones; ordered, so that pictures are the same each time.
        let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for e in edges
            .chunk_by(|a, b| (a.0, a.1) == (b.0, b.1))
            .filter(|e| e.len() == 1)
        {
            let (from, to) = if e[0].2 {
                (e[0].0, e[0].1)
            } else {
                (e[0].1, e[0].0)
            };
            next.entry(from).or_default().push(to);
        }
        while let Some(start) = next.keys().next().copied() {
            let (mut chain, mut at) = (vec![scene.mesh.points[start as usize]], start);
            while let Some(ways) = next.get_mut(&at) {
                let to = ways.pop();
                if ways.is_empty() {
                    next.remove(&at);
                }
                let Some(to) = to else { break };
                chain.push(scene.mesh.points[to as usize]);
                at = to;
            }
            chains.push(chain);
        }
    }
    chains
}

/// The farthest distance seen within each pixel; infinite where the background shows.
pub(crate) struct Depth {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) far: Vec<f32>,
}

impl Depth {
    /// The distances of the pixels of a band of samples, `per` to a pixel's side.
    pub(crate) fn of_band(band: &Band, per: usize, camera: &Camera) -> Vec<f32> {
        let (columns, rows) = (band.width / per, band.height / per);
        let mut far = vec![0f32; columns * rows];
        for (index, f) in far.iter_mut().enumerate() {
            let (x, y) = (index % columns * per, index / columns * per);
            for s in (y..y + per)
                .flat_map(|row| (x..x + per).map(move |column| row * band.width + column))
            {
                let d = if band.seen[s] == NONE {
                    f64::INFINITY
                } else {
                    camera.distance(band.near[s])
                };
                *f = if s == y * band.width + x {
                    d as f32
                } else {
                    f.max(d as f32)
                };
            }
        }
        far
    }

    /// The farthest distance in the four pixels around a place. Around, because a line on a steep surface lies a
    /// fraction of a pixel beside the samples it is compared with.
    fn farthest(&self, p: Pixel) -> f64 {
        let (x, y) = ((p.x - 0.5).floor(), (p.y - 0.5).floor());
        let mut far = f64::NEG_INFINITY;
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let (x, y) = (x + dx, y + dy);
            if x < 0.0 || y < 0.0 || x >= self.width as f64 || y >= self.height as f64 {
                return f64::INFINITY;
            }
            far = far.max(f64::from(self.far[y as usize * self.width + x as usize]));
        }
        far
    }

    /// Whether nothing lies in front of a place by more than `bias`.
    pub(crate) fn shows(&self, p: Pixel, camera: &Camera, bias: f64) -> bool {
        camera.distance(p.near) <= self.farthest(p) + bias
    }
}

/// A piece of a line that is all seen or all hidden.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Span {
    pub(crate) points: Vec<DVec2>,
    pub(crate) seen: bool,
}

/// Distance in pixels between tests of a line.
const STEP: f64 = 0.6;
/// Pieces shorter than this many pixels are noise of the test.
const NOISE: f64 = 2.0;

/// Cuts a line where it goes behind a surface.
pub(crate) fn spans(points: &[DVec3], camera: &Camera, depth: &Depth, bias: f64) -> Vec<Span> {
    // Places along the line, whether they are seen, and whether they are corners that must stay.
    let mut places: Vec<(DVec2, bool, bool)> = Vec::new();
    let pixels: Vec<Pixel> = points.iter().map(|p| camera.project(*p)).collect();
    for ends in pixels.windows(2) {
        let (a, b) = (ends[0], ends[1]);
        let length = (b.x - a.x).hypot(b.y - a.y);
        let steps = (length / STEP).ceil().clamp(1.0, 1e6) as usize;
        for k in usize::from(!places.is_empty())..=steps {
            let t = k as f64 / steps as f64;
            let mid = |f: fn(&Pixel) -> f64| f(&a) + (f(&b) - f(&a)) * t;
            let p = Pixel {
                x: mid(|p| p.x),
                y: mid(|p| p.y),
                near: mid(|p| p.near),
            };
            places.push((
                DVec2::new(p.x, p.y),
                depth.shows(p, camera, bias),
                k == 0 || k == steps,
            ));
        }
    }
    let mut runs: Vec<(usize, usize)> = Vec::new();
    let mut start = 0;
    for run in places.chunk_by(|a, b| a.1 == b.1) {
        runs.push((start, start + run.len()));
        start += run.len();
    }
    for k in 0..runs.len() {
        let (from, to) = runs[k];
        let inner = k > 0 && k + 1 < runs.len();
        if inner && (to - from) as f64 * STEP < NOISE {
            let seen = places[runs[k - 1].0].1;
            places[from..to].iter_mut().for_each(|p| p.1 = seen);
        }
    }
    let mut out: Vec<Span> = Vec::new();
    for (index, (at, seen, corner)) in places.iter().enumerate() {
        let turns = index == 0 || places[index - 1].1 != *seen;
        if turns {
            if let Some(last) = out.last_mut() {
                last.points.push(*at);
            }
            out.push(Span {
                points: vec![*at],
                seen: *seen,
            });
        } else if (*corner || index + 1 == places.len())
            && let Some(last) = out.last_mut()
        {
            last.points.push(*at);
        }
    }
    out.retain(|s| s.points.len() > 1);
    out
}
