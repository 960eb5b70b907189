//! Polylines, and how parameters are spread over a list of points.

use super::CurveError;
use crate::exact::{NurbsCurve, NurbsError};
use glam::DVec3;
use std::cmp::Ordering;

/// How parameters are given to the points of a list. The first point has 0, the last (or, of a closed list, the
/// first again) has 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Spacing {
    /// In proportion to the distances between the points: even speed, and a point more on a straight stretch
    /// changes nothing.
    #[default]
    Chord,
    /// In proportion to the square roots of the distances: fewer overshoots where distances differ much. Source:
    /// Lee, *Choosing nodes in parametric curve interpolation* (1989).
    Centripetal,
    /// Equal steps: the k-th points of two lists face each other.
    Uniform,
}

impl Spacing {
    /// The parameters of the points, strictly increasing. With `closed` there is one more than points, for the way
    /// back to the first.
    ///
    /// Errors: a coordinate is not finite; fewer than two points; for [`Spacing::Chord`] and
    /// [`Spacing::Centripetal`], points that follow each other coincide (within rounding of the whole length).
    pub fn parameters(self, points: &[DVec3], closed: bool) -> Result<Vec<f64>, CurveError> {
        if let Some(index) = points.iter().position(|p| !p.is_finite()) {
            let point = points[index];
            return Err(NurbsError::PointNotFinite { index, point }.into());
        }
        let n = points.len();
        if n < 2 {
            return Err(CurveError::TooFewPoints {
                given: n,
                needed: 2,
            });
        }
        let steps = if closed { n } else { n - 1 };
        let mut at = Vec::with_capacity(steps + 1);
        let mut sum = 0.0;
        at.push(0.0);
        for i in 0..steps {
            let step = match self {
                Spacing::Uniform => 1.0,
                Spacing::Chord => points[i].distance(points[(i + 1) % n]),
                Spacing::Centripetal => points[i].distance(points[(i + 1) % n]).sqrt(),
            };
            sum += step;
            at.push(sum);
        }
        at.iter_mut().for_each(|t| *t /= sum);
        at[steps] = 1.0;
        match (0..steps).find(|&i| at[i].partial_cmp(&at[i + 1]) != Some(Ordering::Less)) {
            None => Ok(at),
            Some(first) => Err(CurveError::Coincident {
                first,
                second: (first + 1) % n,
                point: points[first],
            }),
        }
    }
}

impl Spacing {
    /// The rates of the parameters when points move.
    pub fn rates(self, points: &[DVec3], velocities: &[DVec3], closed: bool) -> Vec<f64> {
        let n = points.len();
        let steps = if closed { n } else { n.saturating_sub(1) };
        let mut sums = vec![[0.0; 2]];
        let mut sum = [0.0; 2];
        for i in 0..steps {
            let j = (i + 1) % n;
            let (way, rate) = (points[j] - points[i], velocities[j] - velocities[i]);
            let length = way.length();
            let speed = if length > 0.0 {
                way.dot(rate) / length
            } else {
                0.0
            };
            let [step, rate] = match self {
                Spacing::Uniform => [1.0, 0.0],
                Spacing::Chord => [length, speed],
                Spacing::Centripetal => [length.sqrt(), 0.5 * speed / length.sqrt()],
            };
            sum = [sum[0] + step, sum[1] + rate];
            sums.push(sum);
        }
        let [whole, grows] = sum;
        let rate = |[at, rate]: [f64; 2]| (rate - at / whole * grows) / whole;
        sums.into_iter().map(rate).collect()
    }
}

/// The polyline through points on `[0, 1]`, with a corner (a break of smoothness 0) at every inner point; a B-spline
/// of degree 1. Errors: as [`Spacing::parameters`]. With [`Spacing::Uniform`] repeated points are allowed.
pub fn polyline(points: &[DVec3], spacing: Spacing) -> Result<NurbsCurve, CurveError> {
    let at = spacing.parameters(points, false)?;
    let mut knots = vec![0.0];
    knots.extend(at);
    knots.push(1.0);
    Ok(NurbsCurve::new(1, knots, points, None)?)
}
