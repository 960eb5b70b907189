//! How far the triangles of one square of the quadtree are from the surface: partners beside each other.
//!
//! Let `L` be linear on each triangle and equal to the surface `r` at the corners, `e = L - r`. A point `L(p)` of the mesh
//! has its partner on the surface at parameters `p + d(p)`. By Taylor's formula
//!
//! `|r(p + d) - L(p)| ≤ |J d - e(p)| + ½ sup |D²r[d, d]|`, `J = [r_u r_v]` at `p`,
//!
//! so `d` should take away what of `e` lies in the tangent plane; it is small of second order, and what it adds of fourth.
//! In each square that the triangulation does not cut through, one of these is taken:
//!
//! - *inside*: with a frame whose z is about normal, `N = r_u × r_v` and `J d = e` in x and y there remains `|N·e| / N_z`;
//! - *at a side* `v = const` of the domain: `d` along u so that `J d = e` in x, which is about along `r_u`. There remain
//!   y and z of `e - r_u e_x / r_u,x`. Likewise at a side `u = const`;
//! - *beside a side* of one analytic piece: as inside, but held back where that would leave or leave the side (`parts`);
//! - *anywhere*: `d = 0`. There remains `|e|`.
//!
//! **Theorem.** Let τ be at least what remains with what is added, in all squares, and `p + d` in the domain. Then every
//! point of the mesh is within τ of the surface. If in every square with `d ≠ 0` also
//! `½ sup |D²r[w, w]| ≤ α` for all `w` with `|J w| ≤ τ`, then every point of the surface is within `τ + α` of the mesh.
//!
//! *Proof.* The first is what was said. Now let `F(p)` be `{p + d(p)}`; on the common edge of two triangles, of two squares
//! or of one, for which partners are chosen differently (at its ends `e = 0` and `d = 0`) the segment between both choices
//! `p + d_1` and `p + d_2`. It lies in the surroundings of the larger square, or of the one with `d ≠ 0` if the other has
//! `d = 0`. As `|J d_i - e| ≤ τ`, half of `d_1 - d_2` is such a `w`, and the surface over the segment leaves its chord by at
//! most `⅛ sup |D²r[2w, 2w]| ≤ α`. `F` is upper semicontinuous with convex values, and maps every side of the domain into
//! itself, since there partners slide along it. So it has continuous selections as near to its graph as we like (Cellina),
//! of degree 1 on the border; they reach every parameter, and in the limit `F` does. ∎
//!
//! The components of `e` are bounded as those of any function by its second derivatives `Q` (`bound`): for a corner `p_i`
//! of a triangle and `p = Σ λ_i p_i`, `e_c(p) = ½ Σ λ_i Q_i[p_i - p]` with `Q_i` a mean over a segment. If `Q` were one
//! positive semidefinite form, this is largest for the triangle itself among all triangles in it, by Jensen's inequality:
//! an eighth of the longest side, or half the squared radius of the circle around it, in the measure of `Q`. The middle of
//! the enclosure is a difference of two such forms; the rest is bounded by Popoviciu's inequality, also for all triangles
//! inside. So further bisections and further vertices on sides need no other proof.
//!
//! Inside a square in one analytic piece, `Q` is a form Q₀ in the middle, a linear part C, and a rest that is bounded like
//! above. About the middle m of a triangle's longest side, C adds the constant form `C m` and a function of third order,
//! whose error of interpolation is known (`CUBE`, `MIXED`). So the linear part counts with the distance of m alone, which is
//! zero for the two triangles of a square. Smaller triangles may have larger m: the bound is the greatest for all of them.
//! Further vertices on sides do not get there.
//!
//! Where a side is one point `P`, triangles with two corners there vanish. Those with one are covered by rays from it: let
//! a ray at `p` end at height `v` in the opposite edge; the surface leaves its chord along the ray by at most
//! `⅛ sup|r_vv| v²`, and the end by the bound of an edge. This is `d = 0` with other parameters of the same mesh.

