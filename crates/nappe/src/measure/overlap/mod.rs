//! Whether surfaces pass through themselves or each other, by branch and bound over pairs of rectangles of parameters.
//!
//! A pair is done with if the proofs of [`apart`] apply, or if both rectangles lie within the contact distance of one
//! place of a surface or of something shared. Otherwise a common point is looked for, and the larger rectangle is halved.

mod apart;
mod links;
mod meet;
mod tree;

use super::pinch::pinches;
use super::size;
use super::tear::tear;
use crate::breaks::Breaks;
use crate::interval::Interval;
use crate::mesh::closing::SHARE;
use crate::mesh::shared::Edge;
use crate::ranked::Ranked;
use crate::surface::{Dir, Side, Surface, SurfaceRef};
use glam::DVec3;
use links::Links;
use meet::{Kind, Meet, Root};
use std::collections::BinaryHeap;
use tree::{Line, Node, Tree};

/// How closely to look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverlapOptions {
    /// Sides and corners that are nowhere farther apart than this length are shared. Common points within this distance
    /// of what is shared are not told from it, nor are points of one surface that lie in a part of it no larger. At most
    /// a hundredth of the smaller surface of a pair is used.
    pub contact: f64,
    /// The most pairs of rectangles that are looked at for each pair of surfaces. If they have many analytic pieces, at
    /// least twenty for each piece are looked at.
    pub budget: usize,
}

impl OverlapOptions {
    /// The defaults with a contact distance: 20000 pairs of rectangles.
    pub fn with_contact(contact: f64) -> Self {
        Self {
            contact,
            budget: 20_000,
        }
    }
}

/// What is known where surfaces are not proven to be apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Meeting {
    /// One passes through the other.
    Crosses {
        /// True if the common point is proven to exist; else it was found in floating point, within rounding.
        proven: bool,
        /// The angle between the tangent planes there, radians in (0, π/2].
        angle: f64,
    },
    /// They have an area in common, within rounding: found at a point and beside it.
    Overlaps,
    /// They have a point in common, within rounding, where tangent planes agree or one of them ends.
    Touches {
        /// True if it is proven that they do not pass through each other anywhere, but for rounding and what is within
        /// the contact distance of something shared: every two parts are apart, or a plane has one part on either side.
        /// Else that they cross elsewhere is not excluded.
        only: bool,
    },
    /// Neither a common point was found nor could one be excluded.
    Undecided {
        /// The distance between the points at the place: they come at least as near as this. 0 with equal parameters
        /// where it is not proven that a surface does not fold back beside one place.
        distance: f64,
    },
}

/// Two surfaces, or one with itself, that are not proven to be apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// The indices of the surfaces; equal for a surface with itself.
    pub surfaces: [usize; 2],
    /// How they meet.
    pub meeting: Meeting,
    /// The parameters on both, of the common point or of the undecided place.
    pub uv: [[f64; 2]; 2],
    /// The point of the first surface there.
    pub point: DVec3,
}

/// The result of [`overlaps`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlaps {
    /// What is not proven to be apart, ordered by the surfaces' indices. For each pair one place is given.
    pub found: Vec<Overlap>,
    /// The number of pairs of surfaces, each with itself included, that are proven to have no common points but shared
    /// ones.
    pub apart: usize,
}

/// A side whose points lie within this part of the surface's size of each other is one point.
const POLE: f64 = 1e-9;
/// Rectangles smaller than this share of the contact distance are not halved.
const SMALLEST: f64 = 1e-3;
/// The accuracy to which points are computed, relative to the greatest coordinate.
const ROUNDING: f64 = 1e-12;
/// A common point is looked for after every so many halvings: it takes as long as an enclosure, and is found as well a
/// little later.
const TRIED_AFTER: u32 = 4;
/// The least budget for each analytic piece: rectangles are pieces at first, and each has a few neighbours.
const FOR_PIECE: usize = 20;
/// How much more is looked at, relative to the budget, after surfaces were found to touch: they may cross elsewhere.
const AFTER_TOUCH: usize = 10;

