//! Splines with fewer knots or a lower degree, within a proven distance.
//!
//! The smaller spline interpolates the given one at the averages of its knots (Greville's abscissae), which gives back what
//! already lies in the smaller space, and ends exactly where it ended. Then both are written as Bézier pieces of a
//! common degree, where each is an average of its control points: no point of the surface moves farther than a control
//! point does. Which knots may go is guessed from what removing each alone would move, and halved until the bound
//! holds. Source: Lyche and Mørken, *Knot removal for parametric B-spline curves and surfaces* (1987); here with
//! interpolation instead of least squares, and with the bound for rational splines.

use super::nurbs_curve::middle;
use super::spline::{Row, Spline, elevate};
use super::{ApproximationError, Converted, NurbsCurve, NurbsSurface};
use crate::basis::{BSplineBasis, Functions};
use crate::breaks::{Break, Limit};
use crate::linear::Banded;
use crate::mesh::Certainty;
use crate::surface::Dir;
use glam::{DVec4, Vec4Swizzles};

impl NurbsCurve {
    /// The curve with as few inner knots as are found to stay within `tol` at equal parameters. Its ends do not move, and
    /// its creases (knots of full multiplicity) stay.
    /// Without a removable knot it is the same curve, clamped, with the bound 0.
    ///
    /// Errors: `tol` is not a positive, finite length. Cost: some dozen banded systems.
    pub fn with_fewer_knots(&self, tol: f64) -> Result<Converted<Self>, ApproximationError> {
        check(tol)?;
        let (s, error) = fewer_knots(self.to_spline().clamped(), tol);
        Ok(Converted {
            nurbs: Self::from_spline(s)?,
            certainty: certainty(error),
            same_parameters: true,
        })
    }

    /// A curve of a lower degree near this one, with the same ends and the same creases, and how far it is at equal
    /// parameters. A curve that was elevated from this degree comes back within rounding. Knots are kept, so that a
    /// bound which is too large can be lowered by inserting knots first.
    ///
    /// Errors: `degree` is 0 or higher than the curve's; no positive weights would do.
    pub fn with_lower_degree(&self, degree: usize) -> Result<Converted<Self>, ApproximationError> {
        let (s, error) = lower_degree(self.to_spline().clamped(), degree)?;
        Ok(Converted {
            nurbs: Self::from_spline(s)?,
            certainty: certainty(error),
            same_parameters: true,
        })
    }
}

impl NurbsSurface {
    /// The surface with as few inner knots in both directions as are found to stay within `tol` at equal parameters. Its
    /// corners do not move, its creases stay, and a side that is one point stays one. A knot goes for a whole line of the net: surfaces
    /// that share a side keep a common side only if they keep common knots along it.
    ///
    /// Errors: `tol` is not a positive, finite length.
    pub fn with_fewer_knots(&self, tol: f64) -> Result<Converted<Self>, ApproximationError> {
        check(tol)?;
        // The first direction takes its half; the second what is left.
        self.in_both_directions(|dir, spline, error| {
            let share = if dir == Dir::U { 0.5 } else { 1.0 };
            Ok(fewer_knots(spline, share * tol - error))
        })
    }

    /// A surface of lower degrees near this one: see [`NurbsCurve::with_lower_degree`].
    pub fn with_lower_degrees(
        &self,
        degrees: [usize; 2],
    ) -> Result<Converted<Self>, ApproximationError> {
        self.in_both_directions(|dir, spline, _| lower_degree(spline, degrees[dir as usize]))
    }

    /// Reduces the surface along u and then along v, each time from its spline, clamped, and the error so far to another
    /// spline and its error.
    fn in_both_directions(
        &self,
        reduced: impl Fn(Dir, Spline, f64) -> Result<(Spline, f64), ApproximationError>,
    ) -> Result<Converted<Self>, ApproximationError> {
        let mut out = self.clone();
        let mut error = 0.0;
        for dir in [Dir::U, Dir::V] {
            let (spline, e) = reduced(dir, out.to_spline(dir).clamped(), error)?;
            out = out.with_spline(dir, spline)?;
            error = sum(error, e);
        }
        Ok(Converted {
            nurbs: out,
            certainty: certainty(error),
            same_parameters: true,
        })
    }
}

fn check(tol: f64) -> Result<(), ApproximationError> {
    if tol.is_finite() && tol > 0.0 {
        Ok(())
    } else {
        Err(ApproximationError::Tolerance { tol })
    }
}

/// Bounds that add up; without a change on one side without rounding.
fn sum(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 {
        a + b
    } else {
        (a + b).next_up()
    }
}

fn certainty(error: f64) -> Certainty {
    if error == 0.0 {
        Certainty::Exact
    } else {
        Certainty::Bounded(error)
    }
}

/// Removals are tried anew for the result until nothing more goes, at most so often.
const ROUNDS: usize = 8;

