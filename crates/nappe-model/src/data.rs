//! What was read: typed data with their places, by the names of the registry.

use crate::registry::Kind;
use crate::value::Span;
use nappe::DVec3;
use nappe::expr::Bound;
use nappe::surface::Side;

/// A datum of the shape that the registry asks for.
#[derive(Clone, Debug)]
pub(crate) enum Datum {
    Number(f64),
    /// In radians.
    Angle(f64),
    Bool(bool),
    /// A text, a word of a choice, or the name of a surface.
    Text(String),
    Vector(DVec3),
    Formula(Bound),
    Curve(CurveSource),
    Side(SideName),
    /// A list; of a grid, the rows.
    List(Vec<Item>),
    Record(Fields),
}

/// Where a curve comes from.
#[derive(Clone, Debug)]
pub(crate) enum CurveSource {
    Named(String),
    Side(SideName),
    Inline(Box<Object>),
}

/// A side of a surface by name.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SideName {
    pub(crate) surface: String,
    pub(crate) side: Side,
}

/// A datum and its place.
#[derive(Clone, Debug)]
pub(crate) struct Item {
    pub(crate) span: Span,
    pub(crate) datum: Datum,
}

/// The values of a table, complete by the registry.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fields {
    pub(crate) entries: Vec<(&'static str, Item)>,
    /// Where the table is named; the place of what is missing.
    pub(crate) span: Span,
}

/// A curve or surface as written.
#[derive(Clone, Debug)]
pub(crate) struct Object {
    /// Such as "surface `dome`".
    pub(crate) label: String,
    pub(crate) kind: &'static Kind,
    pub(crate) fields: Fields,
    pub(crate) construction_only: bool,
}

impl Fields {
    pub(crate) fn get(&self, name: &str) -> Option<&Item> {
        self.entries
            .iter()
            .find(|(k, _)| *k == name)
            .map(|(_, v)| v)
    }

    /// The most specific place: an entry of a key's list, the key's value, or the table.
    pub(crate) fn place(&self, name: &str, path: &[usize]) -> Span {
        let Some(mut item) = self.get(name) else {
            return self.span.clone();
        };
        for &i in path {
            match &item.datum {
                Datum::List(l) if i < l.len() => item = &l[i],
                _ => break,
            }
        }
        item.span.clone()
    }

    pub(crate) fn number(&self, name: &str) -> Option<f64> {
        match self.get(name)?.datum {
            Datum::Number(x) | Datum::Angle(x) => Some(x),
            _ => None,
        }
    }

    pub(crate) fn flag(&self, name: &str) -> bool {
        matches!(self.get(name).map(|i| &i.datum), Some(Datum::Bool(true)))
    }

    pub(crate) fn text(&self, name: &str) -> Option<&str> {
        match &self.get(name)?.datum {
            Datum::Text(t) => Some(t),
            _ => None,
        }
    }

    pub(crate) fn vector(&self, name: &str) -> Option<DVec3> {
        self.get(name)?.vector()
    }

    pub(crate) fn record(&self, name: &str) -> Option<&Fields> {
        match &self.get(name)?.datum {
            Datum::Record(r) => Some(r),
            _ => None,
        }
    }

    pub(crate) fn list(&self, name: &str) -> Option<&[Item]> {
        self.get(name)?.list()
    }

    pub(crate) fn vectors(&self, name: &str) -> Option<Vec<DVec3>> {
        self.list(name)?.iter().map(Item::vector).collect()
    }

    pub(crate) fn numbers(&self, name: &str) -> Option<Vec<f64>> {
        self.list(name)?.iter().map(Item::number).collect()
    }

    pub(crate) fn vector_rows(&self, name: &str) -> Option<Vec<Vec<DVec3>>> {
        self.list(name)?
            .iter()
            .map(|row| row.list()?.iter().map(Item::vector).collect())
            .collect()
    }

    pub(crate) fn number_rows(&self, name: &str) -> Option<Vec<Vec<f64>>> {
        self.list(name)?
            .iter()
            .map(|row| row.list()?.iter().map(Item::number).collect())
            .collect()
    }
}

impl Item {
    pub(crate) fn number(&self) -> Option<f64> {
        match self.datum {
            Datum::Number(x) | Datum::Angle(x) => Some(x),
            _ => None,
        }
    }

    /// A vector, or a direction given as `x`, `y` or `z`.
    pub(crate) fn vector(&self) -> Option<DVec3> {
        match &self.datum {
            Datum::Vector(v) => Some(*v),
            Datum::Text(t) => match t.as_str() {
                "x" => Some(DVec3::X),
                "y" => Some(DVec3::Y),
                "z" => Some(DVec3::Z),
                _ => None,
            },
            _ => None,
        }
    }

    pub(crate) fn list(&self) -> Option<&[Item]> {
        match &self.datum {
            Datum::List(l) => Some(l),
            _ => None,
        }
    }
}
