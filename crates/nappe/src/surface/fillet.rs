//! Fillets: rolling-ball surfaces with circular sections between two supports.

use super::rolling_ball::{Cylinder, Radius, RollingBall, Track, prove};
use super::turned::carried_round;
use super::{Core, Elementary, Separable, Surface, Term};
use crate::basis::{BSplineBasis, FunctionsRef};
use crate::exact::{ConicArcs, NurbsSurface};
use crate::frame::Frame;
use crate::interval::Interval;
use crate::significant;
use glam::{DVec3, DVec4, Vec4Swizzles};
use std::f64::consts::TAU;
use std::sync::Arc;
use thiserror::Error;

/// The sine of the angle below which two supports are parallel: with less, the place of their edge is rounding.
const PARALLEL: f64 = 1e-12;
/// Relative to the radius: how far a contact may lie beyond the end of its support by rounding.
const BEYOND: f64 = 1e-9;

fn ordinal(index: usize) -> &'static str {
    ["first", "second"][index]
}

/// What can be wrong with a fillet.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FilletError {
    /// A support is neither a plane nor a circular cylinder.
    #[error(
        "the {} surface is neither a plane nor a circular cylinder: fillets are made between two planes, and between a plane and a cylinder",
        ordinal(*index)
    )]
    Support {
        /// 0 or 1.
        index: usize,
    },
    /// Two cylinders, which need a traced spine.
    #[error(
        "both supports are cylinders: fillets are made between two planes, and between a plane and a cylinder"
    )]
    TwoCylinders,
    /// The planes do not meet.
    #[error(
        "the planes are parallel (the sine of their angle is {}): they have no edge to fillet", significant(*sine, 3)
    )]
    Parallel {
        /// The sine of the angle between them.
        sine: f64,
    },
    /// The radius is not positive and finite.
    #[error("the radius is {value} at u = {at}: it must be a positive, finite number")]
    Radius {
        /// The parameter.
        at: f64,
        /// The radius there.
        value: f64,
    },
    /// A radius function with more or less than one value, or another domain.
    #[error(
        "the radius must be one function of u on [0, 1]: {count} functions on [{from}, {to}] are given"
    )]
    RadiusFunction {
        /// How many functions it is.
        count: usize,
        /// Where its domain begins.
        from: f64,
        /// Where its domain ends.
        to: f64,
    },
    /// The ball does not fit, or its contact leaves a support.
    #[error("the radius {radius} at u = {at} is too large: at most {largest} fits there")]
    TooLarge {
        /// The parameter.
        at: f64,
        /// The radius there.
        radius: f64,
        /// The greatest radius that fits.
        largest: f64,
    },
    /// The plane is too far from the cylinder for this ball.
    #[error(
        "the radius {radius} at u = {at} does not reach from the plane to the cylinder: more than {least} is needed"
    )]
    TooSmall {
        /// The parameter.
        at: f64,
        /// The radius there.
        radius: f64,
        /// What it must exceed.
        least: f64,
    },
    /// The supports do not extend to this side of their edge.
    #[error(
        "the {} surface does not extend to the side where the ball touches it: choose another side (front is where its normals point)",
        ordinal(*index)
    )]
    Side {
        /// 0 or 1.
        index: usize,
    },
    /// The plane and the cylinder do not come together on the given sides.
    #[error(
        "no ball touches both on these sides: the cylinder's axis is {height} from the plane, on the side of the ball if positive"
    )]
    NoContact {
        /// The height of the axis over the plane, positive on the ball's side.
        height: f64,
    },
    /// The supports do not lie beside a common part of their edge.
    #[error(
        "the supports do not lie beside a common part of their edge: the first ends {gap} before the second begins"
    )]
    Apart {
        /// How far apart they are along the edge.
        gap: f64,
    },
    /// The range of the fillet is empty, not finite, or more than one turn.
    #[error(
        "the range is {from} to {to}: it must increase and be finite, and be at most one turn round a cylinder"
    )]
    Range {
        /// The first value.
        from: f64,
        /// The last value.
        to: f64,
    },
    /// The radius changes faster than the ball moves.
    #[error(
        "the radius changes too fast at u = {at}: each ball swallows the next (|c'|² - r'² is {margin})"
    )]
    Swallowed {
        /// The parameter.
        at: f64,
        /// The quantity that must be positive.
        margin: f64,
    },
    /// Sections cross: the path bends or the radius changes more sharply than the ball can follow.
    #[error(
        "the sections cross at u = {at}: the path bends or the radius changes too sharply for a ball of radius {radius}"
    )]
    SectionsCross {
        /// The parameter.
        at: f64,
        /// The radius there.
        radius: f64,
    },
}

