//! The velocities of curves.

use super::slide::{Moved, Slide};
use super::still::{self, Part};
use super::{Motion, Mover, Pair};
use crate::curves::{ArcData, clamped_uniform, spacing};
use crate::data::{Datum, Fields, Item};
use nappe::curve::{
    CrossDerivative, CurveRef, ExpressionCurve, InterpolateOptions, Isocurve, JoinOptions, Joined,
    Spacing, Trimmed, interpolate_like,
};
use nappe::exact::{NurbsCurve, NurbsError};
use nappe::expr::Bound;
use nappe::surface::Dir;
use nappe::velocity::{
    FrameRate, Net, Sum, Term, arc, as_curve, cross_matrix, extended, interpolation, still_curve,
};
use nappe::{Breaks, DAffine3, DMat3, DVec3, maps};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Relative to the greatest change: parameters of points that change less do not, but for rounding.
const ROUNDING: f64 = 1e-12;
/// Relative to the greatest: velocities of two ends that differ by less are one, but for rounding.
const SAME: f64 = 1e-9;
const JUMPS: &str = "its corners move along its parameter, so its velocity jumps there: write parametrization = \"uniform\"";

/// The curve of a control polygon over equal weights.
fn bezier(points: &[DVec3]) -> Result<CurveRef, NurbsError> {
    Ok(Arc::new(NurbsCurve::bezier(points, None)?))
}

/// A direction and its rate, if it is given.
fn direction(pair: [&Fields; 2], key: &str) -> Option<[DVec3; 2]> {
    let [at, rate] = pair;
    let given = at.get(key)?.vector()?;
    Some([given, vector(rate, key)])
}

/// The rate of a vector; words and what is not given do not change.
pub(super) fn vector(rate: &Fields, key: &str) -> DVec3 {
    match rate.get(key).map(|i| &i.datum) {
        Some(Datum::Vector(v)) => *v,
        _ => DVec3::ZERO,
    }
}

/// The rate of a number; what is not given does not change.
pub(super) fn number(rate: &Fields, key: &str) -> f64 {
    rate.number(key).unwrap_or(0.0)
}

/// True if the parameters of points change with the points.
fn respaced(points: &[DVec3], rates: &[DVec3], spacing: Spacing, closed: bool) -> bool {
    let length = |v: &[DVec3]| v.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>();
    let noise = ROUNDING * (length(rates) / length(points)).max(f64::MIN_POSITIVE);
    let moved = |rate: &f64| rate.is_nan() || rate.abs() > noise;
    spacing.rates(points, rates, closed).iter().any(moved)
}

impl Mover<'_, '_> {
    /// True if nothing that an object is made of moves; the error of what is not known.
    pub(super) fn parts_stay(&mut self, table: &Fields) -> Result<bool, String> {
        let mut parts = Vec::new();
        still::parts(table, &mut parts);
        let mut stay = true;
        for part in parts {
            stay &= match part {
                Part::Curve(name) => self.curve(&name)?.is_none(),
                Part::Surface(name) => {
                    let object = name.split('/').next().unwrap_or_default();
                    // Other texts are words.
                    !self.surfaces.contains_key(object)
                        || self.patches(object)?.iter().all(Option::is_none)
                }
            };
        }
        Ok(stay)
    }

