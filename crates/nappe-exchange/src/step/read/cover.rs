//! Surfaces with sides that cover a face of an endless one.

use super::curves::{self, Course};
use super::surfaces::Expanse;
use super::sweep;
use glam::DVec3;
use nappe::body::cover;
use nappe::curve::{CurveError, Ellipse, EllipseOptions};
use nappe::query::{Finder, FinderOptions};
use nappe::surface::{Elementary, RevolutionError, RevolutionOptions, Torus, TorusOptions, ruled};
use nappe::{Box3, CurveRef, Dir, Frame, Interval, Revolution, SurfaceRef};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A surface and whether its normal is opposite to the one the file means.
pub(super) type Covered = (SurfaceRef, bool);

/// A swept surface reaches beyond the edges by this share of their extent, so that no edge lies on its sides, where rounding decides.
const MARGIN: f64 = 0.01;
/// Parts that an edge is enclosed in.
const PARTS: usize = 16;
/// How far beyond the tip of a cone points may lie, as a share of the farthest on the right side.
const BEYOND: f64 = 1e-6;
/// A profile is cut at so many crossings of the axis.
const CROSSINGS: usize = 6;
/// Sines and relative distances below this are 0: directions and places of files have ten digits or more.
const SAME: f64 = 1e-10;

/// What lies on the border of a face.
pub(super) struct Border<'a> {
    pub(super) edges: &'a [CurveRef],
    /// Vertices without edges.
    pub(super) points: &'a [DVec3],
    /// The distance within which the file's parts agree.
    pub(super) tolerance: f64,
}

impl Border<'_> {
    /// The ranges of the coordinates in a frame.
    fn ranges(&self, frame: &Frame) -> Result<[Interval; 3], String> {
        let mut all: Option<Box3> = None;
        let mut add = |b: Box3| {
            let b = frame.enclose_coordinates(b);
            all = Some(all.map_or(b, |a: Box3| a.hull(b)));
        };
        for edge in self.edges {
            let d = edge.domain();
            let at = |i: usize| d.lo + (d.hi - d.lo) * (i as f64 / PARTS as f64);
            for i in 0..PARTS {
                let hi = if i + 1 == PARTS { d.hi } else { at(i + 1) };
                add(edge.bounds(Interval::new(at(i), hi)));
            }
        }
        self.points.iter().for_each(|p| add(Box3::point(*p)));
        let b = all.ok_or("nothing bounds the face, and its surface has no end")?;
        let ranges = [b.x, b.y, b.z];
        if ranges
            .iter()
            .any(|r| !(r.lo.is_finite() && r.hi.is_finite()))
        {
            return Err("its edges have no bounds".into());
        }
        Ok(ranges)
    }

    /// The ends of the edges.
    pub(super) fn vertices(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.edges.iter().flat_map(|e| e.ends())
    }

    /// Points of the border.
    pub(super) fn samples(&self) -> impl Iterator<Item = DVec3> + '_ {
        let along = self.edges.iter().flat_map(|e| {
            let d = e.domain();
            (0..=PARTS).map(move |i| e.point(d.lo + (d.hi - d.lo) * (i as f64 / PARTS as f64)))
        });
        along.chain(self.points.iter().copied())
    }
}

impl Expanse {
    /// A surface with sides that contains a border, and all that it encloses.
    pub(super) fn cover(&self, border: &Border<'_>) -> Result<Covered, String> {
        match self {
            Expanse::Bounded(s) => Ok((s.clone(), false)),
            Expanse::Flipped(inner) => {
                let (surface, flipped) = inner.cover(border)?;
                Ok((surface, !flipped))
            }
            Expanse::Plane(frame) => elementary(
                border,
                Elementary::Plane {
                    origin: frame.origin(),
                    normal: frame.z(),
                },
            ),
            Expanse::Cylinder { frame, radius } => elementary(
                border,
                Elementary::Cylinder {
                    axis: *frame,
                    radius: *radius,
                    outward: true,
                },
            ),
            Expanse::Cone {
                frame,
                radius,
                slope,
            } => cone(border, frame, *radius, *slope),
            Expanse::Sphere { frame, radius } => elementary(
                border,
                Elementary::Sphere {
                    frame: *frame,
                    radius: *radius,
                    outward: true,
                },
            ),
            Expanse::Torus {
                frame,
                major,
                minor,
            } if major < minor => spindle(border, frame, *major, *minor),
            Expanse::Torus {
                frame,
                major,
                minor,
            } => elementary(
                border,
                Elementary::Torus {
                    axis: *frame,
                    major: *major,
                    minor: *minor,
                    outward: true,
                },
            ),
            Expanse::Extrusion { course, vector } => extrusion(border, course, *vector),
            Expanse::Revolution { course, frame } => revolution(border, course, frame),
        }
    }
}

