//! The volume inside closed surfaces.

use super::bodies::{Body, bodies};
use super::integral::{IntegralOptions, Measured};
use super::solid::{Moments, moments};
use super::strip::{length, strip};
use super::tear::tear;
use crate::box3::Box3;
use crate::breaks::Breaks;
use crate::interval::Interval;
use crate::mesh::closing::within;
use crate::mesh::{Joint, Joints, joints};
use crate::surface::{Dir, Side, SurfaceRef};
use std::collections::HashSet;
use thiserror::Error;

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
    /// A surface jumps: what it encloses is not told from what flows through the slit.
    #[error("surface {surface} is torn at {dir} = {at}: it jumps there")]
    Torn {
        /// The index of the surface.
        surface: usize,
        /// The parameter at which it jumps.
        dir: Dir,
        /// The value of the parameter.
        at: f64,
    },
    /// Normals that agree along all shared sides are impossible, as on a Möbius strip.
    #[error("surface {surface} and those it meets have only one side")]
    OneSided {
        /// The index of the surface.
        surface: usize,
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

/// Closed surfaces that hang together along their sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Shell {
    /// The indices of the surfaces, increasing; true if the normals of a surface point inwards.
    pub surfaces: Vec<(usize, bool)>,
    /// The volume inside, not negative but for its error. Of surfaces that pass through each other (see
    /// [`overlaps`](super::overlaps)) each part counts as often as it is enclosed.
    pub volume: Measured,
}

/// The bodies that surfaces make together, each with its volume `⅓ |∮ (r - c)·n dA|`, or with the reason why it encloses
/// none. Shells may lie inside each other or cross: that is not looked at, so their volumes are not to be added without a
/// thought.
///
/// A shell is closed: each side meets exactly one other within `weld`, or is one point (`None`: 10⁻⁷ of the
/// box; never more than a hundredth of the surface itself, see [`joints`]). Surfaces whose normals disagree are turned,
/// first to agree with their neighbours, then so that the volume is positive.
///
/// The result is proven, for every way to close the gaps along the joints that adds no more area than ruled strips and
/// cones: their area S is bounded along the whole of each joint by Taylor forms, and counts with `⅓ S R`, R being the
/// greatest distance from c. It is an estimate where a surface cannot enclose its derivatives, or where no bound for a
/// joint is found. Cost: `options.budget` boxes for each surface, some hundred enclosures for each joint.
pub fn shells(
    surfaces: &[SurfaceRef],
    weld: Option<f64>,
    options: &IntegralOptions,
) -> Vec<Result<Shell, VolumeError>> {
    let found = shells_with(surfaces, weld, options, 0).into_iter();
    found.map(|one| one.map(|(shell, _)| shell)).collect()
}

/// As [`shells`], with the moments of each up to a degree, 0 or 2.
pub(super) fn shells_with(
    surfaces: &[SurfaceRef],
    weld: Option<f64>,
    options: &IntegralOptions,
    degree: usize,
) -> Vec<Result<(Shell, Moments), VolumeError>> {
    let weld = weld.unwrap_or_else(|| WELD * hull(surfaces.iter()).diagonal());
    let joined = joints(surfaces, weld);
    let mut neighbours = vec![Vec::new(); surfaces.len()];
    for j in &joined.joints {
        let (a, b, turned) = (j.first.0, j.second.0, j.is_turned());
        neighbours[a].push((b, turned));
        neighbours[b].push((a, turned));
    }
    let branched = branched(&joined.joints);
    let one = |body: Body| match flaw(surfaces, &joined, &branched, &body, weld) {
        Some(flaw) => Err(flaw),
        None => Ok(shell(surfaces, &joined, body.parts, weld, options, degree)),
    };
    bodies(&neighbours).into_iter().map(one).collect()
}

