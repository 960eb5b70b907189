//! Sides that meet without being joined: nearly, near enough for the tolerance of the mesh but too far to be joined by
//! it; or in part only.

use crate::text::{bound, number};
use nappe::Interval;
use nappe::measure::{Continuity, JumpOptions, continuity_in_part};
use nappe::mesh::{Joint, Joints, PartialJoint, joints, near_joints, partial_joints};
use nappe::surface::{Dir, Side, SurfaceRef};
use nappe_model::{Model, NamedSurface};
use rayon::prelude::*;
use serde_json::{Value, json};

/// Sides that are farther apart than this share of the tolerance are not joined by the mesh.
pub(crate) const JOINED: f64 = 0.05;

/// Where the mesh is not watertight although sides meet there, in words.
pub(crate) fn notes(model: &Model, tolerance: f64) -> Vec<String> {
    let named: Vec<&NamedSurface> = model.output().collect();
    let surfaces: Vec<SurfaceRef> = named.iter().map(|s| s.surface.clone()).collect();
    let joined = joints(&surfaces, JOINED * tolerance);
    let near = near_joints(&surfaces, &joined, tolerance);
    let mut notes = slits(model, &near, tolerance);
    notes.extend(turned(model, &joined));
    notes.extend(Partial::of(model, &near, tolerance).notes());
    notes
}

/// Parameters nearer to an end of a side than this share of it are the end.
const AT_END: f64 = 1e-6;

/// The sides that run along each other but have different ends.
pub(crate) struct Partial<'a> {
    named: Vec<&'a NamedSurface>,
    found: Vec<PartialJoint>,
    tolerance: f64,
}

/// A stretch along which two sides meet, with what is known of it.
pub(crate) struct Stretch {
    /// The index in the list of partial joints.
    pub(crate) of: usize,
    /// The surface and the side along which the other lies, and the other.
    pub(crate) sides: [(usize, Side); 2],
    /// The ranges of their parameters.
    pub(crate) ranges: [Interval; 2],
    /// `None`: they do not meet from end to end.
    pub(crate) joint: Option<Continuity>,
}

impl<'a> Partial<'a> {
    /// `joined` is what is joined within the tolerance.
    pub(crate) fn of(model: &'a Model, joined: &Joints, tolerance: f64) -> Self {
        let named: Vec<&NamedSurface> = model.output().collect();
        let surfaces: Vec<SurfaceRef> = named.iter().map(|s| s.surface.clone()).collect();
        let found = partial_joints(&surfaces, joined, tolerance);
        Self {
            named,
            found,
            tolerance,
        }
    }

    /// How smoothly the sides meet along each stretch.
    pub(crate) fn measured(&self) -> Vec<Stretch> {
        let joints = self.found.iter().enumerate();
        let stretches: Vec<_> = joints
            .flat_map(|(k, j)| j.stretches.iter().flatten().map(move |s| (k, j, *s)))
            .collect();
        let measure = |&(of, j, [on_part, on_along]): &(usize, &PartialJoint, [Interval; 2])| {
            let side = |(i, side): (usize, Side)| (self.named[i].surface.as_ref(), side);
            Stretch {
                of,
                sides: [j.along, j.part],
                ranges: [on_along, on_part],
                joint: continuity_in_part(
                    (side(j.along), on_along),
                    (side(j.part), on_part),
                    self.tolerance,
                    &JumpOptions::default(),
                ),
            }
        };
        stretches.par_iter().map(measure).collect()
    }

    /// The names of two sides.
    pub(crate) fn names(&self, sides: [(usize, Side); 2]) -> String {
        sides.map(|side| self.name(side)).join(" – ")
    }

    fn name(&self, side: (usize, Side)) -> String {
        name(&self.named, side)
    }

    /// The parameters where `along` is to be split, so that whole sides meet.
    fn places(&self, j: &PartialJoint) -> Vec<f64> {
        let (surface, side) = j.along;
        let range = self.named[surface].surface.domain()[usize::from(side.along() == Dir::V)];
        let inside = |t: &f64| (t - range.lo).min(range.hi - t) > AT_END * range.width();
        let mut places: Vec<f64> = j.partners.into_iter().filter(inside).collect();
        places.sort_by(f64::total_cmp);
        places
    }

