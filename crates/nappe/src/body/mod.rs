//! Bodies: faces that share edges, as sheets or as the boundaries of solids.
//!
//! A [`Body`] is what other systems exchange: each [`Face`] is a part of a surface inside [`Loop`]s, loops run along
//! [`Edge`]s, and faces are neighbours where they share an edge. Everything is held by index in flat lists.
//!
//! ```text
//! Body ── shells: which faces, closed or not
//!      ── faces:  surface, which side is out, loops ── coedges: edge, direction
//!      ── edges:  curve, two vertices, tolerance
//!      ── vertices: points
//! ```

mod bend;
mod chart;
mod closing;
mod cover;
mod cut;
mod error;
mod figures;
mod flat;
mod mesh;
mod region;
mod sew;
mod shells;
mod transform;
mod triangulate;
mod whole;

pub use cover::{CoverError, cover};
pub use error::BodyError;
pub use figures::{BodyFigures, extent, figures};
pub use mesh::{BodyMeshError, FaceError, Meshed, mesh};
pub use region::RegionError;
pub use sew::{Sewn, sew};
use shells::shells;
pub use transform::{BodyCounts, BodyTransformError};

use crate::curve::CurveRef;
use crate::surface::SurfaceRef;
use glam::DVec3;

/// Faces that share edges.
#[derive(Clone, Debug, Default)]
pub struct Body {
    /// The points where edges end.
    pub vertices: Vec<Vertex>,
    /// The curves that faces share.
    pub edges: Vec<Edge>,
    /// The faces.
    pub faces: Vec<Face>,
    /// The shells. Each face belongs to at least one.
    pub shells: Vec<Shell>,
}

/// Where edges end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// The point.
    pub point: DVec3,
}

/// A curve between two vertices, shared by the faces it bounds.
#[derive(Clone, Debug)]
pub struct Edge {
    /// The curve. Its whole domain is the edge.
    pub curve: CurveRef,
    /// The vertices at the start and the end of the curve; equal for a closed edge.
    pub vertices: [usize; 2],
    /// No point of the curve is claimed to be farther than this from the surfaces it bounds, nor its ends from their
    /// vertices. Finite; what a file states, or 0. What is true is measured where it matters.
    pub tolerance: f64,
}

/// A part of a surface.
#[derive(Clone, Debug)]
pub struct Face {
    /// The surface. Loops lie within its domain, or beyond it by its period.
    pub surface: SurfaceRef,
    /// Whether the normal of the face is `r_u × r_v`, and not its opposite.
    pub forward: bool,
    /// What bounds it, outer and inner loops in any order. Without loops the face is the whole surface, which is then
    /// closed.
    pub loops: Vec<Loop>,
}

/// One contour of a face.
#[derive(Clone, Debug, PartialEq)]
pub enum Loop {
    /// Edges end to end. Seen with the normal of the face upwards, the face lies to the left of them.
    Edges(Vec<Coedge>),
    /// One vertex: the tip of a cone or the pole of a sphere.
    Vertex(usize),
}

/// An edge as a loop runs along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coedge {
    /// Index into [`Body::edges`].
    pub edge: usize,
    /// Whether the loop runs in the direction of the edge's curve.
    pub forward: bool,
}

/// Faces that hang together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shell {
    /// Index into [`Body::faces`], and whether the shell takes the face as it is, and not the other way round.
    pub faces: Vec<(usize, bool)>,
    /// Whether it is said to enclose a solid, with the normals of its faces pointing out of it.
    pub closed: bool,
}

impl Body {
    /// The vertices that a loop's edge starts and ends at, in the direction of the loop.
    ///
    /// Panics if the coedge names an edge that is not there: see [`Body::validate`].
    pub fn ends(&self, c: Coedge) -> [usize; 2] {
        let [a, b] = self.edges[c.edge].vertices;
        if c.forward { [a, b] } else { [b, a] }
    }

    /// Checks that every index exists, that every number is finite and no tolerance negative, that loops are closed and not
    /// empty, and that the curves of edges end within `tol` of their vertices (or the edge's own tolerance, whichever is
    /// larger).
    ///
    /// # Errors
    /// The first thing that is wrong, with its place and numbers.
    pub fn validate(&self, tol: f64) -> Result<(), BodyError> {
        let some = |what, index: usize, count: usize| {
            if index < count {
                Ok(())
            } else {
                Err(BodyError::Index { what, index, count })
            }
        };
        for (vertex, v) in self.vertices.iter().enumerate() {
            if !v.point.is_finite() {
                let point = v.point;
                return Err(BodyError::Point { vertex, point });
            }
        }
        for (edge, e) in self.edges.iter().enumerate() {
            let ends = e.curve.ends();
            let tolerance = e.tolerance;
            if !(tolerance.is_finite() && tolerance >= 0.0) {
                return Err(BodyError::Tolerance { edge, tolerance });
            }
            for end in 0..2 {
                some("vertex", e.vertices[end], self.vertices.len())?;
                let distance = ends[end].distance(self.vertices[e.vertices[end]].point);
                let allowed = tol.max(tolerance);
                if !distance.is_finite() || distance > allowed {
                    return Err(BodyError::End {
                        edge,
                        end,
                        distance,
                        allowed,
                    });
                }
            }
        }
        for (face, f) in self.faces.iter().enumerate() {
            for (number, l) in f.loops.iter().enumerate() {
                match l {
                    Loop::Vertex(v) => some("vertex", *v, self.vertices.len())?,
                    Loop::Edges(coedges) => {
                        for c in coedges {
                            some("edge", c.edge, self.edges.len())?;
                        }
                        let next = coedges.iter().cycle().skip(1);
                        let open = coedges
                            .iter()
                            .zip(next)
                            .position(|(a, b)| self.ends(*a)[1] != self.ends(*b)[0]);
                        if coedges.is_empty() || open.is_some() {
                            return Err(BodyError::Open {
                                face,
                                number,
                                after: open,
                            });
                        }
                    }
                }
            }
        }
        for shell in &self.shells {
            for (f, _) in &shell.faces {
                some("face", *f, self.faces.len())?;
            }
        }
        Ok(())
    }

    /// For each edge the faces whose loops run along it, with the direction relative to the edge as the face is: two of
    /// opposite directions inside a shell of faces that agree, one at its border, two of one face at a seam.
    pub fn uses(&self) -> Vec<Vec<(usize, bool)>> {
        let mut uses = vec![Vec::new(); self.edges.len()];
        for (face, f) in self.faces.iter().enumerate() {
            for l in &f.loops {
                if let Loop::Edges(coedges) = l {
                    coedges
                        .iter()
                        .for_each(|c| uses[c.edge].push((face, c.forward)));
                }
            }
        }
        uses
    }
}