/// Looks for points that two surfaces, or two places of one surface, have in common, apart from shared sides, corners,
/// poles and lines inside that are one point ([`pinches`](super::pinches)). Two points of one surface with the same place but different parameters count as common.
///
/// That surfaces are apart is proven by interval arithmetic, within `options.contact` as said there. Where several
/// proofs fail (surfaces that touch, or fold back sharply along a shared side) the place is given as undecided, never
/// passed over. A surface that cannot be enclosed stays undecided.
///
/// Cost: some enclosures of order 1 for each surface that is clear of the others (up to a thousand for each analytic piece
/// whose enclosures are loose); at most `options.budget` pairs of rectangles for each pair of surfaces.
pub fn overlaps(surfaces: &[SurfaceRef], options: &OverlapOptions) -> Overlaps {
    let mut trees: Vec<Tree> = surfaces.iter().map(|s| tree(s.as_ref())).collect();
    let mut out = Overlaps::default();
    for i in 0..trees.len() {
        for j in i..trees.len() {
            match search(&mut trees, [i, j], options) {
                Some(found) => out.found.push(found),
                None => out.apart += 1,
            }
        }
    }
    out
}

fn tree(surface: &dyn Surface) -> Tree<'_> {
    let size = size(surface);
    let is_pole = |s: &Side| Edge::new(surface, *s).is_collapsed(POLE * size);
    let sides = Side::ALL.into_iter().filter(is_pole);
    let inside = pinches(surface).into_iter().map(|p| Line {
        across: p.dir as usize,
        at: p.at,
    });
    let poles = sides.map(|s| Line::side(surface, s)).chain(inside);
    Tree::new(surface, size, poles.collect())
}

/// A pair of nodes to be looked at.
struct Pending {
    nodes: [usize; 2],
    halvings: u32,
}

