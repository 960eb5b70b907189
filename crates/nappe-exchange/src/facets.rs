//! Triangles as a file stores them: what rounding to f32 does, and what becomes of degenerate ones.

use crate::report::Tally;
use glam::{DVec3, Vec3};
use nappe::mesh::{Mesh, MeshPatch};

/// How a format stores a point.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Store {
    /// As f64, unchanged.
    Double,
    /// As f32, measured from an origin.
    Single {
        /// The origin, kept elsewhere in the file as f64 (or zero).
        origin: DVec3,
    },
}

impl Store {
    /// The point as a reader gets it, measured from the origin.
    pub(crate) fn single(self, p: DVec3) -> Vec3 {
        match self {
            Store::Double => p.as_vec3(),
            Store::Single { origin } => (p - origin).as_vec3(),
        }
    }

    /// How far storing moves the point.
    pub(crate) fn moved(self, p: DVec3) -> f64 {
        match self {
            Store::Double => 0.0,
            Store::Single { origin } => ((p - origin).as_vec3().as_dvec3() - (p - origin)).length(),
        }
    }

    /// The corners as stored, as f64.
    fn stored(self, corners: [DVec3; 3]) -> [DVec3; 3] {
        match self {
            Store::Double => corners,
            Store::Single { .. } => corners.map(|c| self.single(c).as_dvec3()),
        }
    }
}

/// What storing makes of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Facet {
    /// It has an area.
    Sound,
    /// Three different corners on one line. It must stay: its three neighbours have different edges.
    Sliver,
    /// Two corners are one. It must go: its two other edges are one as well, and its neighbours meet there.
    Collapsed,
}

/// The corners of a triangle.
pub(crate) fn corners(mesh: &Mesh, patch: &MeshPatch, triangle: [u32; 3]) -> [DVec3; 3] {
    triangle.map(|i| mesh.points[patch.vertices[i as usize].point as usize])
}

/// Twice the area of a triangle as a vector along its normal.
pub(crate) fn area_vector([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// What storing makes of a triangle with these corners.
pub(crate) fn classify(corners: [DVec3; 3], store: Store) -> Facet {
    let [a, b, c] = store.stored(corners);
    if a == b || b == c || c == a {
        Facet::Collapsed
    } else if area_vector([a, b, c]) == DVec3::ZERO {
        Facet::Sliver
    } else {
        Facet::Sound
    }
}

impl Tally {
    /// Counts a triangle and says whether it is written.
    pub(crate) fn admit(&mut self, corners: [DVec3; 3], store: Store) -> bool {
        match classify(corners, store) {
            Facet::Collapsed => {
                self.dropped += 1;
                return false;
            }
            Facet::Sliver => self.slivers += 1,
            Facet::Sound => {}
        }
        self.triangles += 1;
        true
    }

    /// Notes how far storing moves a point.
    pub(crate) fn note_rounding(&mut self, p: DVec3, store: Store) {
        self.rounding = self.rounding.max(store.moved(p));
    }
}

/// The unit normal of a facet from the exact corners; of a facet without area, the mean of the surface's normals.
pub(crate) fn facet_normal(corners: [DVec3; 3], normals: [DVec3; 3]) -> DVec3 {
    // Scaled first: the cross product of edges of 1e-170 underflows.
    let size = (corners[1] - corners[0])
        .abs()
        .max((corners[2] - corners[0]).abs())
        .max_element();
    let scaled = [
        DVec3::ZERO,
        (corners[1] - corners[0]) / size,
        (corners[2] - corners[0]) / size,
    ];
    area_vector(scaled)
        .try_normalize()
        .or_else(|| (normals[0] + normals[1] + normals[2]).try_normalize())
        .unwrap_or(normals[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_far_from_the_origin_collapses_and_flattens() {
        let far = DVec3::splat(1e8);
        let store = Store::Single {
            origin: DVec3::ZERO,
        };
        // The spacing of f32 at 1e8 is 8.
        let t = |c: [[f64; 3]; 3]| c.map(|p| far + DVec3::from(p));
        assert_eq!(
            classify(t([[0., 0., 0.], [1., 0., 0.], [0., 64., 0.]]), store),
            Facet::Collapsed
        );
        assert_eq!(
            classify(t([[0., 0., 0.], [32., 1., 0.], [64., 0., 0.]]), store),
            Facet::Sliver
        );
        assert_eq!(
            classify(t([[0., 0., 0.], [32., 0., 0.], [0., 32., 0.]]), store),
            Facet::Sound
        );
        let near = Store::Single { origin: far };
        assert_eq!(
            classify(t([[0., 0., 0.], [1., 0., 0.], [0., 64., 0.]]), near),
            Facet::Sound
        );
        assert!(
            store.moved(far + DVec3::splat(3.0)) > 3.0
                && near.moved(far + DVec3::splat(3.0)) == 0.0
        );
    }

    #[test]
    fn normals_of_tiny_and_flat_facets_are_unit() {
        let n = [DVec3::Z, DVec3::Z, DVec3::Y];
        for s in [1e-200, 1.0, 1e150] {
            let c = [DVec3::ZERO, DVec3::X * s, DVec3::Y * s];
            assert!((facet_normal(c, n) - DVec3::Z).length() < 1e-15);
        }
        let flat = facet_normal([DVec3::ZERO, DVec3::X, DVec3::X * 2.0], n);
        assert!((flat.length() - 1.0).abs() < 1e-15 && flat.z > flat.y);
        assert!(facet_normal([DVec3::X; 3], n).is_finite());
    }
}
