//! The report for programs.

use super::Findings;
use super::declared::Declared;
use crate::commands::report::certainty_json;
use crate::slits::Stretch;
use nappe::Interval;
use nappe::measure::{Continuity, Jump, tear};
use serde_json::{Value, json};

impl Findings<'_> {
    pub(super) fn json(&self) -> Value {
        let declared: Vec<Value> = self.declared.iter().map(Declared::json).collect();
        let shared: Vec<Value> = self
            .shared
            .iter()
            .map(|s| {
                json!({
                    "sides": s.sides,
                    "found": s.joint.as_ref().map(joint_json),
                    "sampled_gap": s.gap,
                    "joined": s.verdict.passes(),
                })
            })
            .collect();
        let surfaces: Vec<Value> = self
            .surfaces
            .iter()
            .map(|(s, r, creases)| {
                json!({
                    "name": s.name,
                    "regular": r.regular,
                    "torn": tear(s.surface.as_ref())
                        .map(|(dir, at)| json!({ "dir": dir.to_string(), "at": at })),
                    "creases": creases
                        .iter()
                        .map(|c| json!({"dir": c.dir.to_string(), "at": c.at, "angle": c.angle, "uv": c.uv}))
                        .collect::<Vec<_>>(),
                    "collapsed_sides": r.collapsed.iter().map(|s| s.name()).collect::<Vec<_>>(),
                    "pinches": r.pinches
                        .iter()
                        .map(|p| json!({ "dir": p.dir.to_string(), "at": p.at, "point": p.point.to_array() }))
                        .collect::<Vec<_>>(),
                    "folds": r.folds,
                    "degenerate": r.degenerate,
                })
            })
            .collect();
        json!({
            "units": self.unit,
            "angles": "radians",
            "checks": declared,
            "shared_sides": shared,
            "open_sides": self.open_sides(),
            "sides_in_part": self.in_part.json(|k| self.stretches_json(k)),
            "surfaces": surfaces,
            "passing_through": self.passing.json(),
            "failures": self.failures(),
        })
    }

    /// The stretches of a partial joint.
    fn stretches_json(&self, of: usize) -> Value {
        let one = |s: &Stretch| {
            json!({
                "along": range_json(s.ranges[0]),
                "part": range_json(s.ranges[1]),
                "found": s.joint.as_ref().map(joint_json),
            })
        };
        let own = self.stretches.iter().filter(|s| s.of == of);
        own.map(one).collect()
    }
}

pub(super) fn range_json(range: Interval) -> [f64; 2] {
    [range.lo, range.hi]
}

pub(super) fn joint_json(j: &Continuity) -> Value {
    let jump = |x: &Jump| {
        json!({
            "at_most": certainty_json(x.greatest), "found": x.found, "at": x.at, "point": x.point.to_array(),
        })
    };
    json!({
        "gap": jump(&j.gap),
        "angle": jump(&j.angle),
        "relative_curvature_jump": jump(&j.curvature),
        "same_orientation": j.same_orientation,
    })
}
