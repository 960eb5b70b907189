//! Certified triangle meshes.

use glam::DVec3;

/// How far an approximating result is from the exact thing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Certainty {
    /// No error beyond rounding.
    Exact,
    /// Proven: the error is at most this length.
    Bounded(f64),
    /// Not proven: sampling found no larger error than this.
    Estimated(f64),
}

impl Certainty {
    /// The error: 0 if exact.
    pub fn error(self) -> f64 {
        match self {
            Certainty::Exact => 0.0,
            Certainty::Bounded(e) | Certainty::Estimated(e) => e,
        }
    }

    /// The certainty of a whole made of two parts: the weaker statement and the larger error.
    pub fn and(self, o: Certainty) -> Certainty {
        let e = self.error().max(o.error());
        match (self, o) {
            (Certainty::Estimated(_), _) | (_, Certainty::Estimated(_)) => Certainty::Estimated(e),
            (Certainty::Exact, Certainty::Exact) => Certainty::Exact,
            _ => Certainty::Bounded(e),
        }
    }
}

/// A triangle mesh of several surfaces. Points are shared across surfaces and along seams, so the mesh is watertight
/// by construction; what differs from patch to patch (parameters, normals) is in the patches' vertices.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// The points. No two triangles meet in an edge without sharing these.
    pub points: Vec<DVec3>,
    /// One patch for each surface, in the order given.
    pub patches: Vec<MeshPatch>,
}

/// The mesh of one surface.
#[derive(Clone, Debug)]
pub struct MeshPatch {
    /// The vertices. Several may share a point: on a seam, and at a pole, where each triangle has its own normal.
    pub vertices: Vec<MeshVertex>,
    /// Indices into `vertices`, counter-clockwise seen from the side the normal points to.
    pub triangles: Vec<[u32; 3]>,
    /// The two-sided Hausdorff distance between this patch and its surface.
    pub deviation: Certainty,
}

/// A corner of mesh triangles on one surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshVertex {
    /// Index into [`Mesh::points`].
    pub point: u32,
    /// The parameters on the surface.
    pub uv: [f64; 2],
    /// The unit normal.
    pub normal: DVec3,
}
