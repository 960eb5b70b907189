//! Bounds for the equal parts of a square in one analytic piece, from what is known about the whole square.
//!
//! The surface over the square is a polynomial, but for a little. So in each part the second derivatives are a constant form,
//! a linear change and a rest that falls with the square of the part's size: enclosing the square once serves all parts. The
//! theorem of `partners` holds with the square: its triangles may be of different sizes, and partners may be chosen with
//! another frame in each part.
//!
//! # Beside a side
//!
//! Let the side `v = 0` of the block be a side of the part, which lies at `v ≥ 0`; likewise for the other sides. Let `d*` be
//! the way to the partner as inside, with `J d* = e` in x and y. Its share across the side is held back to
//! `d_v = max(-v, min(v, d*_v))`, so partners stay in the domain, and those of points of the side on the side. With
//! `c = d*_v - d_v` let `d_u = d*_u + c r_u·r_v / |r_u|²`. Then
//!
//! `J d - e = (J d* - e) - c (r_v - r_u (r_u·r_v) / |r_u|²)`.
//!
//! The first part is `|N·e| / N_z` long and along z. The second has the length `h = |c| |N| / |r_u|` and is orthogonal to N,
//! so its z is at most `h |N_xy| / |N|`. Here `|c| ≤ |d*_v| = |(r_u × e)_z| / N_z`, and c is not zero only where `v < |d*_v|`:
//! there e is nearly what it is on the side. Let a be the tangent along the side in the middle of the part, `r_u = a + A`, and
//! y the direction `z × a / |a|`. Then `|(r_u × e)_z| ≤ |a| |e_y| + |A| |e_xy|`. At the point of the side at the same u,
//! `|e_y| ≤ ⅛ sup |y·r_uu| q²`, as edges there are q long, and on the way from there, of the length `v < |d*_v|`, it changes
//! by at most `v sup |∂_v e|`. In a triangle with a side along v, `∂_v L` is a mean of `r_v` over that side. In any other
//! triangle, also if further vertices divide an edge on the side of the block, it follows from the means of derivatives over
//! an edge along u and over one that is at most q wide and at least q/2 high:
//! `|∂_v e| ≤ q (4 |r_uu| + 5 |r_uv| + |r_vv|)`. As `|c r_u·r_v| / |r_u|² ≤ |e_xy| |r_v| / N_z`, which is the bound for `|d*_u|`
//! as well, partners are at most twice as far away as inside.
//!
//! Triangles that have further vertices on a side may have any shape, so the linear part of second derivatives counts there as
//! what is bounded by Popoviciu's inequality.

use super::bound::ROUND_UP;
use super::levels::{Level, Levels};
use super::partners::{Bound, Framed, Place, length2, middle, partners, rest};
use super::pieces::{Local, ORDER, Polynomial, falling, powers};
use crate::scalar::Pack;
use crate::simd::{InstructionSet, Kernel, Lanes, Registers, Single, cross, dot};
use crate::surface::jet_index;
use glam::DVec3;

/// The greatest errors of linear interpolation of x³/6 and of x² y/2 on the triangles, with x = y = 0 in the middle of the
/// longest side and legs of length 1 or √½: those of x/24 - x³/6 and y (¼ - x²)/2 (`√3/216` < 0.0081, with room to
/// spare, and ⅟16).
const CUBE: f64 = 0.009;
const MIXED: f64 = 0.0625;

/// The derivatives of the surface over a square as those of a polynomial. Each equal part has its own frame.
///
/// Let z be the normal in the middle of a part, and the tangents there be a and b along its sides. Within the part they
/// change by no more than A and B, in z by no more than `A_z` and `B_z`. Then `|N_xy| ≤ (|a| + A) B_z + (|b| + B) A_z` and
/// `N_z ≥ |a × b| - |a| B - |b| A - A B`, and of `e` there remains at most `|e_z| + |e_xy| |N_xy| / N_z`.
pub(super) struct Parts {
    room: [f64; 2],
    /// Along u and v, whether a side of the block is at the lower and at the upper end.
    touches: [[bool; 2]; 2],
    /// The normal of the square's frame, and how far `e` goes within the plane across and out of it.
    z: DVec3,
    within: [f64; 2],
    across: [f64; 2],
    /// The greatest second derivatives.
    norms: [f64; 3],
    /// The polynomial about the middle, with the square's sides as units.
    terms: Polynomial,
    /// How much its first derivatives are off, at most, and its second.
    first: [f64; 2],
    second: [DVec3; 3],
    /// The greatest fourth derivatives of the polynomial: `uuuu`, `uuuv`, …
    fourth: [DVec3; 5],
}

