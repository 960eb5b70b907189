//! A surface whose side is replaced by another curve near it.
//!
//! Let the surface be `Σ_j N_j(c) R_j(t)`, t along the side and c across, in homogeneous coordinates, and `R_0 = (a, w)` its
//! side. With the curve `(p, q)` in its place, `R_j q` for all other j and `(p w, q w)` for `R_0` are the same surface but for
//! `N_0 (p w - a q)`, over a weight that is at least `N_0 w q` if all weights are positive. So no point moves farther than
//! one of the curve does, `|p/q - a/w|`, and of two opposite sides only the greater move counts.

use super::curve_tools::unify;
use super::piecewise::bernstein_product;
use super::spline::{Row, Spline, join};
use super::{NurbsCurve, NurbsSurface};
use crate::basis::BSplineBasis;
use crate::surface::Side;
use glam::{DVec4, Vec4Swizzles};

/// Rounding errors of a control point for each knot that is inserted, in units in the last place of the greatest
/// coordinate.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The clamped surface with a curve in the place of a side, run through in the same direction over its range of
/// parameters, and how far points move at most, at equal parameters. The degree along the side is that of both, or their
/// sum for a rational curve or surface, and its knots are those of both. `None` if that degree is more than what is possible, if a
/// weight is not positive, or if numbers are too large.
pub(super) fn with_side(
    surface: &NurbsSurface,
    side: Side,
    curve: &NurbsCurve,
) -> Option<(NurbsSurface, f64)> {
    let along = side.along();
    let own = surface.to_spline(along);
    let domain = own.domain();
    let line = curve.to_spline().on(domain.lo, domain.hi);
    let degree = own.degree.max(line.degree);
    let mut both = [own.elevated(degree), line.elevated(degree)];
    unify(&mut both);
    let edge = if side.is_upper() {
        both[0].rows[0].len() - 1
    } else {
        0
    };
    let w = both[0].rows[0][edge].w;
    let is_even = both[0].rows.iter().all(|r| r[edge].w == w);
    let [whole, line] = if is_even && !curve.is_rational() {
        let [whole, mut line] = both;
        let scale = w / line.rows[0][0].w;
        line.rows.iter_mut().for_each(|r| r[0] *= scale);
        [whole, line]
    } else {
        products(&both, edge)?
    };
    let positive = |r: &Row| r.iter().all(|p| p.w > 0.0);
    if !whole.rows.iter().chain(&line.rows).all(positive) {
        return None;
    }
    // A quotient of averages with positive weights is an average of the quotients.
    let (mut moved, mut largest) = (0.0f64, 0.0f64);
    for (r, l) in whole.rows.iter().zip(&line.rows) {
        moved = moved.max((r[edge].xyz() - l[0].xyz()).length() / l[0].w);
        for p in r.iter().chain(l) {
            largest = largest.max(p.xyz().abs().max_element() / p.w);
        }
    }
    let rounding = ROUNDING * whole.rows.len() as f64 * largest;
    let moved = (moved + rounding).next_up();
    let mut changed = whole;
    for (r, l) in changed.rows.iter_mut().zip(&line.rows) {
        r[edge] = l[0];
    }
    let changed = surface.with_spline(along, changed).ok()?;
    moved.is_finite().then_some((changed, moved))
}

