//! Coons surfaces: a surface from its boundary, by blending.

use super::bilinear::not_finite;
use super::compatibility::{Compatibility, Datum, Disagreement, Source};
use super::contour::{Contour, ContourError, size};
use super::gregory::{Gregory, GregoryCorner};
use super::neighbour::continuation;
use super::sides::{Corner, Side};
use super::{Core, Dir, Separable, Surface, SurfaceRef, Term};
use crate::basis::{Blending, Coordinates, FunctionsRef, Stack};
use crate::box3::Box3;
use crate::breaks::{Break, Limit};
use crate::curve::{Curve, CurveRef, on_unit_domain};
use crate::exact::NurbsSurface;
use crate::interval::Interval;
use glam::{DVec3, DVec4};
use std::sync::Arc;
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
    /// same parametrisation up to a linear map), so that the two join with G1 continuity. The derivative lies in the
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
    /// the distances from the corner: all cross-derivatives are kept, and second derivatives jump in the corner.
    Gregory,
    /// The given twist if there is one, else the mean of both: twists are continuous, and the cross-derivatives of the
    /// surface differ from the given ones by at most the change of the twist times `max |H2|`.
    Average,
}

/// How a Coons surface is blended, and what is known beyond its boundary curves.
#[derive(Clone, Debug)]
pub struct CoonsOptions {
    /// The blending functions. Default: linear.
    pub blend: Blending,
    /// The cross-derivatives in the order south, north, west, east. Default: estimated.
    pub cross: [Cross; 4],
    /// Where unknown twists come from.
    pub estimate: Estimate,
    /// The corner twists `[u][v]`, if given.
    pub twists: Option<[[DVec3; 2]; 2]>,
    /// What to do about incompatible twists.
    pub incompatible_twists: IncompatibleTwists,
    /// How far the data may disagree in the corners, relative to the size of the contour (for derivatives: or to their
    /// own length, if that is more). The surface misses its boundary by at most that. Values below
    /// [`Contour::CLOSURE`], the default, count as that.
    pub tol: f64,
}

impl Default for CoonsOptions {
    fn default() -> Self {
        Self {
            blend: Blending::linear(),
            cross: Default::default(),
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
        "{source_name} is given, but linear blending keeps positions only: use cubic, trigonometric or four blending functions"
    )]
    PositionsOnly {
        /// What is given.
        source_name: Source,
    },
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
        "{side} is to continue the {neighbour} side of another surface, but at t = {at} the two are {distance:.6e} apart (allowed: {limit:.1e})"
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
/// position functions.
///
/// A cross-derivative that is not given is `Σ_j H_j L_j` of its corner data: the surface then depends on the boundary
/// curves and the corner twists alone.
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
enum Form {
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
        Data::new([south, north, west, east].map(on_unit_domain), options)?.build(options)
    }

    /// The surface of eight boundary functions: `f` are the position, `∂r/∂u`, `∂r/∂u` and position on u = 0, 0, 1, 1
    /// as curves of v; `g` are the position, `∂r/∂v`, `∂r/∂v` and position on v = 0, 0, 1, 1 as curves of u.
    /// The blending must have four functions; all else as in [`Coons::new`].
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
    fn breaks(&self, dir: Dir) -> &[Break] {
        self.surface().breaks(dir)
    }

    fn jet_into(&self, uv: [f64; 2], limit: [Limit; 2], order: usize, out: &mut [DVec3]) {
        self.surface().jet_into(uv, limit, order, out);
    }

    fn enclose_piece(&self, uv: [Interval; 2], limit: [Limit; 2], order: usize, out: &mut [Box3]) {
        self.surface().enclose_piece(uv, limit, order, out);
    }

    fn to_nurbs(&self) -> Option<NurbsSurface> {
        self.surface().to_nurbs()
    }
}

/// Indices 0 to 3 stand for the functionals: value at 0, derivative at 0, derivative at 1, value at 1.
fn is_derivative(i: usize) -> bool {
    i == 1 || i == 2
}