use super::bound::ROUND_UP;
use super::parts::Parts;
use super::pieces::Jet;
use super::slide::{NEGLIGIBLE, Tip, frame, tip};
use crate::ball::{Ball, Ball3};
use crate::box3::Box3;
use crate::interval::{Interval, greater};
use crate::simd::{Lanes, Plain, QUAD, Registers, Single};
use crate::surface::Surface;
use glam::DMat3;
use smallvec::{SmallVec, smallvec};
use std::ops::{Add, Mul};

/// Squares of smaller numbers than this would lose digits.
const SMALLEST: f64 = 1e-140;
/// The neighbourhood of a square in which partners are looked for, as a share of its size.
const ROOM: f64 = 1.0 / 16.0;
/// The greatest share of the tolerance for what partners add, and for points between the partners of different squares.
pub(super) const BETWEEN: f64 = 1.0 / 8.0;

/// A bound for the triangles that are `L = 2 k` times (index 0) or `L = 2 k + 1` times (1) bisected, with `q = 1 / 2^k`:
/// `q² (error + skew + cubic q) + added q⁴ + shift`, if `slip q² ≤ 1`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Bound {
    pub(super) error: [f64; 2],
    /// What the linear change of second derivatives along u and along v adds at the border of the square.
    pub(super) skew: [[f64; 2]; 2],
    pub(super) cubic: f64,
    pub(super) added: [f64; 2],
    pub(super) slip: [f64; 2],
    /// What is lost whatever the triangles.
    pub(super) shift: f64,
}

impl Bound {
    /// The bound after some bisections; `None` if partners are too far away for it.
    pub(super) fn deviation(&self, level: u32, grain: f64, tol: f64) -> Option<f64> {
        let odd = level as usize % 2;
        let q = share(level) + grain;
        let added = self.added[odd] * (q * q * q * q);
        // Smaller triangles may be nearer to where second derivatives are greater; from the second bisection on, they all
        // are.
        let here = self.linear(level, grain, 1.0 - share(level) + 4.0 * grain);
        let next = self.linear(level + 1, grain, 1.0 - share(level + 1) + 4.0 * grain);
        let all = self.linear(level + 2, grain, 1.0 + 4.0 * grain);
        let near = self.slip[odd] * q * q <= 1.0 && added <= BETWEEN * tol;
        near.then(|| (greatest_of([here, next, all]) + added + self.shift) * ROUND_UP)
    }

    /// For triangles with the middles of their longest sides that share of the way to the border.
    fn linear(&self, level: u32, grain: f64, away: f64) -> f64 {
        let (q, odd) = (share(level) + grain, level as usize % 2);
        let [u, v] = self.skew[odd];
        let skew = if odd == 0 {
            away * (u + v)
        } else {
            // Their longest sides lie on lines of smaller squares, perhaps on the border.
            greatest_of([u + away * v, away * u + v]) * (1.0 + 4.0 * grain)
        };
        q * q * (self.error[odd] + skew + self.cubic * q)
    }

    /// The fewest bisections that keep a tolerance, with the bound after these.
    pub(super) fn level(&self, tol: f64, grain: f64) -> Option<(u32, f64)> {
        if self.error.iter().any(|e| e.is_nan()) {
            return None;
        }
        (0..=2 * super::bisection::DEPTH).find_map(|level| {
            // Without the rest of the bound, most levels are out of the question.
            let q = share(level);
            if q * q * self.error[level as usize % 2] > tol {
                return None;
            }
            let deviation = self.deviation(level, grain, tol)?;
            (deviation <= tol).then_some((level, deviation))
        })
    }
}

/// The greatest of some numbers; NaN if one is none.
pub(super) fn greatest_of(all: impl IntoIterator<Item = f64>) -> f64 {
    all.into_iter().fold(0.0, greater)
}

/// The size of the triangles' legs, as a share of the square's, after an even number of bisections.
#[inline(always)]
pub(super) fn share(level: u32) -> f64 {
    // 2^-k, by its exponent.
    f64::from_bits((1023 - u64::from(level / 2)) << 52)
}

/// The second derivatives of a function along the sides of a rectangle: `uu Δu²`, `uv Δu Δv`, `vv Δv²`.
type Form = [Ball; 3];