fn elementary(border: &Border<'_>, elementary: Elementary) -> Result<Covered, String> {
    let surface = cover(&elementary, border.edges).map_err(|e| e.to_string())?;
    Ok((surface, false))
}

fn cone(border: &Border<'_>, frame: &Frame, radius: f64, slope: f64) -> Result<Covered, String> {
    // From the apex, z towards where the cone widens: only there does the file have it.
    let apex = frame.point(DVec3::Z * (-radius / slope));
    let z = frame.z() * slope.signum();
    let up = Frame::new(apex, z, frame.x()).map_err(|e| e.to_string())?;
    let heights: Vec<f64> = border.samples().map(|p| up.coordinates(p).z).collect();
    let farthest = |sign: f64| heights.iter().fold(0.0, |far: f64, z| far.max(sign * z));
    let (above, below) = (farthest(1.0), farthest(-1.0));
    if above.min(below) > BEYOND * above.max(below) {
        return Err("the face reaches over the tip of its cone".into());
    }
    let axis = if above >= below {
        up
    } else {
        Frame::new(apex, -z, frame.x()).map_err(|e| e.to_string())?
    };
    elementary(
        border,
        Elementary::Cone {
            axis,
            slope: slope.abs(),
            outward: true,
        },
    )
}

/// The part of a torus that passes through itself on which the border lies, the outer or the inner one.
fn spindle(border: &Border<'_>, frame: &Frame, major: f64, minor: f64) -> Result<Covered, String> {
    let (mut inner, mut outer) = (false, false);
    for p in border.samples() {
        let c = frame.coordinates(p);
        let from = |radius: f64| ((c.truncate().length() - radius).hypot(c.z) - minor).abs();
        // Points of both parts are where these meet, on the axis.
        let difference = from(major) - from(-major);
        inner |= difference > BEYOND * minor;
        outer |= difference < -BEYOND * minor;
    }
    if inner && outer {
        return Err("the face reaches from the outer to the inner part of its torus".into());
    }
    let text = |e: CurveError| e.to_string();
    if inner {
        // An arc about a centre beyond the axis, upwards: its normals point to the axis, as those of the torus do there.
        let half = (major / minor).acos();
        let options = EllipseOptions {
            from: -half,
            to: half,
            normal: -frame.y(),
            x_direction: Some(frame.x()),
        };
        let center = frame.point(DVec3::X * -major);
        let arc = Ellipse::new(center, [minor; 2], options).map_err(text)?;
        let surface = Revolution::new(Arc::new(arc), *frame, RevolutionOptions::default());
        return Ok((Arc::new(surface.map_err(|e| e.to_string())?), false));
    }
    let limit = (-major / minor).acos();
    let options = TorusOptions {
        frame: *frame,
        range: [[0.0, TAU], [-limit, limit]],
    };
    let torus = Torus::new(major, minor, options).map_err(|e| e.to_string())?;
    Ok((Arc::new(torus), false))
}

/// The profile of a swept surface as a curve with ends: of an endless one the part that `at` finds over the border.
fn profile(
    course: &Course,
    border: &Border<'_>,
    at: impl Fn(DVec3) -> DVec3,
) -> Result<CurveRef, String> {
    if let Course::Bounded(_) | Course::Ellipse { .. } = course {
        return course.whole();
    }
    let mut range: Option<[f64; 2]> = None;
    for p in border.samples() {
        let t = course.parameter(at(p))?;
        let [lo, hi] = range.unwrap_or([t, t]);
        range = Some([lo.min(t), hi.max(t)]);
    }
    let [lo, hi] = range.ok_or("nothing bounds the face, and its surface has no end")?;
    // Samples may miss the farthest point by some hundredths.
    let margin = 5.0 * MARGIN * (hi - lo);
    course.between([lo - margin, hi + margin])
}

fn extrusion(border: &Border<'_>, course: &Course, vector: DVec3) -> Result<Covered, String> {
    let way = vector.normalize();
    match course {
        Course::Line {
            point,
            vector: along,
        } => {
            let frame =
                Frame::new(*point, along.cross(vector), *along).map_err(|e| e.to_string())?;
            return Expanse::Plane(frame).cover(border);
        }
        Course::Ellipse { frame, a, b } if a == b && frame.z().cross(way).length() < SAME => {
            let (surface, flipped) = Expanse::Cylinder {
                frame: *frame,
                radius: *a,
            }
            .cover(border)?;
            return Ok((surface, flipped != (frame.z().dot(way) < 0.0)));
        }
        _ => {}
    }
    let in_plane = |p: DVec3| match course {
        Course::Hyperbola { frame, .. } | Course::Parabola { frame, .. } => {
            p - way * ((p - frame.origin()).dot(frame.z()) / way.dot(frame.z()))
        }
        _ => p,
    };
    let curve = profile(course, border, in_plane)?;
    if let Some(surface) = sweep::moved(border, &curve, vector) {
        return Ok((surface, false));
    }
    let frame = Frame::along(curve.ends()[0], way).map_err(|e| e.to_string())?;
    let edges = border.ranges(&frame)?[2];
    let own = Border {
        edges: std::slice::from_ref(&curve),
        points: &[],
        tolerance: border.tolerance,
    }
    .ranges(&frame)?[2];
    let [lo, hi] = [edges.lo - own.hi, edges.hi - own.lo];
    let margin = MARGIN * (hi - lo);
    let moved = |by: f64| sweep::at(&curve, way * by);
    let surface = ruled(moved(lo - margin)?, moved(hi + margin)?, Dir::U);
    Ok((Arc::new(surface.map_err(|e| e.to_string())?), false))
}

