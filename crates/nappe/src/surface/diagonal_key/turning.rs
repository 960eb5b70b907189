//! The particular operator in space: a scaled rotation that follows the direction of d(1, v) smoothly.

use super::DiagonalKeyError;
use super::factor::Factored;
use crate::basis::{Functions, FunctionsRef};
use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit};
use crate::interval::Interval;
use crate::scalar::{Number, Pack};
use crate::series::{Series, series_cross, series_dot, series_norm2};
use glam::{DMat3, DVec3};

/// While `1 + a·e(v)` stays above this, the rotation is the direct one from a to e (e stays 26° away from -a). Smaller,
/// and the operator's derivatives would grow near -a; larger, and the direct rotation would be given up without need.
const DIRECT: f64 = 0.1;
/// No intermediate direction with a smaller margin `1 + b·e(v)` is accepted (e stays 20° away from -b). Smaller, and
/// the leaves of the direction's cover, which are up to [`LEAF`] wide, could touch -b.
const LEAST: f64 = 0.06;
/// The direction of g is covered by boxes whose half diagonal is at most this part of their distance from zero.
const LEAF: f64 = 0.1;
/// Halvings of a piece in the cover of the direction; a direction that turns faster is refused.
const DEPTH: usize = 24;
/// Halvings of a wide interval in an enclosure, where the whole one touches the singular direction.
const ENCLOSE_DEPTH: usize = 8;
/// Intermediate directions tried.
const CANDIDATES: usize = 200;

/// The nine entries, row by row, of `L(v) = s(v)/|d11| · R_{b→e(v)} R_{a→b}`, where `d(1, v) = s e` with a unit vector e
/// that is smooth also where d passes through zero, `a = d11/|d11|`, and b is a unit vector that keeps e away from -b.
///
/// `|g| R_{b→g/|g|} x = (b·g) x + (b×g)×x + (b×g)((b×g)·x)/(|g| + b·g)` has its only singularity at g = -|g| b.
#[derive(Clone, Debug)]
pub(super) struct Turning {
    d: Factored,
    b: DVec3,
    /// `R_{a→b}/|d11|`.
    first: DMat3,
    /// `1/|d11|`, for the bound that every rotation obeys.
    scale: f64,
}

impl Turning {
    /// From `d(1, v)`, three functions that vanish at 0 and are d11 at 1.
    pub(super) fn new(d: FunctionsRef, d11: DVec3, noise: f64) -> Result<Self, DiagonalKeyError> {
        let d = Factored::new(d, noise)?;
        let a = d11.normalize();
        let cover = cover(&d)?;
        let margin = |b: DVec3| {
            let start = (f64::INFINITY, 0.0);
            cover.iter().fold(start, |m, &(v, e)| {
                let x = 1.0 + b.dot(e);
                if x < m.0 { (x, v) } else { m }
            })
        };
        let mut b = a;
        if margin(a).0 < DIRECT {
            let mut best = margin(a);
            for c in candidates(a, &cover) {
                let m = margin(c);
                // A later candidate must be clearly better, so that rounding does not decide between equals.
                const CLEARLY: f64 = 1e-6;
                if m.0 > best.0 + CLEARLY {
                    (b, best) = (c, m);
                }
            }
            if best.0 < LEAST {
                let (_, g) = d.value(best.1, Limit::Above, 0);
                let d = DVec3::new(g[0].c[0], g[1].c[0], g[2].c[0]);
                return Err(DiagonalKeyError::Direction { v: best.1, d });
            }
        }
        let scale = 1.0 / d11.length();
        Ok(Self {
            first: rotation(a, b) * scale,
            d,
            b,
            scale,
        })
    }

    /// True if the rotation takes a to e directly.
    pub(super) fn is_direct(&self) -> bool {
        self.first == DMat3::IDENTITY * self.scale
    }

    /// The entries from the series of m and g; `None` if the denominator may vanish.
    fn entries<S: Number>(
        &self,
        m: &Series<S>,
        g: &[Series<S>; 3],
        regular: impl Fn(S) -> bool,
    ) -> Option<Vec<Series<S>>> {
        let order = m.order();
        let b = self
            .b
            .to_array()
            .map(|x| Series::constant(S::from(x), order));
        let dot = series_dot(&b, g);
        let c = series_cross(&b, g);
        let den = series_norm2(g).sqrt().add(&dot);
        if !regular(den.c[0]) {
            return None;
        }
        let direct = self.is_direct();
        let [x, y, z] = &c;
        let skew = [
            [None, Some((z, -1.0)), Some((y, 1.0))],
            [Some((z, 1.0)), None, Some((x, -1.0))],
            [Some((y, -1.0)), Some((x, 1.0)), None],
        ];
        let turned: Vec<Series<S>> = (0..9)
            .map(|i| {
                let (r, k) = (i / 3, i % 3);
                let square = if r == k { c[r].sqr() } else { c[r].mul(&c[k]) };
                let mut e = square.div(&den);
                if let Some((s, sign)) = skew[r][k] {
                    e = e.add(&s.scale(S::from(sign)));
                } else {
                    e = e.add(&dot);
                }
                e.mul(m)
            })
            .collect();
        if direct {
            return Some(
                turned
                    .iter()
                    .map(|e| e.scale(S::from(self.scale)))
                    .collect(),
            );
        }
        Some(
            (0..9)
                .map(|i| {
                    let (r, k) = (i / 3, i % 3);
                    let q = self.first.col(k).to_array().map(S::from);
                    turned[3 * r]
                        .scale(q[0])
                        .add(&turned[3 * r + 1].scale(q[1]))
                        .add(&turned[3 * r + 2].scale(q[2]))
                })
                .collect(),
        )
    }

