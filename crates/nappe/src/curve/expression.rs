//! A curve whose coordinates are expressions.

use super::Curve;
use crate::box3::Box3;
use crate::breaks::{Break, Limit, merge_breaks};
use crate::expr::{Function, FunctionError};
use crate::interval::Interval;
use glam::DVec3;
use smallvec::SmallVec;
use thiserror::Error;

/// The curve `(x(t), y(t), z(t))` with an expression for each coordinate.
///
/// Derivatives of any order are exact (series arithmetic, no differences) and enclosures rigorous. Its breaks are
/// the places where `abs`, `if` and other switches of an expression change. There is no exact NURBS form.
/// Each coordinate has a finite value and first derivative everywhere in the domain; a higher derivative that does
/// not exist (the second of `t^1.5` at 0) is infinite.
/// Cost of a point: one walk over the three expressions.
#[derive(Clone, Debug)]
pub struct ExpressionCurve {
    coordinates: [Function; 3],
    breaks: Vec<Break>,
}

/// Why three functions are no curve.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ExpressionCurveError {
    /// A coordinate is no function over the domain.
    #[error("{}: {error}", ["x", "y", "z"][*.coordinate])]
    Coordinate {
        /// 0, 1 or 2.
        coordinate: usize,
        /// What is wrong with it.
        error: FunctionError,
    },
}

impl ExpressionCurve {
    /// The curve with the given coordinates over the domain `[from, to]`.
    pub fn new(
        coordinates: [crate::expr::Bound; 3],
        domain: [f64; 2],
    ) -> Result<Self, ExpressionCurveError> {
        let make = |coordinate: usize, bound: crate::expr::Bound| {
            Function::new(bound, domain)
                .map_err(|error| ExpressionCurveError::Coordinate { coordinate, error })
        };
        let [x, y, z] = coordinates;
        let coordinates = [make(0, x)?, make(1, y)?, make(2, z)?];
        let breaks = merge_breaks(coordinates.iter().map(Function::breaks));
        Ok(Self {
            coordinates,
            breaks,
        })
    }

    /// The functions of the coordinates.
    pub fn coordinates(&self) -> &[Function; 3] {
        &self.coordinates
    }
}

impl Curve for ExpressionCurve {
    fn breaks(&self) -> &[Break] {
        &self.breaks
    }

    fn jet_into(&self, t: f64, limit: Limit, out: &mut [DVec3]) {
        let mut d: SmallVec<[f64; 6]> = SmallVec::from_elem(0.0, out.len());
        for (i, f) in self.coordinates.iter().enumerate() {
            f.jet_into(t, limit, &mut d);
            for (o, &d) in out.iter_mut().zip(&d) {
                o[i] = d;
            }
        }
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, out: &mut [Box3]) {
        let mut d: [SmallVec<[Interval; 6]>; 3] =
            std::array::from_fn(|_| SmallVec::from_elem(Interval::ENTIRE, out.len()));
        for (f, d) in self.coordinates.iter().zip(&mut d) {
            f.enclose_piece(t, limit, d);
        }
        for (k, o) in out.iter_mut().enumerate() {
            *o = Box3 {
                x: d[0][k],
                y: d[1][k],
                z: d[2][k],
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::{Bound, Expr};
    use crate::laws;

    fn bound(text: &str) -> Bound {
        Expr::parse(text)
            .unwrap()
            .bind(&["t"], &[("a", 2.0)])
            .unwrap()
    }

    fn curve(x: &str, y: &str, z: &str, domain: [f64; 2]) -> ExpressionCurve {
        ExpressionCurve::new([bound(x), bound(y), bound(z)], domain).unwrap()
    }

    #[test]
    fn laws_hold_for_expressions() {
        laws::curve(&curve("a*cos(tau*t)", "a*sin(tau*t)", "t/3", [0.0, 1.0]));
        laws::curve(&curve("t", "exp(-t^2)", "ln(2+t)*tanh(t)", [-1.0, 2.0]));
        laws::curve(&curve(
            "abs(t-0.3)",
            "if(t<0.5, t, 1-t)",
            "max(t, t^2)",
            [0.0, 1.0],
        ));
        laws::curve(&curve(
            "1e6*t",
            "1e6+sqrt(1+t^2)",
            "1e6*atan2(t, 2)",
            [0.0, 3.0],
        ));
        laws::curve(&curve("1e-6*t", "1e-6*sinh(t)", "1e-6*t^2.5", [0.5, 1.0]));
    }

    /// Values, breaks, powers and inverse functions together, on 10⁵ random intervals.
    #[test]
    fn enclosures_hold_on_many_intervals() {
        let c = curve(
            "abs(t-0.3) + t^2.5",
            "atan2(t-0.5, 0.2)*asin(t/2)",
            "max(t^2, 0.25)/(1+t)",
            [0.1, 1.0],
        );
        laws::curve_with(&c, 100_000);
    }

    #[test]
    fn a_coordinate_without_value_is_named() {
        let e = ExpressionCurve::new([bound("t"), bound("1/(t-0.5)"), bound("0")], [0.0, 1.0])
            .unwrap_err();
        assert_eq!(
            e.to_string(),
            "y: division by zero at t = 0.5 in `1/(t-0.5)`"
        );
    }
}
