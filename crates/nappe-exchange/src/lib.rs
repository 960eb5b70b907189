//! Files and pictures of exact surfaces.
//!
//! A [`Scene`] is a certified mesh with names, colours, curves and numbers at its vertices. [`write()`] puts it into a
//! file whose ending says the format, whole or not at all, and reports what the file holds:
//!
//! | ending | holds |
//! |---|---|
//! | `.glb`, `.gltf` | mesh, normals, parameters, names, colours, curves; y-up, metres |
//! | `.stl` | triangles in f32; solids with normals outward |
//! | `.obj` | shared points, normals, parameters, names, curves |
//! | `.ply` | shared points, normals, parameters of each corner |
//! | `.3mf` | shared points, names, colours, units; for printing |
//! | `.vtu` | mesh with normals, parameters and all fields |
//! | `.png`, `.svg` | pictures, see [`render`] |
//! | `.json` | the exact NURBS curves and surfaces |
//! | `.step`, `.stp` | the exact surfaces as bodies with names, see [`step`] |
//! | `.igs`, `.iges` | the exact NURBS surfaces, trimmed or as solids, see [`iges`] |
//!
//! Formats that store f64 keep the mesh's proof as it is; for those that store f32, [`WriteReport`] adds what rounding
//! moved. Triangles that rounding makes degenerate are counted, never written in silence.

mod atomic;
mod document;
mod error;
mod facets;
mod format;
mod gltf;
mod hollow;
pub mod iges;
mod json;
mod meshing;
mod obj;
mod ply;
pub mod read;
pub mod render;
mod report;
#[cfg(test)]
mod samples;
mod scene;
mod solid;
pub mod step;
mod stl;
#[cfg(test)]
mod tests;
mod text;
mod threemf;
mod triangles;
mod vtu;
mod whole;
mod write;

pub use atomic::{check_target, write_atomically};
pub use document::{Document, FaceStyle, Item, ItemForm, LeftOut};
pub use error::{ExchangeError, PictureError, SceneError};
pub use format::Format;
pub use meshing::{
    DocumentMesh, Missing, face_name, face_place, item_name, item_place, mesh_document,
};
pub use nappe::Units;
pub use read::{Read, ReadError, read, read_telling};
pub use report::{Progress, WriteOptions, WriteReport};
pub use scene::{Colour, Exact, ExactForm, Field, PALETTE, Part, Polyline, Scene};
pub use triangles::{Group, MeshFacts, TriangleMesh, mesh_facts};
pub use whole::is_whole;
pub use write::write;

pub(crate) use write::Output;
