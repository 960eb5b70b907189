//! The rational surface on any basis.

use super::{Core, Dir, Separable, Surface};
use crate::basis::FunctionsRef;
use crate::breaks::Breaks;
use crate::exact::{NurbsError, homogeneous, middle};
use crate::interval::Interval;
use glam::{DVec3, DVec4, Vec4Swizzles};
use thiserror::Error;

/// What can be wrong with a rational surface on a user's basis.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RationalError {
    /// Points or weights are wrong.
    #[error(transparent)]
    Net(#[from] NurbsError),
    /// The weight function is zero or negative, or not a number.
    #[error(
        "the weight Σ w_ij N_i(u) M_j(v) is {value} at u = {u}, v = {v}: it must be positive everywhere, or the surface runs to infinity"
    )]
    NotPositive {
        /// The parameter u.
        u: f64,
        /// The parameter v.
        v: f64,
        /// The weight there.
        value: f64,
    },
    /// The weight function could not be shown to be positive.
    #[error(
        "the weight Σ w_ij N_i(u) M_j(v) could not be shown to be positive near u = {u}, v = {v}: it is only known to lie in [{}, {}]",
        range.lo, range.hi
    )]
    Unproven {
        /// The parameter u.
        u: f64,
        /// The parameter v.
        v: f64,
        /// What is known there.
        range: Interval,
    },
}

/// The rational surface `r(u, v) = Σ_ij w_ij N_i(u) M_j(v) p_ij / Σ_ij w_ij N_i(u) M_j(v)` on any two lists of functions.
///
/// `points[i * basis_v.count() + j]` belongs to `N_i(u) M_j(v)`; weights are all 1 if not given, and only their ratios
/// matter. The functions need not sum to 1 nor be positive: the weight function (the denominator) is proven positive
/// over the whole domain by enclosures. Exactly a NURBS surface if all functions are piecewise rational; Bernstein and
/// B-spline bases are the two cases with kinds of their own.
///
/// Cost: as long as the weight function keeps away from zero, a few enclosures.
/// Source: Golovanov, *Geometric modelling*, §3.9 (3.9.4).
pub fn rational(
    basis_u: FunctionsRef,
    basis_v: FunctionsRef,
    points: &[DVec3],
    weights: Option<&[f64]>,
) -> Result<Separable, RationalError> {
    let (rows, columns) = (basis_u.count(), basis_v.count());
    if rows * columns != points.len() || points.is_empty() {
        let points = points.len();
        return Err(NurbsError::NetSize {
            rows,
            columns,
            points,
        }
        .into());
    }
    let net = homogeneous(points, weights)?;
    let weight = net.iter().map(|p| DVec4::X * p.w).collect();
    prove_positive(&Separable::polynomial(
        basis_u.clone(),
        basis_v.clone(),
        Core::Net(weight),
        DVec3::ZERO,
    ))?;
    let origin = middle(&net);
    let net = net.iter().map(|p| (p.xyz() - origin * p.w).extend(p.w));
    let core = Core::Net(net.collect());
    Ok(Separable::rational(basis_u, basis_v, core, origin))
}

/// Proves that the x coordinate is positive everywhere, by bisection.
fn prove_positive(weight: &Separable) -> Result<(), RationalError> {
    /// A weight that needs more boxes than this comes so near to zero that the surface would be of no use.
    const BOXES: usize = 20_000;
    let domain = weight.domain();
    let mut todo: Vec<[Interval; 2]> = Vec::new();
    let pieces = [Dir::U, Dir::V].map(|d| {
        let breaks = weight.breaks(d);
        (0..breaks.pieces())
            .map(|i| breaks.piece(i))
            .collect::<Vec<_>>()
    });
    for u in &pieces[0] {
        todo.extend(pieces[1].iter().map(|v| [*u, *v]));
    }
    let limit = BOXES + todo.len();
    let mut done = 0;
    while let Some(uv) = todo.pop() {
        let [u, v] = uv;
        let range = weight.bounds(uv).x;
        if range.lo > 0.0 {
            done += 1;
            continue;
        }
        for [u, v] in [
            [u.mid(), v.mid()],
            [u.lo, v.lo],
            [u.lo, v.hi],
            [u.hi, v.lo],
            [u.hi, v.hi],
        ] {
            let value = weight.point([u, v]).x;
            // NaN is refused with the numbers below zero.
            if value.is_nan() || value <= 0.0 {
                return Err(RationalError::NotPositive { u, v, value });
            }
        }
        done += 1;
        let share = [0, 1].map(|d| (uv[d].hi - uv[d].lo) / (domain[d].hi - domain[d].lo));
        let wider = if share[0] >= share[1] { 0 } else { 1 };
        let m = uv[wider].mid();
        if done > limit || m <= uv[wider].lo || m >= uv[wider].hi {
            let (u, v) = (u.mid(), v.mid());
            return Err(RationalError::Unproven { u, v, range });
        }
        for part in [
            Interval::new(uv[wider].lo, m),
            Interval::new(m, uv[wider].hi),
        ] {
            let mut half = uv;
            half[wider] = part;
            todo.push(half);
        }
    }
    Ok(())
}