impl Parts {
    pub(super) fn new(framed: &Framed, place: &Place, local: &Local) -> Self {
        let size = [0, 1].map(|d| place.uv[d].width() / local.half[d]);
        let [u, v] = size.map(powers);
        let mut terms = local.terms;
        let mut fourth = [DVec3::ZERO; 5];
        for (i, j) in (0..=ORDER).flat_map(|i| (0..=ORDER - i).map(move |j| (i, j))) {
            terms[i][j] *= u[i] * v[j];
            // The square reaches half a unit far.
            let most = terms[i][j].abs() * (16.0 / (1u32 << (i + j)) as f64);
            for (b, fourth) in fourth.iter_mut().enumerate() {
                if i + b >= 4 && j >= b {
                    *fourth += most * (falling(i, 4 - b) * falling(j, b));
                }
            }
        }
        let off = |a: usize, b: usize| local.off[jet_index(a, b)] * (u[a] * v[b] * ROUND_UP);
        let [x, y, across] = framed.errors();
        Self {
            room: [0, 1].map(|d| place.room_inside(d)),
            touches: [0, 1].map(|d| place.touches(d)),
            z: framed.turn.row(2),
            within: [0, 1].map(|k| length2(x[k], y[k])),
            across,
            norms: framed.sized.norms(),
            terms,
            first: [off(1, 0), off(0, 1)].map(DVec3::length),
            second: [off(2, 0), off(1, 1), off(0, 2)],
            fourth,
        }
    }

    /// The fewest bisections of so many parts along each direction, v fastest. Those of parts [`Beside::Corner`] do not hold.
    pub(super) fn levels(&self, count: usize, grain: f64, tol: f64) -> Vec<Level> {
        self.every(count, || Levels::new(grain, tol))
    }

    /// What is told of all parts.
    fn every<T: Tell>(&self, count: usize, new: impl Fn() -> T) -> Vec<T::Told> {
        let all = |k: usize| [k / count, k % count];
        let mut out = self.some::<_, NOWHERE>(count, count * count, all, new());
        for (d, upper) in [(0, false), (0, true), (1, false), (1, true)] {
            if !self.touches[d][usize::from(upper)] {
                continue;
            }
            let at = if upper { count - 1 } else { 0 };
            let on = if d == 0 {
                self.some::<_, 1>(count, count, |k| [at, k], new())
            } else {
                self.some::<_, 0>(count, count, |k| [k, at], new())
            };
            for (k, told) in on.into_iter().enumerate() {
                out[if d == 0 {
                    at * count + k
                } else {
                    k * count + at
                }] = told;
            }
        }
        out
    }

    /// What is told of some of so many parts along each direction; see [`Self::bounds`].
    fn some<T: Tell, const ALONG: usize>(
        &self,
        count: usize,
        number: usize,
        at: impl Fn(usize) -> [usize; 2],
        mut tell: T,
    ) -> Vec<T::Told> {
        let mut out = Vec::with_capacity(number);
        InstructionSet::best().run(Chosen::<_, _, ALONG> {
            parts: self,
            count,
            number,
            at,
            tell: &mut tell,
            out: &mut out,
        });
        out
    }

    /// Where a part of so many lies in the block.
    pub(super) fn beside(&self, at: [usize; 2], count: usize) -> Beside {
        let touches = |d: usize| {
            let [lower, upper] = self.touches[d];
            usize::from(lower && at[d] == 0) + usize::from(upper && at[d] + 1 == count)
        };
        match [touches(0), touches(1)] {
            [0, 0] => Beside::Nothing,
            [0, 1] => Beside::Side(0),
            [1, 0] => Beside::Side(1),
            _ => Beside::Corner,
        }
    }

