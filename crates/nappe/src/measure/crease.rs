//! Creases inside a surface: lines between its analytic pieces where the tangent plane turns.

use crate::breaks::{Breaks, Limit};
use crate::interval::Interval;
use crate::surface::{Dir, Surface, normal_at};
use glam::DVec3;

/// A line `u = at` or `v = at` across which the tangent plane turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crease {
    /// The parameter that is constant along the crease.
    pub dir: Dir,
    /// Its value.
    pub at: f64,
    /// The largest angle found between the normals of both sides, radians in (0, π].
    pub angle: f64,
    /// Where that is.
    pub uv: [f64; 2],
}

/// Places examined along each line.
const PLACES: usize = 33;

/// A smaller angle, radians, is the rounding of normals and not a crease.
const ROUNDING: f64 = 1e-7;

/// The normals before and after a line, and the tangent across after it.
struct Beside {
    uv: [f64; 2],
    normals: [DVec3; 2],
    across: DVec3,
}

impl Beside {
    fn angle(&self) -> f64 {
        let [a, b] = self.normals;
        a.cross(b).length().atan2(a.dot(b))
    }
}

/// Both sides of a place of the line where the parameter `dir` has the value `at`; `None` where one has no normal.
fn beside(surface: &dyn Surface, dir: Dir, at: f64, along: f64) -> Option<Beside> {
    let (uv, limit): (_, fn(Limit) -> [Limit; 2]) = match dir {
        Dir::U => ([at, along], |l| [l, Limit::Above]),
        Dir::V => ([along, at], |l| [Limit::Above, l]),
    };
    let both = [Limit::Below, Limit::Above];
    let [a, b] = both.map(|l| normal_at(surface, uv, limit(l)).vector());
    let across = |l| surface.jet(uv, limit(l), 1).d[if dir == Dir::U { 1 } else { 2 }];
    Some(Beside {
        uv,
        normals: [a?, b?],
        across: across(Limit::Above),
    })
}

/// Places inside a range: a pole at its end does not hide the line.
fn inside(range: Interval, count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| range.lo + (range.hi - range.lo) * (i as f64 + 0.5) / count as f64)
}

/// Places along a piece of a line: an angle that is analytic along it does not vanish in all of them by accident.
const PIECE: usize = 9;

/// The sharpest places found where the surface turns towards its normal in a crease, and away from it.
/// Cost: 18 normals for each piece of the breaks with less than one continuous derivative.
pub(super) fn sharpest(surface: &dyn Surface) -> [Option<[f64; 2]>; 2] {
    let mut worst = [(ROUNDING, None); 2];
    for (dir, other) in [(Dir::U, Dir::V), (Dir::V, Dir::U)] {
        let along = surface.breaks(other);
        for at in surface.breaks(dir).below(1) {
            let places = (0..along.pieces()).flat_map(|k| inside(along.piece(k), PIECE));
            for b in places.filter_map(|t| beside(surface, dir, at, t)) {
                let turn = b.normals[0].dot(b.across.normalize_or_zero());
                // Folded back onto itself, it counts for both sides.
                let sides = [turn > -ROUNDING, turn < ROUNDING];
                for (side, counts) in worst.iter_mut().zip(sides) {
                    if counts && b.angle() > side.0 {
                        *side = (b.angle(), Some(b.uv));
                    }
                }
            }
        }
    }
    worst.map(|w| w.1)
}

/// The creases of a surface: at every break with less than one continuous derivative, the angle between the normals
/// of both sides at 33 places. A witness, not a bound. Cost: 66 normals for each such break.
pub fn creases(surface: &dyn Surface) -> Vec<Crease> {
    let mut found = Vec::new();
    for (d, dir) in [Dir::U, Dir::V].into_iter().enumerate() {
        let along = surface.domain()[1 - d];
        for at in surface.breaks(dir).below(1) {
            let worst = inside(along, PLACES)
                .filter_map(|t| beside(surface, dir, at, t))
                .map(|b| Crease {
                    dir,
                    at,
                    angle: b.angle(),
                    uv: b.uv,
                })
                .max_by(|a, b| a.angle.total_cmp(&b.angle));
            found.extend(worst.filter(|c| c.angle > ROUNDING));
        }
    }
    found
}
