//! How far triangles are from the surface, and so how many are needed: partners with the same parameters.
//!
//! **Theorem.** Let `r` be C¹ with bounded second derivatives on a rectangle of size `Δu × Δv`. For every triangle
//! whose corners `p_i` lie in the rectangle and every `p = Σ λ_i p_i` (`λ_i ≥ 0, Σ λ_i = 1`)
//!
//! `|r(p) - Σ λ_i r(p_i)| ≤ ⅛ (‖r_uu‖ Δu² + 2 ‖r_uv‖ Δu Δv + ‖r_vv‖ Δv²)`,
//!
//! and the same holds for the component along any fixed vector.
//!
//! *Proof.* With `d_i = p_i - p`, Taylor's formula gives `r(p_i) = r(p) + Dr(p) d_i + ρ_i`,
//! `|ρ_i| ≤ ½ (‖r_uu‖ du_i² + 2 ‖r_uv‖ |du_i dv_i| + ‖r_vv‖ dv_i²)`. As `Σ λ_i d_i = 0` the linear terms cancel in the
//! mean. `Σ λ_i du_i²` is the variance of numbers in an interval of length `Δu`, so at most `Δu²/4` (Popoviciu), likewise
//! for v, and `Σ λ_i |du_i dv_i| ≤ Δu Δv / 4` by the inequality of Cauchy and Schwarz. ∎
//!
//! **Corollary.** Let `c` be the component along a fixed vector, `c_uu ≤ L`, `|c_uv| ≤ M`, `c_vv ≤ N`. Then
//!
//! `Σ λ_i c(p_i) - c(p) ≤ ⅛ max {L a² + 2 M a b + N b² : 0 ≤ a ≤ Δu, 0 ≤ b ≤ Δv}`,
//!
//! with `a²/4 = Σ λ_i du_i²` and `b²/4 = Σ λ_i dv_i²`; and so for `-c`. Where the surface is a saddle, L and N have
//! different signs and help each other, in both directions.
//!
//! If triangles cover the rectangle in the plane of the parameters, every point of the surface has its partner on the
//! mesh and every point of the mesh its partner on the surface: the bound is one for the two-sided Hausdorff distance.
//! If the corners are moved by at most `g` in space, partners are farther apart by at most `g`. The sharper bound of
//! `slide` takes nearer partners.

use crate::box3::Box3;
use crate::interval::{Interval, greater};
use crate::surface::{Surface, jet_len};
use glam::DVec3;

/// Covers the few roundings of the sums of positive numbers below.
pub(super) const ROUND_UP: f64 = 1.0 + 1e-14;
/// The most cells along one direction of a grid.
const MAX_CELLS: f64 = 1_048_576.0;
/// The steps in which grids are tried: finer gains no cells, coarser loses this share of them.
const STEP: f64 = 1.1;
/// Grids with this share of cells more are taken for better shaped triangles, for each factor e of the shape. Smaller, and
/// a twisted surface is cut into strips, which keep the distance with as few cells but not the normals and the area;
/// larger, and cells are less long than the curvatures ask for.
const SHAPE: f64 = 0.1;

/// A bound on the distance of a piece of surface from its n × m grid of triangles, with its parts for `n = m = 1`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bend {
    /// Second derivatives times `Δu²`, `Δu Δv` and `Δv²`: of the component across the surface, or symmetric intervals
    /// of their norms, which bound the components in all directions. They fall with 1/n², with 1/(n m) and with 1/m².
    pub(super) across: [Interval; 3],
    /// How far the sides along u and along v leave their chords within the surface: falls with 1/n² and with 1/m².
    pub(super) within: [f64; 2],
    /// What the part within the surface adds to the part across.
    pub(super) slope: f64,
    /// The ratio of the sizes along u and v.
    pub(super) aspect: f64,
    /// The rounding of parameters, as a share of the sizes.
    pub(super) grain: [f64; 2],
    /// What is lost whatever the grid.
    pub(super) shift: f64,
    /// The normal around which all triangles must be counter-clockwise, if the bound needs that.
    pub(super) normal: Option<DVec3>,
}

