//! What is known of a claim.

use nappe::measure::Jump;
use nappe::mesh::Certainty;

/// What is known of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Proven.
    Holds,
    /// Sampling found nothing against it, and nothing can be proven.
    Seems,
    /// It holds of what the sides have in common, but both of them go on without the other.
    InPart,
    /// Neither proven nor refuted.
    Open,
    /// Refuted.
    Fails,
}

impl Verdict {
    pub(super) fn of(jump: &Jump, tolerance: f64) -> Verdict {
        match (jump.within(tolerance), jump.greatest) {
            (Some(true), _) => Verdict::Holds,
            (Some(false), _) => Verdict::Fails,
            (None, Certainty::Estimated(e)) if e <= tolerance => Verdict::Seems,
            (None, _) => Verdict::Open,
        }
    }

    /// The less certain of two claims that must both hold.
    pub(super) fn and(self, other: Verdict) -> Verdict {
        let rank = |v| {
            [
                Verdict::Holds,
                Verdict::Seems,
                Verdict::InPart,
                Verdict::Open,
                Verdict::Fails,
            ]
            .iter()
            .position(|&w| w == v)
        };
        if rank(self) >= rank(other) {
            self
        } else {
            other
        }
    }

    pub(super) fn passes(self) -> bool {
        matches!(self, Verdict::Holds | Verdict::Seems)
    }

    pub(super) fn mark(self) -> &'static str {
        if self.passes() { "✓" } else { "✗" }
    }

    pub(super) fn word(self) -> &'static str {
        match self {
            Verdict::Holds => "proven",
            Verdict::Seems => "estimated",
            Verdict::InPart => "only in part",
            Verdict::Open => "not proven",
            Verdict::Fails => "fails",
        }
    }
}
