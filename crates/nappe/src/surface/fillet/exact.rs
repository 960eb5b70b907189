//! Fillets whose spine has a formula: between two planes, between a plane and a cylinder, and where both supports are
//! carried into themselves by one motion.

use super::motion::Carried;
use super::rolling_ball::{Cylinder, RollingBall, Track, pieces, prove};
use super::spine::Spine;
use super::{BEYOND, Fillet, FilletError, FilletOptions, PARALLEL, Radius, arc_sections};
use crate::basis::BSplineBasis;
use crate::breaks::Limit;
use crate::exact::{ConicArcs, NurbsSurface};
use crate::frame::Frame;
use crate::interval::Interval;
use crate::surface::Surface;
use crate::surface::turned::carried_round;
use glam::{DVec3, DVec4, Vec4Swizzles};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

type Built = (Fillet, Arc<RollingBall>);

fn build(ball: RollingBall, origin: DVec3) -> Result<Built, FilletError> {
    if let Err((condition, at, margin)) =
        prove(pieces(&ball.breaks), |u| ball.margins(u, Limit::Above))
    {
        let radius = ball.radius_value(at);
        return Err(match condition {
            0 => FilletError::Radius { at, value: radius },
            1 => ball_does_not_reach(&ball.track, at, radius),
            2 => FilletError::Swallowed { at, margin },
            _ => FilletError::SectionsCross { at, radius },
        });
    }
    let ball = Arc::new(ball);
    let fillet = Fillet {
        form: arc_sections(ball.clone(), origin),
        ball: Some(ball.clone()),
        spine: None,
        origin,
        nurbs: None,
        rational: None,
    };
    Ok((fillet, ball))
}

/// The fillet whose path is carried by a motion of both supports, with the proof of its contacts.
pub(super) fn carried(carried: Carried, spine: Spine, radius: f64) -> Result<Fillet, FilletError> {
    let Carried {
        track,
        range,
        origin,
        axis,
        ..
    } = carried;
    let ball = RollingBall::new(track, Radius::Constant(radius), range, false);
    let mut fillet = match axis {
        Some(frame) => torus(build(ball, origin)?, &frame),
        None => straight(ball, origin)?,
    };
    fillet.spine = Some(Arc::new(spine));
    Ok(fillet)
}

/// With the NURBS form of constant sections moved along a straight line.
fn straight(ball: RollingBall, origin: DVec3) -> Result<Fillet, FilletError> {
    let (mut fillet, ball) = build(ball, origin)?;
    if let Radius::Constant(_) = ball.radius {
        let points = [0.0, 1.0].map(|u| section(&ball, origin, u));
        fillet.nurbs = Some(NurbsSurface::from_homogeneous(
            BSplineBasis::bernstein(1),
            BSplineBasis::bernstein(2),
            points.as_flattened().to_vec(),
        ));
        fillet.rational = fillet.nurbs.clone();
    }
    Ok(fillet)
}

/// With the NURBS form of a constant section turned about the cylinder's axis: a piece of a torus.
fn torus((mut fillet, ball): Built, frame: &Frame) -> Fillet {
    if let Radius::Constant(_) = ball.radius {
        let origin = fillet.origin;
        let profile = section(&ball, origin, 0.0)
            .map(|p| frame.components(p.xyz() - origin * p.w).extend(p.w));
        let [from, to] = ball.range;
        let round = ConicArcs::circle(0.0, to - from);
        let points = carried_round(&profile, &round.points, frame.directions(), origin);
        fillet.rational = Some(NurbsSurface::from_homogeneous(
            round.basis,
            BSplineBasis::bernstein(2),
            points,
        ));
    }
    fillet
}

/// The three homogeneous points of a section.
fn section(ball: &RollingBall, origin: DVec3, u: f64) -> [DVec4; 3] {
    let f = ball.values(u);
    let at = |k: usize, w: f64| {
        let p = DVec3::new(f[k], f[k + 1], f[k + 2]);
        (p + origin * w).extend(w)
    };
    [at(0, 1.0), at(3, f[10]), at(6, 1.0)]
}

/// The control points of a support: its hull.
fn hull(s: &dyn Surface) -> Vec<DVec3> {
    s.to_rational()
        .map(|n| n.control_points())
        .unwrap_or_default()
}