/// The end a functional belongs to.
fn end(i: usize) -> usize {
    i / 2
}

/// What the functionals give for a curve.
pub(super) fn functionals(curve: &dyn Curve) -> [DVec3; 4] {
    let (a, b) = (
        curve.jet(0.0, Limit::Above, 1).d,
        curve.jet(1.0, Limit::Below, 1).d,
    );
    [a[0], a[1], b[1], b[0]]
}

/// The boundary functions and their corner data.
struct Data {
    /// f_i: west, across west, across east, east.
    f: [Option<CurveRef>; 4],
    /// g_j: south, across south, across north, north.
    g: [Option<CurveRef>; 4],
    /// `L_j(f_i)` at `[i][j]`.
    from_f: [[Option<DVec3>; 4]; 4],
    /// `L_i(g_j)` at `[i][j]`.
    from_g: [[Option<DVec3>; 4]; 4],
    /// A length to compare with.
    size: f64,
    /// Why the contour does not close.
    open: Option<ContourError>,
}

/// The side whose position (or cross-derivative) is the i-th boundary function.
fn source(along: Dir, i: usize) -> Source {
    let side = match along {
        Dir::U => [Side::South, Side::North][end(i)],
        Dir::V => [Side::West, Side::East][end(i)],
    };
    if is_derivative(i) {
        Source::Cross(side)
    } else {
        Source::Side(side)
    }
}

impl Data {
    fn new(sides: [CurveRef; 4], options: &CoonsOptions) -> Result<Self, CoonsError> {
        let tangents = options.blend.has_tangents();
        if !tangents {
            let given = |s: &Side| !matches!(options.cross[*s as usize], Cross::Estimated);
            let twists = options.twists.map(|_| Source::Twists);
            let cross = Side::ALL.into_iter().find(given).map(Source::Cross);
            if let Some(source_name) = cross.or(twists) {
                return Err(CoonsError::PositionsOnly { source_name });
            }
        }
        let size = size(&sides);
        let tol = options.tol.max(Contour::CLOSURE) * size;
        let [south, north, west, east] = sides.clone();
        let open = match Contour::with_tolerance(south, north, west, east, tol) {
            Ok(_) => None,
            Err(e @ ContourError::Open { .. }) => Some(e),
            Err(e) => return Err(CoonsError::Contour(e)),
        };
        let mut cross = [None, None, None, None];
        for side in Side::ALL {
            cross[side as usize] = match &options.cross[side as usize] {
                Cross::Estimated => None,
                Cross::Curve(c) => Some(on_unit_domain(c.clone())),
                Cross::Neighbour {
                    surface,
                    side: other,
                } => match continuation(&sides, side, surface, *other, tol) {
                    Ok(c) => Some(c),
                    // A contour that is open is the first thing to mend.
                    Err(_) if open.is_some() => None,
                    Err(e) => return Err(e),
                },
            };
        }
        let [south, north, west, east] = sides.map(Some);
        let [across_south, across_north, across_west, across_east] = cross;
        let mut data = Self {
            f: [west, across_west, across_east, east],
            g: [south, across_south, across_north, north],
            from_f: Default::default(),
            from_g: Default::default(),
            size,
            open,
        };
        let used = |k: usize| tangents || !is_derivative(k);
        for i in 0..4 {
            for (along, curve) in [(Dir::V, &data.f[i]), (Dir::U, &data.g[i])] {
                let Some(curve) = curve else { continue };
                for (j, value) in functionals(curve.as_ref()).into_iter().enumerate() {
                    if !used(j) {
                        continue;
                    }
                    if !value.is_finite() {
                        return Err(CoonsError::NotFinite {
                            source_name: source(along, i),
                            at: end(j) as f64,
                            order: is_derivative(j) as usize,
                            value,
                        });
                    }
                    match along {
                        Dir::V => data.from_f[i][j] = Some(value),
                        Dir::U => data.from_g[j][i] = Some(value),
                    }
                }
            }
        }
        if let Some(twists) = &options.twists
            && let Some((u, v)) = not_finite(twists)
        {
            let value = twists[u][v];
            return Err(CoonsError::TwistNotFinite { u, v, value });
        }
        Ok(data)
    }

