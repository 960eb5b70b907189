//! Sides that meet without being joined: nearly, near enough for the tolerance of the mesh but too far to be joined by
//! it; or in part only.

use crate::text::{bound, number};
use nappe::mesh::{Joint, PartialJoint, joints, partial_joints};
use nappe::surface::{Dir, SurfaceRef};
use nappe_model::{Model, NamedSurface};

/// Sides that are farther apart than this share of the tolerance are not joined by the mesh.
pub(crate) const JOINED: f64 = 0.05;

/// Where the mesh is not watertight although sides meet there, in words.
pub(crate) fn notes(model: &Model, tolerance: f64) -> Vec<String> {
    let mut notes = slits(model, tolerance);
    notes.extend(partial(model, tolerance));
    notes
}

/// Parameters nearer to an end of a side than this share of it are the end.
const AT_END: f64 = 1e-6;

/// The sides that run along each other but have different ends, in words.
pub(crate) fn partial(model: &Model, tolerance: f64) -> Vec<String> {
    let named: Vec<&NamedSurface> = model.output().collect();
    let surfaces: Vec<SurfaceRef> = named.iter().map(|s| s.surface.clone()).collect();
    let name = |(i, side): (usize, nappe::Side)| format!("{}.{side}", named[i].name);
    let note = |j: &PartialJoint| {
        let (along, part) = (name(j.along), name(j.part));
        let [a, b] = j
            .ends
            .map(|p| format!("({})", p.to_array().map(|x| number(x, 5)).join(", ")));
        if j.closed {
            return format!(
                "note: {part} lies along {along} all the way round, but they start at different points: they are not joined, \
                 and the mesh is not watertight there\n  help: let both start at one point; {part} starts at {a}"
            );
        }
        let (surface, side) = j.along;
        let dir = side.along();
        let range = surfaces[surface].domain()[usize::from(dir == Dir::V)];
        let inside = |t: &f64| (t - range.lo).min(range.hi - t) > AT_END * range.width();
        let mut places: Vec<f64> = j.partners.into_iter().filter(inside).collect();
        places.sort_by(f64::total_cmp);
        let letter = if dir == Dir::U { 'u' } else { 'v' };
        let places: Vec<String> = places
            .iter()
            .map(|t| format!("{letter} = {}", number(*t, 6)))
            .collect();
        let help = if places.is_empty() {
            format!("split {}", named[j.part.0].name)
        } else {
            format!("split {} at {}", named[surface].name, places.join(" and "))
        };
        format!(
            "note: {part} lies along part of {along}, from {a} to {b}: they are not joined, and the mesh is not watertight \
             there\n  help: {help}, so that whole sides meet"
        )
    };
    let found = partial_joints(&surfaces, tolerance);
    found.iter().map(note).collect()
}

/// The pairs of sides that leave a slit in the mesh, in words.
fn slits(model: &Model, tolerance: f64) -> Vec<String> {
    let named: Vec<&NamedSurface> = model.output().collect();
    let surfaces: Vec<SurfaceRef> = named.iter().map(|s| s.surface.clone()).collect();
    let unit = model.units.symbol();
    let open = joints(&surfaces, JOINED * tolerance).open;
    let is_open = |(i, side): (usize, _)| open[i].contains(&side);
    let name = |(i, side): (usize, nappe::Side)| format!("{}.{side}", named[i].name);
    let slit = |j: &Joint| {
        format!(
            "note: {} and {} nearly meet, but with a gap of {} {unit} they are not joined: the mesh has a slit there\n  \
             help: the mesh joins sides within {} {unit}, a twentieth of its tolerance: move the sides together, or set a \
             tolerance of {} {unit} or more",
            name(j.first),
            name(j.second),
            number(j.gap, 4),
            number(JOINED * tolerance, 4),
            bound(j.gap / JOINED, 2),
        )
    };
    joints(&surfaces, tolerance)
        .joints
        .iter()
        .filter(|j| j.gap > JOINED * tolerance && (is_open(j.first) || is_open(j.second)))
        .map(slit)
        .collect()
}
