//! Smooth curves through points.

use super::error::finite_vector;
use super::{Curve, CurveError, Spacing};
use crate::basis::{BSplineBasis, Functions};
use crate::breaks::Limit;
use crate::exact::NurbsCurve;
use crate::linear::{Banded, solve_dense};
use glam::{DVec3, Vec4Swizzles};
use smallvec::SmallVec;

/// How a curve is laid through points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InterpolateOptions {
    /// 2 to 5; 3 by default, the cubic spline of continuous curvature.
    pub degree: usize,
    /// True if the curve returns to its first point smoothly. The first point may be repeated at the end.
    pub closed: bool,
    /// How the parameters are spread.
    pub spacing: Spacing,
    /// The derivative at the start (with the parameter running from 0 to 1). Without it a cubic has no curvature
    /// there ("natural"), other degrees have fewer knots.
    pub start_tangent: Option<DVec3>,
    /// The derivative at the end.
    pub end_tangent: Option<DVec3>,
}

impl Default for InterpolateOptions {
    fn default() -> Self {
        Self {
            degree: 3,
            closed: false,
            spacing: Spacing::default(),
            start_tangent: None,
            end_tangent: None,
        }
    }
}

/// The largest distance from a given point, relative to the size of all points, that is rounding. If the curve misses
/// one by more, the equations are too near to having no solution.
const MISSED: f64 = 1e-9;

/// The B-spline curve through points in their order, on `[0, 1]`, `degree - 1` times continuously differentiable.
///
/// Degree 3: the knots are the parameters of the points. Other degrees, open: averaged parameters. Even degrees,
/// closed: the middles between the parameters. Cost: O(points · degree²).
/// Sources: de Boor, *A Practical Guide to Splines*, chapters IV and XIII; Piegl and Tiller, *The NURBS Book*, §9.2.
///
/// Errors: a coordinate is not finite; too few points (2 for a cubic, degree + 1 without tangents for other degrees,
/// 3 for a closed curve); points that follow each other coincide; the degree is not 2 to 5; tangents of a closed
/// curve; points so unevenly spaced that the equations cannot be solved.
pub fn interpolate(
    points: &[DVec3],
    options: InterpolateOptions,
) -> Result<NurbsCurve, CurveError> {
    let points = given_once(points, options.closed);
    interpolate_at(points, options, |points| {
        options.spacing.parameters(points, options.closed)
    })
}

/// The same with the parameters that other points have: linear in the points and tangents, so it gives the velocity of an
/// interpolation whose parameters stay.
pub fn interpolate_like(
    like: &[DVec3],
    points: &[DVec3],
    options: InterpolateOptions,
) -> Result<NurbsCurve, CurveError> {
    let like = given_once(like, options.closed);
    let at = options.spacing.parameters(like, options.closed)?;
    let points = points.get(..like.len()).unwrap_or(points);
    interpolate_at(points, options, |_| Ok(at.clone()))
}

/// The points of a closed list without the first at its end.
pub(crate) fn given_once(points: &[DVec3], closed: bool) -> &[DVec3] {
    match points {
        [first, rest @ .., last] if closed && first == last && !rest.is_empty() => {
            &points[..points.len() - 1]
        }
        _ => points,
    }
}

