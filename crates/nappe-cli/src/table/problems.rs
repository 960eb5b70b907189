//! Bad rows.

use crate::failure::{Failure, Problem};

/// Bad rows that are told in one run.
const MOST: usize = 10;

/// What is wrong with the rows of a table: the first of them are told, the others counted.
#[derive(Debug, Default)]
pub(crate) struct Problems {
    /// With the row of each, in this order.
    told: Vec<(u64, Problem)>,
    more: u64,
}

impl Problems {
    /// Adds one. Rows come nearly in their order: what cannot be read is found before what is outside the domain.
    pub(crate) fn push(&mut self, row: u64, problem: impl FnOnce() -> Problem) {
        let at = self.told.partition_point(|(r, _)| *r <= row);
        if at < MOST {
            self.told.insert(at, (row, problem()));
        } else {
            self.more += 1;
        }
        if self.told.len() > MOST {
            self.told.pop();
            self.more += 1;
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.told.is_empty()
    }

    /// The first of them, and how many more there are.
    pub(crate) fn list(self) -> Vec<Problem> {
        let mut list: Vec<Problem> = self.told.into_iter().map(|(_, p)| p).collect();
        if self.more > 0 {
            let what = if self.more == 1 {
                "problem"
            } else {
                "problems"
            };
            list.push(Problem::new(format!(
                "and {} more {what} in other rows",
                self.more
            )));
        }
        list
    }

    pub(crate) fn result(self) -> Result<(), Failure> {
        if self.is_empty() {
            Ok(())
        } else {
            Err(self.list().into())
        }
    }

    /// What was found until reading stopped, and why it stopped.
    pub(crate) fn before(self, stopped: Failure) -> Failure {
        match stopped {
            Failure::Problems(why) => {
                let found = self.list().into_iter().map(|p| Box::new(p) as _);
                Failure::Problems(found.chain(why).collect())
            }
            other => other,
        }
    }
}
