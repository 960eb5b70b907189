//! A path in a parameter plane, and the curve it draws on a surface.

use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit};
use crate::curve::Curve;
use crate::interval::Interval;
use crate::scalar::Number;
use crate::series::Series;
use crate::surface::{Dir, SurfaceRef, jet_index, jet_len};
use glam::DVec3;
use smallvec::SmallVec;

/// A cubic by its four Bézier points.
pub(super) type Cubic = [[f64; 2]; 4];

/// Piecewise cubic in the plane of two parameters.
///
/// As a [`Curve`] it runs over `[0, 1]`, about evenly in the plane (both parameters scaled to the same range): through
/// `(u, v, 0)`, or over a surface. It has a break where cubics meet, with continuous first derivatives except at
/// corners, and where it crosses breaks of the surface.
#[derive(Clone, Debug)]
pub struct Path {
    cubics: Vec<Piece>,
    breaks: Vec<Break>,
    surface: Option<SurfaceRef>,
}

/// One cubic with the analytic piece of the surface that it lies on.
#[derive(Clone, Copy, Debug)]
struct Piece {
    points: Cubic,
    /// Evaluation is held in here.
    within: [Interval; 2],
}

/// What a path is made of: a cubic, its length, and whether the path is smooth where it begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    pub(super) points: Cubic,
    pub(super) length: f64,
    pub(super) smooth: bool,
}

impl Path {
    /// A path in the plane `(u, v, 0)`. At least one part.
    pub(super) fn plane(parts: &[Part], domain: [Interval; 2]) -> Self {
        Self::new(parts, domain, None)
    }

    /// The same path on a surface.
    pub(super) fn on(parts: &[Part], surface: SurfaceRef) -> Self {
        Self::new(parts, surface.domain(), Some(surface))
    }

    fn new(parts: &[Part], domain: [Interval; 2], surface: Option<SurfaceRef>) -> Self {
        let total: f64 = parts.iter().map(|p| p.length).sum();
        let mut cubics = Vec::with_capacity(parts.len());
        let mut breaks: Vec<Break> = vec![Break::new(0.0, 0)];
        let mut before = 0.0;
        for (k, part) in parts.iter().enumerate() {
            if k > 0
                && let Some(last) = breaks.last_mut()
            {
                // In the plane a path that goes on across a seam jumps.
                let jumps = surface.is_none() && parts[k - 1].points[3] != part.points[0];
                last.smooth = if jumps { -1 } else { i32::from(part.smooth) };
            }
            let cuts = surface
                .as_ref()
                .map_or_else(Vec::new, |s| cuts(&part.points, s));
            let mut from = 0.0;
            for (to, smooth) in cuts.into_iter().chain([(1.0, 0)]) {
                let at = (before + to * part.length) / total;
                // Less than rounding: no piece of its own.
                if at <= breaks[breaks.len() - 1].at {
                    continue;
                }
                let points = section(&part.points, from, to);
                let within = match &surface {
                    None => domain,
                    Some(s) => [Dir::U, Dir::V].map(|dir| {
                        let b = s.breaks(dir);
                        let middle = value(&points, 0.5)[dir as usize];
                        b.piece(b.find(middle, Limit::Above))
                    }),
                };
                cubics.push(Piece { points, within });
                breaks.push(Break::new(at, smooth));
                from = to;
            }
            before += part.length;
        }
        if let Some(last) = breaks.last_mut() {
            *last = Break::new(1.0, 0);
        }
        Self {
            cubics,
            breaks,
            surface,
        }
    }

    /// The surface it is drawn on.
    pub fn surface(&self) -> Option<&SurfaceRef> {
        self.surface.as_ref()
    }

    /// The parameters of the plane at t.
    pub fn parameters(&self, t: f64, limit: Limit) -> [f64; 2] {
        let k = self.breaks.find(t, limit);
        let piece = &self.cubics[k];
        held(value(&piece.points, self.local(k, t)), piece.within)
    }

    /// The parameter within a cubic.
    fn local(&self, k: usize, t: f64) -> f64 {
        let p = self.breaks.piece(k);
        (t - p.lo) / (p.hi - p.lo)
    }

    /// The Taylor series of both parameters about a place of a cubic, in t.
    fn series<S: Number>(&self, k: usize, s: S, order: usize) -> [Series<S>; 2] {
        let p = self.breaks.piece(k);
        let rate = S::ONE / (S::from(p.hi) - S::from(p.lo));
        let b = &self.cubics[k].points;
        [0, 1].map(|d| {
            let [b0, b1, b2, b3] = [0, 1, 2, 3].map(|i| S::from(b[i][d]));
            let three = S::from(3.0);
            let (d1, d2, d3) = (b1 - b0, b2 - b1, b3 - b2);
            let (e1, e2) = (d2 - d1, d3 - d2);
            let r = S::ONE - s;
            let c = [
                b0 + s * three * d1 + s * s * three * e1 + s * s * s * (e2 - e1),
                three * (r * r * d1 + S::from(2.0) * r * s * d2 + s * s * d3) * rate,
                three * (r * e1 + s * e2) * rate * rate,
                (e2 - e1) * rate * rate * rate,
            ];
            let mut out = Series::constant(S::ZERO, order);
            for (o, c) in out.c.iter_mut().zip(c) {
                *o = c;
            }
            out
        })
    }
}

