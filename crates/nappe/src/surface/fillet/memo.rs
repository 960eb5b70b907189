//! What was enclosed lately. Meshes and proofs ask for the same ranges of u again and again, for each range of v.

use crate::breaks::Limit;
use crate::interval::Interval;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// The most ranges that are kept: some megabytes. Then all are forgotten.
const MOST: usize = 8192;

/// The bits of the ends of a range, the order, and whether the piece above is meant.
type Key = (u64, u64, usize, bool);

/// Enclosures by range of u, limit and order. A copy begins empty.
#[derive(Debug, Default)]
pub(super) struct Memo(Mutex<HashMap<Key, Arc<[Interval]>>>);

impl Clone for Memo {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Memo {
    /// What is kept for a range, or else is made and then kept. What is made must depend on nothing else.
    pub(super) fn get(
        &self,
        u: Interval,
        limit: Limit,
        order: usize,
        make: impl FnOnce() -> Arc<[Interval]>,
    ) -> Arc<[Interval]> {
        let key = (u.lo.to_bits(), u.hi.to_bits(), order, limit == Limit::Above);
        let kept = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = kept().get(&key) {
            return found.clone();
        }
        let made = make();
        let mut all = kept();
        if all.len() >= MOST {
            all.clear();
        }
        all.insert(key, made.clone());
        made
    }
}
