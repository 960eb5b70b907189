//! Bodies of faces that share edges.

#![allow(clippy::unwrap_used)]

mod sew;
mod shapes;
