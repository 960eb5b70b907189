//! Colours.

use super::file::{File, Record};
use crate::Colour;
use std::collections::HashMap;

/// From a styled item to its colour there are at most seven steps.
const DEPTH: usize = 10;

/// The colour of each entity that has one of its own.
pub(super) fn colours(file: &File<'_>) -> HashMap<u64, Colour> {
    let mut found = HashMap::new();
    let mut known = HashMap::new();
    // Styles that override others come last.
    for kind in ["STYLED_ITEM", "OVER_RIDING_STYLED_ITEM"] {
        for id in file.all(kind) {
            let Ok(record) = file.record(id) else {
                continue;
            };
            let args = record.args();
            let (Ok(styles), Ok(item)) = (args.references(1), args.reference(2)) else {
                continue;
            };
            if let Some(c) = styles.iter().find_map(|s| colour(file, *s, 0, &mut known)) {
                found.insert(item, c);
            }
        }
    }
    found
}

/// The first colour that a style leads to.
fn colour(
    file: &File<'_>,
    id: u64,
    depth: usize,
    known: &mut HashMap<u64, Option<Colour>>,
) -> Option<Colour> {
    if depth > DEPTH {
        return None;
    }
    if let Some(c) = known.get(&id) {
        return *c;
    }
    // What leads back here has no colour from here.
    known.insert(id, None);
    let record = file.record(id).ok()?;
    let found = match record.kind() {
        "COLOUR_RGB" => rgb(&record),
        "DRAUGHTING_PRE_DEFINED_COLOUR" | "PRE_DEFINED_COLOUR" => named(&record.args().text(0)),
        _ => record
            .references()
            .into_iter()
            .find_map(|r| colour(file, r, depth + 1, known)),
    };
    known.insert(id, found);
    found
}

fn rgb(record: &Record<'_>) -> Option<Colour> {
    let args = record.args();
    let c = [1, 2, 3].map(|i| args.real(i).unwrap_or(f64::NAN));
    c.iter()
        .all(|x| (0.0..=1.0).contains(x))
        .then(|| c.map(|x| x as f32))
}

fn named(name: &str) -> Option<Colour> {
    Some(match name.to_ascii_lowercase().as_str() {
        "red" => [1.0, 0.0, 0.0],
        "green" => [0.0, 1.0, 0.0],
        "blue" => [0.0, 0.0, 1.0],
        "yellow" => [1.0, 1.0, 0.0],
        "magenta" => [1.0, 0.0, 1.0],
        "cyan" => [0.0, 1.0, 1.0],
        "black" => [0.0, 0.0, 0.0],
        "white" => [1.0, 1.0, 1.0],
        _ => return None,
    })
}