fn interpolate_at(
    points: &[DVec3],
    options: InterpolateOptions,
    parameters: impl Fn(&[DVec3]) -> Result<Vec<f64>, CurveError>,
) -> Result<NurbsCurve, CurveError> {
    let InterpolateOptions {
        degree,
        closed,
        start_tangent,
        end_tangent,
        ..
    } = options;
    let (least, most) = (2, 5);
    if !(least..=most).contains(&degree) {
        return Err(CurveError::Degree {
            degree,
            least,
            most,
        });
    }
    let needed = if closed { 3 } else { 2 };
    if points.len() < needed {
        let given = points.len();
        return Err(CurveError::TooFewPoints { given, needed });
    }
    let at = parameters(points)?;
    // Coordinates from the middle of the points: nothing is lost far from the origin of space.
    let middle: DVec3 = points.iter().map(|p| *p / points.len() as f64).sum();
    let local: Vec<DVec3> = points.iter().map(|p| *p - middle).collect();
    let curve = if closed {
        if start_tangent.or(end_tangent).is_some() {
            return Err(CurveError::TangentOfClosed);
        }
        periodic(&local, &at, degree)
    } else {
        for (what, t) in [
            ("the tangent at the start", start_tangent),
            ("the tangent at the end", end_tangent),
        ] {
            finite_vector(what, t.unwrap_or(DVec3::ZERO))?;
        }
        open(&local, &at, degree, [start_tangent, end_tangent])?
    };
    let size = local.iter().map(|p| p.length()).fold(0.0, f64::max);
    let missed = |index: usize| match &curve {
        Some((c, _)) => c.point(at[index]).distance(local[index]),
        None => f64::INFINITY,
    };
    for index in 0..points.len() {
        let distance = missed(index);
        if distance.is_nan() || distance > MISSED * size {
            return Err(CurveError::IllConditioned { index, distance });
        }
    }
    let Some((curve, basis)) = curve else {
        return Err(CurveError::IllConditioned {
            index: 0,
            distance: f64::INFINITY,
        });
    };
    let mut h: Vec<_> = curve
        .homogeneous()
        .iter()
        .map(|p| (p.xyz() + middle).extend(1.0))
        .collect();
    // The end points are the given ones, exactly.
    let last = if closed { 0 } else { points.len() - 1 };
    let end = h.len() - 1;
    h[0] = points[0].extend(1.0);
    h[end] = points[last].extend(1.0);
    Ok(NurbsCurve::from_homogeneous(basis, h))
}

/// A curve and its basis; none if the equations have no solution.
type Solved = Option<(NurbsCurve, BSplineBasis)>;

/// What the curve must satisfy at a parameter: the value of a derivative.
struct Condition {
    at: f64,
    order: usize,
    value: DVec3,
}

fn open(
    points: &[DVec3],
    at: &[f64],
    p: usize,
    tangents: [Option<DVec3>; 2],
) -> Result<Solved, CurveError> {
    let last = points.len() - 1;
    let end = |at, tangent: Option<DVec3>| match tangent {
        Some(value) => Some(Condition {
            at,
            order: 1,
            value,
        }),
        None if p == 3 => Some(Condition {
            at,
            order: 2,
            value: DVec3::ZERO,
        }),
        None => None,
    };
    let mut conditions: Vec<Condition> = points
        .iter()
        .zip(at)
        .map(|(&value, &at)| Condition {
            at,
            order: 0,
            value,
        })
        .collect();
    // End conditions stand beside the end points, so that the matrix stays banded.
    if let Some(c) = end(1.0, tangents[1]) {
        conditions.insert(last, c);
    }
    if let Some(c) = end(0.0, tangents[0]) {
        conditions.insert(1, c);
    }
    let n = conditions.len();
    if n < p + 1 {
        let given = points.len();
        return Err(CurveError::TooFewPoints {
            given,
            needed: given + p + 1 - n,
        });
    }
    let mut knots = vec![0.0; p + 1];
    if p == 3 {
        knots.extend_from_slice(&at[1..last]);
    } else {
        let mean = |j: usize| {
            let sum: f64 = conditions[j..j + p].iter().map(|c| c.at).sum();
            sum / p as f64
        };
        knots.extend((1..n - p).map(mean));
    }
    knots.resize(n + p + 1, 1.0);
    let basis = BSplineBasis::new(p, knots).map_err(|e| CurveError::Nurbs(e.into()))?;
    let mut matrix = Banded::new(n, p);
    for (i, c) in conditions.iter().enumerate() {
        // Rows of derivatives are scaled to the size of the others.
        let scale = at[1].min(1.0 - at[last - 1]).powi(c.order as i32);
        for (j, value) in row(&basis, c.at, c.order) {
            if value != 0.0 {
                matrix.add(i, j, value * scale);
            }
        }
    }
    if !matrix.factor() {
        return Ok(None);
    }
    let mut x = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
    for (i, c) in conditions.iter().enumerate() {
        let scale = at[1].min(1.0 - at[last - 1]).powi(c.order as i32);
        (0..3).for_each(|k| x[k][i] = c.value[k] * scale);
    }
    x.iter_mut().for_each(|x| matrix.solve(x));
    let points = (0..n).map(|i| DVec3::new(x[0][i], x[1][i], x[2][i]).extend(1.0));
    let curve = NurbsCurve::from_homogeneous(basis.clone(), points.collect());
    Ok(Some((curve, basis)))
}