/// The volume that closed surfaces enclose, with the signs of their normals: `⅓ ∮ (r - c)·n dA`, positive if the normals
/// point outwards. So a shell inside another, with normals that point into it, is a hollow.
///
/// As [`shells`], but the normals of neighbours must agree; checked.
pub fn volume(
    surfaces: &[SurfaceRef],
    weld: Option<f64>,
    options: &IntegralOptions,
) -> Result<Measured, VolumeError> {
    let shells = shells(surfaces, weld, options);
    let shells = shells.into_iter().collect::<Result<Vec<Shell>, _>>()?;
    let mixed = |s: &&Shell| s.surfaces.iter().any(|f| f.1 != s.surfaces[0].1);
    if let Some(shell) = shells.iter().find(mixed) {
        let weld = weld.unwrap_or_else(|| WELD * hull(surfaces.iter()).diagonal());
        let part = |k: usize| shell.surfaces.iter().any(|f| f.0 == k);
        let wrong = joints(surfaces, weld).joints.into_iter();
        if let Some(j) = wrong.filter(|j| part(j.first.0)).find(Joint::is_turned) {
            return Err(VolumeError::Orientation {
                first: j.first,
                second: j.second,
            });
        }
    }
    let signed = shells.iter().map(|s| {
        let inwards = s.surfaces.first().is_some_and(|f| f.1);
        Measured {
            value: if inwards {
                -s.volume.value
            } else {
                s.volume.value
            },
            ..s.volume
        }
    });
    Ok(signed.sum())
}

/// Parts in each direction for a box around a surface, as enclosures of a whole domain may be much larger than it.
const PARTS: usize = 4;

/// A box around surfaces.
fn hull<'a>(surfaces: impl Iterator<Item = &'a SurfaceRef>) -> Box3 {
    let own = |s: &SurfaceRef| {
        let [us, vs] = [Dir::U, Dir::V].map(|dir| {
            let breaks = s.breaks(dir);
            let each = PARTS.div_ceil(breaks.pieces());
            let parts = |k: usize| {
                let piece = breaks.piece(k);
                let at = move |i: usize| match i {
                    0 => piece.lo,
                    _ if i == each => piece.hi,
                    _ => piece.lo + (piece.hi - piece.lo) * i as f64 / each as f64,
                };
                (0..each).map(move |i| Interval::new(at(i), at(i + 1)))
            };
            (0..breaks.pieces()).flat_map(parts).collect::<Vec<_>>()
        });
        let pairs = us.iter().flat_map(|&u| vs.iter().map(move |&v| [u, v]));
        pairs.map(|uv| s.bounds(uv)).reduce(Box3::hull)
    };
    surfaces
        .filter_map(own)
        .reduce(Box3::hull)
        .unwrap_or(Box3::ZERO)
}

/// The shell of surfaces that hang together.
fn shell(
    surfaces: &[SurfaceRef],
    joined: &Joints,
    mut body: Vec<(usize, bool)>,
    weld: f64,
    options: &IntegralOptions,
    degree: usize,
) -> (Shell, Moments) {
    body.sort_unstable();
    let hull = hull(body.iter().map(|&(k, _)| &surfaces[k]));
    let own: Vec<_> = body
        .iter()
        .map(|&(k, turned)| (surfaces[k].as_ref(), turned))
        .collect();
    let mut moments = moments(&own, hull, options, degree);
    if moments.is_negative() {
        moments.turn();
        body.iter_mut().for_each(|f| f.1 = !f.1);
    }
    // The distance within which sides were joined: of small surfaces much less than that for the model.
    let joined_within = body
        .iter()
        .flat_map(|&(k, _)| within(surfaces[k].as_ref(), weld));
    let near = joined_within
        .map(|w| w.join.max(w.point))
        .fold(0.0, f64::max);
    let reach = 0.5 * hull.diagonal() * ROUND_UP + near;
    let enough = options.relative * moments.volume().mid().abs() * STRIP_SHARE / reach;
    let holes = body_holes(surfaces, joined, &body, weld, enough);
    moments.open(holes.area, near, reach, holes.proven);
    let shell = Shell {
        surfaces: body,
        volume: moments.measured(),
    };
    (shell, moments)
}

/// Whether the normals of closed surfaces point inwards; `true` for surfaces whose normals count the other way. Only the
/// sign of the volume is asked for, so few boxes do.
pub(crate) fn inside_out<'a>(own: impl Iterator<Item = (&'a SurfaceRef, bool)> + Clone) -> bool {
    let hull = hull(own.clone().map(|s| s.0));
    let own: Vec<_> = own.map(|(s, turned)| (s.as_ref(), turned)).collect();
    let options = IntegralOptions {
        relative: 0.1,
        ..IntegralOptions::default()
    };
    moments(&own, hull, &options, 0).is_negative()
}

