//! Bounds for the equal parts of a square in one analytic piece, from what is known about the whole square.
//!
//! The second derivatives over the square are a linear law and a rest. So in each part the middle of the law is a constant
//! form, and its change counts with the size of the part only: enclosing the square once serves all parts. The theorem of
//! `partners` holds with the square: its triangles may be of different sizes, and partners may be chosen with another frame
//! in each part.

use super::bound::ROUND_UP;
use super::partners::{Bound, Framed, Place, length2, middle, partners, rest, room};
use super::pieces::Local;
use crate::scalar::Pack;
use crate::simd::{InstructionSet, Kernel, Lanes, Registers, Single, cross, dot};
use glam::DVec3;

/// The greatest errors of linear interpolation of x³/6 and of x² y/2 on the triangles, with x = y = 0 in the middle of the
/// longest side and legs of length 1 or √½: those of x/24 - x³/6 and y (¼ - x²)/2 (`√3/216` < 0.0081, with room to
/// spare, and ⅟16).
const CUBE: f64 = 0.009;
const MIXED: f64 = 0.0625;

/// The equal parts of a square over which the second derivatives change about linearly. Each has its own frame.
///
/// Let z be the normal in the middle of a part, and the tangents there be a and b along its sides. Within the part they
/// change by no more than A and B, in z by no more than `A_z` and `B_z`. Then `|N_xy| ≤ (|a| + A) B_z + (|b| + B) A_z` and
/// `N_z ≥ |a × b| - |a| B - |b| A - A B`, and of `e` there remains at most `|e_z| + |e_xy| |N_xy| / N_z`.
pub(super) struct Parts {
    /// The number of parts along each direction.
    count: usize,
    room: [f64; 2],
    /// The normal of the square's frame, and how far `e` goes within the plane across and out of it.
    z: DVec3,
    within: [f64; 2],
    across: [f64; 2],
    norms: [f64; 3],
    /// The derivatives in the middle of the square along its sides, with how much they are off: the first there, the
    /// second from their linear law anywhere.
    first: [DVec3; 2],
    off: [DVec3; 2],
    second: [DVec3; 3],
    third: [DVec3; 4],
    rest: [DVec3; 3],
}

impl Parts {
    /// So many parts along each direction.
    pub(super) fn new(framed: &Framed, place: &Place, local: &Local, count: usize) -> Self {
        let size = [0, 1].map(|d| place.uv[d].width() / local.half[d] * ROUND_UP);
        let [u, v] = size;
        let seconds = [u * u, u * v, v * v];
        let [x, y, across] = framed.errors();
        Self {
            count,
            room: room(place),
            z: framed.turn.row(2),
            within: [0, 1].map(|k| length2(x[k], y[k])),
            across,
            norms: framed.sized.norms(),
            first: [0, 1].map(|k| local.first[k] * size[k]),
            off: [0, 1].map(|k| local.off[k] * size[k]),
            second: [0, 1, 2].map(|k| local.second[k] * seconds[k]),
            third: [
                local.third[0] * (u * u * u),
                local.third[1] * (u * u * v),
                local.third[2] * (u * v * v),
                local.third[3] * (v * v * v),
            ],
            rest: [0, 1, 2].map(|k| local.rest[k] * seconds[k]),
        }
    }

    /// The bounds for all parts, v fastest, in terms of the parts, each with what could be said at best.
    pub(super) fn all(&self) -> Vec<[Bound; 2]> {
        let mut out = Vec::with_capacity(self.count * self.count);
        InstructionSet::best().run(All {
            parts: self,
            out: &mut out,
        });
        out
    }

    /// The bound for the square, if it is the only part.
    pub(super) fn whole(&self) -> Bound {
        self.bounds([Lanes(Single, 0.0); 2]).map(|x| x.1).told()[0]
    }

