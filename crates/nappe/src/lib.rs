//! Exact parametric surfaces with certified answers.

pub mod basis;
pub mod curve;
pub mod exact;
pub mod expr;
pub mod laws;
pub mod maps;
pub mod measure;
pub mod mesh;
pub mod scalar;
pub mod series;
pub mod surface;

mod box3;
mod breaks;
mod frame;
mod interval;
mod linear;

pub use box3::Box3;
pub use breaks::{Break, Breaks, Limit, UNIT_BREAKS, merge_breaks};
pub use frame::{Frame, FrameError, cos_sin};
pub use glam::{DAffine3, DMat3, DVec3, DVec4};
pub use interval::Interval;