/// The clamped spline with fewer knots, and how far it is.
fn fewer_knots(s: Spline, tol: f64) -> (Spline, f64) {
    let mut best: Option<(Spline, f64)> = None;
    for _ in 0..ROUNDS {
        let now = best.as_ref().map_or(&s, |b| &b.0);
        let order = dispensable(now, tol);
        let found = remove_most(&s, &now.knots, now.degree, &order, tol);
        match found {
            Some(found) => best = Some(found),
            None => break,
        }
    }
    best.unwrap_or((s, 0.0))
}

/// The most of the knots, in their order, without which the spline can be had within `tol`: by bisection, as if more
/// knots always meant less error.
fn remove_most(
    s: &Spline,
    knots: &[f64],
    degree: usize,
    order: &[f64],
    tol: f64,
) -> Option<(Spline, f64)> {
    let attempt = |n: usize| {
        let mut kept = knots.to_vec();
        for t in &order[..n] {
            let i = kept.iter().position(|k| k == t)?;
            kept.remove(i);
        }
        let fit = fitted(s, degree, kept)?;
        let error = deviation(s, &fit);
        (error <= tol).then_some((fit, error))
    };
    let mut best = None;
    let (mut enough, mut most) = (0, order.len());
    while enough < most {
        let n = (enough + most).div_ceil(2);
        match attempt(n) {
            Some(found) => {
                best = Some(found);
                enough = n;
            }
            None => most = n - 1,
        }
    }
    best
}

/// Of the size of a spline: a knot of full multiplicity whose removal moves it by more is a crease and stays, whatever the
/// tolerance. Smaller, and rounding would be a crease.
const CREASE: f64 = 1e-11;

/// The inner knots that alone could go, the least needed first; of those that matter little next to `tol`, far ones before
/// neighbours.
fn dispensable(s: &Spline, tol: f64) -> Vec<f64> {
    // Measured from the middle of the points, homogeneous data is small.
    let mut s = s.clone();
    let o = middle(&s.rows.concat());
    for p in s.rows.iter_mut().flatten() {
        *p = (p.xyz() - o * p.w).extend(p.w);
    }
    let inner = s.breaks();
    let start = &s.rows[0];
    let from_start = s.rows.iter().flat_map(|r| r.iter().zip(start));
    let size = from_start.fold(0.0, |m: f64, (p, q)| m.max(p.distance(*q)));
    let mut ranked = Vec::new();
    for (i, b) in inner[1..inner.len() - 1].iter().enumerate() {
        let mut rest = s.near(b.at);
        let mut needed = 0.0f64;
        for _ in 0..s.multiplicity(b.at) {
            let Some((without, moved)) = rest.removed(b.at) else {
                break;
            };
            needed = needed.max(moved);
            let crease = rest.multiplicity(b.at) == s.degree && needed > CREASE * size;
            if crease || !needed.is_finite() {
                break;
            }
            // Powers of four; what is below a thousandth is all the same. What is too much alone comes last, and may still
            // go: the points in between can take it up.
            let rank = (needed / tol).max(1e-3).log2() * 0.5;
            ranked.push((rank.floor() as i64, i.reverse_bits(), b.at));
            rest = without;
        }
    }
    ranked.sort_by_key(|r| (r.0, std::cmp::Reverse(r.1)));
    ranked.into_iter().map(|r| r.2).collect()
}

/// The clamped spline in a lower degree, and how far it is.
fn lower_degree(s: Spline, degree: usize) -> Result<(Spline, f64), ApproximationError> {
    let p = s.degree;
    if degree == 0 || degree > p {
        return Err(ApproximationError::Degree { own: p, degree });
    }
    if degree == p {
        return Ok((s, 0.0));
    }
    let breaks = s.breaks();
    let (lo, hi) = (breaks[0].at, breaks[breaks.len() - 1].at);
    let mut knots = vec![lo; degree + 1];
    for b in &breaks[1..breaks.len() - 1] {
        let multiplicity = (s.multiplicity(b.at) + degree).saturating_sub(p).max(1);
        knots.extend(std::iter::repeat_n(b.at, multiplicity));
    }
    knots.extend(std::iter::repeat_n(hi, degree + 1));
    let fit = fitted(&s, degree, knots).ok_or(ApproximationError::Weights)?;
    let error = deviation(&s, &fit);
    if error.is_finite() {
        Ok((fit, error))
    } else {
        Err(ApproximationError::Weights)
    }
}

/// Relative to its largest coordinate: points of a net line that differ by no more are one point, multiplied with its
/// weights and divided by them.
const SAME_POINT: f64 = 2.0 * f64::EPSILON;

