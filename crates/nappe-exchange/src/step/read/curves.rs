//! Curves, endless ones included.

use super::file::{Args, Got, Record};
use super::place::Space;
use super::splines;
use super::value::Value;
use glam::DVec3;
use nappe::curve::{
    Ellipse, EllipseOptions, JoinOptions, Joined, Line, Spacing, Trimmed, conic, polyline,
};
use nappe::query::{Finder, FinderOptions};
use nappe::{CurveRef, Frame};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A curve as a file states it.
#[derive(Clone, Debug)]
pub(crate) enum Course {
    /// `point + t vector`.
    Line { point: DVec3, vector: DVec3 },
    /// `a cos t x + b sin t y`: a circle if both are equal.
    Ellipse { frame: Frame, a: f64, b: f64 },
    /// `a cosh t x + b sinh t y`.
    Hyperbola { frame: Frame, a: f64, b: f64 },
    /// `f (t² x + 2 t y)`.
    Parabola { frame: Frame, f: f64 },
    /// A curve with ends.
    Bounded(CurveRef),
}

/// Curves made of curves are followed so far.
const DEPTH: usize = 16;
/// What the depth grows by inside a composite curve. None is read inside another: that could ask for any number of
/// segments.
const INSIDE: usize = 1000;
/// Angles nearer than this to a whole turn, or to none, are that: points have at most so many digits of it.
const WHOLE: f64 = 1e-9;
/// Points of a curve that are farther from each other than this share of its extent are two, whatever the file's uncertainty.
const NEAR: f64 = 1e-3;
/// A hyperbola is read as far as its arc's middle weight stays below cosh of this.
const HYPERBOLIC: f64 = 20.0;

/// The curve with this number.
pub(super) fn course(space: &Space<'_>, id: u64, depth: usize) -> Got<Course> {
    if depth % INSIDE > DEPTH {
        return Err(space
            .file
            .refused(id, "curves are made of curves without end"));
    }
    let record = space.file.record(id)?;
    let args = record.args();
    Ok(match record.kind() {
        "LINE" => Course::Line {
            point: space.point(args.reference(1)?)?,
            vector: space.vector(args.reference(2)?)?,
        },
        "CIRCLE" => {
            let a = length(space, &args, 2)?;
            let frame = space.frame(args.reference(1)?)?;
            Course::Ellipse { frame, a, b: a }
        }
        "ELLIPSE" => Course::Ellipse {
            frame: space.frame(args.reference(1)?)?,
            a: length(space, &args, 2)?,
            b: length(space, &args, 3)?,
        },
        "HYPERBOLA" => Course::Hyperbola {
            frame: space.frame(args.reference(1)?)?,
            a: length(space, &args, 2)?,
            b: length(space, &args, 3)?,
        },
        "PARABOLA" => Course::Parabola {
            frame: space.frame(args.reference(1)?)?,
            f: length(space, &args, 2)?,
        },
        "POLYLINE" => {
            let ids = args.references(1)?;
            let points: Got<Vec<DVec3>> = ids.iter().map(|id| space.point(*id)).collect();
            let line = polyline(&points?, Spacing::Uniform)
                .map_err(|e| e.to_string())
                .and_then(|c| {
                    c.on_domain(0.0, (ids.len() - 1) as f64)
                        .map_err(|e| e.to_string())
                });
            Course::Bounded(Arc::new(line.map_err(|e| record.refused(e))?))
        }
        "TRIMMED_CURVE" => Course::Bounded(trimmed(space, &record, depth)?),
        "SURFACE_CURVE" | "SEAM_CURVE" | "INTERSECTION_CURVE" => {
            course(space, args.reference(1)?, depth + 1)?
        }
        "COMPOSITE_CURVE" => Course::Bounded(composite(space, &record, depth)?),
        _ if splines::is_curve(&record) => {
            Course::Bounded(Arc::new(splines::curve(space, &record)?))
        }
        "OFFSET_CURVE_3D" => {
            return Err(record.refused("offset curves are not read"));
        }
        _ => return Err(record.refused("curves of this kind are not read")),
    })
}

/// A length that must be positive.
pub(super) fn length(space: &Space<'_>, args: &Args<'_, '_>, i: usize) -> Got<f64> {
    let x = space.length(args.real(i)?);
    if x > 0.0 && x.is_finite() {
        return Ok(x);
    }
    Err(args.refused(format!(
        "its parameter {} is {x}, not a positive length",
        i + 1
    )))
}