/// Which fillet of several.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct FilletOptions {
    /// For each support whether the ball is on the side its normals `r_u × r_v` point to. `None`: of the four
    /// quadrants between two planes the one in which both supports reach furthest from the edge (at a tie, the sides
    /// the normals point to); for a cylinder, the sides the normals point to.
    pub side: Option<[bool; 2]>,
    /// A plane parallel to a cylinder's axis is touched on one of two lines: this takes the other one. The first is
    /// towards `axis × normal`, the normal pointing to the ball.
    pub other_line: bool,
    /// The part of the fillet: lengths along the edge (the way u runs) or along the axis, from where the supports begin
    /// to lie beside each other (default: as long as they do); or angles in radians in a cylinder's frame where the fillet goes round it (default: one
    /// turn).
    pub range: Option<[f64; 2]>,
}

/// A fillet between two supports on `[0, 1]²`: each section u = const is the circular arc
/// `r(u, v) = [B0(v) p0(u) + w(u) B1(v) p1(u) + B2(v) p2(u)] / [B0 + w B1 + B2]`, `w = cos(α/2)`, from the contact p0 on
/// the first support (v = 0) to the contact p2 on the second (v = 1), p1 being the meeting point of the tangents.
///
/// It is the exact envelope of a rolling ball of constant or variable radius; with a variable radius the sections' planes are
/// not square to the edge and the arcs' radius is `r √(1 - r'²/|c'|²)`. It touches both supports. The normals `r_u × r_v`
/// point to the ball's centre; for that u runs along `n0 × n2`, where n0 and n2 are the supports' normals towards the
/// ball.
///
/// Supports: two planes; a plane and a circular cylinder pierced by it at any angle, or parallel to it. They are
/// recognised by [`Surface::elementary`]. Between planes the contacts must lie on the given parts; a cylinder and the plane
/// with it count as unbounded.
///
/// Exactly a NURBS surface for a constant radius between planes and along a cylinder; round a cylinder square to the plane
/// [`Surface::to_rational`] gives the same piece of a torus. Source: Golovanov, *Geometric modelling*, §3.9 (3.9.3).
#[derive(Clone, Debug)]
pub struct Fillet {
    form: Separable,
    ball: Arc<RollingBall>,
    origin: DVec3,
    nurbs: Option<NurbsSurface>,
    rational: Option<NurbsSurface>,
}

impl Fillet {
    /// The fillet between two surfaces.
    pub fn new(
        first: &dyn Surface,
        second: &dyn Surface,
        radius: Radius,
        options: FilletOptions,
    ) -> Result<Self, FilletError> {
        check_radius(&radius)?;
        let support =
            |index: usize, s: &dyn Surface| s.elementary().ok_or(FilletError::Support { index });
        let supports = [support(0, first)?, support(1, second)?];
        if let Some([from, to]) = options.range
            && !(from.is_finite() && to.is_finite() && from < to)
        {
            return Err(FilletError::Range { from, to });
        }
        let surfaces = [first, second];
        match supports {
            [
                Elementary::Plane {
                    origin: a,
                    normal: m,
                },
                Elementary::Plane {
                    origin: b,
                    normal: n,
                },
            ] => between_planes(surfaces, [a, b], [m, n], radius, &options),
            [plane @ Elementary::Plane { .. }, cylinder] => {
                at_cylinder(surfaces, [plane, cylinder], false, radius, &options)
            }
            [cylinder, plane @ Elementary::Plane { .. }] => {
                at_cylinder(surfaces, [plane, cylinder], true, radius, &options)
            }
            _ => Err(FilletError::TwoCylinders),
        }
    }

    fn build(ball: RollingBall, origin: DVec3) -> Result<Self, FilletError> {
        if let Err((condition, at, margin)) = prove(&ball) {
            let radius = ball.radius_value(at);
            return Err(match condition {
                0 => FilletError::Radius { at, value: radius },
                1 => ball_does_not_reach(&ball.track, at, radius),
                2 => FilletError::Swallowed { at, margin },
                _ => FilletError::SectionsCross { at, radius },
            });
        }
        let ball = Arc::new(ball);
        Ok(Self {
            form: arc_sections(ball.clone(), origin),
            ball,
            origin,
            nurbs: None,
            rational: None,
        })
    }

    /// The ball's centre, and its radius, at a parameter u.
    pub fn ball(&self, u: f64) -> (DVec3, f64) {
        let (centre, radius) = self.ball.centre(u);
        (self.origin + centre, radius)
    }

