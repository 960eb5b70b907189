//! How far triangles are from the surface when sliding within it costs nothing.
//!
//! Let `B` be a rectangle of parameters cut into cells of size `Δu × Δv`, `L` the function linear on each triangle that
//! agrees with the surface `r` at the corners, all of which lie in one cell each, and `e = L - r`. Let `n` be a unit
//! vector, `π` the projection along it onto a plane, `f = π∘r`, `g = π∘L`, and `N = {a × b : a ∈ A, b ∈ B'}` for convex
//! sets `A ∋ r_u`, `B' ∋ r_v` over `B`. Suppose
//!
//! 1. `N·n > 0` for all these products, and
//! 2. every triangle is counter-clockwise around `n` after projection.
//!
//! **Theorem.** The two-sided Hausdorff distance between `r(B)` and `L(B)` is at most `√((ε + σδ)² + δ²)` with
//!
//! - `ε` the bound of the corollary in `bound` for the component along `N / N·n`: at most
//!   `⅛ (sup|N·r_uu| Δu² + 2 sup|N·r_uv| Δu Δv + sup|N·r_vv| Δv²) / inf N·n`,
//! - `σ = sup |πN| / inf N·n`, the greatest slope,
//! - `δ` the greatest distance within the plane between the projected sides of `B` and their chords.
//!
//! *Proof.* (a) For `p, p'` in `B` the vector `w = r(p') - r(p)` is `a du + b dv` with `a ∈ A`, `b ∈ B'`, the means of
//! the derivatives over the segment; so it is orthogonal to `N = a × b`. If `f(p) = f(p')` then `w ∥ n`, so `w·N = 0`
//! gives `w = 0`, and as `a`, `b` are independent `p = p'`: `f` is injective, `f(B)` is the closed inside of the curve
//! `f(∂B)`, and its degree is 1 inside and 0 outside.
//!
//! (b) Each piece of `f(∂B)` over a chord goes to the chord along segments no longer than `δ`. Let the tube be the union
//! of these segments. Each of its points is within `δ` of `f(∂B)` and of `g(∂B)`. The movement is a homotopy (moving on
//! along the chord itself to the linear parametrisation stays in `g(∂B)`), so at a point outside the tube `f` and `g`
//! have the same degree.
//!
//! (c) From the mesh to the surface: let `q = L(p)`, `y = π q`. If `y` is outside the tube then it lies in `f(B)`: the
//! degree of `g` there is positive, as all triangles have one orientation (if `y` lies on an edge, take a point close
//! by). So there is `p'` with `|f(p') - y| ≤ δ` in any case. With `w = r(p') - r(p)`, `N` as in (a): `q - r(p') = e - w
//! = t n + τ`, `|τ| ≤ δ`, and `N·w = 0` gives `t N·n = N·e - N·τ`, `|t| ≤ |N·e| / N·n + σδ`. The theorem in `bound`
//! for the component along the fixed vector `N` bounds `|N·e|`.
//!
//! (d) From the surface to the mesh: let `y = f(p)`. If `y` is not in `g(B)` then the degree of `g` there is 0 and that
//! of `f` is 1 (or `y` lies on `f(∂B)`), so `y` is in the tube. So there is `p'` with `|g(p') - y| ≤ δ` in any case, and
//! `L(p') - r(p) = e(p') + w` is bounded as before. ∎
//!
//! Condition 2 follows from 1 for triangles with two sides along u and v: their edges are `a du` and `b dv`. It is
//! checked for the others when they are made. Over a part of a side of length `Δ`, the curve `c = π r` leaves its chord
//! by at most `⅛ sup(|c' × c''| / |c'|) Δ²` across it, and not beyond its ends if `c'(s)·c'(t) > 0` for all `s, t`: the
//! chord is `Δ` times a mean of `c'`, and the distance from it a function of one variable that vanishes at both ends. A
//! straight side costs nothing, however uneven its parameter.
//!
//! # Beside a pole
//!
//! Let the side `v = v0` of `B` be one point, so that `r_u = 0` there and condition 1 fails. Let `h = |v - v0|` and let
//! `A` be a convex set that holds `±r_uv` over `B`, with the sign of `v - v0`. *The theorem holds as it stands.*
//!
//! *Proof.* `r_u(u, v) = h a` with `a ∈ A`, the mean of `±r_uv` over the way from the side. So `w = r(p') - r(p) = H a du
//! + b dv` with `H ≥ 0` the mean of `h` over the segment and `a ∈ A` a weighted mean, orthogonal to `N = a × b` as
//! before. In (a), `w = 0` gives `dv = 0` and `H du = 0`: `p = p'`, or both lie on the side. So `f` is injective but for
//! this side, which is one point of the closed curve `f(∂B)`; what follows about degrees stays. Triangles with two
//! corners on the side have no area: they add nothing to a degree, and are left out of the mesh, as the edge which they
//! would cover belongs to their neighbour. The other triangles have edges `h a du` and `b dv`. ∎
//!
//! A side that is one point only up to a size `η` (rounding) is treated as that of `r̃(u, v) = r(u, v) - r(u, v0) + P`
//! with a point `P` of it: `|r - r̃| ≤ η`, likewise for the two meshes, so their distance is at most `2η` more. `r̃`
//! differs from `r` in the derivatives by u alone, by those along the side.

