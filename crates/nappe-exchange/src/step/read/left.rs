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

    /// Adds an item of a shape, of a kind: some are there to be read by people, or are numbers.
    pub(super) fn item(&mut self, refused: &Refused, kind: &str) {
        let is_other = WORDS.iter().any(|w| kind.contains(w));
        let lost = if is_other {
            Lost::Other
        } else {
            Lost::Geometry
        };
        self.put(refused, lost);
    }

    fn put(&mut self, refused: &Refused, lost: Lost) {
        let is_geometry = lost == Lost::Geometry;
        let mut key = (refused.what.clone(), refused.why.clone(), is_geometry);
        if self.list.len() >= REASONS && !self.places.contains_key(&key) {
            key.0 = "more".into();
            key.1 = "of many kinds and for many reasons".into();
        }
        if let Some(i) = self.places.get(&key) {
            self.list[*i].count += 1;
            return;
        }
        self.places.insert(key.clone(), self.list.len());
        self.list.push(LeftOut {
            what: key.0,
            why: key.1,
            count: 1,
            first: format!("#{}", refused.id),
            is_geometry,
        });
    }

    pub(super) fn done(self) -> Vec<LeftOut> {
        self.list
    }
}
