//! The data of a Coons surface: collected, checked against itself, and summed up.

use super::bilinear::not_finite;
use super::compatibility::{Compatibility, Datum, Disagreement, Source};
use super::contour::{Contour, ContourError, size};
use super::coons::{CoonsError, CoonsOptions, Cross, Estimate, Form, IncompatibleTwists};
use super::gregory::{Gregory, GregoryCorner};
use super::neighbour::continuation;
use super::sides::{Corner, Side};
use super::{Core, Dir, Separable, Term};
use crate::basis::{Blending, Coordinates, FunctionsRef, Stack};
use crate::box3::Box3;
use crate::breaks::Limit;
use crate::curve::{Curve, CurveRef, on_unit_domain};
use glam::{DVec3, DVec4};
use std::sync::Arc;

/// The number of functionals, indices 0 to 5: value, first and second derivative at 0; second and first derivative and
/// value at 1. The second derivatives belong to quintic blending.
const COUNT: usize = 6;

/// The value at 1.
const LAST: usize = COUNT - 1;

/// What the rounding of a place far from the origin may become in derivatives of an order along one direction: two roundings of
/// differences of the control points of a quintic, `2ᵏ 5!/(5-k)!`, with spans half as long as its neighbour's, `2ᵏ`. The
/// blending functions take it back: no point of the surface moves by more than some hundred roundings.
const ROUNDED: [f64; 3] = [2.0, 40.0, 640.0];

/// The order of the derivative.
fn order(i: usize) -> usize {
    i.min(LAST - i)
}

/// The end a functional belongs to.
fn end(i: usize) -> usize {
    i / 3
}

/// What the functionals of derivatives up to an order give for a curve; zero for the others.
fn functionals(curve: &dyn Curve, highest: usize) -> [DVec3; COUNT] {
    let mut all = [DVec3::ZERO; COUNT];
    for (k, d) in at_end(curve, 0, highest).into_iter().enumerate() {
        all[k] = d;
    }
    for (k, d) in at_end(curve, 1, highest).into_iter().enumerate() {
        all[LAST - k] = d;
    }
    all
}

/// The value and the derivatives of a curve up to an order at 0 or 1.
pub(super) fn at_end(curve: &dyn Curve, end: usize, order: usize) -> Vec<DVec3> {
    let (t, limit) = [(0.0, Limit::Above), (1.0, Limit::Below)][end];
    curve.jet(t, limit, order).d.to_vec()
}

/// The boundary functions and their corner data.
pub(super) struct Data {
    /// f_i: west and its first and second derivative across, east's second and first derivative across, and east.
    f: [Option<CurveRef>; COUNT],
    /// g_j: the same of south and north.
    g: [Option<CurveRef>; COUNT],
    /// `L_j(f_i)` at `[i][j]`.
    from_f: [[Option<DVec3>; COUNT]; COUNT],
    /// `L_i(g_j)` at `[i][j]`.
    from_g: [[Option<DVec3>; COUNT]; COUNT],
    /// The highest order of the derivatives that are blended.
    highest: usize,
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
    match order(i) {
        0 => Source::Side(side),
        1 => Source::Cross(side),
        _ => Source::Second(side),
    }
}

