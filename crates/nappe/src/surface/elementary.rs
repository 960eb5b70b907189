//! What a surface is in the language of elementary geometry, where that is known exactly.

use crate::exact::NurbsSurface;
use crate::frame::Frame;
use crate::surface::Surface;
use glam::{DAffine3, DMat3, DVec2, DVec3};

/// A control net whose points all lie within this distance of a plane, relative to the net's size, is flat. With
/// positive weights the surface lies in the hull of its net, so this also bounds the surface. Larger would make
/// fillets of slightly curved surfaces wrong by as much, smaller would refuse planes that are rounded.
const FLAT: f64 = 1e-13;
/// Relative difference of lengths and angles within which a map keeps circles round.
const SIMILAR: f64 = 1e-13;
/// The distance from a line or circle, relative to the largest coordinate, within which a meridian lies on it: what
/// profiles made by angles are rounded by. Larger would call flat curves straight.
const SAME: f64 = 1e-13;
/// A cone's apex may be this many sizes away. From farther, heights over the apex would lose more than four digits.
const FAR_APEX: f64 = 1e4;

/// An elementary surface that contains the whole of a given surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Elementary {
    /// A plane.
    Plane {
        /// A point of it.
        origin: DVec3,
        /// The unit normal, on the side of the given surface's `r_u × r_v`.
        normal: DVec3,
    },
    /// A circular cylinder.
    Cylinder {
        /// Its axis is the frame's z.
        axis: Frame,
        /// Its radius.
        radius: f64,
        /// Whether the given surface's `r_u × r_v` points away from the axis.
        outward: bool,
    },
    /// One nappe of a circular cone, or a part of it.
    Cone {
        /// The apex, and z along the axis towards the given surface.
        axis: Frame,
        /// The radius at height 1 over the apex: the tangent of half the angle.
        slope: f64,
        /// Whether the given surface's `r_u × r_v` points away from the axis.
        outward: bool,
    },
    /// A sphere.
    Sphere {
        /// The centre; the given surface's poles, if any, lie along z.
        frame: Frame,
        /// The radius.
        radius: f64,
        /// Whether the given surface's `r_u × r_v` points away from the centre.
        outward: bool,
    },
    /// A torus.
    Torus {
        /// The centre, and z along the axis.
        axis: Frame,
        /// The distance of the tube's centre from the axis.
        major: f64,
        /// The tube's radius.
        minor: f64,
        /// Whether the given surface's `r_u × r_v` points out of the tube.
        outward: bool,
    },
}

impl Elementary {
    /// The image under an affine map, `None` if that is of no elementary kind (a circular cylinder made elliptic).
    pub fn transformed(&self, map: &DAffine3) -> Option<Self> {
        match *self {
            Elementary::Plane { origin, normal } => Some(Elementary::Plane {
                origin: map.transform_point3(origin),
                normal: normal_image(&map.matrix3, normal).try_normalize()?,
            }),
            Elementary::Cylinder {
                axis,
                radius,
                outward,
            } => {
                let image = Similar::of(map, &axis, false)?;
                Some(Elementary::Cylinder {
                    axis: image.frame,
                    radius: radius * image.across,
                    outward: outward == image.keeps,
                })
            }
            Elementary::Cone {
                axis,
                slope,
                outward,
            } => {
                let image = Similar::of(map, &axis, false)?;
                Some(Elementary::Cone {
                    axis: image.frame,
                    slope: slope * image.across / image.along,
                    outward: outward == image.keeps,
                })
            }
            Elementary::Sphere {
                frame,
                radius,
                outward,
            } => {
                let image = Similar::of(map, &frame, true)?;
                Some(Elementary::Sphere {
                    frame: image.frame,
                    radius: radius * image.across,
                    outward: outward == image.keeps,
                })
            }
            Elementary::Torus {
                axis,
                major,
                minor,
                outward,
            } => {
                let image = Similar::of(map, &axis, true)?;
                Some(Elementary::Torus {
                    axis: image.frame,
                    major: major * image.across,
                    minor: minor * image.across,
                    outward: outward == image.keeps,
                })
            }
        }
    }

    /// The same with the normal on the other side.
    pub fn flipped(mut self) -> Self {
        match &mut self {
            Elementary::Plane { normal, .. } => *normal = -*normal,
            Elementary::Cylinder { outward, .. }
            | Elementary::Cone { outward, .. }
            | Elementary::Sphere { outward, .. }
            | Elementary::Torus { outward, .. } => *outward = !*outward,
        }
        self
    }

    /// The image of an axis, about which the image of a turn is one again, counter-clockwise too; `None` if circles do not stay
    /// circles.
    pub(super) fn turned_axis(map: &DAffine3, axis: &Frame) -> Option<Frame> {
        let image = Similar::of(map, axis, false)?;
        if image.keeps {
            return Some(image.frame);
        }
        let [x, _, z] = image.frame.directions();
        Frame::new(image.frame.origin(), -z, x).ok()
    }

