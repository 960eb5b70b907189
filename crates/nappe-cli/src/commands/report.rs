//! What reports of several commands have in common.

use clap::ValueEnum;
use nappe::measure::Measured;
use nappe::mesh::Certainty;
use serde_json::{Value, json};

/// How a report is put out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ReportFormat {
    /// For people.
    Text,
    /// For programs.
    Json,
}

/// A certainty with its error; JSON has no infinity, so without a bound the error is null.
pub(super) fn certainty_json(c: Certainty) -> Value {
    let word = match c {
        Certainty::Exact => "exact",
        Certainty::Bounded(_) => "bounded",
        Certainty::Estimated(_) => "estimated",
    };
    json!({ "is": word, "error": Some(c.error()).filter(|e| e.is_finite()) })
}

/// A number with its certainty; an infinite one is null.
pub(super) fn measured_json(m: Measured) -> Value {
    json!({
        "value": Some(m.value).filter(|x| x.is_finite()),
        "certainty": certainty_json(m.certainty),
    })
}
