//! Which sides of surfaces meet, for those who ask without meshing.

use super::shared::find_with;
use crate::parallel;
use crate::surface::{Side, SurfaceRef};

/// Two sides that are one curve within the weld distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// The surface and side that lead.
    pub first: (usize, Side),
    /// The surface and side that follow.
    pub second: (usize, Side),
    /// True if the parameters run in opposite directions.
    pub reversed: bool,
    /// The greatest distance found between partners (sampled).
    pub gap: f64,
    /// The length of the side, as a polygon through samples.
    pub length: f64,
}

impl Joint {
    /// True if the surfaces on both sides have normals on different sides.
    pub fn is_turned(&self) -> bool {
        // The border runs counter-clockwise: along u in the south, against v in the west.
        let forward = |s: Side| matches!(s, Side::South | Side::East);
        (forward(self.first.1) == forward(self.second.1)) != self.reversed
    }
}

/// How surfaces meet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Joints {
    /// The pairs of sides that meet. Where more than two do, all are paired with the first.
    pub joints: Vec<Joint>,
    /// For each surface the sides that are one point.
    pub collapsed: Vec<Vec<Side>>,
    /// For each surface the sides that meet nothing.
    pub open: Vec<Vec<Side>>,
}

/// Finds the sides that agree within `weld`, whatever their parametrisation and direction, as [`mesh`](super::mesh)
/// does; but never within more than a hundredth of the length of a side or of the surface across it. So an open surface
/// that is smaller than `weld` stays open.
pub fn joints(surfaces: &[SurfaceRef], weld: f64) -> Joints {
    among(surfaces, weld, |_| true)
}

/// Finds the pairs of sides that agree within `weld`, larger than before, of which at least one is open in `joined`; in
/// the result, the sides that stay open. Cost: little if there are no open sides.
pub fn near_joints(surfaces: &[SurfaceRef], joined: &Joints, weld: f64) -> Joints {
    if joined.open.iter().all(Vec::is_empty) {
        return Joints {
            joints: Vec::new(),
            ..joined.clone()
        };
    }
    among(surfaces, weld, |k| joined.is_open(k))
}

impl Joints {
    /// True if a side, numbered as those of [`find_with`], meets nothing.
    pub(super) fn is_open(&self, side: usize) -> bool {
        self.open[side / 4].contains(&Side::ALL[side % 4])
    }
}

/// Pairs of which at least one is wanted.
fn among(surfaces: &[SurfaceRef], weld: f64, wanted: impl Fn(usize) -> bool + Sync) -> Joints {
    let threads = parallel::all_threads();
    let shared = find_with(surfaces, weld, threads, &wanted);
    let name = |k: usize| (k / 4, Side::ALL[k % 4]);
    let mut out = Joints {
        joints: Vec::new(),
        collapsed: vec![Vec::new(); surfaces.len()],
        open: vec![Vec::new(); surfaces.len()],
    };
    let mut met = shared.collapsed.clone();
    for (k, join) in shared.joins.iter().enumerate() {
        let Some(join) = join else { continue };
        met[k] = true;
        met[join.leader] = true;
        out.joints.push(Joint {
            first: name(join.leader),
            second: name(k),
            reversed: join.map.is_reversed(),
            gap: join.map.gap,
            length: join.map.length,
        });
    }
    for k in 0..met.len() {
        let (surface, side) = name(k);
        if shared.collapsed[k] {
            out.collapsed[surface].push(side);
        } else if !met[k] && wanted(k) {
            out.open[surface].push(side);
        }
    }
    out
}
