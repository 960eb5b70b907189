//! Exact parametric surfaces with certified answers.

pub mod mesh;
