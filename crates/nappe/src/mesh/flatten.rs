//! Curves as polylines within a proven tolerance.

use super::{Certainty, ROUNDING};
use crate::breaks::{Breaks, Limit};
use crate::curve::Curve;
use crate::interval::Interval;
use glam::DVec3;
use thiserror::Error;

/// A curve as a polyline.
#[derive(Clone, Debug, PartialEq)]
pub struct FlatCurve {
    /// The parameters of the points, increasing.
    pub parameters: Vec<f64>,
    /// The points, two or more. The first and the last are those of the curve.
    pub points: Vec<DVec3>,
    /// The greatest distance between points of the curve and of the polyline that share a parameter, and so at least
    /// their two-sided Hausdorff distance.
    pub deviation: Certainty,
}

/// Why there is no polyline.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FlattenError {
    /// The tolerance is not a length.
    #[error("the tolerance is {tol}: it must be a positive, finite length")]
    Tolerance {
        /// The tolerance asked for.
        tol: f64,
    },
    /// The curve has no point somewhere.
    #[error("the curve has no finite point at t = {t}")]
    NotFinite {
        /// The parameter.
        t: f64,
    },
    /// Too many points would be needed.
    #[error("more than {max} points are needed: raise the tolerance")]
    TooMany {
        /// The limit.
        max: usize,
    },
}

/// A piece is halved at most this often. Where a derivative is infinite the pieces become small; after this many
/// halvings they are as small as rounding.
const MAX_DEPTH: u32 = 52;
/// Covers the roundings of the few operations on positive numbers below.
const ROUND_UP: f64 = 1.0 + 1e-14;
/// Where nothing can be proven a piece is halved this often, so that the samples at its middle are an estimate.
const UNPROVEN_DEPTH: u32 = 8;

/// A polyline within `tol` (a length in the model's units) of a curve, by halving its pieces: over a part of length h
/// the chord is within `⅛ ‖r''‖ h²` of the curve, and within the diagonal of a box around it. The curve's breaks are
/// points of the polyline; a straight piece has no others. [`Certainty::Bounded`] includes the rounding of the points;
/// [`Certainty::Estimated`] means that the curve could not enclose itself somewhere.
///
/// Errors: see [`FlattenError`]; no more than `max_points` points are made. Cost: proportional to the points.
pub fn flatten(curve: &dyn Curve, tol: f64, max_points: usize) -> Result<FlatCurve, FlattenError> {
    if !(tol > 0.0 && tol.is_finite()) {
        return Err(FlattenError::Tolerance { tol });
    }
    let breaks = curve.breaks();
    let mut flat = FlatCurve {
        parameters: vec![breaks.domain().lo],
        points: vec![finite(curve, breaks.domain().lo)?],
        deviation: Certainty::Exact,
    };
    for i in 0..breaks.pieces() {
        let mut waiting = vec![(breaks.piece(i), 0)];
        while let Some((t, depth)) = waiting.pop() {
            let (deviation, fine) = chord_error(curve, t, tol, depth);
            let m = t.mid();
            if !fine && t.lo < m && m < t.hi {
                waiting.push((Interval { lo: m, hi: t.hi }, depth + 1));
                waiting.push((Interval { lo: t.lo, hi: m }, depth + 1));
                continue;
            }
            if flat.points.len() == max_points {
                return Err(FlattenError::TooMany { max: max_points });
            }
            flat.parameters.push(t.hi);
            flat.points.push(finite(curve, t.hi)?);
            flat.deviation = flat.deviation.and(deviation);
        }
    }
    let far = flat
        .points
        .iter()
        .fold(0.0f64, |a, p| a.max(p.abs().max_element()));
    flat.deviation = match flat.deviation {
        Certainty::Exact | Certainty::Bounded(_) => {
            Certainty::Bounded(flat.deviation.error() + ROUNDING * far)
        }
        Certainty::Estimated(e) => Certainty::Estimated(e + ROUNDING * far),
    };
    Ok(flat)
}

