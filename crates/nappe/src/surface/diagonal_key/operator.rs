//! The linear operator L(v) as a sum of functions of v times constant matrices: `L(v) = Σ_j F_j(v) A_j`.

use super::DiagonalKeyError;
use super::plane::{Plane, dyad, eigen};
use crate::basis::FunctionsRef;
use glam::{DMat3, DVec3};

const UNIT: [DVec3; 3] = [DVec3::X, DVec3::Y, DVec3::Z];

/// `L(v) = Σ_k d(1, v)_k linear_k + Σ extra`.
#[derive(Clone, Debug)]
pub(super) struct Operator {
    /// The matrices of the three coordinates of d(1, v).
    pub(super) linear: [DMat3; 3],
    /// Further functions, a matrix for each.
    pub(super) extra: Vec<(FunctionsRef, Vec<DMat3>)>,
}

impl Operator {
    /// `d(1, v) (a·x)/|a|²` with a = d11: keeps only `L[d11] = d(1, v)`.
    pub(super) fn rank_one(a: DVec3) -> Self {
        Self {
            linear: UNIT.map(|e| dyad(e, a / a.length_squared())),
            extra: Vec::new(),
        }
    }

    /// The scaled rotation in a plane: multiplication by the complex number `d(1, v)/d11`. Linear in d(1, v), so it
    /// needs no square root and passes through zero and through the direction opposite to d11 without notice.
    ///
    /// Vectors square to the plane are multiplied by the real part of that number, and what d11 and d(1, v) have
    /// outside the plane (rounding, at most the tolerance of [`Plane`]) is added so that `L[d11] = d(1, v)` holds
    /// exactly, as do `L(0) = 0` and `L(1) = I`.
    pub(super) fn in_plane(plane: &Plane, d11: DVec3) -> Self {
        let [x, y] = plane.axes;
        let n = plane.normal;
        let (a1, a2, a3) = (d11.dot(x), d11.dot(y), d11.dot(n));
        let square = a1 * a1 + a2 * a2;
        let inner = (x * a1 + y * a2) / square;
        let turn = dyad(y, x) - dyad(x, y);
        let linear = UNIT.map(|d| {
            let (c1, c2, c3) = (d.dot(x), d.dot(y), d.dot(n));
            let (re, im) = ((c1 * a1 + c2 * a2) / square, (c2 * a1 - c1 * a2) / square);
            DMat3::IDENTITY * re + turn * im + dyad(n, inner) * (c3 - re * a3)
        });
        Self {
            linear,
            extra: Vec::new(),
        }
    }

    /// Nine functions that are the entries of the matrix, row by row.
    pub(super) fn entries(functions: FunctionsRef) -> Self {
        let matrices = (0..9).map(|i| dyad(UNIT[i / 3], UNIT[i % 3])).collect();
        Self {
            linear: [DMat3::ZERO; 3],
            extra: vec![(functions, matrices)],
        }
    }

    /// `b(v) I`.
    pub(super) fn multiple_of_identity(b: FunctionsRef) -> Self {
        Self {
            linear: [DMat3::ZERO; 3],
            extra: vec![(b, vec![DMat3::IDENTITY])],
        }
    }

    /// Adds `x ↦ (x·n) Σ_k g_k(v) axes_k`.
    pub(super) fn add_free(&mut self, g: FunctionsRef, axes: &[DVec3], n: DVec3) {
        self.extra
            .push((g, axes.iter().map(|e| dyad(*e, n)).collect()));
    }

    /// Makes `L(v)[e_i] = W_i(v)` for some vectors e_i, and leaves `L[a]` (a = d11 or 0) and what is square to all of
    /// them as it is: `L ← L (I - Σ e_i ρ_iᵀ) + Σ W_i ρ_iᵀ` with the vectors ρ dual to e and square to a.
    pub(super) fn stitch(
        &mut self,
        a: DVec3,
        images: &[(DVec3, FunctionsRef)],
    ) -> Result<(), DiagonalKeyError> {
        /// The greatest condition number. Larger, and the surface would lose more than six digits.
        const MOST: f64 = 1e6;
        let mut vectors: Vec<DVec3> = images.iter().map(|(e, _)| *e).collect();
        if a != DVec3::ZERO {
            vectors.insert(0, a);
        }
        let condition = condition(&vectors);
        if condition.is_nan() || condition > MOST {
            return Err(DiagonalKeyError::Singular {
                vectors,
                condition,
                most: MOST,
            });
        }
        let along = a.normalize_or_zero();
        let off: Vec<DVec3> = images
            .iter()
            .map(|(e, _)| *e - along * e.dot(along))
            .collect();
        let dual: Vec<DVec3> = (0..off.len())
            .map(|i| {
                let mut r = off[i];
                for (j, o) in off.iter().enumerate() {
                    if j != i {
                        let o = o.normalize();
                        r -= o * r.dot(o);
                    }
                }
                r / r.dot(images[i].0)
            })
            .collect();
        let keep = images
            .iter()
            .zip(&dual)
            .fold(DMat3::IDENTITY, |m, ((e, _), r)| m - dyad(*e, *r));
        for m in &mut self.linear {
            *m *= keep;
        }
        for m in self.extra.iter_mut().flat_map(|(_, m)| m) {
            *m *= keep;
        }
        for ((_, image), r) in images.iter().zip(dual) {
            let matrices = UNIT.map(|e| dyad(e, r)).to_vec();
            self.extra.push((image.clone(), matrices));
        }
        Ok(())
    }
}

/// The condition number of the matrix whose columns are the directions of up to three vectors; NaN for a zero vector.
fn condition(vectors: &[DVec3]) -> f64 {
    let unit: Vec<DVec3> = vectors.iter().map(|v| *v / v.length()).collect();
    let mut gram = DMat3::IDENTITY;
    for (i, a) in unit.iter().enumerate() {
        for (j, b) in unit.iter().enumerate() {
            gram.col_mut(j)[i] = a.dot(*b);
        }
    }
    if !gram.is_finite() {
        return f64::NAN;
    }
    let (values, _) = eigen(gram);
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(0.0, f64::max);
    (most / least.max(0.0)).sqrt()
}
