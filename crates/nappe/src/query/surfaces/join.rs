//! Strands of all pairs of rectangles joined into branches: across creases, and across seams, where two sides of a surface are
//! one curve.

use super::follow::{End, Strand};
use super::pair::{Pair, Place};
use super::parts::ON_SIDE;
use super::step::Part4;
use crate::box3::Box3;
use crate::interval::Interval;
use crate::query::seams::in_a_row;
use crate::query::trace::BranchEnd;
use glam::DVec3;

/// Parameters nearer than this, relative to the domain, are the same.
const SAME: f64 = 1e-7;
/// Points nearer than this, relative to the size, are the same.
const SAME_POINT: f64 = 1e-8;

/// A strand with the number of its pair of rectangles.
pub(super) struct Piece {
    pub(super) strand: Strand,
    pub(super) pair: usize,
    /// What its ends are, for the result.
    pub(super) ends: Option<[BranchEnd; 2]>,
}

/// Strands one after the other.
pub(super) struct Joined {
    pub(super) parts: Vec<Part4>,
    pub(super) ends: Option<[BranchEnd; 2]>,
    pub(super) error: f64,
}

/// Joins what belongs together; of strands that run along a crease or a seam on both sides one is kept.
pub(super) fn joined(
    pieces: &[Piece],
    pairs: &[Pair],
    domain: [Interval; 4],
    size: f64,
    tol: f64,
) -> Vec<Joined> {
    let near_point = SAME_POINT * size;
    let point = |k: usize, x: Place| pairs[pieces[k].pair].point(x);
    let near = |a: f64, b: f64, j: usize| (a - b).abs() <= SAME * domain[j].width();
    let end = |k: usize, e: usize| match pieces[k].strand.ends {
        Some(ends) => match ends[e] {
            End::Side(knot) => Some(knot.x),
            End::Stuck(_) => None,
        },
        None => None,
    };
    // On each surface the same parameters, or both on sides of the domain: the points agree.
    let on_sides = |x: &Place, n: usize| {
        (2 * n..2 * n + 2).any(|j| near(x[j], domain[j].lo, j) || near(x[j], domain[j].hi, j))
    };
    let same = |x: &Place, y: &Place| {
        (0..2).all(|n| {
            (2 * n..2 * n + 2).all(|j| near(x[j], y[j], j)) || (on_sides(x, n) && on_sides(y, n))
        })
    };
    let direction = |k: usize, e: usize| {
        let parts = &pieces[k].strand.parts;
        let p = if e == 0 { parts.first() } else { parts.last() };
        p.map(|p| {
            let [a, b] = if e == 0 { [0, 1] } else { [2, 3] };
            point(k, p.points[b]) - point(k, p.points[a])
        })
    };
    let gone: Vec<bool> = (0..pieces.len())
        .map(|k| is_double(k, pieces, pairs, near_point, ON_SIDE * tol))
        .collect();
    let mut next = vec![None; pieces.len()];
    let mut taken = vec![false; pieces.len()];
    let kept = |k: &usize| !gone[*k];
    for k in (0..pieces.len()).filter(kept) {
        let Some(x) = end(k, 1) else { continue };
        let p = point(k, x);
        let follows = |&j: &usize| {
            let Some(y) = end(j, 0) else { return false };
            let agree = match (direction(k, 1), direction(j, 0)) {
                (Some(a), Some(b)) => a.dot(b) > 0.0,
                _ => false,
            };
            same(&x, &y) && agree && point(j, y).distance(p) <= near_point
        };
        let mut found = (0..pieces.len()).filter(kept).filter(follows);
        if let (Some(j), None) = (found.next(), found.next())
            && !taken[j]
        {
            taken[j] = true;
            next[k] = Some(j);
        }
    }
    let lists = in_a_row(&next, gone);
    let join = |(list, closed): (Vec<usize>, bool)| {
        let mut parts: Vec<Part4> = Vec::new();
        for &k in &list {
            let begin = parts.len();
            parts.extend_from_slice(&pieces[k].strand.parts);
            if let Some(first) = parts.get_mut(begin).filter(|_| begin > 0) {
                first.smooth = false;
            }
        }
        let [first, last] = [list[0], list[list.len() - 1]].map(|k| pieces[k].ends);
        Joined {
            parts,
            ends: match (first, last) {
                (Some(first), Some(last)) if !closed => Some([first[0], last[1]]),
                _ => None,
            },
            error: list
                .iter()
                .map(|&k| pieces[k].strand.error)
                .fold(0.0, f64::max),
        }
    };
    lists.into_iter().map(join).collect()
}

