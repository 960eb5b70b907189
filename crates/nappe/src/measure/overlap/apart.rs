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
//! **Around a shared corner or pole**: `r(p) = P + Σ aᵢcᵢ`, `r(q) = P + Σ bⱼdⱼ + j` with the inward tangents; if `f·aᵢ > 0 >
//! f·bⱼ`, points are the same only where all `cᵢ`, `dⱼ` are at most g over the least product.

use super::links::{Links, Place, Seam};
use super::tree::{Node, Tree};
use crate::box3::Box3;
use crate::interval::Interval;
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
    // A rectangle that is that of one of them was looked at already.
    !(both == x.uv || both == y.uv)
        && tree
            .grow(if x.size() > y.size() { x } else { y }, both)
            .is_some_and(|z| beside(&z, &z))
}

fn across(trees: [&Tree; 2], [x, y]: [&Node; 2], seam: &Seam, contact: f64) -> bool {
    let [first, second] = &seam.borders;
    let (Some(x), Some(y)) = (
        first.reach(x.uv).and_then(|uv| trees[0].grow(x, uv)),
        second.reach(y.uv).and_then(|uv| trees[1].grow(y, uv)),
    ) else {
        return false;
    };
    let Some(range) = seam.back(y.uv[1 - second.across]) else {
        return false;
    };
    let tangent = seam.tangent(trees[0].surface, range.hull(x.uv[1 - first.across]));
    let inward = [first.inward(&x), second.inward(&y)];
    let sets = [tangent.cross(inward[0]), inward[1].cross(tangent)];
    let Some((_, least)) = half_space(&sets) else {
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