    /// What a meridian `(ρ, z)` sweeps about the z axis of a frame, from points of it: as many that a rational curve of
    /// its degree through them lies on a line or circle if they do. `normal` is a point of the
    /// meridian and the surface's normal there.
    pub(super) fn swept(axis: &Frame, points: &[DVec2], normal: [DVec2; 2]) -> Option<Elementary> {
        let size = points.iter().map(|p| p.length()).fold(0.0, f64::max);
        let [first, second, third] = [0, points.len() / 3, 2 * points.len() / 3].map(|i| points[i]);
        let last = *points.last()?;
        let [at, normal] = normal;
        let on = |distance: &dyn Fn(DVec2) -> f64| {
            points.iter().all(|p| distance(*p).abs() <= SAME * size)
        };
        let way = (last - first).try_normalize();
        if let Some(way) = way
            && on(&|p| way.perp_dot(p - first))
        {
            // A straight meridian.
            if way.x.abs() <= SAME {
                return Some(Elementary::Cylinder {
                    axis: *axis,
                    radius: first.x,
                    outward: normal.x > 0.0,
                });
            }
            let slope = way.x / way.y;
            let apex = first.y - first.x / slope;
            let middle = 0.5 * (first + last);
            let z = axis.directions()[2] * (middle.y - apex).signum();
            let origin = axis.point(DVec3::Z * apex);
            return (apex.abs() < FAR_APEX * size).then_some(Elementary::Cone {
                axis: Frame::new(origin, z, axis.directions()[0]).ok()?,
                slope: slope.abs(),
                outward: normal.x > 0.0,
            });
        }
        let center = circle_through([first, second, third])?;
        let radius = center.distance(first);
        if !on(&|p| center.distance(p) - radius) || radius > size / SAME.sqrt() {
            return None;
        }
        let outward = normal.dot(at - center) > 0.0;
        let frame = Frame::new(
            axis.point(DVec3::Z * center.y),
            axis.directions()[2],
            axis.directions()[0],
        )
        .ok()?;
        if center.x.abs() <= SAME * size {
            Some(Elementary::Sphere {
                frame,
                radius,
                outward,
            })
        } else {
            (center.x > 0.0).then_some(Elementary::Torus {
                axis: frame,
                major: center.x,
                minor: radius,
                outward,
            })
        }
    }
}

/// The centre of the circle through three points, `None` if they lie on a line.
fn circle_through([a, b, c]: [DVec2; 3]) -> Option<DVec2> {
    let (p, q) = (b - a, c - a);
    let twice = 2.0 * p.perp_dot(q);
    let d = DVec2::new(
        q.y * p.length_squared() - p.y * q.length_squared(),
        p.x * q.length_squared() - q.x * p.length_squared(),
    ) / twice;
    d.is_finite().then_some(a + d)
}

/// What an affine map makes of a frame, if circles about its axis stay circles square to it.
struct Similar {
    frame: Frame,
    /// The scale square to the axis.
    across: f64,
    /// The scale along it.
    along: f64,
    /// Whether right-handed stays right-handed.
    keeps: bool,
}

impl Similar {
    /// `evenly`: whether the scale must be the same along the axis.
    fn of(map: &DAffine3, axis: &Frame, evenly: bool) -> Option<Self> {
        let [x, y, z] = axis.directions().map(|d| map.matrix3 * d);
        let [across, other, along] = [x, y, z].map(DVec3::length);
        let same = |a: f64, b: f64| (a - b).abs() <= SIMILAR * a;
        let square = |a: DVec3, b: DVec3| a.dot(b).abs() <= SIMILAR * a.length() * b.length();
        if !(same(across, other) && square(x, y) && square(y, z) && square(z, x))
            || (evenly && !same(across, along))
        {
            return None;
        }
        Some(Similar {
            frame: Frame::new(map.transform_point3(axis.origin()), z, x).ok()?,
            across,
            along,
            keeps: map.matrix3.determinant() > 0.0,
        })
    }
}

/// `(A a) × (A b)` for `n = a × b`: the cofactor matrix applied to n.
pub(super) fn normal_image(a: &DMat3, n: DVec3) -> DVec3 {
    let (x, y, z) = (a.x_axis, a.y_axis, a.z_axis);
    y.cross(z) * n.x + z.cross(x) * n.y + x.cross(y) * n.z
}

/// Points of a net this far off a plane through three of them, relative to its width, are in no plane.
const BENT: f64 = 1e-6;

/// Whether a few looks show that points lie in no plane: the three first that are apart span one, and another is off it.
fn is_bent(points: &[DVec3]) -> bool {
    let (first, last) = (points[0], points[points.len() - 1]);
    let along = last - first;
    let size = along.length();
    let mut normal = None;
    points.iter().any(|p| {
        let d = *p - first;
        match normal {
            None => {
                let n = along.cross(d);
                normal = (n.length() > 0.01 * size * size).then(|| n.normalize());
                false
            }
            Some(n) => n.dot(d).abs() > BENT * (size + d.length()) + 1e-12 * p.length(),
        }
    })
}

/// The plane of a flat NURBS surface.
pub(super) fn plane_of(surface: &NurbsSurface) -> Option<Elementary> {
    let points = surface.control_points();
    if surface.weights().iter().any(|w| *w <= 0.0) {
        return None;
    }
    let origin = points[0];
    if is_bent(&points) {
        return None;
    }
    let far = |from: DVec3| {
        points
            .iter()
            .copied()
            .max_by(|a, b| a.distance(from).total_cmp(&b.distance(from)))
    };
    let along = far(origin)? - origin;
    let size = along.length();
    // The net's widest triangle over its longest line spans the plane best.
    let across = points
        .iter()
        .map(|p| along.cross(*p - origin))
        .max_by(|a, b| a.length().total_cmp(&b.length()))?;
    let normal = across.try_normalize()?;
    if points
        .iter()
        .any(|p| normal.dot(*p - origin).abs() > FLAT * size + f64::EPSILON * p.length())
    {
        return None;
    }
    let domain = surface.domain();
    let middle = [domain[0].mid(), domain[1].mid()];
    let side = surface.jet(middle, Default::default(), 1).normal()?;
    Some(Elementary::Plane {
        origin,
        normal: if side.dot(normal) < 0.0 {
            -normal
        } else {
            normal
        },
    })
}
