//! A surface as a binary tree of rectangles of parameters, each with enclosures.

use crate::box3::Box3;
use crate::breaks::{Breaks, Limit};
use crate::interval::Interval;
use crate::mesh::shared::Edge;
use crate::surface::{Dir, Side, Surface, jet_index, normal_at};
use glam::DVec3;
use std::cell::RefCell;
use std::collections::HashMap;

/// A line of constant parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    /// The parameter that is constant: 0 for u, 1 for v.
    pub(super) across: usize,
    pub(super) at: f64,
}

impl Line {
    pub(super) fn side(surface: &dyn Surface, side: Side) -> Self {
        Self {
            across: side.across() as usize,
            at: Edge::new(surface, side).at,
        }
    }
}

/// A rectangle of parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) uv: [Interval; 2],
    /// Encloses the points.
    pub(super) bounds: Box3,
    /// Encloses the point in the middle, and the tangents `r_u` and `r_v` over the rectangle.
    at: Box3,
    tangents: [Box3; 2],
    /// The tangents up to positive factors that depend on the point and vanish only where the surface is one point:
    /// beside a pole `v = v₀`, where `r_u = (v - v₀) × a mean of r_uv`, this mean stands for `r_u`.
    pub(super) along: [Box3; 2],
    /// The unit normal in the middle.
    pub(super) normal: Option<DVec3>,
    /// The numbers of the halves, if made.
    halves: Option<[usize; 2]>,
}

impl Node {
    /// The length of the diagonal of the box around it.
    pub(super) fn size(&self) -> f64 {
        self.bounds.diagonal()
    }

    /// The hulls of the enclosures of two nodes.
    fn with(&self, o: &Node) -> Node {
        let both = |x: [Box3; 2], y: [Box3; 2]| [x[0].hull(y[0]), x[1].hull(y[1])];
        Node {
            bounds: self.bounds.hull(o.bounds),
            tangents: both(self.tangents, o.tangents),
            along: both(self.along, o.along),
            ..*self
        }
    }

    /// The range of `f·r`: by the mean value theorem from the middle, and by the box.
    pub(super) fn range(&self, f: DVec3) -> Interval {
        let f = Box3::point(f);
        let step = |d: usize| {
            let t = self.uv[d];
            (t - Interval::point(t.mid())) * f.dot(self.tangents[d])
        };
        let mean = f.dot(self.at) + step(0) + step(1);
        let whole = f.dot(self.bounds);
        if mean.is_finite() {
            mean.meet(whole)
        } else {
            whole
        }
    }

    /// True if the rectangles have a point in common.
    pub(super) fn touches(&self, o: &Node) -> bool {
        (0..2).all(|d| self.uv[d].lo <= o.uv[d].hi && o.uv[d].lo <= self.uv[d].hi)
    }
}

pub(super) struct Tree<'a> {
    pub(super) surface: &'a dyn Surface,
    /// How large the surface is.
    pub(super) size: f64,
    pub(super) nodes: Vec<Node>,
    /// The node of the whole surface.
    pub(super) root: usize,
    /// The sides and the lines inside that are one point.
    pub(super) poles: Vec<Line>,
    /// Lines at which rectangles are halved first: those along which another surface stands on this one.
    pub(super) cuts: Vec<Line>,
    /// Other rectangles that were asked for, by their ends.
    grown: RefCell<HashMap<[u64; 4], Node>>,
}

/// A rectangle is grown by at most this many times its own width. Larger, and its tangents would vary too much for a
/// proof; smaller, and more and smaller rectangles would be looked at.
const GROWTH: f64 = 4.0;

/// A box that is larger than this many times the surface in it is loose: its halves' boxes are used. Smaller, and pieces
/// whose boxes are as good as boxes get would be halved; larger, and more pairs of rectangles would be looked at.
const LOOSE: f64 = 1.5;
/// Rectangles are not halved for their boxes alone if they are narrower than this part of the domain both ways.
const FINEST: f64 = 1.0 / 32.0;

