//! Arcs of conics in the plane as rational quadratic B-splines: the round directions of quadrics, tori and surfaces of
//! revolution.

use crate::basis::BSplineBasis;
use crate::frame::cos_sin;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// The widest single arc: a quarter turn. Wider arcs have smaller middle weights and a less even parameter.
const WIDEST_ARC: f64 = FRAC_PI_2;
/// The widest single hyperbolic arc, in the hyperbolic angle; beyond, the parameter is very uneven.
const WIDEST_HYPERBOLIC_ARC: f64 = 2.0;
/// Relative excess over a whole number of arcs that is taken as rounding.
const WHOLE: f64 = 1e-12;

/// Conic arcs joined end to end on `[0, 1]`, all over equal parameter ranges: homogeneous points `(w x, w y, w)` over
/// a quadratic B-spline basis with double inner knots. End weights are 1.
///
/// Source: Golovanov, *Geometric modelling*, §3.9 (weight `cos(α/2)`); Grigoriev 2007, §1 (weight `√μ`).
#[derive(Clone, Debug)]
pub struct ConicArcs {
    /// The basis.
    pub basis: BSplineBasis,
    /// `(w x, w y, w)`, one for each basis function.
    pub points: Vec<DVec3>,
}

impl ConicArcs {
    /// The unit circle from one angle to another (radians, counter-clockwise if increasing), in equal arcs of at most
    /// a quarter turn, each with middle weight `cos` of its half angle. A whole turn ends exactly where it begins.
    pub fn circle(from: f64, to: f64) -> Self {
        let sweep = to - from;
        let n = count(sweep, WIDEST_ARC);
        let half = sweep / (2 * n) as f64;
        let w = cos_sin(half).0;
        let mut points: Vec<_> = (0..=2 * n)
            .map(|i| {
                let (c, s) = cos_sin(if i == 2 * n {
                    to
                } else {
                    from + half * i as f64
                });
                DVec3::new(c, s, if i % 2 == 1 { w } else { 1.0 })
            })
            .collect();
        if (sweep.abs() - TAU).abs() <= WHOLE * TAU {
            points[2 * n] = points[0];
        }
        Self::joined(points)
    }

    /// The branch `(cosh t, sinh t)` of the unit hyperbola between two hyperbolic angles given by their sinh.
    pub fn hyperbola(from: f64, to: f64) -> Self {
        let (a, b) = (from.asinh(), to.asinh());
        let n = count(b - a, WIDEST_HYPERBOLIC_ARC);
        let half = (b - a) / (2 * n) as f64;
        let points = (0..=2 * n)
            .map(|i| {
                // The ends are exact in the coordinate the caller gave.
                let s = match i {
                    0 => from,
                    _ if i == 2 * n => to,
                    _ => (a + half * i as f64).sinh(),
                };
                let w = if i % 2 == 1 { half.cosh() } else { 1.0 };
                DVec3::new((1.0 + s * s).sqrt(), s, w)
            })
            .collect();
        Self::joined(points)
    }

    /// Quarters of Grigoriev's section: arcs from (1, 0) to (0, 1) with middle point (1, 1) and weight `√μ`, each
    /// following quarter turned by a right angle. On the first, `(x + y - 1)² = 4 μ (1 - x)(1 - y)`.
    pub fn grigoriev(mu: f64, quarters: usize) -> Self {
        let w = mu.sqrt();
        let points = (0..=2 * quarters)
            .map(|i| {
                let (c, s) = cos_sin((i / 2) as f64 * FRAC_PI_2);
                if i % 2 == 0 {
                    DVec3::new(c, s, 1.0)
                } else {
                    DVec3::new(w * (c - s), w * (s + c), w)
                }
            })
            .collect();
        Self::joined(points)
    }

    fn joined(points: Vec<DVec3>) -> Self {
        let n = (points.len() - 1) / 2;
        let mut knots = vec![0.0; 3];
        for i in 1..n {
            knots.extend([i as f64 / n as f64; 2]);
        }
        knots.extend([1.0; 3]);
        Self {
            basis: BSplineBasis::new(2, knots).expect("equal spans with double inner knots"),
            points,
        }
    }
}

fn count(sweep: f64, widest: f64) -> usize {
    ((sweep.abs() / widest - WHOLE).ceil() as usize).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::Functions;
    use crate::breaks::Limit;

    fn sample(arcs: &ConicArcs, t: f64) -> [f64; 2] {
        let range = arcs.basis.active(t, Limit::Above);
        let mut b = [0.0; 3];
        arcs.basis.jet_into(t, Limit::Above, 0, &mut b);
        let h: DVec3 = range.zip(b).map(|(i, f)| arcs.points[i] * f).sum();
        [h.x / h.z, h.y / h.z]
    }

    #[test]
    fn arcs_lie_on_their_conics() {
        for (from, to) in [(0.0, TAU), (0.3, 4.0), (1.0, -2.5), (-0.1, 1e-3)] {
            let arcs = ConicArcs::circle(from, to);
            for i in 0..=100 {
                let [x, y] = sample(&arcs, i as f64 / 100.0);
                assert!((x * x + y * y - 1.0).abs() < 1e-15 * 4.0);
            }
            let [x, y] = sample(&arcs, 1.0);
            assert!((x - to.cos()).abs() + (y - to.sin()).abs() < 1e-15 * 4.0);
        }
        let arcs = ConicArcs::hyperbola(-3.0, 40.0);
        for i in 0..=100 {
            let [x, y] = sample(&arcs, i as f64 / 100.0);
            assert!((x * x - y * y - 1.0).abs() < 1e-14 * x * x);
        }
    }

    #[test]
    fn grigorievs_sections_satisfy_their_equation() {
        for mu in [0.01, 0.5, 0.9, 1.0, 4.0, 100.0] {
            let arcs = ConicArcs::grigoriev(mu, 1);
            for i in 0..=50 {
                let [x, y] = sample(&arcs, i as f64 / 50.0);
                let (l, r) = ((x + y - 1.0).powi(2), 4.0 * mu * (1.0 - x) * (1.0 - y));
                assert!((l - r).abs() < 1e-14 * mu.max(1.0), "{mu}: {l} {r}");
            }
            let closed = ConicArcs::grigoriev(mu, 4);
            assert_eq!(closed.points[0], closed.points[8]);
            let ([x, y], [a, b]) = (sample(&closed, 0.0625), sample(&closed, 0.3125));
            assert!((a + y).abs() < 1e-15 && (b - x).abs() < 1e-15);
        }
    }
}
