//! A surface as the plane of its parameters: where it closes, where it is one point, and which parameters belong to a
//! point of space.

use super::closing::{Other, apart};
use crate::breaks::{Breaks, inwards};
use crate::interval::Interval;
use crate::mesh::shared::Edge as Line;
use crate::surface::{Dir, Side, Surface};
use glam::DVec3;
use smallvec::SmallVec;
use std::sync::OnceLock;

/// Lines in each direction that are looked at to see whether a surface closes.
const LINES: usize = 9;
/// The sides of a surface meet if they are no farther apart than this share of its size.
const CLOSED: f64 = 1e-7;
/// The steps of Newton's method, and of halving in between.
const STEPS: usize = 40;
/// The fewest and the most samples in each direction for first guesses, and how many for each analytic piece.
const GUESSES: [usize; 2] = [13, 97];
const EACH: usize = 4;
/// The guesses that are followed.
const FOLLOWED: usize = 4;
/// In place of a pole, samples are beside it by this share of the way to the next ones.
const BESIDE: f64 = 0.125;

/// A side that is one point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pole {
    /// The parameter that is constant there, and its value.
    pub(super) d: usize,
    pub(super) at: f64,
    pub(super) upper: bool,
    pub(super) point: DVec3,
    /// How far points of the side are from it at most.
    pub(super) size: f64,
}

pub(super) struct Chart<'a> {
    pub(super) surface: &'a dyn Surface,
    pub(super) domain: [Interval; 2],
    /// The widths of the domain in the directions in which the surface closes.
    pub(super) period: [Option<f64>; 2],
    /// How far apart the sides are that meet.
    pub(super) slit: f64,
    /// Whether that and the sizes of poles are proven.
    pub(super) proven: bool,
    pub(super) poles: Vec<Pole>,
    pub(super) size: f64,
    /// Where first derivatives jump, u and v; with the ends where the surface closes with a crease.
    creases: [Vec<f64>; 2],
    guesses: OnceLock<Vec<([f64; 2], DVec3)>>,
}

impl<'a> Chart<'a> {
    /// Sides that are within `weld` of one point are poles.
    pub(super) fn new(surface: &'a dyn Surface, weld: f64) -> Self {
        let size = crate::measure::size(surface);
        let mut new = Self {
            surface,
            domain: surface.domain(),
            period: [None; 2],
            slit: 0.0,
            proven: true,
            poles: Vec::new(),
            size,
            creases: [Dir::U, Dir::V].map(|dir| surface.breaks(dir).below(1)),
            guesses: OnceLock::new(),
        };
        let near = weld.min(1e-6 * size);
        for side in Side::ALL {
            let line = Line::new(surface, side);
            if line.is_collapsed(near) {
                let (d, upper) = (usize::from(side.across() == Dir::V), side.is_upper());
                let point = line.point(line.range.mid());
                let size = apart(surface, d, upper, Other::Point(point), near);
                // Samples saw no more than half of what is near.
                new.proven &= size.is_some();
                if size.is_none_or(|s| s <= near) {
                    new.poles.push(Pole {
                        d,
                        at: line.at,
                        upper,
                        point,
                        size: size.unwrap_or(0.5 * near),
                    });
                }
            }
        }
        for d in 0..2 {
            new.close(d, weld.min(CLOSED * size));
        }
        new
    }

    /// Finds whether the sides at the ends of a parameter are the same.
    fn close(&mut self, d: usize, near: f64) {
        if self.poles.iter().any(|p| p.d == d) {
            return;
        }
        let (own, other) = (self.domain[d], self.domain[1 - d]);
        let (mut sampled, mut crease) = (0.0f64, false);
        for k in 0..LINES {
            let t = other.lo + (other.hi - other.lo) * k as f64 / (LINES - 1) as f64;
            let jet = |at: f64| {
                let uv = if d == 0 { [at, t] } else { [t, at] };
                self.surface.jet(uv, inwards(uv, self.domain), 1)
            };
            let (a, b) = (jet(own.lo), jet(own.hi));
            let gap = a.point().distance(b.point());
            // A NaN is no closed surface.
            if gap.is_nan() || gap > near {
                return;
            }
            sampled = sampled.max(gap);
            let (p, q) = (a.d[1 + d], b.d[1 + d]);
            // Beside a pole both are nothing but rounding.
            let rounding = 1e-9 * self.size / own.width();
            crease |= p.distance(q) > 1e-6 * (p.length() + q.length()) + rounding;
        }
        let proven = apart(self.surface, d, false, Other::Side, near);
        if proven.is_some_and(|gap| gap > 2.0 * near) {
            // Open between the samples.
            return;
        }
        self.proven &= proven.is_some();
        self.period[d] = Some(own.width());
        self.slit = self.slit.max(proven.unwrap_or(sampled));
        if crease {
            self.creases[d].extend([own.lo, own.hi]);
        }
    }

