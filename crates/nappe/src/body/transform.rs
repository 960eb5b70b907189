//! Bodies moved, turned, scaled and mirrored.

use super::{Body, Edge, Face, Vertex};
use crate::curve::{self, CurveError};
use crate::surface::{self, TransformError};
use glam::DAffine3;
use std::sync::Arc;
use thiserror::Error;

/// Why a body has no image.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BodyTransformError {
    /// The map does not fit a curve.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// The map does not fit a surface.
    #[error(transparent)]
    Surface(#[from] TransformError),
}

/// How many there are of each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BodyCounts {
    /// Vertices.
    pub vertices: usize,
    /// Edges.
    pub edges: usize,
    /// Faces.
    pub faces: usize,
    /// Loops of all faces.
    pub loops: usize,
    /// Closed shells.
    pub closed: usize,
    /// Other shells.
    pub open: usize,
}

impl Body {
    /// The image under an affine map. A map that mirrors turns `r_u × r_v` to the other side of the material: faces
    /// are turned, so that normals that pointed out of a solid still do. Tolerances grow with the longest image of a unit
    /// vector.
    ///
    /// # Errors
    /// A number of the map is not finite, or it is singular.
    pub fn transformed(&self, map: &DAffine3) -> Result<Body, BodyTransformError> {
        let m = &map.matrix3;
        // The Frobenius norm is no less than the spectral one.
        let stretch =
            (m.x_axis.length_squared() + m.y_axis.length_squared() + m.z_axis.length_squared())
                .sqrt();
        let edge = |e: &Edge| -> Result<Edge, BodyTransformError> {
            Ok(Edge {
                curve: Arc::new(curve::Transformed::new(e.curve.clone(), *map)?),
                vertices: e.vertices,
                tolerance: e.tolerance * stretch,
            })
        };
        let mirrors = m.determinant() < 0.0;
        let face = |f: &Face| -> Result<Face, BodyTransformError> {
            let image = surface::Transformed::new(f.surface.clone(), *map)?;
            let mut face = Face {
                surface: Arc::new(image),
                ..f.clone()
            };
            if mirrors {
                face.turn();
            }
            Ok(face)
        };
        let vertex = |v: &Vertex| Vertex {
            point: map.transform_point3(v.point),
        };
        Ok(Body {
            vertices: self.vertices.iter().map(vertex).collect(),
            edges: self.edges.iter().map(edge).collect::<Result<_, _>>()?,
            faces: self.faces.iter().map(face).collect::<Result<_, _>>()?,
            shells: self.shells.clone(),
        })
    }

    /// How many vertices, edges, faces, loops and shells there are.
    pub fn counts(&self) -> BodyCounts {
        let closed = self.shells.iter().filter(|s| s.closed).count();
        BodyCounts {
            vertices: self.vertices.len(),
            edges: self.edges.len(),
            faces: self.faces.len(),
            loops: self.faces.iter().map(|f| f.loops.len()).sum(),
            closed,
            open: self.shells.len() - closed,
        }
    }
}