impl Bend {
    /// From enclosures (or samples) of a jet of order 2.
    pub(super) fn new(jet: &[Box3], uv: [Interval; 2]) -> Self {
        debug_assert_eq!(jet.len(), jet_len(2));
        let [du, dv] = uv.map(Interval::width);
        let norm = |k: usize| jet[k].norm().hi;
        let (lu, lv) = (norm(1) * du, norm(2) * dv);
        // Far from square is square enough: beyond this the shape decides nothing.
        let aspect = (lu / lv).clamp(1e-3, 1e3);
        Self {
            across: [norm(3) * du * du, norm(4) * du * dv, norm(5) * dv * dv]
                .map(|x| symmetric(x * ROUND_UP)),
            within: [0.0; 2],
            slope: 0.0,
            aspect: if aspect.is_nan() { 1.0 } else { aspect },
            grain: uv.map(|i| 2.0 * f64::EPSILON * i.mag() / i.width()),
            shift: 0.0,
            normal: None,
        }
    }

    /// The bound for the cells of an n × m grid.
    pub(super) fn deviation(&self, n: f64, m: f64) -> f64 {
        let (a, b) = (1.0 / n + self.grain[0], 1.0 / m + self.grain[1]);
        let [uu, uv, vv] = self.across;
        let mixed = uv.mag() * a * b;
        let (aa, bb) = (a * a, b * b);
        let above = reach(uu.hi * aa, mixed, vv.hi * bb);
        let below = reach(-uu.lo * aa, mixed, -vv.lo * bb);
        let across = 0.125 * greater(above, below);
        let within = (self.within[0] * a * a).max(self.within[1] * b * b);
        (length(across + self.slope * within, within) + self.shift) * ROUND_UP
    }

    /// A grid with few cells that keeps `tol`, at least `least` along each direction; `None` if there is none.
    pub(super) fn cells(&self, tol: f64, least: [f64; 2]) -> Option<[f64; 2]> {
        let mut m = fewest(|m| self.deviation(MAX_CELLS, m) <= tol, least[1])?;
        let mut n = fewest(|n| self.deviation(n, m) <= tol, least[0])?;
        let mut best = (f64::INFINITY, [n, m]);
        loop {
            let shape = (n / (m * self.aspect)).ln().abs();
            let cost = n * m * (1.0 + SHAPE * shape);
            if cost < best.0 {
                best = (cost, [n, m]);
            }
            m = (m * STEP).ceil().max(m + 1.0);
            if n <= least[0] || m > MAX_CELLS || m * least[0] > best.0 {
                return Some(best.1);
            }
            n = fewer(|n| self.deviation(n, m) <= tol, least[0], n);
        }
    }
}

/// The fewest cells that keep a tolerance, at least `least`; `None` if there are no such.
fn fewest(keeps: impl Fn(f64) -> bool, least: f64) -> Option<f64> {
    let mut n = least;
    while !keeps(n) {
        n *= 2.0;
        if n > MAX_CELLS {
            return None;
        }
    }
    Some(if n > least {
        between(keeps, 0.5 * n, n)
    } else {
        n
    })
}

/// The same if `n` keep it, and not many fewer are enough.
fn fewer(keeps: impl Fn(f64) -> bool, least: f64, mut n: f64) -> f64 {
    let mut step = 1.0;
    while n > least {
        let below = (n - step).max(least);
        if !keeps(below) {
            return between(keeps, below, n);
        }
        (n, step) = (below, 2.0 * step);
    }
    n
}

/// Bisects between too few cells and enough.
fn between(keeps: impl Fn(f64) -> bool, mut below: f64, mut n: f64) -> f64 {
    while n - below > 1.0 {
        let middle = (0.5 * (n + below)).floor();
        if keeps(middle) {
            n = middle;
        } else {
            below = middle;
        }
    }
    n
}

/// Quicker than what avoids overflow, beyond which there is no bound; what is lost below the smallest number is added.
fn length(x: f64, y: f64) -> f64 {
    (x * x + y * y + f64::MIN_POSITIVE).sqrt()
}

/// All numbers whose size is at most x; NaN stays unbounded.
fn symmetric(x: f64) -> Interval {
    if x.is_nan() {
        Interval::ENTIRE
    } else {
        Interval { lo: -x, hi: x }
    }
}

/// `max {uu s² + 2 uv s t + vv t² : 0 ≤ s, t ≤ 1}` for `uv ≥ 0`: at the origin, or on a side `s = 1` or `t = 1`, since the
/// form is homogeneous.
fn reach(uu: f64, uv: f64, vv: f64) -> f64 {
    // The maximum over 0 ≤ t ≤ 1 with s = 1.
    let side = |first: f64, second: f64| {
        if uv < -second {
            first + uv * uv / -second
        } else {
            first + 2.0 * uv + second
        }
    };
    greater(greater(side(uu, vv), side(vv, uu)), 0.0)
}

