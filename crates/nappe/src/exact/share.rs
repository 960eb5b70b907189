//! NURBS forms of several surfaces that have common curves where the surfaces share sides.

use super::impose::with_side;
use super::{ApproximationError, Converted, NurbsSurface, to_nurbs_or_approximate};
use crate::breaks::Limit;
use crate::measure::{SideOf, greatest_gap};
use crate::mesh::shared::{Edge, matching};
use crate::mesh::{Certainty, joints};
use crate::parallel;
use crate::surface::{Dir, Side, SurfaceRef};
use std::collections::BTreeMap;

/// A side that two surfaces share, of whose NURBS forms at least one is approximated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SharedSide {
    /// The surface and the side whose curve the other has taken over if possible, and that other.
    pub sides: [(usize, Side); 2],
    /// True if it has: then both forms have one curve there, within rounding.
    pub common: bool,
    /// How far the forms are from each other along it.
    pub gap: Certainty,
}

/// The part of the tolerance for the approximation of a surface that shares sides: what is left is needed to move two of
/// its sides that meet in a corner, each by the errors of both surfaces there and by the distance of the surfaces.
const SHARE: f64 = 1.0 / 6.0;

/// The NURBS forms of surfaces, as of [`to_nurbs_or_approximate`], with common curves where surfaces share sides: of those
/// that agree within `weld`, a length, an approximated surface takes the curve of one with an exact form, or else of the
/// first. The errors of the forms are at most those of before and what this adds; where that is more than `tol`, or where
/// parameters do not correspond linearly, the curve is not taken over. Returns also the shared sides, and how far the forms
/// are from each other there.
///
/// Errors: `Err((i, e))` if surface i has no form.
#[allow(clippy::type_complexity)]
pub fn to_nurbs_together(
    surfaces: &[SurfaceRef],
    tol: f64,
    weld: f64,
) -> Result<(Vec<Converted<NurbsSurface>>, Vec<SharedSide>), (usize, ApproximationError)> {
    let groups = groups(surfaces, weld);
    let shares: Vec<bool> = {
        let mut shares = vec![false; surfaces.len()];
        for &(i, _) in groups.iter().flatten() {
            shares[i] = true;
        }
        shares
    };
    let threads = parallel::all_threads();
    let convert = |i: usize| {
        let part = if shares[i] { SHARE * tol } else { tol };
        to_nurbs_or_approximate(surfaces[i].as_ref(), part)
    };
    let converted = parallel::each(threads, surfaces.len(), convert, |_| false);
    let mut forms = Vec::with_capacity(surfaces.len());
    for (i, form) in converted.into_iter().enumerate() {
        forms.push(form.map_err(|e| (i, e))?);
    }
    let shared = share(&mut forms, groups, tol, weld);
    Ok((forms, shared))
}

/// The sides that are one curve.
fn groups(surfaces: &[SurfaceRef], weld: f64) -> Vec<Vec<(usize, Side)>> {
    let mut groups: BTreeMap<(usize, Side), Vec<(usize, Side)>> = BTreeMap::new();
    for j in joints(surfaces, weld).joints {
        let group = groups.entry(j.first).or_insert_with(|| vec![j.first]);
        group.push(j.second);
    }
    groups.into_values().collect()
}

fn is_exact(form: &Converted<NurbsSurface>) -> bool {
    form.certainty == Certainty::Exact
}

/// Gives the approximated ones of the forms common curves, in their order: what a form has taken over, others take from it.
fn share(
    forms: &mut [Converted<NurbsSurface>],
    mut groups: Vec<Vec<(usize, Side)>>,
    tol: f64,
    weld: f64,
) -> Vec<SharedSide> {
    for group in &mut groups {
        group.sort_by_key(|&(i, side)| (!is_exact(&forms[i]), i, side));
    }
    let leader = |of: (usize, Side)| {
        let group = groups.iter().find(|g| g[1..].contains(&of));
        group.map(|g| g[0])
    };
    let mut shared = Vec::new();
    for i in 0..forms.len() {
        if is_exact(&forms[i]) {
            continue;
        }
        let own = forms[i].certainty;
        // How far sides across u and across v were moved.
        let mut moved = [0.0f64; 2];
        for side in Side::ALL {
            let Some(from) = leader((i, side)) else {
                continue;
            };
            let near = weld + forms[from.0].certainty.error() + own.error() + moved[0] + moved[1];
            let taken = taken(forms, from, (i, side), near).and_then(|(form, by)| {
                let mut moved = moved;
                let across = usize::from(side.across() == Dir::V);
                moved[across] = moved[across].max(by);
                let error = (own.error() + moved[0] + moved[1]).next_up();
                (error <= tol).then_some((form, moved, error))
            });
            let common = taken.is_some();
            if let Some((form, by, error)) = taken {
                moved = by;
                forms[i] = Converted {
                    nurbs: form,
                    certainty: match own {
                        Certainty::Estimated(_) => Certainty::Estimated(error),
                        _ => Certainty::Bounded(error),
                    },
                    same_parameters: forms[i].same_parameters,
                };
            }
            shared.push((from, (i, side), common, near));
        }
    }
    let gap = |&(from, to, common, near): &((usize, Side), (usize, Side), bool, f64)| SharedSide {
        sides: [from, to],
        common,
        gap: greatest_gap(side_of(forms, from), side_of(forms, to), near)
            .map_or(Certainty::Estimated(near), Certainty::Bounded),
    };
    shared.iter().map(gap).collect()
}

fn side_of(forms: &[Converted<NurbsSurface>], (i, side): (usize, Side)) -> SideOf<'_> {
    (&forms[i].nurbs, side)
}

/// A form with the curve of another one's side, or of another side of its own, and how far it moves; `None` if the
/// parameters do not correspond linearly, or if that is not possible.
fn taken(
    forms: &[Converted<NurbsSurface>],
    from: (usize, Side),
    to: (usize, Side),
    near: f64,
) -> Option<(NurbsSurface, f64)> {
    let [a, b] = [from, to].map(|s| {
        let (surface, side) = side_of(forms, s);
        Edge::new(surface, side)
    });
    let map = matching(&a, &b, near).filter(|m| m.is_linear())?;
    let limit = if a.side.is_upper() {
        Limit::Below
    } else {
        Limit::Above
    };
    let curve = forms[from.0].nurbs.isocurve(a.side.along(), a.at, limit);
    let curve = if map.is_reversed() {
        curve.reversed().ok()?
    } else {
        curve
    };
    with_side(&forms[to.0].nurbs, to.1, &curve)
}