/// The curve that is trimmed in the end, and whether it runs the same way: what an edge lies on.
pub(super) fn basis(space: &Space<'_>, id: u64) -> Got<(Course, bool)> {
    let (mut id, mut same) = (id, true);
    for _ in 0..DEPTH {
        let record = space.file.record(id)?;
        match record.kind() {
            "TRIMMED_CURVE" => {
                same ^= !record.args().flag(4)?;
                id = record.args().reference(1)?;
            }
            "SURFACE_CURVE" | "SEAM_CURVE" | "INTERSECTION_CURVE" => {
                id = record.args().reference(1)?;
            }
            _ => return Ok((course(space, id, 0)?, same)),
        }
    }
    Err(space
        .file
        .refused(id, "curves are made of curves without end"))
}

fn trimmed(space: &Space<'_>, record: &Record<'_>, depth: usize) -> Got<CurveRef> {
    let args = record.needed("TRIMMED_CURVE")?;
    let course = course(space, args.reference(1)?, depth + 1)?;
    let by_point = matches!(args.get(5), Some(Value::Enum(b"CARTESIAN")));
    let mut at = [0.0; 2];
    for (i, at) in at.iter_mut().enumerate() {
        let list = args.list(2 + i)?;
        let parameter = list.values.iter().find_map(super::file::number);
        let point = list.values.iter().find_map(|v| match v {
            Value::Ref(id) => Some(*id),
            _ => None,
        });
        *at = match (parameter, point) {
            (Some(t), None) => course.scaled(space, t),
            (Some(t), Some(_)) if !by_point => course.scaled(space, t),
            (_, Some(id)) => course
                .parameter(space.point(id)?)
                .map_err(|e| record.refused(e))?,
            (None, None) => return Err(record.refused("it does not say where it is trimmed")),
        };
    }
    let same = args.flag(4)?;
    match &course {
        Course::Ellipse { .. } => at[1] = turned(at, same),
        Course::Bounded(c) if is_ring(c, space.uncertainty) => {
            return stretch(c, at, same, space.uncertainty).map_err(|e| record.refused(e));
        }
        _ => {}
    }
    course.between(at).map_err(|e| record.refused(e))
}

/// Whether a curve ends where it begins: within a tolerance that is small beside it.
fn is_ring(c: &CurveRef, tol: f64) -> bool {
    let [first, last] = c.ends();
    first.distance(last) <= near(c, tol)
}

/// A distance of two points of a curve, which is at least so large: found far sooner than its extent.
pub(super) fn reaches(c: &CurveRef) -> f64 {
    let [first, last] = c.ends();
    let middle = c.point(c.domain().mid());
    first.distance(last).max(first.distance(middle))
}

/// Points of a curve nearer than this are one: a tolerance, but for curves that are not much larger than it.
fn near(c: &CurveRef, tol: f64) -> f64 {
    if NEAR * reaches(c) >= tol {
        return tol;
    }
    tol.min(NEAR * c.bounds(c.domain()).diagonal())
}

/// The part of a closed curve from one parameter to another, forwards or backwards, also through the point where it begins and ends;
/// all of it where they are one.
fn stretch(c: &CurveRef, at: [f64; 2], forward: bool, tol: f64) -> Result<CurveRef, String> {
    let domain = c.domain();
    let [first, _] = c.ends();
    let [mut from, mut to] = at.map(|t| t.clamp(domain.lo, domain.hi));
    if !(from.is_finite() && to.is_finite()) {
        return Err(format!("it is trimmed from {} to {}", at[0], at[1]));
    }
    if !forward {
        (from, to) = (to, from);
    }
    // What is found at the seam may be either end. A curve may pass there in its middle too, which is no end.
    let margin = NEAR * (domain.hi - domain.lo);
    let at_seam = |t: f64| {
        (t - domain.lo).min(domain.hi - t) <= margin && c.point(t).distance(first) <= near(c, tol)
    };
    if at_seam(from) {
        from = domain.lo;
    }
    if at_seam(to) {
        to = domain.hi;
    }
    let part = if from < to {
        part(c, from, to)?
    } else {
        around(c, from, to, tol)?
    };
    Ok(if forward { part } else { backwards(part) })
}

/// The part of a closed curve from one parameter through the point where it begins and ends to another.
fn around(c: &CurveRef, from: f64, to: f64, tol: f64) -> Result<CurveRef, String> {
    let domain = c.domain();
    let pieces: Result<Vec<CurveRef>, String> = [[from, domain.hi], [domain.lo, to]]
        .into_iter()
        .filter(|r| r[0] < r[1])
        .map(|[a, b]| part(c, a, b))
        .collect();
    let mut pieces = pieces?;
    if pieces.len() == 1 {
        return Ok(pieces.remove(0));
    }
    let options = JoinOptions {
        tol: Some(tol),
        ..JoinOptions::default()
    };
    Ok(Arc::new(
        Joined::new(pieces, options).map_err(|e| e.to_string())?,
    ))
}

