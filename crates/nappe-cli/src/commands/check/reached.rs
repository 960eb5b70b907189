//! How well sides are joined, by what is proven.

use super::verdict::Verdict;
use nappe::measure::{Continuity, Smoothness};
use nappe::surface::Side;
use std::f64::consts::PI;

/// Tangent planes that differ by less (0.1°) count as smooth where nothing is declared.
pub(super) const SMOOTH_ANGLE: f64 = PI / 1800.0;
/// Curvatures that differ by less, relatively, count as the same where nothing is declared.
const SAME_CURVATURE: f64 = 0.01;

/// A side that two surfaces, or one with itself, have in common.
pub(super) struct Shared {
    pub(super) sides: [String; 2],
    pub(super) first: (usize, Side),
    pub(super) joint: Option<Continuity>,
    /// The greatest distance found while looking for shared sides.
    pub(super) gap: f64,
    pub(super) verdict: Verdict,
}

/// How well two sides are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reached {
    /// Too far apart to be joined.
    Apart,
    /// Along a part of one of them only, and there not from end to end.
    InPart,
    /// At an angle.
    Edge,
    /// A surface with itself at an angle.
    Crease,
    /// In their points; what is more is not proven.
    Points,
    /// With their tangent planes.
    Tangents,
    /// With their curvatures.
    Curvatures,
}

impl Shared {
    pub(super) fn reached(&self) -> Reached {
        match &self.joint {
            Some(j) if self.verdict.passes() => reached(j),
            _ => Reached::Apart,
        }
    }
}

/// How smoothly sides without a gap meet, by what is proven.
pub(super) fn reached(j: &Continuity) -> Reached {
    match j.proven(f64::INFINITY, SMOOTH_ANGLE, SAME_CURVATURE) {
        Some(Smoothness::G2) => Reached::Curvatures,
        Some(Smoothness::G1) => Reached::Tangents,
        // Found at one place is proven, also where the gap is only estimated.
        _ if j.angle.within(SMOOTH_ANGLE) == Some(false) => Reached::Edge,
        _ => Reached::Points,
    }
}

pub(super) fn smoothness(j: &Continuity) -> &'static str {
    match reached(j) {
        Reached::Curvatures => "G2",
        Reached::Tangents => "G1",
        Reached::Edge => "G0, an edge",
        _ => "G0",
    }
}
