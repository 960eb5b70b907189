//! One step along a curve: a box that holds nothing but one arc of it, and a cubic beside the arc with a bound.
//!
//! **The bound.** Over a box where [`Contraction`] proves an arc, let p be a point of a path in the box and x the point of the arc
//! with the same parameter k. By the mean value theorem `F(p) = M (p - x)` for a matrix M among the enclosed derivatives, so
//! the residual `Y F(p)` bounds the distance: `|p - x| ≤ (1 - |1 - Y J|)⁻¹ |Y F(p)|`. On a section of the path where both
//! surfaces are analytic the residual `g(s)`, s from 0 to 1, is the cubic with the values and slopes of its ends and a rest of
//! at most `max |g''''| / 384`: `|g| ≤ max |g(0)|, |g(1)| + 4/27 (|g'(0)| + |g'(1)|) + max |g''''| / 384`.

use super::pair::{Box4, Contraction, Knot, Pair, Place, others};
use crate::box3::Box3;
use crate::breaks::{Breaks, Limit};
use crate::curve::Curve;
use crate::interval::Interval;
use crate::query::path::{Part, Path};
use crate::query::solve::encloses;
use std::array::from_fn;

/// The arc is proven this far beyond both ends, relative to the step.
const BEYOND: f64 = 0.125;
/// The room around the arc, relative to the step: tried one after the other.
const ROOMS: [f64; 2] = [2.0, 0.3];
/// A box that is not wider than this many times the rounding errors is as good as it gets.
const ROUNDING: f64 = 16.0;
/// A place as near as this to a side, relative to the rectangle, is on it.
pub(super) const ON_SIDE: f64 = 1e-12;

/// A cubic through the parameters of both surfaces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part4 {
    pub(super) points: [Place; 4],
    /// Its length in scaled parameters.
    pub(super) length: f64,
    /// Whether the path is smooth where it begins.
    pub(super) smooth: bool,
}

impl Part4 {
    /// Its part in the parameters of one surface.
    pub(super) fn half(&self, surface: usize) -> Part {
        Part {
            points: self.points.map(|p| [p[2 * surface], p[2 * surface + 1]]),
            length: self.length,
            smooth: self.smooth,
        }
    }

    /// Its place at t from 0 to 1.
    pub(super) fn at(&self, t: f64) -> Place {
        let r = 1.0 - t;
        let weights = [r * r * r, 3.0 * r * r * t, 3.0 * r * t * t, t * t * t];
        from_fn(|j| (0..4).map(|i| weights[i] * self.points[i][j]).sum())
    }

    /// A box around it.
    pub(super) fn hull(&self) -> Box4 {
        from_fn(|j| {
            let first = Interval::point(self.points[0][j]);
            let points = self.points.iter().map(|p| Interval::point(p[j]));
            points.fold(first, Interval::hull)
        })
    }
}

/// A box with one arc: for each value of parameter `k` in its range there is one solution in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tube {
    pub(super) bounds: Box4,
    pub(super) k: usize,
    /// Parameter k where the step begins and where it ends.
    pub(super) from: f64,
    pub(super) to: f64,
}

/// What a step leads to.
#[derive(Clone, Copy, Debug)]
pub(super) enum Leads {
    /// On.
    To(Knot),
    /// Out of a rectangle.
    Out(Knot),
    /// Back to the start.
    Back,
}

/// A step along a curve.
pub(super) struct Step {
    pub(super) tube: Tube,
    /// `None` if the curve leaves at once.
    pub(super) part: Option<Part4>,
    /// How far path and curve are apart at most in space.
    pub(super) error: f64,
    pub(super) leads: Leads,
}

/// How steps are made.
pub(super) struct Stepper<'a> {
    pub(super) pair: &'a Pair,
    pub(super) tol: f64,
    /// The widths of the domains: lengths of parts are measured in them.
    pub(super) widths: Place,
}

