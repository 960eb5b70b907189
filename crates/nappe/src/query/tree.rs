//! Parts of surfaces in a tree of boxes.

use super::part::{EXACTNESS, Hull, Part};
use super::patch::Patch;
use super::shape::Shape;
use crate::box3::Box3;
use crate::exact::NurbsSurface;
use crate::interval::Interval;
use crate::parallel;
use glam::DVec3;

/// About the most parts of a piece that are made beforehand, and how often it is halved: at poles more tells nothing.
const PARTS: usize = 512;
const DEPTH: u32 = 12;

/// A box around some surfaces, pieces or parts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) hull: Hull,
    /// The number of the part, if it is one.
    pub(super) part: Option<u32>,
    /// The number of the first of two nodes below, if there are any.
    pub(super) below: Option<u32>,
    /// The number of the patch, if the part is a piece that is one.
    pub(super) patch: Option<u32>,
    /// True if all pieces in the box are patches.
    pub(super) patched: bool,
}

impl Node {
    fn empty(hull: Hull) -> Self {
        Self {
            hull,
            part: None,
            below: None,
            patch: None,
            patched: false,
        }
    }
}

/// All parts, with a tree of boxes over them whose root is the first node: halves of parts, parts of pieces, and pieces of
/// all surfaces.
#[derive(Debug)]
pub(super) struct Tree {
    pub(super) nodes: Vec<Node>,
    pub(super) parts: Vec<Part>,
    pub(super) patches: Vec<Patch>,
    /// That of the box around all surfaces; where no box encloses them, that around the parts that have one.
    pub(super) diagonal: f64,
}

impl Tree {
    pub(super) fn new(shapes: &[Shape], threads: usize) -> Self {
        let pieces: Vec<(u32, [Interval; 2])> = shapes
            .iter()
            .enumerate()
            .flat_map(|(k, shape)| shape.pieces().into_iter().map(move |uv| (k as u32, uv)))
            .collect();
        let bounds: Vec<Box3> = shapes.iter().map(Shape::bounds).collect();
        let bounded = bounds.iter().copied().filter(|b| b.is_finite());
        let diagonal = bounded.reduce(Box3::hull).map_or(0.0, Box3::diagonal);
        let nets: Vec<Option<NurbsSurface>> = shapes.iter().map(Shape::net).collect();
        let of = |k: usize| {
            let (surface, uv) = pieces[k];
            let net = nets[surface as usize].as_ref();
            Divided {
                patch: net.and_then(|net| Patch::new(net, uv)),
                ..Divided::new(shapes, Part::new(shapes, surface, uv), diagonal)
            }
        };
        let pieces = parallel::each(threads, pieces.len(), of, |_| false);
        let mut tree = Self {
            nodes: Vec::new(),
            parts: Vec::new(),
            patches: Vec::new(),
            diagonal,
        };
        if let Some(first) = pieces.first() {
            tree.nodes.push(Node::empty(first.hulls[0]));
            tree.branch(0, pieces);
        }
        if !bounds.iter().all(|b| b.is_finite()) {
            tree.diagonal = tree.extent();
        }
        tree
    }

    /// The diagonal of the box around all parts, or else around those whose own box is finite.
    fn extent(&self) -> f64 {
        let boxes = |k: usize| self.nodes[k].hull.to_box();
        let whole = (!self.nodes.is_empty()).then(|| boxes(0));
        let lowest = (0..self.nodes.len()).filter(|&k| self.nodes[k].below.is_none());
        let finite = lowest.map(boxes).filter(|b| b.is_finite());
        let around = whole.filter(|b| b.is_finite());
        let around = around.or_else(|| finite.reduce(Box3::hull));
        around.map_or(0.0, Box3::diagonal)
    }

    /// The rounding errors of all points, and of the ways to a point.
    pub(super) fn rounding(&self, p: DVec3) -> f64 {
        let corners = self.nodes.first().map(|n| [n.hull.lo, n.hull.hi, p]);
        let sizes = corners.into_iter().flatten().map(|c| c.abs().max_element());
        EXACTNESS * sizes.fold(0.0, f64::max)
    }

    /// Puts pieces below a node: halves of them by their middles along the longest side of their box.
    fn branch(&mut self, node: usize, mut pieces: Vec<Divided>) {
        if pieces.len() < 2 {
            for piece in pieces {
                self.piece(node, piece);
            }
            return;
        }
        let middle = |d: &Divided| 0.5 * d.hulls[0].lo + 0.5 * d.hulls[0].hi;
        let (mut all, mut lo, mut hi) = (pieces[0].hulls[0], DVec3::INFINITY, DVec3::NEG_INFINITY);
        for piece in &pieces {
            all = all.join(piece.hulls[0]);
            (lo, hi) = (lo.min(middle(piece)), hi.max(middle(piece)));
        }
        let axis = (hi - lo).max_position();
        let half = pieces.len() / 2;
        pieces.select_nth_unstable_by(half, |a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
        let upper = pieces.split_off(half);
        let first = self.pair(node, all);
        self.branch(first, pieces);
        self.branch(first + 1, upper);
        self.nodes[node].patched = self.nodes[first..first + 2].iter().all(|n| n.patched);
    }

    /// Makes room for two nodes below a node.
    fn pair(&mut self, node: usize, hull: Hull) -> usize {
        let first = self.nodes.len();
        self.nodes[node].hull = hull;
        self.nodes[node].below = Some(first as u32);
        self.nodes.extend([Node::empty(hull); 2]);
        first
    }

    /// Puts the parts of a piece below a node.
    fn piece(&mut self, node: usize, piece: Divided) {
        let first_part = self.parts.len();
        self.parts.extend(piece.parts);
        let mut open = vec![(node, 0)];
        while let Some((node, k)) = open.pop() {
            let hull = piece.hulls[k];
            if let Some(halves) = piece.halves[k] {
                let first = self.pair(node, hull);
                open.extend([(first, halves), (first + 1, halves + 1)]);
            }
            self.nodes[node].hull = hull;
            self.nodes[node].part = Some((first_part + k) as u32);
        }
        if let Some(patch) = piece.patch {
            self.nodes[node].patch = Some(self.patches.len() as u32);
            self.nodes[node].patched = true;
            self.patches.push(patch);
        }
    }
}

/// A piece with its parts: the curvature of the distance is known well over those that are not halved.
struct Divided {
    /// The piece first.
    parts: Vec<Part>,
    /// The number of the first half of each part that was halved.
    halves: Vec<Option<usize>>,
    /// The boxes of the parts, no larger than those around their halves.
    hulls: Vec<Hull>,
    patch: Option<Patch>,
}

impl Divided {
    fn new(shapes: &[Shape], whole: Part, size: f64) -> Self {
        let mut out = Self {
            parts: vec![whole],
            halves: vec![None],
            hulls: Vec::new(),
            patch: None,
        };
        let mut depths = vec![0];
        let mut k = 0;
        while k < out.parts.len() && out.parts.len() < PARTS {
            if depths[k] < DEPTH
                && !out.parts[k].is_known(size)
                && let Some(halves) = out.parts[k].halves(shapes)
            {
                out.halves[k] = Some(out.parts.len());
                out.parts.extend(halves);
                out.halves.extend([None; 2]);
                depths.extend([depths[k] + 1; 2]);
            }
            k += 1;
        }
        out.hulls = out.parts.iter().map(|p| p.hull).collect();
        for k in (0..out.parts.len()).rev() {
            if let Some(first) = out.halves[k] {
                let halves = out.hulls[first].join(out.hulls[first + 1]);
                out.hulls[k] = out.hulls[k].meet(halves);
            }
        }
        out
    }
}
