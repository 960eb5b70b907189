//! Right-handed orthonormal frames: axes of revolution, centres of quadrics, planes of mirrors.

use crate::box3::Box3;
use crate::interval::Interval;
use glam::DVec3;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4};
use thiserror::Error;

/// What can be wrong with a frame.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FrameError {
    /// The origin has a coordinate that is NaN or infinite.
    #[error("the origin is {origin}: coordinates must be finite numbers")]
    Origin {
        /// The origin given.
        origin: DVec3,
    },
    /// A direction has no length or is not finite.
    #[error("the {name} is {direction}: a direction must be finite and not zero")]
    Direction {
        /// Which direction: `direction` or `x direction`.
        name: &'static str,
        /// The direction given.
        direction: DVec3,
    },
    /// The second direction is parallel to the first.
    #[error("the x direction {x} is parallel to the direction {z}: it must point aside")]
    Parallel {
        /// The main direction.
        z: DVec3,
        /// The second direction.
        x: DVec3,
    },
}

/// The sine of the angle below which two directions are taken as parallel: with less, the frame would turn visibly
/// by the rounding of its input.
const PARALLEL: f64 = 1e-9;

/// A point and three orthonormal directions, `x × y = z`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Frame {
    origin: DVec3,
    x: DVec3,
    y: DVec3,
    z: DVec3,
}

/// The coordinate axis that a direction leans on least, the first of those.
pub(crate) fn aside(direction: DVec3) -> DVec3 {
    let a = direction.abs();
    if a.x <= a.y && a.x <= a.z {
        DVec3::X
    } else if a.y <= a.z {
        DVec3::Y
    } else {
        DVec3::Z
    }
}

impl Frame {
    /// The frame of space.
    pub const WORLD: Frame = Frame {
        origin: DVec3::ZERO,
        x: DVec3::X,
        y: DVec3::Y,
        z: DVec3::Z,
    };

    /// The frame with its z along a direction of any length. Its x is square to that and as near as possible to the
    /// coordinate axis that the direction leans on least (the first of those; so z gives x, y, z themselves).
    pub fn along(origin: DVec3, z: DVec3) -> Result<Self, FrameError> {
        Self::new(origin, z, aside(unit("direction", z)?))
    }

    /// The frame with its z along a direction and its x in the half-plane of z and a second direction.
    pub fn new(origin: DVec3, z: DVec3, x: DVec3) -> Result<Self, FrameError> {
        if !origin.is_finite() {
            return Err(FrameError::Origin { origin });
        }
        let (uz, ux) = (unit("direction", z)?, unit("x direction", x)?);
        let aside = ux - uz * ux.dot(uz);
        if aside.length() < PARALLEL {
            return Err(FrameError::Parallel { z, x });
        }
        let ux = aside.normalize();
        // Once more: after the first step ux is square to uz only up to rounding over the sine of their angle.
        let ux = (ux - uz * ux.dot(uz)).normalize();
        Ok(Self {
            origin,
            x: ux,
            y: uz.cross(ux),
            z: uz,
        })
    }

    /// The same directions at another origin.
    pub fn moved_to(&self, origin: DVec3) -> Self {
        Self { origin, ..*self }
    }

    /// The origin.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The first direction.
    pub fn x(&self) -> DVec3 {
        self.x
    }

    /// The second direction.
    pub fn y(&self) -> DVec3 {
        self.y
    }

    /// The third direction: the axis.
    pub fn z(&self) -> DVec3 {
        self.z
    }

    /// The three directions.
    pub fn directions(&self) -> [DVec3; 3] {
        [self.x, self.y, self.z]
    }

    /// The coordinates of a point in the frame.
    pub fn coordinates(&self, p: DVec3) -> DVec3 {
        self.components(p - self.origin)
    }

    /// The components of a vector along the frame's directions.
    pub fn components(&self, v: DVec3) -> DVec3 {
        DVec3::new(self.x.dot(v), self.y.dot(v), self.z.dot(v))
    }

    /// The point with the given coordinates.
    pub fn point(&self, c: DVec3) -> DVec3 {
        self.origin + self.x * c.x + self.y * c.y + self.z * c.z
    }

