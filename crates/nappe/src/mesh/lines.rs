//! The vertices on the sides of a surface: neighbours share them.

use super::layout::Layout;
use crate::surface::{Dir, Side};

/// A parameter pair as a key.
pub(super) type Key = [u64; 2];

pub(super) fn key(uv: [f64; 2]) -> Key {
    // Equal numbers, equal bits: -0 is 0.
    uv.map(|x| (x + 0.0).to_bits())
}

/// The parameters along a side of every vertex of a layout on it, increasing.
pub(super) fn on(layout: &Layout, side: Side) -> Vec<f64> {
    let net = &layout.net;
    let along = index(side.along());
    let on = net.on_side(along, side.is_upper());
    let mut line: Vec<f64> = on.into_iter().map(|x| net.param(along, x)).collect();
    line.sort_by(f64::total_cmp);
    line.dedup();
    line
}

/// 0 for u, 1 for v.
pub(super) fn index(dir: Dir) -> usize {
    match dir {
        Dir::U => 0,
        Dir::V => 1,
    }
}