/// How far the chord over a part of a piece is from the curve, and whether that is all that is asked for.
fn chord_error(curve: &dyn Curve, t: Interval, tol: f64, depth: u32) -> (Certainty, bool) {
    // The part's inner side is meant at both ends; its middle lies in the piece.
    let mut boxes = [crate::Box3::ENTIRE; 3];
    curve.enclose_piece(t, Limit::Above, &mut boxes);
    let h = t.width();
    let bent = 0.125 * boxes[2].norm().hi * h * h * ROUND_UP;
    let bound = bent.min(boxes[0].diagonal());
    if bound.is_finite() {
        return (
            Certainty::Bounded(bound),
            bound <= tol || depth >= MAX_DEPTH,
        );
    }
    let [a, m, b] = [t.lo, t.mid(), t.hi].map(|t| curve.point(t));
    let sampled = m.distance(0.5 * (a + b));
    let fine = sampled <= tol && depth >= UNPROVEN_DEPTH || depth >= MAX_DEPTH;
    (Certainty::Estimated(sampled), fine)
}

fn finite(curve: &dyn Curve, t: f64) -> Result<DVec3, FlattenError> {
    let p = curve.point(t);
    if p.is_finite() {
        Ok(p)
    } else {
        Err(FlattenError::NotFinite { t })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::ExpressionCurve;
    use crate::exact::NurbsCurve;
    use crate::expr::Expr;

    fn formula(x: &str, y: &str) -> ExpressionCurve {
        let bound = |text: &str| Expr::parse(text).unwrap().bind(&["t"], &[]).unwrap();
        ExpressionCurve::new([bound(x), bound(y), bound("0")], [0.0, 1.0]).unwrap()
    }

    /// Every point of the curve lies within the stated deviation of the chord with the same parameter, and the number
    /// of points is within a small factor of what the curvature asks for.
    fn holds(curve: &dyn Curve, tol: f64, most: usize) {
        let flat = flatten(curve, tol, 100_000).unwrap();
        let Certainty::Bounded(e) = flat.deviation else {
            panic!("not proven: {:?}", flat.deviation)
        };
        assert!(e <= tol * 1.001, "{e:e} > {tol:e}");
        assert!(flat.points.len() <= most, "{} points", flat.points.len());
        for (t, p) in flat.parameters.windows(2).zip(flat.points.windows(2)) {
            for k in 0..=16 {
                let s = k as f64 / 16.0;
                let on_curve = curve.point(t[0] + (t[1] - t[0]) * s);
                assert!(on_curve.distance(p[0].lerp(p[1], s)) <= e);
            }
        }
        let [a, b] = curve.ends();
        assert_eq!((flat.points[0], flat.points[flat.points.len() - 1]), (a, b));
    }

    #[test]
    fn arcs_are_cut_as_their_curvature_asks_at_all_scales() {
        let p = [DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        for scale in [1e-6, 1.0, 1e6] {
            let p = p.map(|p| p * scale);
            let arc = NurbsCurve::bezier(&p, Some(&[1.0, 0.5f64.sqrt(), 1.0])).unwrap();
            // A sagitta of 1e-4 takes about π/4 / √(2e-4) = 56 chords of a quarter circle.
            holds(&arc, 1e-4 * scale, 2 * 65);
        }
    }

    #[test]
    fn a_line_is_one_chord() {
        let flat = flatten(&formula("3 * t", "1 - t"), 1e-9, 10).unwrap();
        assert_eq!(flat.points, [DVec3::Y, DVec3::new(3.0, 0.0, 0.0)]);
    }

    #[test]
    fn an_infinite_second_derivative_is_still_proven() {
        holds(&formula("t", "t^1.5"), 1e-4, 200);
        holds(&formula("t", "abs(t - 0.3)"), 1e-9, 3);
    }

    #[test]
    fn what_cannot_be_is_said() {
        let c = formula("t", "t^2");
        assert!(matches!(
            flatten(&c, 0.0, 9),
            Err(FlattenError::Tolerance { .. })
        ));
        assert!(matches!(
            flatten(&c, f64::NAN, 9),
            Err(FlattenError::Tolerance { .. })
        ));
        assert_eq!(flatten(&c, 1e-9, 9), Err(FlattenError::TooMany { max: 9 }));
    }
}
