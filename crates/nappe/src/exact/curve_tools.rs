//! NURBS curves with other knots, degrees, domains: the same points by other data.

use super::spline::{Row, SAME_KNOT, Spline};
use super::{NurbsCurve, NurbsError};
use crate::basis::{BSplineBasis, KnotError};
use crate::curve::Curve;
use crate::interval::Interval;
use glam::Vec4Swizzles;

impl NurbsCurve {
    pub(crate) fn to_spline(&self) -> Spline {
        let rows = self.homogeneous().iter().map(|&p| vec![p]).collect();
        Spline::new(self.basis(), rows)
    }

    pub(crate) fn from_spline(s: Spline) -> Result<Self, NurbsError> {
        let points = s.rows.iter().map(|r| r[0]).collect();
        let basis = BSplineBasis::new(s.degree, s.knots)?;
        Ok(Self::from_homogeneous(basis, points))
    }

    /// The same curve with a knot inserted `times` times. Cost: O(degree) each.
    ///
    /// Errors: `t` is outside the domain; the knot would occur more than `degree` times.
    pub fn insert_knot(&self, t: f64, times: usize) -> Result<Self, NurbsError> {
        let mut s = self.to_spline();
        inside(t, s.domain())?;
        let multiplicity = s.multiplicity(t) + times;
        check_multiplicity(&s, t, multiplicity)?;
        s.raise(t, multiplicity);
        Self::from_spline(s)
    }

    /// The same curve with several knots inserted, in any order, repeated as often as they are to be inserted.
    /// Errors: as [`Self::insert_knot`].
    pub fn refined(&self, knots: &[f64]) -> Result<Self, NurbsError> {
        let mut s = self.to_spline();
        refine(&mut s, knots)?;
        Self::from_spline(s)
    }

    /// The same curve without one occurrence of an inner knot, if no point of the curve moves by more than `tol`;
    /// `None` if the knot is needed or not there.
    pub fn without_knot(&self, t: f64, tol: f64) -> Option<Self> {
        // Measured from the middle of the points, homogeneous data is small, and a move of the homogeneous points by
        // h moves the curve by at most h (1 + |p|) / w. Source: Piegl and Tiller, The NURBS Book, §5.4 (5.30).
        let origin = super::nurbs_curve::middle(self.homogeneous());
        let mut s = self.to_spline();
        let (mut reach, mut weight) = (0.0f64, f64::INFINITY);
        for p in s.rows.iter_mut().flatten() {
            *p = (p.xyz() - origin * p.w).extend(p.w);
            reach = reach.max((p.xyz() / p.w).length());
            weight = weight.min(p.w);
        }
        let allowed = if self.is_rational() {
            tol * weight / (1.0 + reach)
        } else {
            tol * weight
        };
        let mut s = s.without(t, allowed)?;
        for p in s.rows.iter_mut().flatten() {
            *p = (p.xyz() + origin * p.w).extend(p.w);
        }
        // A removal may leave a weight that is not positive: such a curve is not one of ours.
        if s.rows.iter().flatten().any(|p| p.w.is_nan() || p.w <= 0.0) {
            return None;
        }
        Self::from_spline(s).ok()
    }

    /// The same curve with a higher degree, clamped. Error: `degree` is lower than the curve's or too high.
    pub fn elevated(&self, degree: usize) -> Result<Self, NurbsError> {
        check_degree(self.degree(), degree)?;
        Self::from_spline(self.to_spline().elevated(degree))
    }

    /// The part over `[from, to]`, clamped, with the parameters it had. Error: not a part of positive length.
    pub fn part(&self, from: f64, to: f64) -> Result<Self, NurbsError> {
        check_part(from, to, self.domain())?;
        Self::from_spline(self.to_spline().part(from, to))
    }

    /// The parts before and after a parameter inside the domain.
    pub fn split(&self, t: f64) -> Result<[Self; 2], NurbsError> {
        let Interval { lo, hi } = self.domain();
        Ok([self.part(lo, t)?, self.part(t, hi)?])
    }

    /// The Bézier curves between the knots, each with the parameters it had.
    pub fn bezier_pieces(&self) -> Result<Vec<Self>, NurbsError> {
        let s = self.to_spline();
        let (breaks, pieces) = s.pieces();
        let ranges = breaks.windows(2).map(|w| [w[0].at, w[1].at]);
        ranges
            .zip(pieces)
            .map(|([lo, hi], rows)| {
                let mut knots = vec![lo; s.degree + 1];
                knots.resize(2 * s.degree + 2, hi);
                Self::from_spline(Spline {
                    degree: s.degree,
                    knots,
                    rows,
                })
            })
            .collect()
    }

    /// The same curve with end knots of full multiplicity, so that it starts and ends at its end points.
    pub fn clamped(&self) -> Result<Self, NurbsError> {
        Self::from_spline(self.to_spline().clamped())
    }

    /// The curve run through backwards over the same domain: `t ↦ r(lo + hi - t)`.
    ///
    /// Error: knots so near each other that rounding makes them one too often.
    pub fn reversed(&self) -> Result<Self, NurbsError> {
        let Interval { lo, hi } = self.domain();
        Self::from_spline(self.to_spline().on(hi, lo))
    }