/// The search for one pair of surfaces; `None` if they are proven to be apart.
fn search(trees: &mut [Tree], pair: [usize; 2], options: &OverlapOptions) -> Option<Overlap> {
    let [i, j] = pair;
    let is_self = i == j;
    let roots = pair.map(|k| trees[k].nodes[trees[k].root]);
    if !is_self && !roots[0].bounds.touches(roots[1].bounds) {
        return None;
    }
    let rounding = ROUNDING * trees[i].far().max(trees[j].far());
    let contact = options
        .contact
        .min(SHARE * trees[i].size.min(trees[j].size));
    let mut links = Links::between(&trees[i], &trees[j], is_self, contact, rounding);
    let surfaces = pair.map(|k| trees[k].surface);
    let meet = Meet { surfaces, rounding };
    let torn = surfaces.iter().any(|s| tear(*s).is_some());

    let mut heap = BinaryHeap::new();
    let mut order = 0;
    // The largest first.
    let mut push =
        |heap: &mut BinaryHeap<Ranked<Pending>>, trees: &[Tree], nodes: [usize; 2], halvings| {
            let size = trees[i].nodes[nodes[0]]
                .size()
                .max(trees[j].nodes[nodes[1]].size());
            order += 1;
            heap.push(Ranked {
                rank: size,
                number: order,
                item: Pending { nodes, halvings },
            });
        };
    push(&mut heap, trees, pair.map(|k| trees[k].root), 0);
    let pieces = |s: &dyn Surface| s.breaks(Dir::U).pieces() * s.breaks(Dir::V).pieces();
    let pieces: usize = surfaces.iter().map(|s| pieces(*s)).sum();
    let (mut seen, mut budget) = (0, options.budget.max(FOR_PIECE * pieces));
    let mut left: Option<[Node; 2]> = None;
    let mut touch: Option<Root> = None;
    let result = |root: &Root, meeting| Overlap {
        surfaces: pair,
        meeting,
        uv: root.uv,
        point: root.point,
    };
    while let Some(Ranked { item: top, .. }) = heap.pop() {
        let [x, y] = [trees[i].nodes[top.nodes[0]], trees[j].nodes[top.nodes[1]]];
        // Quickly seen, and not counted: near a point where a surface touches itself there are many such pairs.
        if is_one_place(surfaces, &x, &y, &links, contact) {
            continue;
        }
        if seen >= budget {
            left = left.or(Some([x, y]));
            break;
        }
        seen += 1;
        let both = [&trees[i], &trees[j]];
        if !torn && apart::apart(both, &x, &y, &links, contact) {
            continue;
        }
        let is_same = is_self && top.nodes[0] == top.nodes[1];
        let only_touch = !is_self && !torn && apart::touch(both, &x, &y, 2.0 * rounding);
        let look = if only_touch {
            touch.is_none()
        } else {
            top.halvings % TRIED_AFTER == TRIED_AFTER - 1
        };
        // Over a tear a point would be found beside itself; a torn surface is at fault anyway.
        if look && !(is_same || torn && is_self) {
            let explained = |r: &Root| {
                (is_self && part(surfaces[0], r.uv) <= contact)
                    || links.explain(surfaces, r.uv, contact)
            };
            let root = meet.find([x.uv, y.uv]).or_else(|| {
                let sides = only_touch.then(|| meet.find_on_side([x.uv, y.uv]));
                sides.flatten()
            });
            if let Some(root) = root.filter(|r| !explained(r)) {
                match meet.classify(&root, &links) {
                    Kind::Crosses { proven, angle } => {
                        return Some(result(&root, Meeting::Crosses { proven, angle }));
                    }
                    Kind::Overlaps => return Some(result(&root, Meeting::Overlaps)),
                    Kind::Touches => {
                        if touch.is_none() {
                            touch = Some(root);
                            match links.stand(surfaces, root.uv, contact, rounding) {
                                Some((k, line)) => trees[pair[k]].cuts.push(line),
                                None => budget = budget.min(seen + options.budget / AFTER_TOUCH),
                            }
                        }
                    }
                }
            }
        }
        // Without a common point it is not known that they touch: smaller parts may be apart.
        if only_touch && touch.is_some() {
            continue;
        }
        if x.size().max(y.size()) <= SMALLEST * contact {
            left = left.or(Some([x, y]));
            continue;
        }
        let [a, b] = top.nodes;
        let n = top.halvings + 1;
        let first = x.size() >= y.size();
        let halves = if first {
            trees[i].halve(a)
        } else {
            trees[j].halve(b)
        };
        match halves {
            None => left = left.or(Some([x, y])),
            Some([k, l]) if is_same => {
                push(&mut heap, trees, [k, k], n);
                push(&mut heap, trees, [l, l], n);
                push(&mut heap, trees, [k, l], n);
            }
            Some(halves) => {
                for h in halves {
                    push(&mut heap, trees, if first { [h, b] } else { [a, h] }, n);
                }
            }
        }
    }
    if let Some(root) = touch {
        let only = left.is_none();
        return Some(result(&root, Meeting::Touches { only }));
    }
    let [x, y] = left?;
    let uv = [x, y].map(|n| n.uv.map(Interval::mid));
    let [p, q] = [0, 1].map(|k| surfaces[k].point(uv[k]));
    Some(Overlap {
        surfaces: pair,
        meeting: Meeting::Undecided {
            distance: p.distance(q),
        },
        uv,
        point: p,
    })
}

/// The size of the part of a surface between two places.
fn part(surface: &dyn Surface, [p, q]: [[f64; 2]; 2]) -> f64 {
    let between = [0, 1].map(|d| Interval::new(p[d], q[d]));
    surface.bounds(between).diagonal()
}

/// True if both rectangles lie in a part of one surface, or at something shared, that is not larger than the contact
/// distance.
fn is_one_place(
    surfaces: [&dyn Surface; 2],
    x: &Node,
    y: &Node,
    links: &Links,
    contact: f64,
) -> bool {
    if x.bounds.hull(y.bounds).diagonal() > contact {
        return false;
    }
    let both = [0, 1].map(|d| x.uv[d].hull(y.uv[d]));
    (links.is_self && surfaces[0].bounds(both).diagonal() <= contact) || links.join(x, y)
}
