//! Curves.

use super::conic;
use super::file::Entry;
use super::record::{Got, Record};
use super::space::{DEEPEST, Space};
use glam::{DAffine3, DVec3};
use nappe::curve::{self, Ellipse, EllipseOptions, JoinOptions, Joined, Line, Spacing, polyline};
use nappe::{Curve, CurveRef, NurbsCurve};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Parameters this near, relative to their range, are the same.
pub(super) const SAME_PARAMETER: f64 = 1e-12;
/// The pieces of a parametric spline may be this far apart, relative to their size: files of ten digits pass.
const SAME_POINT: f64 = 1e-8;

/// A turn of fewer radians is none, or a whole one.
const WHOLE: f64 = 1e-9;
/// The ends of an arc may differ so much, relative to its radius: files have as few as five digits.
const UNEVEN: f64 = 1e-3;

/// The curves that hold this kind.
pub(super) fn is_curve(entry: &Entry) -> bool {
    match entry.kind {
        100 | 102 | 104 | 112 | 126 => true,
        106 => matches!(entry.form, 11..=13 | 63),
        110 => true,
        _ => false,
    }
}

impl Space {
    /// A curve in pieces, in their order: composite curves are taken apart.
    pub(super) fn pieces(&self, number: i64, map: DAffine3) -> Got<Vec<CurveRef>> {
        let mut out = Vec::new();
        self.add_pieces(number, map, 0, &mut out)?;
        if out.is_empty() {
            return Err("a composite curve without parts".into());
        }
        Ok(out)
    }

    /// A curve in one piece.
    pub(super) fn curve(&self, number: i64, map: DAffine3) -> Got<CurveRef> {
        let mut pieces = self.pieces(number, map)?;
        if pieces.len() == 1 {
            return Ok(pieces.remove(0));
        }
        let joined = Joined::new(pieces, JoinOptions::default()).map_err(|e| e.to_string())?;
        Ok(Arc::new(joined))
    }

    fn add_pieces(
        &self,
        number: i64,
        map: DAffine3,
        depth: usize,
        out: &mut Vec<CurveRef>,
    ) -> Got<()> {
        let (entry, mut r) = self.open(number)?;
        if depth > DEEPEST {
            return Err("composite curves that go in a circle".into());
        }
        let map = map * self.placement(entry)?;
        if entry.kind == 102 {
            let n = r.count(1)?;
            for part in r.ints(n)? {
                // Points and connections between the curves say nothing of their course.
                if !matches!(self.entry(part)?.kind, 116 | 132) {
                    self.add_pieces(part, map, depth + 1, out)?;
                }
            }
            return Ok(());
        }
        out.push(placed(self.simple(entry, &mut r)?, map)?);
        Ok(())
    }

    fn simple(&self, entry: &Entry, r: &mut Record) -> Got<CurveRef> {
        Ok(match (entry.kind, entry.form) {
            (100, _) => Arc::new(circle(r)?),
            (104, _) => conic::arc(r)?,
            (106, 11..=13 | 63) => {
                let points = copious(r, entry.form == 63)?;
                Arc::new(polyline(&points, Spacing::Uniform).map_err(text)?)
            }
            (110, 0) => Arc::new(Line::new(r.point()?, r.point()?).map_err(text)?),
            (110, _) => return Err("a line without ends".into()),
            (112, _) => Arc::new(spline(r)?),
            (126, _) => Arc::new(nurbs(r)?),
            (kind, form) => {
                return Err(format!(
                    "D{} of the kind {kind}, form {form}, is not read as a curve",
                    entry.start
                ));
            }
        })
    }
}

pub(super) fn text(e: impl ToString) -> String {
    e.to_string()
}

/// The image under a map.
pub(crate) fn placed(curve: CurveRef, map: DAffine3) -> Got<CurveRef> {
    if map == DAffine3::IDENTITY {
        return Ok(curve);
    }
    if let Some(n) = curve.to_nurbs() {
        return Ok(Arc::new(n.transformed(&map)));
    }
    Ok(Arc::new(curve::Transformed::new(curve, map).map_err(text)?))
}

