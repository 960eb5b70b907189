//! What a surface is in the language of elementary geometry, where that is known exactly.

use crate::exact::NurbsSurface;
use crate::frame::Frame;
use crate::surface::Surface;
use glam::{DAffine3, DMat3, DVec3};

/// A control net whose points all lie within this distance of a plane, relative to the net's size, is flat. With
/// positive weights the surface lies in the hull of its net, so this also bounds the surface. Larger would make
/// fillets of slightly curved surfaces wrong by as much, smaller would refuse planes that are rounded.
const FLAT: f64 = 1e-13;
/// Relative difference of lengths and angles within which a map keeps circles round.
const SIMILAR: f64 = 1e-13;

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
                let [x, y, z] = axis.directions().map(|d| map.matrix3 * d);
                let scale = x.length();
                let round = (y.length() - scale).abs() <= SIMILAR * scale;
                let square =
                    |a: DVec3, b: DVec3| a.dot(b).abs() <= SIMILAR * a.length() * b.length();
                if !(round && square(x, y) && square(y, z) && square(z, x)) {
                    return None;
                }
                let keeps = map.matrix3.determinant() > 0.0;
                Some(Elementary::Cylinder {
                    axis: Frame::new(map.transform_point3(axis.origin()), z, x).ok()?,
                    radius: radius * scale,
                    outward: outward == keeps,
                })
            }
        }
    }

    /// The same with the normal on the other side.
    pub fn flipped(self) -> Self {
        match self {
            Elementary::Plane { origin, normal } => Elementary::Plane {
                origin,
                normal: -normal,
            },
            Elementary::Cylinder {
                axis,
                radius,
                outward,
            } => Elementary::Cylinder {
                axis,
                radius,
                outward: !outward,
            },
        }
    }
}

/// `(A a) × (A b)` for `n = a × b`: the cofactor matrix applied to n.
pub(super) fn normal_image(a: &DMat3, n: DVec3) -> DVec3 {
    let (x, y, z) = (a.x_axis, a.y_axis, a.z_axis);
    y.cross(z) * n.x + z.cross(x) * n.y + x.cross(y) * n.z
}

/// The plane of a flat NURBS surface.
pub(super) fn plane_of(surface: &NurbsSurface) -> Option<Elementary> {
    let points = surface.control_points();
    if surface.weights().iter().any(|w| *w <= 0.0) {
        return None;
    }
    let origin = points[0];
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
