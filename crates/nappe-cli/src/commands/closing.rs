//! The table with which commands end that write meshes.

use crate::text::{self, Table, bound, number};
use nappe::DVec3;
use nappe::mesh::Certainty;
use nappe_exchange::{Scene, WriteReport};
use std::time::Instant;

/// A coordinate smaller than this share of the box is shown as 0.
const NEGLIGIBLE: f64 = 1e-9;

/// The rows on a mesh: triangles, box, error.
pub(super) fn mesh(table: &mut Table, scene: &Scene) {
    let unit = scene.units.symbol();
    table.row(["triangles".to_owned(), text::count(scene.triangles())]);
    if let Some([lo, hi]) = scene.extent() {
        let size = (hi - lo).to_array().map(|x| number(x, 5)).join(" × ");
        // Rounding leaves a coordinate of 1e-15 where 0 is meant.
        let negligible = NEGLIGIBLE * (hi - lo).length();
        let place = |x: f64| if x.abs() < negligible { 0.0 } else { x };
        let range = |p: DVec3| p.to_array().map(|x| number(place(x), 5)).join(", ");
        table.row([
            "box".to_owned(),
            format!("{size} {unit}, from ({}) to ({})", range(lo), range(hi)),
        ]);
    }
    table.row(["mesh error".to_owned(), certainty(scene.deviation(), unit)]);
}

/// The rows on the files, and on the time.
pub(super) fn files(table: &mut Table, scene: &Scene, reports: &[WriteReport], start: Instant) {
    let unit = scene.units.symbol();
    for (i, r) in reports.iter().enumerate() {
        let name = if i == 0 { "files" } else { "" };
        // Worth a word only where it shows.
        let rounded = if certainty(r.deviation, unit) == certainty(scene.deviation(), unit) {
            String::new()
        } else {
            format!(
                "; error with the format's rounding {}",
                certainty(r.deviation, unit)
            )
        };
        table.row([
            name.to_owned(),
            format!("{} ({}{rounded})", r.path.display(), text::bytes(r.bytes)),
        ]);
    }
    table.row([
        "time".to_owned(),
        format!("{} s", number(start.elapsed().as_secs_f64(), 3)),
    ]);
}

/// A deviation in words.
fn certainty(c: Certainty, unit: &str) -> String {
    match c {
        Certainty::Exact => "none, exact".to_owned(),
        Certainty::Bounded(e) => format!("at most {} {unit}, proven", bound(e, 3)),
        Certainty::Estimated(e) => format!("about {} {unit}, estimated, not proven", bound(e, 3)),
    }
}
