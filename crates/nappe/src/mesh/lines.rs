//! The vertices on the sides of a surface: neighbours share them.

use super::layout::Layout;
use crate::surface::{Dir, Side};

/// A parameter pair as a key.
pub(super) type Key = [u64; 2];

pub(super) fn key(uv: [f64; 2]) -> Key {
    // Equal numbers, equal bits: -0 is 0.
    uv.map(|x| (x + 0.0).to_bits())
}

/// For each side the parameters along it of every vertex on it, increasing.
#[derive(Debug, Default)]
pub(super) struct Lines([Vec<f64>; 4]);

impl Lines {
    pub(super) fn new(layout: &Layout) -> Self {
        let net = &layout.net;
        Self(Side::ALL.map(|side| {
            let (along, across) = (index(side.along()), index(side.across()));
            let at = if side.is_upper() {
                net.last()[across]
            } else {
                0
            };
            let on = net.places.iter().filter(|p| p[across] == at);
            let mut line: Vec<f64> = on.map(|p| net.param(along, p[along])).collect();
            line.sort_by(f64::total_cmp);
            line.dedup();
            line
        }))
    }

    /// Replaces the vertices along a side.
    pub(super) fn set(&mut self, side: Side, params: Vec<f64>) {
        self.0[side as usize] = params;
    }

    /// All vertices on a side.
    pub(super) fn on(&self, side: Side) -> &[f64] {
        &self.0[side as usize]
    }

    /// The vertices strictly between two others on a side.
    pub(super) fn between(&self, side: Side, from: f64, to: f64) -> &[f64] {
        let line = self.on(side);
        let first = line.partition_point(|&t| t <= from);
        let last = line.partition_point(|&t| t < to);
        &line[first..last.max(first)]
    }
}

/// 0 for u, 1 for v.
pub(super) fn index(dir: Dir) -> usize {
    match dir {
        Dir::U => 0,
        Dir::V => 1,
    }
}