    /// The velocity of a curve, from those of its parts.
    pub(super) fn moved_curve(&mut self, pair: Pair<'_>, curve: &CurveRef) -> Motion<CurveRef> {
        let [f, r] = [&pair.at.fields, &pair.rate.fields];
        if self.parts_stay(f)? && still::fields(r) {
            return Ok(None);
        }
        let fault = |e: &dyn std::fmt::Display| pair.unknown(format!("its velocity: {e}"));
        let points = || {
            let both = (f.vectors("points"), r.vectors("points"));
            let (Some(points), Some(rates)) = both else {
                return Err(pair.unknown("it has no points"));
            };
            Ok((points, rates))
        };
        let weights = (f.numbers("weights"), r.numbers("weights"));
        let weights = match (&weights.0, &weights.1) {
            (Some(w), Some(rates)) => Some([w.as_slice(), rates.as_slice()]),
            _ => None,
        };
        let made = match pair.at.kind.name {
            "line" => bezier(&[vector(r, "from"), vector(r, "to")]).map_err(|e| fault(&e))?,
            "hermite" => {
                let [a, b] = [vector(r, "from"), vector(r, "to")];
                let [s, e] = [vector(r, "from_tangent"), vector(r, "to_tangent")];
                bezier(&[a, a + s / 3.0, b - e / 3.0, b]).map_err(|e| fault(&e))?
            }
            "polyline" => {
                let (points, rates) = points()?;
                let at: Vec<f64> = curve.breaks().iter().map(|b| b.at).collect();
                let mut knots = vec![curve.domain().lo];
                knots.extend(&at);
                knots.push(curve.domain().hi);
                if knots.len() == points.len() + 2 {
                    let line = NurbsCurve::new(1, knots, &rates, None).map_err(|e| fault(&e))?;
                    if respaced(&points, &rates, spacing(f), false) {
                        let why = pair.unknown(JUMPS);
                        let slide = Slide::new(at, spacing(f).rates(&points, &rates, false), why);
                        return Ok(Some(Moved::sliding(Arc::new(line), Some(slide))));
                    }
                    Arc::new(line)
                } else {
                    return Err(pair.unknown("it has not as many corners as points"));
                }
            }
            "bezier" => {
                let (points, rates) = points()?;
                let net = Net {
                    points: &points,
                    rates: &rates,
                    weights,
                };
                let w = weights.map(|w| w[0]);
                let make = |p: &[DVec3]| Ok(Arc::new(NurbsCurve::bezier(p, w)?) as CurveRef);
                net.curve(curve, make).map_err(|e: NurbsError| fault(&e))?
            }
            "nurbs" => {
                if !pair.stays("knots") {
                    return Err(pair.unknown("its knots change"));
                }
                let (points, rates) = points()?;
                let net = Net {
                    points: &points,
                    rates: &rates,
                    weights,
                };
                let degree = f.number("degree").unwrap_or(1.0) as usize;
                let knots = f
                    .numbers("knots")
                    .unwrap_or_else(|| clamped_uniform(points.len(), degree));
                let w = weights.map(|w| w[0]);
                let make = |p: &[DVec3]| {
                    Ok(Arc::new(NurbsCurve::new(degree, knots.clone(), p, w)?) as CurveRef)
                };
                net.curve(curve, make).map_err(|e: NurbsError| fault(&e))?
            }
            "conic" => {
                let (points, rates) = points()?;
                let w = [1.0, f.number("weight").unwrap_or(1.0), 1.0];
                let weight_rates = [0.0, number(r, "weight"), 0.0];
                let net = Net {
                    points: &points,
                    rates: &rates,
                    weights: Some([&w, &weight_rates]),
                };
                let make = |p: &[DVec3]| Ok(Arc::new(NurbsCurve::bezier(p, Some(&w))?) as CurveRef);
                net.curve(curve, make).map_err(|e: NurbsError| fault(&e))?
            }
            "arc" | "circle" | "ellipse" if f.get("through").is_none() => self.moved_arc(pair)?,
            "interpolate" => {
                let (points, rates) = points()?;
                let closed = f.flag("closed");
                let degree = f.number("degree").map_or(3, |d| d as usize);
                let once = match (&points[..], &rates[..]) {
                    ([p, .., q], [p_rate, .., q_rate]) if closed && p == q => {
                        if p_rate != q_rate {
                            return Err(pair.unknown("its first point leaves its last one"));
                        }
                        points.len() - 1
                    }
                    _ => points.len(),
                };
                let (points, rates) = (&points[..once], &rates[..once]);
                if respaced(points, rates, spacing(f), closed) {
                    if degree != 3 {
                        return Err(pair.unknown(
                            "its knots change with the distances of its points: write degree = 3 or parametrization = \"uniform\"",
                        ));
                    }
                    let given =
                        |fields: &Fields, key: &str| f.get(key).map(|_| vector(fields, key));
                    let options = InterpolateOptions {
                        degree,
                        closed,
                        spacing: spacing(f),
                        start_tangent: given(f, "start_tangent"),
                        end_tangent: given(f, "end_tangent"),
                    };
                    let turns = ["start_tangent", "end_tangent"].map(|key| given(r, key));
                    let moved = interpolation(points, rates, options, turns);
                    return Ok(Some(Moved::new(Arc::new(moved.map_err(|e| fault(&e))?))));
                }
                let tangent = |key: &str| f.get(key).map(|_| vector(r, key));
                let options = InterpolateOptions {
                    degree,
                    closed,
                    spacing: spacing(f),
                    start_tangent: tangent("start_tangent"),
                    end_tangent: tangent("end_tangent"),
                };
                Arc::new(interpolate_like(points, rates, options).map_err(|e| fault(&e))?)
            }
            "expression" => {
                if !pair.stays("domain") {
                    return Err(pair.unknown("its domain changes"));
                }
                let formula = |key: &str| match r.get(key).map(|i| &i.datum) {
                    Some(Datum::Formula(b)) => Ok(b.clone()),
                    _ => Err(pair.unknown("a formula is missing")),
                };
                let formulas: [Bound; 3] = [formula("x")?, formula("y")?, formula("z")?];
                let domain = curve.domain();
                let velocity = ExpressionCurve::new(formulas, [domain.lo, domain.hi]);
                Arc::new(velocity.map_err(|e| fault(&e))?)
            }
            "isocurve" => return self.moved_isocurve(pair).map(Some),
            "side" => match f.get("side").map(|i| &i.datum) {
                Some(Datum::Side(side)) => return self.side(side),
                _ => return Err(pair.unknown("it names no side")),
            },
            "reverse" => {
                let Some(Moved { velocity, slides }) = self.key(pair, "curve")?.1 else {
                    return Ok(None);
                };
                let back = Arc::new(Trimmed::reversed(velocity));
                let [slide, _] = slides;
                return Ok(Some(Moved::sliding(back, slide.map(Slide::reversed))));
            }
            "trim" => self.moved_part(pair, curve)?,
            "join" => {
                let (Some(items), Some(rates)) = (f.list("curves"), r.list("curves")) else {
                    return Err(pair.unknown("it has no curves"));
                };
                let label = format!("{}, `curves`", pair.at.label);
                let (mut parts, mut slides) = (Vec::new(), Vec::new());
                for (item, rate) in items.iter().zip(rates) {
                    let (curve, moved) = self.item(item, rate, &label)?;
                    slides.push(moved.as_ref().and_then(|m| m.slide().cloned()));
                    let velocity = moved.map(|m| m.velocity);
                    parts.push(velocity.unwrap_or_else(|| still_curve(curve.breaks())));
                }
                // The curves have been found to meet; so must their velocities, else they part.
                let ends = |c: &CurveRef| [c.domain().lo, c.domain().hi].map(|t| c.point(t));
                let ends: Vec<[DVec3; 2]> = parts.iter().map(ends).collect();
                let fastest = ends.iter().flatten().map(|v| v.length());
                let noise = SAME * fastest.fold(0.0, f64::max);
                let part = ends
                    .windows(2)
                    .position(|w| w[0][1].distance(w[1][0]) > noise);
                if let Some(k) = part {
                    let (k, next) = (k + 1, k + 2);
                    return Err(
                        pair.unknown(format!("its curves {k} and {next} part as they move"))
                    );
                }
                let options = JoinOptions {
                    tol: Some(f64::MAX),
                    ..JoinOptions::default()
                };
                let joined = Joined::new(parts, options).map_err(|e| fault(&e))?;
                let slide = Slide::joined(&slides);
                return Ok(Some(Moved::sliding(Arc::new(joined), slide)));
            }
            "transform" => {
                let (source, moved) = self.key(pair, "curve")?;
                let [map, rate] = self.map(pair)?;
                let from = source.point(source.domain().lo);
                let mut terms = vec![Term::image(extended(source), rate.matrix3, from)];
                let slide = moved.as_ref().and_then(|m| m.slide().cloned());
                let image = |v| Term::image(extended(v), map.matrix3, DVec3::ZERO);
                terms.extend(moved.map(|m| image(m.velocity)));
                let image = as_curve(Sum::new(rate.transform_point3(from), terms));
                return Ok(Some(Moved::sliding(image, slide)));
            }
            _ => return Err(pair.unknown_kind()),
        };
        Ok(Some(Moved::new(made)))
    }

