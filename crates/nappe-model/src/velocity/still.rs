//! What does not change.

use crate::data::{CurveSource, Datum, Fields, Item};

/// True if no number of a table has a rate other than 0. What other objects do is not looked at.
pub(super) fn fields(rates: &Fields) -> bool {
    rates.entries.iter().all(|(_, i)| item(i))
}

/// The same for one datum.
pub(super) fn item(rate: &Item) -> bool {
    match &rate.datum {
        Datum::Number(x) | Datum::Angle(x) => *x == 0.0,
        Datum::Vector(v) => *v == nappe::DVec3::ZERO,
        Datum::Formula(f) => f.is_constant() && f.value(&[0.0; 2]) == Ok(0.0),
        Datum::Curve(CurveSource::Inline(object)) => fields(&object.fields),
        Datum::Bool(_) | Datum::Text(_) | Datum::Curve(_) | Datum::Side(_) => true,
        Datum::List(list) => list.iter().all(item),
        Datum::Record(r) => fields(r),
    }
}

/// An object that another is made of.
pub(super) enum Part {
    Curve(String),
    Surface(String),
}

/// The names of the objects that a table refers to. A text may be the name of a surface.
pub(super) fn parts(table: &Fields, found: &mut Vec<Part>) {
    // What a file holds does not move, and its names are not those of the model.
    if table.get("file").is_some() {
        return;
    }
    table.entries.iter().for_each(|(_, i)| of_item(i, found));
}

fn of_item(item: &Item, found: &mut Vec<Part>) {
    match &item.datum {
        Datum::Curve(CurveSource::Named(name)) => found.push(Part::Curve(name.clone())),
        Datum::Curve(CurveSource::Side(side)) | Datum::Side(side) => {
            found.push(Part::Surface(side.surface.clone()));
        }
        Datum::Text(name) => found.push(Part::Surface(name.clone())),
        Datum::Curve(CurveSource::Inline(object)) => parts(&object.fields, found),
        Datum::List(list) => list.iter().for_each(|i| of_item(i, found)),
        Datum::Record(r) => parts(r, found),
        Datum::Number(_)
        | Datum::Angle(_)
        | Datum::Bool(_)
        | Datum::Vector(_)
        | Datum::Formula(_) => {}
    }
}
