//! B-spline curves and surfaces in all their spellings.

use super::file::{Args, Got, Record, Refused};
use super::place::Space;
use glam::DVec3;
use nappe::basis::BSplineBasis;
use nappe::{NurbsCurve, NurbsSurface};

/// The keyword and the knots' kind of a simple entity, or of the parts of a complex one.
fn spelling<'r>(
    record: &'r Record<'_>,
    names: [&'static str; 5],
) -> (Option<Args<'r, 'r>>, usize, &'static str) {
    let [base, knots, ..] = names;
    if let Some(args) = record.part(base) {
        let kind = names.into_iter().skip(1).find(|n| record.part(n).is_some());
        return (Some(args), 0, kind.unwrap_or(base));
    }
    let kind = names.into_iter().skip(1).find(|n| record.kind() == *n);
    // After the name.
    (kind.map(|_| record.args()), 1, kind.unwrap_or(knots))
}

const CURVES: [&str; 5] = [
    "B_SPLINE_CURVE",
    "B_SPLINE_CURVE_WITH_KNOTS",
    "QUASI_UNIFORM_CURVE",
    "UNIFORM_CURVE",
    "BEZIER_CURVE",
];
const SURFACES: [&str; 5] = [
    "B_SPLINE_SURFACE",
    "B_SPLINE_SURFACE_WITH_KNOTS",
    "QUASI_UNIFORM_SURFACE",
    "UNIFORM_SURFACE",
    "BEZIER_SURFACE",
];

/// Whether a record is a B-spline curve.
pub(super) fn is_curve(record: &Record<'_>) -> bool {
    spelling(record, CURVES).0.is_some()
}

/// Whether a record is a B-spline surface.
pub(super) fn is_surface(record: &Record<'_>) -> bool {
    spelling(record, SURFACES).0.is_some()
}

/// A B-spline curve.
pub(super) fn curve(space: &Space<'_>, record: &Record<'_>) -> Got<NurbsCurve> {
    let (args, first, kind) = spelling(record, CURVES);
    let args = args.ok_or_else(|| record.refused("it is no B-spline curve"))?;
    let degree = degree(&args, first)?;
    let points = points(space, &args.references(first + 1)?)?;
    let knots = if kind == CURVES[1] {
        let (args, at) = if first == 0 {
            (record.needed(kind)?, 0)
        } else {
            (args, 6)
        };
        expanded(
            record,
            &args.counts(at)?,
            &args.reals(at + 1)?,
            points.len() + degree + 1,
        )?
    } else {
        regular(record, kind, degree, points.len())?
    };
    let weights = match record.part("RATIONAL_B_SPLINE_CURVE") {
        Some(args) => Some(args.reals(0)?),
        None => None,
    };
    NurbsCurve::new(degree, knots, &points, weights.as_deref())
        .map_err(|e| record.refused(e.to_string()))
}

/// A B-spline surface.
pub(super) fn surface(space: &Space<'_>, record: &Record<'_>) -> Got<NurbsSurface> {
    let (args, first, kind) = spelling(record, SURFACES);
    let args = args.ok_or_else(|| record.refused("it is no B-spline surface"))?;
    let degree = [degree(&args, first)?, degree(&args, first + 1)?];
    let rows = args.list(first + 2)?;
    let (mut net, mut columns) = (Vec::new(), 0);
    for i in 0..rows.values.len() {
        let row = rows.references(i)?;
        if i > 0 && row.len() != columns {
            return Err(record.refused("its rows of points are not of one length"));
        }
        columns = row.len();
        net.reserve(columns);
        for id in row {
            net.push(space.point(id)?);
        }
    }
    let counts = [rows.values.len(), columns];
    let mut knots = [Vec::new(), Vec::new()];
    for (d, knots) in knots.iter_mut().enumerate() {
        *knots = if kind == SURFACES[1] {
            let (args, at) = if first == 0 {
                (record.needed(kind)?, 0)
            } else {
                (args, 8)
            };
            let needed = counts[d] + degree[d] + 1;
            expanded(
                record,
                &args.counts(at + d)?,
                &args.reals(at + 2 + d)?,
                needed,
            )?
        } else {
            regular(record, kind, degree[d], counts[d])?
        };
    }
    let weights = match record.part("RATIONAL_B_SPLINE_SURFACE") {
        Some(args) => {
            let rows = args.list(0)?;
            let mut weights = Vec::with_capacity(net.len());
            for i in 0..rows.values.len() {
                weights.extend(rows.reals(i)?);
            }
            Some(weights)
        }
        None => None,
    };
    NurbsSurface::new(degree, knots, &net, weights.as_deref())
        .map_err(|e| record.refused(e.to_string()))
}

/// A degree that is computed with: as many knots as it asks for are made.
fn degree(args: &Args<'_, '_>, i: usize) -> Got<usize> {
    let degree = args.count(i)?;
    if degree > BSplineBasis::MAX_DEGREE {
        let most = BSplineBasis::MAX_DEGREE;
        return Err(args.refused(format!("its degree is {degree}; up to {most} are read")));
    }
    Ok(degree)
}

fn points(space: &Space<'_>, ids: &[u64]) -> Got<Vec<DVec3>> {
    ids.iter().map(|id| space.point(*id)).collect()
}

/// The full list of knots from distinct ones and how often each occurs.
fn expanded(
    record: &Record<'_>,
    times: &[usize],
    knots: &[f64],
    needed: usize,
) -> Result<Vec<f64>, Refused> {
    let total = times.iter().try_fold(0usize, |sum, n| sum.checked_add(*n));
    if times.len() != knots.len() || total != Some(needed) {
        return Err(record.refused(format!(
            "it has {} knots with {} multiplicities, {} in all; {needed} are needed",
            knots.len(),
            times.len(),
            total.map_or("too many".into(), |n| n.to_string())
        )));
    }
    let repeated = knots.iter().zip(times);
    Ok(repeated
        .flat_map(|(k, n)| std::iter::repeat_n(*k, *n))
        .collect())
}

/// The knots that a kind without stated knots has.
fn regular(
    record: &Record<'_>,
    kind: &str,
    degree: usize,
    points: usize,
) -> Result<Vec<f64>, Refused> {
    if degree == 0 || points <= degree {
        return Err(record.refused(format!("{points} points are too few for degree {degree}")));
    }
    let number = |i: usize| i as f64;
    if kind.starts_with("UNIFORM") {
        return Ok((0..points + degree + 1)
            .map(|i| number(i) - number(degree))
            .collect());
    }
    let bezier = kind.starts_with("BEZIER");
    let (spans, times) = if bezier {
        ((points - 1) / degree, degree)
    } else {
        (points - degree, 1)
    };
    if bezier && spans * degree + 1 != points {
        return Err(record.refused(format!(
            "{points} points are no chain of Bézier pieces of degree {degree}"
        )));
    }
    let inner = (1..spans).flat_map(|i| std::iter::repeat_n(number(i), times));
    let mut knots = vec![0.0; degree + 1];
    knots.extend(inner);
    knots.extend(std::iter::repeat_n(number(spans), degree + 1));
    Ok(knots)
}
