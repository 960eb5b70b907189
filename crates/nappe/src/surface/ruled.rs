//! The ruled surface between two curves.

use super::{Core, Dir, Separable, Term};
use crate::basis::{BSplineBasis, Coordinates, FunctionsRef, Stack};
use crate::box3::Box3;
use crate::curve::{CurveRef, on_unit_domain};
use glam::{DVec3, DVec4};
use std::sync::Arc;
use thiserror::Error;

/// What can be wrong with a ruled surface.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum RuledError {
    /// An end of a rail has a coordinate that is NaN or infinite.
    #[error("rail {rail} is not finite at its end {end}: {point}")]
    NotFinite {
        /// 0 for south or west, 1 for north or east.
        rail: usize,
        /// 0 for the first end, 1 for the last.
        end: usize,
        /// The point there.
        point: DVec3,
    },
}

/// The surface of straight lines between equal parameters of two curves, on `[0, 1]²`.
///
/// With `along == Dir::U` the rails are south and north: `r(u, v) = (1-v) first(u) + v second(u)`; with `Dir::V` they
/// are west and east: `r(u, v) = (1-u) first(v) + u second(v)`. Rails over another domain are reparametrised linearly.
/// Exactly a NURBS surface if the rails are NURBS curves.
/// Source: "Description and construction of surfaces in space", (2) and (3).
pub fn ruled(first: CurveRef, second: CurveRef, along: Dir) -> Result<Separable, RuledError> {
    let rails = [first, second].map(on_unit_domain);
    let ends = [rails[0].ends(), rails[1].ends()];
    for (rail, pair) in ends.iter().enumerate() {
        if let Some(end) = pair.iter().position(|p| !p.is_finite()) {
            let point = pair[end];
            return Err(RuledError::NotFinite { rail, end, point });
        }
    }
    let origin = Box3::around(ends.into_iter().flatten()).map_or(DVec3::ZERO, Box3::mid);
    let parts = rails.map(|c| Arc::new(Coordinates::new(c, origin)) as FunctionsRef);
    let curves: FunctionsRef = Arc::new(Stack::new(parts.to_vec()));
    let line: FunctionsRef = Arc::new(BSplineBasis::bernstein(1));
    let axes = [DVec4::X, DVec4::Y, DVec4::Z];
    let terms = (0..6).map(|k| match along {
        Dir::U => Term::new(k, k / 3, axes[k % 3]),
        Dir::V => Term::new(k / 3, k, axes[k % 3]),
    });
    let core = Core::Terms(terms.collect());
    Ok(match along {
        Dir::U => Separable::polynomial(curves, line, core, origin),
        Dir::V => Separable::polynomial(line, curves, core, origin),
    })
}