    /// All conditions that are missed.
    fn disagreements(&self, options: &CoonsOptions) -> Vec<Disagreement> {
        let tol = options.tol.max(Contour::CLOSURE);
        let mut all = Vec::new();
        for corner in Corner::ALL {
            let [u, v] = corner.ends();
            for (i, j) in corner_pairs(u, v) {
                let datum = match (is_derivative(i), is_derivative(j)) {
                    (false, false) => Datum::Position,
                    (true, false) => Datum::TangentU,
                    (false, true) => Datum::TangentV,
                    (true, true) => Datum::Twist,
                };
                let given = options.twists.filter(|_| datum == Datum::Twist);
                let candidates = [
                    (self.from_g[i][j], source(Dir::U, j)),
                    (self.from_f[i][j], source(Dir::V, i)),
                    (given.map(|t| t[u][v]), Source::Twists),
                ];
                let known: Vec<_> = candidates
                    .into_iter()
                    .filter_map(|(value, s)| Some((value?, s)))
                    .collect();
                for (k, &(a, sa)) in known.iter().enumerate() {
                    for &(b, sb) in &known[k + 1..] {
                        let own = if datum == Datum::Position {
                            0.0
                        } else {
                            a.length().max(b.length())
                        };
                        let (distance, limit) = (a.distance(b), tol * self.size.max(own));
                        if distance > limit {
                            all.push(Disagreement {
                                corner,
                                datum,
                                sources: [sa, sb],
                                values: [a, b],
                                distance,
                                limit,
                            });
                        }
                    }
                }
            }
        }
        all
    }

    /// The agreed corner data `[i][j]`. Where two sources agree within the tolerance their mean is taken, so that the
    /// surface does not depend on the order of u and v.
    fn corner_data(&self, options: &CoonsOptions) -> [[DVec3; 4]; 4] {
        let mut data = [[DVec3::ZERO; 4]; 4];
        for i in 0..4 {
            for j in 0..4 {
                let twist = options
                    .twists
                    .filter(|_| is_derivative(i) && is_derivative(j));
                data[i][j] = match (twist, self.from_f[i][j], self.from_g[i][j]) {
                    (Some(t), ..) => t[end(i)][end(j)],
                    (None, Some(a), Some(b)) => a.midpoint(b),
                    (None, Some(a), None) | (None, None, Some(a)) => a,
                    (None, None, None) => self.estimated_twist(i, j, options.estimate),
                };
            }
        }
        data
    }

    fn estimated_twist(&self, i: usize, j: usize, estimate: Estimate) -> DVec3 {
        if estimate == Estimate::Ferguson {
            return DVec3::ZERO;
        }
        let f = |a: usize, b: usize| self.from_f[a][b].unwrap_or(DVec3::ZERO);
        let g = |a: usize, b: usize| self.from_g[a][b].unwrap_or(DVec3::ZERO);
        // ∂²/∂u∂v of (1-v) g1 + v g4 + (1-u) f1 + u f4 - bilinear.
        let bilinear = (g(0, 0) - g(3, 0)) + (g(3, 3) - g(0, 3));
        (g(i, 3) - g(i, 0)) + (f(3, j) - f(0, j)) - bilinear
    }

