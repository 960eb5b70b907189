//! How far triangles are from the surface, and so how many are needed.
//!
//! **Theorem.** Let `r` be C¹ with bounded second derivatives on a rectangle of size `Δu × Δv`. For every triangle
//! whose corners `p_i` lie in the rectangle and every `p = Σ λ_i p_i` (`λ_i ≥ 0, Σ λ_i = 1`)
//!
//! `|r(p) - Σ λ_i r(p_i)| ≤ ⅛ (‖r_uu‖ Δu² + 2 ‖r_uv‖ Δu Δv + ‖r_vv‖ Δv²)`.
//!
//! *Proof.* With `d_i = p_i - p`, Taylor's formula gives `r(p_i) = r(p) + Dr(p) d_i + ρ_i`,
//! `|ρ_i| ≤ ½ (‖r_uu‖ du_i² + 2 ‖r_uv‖ |du_i dv_i| + ‖r_vv‖ dv_i²)`. As `Σ λ_i d_i = 0` the linear terms cancel in the
//! mean. `Σ λ_i du_i²` is the variance of numbers in an interval of length `Δu`, so at most `Δu²/4` (Popoviciu), likewise
//! for v, and `Σ λ_i |du_i dv_i| ≤ Δu Δv / 4` by the inequality of Cauchy and Schwarz. ∎
//!
//! If triangles cover the rectangle in the plane of the parameters, every point of the surface has its partner on the
//! mesh and every point of the mesh its partner on the surface: the bound is one for the two-sided Hausdorff distance.
//! If the corners are moved by at most `g` in space, partners are farther apart by at most `g`.

use crate::box3::Box3;
use crate::interval::Interval;
use crate::surface::{Surface, jet_len};

/// Covers the few roundings of the sums of positive numbers below.
const ROUND_UP: f64 = 1.0 + 1e-14;
/// The most cells along one direction of a leaf, so that the numerators of parameters stay exact in a double.
const MAX_CELLS: f64 = 1_048_576.0;

/// The three parts of the bound for a whole rectangle: `⅛‖r_uu‖Δu²`, `¼‖r_uv‖ΔuΔv`, `⅛‖r_vv‖Δv²`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bend {
    uu: f64,
    uv: f64,
    vv: f64,
    /// The ratio of the sizes along u and v.
    aspect: f64,
}

impl Bend {
    /// From enclosures (or samples) of a jet of order 2.
    pub(super) fn new(jet: &[Box3], [du, dv]: [f64; 2]) -> Self {
        debug_assert_eq!(jet.len(), jet_len(2));
        let norm = |k: usize| jet[k].norm().hi;
        let (lu, lv) = (norm(1) * du, norm(2) * dv);
        let aspect = (lu / lv).clamp(1e-3, 1e3);
        Self {
            uu: 0.125 * norm(3) * du * du * ROUND_UP,
            uv: 0.25 * norm(4) * du * dv * ROUND_UP,
            vv: 0.125 * norm(5) * dv * dv * ROUND_UP,
            aspect: if aspect.is_nan() { 1.0 } else { aspect },
        }
    }

    /// True if the surface is bent more along u than along v.
    pub(super) fn is_along_u(&self) -> bool {
        self.uu >= self.vv
    }

    /// The bound for the cells of an n × m grid.
    pub(super) fn deviation(&self, n: f64, m: f64) -> f64 {
        (self.uu / (n * n) + self.uv / (n * m) + self.vv / (m * m)) * ROUND_UP
    }

    /// The fewest cells along u that keep `tol` with m cells along v.
    fn along_u(&self, m: f64, tol: f64) -> Option<f64> {
        let rest = tol - self.vv / (m * m) * ROUND_UP;
        let b = self.uv / m;
        if rest < 0.0 || rest.is_nan() {
            return None;
        }
        if self.uu == 0.0 && b == 0.0 {
            return Some(1.0);
        }
        // a y² + b y = rest for y = 1/n, solved without cancellation.
        let y = 2.0 * rest / (b + (b * b + 4.0 * self.uu * rest).sqrt());
        let mut n = (1.0 / y).ceil().max(1.0);
        if self.deviation(n, m) > tol {
            n += 1.0;
        }
        (n <= MAX_CELLS && self.deviation(n, m) <= tol).then_some(n)
    }

    fn exchanged(self) -> Self {
        Self {
            uu: self.vv,
            vv: self.uu,
            aspect: 1.0 / self.aspect,
            ..self
        }
    }

    /// A grid with few cells that keeps `tol`, at least `least` along each direction; `None` if there is none.
    pub(super) fn cells(&self, tol: f64, least: [f64; 2]) -> Option<[f64; 2]> {
        if !(self.uu + self.uv + self.vv).is_finite() {
            return None;
        }
        let swapped = self.exchanged();
        let along_u = |m: f64| {
            self.along_u(m.max(least[1]), tol)
                .map(|n| [n, m.max(least[1])])
        };
        let along_v = |n: f64| {
            swapped
                .along_u(n.max(least[0]), tol)
                .map(|m| [n.max(least[0]), m])
        };
        // With n = ρ m the bound is (uu/ρ² + uv/ρ + vv)/m².
        let ratio = |rho: f64| {
            let m = ((self.uu / (rho * rho) + self.uv / rho + self.vv) / tol).sqrt();
            along_u(m.ceil().clamp(1.0, MAX_CELLS))
        };
        let best = (self.uu / self.vv).sqrt();
        let balanced = (best.is_finite() && best > 0.0)
            .then(|| ratio(best))
            .flatten();
        [along_u(1.0), along_v(1.0), balanced, ratio(self.aspect)]
            .into_iter()
            .flatten()
            .map(|[n, m]| [n.max(least[0]), m.max(least[1])])
            .min_by(|a, b| (a[0] * a[1]).total_cmp(&(b[0] * b[1])))
    }
}

/// Samples for a bound that cannot be proven, in each direction.
const SAMPLES: usize = 5;
/// What an estimate from samples is enlarged by.
const MARGIN: f64 = 1.5;

/// A jet of order 2 whose boxes hold samples of the rectangle only; `None` if a sample is not finite.
pub(super) fn sampled(surface: &dyn Surface, uv: [Interval; 2]) -> Option<Vec<Box3>> {
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

    #[test]
    fn grids_keep_the_bound_and_are_small() {
        for (uu, uv, vv) in [
            (1.0, 0.0, 0.0),
            (0.0, 0.0, 1.0),
            (0.0, 1.0, 0.0),
            (1.0, 0.5, 2.0),
            (1e3, 1.0, 1e-6),
            (0.0, 0.0, 0.0),
        ] {
            for tol in [1e-1, 1e-3, 1e-6] {
                let bend = Bend {
                    uu,
                    uv,
                    vv,
                    aspect: 1.0,
                };
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
        let cylinder = Bend {
            uu: 1.0,
            uv: 0.0,
            vv: 0.0,
            aspect: 1.0,
        };
        assert_eq!(cylinder.cells(1.001e-4, [4.0, 1.0]), Some([100.0, 1.0]));
    }
}
