//! The cross-derivative that continues a neighbouring surface over a shared side without a crease.

use super::coons::CoonsError;
use super::coons_data::at_end;
use super::neighbour_second::SecondOutOfSide;
use super::sides::{Corner, Side};
use super::{Dir, SurfaceRef};
use crate::basis::BSplineBasis;
use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit};
use crate::curve::{CrossDerivative, Curve, CurveRef, Isocurve, Trimmed, on_unit_domain};
use crate::exact::{NurbsCurve, Row, bernstein_elevate, bernstein_product, join};
use crate::interval::Interval;
use crate::scalar::Scalar;
use crate::velocity::{Factor, Sum, Term, as_curve, extended};
use glam::{DVec3, DVec4};
use smallvec::SmallVec;
use std::sync::Arc;

/// `a(t) n(t) + b(t) s'(t)` along a side of a surface, where s is the side, n the derivative out of the surface across
/// it, and a and b are linear over the side: every such vector lies in the tangent plane, so a surface with this
/// cross-derivative joins it with G1 continuity if a > 0 (with equal derivatives if a = 1 and b = 0).
#[derive(Clone, Debug)]
pub(super) struct OutOfSide {
    line: Isocurve,
    across: CrossDerivative,
    breaks: Vec<Break>,
    /// The factors at both ends of the side, for the derivatives with respect to the parameters.
    a: [f64; 2],
    b: [f64; 2],
    /// The derivatives out of the surface and along the side with respect to parameters that run over a unit range.
    scales: [f64; 2],
}

impl OutOfSide {
    pub(super) fn new(surface: SurfaceRef, side: Side) -> Self {
        let width = |dir: Dir| {
            let d = surface.breaks(dir).domain();
            d.hi - d.lo
        };
        let out = if side.is_upper() { 1.0 } else { -1.0 };
        let scales = [out * width(side.across()), width(side.along())];
        // The derivative along the side is one order less smooth than the side.
        let breaks = surface.breaks(side.along()).iter();
        Self {
            breaks: breaks.map(|b| Break::new(b.at, b.smooth - 1)).collect(),
            line: Isocurve::side(surface.clone(), side),
            across: CrossDerivative::side(surface.clone(), side),
            a: [scales[0]; 2],
            b: [0.0; 2],
            scales,
        }
    }

    /// Chooses a and b so that the ends come nearest to the two given vectors. Returns the values of a at both ends for
    /// unit parameter ranges.
    pub(super) fn fit(&mut self, ends: [DVec3; 2]) -> [f64; 2] {
        let domain = self.domain();
        let at = [(domain.lo, Limit::Above), (domain.hi, Limit::Below)];
        for (k, (t, limit)) in at.into_iter().enumerate() {
            let (n, l) = self.frame(t, limit);
            let (nn, nl, ll) = (n.dot(n), n.dot(l), l.dot(l));
            let determinant = nn * ll - nl * nl;
            // Where the plane is lost to rounding nothing can be fitted; the corner report then tells.
            if determinant > 1e-20 * nn * ll {
                let (en, el) = (ends[k].dot(n), ends[k].dot(l));
                self.a[k] = (en * ll - el * nl) / determinant * self.scales[0];
                self.b[k] = (el * nn - en * nl) / determinant * self.scales[1];
            }
        }
        self.a.map(|a| a / self.scales[0])
    }

    /// Points into the surface instead of out of it.
    pub(super) fn turn_round(&mut self) {
        self.a = self.a.map(|x| -x);
        self.b = self.b.map(|x| -x);
    }

    /// The derivative out of the surface and the one along the side, for unit parameter ranges.
    fn frame(&self, t: f64, limit: Limit) -> (DVec3, DVec3) {
        let n = self.across.jet(t, limit, 0).d[0];
        let l = self.line.jet(t, limit, 1).d[1];
        (n * self.scales[0], l * self.scales[1])
    }

    /// One coordinate of the sum and its derivatives by Leibniz' rule, from those of n and of the side.
    fn combine<S: Scalar>(
        &self,
        t: S,
        n: impl Fn(usize) -> S,
        s: impl Fn(usize) -> S,
        k: usize,
    ) -> S {
        let domain = self.domain();
        let width = S::from(domain.hi) - S::from(domain.lo);
        let x = (t - S::from(domain.lo)) / width;
        let linear = |f: [f64; 2]| {
            let [p, q] = f.map(S::from);
            (p + (q - p) * x, (q - p) / width)
        };
        let ((a, da), (b, db)) = (linear(self.a), linear(self.b));
        let value = a * n(k) + b * s(k + 1);
        if k == 0 {
            return value;
        }
        value + S::from(k as f64) * (da * n(k - 1) + db * s(k))
    }
}

