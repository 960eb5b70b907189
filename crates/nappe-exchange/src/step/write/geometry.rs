//! Curves and surfaces as entities.

use super::WriteError;
use super::conic::{Conic, conic};
use super::out::Out;
use nappe::exact::{to_nurbs_or_approximate, to_nurbs_or_approximate_curve};
use nappe::mesh::Certainty;
use nappe::surface::{Elementary, Surface};
use nappe::{Curve, Frame, NurbsCurve, NurbsSurface};

/// A surface in the file.
pub(super) struct Written {
    pub(super) id: u64,
    /// Whether its normal is that of the surface it stands for.
    pub(super) same: bool,
    /// How far it is from that.
    pub(super) certainty: Certainty,
}

/// A curve in the file.
pub(super) struct Curved {
    pub(super) id: u64,
    /// Whether it ends where the curve ends that it stands for; lines and ellipses go on.
    pub(super) ends: bool,
    /// How far it is from that.
    pub(super) certainty: Certainty,
}

/// A curve. Lines and ellipses have no name: what trims them has it.
pub(super) fn curve(
    out: &mut Out<'_>,
    curve: &dyn Curve,
    name: &str,
    tol: f64,
) -> Result<Curved, WriteError> {
    let form =
        to_nurbs_or_approximate_curve(curve, tol).map_err(|e| WriteError::Shape(e.to_string()))?;
    let nurbs = form.nurbs;
    let conic = conic(&nurbs);
    let ends = conic.is_none();
    let id = match conic {
        Some(Conic::Line { from, along }) => {
            let point = out.point(from)?;
            let direction = out.direction(along.normalize())?;
            let vector = out
                .open("VECTOR")
                .text("")
                .reference(direction)
                .real(1.0)
                .close()?;
            out.open("LINE")
                .text("")
                .reference(point)
                .reference(vector)
                .close()?
        }
        Some(Conic::Ellipse { center, x, z, a, b }) => {
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
        None => {
            let clamped = if nurbs.basis().is_clamped() {
                nurbs
            } else {
                nurbs
                    .clamped()
                    .map_err(|e| WriteError::Shape(e.to_string()))?
            };
            spline_curve(out, &clamped, name)?
        }
    };
    Ok(Curved {
        id,
        ends,
        certainty: form.certainty,
    })
}

/// Distinct knots and how often each occurs.
fn knots(all: &[f64]) -> (Vec<usize>, Vec<f64>) {
    let (mut times, mut distinct): (Vec<usize>, Vec<f64>) = (Vec::new(), Vec::new());
    for k in all {
        match (times.last_mut(), distinct.last()) {
            (Some(n), Some(last)) if last == k => *n += 1,
            _ => {
                times.push(1);
                distinct.push(*k);
            }
        }
    }
    (times, distinct)
}

fn counts(out: &mut Out<'_>, times: &[usize]) {
    out.list();
    for n in times {
        out.count(*n);
    }
    out.end();
}

fn spline_curve(out: &mut Out<'_>, n: &NurbsCurve, name: &str) -> Result<u64, WriteError> {
    let ids = out.points(&n.control_points())?;
    let (times, distinct) = knots(n.knots());
    let [first, last] = n.ends();
    let rational = n.is_rational();
    if rational {
        out.open("(BOUNDED_CURVE()B_SPLINE_CURVE");
    } else {
        out.open("B_SPLINE_CURVE_WITH_KNOTS").text(name);
    }
    out.count(n.degree()).references(&ids).word(".UNSPECIFIED.");
    out.flag(first == last).word(".F.");
    if rational {
        out.raw(")B_SPLINE_CURVE_WITH_KNOTS(");
    }
    counts(out, &times);
    out.reals(distinct).word(".UNSPECIFIED.");
    if rational {
        out.raw(")CURVE()GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE(");
        out.reals(n.weights());
        out.raw(")REPRESENTATION_ITEM(");
        out.text(name).end();
    }
    Ok(out.close()?)
}

/// A surface.
pub(super) fn surface(
    out: &mut Out<'_>,
    surface: &dyn Surface,
    tol: f64,
) -> Result<Written, WriteError> {
    if let Some(e) = surface.elementary() {
        let (id, same) = elementary(out, &e)?;
        return Ok(Written {
            id,
            same,
            certainty: Certainty::Exact,
        });
    }
    let form =
        to_nurbs_or_approximate(surface, tol).map_err(|e| WriteError::Shape(e.to_string()))?;
    let nurbs = form.nurbs;
    let clamped = nurbs.basis_u().is_clamped() && nurbs.basis_v().is_clamped();
    let nurbs = if clamped {
        nurbs
    } else {
        nurbs
            .clamped()
            .map_err(|e| WriteError::Shape(e.to_string()))?
    };
    let id = spline_surface(out, &nurbs)?;
    Ok(Written {
        id,
        same: true,
        certainty: form.certainty,
    })
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

fn spline_surface(out: &mut Out<'_>, n: &NurbsSurface) -> Result<u64, WriteError> {
    let [rows, columns] = n.size();
    let net = out.points(&n.control_points())?;
    let rational = n.is_rational();
    if rational {
        out.open("(BOUNDED_SURFACE()B_SPLINE_SURFACE");
    } else {
        out.open("B_SPLINE_SURFACE_WITH_KNOTS").text("");
    }
    out.count(n.basis_u().degree())
        .count(n.basis_v().degree())
        .list();
    net.chunks(columns).for_each(|row| {
        out.references(row);
    });
    out.end().word(".UNSPECIFIED.");
    let points = n.homogeneous();
    let same = |a: usize, b: usize| points[a] == points[b];
    let closed_u = (0..columns).all(|j| same(j, (rows - 1) * columns + j));
    let closed_v = (0..rows).all(|i| same(i * columns, i * columns + columns - 1));
    out.flag(closed_u).flag(closed_v).word(".F.");
    if rational {
        out.raw(")B_SPLINE_SURFACE_WITH_KNOTS(");
    }
    let (u, v) = (knots(n.basis_u().knots()), knots(n.basis_v().knots()));
    counts(out, &u.0);
    counts(out, &v.0);
    out.reals(u.1).reals(v.1).word(".UNSPECIFIED.");
    if rational {
        out.raw(")GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(");
        out.list();
        for row in n.weights().chunks(columns) {
            out.reals(row.iter().copied());
        }
        out.end();
        out.raw(")REPRESENTATION_ITEM('')SURFACE()");
    }
    Ok(out.close()?)
}
