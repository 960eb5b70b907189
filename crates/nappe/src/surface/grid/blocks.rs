//! Columns in blocks of a register each, and the functions of v as rows read them.

use super::columns::{Columns, Piece};
use crate::scalar::Pack;
use std::ops::Range;

/// Neighbouring blocks with columns of one piece. Where pieces meet within a block, it belongs to both runs: each takes its
/// own lanes of it.
pub(super) struct Run {
    pub(super) piece: usize,
    pub(super) blocks: Range<usize>,
    /// Where the piece begins in the first block.
    pub(super) lane: usize,
    /// The last block has columns of the next piece too.
    pub(super) is_shared: bool,
    values: Range<usize>,
}

/// All columns, cut to blocks.
pub(super) struct Blocks {
    pub(super) runs: Vec<Run>,
    /// The first column of each block.
    pub(super) columns: Vec<usize>,
    /// For each run, for each of its blocks and each derivative the functions of the piece: each once for a net, and for a
    /// sparse core those of each coordinate, side by side. Read in this order by every row.
    values: Vec<f64>,
    /// Where these start: no register straddles a line of the cache.
    start: usize,
}

impl Blocks {
    /// Blocks of so many `lanes`. One begins at the column `head`: where one before it would reach that far, it ends there.
    pub(super) fn new(columns: &Columns, layout: &Layout, lanes: usize, head: usize) -> Self {
        let heads = (0..head).step_by(lanes);
        let rest = (head..columns.count).step_by(lanes);
        let firsts: Vec<usize> = heads.chain(rest).collect();
        let end = |b: usize| firsts.get(b + 1).copied().unwrap_or(columns.count);
        let (mut runs, mut values): (Vec<Run>, Vec<f64>) = Default::default();
        for (number, piece) in columns.pieces.iter().enumerate() {
            let Range { start, end: stop } = piece.columns;
            let first = firsts.partition_point(|&c| c <= start) - 1;
            let last = firsts.partition_point(|&c| c < stop) - 1;
            let before = values.len();
            for &column in &firsts[first..=last] {
                for q in 0..=layout.order {
                    layout.each_used(piece, |j| {
                        values.extend_from_slice(&columns.values(q, j, column)[..lanes]);
                    });
                }
            }
            runs.push(Run {
                piece: number,
                blocks: first..last + 1,
                lane: start - firsts[first],
                is_shared: end(last) > stop,
                values: before..values.len(),
            });
        }
        // Moved to where lines begin.
        let length = values.len();
        values.resize(length + Pack::LANES, 0.0);
        let start = values.as_ptr().align_offset(size_of::<Pack>()) % Pack::LANES;
        values.copy_within(..length, start);
        Self {
            runs,
            columns: firsts,
            values,
            start,
        }
    }

    /// The functions of a run.
    pub(super) fn values(&self, run: &Run) -> &[f64] {
        &self.values[self.start..][run.values.clone()]
    }
}

/// Which functions sums of products take.
pub(super) struct Layout {
    pub(super) order: usize,
    pub(super) dimensions: usize,
    pub(super) is_net: bool,
}

impl Layout {
    /// Hands on the active functions of a piece in the order in which sums take them.
    fn each_used(&self, piece: &Piece, each: impl FnMut(usize)) {
        if self.is_net {
            (0..piece.active.len()).for_each(each);
        } else {
            let used = &piece.sparse.used;
            used.iter()
                .flat_map(|u| &u[..self.dimensions])
                .copied()
                .for_each(each);
        }
    }
}