    /// The same place in the domain; what is beyond its ends comes to them.
    pub(super) fn wrapped(&self, uv: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|d| {
            let Interval { lo, hi } = self.domain[d];
            match self.period[d] {
                Some(p) if !(lo..=hi).contains(&uv[d]) => {
                    (lo + (uv[d] - lo).rem_euclid(p)).clamp(lo, hi)
                }
                _ => uv[d].clamp(lo, hi),
            }
        })
    }

    pub(super) fn point(&self, uv: [f64; 2]) -> DVec3 {
        let uv = self.wrapped(uv);
        self.surface.jet(uv, inwards(uv, self.domain), 0).point()
    }

    pub(super) fn jet(&self, uv: [f64; 2], order: usize) -> SmallVec<[DVec3; 6]> {
        let uv = self.wrapped(uv);
        self.surface.jet(uv, inwards(uv, self.domain), order).d
    }

    /// The parameters of the point nearest to `p` near a guess: Newton's method, halved until the distance does not grow.
    pub(super) fn nearest(&self, p: DVec3, guess: [f64; 2]) -> [f64; 2] {
        let clamped = |uv: [f64; 2]| {
            [0, 1].map(|d| match self.period[d] {
                Some(_) => uv[d],
                None => uv[d].clamp(self.domain[d].lo, self.domain[d].hi),
            })
        };
        let mut uv = clamped(guess);
        let mut best = self.point(uv).distance_squared(p);
        for _ in 0..STEPS {
            let j = self.jet(uv, 2);
            let r = j[0] - p;
            let g = [r.dot(j[1]), r.dot(j[2])];
            let gauss = [j[1].dot(j[1]), j[1].dot(j[2]), j[2].dot(j[2])];
            let full = [
                gauss[0] + r.dot(j[3]),
                gauss[1] + r.dot(j[4]),
                gauss[2] + r.dot(j[5]),
            ];
            // At an end of the domain only steps inwards, or along it.
            let free = [0, 1].map(|d| {
                let Interval { lo, hi } = self.domain[d];
                self.period[d].is_some()
                    || !((uv[d] <= lo && g[d] > 0.0) || (uv[d] >= hi && g[d] < 0.0))
            });
            let step = newton(full, g, free).or_else(|| newton(gauss, g, free));
            let Some(mut step) = step else { break };
            let mut moved = false;
            for _ in 0..STEPS {
                let next = clamped([uv[0] + step[0], uv[1] + step[1]]);
                let distance = self.point(next).distance_squared(p);
                if distance < best {
                    (uv, best, moved) = (next, distance, true);
                    break;
                }
                step = step.map(|s| 0.5 * s);
                if uv[0] + step[0] == uv[0] && uv[1] + step[1] == uv[1] {
                    break;
                }
            }
            if !moved {
                break;
            }
        }
        uv
    }

    /// The nearest point that is found from samples of the whole surface, and its distance.
    pub(super) fn find(&self, p: DVec3) -> ([f64; 2], f64) {
        let guesses = self.guesses.get_or_init(|| self.sample());
        let mut order: Vec<(f64, usize)> = guesses
            .iter()
            .enumerate()
            .map(|(k, g)| (g.1.distance_squared(p), k))
            .collect();
        let few = FOLLOWED.min(order.len());
        if few < order.len() {
            order.select_nth_unstable_by(few, |a, b| a.0.total_cmp(&b.0));
        }
        let found = order[..few].iter().map(|&(_, k)| {
            let uv = self.nearest(p, guesses[k].0);
            let distance = self.point(uv).distance(p);
            // A NaN may sort before all numbers.
            (
                uv,
                if distance.is_nan() {
                    f64::INFINITY
                } else {
                    distance
                },
            )
        });
        let best = found.min_by(|a, b| a.1.total_cmp(&b.1));
        best.unwrap_or(([self.domain[0].mid(), self.domain[1].mid()], f64::INFINITY))
    }

    fn sample(&self) -> Vec<([f64; 2], DVec3)> {
        let [us, vs] = [Dir::U, Dir::V].map(|dir| {
            let breaks = self.surface.breaks(dir);
            let count = (EACH * breaks.pieces() + 1).clamp(GUESSES[0], GUESSES[1]);
            let Interval { lo, hi } = breaks.domain();
            let mut at: Vec<f64> = (0..count)
                .map(|k| lo + (hi - lo) * k as f64 / (count - 1) as f64)
                .collect();
            // At a pole all samples are one point, and from it there is no way round it: those that lead away from what is
            // looked for would be followed as well as the one that leads there.
            let own = |p: &&Pole| p.d == usize::from(dir == Dir::V);
            for pole in self.poles.iter().filter(own) {
                let [end, next] = if pole.upper {
                    [count - 1, count - 2]
                } else {
                    [0, 1]
                };
                at[end] += BESIDE * (at[next] - at[end]);
            }
            at
        });
        let mut points = vec![DVec3::ZERO; us.len() * vs.len()];
        self.surface.grid(&us, &vs, &mut points);
        let pairs = us.iter().flat_map(|&u| vs.iter().map(move |&v| [u, v]));
        // Where the surface has no finite point, nothing is near.
        pairs.zip(points).filter(|g| g.1.is_finite()).collect()
    }

    /// Where first derivatives jump, in one parameter.
    pub(super) fn creases(&self, d: usize) -> &[f64] {
        &self.creases[d]
    }

    /// The parts of a range in the domain.
    pub(super) fn parts(&self, d: usize, range: Interval) -> SmallVec<[Interval; 2]> {
        let domain = self.domain[d];
        let inside = |lo: f64, hi: f64| Interval {
            lo: lo.clamp(domain.lo, domain.hi),
            hi: hi.clamp(domain.lo, domain.hi),
        };
        let mut parts = SmallVec::new();
        match self.period[d] {
            Some(p) if range.width() >= p => parts.push(domain),
            Some(p) => {
                let turns = ((range.lo - domain.lo) / p).floor();
                let (lo, hi) = (range.lo - turns * p, range.hi - turns * p);
                parts.push(inside(lo, hi));
                if hi > domain.hi {
                    parts.push(inside(domain.lo, hi - p));
                }
            }
            None => parts.push(inside(range.lo, range.hi)),
        }
        parts
    }
}

