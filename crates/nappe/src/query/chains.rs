//! Arcs of cells joined into branches.

use super::cells::{Arc, Crossing};
use crate::interval::Interval;
use std::collections::HashMap;

/// Arcs one after the other.
#[derive(Debug)]
pub(super) struct Chain {
    /// The arcs, and for each the number of the crossing where it is entered.
    pub(super) arcs: Vec<(usize, usize)>,
    pub(super) closed: bool,
}

/// Joins the arcs of neighbours.
pub(super) fn chains(arcs: &[Arc]) -> Vec<Chain> {
    let partner = partners(arcs);
    let mut used = vec![false; arcs.len()];
    let mut chains = Vec::new();
    // Those with an end first; what is left are loops.
    let ends = (0..arcs.len()).flat_map(|k| [(k, 0), (k, 1)]);
    let starts = ends
        .filter(|&(k, c)| partner[k][c].is_none())
        .chain((0..arcs.len()).map(|k| (k, 0)));
    for (first, entry) in starts {
        if used[first] {
            continue;
        }
        let mut chain = Chain {
            arcs: Vec::new(),
            closed: false,
        };
        let (mut k, mut c) = (first, entry);
        loop {
            used[k] = true;
            chain.arcs.push((k, c));
            match partner[k][1 - c] {
                None => break,
                Some((next, _)) if next == first => {
                    chain.closed = true;
                    break;
                }
                // A field that does not keep its word could lead back into the middle.
                Some((next, _)) if used[next] => break,
                Some((next, entry)) => (k, c) = (next, entry),
            }
        }
        chains.push(chain);
    }
    chains
}

/// For each crossing of each arc the arc beyond it.
fn partners(arcs: &[Arc]) -> Vec<[Option<(usize, usize)>; 2]> {
    // By line: the crossings of the cells below and above it.
    type Sides<'a> = [Vec<(usize, usize, &'a Crossing)>; 2];
    let mut lines: HashMap<(usize, u64), Sides> = HashMap::new();
    for (k, arc) in arcs.iter().enumerate() {
        for (c, crossing) in arc.crossings.iter().enumerate() {
            let sides = lines
                .entry((crossing.d, crossing.at.to_bits()))
                .or_default();
            sides[usize::from(crossing.upper)].push((k, c, crossing));
        }
    }
    let mut partner = vec![[None; 2]; arcs.len()];
    for sides in lines.values_mut() {
        for side in sides.iter_mut() {
            side.sort_by(|a, b| a.2.along.lo.total_cmp(&b.2.along.lo));
        }
        let [above, below] = sides;
        let (mut i, mut j) = (0, 0);
        // Edges on a line are nested or beside each other. The larger one has one zero, so the smaller one has the same.
        while i < above.len() && j < below.len() {
            let (a, b) = (&above[i], &below[j]);
            if a.2.along.lo.max(b.2.along.lo) < a.2.along.hi.min(b.2.along.hi) {
                partner[a.0][a.1] = Some((b.0, b.1));
                partner[b.0][b.1] = Some((a.0, a.1));
                i += 1;
                j += 1;
            } else if a.2.along.hi <= b.2.along.lo {
                i += 1;
            } else {
                j += 1;
            }
        }
    }
    partner
}

/// True if two boxes have a point in common.
pub(super) fn touch<const N: usize>(a: [Interval; N], b: [Interval; N]) -> bool {
    (0..N).all(|d| a[d].intersection(b[d]).is_some())
}