    /// The bound for the square, if it is the only part.
    pub(super) fn whole(&self) -> Option<Bound> {
        let middle = [Lanes(Single, 0.0); 2];
        let bounds = match self.beside([0; 2], 1) {
            Beside::Nothing => self.bounds::<_, NOWHERE>(middle, 1),
            Beside::Side(0) => self.bounds::<_, 0>(middle, 1),
            Beside::Side(_) => self.bounds::<_, 1>(middle, 1),
            Beside::Corner => return None,
        };
        let both = |x: [Lanes<Single>; 2]| x.map(|x| x.1);
        let bounds = Bounds {
            error: both(bounds.error),
            best: both(bounds.best),
            skew: bounds.skew.map(both),
            cubic: bounds.cubic.1,
            added: both(bounds.added),
            slip: both(bounds.slip),
        };
        Some(bounds.told())
    }

    /// Those for parts with their middles there, in shares of the square from its middle: beside a side of the block that
    /// runs along u (`ALONG` is 0) or v (1), or beside none ([`NOWHERE`]).
    #[inline(always)]
    fn bounds<R: Registers, const ALONG: usize>(
        &self,
        at: [Lanes<R>; 2],
        count: usize,
    ) -> Bounds<Lanes<R>> {
        let r = at[0].0;
        let zero = Lanes::splat(r, 0.0);
        let share = 1.0 / count as f64;
        let half = 0.5 * share;
        let norms = splat(r, self.norms);
        let Derivatives {
            first,
            second,
            third,
        } = self.derivatives(at);
        let area = cross(&first[0], &first[1]);
        let size = dot(&area, &area).sqrt();
        let z = [area[0] / size, area[1] / size, area[2] / size];
        // The second derivatives along the normal in the middle, how much they are off anywhere from their linear law, and
        // the sizes of the third.
        let sizes = [z[0].abs(), z[1].abs(), z[2].abs()];
        let rests = self.rests(half);
        let [mut mid, mut rad] = [[zero; 3]; 2];
        for k in 0..3 {
            mid[k] = dot(&z, &second[k]);
            rad[k] = dot(&sizes, &splat(r, rests[k])) + norms[k] * ROUNDING;
        }
        let mut across = [zero; 4];
        for k in 0..4 {
            across[k] = dot(&z, &third[k]).abs();
        }
        let (vectors, third) = (third, across);
        // The greatest second derivatives in this part, all and those within the plane across the normal.
        let mut sized = [zero; 4];
        for k in 0..4 {
            sized[k] = dot(&vectors[k], &vectors[k]).sqrt();
        }
        let [mut local, mut plane] = [[zero; 3]; 2];
        for k in 0..3 {
            let [x, y, w] = second[k];
            let flat = [x - z[0] * mid[k], y - z[1] * mid[k], w - z[2] * mid[k]];
            let other = Lanes::splat(r, DVec3::from_array(rests[k]).length() * ROUND_UP)
                + (sized[k] + sized[k + 1]) * half
                + norms[k] * ROUNDING;
            plane[k] = dot(&flat, &flat).sqrt() + other;
            local[k] = dot(&second[k], &second[k]).sqrt() + other;
            local[k] = local[k].where_greater(norms[k], [norms[k], local[k]]);
        }
        let plane = rest(plane);
        // What is not known about the first derivatives, what they change within half a part, and rounding.
        let mut steep = [zero; 3];
        for k in 0..3 {
            let most = (mid[k].abs() + rad[k]) * ROUND_UP;
            steep[k] = most + (third[k] + third[k + 1]) * half;
        }
        let [mut lengths, mut turn, mut change, mut long] = [[zero; 2]; 4];
        for k in 0..2 {
            lengths[k] = dot(&first[k], &first[k]).sqrt();
            let rounding = (lengths[k] + norms[k] + norms[k + 1]) * ROUNDING;
            let unknown = rounding + Lanes::splat(r, self.first[k]);
            // If tangents are nearly parallel, the normal is off by more than a rounding.
            let aside = dot(&z, &first[k]).abs();
            turn[k] = (steep[k] + steep[k + 1]) * half + unknown + aside;
            change[k] = (local[k] + local[k + 1]) * half + unknown;
            long[k] = lengths[k] + change[k];
        }
        let lost = lengths[0] * change[1] + lengths[1] * change[0] + change[0] * change[1];
        let least = size - lost - long[0] * long[1] * ROUNDING;
        // Without a normal there is no bound.
        let least = least.where_greater(zero, [least, Lanes::splat(r, f64::NAN)]);
        let tilt = (long[0] * turn[1] + long[1] * turn[0]) / least;
        let from = splat(r, self.z.to_array());
        let aside = [z[0] - from[0], z[1] - from[1], z[2] - from[2]];
        let aside = dot(&aside, &aside).sqrt();
        let [mut within, mut moved] = [[zero; 2]; 2];
        for k in 0..2 {
            within[k] = aside * self.across[k] + Lanes::splat(r, self.within[k]);
            within[k] = within[k].where_greater(plane[k], [plane[k], within[k]]);
            moved[k] = within[k] / least;
        }
        // Sides of the block are no nearer than a part is wide.
        let room = splat(r, self.room.map(|room| room.min(share)));
        let [mut added, mut slip] = partners(norms, long, moved, room);
        let (mut best, off) = (middle(mid), rest(rad));
        // The middles of longest sides are at most half a part away from its middle.
        let skew_u = rest([third[0], third[1], third[2]]);
        let skew_v = rest([third[1], third[2], third[3]]);
        let (squared, cubed) = (share * share, share * share * share);
        let (mut error, mut skew) = ([zero; 2], [[zero; 2]; 2]);
        for k in 0..2 {
            error[k] = (best[k] + off[k] + tilt * within[k]) * squared;
            best[k] = best[k] * squared;
            skew[k] = [skew_u[k] * (0.5 * cubed), skew_v[k] * (0.5 * cubed)];
            added[k] = added[k] * (squared * squared);
            slip[k] = slip[k] * squared;
        }
        let cubic = (third[0] + third[3]) * CUBE + (third[1] + third[2]) * MIXED;
        let mut bounds = Bounds {
            error,
            best,
            skew,
            cubic: cubic * cubed,
            added,
            slip,
        };
        if ALONG == NOWHERE {
            return bounds;
        }
        // See above: the second derivative along the side in y, and how `e` changes away from the side.
        let (run, length) = (&first[ALONG], lengths[ALONG]);
        let y = cross(&z, run);
        let y = [y[0] / length, y[1] / length, y[2] / length];
        let sizes = [y[0].abs(), y[1].abs(), y[2].abs()];
        let (own, mixed) = [(0, 1), (3, 2)][ALONG];
        let change_y = dot(&y, &vectors[own]).abs() + dot(&y, &vectors[mixed]).abs();
        let bent = dot(&y, &second[2 * ALONG]).abs()
            + dot(&sizes, &splat(r, rests[2 * ALONG]))
            + norms[2 * ALONG] * ROUNDING
            + change_y * half;
        let uneven = (norms[2 * ALONG] * 4.0 + norms[1] * 5.0 + norms[2 - 2 * ALONG]) * share;
        let shortest = length - change[ALONG];
        let shortest = shortest.where_greater(zero, [shortest, Lanes::splat(r, f64::NAN)]);
        let larger = (tilt + Lanes::splat(r, 1.0)) / shortest;
        for k in 0..2 {
            let on_side = bent * 0.125 + moved[k] * long[ALONG] * uneven;
            let held = larger * (length * on_side + change[ALONG] * within[k]);
            // Triangles may get further vertices on the side, so the linear part is like the rest.
            let skew = bounds.skew[k][0] + bounds.skew[k][1];
            let (out, held) = (bounds.error[k] + skew, held * squared);
            let out = out + tilt * held;
            let smallest = Lanes::splat(r, f64::MIN_POSITIVE);
            bounds.error[k] = (out * out + held * held + smallest).sqrt();
            bounds.skew[k] = [zero; 2];
            bounds.added[k] = bounds.added[k] * 4.0;
            bounds.slip[k] = bounds.slip[k] * 2.0;
        }
        bounds.cubic = zero;
        bounds
    }

