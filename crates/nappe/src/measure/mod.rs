//! Numbers of surfaces: curvature, area, volume, extent, continuity along shared sides, regularity. Each says how far it
//! may be from the truth.

mod along;
mod apex;
mod area;
mod continuity;
mod crease;
mod curvature;
mod extent;
mod integral;
mod jump;
mod overlap;
mod regularity;
mod search;
mod shape;
mod strip;
mod taylor;

pub use area::{VolumeError, area, volume};
pub use continuity::{Continuity, SideOf, Smoothness, continuity};
pub use crease::{Crease, creases};
pub use curvature::{Curvature, CurvatureExtremes, curvature, curvature_extremes};
pub use extent::{Extent, extent};
pub use integral::{IntegralOptions, Measured};
pub use jump::{Jump, JumpOptions};
pub use overlap::{Meeting, Overlap, OverlapOptions, Overlaps, overlaps};
pub use regularity::{Regularity, regularity};
pub use search::{Extreme, SearchOptions};
