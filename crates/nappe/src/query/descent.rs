//! The nearest place over a part, by Newton's method within its box.

use super::part::{Part, Place, half_width, lowest};
use super::shape::Shape;
use crate::interval::Interval;
use crate::surface::jet_len;
use glam::DVec3;

/// Steps of Newton's method at most; it converges in a few.
const STEPS: usize = 32;
/// Halvings of a step that leads up.
const HALVINGS: usize = 30;

/// The distance at a place with its derivatives by u and v.
pub(super) struct Local {
    point: DVec3,
    half_square: f64,
    gradient: [f64; 2],
    hessian: [f64; 3],
}

impl Part {
    /// The nearest place over a part where the distance is convex, and a lower bound of the distance over the part. Ends when
    /// `enough` is true for half the squared distance and the bound.
    pub(super) fn nearest(
        &self,
        shape: &Shape,
        p: DVec3,
        enough: impl Fn(f64, f64) -> bool,
    ) -> (Place, f64) {
        let (hessian, springs) = self.springs(p);
        let mut uv = self.begin(p, hessian);
        let (mut best, mut lower) = (self.middle(p), f64::NEG_INFINITY);
        let mut now = self.tangents(shape, p, uv);
        for _ in 0..STEPS {
            if now.half_square < best.half_square {
                best = Place {
                    uv,
                    point: now.point,
                    half_square: now.half_square,
                    ..best
                };
            }
            lower = f64::max(lower, self.distance(self.least(&now, uv, springs), p));
            if enough(best.half_square, lower) {
                break;
            }
            let room = [0, 1].map(|d| {
                let t = self.uv[d];
                Interval {
                    lo: t.lo - uv[d],
                    hi: t.hi - uv[d],
                }
            });
            let step = newton(now.gradient, now.hessian, room);
            if !(step[0].is_finite() && step[1].is_finite()) {
                break;
            }
            let mut share = 1.0;
            let mut next = None;
            for _ in 0..HALVINGS {
                let to = [0, 1].map(|d| {
                    let t = self.uv[d];
                    (uv[d] + share * step[d]).clamp(t.lo, t.hi)
                });
                if to == uv {
                    break;
                }
                let there = self.tangents(shape, p, to);
                if there.half_square <= now.half_square {
                    next = Some((to, there));
                    break;
                }
                share *= 0.5;
            }
            let Some((to, there)) = next else {
                break;
            };
            (uv, now) = (to, there);
        }
        (best, lower)
    }

    /// Where the distance is least as the derivatives in the middle tell: most of the way, for no evaluation.
    fn begin(&self, p: DVec3, hessian: [f64; 3]) -> [f64; 2] {
        let all = Interval { lo: -1.0, hi: 1.0 };
        let is_curve = self.uv[1].is_point();
        let [uu, uv, vv] = hessian;
        let step = if uu > 0.0 && (is_curve || uu * vv > uv * uv) {
            let second = if is_curve { Interval::ZERO } else { all };
            newton(self.gradient(p), hessian, [all, second])
        } else {
            [0.0; 2]
        };
        [0, 1].map(|d| {
            let (t, to) = (self.uv[d], step[d] * half_width(self.uv[d]));
            let at = (t.mid() + to).clamp(t.lo, t.hi);
            if at.is_nan() { t.mid() } else { at }
        })
    }

    /// The least value of half the squared distance as a place tells it, with the springs of the part, or with none.
    pub(super) fn least(&self, at: &Local, uv: [f64; 2], springs: [f64; 2]) -> f64 {
        // Where the gradient leads out of the box, nothing is lost.
        let gain = |d: usize| {
            let (t, half) = (self.uv[d], half_width(self.uv[d]));
            let room = Interval {
                lo: t.lo - uv[d],
                hi: t.hi - uv[d],
            };
            let k = springs[d] / (half * half);
            let plane = lowest(at.gradient[d], 0.0, room);
            let sprung = lowest(at.gradient[d], k * (1.0 - 8.0 * f64::EPSILON), room);
            // NaN tells nothing.
            if sprung > plane { sprung } else { plane }
        };
        at.half_square + gain(0) + gain(1)
    }

    pub(super) fn tangents(&self, shape: &Shape, p: DVec3, uv: [f64; 2]) -> Local {
        let mut jet = [DVec3::ZERO; jet_len(2)];
        shape.jet_into(uv, self.uv, 2, &mut jet);
        let [point, a, b, aa, ab, bb] = jet;
        let e = point - p;
        Local {
            point,
            half_square: 0.5 * e.length_squared(),
            gradient: [e.dot(a), e.dot(b)],
            hessian: [
                a.dot(a) + e.dot(aa),
                a.dot(b) + e.dot(ab),
                b.dot(b) + e.dot(bb),
            ],
        }
    }
}

/// The step to the least value of `g d + ½ d h d` over a box, if h is positive.
///
/// Where the least value without the box lies outside of it, that over the box lies on one of the sides between them: else the
/// straight way there would lead on down.
fn newton([g, h]: [f64; 2], [uu, uv, vv]: [f64; 3], room: [Interval; 2]) -> [f64; 2] {
    let within = |x: f64, d: usize| x.max(room[d].lo).min(room[d].hi);
    if room[1].is_point() {
        return [within(-g / uu, 0), 0.0];
    }
    let det = uu * vv - uv * uv;
    let free = [(uv * h - vv * g) / det, (uv * g - uu * h) / det];
    let held = [0, 1].map(|d| within(free[d], d));
    let on = |d: usize| {
        let (x, y) = if d == 0 {
            (held[0], within(-(h + uv * held[0]) / vv, 1))
        } else {
            (within(-(g + uv * held[1]) / uu, 0), held[1])
        };
        let value = g * x + h * y + 0.5 * (uu * x * x + vv * y * y) + uv * x * y;
        (value, [x, y])
    };
    match [0, 1].map(|d| held[d] != free[d]) {
        [false, false] => free,
        [true, false] => on(0).1,
        [false, true] => on(1).1,
        [true, true] => {
            let (a, b) = (on(0), on(1));
            if b.0 < a.0 { b.1 } else { a.1 }
        }
    }
}
