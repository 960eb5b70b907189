//! Down to the nearest place, by Newton's method within a box of parameters.

use super::shape::Shape;
use crate::interval::Interval;
use crate::surface::jet_len;
use glam::DVec3;

/// Steps at most; the method converges in a few.
const STEPS: usize = 32;
/// Halvings of a step that leads up.
const HALVINGS: usize = 30;
/// After a step that is so short beside the size of what is looked at, the next one would be as short as rounding.
const SHORT: f64 = 1e-7;
/// After a step no longer than this rounding may hide that the distance is less: that the slope is less will do.
const HIDDEN: f64 = 1e-5;
/// Below this share of what it would be if the directions were square to each other, the determinant of second derivatives is
/// not trusted.
const DEFINITE: f64 = 1e-3;

/// Half the squared distance at a place, with its derivatives by u and v.
#[derive(Clone, Copy)]
pub(super) struct Local {
    pub(super) uv: [f64; 2],
    pub(super) point: DVec3,
    pub(super) half_square: f64,
    gradient: [f64; 2],
    hessian: [f64; 3],
    /// The products of the tangents: the second derivatives for a point on the surface.
    metric: [f64; 3],
}

impl Local {
    /// With the limits from the inside of a rectangle.
    pub(super) fn new(shape: &Shape, p: DVec3, uv: [f64; 2], inside: [Interval; 2]) -> Self {
        let mut jet = [DVec3::ZERO; jet_len(2)];
        shape.jet_into(uv, inside, 2, &mut jet);
        let [point, a, b, aa, ab, bb] = jet;
        let e = point - p;
        let metric = [a.dot(a), a.dot(b), b.dot(b)];
        Self {
            uv,
            point,
            half_square: 0.5 * e.length_squared(),
            gradient: [e.dot(a), e.dot(b)],
            hessian: [
                metric[0] + e.dot(aa),
                metric[1] + e.dot(ab),
                metric[2] + e.dot(bb),
            ],
            metric,
        }
    }

    /// The least value over a box of the tangent plane of half the squared distance: a lower bound where that is convex.
    pub(super) fn least(&self, over: [Interval; 2]) -> f64 {
        // Where the gradient leads out of the box, nothing is lost.
        let gain = |d: usize| {
            let (t, g) = (over[d], self.gradient[d]);
            (g * (t.lo - self.uv[d])).min(g * (t.hi - self.uv[d]))
        };
        self.half_square + gain(0) + gain(1)
    }

    /// How long a step is.
    fn length(&self, [du, dv]: [f64; 2]) -> f64 {
        let [aa, ab, bb] = self.metric;
        (aa * du * du + 2.0 * ab * du * dv + bb * dv * dv)
            .max(0.0)
            .sqrt()
    }

    /// The square of how fast half the squared distance changes along the tangents.
    fn slope(&self) -> f64 {
        let of = |d: usize| self.gradient[d] * self.gradient[d] / self.metric[2 * d];
        of(0) + of(1)
    }

    /// The step to the least value over a box. Where second derivatives do not lead to a minimum, those for a point on the
    /// surface do.
    fn step(&self, within: [Interval; 2]) -> [f64; 2] {
        let room = [0, 1].map(|d| Interval {
            lo: within[d].lo - self.uv[d],
            hi: within[d].hi - self.uv[d],
        });
        let [uu, uv, vv] = self.hessian;
        let (square, is_curve) = (uu * vv, within[1].is_point());
        let definite = uu > 0.0 && (is_curve || square - uv * uv > DEFINITE * square);
        newton(
            self.gradient,
            if definite { self.hessian } else { self.metric },
            room,
        )
    }
}

/// Goes down from a place within a box; limits are from the inside of a rectangle around it, and `size` is that of what lies over
/// the box. Ends where it goes no further, or when `enough` is true for a place on the way.
pub(super) fn descend(
    shape: &Shape,
    p: DVec3,
    from: Local,
    [within, inside]: [[Interval; 2]; 2],
    size: f64,
    mut enough: impl FnMut(&Local) -> bool,
) -> Local {
    let mut now = from;
    let mut last = false;
    for _ in 0..STEPS {
        if enough(&now) || last {
            break;
        }
        let step = now.step(within);
        if !(step[0].is_finite() && step[1].is_finite()) {
            break;
        }
        let long = now.length(step);
        last = long <= SHORT * size;
        let mut share = 1.0;
        let mut next = None;
        for _ in 0..HALVINGS {
            let to = [0, 1].map(|d| {
                let t = within[d];
                (now.uv[d] + share * step[d]).clamp(t.lo, t.hi)
            });
            if to == now.uv {
                break;
            }
            let there = Local::new(shape, p, to, inside);
            let down = there.half_square <= now.half_square;
            if down || (long <= HIDDEN * size && there.slope() < now.slope()) {
                next = Some(there);
                break;
            }
            share *= 0.5;
        }
        let Some(there) = next else { break };
        now = there;
    }
    now
}

/// The step to the least value of `g d + ½ d h d` over a box around 0, if h is positive.
///
/// Where the least value without the box lies outside of it, that over the box lies on one of the sides between them.
fn newton([g, h]: [f64; 2], [uu, uv, vv]: [f64; 3], room: [Interval; 2]) -> [f64; 2] {
    // NaN stays.
    let within = |x: f64, d: usize| x.clamp(room[d].lo, room[d].hi);
    if room[1].is_point() {
        return [within(-g / uu, 0), 0.0];
    }
    if room[0].is_point() {
        return [0.0, within(-h / vv, 1)];
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
