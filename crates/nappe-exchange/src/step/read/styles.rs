//! Colours.

use super::file::{File, Record};
use super::left::Left;
use crate::Colour;
use std::collections::HashMap;

/// What is said of the looks of things and not read.
const UNREAD: [(&str, &str); 2] = [
    (
        "CONTEXT_DEPENDENT_OVER_RIDING_STYLED_ITEM",
        "colours of single uses of a part are not read; it has the colour of the part",
    ),
    (
        "INVISIBILITY",
        "what is hidden in the file is read as if it were not",
    ),
];
/// From a styled item to its colour there are at most seven steps.
const DEPTH: usize = 10;

/// The colour of each entity that has one of its own. What is said of looks and not read is told.
pub(super) fn colours(file: &File<'_>, left: &mut Left) -> HashMap<u64, Colour> {
    for (kind, why) in UNREAD {
        for id in file.all(kind) {
            left.tell(&file.refused(id, why));
        }
    }
    let mut found = HashMap::new();
    // Of curves and of all else.
    let mut known = [HashMap::new(), HashMap::new()];
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
            let wire = is_wire(file.kind(item));
            let known = &mut known[usize::from(wire)];
            if let Some(c) = styles.iter().find_map(|s| colour(file, *s, wire, 0, known)) {
                found.insert(item, c);
            }
        }
    }
    found
}

/// Whether an item is made of curves or points.
fn is_wire(kind: &str) -> bool {
    const WIRES: [&str; 6] = [
        "CURVE",
        "LINE",
        "CIRCLE",
        "ELLIPSE",
        "POINT",
        "GEOMETRIC_SET",
    ];
    WIRES.iter().any(|w| kind.contains(w))
}

/// The first colour that a style leads to: of a solid or a face not that of its lines, of a curve not that of a surface.
fn colour(
    file: &File<'_>,
    id: u64,
    wire: bool,
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
        "CURVE_STYLE" | "POINT_STYLE" if !wire => None,
        "SURFACE_STYLE_USAGE" if wire => None,
        _ => record
            .references()
            .into_iter()
            .find_map(|r| colour(file, r, wire, depth + 1, known)),
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
