//! The cross-derivative that continues a neighbouring surface over a shared side without a crease.

use super::sides::Side;
use super::{Dir, SurfaceRef, jet_index, jet_len};
use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit};
use crate::curve::Curve;
use crate::interval::Interval;
use crate::scalar::Scalar;
use glam::DVec3;
use smallvec::SmallVec;

/// `a(t) n(t) + b(t) s'(t)` along a side of a surface, where s is the side, n the derivative out of the surface across
/// it, and a and b are linear over the side: every such vector lies in the tangent plane, so a surface with this
/// cross-derivative joins it with G1 continuity if a > 0 (with equal derivatives if a = 1 and b = 0).
#[derive(Clone, Debug)]
pub(super) struct OutOfSide {
    surface: SurfaceRef,
    side: Side,
    breaks: Vec<Break>,
    /// The factors at both ends of the side; for one parameter unit across and along the whole surface.
    a: [f64; 2],
    b: [f64; 2],
}

impl OutOfSide {
    pub(super) fn new(surface: SurfaceRef, side: Side) -> Self {
        // The derivative along the side is one order less smooth than the side.
        let breaks = surface.breaks(side.along()).iter();
        let breaks = breaks.map(|b| Break::new(b.at, b.smooth - 1)).collect();
        Self {
            surface,
            side,
            breaks,
            a: [1.0; 2],
            b: [0.0; 2],
        }
    }

    /// Chooses a and b so that the ends come nearest to the two given vectors. Returns the two values of a.
    pub(super) fn fit(&mut self, ends: [DVec3; 2]) -> [f64; 2] {
        let domain = self.domain();
        for (k, (t, limit)) in [(domain.lo, Limit::Above), (domain.hi, Limit::Below)]
            .into_iter()
            .enumerate()
        {
            let (n, l) = self.frame(t, limit);
            let (nn, nl, ll) = (n.dot(n), n.dot(l), l.dot(l));
            let determinant = nn * ll - nl * nl;
            // Where the plane is lost to rounding nothing can be fitted; the corner report then tells.
            if determinant > 1e-20 * nn * ll {
                let (en, el) = (ends[k].dot(n), ends[k].dot(l));
                self.a[k] = (en * ll - el * nl) / determinant;
                self.b[k] = (el * nn - en * nl) / determinant;
            }
        }
        self.a
    }

    /// Points into the surface instead of out of it.
    pub(super) fn turn_round(&mut self) {
        self.a = self.a.map(|x| -x);
        self.b = self.b.map(|x| -x);
    }

    /// The derivative out of the surface and the one along the side, for whole parameter ranges.
    fn frame(&self, t: f64, limit: Limit) -> (DVec3, DVec3) {
        let (uv, limits) = self.place(t, limit);
        let jet = self.surface.jet(uv, limits, 1);
        let (across, along) = self.scales();
        match self.side.across() {
            Dir::V => (jet.partial(0, 1) * across, jet.partial(1, 0) * along),
            Dir::U => (jet.partial(1, 0) * across, jet.partial(0, 1) * along),
        }
    }

    /// Signed width across (positive outwards), width along.
    fn scales(&self) -> (f64, f64) {
        let width = |dir: Dir| {
            let d = self.surface.breaks(dir).domain();
            d.hi - d.lo
        };
        let sign = if self.side.is_upper() { 1.0 } else { -1.0 };
        (sign * width(self.side.across()), width(self.side.along()))
    }

    fn place(&self, t: f64, limit: Limit) -> ([f64; 2], [Limit; 2]) {
        let across = self.surface.breaks(self.side.across()).domain();
        let (x, inside) = if self.side.is_upper() {
            (across.hi, Limit::Below)
        } else {
            (across.lo, Limit::Above)
        };
        match self.side.across() {
            Dir::V => ([t, x], [limit, inside]),
            Dir::U => ([x, t], [inside, limit]),
        }
    }