/// The last angle of an arc that runs from the first the right way round, a whole turn if they are equal.
fn turned([from, to]: [f64; 2], forward: bool) -> f64 {
    let turn = if forward { to - from } else { from - to }.rem_euclid(TAU);
    let turn = if !(WHOLE..=TAU - WHOLE).contains(&turn) {
        TAU
    } else {
        turn
    };
    if forward { from + turn } else { from - turn }
}

fn composite(space: &Space<'_>, record: &Record<'_>, depth: usize) -> Got<CurveRef> {
    let args = record.needed("COMPOSITE_CURVE")?;
    if depth >= INSIDE {
        return Err(record.refused("a composite curve inside another is not read"));
    }
    let mut parts: Vec<CurveRef> = Vec::new();
    for id in args.references(1)? {
        let segment = space.file.record(id)?;
        let args = segment.needed("COMPOSITE_CURVE_SEGMENT")?;
        let part = course(space, args.reference(2)?, depth + INSIDE)?
            .whole()
            .map_err(|e| segment.refused(e))?;
        parts.push(if args.flag(1)? { part } else { backwards(part) });
    }
    if parts.len() == 1 {
        return Ok(parts.remove(0));
    }
    let options = JoinOptions {
        tol: Some(10.0 * space.uncertainty),
        ..JoinOptions::default()
    };
    let joined = Joined::new(parts, options).map_err(|e| record.refused(e.to_string()))?;
    Ok(Arc::new(joined))
}

/// A curve run through the other way, as what it is where possible.
pub(super) fn backwards(curve: CurveRef) -> CurveRef {
    match curve.to_nurbs().and_then(|n| n.reversed().ok()) {
        Some(n) => Arc::new(n),
        None => Arc::new(Trimmed::reversed(curve)),
    }
}

impl Course {
    /// A stated parameter: angles in radians.
    fn scaled(&self, space: &Space<'_>, t: f64) -> f64 {
        if matches!(self, Course::Ellipse { .. }) {
            t * space.radians
        } else {
            t
        }
    }

    /// The parameter of the point nearest to a given one (for points on the curve within rounding).
    pub(super) fn parameter(&self, p: DVec3) -> Result<f64, String> {
        Ok(match self {
            Course::Line { point, vector } => (p - *point).dot(*vector) / vector.length_squared(),
            Course::Ellipse { frame, a, b } => {
                let c = frame.coordinates(p);
                (c.y / b).atan2(c.x / a)
            }
            Course::Hyperbola { frame, b, .. } => (frame.coordinates(p).y / b).asinh(),
            Course::Parabola { frame, f } => frame.coordinates(p).y / (2.0 * f),
            Course::Bounded(c) => {
                let finder = Finder::on_curves(std::slice::from_ref(c), FinderOptions::default());
                let found = finder
                    .and_then(|f| f.nearest(p))
                    .map_err(|e| e.to_string())?;
                found.uv[0]
            }
        })
    }

    /// The part from one parameter to another, backwards if the second is smaller. Of an ellipse at most one turn.
    pub(crate) fn between(&self, [from, to]: [f64; 2]) -> Result<CurveRef, String> {
        if !(from.is_finite() && to.is_finite()) || from == to {
            return Err(format!(
                "it is trimmed from {from} to {to}, which is no part of it"
            ));
        }
        let text = |e: nappe::curve::CurveError| e.to_string();
        match self {
            Course::Line { point, vector } => {
                let line = Line::new(*point + *vector * from, *point + *vector * to);
                Ok(Arc::new(line.map_err(text)?))
            }
            Course::Ellipse { frame, a, b } => {
                let options = EllipseOptions {
                    from,
                    to,
                    normal: frame.z(),
                    x_direction: Some(frame.x()),
                };
                let arc = Ellipse::new(frame.origin(), [*a, *b], options);
                Ok(Arc::new(arc.map_err(text)?))
            }
            Course::Hyperbola { frame, a, b } => {
                let (m, h) = (0.5 * (from + to), 0.5 * (to - from));
                if h.abs() > HYPERBOLIC {
                    return Err("the arc of a hyperbola is too long to be computed with".into());
                }
                let at = |t: f64, w: f64| {
                    frame.point(DVec3::new(a * t.cosh() / w, b * t.sinh() / w, 0.0))
                };
                let points = [at(from, 1.0), at(m, h.cosh()), at(to, 1.0)];
                Ok(Arc::new(conic(points, h.cosh()).map_err(text)?))
            }
            Course::Parabola { frame, f } => {
                let middle = DVec3::new(from * to, from + to, 0.0) * *f;
                let at = |t: f64| frame.point(DVec3::new(t * t, 2.0 * t, 0.0) * *f);
                let points = [at(from), frame.point(middle), at(to)];
                Ok(Arc::new(conic(points, 1.0).map_err(text)?))
            }
            Course::Bounded(c) => part(c, from, to),
        }
    }