    /// The curve with its domain mapped linearly to `[lo, hi]`.
    ///
    /// Errors: not an interval; knots so near each other that rounding makes them one too often.
    pub fn on_domain(&self, lo: f64, hi: f64) -> Result<Self, NurbsError> {
        check_interval(lo, hi)?;
        Self::from_spline(self.to_spline().on(lo, hi))
    }
}

impl NurbsCurve {
    /// Curves joined end to end into one: each keeps its parameters, so each must begin where the one before ends, in
    /// space and in the parameter. The joints get knots of multiplicity `degree`; the joint point is that of the
    /// earlier curve.
    ///
    /// Errors: no curves; a domain that does not continue the one before.
    pub(crate) fn joined(parts: &[NurbsCurve]) -> Result<Self, NurbsError> {
        let degree = parts.iter().map(NurbsCurve::degree).max().unwrap_or(1);
        let mut whole: Option<Spline> = None;
        for part in parts {
            let next = part.to_spline().elevated(degree);
            let Some(s) = &mut whole else {
                whole = Some(next);
                continue;
            };
            let (end, start) = (s.domain().hi, next.domain().lo);
            if end != start {
                return Err(NurbsError::Empty {
                    from: start,
                    to: end,
                });
            }
            // Only ratios of weights matter: the shared point gets one weight.
            let scale = s.rows[s.rows.len() - 1][0].w / next.rows[0][0].w;
            s.knots.truncate(s.knots.len() - 1);
            s.knots.extend_from_slice(&next.knots[degree + 1..]);
            let rest = next.rows[1..].iter().map(|r| vec![r[0] * scale]);
            s.rows.extend(rest);
        }
        let Some(whole) = whole else {
            return Err(NurbsError::Empty { from: 0.0, to: 0.0 });
        };
        Self::from_spline(whole)
    }
}

/// The same curves with one degree and one clamped knot vector: the highest degree of all, the domain of the first,
/// and every knot as often as the curve that has it most often. Knots within 4 units in the last place are one.
///
/// Errors: knots so near each other that they cannot be told apart on the common domain. No curves give none.
pub fn compatible(curves: &[NurbsCurve]) -> Result<Vec<NurbsCurve>, NurbsError> {
    let Some(first) = curves.first() else {
        return Ok(Vec::new());
    };
    let Interval { lo, hi } = first.domain();
    let degree = curves.iter().map(NurbsCurve::degree).max().unwrap_or(1);
    let mut splines: Vec<Spline> = curves
        .iter()
        .map(|c| c.to_spline().on(lo, hi).elevated(degree))
        .collect();
    unify(&mut splines);
    splines.into_iter().map(NurbsCurve::from_spline).collect()
}

/// Gives clamped splines of one degree and domain one knot vector.
pub(crate) fn unify(splines: &mut [Spline]) {
    let mut all: Vec<f64> = splines.iter().flat_map(|s| s.knots.clone()).collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|b, a| *b - *a <= SAME_KNOT * a.abs().max(b.abs()));
    for s in splines.iter_mut() {
        for k in &mut s.knots {
            let i = all.partition_point(|a| a <= k);
            *k = all[i.saturating_sub(1)];
        }
    }
    for t in all {
        let most = splines.iter().map(|s| s.multiplicity(t)).max().unwrap_or(0);
        splines.iter_mut().for_each(|s| s.raise(t, most));
    }
}

pub(crate) fn refine(s: &mut Spline, knots: &[f64]) -> Result<(), NurbsError> {
    for &t in knots {
        inside(t, s.domain())?;
        let multiplicity = s.multiplicity(t) + 1;
        check_multiplicity(s, t, multiplicity)?;
        s.raise(t, multiplicity);
    }
    Ok(())
}

pub(crate) fn inside(value: f64, domain: Interval) -> Result<(), NurbsError> {
    if domain.contains(value) {
        Ok(())
    } else {
        Err(NurbsError::Outside { value, domain })
    }
}

pub(crate) fn check_degree(own: usize, degree: usize) -> Result<(), NurbsError> {
    if degree > BSplineBasis::MAX_DEGREE {
        return Err(KnotError::Degree { degree }.into());
    }
    if degree < own {
        return Err(NurbsError::Lower { own, degree });
    }
    Ok(())
}

pub(crate) fn check_part(from: f64, to: f64, domain: Interval) -> Result<(), NurbsError> {
    inside(from, domain)?;
    inside(to, domain)?;
    check_interval(from, to)
}

pub(crate) fn check_interval(from: f64, to: f64) -> Result<(), NurbsError> {
    if from < to && from.is_finite() && to.is_finite() {
        Ok(())
    } else {
        Err(NurbsError::Empty { from, to })
    }
}

pub(crate) fn check_multiplicity(
    s: &Spline,
    value: f64,
    multiplicity: usize,
) -> Result<(), NurbsError> {
    if multiplicity <= s.degree {
        return Ok(());
    }
    Err(KnotError::Multiplicity {
        index: s.knots.partition_point(|&k| k < value),
        value,
        multiplicity,
        most: s.degree,
        degree: s.degree,
    }
    .into())
}

/// One row for each control point of a line of points.
pub(crate) fn single_rows(points: impl IntoIterator<Item = glam::DVec4>) -> Vec<Row> {
    points.into_iter().map(|p| vec![p]).collect()
}