/// The derivatives of `r(u(t), v(t))` from those of r (coordinate by coordinate) and the series of u and v.
fn composed<S: Number>(jet: &[S], uv: &[Series<S>; 2], out: &mut [S]) {
    let order = out.len() - 1;
    let [x, y] = [0, 1].map(|d| {
        let mut s = uv[d].clone();
        s.c[0] = S::ZERO;
        s
    });
    let powers = |x: &Series<S>| {
        let mut p = vec![Series::constant(S::ONE, order)];
        for k in 0..order {
            p.push(p[k].mul(x));
        }
        p
    };
    let (px, py) = (powers(&x), powers(&y));
    let factorial = |n: usize| S::from((1..=n).map(|k| k as f64).product::<f64>());
    let mut sum = Series::constant(S::ZERO, order);
    for n in 0..=order {
        for j in 0..=n {
            let i = n - j;
            let c = jet[jet_index(i, j)] / (factorial(i) * factorial(j));
            sum = sum.add(&px[i].mul(&py[j]).scale(c));
        }
    }
    sum.write_derivatives(out);
}

impl Curve for Path {
    fn breaks(&self) -> &[Break] {
        &self.breaks
    }

    fn jet_into(&self, t: f64, limit: Limit, out: &mut [DVec3]) {
        let order = out.len() - 1;
        let k = self.breaks.find(t, limit);
        let uv = self.series(k, self.local(k, t), order);
        let Some(surface) = &self.surface else {
            let mut d = [0, 1].map(|i| {
                let mut d: SmallVec<[f64; 6]> = SmallVec::from_elem(0.0, order + 1);
                uv[i].write_derivatives(&mut d);
                d
            });
            let at = held([d[0][0], d[1][0]], self.cubics[k].within);
            (d[0][0], d[1][0]) = (at[0], at[1]);
            for (n, o) in out.iter_mut().enumerate() {
                *o = DVec3::new(d[0][n], d[1][n], 0.0);
            }
            return;
        };
        let within = self.cubics[k].within;
        let at = held([uv[0].c[0], uv[1].c[0]], within);
        let jet = surface.jet(at, crate::breaks::inwards(at, within), order);
        let mut one: SmallVec<[f64; 6]> = SmallVec::from_elem(0.0, order + 1);
        for axis in 0..3 {
            let c: SmallVec<[f64; 15]> = jet.d.iter().map(|p| p[axis]).collect();
            composed(&c, &uv, &mut one);
            for (o, &x) in out.iter_mut().zip(&one) {
                o[axis] = x;
            }
        }
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, out: &mut [Box3]) {
        let order = out.len() - 1;
        let k = self.breaks.find(t.mid(), limit);
        let p = self.breaks.piece(k);
        let wide = (t - Interval::point(p.lo)) / (Interval::point(p.hi) - Interval::point(p.lo));
        let uv = self.series(k, wide, order);
        let within = self.cubics[k].within;
        let at = [0, 1].map(|d| Interval {
            lo: uv[d].c[0].lo.clamp(within[d].lo, within[d].hi),
            hi: uv[d].c[0].hi.clamp(within[d].lo, within[d].hi),
        });
        let mut coordinates = [0; 3].map(|_| vec![Interval::ZERO; order + 1]);
        if let Some(surface) = &self.surface {
            let mut jet = vec![Box3::ENTIRE; jet_len(order)];
            let limits = crate::breaks::inwards([at[0].lo, at[1].lo], within);
            surface.enclose_piece(at, limits, order, &mut jet);
            for (axis, out) in coordinates.iter_mut().enumerate() {
                let c: Vec<Interval> = jet.iter().map(|b| b.to_array()[axis]).collect();
                composed(&c, &uv, out);
            }
        } else {
            for d in 0..2 {
                uv[d].write_derivatives(&mut coordinates[d]);
                coordinates[d][0] = at[d];
            }
        }
        for (n, o) in out.iter_mut().enumerate() {
            *o = Box3::from([coordinates[0][n], coordinates[1][n], coordinates[2][n]]);
        }
    }
}

/// The nearest place of a rectangle.
fn held(uv: [f64; 2], within: [Interval; 2]) -> [f64; 2] {
    [0, 1].map(|d| uv[d].clamp(within[d].lo, within[d].hi))
}