/// The sides of the triangles that are an even and an odd number of times bisected, in units of the rectangle.
const SIDES: [[[[f64; 2]; 3]; 2]; 2] = [
    [
        [[1.0, 0.0], [0.0, 1.0], [1.0, -1.0]],
        [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]],
    ],
    [
        [[1.0, 0.0], [0.5, 0.5], [0.5, -0.5]],
        [[0.0, 1.0], [0.5, 0.5], [0.5, -0.5]],
    ],
];

/// The sum in Popoviciu's inequality for triangles that are an even and an odd number of times bisected.
#[inline(always)]
pub(super) fn rest<R: Registers>([uu, uv, vv]: [Lanes<R>; 3]) -> [Lanes<R>; 2] {
    [
        (uu + uv * 2.0 + vv) * 0.125,
        ((uu + uv + vv * 0.25) * 0.125).max((uu * 0.25 + uv + vv) * 0.125),
    ]
}

/// The greatest error of interpolation of some functions, for triangles that are an even and an odd number of times bisected:
/// that of the middles, and what the radii add.
fn errors<const N: usize>(forms: [Form; N]) -> [[f64; 2]; N] {
    let numbers = |of: fn(Ball) -> f64| {
        [0, 1, 2].map(|k| {
            let mut lanes = [0.0; QUAD];
            for (lane, form) in lanes.iter_mut().zip(&forms) {
                *lane = of(form[k]);
            }
            Lanes(Plain, lanes)
        })
    };
    let (middle, rest) = (middle(numbers(|q| q.mid)), rest(numbers(|q| q.rad)));
    std::array::from_fn(|lane| [0, 1].map(|k| middle[k].1[lane] + rest[k].1[lane]))
}

/// The greatest error of interpolation for constant second derivatives of several functions, for triangles that are an even
/// and an odd number of times bisected.
///
/// Of a semidefinite form it is an eighth of the longest side of both kinds of triangles, in the measure of the form: their
/// sides are p, q and p + q, or p, q and p - q. The longer of the last two is no shorter than `√(p² + q²)`, so its triangle
/// is right or obtuse, and has an eighth of its square. If the other is acute, with the angle θ between p and q, it has half
/// the squared radius of the circle around it, of the diameter `|p - q| / sin θ`; that is at most `|p + q|`, since
/// `cos θ (p² + q²) ≤ 2 |p| |q|` where the other angles are acute.
#[inline(always)]
pub(super) fn middle<R: Registers>([u, c, v]: [Lanes<R>; 3]) -> [Lanes<R>; 2] {
    let zero = Lanes::splat(u.0, 0.0);
    let (mean, deviator) = ((u + v) * 0.5, (u - v) * 0.5);
    let half = (deviator * deviator + c * c).sqrt();
    let (upper, lower) = (mean + half, mean - half);
    let mut worst = [zero; 2];
    for (worst, kinds) in worst.iter_mut().zip(SIDES) {
        for sides in kinds {
            let (mut longest, mut most, mut least) = (zero, zero, zero);
            for [x, y] in sides {
                longest = longest.max((u * (x * x) + c * (2.0 * x * y) + v * (y * y)).abs());
                // The projections on the eigenvectors: a half of the unit form and of the form without its mean.
                let unit = Lanes::splat(u.0, x * x + y * y);
                let turned = (deviator * (x * x - y * y) + c * (2.0 * x * y)) / half;
                most = most.max(unit + turned);
                least = least.max(unit - turned);
            }
            let opposite = (upper.abs() * most).max(lower.abs() * least) * 0.0625;
            let same = longest * 0.125;
            *worst = worst.max(zero.where_greater(upper * lower, [opposite, same]));
        }
    }
    worst
}

/// Quicker than what avoids overflow: beyond that there is no bound. What is lost below the smallest number is added.
pub(super) fn length2(x: f64, y: f64) -> f64 {
    (x * x + y * y + f64::MIN_POSITIVE).sqrt()
}

/// A rectangle with its surroundings.
pub(super) struct Place {
    pub(super) uv: [Interval; 2],
    /// The part of the surface without corners around it.
    pub(super) block: [Interval; 2],
    /// The sizes of the smallest squares of this depth here and beside: partners of smaller squares are not so far away
    /// that they leave the surroundings of larger ones.
    pub(super) least: [f64; 2],
}

