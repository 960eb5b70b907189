//! A field over one rectangle, continued a little beyond its border, so that nothing happens exactly on the border.
//!
//! Beyond the border f goes on as `f(c) + f_u(c) x + f_v(c) y + f_uv(c) x y`, where c is the nearest place of the rectangle
//! and (x, y) the way from there: smooth, whatever f is. The margin is 2⁻³⁴ of the width: zeros of the continuation
//! count as on the border. (Smaller, and where f grows slowly from the border rounding would hide its sign.) Curves that run along the
//! border, touch it from inside or go through a corner are then curves like all others.

use super::field::{Field, FieldJet};
use crate::box3::Box3;
use crate::breaks::inwards;
use crate::interval::Interval;
use crate::surface::{Surface, jet_len};
use glam::DVec3;

/// The margin as a part of the width.
pub(super) const MARGIN: f64 = 1.0 / (1u64 << 34) as f64;
/// The margins of the four sides relative to that (lower and upper u, lower and upper v): different, or diagonals of the
/// rectangle would go through the corners.
const UNEVEN: [[f64; 2]; 2] = [[1.0, 1.37], [1.71, 0.83]];

/// Rows and columns of the places where it is seen whether f is zero all over a box.
const PLACES: [f64; 3] = [0.193_7, 0.467_1, 0.821_3];

/// Enclosures of `f, f_u, f_v`.
pub(super) type Slopes = [Interval; 3];

/// A continued field.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extended<'a> {
    field: &'a dyn Field,
    /// Where f is given: no jump is inside.
    pub(super) rect: [Interval; 2],
    /// The same with the margins.
    pub(super) outer: [Interval; 2],
}

impl<'a> Extended<'a> {
    pub(super) fn new(field: &'a dyn Field, rect: [Interval; 2]) -> Self {
        let outer = [0, 1].map(|d| margins(rect[d], UNEVEN[d]));
        Self { field, rect, outer }
    }

    /// The nearest place of the rectangle.
    pub(super) fn clamp(&self, uv: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|d| uv[d].clamp(self.rect[d].lo, self.rect[d].hi))
    }

    /// The field's own enclosures over a box inside the rectangle.
    pub(super) fn jet(&self, uv: [Interval; 2]) -> Option<FieldJet> {
        self.field.enclose(uv, self.rect)
    }

    /// Enclosures over a box inside `outer`; `None` where f has no value.
    pub(super) fn slopes(&self, uv: [Interval; 2]) -> Option<Slopes> {
        let parts = [0, 1].map(|d| beyond(self.rect[d], uv[d]));
        let mut hull: Option<Slopes> = None;
        for &(u, x) in parts[0].iter().flatten() {
            for &(v, y) in parts[1].iter().flatten() {
                let Some(mut j) = self.centred([u, v]) else {
                    continue;
                };
                let beyond = x != Interval::ZERO || y != Interval::ZERO;
                if beyond
                    && j[0].contains(0.0)
                    && let Some(f) = self.field.edge([u, v], self.rect)
                    && f.is_finite()
                {
                    j[0] = j[0].meet(f);
                }
                let s = [
                    j[0] + j[1] * x + j[2] * y + j[4] * x * y,
                    j[1] + j[4] * y,
                    j[2] + j[4] * x,
                ];
                hull = Some(match hull {
                    None => s,
                    Some(h) => [0, 1, 2].map(|k| h[k].hull(s[k])),
                });
            }
        }
        hull
    }

    /// The sign of f at a place, if it is proven not to be zero.
    pub(super) fn sign(&self, uv: [f64; 2]) -> Option<bool> {
        let f = self.slopes(uv.map(Interval::point))?[0];
        (!f.contains(0.0)).then_some(f.lo > 0.0)
    }

    /// True if f is zero, within rounding, at all of some places of a box inside the rectangle. Zeros of a function that has
    /// others are curves and points, which do not go through nine places.
    pub(super) fn is_zero(&self, uv: [Interval; 2]) -> bool {
        if uv[0].is_point() || uv[1].is_point() {
            return false;
        }
        let at = |d: usize, k: usize| uv[d].lo + PLACES[k] * (uv[d].hi - uv[d].lo);
        (0..9).all(|k| {
            let p = [at(0, k / 3), at(1, k % 3)].map(Interval::point);
            self.jet(p)
                .is_some_and(|j| j[0].is_finite() && j[0].contains(0.0))
        })
    }

    /// Taylor's formula about the middle makes the enclosures of f and its first derivatives narrower.
    fn centred(&self, uv: [Interval; 2]) -> Option<FieldJet> {
        let mut j = self.jet(uv)?;
        if uv[0].is_point() && uv[1].is_point() {
            return Some(j);
        }
        let m = uv.map(|t| Interval::point(t.mid()));
        let Some(at) = self.jet(m) else {
            return Some(j);
        };
        let [x, y] = [uv[0] - m[0], uv[1] - m[1]];
        let tight = |a: Interval, b: Interval| if b.is_finite() { a.meet(b) } else { a };
        j[1] = tight(j[1], at[1] + j[3] * x + j[4] * y);
        j[2] = tight(j[2], at[2] + j[4] * x + j[5] * y);
        let half = Interval::point(0.5);
        let second = j[3] * x.sqr() * half + j[4] * x * y + j[5] * y.sqr() * half;
        j[0] = tight(j[0], at[0] + at[1] * x + at[2] * y + second);
        j[0] = tight(j[0], at[0] + j[1] * x + j[2] * y);
        Some(j)
    }
}

