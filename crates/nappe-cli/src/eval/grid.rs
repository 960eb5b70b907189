//! Uniform grids of parameters.

use super::target::Target;
use crate::failure::Failure;
use crate::table::{BLOCK, Block, Problems, Source};
use nappe::Interval;
use std::str::FromStr;

/// The numbers of parameters along the first and the second direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Grid {
    first: u64,
    second: Option<u64>,
}

impl FromStr for Grid {
    type Err = String;

    fn from_str(s: &str) -> Result<Grid, String> {
        let count = |s: &str| match s.trim().parse::<u64>() {
            Ok(n) if n >= 2 => Ok(n),
            Ok(n) => Err(format!(
                "{n} is too few: a grid has 2 parameters or more in each direction, the ends among them"
            )),
            Err(_) => Err(format!(
                "`{s}` is not a number of parameters; write for example 11 or 11x21"
            )),
        };
        match s.split_once(['x', 'X', '×']) {
            None => Ok(Grid {
                first: count(s)?,
                second: None,
            }),
            Some((a, b)) => Ok(Grid {
                first: count(a)?,
                second: Some(count(b)?),
            }),
        }
    }
}

impl Grid {
    /// The rows of the grid over a target's whole domain. One number for a surface means as many in both directions.
    pub(super) fn over(self, target: &Target) -> Result<Rows, Failure> {
        let domain = target.domain();
        if let (1, Some(second)) = (domain.len(), self.second) {
            let first = self.first;
            return Err(Failure::usage(format!(
                "--grid {first}x{second}: {target} has one parameter; write --grid {first}"
            )));
        }
        let axis = |i: usize, count| domain.get(i).map(|&range| Axis { range, count });
        Ok(Rows {
            axes: [
                axis(0, self.first),
                axis(1, self.second.unwrap_or(self.first)),
            ],
            next: [0, 0],
        })
    }
}

/// Equal steps over a range, both ends among them.
#[derive(Clone, Copy, Debug)]
struct Axis {
    range: Interval,
    count: u64,
}

impl Axis {
    fn at(self, i: u64) -> f64 {
        let Interval { lo, hi } = self.range;
        if i + 1 == self.count {
            return hi;
        }
        let s = i as f64 / (self.count - 1) as f64;
        // Between the ends, whatever the rounding.
        (lo + (hi - lo) * s).clamp(lo, hi)
    }

    fn values(self, from: u64, most: u64) -> Vec<f64> {
        let to = self.count.min(from.saturating_add(most));
        (from..to).map(|i| self.at(i)).collect()
    }
}

/// The rows of a grid: the second parameter runs first.
#[derive(Debug)]
pub(super) struct Rows {
    axes: [Option<Axis>; 2],
    next: [u64; 2],
}

impl Source for Rows {
    fn fill(&mut self, block: &mut Block, _: &mut Problems) -> Result<bool, Failure> {
        let Some(first) = self.axes[0] else {
            return Ok(false);
        };
        let Some(second) = self.axes[1] else {
            block.numbers = first.values(self.next[0], BLOCK as u64);
            self.next[0] += block.numbers.len() as u64;
            return Ok(!block.numbers.is_empty());
        };
        // Whole lines while they are short, parts of one line if it is longer than a block.
        let v = second.values(self.next[1], BLOCK as u64);
        let lines = (BLOCK as u64 / second.count).max(1);
        let u = first.values(self.next[0], lines);
        for &u in &u {
            block.numbers.extend(v.iter().flat_map(|&v| [u, v]));
        }
        self.next[1] += v.len() as u64;
        if self.next[1] == second.count {
            self.next = [self.next[0] + u.len() as u64, 0];
        }
        if !block.numbers.is_empty() {
            block.grid = Some([u, v]);
        }
        Ok(!block.numbers.is_empty())
    }

    fn name(&self, _: u64, _: Option<usize>) -> String {
        "the grid".to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read() {
        let grid = |first, second| Ok(Grid { first, second });
        assert_eq!("11".parse(), grid(11, None));
        assert_eq!("3x4".parse(), grid(3, Some(4)));
        for bad in ["", "x", "3x", "1", "0x5", "-3", "2.5", "3x4x5"] {
            assert!(bad.parse::<Grid>().is_err(), "{bad}");
        }
    }
}