    /// Those for parts with their middles there, in shares of the square from its middle.
    #[inline(always)]
    fn bounds<R: Registers>(&self, [x, y]: [Lanes<R>; 2]) -> Bounds<Lanes<R>> {
        let r = x.0;
        let zero = Lanes::splat(r, 0.0);
        let share = 1.0 / self.count as f64;
        let half = 0.5 * share;
        let norms = splat(r, self.norms);
        // The first derivatives in the middle, and a normal.
        let (xx, xy, yy) = (x * x * 0.5, x * y, y * y * 0.5);
        let mut first = [[zero; 3]; 2];
        for k in 0..2 {
            for c in 0..3 {
                let linear = x * self.second[k][c] + y * self.second[k + 1][c];
                let [p, q, s] = [0, 1, 2].map(|i| self.third[k + i][c]);
                first[k][c] = linear + xx * p + xy * q + yy * s + Lanes::splat(r, self.first[k][c]);
            }
        }
        let area = cross(&first[0], &first[1]);
        let size = dot(&area, &area).sqrt();
        let z = [area[0] / size, area[1] / size, area[2] / size];
        // The second derivatives along it: what they are in the middle, and how much they are off anywhere from their linear
        // law. The sizes of the third.
        let mut third = [zero; 4];
        for k in 0..4 {
            third[k] = dot(&z, &splat(r, self.third[k].to_array()));
        }
        let sizes = [z[0].abs(), z[1].abs(), z[2].abs()];
        let [mut mid, mut rad] = [[zero; 3]; 2];
        for k in 0..3 {
            let (p, q) = (third[k] * x, third[k + 1] * y);
            mid[k] = dot(&z, &splat(r, self.second[k].to_array())) + p + q;
            let rounding = (norms[k] + p.abs() + q.abs()) * ROUNDING;
            rad[k] = dot(&sizes, &splat(r, self.rest[k].to_array())) + rounding;
        }
        for k in 0..4 {
            third[k] = third[k].abs();
        }
        // What is not known about the first derivatives, what they change within half a part, and rounding.
        let (far_x, far_y) = (x.abs() + Lanes::splat(r, half), y.abs() + Lanes::splat(r, half));
        let mut steep = [zero; 3];
        for k in 0..3 {
            let most = (mid[k].abs() + rad[k]) * ROUND_UP;
            steep[k] = most + (third[k] + third[k + 1]) * half;
        }
        let [mut lengths, mut turn, mut change, mut long] = [[zero; 2]; 4];
        for k in 0..2 {
            lengths[k] = dot(&first[k], &first[k]).sqrt();
            let mut off = [zero; 3];
            for c in 0..3 {
                let known = Lanes::splat(r, self.off[k][c]);
                off[c] = known + far_x * self.rest[k][c] + far_y * self.rest[k + 1][c];
            }
            let unknown = dot(&off, &off).sqrt();
            let unknown = unknown + (lengths[k] + norms[k] + norms[k + 1]) * ROUNDING;
            turn[k] = (steep[k] + steep[k + 1]) * half + unknown;
            change[k] = (norms[k] + norms[k + 1]) * half + unknown;
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
            moved[k] = within[k] / least;
        }
        let [mut added, mut slip] = partners(norms, long, moved, splat(r, self.room));
        let (mut best, off) = (middle(mid), rest(rad));
        // The middles of longest sides are at most half a part away from its middle.
        let skew_u = rest([third[0], third[1], third[2]]);
        let skew_v = rest([third[1], third[2], third[3]]);
        let (second, cubed) = (share * share, share * share * share);
        let (mut error, mut skew) = ([zero; 2], [[zero; 2]; 2]);
        for k in 0..2 {
            error[k] = (best[k] + off[k] + tilt * within[k]) * second;
            best[k] = best[k] * second;
            skew[k] = [skew_u[k] * (0.5 * cubed), skew_v[k] * (0.5 * cubed)];
            added[k] = added[k] * (second * second);
            slip[k] = slip[k] * second;
        }
        let cubic = (third[0] + third[3]) * CUBE + (third[1] + third[2]) * MIXED;
        Bounds {
            error,
            best,
            skew,
            cubic: cubic * cubed,
            added,
            slip,
        }
    }
}

/// Rounding errors as a share of the terms.
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
struct Bounds<T> {
    error: [T; 2],
    /// Instead of `error`, what could be said at best.
    best: [T; 2],
    skew: [[T; 2]; 2],
    cubic: T,
    added: [T; 2],
    slip: [T; 2],
}

impl<T> Bounds<T> {
    #[inline(always)]
    fn map<S>(&self, of: impl Fn(&T) -> S) -> Bounds<S> {
        let both = |x: &[T; 2]| [of(&x[0]), of(&x[1])];
        Bounds {
            error: both(&self.error),
            best: both(&self.best),
            skew: [both(&self.skew[0]), both(&self.skew[1])],
            cubic: of(&self.cubic),
            added: both(&self.added),
            slip: both(&self.slip),
        }
    }
}

impl Bounds<f64> {
    /// The bound, and what it could be at best.
    fn told(self) -> [Bound; 2] {
        let bound = Bound {
            error: self.error,
            skew: self.skew,
            cubic: self.cubic,
            added: self.added,
            slip: self.slip,
            shift: 0.0,
        };
        let error = self.best;
        [bound, Bound { error, ..bound }]
    }
}

/// The bounds for all parts, a register of them at a time.
struct All<'a> {
    parts: &'a Parts,
    out: &'a mut Vec<[Bound; 2]>,
}

