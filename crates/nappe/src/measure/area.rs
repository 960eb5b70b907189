//! The area of a surface and the volume inside closed surfaces.

use super::integral::{IntegralOptions, Measured, estimate, integrate, measured};
use super::strip::{length, strip};
use super::taylor::{Patch, Taylor};
use crate::box3::Box3;
use crate::interval::Interval;
use crate::mesh::shared::Edge;
use crate::mesh::{Certainty, Joints, joints};
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
    let integrand = |patch: &Patch, degree: usize| {
        let [wide, at] = [&patch.wide, &patch.at].map(|j| Taylor::square(&normal(j, degree)));
        [wide.tightened(&at, patch.offset).sqrt(), at.sqrt()]
    };
    let found = integrate(&[surface], &integrand, options)[0];
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
/// box; never more than a hundredth of the surface itself, see [`joints`]) and have their normals on the same side
/// everywhere; checked. Surfaces that cross each other are not noticed here, see [`overlaps`](super::overlaps): each part
/// counts as often as it is enclosed.
///
/// The result is proven, for every way to close the gaps along the joints that adds no more area than ruled strips and
/// cones: their area S is bounded along the whole of each joint by Taylor forms, and counts with `⅓ S R`, R being the
/// greatest distance from c. It is an estimate where a surface cannot enclose its derivatives, or where no bound for a
/// joint is found. Cost: `options.budget` boxes for each surface, some hundred enclosures for each joint.
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
    let joined = closed(surfaces, weld)?;
    let centre = if hull.is_finite() {
        hull.mid()
    } else {
        DVec3::ZERO
    };
    let third = Interval::ONE / Interval::point(3.0);
    let flux = |jet: &[Box3], degree: usize| {
        let n = normal(jet, degree);
        let terms = [0, 1, 2].map(|axis| {
            let mut r = Taylor::coordinate(jet, axis, [0, 0], degree);
            r.c[0] = r.c[0] - Interval::point(centre.to_array()[axis]);
            r.mul(&n[axis])
        });
        terms[0].add(&terms[1]).add(&terms[2]).scale(third)
    };
    let integrand = |p: &Patch, degree: usize| [&p.wide, &p.at].map(|j| flux(j, degree));
    let all: Vec<&dyn Surface> = surfaces.iter().map(|s| s.as_ref()).collect();
    let parts = integrate(&all, &integrand, options);
    let mut sum = Interval::ZERO;
    let mut proven = true;
    for (s, &part) in all.iter().zip(&parts) {
        if part.is_finite() {
            sum = sum + part;
        } else {
            let e = estimate(*s, &|d| (d[0] - centre).dot(d[1].cross(d[2])) / 3.0);
            sum = sum + Interval::point(e.value).inflate(e.certainty.error());
            proven = false;
        }
    }
    let result = measured(sum);
    let reach = 0.5 * size * ROUND_UP + weld;
    let enough = options.relative * result.value.abs() * STRIP_SHARE / reach;
    let holes = holes(&all, &joined, weld, enough);
    let missing = holes.area * reach / 3.0;
    let error = (result.certainty.error() + missing).next_up();
    Ok(Measured {
        certainty: if proven && holes.proven && error.is_finite() {
            Certainty::Bounded(error)
        } else {
            Certainty::Estimated(error)
        },
        ..result
    })
}

/// The share of the error that the strips between sides may have before they are bounded more closely. Larger, and they
/// would spoil the result; smaller, and rounding errors would be measured.
const STRIP_SHARE: f64 = 0.1;

/// What is needed to close surfaces up.
struct Holes {
    area: f64,
    proven: bool,
}

/// Strips along the joints, and what they leave open: segments in the corners and sides that are all but a point. That
/// border is closed, of total length l: each of its loops bounds a cone from one of its points, at most l/2 away, so all
/// cones together have an area of at most l²/4.
fn holes(surfaces: &[&dyn Surface], joined: &Joints, weld: f64, enough: f64) -> Holes {
    let mut holes = Holes {
        area: 0.0,
        proven: true,
    };
    let mut border = 0.0;
    let side = |(surface, side): (usize, Side)| (surfaces[surface], side);
    let each = enough / joined.joints.len().max(1) as f64;
    for j in &joined.joints {
        match strip(side(j.first), side(j.second), weld, each) {
            Some(s) => {
                holes.area += s.area;
                border += s.border;
            }
            None => {
                holes.area += j.gap * j.length;
                border += 2.0 * j.gap;
                holes.proven = false;
            }
        }
    }
    for (surface, sides) in joined.collapsed.iter().enumerate() {
        border += sides
            .iter()
            .map(|&s| length((surfaces[surface], s)))
            .sum::<f64>();
    }
    holes.area = (holes.area + 0.25 * border * border) * ROUND_UP;
    holes
}

/// Covers the roundings of sums of positive numbers.
const ROUND_UP: f64 = 1.0 + 1e-12;

/// Checks that the surfaces close up; returns the joints.
fn closed(surfaces: &[SurfaceRef], weld: f64) -> Result<Joints, VolumeError> {
    let found = joints(surfaces, weld);
    for (surface, sides) in found.open.iter().enumerate() {
        if let Some(&side) = sides.first() {
            let edge = Edge::new(surfaces[surface].as_ref(), side);
            return Err(VolumeError::Open {
                surface,
                side,
                weld: edge.join_within(weld),
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
    Ok(found)
}
