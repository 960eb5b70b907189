//! Tables of numbers: read block by block and written row by row, so that they may be larger than the memory.

mod csv;
mod input;
mod parquet;
mod problems;
mod sink;

pub(crate) use self::input::Input;
pub(crate) use self::problems::Problems;
pub(crate) use self::sink::{Cell, Column, Holds, Nowhere, OutputFormat, Sink};

use crate::failure::{Failure, Problem};

/// Rows read at a time: enough to make the cost of a block nothing, few enough to stay in the cache.
pub(crate) const BLOCK: usize = 4096;

/// What a table is read for.
#[derive(Clone, Debug)]
pub(crate) struct Wanted {
    /// The columns of numbers that it must have.
    pub(crate) columns: &'static [&'static str],
    /// What its rows are, in the plural.
    pub(crate) what: &'static str,
    /// What they are read for, naming the columns.
    pub(crate) purpose: String,
    /// The option that names the file.
    pub(crate) option: &'static str,
    /// True if other columns are handed on, as text.
    pub(crate) others: bool,
}

/// Rows of numbers.
#[derive(Debug, Default)]
pub(crate) struct Block {
    /// The numbers, row after row; NaN where there is none.
    pub(crate) numbers: Vec<f64>,
    /// The line or row of the input each comes from; empty if they come from no input.
    pub(crate) places: Vec<u64>,
    /// Where in its line or row each number stands, counted as the source does.
    pub(crate) columns: Vec<usize>,
    /// The rows that could not be read, increasing.
    pub(crate) bad: Vec<usize>,
    /// What stands in the other columns, row after row.
    pub(crate) others: Texts,
    /// If the rows are a grid: its values of u and of v. The rows run through v first.
    pub(crate) grid: Option<[Vec<f64>; 2]>,
}

impl Block {
    pub(crate) fn clear(&mut self) {
        self.numbers.clear();
        self.places.clear();
        self.columns.clear();
        self.bad.clear();
        self.others.clear();
        self.grid = None;
    }
}

/// Many short texts.
#[derive(Debug, Default)]
pub(crate) struct Texts {
    all: String,
    ends: Vec<usize>,
}

impl Texts {
    fn clear(&mut self) {
        self.all.clear();
        self.ends.clear();
    }

    fn push(&mut self, text: &str) {
        self.all.push_str(text);
        self.ends.push(self.all.len());
    }

    /// The one of that number. Panics if there are fewer.
    pub(crate) fn get(&self, i: usize) -> &str {
        let start = i.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.all[start..self.ends[i]]
    }
}

/// Where rows come from.
pub(crate) trait Source {
    /// Fills the block with the next rows and says which could not be read. False at the end.
    fn fill(&mut self, block: &mut Block, problems: &mut Problems) -> Result<bool, Failure>;

    /// How a row is named in messages, or a column of it.
    fn name(&self, place: u64, column: Option<usize>) -> String;

    /// The names of the other columns that are handed on.
    fn others(&self) -> &[String] {
        &[]
    }

    /// What is to be told once all is read.
    fn notes(&self) -> Notes {
        Notes::new()
    }

    /// The share that was read.
    fn share(&self) -> f64 {
        0.0
    }
}

/// What was told while reading, in full sentences.
pub(crate) type Notes = Vec<String>;

/// Where each wanted column stands among named columns, and where the others stand.
fn find_columns(
    columns: &[String],
    wanted: &Wanted,
    place: &str,
) -> Result<[Vec<usize>; 2], Failure> {
    let mut at = Vec::new();
    for name in wanted.columns {
        let mut found = (0..columns.len()).filter(|&i| columns[i].eq_ignore_ascii_case(name));
        match (found.next(), found.next()) {
            (Some(i), None) => at.push(i),
            (Some(i), Some(j)) => {
                return Err(Problem::new(format!(
                    "{place}: the columns {} and {} are both named {name}",
                    i + 1,
                    j + 1
                ))
                .help("rename one of them")
                .into());
            }
            (None, _) => {
                return Err(Problem::new(format!(
                    "{place}: there is no column {name}; the columns are {}",
                    columns.join(", ")
                ))
                .help(format!(
                    "{}: name the columns so, or leave the header out",
                    wanted.purpose
                ))
                .into());
            }
        }
    }
    let others = (0..columns.len()).filter(|i| !at.contains(i)).collect();
    Ok([at, others])
}

/// Notes that some columns are not used.
fn unused(columns: &[String], which: &[usize], place: &str, notes: &mut Notes) {
    if !which.is_empty() {
        let names: Vec<&str> = which.iter().map(|&i| columns[i].as_str()).collect();
        notes.push(format!("{place}: not used: {}", names.join(", ")));
    }
}