/// The active functions at a parameter with a derivative of each.
fn row(basis: &BSplineBasis, t: f64, order: usize) -> Vec<(usize, f64)> {
    let active = basis.active(t, Limit::Above);
    let n = active.len();
    let mut d: SmallVec<[f64; 18]> = SmallVec::from_elem(0.0, (order + 1) * n);
    basis.jet_into(t, Limit::Above, order, &mut d);
    active.zip(d[order * n..].iter().copied()).collect()
}

/// The closed curve: as many unknown points as given ones, used again from the first when all are used.
fn periodic(points: &[DVec3], at: &[f64], p: usize) -> Solved {
    let n = points.len();
    // Knots over a little more than a period on both sides; knot(p + j) is the one at or after the j-th parameter.
    let parameter = |j: isize| {
        let turns = j.div_euclid(n as isize);
        at[j.rem_euclid(n as isize) as usize] + turns as f64
    };
    let knot = |k: usize| {
        let j = k as isize - p as isize;
        if p % 2 == 1 {
            parameter(j)
        } else {
            0.5 * (parameter(j - 1) + parameter(j))
        }
    };
    // One span more than a period, so that [0, 1] lies inside also where no knot is at 0.
    let count = n + p + 1;
    let basis = BSplineBasis::new(p, (0..count + p + 1).map(knot).collect()).ok()?;
    // The unknown that weighs most in equation i stands on the diagonal.
    let unknown = |function: usize| (function + n - (p / 2) % n) % n;
    let rows: Vec<Vec<(usize, f64)>> = at[..n]
        .iter()
        .map(|&t| {
            let row = row(&basis, t, 0).into_iter();
            row.map(|(f, v)| (unknown(f % n), v)).collect()
        })
        .collect();
    let sides: Vec<Vec<f64>> = (0..3)
        .map(|k| points.iter().map(|p| p[k]).collect())
        .collect();
    let x = if n <= 3 * p {
        let mut a = vec![0.0; n * n];
        for (i, row) in rows.iter().enumerate() {
            row.iter().for_each(|&(j, v)| a[i * n + j] += v);
        }
        let mut x = sides;
        solve_dense(n, &mut a, &mut x).then_some(x)?
    } else {
        cyclic(&rows, &sides, p)?
    };
    let all = (0..count).map(|f| {
        let i = unknown(f % n);
        DVec3::new(x[0][i], x[1][i], x[2][i]).extend(1.0)
    });
    let whole = NurbsCurve::from_homogeneous(basis, all.collect());
    let part = whole.part(0.0, 1.0).ok()?;
    let basis = part.basis().clone();
    Some((part, basis))
}

/// Solves equations whose band runs on cyclically: the last `p` unknowns are eliminated from the banded rest.
pub(crate) fn cyclic(
    rows: &[Vec<(usize, f64)>],
    sides: &[Vec<f64>],
    p: usize,
) -> Option<Vec<Vec<f64>>> {
    let n = rows.len();
    let m = n - p;
    let mut matrix = Banded::new(m, p);
    // Columns of the last unknowns in the first m equations.
    let mut border = vec![vec![0.0; m]; p];
    for (i, row) in rows[..m].iter().enumerate() {
        for &(j, v) in row.iter().filter(|(_, v)| *v != 0.0) {
            if j < m {
                matrix.add(i, j, v);
            } else {
                border[j - m][i] += v;
            }
        }
    }
    if !matrix.factor() {
        return None;
    }
    border.iter_mut().for_each(|b| matrix.solve(b));
    let first: Vec<Vec<f64>> = sides
        .iter()
        .map(|s| {
            let mut x = s[..m].to_vec();
            matrix.solve(&mut x);
            x
        })
        .collect();
    // The last p equations in the last p unknowns alone.
    let mut a = vec![0.0; p * p];
    let mut last: Vec<Vec<f64>> = sides.iter().map(|s| s[m..].to_vec()).collect();
    for (i, row) in rows[m..].iter().enumerate() {
        for &(j, v) in row {
            if j >= m {
                a[i * p + j - m] += v;
                continue;
            }
            (0..p).for_each(|k| a[i * p + k] -= v * border[k][j]);
            last.iter_mut()
                .zip(&first)
                .for_each(|(l, f)| l[i] -= v * f[j]);
        }
    }
    if !solve_dense(p, &mut a, &mut last) {
        return None;
    }
    let whole = first.into_iter().zip(last).map(|(mut x, l)| {
        for (k, b) in border.iter().enumerate() {
            x.iter_mut().zip(b).for_each(|(x, b)| *x -= b * l[k]);
        }
        x.extend(l);
        x
    });
    Some(whole.collect())
}