    fn moved_arc(&self, pair: Pair<'_>) -> Result<CurveRef, String> {
        let [f, r] = [&pair.at.fields, &pair.rate.fields];
        let missing = |_| pair.unknown("its data are missing");
        let at = ArcData::of(pair.at, TAU).map_err(missing)?;
        let rate = ArcData::of(pair.rate, 0.0).map_err(missing)?;
        let normal = direction([f, r], "normal").unwrap_or([DVec3::Z, DVec3::ZERO]);
        let x = direction([f, r], "x_direction");
        let frame = FrameRate::new(rate.center, normal, x).ok_or_else(|| {
            pair.unknown("its x direction jumps as its normal turns: give `x_direction`")
        })?;
        let ellipse = at.ellipse(f).map_err(|e| pair.unknown(e))?;
        let growth = [0, 1].map(|k| rate.semi_axes[k] / at.semi_axes[k]);
        Ok(arc(&ellipse, &frame, growth, rate.range))
    }

    fn moved_isocurve(&mut self, pair: Pair<'_>) -> Result<Moved<CurveRef>, String> {
        let [f, r] = [&pair.at.fields, &pair.rate.fields];
        let name = f.text("surface").unwrap_or_default();
        let label = format!("{}, `surface`", pair.at.label);
        let span = f.place("surface", &[]);
        let surface = self.builder.surface(name, &label, &span);
        let surface = surface.map_err(|_| pair.unknown("its surface is not built"))?;
        let moved = self.surface(name)?;
        let (along, held, key) = match f.number("u") {
            Some(_) => (Dir::V, Dir::U, "u"),
            None => (Dir::U, Dir::V, "v"),
        };
        let (at, rate) = (f.number(key).unwrap_or(0.0), number(r, key));
        let fault = |e: nappe::curve::CurveError| pair.unknown(e);
        let mut terms = Vec::new();
        if rate != 0.0 {
            if surface.breaks(held).below(1).contains(&at) {
                return Err(pair.unknown(format!("{key} = {at} leaves a crease of the surface")));
            }
            let across = CrossDerivative::new(surface.clone(), along, at).map_err(fault)?;
            let across = extended(Arc::new(across));
            terms.push(Term::image(across, DMat3::IDENTITY * rate, DVec3::ZERO));
        }
        let mut slide = None;
        if let Some(moved) = moved {
            slide = moved.slide_along(along)?;
            let own = Isocurve::new(moved.velocity, along, at).map_err(fault)?;
            terms.push(Term::new(extended(Arc::new(own))));
        }
        if terms.is_empty() {
            return Ok(Moved::new(still_curve(surface.breaks(along))));
        }
        let sum = as_curve(Sum::new(DVec3::ZERO, terms));
        Ok(Moved::sliding(sum, slide))
    }