impl Curve for OutOfSide {
    fn breaks(&self) -> &[Break] {
        &self.breaks
    }

    fn jet_into(&self, t: f64, limit: Limit, out: &mut [DVec3]) {
        let n = self.across.jet(t, limit, out.len() - 1).d;
        let s = self.line.jet(t, limit, out.len()).d;
        for (k, o) in out.iter_mut().enumerate() {
            let at = |c: usize| self.combine(t, |k| n[k][c], |k| s[k][c], k);
            *o = DVec3::new(at(0), at(1), at(2));
        }
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, out: &mut [Box3]) {
        let whole = || SmallVec::<[Box3; 6]>::from_elem(Box3::ENTIRE, out.len() + 1);
        let (mut n, mut s) = (whole(), whole());
        self.across.enclose_piece(t, limit, &mut n[..out.len()]);
        self.line.enclose_piece(t, limit, &mut s);
        let array =
            |b: &SmallVec<[Box3; 6]>| -> Vec<_> { b.iter().map(|b| b.to_array()).collect() };
        let (n, s) = (array(&n), array(&s));
        for (k, o) in out.iter_mut().enumerate() {
            let at = |c: usize| self.combine(t, |k| n[k][c], |k| s[k][c], k);
            *o = Box3::from([at(0), at(1), at(2)]);
        }
    }

    /// Of one degree more than the derivative across.
    fn to_nurbs(&self) -> Option<NurbsCurve> {
        let domain = self.domain();
        let across = self.across.to_nurbs()?.to_piecewise(DVec3::ZERO);
        let line = self.line.to_nurbs()?;
        let line = line.to_piecewise(line.control_points()[0]);
        let degree = across.degree().max(line.degree()) + 1;
        if across.breaks().len() != line.breaks().len() || degree > BSplineBasis::MAX_DEGREE {
            return None;
        }
        let mut breaks = Vec::with_capacity(line.breaks().len());
        for (x, y) in across.breaks().iter().zip(line.breaks()) {
            breaks.push(Break::new(y.at, x.smooth.min(y.smooth.saturating_sub(1))));
        }
        let pieces: Vec<Vec<Row>> = (0..breaks.pieces())
            .map(|i| {
                let part = breaks.piece(i);
                let share = [part.lo, part.hi].map(|t| (t - domain.lo) / (domain.hi - domain.lo));
                let linear = |f: [f64; 2]| share.map(|s| f[0] + (f[1] - f[0]) * s);
                let mut points = vec![vec![DVec4::ZERO]; degree + 1];
                let den = across.denominator(i);
                let w = line.is_rational().then(|| line.denominator(i));
                // A side with equal weights has the denominator 1, the derivative across perhaps another number.
                let unit = if w.is_some() { 1.0 } else { den[0] };
                for c in 0..3 {
                    let n = bernstein_product(across.numerator(i, c), &linear(self.a));
                    let s = slope(line.numerator(i, c), w.as_deref(), part);
                    let s = bernstein_product(&s, &linear(self.b.map(|b| b * unit)));
                    let (n, s) = (bernstein_elevate(&n, degree), bernstein_elevate(&s, degree));
                    for (p, (n, s)) in points.iter_mut().zip(n.iter().zip(&s)) {
                        p[0][c] = n + s;
                    }
                }
                // The derivative across has the square of the side's denominator: that of the derivative along.
                let w = elevated_denominator(&den, degree);
                points.iter_mut().zip(w).for_each(|(p, w)| p[0].w = w);
                points
            })
            .collect();
        NurbsCurve::from_spline(join(&breaks, degree, &pieces)).ok()
    }
}

/// A denominator with a higher degree. What is constant stays so: rounding would make a polynomial rational.
pub(super) fn elevated_denominator(den: &[f64], degree: usize) -> Vec<f64> {
    if den.iter().all(|w| *w == den[0]) {
        return vec![den[0]; degree + 1];
    }
    bernstein_elevate(den, degree)
}

