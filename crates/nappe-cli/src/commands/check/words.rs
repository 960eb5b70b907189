//! Bounds and places in words.

use crate::text::{bound, number};
use nappe::Interval;
use nappe::measure::{Crease, Jump, Regularity};
use nappe::mesh::Certainty;
use nappe::surface::Dir;
use std::f64::consts::PI;

/// A bound in some unit.
fn shown(c: Certainty, unit: f64, symbol: &str) -> String {
    match c {
        Certainty::Exact => format!("0{symbol}"),
        Certainty::Bounded(e) if !e.is_finite() => "unbounded".to_owned(),
        Certainty::Estimated(e) if !e.is_finite() => "unknown".to_owned(),
        Certainty::Bounded(e) => format!("≤ {}{symbol}", bound(e * unit, 4)),
        Certainty::Estimated(e) => format!("{}{symbol} (estimated)", bound(e * unit, 4)),
    }
}

/// What is said of a surface with lines that are one point.
pub(super) fn pinched(r: &Regularity) -> String {
    let lines: Vec<String> = r
        .pinches
        .iter()
        .map(|p| format!("{} = {}", p.dir, number(p.at, 6)))
        .collect();
    let rest = match (r.regular, r.degenerate.is_empty()) {
        (true, _) => "; elsewhere proven".to_owned(),
        (false, true) => "; elsewhere proven, but not close to it".to_owned(),
        (false, false) => format!("; none, or not proven, at {}", places(&r.degenerate)),
    };
    format!(
        "{} is one point, where it touches itself{rest}",
        lines.join(", ")
    )
}

pub(super) fn crease(c: &Crease) -> String {
    format!(
        "{} = {} ({}°)",
        c.dir,
        number(c.at, 6),
        number(c.angle.to_degrees(), 4)
    )
}

pub(super) fn degrees(jump: &Jump) -> String {
    // A bound of half a turn, rounded upwards, would show an angle that there is not.
    let greatest = match jump.greatest {
        Certainty::Bounded(e) if e.is_finite() => Certainty::Bounded(e.min(PI)),
        other => other,
    };
    shown(greatest, 1f64.to_degrees(), "°")
}

pub(super) fn length(jump: &Jump, unit: &str) -> String {
    shown(jump.greatest, 1.0, &format!(" {unit}"))
}

pub(super) fn plain(jump: &Jump) -> String {
    shown(jump.greatest, 1.0, "")
}

/// A range of a parameter along a side.
pub(super) fn range(along: Dir, range: Interval) -> String {
    format!(
        "{along} from {} to {}",
        number(range.lo, 6),
        number(range.hi, 6)
    )
}

/// Places told in a line; the JSON has all.
const MOST_PLACES: usize = 3;

pub(super) fn places(uv: &[[f64; 2]]) -> String {
    let some = uv.iter().take(MOST_PLACES);
    let told: Vec<String> = some
        .map(|[u, v]| format!("u = {}, v = {}", number(*u, 4), number(*v, 4)))
        .collect();
    let more = uv.len().saturating_sub(MOST_PLACES);
    if more > 0 {
        format!("{} and {more} more places", told.join("; "))
    } else {
        told.join("; ")
    }
}
