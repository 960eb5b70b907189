//! Swept surfaces that are as large as a face: its border runs along their sides.

use super::cover::Border;
use glam::{DAffine3, DVec3};
use nappe::curve::Transformed;
use nappe::query::{Finder, FinderOptions};
use nappe::surface::{RevolutionOptions, ruled};
use nappe::{CurveRef, Dir, Frame, Revolution, SurfaceRef};
use std::f64::consts::TAU;
use std::sync::Arc;

/// What is nearer than this share of the border's extent is one place: directions and places of files have ten digits or more.
const SAME: f64 = 1e-9;
/// Rounding of coordinates.
const ROUNDING: f64 = 1e-13;
/// A turn or a way that begins or ends at the stated place but for this share of it does so exactly.
const EXACT: f64 = 1e-14;

/// How near places must be to be one.
fn near(border: &Border<'_>) -> f64 {
    let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for p in border.samples() {
        (lo, hi) = (lo.min(p), hi.max(p));
    }
    let far = lo.abs().max(hi.abs()).max_element();
    (SAME * lo.distance(hi))
        .min(border.tolerance)
        .max(ROUNDING * far)
}

/// The two distinct values of what vertices tell, nearer than `same` being one; the first of them twice if there is one only.
fn two(values: impl Iterator<Item = f64>, same: f64) -> Option<[f64; 2]> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup_by(|b, a| *b - *a <= same);
    match values.as_slice() {
        [one] => Some([*one; 2]),
        [one, other] => Some([*one, *other]),
        _ => None,
    }
}

/// Whether a border runs along the sides of a swept surface only: along the paths of the curve's ends, or where one of two maps
/// takes it to the curve.
fn goes_round(
    border: &Border<'_>,
    curve: &CurveRef,
    tol: f64,
    on_path: impl Fn(DVec3) -> bool,
    back: [&dyn Fn(DVec3) -> DVec3; 2],
) -> bool {
    let options = FinderOptions {
        tol: Some(0.1 * tol),
        ..FinderOptions::default()
    };
    let Ok(finder) = Finder::on_curves(std::slice::from_ref(curve), options) else {
        return false;
    };
    let on_curve = |p: DVec3| finder.nearest(p).is_ok_and(|n| n.distance <= tol);
    border
        .samples()
        .all(|p| on_path(p) || back.iter().any(|b| on_curve(b(p))))
}

/// The surface of a curve turned about an axis that the border goes round; `None` if there is none, or that cannot be told from
/// the vertices.
pub(super) fn turned(border: &Border<'_>, curve: &CurveRef, axis: &Frame) -> Option<SurfaceRef> {
    let tol = near(border);
    let ends = curve.ends().map(|p| axis.coordinates(p));
    let radius = |p: DVec3| p.truncate().length();
    let far = if radius(ends[0]) >= radius(ends[1]) {
        ends[0]
    } else {
        ends[1]
    };
    let wide = radius(far);
    // On the same circle?
    let level = |p: DVec3, q: DVec3| (radius(p) - radius(q)).hypot(p.z - q.z) <= tol;
    // Angles that are a whole turn but for rounding are none.
    let angle = |p: DVec3, from: DVec3| {
        let a = (from.x * p.y - from.y * p.x)
            .atan2(from.x * p.x + from.y * p.y)
            .rem_euclid(TAU);
        if a * wide <= tol || (TAU - a) * wide <= tol {
            if a > 1.0 { a - TAU } else { a }
        } else {
            a
        }
    };
    if wide <= tol {
        return None;
    }
    let places = border.vertices().map(|p| axis.coordinates(p));
    let angles = places.filter(|p| level(*p, far)).map(|p| angle(p, far));
    let [a, b] = two(angles, tol / wide)?;
    let whole = [[a, TAU]];
    let parts = [[a, b - a], [b, TAU - (b - a)]];
    let candidates: &[[f64; 2]] = if a == b { &whole } else { &parts };
    candidates.iter().find_map(|&[start, angle_of_turn]| {
        let start = if start.abs() <= EXACT { 0.0 } else { start };
        let turn = angle_of_turn;
        let about = |by: f64| {
            let (s, c) = by.sin_cos();
            move |p: DVec3| {
                let p = axis.coordinates(p);
                axis.point(DVec3::new(p.x * c + p.y * s, p.y * c - p.x * s, p.z))
            }
        };
        let (to_first, to_last) = (about(start), about(start + turn));
        let on_path = |p: DVec3| {
            let p = axis.coordinates(p);
            ends.iter().any(|e| {
                let slack = tol / radius(*e).max(tol);
                let past = (angle(p, *e) - start).rem_euclid(TAU);
                level(p, *e) && (past <= turn + slack || past >= TAU - slack)
            })
        };
        if !goes_round(border, curve, tol, on_path, [&to_first, &to_last]) {
            return None;
        }
        let options = RevolutionOptions {
            start,
            angle: turn,
            ..RevolutionOptions::default()
        };
        let surface = Revolution::new(curve.clone(), *axis, options).ok()?;
        Some(Arc::new(surface) as SurfaceRef)
    })
}

/// A curve moved by a vector.
pub(super) fn at(curve: &CurveRef, by: DVec3) -> Result<CurveRef, String> {
    if by == DVec3::ZERO {
        return Ok(curve.clone());
    }
    let map = DAffine3::from_translation(by);
    Ok(match curve.to_nurbs() {
        Some(n) => Arc::new(n.transformed(&map)),
        None => Arc::new(Transformed::new(curve.clone(), map).map_err(|e| e.to_string())?),
    })
}

/// The surface of a curve moved along a vector that the border goes round; `None` if there is none, or that cannot be told from
/// the vertices.
pub(super) fn moved(border: &Border<'_>, curve: &CurveRef, vector: DVec3) -> Option<SurfaceRef> {
    let tol = near(border);
    let (way, length) = (vector.normalize(), vector.length());
    let ends = curve.ends();
    let height = |p: DVec3, from: DVec3| {
        let h = (p - from).dot(way);
        ((p - from).distance(way * h) <= tol).then_some(h)
    };
    let heights = border.vertices().filter_map(|p| height(p, ends[0]));
    let [lo, hi] = two(heights, tol)?;
    if lo == hi {
        return None;
    }
    let on_path = |p: DVec3| {
        ends.iter()
            .filter_map(|e| height(p, *e))
            .any(|h| (lo - tol..=hi + tol).contains(&h))
    };
    if !goes_round(
        border,
        curve,
        tol,
        on_path,
        [&|p| p - way * lo, &|p| p - way * hi],
    ) {
        return None;
    }
    // As the file states it, where it does.
    let by = |h: f64| {
        if h.abs() <= EXACT * length {
            DVec3::ZERO
        } else if (h - length).abs() <= SAME * length {
            vector
        } else {
            way * h
        }
    };
    let [first, last] = [lo, hi].map(|h| at(curve, by(h)));
    let surface = ruled(first.ok()?, last.ok()?, Dir::U).ok()?;
    Some(Arc::new(surface))
}