/// True if a strand runs along a side of its rectangle, and a longer or earlier one runs along a side there too, all the way:
/// the ends and the middle of each part lie on it, within the errors of both and a rounding error `near`. Its ends may
/// lie farther away by `beyond`, by which rectangles reach over their sides.
fn is_double(k: usize, pieces: &[Piece], pairs: &[Pair], near: f64, beyond: f64) -> bool {
    let along = |k: usize| {
        let rect = pairs[pieces[k].pair].rect;
        let points = || pieces[k].strand.parts.iter().flat_map(|p| p.points);
        (0..4).any(|j| {
            let on = |at: f64| points().all(|x| (x[j] - at).abs() <= SAME * rect[j].width());
            on(rect[j].lo) || on(rect[j].hi)
        })
    };
    if pieces[k].strand.parts.is_empty() || !along(k) {
        return false;
    }
    let point = |k: usize, x: Place| pairs[pieces[k].pair].point(x);
    let chords = |k: usize| {
        let parts = &pieces[k].strand.parts;
        parts
            .iter()
            .map(move |p| [p.points[0], p.points[3]].map(|x| point(k, x)))
    };
    let runs_there = |j: usize| {
        let near = near + pieces[k].strand.error + pieces[j].strand.error;
        // Between samples an arc leaves them by less than the longest step.
        let others: Vec<(&Part4, Box3)> = pieces[j]
            .strand
            .parts
            .iter()
            .map(|part| {
                let points = (0..=8).map(|i| point(j, part.at(f64::from(i) / 8.0)));
                let points: Vec<DVec3> = points.collect();
                let step = points.windows(2).map(|p| p[0].distance(p[1]));
                let around = Box3::around(points.iter().copied()).unwrap_or(Box3::ENTIRE);
                (part, around.inflate(step.fold(near + beyond, f64::max)))
            })
            .collect();
        let on = |x: Place, near: f64| {
            let p = point(k, x);
            others.iter().any(|(part, around)| {
                let distance = |t: f64| point(j, part.at(t)).distance(p);
                around.contains(p) && nearest(&distance) <= near
            })
        };
        let parts = &pieces[k].strand.parts;
        let last = parts.len().saturating_sub(1);
        parts.iter().enumerate().all(|(i, part)| {
            let at = |end: bool| if end { near + beyond } else { near };
            on(part.at(0.5), near)
                && on(part.points[0], at(i == 0))
                && on(part.points[3], at(i == last))
        })
    };
    let reach = |k: usize| chords(k).map(|[a, b]| a.distance(b)).sum::<f64>();
    (0..pieces.len()).any(|j| {
        j != k && along(j) && runs_there(j) && {
            let (own, other) = (reach(k), reach(j));
            other > own * (1.0 + 1e-3) || (other >= own * (1.0 - 1e-3) && j < k)
        }
    })
}

/// About the least value of a function over [0, 1] that has few minima there.
fn nearest(f: &dyn Fn(f64) -> f64) -> f64 {
    const SAMPLES: usize = 8;
    let at = |k: usize| k as f64 / SAMPLES as f64;
    let best = (0..=SAMPLES).min_by(|&a, &b| f(at(a)).total_cmp(&f(at(b))));
    let middle = at(best.unwrap_or(0));
    let (mut lo, mut hi) = ((middle - at(1)).max(0.0), (middle + at(1)).min(1.0));
    for _ in 0..50 {
        let [a, b] = [lo + 0.4 * (hi - lo), lo + 0.6 * (hi - lo)];
        if f(a) < f(b) {
            hi = b;
        } else {
            lo = a;
        }
    }
    f(0.5 * (lo + hi))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::surface::{SurfaceRef, bilinear};
    use std::array::from_fn;
    use std::sync::Arc;

    /// A piece straight from one place to another on a square, in so many parts.
    fn piece(from: [f64; 2], to: [f64; 2], parts: usize) -> Piece {
        let at = |t: f64| {
            let [u, v] = from_fn(|k| from[k] + t * (to[k] - from[k]));
            [u, v, u, v]
        };
        let part = |i: usize| Part4 {
            points: from_fn(|k| at((i as f64 + k as f64 / 3.0) / parts as f64)),
            length: 1.0,
            smooth: true,
        };
        Piece {
            strand: Strand {
                parts: (0..parts).map(part).collect(),
                ends: None,
                error: 0.0,
                covers: Vec::new(),
            },
            pair: 0,
            ends: None,
        }
    }

    #[test]
    fn a_strand_is_dropped_only_if_all_of_it_runs_on_another() {
        let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let square: SurfaceRef = Arc::new(
            bilinear([
                [corner(0.0, 0.0), corner(0.0, 1.0)],
                [corner(1.0, 0.0), corner(1.0, 1.0)],
            ])
            .unwrap(),
        );
        let unit = [Interval { lo: 0.0, hi: 1.0 }; 4];
        let pairs = [Pair {
            surfaces: [square.clone(), square],
            rect: unit,
            outer: unit,
            size: 1.0,
        }];
        let double = |pieces: [Piece; 2]| is_double(0, &pieces, &pairs, 1e-8, 0.25e-6);
        let south = || piece([0.0, 0.0], [1.0, 0.0], 3);
        // From the same corner along another side, in one part: the place where it begins lies on both.
        assert!(!double([piece([0.0, 0.0], [0.0, 0.3], 1), south()]));
        // It goes on beyond the other one.
        let half = || piece([0.0, 0.0], [0.5, 0.0], 1);
        assert!(!double([piece([0.4, 0.0], [0.55, 0.0], 4), half()]));
        assert!(!double([south(), half()]));
        // All of it is there, in either direction.
        assert!(double([piece([0.2, 0.0], [0.5, 0.0], 2), south()]));
        assert!(double([piece([0.5, 0.0], [0.0, 0.0], 1), south()]));
        // Of two that are the same the first stays.
        assert!(!double([south(), south()]));
        assert!(!double([half(), piece([0.0, 1e-3], [1.0, 1e-3], 2)]));
    }
}