    /// How much the second derivatives are off from their linear law within so much of a part's middle.
    #[inline(always)]
    fn rests(&self, half: f64) -> [[f64; 3]; 3] {
        let mut out = [[0.0; 3]; 3];
        for k in 0..3 {
            let [p, q, s] = [self.fourth[k], self.fourth[k + 1], self.fourth[k + 2]];
            let rest = self.second[k] + (p + q + q + s) * (0.5 * half * half * ROUND_UP);
            out[k] = rest.to_array();
        }
        out
    }

    /// The derivatives of the polynomial, by Horner's scheme along v and along u.
    #[inline(always)]
    fn derivatives<R: Registers>(&self, [x, y]: [Lanes<R>; 2]) -> Derivatives<R> {
        let zero = Lanes::splat(x.0, 0.0);
        let mut out = Derivatives {
            first: [[zero; 3]; 2],
            second: [[zero; 3]; 3],
            third: [[zero; 3]; 4],
        };
        for c in 0..3 {
            // Derivatives over factorials, by orders along u and v.
            let mut all = [[zero; 4]; 4];
            for i in (0..=ORDER).rev() {
                let mut row = [zero; 4];
                for j in (0..=ORDER - i).rev() {
                    row[3] = row[3] * y + row[2];
                    row[2] = row[2] * y + row[1];
                    row[1] = row[1] * y + row[0];
                    row[0] = row[0] * y + Lanes::splat(x.0, self.terms[i][j][c]);
                }
                for b in 0..4 {
                    for a in (1..4 - b).rev() {
                        all[a][b] = all[a][b] * x + all[a - 1][b];
                    }
                    all[0][b] = all[0][b] * x + row[b];
                }
            }
            out.first[0][c] = all[1][0];
            out.first[1][c] = all[0][1];
            out.second[0][c] = all[2][0] * 2.0;
            out.second[1][c] = all[1][1];
            out.second[2][c] = all[0][2] * 2.0;
            out.third[0][c] = all[3][0] * 6.0;
            out.third[1][c] = all[2][1] * 2.0;
            out.third[2][c] = all[1][2] * 2.0;
            out.third[3][c] = all[0][3] * 6.0;
        }
        out
    }
}

