//! The velocities of Diagonal-key surfaces.

use super::slide::Moved;
use super::{Mover, Pair};
use crate::data::{Datum, Fields, Item, SideName};
use nappe::UNIT_BREAKS;
use nappe::basis::{ExpressionFunctions, FunctionsRef};
use nappe::curve::{CrossDerivative, CurveRef};
use nappe::expr::Bound;
use nappe::surface::{Side, SurfaceRef};
use nappe::velocity::{DiagonalKeyRate, diagonal_key, still_curve};
use std::sync::Arc;

impl Mover<'_, '_> {
    pub(super) fn moved_diagonal_key(&mut self, pair: Pair<'_>) -> Result<SurfaceRef, String> {
        let f = &pair.at.fields;
        if !pair.stays("plane_axes") || !pair.stays("normals") || !pair.stays("free") {
            return Err(pair.unknown("its free functions in space or its axes change"));
        }
        let own = self.builder.diagonal_key_with_options(pair.at);
        let (own, options) = own.map_err(|_| pair.unknown("its data are missing"))?;
        let mut sides = Vec::new();
        for side in Side::ALL {
            sides.push(self.velocity_of(pair, side.name())?);
        }
        let [south, north, west, east] = [0, 1, 2, 3].map(|k: usize| sides[k].clone());
        let free = match ["p", "q"].iter().any(|k| f.get(k).is_some()) {
            true => Some([
                self.function_rate(pair, "p")?,
                self.function_rate(pair, "q")?,
            ]),
            false => None,
        };
        let guides = if options.exchange {
            ["tangent_south", "tangent_north"]
        } else {
            ["tangent_west", "tangent_east"]
        };
        let tangents = match options.tangents.iter().all(Option::is_some) {
            true => {
                let [first, second] = guides;
                Some([
                    self.tangent_rate(pair, first)?,
                    self.tangent_rate(pair, second)?,
                ])
            }
            false => None,
        };
        let rate = DiagonalKeyRate {
            sides: [south, north, west, east],
            free,
            tangents,
        };
        let velocity = diagonal_key(&own, &options, &rate).map_err(|why| pair.unknown(why))?;
        Ok(Arc::new(velocity))
    }

    /// The rate of a function of v; of 0 if there is none.
    fn function_rate(&self, pair: Pair<'_>, key: &str) -> Result<FunctionsRef, String> {
        let formula = match pair.rate.fields.get(key).map(|i| &i.datum) {
            Some(Datum::Formula(b)) => b.clone(),
            _ => Bound::constant(0.0, "v"),
        };
        let made = ExpressionFunctions::new(vec![formula], [0.0, 1.0]);
        Ok(Arc::new(made.map_err(|e| pair.unknown(e))?))
    }

    /// The velocity of a tangent along a guide: of a curve, or of the derivative across a side of another surface.
    fn tangent_rate(&mut self, pair: Pair<'_>, key: &str) -> Result<CurveRef, String> {
        let fields = [&pair.at.fields, &pair.rate.fields];
        let [Some(at), Some(rate)] = fields.map(|f: &Fields| f.get(key)) else {
            return Err(pair.unknown("a tangent is missing"));
        };
        let label = format!("{}, `{key}`", pair.at.label);
        self.cross_rate(at, rate, &label)
    }

    /// The velocity of the surface whose derivatives are taken across a side.
    pub(super) fn taken_from(&mut self, item: &Item) -> Result<Option<Moved<SurfaceRef>>, String> {
        match named_side(item) {
            Some(side) => self.surface(&side.surface),
            None => Err("a cross-derivative names no side".to_owned()),
        }
    }

    /// The velocity of a cross-derivative, zero if it does not move.
    pub(super) fn cross_rate(
        &mut self,
        at: &Item,
        rate: &Item,
        label: &str,
    ) -> Result<CurveRef, String> {
        let Some(side) = named_side(at) else {
            let (curve, moved) = self.item(at, rate, label)?;
            let velocity = moved.map(Moved::fixed).transpose()?;
            return Ok(velocity.unwrap_or_else(|| still_curve(curve.breaks())));
        };
        Ok(match self.surface(&side.surface)? {
            Some(moved) => Arc::new(CrossDerivative::side(moved.fixed()?, side.side)),
            None => still_curve(&UNIT_BREAKS),
        })
    }
}

/// The side of `{ from = "other.east" }`.
fn named_side(item: &Item) -> Option<&SideName> {
    let Datum::Record(fields) = &item.datum else {
        return None;
    };
    match fields.get("from").map(|i| &i.datum) {
        Some(Datum::Side(side)) => Some(side),
        _ => None,
    }
}
