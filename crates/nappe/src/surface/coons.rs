//! Coons surfaces: a surface from its boundary, by blending.

use super::compatibility::{Compatibility, Disagreement, Source};
use super::contour::{Contour, ContourError};
use super::coons_data::Data;
use super::gregory::Gregory;
use super::sides::{Corner, Side};
use super::{Elementary, Separable, Surface, SurfaceRef};
use crate::basis::Blending;
use crate::curve::{CurveRef, on_unit_domain};
use crate::exact::NurbsSurface;
use crate::significant;
use glam::DVec3;
use thiserror::Error;

/// The derivative across a side: `∂r/∂v` on south and north, `∂r/∂u` on west and east.
#[derive(Clone, Debug, Default)]
pub enum Cross {
    /// Estimated from the boundary curves and the corner twists.
    #[default]
    Estimated,
    /// Given as a vector-valued curve along the side, in the direction of the side.
    Curve(CurveRef),
    /// Continues another surface over one of its sides, which must run along this one (in either direction, with the
    /// same parametrisation up to a linear map), so that the two join with G1 continuity, and with G2 continuity if the
    /// blending is quintic (see [`CoonsOptions::second`]). The derivative lies in the
    /// tangent planes of the other surface and ends in the tangents of the boundary curves that meet the side; if
    /// these continue the other surface's sides with equal derivatives, so does the whole surface (C1).
    Neighbour {
        /// The other surface.
        surface: SurfaceRef,
        /// Its side.
        side: Side,
    },
}

/// Where corner twists come from if neither given nor implied by a given cross-derivative.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Estimate {
    /// Zero (Ferguson): nothing is added to the blended boundaries; flat near the corners.
    #[default]
    Ferguson,
    /// The twist of the linear Coons surface of the same boundary (Adini): usually the fairer surface.
    Adini,
}

/// What to do where the cross-derivatives of two sides imply different twists in their common corner.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum IncompatibleTwists {
    /// Refuse.
    #[default]
    Error,
    /// Gregory's rational blend `(û A + v̂ B)/(û + v̂)` of the twists A (west or east) and B (south or north), with û, v̂
    /// the distances from the corner: all cross-derivatives are kept, and second derivatives jump in the corner. Not for
    /// quintic blending.
    Gregory,
    /// The given twist if there is one, else the mean of both: twists are continuous, and the cross-derivatives of the
    /// surface differ from the given ones by at most the change of the twist times `max |H2|`. With quintic blending all
    /// mixed derivatives are averaged, and first and second cross-derivatives change likewise: a surface that continues
    /// its neighbours meets them with the continuity of their positions alone near such a corner.
    Average,
}

/// How a Coons surface is blended, and what is known beyond its boundary curves.
#[derive(Clone, Debug)]
pub struct CoonsOptions {
    /// The blending functions. Default: linear.
    pub blend: Blending,
    /// The cross-derivatives in the order south, north, west, east. Default: estimated.
    pub cross: [Cross; 4],
    /// The second derivatives across in the same order, `∂²r/∂v²` or `∂²r/∂u²` as curves along the sides; for quintic
    /// blending only. Where none is given, it follows from the neighbour if the cross-derivative does: with the
    /// cross-derivative `a n + b s'` it is `a² n₂ + 2ab n' + b² s'' + c n + d s'`, where n₂ is the neighbour's second
    /// derivative across, and c and d, linear along the side, end in the second derivatives of the boundary curves that
    /// meet it: curvatures agree (G2). Else it is estimated, as a cross-derivative is.
    pub second: [Option<CurveRef>; 4],
    /// Where unknown twists come from.
    pub estimate: Estimate,
    /// The corner twists `[u][v]`, if given.
    pub twists: Option<[[DVec3; 2]; 2]>,
    /// What to do about incompatible twists.
    pub incompatible_twists: IncompatibleTwists,
    /// How far the data may disagree in the corners, relative to the size of the contour (for derivatives: or to their
    /// own length, if that is more), beyond what the rounding of points far from the origin makes of derivatives. The
    /// surface misses its boundary by at most that. Values below [`Contour::CLOSURE`], the default, count as that.
    pub tol: f64,
}

impl Default for CoonsOptions {
    fn default() -> Self {
        Self {
            blend: Blending::linear(),
            cross: Default::default(),
            second: Default::default(),
            estimate: Estimate::default(),
            twists: None,
            incompatible_twists: IncompatibleTwists::default(),
            tol: Contour::CLOSURE,
        }
    }
}