/// Derivatives in the middles of some parts, `u` first.
struct Derivatives<R: Registers> {
    first: [[Lanes<R>; 3]; 2],
    second: [[Lanes<R>; 3]; 3],
    third: [[Lanes<R>; 3]; 4],
}

/// No side of the block is beside a part.
const NOWHERE: usize = 2;

/// What a part lies beside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Beside {
    /// No side of the block.
    Nothing,
    /// One that runs along u (0) or v (1).
    Side(usize),
    /// Several sides.
    Corner,
}

/// Rounding errors as a share of lengths and second derivatives; those of the polynomial's terms are in [`Local::off`].
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The same numbers in all lanes.
#[inline(always)]
fn splat<R: Registers, const N: usize>(r: R, x: [f64; N]) -> [Lanes<R>; N] {
    let mut out = [Lanes::splat(r, 0.0); N];
    for k in 0..N {
        out[k] = Lanes::splat(r, x[k]);
    }
    out
}

/// The numbers of a [`Bound`], of several parts or one.
pub(super) struct Bounds<T> {
    pub(super) error: [T; 2],
    /// Instead of `error`, what could be said at best.
    pub(super) best: [T; 2],
    pub(super) skew: [[T; 2]; 2],
    pub(super) cubic: T,
    pub(super) added: [T; 2],
    pub(super) slip: [T; 2],
}

impl Bounds<f64> {
    fn told(&self) -> Bound {
        Bound {
            error: self.error,
            skew: self.skew,
            cubic: self.cubic,
            added: self.added,
            slip: self.slip,
            shift: 0.0,
        }
    }
}

/// What is wanted of the bounds.
pub(super) trait Tell {
    /// Of each part.
    type Told;
    /// Adds it for the first `number` parts of a register; must be inlined.
    fn tell<R: Registers>(
        &mut self,
        bounds: &Bounds<Lanes<R>>,
        number: usize,
        out: &mut Vec<Self::Told>,
    );
}

/// The bounds for some parts, a register of them at a time.
struct Chosen<'a, T: Tell, At, const ALONG: usize> {
    parts: &'a Parts,
    count: usize,
    number: usize,
    at: At,
    tell: &'a mut T,
    out: &'a mut Vec<T::Told>,
}

