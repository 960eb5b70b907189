//! What two surfaces, or a surface with itself, are meant to have in common.

use super::tree::{Node, Tree};
use crate::box3::Box3;
use crate::breaks::Breaks;
use crate::interval::Interval;
use crate::measure::along::Along;
use crate::measure::continuity::{Cell, Pair};
use crate::mesh::shared::{Edge, matching};
use crate::surface::{Corner, Dir, Side, Surface};
use glam::DVec3;
use smallvec::SmallVec;
use std::cell::RefCell;
use std::collections::HashMap;

/// A line of constant parameter, with the surface on one side of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Border {
    /// The parameter that is constant: 0 for u, 1 for v.
    pub(super) across: usize,
    pub(super) at: f64,
    /// True if the surface has smaller parameters.
    below: bool,
}

impl Border {
    fn of(surface: &dyn Surface, side: Side) -> Self {
        let edge = Edge::new(surface, side);
        Self {
            across: side.across() as usize,
            at: edge.at,
            below: side.is_upper(),
        }
    }

    fn meets(&self, x: &Node) -> bool {
        let t = x.uv[self.across];
        self.at == if self.below { t.hi } else { t.lo }
    }

    /// The rectangle grown up to the line; `None` if it lies beyond the line.
    pub(super) fn reach(&self, uv: [Interval; 2]) -> Option<[Interval; 2]> {
        let t = uv[self.across];
        let beyond = if self.below {
            t.hi > self.at
        } else {
            t.lo < self.at
        };
        let mut grown = uv;
        grown[self.across] = toward(t, self.at, self.below);
        (!beyond).then_some(grown)
    }

    /// The tangents across the line, into the surface.
    pub(super) fn inward(&self, x: &Node) -> Box3 {
        let sign = if self.below { -1.0 } else { 1.0 };
        x.along[self.across].scale(Interval::point(sign))
    }

    /// The tangents along the line.
    fn tangent(&self, surface: &dyn Surface, range: Interval) -> Box3 {
        surface.enclose(self.with(range), 1)[2 - self.across]
    }

    /// The parameters where the one along the line is `t`.
    fn with(&self, t: Interval) -> [Interval; 2] {
        let at = Interval::point(self.at);
        if self.across == 0 { [at, t] } else { [t, at] }
    }

    /// How far a point of the surface is from the point of the line with the same parameter along it.
    fn distance(&self, surface: &dyn Surface, uv: [f64; 2]) -> f64 {
        let on = self
            .with(Interval::point(uv[1 - self.across]))
            .map(|t| t.lo);
        surface.point(uv).distance(surface.point(on))
    }
}

/// Two sides that are one, or both sides of a crease.
#[derive(Debug)]
pub(super) struct Seam {
    pub(super) borders: [Border; 2],
    /// From the first side's parameter to the second's; none where they are the same.
    cells: Vec<Cell>,
    /// A bound of the distance between corresponding points.
    pub(super) gap: f64,
    /// The tangents over ranges that were asked for before: many pairs of rectangles lie at the same part.
    known: RefCell<HashMap<[u64; 2], Box3>>,
}

impl Seam {
    /// The tangents along the first side.
    pub(super) fn tangent(&self, surface: &dyn Surface, range: Interval) -> Box3 {
        *self
            .known
            .borrow_mut()
            .entry([range.lo.to_bits(), range.hi.to_bits()])
            .or_insert_with(|| self.borders[0].tangent(surface, range))
    }

    /// A range of the first side's parameter that contains all that correspond to a range of the second's.
    pub(super) fn back(&self, t: Interval) -> Option<Interval> {
        if self.cells.is_empty() {
            return Some(t);
        }
        self.cells
            .iter()
            .filter_map(|c| c.back(t))
            .reduce(Interval::hull)
    }
}

/// A corner, or a side that is one point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// The ends of u and v: the parameter and whether the surface has smaller ones. `None` along a side that is a point.
    ends: [Option<(f64, bool)>; 2],
    pub(super) point: DVec3,
}

impl Place {
    /// All corners and poles of a surface.
    fn all(tree: &Tree) -> Vec<Place> {
        let domain = tree.surface.domain();
        let mut found = Vec::new();
        let end = |d: usize, upper: bool| {
            let at = if upper { domain[d].hi } else { domain[d].lo };
            (at, upper)
        };
        for side in &tree.poles {
            let mut ends = [None; 2];
            ends[side.across() as usize] = Some(end(side.across() as usize, side.is_upper()));
            let uv = [0, 1].map(|d| ends[d].map_or(domain[d].lo, |e| e.0));
            let point = tree.surface.point(uv);
            found.push(Place { ends, point });
        }
        for corner in Corner::ALL {
            if corner.sides().iter().any(|s| tree.poles.contains(s)) {
                continue;
            }
            let upper = corner.ends().map(|k| k == 1);
            let ends = [0, 1].map(|d| end(d, upper[d]));
            let point = tree.surface.point(ends.map(|e| e.0));
            found.push(Place {
                ends: ends.map(Some),
                point,
            });
        }
        found
    }

