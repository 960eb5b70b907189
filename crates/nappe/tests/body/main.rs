//! Bodies of faces that share edges.

#![allow(clippy::unwrap_used)]

mod cover;
mod sew;
mod shapes;
