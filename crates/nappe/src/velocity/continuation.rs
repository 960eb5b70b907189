//! Cross-derivatives that continue a neighbour.

use crate::curve::{CurveRef, on_unit_domain};
use crate::surface::neighbour::continuation_rate;
use crate::surface::{Side, SurfaceRef};

/// The velocity of the cross-derivative that a Coons surface takes from the side of a neighbour
/// ([`Cross::Neighbour`](crate::surface::Cross::Neighbour)): the neighbour moves, and with the tangents of the boundary in the
/// corners also the vectors of its tangent plane that are taken.
///
/// `sides` are south, north, west and east of the Coons surface with their velocities, `surface` the neighbour with its
/// velocity. `None` where the neighbour has no tangent plane in a corner.
pub fn continuation(
    sides: [&[CurveRef; 4]; 2],
    side: Side,
    surface: [&SurfaceRef; 2],
    neighbour: Side,
) -> Option<CurveRef> {
    let [at, rates] = sides.map(|all| all.clone().map(on_unit_domain));
    continuation_rate([&at, &rates], side, surface, neighbour)
}
