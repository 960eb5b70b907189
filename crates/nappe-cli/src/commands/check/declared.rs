//! The checks that a model declares, and what is known of each.

use super::json::{joint_json, range_json};
use super::reached::SMOOTH_ANGLE;
use super::verdict::Verdict;
use super::words::{degrees, length, plain, range};
use crate::text::number;
use nappe::Interval;
use nappe::measure::{Continuity, JumpOptions, SideOf, continuity, continuity_in_part};
use nappe::mesh::{partial_joint, sides_apart};
use nappe_model::{Check, CheckTolerance};
use serde_json::{Value, json};

/// Relative to its range: what a side may lack and still be met from end to end, for the rounding of nearest points.
const WHOLE: f64 = 1e-9;

/// A declared check and what is known of it.
pub(super) struct Declared<'a> {
    pub(super) check: &'a Check,
    found: Found,
    pub(super) verdict: Verdict,
}

/// How two sides meet.
enum Found {
    /// From end to end.
    Whole(Continuity),
    /// In part.
    Part(Part),
    /// Not that it was found: the least and the greatest distance.
    Apart([f64; 2]),
}

/// What sides that meet in part have in common.
struct Part {
    /// The ranges of both parameters along which they meet, with what is known there. `None`: not from end to end of these
    /// ranges.
    stretches: Vec<([Interval; 2], Option<Continuity>)>,
    /// Whether one of them lies on the other from end to end.
    whole_side: bool,
    /// Whether they are together until one of them ends.
    to_ends: bool,
}

impl<'a> Declared<'a> {
    /// Examines a declared check: along whole sides if these meet, else along what they have in common. Tangent planes and
    /// curvatures are compared only of sides that meet within the tolerance of the mesh, and curvatures only where tangent
    /// planes agree.
    pub(super) fn of(check: &'a Check, tolerance: f64) -> Self {
        // How far sides may be apart, and from where on they do not meet: those that miss the claim by far are still to be
        // measured, to say by how much.
        let (claimed, near) = match check.tolerance {
            CheckTolerance::Length(x) => (x, tolerance.max(2.0 * x)),
            _ => (tolerance, tolerance),
        };
        let [a, b] = check
            .between
            .each_ref()
            .map(|s| (s.geometry.as_ref(), s.side));
        let found = meeting(a, b, near);
        let verdict = match &found {
            Found::Whole(joint) => verdict(check, joint, tolerance),
            Found::Part(part) => part.verdict(check, tolerance),
            Found::Apart([_, greatest]) if *greatest <= claimed => Verdict::Open,
            Found::Apart(_) => Verdict::Fails,
        };
        Self {
            check,
            found,
            verdict,
        }
    }

    fn sides(&self) -> [String; 2] {
        self.check
            .between
            .each_ref()
            .map(|s| format!("{}.{}", s.surface, s.side))
    }

    /// A row of the table.
    pub(super) fn row(&self, unit: &str) -> [String; 5] {
        let tolerance = match self.check.tolerance {
            CheckTolerance::Length(x) => format!("{} {unit}", number(x, 4)),
            CheckTolerance::Angle(x) => format!("{}°", number(x.to_degrees(), 4)),
            CheckTolerance::Relative(x) => number(x, 4),
        };
        [
            self.verdict.mark().to_owned(),
            self.sides().join(" – "),
            format!("{} within {tolerance}", self.check.continuity.name()),
            self.words(unit),
            self.verdict.word().to_owned(),
        ]
    }

    /// What is found, in words.
    fn words(&self, unit: &str) -> String {
        let joint = |j: &Continuity| {
            let gap = format!("gap {}", length(&j.gap, unit));
            match self.check.tolerance {
                CheckTolerance::Length(_) => gap,
                CheckTolerance::Angle(_) => format!("angle {}, {gap}", degrees(&j.angle)),
                CheckTolerance::Relative(_) => format!(
                    "curvature {}, angle {}, {gap}",
                    plain(&j.curvature),
                    degrees(&j.angle)
                ),
            }
        };
        match &self.found {
            Found::Whole(j) => joint(j),
            Found::Part(part) => {
                let one = |(ranges, j): &([Interval; 2], Option<Continuity>)| {
                    let along =
                        [0, 1].map(|k| range(self.check.between[k].side.along(), ranges[k]));
                    let what = j
                        .as_ref()
                        .map_or_else(|| "not from end to end".to_owned(), joint);
                    format!("along {}: {what}", along.join(" – "))
                };
                let each: Vec<String> = part.stretches.iter().map(one).collect();
                let beyond = if part.to_ends {
                    ""
                } else {
                    "; beside it they go apart before either ends"
                };
                format!("in part, {}{beyond}", each.join("; "))
            }
            Found::Apart([least, greatest]) => format!(
                "the sides do not meet: {} to {} {unit} apart",
                number(*least, 4),
                number(*greatest, 4)
            ),
        }
    }

