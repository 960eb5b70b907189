//! All solutions over a pair of rectangles: boxes of all four parameters are halved until they are proven to hold nothing, or
//! nothing but curves that have been followed.
//!
//! A box holds nothing if the parts of the two surfaces are apart: their boxes, or the ranges of their distance along the
//! normals. A curve is begun at any point to which Newton's method leads from the middle of a box, unless the point lies in
//! the box of a known curve. So no branch can be lost: what is neither empty nor covered when the boxes are as small as it makes
//! sense, or the budget ends, is given back as open.

use super::follow::{Strand, follow, is_covered, only_place};
use super::pair::{Box4, Pair, Place, null};
use super::step::Stepper;
use crate::box3::Box3;
use crate::interval::Interval;
use crate::query::extended::{margins, surface_at, surface_over};
use crate::query::solve::encloses;
use crate::ranked::Ranked;
use crate::surface::Surface;
use glam::DVec3;
use std::array::from_fn;
use std::collections::BinaryHeap;

/// Where a rectangle is cut: not where models like to have their symmetries.
const CUT: f64 = 0.487_163_9;
/// The smallest part, relative to the rectangle.
const SMALLEST: f64 = 1.0 / (1u64 << 18) as f64;
/// A curve is looked for after every so many halvings.
const TRIED_AFTER: u32 = 3;
/// When it is looked at whether the surfaces coincide.
const COINCIDE_TRIED: std::ops::Range<u32> = 4..24;
/// So many more boxes are looked at after the surfaces were found to coincide somewhere: the border of such a region cannot be
/// told.
const AFTER_COINCIDING: usize = 2000;
/// The accuracy to which points of coinciding surfaces agree, relative to the greatest coordinate.
const SAME: f64 = 1e-12;
/// A step is worth so many boxes; and so many steps there are at least.
pub(super) const STEP: usize = 8;
const STEPS: usize = 500;
/// Tangent planes at a smaller angle may be those of coinciding surfaces.
const PARALLEL: f64 = 1e-4;
/// Rows and columns of the places where that is looked at.
const PLACES: [f64; 3] = [0.193_7, 0.467_1, 0.821_3];

/// A part of a rectangle of one surface.
struct Node {
    uv: [Interval; 2],
    middle: Box3,
    normal: DVec3,
    /// The point and the tangents over it.
    over: [Box3; 3],
    size: f64,
    /// The number of the first half.
    below: Option<usize>,
}

/// The parts that were looked at.
struct Parts<'a> {
    surface: &'a dyn Surface,
    rect: [Interval; 2],
    nodes: Vec<Node>,
}

/// What is left.
#[derive(Clone, Copy, Debug)]
pub(super) struct Open {
    pub(super) x: Box4,
    /// True if the surfaces coincide there, within rounding, as far as places on one of them tell.
    pub(super) coincides: bool,
}

/// All that was found over a pair of rectangles.
#[derive(Debug, Default)]
pub(super) struct Found {
    pub(super) strands: Vec<Strand>,
    /// Points where a curve touches the sides without entering.
    pub(super) touches: Vec<Place>,
    pub(super) open: Vec<Open>,
    pub(super) looked: usize,
    /// The steps tried.
    pub(super) steps: usize,
}

struct Pending {
    nodes: [usize; 2],
    halved: u32,
}

