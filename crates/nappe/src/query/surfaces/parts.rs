//! The parts of two surfaces between creases, and which of them may meet.

use super::pair::{Box4, Pair};
use crate::box3::Box3;
use crate::breaks::Breaks;
use crate::interval::Interval;
use crate::query::extended::MARGIN;
use crate::surface::{Dir, SurfaceRef, enclose_direct};
use std::array::from_fn;

/// Curves beyond a side by less than this part of the tolerance count as on it.
pub(super) const ON_SIDE: f64 = 0.25;

/// A part of a surface without a crease inside.
struct Rect {
    uv: [Interval; 2],
    over: Box3,
    /// The greatest lengths of the tangents.
    stretch: [f64; 2],
}

/// The parts of both surfaces between creases whose boxes touch.
pub(super) struct Pairs {
    /// As many as there may be.
    pub(super) pairs: Vec<Pair>,
    /// A box of parameters around all others.
    pub(super) rest: Option<Box4>,
}

/// Finds the parts of both surfaces between creases whose boxes touch, `most` of them at most. `smaller` is the size of the
/// smaller surface. Cost: the parts of the second surface are sorted, and for each one of the first those abreast are looked at.
pub(super) fn pairs(surfaces: [&SurfaceRef; 2], tol: f64, smaller: f64, most: usize) -> Pairs {
    let parts = surfaces.map(rects);
    // Sides count with what is a rounding error beyond them.
    let room = MARGIN * smaller + ON_SIDE * tol;
    let axis = longest(&parts[1]);
    let along = |r: &Rect| range(r.over, axis);
    let mut order: Vec<usize> = (0..parts[1].len()).collect();
    order.sort_by(|&i, &j| along(&parts[1][i]).lo.total_cmp(&along(&parts[1][j]).lo));
    let widest = parts[1]
        .iter()
        .map(|q| along(q).width())
        .fold(0.0, f64::max);
    let mut out = Pairs {
        pairs: Vec::new(),
        rest: None,
    };
    for p in &parts[0] {
        let inflated = p.over.inflate(room);
        let Interval { lo, hi } = range(inflated, axis);
        // A little more than the widest: widths are rounded.
        let begin = lo - widest * (1.0 + 1e-12);
        let first = order.partition_point(|&k| along(&parts[1][k]).lo < begin);
        let abreast = order[first..].iter();
        let mut near: Vec<usize> = abreast
            .copied()
            .take_while(|&k| along(&parts[1][k]).lo <= hi)
            .filter(|&k| inflated.touches(parts[1][k].over))
            .collect();
        near.sort_unstable();
        for q in near.into_iter().map(|k| &parts[1][k]) {
            if out.pairs.len() < most {
                out.pairs.push(pair(surfaces, [p, q], tol, smaller));
                continue;
            }
            let rect = [p.uv[0], p.uv[1], q.uv[0], q.uv[1]];
            out.rest = Some(match out.rest {
                Some(rest) => from_fn(|j| rest[j].hull(rect[j])),
                None => rect,
            });
        }
    }
    out
}

/// The parts of a surface, row by row.
fn rects(surface: &SurfaceRef) -> Vec<Rect> {
    let ranges = [Dir::U, Dir::V].map(|dir| {
        let breaks = surface.breaks(dir);
        let mut at = breaks.below(1);
        let domain = breaks.domain();
        at.insert(0, domain.lo);
        at.push(domain.hi);
        at.windows(2)
            .map(|w| Interval { lo: w[0], hi: w[1] })
            .collect::<Vec<_>>()
    });
    let mut rects = Vec::with_capacity(ranges[0].len() * ranges[1].len());
    for &u in &ranges[0] {
        for &v in &ranges[1] {
            let j = enclose_direct(surface.as_ref(), [u, v], 1);
            rects.push(Rect {
                uv: [u, v],
                over: surface.bounds([u, v]),
                stretch: [j[1], j[2]].map(|t| t.norm().hi),
            });
        }
    }
    rects
}

/// The side of a box along an axis.
fn range(b: Box3, axis: usize) -> Interval {
    [b.x, b.y, b.z][axis]
}

/// The axis along which parts are least abreast: that of the longest side of the box around them all, in units of the mean
/// of theirs.
fn longest(parts: &[Rect]) -> usize {
    let share = |axis: usize| {
        let all = parts
            .iter()
            .map(|r| range(r.over, axis))
            .reduce(Interval::hull);
        let sum: f64 = parts.iter().map(|r| range(r.over, axis).width()).sum();
        let share = all.map_or(0.0, Interval::width) / sum;
        if share.is_nan() { 0.0 } else { share }
    };
    (0..3)
        .max_by(|&i, &j| share(i).total_cmp(&share(j)))
        .unwrap_or(0)
}

/// Two parts as the search takes them.
fn pair(surfaces: [&SurfaceRef; 2], [p, q]: [&Rect; 2], tol: f64, smaller: f64) -> Pair {
    let rect = [p.uv[0], p.uv[1], q.uv[0], q.uv[1]];
    let stretch = [p.stretch[0], p.stretch[1], q.stretch[0], q.stretch[1]];
    let outer = from_fn(|j| {
        let w = rect[j].width();
        let side = ON_SIDE * tol / stretch[j];
        let side = if side.is_finite() { side } else { 0.0 };
        rect[j].inflate(side.clamp(2.0 * MARGIN * w, w / 1024.0))
    });
    let diagonal = p.over.diagonal().min(q.over.diagonal());
    Pair {
        surfaces: surfaces.map(SurfaceRef::clone),
        rect,
        outer,
        size: if diagonal > 0.0 && diagonal.is_finite() {
            diagonal.min(2.0 * smaller)
        } else {
            smaller
        },
    }
}
