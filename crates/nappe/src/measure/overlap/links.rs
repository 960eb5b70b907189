//! What two surfaces, or a surface with itself, are meant to have in common.

use super::meet::ON_SIDE;
use super::tree::{Line, Node, Tree};
use crate::box3::Box3;
use crate::breaks::{Breaks, Limit};
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
    fn of(edge: &Edge) -> Self {
        Self {
            across: edge.side.across() as usize,
            at: edge.at,
            below: edge.side.is_upper(),
        }
    }

    fn meets(&self, x: &Node) -> bool {
        let t = x.uv[self.across];
        self.at == if self.below { t.hi } else { t.lo }
    }

    /// The rectangle grown up to the line; `None` if it lies beyond the line.
    pub(super) fn reach(&self, uv: [Interval; 2]) -> Option<[Interval; 2]> {
        let t = uv[self.across];
        let mut grown = uv;
        grown[self.across] = toward(t, self.at, self.below);
        (!is_beyond(t, self.at, self.below)).then_some(grown)
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

    /// How large the part of the surface is between a point and the point of the line with the same parameter along it.
    /// (The distance in space would not do: another sheet may come near the line.)
    fn part(&self, surface: &dyn Surface, uv: [f64; 2]) -> f64 {
        let mut strip = uv.map(Interval::point);
        strip[self.across] = Interval::new(self.at, self.at).hull(strip[self.across]);
        surface.bounds(strip).diagonal()
    }

    /// The tangents along the line and across it, into the surface, at a point.
    fn frame(&self, surface: &dyn Surface, t: f64) -> [DVec3; 2] {
        let limit = if self.below {
            Limit::Below
        } else {
            Limit::Above
        };
        let uv = self.with(Interval::point(t)).map(|t| t.lo);
        let jet = surface.jet(uv, [limit; 2], 1);
        let sign = if self.below { -1.0 } else { 1.0 };
        [jet.d[2 - self.across], jet.d[1 + self.across] * sign]
    }
}

