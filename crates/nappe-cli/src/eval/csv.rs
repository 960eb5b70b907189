//! Tables of parameters as text.

use super::problems::Problems;
use super::target::Target;
use super::{BLOCK, Block, Notes, Source};
use crate::failure::{Failure, Problem};
use csv::{ByteRecord, Reader, ReaderBuilder, Trim};
use std::io::Read;

/// A table of parameters: comma-separated, with a header that names the columns in any order, or without one and with
/// the parameters alone in their order. Empty lines and lines that begin with `#` are skipped.
pub(super) struct Rows<'a, R> {
    reader: Reader<R>,
    name: String,
    parameters: &'static [&'static str],
    target: &'a Target,
    /// Where each parameter stands in a record.
    at: Vec<usize>,
    /// The number of columns of every record.
    width: usize,
    record: ByteRecord,
    /// True if `record` holds a row that was read but not given out.
    pending: bool,
}

impl<'a, R: Read> Rows<'a, R> {
    /// Reads the first line and takes it as a header if nothing in it is a number.
    pub(super) fn open(
        input: R,
        name: String,
        target: &'a Target,
        notes: &mut Notes,
    ) -> Result<Self, Failure> {
        let parameters = target.parameters();
        let reader = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(Trim::All)
            .comment(Some(b'#'))
            .from_reader(input);
        let mut rows = Rows {
            reader,
            name,
            parameters,
            target,
            at: (0..parameters.len()).collect(),
            width: parameters.len(),
            record: ByteRecord::new(),
            pending: false,
        };
        rows.pending = rows.read()?;
        let is_header = rows.pending && rows.record.iter().all(|field| parse(field).is_none());
        if is_header {
            rows.take_header(notes)?;
            rows.pending = false;
        }
        Ok(rows)
    }

    fn read(&mut self) -> Result<bool, Failure> {
        self.reader.read_byte_record(&mut self.record).map_err(|e| {
            let line = e
                .position()
                .map_or(self.reader.position().line(), |p| p.line());
            Problem::new(format!("{}: could not read: {e}", self.name(line, None)))
                .help("is the file whole, and text or Parquet?")
                .into()
        })
    }

    fn line(&self) -> u64 {
        self.record.position().map_or(0, |p| p.line())
    }

    fn take_header(&mut self, notes: &mut Notes) -> Result<(), Failure> {
        let columns: Vec<String> = self
            .record
            .iter()
            .map(|f| String::from_utf8_lossy(f).into_owned())
            .collect();
        let place = self.name(self.line(), None);
        self.at = super::find_columns(&columns, self.target, &place, notes)?;
        self.width = columns.len();
        Ok(())
    }

    /// Appends the row in `record`, or says what is wrong with it.
    fn take_row(&self, block: &mut Block, problems: &mut Problems) {
        let line = self.line();
        if self.record.len() != self.width {
            problems.push(line, || self.wrong_count(line));
            return;
        }
        let before = block.parameters.len();
        for (k, &at) in self.at.iter().enumerate() {
            match parse(&self.record[at]) {
                Some(p) => block.parameters.push(p),
                None => problems.push(line, || self.no_number(line, k)),
            }
        }
        if block.parameters.len() == before + self.at.len() {
            block.places.push(line);
        } else {
            block.parameters.truncate(before);
        }
    }

    fn wrong_count(&self, line: u64) -> Problem {
        let expected = if self.width == self.parameters.len() {
            self.parameters.join(",")
        } else {
            "as many as the header".to_owned()
        };
        Problem::new(format!(
            "{}: {} instead of {} ({expected})",
            self.name(line, None),
            counted(self.record.len()),
            self.width
        ))
        .help("columns are separated by commas; a table with more columns needs a header line that names them")
    }

    fn no_number(&self, line: u64, k: usize) -> Problem {
        let field = String::from_utf8_lossy(&self.record[self.at[k]]);
        let shown: String = field.chars().take(MOST_SHOWN).collect();
        let rest = if shown.len() < field.len() { "…" } else { "" };
        Problem::new(format!(
            "{}: {} is `{shown}{rest}`, not a number",
            self.name(line, Some(k)),
            self.parameters[k],
        ))
        .help("numbers are written as 0.25 or 2.5e-1, with a point")
    }
}

/// Characters of a field that a message shows: a file that is no table can be one long field.
const MOST_SHOWN: usize = 40;

fn counted(columns: usize) -> String {
    if columns == 1 {
        "1 column".to_owned()
    } else {
        format!("{columns} columns")
    }
}

fn parse(field: &[u8]) -> Option<f64> {
    std::str::from_utf8(field).ok()?.parse().ok()
}

impl<R: Read> Source for Rows<'_, R> {
    fn fill(&mut self, block: &mut Block, problems: &mut Problems) -> Result<bool, Failure> {
        for i in 0..BLOCK {
            if !std::mem::take(&mut self.pending) && !self.read()? {
                return Ok(i > 0);
            }
            self.take_row(block, problems);
        }
        Ok(true)
    }

    fn name(&self, line: u64, parameter: Option<usize>) -> String {
        let column = parameter.map_or(String::new(), |k| format!(", column {}", self.at[k] + 1));
        format!("{}:{line}{column}", self.name)
    }
}
