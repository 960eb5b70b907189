//! Lines inside a surface that are one point: there it touches itself.

use super::size;
use crate::box3::Box3;
use crate::breaks::Breaks;
use crate::interval::Interval;
use crate::surface::{Dir, Surface};
use glam::DVec3;

/// A line `u = at` or `v = at` inside a surface that is one point, as the middle of an hourglass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pinch {
    /// The parameter that is constant along the line.
    pub dir: Dir,
    /// Its value.
    pub at: f64,
    /// The point.
    pub point: DVec3,
}

/// A line whose points lie within this part of the surface's size of each other is one point.
const POINT: f64 = 1e-9;
/// Lines looked at in each analytic piece, and points of each line.
const LINES: usize = 32;
const POINTS: usize = 16;
/// Steps of the search for the shortest line: each leaves two thirds of the range.
const STEPS: usize = 100;

/// The lines of constant parameter inside a surface that are one point: between lines that are shorter than their
/// neighbours the shortest is looked for. Found by samples; what is not found is not excluded.
///
/// Cost: 16 points of each of 32 lines for each piece in each direction, and of 200 lines for each place looked at.
pub fn pinches(surface: &dyn Surface) -> Vec<Pinch> {
    let size = size(surface);
    if size <= 0.0 {
        return Vec::new();
    }
    let domain = surface.domain();
    let mut found = Vec::new();
    for dir in [Dir::U, Dir::V] {
        let d = dir as usize;
        let extent = |at: f64| {
            let points = (0..=POINTS).map(|k| {
                let t = domain[1 - d].lo + domain[1 - d].width() * k as f64 / POINTS as f64;
                let mut uv = [t; 2];
                uv[d] = at;
                surface.point(uv)
            });
            Box3::around(points).map_or(f64::INFINITY, Box3::diagonal)
        };
        let breaks = surface.breaks(dir);
        let mut lines = Vec::new();
        for i in 0..breaks.pieces() {
            let p = breaks.piece(i);
            lines.extend((0..LINES).map(|k| p.lo + p.width() * k as f64 / LINES as f64));
        }
        lines.push(domain[d].hi);
        let lengths: Vec<f64> = lines.iter().map(|&at| extent(at)).collect();
        for k in 1..lines.len() - 1 {
            if lengths[k] <= lengths[k - 1] && lengths[k] <= lengths[k + 1] {
                // The search would leave a break by a rounding error.
                let at = if lengths[k] <= POINT * size {
                    lines[k]
                } else {
                    shortest(&extent, Interval::new(lines[k - 1], lines[k + 1]))
                };
                if extent(at) <= POINT * size && domain[d].lo < at && at < domain[d].hi {
                    let mut uv = domain.map(Interval::mid);
                    uv[d] = at;
                    let point = surface.point(uv);
                    found.push(Pinch { dir, at, point });
                }
            }
        }
        found.dedup_by(|a, b| a.dir == b.dir && a.at == b.at);
    }
    found
}

/// The least of a function in a range.
fn shortest(f: &dyn Fn(f64) -> f64, mut range: Interval) -> f64 {
    let mut best = (f64::INFINITY, range.mid());
    for _ in 0..STEPS {
        let [a, b] = [1.0, 2.0].map(|k| range.lo + range.width() * k / 3.0);
        let [fa, fb] = [f(a), f(b)];
        for (value, at) in [(fa, a), (fb, b)] {
            if value < best.0 {
                best = (value, at);
            }
        }
        if fa <= fb {
            range.hi = b;
        } else {
            range.lo = a;
        }
        if a <= range.lo && b >= range.hi {
            break;
        }
    }
    best.1
}
