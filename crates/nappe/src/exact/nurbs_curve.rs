//! NURBS curves.

use super::PiecewiseRational;
use crate::basis::{BSplineBasis, Functions, KnotError, jet_of};
use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit};
use crate::curve::{Curve, quotient_rule};
use crate::interval::Interval;
use crate::scalar::{Number, Pack};
use glam::{DAffine3, DVec3, DVec4, Vec4Swizzles};
use pulp::bytemuck::cast_slice_mut;
use smallvec::SmallVec;
use thiserror::Error;

/// What can be wrong with the data of a Bézier or NURBS curve or surface.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NurbsError {
    /// The knots are wrong.
    #[error(transparent)]
    Knots(#[from] KnotError),
    /// A control point has a coordinate that is NaN or infinite.
    #[error("point {index} is {point}: coordinates must be finite numbers")]
    PointNotFinite {
        /// Which point.
        index: usize,
        /// The point.
        point: DVec3,
    },
    /// A weight is not positive and finite.
    #[error("weight {index} is {value}: weights must be positive, finite numbers")]
    Weight {
        /// Which weight.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// The number of weights differs from the number of points.
    #[error("{weights} weights are given for {points} points")]
    WeightCount {
        /// The number of points.
        points: usize,
        /// The number of weights.
        weights: usize,
    },
    /// The number of points is not that of a net with the given rows and columns.
    #[error("a net of {rows} × {columns} has {} points, {points} are given", rows * columns)]
    NetSize {
        /// Rows, along u.
        rows: usize,
        /// Columns, along v.
        columns: usize,
        /// The number of points given.
        points: usize,
    },
    /// A parameter is outside the domain.
    #[error("the parameter {value} is not between {} and {}", domain.lo, domain.hi)]
    Outside {
        /// The parameter.
        value: f64,
        /// The domain.
        domain: Interval,
    },
    /// A range has no positive length.
    #[error("the range from {from} to {to} must have finite ends and a positive length")]
    Empty {
        /// Where it begins.
        from: f64,
        /// Where it ends.
        to: f64,
    },
    /// A degree is to be raised, but the one asked for is lower.
    #[error("degree {own} cannot be raised to {degree}")]
    Lower {
        /// The degree there is.
        own: usize,
        /// The degree asked for.
        degree: usize,
    },
}

/// Checks points and weights and lifts them to homogeneous coordinates `(w x, w y, w z, w)`.
pub(crate) fn homogeneous(
    points: &[DVec3],
    weights: Option<&[f64]>,
) -> Result<Vec<DVec4>, NurbsError> {
    if let Some(index) = points.iter().position(|p| !p.is_finite()) {
        return Err(NurbsError::PointNotFinite {
            index,
            point: points[index],
        });
    }
    let Some(weights) = weights else {
        return Ok(points.iter().map(|p| p.extend(1.0)).collect());
    };
    if weights.len() != points.len() {
        return Err(NurbsError::WeightCount {
            points: points.len(),
            weights: weights.len(),
        });
    }
    if let Some(error) = bad_weights(weights).next() {
        return Err(error);
    }
    Ok(points
        .iter()
        .zip(weights)
        .map(|(p, &w)| (*p * w).extend(w))
        .collect())
}

/// An error for each weight that is not positive and finite.
pub fn bad_weights(weights: &[f64]) -> impl Iterator<Item = NurbsError> {
    let bad = weights.iter().enumerate();
    let bad = bad.filter(|(_, w)| !(w.is_finite() && **w > 0.0));
    bad.map(|(index, &value)| NurbsError::Weight { index, value })
}

/// The point that homogeneous data is measured from: the middle of the points, so that enclosures and quotients
/// lose nothing far from the origin of space.
pub(crate) fn middle(points: &[DVec4]) -> DVec3 {
    let sum: DVec3 = points.iter().map(|p| p.xyz() / p.w).sum();
    let m = sum / points.len() as f64;
    if m.is_finite() { m } else { DVec3::ZERO }
}

/// A NURBS curve; without weights a B-spline curve, without inner knots a (rational) Bézier curve.
///
/// `r(t) = Σ N_i(t) w_i p_i / Σ N_i(t) w_i` on `[knots[degree], knots[points]]`. Only ratios of weights matter.
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsCurve {
    basis: BSplineBasis,
    /// Homogeneous points as given.
    points: Vec<DVec4>,
    /// The same, measured from `origin`.
    local: Vec<DVec4>,
    origin: DVec3,
    rational: bool,
}

impl NurbsCurve {
    /// From control points, knots and weights (`None`: all 1).
    pub fn new(
        degree: usize,
        knots: Vec<f64>,
        points: &[DVec3],
        weights: Option<&[f64]>,
    ) -> Result<Self, NurbsError> {
        if points.len() <= degree {
            return Err(KnotError::TooFewPoints {
                points: points.len(),
                degree,
            }
            .into());
        }
        if knots.len() != points.len() + degree + 1 {
            return Err(KnotError::Count {
                points: points.len(),
                degree,
                knots: knots.len(),
            }
            .into());
        }
        let h = homogeneous(points, weights)?;
        Ok(Self::from_homogeneous(BSplineBasis::new(degree, knots)?, h))
    }

    /// A (rational) Bézier curve on `[0, 1]`; the degree is one less than the number of points.
    pub fn bezier(points: &[DVec3], weights: Option<&[f64]>) -> Result<Self, NurbsError> {
        let degree = points.len().saturating_sub(1);
        if degree == 0 {
            return Err(KnotError::TooFewPoints {
                points: points.len(),
                degree: 1,
            }
            .into());
        }
        if degree > BSplineBasis::MAX_DEGREE {
            return Err(KnotError::Degree { degree }.into());
        }
        Ok(Self::from_homogeneous(
            BSplineBasis::bernstein(degree),
            homogeneous(points, weights)?,
        ))
    }

    /// From points `(w x, w y, w z, w)`. Panics if their number is not that of the basis.
    pub fn from_homogeneous(basis: BSplineBasis, points: Vec<DVec4>) -> Self {
        assert_eq!(
            basis.count(),
            points.len(),
            "one point for each basis function"
        );
        let origin = middle(&points);
        let local = points
            .iter()
            .map(|p| (p.xyz() - origin * p.w).extend(p.w))
            .collect();
        let rational = points.iter().any(|p| p.w != points[0].w);
        Self {
            basis,
            points,
            local,
            origin,
            rational,
        }
    }

    /// The basis: degree and knots.
    pub fn basis(&self) -> &BSplineBasis {
        &self.basis
    }

    /// The degree.
    pub fn degree(&self) -> usize {
        self.basis.degree()
    }

    /// The full knot vector.
    pub fn knots(&self) -> &[f64] {
        self.basis.knots()
    }

    /// The points `(w x, w y, w z, w)`.
    pub fn homogeneous(&self) -> &[DVec4] {
        &self.points
    }

    /// The control points in space.
    pub fn control_points(&self) -> Vec<DVec3> {
        self.points.iter().map(|p| p.xyz() / p.w).collect()
    }

    /// The weights.
    pub fn weights(&self) -> Vec<f64> {
        self.points.iter().map(|p| p.w).collect()
    }

    /// True if the weights differ.
    pub fn is_rational(&self) -> bool {
        self.rational
    }

    /// The image under an affine map: exact, since only the points move.
    pub fn transformed(&self, map: &DAffine3) -> Self {
        let image = |p: &DVec4| (map.matrix3 * p.xyz() + map.translation * p.w).extend(p.w);
        Self::from_homogeneous(self.basis.clone(), self.points.iter().map(image).collect())
    }

    /// The coordinates of `curve - origin` in piecewise Bernstein form.
    pub fn to_piecewise(&self, origin: DVec3) -> PiecewiseRational {
        let basis = super::piecewise_of(&self.basis);
        let (p, pieces) = (basis.degree(), basis.breaks().len() - 1);
        let (mut num, mut den) = (Vec::new(), Vec::new());
        let shift = self.origin - origin;
        for piece in 0..pieces {
            let range = self
                .basis
                .active(basis.breaks().piece(piece).mid(), Limit::Above);
            let mut sum = vec![DVec4::ZERO; p + 1];
            for f in range {
                let c = self.local[f];
                let c = (c.xyz() + shift * c.w).extend(c.w);
                for (s, b) in sum.iter_mut().zip(basis.numerator(piece, f)) {
                    *s += c * *b;
                }
            }
            for k in 0..3 {
                num.extend(
                    sum.iter()
                        .map(|s| s[k] / if self.rational { 1.0 } else { self.points[0].w }),
                );
            }
            den.extend(sum.iter().map(|s| s.w));
        }
        let breaks = basis.breaks().to_vec();
        if self.rational {
            PiecewiseRational::rational(breaks, p, 3, num, den)
        } else {
            PiecewiseRational::polynomial(breaks, p, 3, num)
        }
    }

    /// The sum of the active points, `n` of them, measured from `origin` or another point; then the quotient rule.
    fn eval<S: Number>(
        &self,
        basis: &[S],
        n: usize,
        point: impl Fn(usize) -> [S; 4],
        out: &mut [[S; 3]],
    ) {
        let mut h: SmallVec<[[S; 4]; 4]> = SmallVec::from_elem([S::ZERO; 4], out.len());
        for i in 0..n {
            let c = point(i);
            for (k, h) in h.iter_mut().enumerate() {
                let f = basis[k * n + i];
                for a in 0..4 {
                    h[a] = h[a] + f * c[a];
                }
            }
        }
        if self.rational {
            return quotient_rule(&h, out);
        }
        let w = self.points[0].w;
        for (o, h) in out.iter_mut().zip(&h) {
            *o = [h[0], h[1], h[2]];
            if w != 1.0 {
                *o = o.map(|x| x / S::from(w));
            }
        }
    }
}

impl Curve for NurbsCurve {
    fn breaks(&self) -> &[Break] {
        self.basis.breaks()
    }

    fn jet_into(&self, t: f64, limit: Limit, out: &mut [DVec3]) {
        let (mut stack, mut heap) = ([0.0; 16], Vec::new());
        let order = out.len() - 1;
        let (active, basis) = jet_of(&self.basis, (t, limit), order, &mut stack, &mut heap);
        let points = &self.local[active];
        let point = |i: usize| points[i].to_array();
        self.eval(basis, points.len(), point, cast_slice_mut(out));
        out[0] += self.origin;
    }

    fn pack_into(&self, t: Pack, limit: Limit, out: &mut [[Pack; 3]]) {
        let (n, spans) = (self.degree() + 1, t.0.map(|t| self.basis.span(t, limit)));
        let mut basis: SmallVec<[Pack; 8]> = SmallVec::from_elem(Pack::ZERO, out.len() * n);
        self.basis.pack_in(spans, t, out.len() - 1, &mut basis);
        let point = |i: usize| {
            let mut point = [Pack::ZERO; 4];
            for (lane, span) in spans.into_iter().enumerate() {
                let p = self.local[span + 1 - n + i];
                for a in 0..4 {
                    point[a].0[lane] = p[a];
                }
            }
            point
        };
        self.eval(&basis, n, point, out);
        for (x, origin) in out[0].iter_mut().zip(self.origin.to_array()) {
            *x = *x + Pack::from(origin);
        }
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, out: &mut [Box3]) {
        let m = t.mid();
        let range = self.basis.active(m, limit);
        let mut basis: SmallVec<[Interval; 16]> =
            SmallVec::from_elem(Interval::ENTIRE, out.len() * range.len());
        self.basis
            .enclose_piece(t, limit, out.len() - 1, &mut basis);
        let mut at = [DVec3::ZERO];
        self.jet_into(m, limit, &mut at);
        let shift = at[0] - self.origin;
        let mut r: SmallVec<[[Interval; 3]; 4]> =
            SmallVec::from_elem([Interval::ENTIRE; 3], out.len());
        let points = &self.local[range];
        let point = |i: usize| {
            let [x, y, z, w] = points[i].to_array().map(Interval::point);
            let [a, b, c] = shift.to_array().map(Interval::point);
            [x - a * w, y - b * w, z - c * w, w]
        };
        self.eval(&basis, points.len(), point, &mut r);
        for (o, r) in out.iter_mut().zip(&r) {
            *o = Box3::from(*r);
        }
        // Within the domain a span lies in the hull of its points if weights are positive, also where their enclosed sum may
        // be zero.
        if self.domain().encloses(t) && points.iter().all(|p| p.w > 0.0) {
            let place = |i: usize| {
                let [x, y, z, w] = point(i);
                Box3::from([x / w, y / w, z / w])
            };
            let hull = (0..points.len()).map(place).reduce(Box3::hull);
            out[0] = hull.map_or(out[0], |hull| out[0].meet(hull));
        }
        out[0] = out[0] + Box3::point(shift) + Box3::point(self.origin);
    }

    fn to_nurbs(&self) -> Option<NurbsCurve> {
        Some(self.clone())
    }
}
