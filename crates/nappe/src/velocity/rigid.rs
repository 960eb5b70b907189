//! How frames move.

use crate::frame::aside;
use glam::{DMat3, DVec3};

/// The matrix of `x ↦ w × x`.
pub fn cross_matrix(w: DVec3) -> DMat3 {
    DMat3::from_cols(w.cross(DVec3::X), w.cross(DVec3::Y), w.cross(DVec3::Z))
}

/// How a frame moves: with its origin, and turning.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct FrameRate {
    /// The velocity of the origin.
    pub origin: DVec3,
    /// The angular velocity w: each direction e moves with `w × e`.
    pub turn: DVec3,
}

/// A unit vector and its rate from those of a vector of any length.
fn unit([v, rate]: [DVec3; 2]) -> [DVec3; 2] {
    let (length, v) = (v.length(), v.normalize_or_zero());
    [v, (rate - v * v.dot(rate)) / length]
}

/// Two coordinates of a unit vector nearer than this are equal but for rounding.
const TIE: f64 = 1e-12;

impl FrameRate {
    /// The rate of an axis through a moving point with a moving direction: the frame turns about the axis no more than
    /// it must. Enough where only the axis counts.
    pub fn of_axis(origin: DVec3, direction: [DVec3; 2]) -> Self {
        let [z, rate] = unit(direction);
        let turn = z.cross(rate);
        Self { origin, turn }
    }

    /// The rate of [`Frame::new`](crate::Frame::new)`(origin, z, x)`, or of [`Frame::along`](crate::Frame::along) if
    /// there is no x; vectors with their rates. `None` where z moves and the choice of x jumps.
    pub fn new(origin: DVec3, z: [DVec3; 2], x: Option<[DVec3; 2]>) -> Option<Self> {
        let [uz, dz] = unit(z);
        let x = match x {
            Some(x) => x,
            None => {
                let x = aside(uz);
                let lean = uz.abs();
                let least = lean.dot(x);
                let tied = lean
                    .to_array()
                    .iter()
                    .filter(|l| **l - least <= TIE)
                    .count()
                    > 1;
                if tied && dz != DVec3::ZERO {
                    return None;
                }
                [x, DVec3::ZERO]
            }
        };
        let [ux, dx] = unit(x);
        let cosine = ux.dot(uz);
        let across = ux - uz * cosine;
        let rate = dx - dz * cosine - uz * (dx.dot(uz) + ux.dot(dz));
        let [ex, dex] = unit([across, rate]);
        let (ey, dey) = (uz.cross(ex), dz.cross(ex) + uz.cross(dex));
        let turn = 0.5 * (ex.cross(dex) + ey.cross(dey) + uz.cross(dz));
        Some(Self { origin, turn })
    }

    /// The linear map that gives the velocity, but for that of the origin, of what is fixed in the frame.
    pub fn spin(&self) -> DMat3 {
        cross_matrix(self.turn)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Frame;
    use crate::laws::Random;

    #[test]
    fn frames_turn_as_their_rate_says() {
        // Where z leans on two axes alike, the frame without x jumps.
        let jumping = FrameRate::new(DVec3::ZERO, [DVec3::Z, DVec3::X], None);
        assert_eq!(jumping, None);
        let mut random = Random(5);
        let mut vector =
            || DVec3::new(random.unit(), random.unit(), random.unit()) * 2.0 - DVec3::ONE;
        for with_x in [false, true] {
            for _ in 0..50 {
                let [z, dz, x, dx] = [(); 4].map(|()| vector());
                let at = |h: f64| {
                    let z = z + dz * h;
                    match with_x {
                        true => Frame::new(DVec3::ZERO, z, x + dx * h),
                        false => Frame::along(DVec3::ZERO, z),
                    }
                };
                let h = 1e-5;
                let (Ok(a), Ok(m), Ok(b)) = (at(-h), at(0.0), at(h)) else {
                    continue;
                };
                if z.cross(x).length() < 0.1 || z.length() < 0.3 || x.length() < 0.3 {
                    continue;
                }
                let x = with_x.then_some([x, dx]);
                let rate = FrameRate::new(DVec3::ZERO, [z, dz], x).unwrap();
                for ((a, m), b) in a
                    .directions()
                    .into_iter()
                    .zip(m.directions())
                    .zip(b.directions())
                {
                    let difference = (b - a) / (2.0 * h);
                    assert!((rate.turn.cross(m) - difference).length() < 1e-6, "{z}");
                }
            }
        }
    }
}
