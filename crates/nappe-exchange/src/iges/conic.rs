//! Conic arcs (104).

use super::record::{Got, Record};
use glam::{DVec2, DVec3};
use nappe::CurveRef;
use nappe::curve::{Ellipse, EllipseOptions, conic};
use std::f64::consts::TAU;
use std::sync::Arc;

/// What lies this little off the standard position, relative to the larger coefficients, is rounding.
const STANDARD: f64 = 1e-9;

/// `A x² + B x y + C y² + D x + E y + F = 0` in the plane z = ZT, counter-clockwise from a point to another.
pub(super) fn arc(r: &mut Record) -> Got<CurveRef> {
    let [a, b, c, d, e, f] = [0; 6].map(|_| r.real());
    let (a, b, c, d, e, f) = (a?, b?, c?, d?, e?, f?);
    let z = r.real()?;
    let from = DVec2::new(r.real()?, r.real()?);
    let to = DVec2::new(r.real()?, r.real()?);
    let size = from
        .abs()
        .max(to.abs())
        .max_element()
        .max(f64::MIN_POSITIVE);
    if b * b - 4.0 * a * c < -STANDARD * (a * a).max(c * c) {
        let off = b.abs().max((d / size).abs()).max((e / size).abs());
        let (ra, rb) = ((-f / a).sqrt(), (-f / c).sqrt());
        if off > STANDARD * a.abs().max(c.abs()) || !(ra > 0.0 && rb > 0.0) {
            return Err("an ellipse that is not in its standard position".into());
        }
        let angle = |p: DVec2| (p.y / rb).atan2(p.x / ra);
        let (first, mut last) = (angle(from), angle(to));
        if from == to || last <= first {
            last += TAU;
        }
        let options = EllipseOptions {
            from: first,
            to: last.min(first + TAU),
            normal: DVec3::Z,
            x_direction: Some(DVec3::X),
        };
        let ellipse = Ellipse::new(DVec3::Z * z, [ra, rb], options).map_err(|e| e.to_string())?;
        return Ok(Arc::new(ellipse));
    }
    // The tangents at the ends meet in the middle point of the control polygon.
    let gradient = |p: DVec2| DVec2::new(2.0 * a * p.x + b * p.y + d, b * p.x + 2.0 * c * p.y + e);
    let (g, h) = (gradient(from), gradient(to));
    let det = g.perp_dot(h);
    let (k, l) = (g.dot(from), h.dot(to));
    let meet = DVec2::new(k * h.y - l * g.y, g.x * l - h.x * k) / det;
    // Where the line from there to the middle of the chord meets the conic: at w / (1 + w) of the way from the chord.
    let middle = (from + to) / 2.0;
    let value = |p: DVec2| a * p.x * p.x + b * p.x * p.y + c * p.y * p.y + d * p.x + e * p.y + f;
    let way = meet - middle;
    let square = a * way.x * way.x + b * way.x * way.y + c * way.y * way.y;
    let (linear, constant) = (gradient(middle).dot(way), value(middle));
    let root = (linear * linear - 4.0 * square * constant).sqrt();
    let q = -0.5 * (linear + linear.signum() * root);
    let share = [q / square, constant / q]
        .into_iter()
        .find(|s| *s > 0.0 && *s < 1.0);
    let share = share.ok_or("a conic whose ends are not on one branch")?;
    let points = [from, meet, to].map(|p| p.extend(z));
    conic(points, share / (1.0 - share))
        .map(|c| Arc::new(c) as CurveRef)
        .map_err(|e| e.to_string())
}
