//! Measurements with proven bounds: continuity along shared sides, and where a surface is regular.

mod along;
mod continuity;
mod jump;
mod regularity;

pub use continuity::{Continuity, SideOf, Smoothness, continuity};
pub use jump::{Jump, JumpOptions};
pub use regularity::{Regularity, regularity};
