//! Bounds for the equal parts of a square in one analytic piece, from what is known about the whole square.
//!
//! The second derivatives over the square are a linear law and a rest. So in each part the middle of the law is a constant
//! form, and its change counts with the size of the part only: enclosing the square once serves all parts. The theorem of
//! `partners` holds with the square: its triangles may be of different sizes, and partners may be chosen with another frame
//! in each part.

use super::bound::ROUND_UP;
use super::partners::{Bound, Form, Framed, Place, length2, partners, popoviciu, room};
use super::pieces::Local;
use crate::ball::Ball;
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
    /// The size of a part as a share of the square's.
    share: f64,
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
    /// `n` parts along each direction.
    pub(super) fn new(framed: &Framed, place: &Place, local: &Local, n: u32) -> Self {
        let size = [0, 1].map(|d| place.uv[d].width() / local.half[d] * ROUND_UP);
        let [u, v] = size;
        let seconds = [u * u, u * v, v * v];
        let [x, y, across] = framed.errors();
        Self {
            share: 1.0 / f64::from(n),
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
    pub(super) fn all(&self) -> impl Iterator<Item = [Bound; 2]> {
        let n = (1.0 / self.share) as u32;
        let middle = |i: u32| (f64::from(i) + 0.5) * self.share - 0.5;
        (0..n * n).map(move |k| self.bounds([k / n, k % n].map(middle)))
    }

    /// That for the part with its middle there, in shares of the square from its middle.
    pub(super) fn bounds(&self, [x, y]: [f64; 2]) -> [Bound; 2] {
        let [uuu, uuv, uvv, vvv] = self.third;
        let (xx, xy, yy) = (0.5 * x * x, x * y, 0.5 * y * y);
        let a = self.first[0] + self.second[0] * x + self.second[1] * y;
        let a = a + uuu * xx + uuv * xy + uvv * yy;
        let b = self.first[1] + self.second[1] * x + self.second[2] * y;
        let b = b + uuv * xx + uvv * xy + vvv * yy;
        let area = a.cross(b);
        let z = area / area.length();
        let change = self.across(z, [x, y]);
        // What is not known about a and b, what they change within half a part, and rounding.
        let [far_x, far_y] = [x, y].map(|t| t.abs() + 0.5 * self.share);
        let half = 0.5 * self.share;
        let lengths = [a, b].map(DVec3::length);
        let unknown = [0, 1].map(|k| {
            let off = self.off[k] + self.rest[k] * far_x + self.rest[k + 1] * far_y;
            off.length() + ROUNDING * (lengths[k] + self.norms[k] + self.norms[k + 1])
        });
        let steep = [0, 1, 2].map(|k| change.greatest(k));
        let [turn_a, turn_b] = [0, 1].map(|k| (steep[k] + steep[k + 1]) * half + unknown[k]);
        let [far_a, far_b] =
            [0, 1].map(|k| (self.norms[k] + self.norms[k + 1]) * half + unknown[k]);
        let [long_a, long_b] = [lengths[0] + far_a, lengths[1] + far_b];
        let lost = lengths[0] * far_b + lengths[1] * far_a + far_a * far_b;
        let least = area.length() - lost - ROUNDING * long_a * long_b;
        // Without a normal there is no bound.
        let least = if least > 0.0 { least } else { f64::NAN };
        let tilt = (long_a * turn_b + long_b * turn_a) / least;
        let aside = (z - self.z).length();
        let within = [0, 1].map(|k| self.within[k] + aside * self.across[k]);
        let moved = within.map(|e| e / least);
        let whole = partners(self.norms, [long_a, long_b], moved, self.room);
        let (middle, rest) = (change.form.middle(), change.form.rest());
        let s = self.share;
        let (second, third) = (s * s, s * s * s);
        let bound = Bound {
            error: [0, 1].map(|k| (middle[k] + rest[k] + tilt * within[k]) * second),
            skew: change.skew().map(|x| x.map(|x| x * third)),
            cubic: change.cubic() * third,
            added: whole.added.map(|x| x * second * second),
            slip: whole.slip.map(|x| x * second),
            shift: 0.0,
        };
        let best = Bound {
            error: middle.map(|e| e * second),
            ..bound
        };
        [bound, best]
    }

    /// The second derivatives in a direction about a place.
    fn across(&self, z: DVec3, [x, y]: [f64; 2]) -> Change {
        let third = self.third.map(|t| z.dot(t));
        let size = z.abs();
        Change {
            form: Form([0, 1, 2].map(|k| {
                let [a, b] = [third[k] * x, third[k + 1] * y];
                let mid = z.dot(self.second[k]) + a + b;
                let rounding = ROUNDING * (self.norms[k] + a.abs() + b.abs());
                Ball {
                    mid,
                    rad: size.dot(self.rest[k]) + rounding,
                }
            })),
            third: third.map(f64::abs),
            half: 0.5 * self.share,
        }
    }
}

/// Rounding errors as a share of the terms.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The second derivatives of a component of the surface over a part of a square, along the sides of the square.
struct Change {
    /// In the middle, with how much they are off anywhere from their linear law.
    form: Form,
    /// The sizes of third derivatives.
    third: [f64; 4],
    /// Half the size of the part.
    half: f64,
}

impl Change {
    /// The greatest size of one of the second derivatives.
    fn greatest(&self, k: usize) -> f64 {
        self.form.0[k].mag() + (self.third[k] + self.third[k + 1]) * self.half
    }

    /// What the linear change adds at the border of the part, for a part as large as the square. The middles of longest
    /// sides are at most half a part away from its middle.
    fn skew(&self) -> [[f64; 2]; 2] {
        let half = self.third.map(|x| 0.5 * x);
        let [u, v] = [0, 1].map(|k| popoviciu([half[k], half[k + 1], half[k + 2]]));
        [0, 1].map(|k| [u[k], v[k]])
    }

    /// Likewise what it does within a triangle.
    fn cubic(&self) -> f64 {
        let [uuu, uuv, uvv, vvv] = self.third;
        CUBE * (uuu + vvv) + MIXED * (uuv + uvv)
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