fn revolution(border: &Border<'_>, course: &Course, axis: &Frame) -> Result<Covered, String> {
    match course {
        Course::Line { point, vector } => {
            let (at, way) = (
                axis.coordinates(*point),
                axis.components(*vector).normalize(),
            );
            let aside = DVec3::new(at.x, at.y, 0.0);
            let apart = aside.length();
            // In a plane with the axis?
            if aside.cross(way).z.abs() <= SAME * apart.max(f64::MIN_POSITIVE) {
                let across = if apart > SAME * at.length() {
                    way.dot(aside) / apart
                } else {
                    way.truncate().length()
                };
                if way.z.abs() < SAME {
                    let frame = axis.moved_to(axis.point(DVec3::Z * at.z));
                    let (surface, _) = Expanse::Plane(frame).cover(border)?;
                    return Ok((surface, across > 0.0));
                }
                let up = axis.moved_to(axis.point(DVec3::Z * at.z));
                let same = if across.abs() < SAME {
                    Expanse::Cylinder {
                        frame: up,
                        radius: apart,
                    }
                } else {
                    Expanse::Cone {
                        frame: up,
                        radius: apart,
                        slope: across / way.z,
                    }
                };
                let (surface, flipped) = same.cover(border)?;
                return Ok((surface, flipped != (way.z < 0.0)));
            }
        }
        Course::Ellipse { frame, a, b } if a == b => {
            let center = axis.coordinates(frame.origin());
            let normal = axis.components(frame.z());
            let aside = DVec3::new(center.x, center.y, 0.0);
            let round = DVec3::Z.cross(aside.normalize_or_zero());
            if aside.length() > SAME * a && normal.cross(round).length() < SAME {
                let frame = axis.moved_to(axis.point(DVec3::Z * center.z));
                let torus = Expanse::Torus {
                    frame,
                    major: aside.length(),
                    minor: *a,
                };
                let (surface, flipped) = torus.cover(border)?;
                return Ok((surface, flipped != (normal.dot(round) > 0.0)));
            }
        }
        _ => {}
    }
    let height = |p: DVec3| match course {
        Course::Line { point, vector } => {
            let (z, way) = (axis.coordinates(*point).z, axis.components(*vector).z);
            let t = (axis.coordinates(p).z - z) / way;
            if t.is_finite() {
                *point + *vector * t
            } else {
                p
            }
        }
        _ => p,
    };
    let curve = profile(course, border, height)?;
    // There u runs along the curve, here round the axis.
    if let Some(surface) = sweep::turned(border, &curve, axis) {
        return Ok((surface, true));
    }
    Ok((turned(border, curve, axis, 0)?, true))
}

/// The surface of a profile; where that crosses the axis, of the part that the border lies on.
fn turned(
    border: &Border<'_>,
    curve: CurveRef,
    axis: &Frame,
    depth: usize,
) -> Result<SurfaceRef, String> {
    let at = match Revolution::new(curve.clone(), *axis, RevolutionOptions::default()) {
        Ok(surface) => return Ok(Arc::new(surface)),
        Err(RevolutionError::Crosses { at, .. }) if depth < CROSSINGS => at,
        Err(e) => return Err(e.to_string()),
    };
    let domain = curve.domain();
    let mut best: Option<(f64, SurfaceRef)> = None;
    for [from, to] in [[domain.lo, at], [at, domain.hi]] {
        let Ok(part) = curves::part(&curve, from, to) else {
            continue;
        };
        let Ok(surface) = turned(border, part, axis, depth + 1) else {
            continue;
        };
        let Ok(finder) = Finder::new(std::slice::from_ref(&surface), FinderOptions::default())
        else {
            continue;
        };
        let far = |p| finder.nearest(p).map_or(f64::INFINITY, |n| n.distance);
        let distance = border.samples().map(far).fold(0.0, f64::max);
        if best.as_ref().is_none_or(|b| distance < b.0) {
            best = Some((distance, surface));
        }
    }
    best.map(|b| b.1)
        .ok_or_else(|| "its profile crosses the axis and has no part without a crossing".into())
}
