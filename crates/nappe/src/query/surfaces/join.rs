//! Strands of all pairs of rectangles joined into branches: across creases, and across seams, where two sides of a surface are
//! one curve.

use super::follow::{End, Strand};
use super::pair::{Pair, Place};
use super::step::Part4;
use crate::interval::Interval;
use crate::query::seams::in_a_row;
use crate::query::trace::BranchEnd;

/// Parameters nearer than this, relative to the domain, are the same.
const SAME: f64 = 1e-7;
/// Points nearer than this, relative to the size, are the same.
const SAME_POINT: f64 = 1e-8;
/// Places of a strand at which it is seen whether another one runs there too.
const PLACES: usize = 7;

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
        .map(|k| is_double(k, pieces, pairs, near_point))
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

/// True if a strand runs along a side of its rectangle, and an earlier one runs along a side there too.
fn is_double(k: usize, pieces: &[Piece], pairs: &[Pair], near: f64) -> bool {
    let along = |k: usize| {
        let rect = pairs[pieces[k].pair].rect;
        let points = || pieces[k].strand.parts.iter().flat_map(|p| p.points);
        (0..4).any(|j| {
            let on = |at: f64| points().all(|x| (x[j] - at).abs() <= SAME * rect[j].width());
            on(rect[j].lo) || on(rect[j].hi)
        })
    };
    if pieces.is_empty() || !along(k) {
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
        let parts = &pieces[k].strand.parts;
        let step = parts.len().div_ceil(PLACES);
        let mut places = parts.iter().step_by(step).map(|p| p.points[0]);
        places.all(|x| {
            let p = point(k, x);
            let others = &pieces[j].strand.parts;
            others.iter().any(|part| {
                let distance = |t: f64| point(j, part.at(t)).distance(p);
                nearest(&distance) <= near
            })
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
