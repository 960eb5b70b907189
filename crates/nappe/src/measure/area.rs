//! The area of a surface and the volume inside closed surfaces.

use super::integral::{IntegralOptions, Measured, estimate, integrate, measured};
use super::taylor::Taylor;
use crate::box3::Box3;
use crate::interval::Interval;
use crate::mesh::{Certainty, Joint, joints};
use crate::surface::{Side, Surface, SurfaceRef};
use glam::DVec3;
use thiserror::Error;

/// `r_u × r_v` as Taylor polynomials.
fn normal(jet: &[Box3], degree: usize) -> [Taylor; 3] {
    let [u, v] = [[1, 0], [0, 1]].map(|d| Taylor::vector(jet, d, degree));
    Taylor::cross(&u, &v)
}

/// The area `∫∫ |r_u × r_v| du dv`, in the square of the unit of length.
///
/// `options.relative` is relative to the area. The result is proven unless the surface cannot enclose its derivatives.
pub fn area(surface: &dyn Surface, options: &IntegralOptions) -> Measured {
    let integrand = |jet: &[Box3], degree: usize| Taylor::square(&normal(jet, degree)).sqrt();
    let enough = |value: f64| options.relative * value.abs();
    let found = integrate(surface, &integrand, enough, options.budget);
    if found.is_finite() {
        measured(found)
    } else {
        estimate(surface, &|d| d[1].cross(d[2]).length())
    }
}

/// Why surfaces enclose no volume.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum VolumeError {
    /// A side meets no other.
    #[error("surface {surface} is open along its {side} side: nothing within {weld:e} meets it")]
    Open {
        /// The index of the surface.
        surface: usize,
        /// The side.
        side: Side,
        /// The distance within which sides count as one.
        weld: f64,
    },
    /// Two surfaces meet with opposite normals.
    #[error(
        "surface {} (its {} side) and surface {} (its {} side) have normals on different sides: turn one over",
        first.0, first.1, second.0, second.1
    )]
    Orientation {
        /// One surface and side.
        first: (usize, Side),
        /// The other.
        second: (usize, Side),
    },
    /// More than two sides meet.
    #[error("more than two sides meet along the {side} side of surface {surface}")]
    Branched {
        /// The index of the surface.
        surface: usize,
        /// The side.
        side: Side,
    },
}

/// The default distance within which sides count as one, relative to the box.
const WELD: f64 = 1e-7;

/// The volume that closed surfaces enclose: `⅓ ∮ (r - c)·n dA`, positive if the normals point outwards.
///
/// The surfaces must be closed (each side meets exactly one other within `weld`, or is one point; `None`: 10⁻⁷ of the
/// box) and have their normals on the same side everywhere; checked. `options.relative` is relative to the cube of the
/// diagonal of the box. Surfaces that cross each other are not noticed: each part counts as often as it is enclosed.
///
/// The integral is proven. Where sides meet with a gap g over a length L at a distance R from c, the missing strip adds up
/// to `⅓ g L R`, which is included; as gaps are sampled, the result is then an estimate unless the gaps are no more
/// than rounding errors.
pub fn volume(
    surfaces: &[SurfaceRef],
    weld: Option<f64>,
    options: &IntegralOptions,
) -> Result<Measured, VolumeError> {
    let hull = surfaces
        .iter()
        .map(|s| s.bounds(s.domain()))
        .reduce(Box3::hull)
        .unwrap_or(Box3::ZERO);
    let size = hull.diagonal();
    let weld = weld.unwrap_or(WELD * size);
    let gaps = closed(surfaces, weld)?;
    let centre = if hull.is_finite() {
        hull.mid()
    } else {
        DVec3::ZERO
    };
    let third = Interval::ONE / Interval::point(3.0);
    let integrand = |jet: &[Box3], degree: usize| {
        let n = normal(jet, degree);
        let terms = [0, 1, 2].map(|axis| {
            let mut r = Taylor::coordinate(jet, axis, [0, 0], degree);
            r.c[0] = r.c[0] - Interval::point(centre.to_array()[axis]);
            r.mul(&n[axis])
        });
        terms[0].add(&terms[1]).add(&terms[2]).scale(third)
    };
    let enough = options.relative * size.powi(3) / surfaces.len().max(1) as f64;
    let mut sum = Interval::ZERO;
    let mut estimated: Option<Measured> = None;
    for s in surfaces {
        let part = integrate(s.as_ref(), &integrand, |_| enough, options.budget);
        if part.is_finite() {
            sum = sum + part;
        } else {
            let e = estimate(s.as_ref(), &|d| (d[0] - centre).dot(d[1].cross(d[2])) / 3.0);
            sum = sum + Interval::point(e.value).inflate(e.certainty.error());
            estimated = Some(e);
        }
    }
    let rounding = ROUNDING * (size + hull.to_array().iter().fold(0.0, |a: f64, i| a.max(i.mag())));
    let mut proven = estimated.is_none();
    let mut strips = 0.0;
    for joint in &gaps {
        strips += (joint.gap + rounding) * joint.length * size / 3.0;
        proven &= joint.gap <= rounding;
    }
    let result = measured(sum);
    let error = result.certainty.error() + strips;
    Ok(Measured {
        certainty: if proven {
            Certainty::Bounded(error)
        } else {
            Certainty::Estimated(error)
        },
        ..result
    })
}

/// Gaps below this share of the coordinates are rounding errors of the two surfaces.
const ROUNDING: f64 = 1e-12;

/// Checks that the surfaces close up; returns the joints.
fn closed(surfaces: &[SurfaceRef], weld: f64) -> Result<Vec<Joint>, VolumeError> {
    let found = joints(surfaces, weld);
    for (surface, sides) in found.open.iter().enumerate() {
        if let Some(&side) = sides.first() {
            return Err(VolumeError::Open {
                surface,
                side,
                weld,
            });
        }
    }
    let mut seen: Vec<(usize, Side)> = Vec::new();
    // The border runs counter-clockwise: along u in the south, against v in the west.
    let forward = |s: Side| matches!(s, Side::South | Side::East);
    for j in &found.joints {
        if seen.contains(&j.first) {
            let (surface, side) = j.first;
            return Err(VolumeError::Branched { surface, side });
        }
        seen.push(j.first);
        if (forward(j.first.1) == forward(j.second.1)) != j.reversed {
            return Err(VolumeError::Orientation {
                first: j.first,
                second: j.second,
            });
        }
    }
    Ok(found.joints)
}
