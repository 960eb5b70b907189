//! Curves and surfaces as entities.

use super::WriteError;
use super::conic::Conic;
use super::forms::{CurveShape, SplineCurve, SplineSurface, SurfaceShape};
use super::out::Out;
use glam::DVec3;
use nappe::Frame;
use nappe::surface::Elementary;

/// A surface in the file.
pub(super) struct Written {
    pub(super) id: u64,
    /// Whether its normal is that of the surface it stands for.
    pub(super) same: bool,
}

/// A curve. Lines and ellipses have no name: what trims them has it.
pub(super) fn curve(out: &mut Out<'_>, shape: CurveShape, name: &str) -> Result<u64, WriteError> {
    Ok(match shape {
        CurveShape::Conic(Conic::Line { from, along }) => {
            let point = out.point(from)?;
            let vector = out.vector(along, 1.0)?;
            out.open("LINE")
                .text("")
                .reference(point)
                .reference(vector)
                .close()?
        }
        CurveShape::Conic(Conic::Ellipse { center, x, z, a, b }) => {
            let place = out.placement(center, z, x)?;
            if a == b {
                out.open("CIRCLE")
                    .text("")
                    .reference(place)
                    .real(a)
                    .close()?
            } else {
                out.open("ELLIPSE")
                    .text("")
                    .reference(place)
                    .real(a)
                    .real(b)
                    .close()?
            }
        }
        CurveShape::Spline(spline) => spline_curve(out, spline, name)?,
    })
}

fn counts(out: &mut Out<'_>, times: &[usize]) {
    out.list();
    for n in times {
        out.count(*n);
    }
    out.end();
}

fn spline_curve(out: &mut Out<'_>, s: SplineCurve, name: &str) -> Result<u64, WriteError> {
    let count = s.points.len();
    let first = out.points(s.points)?;
    let rational = s.weights.is_some();
    if rational {
        out.open("(BOUNDED_CURVE()B_SPLINE_CURVE");
    } else {
        out.open("B_SPLINE_CURVE_WITH_KNOTS").text(name);
    }
    out.count(s.degree)
        .references_from(first, count)
        .word(".UNSPECIFIED.")
        .flag(s.closed)
        .word(".F.");
    if rational {
        out.raw(")B_SPLINE_CURVE_WITH_KNOTS(");
    }
    counts(out, &s.knots.times);
    out.reals(s.knots.distinct).word(".UNSPECIFIED.");
    if let Some(weights) = s.weights {
        out.raw(")CURVE()GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE(");
        out.reals(weights);
        out.raw(")REPRESENTATION_ITEM(");
        out.text(name).end();
    }
    Ok(out.close()?)
}

/// A surface.
pub(super) fn surface(out: &mut Out<'_>, shape: SurfaceShape) -> Result<Written, WriteError> {
    let (id, same) = match shape {
        SurfaceShape::Elementary(e) => elementary(out, &e)?,
        SurfaceShape::Turned { curve, axis, same } => (turned(out, curve, &axis)?, same),
        SurfaceShape::Moved { curve, along, same } => (moved(out, curve, along)?, same),
        SurfaceShape::Spline(spline) => (spline_surface(out, spline)?, true),
    };
    Ok(Written { id, same })
}

/// An elementary surface, and whether its normal in the file is that which it has here.
fn elementary(out: &mut Out<'_>, e: &Elementary) -> Result<(u64, bool), WriteError> {
    let place = |out: &mut Out<'_>, f: &Frame| out.placement(f.origin(), f.z(), f.x());
    Ok(match e {
        Elementary::Plane { origin, normal } => {
            let frame =
                Frame::along(*origin, *normal).map_err(|e| WriteError::Shape(e.to_string()))?;
            let at = place(out, &frame)?;
            (out.open("PLANE").text("").reference(at).close()?, true)
        }
        Elementary::Cylinder {
            axis,
            radius,
            outward,
        } => {
            let at = place(out, axis)?;
            let id = out
                .open("CYLINDRICAL_SURFACE")
                .text("")
                .reference(at)
                .real(*radius)
                .close()?;
            (id, *outward)
        }
        Elementary::Cone {
            axis,
            slope,
            outward,
        } => {
            let at = place(out, axis)?;
            let half = slope.atan();
            let id = out
                .open("CONICAL_SURFACE")
                .text("")
                .reference(at)
                .real(0.0)
                .real(half)
                .close()?;
            (id, *outward)
        }
        Elementary::Sphere {
            frame,
            radius,
            outward,
        } => {
            let at = place(out, frame)?;
            let id = out
                .open("SPHERICAL_SURFACE")
                .text("")
                .reference(at)
                .real(*radius)
                .close()?;
            (id, *outward)
        }
        Elementary::Torus {
            axis,
            major,
            minor,
            outward,
        } => {
            let at = place(out, axis)?;
            let keyword = if major < minor {
                "DEGENERATE_TOROIDAL_SURFACE"
            } else {
                "TOROIDAL_SURFACE"
            };
            out.open(keyword)
                .text("")
                .reference(at)
                .real(*major)
                .real(*minor);
            if major < minor {
                out.word(".T.");
            }
            (out.close()?, *outward)
        }
    })
}

fn turned(out: &mut Out<'_>, curve: SplineCurve, axis: &Frame) -> Result<u64, WriteError> {
    let curve = spline_curve(out, curve, "")?;
    let origin = out.point(axis.origin())?;
    let z = out.direction(axis.z())?;
    let axis = out
        .open("AXIS1_PLACEMENT")
        .text("")
        .reference(origin)
        .reference(z)
        .close()?;
    let out = out.open("SURFACE_OF_REVOLUTION").text("");
    Ok(out.reference(curve).reference(axis).close()?)
}

fn moved(out: &mut Out<'_>, curve: SplineCurve, along: DVec3) -> Result<u64, WriteError> {
    let curve = spline_curve(out, curve, "")?;
    let vector = out.vector(along, along.length())?;
    let out = out.open("SURFACE_OF_LINEAR_EXTRUSION").text("");
    Ok(out.reference(curve).reference(vector).close()?)
}

fn spline_surface(out: &mut Out<'_>, s: SplineSurface) -> Result<u64, WriteError> {
    let rows = s.points.len() / s.columns;
    let first = out.points(s.points)?;
    let rational = s.weights.is_some();
    if rational {
        out.open("(BOUNDED_SURFACE()B_SPLINE_SURFACE");
    } else {
        out.open("B_SPLINE_SURFACE_WITH_KNOTS").text("");
    }
    let [u, v] = s.degrees;
    out.count(u).count(v).list();
    for row in 0..rows {
        out.references_from(first + (row * s.columns) as u64, s.columns);
    }
    out.end().word(".UNSPECIFIED.");
    let [u, v] = s.closed;
    out.flag(u).flag(v).word(".F.");
    if rational {
        out.raw(")B_SPLINE_SURFACE_WITH_KNOTS(");
    }
    let [u, v] = s.knots;
    counts(out, &u.times);
    counts(out, &v.times);
    out.reals(u.distinct)
        .reals(v.distinct)
        .word(".UNSPECIFIED.");
    if let Some(weights) = s.weights {
        out.raw(")GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(");
        out.list();
        for row in weights.chunks(s.columns) {
            out.reals(row.iter().copied());
        }
        out.end();
        out.raw(")REPRESENTATION_ITEM('')SURFACE()");
    }
    Ok(out.close()?)
}
