//! Points that are one where their numbers are equal, for formats that store each triangle by itself.

use super::{Fault, MOST};
use glam::DVec3;
use std::collections::HashMap;

/// Gives equal points one number.
#[derive(Default)]
pub(super) struct Weld {
    pub(super) points: Vec<DVec3>,
    numbers: HashMap<[u64; 3], u32>,
}

impl Weld {
    /// The number of a point.
    pub(super) fn number(&mut self, p: DVec3) -> Result<u32, Fault> {
        // Adding 0 makes -0 the same as 0.
        let key = (p + DVec3::ZERO).to_array().map(f64::to_bits);
        if self.points.len() >= MOST {
            return Err(Fault::whole("more points than 32 bits can number"));
        }
        let next = self.points.len() as u32;
        let number = *self.numbers.entry(key).or_insert(next);
        if number == next {
            self.points.push(p);
        }
        Ok(number)
    }
}