    pub(super) fn json(&self) -> Value {
        let (kind, tolerance) = match self.check.tolerance {
            CheckTolerance::Length(x) => ("length", x),
            CheckTolerance::Angle(x) => ("angle", x),
            CheckTolerance::Relative(x) => ("relative curvature", x),
        };
        let (mut whole, mut parts, mut apart) = (None, Vec::new(), None);
        match &self.found {
            Found::Whole(j) => whole = Some(joint_json(j)),
            Found::Part(part) => {
                let one = |(ranges, j): &([Interval; 2], Option<Continuity>)| {
                    json!({
                        "along": ranges.map(range_json),
                        "found": j.as_ref().map(joint_json),
                    })
                };
                parts = part.stretches.iter().map(one).collect();
            }
            Found::Apart(distances) => apart = Some(distances),
        }
        json!({
            "between": self.sides(),
            "continuity": self.check.continuity.name(),
            "tolerance": { "of": kind, "value": tolerance },
            "found": whole,
            "in_part": matches!(self.found, Found::Part(_)),
            "stretches": parts,
            "sampled_distances": apart,
            "verdict": self.verdict.word(),
            "passes": self.verdict.passes(),
        })
    }
}

/// How two sides meet within a distance.
fn meeting(a: SideOf, b: SideOf, near: f64) -> Found {
    let options = JumpOptions::default();
    if let Some(joint) = continuity(a, b, near, &options) {
        return Found::Whole(joint);
    }
    let Some(joint) = partial_joint(a, b, near) else {
        return Found::Apart(sides_apart(a, b));
    };
    let stretches = joint.stretches.iter().flatten().map(|&[part, along]| {
        let ranges = if joint.part.0 == 0 {
            [part, along]
        } else {
            [along, part]
        };
        let found = continuity_in_part((a, ranges[0]), (b, ranges[1]), near, &options);
        (ranges, found)
    });
    let stretches: Vec<([Interval; 2], Option<Continuity>)> = stretches.collect();
    let whole_side = [a, b].iter().enumerate().any(|(k, side)| {
        let met: f64 = stretches.iter().map(|(ranges, _)| ranges[k].width()).sum();
        met >= (1.0 - WHOLE) * side.0.domain()[side.1.along() as usize].width()
    });
    Found::Part(Part {
        stretches,
        whole_side,
        to_ends: joint.to_ends,
    })
}

impl Part {
    /// Whether a claim holds of sides that meet in part.
    fn verdict(&self, check: &Check, tolerance: f64) -> Verdict {
        let each = self.stretches.iter().map(|(_, joint)| match joint {
            Some(joint) => verdict(check, joint, tolerance),
            None => Verdict::Open,
        });
        let along = each.reduce(Verdict::and).unwrap_or(Verdict::Open);
        // The gap where they go apart is wider than what is claimed, but sampled.
        let along = if self.to_ends {
            along
        } else {
            along.and(Verdict::Open)
        };
        if self.whole_side || check.in_part {
            along
        } else {
            along.and(Verdict::InPart)
        }
    }
}

/// Whether a claim holds where two sides meet.
fn verdict(check: &Check, joint: &Continuity, tolerance: f64) -> Verdict {
    let meets = Verdict::of(&joint.gap, tolerance);
    match check.tolerance {
        CheckTolerance::Length(x) => Verdict::of(&joint.gap, x),
        CheckTolerance::Angle(x) => meets.and(Verdict::of(&joint.angle, x)),
        CheckTolerance::Relative(x) => meets
            .and(Verdict::of(&joint.angle, SMOOTH_ANGLE))
            .and(Verdict::of(&joint.curvature, x)),
    }
}