impl Place {
    /// True if a side of the block is at the lower and at the upper end along a direction.
    pub(super) fn touches(&self, d: usize) -> [bool; 2] {
        let (r, b) = (self.uv[d], self.block[d]);
        [r.lo <= b.lo, r.hi >= b.hi]
    }

    /// True if no side of the block is along the square.
    pub(super) fn is_inside(&self) -> bool {
        (0..2).all(|d| self.touches(d) == [false; 2])
    }

    /// The rectangle in which partners are looked for.
    pub(super) fn surroundings(&self) -> [Interval; 2] {
        [0, 1].map(|d| {
            let r = self.uv[d];
            let room = ROOM * r.width();
            Interval {
                lo: (r.lo - room).max(self.block[d].lo),
                hi: (r.hi + room).min(self.block[d].hi),
            }
        })
    }

    /// How far partners may be away beyond the lower and the upper end along a direction, as shares of the size.
    pub(super) fn room(&self, d: usize) -> [f64; 2] {
        let (r, around) = (self.uv[d], self.surroundings()[d]);
        [r.lo - around.lo, around.hi - r.hi].map(|x| x.min(ROOM * self.least[d]) / r.width())
    }

    /// How far partners of what does not touch a side of the block may be away beyond its ends.
    pub(super) fn room_inside(&self, d: usize) -> f64 {
        let (room, touches) = (self.room(d), self.touches(d));
        let inner = (0..2).filter(|&k| !touches[k]).map(|k| room[k]);
        inner.fold(ROOM * self.least[d] / self.uv[d].width(), f64::min)
    }
}

/// What is known about a square of the quadtree, in a frame whose z is about normal; from an enclosure over its
/// surroundings.
pub(super) struct Framed {
    pub(super) turn: DMat3,
    pub(super) sized: Sized,
    normal: Ball3,
}

impl Framed {
    /// `None` if the normal cannot be shown to stay on one side.
    pub(super) fn new(place: &Place, jet: &[Box3]) -> Option<Self> {
        let turn = frame(jet[1].mid(), jet[2].mid())?;
        let sized = Sized::new(place, jet, &turn);
        let [a, b] = sized.first;
        let normal = a.cross(b);
        (normal.z.lo() > SMALLEST && normal.length().is_finite()).then_some(Self {
            turn,
            sized,
            normal,
        })
    }

    /// The greatest α of the theorem if partners have other parameters here.
    pub(super) fn between(&self, tol: f64) -> f64 {
        let [a, b] = self.sized.first;
        let least = self.normal.z.lo();
        // `|J w|` is at least the height of each side over the other, times its share.
        let (u, v) = (tol * b.length() / least, tol * a.length() / least);
        0.5 * greatest(self.sized.norms(), [u, v]) * ROUND_UP
    }

    /// What could be said at best if the derivatives were constant.
    pub(super) fn within_reach(&self) -> Bound {
        Bound {
            error: middle(self.sized.second.map(|x| Lanes(Single, x.z.mid))).map(|x| x.1),
            ..Bound::default()
        }
    }

    /// Partners along the normal; `parts` is what is known about the square itself.
    fn inside(&self, place: &Place, parts: Option<&Parts>) -> Bound {
        if let Some(bound) = parts.and_then(Parts::whole) {
            return bound;
        }
        let Self { sized, normal, .. } = self;
        let least = normal.z.lo();
        let [mx, my] = [normal.x.mag() / least, normal.y.mag() / least];
        let [x, y, z] = self.errors();
        let [a, b] = sized.first.map(|x| length2(x.x.mag(), x.y.mag()));
        let moved = [0, 1].map(|k| length2(x[k], y[k]) / least);
        let single = |x| Lanes(Single, x);
        let (norms, first) = (sized.norms().map(single), [a, b].map(single));
        let room = [0, 1].map(|d| single(place.room_inside(d)));
        let partners = partners(norms, first, moved.map(single), room);
        let [added, slip] = partners.map(|both| both.map(|x| x.1));
        Bound {
            error: [0, 1].map(|k| z[k] + mx * x[k] + my * y[k]),
            added,
            slip,
            ..Bound::default()
        }
    }

