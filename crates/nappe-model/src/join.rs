//! Surfaces that belong together: a patch complex without gaps.

use crate::build::{Builder, Built, Patch};
use crate::curves::need;
use crate::data::{Datum, Item, Object};
use nappe::mesh::{Joint, joints, near_joints};
use nappe::surface::SurfaceRef;
use nappe::{Box3, significant};
use std::sync::Arc;

/// The greatest gap allowed along a shared side when nothing is said, relative to the size of the members.
const DEFAULT_GAP: f64 = 1e-6;
/// Sides this near, relative to the size, are meant to be shared: a gap that is larger than allowed and smaller than
/// this is a fault. Larger would take narrow slits that are meant for gaps, smaller would miss coarse data.
const MEANT: f64 = 1e-3;

/// A member: its name, its surface, and which entry of the list named it.
type Member = (String, Patch, usize);

impl Builder<'_> {
    /// A join: its members must hang together, and sides that are meant to be shared must not gap.
    pub(crate) fn join(&mut self, o: &Object) -> Built<Vec<Patch>> {
        let items: Vec<Item> = need(o.fields.list("surfaces"))?.to_vec();
        let label = format!("{}, `surfaces`", o.label);
        let mut members: Vec<Member> = Vec::new();
        let mut stop = None;
        for (i, item) in items.iter().enumerate() {
            let Datum::Text(name) = &item.datum else {
                continue;
            };
            let found = if name.contains('/') {
                self.surface(name, &label, &item.span)
                    .map(|s| Arc::new(Patch::one(s)))
            } else {
                self.patches(name, &label, &item.span)
            };
            match found {
                Ok(patches) => members.extend(patches.iter().map(|p| {
                    let full = p
                        .suffix
                        .as_ref()
                        .map_or(name.clone(), |s| format!("{name}/{s}"));
                    (full, p.clone(), i)
                })),
                Err(s) => stop = Some(s),
            }
        }
        if let Some(s) = stop {
            return Err(s);
        }
        if members.is_empty() {
            return Err(self.refuse(
                o,
                ("surfaces", &[]),
                "no surfaces are named",
                "name at least one surface",
            ));
        }
        let surfaces: Vec<SurfaceRef> = members.iter().map(|m| m.1.surface.clone()).collect();
        let size = surfaces
            .iter()
            .map(|s| s.bounds(s.domain()))
            .reduce(Box3::hull)
            .map_or(0.0, Box3::diagonal);
        let tol = match o.fields.number("tolerance") {
            Some(t) if t > 0.0 => t,
            Some(t) => {
                let message = format!("the tolerance is {t}: it must be greater than 0");
                return Err(self.refuse(o, ("tolerance", &[]), message, "write a length"));
            }
            None => DEFAULT_GAP * size,
        };
        if !(size.is_finite() && size > 0.0) {
            let message = format!("the size of the surfaces is {size}");
            return Err(self.refuse(
                o,
                ("surfaces", &[]),
                message,
                "use numbers of a reasonable size",
            ));
        }
        self.gaps(o, &members, &surfaces, [tol, MEANT * size])?;
        Ok(members
            .into_iter()
            .map(|(name, p, _)| Patch {
                suffix: Some(name),
                ..p
            })
            .collect())
    }

    /// Reports sides that gap by more than the first tolerance and less than the second, and members that touch no
    /// other.
    fn gaps(
        &mut self,
        o: &Object,
        members: &[Member],
        surfaces: &[SurfaceRef],
        tol: [f64; 2],
    ) -> Built<()> {
        let tight = joints(surfaces, tol[0]);
        let mut result = Ok(());
        if tol[1] > tol[0] {
            for j in near_joints(surfaces, &tight, tol[1]).joints {
                if j.first.0 != j.second.0 && j.gap > tol[0] {
                    result = Err(self.gap(o, members, &j, tol[0]));
                }
            }
        }
        result?;
        let mut group: Vec<usize> = (0..members.len()).collect();
        for j in &tight.joints {
            let (from, to) = (group[j.second.0], group[j.first.0]);
            group
                .iter_mut()
                .filter(|g| **g == from)
                .for_each(|g| *g = to);
        }
        let Some(lone) = group.iter().position(|g| *g != group[0]) else {
            return Ok(());
        };
        let message = format!(
            "{} shares no side with {} and its neighbours",
            members[lone].0, members[0].0
        );
        let help = "surfaces share a side when they use the same curve or side; leave this one out otherwise";
        Err(self.refuse(o, ("surfaces", &[members[lone].2]), message, help))
    }

    fn gap(&mut self, o: &Object, members: &[Member], j: &Joint, tol: f64) -> crate::build::Stop {
        let message = format!(
            "{}.{} and {}.{} gap by {} (allowed: {})",
            members[j.first.0].0,
            j.first.1,
            members[j.second.0].0,
            j.second.1,
            significant(j.gap, 6),
            significant(tol, 2)
        );
        let help = "let both surfaces use the same curve, or raise `tolerance`";
        self.refuse(o, ("surfaces", &[members[j.second.0].2]), message, help)
    }
}