/// Parts of a line around which a surface is narrow, for a part across of the width of its distance: with fewer the
/// opposite parts around a point would not be told apart; with more there would be needlessly many.
const AROUND: f64 = 2.0;

impl<'a> Tree<'a> {
    pub(super) fn new(surface: &'a dyn Surface, size: f64, poles: Vec<Line>) -> Self {
        let mut tree = Self {
            surface,
            size,
            nodes: Vec::new(),
            root: 0,
            poles,
            cuts: Vec::new(),
            grown: RefCell::default(),
        };
        let pieces = [Dir::U, Dir::V].map(|d| surface.breaks(d).pieces());
        tree.root = tree.over([[0, pieces[0]], [0, pieces[1]]]);
        tree
    }

    pub(super) fn is_pole(&self, side: Side) -> bool {
        self.poles.contains(&Line::side(self.surface, side))
    }

    /// The greatest coordinate: of the box around the surface, or if that is not bounded, of the points in the middles of
    /// the nodes.
    pub(super) fn far(&self) -> f64 {
        let greatest = |b: Box3| b.to_array().iter().fold(0.0f64, |m, r| m.max(r.mag()));
        let whole = greatest(self.nodes[self.root].bounds);
        if whole.is_finite() {
            return whole;
        }
        let middles = self.nodes.iter().map(|n| greatest(n.at));
        middles.filter(|m| m.is_finite()).fold(0.0, f64::max)
    }

    /// The node over ranges of analytic pieces; the enclosures of more than one piece come from those of its halves.
    fn over(&mut self, pieces: [[usize; 2]; 2]) -> usize {
        let count = pieces.map(|[a, b]| b - a);
        let range = |d: usize, dir: Dir| {
            let breaks = self.surface.breaks(dir);
            let [a, b] = pieces[d];
            Interval::new(breaks.piece(a).lo, breaks.piece(b - 1).hi)
        };
        let uv = [range(0, Dir::U), range(1, Dir::V)];
        if count == [1, 1] {
            return self.tight(uv);
        }
        let d = usize::from(count[1] > count[0]);
        let middle = (pieces[d][0] + pieces[d][1]) / 2;
        let halves = [0, 1].map(|k| {
            let mut half = pieces;
            half[d][1 - k] = middle;
            self.over(half)
        });
        let m = uv.map(Interval::mid);
        let [a, b] = halves.map(|k| self.nodes[k]);
        self.nodes.push(Node {
            uv,
            at: self.surface.bounds(m.map(Interval::point)),
            normal: normal_at(self.surface, m, [Limit::Above; 2]).vector(),
            halves: Some(halves),
            ..a.with(&b)
        });
        self.nodes.len() - 1
    }

    /// Adds a node of one analytic piece. Where its enclosures are much larger than the surface those of its halves are
    /// hulled: a loose box near the root costs a pair of rectangles with every other one.
    fn tight(&mut self, uv: [Interval; 2]) -> usize {
        let node = self.node(uv);
        self.nodes.push(node);
        let k = self.nodes.len() - 1;
        if self.is_loose(&node)
            && let Some(halves) = self.halve(k)
        {
            let [a, b] = halves.map(|h| self.nodes[h]);
            let hull = a.with(&b);
            let node = &mut self.nodes[k];
            node.bounds = node.bounds.meet(hull.bounds);
            node.tangents = [0, 1].map(|d| node.tangents[d].meet(hull.tangents[d]));
            node.along = hull.along;
        }
        k
    }

    /// True if the box around a node that is not yet small is much larger than that of some of its points.
    fn is_loose(&self, node: &Node) -> bool {
        let domain = self.surface.domain();
        if (0..2).all(|d| node.uv[d].width() <= FINEST * domain[d].width()) {
            return false;
        }
        let at = |d: usize, k: usize| {
            let t = node.uv[d];
            [t.lo, t.mid(), t.hi][k]
        };
        let points = (0..9).map(|k| self.surface.point([at(0, k % 3), at(1, k / 3)]));
        let extent = Box3::around(points).map_or(f64::INFINITY, Box3::diagonal);
        node.size() > LOOSE * extent
    }

