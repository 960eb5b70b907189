//! Numbers of surfaces: curvature and how it varies, area, volume, centroids, inertia, extent, continuity along shared sides, regularity. Each says how far it
//! may be from the truth. And what is wrong with them: tears, folds, surfaces that pass through themselves.

use crate::box3::Box3;
use crate::surface::Surface;

mod along;
mod apex;
mod area;
mod bending_rate;
mod bodies;
mod centroid;
mod concave;
mod continuity;
mod crease;
mod curvature;
mod curvature_rate;
mod extent;
mod fairness;
mod figures;
mod gauss;
mod inertia;
mod integral;
mod jump;
mod model;
mod opening;
mod overlap;
mod pinch;
mod rate;
mod regularity;
mod search;
mod shape;
mod solid;
mod strip;
mod taylor;
mod tear;
mod twin;
mod volume;

pub use apex::{UnboundedCurvature, unbounded_curvature};
pub use area::area;
pub use bending_rate::{BendingRate, bending_rate};
pub use bodies::{Body, bodies};
pub use centroid::{AreaCentroid, Centroid, area_centroid, joint_centroid};
pub use concave::{RollingBall, rolling_balls};
pub(crate) use continuity::greatest_gap;
pub use continuity::{Continuity, SideOf, Smoothness, continuity, continuity_in_part};
pub use crease::{Crease, creases};
pub use curvature::{Curvature, CurvatureExtremes, curvature, curvature_extremes};
pub use curvature_rate::{CurvatureRate, ExtremeRate, curvature_rate};
pub use extent::{Extent, extent};
pub use fairness::{curvature_derivative, curvature_variation};
pub use figures::{CurvatureKind, Implicit};
pub(crate) use figures::{
    FigureJet, NormalFigure, Pole, curvature_over, curvature_range, height_over, height_range,
    implicit_over, implicit_range, normal_over, normal_range, poles,
};
pub use gauss::{Developable, TotalCurvature, total_curvature};
pub use inertia::Inertia;
pub use integral::{IntegralOptions, Measured};
pub use jump::{Jump, JumpOptions};
pub use opening::Opening;
pub use overlap::{Meeting, Overlap, OverlapOptions, Overlaps, overlaps};
pub use pinch::{Pinch, pinches};
pub use rate::{AreaRate, FaceRate, Moving, SolidRate, area_rate, face_rate, solid_rate};
pub use regularity::{Regularity, regularity};
pub use search::{Extreme, SearchOptions};
pub use solid::{Solid, solids};
pub use tear::tear;
pub(crate) use volume::inside_out;
pub use volume::{Shell, VolumeError, shells, volume};

/// How large a surface is: the diagonal of a box around points of it. Enclosures of a whole domain may be much larger than
/// the surface, or infinite.
pub(crate) fn size(surface: &dyn Surface) -> f64 {
    const POINTS: usize = 9;
    let domain = surface.domain();
    let at = |d: usize, k: usize| {
        domain[d].lo + (domain[d].hi - domain[d].lo) * k as f64 / (POINTS - 1) as f64
    };
    let points =
        (0..POINTS * POINTS).map(|k| surface.point([at(0, k / POINTS), at(1, k % POINTS)]));
    Box3::around(points.filter(|p| p.is_finite())).map_or(0.0, Box3::diagonal)
}
