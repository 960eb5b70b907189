//! Curves of a BREP file.

use super::super::Fault;
use super::super::words::Words;
use crate::step::Course;
use glam::DVec3;
use nappe::{CurveRef, Frame, NurbsCurve};
use std::sync::Arc;

/// Trimmed curves of trimmed curves.
const DEEPEST: usize = 32;
/// Parameters this near, relative to their range, are the same: files have 15 digits.
const SAME_PARAMETER: f64 = 1e-9;
/// A curve's numbers stand for more, but no file of a curve has so high a degree.
const HIGHEST_DEGREE: usize = 64;

/// A curve, and what its parameter is multiplied with to have that of [`Course`].
#[derive(Clone, Debug)]
pub(super) struct Stated {
    course: Course,
    rate: f64,
    /// Where it is trimmed, in its own parameter.
    range: Option<[f64; 2]>,
}

impl Stated {
    /// The part between two parameters.
    pub(super) fn part(&self, [from, to]: [f64; 2]) -> Result<CurveRef, String> {
        let limits = match (&self.course, self.range) {
            (Course::Bounded(c), None) => Some([c.domain().lo, c.domain().hi]),
            (_, range) => range,
        };
        if let Some([lo, hi]) = limits {
            let slack = SAME_PARAMETER * (hi - lo).abs();
            if from < lo - slack || to > hi + slack {
                return Err(format!(
                    "it goes from {from} to {to} on a curve that goes from {lo} to {hi}"
                ));
            }
        }
        if from >= to {
            return Err(format!(
                "it goes from {from} to {to}, which is no part of a curve"
            ));
        }
        self.course.between([from * self.rate, to * self.rate])
    }
}

/// Reads the next curve; the inner error is why it cannot be taken over.
pub(super) fn stated(words: &mut Words<'_>, depth: usize) -> Result<Result<Stated, String>, Fault> {
    if depth > DEEPEST {
        return Err(words.fault(format!("a curve trimmed more than {DEEPEST} times")));
    }
    let kind = words.whole("the kind of a curve")?;
    let course = match kind {
        1 => {
            let [point, vector] = [words.point("a coordinate")?, words.point("a direction")?];
            if vector.length() > 0.0 {
                Ok(Course::Line { point, vector })
            } else {
                Err("a line without a direction".into())
            }
        }
        2..=5 => return conic(words, kind),
        6 | 7 => spline(words, kind == 7)?.map(|c| Course::Bounded(Arc::new(c))),
        8 => {
            let range = words.reals("a parameter")?;
            let basis = stated(words, depth + 1)?;
            return Ok(basis.map(|basis| Stated {
                range: Some(range),
                ..basis
            }));
        }
        9 => {
            words.real("a distance")?;
            words.point("a direction")?;
            // What it is an offset of follows, and has to be passed over.
            let basis = stated(words, depth + 1)?;
            Err(basis
                .err()
                .unwrap_or_else(|| "offset curves are not read".into()))
        }
        _ => return Err(words.fault(format!("a curve of the unknown kind {kind}"))),
    };
    Ok(course.map(|course| Stated {
        course,
        rate: 1.0,
        range: None,
    }))
}

/// Circle, ellipse, parabola, hyperbola: centre or vertex, normal, x and y, and one or two lengths.
fn conic(words: &mut Words<'_>, kind: usize) -> Result<Result<Stated, String>, Fault> {
    let origin = words.point("a coordinate")?;
    let [z, x, _y] = [0; 3].map(|_| words.point("a direction"));
    let (z, x): (DVec3, DVec3) = (z?, x?);
    let a = words.real("a radius")?;
    let b = if matches!(kind, 3 | 5) {
        words.real("a radius")?
    } else {
        a
    };
    if !(a > 0.0 && b > 0.0) {
        return Ok(Err(format!("a conic with the radii {a} and {b}")));
    }
    let frame = match Frame::new(origin, z, x) {
        Ok(frame) => frame,
        Err(e) => return Ok(Err(e.to_string())),
    };
    let (course, rate) = match kind {
        2 | 3 => (Course::Ellipse { frame, a, b }, 1.0),
        // p + t² / 4f x + t y.
        4 => (Course::Parabola { frame, f: a }, 0.5 / a),
        _ => (Course::Hyperbola { frame, a, b }, 1.0),
    };
    Ok(Ok(Stated {
        course,
        rate,
        range: None,
    }))
}