    /// All of a curve that has ends or is closed.
    pub(super) fn whole(&self) -> Result<CurveRef, String> {
        match self {
            Course::Bounded(c) => Ok(c.clone()),
            Course::Ellipse { .. } => self.between([0.0, TAU]),
            _ => Err("the curve has no ends and no parts are stated".into()),
        }
    }

    /// The part from one point to another, along the curve or against it; all of it where they are one and it is closed.
    pub(super) fn reach(
        &self,
        ends: [DVec3; 2],
        same: bool,
        closed: bool,
        tol: f64,
    ) -> Result<CurveRef, String> {
        match self {
            Course::Line { .. } => {
                let line = Line::new(ends[0], ends[1]).map_err(|e| e.to_string())?;
                Ok(Arc::new(line))
            }
            Course::Ellipse { .. } => {
                let from = self.parameter(ends[0])?;
                let to = if closed {
                    from
                } else {
                    self.parameter(ends[1])?
                };
                self.between([from, turned([from, to], same)])
            }
            Course::Hyperbola { .. } | Course::Parabola { .. } => {
                self.between([self.parameter(ends[0])?, self.parameter(ends[1])?])
            }
            Course::Bounded(c) => {
                let [start, end] = if same { ends } else { [ends[1], ends[0]] };
                let part = self.bounded_part(c, [start, end], closed, tol)?;
                // Of an open curve only one part lies between two points, whatever the file says of its direction.
                let [a, b] = part.ends();
                let straight = a.distance(ends[0]) + b.distance(ends[1]);
                let crossed = a.distance(ends[1]) + b.distance(ends[0]);
                let turn = if straight == crossed || closed {
                    !same
                } else {
                    crossed < straight
                };
                Ok(if turn { backwards(part) } else { part })
            }
        }
    }

    /// The part of a curve with ends between two points of it, in its own direction.
    fn bounded_part(
        &self,
        c: &CurveRef,
        [start, end]: [DVec3; 2],
        closed: bool,
        tol: f64,
    ) -> Result<CurveRef, String> {
        let [first, last] = c.ends();
        let domain = c.domain();
        let ring = is_ring(c, tol);
        let tol = near(c, tol);
        if start.distance(first) <= tol
            && end.distance(last) <= tol
            && (closed || !ring || start.distance(end) > tol)
        {
            return Ok(c.clone());
        }
        if !ring && start.distance(last) <= tol && end.distance(first) <= tol {
            return Ok(c.clone());
        }
        let parameter = |p: DVec3, own: DVec3, at: f64| -> Result<f64, String> {
            if p.distance(own) <= tol {
                Ok(at)
            } else {
                self.parameter(p)
            }
        };
        let from = parameter(start, first, domain.lo)?;
        let to = if closed {
            from
        } else {
            parameter(end, last, domain.hi)?
        };
        if from < to {
            return part(c, from, to);
        }
        if !ring {
            return part(c, to, from);
        }
        around(c, from, to, tol)
    }
}

/// A part of a curve with ends, as what it is where possible; backwards if `to` is smaller.
pub(super) fn part(c: &CurveRef, from: f64, to: f64) -> Result<CurveRef, String> {
    let domain = c.domain();
    let inside = |t: f64| t.clamp(domain.lo, domain.hi);
    let (from, to) = (inside(from), inside(to));
    if [from, to] == [domain.lo, domain.hi] {
        return Ok(c.clone());
    }
    if let Some(n) = c.to_nurbs() {
        let part = n
            .part(from.min(to), from.max(to))
            .map_err(|e| e.to_string())?;
        let part = if from > to {
            part.reversed().map_err(|e| e.to_string())?
        } else {
            part
        };
        return Ok(Arc::new(part));
    }
    let part = Trimmed::new(c.clone(), from, to).map_err(|e| e.to_string())?;
    Ok(Arc::new(part))
}
