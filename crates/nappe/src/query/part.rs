//! A part of a surface, as the distance of its points sees it.
//!
//! Half the squared distance `f = ½ |r - p|²` has the second derivatives `r_i · r_j + (r - p) · r_ij`. In parameters `s` that
//! are lengths along two orthonormal tangents in the middle, the first term is the unit matrix but for δ. With the middle c
//! of the part and second derivatives `c_ij` there that are off by no more than ρ, and no greater than N, the second term is
//! `(c - p) · c_ij` but for `|c - p| ρ + R N`, where R bounds `|r - c|`. So `μ`, the least eigenvalue of
//! `1 + (c - p) · c_ij` less all that is unknown, bounds the curvature of `f` from below, and Taylor's formula bounds `f`:
//! `f ≥ f₀ + g s + ½ μ |s|²`. Where `μ > 0` it is convex over the part, and any place tells how much less `f` can be
//! elsewhere: `f ≥ f(x) + ∇f(x) (y - x) + ½ μ |s(y) - s(x)|²`.
//!
//! A curve is treated as if its second parameter led straight into a dimension of its own, so that `s_2` adds `½ s_2²`; it
//! is always 0.

use super::descent::{Local, descend};
use super::shape::Shape;
use crate::box3::Box3;
use crate::interval::Interval;
use crate::surface::jet_len;
use glam::DVec3;

/// A part of a surface in one analytic piece.
#[derive(Debug)]
pub(super) struct Part {
    pub(super) surface: u32,
    pub(super) uv: [Interval; 2],
    pub(super) hull: Hull,
    /// The point in the middle, and the first derivatives times half the widths.
    centre: DVec3,
    pub(super) first: [DVec3; 2],
    /// The unit normal in the middle.
    normal: DVec3,
    /// How far its points are from the middle, and how far its parameters `s` are.
    radius: f64,
    far: f64,
    /// δ of the module, `c_11`, `c_12` and `c_22`, ρ and N. Without a frame in the middle δ is infinite.
    stretch: f64,
    second: [DVec3; 3],
    off: f64,
    bend: f64,
    /// The largest coordinate.
    largest: f64,
}

/// The corners of a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hull {
    pub(super) lo: DVec3,
    pub(super) hi: DVec3,
}

impl Hull {
    pub(super) fn of(b: Box3) -> Self {
        let [x, y, z] = b.to_array();
        Self {
            lo: DVec3::new(x.lo, y.lo, z.lo),
            hi: DVec3::new(x.hi, y.hi, z.hi),
        }
    }

    pub(super) fn join(self, o: Self) -> Self {
        Self {
            lo: self.lo.min(o.lo),
            hi: self.hi.max(o.hi),
        }
    }

    /// The box within two boxes that both enclose the same.
    pub(super) fn meet(self, o: Self) -> Self {
        Self {
            lo: self.lo.max(o.lo),
            hi: self.hi.min(o.hi),
        }
    }

    pub(super) fn to_box(self) -> Box3 {
        let of = |lo, hi| Interval { lo, hi };
        Box3 {
            x: of(self.lo.x, self.hi.x),
            y: of(self.lo.y, self.hi.y),
            z: of(self.lo.z, self.hi.z),
        }
    }

    /// The squared distance of a point from the box.
    #[inline]
    pub(super) fn distance2(&self, p: DVec3) -> f64 {
        let off = (self.lo - p).max(p - self.hi).max(DVec3::ZERO);
        off.length_squared()
    }
}

/// The length whose half square that is; 0 for less.
pub(super) fn length(half_square: f64) -> f64 {
    (2.0 * half_square.max(0.0)).sqrt()
}

/// A place on a surface, with half its squared distance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) surface: u32,
    pub(super) uv: [f64; 2],
    pub(super) point: DVec3,
    pub(super) half_square: f64,
}

/// How much of the curvature of the distance may be unknown in a part that is not halved beforehand.
const KNOWN: f64 = 0.25;
/// The rounding errors of points as a share of the largest coordinate: the accuracy to which every surface is held.
pub(super) const EXACTNESS: f64 = 1e-13;
/// Rounding errors as a share of the terms.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