/// A Bézier curve, or a B-spline with its knots.
fn spline(words: &mut Words<'_>, knotted: bool) -> Result<Result<NurbsCurve, String>, Fault> {
    let flag = |words: &mut Words<'_>, what: &str| Ok(words.whole(what)? != 0);
    let rational = flag(words, "whether it is rational, 0 or 1")?;
    let periodic = knotted && flag(words, "whether it is periodic, 0 or 1")?;
    let degree = words.whole("the degree")?;
    if !(1..=HIGHEST_DEGREE).contains(&degree) {
        return Err(words.fault(format!(
            "the degree {degree}; those from 1 to {HIGHEST_DEGREE} are read"
        )));
    }
    let each = if rational { 4 } else { 3 };
    let (count, distinct) = if knotted {
        (words.count("poles", each)?, words.count("knots", 2)?)
    } else {
        words.holds(degree + 1, "poles", each)?;
        (degree + 1, 0)
    };
    let (mut points, mut weights) = (Vec::with_capacity(count), Vec::new());
    for _ in 0..count {
        points.push(words.point("a coordinate of a pole")?);
        if rational {
            weights.push(words.real("a weight")?);
        }
    }
    if !knotted {
        let weights = rational.then_some(&weights[..]);
        return Ok(NurbsCurve::bezier(&points, weights).map_err(|e| e.to_string()));
    }
    let mut knots = Vec::with_capacity(distinct);
    for _ in 0..distinct {
        let knot = words.real("a knot")?;
        let times = words.whole("how often a knot occurs")?;
        if !(1..=degree + 1).contains(&times) {
            return Err(words.fault(format!(
                "a knot that occurs {times} times; at degree {degree} 1 to {} can be",
                degree + 1
            )));
        }
        knots.push((knot, times));
    }
    let mut flat: Vec<f64> = knots
        .iter()
        .flat_map(|(k, n)| std::iter::repeat_n(*k, *n))
        .collect();
    if periodic {
        match opened(&flat, &knots, degree, count) {
            Ok(all) => flat = all,
            Err(why) => return Ok(Err(why)),
        }
        let more = flat.len().saturating_sub(degree + 1);
        points = (0..more).map(|i| points[i % count]).collect();
        if rational {
            weights = (0..more).map(|i| weights[i % count]).collect();
        }
    }
    let weights = rational.then_some(&weights[..]);
    Ok(NurbsCurve::new(degree, flat, &points, weights).map_err(|e| e.to_string()))
}

/// The knots of one turn of a periodic spline: those of the turns before and after it continue the list, until the first
/// and the last knot have as many before and after them as the degree asks for.
fn opened(
    flat: &[f64],
    knots: &[(f64, usize)],
    degree: usize,
    poles: usize,
) -> Result<Vec<f64>, String> {
    let (Some(first), Some(last)) = (knots.first(), knots.last()) else {
        return Err("a periodic spline without knots".into());
    };
    let (turn, period) = (flat.len() - last.1, last.0 - first.0);
    if first.1 != last.1 || first.1 > degree || turn != poles || period <= 0.0 {
        return Err(format!(
            "a periodic spline of {poles} poles whose knots are for {turn}, with {} and {} at its ends",
            first.1, last.1
        ));
    }
    let missing = degree + 1 - first.1;
    // The k-th knot of the endless list; the given ones begin at 0.
    let knot = |k: i64| {
        let n = turn as i64;
        flat[k.rem_euclid(n) as usize] + period * k.div_euclid(n) as f64
    };
    Ok((-(missing as i64)..(flat.len() + missing) as i64)
        .map(knot)
        .collect())
}