/// The spline over clamped knots that interpolates another at the averages of `degree` knots.
fn fitted(s: &Spline, degree: usize, knots: Vec<f64>) -> Option<Spline> {
    let basis = BSplineBasis::new(degree, knots.clone()).ok()?;
    let own = BSplineBasis::new(s.degree, s.knots.clone()).ok()?;
    let n = basis.count();
    let width = s.rows[0].len();
    let mut matrix = Banded::new(n, degree);
    let mut sides = vec![vec![0.0; n]; 4 * width];
    for i in 0..n {
        // An average of equal knots is that knot, without rounding.
        let (a, b) = (knots[i + 1], knots[i + degree]);
        let mean = knots[i + 1..=i + degree].iter().sum::<f64>() / degree as f64;
        let t = mean.clamp(a, b);
        let limit = if i + 1 == n {
            Limit::Below
        } else {
            Limit::Above
        };
        let mut values = vec![0.0; degree + 1];
        for (j, value) in basis.active_jet(t, limit, 0, &mut values).zip(&values) {
            if i.abs_diff(j) <= degree {
                matrix.add(i, j, *value);
            }
        }
        let mut values = vec![0.0; s.degree + 1];
        for (j, value) in own.active_jet(t, limit, 0, &mut values).zip(&values) {
            for (k, p) in s.rows[j].iter().enumerate() {
                for (c, x) in p.to_array().into_iter().enumerate() {
                    sides[4 * k + c][i] += value * x;
                }
            }
        }
    }
    if !matrix.factor() {
        return None;
    }
    for (k, side) in sides.iter_mut().enumerate() {
        let same = s.rows.iter().all(|r| r[k / 4] == s.rows[0][k / 4]);
        if same {
            // A net line that is one point, or weights that are all one.
            side.fill(s.rows[0][k / 4].to_array()[k % 4]);
        } else {
            matrix.solve(side);
        }
        if s.rows.iter().all(|r| r[k / 4].w == s.rows[0][k / 4].w) && k % 4 == 3 {
            side.fill(s.rows[0][k / 4].w);
        }
    }
    for k in 0..width {
        let point = |r: &Row| r[k].xyz() / r[k].w;
        let first = point(&s.rows[0]);
        let near = SAME_POINT * first.abs().max_element();
        if s.rows
            .iter()
            .all(|r| (point(r) - first).abs().max_element() <= near)
        {
            // A net line that is one point, with weights that differ.
            for i in 0..n {
                let w = sides[4 * k + 3][i];
                for (c, x) in first.to_array().into_iter().enumerate() {
                    sides[4 * k + c][i] = x * w;
                }
            }
        }
    }
    let row = |i: usize| -> Row {
        let point = |k: usize| DVec4::from_array([0, 1, 2, 3].map(|c| sides[4 * k + c][i]));
        (0..width).map(point).collect()
    };
    let mut rows: Vec<Row> = (0..n).map(row).collect();
    // The ends are interpolated: without the rounding of the solution.
    rows[0].clone_from(&s.rows[0]);
    rows[n - 1].clone_from(&s.rows[s.rows.len() - 1]);
    let valid = |p: &DVec4| p.is_finite() && p.w > 0.0;
    rows.iter().flatten().all(valid).then_some(Spline {
        degree,
        knots,
        rows,
    })
}

/// Rounding errors of points that were averaged `n` times, in units in the last place of the largest.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The Bézier points of all pieces between breaks, in a degree that is not lower. Each is an average of control points.
fn bezier(s: &Spline, breaks: &[Break], degree: usize) -> Vec<DVec4> {
    let mut s = s.clone();
    for b in &breaks[1..breaks.len() - 1] {
        s.raise(b.at, s.degree);
    }
    let mut points = Vec::new();
    for mut piece in s.pieces().1 {
        for p in s.degree..degree {
            piece = elevate(&piece, p);
        }
        points.extend(piece.into_iter().flatten());
    }
    points
}

/// How far two clamped splines over one domain are apart at equal parameters, at most; the knots of the other are among
/// those of the first. Infinite if a weight is not positive.
///
/// About a point o: `r - r' = (ΔA - (r' - o) Δw) / w` with the homogeneous coordinates A = w (r - o). All three are averages of
/// those of the control points.
fn deviation(s: &Spline, other: &Spline) -> f64 {
    let degree = s.degree.max(other.degree);
    let count = s.rows.len() + degree * (degree + 2);
    let breaks = s.breaks();
    let [points, others] = [s, other].map(|s| bezier(s, &breaks, degree));
    if points.len() != others.len() {
        return f64::INFINITY;
    }
    let o = middle(&points);
    let least = points
        .iter()
        .chain(&others)
        .fold(f64::INFINITY, |m, p| m.min(p.w));
    if least.is_nan() || least <= 0.0 {
        return f64::INFINITY;
    }
    let reach = others
        .iter()
        .fold(0.0, |m: f64, p| m.max((p.xyz() / p.w - o).length()));
    let mut most = 0.0f64;
    let mut size = 0.0f64;
    for (p, q) in points.iter().zip(&others) {
        let d = *p - *q;
        let moved = (d.xyz() - o * d.w).length() + reach * d.w.abs();
        if moved.is_nan() {
            return f64::INFINITY;
        }
        most = most.max(moved / least);
        size = size.max((p.xyz().length() + o.length() * p.w + reach * p.w) / least);
    }
    (most + ROUNDING * count as f64 * size).next_up()
}