/// What can be wrong with the data of a Coons surface.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CoonsError {
    /// A boundary curve is not usable.
    #[error(transparent)]
    Contour(ContourError),
    /// Derivatives are given that the blending cannot keep.
    #[error(
        "{source_name} is given, but linear blending keeps positions only: use cubic, quintic, trigonometric or four blending functions"
    )]
    PositionsOnly {
        /// What is given.
        source_name: Source,
    },
    /// A second derivative is given that the blending cannot keep.
    #[error(
        "second.{side} is given, but this blending keeps no second derivatives: use quintic blending"
    )]
    SecondNotKept {
        /// The side.
        side: Side,
    },
    /// Gregory twists are asked for with quintic blending.
    #[error(
        "quintic blending has no Gregory twists, which would make its second derivatives jump: take the mean of incompatible twists, or change the cross-derivatives"
    )]
    GregoryQuintic,
    /// A curve has a value that is NaN or infinite.
    #[error("derivative {order} of {source_name} is not finite at {at}: {value}")]
    NotFinite {
        /// Which curve.
        source_name: Source,
        /// The parameter along the side, 0 or 1.
        at: f64,
        /// The order of the derivative.
        order: usize,
        /// Its value.
        value: DVec3,
    },
    /// A given twist is NaN or infinite.
    #[error("twists[{u}][{v}] is {value}: coordinates must be finite numbers")]
    TwistNotFinite {
        /// Its index along u.
        u: usize,
        /// Its index along v.
        v: usize,
        /// The twist.
        value: DVec3,
    },
    /// The data disagrees in the corners.
    #[error("the boundary data does not fit together: {0}")]
    Incompatible(Box<Compatibility>),
    /// The side of the neighbouring surface is another curve.
    #[error(
        "{side} is to continue the {neighbour} side of another surface, but at t = {at} the two are {} apart (allowed: {})", significant(*distance, 6), significant(*limit, 2)
    )]
    NeighbourApart {
        /// The side of this surface.
        side: Side,
        /// The side of the other.
        neighbour: Side,
        /// The parameter of the greatest distance found, along this surface's side.
        at: f64,
        /// The distance there.
        distance: f64,
        /// The greatest distance allowed.
        limit: f64,
    },
    /// The second derivatives of the neighbouring surface jump along the side.
    #[error(
        "{side} is to continue the curvatures of the {neighbour} side of another surface, but at t = {at} its derivatives jump, and the boundary leaves that side in another direction than its parameter lines: leave it along these, or give second.{side}"
    )]
    NeighbourJumps {
        /// The side of this surface.
        side: Side,
        /// The side of the other.
        neighbour: Side,
        /// The parameter along this surface's side.
        at: f64,
    },
    /// The boundary leaves the common side towards the inside of the neighbouring surface.
    #[error(
        "{side} is to continue the {neighbour} side of another surface, but in the {corner} corner the boundary turns back over that surface: no G1 join is possible there"
    )]
    NeighbourFolds {
        /// The side of this surface.
        side: Side,
        /// The side of the other.
        neighbour: Side,
        /// The corner.
        corner: Corner,
    },
}

/// A Coons surface.
///
/// `r(u, v) = Σ_i H_i(u) f_i(v) + Σ_j H_j(v) g_j(u) - Σ_ij H_i(u) H_j(v) L_i(g_j)`, with blending functions
/// `L_i(H_j) = δ_ij`, positions and cross-derivatives `f_i` on u = 0, 0, 1, 1 and `g_j` on v = 0, 0, 1, 1. It takes all
/// boundary functions that are given, if they are compatible: `L_j(f_i) = L_i(g_j)`. Linear blending has only the four
/// position functions; quintic blending adds the second derivatives across, and has six functions for each direction.
///
/// A cross-derivative that is not given is `Σ_j H_j L_j` of its corner data: the surface then depends on the boundary
/// curves and the corner twists alone. A second cross-derivative is estimated in the same way, from the second derivatives
/// of the boundary curves and mixed derivatives that are known or estimated like twists.
///
/// Exactly a NURBS surface if all curves are and the blending functions are polynomials (and no Gregory twist occurs).
///
/// Sources: Chashnikov, "A surface of revolution as a Coons surface" (2007), (3) to (5); "Description and construction
/// of surfaces in space", (4) to (6) and (13) to (15).
#[derive(Clone, Debug)]
pub struct Coons {
    form: Form,
    resolved: Vec<Disagreement>,
}

#[derive(Clone, Debug)]
pub(super) enum Form {
    Separable(Separable),
    Gregory(Gregory),
}

impl Coons {
    /// The surface with the given boundary curves: south and north run along u from west to east, west and east along
    /// v from south to north. Curves over another domain are reparametrised linearly.
    pub fn new(
        south: CurveRef,
        north: CurveRef,
        west: CurveRef,
        east: CurveRef,
        options: &CoonsOptions,
    ) -> Result<Self, CoonsError> {
        let sides = [south, north, west, east].map(on_unit_domain);
        let (form, resolved) = Data::new(sides, options)?.build(options)?;
        Ok(Self { form, resolved })
    }

    /// The surface of eight boundary functions: `f` are the position, `∂r/∂u`, `∂r/∂u` and position on u = 0, 0, 1, 1
    /// as curves of v; `g` are the position, `∂r/∂v`, `∂r/∂v` and position on v = 0, 0, 1, 1 as curves of u.
    /// The blending must have four functions or six; all else as in [`Coons::new`].
    pub fn from_boundary_functions(
        f: [CurveRef; 4],
        g: [CurveRef; 4],
        blend: Blending,
    ) -> Result<Self, CoonsError> {
        let [west, across_west, across_east, east] = f;
        let [south, across_south, across_north, north] = g;
        let options = CoonsOptions {
            blend,
            cross: [across_south, across_north, across_west, across_east].map(Cross::Curve),
            ..CoonsOptions::default()
        };
        Self::new(south, north, west, east, &options)
    }

    /// The incompatible twists that were resolved on request; empty if everything was compatible.
    pub fn resolved(&self) -> &[Disagreement] {
        &self.resolved
    }

    /// The separable form, unless Gregory twists are blended.
    pub fn separable(&self) -> Option<&Separable> {
        match &self.form {
            Form::Separable(s) => Some(s),
            Form::Gregory(_) => None,
        }
    }

    fn surface(&self) -> &dyn Surface {
        match &self.form {
            Form::Separable(s) => s,
            Form::Gregory(s) => s,
        }
    }
}

impl Surface for Coons {
    evaluate_through!(self => self.surface());

    fn to_nurbs(&self) -> Option<NurbsSurface> {
        self.surface().to_nurbs()
    }

    fn elementary(&self) -> Option<Elementary> {
        self.surface().elementary()
    }
}