use super::bound::{Bend, ROUND_UP};
use crate::box3::Box3;
use crate::interval::Interval;
use crate::surface::Surface;
use glam::{DMat3, DVec3};

/// A plane across which the surface is not steeper than this is used; a steeper one never gives a better bound.
const STEEP: f64 = 4.0;
/// A side of at most this share of the tolerance is one point.
pub(super) const NEGLIGIBLE: f64 = 1e-3;

/// The bound for one rectangle; `None` if condition 1 cannot be shown, or if it is not worth the enclosures of the sides
/// even if these turn out to be straight.
pub(super) fn slide(
    surface: &dyn Surface,
    uv: [Interval; 2],
    jet: &[Box3],
    plain: &Bend,
    tol: f64,
    worth: impl Fn(&Bend) -> bool,
) -> Option<Bend> {
    let tip = tip(surface, uv, jet, NEGLIGIBLE * tol);
    let lifted = tip.as_ref().map(|tip| tip.lift(jet.to_vec()));
    let jet = lifted.as_deref().unwrap_or(jet);
    let [along_u, along_v] = match &tip {
        Some(tip) => tip.directions(jet),
        None => [jet[1], jet[2]],
    };
    let (a, b) = (along_u.mid(), along_v.mid());
    let turn = frame(a, b)?;
    let normal = turn.row(2);
    let turned = |b: Box3| b.linear_image(&turn);
    let across = turned(along_u).cross(turned(along_v));
    let least = across.z.lo;
    if !(least > 0.0 && across.is_finite()) {
        return None;
    }
    let slope = plane(across).norm().hi / least;
    if slope > STEEP {
        return None;
    }
    let [du, dv] = uv.map(Interval::width);
    let part = |k: usize, size: f64| {
        across.dot(turned(jet[k])) / across.z * Interval::point(size * ROUND_UP)
    };
    let side = |dir: usize, at: f64| {
        let mut line = uv;
        line[1 - dir] = Interval::point(at);
        let mut d = surface.enclose(line, 2);
        if let Some(tip) = &tip {
            d = tip.lift(d);
        }
        let size = uv[dir].width();
        let bent = leave(plane(turned(d[1 + dir])), plane(turned(d[SECOND[dir]])));
        0.125 * bent * size * size * ROUND_UP
    };
    let straight = Bend {
        across: [part(3, du * du), part(4, du * dv), part(5, dv * dv)],
        slope: slope * ROUND_UP,
        shift: tip.as_ref().map_or(0.0, |tip| 2.0 * tip.size),
        normal: Some(normal),
        ..*plain
    };
    worth(&straight).then(|| Bend {
        within: [0, 1].map(|dir| {
            let ends = uv[1 - dir];
            side(dir, ends.lo).max(side(dir, ends.hi))
        }),
        ..straight
    })
}