    /// In words.
    pub(crate) fn notes(&self) -> impl Iterator<Item = String> {
        self.found.iter().map(|j| self.note(j))
    }

    fn note(&self, j: &PartialJoint) -> String {
        let (along, part) = (self.name(j.along), self.name(j.part));
        let [a, b] = j
            .ends
            .map(|p| format!("({})", p.to_array().map(|x| number(x, 5)).join(", ")));
        if j.closed {
            return format!(
                "note: {part} lies along {along} all the way round, but they start at different points: they are not joined, \
                 and the mesh is not watertight there\n  help: let both start at one point; {part} starts at {a}"
            );
        }
        let letter = if j.along.1.along() == Dir::U {
            'u'
        } else {
            'v'
        };
        let places: Vec<String> = self
            .places(j)
            .iter()
            .map(|t| format!("{letter} = {}", number(*t, 6)))
            .collect();
        let help = if places.is_empty() {
            format!("split {}", self.named[j.part.0].name)
        } else {
            let whole = &self.named[j.along.0].name;
            format!("split {whole} at {}", places.join(" and "))
        };
        format!(
            "note: {part} lies along part of {along}, from {a} to {b}: they are not joined, and the mesh is not watertight \
             there\n  help: {help}, so that whole sides meet"
        )
    }

    /// `found` has the ranges and the continuity of each stretch.
    pub(crate) fn json(&self, found: impl Fn(usize) -> Value) -> Value {
        let one = |(k, j): (usize, &PartialJoint)| {
            json!({
                "stretches": found(k),
                "along": self.name(j.along),
                "part": self.name(j.part),
                "from": j.ends[0].to_array(),
                "to": j.ends[1].to_array(),
                "all_round": j.closed,
                "split": { "dir": j.along.1.along().to_string(), "at": self.places(j) },
                "sampled_gap": j.gap,
            })
        };
        self.found.iter().enumerate().map(one).collect()
    }
}

/// The name of a side of what the model puts out.
fn name(named: &[&NamedSurface], (i, side): (usize, Side)) -> String {
    format!("{}.{side}", named[i].name)
}

/// The surfaces whose triangles run against those of their neighbours, in words.
fn turned(model: &Model, joined: &Joints) -> Option<String> {
    let turned: Vec<&Joint> = joined.joints.iter().filter(|j| j.is_turned()).collect();
    let first = turned.first()?;
    let more = match turned.len() {
        1 => String::new(),
        n => format!(" and along {} more shared sides", n - 1),
    };
    let named: Vec<&NamedSurface> = model.output().collect();
    Some(format!(
        "note: the normals are on different sides along {} – {}{more}\n  help: .stl and .3mf are written with the \
         triangles of neighbours in one direction; the other formats keep that of each surface, u to v",
        name(&named, first.first),
        name(&named, first.second)
    ))
}

/// The pairs of sides that are near each other within the tolerance but leave a slit in the mesh, in words.
fn slits(model: &Model, near: &Joints, tolerance: f64) -> Vec<String> {
    let named: Vec<&NamedSurface> = model.output().collect();
    let unit = model.units.symbol();
    let slit = |j: &Joint| {
        format!(
            "note: {} and {} nearly meet, but with a gap of {} {unit} they are not joined: the mesh has a slit there\n  \
             help: the mesh joins sides within {} {unit}, a twentieth of its tolerance: move the sides together, or set a \
             tolerance of {} {unit} or more",
            name(&named, j.first),
            name(&named, j.second),
            number(j.gap, 4),
            number(JOINED * tolerance, 4),
            bound(j.gap / JOINED, 2),
        )
    };
    let slits = near.joints.iter();
    let slits = slits.filter(|j| j.gap > JOINED * tolerance);
    slits.map(slit).collect()
}