    fn build(self, options: &CoonsOptions) -> Result<Coons, CoonsError> {
        let disagreements = self.disagreements(options);
        let resolvable = |d: &Disagreement| match options.incompatible_twists {
            IncompatibleTwists::Error => false,
            IncompatibleTwists::Average => d.datum == Datum::Twist,
            IncompatibleTwists::Gregory => {
                d.datum == Datum::Twist && !d.sources.contains(&Source::Twists)
            }
        };
        if self.open.is_some() || !disagreements.iter().all(resolvable) {
            let (reverse, remaining) = match self.open {
                Some(ContourError::Open {
                    reverse,
                    remaining,
                    tol,
                    ..
                }) => (reverse, if remaining > tol { remaining } else { 0.0 }),
                _ => (Vec::new(), 0.0),
            };
            return Err(CoonsError::Incompatible(Box::new(Compatibility {
                disagreements,
                reverse,
                remaining,
            })));
        }
        let data = self.corner_data(options);
        let base = self.separable(&data, &options.blend);
        let gregory = options.incompatible_twists == IncompatibleTwists::Gregory;
        let form = if gregory && !disagreements.is_empty() {
            let corners = disagreements.iter().map(|d| {
                let [u, v] = d.corner.ends();
                // values are those of g, f; the mean is in the base.
                GregoryCorner::new([u, v], (d.values[1] - d.values[0]) * 0.5)
            });
            Form::Gregory(Gregory::new(
                base,
                options.blend.functions().clone(),
                corners.collect(),
            ))
        } else {
            Form::Separable(base)
        };
        Ok(Coons {
            form,
            resolved: disagreements,
        })
    }

    fn separable(&self, data: &[[DVec3; 4]; 4], blend: &Blending) -> Separable {
        let h = blend.functions();
        let kept: &[usize] = if blend.has_tangents() {
            &[0, 1, 2, 3]
        } else {
            &[0, 3]
        };
        // Blending that does not sum to 1 does not commute with translations: its formula is taken as it stands.
        let corners = [data[0][0], data[3][0], data[0][3], data[3][3]];
        let middle = Box3::around(corners).map_or(DVec3::ZERO, Box3::mid);
        let origin = if blend.is_affine() && middle.is_finite() {
            middle
        } else {
            DVec3::ZERO
        };
        let axes = [DVec4::X, DVec4::Y, DVec4::Z];
        let mut terms = Vec::new();
        let mut stack = |curves: &[Option<CurveRef>; 4], along: Dir| -> FunctionsRef {
            let mut parts: Vec<FunctionsRef> = vec![h.clone()];
            let mut next = h.count();
            for (b, &k) in kept.iter().enumerate() {
                let Some(curve) = &curves[k] else { continue };
                let from = if is_derivative(k) {
                    DVec3::ZERO
                } else {
                    origin
                };
                parts.push(Arc::new(Coordinates::new(curve.clone(), from)));
                terms.extend((0..3).map(|c| match along {
                    Dir::U => Term::new(next + c, b, axes[c]),
                    Dir::V => Term::new(b, next + c, axes[c]),
                }));
                next += 3;
            }
            Arc::new(Stack::new(parts))
        };
        let u = stack(&self.g, Dir::U);
        let v = stack(&self.f, Dir::V);
        for (a, &i) in kept.iter().enumerate() {
            for (b, &j) in kept.iter().enumerate() {
                // A function that is not given is Σ H times its corner data.
                let factor = self.f[i].is_none() as i32 + self.g[j].is_none() as i32 - 1;
                let position = !is_derivative(i) && !is_derivative(j);
                let c = data[i][j] - if position { origin } else { DVec3::ZERO };
                if factor != 0 && c != DVec3::ZERO {
                    terms.push(Term::new(a, b, (c * factor as f64).extend(0.0)));
                }
            }
        }
        Separable::polynomial(u, v, Core::Terms(terms), origin)
    }
}

/// The functionals `(i, j)` that belong to a corner: position, tangent along u, tangent along v, twist.
fn corner_pairs(u: usize, v: usize) -> [(usize, usize); 4] {
    let (value, derivative) = ([0, 3], [1, 2]);
    [
        (value[u], value[v]),
        (derivative[u], value[v]),
        (value[u], derivative[v]),
        (derivative[u], derivative[v]),
    ]
}