/// The step of Newton's method for a symmetric matrix `[a, b, c]`, in the free directions; `None` where it is not positive.
fn newton([a, b, c]: [f64; 3], g: [f64; 2], free: [bool; 2]) -> Option<[f64; 2]> {
    // At a pole one direction has no length; it stays where it is.
    let small = 1e-14;
    let step = match free {
        [true, true] => {
            let det = a * c - b * b;
            if a > small * c && c > small * a && det > 1e-12 * a * c {
                [-(c * g[0] - b * g[1]) / det, -(a * g[1] - b * g[0]) / det]
            } else if a >= c && a > 0.0 {
                [-g[0] / a, 0.0]
            } else if c > 0.0 {
                [0.0, -g[1] / c]
            } else {
                return None;
            }
        }
        [true, false] if a > 0.0 => [-g[0] / a, 0.0],
        [false, true] if c > 0.0 => [0.0, -g[1] / c],
        _ => return None,
    };
    step.iter().all(|s| s.is_finite()).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::{Ellipse, EllipseOptions};
    use crate::frame::Frame;
    use crate::surface::{Revolution, RevolutionOptions};
    use std::sync::Arc;

    /// Points around a pole, much nearer to it than samples are to each other, are found on all meridians.
    #[test]
    fn points_around_poles_are_found() {
        for (aside, scale, base) in [
            (0.0, 1.0, DVec3::ZERO),
            (-0.15, 1.0, DVec3::ZERO),
            (-0.15, 1e-3, DVec3::new(30.0, -20.0, 10.0)),
            (-0.15, 1e5, DVec3::splat(1e6)),
        ] {
            // A sphere, or the inner part of a torus that passes through itself.
            let frame = Frame::new(base, DVec3::new(0.3, -0.2, 1.0), DVec3::X).unwrap();
            let half = f64::acos(-aside);
            let options = EllipseOptions {
                from: -half,
                to: half,
                normal: -frame.y(),
                x_direction: Some(frame.x()),
            };
            let center = frame.point(DVec3::X * (aside * scale));
            let arc = Ellipse::new(center, [scale; 2], options).unwrap();
            let surface =
                Revolution::new(Arc::new(arc), frame, RevolutionOptions::default()).unwrap();
            let chart = Chart::new(&surface, 1e-6 * scale);
            assert_eq!(chart.poles.len(), 2);
            let (d, across) = (chart.poles[0].d, chart.domain[chart.poles[0].d]);
            let turn = chart.domain[1 - d];
            for k in 0..400 {
                let [a, b] = [0.618_034, 0.754_878].map(|s: f64| (s * f64::from(k)).fract());
                let depth = across.width() * 10f64.powf(-1.0 - 4.0 * a);
                let mut uv = [0.0; 2];
                uv[d] = if k % 2 == 0 {
                    across.lo + depth
                } else {
                    across.hi - depth
                };
                uv[1 - d] = turn.lo + b * turn.width();
                let p = chart.point(uv);
                let (found, distance) = chart.find(p);
                let rounding = 1e-12 * (scale + base.length());
                assert!(
                    distance <= rounding,
                    "{aside} {uv:?} {found:?} {distance:e}"
                );
            }
        }
    }
}