/// 100: counter-clockwise from a point to another, the whole circle if they are one.
fn circle(r: &mut Record) -> Got<Ellipse> {
    let z = r.real()?;
    let [c, from, to] = [0; 3].map(|_| Ok(DVec3::new(r.real()?, r.real()?, z)));
    let (c, from, to): (DVec3, DVec3, DVec3) = (c?, (from as Got<DVec3>)?, to?);
    let (a, b) = (from - c, to - c);
    let first = a.y.atan2(a.x);
    // The turn from one to the other.
    let mut turn = (a.x * b.y - a.y * b.x).atan2(a.x * b.x + a.y * b.y);
    // Ends that are one but for rounding are those of the whole circle.
    if turn.abs() < WHOLE {
        turn = TAU;
    } else if turn < 0.0 {
        turn += TAU;
    }
    if (a.length() - b.length()).abs() > UNEVEN * a.length() {
        return Err(format!(
            "an arc whose ends are {} and {} from its centre",
            a.length(),
            b.length()
        ));
    }
    let options = EllipseOptions {
        from: first,
        to: first + turn,
        normal: DVec3::Z,
        x_direction: Some(DVec3::X),
    };
    Ellipse::new(c, [a.length(); 2], options).map_err(text)
}

/// The points of 106.
pub(super) fn copious(r: &mut Record, closed: bool) -> Got<Vec<DVec3>> {
    let kind = r.int()?;
    let mut points = match kind {
        1 => {
            let n = r.count(2)?;
            let z = r.real()?;
            (0..n)
                .map(|_| Ok(DVec3::new(r.real()?, r.real()?, z)))
                .collect::<Got<Vec<_>>>()?
        }
        2 => {
            let n = r.count(3)?;
            r.points(n)?
        }
        3 => {
            let n = r.count(6)?;
            (0..n)
                .map(|_| {
                    let p = r.point()?;
                    r.skip(3);
                    Ok(p)
                })
                .collect::<Got<Vec<_>>>()?
        }
        _ => return Err(format!("points in the unknown arrangement {kind}")),
    };
    if closed && points.first() != points.last() {
        points.extend(points.first().copied());
    }
    Ok(points)
}

/// 112: cubic polynomials `A + B s + C s² + D s³`, s from the start of each piece.
fn spline(r: &mut Record) -> Got<NurbsCurve> {
    r.skip(2);
    let plane = r.int()? == 2;
    let n = r.count(13)?;
    let at = r.reals(n + 1)?;
    let mut points: Vec<DVec3> = Vec::new();
    let mut knots = vec![];
    for i in 0..n {
        let h = at[i + 1] - at[i];
        let mut c = [DVec3::ZERO; 4];
        for axis in 0..3 {
            for term in &mut c {
                term[axis] = r.real()?;
            }
        }
        if plane {
            (1..4).for_each(|k| c[k].z = 0.0);
        }
        let net = bernstein(c, h);
        let size = net
            .iter()
            .fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
        if points
            .last()
            .is_some_and(|p| p.distance(net[0]) > SAME_POINT * size)
        {
            return Err(format!("a spline that jumps before its piece {i}"));
        }
        points.pop();
        points.extend(net);
        knots.extend([at[i]; 3]);
    }
    knots.extend([at[n]; 4]);
    knots.insert(0, at[0]);
    NurbsCurve::new(3, knots, &points, None).map_err(text)
}

/// The Bézier points of a cubic over `[0, h]`.
pub(super) fn bernstein([a, b, c, d]: [DVec3; 4], h: f64) -> [DVec3; 4] {
    let (b, c, d) = (b * h, c * (h * h), d * (h * h * h));
    [a, a + b / 3.0, a + b * (2.0 / 3.0) + c / 3.0, a + b + c + d]
}

/// 126.
fn nurbs(r: &mut Record) -> Got<NurbsCurve> {
    let (k, degree) = (r.int()?, r.int()?);
    let count = r.fits(k.saturating_add(1), 5)?;
    let degree = r.fits(degree, 1)?;
    r.skip(4);
    r.has((count + degree + 1).saturating_add(count.saturating_mul(4)))?;
    let knots = r.reals(count + degree + 1)?;
    let weights = r.reals(count)?;
    let points = r.points(count)?;
    let [from, to] = [r.real(), r.real()];
    let curve = NurbsCurve::new(degree, knots, &points, some_weights(&weights)).map_err(text)?;
    let domain = curve.domain();
    let slack = SAME_PARAMETER * (domain.hi - domain.lo);
    let (from, to) = (from?.max(domain.lo), to?.min(domain.hi));
    // Defaults leave both 0.
    if to - from <= slack || (from - domain.lo <= slack && domain.hi - to <= slack) {
        return Ok(curve);
    }
    curve.part(from, to).map_err(text)
}

/// Weights, unless all are equal.
pub(super) fn some_weights(weights: &[f64]) -> Option<&[f64]> {
    let equal = weights.iter().all(|w| *w == weights[0] && *w != 0.0);
    (!equal).then_some(weights)
}
