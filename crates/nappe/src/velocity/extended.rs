//! A curve as a surface.

use crate::box3::Box3;
use crate::breaks::{Break, Limit};
use crate::curve::CurveRef;
use crate::interval::Interval;
use crate::surface::{Dir, Surface, jet_index};
use glam::DVec3;
use smallvec::SmallVec;

/// A curve as a surface that does not depend on one of its parameters: so that sums need one form.
#[derive(Clone, Debug)]
pub struct Extended {
    curve: CurveRef,
    along: Dir,
    across: [Break; 2],
}

impl Extended {
    /// The curve along a direction; the other parameter runs over a range.
    pub fn new(curve: CurveRef, along: Dir, across: Interval) -> Self {
        Self {
            curve,
            along,
            across: [across.lo, across.hi].map(|at| Break::new(at, 0)),
        }
    }

    /// Writes what depends on the curve's parameter alone.
    fn spread<T: Copy>(&self, order: usize, zero: T, d: &[T], out: &mut [T]) {
        out.fill(zero);
        for (k, &d) in d.iter().enumerate().take(order + 1) {
            let at = match self.along {
                Dir::U => jet_index(k, 0),
                Dir::V => jet_index(0, k),
            };
            out[at] = d;
        }
    }
}

impl Surface for Extended {
    fn breaks(&self, dir: Dir) -> &[Break] {
        if dir == self.along {
            self.curve.breaks()
        } else {
            &self.across
        }
    }

    fn jet_into(&self, uv: [f64; 2], limit: [Limit; 2], order: usize, out: &mut [DVec3]) {
        let k = usize::from(self.along == Dir::V);
        let mut d: SmallVec<[DVec3; 10]> = SmallVec::from_elem(DVec3::ZERO, order + 1);
        self.curve.jet_into(uv[k], limit[k], &mut d);
        self.spread(order, DVec3::ZERO, &d, out);
    }

    fn enclose_piece(&self, uv: [Interval; 2], limit: [Limit; 2], order: usize, out: &mut [Box3]) {
        let k = usize::from(self.along == Dir::V);
        let mut d: SmallVec<[Box3; 10]> = SmallVec::from_elem(Box3::ENTIRE, order + 1);
        self.curve.enclose_piece(uv[k], limit[k], &mut d);
        self.spread(order, Box3::ZERO, &d, out);
    }
}
