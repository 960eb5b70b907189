//! The report for people.

use super::Findings;
use super::reached::smoothness;
use super::verdict::Verdict;
use super::words::{crease, degrees, length, pinched, places, plain, range};
use crate::slits::JOINED;
use crate::text::{Table, bound, torn};
use nappe::measure::{Continuity, Jump, tear};
use nappe::surface::Side;

impl Findings<'_> {
    pub(super) fn text(&self) -> String {
        let mut parts = Vec::new();
        if !self.declared.is_empty() {
            parts.push(format!("Declared checks\n\n{}", self.declared_table()));
        }
        if !self.shared.is_empty() {
            parts.push(format!("Shared sides\n\n{}", self.shared_table()));
        }
        if !self.stretches.is_empty() {
            parts.push(format!(
                "Sides that meet in part\n\n{}",
                self.stretch_table()
            ));
        }
        if !self.open.is_empty() {
            parts.push(format!("Open sides: {}", self.open_sides().join(", ")));
        }
        if !self.surfaces.is_empty() {
            parts.push(format!("Surfaces\n\n{}", self.surface_table()));
            parts.push(self.passing.text());
        }
        parts.push(match self.failures() {
            0 => format!("✓ nothing fails{}", self.reservations()),
            1 => "✗ 1 failure".to_owned(),
            n => format!("✗ {n} failures"),
        });
        parts.join("\n\n") + "\n"
    }

    /// What passes without a proof, for the last line.
    fn reservations(&self) -> String {
        let seems = |v: Verdict| v == Verdict::Seems;
        let estimated = self.declared.iter().filter(|d| seems(d.verdict)).count()
            + self.shared.iter().filter(|s| seems(s.verdict)).count();
        let open = self.passing.undecided();
        let told = [
            (
                estimated,
                "claim is only estimated",
                "claims are only estimated",
            ),
            (
                open,
                "pair is not decided for crossings",
                "pairs are not decided for crossings",
            ),
        ];
        let told = told.into_iter().filter(|t| t.0 > 0);
        told.map(|(n, one, many)| format!("; {n} {}", if n == 1 { one } else { many }))
            .collect()
    }

    fn declared_table(&self) -> Table {
        let mut table = Table::headed(["", "sides", "claim", "found", "verdict"]);
        for d in &self.declared {
            table.row(d.row(self.unit));
        }
        table
    }

    fn shared_table(&self) -> Table {
        let mut table =
            Table::headed(["", "sides", "gap", "angle", "curvature jump", "smoothness"]);
        for s in &self.shared {
            let [gap, angle, jump, smooth] = match &s.joint {
                None => [
                    format!("about {} {}", bound(s.gap, 2), self.unit),
                    String::new(),
                    String::new(),
                    "not joined".to_owned(),
                ],
                Some(j) => [
                    self.length(&j.gap),
                    degrees(&j.angle),
                    plain(&j.curvature),
                    if s.verdict.passes() {
                        smoothness(j)
                    } else {
                        "not joined"
                    }
                    .to_owned(),
                ],
            };
            let sides = s.sides.join(" – ");
            table.row([s.verdict.mark().to_owned(), sides, gap, angle, jump, smooth]);
        }
        table
    }

    pub(super) fn open_sides(&self) -> Vec<String> {
        let name = |(i, side): &(usize, Side)| format!("{}.{side}", self.surfaces[*i].0.name);
        self.open.iter().map(name).collect()
    }

    fn stretch_table(&self) -> Table {
        let mut table = Table::headed([
            "",
            "sides",
            "along the first",
            "gap",
            "angle",
            "curvature jump",
            "smoothness",
        ]);
        for s in &self.stretches {
            let [gap, angle, jump, smooth] = match &s.joint {
                None => ["", "", "", "not from end to end"].map(str::to_owned),
                Some(j) => [
                    self.length(&j.gap),
                    degrees(&j.angle),
                    plain(&j.curvature),
                    if self.is_close(j) {
                        smoothness(j)
                    } else {
                        "apart"
                    }
                    .to_owned(),
                ],
            };
            let sides = self.in_part.names(s.sides);
            let place = range(s.sides[0].1.along(), s.ranges[0]);
            table.row(["•".to_owned(), sides, place, gap, angle, jump, smooth]);
        }
        table
    }

    /// Whether sides meet so closely that the mesh would join them if they had the same ends.
    pub(super) fn is_close(&self, j: &Continuity) -> bool {
        Verdict::of(&j.gap, JOINED * self.tolerance).passes()
    }

    fn surface_table(&self) -> Table {
        let mut table = Table::headed(["", "surface", "tangent plane", "creases", "poles"]);
        for (s, r, creases) in &self.surfaces {
            let tear = tear(s.surface.as_ref());
            let mark = if r.folds.is_empty() && tear.is_none() {
                "✓"
            } else {
                "✗"
            };
            let state = if let Some(tear) = tear {
                torn(tear)
            } else if !r.pinches.is_empty() && r.folds.is_empty() {
                pinched(r)
            } else if r.regular {
                "in every piece, proven".to_owned()
            } else if !r.folds.is_empty() {
                format!("folds over at {}", places(&r.folds))
            } else if !r.degenerate.is_empty() {
                format!("none, or not proven, at {}", places(&r.degenerate))
            } else {
                format!("not proven; the normal is least at {}", places(&[r.at]))
            };
            let poles: Vec<&str> = r.collapsed.iter().map(|s| s.name()).collect();
            table.row([
                mark,
                s.name.as_str(),
                state.as_str(),
                creases
                    .iter()
                    .map(crease)
                    .collect::<Vec<_>>()
                    .join(", ")
                    .as_str(),
                poles.join(", ").as_str(),
            ]);
        }
        table
    }

    fn length(&self, jump: &Jump) -> String {
        length(jump, self.unit)
    }
}
