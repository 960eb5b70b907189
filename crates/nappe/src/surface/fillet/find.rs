//! Finding the paths along which a ball touches two surfaces: by samples of each of them, so that neither may be small
//! beside the other.

use super::FilletError;
use super::contact::{Place, Supports};
use super::spine::Spine;
use super::trace::{Lost, Trace, Tracer};
use crate::breaks::{Breaks, Limit};
use crate::parallel;
use crate::query::{Finder, FinderOptions};
use crate::surface::{Dir, Normal, normal_at};
use glam::DVec3;

/// Samples of a surface in each direction, at least, and in each piece.
const SAMPLES: [usize; 2] = [33, 4];
/// The most samples in each direction.
const MOST: usize = 200;
/// So many balls that are lost are enough.
const MOST_LOST: usize = 4;
/// How far another radius is looked for, as a power of two, and how often the range is then halved.
const OCTAVES: i32 = 6;
const BISECTIONS: usize = 12;
/// Balls whose distance from both surfaces is looked at, and how much nearer than its radius a surface must be that it cuts
/// through, relative to the size and place: far above rounding.
const BALLS: usize = 64;
const CUT: f64 = 1e-9;
/// How well nearest points are looked for, relative to the size: they are only where Newton's method starts.
const NEAR: f64 = 1e-5;
/// The effort for one of them. Most take some tens of halves; beside a surface that is larger by a factor of 10⁶ rounding keeps
/// all from that, and thousands of points would each take the whole budget.
const EFFORT: usize = 300;

/// Looks for balls between two surfaces.
pub(super) struct Search<'a> {
    supports: &'a Supports,
    pub size: f64,
    sides: Vec<Side>,
}

/// One of the surfaces, which is sampled, and what finds nearest points of the other one.
struct Side {
    index: usize,
    lines: [Vec<f64>; 2],
    other: Finder,
}

impl<'a> Search<'a> {
    /// `None` if neither surface can be searched.
    pub(super) fn new(supports: &'a Supports, size: f64) -> Option<Self> {
        let options = FinderOptions {
            tol: Some(NEAR * size),
            budget: EFFORT,
            ..Default::default()
        };
        let side = |index: usize| {
            let other = 1 - index;
            Some(Side {
                index,
                lines: [Dir::U, Dir::V].map(|dir| lines(supports.surfaces[index].breaks(dir))),
                other: Finder::new(&supports.surfaces[other..=other], options).ok()?,
            })
        };
        let sides: Vec<Side> = (0..2).filter_map(side).collect();
        (!sides.is_empty()).then_some(Self {
            supports,
            size,
            sides,
        })
    }