impl Part {
    pub(super) fn new(shapes: &[Shape], surface: u32, uv: [Interval; 2]) -> Self {
        let of = &shapes[surface as usize];
        let is_curve = uv[1].is_point();
        let jet = of.enclose(uv, 2);
        let middle = uv.map(Interval::mid);
        let mut at = [DVec3::ZERO; jet_len(1)];
        of.jet_into(middle, uv, 1, &mut at);
        let [centre, a, b] = at;
        let half = uv.map(half_width);
        // Orthonormal tangents: `e = a / along` and `(b - (b·e) e) / across`.
        let along = a.length();
        let e = a / along;
        let shear = if is_curve { 0.0 } else { b.dot(e) };
        let aside = b - e * shear;
        let across = if is_curve { 1.0 } else { aside.length() };
        let normal = e.cross(aside / across);
        // Derivatives by s: `r_1 = r_u / along`, `r_2 = r_v / across - k r_u` with `k = shear / (along across)`.
        let n = Interval::point;
        let (p, q) = (n(1.0) / n(along), n(1.0) / n(across));
        let k = n(shear) * p * q;
        let r1 = jet[1].scale(p);
        let r2 = jet[2].scale(q) + jet[1].scale(-k);
        let unit = |x: Interval| (x - n(1.0)).mag();
        let stretch = if is_curve {
            unit(r1.norm().sqr())
        } else {
            unit(r1.norm().sqr()).max(unit(r2.norm().sqr())) + r1.dot(r2).mag()
        };
        let r11 = jet[3].scale(p * p);
        let r12 = jet[4].scale(p * q) + jet[3].scale(-(k * p));
        let r22 = jet[5].scale(q * q) + jet[4].scale(-(n(2.0) * k * q)) + jet[3].scale(k * k);
        let all = [r11, r12, r22];
        let second = all.map(Box3::mid);
        let far_off = [0, 1, 2].map(|k| (all[k] + Box3::point(-second[k])).norm().hi);
        let sizes = all.map(|r| r.norm().hi);
        // Of a symmetric matrix by the squares of its entries.
        let norm =
            |[x, y, z]: [f64; 3]| (x * x + 2.0 * y * y + z * z).sqrt() * (1.0 + 4.0 * f64::EPSILON);
        let (off, bend) = (norm(far_off), norm(sizes));
        // `s = (along du + shear dv, across dv)`.
        let far = (along * half[0] + shear.abs() * half[1]).hypot(across * half[1]);
        let framed = stretch.is_finite() && bend.is_finite() && normal.is_finite();
        let around = jet[0] + Box3::point(-centre);
        Self {
            surface,
            uv,
            hull: Hull::of(jet[0]),
            centre,
            first: [a * half[0], b * half[1]],
            normal: if framed { normal } else { DVec3::ZERO },
            radius: around.norm().hi,
            far: far * (1.0 + 4.0 * f64::EPSILON),
            stretch: if framed { stretch } else { f64::INFINITY },
            second: if framed { second } else { [DVec3::ZERO; 3] },
            off: if framed { off } else { 0.0 },
            bend: if framed { bend } else { 0.0 },
            largest: if jet[0].is_finite() {
                jet[0]
                    .to_array()
                    .iter()
                    .fold(0.0, |a, i| f64::max(a, i.mag()))
            } else {
                centre.abs().max_element()
            },
        }
    }

    /// True if the curvature of the distance is known well from everywhere that is no farther away than `size`.
    pub(super) fn is_known(&self, size: f64) -> bool {
        let near = self.stretch + self.radius * self.bend <= KNOWN;
        near && (self.off <= KNOWN * self.bend || self.off * size <= KNOWN)
    }

    /// True if the second half of the parameters along a direction can be told from the first.
    fn can_halve(&self, d: usize) -> bool {
        let (t, middle) = (self.uv[d], self.uv[d].mid());
        t.lo < middle && middle < t.hi
    }

    /// The halves across the longer side; `None` if the part is as small as rounding.
    pub(super) fn halves(&self, shapes: &[Shape]) -> Option<[Self; 2]> {
        let longer = usize::from(self.first[1].length() > self.first[0].length());
        let d = [longer, 1 - longer]
            .into_iter()
            .find(|&d| self.can_halve(d))?;
        let middle = self.uv[d].mid();
        let half = |t: Interval| {
            let mut uv = self.uv;
            uv[d] = t;
            Self::new(shapes, self.surface, uv)
        };
        let Interval { lo, hi } = self.uv[d];
        Some([
            half(Interval { lo, hi: middle }),
            half(Interval { lo: middle, hi }),
        ])
    }

    /// μ of the module for the way from a point to the middle.
    #[inline]
    fn curvature(&self, e: DVec3, distance: f64) -> f64 {
        let [x, y, z] = self.second.map(|c| e.dot(c));
        let least = 1.0 + 0.5 * (x + z) - (0.25 * (x - z) * (x - z) + y * y).sqrt();
        let rounding = ROUNDING * (1.0 + distance * self.bend);
        least - self.stretch - distance * self.off - self.radius * self.bend - rounding
    }

    /// True if the distance of a point is convex over the part.
    pub(super) fn is_convex(&self, p: DVec3) -> bool {
        let e = self.centre - p;
        self.curvature(e, e.length()) > 0.0
    }