    fn enclose_to_depth(
        &self,
        t: Interval,
        limit: Limit,
        order: usize,
        depth: usize,
        out: &mut [Interval],
    ) {
        let (m, g) = self.d.enclose(t, limit, order);
        // Each entry of a rotation is between -1 and 1, and rounding of `first` stays far below this slack.
        const SLACK: f64 = 1.0 + 1e-12;
        let bound =
            (m.c[0].abs() * series_norm2(&g).sqrt().c[0] * Interval::point(self.scale * SLACK)).hi;
        match self.entries(&m, &g, |x: Interval| x.lo > 0.0) {
            Some(entries) => write(&entries, order, out),
            None if depth > 0 && t.width() > 0.0 && t.lo < t.mid() && t.mid() < t.hi => {
                let m = t.mid();
                self.enclose_to_depth(Interval { hi: m, ..t }, limit, order, depth - 1, out);
                let mut upper = vec![Interval::ENTIRE; out.len()];
                self.enclose_to_depth(Interval { lo: m, ..t }, limit, order, depth - 1, &mut upper);
                for (o, u) in out.iter_mut().zip(upper) {
                    *o = o.hull(u);
                }
            }
            None => out.fill(Interval::ENTIRE),
        }
        if bound.is_finite() {
            for o in &mut out[..9] {
                *o = o.meet(Interval {
                    lo: -bound,
                    hi: bound,
                });
            }
        }
    }
}

/// Writes the derivatives of the entries.
fn write<S: Number>(entries: &[Series<S>], order: usize, out: &mut [S]) {
    let mut d = vec![S::ZERO; order + 1];
    for (i, e) in entries.iter().enumerate() {
        e.write_derivatives(&mut d);
        for (k, d) in d.iter().enumerate() {
            out[9 * k + i] = *d;
        }
    }
}

impl Functions for Turning {
    fn count(&self) -> usize {
        9
    }

    fn breaks(&self) -> &[Break] {
        self.d.breaks()
    }

    fn jet_into(&self, t: f64, limit: Limit, order: usize, out: &mut [f64]) {
        let (m, g) = self.d.value(t, limit, order);
        match self.entries(&m, &g, |_| true) {
            Some(entries) => write(&entries, order, out),
            None => out.fill(f64::NAN),
        }
    }

    fn pack_into(&self, t: Pack, limit: Limit, order: usize, out: &mut [Pack]) {
        let values = self.d.values(t, limit, order);
        match values.and_then(|(m, g)| self.entries(&m, &g, |_| true)) {
            Some(entries) => write(&entries, order, out),
            None => t.each_lane(out, |t, out| self.jet_into(t, limit, order, out)),
        }
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, order: usize, out: &mut [Interval]) {
        self.enclose_to_depth(t, limit, order, ENCLOSE_DEPTH, out);
    }
}

/// The rotation that takes the unit vector a to the unit vector b by the shortest way; b must not be -a.
fn rotation(a: DVec3, b: DVec3) -> DMat3 {
    if a == b {
        return DMat3::IDENTITY;
    }
    let (c, d) = (a.cross(b), a.dot(b));
    let f = 1.0 / (1.0 + d);
    let column = |x: DVec3| x * d + c.cross(x) + c * (c.dot(x) * f);
    DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
}

/// Directions of g so close together that every direction is within [`LEAF`] of one of them, with their parameters.
fn cover(d: &Factored) -> Result<Vec<(f64, DVec3)>, DiagonalKeyError> {
    let mut leaves = Vec::new();
    for (piece, limit) in d.breaks().parts(Interval::UNIT) {
        let mut todo = vec![(piece, 0)];
        while let Some((t, depth)) = todo.pop() {
            let (_, whole) = d.enclose(t, limit, 1);
            let m = t.mid();
            let (_, at) = d.enclose(Interval::point(m), limit, 0);
            let h = t - Interval::point(m);
            let g =
                Box3::from([0, 1, 2].map(|i| (at[i].c[0] + whole[i].c[1] * h).meet(whole[i].c[0])));
            let centre = g.mid();
            if g.is_finite()
                && 0.5 * g.diagonal() <= LEAF * centre.length()
                && centre != DVec3::ZERO
            {
                leaves.push((m, centre.normalize()));
            } else if depth == DEPTH || leaves.len() > 1 << 14 {
                return Err(DiagonalKeyError::Direction { v: m, d: centre });
            } else {
                todo.push((Interval { lo: m, ..t }, depth + 1));
                todo.push((Interval { hi: m, ..t }, depth + 1));
            }
        }
    }
    Ok(leaves)
}

/// Unit vectors spread over the sphere in a frame that turns with the data: its first axis is a, its second lies in
/// the plane of a and of the direction that leaves the line of a furthest.
fn candidates(a: DVec3, cover: &[(f64, DVec3)]) -> Vec<DVec3> {
    let off = |e: DVec3| e - a * e.dot(a);
    let mut furthest = DVec3::ZERO;
    for &(_, e) in cover {
        const CLEARLY: f64 = 1e-6;
        if off(e).length() > furthest.length() + CLEARLY {
            furthest = off(e);
        }
    }
    // If e never leaves the line of a, every direction square to a is as good as another.
    let y = furthest
        .try_normalize()
        .unwrap_or_else(|| a.any_orthonormal_vector());
    let z = a.cross(y);
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let n = CANDIDATES as f64;
    let mut all = vec![y, -y, z, -z];
    all.extend((0..CANDIDATES).map(|i| {
        let x = 1.0 - (2.0 * i as f64 + 1.0) / n;
        let (sin, cos) = (golden * i as f64).sin_cos();
        let r = (1.0 - x * x).sqrt();
        a * x + y * (r * cos) + z * (r * sin)
    }));
    all
}