/// The numerator of the derivative of `n/w` over a piece, whose denominator is `w²`; of `n` alone without w.
fn slope(n: &[f64], w: Option<&[f64]>, piece: Interval) -> Vec<f64> {
    let rate = (n.len() - 1) as f64 / (piece.hi - piece.lo);
    let derivative =
        |c: &[f64]| -> Vec<f64> { c.windows(2).map(|p| (p[1] - p[0]) * rate).collect() };
    let Some(w) = w else { return derivative(n) };
    let (a, b) = (
        bernstein_product(&derivative(n), w),
        bernstein_product(n, &derivative(w)),
    );
    a.iter().zip(&b).map(|(a, b)| a - b).collect()
}

/// The derivatives across a side that continue a neighbour.
pub(super) struct Continuation {
    /// The cross-derivative.
    pub first: CurveRef,
    /// The second derivative across, if asked for.
    pub second: Option<CurveRef>,
}

/// The derivatives up to an order of the two boundary curves that meet a side, where they meet it.
fn meeting(sides: &[CurveRef; 4], side: Side, order: usize) -> [Vec<DVec3>; 2] {
    let meeting = match side.along() {
        Dir::U => [Side::West, Side::East],
        Dir::V => [Side::South, Side::North],
    };
    let end = usize::from(side.is_upper());
    meeting.map(|m| at_end(sides[m as usize].as_ref(), end, order))
}

/// Whether a curve runs along a side of a surface backwards, and the parameter of the greatest distance found, with that.
fn orientation(own: &CurveRef, surface: &SurfaceRef, neighbour: Side) -> (bool, f64, f64) {
    /// Enough to tell curves apart; where they differ by more than the tolerance in between, corners still agree.
    const SAMPLES: usize = 32;
    let domains = surface.domain();
    let (along, across) = match neighbour.along() {
        Dir::U => (domains[0], domains[1]),
        Dir::V => (domains[1], domains[0]),
    };
    let x = if neighbour.is_upper() {
        across.hi
    } else {
        across.lo
    };
    let other = |s: f64| {
        let t = along.lo + (along.hi - along.lo) * s;
        surface.point(match neighbour.along() {
            Dir::U => [t, x],
            Dir::V => [x, t],
        })
    };
    let farthest = |reversed: bool| {
        (0..=SAMPLES)
            .map(|k| {
                let s = k as f64 / SAMPLES as f64;
                let p = other(if reversed { 1.0 - s } else { s });
                (s, own.point(s).distance(p))
            })
            // A distance that is NaN counts as the greatest.
            .fold((0.0, 0.0), |m, x| if x.1 <= m.1 { m } else { x })
    };
    let (forwards, backwards) = (farthest(false), farthest(true));
    let reversed = backwards.1 < forwards.1;
    let (at, distance) = if reversed { backwards } else { forwards };
    (reversed, at, distance)
}

/// The cross-derivative along a side that continues a neighbour, see [`Cross::Neighbour`]; for an order of 2 also the
/// second one.
pub(super) fn continuation(
    sides: &[CurveRef; 4],
    side: Side,
    surface: &SurfaceRef,
    neighbour: Side,
    limit: f64,
    order: usize,
) -> Result<Continuation, CoonsError> {
    let own = &sides[side as usize];
    let (reversed, at, distance) = orientation(own, surface, neighbour);
    if distance.is_nan() || distance > limit {
        return Err(CoonsError::NeighbourApart {
            side,
            neighbour,
            at,
            distance,
            limit,
        });
    }
    // Derivatives into this surface: those of the boundary curves that meet the side, turned round at an upper side.
    let sign = if side.is_upper() { -1.0 } else { 1.0 };
    let meeting = meeting(sides, side, order.max(1));
    let inward = [0, 1].map(|k| meeting[k][1] * sign);
    let mut join = OutOfSide::new(surface.clone(), neighbour);
    let ends = if reversed {
        [inward[1], inward[0]]
    } else {
        inward
    };
    let mut a = join.fit(ends);
    if reversed {
        a.reverse();
    }
    for corner in Corner::ALL {
        let k = corner.ends()[if side.along() == Dir::U { 0 } else { 1 }];
        if corner.sides().contains(&side) && a[k] <= 0.0 {
            return Err(CoonsError::NeighbourFolds {
                side,
                neighbour,
                corner,
            });
        }
    }
    if side.is_upper() {
        join.turn_round();
    }
    let second: Option<CurveRef> = if order < 2 {
        None
    } else {
        // The derivative along for a parameter that runs over [0, 1] in the direction of this surface's side.
        let along = surface.breaks(neighbour.along()).domain();
        let width = along.hi - along.lo;
        let (mut a, mut b) = (join.a, join.b.map(|b| b / width));
        if reversed {
            a.reverse();
            b = [-b[1], -b[0]];
        }
        let ends = [0, 1].map(|k| meeting[k][2]);
        let other = (surface.clone(), neighbour);
        let second = SecondOutOfSide::new(other, reversed, own.point(0.0), [a, b], ends);
        if let Some(at) = second.breaks().tear() {
            return Err(CoonsError::NeighbourJumps {
                side,
                neighbour,
                at,
            });
        }
        Some(Arc::new(second))
    };
    let join: CurveRef = Arc::new(join);
    let first = if reversed {
        Arc::new(Trimmed::reversed(join))
    } else {
        on_unit_domain(join)
    };
    Ok(Continuation { first, second })
}

