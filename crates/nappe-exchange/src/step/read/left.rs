//! What is left out, counted.

use super::file::Refused;
use crate::LeftOut;
use std::collections::HashMap;

/// More different reasons than this are one: a list that nobody reads to its end.
const REASONS: usize = 200;

/// A list of things left out.
#[derive(Debug, Default)]
pub(super) struct Left {
    list: Vec<LeftOut>,
    places: HashMap<(String, String), usize>,
}

impl Left {
    pub(super) fn add(&mut self, refused: &Refused) {
        self.count(LeftOut {
            what: refused.what.clone(),
            why: refused.why.clone(),
            count: 1,
            first: format!("#{}", refused.id),
        });
    }

    /// Adds all of another list.
    pub(super) fn append(&mut self, other: Left) {
        other.list.into_iter().for_each(|l| self.count(l));
    }

    fn count(&mut self, left: LeftOut) {
        let mut key = (left.what.clone(), left.why.clone());
        if self.list.len() >= REASONS && !self.places.contains_key(&key) {
            key = ("more".into(), "of many kinds and for many reasons".into());
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