    /// A part of a curve, whose ends may move along it.
    fn moved_part(&mut self, pair: Pair<'_>, part: &CurveRef) -> Result<CurveRef, String> {
        let [f, r] = [&pair.at.fields, &pair.rate.fields];
        let (curve, moved) = self.key(pair, "curve")?;
        let velocity = moved.map(Moved::fixed).transpose()?;
        let domain = curve.domain();
        let [from, to] =
            [("from", domain.lo), ("to", domain.hi)].map(|(k, d)| f.number(k).unwrap_or(d));
        let [start, end] = ["from", "to"].map(|k| number(r, k));
        let mut terms = Vec::new();
        if start != 0.0 || end != 0.0 {
            if let Some(at) = part.breaks().below(1).first() {
                return Err(pair.unknown(format!(
                    "its corner at t = {at} moves along its parameter, so its velocity jumps there: trim the curves between corners"
                )));
            }
            let turn = to - from;
            let of = extended(part.clone());
            terms.push(Term::slide(of, Dir::U, start / turn, (end - start) / turn));
        }
        if let Some(v) = velocity {
            let own = Trimmed::new(v, from, to).map_err(|e| pair.unknown(e))?;
            terms.push(Term::new(extended(Arc::new(own))));
        }
        if terms.is_empty() {
            return Ok(still_curve(part.breaks()));
        }
        Ok(as_curve(Sum::new(DVec3::ZERO, terms)))
    }

