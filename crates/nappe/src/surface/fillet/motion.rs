//! Motions that carry both supports into themselves: turns about a common axis, or shifts along a common direction. A ball
//! of constant radius between them goes round a circle or along a line, whatever the supports are, and its fillet is a
//! piece of a torus or of a cylinder.

use super::rolling_ball::Track;
use super::trace::{Trace, Tracer};
use crate::curve::{CurveRef, Ellipse, EllipseOptions, Line};
use crate::frame::Frame;
use crate::surface::Elementary;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// The sine of the angle below which two axes are parallel, and, relative to the supports, the distance below which they are
/// one: what frames are rounded by. Larger would make fillets wrong by as much.
const SAME: f64 = 1e-12;
/// The same for coordinates far from the origin, relative to these.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// How far the places of a ball that was followed may be from the circle or line, relative to the supports.
const ON_PATH: f64 = 1e-10;

/// A motion of space along itself.
#[derive(Clone, Copy, Debug)]
pub(super) enum Motion {
    /// Turns about the z axis of a frame.
    Turn(Frame),
    /// Shifts along a direction.
    Shift(DVec3),
}

/// The axes about which a surface can be turned into itself: all through a point, all along a direction, or one.
struct Axes {
    through: Option<DVec3>,
    along: Option<DVec3>,
}

impl Axes {
    fn of(form: &Elementary) -> Self {
        match *form {
            Elementary::Plane { normal, .. } => Axes {
                through: None,
                along: Some(normal),
            },
            Elementary::Sphere { frame, .. } => Axes {
                through: Some(frame.origin()),
                along: None,
            },
            Elementary::Cylinder { axis, .. }
            | Elementary::Cone { axis, .. }
            | Elementary::Torus { axis, .. } => Axes {
                through: Some(axis.origin()),
                along: Some(axis.z()),
            },
        }
    }
}

impl Motion {
    /// The motion that two surfaces have in common, if their forms tell one. `size` is that of the supports.
    pub(super) fn of(forms: [Elementary; 2], size: f64) -> Option<Self> {
        let [a, b] = forms.each_ref().map(Axes::of);
        let parallel = |d: DVec3, e: DVec3| d.cross(e).length() <= SAME;
        let same = |p: DVec3, q: DVec3, distance: f64| {
            distance <= SAME * size + ROUNDING * p.length().max(q.length())
        };
        if let (Elementary::Cylinder { axis, .. }, Elementary::Cylinder { axis: other, .. }) =
            (forms[0], forms[1])
            && parallel(axis.z(), other.z())
        {
            return Some(Motion::Shift(axis.z()));
        }
        if let [
            Elementary::Cylinder { axis, .. },
            Elementary::Plane { normal, .. },
        ]
        | [
            Elementary::Plane { normal, .. },
            Elementary::Cylinder { axis, .. },
        ] = forms
            && axis.z().dot(normal).abs() <= SAME
        {
            return Some(Motion::Shift(axis.z()));
        }
        let along = match (a.along, b.along) {
            (Some(d), Some(e)) => parallel(d, e).then_some(d)?,
            (Some(d), None) | (None, Some(d)) => d,
            (None, None) => {
                let (p, q) = (a.through?, b.through?);
                (!same(p, q, p.distance(q))).then(|| (q - p).normalize())?
            }
        };
        let through = match (a.through, b.through) {
            (Some(p), Some(q)) => {
                same(p, q, (q - p).cross(along).length()).then_some(0.5 * (p + q))?
            }
            (Some(p), None) | (None, Some(p)) => p,
            (None, None) => return None,
        };
        Frame::along(through, along).ok().map(Motion::Turn)
    }

    /// The path of a ball, which was followed, as the motion makes it; `None` if it is not so.
    pub(super) fn carry(&self, tracer: &Tracer, trace: &Trace) -> Option<Carried> {
        let home = tracer.supports.origin;
        let samples = &trace.samples;
        let (first, last) = (&samples[0], &samples[samples.len() - 1]);
        let centres = || samples.iter().map(|s| s.centre + home);
        let start = first.centre + home;
        let normals = [0, 1].map(|k| (first.centre - first.contacts[k]) / tracer.radius);
        let tolerance = ON_PATH * tracer.size + ROUNDING * start.length();
        match self {
            Motion::Shift(direction) => {
                let way = last.centre - first.centre;
                let d = direction * way.dot(*direction).signum();
                let length = way.dot(d);
                let on = |p: DVec3| (p - start).cross(d).length() <= tolerance;
                if trace.closed || !centres().all(on) {
                    return None;
                }
                let n = normals.map(|n| (n - d * n.dot(d)).normalize());
                // The edge of the planes that touch at both contacts.
                let q = (n[0] + n[1]) * 2.0 / (n[0] + n[1]).length_squared();
                if !q.is_finite() {
                    return None;
                }
                let line = Line::new(first.centre, first.centre + d * length).ok()?;
                Some(Carried {
                    track: Track::Planes { n, d, q },
                    range: [-0.5 * length, 0.5 * length],
                    origin: start + d * (0.5 * length) - q * tracer.radius,
                    guide: Arc::new(line),
                    axis: None,
                })
            }
            Motion::Turn(axis) => {
                let ring = |p: DVec3| {
                    let c = axis.coordinates(p);
                    DVec2::new(c.truncate().length(), c.z)
                };
                let at = ring(start);
                if !centres().all(|p| ring(p).distance(at) <= tolerance) {
                    return None;
                }
                let angle = |p: DVec3| {
                    let c = axis.coordinates(p);
                    c.y.atan2(c.x)
                };
                let angles: Vec<f64> = centres().map(angle).collect();
                let mut turn: f64 = angles
                    .windows(2)
                    .map(|a| (a[1] - a[0] + PI).rem_euclid(TAU) - PI)
                    .sum();
                if trace.closed {
                    turn = TAU.copysign(turn);
                }
                let z = axis.z() * turn.signum();
                let middle = axis.point(DVec3::Z * at.y);
                let frame = Frame::new(middle, z, start - middle).ok()?;
                let normals = normals.map(|n| {
                    let c = frame.components(n);
                    DVec2::new(c.x, c.z).normalize()
                });
                let options = EllipseOptions {
                    from: 0.0,
                    to: turn.abs(),
                    normal: z,
                    x_direction: Some(frame.x()),
                };
                let circle = Ellipse::new(middle - home, [at.x; 2], options).ok()?;
                let ring = at.x;
                Some(Carried {
                    track: Track::Ring {
                        frame,
                        ring,
                        normals,
                    },
                    range: [0.0, turn.abs()],
                    origin: middle,
                    guide: Arc::new(circle),
                    axis: Some(frame),
                })
            }
        }
    }
}

/// The path of a ball that is carried by a motion.
pub(super) struct Carried {
    pub track: Track,
    /// Of the track's s.
    pub range: [f64; 2],
    /// What the track is measured from.
    pub origin: DVec3,
    /// The path itself, measured from the supports' origin.
    pub guide: CurveRef,
    /// The frame about whose z axis the ball turns.
    pub axis: Option<Frame>,
}