/// The point of a cubic.
pub(super) fn value(b: &Cubic, s: f64) -> [f64; 2] {
    section(b, s, 1.0)[0]
}

/// The part of a cubic between two parameters, by de Casteljau's scheme.
pub(super) fn section(b: &Cubic, from: f64, to: f64) -> Cubic {
    let mix = |a: [f64; 2], b: [f64; 2], s: f64| [0, 1].map(|d| a[d] + s * (b[d] - a[d]));
    // The part up to s, and the part from there.
    let halves = |b: &Cubic, s: f64| {
        let (p, q, r) = (mix(b[0], b[1], s), mix(b[1], b[2], s), mix(b[2], b[3], s));
        let (x, y) = (mix(p, q, s), mix(q, r, s));
        let m = mix(x, y, s);
        [[b[0], p, x, m], [m, y, r, b[3]]]
    };
    let mut part = *b;
    if to < 1.0 {
        part = halves(&part, to)[0];
    }
    if from > 0.0 {
        part = halves(&part, from / to)[1];
    }
    part
}

/// Where a cubic crosses the breaks of a surface, increasing, and how smooth it is there.
fn cuts(b: &Cubic, surface: &SurfaceRef) -> Vec<(f64, i32)> {
    let mut found: Vec<(f64, i32)> = Vec::new();
    for dir in [Dir::U, Dir::V] {
        let d = dir as usize;
        let (lo, hi) = b
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| {
                (l.min(p[d]), h.max(p[d]))
            });
        let breaks = surface.breaks(dir);
        for at in &breaks[1..breaks.len() - 1] {
            if lo < at.at && at.at < hi {
                let roots = crossings(b, d, at.at);
                found.extend(roots.into_iter().map(|s| (s, at.smooth.min(1))));
            }
        }
    }
    found.retain(|f| f.0 > 0.0 && f.0 < 1.0);
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found
}

/// The ends of a cubic and the parameters between them where a coordinate has an extreme, increasing.
fn extremes(b: &Cubic, d: usize) -> Vec<f64> {
    // The derivative is a (1-s)² + 2 m s (1-s) + c s², up to a factor.
    let [a, m, c] = [0, 1, 2].map(|i| b[i + 1][d] - b[i][d]);
    let root = (m * m - a * c).max(0.0).sqrt();
    // Without cancellation, also where a or the leading coefficient is 0 (what is not finite is no root in between).
    let q = (a - m) + root.copysign(a - m);
    let mut ends: Vec<f64> = [q / (a - 2.0 * m + c), a / q]
        .into_iter()
        .filter(|&s| s > 0.0 && s < 1.0)
        .collect();
    ends.extend([0.0, 1.0]);
    ends.sort_by(f64::total_cmp);
    ends
}

/// The least value of a coordinate on a cubic.
pub(super) fn least(b: &Cubic, d: usize) -> f64 {
    let all = extremes(b, d).into_iter().map(|s| value(b, s)[d]);
    all.fold(f64::INFINITY, f64::min)
}

/// The parameters where a coordinate of a cubic has a value: between its extremes there is one at most.
fn crossings(b: &Cubic, d: usize, at: f64) -> Vec<f64> {
    let ends = extremes(b, d);
    let side = |s: f64| value(b, s)[d] - at;
    ends.windows(2)
        .filter_map(|w| {
            let [mut lo, mut hi] = [w[0], w[1]];
            let below = side(lo) < 0.0;
            if below == (side(hi) < 0.0) {
                return None;
            }
            for _ in 0..60 {
                let s = 0.5 * (lo + hi);
                if (side(s) < 0.0) == below {
                    lo = s;
                } else {
                    hi = s;
                }
            }
            Some(hi)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_crossings_of_a_cubic_are_found() {
        // One coordinate of the four points, and how often it has the value 0.1.
        for (x, n) in [
            // The first two points are one: the derivative begins with 0.
            ([0.0, 0.0, 1.0, -1.0], 2),
            ([0.0, 1e-20, 1.0, -1.0], 2),
            ([-1.0, 1.0, 0.0, 0.0], 2),
            ([0.0, 1.0, -1.0, 0.2], 3),
            ([0.0, 1.0, 2.0, 3.0], 1),
            ([0.0, 0.0, 0.0, 1.0], 1),
            ([0.0, 0.0, 0.0, 0.0], 0),
        ] {
            let b = x.map(|x| [x, 0.3]);
            let found = crossings(&b, 0, 0.1);
            assert_eq!(found.len(), n, "{x:?}: {found:?}");
            for s in found {
                assert!((value(&b, s)[0] - 0.1).abs() < 1e-12, "{x:?}: {s}");
            }
        }
    }
}
