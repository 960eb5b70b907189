//! The vertices on the borders of leaves: neighbours share them.

use super::layout::Layout;
use crate::surface::Dir;
use std::collections::HashMap;

/// A parameter pair as a key.
pub(super) type Key = [u64; 2];

/// Equal numbers, equal bits: -0 is 0.
fn bits(x: f64) -> u64 {
    (x + 0.0).to_bits()
}

pub(super) fn key(uv: [f64; 2]) -> Key {
    uv.map(bits)
}

/// For each line `u = const` (index 0) or `v = const` (index 1) along which leaves meet: the other parameter of every
/// vertex on it, increasing.
#[derive(Debug, Default)]
pub(super) struct Lines([HashMap<u64, Vec<f64>>; 2]);

impl Lines {
    /// The corners of cells on the borders of leaves.
    pub(super) fn new(layout: &Layout) -> Self {
        let mut lines = Self::default();
        for leaf in &layout.leaves {
            let params = [0, 1].map(|d| leaf.parts[d].params(layout.blocks[d][leaf.block[d]]));
            for d in 0..2 {
                let along = &params[1 - d];
                for at in [params[d][0], params[d][params[d].len() - 1]] {
                    lines.0[d].entry(bits(at)).or_default().extend(along);
                }
            }
        }
        lines
            .0
            .iter_mut()
            .flat_map(HashMap::values_mut)
            .for_each(order);
        lines
    }

    /// Replaces the vertices on the line where the parameter `across` is `at`.
    pub(super) fn set(&mut self, across: Dir, at: f64, params: Vec<f64>) {
        self.0[index(across)].insert(bits(at), params);
    }

    /// The vertices strictly between two others on a line.
    pub(super) fn between(&self, across: Dir, at: f64, from: f64, to: f64) -> &[f64] {
        let line = self.0[index(across)]
            .get(&bits(at))
            .map_or(&[][..], Vec::as_slice);
        let first = line.partition_point(|&t| t <= from);
        let last = line.partition_point(|&t| t < to);
        &line[first..last.max(first)]
    }
}

/// The other parameter of every corner of a cell on the line where the parameter `across` is `at`, increasing, if the line
/// is on the border of leaves.
pub(super) fn on(layout: &Layout, across: Dir, at: f64) -> Vec<f64> {
    let d = index(across);
    let mut line = Vec::new();
    for leaf in &layout.leaves {
        let [part, along] = [d, 1 - d].map(|d| (leaf.parts[d], layout.blocks[d][leaf.block[d]]));
        if [0, part.0.n]
            .into_iter()
            .any(|i| part.0.at(part.1, i) == at)
        {
            line.extend(along.0.params(along.1));
        }
    }
    order(&mut line);
    line
}

/// Puts the parameters on a line in order, each once.
fn order(line: &mut Vec<f64>) {
    line.sort_by(f64::total_cmp);
    line.dedup();
}

/// 0 for u, 1 for v.
pub(super) fn index(dir: Dir) -> usize {
    match dir {
        Dir::U => 0,
        Dir::V => 1,
    }
}