impl Data {
    pub(super) fn new(sides: [CurveRef; 4], options: &CoonsOptions) -> Result<Self, CoonsError> {
        let highest = options.blend.order();
        if let Some(side) = Side::ALL
            .into_iter()
            .find(|s| highest < 2 && options.second[*s as usize].is_some())
        {
            return Err(CoonsError::SecondNotKept { side });
        }
        if highest == 2 && options.incompatible_twists == IncompatibleTwists::Gregory {
            return Err(CoonsError::GregoryQuintic);
        }
        if highest == 0 {
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
        let mut second = options.second.clone().map(|c| c.map(on_unit_domain));
        for side in Side::ALL {
            let k = side as usize;
            cross[k] = match &options.cross[k] {
                Cross::Estimated => None,
                Cross::Curve(c) => Some(on_unit_domain(c.clone())),
                Cross::Neighbour {
                    surface,
                    side: other,
                } => {
                    let order = if second[k].is_some() { 1 } else { highest };
                    match continuation(&sides, side, surface, *other, tol, order) {
                        Ok(c) => {
                            second[k] = second[k].take().or(c.second);
                            Some(c.first)
                        }
                        // A contour that is open is the first thing to mend.
                        Err(_) if open.is_some() => None,
                        Err(e) => return Err(e),
                    }
                }
            };
        }
        let [south, north, west, east] = sides.map(Some);
        let [across_south, across_north, across_west, across_east] = cross;
        let [bent_south, bent_north, bent_west, bent_east] = second;
        let mut data = Self {
            f: [west, across_west, bent_west, bent_east, across_east, east],
            g: [
                south,
                across_south,
                bent_south,
                bent_north,
                across_north,
                north,
            ],
            from_f: Default::default(),
            from_g: Default::default(),
            highest,
            size,
            open,
        };
        for i in 0..COUNT {
            for (along, curve) in [(Dir::V, &data.f[i]), (Dir::U, &data.g[i])] {
                let Some(curve) = curve else { continue };
                let values = functionals(curve.as_ref(), highest);
                for (j, value) in values.into_iter().enumerate() {
                    if order(j) > highest {
                        continue;
                    }
                    if !value.is_finite() {
                        return Err(CoonsError::NotFinite {
                            source_name: source(along, i),
                            at: end(j) as f64,
                            order: order(j),
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
            let place = self.from_g[u * LAST][v * LAST].map_or(0.0, DVec3::length);
            for (i, j) in corner_pairs(u, v, self.highest) {
                let rounding = place * f64::EPSILON * ROUNDED[order(i)] * ROUNDED[order(j)];
                let datum = Datum::of_orders(order(i), order(j));
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
                        let (distance, limit) =
                            (a.distance(b), tol * self.size.max(own) + rounding);
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
    fn corner_data(&self, options: &CoonsOptions) -> [[DVec3; COUNT]; COUNT] {
        let mut data = [[DVec3::ZERO; COUNT]; COUNT];
        for i in 0..COUNT {
            for j in 0..COUNT {
                let twist = options.twists.filter(|_| (order(i), order(j)) == (1, 1));
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
        // ∂²/∂u∂v of (1-v) g1 + v g4 + (1-u) f1 + u f4 - bilinear; or a derivative of a higher order, in which the parts
        // that are linear along one of the directions vanish.
        let (south_north, west_east) = (g(i, LAST) - g(i, 0), f(LAST, j) - f(0, j));
        match (order(i), order(j)) {
            (1, 1) => {
                let bilinear = (g(0, 0) - g(LAST, 0)) + (g(LAST, LAST) - g(0, LAST));
                south_north + west_east - bilinear
            }
            (_, 1) => south_north,
            (1, _) => west_east,
            _ => DVec3::ZERO,
        }
    }

    /// The surface, and the incompatible twists that were resolved.
    pub(super) fn build(
        self,
        options: &CoonsOptions,
    ) -> Result<(Form, Vec<Disagreement>), CoonsError> {
        let disagreements = self.disagreements(options);
        let resolvable = |d: &Disagreement| match options.incompatible_twists {
            IncompatibleTwists::Error => false,
            IncompatibleTwists::Average => d.datum.is_mixed(),
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
                quintic: self.highest == 2,
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
        Ok((form, disagreements))
    }

    fn separable(&self, data: &[[DVec3; COUNT]; COUNT], blend: &Blending) -> Separable {
        let h = blend.functions();
        let kept: Vec<usize> = (0..COUNT).filter(|&k| order(k) <= self.highest).collect();
        // Blending that does not sum to 1 does not commute with translations: its formula is taken as it stands.
        let corners = [data[0][0], data[LAST][0], data[0][LAST], data[LAST][LAST]];
        let middle = Box3::around(corners).map_or(DVec3::ZERO, Box3::mid);
        let origin = if blend.is_affine() && middle.is_finite() {
            middle
        } else {
            DVec3::ZERO
        };
        let axes = [DVec4::X, DVec4::Y, DVec4::Z];
        let mut terms = Vec::new();
        let mut stack = |curves: &[Option<CurveRef>; COUNT], along: Dir| -> FunctionsRef {
            let mut parts: Vec<FunctionsRef> = vec![h.clone()];
            let mut next = h.count();
            for (b, &k) in kept.iter().enumerate() {
                let Some(curve) = &curves[k] else { continue };
                let from = if order(k) > 0 { DVec3::ZERO } else { origin };
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
                let position = order(i) + order(j) == 0;
                let c = data[i][j] - if position { origin } else { DVec3::ZERO };
                if factor != 0 && c != DVec3::ZERO {
                    terms.push(Term::new(a, b, (c * factor as f64).extend(0.0)));
                }
            }
        }
        Separable::polynomial(u, v, Core::Terms(terms), origin)
    }
}

/// The functionals `(i, j)` that belong to a corner: position, tangent along u, tangent along v, twist; and so on for second
/// derivatives, with the lower orders first.
fn corner_pairs(u: usize, v: usize, highest: usize) -> Vec<(usize, usize)> {
    let at = |end: usize, k: usize| if end == 0 { k } else { LAST - k };
    let mut pairs: Vec<(usize, usize)> = (0..=highest)
        .flat_map(|b| (0..=highest).map(move |a| (a, b)))
        .collect();
    pairs.sort_by_key(|&(a, b)| a.max(b));
    pairs
        .into_iter()
        .map(|(a, b)| (at(u, a), at(v, b)))
        .collect()
}