    /// How far the components of `e` go.
    pub(super) fn errors(&self) -> [[f64; 2]; 3] {
        errors(self.sized.forms())
    }
}

/// Partners along a normal, `moved` times the other direction's first derivative away along each direction: what they add,
/// and how far they slip.
#[inline(always)]
pub(super) fn partners<R: Registers>(
    norms: [Lanes<R>; 3],
    [a, b]: [Lanes<R>; 2],
    moved: [Lanes<R>; 2],
    room: [Lanes<R>; 2],
) -> [[Lanes<R>; 2]; 2] {
    // No closures: these would not be compiled for the instruction set.
    let [x, y] = [[moved[0] * b, moved[0] * a], [moved[1] * b, moved[1] * a]];
    [
        [greatest(norms, x) * 0.5, greatest(norms, y) * 0.5],
        [
            (x[0] / room[0]).max(x[1] / room[1]),
            (y[0] / room[0]).max(y[1] / room[1]),
        ],
    ]
}

/// Bounds for a square of the quadtree, from an enclosure over its surroundings and what is known about the square itself.
/// Partners have other parameters only if it is `framed`.
pub(super) fn bounds(
    surface: &dyn Surface,
    place: &Place,
    jet: &Jet<Box3>,
    parts: Option<&Parts>,
    proven: bool,
    framed: Option<&Framed>,
    tol: f64,
) -> SmallVec<[Bound; 4]> {
    let mut out = smallvec![plain(place, jet)];
    if !proven {
        return out;
    }
    if let Some(framed) = framed {
        match [0, 1].map(|d| place.touches(d) != [false; 2]) {
            [false, false] => out.push(framed.inside(place, parts)),
            [false, true] => {
                out.extend(along(place, jet, 0));
                out.extend(parts.and_then(Parts::whole));
            }
            [true, false] => {
                out.extend(along(place, jet, 1));
                out.extend(parts.and_then(Parts::whole));
            }
            [true, true] => {}
        }
    }
    if let Some(tip) = tip(surface, place.uv, jet, NEGLIGIBLE * tol) {
        out.push(fan(place, &tip, jet));
    }
    out
}

/// The greatest `|D²r[w, w]|` for steps of at most u and v, from the norms of second derivatives.
#[inline(always)]
pub(super) fn greatest<T: Copy + Add<Output = T> + Mul<Output = T>>(
    [uu, uv, vv]: [T; 3],
    [u, v]: [T; 2],
) -> T {
    uu * u * u + (uv + uv) * u * v + vv * v * v
}

/// The derivatives along the sides of the rectangle, in a frame.
pub(super) struct Sized {
    first: [Ball3; 2],
    second: [Ball3; 3],
}

impl Sized {
    fn new(place: &Place, jet: &[Box3], turn: &DMat3) -> Self {
        let [du, dv] = place.uv.map(|i| i.width() * ROUND_UP);
        let of = |k: usize, size: f64| Ball3::from(jet[k]).scale(size).image(turn);
        Self {
            first: [of(1, du), of(2, dv)],
            second: [of(3, du * du), of(4, du * dv), of(5, dv * dv)],
        }
    }

    /// For each coordinate.
    fn forms(&self) -> [Form; 3] {
        let [uu, uv, vv] = self.second.map(Ball3::to_array);
        [0, 1, 2].map(|c| [uu[c], uv[c], vv[c]])
    }

    pub(super) fn norms(&self) -> [f64; 3] {
        self.second.map(Ball3::length)
    }
}

/// Partners with the same parameters.
fn plain(place: &Place, jet: &[Box3]) -> Bound {
    let sized = Sized::new(place, jet, &DMat3::IDENTITY);
    let [x, y, z] = sized.forms();
    let any = sized.norms().map(|rad| Ball { mid: 0.0, rad });
    let [x, y, z, norms] = errors([x, y, z, any]);
    let parts = [x, y, z];
    let sum = [0, 1].map(|k| length2(length2(parts[0][k], parts[1][k]), parts[2][k]));
    Bound {
        error: [0, 1].map(|k| if sum[k] <= norms[k] { sum[k] } else { norms[k] }),
        ..Bound::default()
    }
}

