//! Cubic curves through points that move.

use crate::breaks::Limit;
use crate::curve::interpolate::{cyclic, given_once};
use crate::curve::{Curve, CurveError, InterpolateOptions, interpolate};
use crate::exact::NurbsCurve;
use crate::linear::{Banded, solve_dense};
use glam::DVec3;

/// The velocity of [`interpolate`] of degree 3, at fixed parameters: points, and tangents where they are given, move at rates,
/// and the parameters of the points move with the distances of these.
///
/// At the knots `tᵢ`, where the curve has the points `pᵢ` and the derivatives `mᵢ`, the velocity is `pᵢ' - tᵢ' mᵢ` and its
/// derivative `mᵢ' - tᵢ' cᵢ"`: in between it is the cubic with these. The curve has no jump in its second derivative, so the
/// velocity has none in its first. `mᵢ'` comes from the equations of `mᵢ`, differentiated. Source: de Boor, *A Practical
/// Guide to Splines*, chapter IV.
///
/// Errors: those of [`interpolate`]; another degree. Panics if there are fewer rates than points. Cost: O(points).
pub fn interpolation(
    points: &[DVec3],
    rates: &[DVec3],
    options: InterpolateOptions,
    tangents: [Option<DVec3>; 2],
) -> Result<NurbsCurve, CurveError> {
    let InterpolateOptions {
        degree,
        closed,
        spacing,
        ..
    } = options;
    if degree != 3 {
        let (least, most) = (3, 3);
        return Err(CurveError::Degree {
            degree,
            least,
            most,
        });
    }
    let curve = interpolate(points, options)?;
    let points = given_once(points, closed);
    let rates = rates.get(..points.len()).unwrap_or(rates);
    let at = spacing.parameters(points, closed)?;
    let moves = spacing.rates(points, rates, closed);
    let n = points.len();
    let pieces = at.len() - 1;
    // Widths and slopes of the pieces, with their rates.
    let width = |i: usize| [at[i + 1] - at[i], moves[i + 1] - moves[i]];
    let slope = |i: usize| {
        let [h, dh] = width(i);
        let [way, rate] = [points, rates].map(|p| p[(i + 1) % n] - p[i]);
        [way / h, (rate - way / h * dh) / h]
    };
    let jets: Vec<[DVec3; 3]> = (0..=pieces)
        .map(|i| {
            let side = if i == pieces {
                Limit::Below
            } else {
                Limit::Above
            };
            let mut jet = [DVec3::ZERO; 3];
            curve.jet_into(at[i], side, &mut jet);
            jet
        })
        .collect();
    // Where the second derivatives of the pieces before and after a knot agree:
    // `h m₋ + 2 (g + h) m + g m₊ = 3 (h s₋ + g s)`, with the widths g, h and the slopes s₋, s before and after.
    let inner = |i: usize| {
        let before = (i + pieces - 1) % pieces;
        let ([g, dg], [h, dh]) = (width(before), width(i));
        let ([s, ds], [t, dt]) = (slope(before), slope(i));
        let m = [before, i, i + 1].map(|k| jets[k][1]);
        let next = if closed { (i + 1) % n } else { i + 1 };
        let side = 3.0 * (dh * s + h * ds + dg * t + g * dt)
            - (dh * m[0] + 2.0 * (dg + dh) * m[1] + dg * m[2]);
        (vec![(before, h), (i, 2.0 * (g + h)), (next, g)], side)
    };
    let end = |i: usize, tangent: Option<DVec3>| match tangent {
        Some(rate) => (vec![(i, 1.0)], rate),
        None if i == 0 => (vec![(0, 2.0), (1, 1.0)], 3.0 * slope(0)[1]),
        None => (vec![(i - 1, 1.0), (i, 2.0)], 3.0 * slope(i - 1)[1]),
    };
    let equations = (0..n).map(|i| match i {
        _ if closed => inner(i),
        0 => end(0, tangents[0]),
        _ if i == pieces => end(i, tangents[1]),
        _ => inner(i),
    });
    let (rows, sides): (Vec<_>, Vec<DVec3>) = equations.unzip();
    let Some(turns) = solved(&rows, &sides, closed) else {
        return Err(CurveError::IllConditioned {
            index: 0,
            distance: f64::INFINITY,
        });
    };
    let (mut knots, mut net) = (vec![0.0; 4], Vec::with_capacity(2 * pieces + 2));
    for i in 0..=pieces {
        let [_, m, bend] = jets[i];
        let value = rates[i % n] - moves[i] * m;
        let along = turns[i % n] - moves[i] * bend;
        let (first, last) = (i == 0, i == pieces);
        net.push(if first {
            value
        } else {
            value - along * (width(i - 1)[0] / 3.0)
        });
        net.push(if last {
            value
        } else {
            value + along * (width(i)[0] / 3.0)
        });
        if !first && !last {
            knots.extend([at[i]; 2]);
        }
    }
    knots.extend([1.0; 4]);
    Ok(NurbsCurve::new(3, knots, &net, None)?)
}

/// The solution of equations whose rows have entries beside the diagonal, and in the corners of a closed curve's.
fn solved(rows: &[Vec<(usize, f64)>], sides: &[DVec3], closed: bool) -> Option<Vec<DVec3>> {
    let n = rows.len();
    let mut x: Vec<Vec<f64>> = (0..3)
        .map(|k| sides.iter().map(|s| s[k]).collect())
        .collect();
    if !closed {
        let mut matrix = Banded::new(n, 1);
        for (i, row) in rows.iter().enumerate() {
            row.iter().for_each(|&(j, v)| matrix.add(i, j, v));
        }
        if !matrix.factor() {
            return None;
        }
        x.iter_mut().for_each(|x| matrix.solve(x));
    } else if n <= 3 {
        let mut a = vec![0.0; n * n];
        for (i, row) in rows.iter().enumerate() {
            row.iter().for_each(|&(j, v)| a[i * n + j] += v);
        }
        if !solve_dense(n, &mut a, &mut x) {
            return None;
        }
    } else {
        x = cyclic(rows, &x, 1)?;
    }
    Some(
        (0..n)
            .map(|i| DVec3::new(x[0][i], x[1][i], x[2][i]))
            .collect(),
    )
}
