//! The tight box around a surface.

use super::search::{End, Quantities, Search, SearchOptions};
use super::taylor::{Patch, Taylor};
use crate::box3::Box3;
use crate::interval::Interval;
use crate::mesh::Certainty;
use crate::surface::{Surface, SurfaceJet};

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

/// The degree of the Taylor polynomials that bound a coordinate: with 4 the error over a box of size h is of order h⁵
/// beyond the coordinate's own range.
const DEGREE: usize = 4;

/// The coordinates.
struct Coordinates<'a> {
    surface: &'a dyn Surface,
    size: f64,
}

impl Quantities<3> for Coordinates<'_> {
    const ORDER: usize = 0;

    fn values(&self, jet: &SurfaceJet) -> Option<[f64; 3]> {
        Some(jet.d[0].to_array())
    }

    fn enclose(&self, uv: [Interval; 2]) -> ([Interval; 3], usize) {
        let Patch { wide, at, offset } = Patch::new(self.surface, uv, DEGREE);
        let mut weight = [0.0; 2];
        let ranges = [0, 1, 2].map(|axis| {
            let [wide, at] = [&wide, &at].map(|j| Taylor::coordinate(j, axis, [0, 0], DEGREE));
            let share = wide.weight(&at, offset);
            weight = [weight[0] + share[0], weight[1] + share[1]];
            wide.range(&at, offset)
        });
        (ranges, usize::from(weight[1] > weight[0]))
    }

    fn unit(&self, _: usize, _: [f64; 3]) -> f64 {
        self.size
    }
}

/// The box around a surface, with a bound for its error: `options.relative` is relative to the diagonal of a first, loose
/// box. `None` if no point of the surface is finite.
pub fn extent(surface: &dyn Surface, options: &SearchOptions) -> Option<Extent> {
    let size = surface.bounds(surface.domain()).diagonal();
    let coordinates = Coordinates {
        surface,
        size: if size.is_finite() { size } else { 1.0 },
    };
    let mut search = Search::new(surface, &coordinates);
    let mut certainty = Certainty::Exact;
    let mut places = [[[0.0; 2]; 2]; 3];
    let mut ends = [Interval::ZERO; 3];
    for axis in 0..3 {
        let least = search.extreme(axis, End::Least, options)?;
        let greatest = search.extreme(axis, End::Greatest, options)?;
        places[axis] = [least.uv, greatest.uv];
        ends[axis] = Interval::new(least.value, greatest.value);
        certainty = certainty.and(least.certainty).and(greatest.certainty);
    }
    Some(Extent {
        hull: Box3::from(ends),
        certainty,
        places,
    })
}
