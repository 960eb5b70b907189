//! How far a surface may be from chords and triangles between its points.
//!
//! Partners have the same parameters, as in `mesh/bound.rs`; what is new is that a triangle is judged by its own sides,
//! and that first derivatives may jump at lines inside.
//!
//! **Theorem.** Let `r` be continuous on a rectangle of size `Δu × Δv`, and C¹ with bounded second derivatives but at lines
//! `u = const`, where `r_u` jumps by no more than `κ_u` in all, and lines `v = const`, where `r_v` jumps by no more than
//! `κ_v`. Let `Q = (Q_uu, Q_uv, Q_vv)` be any three vectors and the second derivatives be no farther from them than `ρ_uu`,
//! `ρ_uv`, `ρ_vv`. Then for every triangle with corners `p_i` in the rectangle, with `q_ij = Q[p_i - p_j]` for its sides,
//!
//! `|r(p) - Σ λ_i r(p_i)| ≤ max {⅛ |q_ij|, ¹⁄₂₄ |2 q_ij + q_jk + q_ki|} + ⅛ (ρ_uu Δu² + 2 ρ_uv Δu Δv + ρ_vv Δv²) + ½ (κ_u Δu + κ_v Δv)`,
//!
//! the maximum over the three sides.
//!
//! *Proof.* With `d_i = p_i - p`, Taylor's formula gives `r(p_i) = r(p) + Dr(p) d_i + ½ Q[d_i] + ρ_i + k_i`: `ρ_i` from the
//! rest of the second derivatives, and `|k_i| ≤ κ_u |du_i| + κ_v |dv_i|`, since along the way to `p_i` only what crosses
//! a line jumps. In the mean the linear terms cancel, `ρ_i` is bounded as in `mesh/bound.rs`, and the mean of `|du_i|` is at
//! most the root of that of `du_i²`, so `Δu/2`. Now `Σ λ_i Q[d_i] = Σ_{i<j} λ_i λ_j q_ij`. The three products are not
//! negative, two of them add to no more than ¼, being `λ (1 - λ)`, and all three to no more than ⅓. So they lie in a polytope
//! with the corners 0, (¼, 0, 0), (⅙, ¹⁄₁₂, ¹⁄₁₂) and their permutations, and a norm is greatest at corners. ∎
//!
//! A chord is a triangle without one of its sides: ⅛ |q| is enough.

use super::chart::Chart;
use crate::box3::Box3;
use crate::breaks::{Breaks, Limit};
use crate::interval::{Interval, greater};
use crate::mesh::sampled;
use crate::surface::{Dir, enclose_direct, jet_index, jet_len};
use glam::DVec3;
use smallvec::SmallVec;

/// How far a surface may be from its chords and triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bend {
    pub(super) bound: f64,
    pub(super) proven: bool,
    /// What u and v add to it.
    pub(super) terms: [f64; 2],
}

/// Covers the roundings of the sums of positive numbers.
const ROUND_UP: f64 = 1.0 + 1e-12;
/// And of others, as a share of the sum of their sizes.
const CANCELLED: f64 = 1e-14;

/// Strips beyond creases that are no wider than this share of the domain are rounding.
const GRAIN: f64 = 1e-12;
/// Or as this share of what is enough, in space.
const SLIGHT: f64 = 1e-3;

/// Strips with the direction in which they are narrow.
type Strips = SmallVec<[(usize, [Interval; 2]); 2]>;

/// What is known of second derivatives over a rectangle, and of jumps of the first.
struct Second {
    /// The rectangle: corners beyond it count as if they were on its border.
    uv: [Interval; 2],
    width: [f64; 2],
    middle: [DVec3; 3],
    rest: [f64; 3],
    norms: [f64; 3],
    kinks: [f64; 2],
    /// How far points are moved that are beyond a crease by hardly anything.
    moved: f64,
    /// The size of the box of the surface.
    whole: f64,
    proven: bool,
}

impl Second {
    /// `⅛ (a Δu² + 2 b Δu Δv + c Δv²)`.
    fn form(&self, [a, b, c]: [f64; 3]) -> f64 {
        let [du, dv] = self.width;
        0.125 * (a * du * du + 2.0 * b * du * dv + c * dv * dv)
    }

    /// `Q` for a side.
    fn along(&self, [a, b]: [[f64; 2]; 2]) -> DVec3 {
        let [u, v] = [0, 1].map(|d| {
            let Interval { lo, hi } = self.uv[d];
            b[d].clamp(lo, hi) - a[d].clamp(lo, hi)
        });
        let [uu, uv, vv] = self.middle;
        uu * (u * u) + uv * (2.0 * u * v) + vv * (v * v)
    }