    /// The rectangle grown up to the place.
    pub(super) fn reach(&self, uv: [Interval; 2]) -> [Interval; 2] {
        [0, 1].map(|d| self.ends[d].map_or(uv[d], |(at, below)| toward(uv[d], at, below)))
    }

    fn meets(&self, x: &Node) -> bool {
        self.reach(x.uv) == x.uv
    }

    /// The tangents that lead into the surface, over a rectangle at the place.
    pub(super) fn inward(&self, x: &Node) -> SmallVec<[Box3; 2]> {
        let ends = self.ends.iter().zip(&x.along);
        ends.filter_map(|(end, along)| {
            let &(_, below) = end.as_ref()?;
            Some(along.scale(Interval::point(if below { -1.0 } else { 1.0 })))
        })
        .collect()
    }
}

/// A range grown up to an end.
fn toward(t: Interval, at: f64, below: bool) -> Interval {
    if below {
        Interval { hi: at, ..t }
    } else {
        Interval { lo: at, ..t }
    }
}

/// What two surfaces share.
#[derive(Debug)]
pub(super) struct Links {
    pub(super) is_self: bool,
    pub(super) seams: Vec<Seam>,
    pub(super) places: Vec<[Place; 2]>,
}

impl Links {
    /// Sides that agree within `contact`, and corners that do.
    pub(super) fn between(a: &Tree, b: &Tree, is_self: bool, contact: f64, rounding: f64) -> Self {
        let mut seams = Vec::new();
        for (i, s) in Side::ALL.into_iter().enumerate() {
            let from = if is_self { i + 1 } else { 0 };
            for t in Side::ALL.into_iter().skip(from) {
                if !a.poles.contains(&s) && !b.poles.contains(&t) {
                    seams.extend(seam((a.surface, s), (b.surface, t), contact, rounding));
                }
            }
        }
        if is_self {
            for dir in [Dir::U, Dir::V] {
                for at in a.surface.breaks(dir).below(1) {
                    let border = |below| Border {
                        across: dir as usize,
                        at,
                        below,
                    };
                    seams.push(Seam {
                        borders: [border(true), border(false)],
                        cells: Vec::new(),
                        gap: rounding,
                        known: RefCell::default(),
                    });
                }
            }
        }
        let (p, q) = (Place::all(a), Place::all(b));
        let mut places = Vec::new();
        for (i, x) in p.iter().enumerate() {
            for y in q.iter().skip(if is_self { i } else { 0 }) {
                if x.point.distance(y.point) <= contact {
                    places.push([*x, *y]);
                }
            }
        }
        Self {
            is_self,
            seams,
            places,
        }
    }

    /// True if both rectangles lie at something shared.
    pub(super) fn join(&self, x: &Node, y: &Node) -> bool {
        let seam = |s: &Seam, x: &Node, y: &Node| s.borders[0].meets(x) && s.borders[1].meets(y);
        let place = |p: &[Place; 2], x: &Node, y: &Node| p[0].meets(x) && p[1].meets(y);
        self.seams
            .iter()
            .any(|s| seam(s, x, y) || (self.is_self && seam(s, y, x)))
            || self
                .places
                .iter()
                .any(|p| place(p, x, y) || (self.is_self && place(p, y, x)))
    }

    /// True if both points lie within `contact` of something shared.
    pub(super) fn explain(
        &self,
        surfaces: [&dyn Surface; 2],
        uv: [[f64; 2]; 2],
        contact: f64,
    ) -> bool {
        let seam = |s: &Seam, k: [usize; 2]| {
            (0..2).all(|i| s.borders[i].distance(surfaces[k[i]], uv[k[i]]) <= contact)
        };
        let place = |p: &[Place; 2], k: [usize; 2]| {
            (0..2).all(|i| surfaces[k[i]].point(uv[k[i]]).distance(p[i].point) <= contact)
        };
        let both = |k: [usize; 2]| {
            self.seams.iter().any(|s| seam(s, k)) || self.places.iter().any(|p| place(p, k))
        };
        both([0, 1]) || (self.is_self && both([1, 0]))
    }
}

/// The two sides as one, if they agree within `contact` and a gap can be proven.
fn seam(
    a: (&dyn Surface, Side),
    b: (&dyn Surface, Side),
    contact: f64,
    rounding: f64,
) -> Option<Seam> {
    let [along_a, along_b] = [a, b].map(|(surface, side)| Along {
        edge: Edge::new(surface, side),
    });
    let map = matching(&along_a.edge, &along_b.edge, contact)?;
    let pair = Pair::new(along_a, along_b, &map);
    let gap = pair.greatest_gap()?;
    Some(Seam {
        borders: [Border::of(a.0, a.1), Border::of(b.0, b.1)],
        cells: pair.cells,
        gap: gap + rounding,
        known: RefCell::default(),
    })
}