/// Samples for a bound that cannot be proven, in each direction.
const SAMPLES: usize = 5;
/// What an estimate from samples is enlarged by.
const MARGIN: f64 = 1.5;

/// A jet of order 2 whose boxes hold samples of the rectangle only; `None` if a sample is not finite.
pub(crate) fn sampled(surface: &dyn Surface, uv: [Interval; 2]) -> Option<Vec<Box3>> {
    let mut hull: Option<Vec<Box3>> = None;
    for k in 0..SAMPLES * SAMPLES {
        let at = |i: Interval, k: usize| {
            // Inside, so that the piece is unambiguous.
            i.lo + (i.hi - i.lo) * (k as f64 + 0.5) / SAMPLES as f64
        };
        let p = [at(uv[0], k / SAMPLES), at(uv[1], k % SAMPLES)];
        let jet = surface.jet(p, Default::default(), 2);
        if jet.d.iter().any(|d| !d.is_finite()) {
            return None;
        }
        let boxes = jet.d.iter().map(|&d| Box3::point(d * MARGIN));
        hull = Some(match hull {
            None => boxes.collect(),
            Some(h) => h.into_iter().zip(boxes).map(|(a, b)| a.hull(b)).collect(),
        });
    }
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With the bound `uu / n² + uv / (n m) + vv / m²`.
    fn bend([uu, uv, vv]: [f64; 3], within: [f64; 2]) -> Bend {
        Bend {
            across: [8.0 * uu, 4.0 * uv, 8.0 * vv].map(symmetric),
            within,
            slope: 0.1,
            aspect: 1.0,
            grain: [0.0; 2],
            shift: 0.0,
            normal: None,
        }
    }

    #[test]
    fn the_greatest_value_of_a_form_is_found() {
        let numbers = [-3.0, -1.0, -0.2, 0.0, 0.5, 1.0, 4.0];
        for (uu, vv) in numbers.into_iter().flat_map(|a| numbers.map(|b| (a, b))) {
            for uv in [0.0, 0.1, 0.7, 1.5, 6.0] {
                let at = |i: u32, j: u32| {
                    let (s, t) = (f64::from(i) / 200.0, f64::from(j) / 200.0);
                    uu * s * s + 2.0 * uv * s * t + vv * t * t
                };
                let found = (0..=200)
                    .flat_map(|i| (0..=200).map(move |j| at(i, j)))
                    .fold(0.0, f64::max);
                let bound = reach(uu, uv, vv);
                assert!(
                    found <= bound + 1e-12 && bound <= found + 1e-2,
                    "{uu} {uv} {vv}"
                );
            }
        }
    }

    #[test]
    fn grids_keep_the_bound_and_are_small() {
        for [uu, uv, vv] in [
            [1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, 1.0, 0.0],
            [1.0, 0.5, 2.0],
            [1e3, 1.0, 1e-6],
            [0.0, 0.0, 0.0],
        ] {
            for tol in [1e-1, 1e-3, 1e-6] {
                let bend = bend([uu, uv, vv], [0.0; 2]);
                let [n, m] = bend.cells(tol, [1.0, 1.0]).expect("finite");
                assert!(bend.deviation(n, m) <= tol);
                // The continuous optimum is (2 √(uu vv) + uv) / tol cells, or a strip.
                let area = (2.0 * (uu * vv).sqrt() + uv) / tol;
                let strip = (uu / tol).sqrt().max((vv / tol).sqrt());
                assert!(
                    n * m <= 1.3 * area + 2.0 * strip + 2.0,
                    "{n} {m} for {bend:?} {tol}"
                );
            }
        }
        let cylinder = bend([1.0, 0.0, 0.0], [0.0; 2]);
        assert_eq!(cylinder.cells(1.001e-4, [4.0, 1.0]), Some([100.0, 1.0]));
        let sector = bend([0.0; 3], [0.0, 1.0]);
        assert_eq!(sector.cells(1.006e-4, [1.0, 1.0]), Some([1.0, 100.0]));
        let torn = bend([f64::INFINITY, 0.0, 0.0], [0.0; 2]);
        assert_eq!(torn.cells(1.0, [1.0, 1.0]), None);
        let unknown = bend([f64::NAN, 0.0, 0.0], [0.0; 2]);
        assert_eq!(unknown.cells(1.0, [1.0, 1.0]), None);
    }
}