    /// The bound, with the one for the middle of the second derivatives.
    fn bend(&self, own: f64) -> Bend {
        let [du, dv] = self.width;
        let any = self.form(self.norms);
        let own = own + self.form(self.rest) + CANCELLED * any;
        // What is not known is no bound.
        let least = if own < any { own } else { any };
        let kinks = 0.5 * (self.kinks[0] * du + self.kinks[1] * dv);
        let bound = (least + kinks + 3.0 * self.moved) * ROUND_UP;
        Bend {
            bound: if bound < self.whole {
                bound
            } else {
                self.whole
            },
            proven: self.proven,
            terms: [self.norms[0] * du * du, self.norms[2] * dv * dv],
        }
    }

    fn triangle(&self, p: [[f64; 2]; 3]) -> Bend {
        let q = [0, 1, 2].map(|k| self.along([p[k], p[(k + 1) % 3]]));
        let sum = q[0] + q[1] + q[2];
        let all = q.map(|q| greater(0.125 * q.length(), (q + sum).length() / 24.0));
        self.bend(all.into_iter().fold(0.0, greater))
    }

    fn chord(&self, p: [[f64; 2]; 2]) -> Bend {
        self.bend(0.125 * self.along(p).length())
    }

    /// Both ways to halve a rectangle.
    fn cell(&self) -> Bend {
        let [u, v] = self.uv;
        let a = self.triangle([[u.lo, v.lo], [u.hi, v.lo], [u.hi, v.hi]]);
        let b = self.triangle([[u.lo, v.lo], [u.hi, v.lo], [u.lo, v.hi]]);
        if a.bound > b.bound { a } else { b }
    }
}

/// The range of some parameters.
fn around(p: &[[f64; 2]]) -> [Interval; 2] {
    [0, 1].map(|d| {
        let of = p.iter().map(|p| p[d]);
        let (lo, hi) = of.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
            (a.min(x), b.max(x))
        });
        Interval::new(lo, hi)
    })
}