/// Rows: along `first`, across it in the plane of both, along the normal.
pub(super) fn frame(first: DVec3, second: DVec3) -> Option<DMat3> {
    let normal = first.cross(second).try_normalize()?;
    let first = first.try_normalize()?;
    Some(DMat3::from_cols(first, normal.cross(first).normalize(), normal).transpose())
}

/// Where the first and the second derivatives along u and along v stand in a jet.
const FIRST: [usize; 2] = [1, 2];
const SECOND: [usize; 2] = [3, 5];

/// A side of a rectangle that is one point but for rounding.
pub(super) struct Tip {
    /// The direction along the side: 0 for u.
    pub(super) along: usize,
    upper: bool,
    /// The size of the side.
    pub(super) size: f64,
    /// The jet of order 2 over the side.
    jet: Vec<Box3>,
}

/// The side of a rectangle that is one point, up to a `size`; `None` if there is none, or several.
pub(super) fn tip(
    surface: &dyn Surface,
    uv: [Interval; 2],
    jet: &[Box3],
    size: f64,
) -> Option<Tip> {
    let mut found = None;
    for along in 0..2 {
        // Only a derivative that vanishes somewhere does so along a side.
        let first = jet[FIRST[along]];
        if !first.to_array().iter().all(|i| i.contains(0.0)) {
            continue;
        }
        for upper in [false, true] {
            let mut line = uv;
            let across = uv[1 - along];
            line[1 - along] = Interval::point(if upper { across.hi } else { across.lo });
            if surface.enclose(line, 0)[0].diagonal() <= size {
                if found.is_some() {
                    return None;
                }
                let jet = surface.enclose(line, 2);
                found = Some(Tip {
                    along,
                    upper,
                    size: jet[0].diagonal(),
                    jet,
                });
            }
        }
    }
    found.filter(|tip| tip.jet.iter().all(|b| b.is_finite()))
}

impl Tip {
    /// The jet of the surface whose side is one point exactly, from that of the surface, over any part of the rectangle.
    pub(super) fn lift(&self, mut jet: Vec<Box3>) -> Vec<Box3> {
        for k in [FIRST[self.along], SECOND[self.along]] {
            jet[k] = jet[k] - self.jet[k];
        }
        jet
    }

    /// What takes the place of the first derivatives.
    fn directions(&self, jet: &[Box3]) -> [Box3; 2] {
        let mixed = if self.upper {
            Box3::ZERO - jet[4]
        } else {
            jet[4]
        };
        match self.along {
            0 => [mixed, jet[2]],
            _ => [jet[1], mixed],
        }
    }
}

/// The part within the plane.
fn plane(b: Box3) -> Box3 {
    Box3 {
        z: Interval::ZERO,
        ..b
    }
}

/// `sup |c' × c''| / |c'|` for a curve in the plane, or `sup |c''|` if it may turn back.
fn leave(first: Box3, second: Box3) -> f64 {
    let length = first.norm().lo;
    // The mean of two vectors of the box is in the box.
    let forward = first.dot(first).lo > 0.0;
    let bent = second.norm().hi;
    if forward && length > 0.0 {
        (first.cross(second).z.mag() / length).min(bent)
    } else {
        bent
    }
}

/// True if a triangle is surely counter-clockwise around the normal, for points that are `rounding` away at most.
pub(super) fn is_turned([a, b, c]: [DVec3; 3], normal: DVec3, rounding: f64) -> bool {
    let (x, y) = (b - a, c - a);
    // Each corner moved changes the area by the length of the opposite edge, and by what moves with it.
    let margin = 4.0 * rounding * (x.length() + y.length() + rounding);
    normal.dot(x.cross(y)) > margin
}
