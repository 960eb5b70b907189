//! Rigid maps and reflections as affine maps.

use crate::frame::{Frame, cos_sin};
use glam::{DAffine3, DMat3, DVec3};

/// The rotation about a frame's z axis through an angle in radians, counter-clockwise seen from the tip of the axis.
/// Eighths of a turn about coordinate axes are exact.
pub fn rotation(axis: &Frame, angle: f64) -> DAffine3 {
    let (c, s) = cos_sin(angle);
    in_frame(
        axis,
        DMat3::from_cols(
            DVec3::new(c, s, 0.0),
            DVec3::new(-s, c, 0.0),
            DVec3::new(0.0, 0.0, 1.0),
        ),
    )
}

/// The reflection in the plane through a frame's origin, square to its z axis.
pub fn mirror(plane: &Frame) -> DAffine3 {
    in_frame(plane, DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0)))
}

/// The scaling about a frame's origin by a factor along each of its directions.
pub fn scaling(centre: &Frame, factors: DVec3) -> DAffine3 {
    in_frame(centre, DMat3::from_diagonal(factors))
}

/// A linear map given in the coordinates of a frame.
fn in_frame(frame: &Frame, map: DMat3) -> DAffine3 {
    let [x, y, z] = frame.directions();
    let axes = DMat3::from_cols(x, y, z);
    let matrix3 = axes * map * axes.transpose();
    DAffine3 {
        matrix3,
        translation: frame.origin() - matrix3 * frame.origin(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn maps_do_what_they_say() {
        let z = Frame::along(DVec3::new(1.0, 0.0, 0.0), DVec3::Z).unwrap();
        assert_eq!(
            rotation(&z, FRAC_PI_2).transform_point3(DVec3::new(2.0, 0.0, 5.0)),
            DVec3::new(1.0, 1.0, 5.0)
        );
        assert_eq!(
            mirror(&z).transform_point3(DVec3::new(2.0, 3.0, 5.0)),
            DVec3::new(2.0, 3.0, -5.0)
        );
        let tilted = Frame::along(DVec3::ONE, DVec3::new(1.0, 2.0, 2.0)).unwrap();
        let m = mirror(&tilted);
        assert!((m * m).abs_diff_eq(DAffine3::IDENTITY, 1e-14));
        assert!((m.transform_point3(DVec3::ONE) - DVec3::ONE).length() < 1e-14);
        let s = scaling(&tilted, DVec3::new(1.0, 1.0, 3.0));
        let p = DVec3::ONE + DVec3::new(1.0, 2.0, 2.0);
        assert!((s.transform_point3(p) - DVec3::ONE - DVec3::new(3.0, 6.0, 6.0)).length() < 1e-14);
    }
}
