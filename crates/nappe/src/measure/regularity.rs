//! Where a surface is regular: collapsed sides, folds, and degenerate points.

use super::jump::JumpOptions;
use super::size;
use crate::box3::Box3;
use crate::breaks::{Breaks, Limit};
use crate::interval::Interval;
use crate::mesh::shared::Edge;
use crate::surface::{Dir, Side, Surface, jet_index, jet_len};
use glam::DVec3;
use std::collections::VecDeque;

/// A side whose points lie within this part of the surface's size of each other is one point.
const COLLAPSED: f64 = 1e-9;
/// Rectangles narrower than this part of a piece are not divided. Smaller, and rounding would decide what the normals
/// beside a degenerate point do; larger, and nearly degenerate places would not be told from degenerate ones.
const NARROW: f64 = 1e-6;
/// The most places reported of a kind.
const PLACES: usize = 16;

/// What is known about `n = r_u × r_v` over a whole surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Regularity {
    /// The sides that are one point (poles).
    pub collapsed: Vec<Side>,
    /// True if it is proven that n vanishes nowhere but on collapsed sides, and that it vanishes there only to first
    /// order: the surface has a tangent plane everywhere (at a pole: along every line that leads into it).
    pub regular: bool,
    /// Places beside which n has opposite directions: the surface folds over.
    pub folds: Vec<[f64; 2]>,
    /// Other places where n could not be proven not to vanish: degenerate points, or too narrow to decide.
    pub degenerate: Vec<[f64; 2]>,
    /// The smallest length of n found at a sample, relative to the largest (collapsed sides left out).
    pub least: f64,
    /// Where it was found.
    pub at: [f64; 2],
}

/// Examines a surface. Cost: at most 16 times [`JumpOptions::parts`] enclosures of order 2.
pub fn regularity(surface: &dyn Surface, options: &JumpOptions) -> Regularity {
    let domain = surface.domain();
    let size = size(surface);
    let collapsed: Vec<Side> = Side::ALL
        .into_iter()
        .filter(|&s| Edge::new(surface, s).is_collapsed(COLLAPSED * size))
        .collect();
    let mut boxes: VecDeque<Patch> = VecDeque::new();
    let (bu, bv) = (surface.breaks(Dir::U), surface.breaks(Dir::V));
    for i in 0..bu.pieces() {
        for j in 0..bv.pieces() {
            boxes.push_back(Patch {
                uv: [bu.piece(i), bv.piece(j)],
                share: [bu.piece(i), bv.piece(j)].map(|p| p.hi - p.lo),
            });
        }
    }
    let budget = boxes.len() + 16 * options.parts;
    let mut seen = 0;
    let (mut least, mut most, mut at) = (f64::INFINITY, 0.0f64, [domain[0].mid(), domain[1].mid()]);
    let mut left = Vec::new();
    while let Some(b) = boxes.pop_front() {
        seen += 1;
        let m = b.uv.map(Interval::mid);
        let n = normal(surface, m).length();
        most = most.max(n);
        if n < least {
            (least, at) = (n, m);
        }
        if b.excludes_zero(surface, &collapsed) {
            continue;
        }
        match b.halves() {
            Some(halves) if seen + boxes.len() < budget => boxes.extend(halves),
            _ => left.push(b),
        }
    }
    let mut folds = Vec::new();
    let mut degenerate = Vec::new();
    for b in &left {
        let list = if b.folds(surface) {
            &mut folds
        } else {
            &mut degenerate
        };
        if list.len() < PLACES {
            list.push(b.uv.map(Interval::mid));
        }
    }
    Regularity {
        collapsed,
        regular: left.is_empty(),
        folds,
        degenerate,
        least: if most > 0.0 { least / most } else { 0.0 },
        at,
    }
}

fn normal(surface: &dyn Surface, uv: [f64; 2]) -> DVec3 {
    let mut d = [DVec3::ZERO; jet_len(1)];
    surface.jet_into(uv, [Limit::Above; 2], 1, &mut d);
    d[1].cross(d[2])
}

/// A rectangle inside one analytic piece.
#[derive(Clone, Copy, Debug)]
struct Patch {
    uv: [Interval; 2],
    /// The widths of the piece, to compare those of the rectangle with.
    share: [f64; 2],
}

impl Patch {
    /// True if n is proven not to vanish here, or only on a collapsed side and to first order there.
    fn excludes_zero(&self, surface: &dyn Surface, collapsed: &[Side]) -> bool {
        let limit = [Limit::Above; 2];
        let mut over = [Box3::ENTIRE; jet_len(2)];
        surface.enclose_piece(self.uv, limit, 2, &mut over);
        let across = |b: &[Box3; 6], dir: Dir| {
            // n_u = r_uu × r_v + r_u × r_uv, n_v = r_uv × r_v + r_u × r_vv.
            let (a, c) = match dir {
                Dir::U => (b[jet_index(2, 0)], b[jet_index(1, 1)]),
                Dir::V => (b[jet_index(1, 1)], b[jet_index(0, 2)]),
            };
            a.cross(b[2]) + b[1].cross(c)
        };
        let nonzero = |b: Box3| b.norm().lo > 0.0;
        let domain = surface.domain();
        let touched: Vec<Side> = collapsed
            .iter()
            .copied()
            .filter(|s| {
                let (own, all) = (self.uv[s.across() as usize], domain[s.across() as usize]);
                if s.is_upper() {
                    own.hi >= all.hi
                } else {
                    own.lo <= all.lo
                }
            })
            .collect();
        if let [side] = touched[..] {
            return nonzero(across(&over, side.across()));
        }
        let m = self.uv.map(Interval::mid);
        let mut at = [Box3::ENTIRE; jet_len(1)];
        surface.enclose_piece(m.map(Interval::point), limit, 1, &mut at);
        let [hu, hv] = [0, 1].map(|k| self.uv[k] - Interval::point(m[k]));
        let n =
            at[1].cross(at[2]) + across(&over, Dir::U).scale(hu) + across(&over, Dir::V).scale(hv);
        nonzero(n) || nonzero(over[1].cross(over[2]))
    }

    /// Both halves across the longer direction; `None` if the rectangle is narrow already.
    fn halves(&self) -> Option<[Patch; 2]> {
        let width = |k: usize| (self.uv[k].hi - self.uv[k].lo) / self.share[k];
        let k = usize::from(width(1) > width(0));
        let (t, m) = (self.uv[k], self.uv[k].mid());
        if width(k) < NARROW || m <= t.lo || m >= t.hi {
            return None;
        }
        let half = |t: Interval| {
            let mut p = *self;
            p.uv[k] = t;
            p
        };
        Some([half(Interval { hi: m, ..t }), half(Interval { lo: m, ..t })])
    }

    /// True if the normals around the rectangle point against each other. A fold may lie on its border: the places
    /// looked at are one width outside.
    fn folds(&self, surface: &dyn Surface) -> bool {
        let domain = surface.domain();
        let place = |k: usize, s: f64| {
            let (t, all) = (self.uv[k], domain[k]);
            (t.lo + (t.hi - t.lo) * s).clamp(all.lo, all.hi)
        };
        let n: Vec<DVec3> = [(-1.0, -1.0), (-1.0, 2.0), (2.0, -1.0), (2.0, 2.0)]
            .into_iter()
            .map(|(s, t)| normal(surface, [place(0, s), place(1, t)]))
            .collect();
        /// Cosine of the angle beyond which normals count as opposite.
        const OPPOSITE: f64 = -0.5;
        n.iter().any(|a| {
            n.iter()
                .any(|b| a.dot(*b) < OPPOSITE * a.length() * b.length())
        })
    }
}
