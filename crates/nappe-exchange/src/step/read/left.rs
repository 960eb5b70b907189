//! What is left out, counted.

use super::file::Refused;
use crate::LeftOut;
use crate::document::Lost;
use std::collections::HashMap;

/// More different reasons than this are one: a list that nobody reads to its end.
const REASONS: usize = 200;

/// Parts of the keywords of items that are no geometry.
const WORDS: [&str; 14] = [
    "ANNOTATION",
    "CALLOUT",
    "CAMERA",
    "COUNT_",
    "DESCRIPTIVE",
    "DIMENSION",
    "DIRECTION",
    "MEASURE",
    "PLACEMENT",
    "QUALIFIED",
    "STYLED",
    "SYMBOL",
    "TEXT",
    "VALUE",
];

/// What is lost with an item of a shape, of a kind: some are there to be read by people, or are numbers.
pub(super) fn lost_with(kind: &str) -> Lost {
    if WORDS.iter().any(|w| kind.contains(w)) {
        Lost::Other
    } else {
        Lost::Geometry
    }
}

/// A list of things left out.
#[derive(Debug, Default)]
pub(super) struct Left {
    list: Vec<LeftOut>,
    places: HashMap<(String, String, bool), usize>,
}

impl Left {
    /// Adds what the file shows.
    pub(super) fn add(&mut self, refused: &Refused) {
        self.put(refused, Lost::Geometry);
    }

    /// Adds what is said of geometry, or is not shown.
    pub(super) fn tell(&mut self, refused: &Refused) {
        self.put(refused, Lost::Other);
    }

    pub(super) fn put(&mut self, refused: &Refused, lost: Lost) {
        self.count(LeftOut {
            what: refused.what.clone(),
            why: refused.why.clone(),
            count: 1,
            first: format!("#{}", refused.id),
            is_geometry: lost == Lost::Geometry,
        });
    }

    /// Adds all of another list.
    pub(super) fn append(&mut self, other: Left) {
        other.list.into_iter().for_each(|l| self.count(l));
    }

    fn count(&mut self, left: LeftOut) {
        let mut key = (left.what.clone(), left.why.clone(), left.is_geometry);
        if self.list.len() >= REASONS && !self.places.contains_key(&key) {
            key.0 = "more".into();
            key.1 = "of many kinds and for many reasons".into();
        }
        if let Some(i) = self.places.get(&key) {
            self.list[*i].count += left.count;
            return;
        }
        self.places.insert(key.clone(), self.list.len());
        self.list.push(LeftOut {
            what: key.0,
            why: key.1,
            ..left
        });
    }

    pub(super) fn done(self) -> Vec<LeftOut> {
        self.list
    }
}