impl Kernel for All<'_> {
    #[inline(always)]
    fn run<R: Registers>(self, r: R) {
        let n = self.parts.count;
        let share = 1.0 / n as f64;
        for first in (0..n * n).step_by(R::LANES) {
            let [mut x, mut y] = [[0.0; Pack::LANES]; 2];
            for lane in 0..R::LANES {
                let k = first + lane;
                x[lane] = ((k / n) as f64 + 0.5) * share - 0.5;
                y[lane] = ((k % n) as f64 + 0.5) * share - 0.5;
            }
            let bounds = self.parts.bounds([Lanes::load(r, &x), Lanes::load(r, &y)]);
            let bounds = bounds.map(
                #[inline(always)]
                |x| {
                    let mut all = [0.0; Pack::LANES];
                    x.store(&mut all);
                    all
                },
            );
            for lane in 0..R::LANES.min(n * n - first) {
                self.out.push(bounds.map(|x| x[lane]).told());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::bisection::{Bisection, Square};
    use super::*;
    use crate::box3::Box3;
    use crate::interval::Interval;
    use crate::laws::Random;

    /// `z = f(x, y)` with a function of third order: its second and third derivatives at the origin.
    struct Graph {
        second: [f64; 3],
        third: [f64; 4],
    }

    impl Graph {
        fn point(&self, [x, y]: [f64; 2]) -> DVec3 {
            let ([a, b, c], [p, q, r, s]) = (self.second, self.third);
            let quadratic = 0.5 * (a * x * x + 2.0 * b * x * y + c * y * y);
            let cubic = p * x * x * x + 3.0 * (q * x * x * y + r * x * y * y) + s * y * y * y;
            DVec3::new(x, y, quadratic + cubic / 6.0)
        }

        /// The derivatives over a square around the origin.
        fn jet(&self, half: f64) -> [Box3; 6] {
            let t = Interval::new(-half, half);
            let n = Interval::point;
            let ([a, b, c], [p, q, r, s]) = (self.second.map(n), self.third.map(n));
            let slope = |a, b, p, q, r| {
                a * t + b * t + (p * t * t + n(2.0) * q * t * t + r * t * t) * n(0.5)
            };
            let boxed = |x: f64, y: f64, z: Interval| Box3::from([n(x), n(y), z]);
            [
                Box3::from([t, t, Interval::ENTIRE]),
                boxed(1.0, 0.0, slope(a, b, p, q, r)),
                boxed(0.0, 1.0, slope(b, c, q, r, s)),
                boxed(0.0, 0.0, a + p * t + q * t),
                boxed(0.0, 0.0, b + q * t + r * t),
                boxed(0.0, 0.0, c + r * t + s * t),
            ]
        }

        fn local(&self) -> Local {
            Local {
                half: [1.0; 2],
                first: [DVec3::X, DVec3::Y],
                off: [DVec3::ZERO; 2],
                second: self.second.map(|d| d * DVec3::Z),
                third: self.third.map(|d| d * DVec3::Z),
                rest: [DVec3::ZERO; 3],
            }
        }

        /// The distance of a point, near which the surface is over a place.
        fn distance(&self, p: DVec3, mut at: [f64; 2]) -> f64 {
            const H: f64 = 1e-5;
            for _ in 0..4 {
                let off = p - self.point(at);
                let slope = |x: f64, y: f64| {
                    let [a, b] = [1.0, -1.0].map(|s| self.point([at[0] + s * x, at[1] + s * y]));
                    (a - b) / (2.0 * H)
                };
                let (a, b) = (slope(H, 0.0), slope(0.0, H));
                let n = a.cross(b);
                let area = n.length_squared();
                at[0] += off.cross(b).dot(n) / area;
                at[1] += a.cross(off).dot(n) / area;
            }
            p.distance(self.point(at))
        }
    }

    /// The greatest distance of the triangles of a part after some bisections.
    fn bisected(graph: &Graph, depth: u32, part: Square, level: u32) -> f64 {
        let lines = [vec![-0.5, 0.5], vec![-0.5, 0.5]];
        let mut net = Bisection::new(lines);
        net.refine(Square::cell([0, 0]), 2 * depth);
        net.refine(part, level);
        let [lower, upper] = [net.uv(part.corner), net.uv(part.upper())];
        let numbered = net.numbered();
        let mut worst = 0.0f64;
        numbered.triangles([0, 0], |t| {
            let corners = t.map(|k| net.uv(numbered.places[k as usize]));
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
            let graph = Graph { second, third };
            let framed = Framed::new(&place, &graph.jet(0.5625)).expect("the normal stays up");
            for depth in 0..3 {
                let parts = Parts::new(&framed, &place, &graph.local(), 1 << depth);
                let all = Square::cell([0, 0]).parts(depth).zip(parts.all());
                for (k, (part, [bound, best])) in all.enumerate() {
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
}