/// Two sides that are one, or both sides of a crease.
#[derive(Clone, Debug)]
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

    /// The parameter on the other side of the point at `t` of side `e`.
    fn partner(&self, e: usize, t: f64) -> Option<f64> {
        if self.cells.is_empty() {
            return Some(t);
        }
        if e == 1 {
            return self.back(Interval::point(t)).map(Interval::mid);
        }
        let cell = self.cells.iter().find(|c| c.t.contains(t))?;
        Some(cell.series(Interval::point(t)).c[0].mid())
    }

    /// True if both points are within `contact` of corresponding points of the sides, on the surfaces.
    fn explains(&self, surfaces: [&dyn Surface; 2], uv: [[f64; 2]; 2], contact: f64) -> bool {
        let near = |i: usize| self.borders[i].part(surfaces[i], uv[i]) <= contact;
        let along = |i: usize| uv[i][1 - self.borders[i].across];
        near(0)
            && near(1)
            && self.partner(1, along(1)).is_some_and(|t| {
                let between =
                    self.borders[0].with(Interval::new(t, t).hull(Interval::point(along(0))));
                surfaces[0].bounds(between).diagonal() <= contact
            })
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

/// A corner, or a line that is one point: a side, or one side of a line inside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// The ends of u and v: the parameter and whether the surface has smaller ones. `None` along a line that is a point.
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
        for line in &tree.poles {
            for below in [false, true] {
                let inside = if below {
                    line.at > domain[line.across].lo
                } else {
                    line.at < domain[line.across].hi
                };
                if inside {
                    let mut ends = [None; 2];
                    ends[line.across] = Some((line.at, below));
                    let uv = [0, 1].map(|d| ends[d].map_or(domain[d].lo, |e| e.0));
                    let point = tree.surface.point(uv);
                    found.push(Place { ends, point });
                }
            }
        }
        for corner in Corner::ALL {
            if corner.sides().iter().any(|&s| tree.is_pole(s)) {
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

    /// The rectangle grown up to the place; `None` if it lies beyond a line inside.
    pub(super) fn reach(&self, uv: [Interval; 2]) -> Option<[Interval; 2]> {
        let mut grown = uv;
        for d in 0..2 {
            if let Some((at, below)) = self.ends[d] {
                if is_beyond(uv[d], at, below) {
                    return None;
                }
                grown[d] = toward(uv[d], at, below);
            }
        }
        Some(grown)
    }

    fn meets(&self, x: &Node) -> bool {
        self.reach(x.uv) == Some(x.uv)
    }

    /// How large the part of the surface is between a point and the place.
    fn part(&self, surface: &dyn Surface, uv: [f64; 2]) -> f64 {
        let between = [0, 1].map(|d| {
            let t = Interval::point(uv[d]);
            self.ends[d].map_or(t, |(at, _)| t.hull(Interval::point(at)))
        });
        surface.bounds(between).diagonal()
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

/// True if a range reaches beyond an end.
fn is_beyond(t: Interval, at: f64, below: bool) -> bool {
    if below { t.hi > at } else { t.lo < at }
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
                if !a.is_pole(s) && !b.is_pole(t) {
                    let edges = [Edge::new(a.surface, s), Edge::new(b.surface, t)];
                    seams.extend(seam(edges, contact, rounding));
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

    /// Where a common point lies on a side of one surface but inside the other, that side may stand on the other surface
    /// along a line of constant parameter: then this line is shared as well, with both sides of the surface beside it. Gives
    /// it, and which surface it is in.
    pub(super) fn stand(
        &mut self,
        surfaces: [&dyn Surface; 2],
        uv: [[f64; 2]; 2],
        contact: f64,
        rounding: f64,
    ) -> Option<(usize, Line)> {
        let end = |k: usize, d: usize, t: f64| {
            (t - uv[k][d]).abs() <= ON_SIDE * surfaces[k].domain()[d].width()
        };
        for k in 0..2 {
            for side in Side::ALL {
                let other = Edge::new(surfaces[1 - k], side);
                if !end(1 - k, side.across() as usize, other.at) {
                    continue;
                }
                for dir in [Dir::U, Dir::V] {
                    let (d, at) = (dir as usize, uv[k][dir as usize]);
                    let domain = surfaces[k].domain()[d];
                    if end(k, d, domain.lo) || end(k, d, domain.hi) {
                        continue;
                    }
                    let line = || Edge::inside(surfaces[k], dir, at);
                    let edges = if k == 0 {
                        [line(), Edge::new(surfaces[1], side)]
                    } else {
                        [Edge::new(surfaces[0], side), line()]
                    };
                    let Some(mut found) = seam(edges, contact, rounding) else {
                        continue;
                    };
                    for below in [false, true] {
                        found.borders[k].below = below;
                        self.seams.push(found.clone());
                    }
                    return Some((k, Line { across: d, at }));
                }
            }
        }
        None
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
        let turned = |k: [usize; 2]| (k.map(|i| surfaces[i]), k.map(|i| uv[i]));
        let both = |k: [usize; 2]| {
            let (surfaces, uv) = turned(k);
            let place = |p: &[Place; 2]| (0..2).all(|i| p[i].part(surfaces[i], uv[i]) <= contact);
            self.seams.iter().any(|s| s.explains(surfaces, uv, contact))
                || self.places.iter().any(place)
        };
        both([0, 1]) || (self.is_self && both([1, 0]))
    }

    /// True if a surface passes through a sheet of its own with the unit normal `n` at a point `uv` of a seam: if the seam
    /// does, or if the surface lies on either side of it beside the seam.
    pub(super) fn passes(&self, surface: &dyn Surface, uv: [f64; 2], n: DVec3, least: f64) -> bool {
        let passes = |s: &Seam, e: usize| {
            let t = uv[1 - s.borders[e].across];
            let Some(partner) = s.partner(e, t) else {
                return false;
            };
            let height = |v: DVec3| v.normalize_or_zero().dot(n);
            let [own, other] = [
                s.borders[e].frame(surface, t),
                s.borders[1 - e].frame(surface, partner),
            ]
            .map(|f| f.map(height));
            own[0].abs() > least
                || own[1].abs().min(other[1].abs()) > least && own[1] * other[1] < 0.0
        };
        self.is_self
            && self.seams.iter().any(|s| {
                (0..2).any(|e| {
                    let b = &s.borders[e];
                    (uv[b.across] - b.at).abs() <= ON_SIDE * surface.domain()[b.across].width()
                        && passes(s, e)
                })
            })
    }
}

/// The two lines as one, if they agree within `contact` and a gap can be proven.
fn seam(edges: [Edge; 2], contact: f64, rounding: f64) -> Option<Seam> {
    let borders = [Border::of(&edges[0]), Border::of(&edges[1])];
    let [a, b] = edges.map(|edge| Along { edge });
    let map = matching(&a.edge, &b.edge, contact)?;
    let pair = Pair::new(a, b, &map);
    let gap = pair.greatest_gap()?;
    Some(Seam {
        borders,
        cells: pair.cells,
        gap: gap + rounding,
        known: RefCell::default(),
    })
}
