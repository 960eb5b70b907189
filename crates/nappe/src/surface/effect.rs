//! What an error of a function of one variable does to a separable surface.

use super::{Core, Separable};
use crate::basis::FunctionsRef;
use crate::breaks::{Breaks, Limit};
use glam::{DVec4, Vec4Swizzles};
use std::ops::Range;

/// Parameters in each direction at which the surface is looked at.
const SAMPLES: usize = 9;

/// What errors do to a surface.
pub(super) struct Effects {
    /// For each function of u and of v, how far an error of 1 moves the surface, relative to the surface's size.
    pub(super) of: [Vec<f64>; 2],
    /// The surface's size: the greatest distance from its origin.
    pub(super) size: f64,
}

/// With `R = Σ_ij a_i C_ij b_j`, an error e of `a_i` moves R by `e K_i`, where `K_i = Σ_j C_ij b_j`, and `r = R.xyz / R.w` by
/// `e (K_i.xyz - r K_i.w) / R.w`. The greatest K, the size (the greatest r) and the least w are those found at samples.
pub(super) fn effects(surface: &Separable) -> Effects {
    let [a, b] = [surface.functions_u(), surface.functions_v()].map(samples);
    let of_u: Vec<_> = b.iter().map(|b| factors(surface, b, false)).collect();
    let of_v: Vec<_> = a.iter().map(|a| factors(surface, a, true)).collect();
    let (mut size, mut least) = (0.0f64, f64::INFINITY);
    for a in &a {
        for k in &of_u {
            let k = &k[a.active.clone()];
            let r: DVec4 = k.iter().zip(&a.values).map(|(&k, &a)| k * a).sum();
            let w = if surface.is_rational() { r.w } else { 1.0 };
            size = size.max(r.xyz().length() / w);
            least = least.min(w);
        }
    }
    let effect = |k: &DVec4| {
        let w = if surface.is_rational() { k.w } else { 0.0 };
        (k.xyz().length() / size + w.abs()) / least
    };
    let of = [of_u, of_v].map(|all| {
        let mut effects = vec![0.0f64; all[0].len()];
        for k in &all {
            for (e, k) in effects.iter_mut().zip(k) {
                *e = e.max(effect(k));
            }
        }
        effects
    });
    Effects { of, size }
}

/// The functions that may be other than zero at a parameter.
struct Sample {
    active: Range<usize>,
    values: Vec<f64>,
}

/// The functions at evenly spread parameters.
fn samples(f: &FunctionsRef) -> Vec<Sample> {
    let domain = f.breaks().domain();
    let at = |k: usize| {
        let t = domain.lo + (domain.hi - domain.lo) * k as f64 / (SAMPLES - 1) as f64;
        let active = f.active(t, Limit::Above);
        let mut values = vec![0.0; active.len()];
        f.jet_into(t, Limit::Above, 0, &mut values);
        Sample { active, values }
    };
    (0..SAMPLES).map(at).collect()
}

/// The sums of the core with the functions of u (or of v) at a sample, for each function of the other side.
fn factors(surface: &Separable, sample: &Sample, of_u: bool) -> Vec<DVec4> {
    let counts = [surface.functions_u().count(), surface.functions_v().count()];
    let mut k = vec![DVec4::ZERO; counts[usize::from(of_u)]];
    let mut add = |i: usize, j: usize, c: DVec4| {
        let (from, to) = if of_u { (i, j) } else { (j, i) };
        if let Some(&f) = sample.values.get(from.wrapping_sub(sample.active.start)) {
            k[to] += c * f;
        }
    };
    match surface.core() {
        Core::Net(net) => {
            let all = counts.map(|n| 0..n);
            let [rows, columns] = match (all, of_u) {
                ([_, columns], true) => [sample.active.clone(), columns],
                ([rows, _], false) => [rows, sample.active.clone()],
            };
            for i in rows {
                for j in columns.clone() {
                    add(i, j, net[i * counts[1] + j]);
                }
            }
        }
        Core::Terms(terms) => terms.iter().for_each(|t| add(t.i, t.j, t.c)),
    }
    k
}