    pub(super) fn supports(&self) -> &'a Supports {
        self.supports
    }

    /// All paths found for a radius, and where others could not be followed. A path that winds between the samples, or touches
    /// only once, may be missed.
    pub(super) fn traces(&self, radius: f64) -> (Vec<Trace>, Vec<Lost>) {
        let tracer = self.tracer(radius);
        let mut traces: Vec<Trace> = Vec::new();
        let mut lost = Vec::new();
        for x in self.seeds(radius) {
            let Some(sample) = tracer.at(x) else { continue };
            if traces.iter().any(|t| t.holds(&sample)) {
                continue;
            }
            match tracer.trace(x) {
                Ok(trace) if trace.length() > 0.0 && trace.samples.len() > 2 => traces.push(trace),
                Ok(_) => {}
                Err(l) => lost.push(l),
            }
            if lost.len() >= MOST_LOST {
                break;
            }
        }
        (traces, lost)
    }

    /// Another radius for which a ball touches both surfaces, and where: the greatest below the given one, or else the least
    /// above. Estimated: by samples.
    pub(super) fn fits(&self, radius: f64) -> Option<(f64, DVec3)> {
        let touches = |r: f64| {
            let x = self.seeds(r).into_iter().next()?;
            Some((r, self.tracer(r).at(x)?.centre))
        };
        let far =
            |factor: f64| (1..=OCTAVES).find_map(|k| Some((k, touches(radius * factor.powi(k))?)));
        let (factor, (k, mut found)) = [0.5, 2.0].into_iter().find_map(|f| Some((f, far(f)?)))?;
        let mut fails = radius * factor.powi(k - 1);
        for _ in 0..BISECTIONS {
            let middle = (fails * found.0).sqrt();
            match touches(middle) {
                Some(better) => found = better,
                None => fails = middle,
            }
        }
        Some(found)
    }

    pub(super) fn tracer(&self, radius: f64) -> Tracer<'a> {
        Tracer {
            supports: self.supports,
            radius,
            size: self.size,
        }
    }

    /// Where the ball cuts deepest through a part of a surface that it does not touch: a point of it is nearer to the centre
    /// than the radius. Looked for at samples of the path; what is found is certain.
    pub(super) fn cut(&self, spine: &Spine) -> Option<FilletError> {
        let at = |i: usize| i as f64 / BALLS as f64;
        let centres: Vec<DVec3> = (0..=BALLS)
            .map(|i| spine.centre(at(i)) + self.supports.origin)
            .collect();
        let mut worst = None;
        let mut deepest: f64 = 0.0;
        for side in &self.sides {
            let found = side.other.nearest_many(&centres, parallel::all_threads());
            for (i, (found, place)) in found.iter().zip(&centres).enumerate() {
                let Ok(found) = found else { continue };
                let radius = spine.radius.series_at(at(i), Limit::Above, 0).value();
                let depth = radius - found.distance;
                if depth > deepest.max(CUT * (self.size + place.length())) {
                    deepest = depth;
                    worst = Some(FilletError::CutsThrough {
                        index: 1 - side.index,
                        at: at(i),
                        place: *place,
                        radius,
                        depth,
                    });
                }
            }
        }
        worst
    }

    /// Places where a ball touches both surfaces.
    pub(super) fn seeds(&self, radius: f64) -> Vec<Place<f64>> {
        let each = self.sides.iter().flat_map(|s| self.seeds_of(s, radius));
        each.collect()
    }

    /// Where the distance of the ball's centre over one surface from the other passes the radius between two samples.
    fn seeds_of(&self, side: &Side, radius: f64) -> Vec<Place<f64>> {
        let [us, vs] = &side.lines;
        let (k, l) = (side.index, 1 - side.index);
        let [first, second] = [k, l].map(|i| self.supports.surfaces[i].as_ref());
        let pairs: Vec<[f64; 2]> = us
            .iter()
            .flat_map(|&u| vs.iter().map(move |&v| [u, v]))
            .collect();
        let normal = |s, uv| match normal_at(s, uv, Default::default()) {
            Normal::Regular(n) => Some(n),
            _ => None,
        };
        let centres: Vec<DVec3> = pairs
            .iter()
            .map(|&uv| match normal(first, uv) {
                Some(n) => first.point(uv) + n * (radius * self.supports.sides[k]),
                None => DVec3::NAN,
            })
            .collect();
        let threads = parallel::all_threads();
        let found = side.other.nearest_many(&centres, threads);
        // The distance, negative on the other side of the second surface, and the nearest point.
        let over: Vec<Option<(f64, [f64; 2])>> = found
            .iter()
            .zip(&centres)
            .map(|(found, &c)| {
                let found = found.as_ref().ok()?;
                let n = normal(second, found.uv)?;
                let height = (c - found.point).dot(n) * self.supports.sides[l];
                Some((found.distance.copysign(height) - radius, found.uv))
            })
            .collect();
        let tracer = self.tracer(radius);
        let mut seeds = Vec::new();
        let count = vs.len();
        for i in 0..us.len() {
            for j in 0..count {
                let a = i * count + j;
                let mut pair = |b: usize| {
                    let (Some((fa, ya)), Some((fb, yb))) = (over[a], over[b]) else {
                        return;
                    };
                    if (fa > 0.0) == (fb > 0.0) {
                        return;
                    }
                    let share = fa / (fa - fb);
                    let x = [0, 1].map(|d| pairs[a][d] + share * (pairs[b][d] - pairs[a][d]));
                    let y = if share < 0.5 { ya } else { yb };
                    let both = if k == 0 { [x, y] } else { [y, x] };
                    seeds.extend(tracer.nearest([both[0][0], both[0][1], both[1][0], both[1][1]]));
                };
                if i + 1 < us.len() {
                    pair(a + count);
                }
                if j + 1 < count {
                    pair(a + 1);
                }
            }
        }
        seeds
    }
}

/// Parameters over all pieces, a little aside of the ends, where poles may be.
fn lines(breaks: &[crate::breaks::Break]) -> Vec<f64> {
    let pieces = breaks.pieces();
    let each = SAMPLES[0]
        .div_ceil(pieces)
        .max(SAMPLES[1])
        .min((MOST / pieces).max(1));
    (0..pieces)
        .flat_map(|i| {
            let piece = breaks.piece(i);
            (0..each).map(move |k| {
                // Not even, so that symmetric surfaces are not met in their symmetry.
                let share = (k as f64 + 0.03 + 0.94 * (k as f64 / each as f64)) / each as f64;
                piece.lo + piece.width() * share.min(1.0)
            })
        })
        .collect()
}