/// The holes between the surfaces of a body.
fn body_holes(
    surfaces: &[SurfaceRef],
    joined: &Joints,
    body: &[(usize, bool)],
    weld: f64,
    enough: f64,
) -> Holes {
    let is_own = |k: usize| body.iter().any(|f| f.0 == k);
    let joints: Vec<&Joint> = joined.joints.iter().filter(|j| is_own(j.first.0)).collect();
    let sides = |&(k, _): &(usize, bool)| joined.collapsed[k].iter().map(move |&s| (k, s));
    let points: Vec<(usize, Side)> = body.iter().flat_map(sides).collect();
    holes(surfaces, &joints, &points, weld, enough)
}

/// How the surfaces of a shell meet, and the distance within which they do.
pub(super) fn joints_of(
    surfaces: &[SurfaceRef],
    shell: &Shell,
    weld: Option<f64>,
) -> (Joints, f64) {
    let hull = hull(shell.surfaces.iter().map(|f| &surfaces[f.0]));
    let weld = weld.unwrap_or_else(|| WELD * hull.diagonal());
    (joints(surfaces, weld), weld)
}

/// The area that closes the gaps of a shell, and whether it is proven.
pub(super) fn openings(
    surfaces: &[SurfaceRef],
    shell: &Shell,
    joined: &Joints,
    weld: f64,
    options: &IntegralOptions,
) -> (f64, bool) {
    let hull = hull(shell.surfaces.iter().map(|f| &surfaces[f.0]));
    let reach = 0.5 * hull.diagonal() * ROUND_UP;
    let enough = options.relative * shell.volume.value.abs() * STRIP_SHARE / reach;
    let holes = body_holes(surfaces, joined, &shell.surfaces, weld, enough);
    (holes.area, holes.proven)
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
fn holes(
    surfaces: &[SurfaceRef],
    joints: &[&Joint],
    points: &[(usize, Side)],
    weld: f64,
    enough: f64,
) -> Holes {
    let mut holes = Holes {
        area: 0.0,
        proven: true,
    };
    let mut border = 0.0;
    let side = |(surface, side): (usize, Side)| (surfaces[surface].as_ref(), side);
    let each = enough / joints.len().max(1) as f64;
    for j in joints {
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
    // A border of length l adds l²/4: below this it is small enough.
    let short = (4.0 * enough).sqrt() / points.len().max(1) as f64;
    for &point in points {
        border += length(side(point), short);
    }
    holes.area = (holes.area + 0.25 * border * border) * ROUND_UP;
    holes
}

/// Covers the roundings of sums of positive numbers.
const ROUND_UP: f64 = 1.0 + 1e-12;

/// The leading sides that more than one other side meets.
fn branched(joints: &[Joint]) -> Vec<(usize, Side)> {
    let mut seen = HashSet::new();
    let again = joints.iter().filter(|j| !seen.insert(j.first));
    again.map(|j| j.first).collect()
}

/// Why a body encloses nothing.
fn flaw(
    surfaces: &[SurfaceRef],
    joined: &Joints,
    branched: &[(usize, Side)],
    body: &Body,
    weld: f64,
) -> Option<VolumeError> {
    let mut own: Vec<usize> = body.parts.iter().map(|p| p.0).collect();
    own.sort_unstable();
    let torn = own.iter().find_map(|&surface| {
        let (dir, at) = tear(surfaces[surface].as_ref())?;
        Some(VolumeError::Torn { surface, dir, at })
    });
    let open = || {
        own.iter().find_map(|&surface| {
            let &side = joined.open[surface].first()?;
            let weld = within(surfaces[surface].as_ref(), weld)[side as usize].join;
            Some(VolumeError::Open {
                surface,
                side,
                weld,
            })
        })
    };
    let branched = || {
        let &(surface, side) = branched.iter().find(|b| own.binary_search(&b.0).is_ok())?;
        Some(VolumeError::Branched { surface, side })
    };
    let one_sided = || {
        let surface = body.contradiction?;
        Some(VolumeError::OneSided { surface })
    };
    torn.or_else(open).or_else(branched).or_else(one_sided)
}