/// Looks over a pair of rectangles.
pub(super) fn search(stepper: &Stepper, mut budget: usize) -> Found {
    let pair = stepper.pair;
    let mut parts = [0, 1].map(|n| {
        let rect = [pair.rect[2 * n], pair.rect[2 * n + 1]];
        Parts::new(pair.surfaces[n].as_ref(), rect)
    });
    let mut found = Found::default();
    let mut covers: Vec<Box4> = Vec::new();
    let allowed = budget / STEP + STEPS;
    let mut steps = allowed;
    let mut heap = BinaryHeap::new();
    let mut number = 0;
    let mut push = |heap: &mut BinaryHeap<_>, parts: &[Parts; 2], nodes: [usize; 2], halved| {
        number += 1;
        heap.push(Ranked {
            rank: parts[0].nodes[nodes[0]]
                .size
                .max(parts[1].nodes[nodes[1]].size),
            number,
            item: Pending { nodes, halved },
        });
    };
    push(&mut heap, &parts, [0, 0], 0);
    while let Some(Ranked { item: top, .. }) = heap.pop() {
        let [a, b] = [0, 1].map(|n| &parts[n].nodes[top.nodes[n]]);
        let x = [a.uv[0], a.uv[1], b.uv[0], b.uv[1]];
        if found.looked >= budget {
            if !is_apart(a, b) && !is_covered(x, &covers) {
                found.open.push(Open {
                    x,
                    coincides: false,
                });
            }
            continue;
        }
        found.looked += 1;
        if is_apart(a, b) || is_covered(x, &covers) {
            continue;
        }
        if top.halved % TRIED_AFTER == 0
            && begin(stepper, &x, &mut found, &mut covers, &mut steps)
            && is_covered(x, &covers)
        {
            continue;
        }
        if COINCIDE_TRIED.contains(&top.halved)
            && (coincide(a, pair, 1, b) || coincide(b, pair, 0, a))
        {
            if !found.open.iter().any(|o| o.coincides) {
                budget = budget.min(found.looked + AFTER_COINCIDING);
            }
            found.open.push(Open { x, coincides: true });
            continue;
        }
        let larger = usize::from(b.size > a.size);
        let other = 1 - larger;
        let halves = match parts[larger].halve(top.nodes[larger]) {
            Some(first) => Some((larger, first)),
            None => parts[other].halve(top.nodes[other]).map(|f| (other, f)),
        };
        match halves {
            Some((n, first)) => {
                for half in [first, first + 1] {
                    let mut nodes = top.nodes;
                    nodes[n] = half;
                    push(&mut heap, &parts, nodes, top.halved + 1);
                }
            }
            None => found.open.push(Open {
                x,
                coincides: false,
            }),
        }
    }
    found
        .open
        .retain(|open| open.coincides || !is_covered(open.x, &covers));
    found.steps = allowed - steps;
    found
}

/// Begins a curve near the middle of a box; false if none is new.
fn begin(
    stepper: &Stepper,
    x: &Box4,
    found: &mut Found,
    covers: &mut Vec<Box4>,
    steps: &mut usize,
) -> bool {
    let pair = stepper.pair;
    let Some(at) = pair.near(x.map(Interval::mid)) else {
        return false;
    };
    // Where the curve runs along a side it may be a rounding error beyond it.
    if !(0..4).all(|j| pair.outer[j].contains(at[j])) {
        return false;
    }
    let (_, g) = pair.at(&at);
    let null = null(&g);
    let weight: Place = from_fn(|j| null[j].abs() * g[j].length());
    let Some(k) = (0..4).max_by(|&i, &j| weight[i].total_cmp(&weight[j])) else {
        return false;
    };
    let Some(start) = pair.knot(at, k) else {
        return false;
    };
    if covers.iter().any(|c| encloses(c, &start.zero)) {
        return false;
    }
    let strand = follow(stepper, &start, covers, steps);
    if strand.covers.is_empty() {
        return false;
    }
    covers.extend(strand.covers.iter().copied());
    let short = strand.length(stepper) <= 1e-9 * pair.size;
    match only_place(&strand).filter(|_| short) {
        Some(place) => found.touches.push(pair.held(place)),
        None => found.strands.push(strand),
    }
    true
}

/// True if the parts of two surfaces are proven to have no point in common.
fn is_apart(a: &Node, b: &Node) -> bool {
    if !a.over[0].touches(b.over[0]) {
        return true;
    }
    let between = a.middle - b.middle;
    let along = |d: DVec3| {
        let d = Box3::point(d);
        let reach = |n: &Node| {
            let way = |k: usize| d.dot(n.over[1 + k]) * (n.uv[k] - Interval::point(n.uv[k].mid()));
            way(0) + way(1)
        };
        d.dot(between) + reach(a) - reach(b)
    };
    let across = a.normal.cross(b.normal).normalize_or_zero();
    let directions = [
        a.normal,
        b.normal,
        across,
        a.normal + b.normal,
        a.normal - b.normal,
    ];
    directions
        .into_iter()
        .any(|d| d != DVec3::ZERO && !along(d).contains(0.0))
}

