//! Which sides of surfaces meet, for those who ask without meshing.

use super::closing;
use super::shared::{Edge, GUESSES, Join, edge, find};
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
    let threads = parallel::all_threads();
    let shared = find(surfaces, weld, threads);
    let name = |k: usize| (k / 4, Side::ALL[k % 4]);
    let mut out = Joints {
        joints: Vec::new(),
        collapsed: vec![Vec::new(); surfaces.len()],
        open: vec![Vec::new(); surfaces.len()],
    };
    let mut met = shared.collapsed.clone();
    let joins = shared.joins.iter().enumerate();
    let joins: Vec<(usize, &Join)> = joins.filter_map(|(k, j)| Some((k, j.as_ref()?))).collect();
    let joint = |i: usize| {
        let (k, join) = joins[i];
        let (gap, length) = gap(&edge(surfaces, join.leader), &edge(surfaces, k), join);
        Joint {
            first: name(join.leader),
            second: name(k),
            reversed: join.map.is_reversed(),
            gap,
            length,
        }
    };
    out.joints = parallel::each(threads, joins.len(), joint, |_| false);
    for (k, join) in joins {
        met[k] = true;
        met[join.leader] = true;
    }
    for k in 0..met.len() {
        let (surface, side) = name(k);
        if shared.collapsed[k] {
            out.collapsed[surface].push(side);
        } else if !met[k] {
            out.open[surface].push(side);
        }
    }
    out
}

/// The greatest distance between partners, and the length of the leading side.
fn gap(lead: &Edge, other: &Edge, join: &Join) -> (f64, f64) {
    let t = lead.parts(GUESSES);
    let points = lead.points(&t);
    let partners: Vec<f64> = t
        .iter()
        .zip(&points)
        .map(|(&t, &p)| join.map.partner(0, t, p, other))
        .collect();
    let pairs = points.iter().zip(other.points(&partners));
    let gap = pairs.fold(0.0, |gap: f64, (p, q)| gap.max(p.distance(q)));
    (gap, closing::length(&points))
}
