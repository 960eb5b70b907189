//! The tight box around a surface.

use super::search::{Extreme, SearchOptions, largest};
use super::taylor::Taylor;
use crate::box3::Box3;
use crate::interval::Interval;
use crate::mesh::Certainty;
use crate::surface::Surface;

/// The box around a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// The box of points found on the surface.
    pub hull: Box3,
    /// How far the surface may reach beyond any face of the box.
    pub certainty: Certainty,
    /// The places where the surface reaches the least and the greatest x, y and z.
    pub places: [[[f64; 2]; 2]; 3],
}

/// The box around a surface, with a bound for its error: `options.relative` is relative to the diagonal of a first, loose
/// box. `None` if no point of the surface is finite.
pub fn extent(surface: &dyn Surface, options: &SearchOptions) -> Option<Extent> {
    let middle = surface.point(surface.domain().map(Interval::mid));
    let size = surface.bounds(surface.domain()).diagonal();
    // The search is relative to the value: coordinates are measured so that extremes are of the box's size.
    let shift = if size.is_finite() { size } else { 1.0 };
    let mut certainty = Certainty::Exact;
    let mut places = [[[0.0; 2]; 2]; 3];
    let mut ends = [Interval::ZERO; 3];
    for axis in 0..3 {
        let mut found = [0.0; 2];
        for (k, sign) in [-1.0, 1.0].into_iter().enumerate() {
            let at = middle.to_array()[axis];
            let e: Extreme = largest(
                surface,
                0,
                &|jet| Some(sign * (jet.d[0].to_array()[axis] - at) + shift),
                &|jet, degree| {
                    let mut x = Taylor::coordinate(jet, axis, [0, 0], degree);
                    x.c[0] = x.c[0] - Interval::point(at);
                    let mut x = x.scale(Interval::point(sign));
                    x.c[0] = x.c[0] + Interval::point(shift);
                    x
                },
                options,
            )?;
            places[axis][k] = e.uv;
            found[k] = surface.point(e.uv).to_array()[axis];
            certainty = certainty.and(e.certainty);
        }
        ends[axis] = Interval::new(found[0], found[1]);
    }
    Some(Extent {
        hull: Box3::from(ends),
        certainty,
        places,
    })
}