/// True if all places looked at on a part of one surface lie on the other one (number `n`), found from a part of that, within
/// rounding, and the tangent planes agree at the middles.
fn coincide(a: &Node, pair: &Pair, n: usize, b: &Node) -> bool {
    if a.normal.cross(b.normal).length() > PARALLEL.max(0.5 * a.size.max(b.size) / pair.size) {
        return false;
    }
    let [own, other] = [1 - n, n].map(|n| pair.surfaces[n].as_ref());
    let rect = [pair.rect[2 * n], pair.rect[2 * n + 1]];
    let own_rect = [pair.rect[2 - 2 * n], pair.rect[3 - 2 * n]];
    let at = |d: usize, k: usize| {
        let t = a.uv[d].lo + PLACES[k] * a.uv[d].width();
        t.clamp(own_rect[d].lo, own_rect[d].hi)
    };
    (0..9).all(|k| {
        let p = surface_at(own, own_rect, [at(0, k / 3), at(1, k % 3)])[0];
        let far = p.abs().max_element().max(pair.size);
        let nearest = foot(other, rect, p, b.uv.map(Interval::mid));
        nearest.is_some_and(|gap| gap <= SAME * far)
    })
}

/// The distance of a point from a surface by Newton's method; `None` if that leaves the rectangle.
fn foot(surface: &dyn Surface, rect: [Interval; 2], p: DVec3, from: [f64; 2]) -> Option<f64> {
    let mut x = from;
    let mut gap = f64::INFINITY;
    for _ in 0..12 {
        let j = surface_at(surface, rect, x);
        let d = p - j[0];
        let last = gap;
        gap = d.length();
        if gap >= 0.5 * last && last.is_finite() {
            gap = gap.min(last);
            break;
        }
        let (e, f, g) = (j[1].dot(j[1]), j[1].dot(j[2]), j[2].dot(j[2]));
        let det = e * g - f * f;
        let [r, s] = [j[1].dot(d), j[2].dot(d)];
        let step = [(g * r - f * s) / det, (e * s - f * r) / det];
        if !step.iter().all(|s| s.is_finite()) {
            return None;
        }
        for k in 0..2 {
            x[k] += step[k];
            let w = 1e-9 * rect[k].width();
            if x[k] < rect[k].lo - w || x[k] > rect[k].hi + w {
                return None;
            }
        }
    }
    Some(gap)
}

impl<'a> Parts<'a> {
    fn new(surface: &'a dyn Surface, rect: [Interval; 2]) -> Self {
        let mut parts = Self {
            surface,
            rect,
            nodes: Vec::new(),
        };
        parts.add(rect.map(|r| margins(r, [1.0, 1.0])));
        parts
    }

    fn add(&mut self, uv: [Interval; 2]) {
        let over = surface_over(self.surface, self.rect, uv);
        let at = surface_over(
            self.surface,
            self.rect,
            uv.map(|t| Interval::point(t.mid())),
        );
        let normal = at[1].mid().cross(at[2].mid()).normalize_or_zero();
        self.nodes.push(Node {
            uv,
            middle: at[0],
            normal: if normal.is_finite() {
                normal
            } else {
                DVec3::ZERO
            },
            over,
            size: over[0].diagonal(),
            below: None,
        });
    }

    /// The number of the first of the halves of a part; `None` if it is too small.
    fn halve(&mut self, k: usize) -> Option<usize> {
        if self.nodes[k].below.is_some() {
            return self.nodes[k].below;
        }
        let node = &self.nodes[k];
        let length = |d: usize| node.over[1 + d].norm().hi * node.uv[d].width();
        let relative = |d: usize| node.uv[d].width() / self.rect[d].width();
        let (l, r) = ([length(0), length(1)], [relative(0), relative(1)]);
        let d = if l.iter().all(|l| l.is_finite()) && r[0].max(r[1]) <= 64.0 * r[0].min(r[1]) {
            usize::from(l[1] > l[0])
        } else {
            usize::from(r[1] > r[0])
        };
        let t = node.uv[d];
        let at = t.lo + CUT * (t.hi - t.lo);
        if r[d] <= SMALLEST || at <= t.lo || at >= t.hi {
            return None;
        }
        let uv = node.uv;
        let first = self.nodes.len();
        for range in [Interval { lo: t.lo, hi: at }, Interval { lo: at, hi: t.hi }] {
            let mut half = uv;
            half[d] = range;
            self.add(half);
        }
        self.nodes[k].below = Some(first);
        Some(first)
    }
}
