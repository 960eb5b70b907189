//! Vertices, edges, faces and what is made of them.

use super::super::words::Words;
use super::super::{Fault, shown};
use glam::DVec3;

/// A shape, and the line it begins at.
#[derive(Debug)]
pub(super) struct Shape {
    pub(super) line: usize,
    pub(super) form: Form,
    pub(super) parts: Vec<Use>,
}

#[derive(Debug)]
pub(super) enum Form {
    Point(DVec3),
    /// An edge, with its curve in space if it has one.
    Edge(Option<Edge>),
    /// An edge that is one point of a surface.
    Pole,
    Face,
    /// Wires, shells, solids, compounds.
    Group,
}

/// The curve of an edge: its number from 1, that of its placement, and its range.
#[derive(Debug)]
pub(super) struct Edge {
    pub(super) curve: usize,
    pub(super) place: usize,
    pub(super) range: [f64; 2],
}

/// A shape as a part of another: its place in the list, and the number of its placement.
#[derive(Clone, Copy, Debug)]
pub(super) struct Use {
    pub(super) shape: usize,
    pub(super) place: usize,
}

/// All shapes. What one is made of comes before it.
pub(super) fn all(
    words: &mut Words<'_>,
    version: usize,
    places: usize,
) -> Result<Vec<Shape>, Fault> {
    let count = words.count("shapes", 3)?;
    let mut all: Vec<Shape> = Vec::with_capacity(count);
    for at in 0..count {
        let kind = words.word("the kind of a shape")?;
        let line = words.line();
        let form = match kind {
            "Ve" => vertex(words)?,
            "Ed" => edge(words, version)?,
            "Fa" => face(words)?,
            "Wi" | "Sh" | "So" | "CS" | "Co" => Form::Group,
            other => {
                return Err(words.fault(format!("`{}` is no kind of shape", shown(other))));
            }
        };
        let flags = words.word("the flags of a shape")?;
        if flags.len() > 8 || !flags.bytes().all(|b| matches!(b, b'0' | b'1')) {
            return Err(words.fault(format!(
                "`{}` should be the flags of a shape, seven digits 0 and 1",
                shown(flags)
            )));
        }
        let mut parts = Vec::new();
        while let Some(part) = used(words, count, places)? {
            if part.shape >= at {
                return Err(words.fault("a shape is made of one that comes later"));
            }
            parts.push(part);
        }
        all.push(Shape { line, form, parts });
    }
    Ok(all)
}

/// A shape that is named, or `None` at the end of a list. Numbers count from the last shape.
pub(super) fn used(
    words: &mut Words<'_>,
    shapes: usize,
    places: usize,
) -> Result<Option<Use>, Fault> {
    let word = words.word("the number of a shape")?;
    if word == "*" {
        return Ok(None);
    }
    let number = word.strip_prefix(['+', '-', 'i', 'e']);
    let number: Option<usize> = number.and_then(|n| n.parse().ok());
    let shape = number.and_then(|n| shapes.checked_sub(n).filter(|_| n > 0));
    let shape = shape.ok_or_else(|| {
        words.fault(format!(
            "`{}` should be `+`, `-`, `i` or `e` and the number of one of {shapes} shapes",
            shown(word)
        ))
    })?;
    let place = words.whole("the number of a location")?;
    if place >= places {
        return Err(words.fault(format!(
            "location {place} is named, and there are {}",
            places.saturating_sub(1)
        )));
    }
    Ok(Some(Use { shape, place }))
}

fn vertex(words: &mut Words<'_>) -> Result<Form, Fault> {
    words.real("a tolerance")?;
    let point = words.point("a coordinate")?;
    // Where it is on curves and surfaces; 0 0 ends the list.
    loop {
        words.real("a parameter")?;
        let more = match words.whole("the kind of a vertex's place")? {
            0 => return Ok(Form::Point(point)),
            // Curve and location; surface too; a second parameter, surface and location.
            1 => 2,
            2 | 3 => 3,
            kind => return Err(words.fault(format!("a vertex has the unknown place {kind}"))),
        };
        skip(words, more)?;
    }
}

fn edge(words: &mut Words<'_>, version: usize) -> Result<Form, Fault> {
    words.real("a tolerance")?;
    skip(words, 2)?;
    let pole = words.whole("whether an edge is a point, 0 or 1")? != 0;
    let mut curve = None;
    loop {
        match words.whole("the kind of an edge's curve")? {
            0 => break,
            1 => {
                let (number, place) = (words.whole("a curve")?, words.whole("a location")?);
                let range = words.reals("a parameter")?;
                if number > 0 {
                    curve = Some(Edge {
                        curve: number,
                        place,
                        range,
                    });
                }
            }
            kind @ (2 | 3) => {
                skip(words, 1)?;
                if kind == 3 {
                    // The second curve and the smoothness, which may be written without a space between.
                    let word = words.word("a curve")?;
                    if word.bytes().all(|b| b.is_ascii_digit()) {
                        skip(words, 1)?;
                    }
                }
                // Surface, location, range, and in one version the parameters of the ends.
                skip(words, if version == 2 { 8 } else { 4 })?;
            }
            4 => skip(words, 5)?,
            5 => skip(words, 2)?,
            6 => skip(words, 3)?,
            7 => skip(words, 4)?,
            kind => return Err(words.fault(format!("an edge has the unknown curve {kind}"))),
        }
    }
    Ok(if pole { Form::Pole } else { Form::Edge(curve) })
}

fn face(words: &mut Words<'_>) -> Result<Form, Fault> {
    // Whether it is all of its surface, tolerance, surface, location.
    skip(words, 4)?;
    if words.peek() == Some("2") {
        // Its triangles.
        skip(words, 2)?;
    }
    Ok(Form::Face)
}

fn skip(words: &mut Words<'_>, count: usize) -> Result<(), Fault> {
    for _ in 0..count {
        words.word("more of a shape")?;
    }
    Ok(())
}