    /// A lower bound of the distance of a point.
    #[inline]
    pub(super) fn lower(&self, p: DVec3) -> f64 {
        let least = self.hull.distance2(p).sqrt();
        let e = self.centre - p;
        let square = e.length_squared();
        let slope = e.dot(self.first[0]).abs() + e.dot(self.first[1]).abs();
        let curvature = self.curvature(e, e.length());
        let lost = if curvature > 0.0 {
            let across = e.dot(self.normal);
            let tangential = (square * (1.0 + ROUNDING) - across * across).max(0.0);
            slope.min(tangential / (2.0 * curvature))
        } else {
            slope - 0.5 * curvature * self.far * self.far
        };
        let taylor = self.distance(0.5 * square * (1.0 - ROUNDING) - lost, p);
        // NaN tells nothing.
        if taylor > least { taylor } else { least }
    }

    /// The distance of half a square, less rounding errors of points.
    pub(super) fn distance(&self, half_square: f64, p: DVec3) -> f64 {
        length(half_square) - self.rounding(p)
    }

    /// The rounding errors of points of the surface, and of the way to a point.
    pub(super) fn rounding(&self, p: DVec3) -> f64 {
        EXACTNESS * self.largest.max(p.abs().max_element())
    }

    /// The middle.
    pub(super) fn middle(&self, p: DVec3) -> Place {
        Place {
            surface: self.surface,
            uv: self.uv.map(Interval::mid),
            point: self.centre,
            half_square: 0.5 * (self.centre - p).length_squared(),
        }
    }

    /// The nearest place over a part where the distance is convex, by Newton's method within the box, and a lower bound of
    /// the distance over the part. Ends when `enough` is true for half the squared distance and the bound.
    pub(super) fn nearest(
        &self,
        shape: &Shape,
        p: DVec3,
        enough: impl Fn(f64, f64) -> bool,
    ) -> (Place, f64) {
        let (middle, mut lower) = (self.middle(p), f64::NEG_INFINITY);
        let from = Local::new(shape, p, middle.uv, self.uv);
        let at = descend(shape, p, from, [self.uv; 2], self.far, |at| {
            lower = f64::max(lower, self.distance(at.least(self.uv), p));
            enough(at.half_square.min(middle.half_square), lower)
        });
        let found = self.place(&at);
        let nearer = found.half_square < middle.half_square;
        (if nearer { found } else { middle }, lower)
    }

    /// A place of its surface.
    pub(super) fn place(&self, at: &Local) -> Place {
        Place {
            surface: self.surface,
            uv: at.uv,
            point: at.point,
            half_square: at.half_square,
        }
    }

    /// Of a part where the distance is convex: the parameters of all places that are within `reach`, as seen from one of
    /// its places; none if there are none.
    pub(super) fn within(
        &self,
        shape: &Shape,
        p: DVec3,
        at: [f64; 2],
        reach: f64,
    ) -> Option<[Interval; 2]> {
        let least = Local::new(shape, p, at, self.uv).least(self.uv);
        let lower = self.distance(least, p).max(0.0);
        if lower > reach {
            return None;
        }
        let e = self.centre - p;
        // `½ lower² + ½ μ |s|² ≤ ½ reach²`, with the least value itself instead of `½ lower²` where it is negative, and
        // `s = (along du + shear dv, across dv)`.
        let below = if least < 0.0 {
            let rounding = self.rounding(p);
            -2.0 * least + rounding * (2.0 * reach + rounding)
        } else {
            0.0
        };
        let square = ((reach - lower) * (reach + lower) + below) / self.curvature(e, e.length());
        let radius = square.sqrt() * (1.0 + 1e-12);
        let half = self.uv.map(half_width);
        let [a, b] = [0, 1].map(|d| self.first[d] / half[d]);
        let along = a.length();
        let shear = b.dot(a) / along;
        let across = (b - a * (shear / along)).length();
        // Of tangents at a small angle most cancels.
        let dv = radius / across * (1.0 + 1e-12 * b.length() / across);
        let du = (radius + shear.abs() * dv) / along;
        let steps = if self.uv[1].is_point() {
            [radius / along, 0.0]
        } else {
            [du, dv]
        };
        Some([0, 1].map(|d| {
            let (t, step) = (self.uv[d], steps[d] * (1.0 + 1e-12));
            // What is not finite tells nothing.
            if !step.is_finite() {
                return t;
            }
            Interval {
                lo: (at[d] - step).next_down().max(t.lo),
                hi: (at[d] + step).next_up().min(t.hi),
            }
        }))
    }
}

/// How far the ends are from the middle, which is rounded too.
fn half_width(t: Interval) -> f64 {
    let m = t.mid();
    (m - t.lo).max(t.hi - m).next_up()
}
