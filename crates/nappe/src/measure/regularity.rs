//! Where a surface is regular: collapsed sides, folds, and degenerate points.

use super::jump::JumpOptions;
use super::pinch::{Pinch, pinches};
use super::size;
use crate::box3::Box3;
use crate::breaks::Limit;
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
/// Normals shorter than this part of the longest are rounding errors: their directions say nothing.
const ROUNDING: f64 = 1e-13;
/// The most places reported of a kind.
const PLACES: usize = 16;

/// What is known about `n = r_u × r_v` over a whole surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Regularity {
    /// The sides that are one point (poles).
    pub collapsed: Vec<Side>,
    /// The lines inside that are one point: there the surface touches itself.
    pub pinches: Vec<Pinch>,
    /// True if it is proven that n vanishes nowhere but on collapsed sides and pinches, and that it vanishes there only to
    /// first order: the surface has a tangent plane everywhere (at a pole: along every line that leads into it).
    pub regular: bool,
    /// Places beside which n has opposite directions, or in a pinch the tangents along it: the surface folds over.
    pub folds: Vec<[f64; 2]>,
    /// Other places, not beside a pinch, where n could not be proven not to vanish: degenerate points, or too narrow to
    /// decide.
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
    let pinches = pinches(surface);
    let mut points: Vec<Line> = collapsed
        .iter()
        .map(|&s| (s.across(), Edge::new(surface, s).at))
        .collect();
    points.extend(pinches.iter().map(|p| (p.dir, p.at)));
    // The pieces, divided at lines that are one point.
    let pieces = [Dir::U, Dir::V].map(|dir| {
        let mut at: Vec<f64> = surface.breaks(dir).iter().map(|b| b.at).collect();
        at.extend(pinches.iter().filter(|p| p.dir == dir).map(|p| p.at));
        at.sort_by(f64::total_cmp);
        at.dedup();
        at
    });
    let mut boxes: VecDeque<Patch> = VecDeque::new();
    for u in pieces[0].windows(2) {
        for v in pieces[1].windows(2) {
            boxes.push_back(Patch {
                uv: [Interval::new(u[0], u[1]), Interval::new(v[0], v[1])],
                share: [u[1] - u[0], v[1] - v[0]],
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
        if b.excludes_zero(surface, &points) {
            continue;
        }
        match b.halves() {
            Some(halves) if seen + boxes.len() < budget => boxes.extend(halves),
            _ => left.push(b),
        }
    }
    let mut folds = Vec::new();
    for p in &pinches {
        folds.extend(turns_over(surface, p));
    }
    folds.truncate(PLACES);
    let mut degenerate = Vec::new();
    for b in &left {
        let list = if b.folds(surface, ROUNDING * most) {
            &mut folds
        } else if pinches.iter().any(|p| b.is_beside(p)) {
            continue;
        } else {
            &mut degenerate
        };
        if list.len() < PLACES {
            list.push(b.uv.map(Interval::mid));
        }
    }
    Regularity {
        collapsed,
        pinches,
        regular: left.is_empty() && folds.is_empty(),
        folds,
        degenerate,
        least: if most > 0.0 { least / most } else { 0.0 },
        at,
    }
}

/// A line of constant parameter: which, and its value.
type Line = (Dir, f64);

fn normal(surface: &dyn Surface, uv: [f64; 2]) -> DVec3 {
    let mut d = [DVec3::ZERO; jet_len(1)];
    surface.jet_into(uv, [Limit::Above; 2], 1, &mut d);
    d[1].cross(d[2])
}

/// Cosine of the angle beyond which directions count as opposite.
const OPPOSITE: f64 = -0.5;
/// How far from a pinch, relative to the domain, and at how many points both sides of it are looked at.
const BESIDE: f64 = 1e-4;
const POINTS: usize = 7;

/// The places of a pinch where the tangents along it are opposite before and behind it, as in the knot of a bow tie: the
/// surface turns over there.
fn turns_over(surface: &dyn Surface, pinch: &Pinch) -> Vec<[f64; 2]> {
    let (domain, d) = (surface.domain(), pinch.dir as usize);
    let place = |k: usize, step: f64| {
        let t = domain[1 - d].lo + domain[1 - d].width() * (k as f64 + 0.5) / POINTS as f64;
        let mut uv = [t; 2];
        uv[d] = pinch.at + step * domain[d].width();
        uv
    };
    let opposite = |k: &usize| {
        let tangent = |step| surface.jet(place(*k, step), [Limit::Above; 2], 1).d[2 - d];
        let [a, b] = [-BESIDE, BESIDE].map(tangent);
        a.dot(b) < OPPOSITE * a.length() * b.length()
    };
    (0..POINTS)
        .filter(opposite)
        .map(|k| place(k, 0.0))
        .collect()
}

/// A rectangle inside one analytic piece.
#[derive(Clone, Copy, Debug)]
struct Patch {
    uv: [Interval; 2],
    /// The widths of the piece, to compare those of the rectangle with.
    share: [f64; 2],
}

impl Patch {
    /// True if n is proven not to vanish here, or only on a line that is one point and to first order there.
    fn excludes_zero(&self, surface: &dyn Surface, points: &[Line]) -> bool {
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
        let mut touched = points
            .iter()
            .filter(|l| self.uv[l.0 as usize].contains(l.1));
        if let (Some(line), None) = (touched.next(), touched.next()) {
            return nonzero(across(&over, line.0));
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

    /// True if the rectangle is no farther from the line than it is wide.
    fn is_beside(&self, pinch: &Pinch) -> bool {
        let t = self.uv[pinch.dir as usize];
        t.inflate(t.width()).contains(pinch.at)
    }

    /// True if the normals around the rectangle that are longer than rounding errors point against each other. A fold may
    /// lie on its border: the places looked at are one width outside.
    fn folds(&self, surface: &dyn Surface, rounding: f64) -> bool {
        let domain = surface.domain();
        let place = |k: usize, s: f64| {
            let (t, all) = (self.uv[k], domain[k]);
            (t.lo + (t.hi - t.lo) * s).clamp(all.lo, all.hi)
        };
        let n: Vec<DVec3> = [(-1.0, -1.0), (-1.0, 2.0), (2.0, -1.0), (2.0, 2.0)]
            .into_iter()
            .map(|(s, t)| normal(surface, [place(0, s), place(1, t)]))
            .filter(|n| n.length() > rounding)
            .collect();
        n.iter().any(|a| {
            n.iter()
                .any(|b| a.dot(*b) < OPPOSITE * a.length() * b.length())
        })
    }
}
