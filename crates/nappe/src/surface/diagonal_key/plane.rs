//! The plane-parallel case: is there a plane that holds all differences, and which axes does it have?

use super::DiagonalKeyError;
use glam::{DMat3, DVec3};

/// A difference vector may leave the plane by this part of the longest one. The surface keeps its sides all the same;
/// larger, and p and q would act on contours that visibly are not plane-parallel; smaller, and data written with ten
/// digits would not count as plane-parallel.
pub(super) const PLANE: f64 = 1e-9;

/// The axes of planes square to x, y and z.
const AXES: [[DVec3; 2]; 3] = [
    [DVec3::Y, DVec3::Z],
    [DVec3::Z, DVec3::X],
    [DVec3::X, DVec3::Y],
];

/// A plane with orthonormal axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    pub(super) axes: [DVec3; 2],
    pub(super) normal: DVec3,
    /// True if the axes follow from the coordinate system or were given, so that p and q have a meaning.
    pub(super) named: bool,
}

impl Plane {
    fn new(axes: [DVec3; 2], named: bool) -> Self {
        let normal = axes[0].cross(axes[1]);
        Self {
            axes,
            normal,
            named,
        }
    }

    /// From axes given by a user: the first is kept in direction, the second made square to it.
    pub(super) fn given(axes: [DVec3; 2]) -> Result<Self, DiagonalKeyError> {
        const PARALLEL: f64 = 1e-6;
        let unit = axes.map(|a| a.try_normalize());
        if let [Some(x), Some(y)] = unit {
            let square = y - x * y.dot(x);
            if square.length() > PARALLEL {
                return Ok(Self::new([x, square.normalize()], true));
            }
        }
        Err(DiagonalKeyError::Axes { axes })
    }

    /// The greatest distance of the ends of some vectors from the plane through their common start.
    pub(super) fn deviation(&self, vectors: &[DVec3]) -> f64 {
        vectors
            .iter()
            .map(|w| w.dot(self.normal).abs())
            .fold(0.0, f64::max)
    }

    /// The plane that the `needed` vectors lie in: the one square to x, y or z in which the generators (`wanted`)
    /// lie too, or else one square to an axis, or else the one they are nearest to. Tolerances are lengths, one for
    /// each list.
    pub(super) fn find(needed: (&[DVec3], f64), wanted: (&[DVec3], f64)) -> Self {
        let coordinate = AXES.map(|axes| Self::new(axes, true));
        let fits = |p: &&Plane, (v, tol): (&[DVec3], f64)| p.deviation(v) <= tol;
        let named = coordinate
            .iter()
            .find(|p| fits(p, needed) && fits(p, wanted))
            .or_else(|| coordinate.iter().find(|p| fits(p, needed)));
        if let Some(p) = named {
            return *p;
        }
        let sum = needed.0.iter().fold(DMat3::ZERO, |m, w| m + dyad(*w, *w));
        let (values, frame) = eigen(sum);
        let least = (0..3).fold(0, |b, i| if values[i] < values[b] { i } else { b });
        let normal = frame.col(least).normalize();
        let x = normal.any_orthonormal_vector();
        Self::new([x, normal.cross(x)], false)
    }
}

/// `a bᵀ`.
pub(crate) fn dyad(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// The eigenvalues of a symmetric matrix and the frame of its eigenvectors, by cyclic Jacobi rotations.
pub(super) fn eigen(mut m: DMat3) -> ([f64; 3], DMat3) {
    let mut frame = DMat3::IDENTITY;
    const SWEEPS: usize = 12;
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = m.col(q)[p];
            if off == 0.0 {
                continue;
            }
            let theta = 0.5 * (2.0 * off).atan2(m.col(p)[p] - m.col(q)[q]);
            let (s, c) = theta.sin_cos();
            let mut r = DMat3::IDENTITY;
            r.col_mut(p)[p] = c;
            r.col_mut(q)[q] = c;
            r.col_mut(p)[q] = s;
            r.col_mut(q)[p] = -s;
            m = r.transpose() * m * r;
            frame *= r;
        }
    }
    ([m.col(0).x, m.col(1).y, m.col(2).z], frame)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_oblique_plane_is_found() {
        let n = DVec3::new(1.0, -2.0, 0.5).normalize();
        let x = n.any_orthonormal_vector();
        let y = n.cross(x);
        let v: Vec<_> = (0..20)
            .map(|i| x * (i as f64).sin() + y * (i as f64 * 0.7).cos())
            .collect();
        let p = Plane::find((&v, 1e-12), (&[], 1e-12));
        assert!(p.deviation(&v) < 1e-15 && !p.named);
        assert!(p.normal.cross(n).length() < 1e-14);
    }

    #[test]
    fn the_generators_decide_between_coordinate_planes() {
        // All differences along y: planes square to x and to z hold them, the generators say which.
        let d = [DVec3::Y, DVec3::Y * 2.0];
        let axes = |g: DVec3| Plane::find((&d, 1e-9), (&[g], 1e-9)).axes;
        assert_eq!(axes(DVec3::X), AXES[2]);
        assert_eq!(axes(DVec3::Z), AXES[0]);
        assert_eq!(axes(DVec3::ONE), AXES[0]);
    }
}
