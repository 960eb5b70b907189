//! Shapes of Open CASCADE in text (`.brep`): edges as curves with their ranges, single vertices as points.
//!
//! Edges that bound faces, and the faces themselves, are left out and listed. Curves keep their own direction, whichever
//! way an edge uses them. There are no units.
//! Source: Open CASCADE Technology, *BRep Format*.

mod curves;
mod shapes;

use super::sheet::{dots, wire};
use super::words::Words;
use super::{Fault, shown};
use crate::document::{Document, Item, Lost, note};
use crate::iges::placed;
use curves::Stated;
use glam::DAffine3;
use shapes::{Form, Shape, Use};

/// Shapes placed in shapes may lay out to so many times their number, and this many more.
const MOST_PLACED: usize = 100_000;

pub(super) fn read(bytes: &[u8]) -> Result<Document, Fault> {
    let text = String::from_utf8_lossy(bytes);
    let mut words = Words::new(&text, 1);
    let version = version(&mut words)?;
    find(&mut words, "Locations")?;
    let places = places(&mut words)?;
    find(&mut words, "Curves")?;
    let count = words.count("curves", 7)?;
    let curves: Result<Vec<_>, Fault> = (0..count).map(|_| curves::stated(&mut words, 0)).collect();
    find(&mut words, "TShapes")?;
    let shapes = shapes::all(&mut words, version, places.len())?;
    let root = shapes::used(&mut words, shapes.len(), places.len())?;
    let mut layout = Layout {
        places,
        curves: curves?,
        shapes,
        document: Document::default(),
    };
    match root {
        Some(root) => layout.lay_out(root)?,
        None => return Err(words.fault("the shape of the file should be named here")),
    }
    Ok(layout.document)
}

/// The version that the header states.
fn version(words: &mut Words<'_>) -> Result<usize, Fault> {
    // Files written by the test harness have a line of their own first.
    let mut tell = words.next();
    if tell == Some("DBRep_DrawableShape") {
        tell = words.next();
    }
    if tell != Some("CASCADE") || words.next() != Some("Topology") {
        return Err(words.fault("a BREP file begins with `CASCADE Topology`"));
    }
    match words.word("the version")? {
        "V1," | "V1" => Ok(1),
        "V2," | "V2" => Ok(2),
        "V3," | "V3" => Ok(3),
        other => Err(words.fault(format!(
            "`{}` is no known version; V1, V2 and V3 are read",
            shown(other)
        ))),
    }
}

/// Goes on to the word that a section begins with.
fn find(words: &mut Words<'_>, section: &str) -> Result<(), Fault> {
    while let Some(word) = words.next() {
        if word == section {
            return Ok(());
        }
    }
    Err(words.fault(format!(
        "the file ends without the section `{section}`; it may be cut off"
    )))
}

/// The placements, from number 1; number 0 is none.
fn places(words: &mut Words<'_>) -> Result<Vec<DAffine3>, Fault> {
    let mut all = vec![DAffine3::IDENTITY];
    for _ in 0..words.count("locations", 2)? {
        let map = match words.whole("the kind of a location")? {
            1 => {
                let mut m = [0.0; 12];
                for row in 0..3 {
                    let [x, y, z, w] = words.reals("a number of a location")?;
                    for (column, value) in [x, y, z, w].into_iter().enumerate() {
                        m[3 * column + row] = value;
                    }
                }
                DAffine3::from_cols_array(&m)
            }
            2 => power(words, &all)?,
            kind => return Err(words.fault(format!("a location of the unknown kind {kind}"))),
        };
        if !(map.is_finite() && map.matrix3.determinant() != 0.0) {
            return Err(words.fault("a location that flattens space"));
        }
        all.push(map);
    }
    Ok(all)
}

/// A product of powers of earlier placements, the first of them applied first.
fn power(words: &mut Words<'_>, all: &[DAffine3]) -> Result<DAffine3, Fault> {
    /// Chains of placements repeat one of them a few times at most.
    const MOST: u32 = 1000;
    let mut map = DAffine3::IDENTITY;
    loop {
        let which = words.whole("the number of a location")?;
        if which == 0 {
            return Ok(map);
        }
        let one = *all.get(which).ok_or_else(|| {
            words.fault(format!(
                "location {which} is named, but there are {} so far",
                all.len() - 1
            ))
        })?;
        let word = words.word("the power of a location")?;
        let power: i32 = word
            .parse()
            .ok()
            .filter(|p: &i32| p.unsigned_abs() <= MOST)
            .ok_or_else(|| words.fault(format!("`{}` is no power of a location", shown(word))))?;
        let step = if power < 0 { one.inverse() } else { one };
        for _ in 0..power.unsigned_abs() {
            map = step * map;
        }
    }
}

/// What the file holds, and what becomes of it.
struct Layout {
    places: Vec<DAffine3>,
    curves: Vec<Result<Stated, String>>,
    shapes: Vec<Shape>,
    document: Document,
}

impl Layout {
    /// Takes over a shape and all that it is made of, in the order of the file.
    fn lay_out(&mut self, root: Use) -> Result<(), Fault> {
        let most = self.shapes.len().saturating_mul(4) + MOST_PLACED;
        let mut open = vec![(root, DAffine3::IDENTITY)];
        let mut visited = 0;
        while let Some((next, above)) = open.pop() {
            visited += 1;
            if visited > most {
                return Err(Fault::whole(format!(
                    "{} shapes are placed more than {most} times, out of proportion",
                    self.shapes.len()
                )));
            }
            let map = above * self.places[next.place];
            let shape = &self.shapes[next.shape];
            let first = format!("line {}", shape.line);
            let item = match &shape.form {
                Form::Group => {
                    open.extend(shape.parts.iter().rev().map(|part| (*part, map)));
                    continue;
                }
                Form::Face => Err((
                    "face",
                    "faces of .brep files are not read; write the shape as STEP".into(),
                )),
                Form::Pole => continue,
                Form::Point(p) => dots(String::new(), vec![map.transform_point3(*p)])
                    .map_err(|why| ("vertex", why)),
                Form::Edge(None) => Err(("edge", "it has no curve in space".into())),
                Form::Edge(Some(edge)) => self.edge(edge, map).map_err(|why| ("edge", why)),
            };
            match item {
                Ok(item) => self.document.items.push(item),
                Err((what, why)) => {
                    let lost = Lost::Geometry;
                    note(&mut self.document.left_out, lost, what.into(), why, first);
                }
            }
        }
        Ok(())
    }

    fn edge(&self, edge: &shapes::Edge, map: DAffine3) -> Result<Item, String> {
        let count = self.curves.len();
        let stated = edge.curve.checked_sub(1).and_then(|i| self.curves.get(i));
        let stated = stated
            .ok_or_else(|| format!("it names curve {}, and there are {count}", edge.curve))?;
        let place = self
            .places
            .get(edge.place)
            .ok_or_else(|| format!("it names location {}, which is not there", edge.place))?;
        let curve = stated.as_ref().map_err(String::clone)?.part(edge.range)?;
        let placed = placed(curve, map * *place)?;
        wire(String::new(), placed)
    }
}
