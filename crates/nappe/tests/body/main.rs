//! Bodies of faces that share edges.

#![allow(clippy::unwrap_used)]

mod bad;
mod cover;
mod figures;
mod mesh;
mod sew;
mod shapes;
mod whole;
