//! What hangs together.

use super::{Body, Face, Loop, Shell};
use crate::measure::bodies;

/// A shell, and whether its faces can agree.
pub(super) struct Found {
    pub(super) shell: Shell,
    pub(super) one_sided: bool,
}

/// The faces that hang together along edges that two of them use, in the order of a walk, turned to agree with the
/// first; closed if each of their edges is used exactly twice, in opposite directions. What is outside is not asked.
pub(super) fn shells(body: &Body) -> Vec<Found> {
    let count = body.faces.len();
    let mut neighbours = vec![Vec::new(); count];
    let mut open = vec![false; count];
    let mut twisted = vec![false; count];
    for uses in body.uses() {
        let [(a, forward), (b, other)] = uses[..] else {
            uses.iter().for_each(|u| open[u.0] = true);
            continue;
        };
        // Neighbours that agree run along their edge in opposite directions.
        let against = forward == other;
        if a == b {
            twisted[a] |= against;
        } else {
            neighbours[a].push((b, against));
            neighbours[b].push((a, against));
        }
    }
    let found = bodies(&neighbours).into_iter().map(|hung| {
        let own = || hung.parts.iter().map(|p| p.0);
        let one_sided = hung.contradiction.is_some() || own().any(|f| twisted[f]);
        let turn = |&(f, turned): &(usize, bool)| (f, !turned || one_sided);
        Found {
            shell: Shell {
                faces: hung.parts.iter().map(turn).collect(),
                closed: !one_sided && !own().any(|f| open[f]),
            },
            one_sided,
        }
    });
    found.collect()
}

impl Face {
    /// The same face with its normal on the other side.
    pub fn turn(&mut self) {
        self.forward = !self.forward;
        for l in &mut self.loops {
            if let Loop::Edges(coedges) = l {
                coedges.reverse();
                coedges.iter_mut().for_each(|c| c.forward = !c.forward);
            }
        }
    }
}