    /// The derivatives 0 to `orders - 1` of each coordinate, by Leibniz' rule from those of the surface: `jet(k, m, c)`
    /// is the c-th coordinate of the derivative of order k along and m across.
    fn combine<S: Scalar>(
        &self,
        t: S,
        orders: usize,
        jet: impl Fn(usize, usize, usize) -> S,
    ) -> [SmallVec<[S; 4]>; 3] {
        let domain = self.domain();
        let (across, along) = self.scales();
        let width = S::from(domain.hi) - S::from(domain.lo);
        let s = (t - S::from(domain.lo)) / width;
        let linear = |f: [f64; 2], scale: f64| {
            let [p, q] = f.map(S::from);
            let scale = S::from(scale);
            ((p + (q - p) * s) * scale, (q - p) * scale / width)
        };
        let (a, da) = linear(self.a, across);
        let (b, db) = linear(self.b, along);
        [0, 1, 2].map(|c| {
            let term = |k: usize| {
                let x = a * jet(k, 1, c) + b * jet(k + 1, 0, c);
                if k == 0 {
                    return x;
                }
                x + S::from(k as f64) * (da * jet(k - 1, 1, c) + db * jet(k, 0, c))
            };
            (0..orders).map(term).collect()
        })
    }

    /// Where `∂ᵏ` along and `∂ᵐ` across stand in a jet.
    fn index(&self, along: usize, across: usize) -> usize {
        match self.side.across() {
            Dir::V => jet_index(along, across),
            Dir::U => jet_index(across, along),
        }
    }
}

impl Curve for OutOfSide {
    fn breaks(&self) -> &[Break] {
        &self.breaks
    }

    fn jet_into(&self, t: f64, limit: Limit, out: &mut [DVec3]) {
        let (uv, limits) = self.place(t, limit);
        let jet = self.surface.jet(uv, limits, out.len());
        let [x, y, z] = self.combine(t, out.len(), |k, m, c| jet.d[self.index(k, m)][c]);
        for (k, o) in out.iter_mut().enumerate() {
            *o = DVec3::new(x[k], y[k], z[k]);
        }
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, out: &mut [Box3]) {
        let (at, limits) = self.place(t.mid(), limit);
        let mut uv = at.map(Interval::point);
        uv[if self.side.along() == Dir::U { 0 } else { 1 }] = t;
        let mut boxes = vec![Box3::ENTIRE; jet_len(out.len())];
        self.surface
            .enclose_piece(uv, limits, out.len(), &mut boxes);
        let [x, y, z] = self.combine(t, out.len(), |k, m, c| {
            boxes[self.index(k, m)].to_array()[c]
        });
        for (k, o) in out.iter_mut().enumerate() {
            *o = Box3::from([x[k], y[k], z[k]]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::BSplineBasis;
    use crate::exact::NurbsSurface;
    use crate::laws::{self, Random};
    use std::sync::Arc;

    /// A rational spline surface with breaks, over [0, 4] × [0, 3].
    fn surface() -> NurbsSurface {
        let mut random = Random(5);
        let points: Vec<_> = (0..30)
            .map(|k| DVec3::new((k / 5) as f64, (k % 5) as f64, random.unit()))
            .collect();
        let weights: Vec<_> = (0..30).map(|_| 0.5 + random.unit()).collect();
        let scaled = |p: usize, n: usize, f: f64| {
            let knots = BSplineBasis::clamped_uniform(p, n);
            knots.into_iter().map(|k| k * f).collect()
        };
        let knots = [scaled(3, 6, 4.0), scaled(2, 5, 3.0)];
        NurbsSurface::new([3, 2], knots, &points, Some(&weights)).unwrap()
    }

    #[test]
    fn laws_of_the_continuation() {
        let s: SurfaceRef = Arc::new(surface());
        for side in Side::ALL {
            let mut join = OutOfSide::new(s.clone(), side);
            laws::curve(&join);
            join.fit([DVec3::new(1.0, 2.0, 0.5), DVec3::new(-0.5, 1.0, 2.0)]);
            laws::curve(&join);
        }
    }

    #[test]
    fn vectors_of_the_tangent_plane_are_met() {
        let s: SurfaceRef = Arc::new(surface());
        for side in Side::ALL {
            let mut join = OutOfSide::new(s.clone(), side);
            let d = join.domain();
            let ends = [(d.lo, Limit::Above), (d.hi, Limit::Below)].map(|(t, limit)| {
                let (n, l) = join.frame(t, limit);
                n * 0.7 - l * 0.3
            });
            let a = join.fit(ends);
            for (k, t) in [d.lo, d.hi].into_iter().enumerate() {
                assert!((a[k] - 0.7).abs() <= 1e-14);
                assert!(join.point(t).distance(ends[k]) <= 1e-14 * ends[k].length());
            }
        }
    }
}