/// The velocity of the cross-derivative of [`continuation`], from those of the sides and of the neighbour; `None` where a
/// corner of the neighbour has no tangent plane.
///
/// With `(a, b)` from `G (a, b) = (e·n, e·l)` at both ends, G the products of n and l, it is `a' n + a n' + b' l + b l'`.
pub(crate) fn continuation_rate(
    [sides, rates]: [&[CurveRef; 4]; 2],
    side: Side,
    [surface, velocity]: [&SurfaceRef; 2],
    neighbour: Side,
) -> Option<CurveRef> {
    let (reversed, ..) = orientation(&sides[side as usize], surface, neighbour);
    let sign = if side.is_upper() { -1.0 } else { 1.0 };
    let inward = |sides: &[CurveRef; 4]| {
        let mut ends = meeting(sides, side, 1).map(|d| d[1] * sign);
        if reversed {
            ends.reverse();
        }
        ends
    };
    let (ends, end_rates) = (inward(sides), inward(rates));
    let mut join = OutOfSide::new(surface.clone(), neighbour);
    join.fit(ends);
    let moved = OutOfSide::new(velocity.clone(), neighbour);
    let domain = join.domain();
    let mut factors = [[0.0; 2]; 2];
    let at = [(domain.lo, Limit::Above), (domain.hi, Limit::Below)];
    for (k, (t, limit)) in at.into_iter().enumerate() {
        let ((n, l), (dn, dl)) = (join.frame(t, limit), moved.frame(t, limit));
        let (nn, nl, ll) = (n.dot(n), n.dot(l), l.dot(l));
        let determinant = nn * ll - nl * nl;
        if determinant.is_nan() || determinant <= 1e-20 * nn * ll {
            return None;
        }
        let (a, b) = (join.a[k] / join.scales[0], join.b[k] / join.scales[1]);
        let (e, de) = (ends[k], end_rates[k]);
        let mixed = dn.dot(l) + n.dot(dl);
        let p = de.dot(n) + e.dot(dn) - (2.0 * n.dot(dn) * a + mixed * b);
        let q = de.dot(l) + e.dot(dl) - (mixed * a + 2.0 * l.dot(dl) * b);
        factors[0][k] = (p * ll - q * nl) / determinant * join.scales[0];
        factors[1][k] = (q * nn - p * nl) / determinant * join.scales[1];
    }
    let linear = |f: [f64; 2]| {
        let [p, q] = f.map(|x| x * sign);
        let slope = (q - p) / (domain.hi - domain.lo);
        Factor::Linear {
            constant: p - slope * domain.lo,
            along: [slope, 0.0],
        }
    };
    let across = |of: &OutOfSide| extended(Arc::new(of.across.clone()));
    let along = |of: &OutOfSide| Term::slide(extended(Arc::new(of.line.clone())), Dir::U, 0.0, 0.0);
    let sum = Sum::new(
        DVec3::ZERO,
        vec![
            Term::new(across(&join)).times(linear(factors[0])),
            Term::new(across(&moved)).times(linear(join.a)),
            along(&join).times(linear(factors[1])),
            along(&moved).times(linear(join.b)),
        ],
    );
    let rate = as_curve(sum);
    Some(if reversed {
        Arc::new(Trimmed::reversed(rate))
    } else {
        on_unit_domain(rate)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
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