    /// A node from its own enclosures.
    fn node(&self, uv: [Interval; 2]) -> Node {
        let touched = self.poles.iter().filter(|l| uv[l.across].contains(l.at));
        let touched: Vec<&Line> = touched.collect();
        let jet = self
            .surface
            .enclose(uv, if touched.is_empty() { 1 } else { 2 });
        let tangents = [jet[1], jet[2]];
        let mut along = tangents;
        if let [line] = touched[..] {
            // In the middle the factor changes its sign: nothing is proven.
            let t = uv[line.across];
            let sign = if line.at == t.lo {
                Interval::ONE
            } else if line.at == t.hi {
                Interval::point(-1.0)
            } else {
                Interval::new(-1.0, 1.0)
            };
            along[1 - line.across] = jet[jet_index(1, 1)].scale(sign);
        }
        let m = uv.map(Interval::mid);
        Node {
            uv,
            bounds: jet[0],
            at: self.surface.bounds(m.map(Interval::point)),
            tangents,
            along,
            normal: normal_at(self.surface, m, [Limit::Above; 2]).vector(),
            halves: None,
        }
    }

    /// True if a rectangle around `x` is not much larger.
    pub(super) fn grows(&self, x: &Node, uv: [Interval; 2]) -> bool {
        (0..2).all(|d| uv[d].width() <= (1.0 + GROWTH) * x.uv[d].width())
    }

    /// The node of a rectangle around `x`; `None` if that is much larger.
    pub(super) fn grow(&self, x: &Node, uv: [Interval; 2]) -> Option<Node> {
        if uv == x.uv {
            return Some(*x);
        }
        if !self.grows(x, uv) {
            return None;
        }
        let key = [uv[0].lo, uv[0].hi, uv[1].lo, uv[1].hi].map(f64::to_bits);
        Some(
            *self
                .grown
                .borrow_mut()
                .entry(key)
                .or_insert_with(|| self.node(uv)),
        )
    }

    /// The parameter along which a node is longer in space. Around a line inside that is one point the surface is as
    /// narrow as one likes: there rectangles are measured by their distance from the line.
    fn longer(&self, node: &Node) -> usize {
        let domain = self.surface.domain();
        let width = |d: usize| node.uv[d].width();
        let inside = |l: &&Line| domain[l.across].lo < l.at && l.at < domain[l.across].hi;
        if let Some(line) = self.poles.iter().find(inside) {
            let d = line.across;
            let across = width(d) / ((node.uv[d].mid() - line.at).abs() + width(d));
            let along = AROUND * width(1 - d) / domain[1 - d].width();
            return if along > across { 1 - d } else { d };
        }
        let mut long = [0, 1].map(|d| node.tangents[d].norm().hi * width(d));
        if !(long[0].is_finite() && long[1].is_finite()) {
            long = [0, 1].map(|d| width(d) / domain[d].width());
        }
        usize::from(long[1] > long[0])
    }

    /// The halves of a node across its longer extent, or first at a line that is one point; `None` if it is too narrow to halve.
    pub(super) fn halve(&mut self, k: usize) -> Option<[usize; 2]> {
        let node = self.nodes[k];
        if node.halves.is_some() {
            return node.halves;
        }
        let inside = |l: &&Line| node.uv[l.across].lo < l.at && l.at < node.uv[l.across].hi;
        let (d, m) = match self.poles.iter().chain(&self.cuts).find(inside) {
            Some(line) => (line.across, line.at),
            None => {
                let d = self.longer(&node);
                (d, node.uv[d].mid())
            }
        };
        let t = node.uv[d];
        if m <= t.lo || m >= t.hi {
            return None;
        }
        let halves = [(t.lo, m), (m, t.hi)].map(|(lo, hi)| {
            let mut uv = node.uv;
            uv[d] = Interval::new(lo, hi);
            self.tight(uv)
        });
        self.nodes[k].halves = Some(halves);
        Some(halves)
    }
}