impl Stepper<'_> {
    /// A step of a length in space along the tangent (`sign` +1) or against it; `None` if it cannot be proven, then shorter
    /// ones may be. `start` is where the curve was begun, if it may close there. A step that is `last` need not be within
    /// the tolerance.
    pub(super) fn step(
        &self,
        from: &Knot,
        sign: f64,
        length: f64,
        start: Option<&Knot>,
        last: bool,
    ) -> Option<Step> {
        let pair = self.pair;
        let weight = |j: usize| from.tangent[j].abs() * from.scale[j];
        let k = (0..4).max_by(|&a, &b| weight(a).total_cmp(&weight(b)))?;
        let way = sign * length * from.tangent[k];
        let mut guess: Place = from_fn(|j| from.x[j] + 0.5 * sign * length * from.tangent[j]);
        guess[k] = from.x[k] + 0.5 * way;
        let centre = pair.with(guess, k)?;
        let mut guess: Place = from_fn(|j| 2.0 * centre[j] - from.x[j]);
        guess[k] = from.x[k] + way;
        let ahead = pair.knot(guess, k)?;
        let around = |room: f64| -> Box4 {
            from_fn(|j| {
                if j == k {
                    return Interval::new(from.x[k], ahead.x[k]).inflate(BEYOND * way.abs());
                }
                let reach = [from.x[j], ahead.x[j]].map(|x| (x - centre[j]).abs());
                let room = room * way.abs() * from.scale[k] / from.scale[j];
                Interval::point(centre[j]).inflate(1.25 * reach[0].max(reach[1]) + room)
            })
        };
        // The more room, the sooner what is beside the arc is known to be nothing.
        let (bounds, arc) = ROOMS.into_iter().find_map(|room| {
            let bounds = around(room);
            if !bounds.iter().all(|b| b.is_finite()) {
                return None;
            }
            let arc = pair.contraction(&centre, &bounds, k)?;
            let known = arc.proves(&bounds)
                && encloses(&bounds, &from.zero)
                && encloses(&bounds, &ahead.zero);
            known.then_some((bounds, arc))
        })?;
        let tube = Tube {
            bounds,
            k,
            from: from.x[k],
            to: ahead.x[k],
        };
        let progress = |x: &Place| (x[k] - from.x[k]) / way;
        let closes = start.filter(|s| {
            let t = progress(&s.x);
            t > 0.0 && t <= 1.0 + 0.5 * BEYOND && encloses(&bounds, &s.zero)
        });
        let leads = closes.map_or(Leads::To(ahead), |_| Leads::Back);
        let to = closes.unwrap_or(&ahead);
        let (leads, to) = match self.exit(&arc, &bounds, from, to)? {
            None => (leads, *to),
            Some(q) if progress(&q.x) <= ON_SIDE => {
                return Some(Step {
                    tube,
                    part: None,
                    error: 0.0,
                    leads: Leads::Out(*from),
                });
            }
            Some(q) => (Leads::Out(q), q),
        };
        let part = self.cubic(from, &to, sign);
        if !encloses(&bounds, &part.hull()) {
            return None;
        }
        let off = self.off(&arc, &part)?;
        let stays = (0..4).all(|j| {
            pair.outer[j].encloses(part.hull()[j].inflate(off[j])) || self.is_monotone(&arc, j)
        });
        if !stays {
            return None;
        }
        let space = |off: &Place| {
            let surface = |n: usize| {
                let each = |j: usize| arc.over.columns[j].norm().hi * off[j];
                each(2 * n) + each(2 * n + 1)
            };
            surface(0).max(surface(1))
        };
        let late = space(&from_fn(|j| from.zero[j].width() + to.zero[j].width()));
        let error = (space(&off) + late) * (1.0 + 1e-12);
        let enough = self.tol.max(ROUNDING * late);
        ((error <= enough || last) && error.is_finite()).then_some(Step {
            tube,
            part: Some(part),
            error,
            leads,
        })
    }

    /// Where the arc leaves the rectangles between two places; `None` inside if it does not, `None` if that is not known.
    #[allow(clippy::option_option)] // As said.
    fn exit(
        &self,
        arc: &Contraction,
        bounds: &Box4,
        from: &Knot,
        to: &Knot,
    ) -> Option<Option<Knot>> {
        let pair = self.pair;
        let k = arc.k;
        let progress = |x: &Place| (x[k] - from.x[k]) / (to.x[k] - from.x[k]);
        let mut first: Option<Knot> = None;
        for j in 0..4 {
            let r = pair.rect[j];
            let (x, y) = (from.x[j], to.x[j]);
            let side = if y > r.hi && y > x {
                r.hi
            } else if y < r.lo && y < x {
                r.lo
            } else {
                continue;
            };
            if !self.is_monotone(arc, j) {
                // Along the side: it counts as on it.
                if pair.outer[j].contains(y) {
                    continue;
                }
                return None;
            }
            if (x - side).abs() <= ON_SIDE * r.width() || (x > side) == (y > x) {
                return Some(Some(*from));
            }
            let t = (side - x) / (y - x);
            let mut guess: Place = from_fn(|i| from.x[i] + t * (to.x[i] - from.x[i]));
            guess[j] = side;
            let q = pair.knot(guess, j)?;
            if !encloses(bounds, &q.zero) {
                return None;
            }
            if first.is_none_or(|f| progress(&q.x) < progress(&f.x)) {
                first = Some(q);
            }
        }
        Some(first)
    }

    /// True if parameter j is proven to run one way along the arc.
    fn is_monotone(&self, arc: &Contraction, j: usize) -> bool {
        let Some(i) = others(arc.k).iter().position(|&o| o == j) else {
            return true;
        };
        arc.slopes().is_some_and(|s| !s[i].contains(0.0))
    }

    /// The cubic with the tangents of both ends, held in the rectangles.
    fn cubic(&self, from: &Knot, to: &Knot, sign: f64) -> Part4 {
        let length = |d: &Place| {
            let squares = (0..4).map(|j| (d[j] / self.widths[j]).powi(2));
            squares.sum::<f64>().sqrt()
        };
        let chord = length(&from_fn(|j| to.x[j] - from.x[j]));
        let inner = |knot: &Knot, sign: f64| -> Place {
            let third = sign * chord / (3.0 * length(&knot.tangent));
            from_fn(|j| knot.x[j] + third * knot.tangent[j])
        };
        let points = [from.x, inner(from, sign), inner(to, -sign), to.x];
        Part4 {
            points: points.map(|p| self.pair.held(p)),
            length: chord,
            smooth: true,
        }
    }

    /// How far each parameter of the path is at most from that of the arc with the same parameter k; `None` if that is not known.
    fn off(&self, arc: &Contraction, part: &Part4) -> Option<Place> {
        let k = arc.k;
        let steps = part.points.windows(2).map(|w| w[1][k] - w[0][k]);
        let forward = part.points[3][k] > part.points[0][k];
        // The path must not turn back.
        if steps.into_iter().any(|s| s != 0.0 && (s > 0.0) != forward) {
            return None;
        }
        let residual = self.residual(arc, part)?;
        let z = arc.solved(residual)?;
        let mut off = [0.0; 4];
        for (i, &j) in others(k).iter().enumerate() {
            off[j] = z[i];
        }
        Some(off)
    }

    /// Bounds for `|Y F|` on a path in the rectangles.
    fn residual(&self, arc: &Contraction, part: &Part4) -> Option<[f64; 3]> {
        let paths = [0, 1].map(|n| Path::on(&[part.half(n)], self.pair.surfaces[n].clone()));
        let breaks = crate::breaks::merge_breaks(paths.iter().map(Path::breaks));
        let mut worst = [0.0f64; 3];
        for piece in (0..breaks.pieces()).map(|i| breaks.piece(i)) {
            // Derivatives of Y F by the parameter of the section.
            let over = |t: Interval, limit: Limit, order: usize| {
                let [a, b] = paths.each_ref().map(|path| {
                    let mut d = vec![Box3::ENTIRE; order + 1];
                    path.enclose_piece(t, limit, &mut d);
                    d
                });
                let width = Interval::point(piece.hi) - Interval::point(piece.lo);
                let rows = (0..=order).map(|n| {
                    arc.times(a[n] - b[n])
                        .map(|g| (g * width.powi(n as i32)).mag())
                });
                rows.collect::<Vec<[f64; 3]>>()
            };
            let start = over(Interval::point(piece.lo), Limit::Above, 1);
            let end = over(Interval::point(piece.hi), Limit::Below, 1);
            let all = over(piece, Limit::Above, 4);
            for i in 0..3 {
                let ends = start[0][i].max(end[0][i]);
                let slopes = start[1][i] + end[1][i];
                let fourth = ends + slopes * (4.0 / 27.0) + all[4][i] / 384.0;
                let bound = fourth
                    .min(ends + all[2][i] / 8.0)
                    .min(ends + all[1][i] / 2.0);
                worst[i] = worst[i].max(bound * (1.0 + 1e-14));
            }
        }
        worst.iter().all(|w| w.is_finite()).then_some(worst)
    }
}
