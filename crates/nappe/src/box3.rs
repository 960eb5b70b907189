//! Axis-parallel boxes: enclosures of points and vectors.

use crate::interval::Interval;
use glam::{DMat3, DVec3};
use std::ops::{Add, Sub};

/// An axis-parallel box that encloses a point or a vector.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Box3 {
    /// The range of x.
    pub x: Interval,
    /// The range of y.
    pub y: Interval,
    /// The range of z.
    pub z: Interval,
}

impl Box3 {
    /// The box of one point at the origin.
    pub const ZERO: Box3 = Box3 {
        x: Interval::ZERO,
        y: Interval::ZERO,
        z: Interval::ZERO,
    };
    /// All of space: "nothing is known".
    pub const ENTIRE: Box3 = Box3 {
        x: Interval::ENTIRE,
        y: Interval::ENTIRE,
        z: Interval::ENTIRE,
    };

    /// The box that holds one point.
    pub fn point(p: DVec3) -> Self {
        Self {
            x: Interval::point(p.x),
            y: Interval::point(p.y),
            z: Interval::point(p.z),
        }
    }

    /// The smallest box around some points; `None` for no points.
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Option<Self> {
        points.into_iter().map(Self::point).reduce(Self::hull)
    }

    /// The three ranges.
    pub fn to_array(self) -> [Interval; 3] {
        [self.x, self.y, self.z]
    }

    /// True if the point lies inside or on the border.
    pub fn contains(self, p: DVec3) -> bool {
        self.x.contains(p.x) && self.y.contains(p.y) && self.z.contains(p.z)
    }

    /// True if both have a point in common, be it on their borders.
    pub fn touches(self, o: Self) -> bool {
        let pairs = self.to_array().into_iter().zip(o.to_array());
        pairs.into_iter().all(|(a, b)| a.intersection(b).is_some())
    }

    /// True if all six ends are finite.
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }

    /// The smallest box that contains both.
    pub fn hull(self, o: Self) -> Self {
        Self {
            x: self.x.hull(o.x),
            y: self.y.hull(o.y),
            z: self.z.hull(o.z),
        }
    }

    /// The common part of two enclosures of the same thing.
    pub fn meet(self, o: Self) -> Self {
        Self {
            x: self.x.meet(o.x),
            y: self.y.meet(o.y),
            z: self.z.meet(o.z),
        }
    }

    /// Widened by `r` in every direction.
    pub fn inflate(self, r: f64) -> Self {
        Self {
            x: self.x.inflate(r),
            y: self.y.inflate(r),
            z: self.z.inflate(r),
        }
    }

    /// A point inside, near the middle.
    pub fn mid(self) -> DVec3 {
        DVec3::new(self.x.mid(), self.y.mid(), self.z.mid())
    }

    /// The length of the diagonal, rounded up.
    pub fn diagonal(self) -> f64 {
        let w = [self.x, self.y, self.z].map(|i| Interval::point(i.width()).sqr());
        (w[0] + w[1] + w[2]).sqrt().hi
    }

    /// The range of lengths of the vectors in the box.
    pub fn norm(self) -> Interval {
        (self.x.sqr() + self.y.sqr() + self.z.sqr()).sqrt()
    }

    /// The dot product of every pair.
    pub fn dot(self, o: Self) -> Interval {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// The cross product of every pair.
    pub fn cross(self, o: Self) -> Self {
        Self {
            x: self.y * o.z - self.z * o.y,
            y: self.z * o.x - self.x * o.z,
            z: self.x * o.y - self.y * o.x,
        }
    }

    /// A box around the images of all vectors under a linear map.
    pub fn linear_image(self, map: &DMat3) -> Self {
        let column = |c: DVec3, s: Interval| Box3::point(c).scale(s);
        column(map.x_axis, self.x) + column(map.y_axis, self.y) + column(map.z_axis, self.z)
    }

    /// Every vector times every number.
    pub fn scale(self, s: Interval) -> Self {
        Self {
            x: self.x * s,
            y: self.y * s,
            z: self.z * s,
        }
    }
}

impl From<[Interval; 3]> for Box3 {
    fn from([x, y, z]: [Interval; 3]) -> Self {
        Self { x, y, z }
    }
}

impl Add for Box3 {
    type Output = Box3;
    fn add(self, o: Box3) -> Box3 {
        Box3 {
            x: self.x + o.x,
            y: self.y + o.y,
            z: self.z + o.z,
        }
    }
}

impl Sub for Box3 {
    type Output = Box3;
    fn sub(self, o: Box3) -> Box3 {
        Box3 {
            x: self.x - o.x,
            y: self.y - o.y,
            z: self.z - o.z,
        }
    }
}
