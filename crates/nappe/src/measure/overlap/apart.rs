//! Proofs that two rectangles of parameters have no points in common but those they are meant to share.
//!
//! All of them find a unit vector `f` with a positive product with every vector of some boxes. Let `c, d, … ≥ 0`.
//!
//! **Far apart.** The ranges of `f·r` over both rectangles are disjoint.
//!
//! **Beside each other on one surface**, with a common side, corner or all in common. A path from p to q that first stays
//! in the one and then in the other rectangle, and along which u and v are monotone, gives `r(q) - r(p) = A + B`, with
//! `±A = Σ aᵢcᵢ`, `aᵢ` means of `r_u` over parts of the path in either rectangle, and `±B = Σ bⱼdⱼ` of `r_v` likewise. If
//! `f·(aᵢ × bⱼ) > 0` for all, `f·(A × B) = ± Σ cᵢdⱼ f·(aᵢ × bⱼ)`; so `A + B = 0` only if A or B has no terms, and then
//! neither has: different parameters have different points, but for those of a pole. This applies to two rectangles of a
//! larger one as well.
//!
//! **Across a shared side** `e`, or a crease, for rectangles that reach to it or are grown so far. With `bₚ`, `b_q` means of the inward tangents across the side and T a mean
//! of `e'`: `r(p) - r(q) = T s + bₚ c - b_q d + j` with the gap `|j| ≤ g`. Where the points are the same, the cross product
//! with T is `(T × bₚ) c - (T × b_q) d = -T × j`; if `f·(T × bₚ) > 0 > f·(T × b_q)` for all T, bₚ, b_q, then c and d are
//! at most `|T| g` over the least product. This holds for every angle between the surfaces but 0: f is square to the
//! bisector.
//!
//! **On two sides of a plane**, but for rounding: surfaces that touch. This is told from being apart.
//!
//! **Around a shared corner or pole**: `r(p) = P + Σ aᵢcᵢ`, `r(q) = P + Σ bⱼdⱼ + j` with the inward tangents; if `f·aᵢ > 0 >
//! f·bⱼ`, points are the same only where all `cᵢ`, `dⱼ` are at most g over the least product.

use super::links::{Links, Place, Seam};
use super::tree::{Line, Node, Tree};
use crate::box3::Box3;
use crate::interval::Interval;
use crate::surface::{Side, jet_index};
use glam::DVec3;
use smallvec::SmallVec;

/// Steps towards the vector with the greatest least product: for the few boxes here more gain nothing.
const STEPS: usize = 24;

/// Boxes of vectors; a few.
type Vectors = SmallVec<[Box3; 4]>;

/// True if the nodes are proven to have nothing in common but what is within `contact` of a shared side or corner.
pub(super) fn apart(trees: [&Tree; 2], x: &Node, y: &Node, links: &Links, contact: f64) -> bool {
    if !x.bounds.touches(y.bounds) {
        return true;
    }
    let between = (x.bounds.mid() - y.bounds.mid()).try_normalize();
    if [x.normal, y.normal, between]
        .into_iter()
        .flatten()
        .any(|f| x.range(f).intersection(y.range(f)).is_none())
    {
        return true;
    }
    (links.is_self && (x.touches(y) && beside(x, y) || inside(trees[0], x, y)))
        || links.seams.iter().any(|s| {
            across(trees, [x, y], s, contact)
                || (links.is_self && across(trees, [y, x], s, contact))
        })
        || links.places.iter().any(|p| {
            around(trees, [x, y], p, contact)
                || (links.is_self && around(trees, [y, x], p, contact))
        })
}

/// True if a plane has one node on either side, but for `slack`: the nodes touch at most. Where both lie in the plane they
/// may have an area in common: that is not told.
pub(super) fn touch(trees: [&Tree; 2], x: &Node, y: &Node, slack: f64) -> bool {
    let sides = |a: Interval, b: Interval| {
        (a.hi - b.lo <= slack || b.hi - a.lo <= slack) && a.width().max(b.width()) > 2.0 * slack
    };
    let (p, q) = (x.bounds.to_array(), y.bounds.to_array());
    (0..3).any(|k| sides(p[k], q[k]))
        || [x.normal, y.normal]
            .into_iter()
            .flatten()
            .any(|f| sides(x.range(f), y.range(f)))
        || rests(x, trees[1], y, slack)
        || rests(y, trees[0], x, slack)
}

