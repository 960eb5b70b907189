//! Surfaces, endless ones included.

use super::curves::{self, Course};
use super::file::{Args, Got};
use super::place::Space;
use super::splines;
use glam::DVec3;
use nappe::{Frame, SurfaceRef};
use std::sync::Arc;

/// A surface as a file states it, oriented as the standard says.
#[derive(Clone, Debug)]
pub(super) enum Expanse {
    /// The normal is z.
    Plane(Frame),
    /// The normal points away from the axis, as for the next.
    Cylinder { frame: Frame, radius: f64 },
    /// `radius` at the frame's origin, growing along z by `slope`.
    Cone {
        frame: Frame,
        radius: f64,
        slope: f64,
    },
    /// The normal points out.
    Sphere { frame: Frame, radius: f64 },
    /// The normal points out of the tube.
    Torus {
        frame: Frame,
        major: f64,
        minor: f64,
    },
    /// u along the curve, v along the vector.
    Extrusion { course: Course, vector: DVec3 },
    /// u round the axis, v along the curve.
    Revolution { course: Course, frame: Frame },
    /// A surface with sides.
    Bounded(SurfaceRef),
    /// The other way round.
    Flipped(Box<Expanse>),
}

/// Surfaces made of surfaces are followed so far.
const DEPTH: usize = 16;

/// The surface with this number.
pub(super) fn expanse(space: &Space<'_>, id: u64, depth: usize) -> Got<Expanse> {
    if depth > DEPTH {
        return Err(space
            .file
            .refused(id, "surfaces are made of surfaces without end"));
    }
    let record = space.file.record(id)?;
    let args = record.args();
    let frame = || space.frame(args.reference(1)?);
    Ok(match record.kind() {
        "PLANE" => Expanse::Plane(frame()?),
        "CYLINDRICAL_SURFACE" => Expanse::Cylinder {
            frame: frame()?,
            radius: length(space, &args, 2)?,
        },
        "CONICAL_SURFACE" => {
            let radius = space.length(args.real(2)?);
            let slope = (args.real(3)? * space.radians).tan();
            if !(radius >= 0.0 && radius.is_finite() && slope.is_finite() && slope != 0.0) {
                let why =
                    format!("its radius is {radius} and the tangent of its half angle {slope}");
                return Err(record.refused(why));
            }
            Expanse::Cone {
                frame: frame()?,
                radius,
                slope,
            }
        }
        "SPHERICAL_SURFACE" => Expanse::Sphere {
            frame: frame()?,
            radius: length(space, &args, 2)?,
        },
        "TOROIDAL_SURFACE" | "DEGENERATE_TOROIDAL_SURFACE" => Expanse::Torus {
            frame: frame()?,
            major: length(space, &args, 2)?,
            minor: length(space, &args, 3)?,
        },
        "SURFACE_OF_LINEAR_EXTRUSION" => Expanse::Extrusion {
            course: curves::course(space, args.reference(1)?, 0)?,
            vector: space.vector(args.reference(2)?)?,
        },
        "SURFACE_OF_REVOLUTION" => Expanse::Revolution {
            course: curves::course(space, args.reference(1)?, 0)?,
            frame: space.frame(args.reference(2)?)?,
        },
        "RECTANGULAR_TRIMMED_SURFACE" | "CURVE_BOUNDED_SURFACE" => {
            // What bounds a face are its own edges, which lie within.
            let inner = expanse(space, args.reference(1)?, depth + 1)?;
            let trimmed = record.kind().starts_with('R');
            if trimmed && args.flag(6)? != args.flag(7)? {
                Expanse::Flipped(Box::new(inner))
            } else {
                inner
            }
        }
        _ if splines::is_surface(&record) => {
            Expanse::Bounded(Arc::new(splines::surface(space, &record)?))
        }
        "OFFSET_SURFACE" => return Err(record.refused("offset surfaces are not read")),
        _ => return Err(record.refused("surfaces of this kind are not read")),
    })
}

fn length(space: &Space<'_>, args: &Args<'_, '_>, i: usize) -> Got<f64> {
    let x = space.length(args.real(i)?);
    if x > 0.0 && x.is_finite() {
        return Ok(x);
    }
    Err(args.refused(format!(
        "its parameter {} is {x}, not a positive length",
        i + 1
    )))
}