    /// The map of a `transform` and its rate.
    pub(super) fn map(&mut self, pair: Pair<'_>) -> Result<[DAffine3; 2], String> {
        let [f, r] = [&pair.at.fields, &pair.rate.fields];
        let map = self
            .builder
            .map(pair.at)
            .map_err(|_| pair.unknown("its map is missing"))?;
        let mut whole = [DAffine3::IDENTITY, DAffine3::ZERO];
        if let (Some(mirror), Some(rates)) = (f.record("mirror"), r.record("mirror")) {
            // Words name planes that stay; they are mirrors without a rate.
            let origin = mirror.vector("origin").unwrap_or(DVec3::ZERO);
            let normal = mirror.vector("normal").unwrap_or(DVec3::Z);
            let plane = nappe::Frame::along(origin, normal).map_err(|e| pair.unknown(e))?;
            let rate =
                FrameRate::of_axis(vector(rates, "origin"), [normal, vector(rates, "normal")]);
            whole = after(
                about(maps::mirror(&plane), &rate, origin, DMat3::ZERO),
                whole,
            );
        } else if f.get("mirror").is_some() {
            let normal = match f.text("mirror") {
                Some("xy") => DVec3::Z,
                Some("yz") => DVec3::X,
                _ => DVec3::Y,
            };
            let plane = nappe::Frame::along(DVec3::ZERO, normal).map_err(|e| pair.unknown(e))?;
            whole = after([maps::mirror(&plane), DAffine3::ZERO], whole);
        }
        if let (Some(scale), Some(rate)) = (f.get("scale"), r.get("scale")) {
            let factors = |i: &Item| match i.datum {
                Datum::Vector(v) => v,
                _ => DVec3::splat(i.number().unwrap_or(1.0)),
            };
            let [scale, rate] = [factors(scale), factors(rate)].map(DAffine3::from_scale);
            whole = after([scale, rate], whole);
        }
        if let (Some(rotate), Some(rates)) = (f.record("rotate"), r.record("rotate")) {
            let label = pair.at.label.clone();
            let axis = self.builder.axis(&label, rotate, "axis");
            let axis = axis.map_err(|_| pair.unknown("its axis is missing"))?;
            let angle = rotate.number("angle").unwrap_or(0.0);
            let rotation = maps::rotation(&axis, angle);
            let turn = cross_matrix(axis.z()) * rotation.matrix3 * number(rates, "angle");
            let rate = axis_rate([rotate, rates], "axis");
            whole = after(about(rotation, &rate, axis.origin(), turn), whole);
        }
        let mut rate = whole[1];
        rate.translation += vector(r, "translate");
        Ok([map, rate])
    }
}

/// How an axis moves that a key gives: a word stays.
pub(super) fn axis_rate([at, rate]: [&Fields; 2], key: &str) -> FrameRate {
    match (at.record(key), rate.record(key)) {
        (Some(at), Some(rate)) => {
            let z = at.vector("direction").unwrap_or(DVec3::Z);
            FrameRate::of_axis(vector(rate, "origin"), [z, vector(rate, "direction")])
        }
        _ => match (at.vector(key), rate.get(key).map(|i| &i.datum)) {
            (Some(z), Some(Datum::Vector(v))) => FrameRate::of_axis(DVec3::ZERO, [z, *v]),
            _ => FrameRate::default(),
        },
    }
}

/// A map that leaves a point where it is and moves with a frame, with its rate: `A' = [w] A - A [w] + own`.
fn about(map: DAffine3, frame: &FrameRate, point: DVec3, own: DMat3) -> [DAffine3; 2] {
    let a = map.matrix3;
    let spin = frame.spin();
    let matrix3 = spin * a - a * spin + own;
    // From b = o - A o.
    let translation = frame.origin - matrix3 * point - a * frame.origin;
    [
        map,
        DAffine3 {
            matrix3,
            translation,
        },
    ]
}

/// One map after another, with their rates.
fn after([second, d2]: [DAffine3; 2], [first, d1]: [DAffine3; 2]) -> [DAffine3; 2] {
    let matrix3 = d2.matrix3 * first.matrix3 + second.matrix3 * d1.matrix3;
    let translation =
        d2.matrix3 * first.translation + second.matrix3 * d1.translation + d2.translation;
    let rate = DAffine3 {
        matrix3,
        translation,
    };
    [second * first, rate]
}
