//! Nets of points with weights.

use super::{Factor, Sum, Term, as_curve, extended};
use crate::curve::CurveRef;
use crate::surface::SurfaceRef;
use glam::{DMat3, DVec3};
use std::sync::Arc;

/// The points of a curve or surface that is linear in them, with their weights, and the rates of all.
#[derive(Clone, Copy, Debug)]
pub struct Net<'a> {
    /// The points.
    pub points: &'a [DVec3],
    /// Their velocities.
    pub rates: &'a [DVec3],
    /// The weights, positive, with their rates; `None`: 1.
    pub weights: Option<[&'a [f64]; 2]>,
}

impl Net<'_> {
    /// `w'/w` for each weight, if some weight changes.
    fn growth(&self) -> Option<Vec<f64>> {
        let [weights, rates] = self.weights?;
        let growth = weights.iter().zip(rates).map(|(w, rate)| rate / w);
        rates.iter().any(|r| *r != 0.0).then(|| growth.collect())
    }

    fn origin(&self) -> DVec3 {
        self.points.first().copied().unwrap_or_default()
    }

    /// The velocity of `r = Σ wᵢ Nᵢ pᵢ / Σ wᵢ Nᵢ`: with `q = Σ w'ᵢ Nᵢ / Σ wᵢ Nᵢ` it is
    /// `Σ wᵢ Nᵢ (p'ᵢ + w'ᵢ/wᵢ (pᵢ - o)) / Σ wᵢ Nᵢ - q (r - o)` for any o. `make` gives the same construction, with the
    /// same weights, for other points.
    ///
    /// Errors: those of `make`.
    pub fn surface<E>(
        &self,
        at: &SurfaceRef,
        make: impl Fn(&[DVec3]) -> Result<SurfaceRef, E>,
    ) -> Result<SurfaceRef, E> {
        let Some(growth) = self.growth() else {
            return make(self.rates);
        };
        let origin = self.origin();
        let moved = self.points.iter().zip(self.rates).zip(&growth);
        let moved: Vec<DVec3> = moved
            .map(|((p, rate), g)| *rate + (*p - origin) * *g)
            .collect();
        let growth: Vec<DVec3> = growth.into_iter().map(|g| DVec3::X * g).collect();
        let grown = Factor::Coordinate {
            of: make(&growth)?,
            axis: 0,
        };
        let less = Term::image(at.clone(), -DMat3::IDENTITY, origin).times(grown);
        let terms = vec![Term::new(make(&moved)?), less];
        Ok(Arc::new(Sum::new(DVec3::ZERO, terms)))
    }

    /// The same for a curve.
    pub fn curve<E>(
        &self,
        at: &CurveRef,
        make: impl Fn(&[DVec3]) -> Result<CurveRef, E>,
    ) -> Result<CurveRef, E> {
        if self.growth().is_none() {
            return make(self.rates);
        }
        let sum = self.surface(&extended(at.clone()), |points| make(points).map(extended))?;
        Ok(as_curve(Sum::new(DVec3::ZERO, vec![Term::new(sum)])))
    }
}
