//! Creases inside a surface: lines between its analytic pieces where the tangent plane turns.

use crate::breaks::{Breaks, Limit};
use crate::surface::{Dir, Surface, normal_at};

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

/// The creases of a surface: at every break with less than one continuous derivative, the angle between the normals
/// of both sides at 33 places. A witness, not a bound. Cost: 66 normals for each such break.
pub fn creases(surface: &dyn Surface) -> Vec<Crease> {
    let mut found = Vec::new();
    for dir in [Dir::U, Dir::V] {
        let along = surface.domain()[if dir == Dir::U { 1 } else { 0 }];
        for at in surface.breaks(dir).below(1) {
            let place = |i: usize| {
                // Inside, so that a pole at the end does not hide the line.
                let t = along.lo + (along.hi - along.lo) * (i as f64 + 0.5) / PLACES as f64;
                let (uv, limit): (_, fn(Limit) -> [Limit; 2]) = match dir {
                    Dir::U => ([at, t], |l| [l, Limit::Above]),
                    Dir::V => ([t, at], |l| [Limit::Above, l]),
                };
                let normal = |l| normal_at(surface, uv, limit(l)).vector();
                let (a, b) = (normal(Limit::Below)?, normal(Limit::Above)?);
                Some(Crease {
                    dir,
                    at,
                    angle: a.cross(b).length().atan2(a.dot(b)),
                    uv,
                })
            };
            let worst = (0..PLACES)
                .filter_map(place)
                .max_by(|a, b| a.angle.total_cmp(&b.angle));
            found.extend(worst.filter(|c| c.angle > ROUNDING));
        }
    }
    found
}