    /// Encloses the coordinates of all points of a box.
    pub fn enclose_coordinates(&self, b: Box3) -> Box3 {
        self.enclose_components(b - Box3::point(self.origin))
    }

    /// Encloses the components of all vectors of a box.
    pub fn enclose_components(&self, b: Box3) -> Box3 {
        let dot = |d: DVec3| {
            b.x * Interval::point(d.x) + b.y * Interval::point(d.y) + b.z * Interval::point(d.z)
        };
        Box3 {
            x: dot(self.x),
            y: dot(self.y),
            z: dot(self.z),
        }
    }
}

fn unit(name: &'static str, direction: DVec3) -> Result<DVec3, FrameError> {
    // Scaled first, so that neither very long nor very short directions over- or underflow when squared.
    let scaled = direction / direction.abs().max_element();
    if !direction.is_finite() || !scaled.is_finite() {
        return Err(FrameError::Direction { name, direction });
    }
    Ok(scaled.normalize())
}

/// Cosine and sine, exact at whole multiples of an eighth of a turn (within 4 units in the last place of the angle):
/// so quarter circles end on the axes, and a whole turn ends where it began.
pub fn cos_sin(angle: f64) -> (f64, f64) {
    let eighths = (angle / FRAC_PI_4).round();
    let near = (angle - eighths * FRAC_PI_4).abs() <= 4.0 * f64::EPSILON * angle.abs();
    if near && eighths.abs() < 1e6 {
        let h = FRAC_1_SQRT_2;
        return [
            (1.0, 0.0),
            (h, h),
            (0.0, 1.0),
            (-h, h),
            (-1.0, 0.0),
            (-h, -h),
            (0.0, -1.0),
            (h, -h),
        ][(eighths as i64).rem_euclid(8) as usize];
    }
    (angle.cos(), angle.sin())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    #[test]
    fn coordinate_axes_give_exact_frames() {
        let z = Frame::along(DVec3::ONE, DVec3::Z * 1e-200).unwrap();
        assert_eq!(z.directions(), [DVec3::X, DVec3::Y, DVec3::Z]);
        let x = Frame::along(DVec3::ZERO, DVec3::X).unwrap();
        assert_eq!(x.directions(), [DVec3::Y, DVec3::Z, DVec3::X]);
    }

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        let f = Frame::new(
            DVec3::ONE,
            DVec3::new(1.0, 2.0, -3.0),
            DVec3::new(1.0, 2.0, -3.001),
        )
        .unwrap();
        let [x, y, z] = f.directions();
        for (a, b) in [(x, y), (y, z), (z, x)] {
            assert!(a.dot(b).abs() < 1e-15 && (a.length() - 1.0).abs() < 1e-15);
        }
        assert!((x.cross(y) - z).length() < 1e-15);
        let p = DVec3::new(4.0, -1.0, 7.0);
        assert!((f.point(f.coordinates(p)) - p).length() < 1e-14);
    }

    #[test]
    fn bad_directions_are_named() {
        assert!(matches!(
            Frame::along(DVec3::ZERO, DVec3::ZERO),
            Err(FrameError::Direction { .. })
        ));
        assert!(matches!(
            Frame::along(DVec3::NAN, DVec3::X),
            Err(FrameError::Origin { .. })
        ));
        assert!(matches!(
            Frame::new(DVec3::ZERO, DVec3::X, DVec3::X * 3.0),
            Err(FrameError::Parallel { .. })
        ));
        assert!(Frame::along(DVec3::ZERO, DVec3::new(0.0, f64::INFINITY, 0.0)).is_err());
    }

    #[test]
    fn turns_are_exact_at_eighths() {
        assert_eq!(cos_sin(TAU), (1.0, 0.0));
        assert_eq!(cos_sin(-PI), (-1.0, 0.0));
        assert_eq!(cos_sin(PI * 0.25).0, cos_sin(PI * 0.25).1);
        assert_eq!(cos_sin(0.7), (0.7f64.cos(), 0.7f64.sin()));
    }
}