/// A surface with the knots of a curve, times the curve's weight, and the curve times the weight of a line of the surface.
fn products([whole, line]: &[Spline; 2], edge: usize) -> Option<[Spline; 2]> {
    let degree = 2 * whole.degree;
    if degree > BSplineBasis::MAX_DEGREE {
        return None;
    }
    let ((breaks, pieces), (_, lines)) = (whole.pieces(), line.pieces());
    let coordinates = |points: &[DVec4], f: &[f64]| -> Vec<DVec4> {
        let of = |c: usize| {
            let own: Vec<f64> = points.iter().map(|p| p[c]).collect();
            bernstein_product(&own, f)
        };
        let [x, y, z, w] = [0, 1, 2, 3].map(of);
        (0..=degree)
            .map(|k| DVec4::new(x[k], y[k], z[k], w[k]))
            .collect()
    };
    let (mut out, mut on_line) = (Vec::new(), Vec::new());
    for (piece, line) in pieces.iter().zip(&lines) {
        let column = |j: usize| -> Vec<DVec4> { piece.iter().map(|r| r[j]).collect() };
        let own: Vec<DVec4> = line.iter().map(|r| r[0]).collect();
        let weight = |points: &[DVec4]| -> Vec<f64> { points.iter().map(|p| p.w).collect() };
        let columns: Vec<Vec<DVec4>> = (0..piece[0].len())
            .map(|j| coordinates(&column(j), &weight(&own)))
            .collect();
        let row = |k: usize| columns.iter().map(|c| c[k]).collect();
        out.push((0..=degree).map(row).collect());
        let own = coordinates(&own, &weight(&column(edge)));
        on_line.push(own.into_iter().map(|p| vec![p]).collect());
    }
    Some([join(&breaks, degree, &out), join(&breaks, degree, &on_line)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::breaks::Limit;
    use crate::curve::Curve;
    use crate::interval::Interval;
    use crate::laws::Random;
    use crate::surface::{Dir, Surface};
    use glam::DVec3;

    fn surface(random: &mut Random, far: DVec3) -> NurbsSurface {
        let points: Vec<DVec3> = (0..30)
            .map(|k| far + DVec3::new((k / 5) as f64, (k % 5) as f64, random.unit()))
            .collect();
        let knots = [
            vec![0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 4.0, 4.0, 4.0, 4.0],
            vec![-1.0, -1.0, -1.0, 0.0, 0.5, 1.0, 1.0, 1.0],
        ];
        NurbsSurface::new([3, 2], knots, &points, None).unwrap()
    }

    /// A curve near a side, with knots and a degree of its own.
    fn near(s: &NurbsSurface, side: Side, rational: bool, random: &mut Random) -> NurbsCurve {
        let Interval { lo, hi } = s.domain()[side.along() as usize];
        let at = |t: f64| match side {
            Side::South | Side::North => [t, s.domain()[1].lo + 2.0 * side.is_upper() as u8 as f64],
            _ => [4.0 * side.is_upper() as u8 as f64, t],
        };
        let inner = lo + 0.3 * (hi - lo);
        let mut knots = vec![lo; 5];
        knots.push(inner);
        knots.extend([hi; 5]);
        let count = knots.len() - 5;
        let points: Vec<DVec3> = (0..count)
            .map(|k| {
                let t = lo + (hi - lo) * k as f64 / (count - 1) as f64;
                s.point(at(t)) + DVec3::splat(0.1) * random.unit()
            })
            .collect();
        let weights: Vec<f64> = (0..count).map(|_| 0.5 + random.unit()).collect();
        NurbsCurve::new(4, knots, &points, rational.then_some(&weights[..])).unwrap()
    }

    /// The side becomes the curve within rounding, whatever was imposed before, no point moves farther than was promised,
    /// and the bound is not far above what is found.
    #[test]
    fn sides_become_the_curves() {
        let mut random = Random(11);
        for far in [DVec3::ZERO, DVec3::splat(1e5)] {
            for kinds in 0..16u8 {
                let s = surface(&mut random, far);
                let mut now = s.clone();
                let mut bounds = [0.0f64; 2];
                for side in Side::ALL {
                    let rational = kinds >> (side as u8) & 1 == 1;
                    let curve = near(&s, side, rational, &mut random);
                    let (next, moved) = with_side(&now, side, &curve).unwrap();
                    now = next;
                    let across = side.across() as usize;
                    bounds[across] = bounds[across].max(moved);
                    let domain = now.domain();
                    let at = [domain[across].lo, domain[across].hi][side.is_upper() as usize];
                    let limit = [Limit::Above, Limit::Below][side.is_upper() as usize];
                    let own = now.isocurve(side.along(), at, limit);
                    let range = domain[side.along() as usize];
                    for k in 0..=40 {
                        let t = range.lo + range.width() * k as f64 / 40.0;
                        let distance = own.point(t).distance(curve.point(t));
                        assert!(
                            distance <= 1e-13 * (6.0 + 4.0 * far.x),
                            "{side} {distance:e}"
                        );
                    }
                }
                let (most, mut found) = (bounds[0] + bounds[1], 0.0f64);
                let [u, v] = s.domain();
                for i in 0..=20 {
                    for j in 0..=20 {
                        let uv = [
                            u.lo + u.width() * i as f64 / 20.0,
                            v.lo + v.width() * j as f64 / 20.0,
                        ];
                        found = found.max(s.point(uv).distance(now.point(uv)));
                    }
                }
                assert!(found <= most && found > 0.02 * most, "{found} {most}");
            }
        }
    }

    #[test]
    fn its_own_side_moves_nothing() {
        let s = surface(&mut Random(3), DVec3::ZERO);
        let south = s.isocurve(Dir::U, -1.0, Limit::Above);
        let (same, moved) = with_side(&s, Side::South, &south).unwrap();
        assert!(moved < 1e-12);
        assert_eq!(same.size(), s.size());
    }
}