/// A range with its margins, of which there may be more on one side than on the other.
pub(super) fn margins(r: Interval, uneven: [f64; 2]) -> Interval {
    // Where doubles are coarse, some of them.
    let step = (MARGIN * r.width()).max(8.0 * f64::EPSILON * r.mag());
    Interval {
        lo: r.lo - uneven[0] * step,
        hi: r.hi + uneven[1] * step,
    }
}

/// The numbers of a range nearest to those of another one, with the way from there: inside, below, above.
pub(super) fn beyond(r: Interval, t: Interval) -> [Option<(Interval, Interval)>; 3] {
    let inside = t.intersection(r).map(|t| (t, Interval::ZERO));
    let below = (t.lo < r.lo).then(|| {
        let part = Interval {
            lo: t.lo,
            hi: t.hi.min(r.lo),
        };
        (Interval::point(r.lo), part - Interval::point(r.lo))
    });
    let above = (t.hi > r.hi).then(|| {
        let part = Interval {
            lo: t.lo.max(r.hi),
            hi: t.hi,
        };
        (Interval::point(r.hi), part - Interval::point(r.hi))
    });
    [inside, below, above]
}

/// The point of a surface and its tangents over a box that may reach beyond a rectangle of its parameters; there it goes on as
/// a field does. Sides of the rectangle on creases of the surface belong to its inside.
pub(super) fn surface_over(
    surface: &dyn Surface,
    rect: [Interval; 2],
    uv: [Interval; 2],
) -> [Box3; 3] {
    let domain = surface.domain();
    let parts = [0, 1].map(|d| beyond(rect[d], uv[d]));
    let mut hull: Option<[Box3; 3]> = None;
    for &(u, x) in parts[0].iter().flatten() {
        for &(v, y) in parts[1].iter().flatten() {
            let inside = x == Interval::ZERO && y == Interval::ZERO;
            let at = [inward(rect[0], domain[0], u), inward(rect[1], domain[1], v)];
            let j = surface.enclose(at, if inside { 1 } else { 2 });
            let mut s = [j[0], j[1], j[2]];
            if !inside {
                let twist = j[4];
                s = [
                    j[0] + j[1].scale(x) + j[2].scale(y) + twist.scale(x * y),
                    j[1] + twist.scale(y),
                    j[2] + twist.scale(x),
                ];
            }
            hull = Some(match hull {
                None => s,
                Some(h) => [0, 1, 2].map(|k| h[k].hull(s[k])),
            });
        }
    }
    hull.unwrap_or([Box3::ENTIRE; 3])
}

/// The same at a place, in numbers.
pub(super) fn surface_at(surface: &dyn Surface, rect: [Interval; 2], uv: [f64; 2]) -> [DVec3; 3] {
    let at = [0, 1].map(|d| uv[d].clamp(rect[d].lo, rect[d].hi));
    let [x, y] = [0, 1].map(|d| uv[d] - at[d]);
    let inside = x == 0.0 && y == 0.0;
    let mut j = [DVec3::ZERO; jet_len(2)];
    let order = if inside { 1 } else { 2 };
    surface.jet_into(at, inwards(at, rect), order, &mut j[..jet_len(order)]);
    [
        j[0] + j[1] * x + j[2] * y + j[4] * (x * y),
        j[1] + j[4] * y,
        j[2] + j[4] * x,
    ]
}

/// A single parameter on a side of the rectangle that is inside the domain, stretched a little into the rectangle: then its
/// limits come from there.
fn inward(rect: Interval, domain: Interval, t: Interval) -> Interval {
    let step = 4.0 * f64::EPSILON * rect.mag().max(rect.width());
    let mut out = t;
    if t.is_point() && t.lo == rect.lo && rect.lo > domain.lo {
        out.hi = t.hi + step;
    }
    if t.is_point() && t.hi == rect.hi && rect.hi < domain.hi {
        out.lo = t.lo - step;
    }
    out
}
