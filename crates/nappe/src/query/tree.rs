//! Parts of surfaces in a tree of boxes.

use super::part::{Hull, Part};
use crate::breaks::Breaks;
use crate::interval::Interval;
use crate::parallel;
use crate::surface::{Dir, SurfaceRef};

/// Parts are halved until the distance is convex over them for points as far away as they are large, times this.
const FACTOR: f64 = 2.0;
/// So often at most.
const DEPTH: usize = 12;
/// The most parts of a piece that are made beforehand.
const PARTS: usize = 256;

/// What is below a node.
#[derive(Clone, Copy, Debug)]
pub(super) enum Below {
    /// The number of the first of two nodes.
    Nodes(u32),
    /// The number of a part.
    Part(u32),
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) hull: Hull,
    pub(super) below: Below,
}

/// All parts, with a tree of boxes over them whose root is the first node.
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
                let [u, v] = [Dir::U, Dir::V].map(|dir| {
                    let breaks = surface.breaks(dir);
                    (0..breaks.pieces()).map(|i| breaks.piece(i)).collect()
                });
                let (u, v): (Vec<Interval>, Vec<Interval>) = (u, v);
                u.into_iter()
                    .flat_map(move |u| v.clone().into_iter().map(move |v| (k as u32, [u, v])))
            })
            .collect();
        let of = |k: usize| {
            let (surface, uv) = pieces[k];
            divided(surfaces, Part::new(surfaces, surface, uv))
        };
        let parts: Vec<Part> = parallel::each(threads, pieces.len(), of, |_| false)
            .into_iter()
            .flatten()
            .collect();
        let mut tree = Self {
            nodes: Vec::with_capacity(2 * parts.len()),
            parts,
        };
        let mut all: Vec<u32> = (0..tree.parts.len() as u32).collect();
        if let Some(&first) = all.first() {
            tree.nodes.push(tree.leaf(first));
            tree.branch(0, &mut all);
        }
        tree
    }

    fn leaf(&self, part: u32) -> Node {
        Node {
            hull: self.parts[part as usize].hull,
            below: Below::Part(part),
        }
    }

    /// Puts parts below a node: halves of them by their middles along the longest side of their box.
    fn branch(&mut self, node: usize, parts: &mut [u32]) {
        let hull = |k: &u32| self.parts[*k as usize].hull;
        let Some(all) = parts.iter().map(hull).reduce(Hull::join) else {
            return;
        };
        if let [part] = *parts {
            self.nodes[node] = self.leaf(part);
            return;
        }
        let middle = |k: &u32| {
            let hull = hull(k);
            0.5 * hull.lo + 0.5 * hull.hi
        };
        let (lo, hi) = parts.iter().map(middle).fold(
            (glam::DVec3::INFINITY, glam::DVec3::NEG_INFINITY),
            |(lo, hi), m| (lo.min(m), hi.max(m)),
        );
        let axis = (hi - lo).max_position();
        let half = parts.len() / 2;
        parts.select_nth_unstable_by(half, |a, b| {
            middle(a)[axis].total_cmp(&middle(b)[axis]).then(a.cmp(b))
        });
        let first = self.nodes.len();
        self.nodes[node] = Node {
            hull: all,
            below: Below::Nodes(first as u32),
        };
        let empty = self.nodes[node];
        self.nodes.extend([empty; 2]);
        let (lower, upper) = parts.split_at_mut(half);
        self.branch(first, lower);
        self.branch(first + 1, upper);
    }
}

/// The parts of a part over which the distance is convex near the surface.
fn divided(surfaces: &[SurfaceRef], whole: Part) -> Vec<Part> {
    let mut done = Vec::new();
    let mut open = std::collections::VecDeque::from([(whole, 0)]);
    while let Some((part, depth)) = open.pop_front() {
        let enough = depth >= DEPTH || done.len() + open.len() + 1 >= PARTS;
        let convex = part.is_convex_near(FACTOR);
        let halves = (!enough && !convex).then(|| part.halves(surfaces)).flatten();
        match halves {
            Some(halves) => open.extend(halves.map(|half| (half, depth + 1))),
            None => done.push(part),
        }
    }
    done
}
