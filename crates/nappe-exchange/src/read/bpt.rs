//! Bézier nets (`.bpt`): the number of patches, then for each its two degrees and its points.
//!
//! Points are taken with the first parameter running fastest, as in G+Smo files. There are no weights and no units.

use super::sheet::sheet;
use super::words::Words;
use super::{Fault, net};
use crate::document::Document;
use glam::DVec3;
use nappe::NurbsSurface;

pub(super) fn read(bytes: &[u8]) -> Result<Document, Fault> {
    let text = String::from_utf8_lossy(bytes);
    let mut words = Words::new(&text, 1);
    let mut document = Document::default();
    for patch in 1..=words.count("patches", 14)? {
        let [m, n] = [words.whole("a degree")?, words.whole("a degree")?];
        let first = words.line();
        let size = [m, n].map(|d| d.saturating_add(1));
        let count = size[0].saturating_mul(size[1]);
        words.holds(count, "points of a patch", 3)?;
        let points: Result<Vec<DVec3>, Fault> =
            (0..count).map(|_| words.point("a coordinate")).collect();
        let item = NurbsSurface::bezier(size[0], &net(&points?, size), None)
            .map_err(|e| e.to_string())
            .and_then(|s| sheet(String::new(), s));
        document
            .items
            .push(item.map_err(|e| Fault::line(first, format!("patch {patch}: {e}")))?);
    }
    match words.next() {
        None => Ok(document),
        Some(_) => Err(words.fault("there is more than the announced patches")),
    }
}
