//! Parts of surfaces in a tree of boxes.

use super::part::{Hull, Part};
use crate::breaks::Breaks;
use crate::interval::Interval;
use crate::parallel;
use crate::surface::{Dir, SurfaceRef};
use glam::DVec3;

/// About the most parts of a piece that are made beforehand.
const PARTS: usize = 512;

/// A box around some surfaces, pieces or parts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) hull: Hull,
    /// The number of the part, if it is one.
    pub(super) part: Option<u32>,
    /// The number of the first of two nodes below, if there are any.
    pub(super) below: Option<u32>,
}

/// All parts, with a tree of boxes over them whose root is the first node: halves of parts, parts of pieces, and pieces of
/// all surfaces.
#[derive(Debug)]
pub(super) struct Tree {
    pub(super) nodes: Vec<Node>,
    pub(super) parts: Vec<Part>,
}

impl Tree {
    pub(super) fn new(surfaces: &[SurfaceRef], threads: usize) -> Self {
        let pieces: Vec<(u32, [Interval; 2])> = surfaces
            .iter()
            .enumerate()
            .flat_map(|(k, surface)| {
                let [u, v] = [Dir::U, Dir::V].map(|dir| -> Vec<Interval> {
                    let breaks = surface.breaks(dir);
                    (0..breaks.pieces()).map(|i| breaks.piece(i)).collect()
                });
                let pairs = u
                    .into_iter()
                    .flat_map(move |u| v.clone().into_iter().map(move |v| [u, v]));
                pairs.map(move |uv| (k as u32, uv))
            })
            .collect();
        let of = |k: usize| {
            let (surface, uv) = pieces[k];
            Divided::new(surfaces, Part::new(surfaces, surface, uv))
        };
        let pieces = parallel::each(threads, pieces.len(), of, |_| false);
        let mut tree = Self {
            nodes: Vec::new(),
            parts: Vec::new(),
        };
        let mut all: Vec<Divided> = pieces;
        if let Some(first) = all.first() {
            let hull = first.parts[0].hull;
            tree.nodes.push(Node {
                hull,
                part: None,
                below: None,
            });
            tree.branch(0, &mut all);
        }
        tree
    }

    /// Puts pieces below a node: halves of them by their middles along the longest side of their box.
    fn branch(&mut self, node: usize, pieces: &mut [Divided]) {
        let hull = |d: &Divided| d.parts[0].hull;
        let Some(all) = pieces.iter().map(hull).reduce(Hull::join) else {
            return;
        };
        if let [piece] = pieces {
            return self.piece(node, piece);
        }
        let middle = |d: &Divided| {
            let hull = hull(d);
            0.5 * hull.lo + 0.5 * hull.hi
        };
        let (lo, hi) = pieces
            .iter()
            .map(middle)
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), m| {
                (lo.min(m), hi.max(m))
            });
        let axis = (hi - lo).max_position();
        let half = pieces.len() / 2;
        let key = |d: &Divided| (middle(d)[axis], d.parts[0].place());
        pieces.select_nth_unstable_by(half, |a, b| {
            let ((x, i), (y, j)) = (key(a), key(b));
            x.total_cmp(&y).then_with(|| i.total_cmp(&j))
        });
        let first = self.pair(node, all);
        let (lower, upper) = pieces.split_at_mut(half);
        self.branch(first, lower);
        self.branch(first + 1, upper);
    }

    /// Makes room for two nodes below a node.
    fn pair(&mut self, node: usize, hull: Hull) -> usize {
        let first = self.nodes.len();
        self.nodes[node].hull = hull;
        self.nodes[node].below = Some(first as u32);
        let empty = Node {
            hull,
            part: None,
            below: None,
        };
        self.nodes.extend([empty; 2]);
        first
    }

    /// Puts the parts of a piece below a node.
    fn piece(&mut self, node: usize, piece: &Divided) {
        let mut open = vec![(node, 0)];
        while let Some((node, k)) = open.pop() {
            let part = &piece.parts[k];
            if let Some(halves) = piece.halves[k] {
                let first = self.pair(node, part.hull);
                open.extend([(first, halves), (first + 1, halves + 1)]);
            }
            self.nodes[node].hull = part.hull;
            self.nodes[node].part = Some(self.parts.len() as u32);
            self.parts.push(part.clone());
        }
    }
}

/// A piece with its parts: the curvature of the distance is known well over those that are not halved.
struct Divided {
    /// The piece first.
    parts: Vec<Part>,
    /// The number of the first half of each part that was halved.
    halves: Vec<Option<usize>>,
}

impl Divided {
    fn new(surfaces: &[SurfaceRef], whole: Part) -> Self {
        let mut out = Self {
            parts: vec![whole],
            halves: vec![None],
        };
        let mut k = 0;
        while k < out.parts.len() && out.parts.len() < PARTS {
            if !out.parts[k].is_known()
                && let Some(halves) = out.parts[k].halves(surfaces)
            {
                out.halves[k] = Some(out.parts.len());
                out.parts.extend(halves);
                out.halves.extend([None; 2]);
            }
            k += 1;
        }
        out
    }
}