/// The range of the hull along a direction, measured from an origin.
fn extent(s: &dyn Surface, origin: DVec3, d: DVec3) -> Interval {
    hull(s)
        .into_iter()
        .map(|p| Interval::point((p - origin).dot(d)))
        .reduce(Interval::hull)
        .unwrap_or(Interval::ENTIRE)
}

/// The part of a line beside both supports, or the part of it that the options take.
fn common_range([a, b]: [Interval; 2], options: &FilletOptions) -> Result<[f64; 2], FilletError> {
    let (lo, hi) = (a.lo.max(b.lo), a.hi.min(b.hi));
    if let Some([from, to]) = options.range {
        let start = if lo.is_finite() { lo } else { 0.0 };
        return Ok([start + from, start + to]);
    }
    if lo < hi {
        Ok([lo, hi])
    } else {
        Err(FilletError::Apart { gap: lo - hi })
    }
}

/// Where a radius is greater than a limit. A variable one is looked at in samples: a contact a little beyond the end
/// of its support between them does no harm, since the fillet itself does not depend on that end.
fn exceeds(ball: &RollingBall, most: f64) -> Option<(f64, f64)> {
    const SAMPLES: usize = 200;
    (0..=SAMPLES)
        .map(|i| i as f64 / SAMPLES as f64)
        .map(|u| (u, ball.radius_value(u)))
        .find(|(_, r)| *r > most)
}

/// The quadrant between two planes: the normals towards the ball, and how far each support reaches from the edge on
/// the side where it is touched.
struct Quadrant {
    n: [DVec3; 2],
    d: DVec3,
    reach: [f64; 2],
}

pub(super) fn between_planes(
    surfaces: [&dyn Surface; 2],
    origins: [DVec3; 2],
    normals: [DVec3; 2],
    radius: Radius,
    options: &FilletOptions,
) -> Result<Fillet, FilletError> {
    let cross = normals[0].cross(normals[1]);
    let sine = cross.length();
    if sine < PARALLEL {
        return Err(FilletError::Parallel { sine });
    }
    // The point of both planes nearest to the middle of the two origins.
    let middle = 0.5 * (origins[0] + origins[1]);
    let cosine = normals[0].dot(normals[1]);
    let heights = [0, 1].map(|k| normals[k].dot(origins[k] - middle));
    let edge = middle
        + (normals[0] * (heights[0] - cosine * heights[1])
            + normals[1] * (heights[1] - cosine * heights[0]))
            / (sine * sine);
    let quadrant = |side: [bool; 2]| {
        let n = [0, 1].map(|k| if side[k] { normals[k] } else { -normals[k] });
        let d = n[0].cross(n[1]) / sine;
        let aside = [d.cross(n[0]), n[1].cross(d)];
        let reach = [0, 1].map(|k| extent(surfaces[k], edge, aside[k]).hi);
        Quadrant { n, d, reach }
    };
    let Quadrant { n, d, reach } = match options.side {
        Some(side) => quadrant(side),
        None => {
            let sides = [[true, true], [true, false], [false, true], [false, false]];
            let least = |q: &Quadrant| q.reach[0].min(q.reach[1]);
            sides[1..].iter().fold(quadrant(sides[0]), |best, side| {
                let q = quadrant(*side);
                // A tie within rounding keeps the earlier one.
                if least(&q) > least(&best) + BEYOND * least(&best).abs() {
                    q
                } else {
                    best
                }
            })
        }
    };
    if let Some(index) = reach.iter().position(|r| *r <= 0.0) {
        return Err(FilletError::Side { index });
    }
    let range = common_range([0, 1].map(|k| extent(surfaces[k], edge, d)), options)?;
    let half = (n[0] + n[1]).length_squared() / 2.0;
    let start = 0.5 * (range[0] + range[1]);
    let track = Track::Planes {
        n,
        d,
        q: (n[0] + n[1]) / half,
    };
    let ball = RollingBall::new(track, radius, range.map(|s| s - start), false);
    // The contacts are r tan(half the arc) from the edge.
    let largest = reach[0].min(reach[1]) * half / sine;
    if let Some((at, radius)) = exceeds(&ball, largest * (1.0 + BEYOND)) {
        return Err(FilletError::TooLarge {
            at,
            radius,
            largest,
        });
    }
    straight(ball, edge + d * start)
}