    /// The NURBS form of a fillet with constant sections moved along a straight line.
    fn straight(mut self) -> Self {
        if let Radius::Constant(_) = self.ball.radius {
            let points = [0.0, 1.0].map(|u| self.section(u));
            self.nurbs = Some(NurbsSurface::from_homogeneous(
                BSplineBasis::bernstein(1),
                BSplineBasis::bernstein(2),
                points.as_flattened().to_vec(),
            ));
            self.rational = self.nurbs.clone();
        }
        self
    }

    /// The NURBS form of a constant section turned about the cylinder's axis: a piece of a torus.
    fn torus(mut self, frame: &Frame) -> Self {
        if let Radius::Constant(_) = self.ball.radius {
            let profile = self
                .section(0.0)
                .map(|p| frame.components(p.xyz() - self.origin * p.w).extend(p.w));
            let [from, to] = self.ball.range;
            let round = ConicArcs::circle(0.0, to - from);
            let points = carried_round(&profile, &round.points, frame.directions(), self.origin);
            self.rational = Some(NurbsSurface::from_homogeneous(
                round.basis,
                BSplineBasis::bernstein(2),
                points,
            ));
        }
        self
    }

    /// The three homogeneous points of a section.
    fn section(&self, u: f64) -> [DVec4; 3] {
        let f = self.ball.values(u);
        let at = |k: usize, w: f64| {
            let p = DVec3::new(f[k], f[k + 1], f[k + 2]);
            (p + self.origin * w).extend(w)
        };
        [at(0, 1.0), at(3, f[10]), at(6, 1.0)]
    }
}

/// The general rational surface of sections: functions `p0 (3), w p1 (3), p2 (3), 1, w` of u, measured from an origin, and
/// v the parameter of the quadratic arcs `[B0 p0 + w B1 p1 + B2 p2] / [B0 + w B1 + B2]`.
///
/// Whoever can state contact curves, apex curve and weight as functions, for any pair of supports, has the surface
/// with its derivatives and enclosures. Panics unless there are eleven functions. Source: Golovanov, §3.9 (3.9.3).
pub fn arc_sections(functions: FunctionsRef, origin: DVec3) -> Separable {
    let e = [DVec4::X, DVec4::Y, DVec4::Z];
    let mut terms: Vec<Term> = (0..9).map(|k| Term::new(k, k / 3, e[k % 3])).collect();
    terms.extend([
        Term::new(9, 0, DVec4::W),
        Term::new(10, 1, DVec4::W),
        Term::new(9, 2, DVec4::W),
    ]);
    let arc = Arc::new(BSplineBasis::bernstein(2));
    Separable::rational(functions, arc, Core::Terms(terms), origin)
}

fn check_radius(radius: &Radius) -> Result<(), FilletError> {
    match radius {
        Radius::Constant(r) if !(*r > 0.0 && r.is_finite()) => {
            Err(FilletError::Radius { at: 0.0, value: *r })
        }
        Radius::Constant(_) => Ok(()),
        Radius::Along(f) => {
            let breaks = f.breaks();
            let (from, to) = (breaks[0].at, breaks[breaks.len() - 1].at);
            if f.count() != 1 || from != 0.0 || to != 1.0 {
                let count = f.count();
                return Err(FilletError::RadiusFunction { count, from, to });
            }
            Ok(())
        }
    }
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

fn between_planes(
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
    Ok(Fillet::build(ball, edge + d * start)?.straight())
}

/// A plane and a cylinder, in this order; `swapped` says that the caller gave them the other way round.
fn at_cylinder(
    surfaces: [&dyn Surface; 2],
    supports: [Elementary; 2],
    swapped: bool,
    radius: Radius,
    options: &FilletOptions,
) -> Result<Fillet, FilletError> {
    let [
        Elementary::Plane { origin, normal },
        Elementary::Cylinder {
            axis,
            radius: cylinder_radius,
            outward,
        },
    ] = supports
    else {
        return Err(FilletError::TwoCylinders);
    };
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
        let fillet = Fillet::build(ball, pierced)?;
        return Ok(if a.cross(n).length() <= PARALLEL {
            fillet.torus(&frame)
        } else {
            fillet
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
    Ok(Fillet::build(ball, frame.origin())?.straight())
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
        Track::Planes { .. } => too_large(f64::INFINITY),
    }
}

impl Surface for Fillet {
    evaluate_through!(self => self.form);

    fn to_nurbs(&self) -> Option<NurbsSurface> {
        self.nurbs.clone()
    }

    fn to_rational(&self) -> Option<NurbsSurface> {
        self.rational.clone()
    }
}