impl Chart<'_> {
    /// A triangle, perhaps beyond the domain by periods. Sharper enclosures are looked for while the bound is greater
    /// than `enough`; likewise below.
    pub(super) fn triangle(&self, p: [[f64; 2]; 3], enough: f64) -> Bend {
        self.sharpened(around(&p), enough, |s| s.triangle(p))
    }

    /// A chord.
    pub(super) fn chord(&self, p: [[f64; 2]; 2], enough: f64) -> Bend {
        self.sharpened(around(&p), enough, |s| s.chord(p))
    }

    /// The halves of a rectangle.
    pub(super) fn cell(&self, uv: [Interval; 2], enough: f64) -> Bend {
        self.sharpened(uv, enough, Second::cell)
    }

    fn sharpened(&self, uv: [Interval; 2], enough: f64, bend: impl Fn(&Second) -> Bend) -> Bend {
        let first = bend(&self.second(uv, enough, false));
        if first.bound <= enough {
            return first;
        }
        let sharp = bend(&self.second(uv, enough, true));
        if sharp.bound < first.bound {
            sharp
        } else {
            first
        }
    }

    fn second(&self, uv: [Interval; 2], enough: f64, centred: bool) -> Second {
        let (near, beyond) = self.clipped(uv, enough);
        let mut new = self.inside(near, centred);
        for (d, strip) in beyond {
            // All points of the strip go to its inner end, the corners and what is between them: three times.
            let parts = [0, 1].map(|d| self.parts(d, strip[d]));
            let mut most = 0.0;
            for u in &parts[0] {
                for v in &parts[1] {
                    let boxes = enclose_direct(self.surface, [*u, *v], 1);
                    most = greater(most, boxes[1 + d].norm().hi);
                    new.whole += boxes[0].diagonal();
                }
            }
            new.moved += most * strip[d].width();
        }
        new
    }

    /// A rectangle without strips beyond creases and seams that are only as wide as rounding makes them, and these.
    fn clipped(&self, uv: [Interval; 2], enough: f64) -> ([Interval; 2], Strips) {
        let mut near = uv;
        let mut beyond = Strips::new();
        for d in 0..2 {
            let (own, period) = (self.domain[d], self.period[d]);
            let rounding = GRAIN * (own.width() + own.mag());
            let grain = rounding.max(SLIGHT * enough * own.width() / self.size);
            let turn = period.map_or(0.0, |p| ((uv[d].lo - own.lo) / p).floor() * p);
            let lifts = [turn, turn + period.unwrap_or(0.0)];
            let seams = period.into_iter().flat_map(|_| lifts.map(|l| own.lo + l));
            let creases = self.creases(d).iter().flat_map(|c| lifts.map(|l| c + l));
            for c in seams.chain(creases) {
                let Interval { lo, hi } = near[d];
                let mut strip = uv;
                if lo < c && c - lo <= grain && hi - c > grain {
                    near[d].lo = c;
                    strip[d] = Interval::new(lo, c);
                } else if c < hi && hi - c <= grain && c - lo > grain {
                    near[d].hi = c;
                    strip[d] = Interval::new(c, hi);
                } else {
                    continue;
                }
                beyond.push((d, strip));
            }
        }
        (near, beyond)
    }

    fn inside(&self, uv: [Interval; 2], centred: bool) -> Second {
        let parts = [0, 1].map(|d| self.parts(d, uv[d]));
        let mut new = Second {
            uv,
            width: uv.map(Interval::width),
            middle: [DVec3::ZERO; 3],
            rest: [f64::INFINITY; 3],
            norms: [0.0; 3],
            kinks: [0, 1].map(|d| self.kinks(d, &parts)),
            moved: 0.0,
            whole: f64::INFINITY,
            proven: true,
        };
        let mut hull: Option<Vec<Box3>> = None;
        for u in &parts[0] {
            for v in &parts[1] {
                let mut boxes = if centred {
                    self.surface.enclose([*u, *v], 2)
                } else {
                    enclose_direct(self.surface, [*u, *v], 2)
                };
                if !boxes[3..6].iter().all(|b| b.is_finite()) && !boxes[0].is_finite() {
                    new.proven = false;
                    match sampled(self.surface, [*u, *v]) {
                        Some(jet) => boxes = jet,
                        None => return new,
                    }
                }
                for k in 0..3 {
                    new.norms[k] = greater(new.norms[k], boxes[3 + k].norm().hi);
                }
                hull = Some(match hull {
                    None => boxes,
                    Some(h) => h.iter().zip(boxes).map(|(a, b)| a.hull(b)).collect(),
                });
            }
        }
        if let Some(hull) = hull {
            new.whole = hull[0].diagonal();
            for k in 0..3 {
                let b = hull[3 + k];
                if b.is_finite() {
                    new.middle[k] = b.mid();
                    new.rest[k] = (b - Box3::point(b.mid())).norm().hi;
                }
            }
        }
        new
    }

    /// By how much the derivative in one direction jumps inside a range, over the other: in all.
    fn kinks(&self, d: usize, parts: &[SmallVec<[Interval; 2]>; 2]) -> f64 {
        let domain = self.domain[d];
        let over = &parts[1 - d];
        let mut sum = 0.0;
        for p in &parts[d] {
            for &c in self.creases(d) {
                if p.lo < c && c < p.hi {
                    sum += self.kink(d, [c, c], over);
                }
            }
        }
        // Round the seam, once or all around.
        let whole = self.period[d].is_some() && parts[d].contains(&domain);
        if parts[d].len() > 1 || whole {
            sum += self.kink(d, [domain.hi, domain.lo], over);
        }
        sum
    }

    /// The jump from below one parameter to above another: a centred form, since the sides most often agree.
    fn kink(&self, d: usize, at: [f64; 2], over: &[Interval]) -> f64 {
        let dir = if d == 0 { Dir::V } else { Dir::U };
        let breaks = self.surface.breaks(dir);
        let parts = over.iter().flat_map(|t| breaks.parts(*t));
        let mut greatest = 0.0;
        for (t, limit) in parts {
            // The derivatives by the other parameter of the jump.
            let jump = |t: Interval, order: usize| {
                let side = |at: f64, from: Limit| {
                    let mut boxes = vec![Box3::ENTIRE; jet_len(order)];
                    let (across, along) = ([(Interval::point(at), from)], [(t, limit)]);
                    let parts = if d == 0 {
                        [&across[..], &along[..]]
                    } else {
                        [&along[..], &across[..]]
                    };
                    self.surface.enclose_pieces(parts, order, &mut boxes);
                    boxes
                };
                let (a, b) = (side(at[0], Limit::Below), side(at[1], Limit::Above));
                (0..order)
                    .map(|k| {
                        let k = if d == 0 {
                            jet_index(1, k)
                        } else {
                            jet_index(k, 1)
                        };
                        a[k] - b[k]
                    })
                    .collect::<Vec<Box3>>()
            };
            let (middle, all) = (jump(Interval::point(t.mid()), 2), jump(t, 3));
            let h = t - Interval::point(t.mid());
            let centred =
                middle[0] + middle[1].scale(h) + all[2].scale(h.sqr() * Interval::point(0.5));
            let [a, b] = [centred.norm().hi, all[0].norm().hi];
            greatest = greater(greatest, if a < b { a } else { b });
        }
        greatest
    }
}
