//! Lines and ellipses among NURBS curves.

use glam::{DVec3, Vec4Swizzles};
use nappe::{Curve, NurbsCurve};

/// Relative to the size: points that near lie on a line or an ellipse. As for surfaces in the kernel: what rounding of
/// well-made curves leaves.
const SAME: f64 = 1e-13;
/// A middle weight from here on is that of a nearly straight arc, whose centre is lost.
const STRAIGHT: f64 = 1.0 - 1e-9;
/// Points of each piece that are looked at: one more than the four where a rational quadratic curve can meet an ellipse it does
/// not lie on.
const POINTS: usize = 6;

/// The elementary curve that a curve is a part of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Conic {
    /// From the start straight on.
    Line { from: DVec3, along: DVec3 },
    /// Semi-axes along x and square to it; the curve runs counter-clockwise seen from the tip of z.
    Ellipse {
        center: DVec3,
        x: DVec3,
        z: DVec3,
        a: f64,
        b: f64,
    },
}

/// What a NURBS curve is in elementary geometry; `None` if it is neither a line nor an ellipse, or that is not known.
pub(super) fn conic(curve: &NurbsCurve) -> Option<Conic> {
    line(curve).or_else(|| ellipse(curve))
}

fn line(curve: &NurbsCurve) -> Option<Conic> {
    let points = curve.control_points();
    let (from, to) = (*points.first()?, *points.last()?);
    let along = (to - from).try_normalize()?;
    let size = from.distance(to);
    let mut reached = 0.0;
    for p in &points {
        let t = along.dot(*p - from);
        let off = (*p - from - along * t).length();
        if off > SAME * size + f64::EPSILON * p.length()
            || t < reached - SAME * size
            || !curve_starts(curve)
        {
            return None;
        }
        reached = t;
    }
    Some(Conic::Line {
        from,
        along: to - from,
    })
}

/// Whether the end points of the net are those of the curve.
fn curve_starts(curve: &NurbsCurve) -> bool {
    curve.basis().is_clamped()
}

fn ellipse(curve: &NurbsCurve) -> Option<Conic> {
    if curve.degree() != 2 || !curve.is_rational() {
        return None;
    }
    let pieces = curve.bezier_pieces().ok()?;
    let [p0, p1, p2] = *pieces.first()?.homogeneous() else {
        return None;
    };
    let w = p1.w / (p0.w * p2.w).sqrt();
    if w.is_nan() || w.abs() >= STRAIGHT {
        return None;
    }
    let [a, m, b] = [p0, p1, p2].map(|p| p.xyz() / p.w);
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let s = 1.0 - w * w;
    let center = (middle - m * (w * w)) / s;
    // Two conjugate semi-diameters.
    let (f, g) = ((m - middle) * (w / s), half / s.sqrt());
    let z = f.cross(g).try_normalize()?;
    let on = |p: DVec3| {
        let d = p - center;
        let det = f.cross(g).dot(z);
        let (x, y) = (d.cross(g).dot(z) / det, f.cross(d).dot(z) / det);
        let size = f.length().max(g.length());
        let slack = SAME * size + 4.0 * f64::EPSILON * p.length();
        (x.hypot(y) - 1.0).abs() * f.length().min(g.length()) <= slack && d.dot(z).abs() <= slack
    };
    for piece in &pieces {
        let d = piece.domain();
        let at = |i: usize| d.lo + (d.hi - d.lo) * (i as f64 / (POINTS - 1) as f64);
        if (0..POINTS).any(|i| !on(piece.point(at(i)))) {
            return None;
        }
    }
    let (x, long, short) = axes(f, g, a - center);
    Some(Conic::Ellipse {
        center,
        x,
        z,
        a: long,
        b: short,
    })
}

/// The direction of the first axis and both semi-axes of the ellipse with two conjugate semi-diameters; of a circle the first
/// points to its start.
fn axes(f: DVec3, g: DVec3, start: DVec3) -> (DVec3, f64, f64) {
    let (ff, gg, fg) = (f.length_squared(), g.length_squared(), f.dot(g));
    let size = ff.max(gg);
    if (ff - gg).abs() <= 8.0 * SAME * size && fg.abs() <= 8.0 * SAME * size {
        let radius = start.length();
        return (start.normalize(), radius, radius);
    }
    let t = 0.5 * (2.0 * fg).atan2(ff - gg);
    let p = f * t.cos() + g * t.sin();
    let q = g * t.cos() - f * t.sin();
    let (p, q) = if p.length() >= q.length() {
        (p, q)
    } else {
        (q, p)
    };
    (p.normalize(), p.length(), q.length())
}