/// True if a surface that lies on a cylinder goes all the way round its axis: if not, a ball may come to its end. Told by the
/// angles of samples along its two lines in the middle.
pub(super) fn goes_round(surface: &dyn Surface, axis: &Frame) -> bool {
    const SAMPLES: usize = 64;
    let domain = surface.domain();
    let turn = |along: usize| {
        let angle = |i: usize| {
            let mut uv = domain.map(Interval::mid);
            let way = domain[along].width() * i as f64 / SAMPLES as f64;
            uv[along] = (domain[along].lo + way).min(domain[along].hi);
            let c = axis.coordinates(surface.point(uv));
            c.y.atan2(c.x)
        };
        let step = |i: usize| (angle(i + 1) - angle(i) + PI).rem_euclid(TAU) - PI;
        (0..SAMPLES).map(step).sum::<f64>().abs()
    };
    turn(0).max(turn(1)) >= TAU * (1.0 - BEYOND)
}

/// A plane (origin, normal) and a cylinder (axis, radius, whether its normals point outwards), in this order; `swapped` says that the caller gave them the other way round.
pub(super) fn at_cylinder(
    surfaces: [&dyn Surface; 2],
    ((origin, normal), (axis, cylinder_radius, outward)): ((DVec3, DVec3), (Frame, f64, bool)),
    swapped: bool,
    radius: Radius,
    options: &FilletOptions,
) -> Result<Fillet, FilletError> {
    let [first, second] = options.side.unwrap_or([true, true]);
    let (plane_side, cylinder_side) = if swapped {
        (second, first)
    } else {
        (first, second)
    };
    let n = if plane_side { normal } else { -normal };
    let side = if cylinder_side == outward { 1.0 } else { -1.0 };
    let (a, height) = (axis.z(), (axis.origin() - origin).dot(n));
    let slope = a.dot(n);
    let order = |range: [f64; 2], forwards: bool| {
        if forwards != swapped {
            range
        } else {
            [range[1], range[0]]
        }
    };
    if slope.abs() > PARALLEL {
        // The axis pierces the plane: measured from there the plane has height 0.
        let pierced = axis.origin() - a * (height / slope);
        let frame = axis.moved_to(pierced);
        let range = options.range.unwrap_or([0.0, TAU]);
        if range[1] - range[0] > TAU * (1.0 + BEYOND) {
            let [from, to] = range;
            return Err(FilletError::Range { from, to });
        }
        let track = Track::Turning(Cylinder {
            frame,
            radius: cylinder_radius,
            side,
            normal: n,
            height: 0.0,
        });
        let range = order(range, side * slope > 0.0);
        let ball = RollingBall::new(track, radius, range, swapped);
        let fillet = build(ball, pierced)?;
        return Ok(if a.cross(n).length() <= PARALLEL {
            torus(fillet, &frame)
        } else {
            fillet.0
        });
    }
    let range = common_range(surfaces.map(|s| extent(s, axis.origin(), a)), options)?;
    let start = 0.5 * (range[0] + range[1]);
    let frame = axis.moved_to(axis.origin() + a * start);
    let branch = if options.other_line { -1.0 } else { 1.0 };
    let track = Track::Along {
        cylinder: Cylinder {
            frame,
            radius: cylinder_radius,
            side,
            normal: n,
            height,
        },
        branch,
    };
    let range = order(range.map(|s| s - start), side * branch > 0.0);
    let ball = RollingBall::new(track, radius, range, swapped);
    straight(ball, frame.origin())
}

/// Why a ball of a radius cannot touch plane and cylinder at once.
fn ball_does_not_reach(track: &Track, at: f64, radius: f64) -> FilletError {
    let too_large = |largest| FilletError::TooLarge {
        at,
        radius,
        largest,
    };
    match track {
        Track::Along { cylinder: c, .. } => {
            let (inner, outer) = (c.radius + c.height, c.radius - c.height);
            if inner <= 0.0 || (c.side < 0.0 && outer <= 0.0) {
                FilletError::NoContact { height: c.height }
            } else if c.side > 0.0 {
                FilletError::TooSmall {
                    at,
                    radius,
                    least: -0.5 * outer,
                }
            } else {
                too_large(0.5 * inner)
            }
        }
        Track::Turning(c) => too_large(c.radius),
        Track::Planes { .. } | Track::Ring { .. } => too_large(f64::INFINITY),
    }
}