impl<T: Tell, At: Fn(usize) -> [usize; 2], const ALONG: usize> Kernel for Chosen<'_, T, At, ALONG> {
    #[inline(always)]
    fn run<R: Registers>(self, r: R) {
        let n = self.count;
        let share = 1.0 / n as f64;
        for first in (0..self.number).step_by(R::LANES) {
            let [mut x, mut y] = [[0.0; Pack::LANES]; 2];
            for lane in 0..R::LANES {
                let [i, j] = (self.at)(first + lane);
                x[lane] = (i as f64 + 0.5) * share - 0.5;
                y[lane] = (j as f64 + 0.5) * share - 0.5;
            }
            let at = [Lanes::load(r, &x), Lanes::load(r, &y)];
            let bounds = self.parts.bounds::<_, ALONG>(at, n);
            let number = R::LANES.min(self.number - first);
            self.tell.tell(&bounds, number, self.out);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::bisection::{Bisection, CELL, Square};
    use super::super::levels::DEEPEST;
    use super::super::numbered::Numbered;
    use super::*;
    use crate::box3::Box3;
    use crate::interval::Interval;
    use crate::laws::Random;

    /// `z = f(x, y)` with a function of third order: its second and third derivatives at the origin.
    struct Graph {
        second: [f64; 3],
        third: [f64; 4],
        /// Second derivatives of x and y: parameters are uneven, and the sides bent within the plane.
        plane: [[f64; 3]; 2],
        /// The direction across a side of the surface, and whether it is the upper one of the square.
        side: Option<(usize, bool)>,
    }

    impl Graph {
        fn point(&self, [x, y]: [f64; 2]) -> DVec3 {
            let ([a, b, c], [p, q, r, s]) = (self.second, self.third);
            let quadratic = 0.5 * (a * x * x + 2.0 * b * x * y + c * y * y);
            let cubic = p * x * x * x + 3.0 * (q * x * x * y + r * x * y * y) + s * y * y * y;
            let [along_x, along_y] = self
                .plane
                .map(|[a, b, c]| 0.5 * (a * x * x + 2.0 * b * x * y + c * y * y));
            DVec3::new(x + along_x, y + along_y, quadratic + cubic / 6.0)
        }

        /// The derivatives over a square around the origin.
        fn jet(&self, half: f64) -> [Box3; 6] {
            let t = Interval::new(-half, half);
            let n = Interval::point;
            let ([a, b, c], [p, q, r, s]) = (self.second.map(n), self.third.map(n));
            let slope = |a, b, p, q, r| {
                a * t + b * t + (p * t * t + n(2.0) * q * t * t + r * t * t) * n(0.5)
            };
            let boxed = |k: usize, z: Interval| {
                let [x, y] = self.plane.map(|[a, b, c]| {
                    [n(a) * t + n(b) * t, n(b) * t + n(c) * t, n(a), n(b), n(c)][k]
                });
                let of = |d: usize| n(if k == d { 1.0 } else { 0.0 });
                Box3::from([of(0) + x, of(1) + y, z])
            };
            [
                Box3::from([Interval::ENTIRE; 3]),
                boxed(0, slope(a, b, p, q, r)),
                boxed(1, slope(b, c, q, r, s)),
                boxed(2, a + p * t + q * t),
                boxed(3, b + q * t + r * t),
                boxed(4, c + r * t + s * t),
            ]
        }

        fn local(&self) -> Local {
            let ([a, b, c], [p, q, r, s]) = (self.second, self.third);
            let mut terms = [[DVec3::ZERO; ORDER + 1]; ORDER + 1];
            (terms[1][0], terms[0][1]) = (DVec3::X, DVec3::Y);
            let of = [(2, 0, 0.5 * a), (1, 1, b), (0, 2, 0.5 * c)];
            for (i, j, x) in of {
                terms[i][j].z = x;
            }
            let [[a, b, c], [d, e, f]] = self.plane;
            for (i, j, x, y) in [
                (2, 0, 0.5 * a, 0.5 * d),
                (1, 1, b, e),
                (0, 2, 0.5 * c, 0.5 * f),
            ] {
                (terms[i][j].x, terms[i][j].y) = (x, y);
            }
            let of = [
                (3, 0, p / 6.0),
                (2, 1, 0.5 * q),
                (1, 2, 0.5 * r),
                (0, 3, s / 6.0),
            ];
            for (i, j, x) in of {
                terms[i][j].z = x;
            }
            Local {
                half: [1.0; 2],
                terms,
                off: [DVec3::ZERO; 6],
            }
        }

        /// The distance of a point, near which the surface is over a place.
        fn distance(&self, p: DVec3, mut at: [f64; 2]) -> f64 {
            const H: f64 = 1e-5;
            for _ in 0..8 {
                let off = p - self.point(at);
                let slope = |at: &[f64; 2], x: f64, y: f64| {
                    let [a, b] = [1.0, -1.0].map(|s| self.point([at[0] + s * x, at[1] + s * y]));
                    (a - b) / (2.0 * H)
                };
                let (a, b) = (slope(&at, H, 0.0), slope(&at, 0.0, H));
                let n = a.cross(b);
                let area = n.length_squared();
                at[0] += off.cross(b).dot(n) / area;
                at[1] += a.cross(off).dot(n) / area;
                let Some((d, upper)) = self.side else {
                    continue;
                };
                let end = if upper { 0.5 } else { -0.5 };
                if at[d] < end && upper || at[d] > end && !upper {
                    continue;
                }
                // Along the side.
                at[d] = end;
                for _ in 0..8 {
                    let off = p - self.point(at);
                    let along = if d == 0 {
                        slope(&at, 0.0, H)
                    } else {
                        slope(&at, H, 0.0)
                    };
                    at[1 - d] += off.dot(along) / along.length_squared();
                }
            }
            p.distance(self.point(at))
        }
    }

    /// The bounds themselves, each with what could be said at best.
    struct All;

    impl Tell for All {
        type Told = [Bound; 2];
        #[inline(always)]
        fn tell<R: Registers>(
            &mut self,
            bounds: &Bounds<Lanes<R>>,
            number: usize,
            out: &mut Vec<[Bound; 2]>,
        ) {
            let lane = |x: &Lanes<R>, k: usize| {
                let mut all = [0.0; Pack::LANES];
                x.store(&mut all);
                all[k]
            };
            for k in 0..number {
                let both = |x: &[Lanes<R>; 2]| [lane(&x[0], k), lane(&x[1], k)];
                let of = Bounds {
                    error: both(&bounds.error),
                    best: both(&bounds.best),
                    skew: [both(&bounds.skew[0]), both(&bounds.skew[1])],
                    cubic: lane(&bounds.cubic, k),
                    added: both(&bounds.added),
                    slip: both(&bounds.slip),
                };
                let bound = of.told();
                let error = of.best;
                out.push([bound, Bound { error, ..bound }]);
            }
        }
    }

    /// The bounds of all parts; [`Parts::levels`] has to say the same.
    fn all_bounds(parts: &Parts, n: usize) -> Vec<[Bound; 2]> {
        let all = parts.every(n, || All);
        for tol in [1e-1, 1e-3, 1e-5] {
            for grain in [0.0, 1e-3] {
                let levels = parts.levels(n, grain, tol);
                assert_eq!(levels.len(), all.len());
                for (level, [bound, best]) in levels.iter().zip(&all) {
                    let known = |x: Option<(u32, f64)>| x.filter(|x| x.0 <= DEEPEST);
                    assert_eq!(level.settled(), known(bound.level(tol, grain)));
                    assert_eq!(level.best(), known(best.level(tol, 0.0)).map(|x| x.0));
                    assert_eq!(level.best_error, best.error[0]);
                }
            }
        }
        all
    }

    /// The greatest distance of the triangles of a part after some bisections.
    fn bisected(graph: &Graph, depth: u32, part: Square, level: u32) -> f64 {
        let lines = [vec![-0.5, 0.5], vec![-0.5, 0.5]];
        let mut net = Bisection::new(lines);
        net.refine(Square::cell([0, 0]), 2 * depth);
        net.refine(part, level);
        let [lower, upper] = [net.uv(part.corner), net.uv(part.upper())];
        net.close();
        let numbered = Numbered::plain(&net);
        let places = numbered.places();
        let mut worst = 0.0f64;
        numbered.triangles([0, 0], |t, _| {
            let corners = t.map(|k| net.uv(places[k as usize]));
            let inside = |d: usize| {
                let mid = (corners[0][d] + corners[1][d] + corners[2][d]) / 3.0;
                lower[d] < mid && mid < upper[d]
            };
            if !(inside(0) && inside(1)) {
                return;
            }
            for (i, j) in (0..=6).flat_map(|i| (0..=6 - i).map(move |j| (i, j))) {
                let l = [i, j, 6 - i - j].map(|k| f64::from(k) / 6.0);
                let at = [0, 1].map(|d| (0..3).map(|k| l[k] * corners[k][d]).sum());
                let p: DVec3 = (0..3).map(|k| l[k] * graph.point(corners[k])).sum();
                worst = worst.max(graph.distance(p, at));
            }
        });
        worst
    }

    #[test]
    fn bounds_of_parts_hold_for_all_bisections() {
        let unit = Interval::new(-0.5, 0.5);
        let place = Place {
            uv: [unit; 2],
            block: [Interval::new(-9.0, 9.0); 2],
            least: [1.0; 2],
        };
        let mut random = Random(23);
        let (mut tight, mut known) = (0, 0);
        for round in 0..120 {
            let mut number = |size: f64| size * (2.0 * random.unit() - 1.0);
            // Also where the quadratic part is nothing, where one derivative is all, and where the change counts; flat,
            // and steep enough for the normal to turn.
            let sizes = [[1.0, 1.0], [1.0, 0.2], [0.0, 1.0], [1.0, 6.0]][round % 4];
            let steep = [1e-3, 0.3][round / 4 % 2];
            let second = [0; 3].map(|_| number(steep * sizes[0]));
            let mut third = [0; 4].map(|_| number(steep * sizes[1]));
            if round % 3 == 0 {
                third = std::array::from_fn(|k| if k == round % 4 { third[k] } else { 0.0 });
            }
            let graph = Graph {
                second,
                third,
                plane: [[0.0; 3]; 2],
                side: None,
            };
            let framed = Framed::new(&place, &graph.jet(0.5625)).expect("the normal stays up");
            for depth in 0..3 {
                let parts = Parts::new(&framed, &place, &graph.local());
                let n = 1 << depth;
                for (k, [bound, best]) in all_bounds(&parts, n).into_iter().enumerate() {
                    let size = CELL >> depth;
                    let corner = [k / n, k % n].map(|i| i as u64 * size);
                    let part = Square { corner, depth };
                    // Some of them are enough.
                    if (k + round) % 3 != 0 {
                        continue;
                    }
                    for level in 0..4 {
                        let Some(told) = bound.deviation(level, 0.0, f64::INFINITY) else {
                            continue;
                        };
                        let worst = bisected(&graph, depth, part, level);
                        assert!(
                            worst <= told,
                            "{second:?} {third:?} {level}: {worst} > {told}"
                        );
                        assert!(best.deviation(level, 0.0, f64::INFINITY).unwrap() <= told);
                        tight += usize::from(worst > 0.7 * told);
                        known += 1;
                    }
                }
            }
        }
        assert!(
            3 * tight > known,
            "{tight} of {known} bounds are nearly reached"
        );
    }

    #[test]
    fn bounds_of_parts_hold_beside_sides() {
        let mut random = Random(31);
        let (mut tight, mut known) = (0, 0);
        for round in 0..120 {
            let side = (round % 2, round / 2 % 2 == 1);
            let mut number = |size: f64| size * (2.0 * random.unit() - 1.0);
            let bent = [0.0, 0.02, 0.1][round / 4 % 3];
            let steep = [1e-3, 0.1][round / 12 % 2];
            let graph = Graph {
                second: [0; 3].map(|_| number(steep)),
                third: [0; 4].map(|_| number(0.5 * steep)),
                plane: [[0; 3]; 2].map(|all| all.map(|_| number(bent))),
                side: Some(side),
            };
            let (d, upper) = side;
            let unit = Interval::new(-0.5, 0.5);
            let mut block = [Interval::new(-9.0, 9.0); 2];
            if upper {
                block[d].hi = 0.5;
            } else {
                block[d].lo = -0.5;
            }
            let place = Place {
                uv: [unit; 2],
                block,
                least: [1.0; 2],
            };
            let framed = Framed::new(&place, &graph.jet(0.5625)).expect("the normal stays up");
            let parts = Parts::new(&framed, &place, &graph.local());
            for depth in 0..3 {
                let n = 1 << depth;
                for (k, [bound, best]) in all_bounds(&parts, n).into_iter().enumerate() {
                    let at = [k / n, k % n];
                    if parts.beside(at, n) != Beside::Side(1 - d) {
                        continue;
                    }
                    let size = CELL >> depth;
                    let corner = at.map(|i| i as u64 * size);
                    for level in 0..4 {
                        let Some(told) = bound.deviation(level, 0.0, f64::INFINITY) else {
                            continue;
                        };
                        let worst = bisected(&graph, depth, Square { corner, depth }, level);
                        assert!(worst <= told, "{round} {level}: {worst} > {told}");
                        assert!(best.deviation(level, 0.0, f64::INFINITY).unwrap() <= told);
                        tight += usize::from(worst > 0.6 * told);
                        known += 1;
                    }
                }
            }
        }
        assert!(
            known > 2000 && 4 * tight > known,
            "{tight} of {known} bounds are nearly reached"
        );
    }
}
