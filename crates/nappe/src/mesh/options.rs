//! What a mesh is asked for, and what can be wrong with that.

use crate::surface::Dir;
use std::fmt;
use std::sync::Arc;
use thiserror::Error;

/// Called with the finished share of the work, from 0 to 1 and never less than before, by one thread at a time.
pub type Progress = Arc<dyn Fn(f64) + Send + Sync>;

/// What a mesh must keep to.
#[derive(Clone)]
pub struct MeshOptions {
    /// The greatest distance between a surface and its patch, both ways, in the model's unit of length. `None`: one
    /// thousandth of the diagonal of the box around the model.
    pub tol: Option<f64>,
    /// Sides that are nowhere farther apart than this become one, and a side no larger than this becomes one point.
    /// It is part of `tol`. `None`: a twentieth of `tol`.
    pub weld: Option<f64>,
    /// The fewest cells along u and along v between the lines where a surface is less smooth. More than 1 makes values
    /// at the vertices, as curvatures, vary also where the surface is straight and would not be cut.
    pub least_cells: usize,
    /// A mesh that would need more triangles is refused before it is made.
    pub max_triangles: usize,
    /// The number of threads that work on it; the mesh does not depend on it. `None`: as many as the machine runs at once.
    pub threads: Option<usize>,
    /// Hears of the progress.
    pub progress: Option<Progress>,
}

impl MeshOptions {
    /// The defaults with a tolerance.
    pub fn with_tol(tol: f64) -> Self {
        Self {
            tol: Some(tol),
            ..Self::default()
        }
    }
}

impl Default for MeshOptions {
    fn default() -> Self {
        Self {
            tol: None,
            weld: None,
            least_cells: 1,
            max_triangles: 100_000_000,
            threads: None,
            progress: None,
        }
    }
}

impl fmt::Debug for MeshOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MeshOptions")
            .field("tol", &self.tol)
            .field("weld", &self.weld)
            .field("least_cells", &self.least_cells)
            .field("max_triangles", &self.max_triangles)
            .field("threads", &self.threads)
            .field("progress", &self.progress.is_some())
            .finish()
    }
}

/// Why there is no mesh.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MeshError {
    /// The tolerance is not a length.
    #[error("the tolerance is {tol}: it must be a positive, finite length")]
    Tolerance {
        /// The tolerance asked for.
        tol: f64,
    },
    /// The tolerance is lost in rounding.
    #[error(
        "the tolerance {tol:e} is below the rounding errors of a model of this size: the smallest possible is {smallest:e}"
    )]
    TooFine {
        /// The tolerance asked for.
        tol: f64,
        /// The smallest tolerance that can be proven.
        smallest: f64,
    },
    /// The weld distance leaves nothing of the tolerance.
    #[error(
        "the weld distance is {weld:e}: it must be at least 0 and at most a quarter of the tolerance {tol:e}"
    )]
    Weld {
        /// The weld distance asked for.
        weld: f64,
        /// The tolerance.
        tol: f64,
    },
    /// Too many triangles would be needed.
    #[error(
        "about {needed:.3e} triangles or more are needed but {max} are allowed: raise the tolerance or the limit"
    )]
    TooMany {
        /// The estimated number.
        needed: f64,
        /// The limit.
        max: usize,
    },
    /// A surface is not defined somewhere.
    #[error("surface {surface} has no finite point at (u, v) = ({}, {})", uv[0], uv[1])]
    NotFinite {
        /// The index of the surface.
        surface: usize,
        /// The parameters.
        uv: [f64; 2],
    },
    /// A surface has no area.
    #[error("surface {surface} is collapsed: all of it lies on one point or line within {weld:e}")]
    Collapsed {
        /// The index of the surface.
        surface: usize,
        /// The weld distance.
        weld: f64,
    },
    /// A surface jumps.
    #[error("surface {surface} is torn at {} = {at}: split it there", if *dir == Dir::U { 'u' } else { 'v' })]
    Torn {
        /// The index of the surface.
        surface: usize,
        /// Which parameter.
        dir: Dir,
        /// Where.
        at: f64,
    },
    /// Sides were joined that do not meet well enough.
    #[error(
        "surface {surface}: after joining the sides the mesh is {deviation:e} away, more than {tol:e}: lower the weld distance"
    )]
    Gap {
        /// The index of the surface.
        surface: usize,
        /// The deviation reached.
        deviation: f64,
        /// The tolerance.
        tol: f64,
    },
}
