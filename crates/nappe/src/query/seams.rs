//! Branches joined across the lines where a function jumps.
//!
//! A figure of a surface may jump with the parametrisation though its zeros go on: a normal's length does where patches meet
//! smoothly in space. Each side is traced alone; here a branch that ends on such a line goes on in the one that begins there,
//! and of two that run along it on both sides one is kept.

use super::path::Part;
use crate::interval::Interval;

/// Places nearer than this, relative to the rectangle, are the same: the margin of each side, times the steepness of the curve.
const SAME: f64 = 1e-9;

/// A branch before it is joined.
#[derive(Debug)]
pub(super) struct Strand {
    pub(super) parts: Vec<Part>,
    /// The number of the rectangle it was traced in.
    pub(super) piece: usize,
    /// Which of its ends, start and end, are on a line between pieces.
    pub(super) open: [bool; 2],
}

impl Strand {
    fn ends(&self) -> [[f64; 2]; 2] {
        let n = self.parts.len();
        [self.parts[0].points[0], self.parts[n - 1].points[3]]
    }

    fn bounds(&self) -> [Interval; 2] {
        bounds(&self.parts)
    }
}

/// A box around some parts. Panics if there are none.
pub(super) fn bounds(parts: &[Part]) -> [Interval; 2] {
    let first = parts[0].points[0].map(Interval::point);
    let points = parts.iter().flat_map(|p| p.points);
    points.fold(first, |b, p| {
        [0, 1].map(|d| b[d].hull(Interval::point(p[d])))
    })
}

/// Which strands follow each other: lists of their numbers, and whether the list is closed. Strands left out are doubles.
pub(super) fn joined(
    strands: &[Strand],
    cuts: &[Vec<f64>; 2],
    scale: [f64; 2],
) -> Vec<(Vec<usize>, bool)> {
    let near = |a: f64, b: f64, d: usize| (a - b).abs() <= SAME * scale[d];
    let same = |a: [f64; 2], b: [f64; 2]| (0..2).all(|d| near(a[d], b[d], d));
    // Doubles: a strand on a line, all along another one of the other side.
    let boxes: Vec<[Interval; 2]> = strands.iter().map(Strand::bounds).collect();
    let on_line = |k: usize| {
        (0..2).any(|d| {
            let b = boxes[k][d];
            cuts[d]
                .iter()
                .any(|&at| near(b.lo, at, d) && near(b.hi, at, d))
        })
    };
    let lines: Vec<usize> = (0..strands.len()).filter(|&k| on_line(k)).collect();
    let double = |&k: &usize| {
        let part = |a: usize, b: usize| {
            (0..2).all(|d| {
                let near = SAME * scale[d];
                boxes[b][d].lo <= boxes[a][d].lo + near && boxes[a][d].hi <= boxes[b][d].hi + near
            })
        };
        // Of equal ones the first is kept.
        let twin =
            |j: usize| strands[j].piece != strands[k].piece && part(k, j) && (!part(j, k) || j < k);
        lines.iter().any(|&j| twin(j))
    };
    let mut gone = vec![false; strands.len()];
    lines
        .iter()
        .filter(|k| double(k))
        .for_each(|&k| gone[k] = true);
    // The only one that begins where another one ends.
    let mut next = vec![None; strands.len()];
    let mut before = vec![None; strands.len()];
    let starts: Vec<usize> = (0..strands.len())
        .filter(|&k| !gone[k] && strands[k].open[0])
        .collect();
    for k in (0..strands.len()).filter(|&k| !gone[k] && strands[k].open[1]) {
        let end = strands[k].ends()[1];
        let mut found = starts
            .iter()
            .filter(|&&j| strands[j].piece != strands[k].piece && same(strands[j].ends()[0], end));
        if let (Some(&j), None) = (found.next(), found.next())
            && before[j].is_none()
        {
            next[k] = Some(j);
            before[j] = Some(k);
        }
    }
    in_a_row(&next, gone)
}

/// Lists of numbers of which each is followed by `next`, and whether the list is closed, without those that are gone.
pub(super) fn in_a_row(next: &[Option<usize>], gone: Vec<bool>) -> Vec<(Vec<usize>, bool)> {
    let mut before = vec![None; next.len()];
    for (k, n) in next.iter().enumerate() {
        if let Some(n) = n {
            before[*n] = Some(k);
        }
    }
    let mut used = gone;
    let mut lists = Vec::new();
    let heads = (0..next.len()).filter(|&k| before[k].is_none());
    for head in heads.chain(0..next.len()) {
        if used[head] {
            continue;
        }
        let (mut list, mut at) = (Vec::new(), Some(head));
        while let Some(k) = at.filter(|&k| !used[k]) {
            used[k] = true;
            list.push(k);
            at = next[k];
        }
        lists.push((list, at == Some(head)));
    }
    lists
}