/// Partners along a side that runs along u (0) or v (1).
fn along(place: &Place, jet: &[Box3], dir: usize) -> Option<Bound> {
    let directions = [jet[1].mid(), jet[2].mid()];
    let sized = Sized::new(place, jet, &frame(directions[dir], directions[1 - dir])?);
    let first = sized.first[dir];
    let least = first.x.lo();
    if !(least > 0.0 && first.length().is_finite()) {
        return None;
    }
    let [ty, tz] = [first.y.mag() / least, first.z.mag() / least];
    let [x, y, z] = errors(sized.forms());
    let away = x.map(|e| e / least);
    let second = sized.norms()[2 * dir];
    let [below, above] = place.room(dir);
    let room = below.min(above);
    Some(Bound {
        error: [0, 1].map(|k| length2(y[k] + ty * x[k], z[k] + tz * x[k])),
        added: away.map(|d| 0.5 * second * d * d),
        slip: away.map(|d| d / room),
        ..Bound::default()
    })
}

/// Partners with the same parameters where a side is one point.
fn fan(place: &Place, tip: &Tip, jet: &[Box3]) -> Bound {
    let jet = tip.lift(jet.to_vec());
    let [uu, uv, vv] = Sized::new(place, &jet, &DMat3::IDENTITY).norms();
    let ray = [vv, uu][tip.along];
    let error = 0.125 * (uu + 2.0 * uv + vv + ray);
    Bound {
        error: [error; 2],
        shift: 2.0 * tip.size,
        ..Bound::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::Random;

    /// The greatest error of interpolation on a triangle, on a grid of points.
    fn off(f: impl Fn([f64; 2]) -> f64, corners: [[f64; 2]; 3], steps: usize) -> f64 {
        let mut worst = 0.0f64;
        for i in 0..=steps {
            for j in 0..=steps - i {
                let l = [i, j, steps - i - j].map(|k| k as f64 / steps as f64);
                let at = [0, 1].map(|d| (0..3).map(|k| l[k] * corners[k][d]).sum());
                let linear: f64 = (0..3).map(|k| l[k] * f(corners[k])).sum();
                worst = worst.max((linear - f(at)).abs());
            }
        }
        worst
    }

    /// That of ½ Q.
    fn sampled([u, c, v]: [f64; 3], corners: [[f64; 2]; 3]) -> f64 {
        let f = |[x, y]: [f64; 2]| 0.5 * (u * x * x + 2.0 * c * x * y + v * y * y);
        off(f, corners, 60)
    }

    const TRIANGLES: [[[[f64; 2]; 3]; 2]; 2] = [
        [
            [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]],
        ],
        [
            [[0.0, 0.0], [1.0, 0.0], [0.5, 0.5]],
            [[0.0, 0.0], [0.0, 1.0], [0.5, 0.5]],
        ],
    ];

    #[test]
    fn errors_of_quadratic_functions_are_bounded_also_for_triangles_inside() {
        let mut random = Random(17);
        let mut tight = 0;
        for _ in 0..300 {
            let q = [0; 3].map(|_| 2.0 * random.unit() - 1.0);
            let [bound] = errors([q.map(Ball::point)]);
            for (kinds, bound) in TRIANGLES.iter().zip(bound) {
                let found = kinds.map(|t| sampled(q, t));
                let worst = found[0].max(found[1]);
                assert!(worst <= bound + 1e-12, "{q:?}: {worst} > {bound}");
                tight += usize::from(worst > 0.7 * bound);
                for t in kinds {
                    let inner = [0; 3].map(|_| {
                        let (a, b) = (random.unit(), random.unit());
                        let (a, b) = if a + b > 1.0 {
                            (1.0 - a, 1.0 - b)
                        } else {
                            (a, b)
                        };
                        [0, 1].map(|d| t[0][d] + a * (t[1][d] - t[0][d]) + b * (t[2][d] - t[0][d]))
                    });
                    assert!(sampled(q, inner) <= bound + 1e-12);
                }
            }
        }
        assert!(tight > 400, "{tight} of 600 bounds are nearly reached");
    }
}
