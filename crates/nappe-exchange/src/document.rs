//! What files of exact geometry hold: bodies and curves with names and colours.

use crate::{Colour, ExchangeError};
use nappe::body::Body;
use nappe::{CurveRef, DVec3, Units};
use std::path::Path;

/// The content of a file of exact geometry, read or to be written. Assemblies are laid out: every placed part is an item,
/// with its coordinates in the whole.
#[derive(Clone, Debug, Default)]
pub struct Document {
    /// The name of the product or file, if it has one.
    pub name: Option<String>,
    /// The unit of all coordinates. Files in other units (µm, miles) are converted to the nearest of these.
    pub units: Units,
    /// The distance within which the file says that its parts agree, in `units`; `None` if it says nothing.
    pub uncertainty: Option<f64>,
    /// Everything in it, in the order of the file.
    pub items: Vec<Item>,
    /// What a reader could not take over.
    pub left_out: Vec<LeftOut>,
}

impl Document {
    /// Refuses to write a file that would hold nothing.
    pub(crate) fn holds_something(&self, path: &Path) -> Result<(), ExchangeError> {
        if self.items.is_empty() {
            let (path, what) = (path.to_owned(), "surfaces or curves");
            return Err(ExchangeError::Nothing { path, what });
        }
        Ok(())
    }
}

/// One object of a document.
#[derive(Clone, Debug)]
pub struct Item {
    /// Its name; for a part of an assembly the names on the way to it, separated by `/`. Empty if it has none.
    pub name: String,
    /// Its colour, if it has one.
    pub colour: Option<Colour>,
    /// The geometry.
    pub form: ItemForm,
}

/// The geometry of an item.
#[derive(Clone, Debug)]
pub enum ItemForm {
    /// A solid, a sheet or single faces.
    Body {
        /// The faces and what bounds them.
        body: Body,
        /// For each face its own name and colour, where it has one; empty if none has.
        faces: Vec<FaceStyle>,
    },
    /// A curve that bounds nothing.
    Curve(CurveRef),
    /// Points.
    Points(Vec<DVec3>),
}

/// What a file says of a single face.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FaceStyle {
    /// Its name; empty if it has none.
    pub name: String,
    /// Its colour, if it differs from that of its body.
    pub colour: Option<Colour>,
}

/// Things of one kind that a reader left out.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// What they are, in the words of the format: `OFFSET_SURFACE`, `entity 140`.
    pub what: String,
    /// Why they were left out.
    pub why: String,
    /// How many.
    pub count: usize,
    /// The first of them, as the file numbers it: `#123`, `D45`.
    pub first: String,
    /// Whether it is geometry that the file shows, as a face, a curve or a point: the document is then not whole. Else it is
    /// something said of geometry (annotations, styles, units) or what the file itself hides.
    pub is_geometry: bool,
}

/// What a reader leaves out, by [`LeftOut::is_geometry`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lost {
    Geometry,
    Other,
}

/// Counts a thing that a reader leaves out, together with those of its kind that it leaves out for the same reason.
pub(crate) fn note(list: &mut Vec<LeftOut>, lost: Lost, what: String, why: String, first: String) {
    let is_geometry = lost == Lost::Geometry;
    let is_same = |l: &&mut LeftOut| l.what == what && l.why == why && l.is_geometry == is_geometry;
    if let Some(l) = list.iter_mut().find(is_same) {
        l.count += 1;
        return;
    }
    list.push(LeftOut {
        what,
        why,
        count: 1,
        first,
        is_geometry,
    });
}