/// True if `x` is flat, and `y` has a side in its plane and rises from it to one side only. With the distance c from the
/// side the height over the plane is `h + h' c + h'' c²/2`, h and h' being those at the side and h'' a mean: an enclosure
/// over all of `y` would not be sharp enough where the side is tangent to the plane.
fn rests(x: &Node, tree: &Tree, y: &Node, slack: f64) -> bool {
    let Some(f) = x.normal else { return false };
    let plane = x.range(f);
    if plane.width() > slack {
        return false;
    }
    let normal = Box3::point(f);
    Side::ALL.into_iter().any(|side| {
        let Line { across: d, at } = Line::side(tree.surface, side);
        if y.uv[d].lo != at && y.uv[d].hi != at {
            return false;
        }
        let mut line = y.uv;
        line[d] = Interval::point(at);
        let beside = tree.surface.enclose(line, 1);
        let height = normal.dot(beside[0]) - plane;
        if height.mag() > slack {
            return false;
        }
        let bent = tree.surface.enclose(y.uv, 2)[jet_index(2 - 2 * d, 2 * d)];
        let c = y.uv[d] - Interval::point(at);
        let half = Interval::point(0.5);
        let rise = height + normal.dot(beside[1 + d]) * c + normal.dot(bent) * c.sqr() * half;
        (rise.lo >= -2.0 * slack || rise.hi <= 2.0 * slack) && rise.width() > 4.0 * slack
    })
}

fn beside(x: &Node, y: &Node) -> bool {
    let products: Vectors = [x, y]
        .iter()
        .flat_map(|a| [x, y].map(|b| a.along[0].cross(b.along[1])))
        .collect();
    half_space(&products).is_some()
}

/// Both are in one rectangle whose points are all different.
fn inside(tree: &Tree, x: &Node, y: &Node) -> bool {
    let both = [0, 1].map(|d| x.uv[d].hull(y.uv[d]));
    // A rectangle that is that of one of them was looked at already. Where the proof fails for the tangents of both it
    // fails for those of a larger rectangle, which would have to be enclosed first.
    !(both == x.uv || both == y.uv)
        && beside(x, y)
        && tree
            .grow(if x.size() > y.size() { x } else { y }, both)
            .is_some_and(|z| beside(&z, &z))
}

fn across(trees: [&Tree; 2], [x, y]: [&Node; 2], seam: &Seam, contact: f64) -> bool {
    let [first, second] = &seam.borders;
    let (Some(p), Some(q)) = (first.reach(x.uv), second.reach(y.uv)) else {
        return false;
    };
    if !(trees[0].grows(x, p) && trees[1].grows(y, q)) {
        return false;
    }
    let Some(range) = seam.back(y.uv[1 - second.across]) else {
        return false;
    };
    let tangent = seam.tangent(trees[0].surface, range.hull(x.uv[1 - first.across]));
    let sets = |inward: [Box3; 2]| [tangent.cross(inward[0]), inward[1].cross(tangent)];
    // What fails without growing fails with larger sets.
    if half_space(&sets([first.inward(x), second.inward(y)])).is_none() {
        return false;
    }
    let (Some(x), Some(y)) = (trees[0].grow(x, p), trees[1].grow(y, q)) else {
        return false;
    };
    let inward = [first.inward(&x), second.inward(&y)];
    let Some((_, least)) = half_space(&sets(inward)) else {
        return false;
    };
    let gap = tangent.norm() * Interval::point(seam.gap);
    (0..2).all(|k| reach(inward[k], least[k], gap) <= contact)
}

fn around(trees: [&Tree; 2], [x, y]: [&Node; 2], [p, q]: &[Place; 2], contact: f64) -> bool {
    let (Some(x), Some(y)) = (
        p.reach(x.uv).and_then(|uv| trees[0].grow(x, uv)),
        q.reach(y.uv).and_then(|uv| trees[1].grow(y, uv)),
    ) else {
        return false;
    };
    let minus = Interval::point(-1.0);
    let away = q.inward(&y).into_iter().map(|v| v.scale(minus));
    let sets: Vectors = p.inward(&x).into_iter().chain(away).collect();
    let gap = (Box3::point(p.point) - Box3::point(q.point)).norm();
    half_space(&sets).is_some_and(|(_, least)| {
        sets.iter()
            .zip(&least)
            .all(|(&v, &l)| reach(v, l, gap) <= contact)
    })
}

/// How far from what is shared a common point may lie: `|v| c` with `c ≤ gap / least`.
fn reach(v: Box3, least: f64, gap: Interval) -> f64 {
    (v.norm() * gap / Interval::point(least)).hi
}

/// A unit vector (within rounding) that has positive products with all vectors of all sets, and the least product for
/// each set: the point next to 0 in the hull of the middles, by the method of Frank and Wolfe.
fn half_space(sets: &[Box3]) -> Option<(DVec3, SmallVec<[f64; 4]>)> {
    let units: SmallVec<[DVec3; 4]> = sets
        .iter()
        .map(|s| s.is_finite().then(|| s.mid().try_normalize()).flatten())
        .collect::<Option<_>>()?;
    let mut f = units.iter().sum::<DVec3>() / units.len() as f64;
    for _ in 0..STEPS {
        let worst = units
            .iter()
            .copied()
            .min_by(|a, b| f.dot(*a).total_cmp(&f.dot(*b)))?;
        let step = worst - f;
        let share = -f.dot(step) / step.length_squared();
        if share.is_nan() || share <= 0.0 {
            break;
        }
        f += step * share.min(1.0);
    }
    let f = f.try_normalize()?;
    let least: SmallVec<[f64; 4]> = sets.iter().map(|&s| Box3::point(f).dot(s).lo).collect();
    least.iter().all(|&l| l > 0.0).then_some((f, least))
}
