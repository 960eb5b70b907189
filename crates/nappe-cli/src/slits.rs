//! Sides that nearly meet: near enough for the tolerance of the mesh, too far to be joined by it.

use crate::text::{bound, number};
use nappe::mesh::{Joint, joints};
use nappe::surface::SurfaceRef;
use nappe_model::{Model, NamedSurface};

/// Sides that are farther apart than this share of the tolerance are not joined by the mesh.
pub(crate) const JOINED: f64 = 0.05;

/// The pairs of sides that leave a slit in the mesh, in words.
pub(crate) fn notes(model: &Model, tolerance: f64) -> Vec<String> {
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
