//! Tables of parameters as text.

use super::target::Target;
use super::{BLOCK, Block, Notes, Problems, Source};
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
            Problem::new(format!("{}: could not read: {e}", self.name(line))).into()
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
        let place = self.name(self.line());
        self.at = super::find_columns(&columns, self.target, &place, notes)?;
        self.width = columns.len();
        Ok(())
    }

    /// Appends the row in `record`, or says what is wrong with it.
    fn take_row(&self, block: &mut Block, problems: &mut Problems) {
        let line = self.line();
        if self.record.len() != self.width {
            let expected = if self.width == self.parameters.len() {
                self.parameters.join(",")
            } else {
                "as many as the header".to_owned()
            };
            problems.push(
                Problem::new(format!(
                    "{}: {} instead of {} ({expected})",
                    self.name(line),
                    counted(self.record.len()),
                    self.width
                ))
                .help(
                    "columns are separated by commas; a table with more columns needs a header line that names them",
                ),
            );
            return;
        }
        let before = block.parameters.len();
        for (&at, name) in self.at.iter().zip(self.parameters) {
            let field = &self.record[at];
            match parse(field) {
                Some(p) => block.parameters.push(p),
                None => {
                    block.parameters.truncate(before);
                    problems.push(
                        Problem::new(format!(
                            "{}: {name} is `{}`, not a number",
                            self.name(line),
                            String::from_utf8_lossy(field)
                        ))
                        .help("numbers are written as 0.25 or 2.5e-1, with a point"),
                    );
                    return;
                }
            }
        }
        block.places.push(line);
    }
}

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
    fn fill(&mut self, block: &mut Block) -> Result<(), Failure> {
        let mut problems = Problems::default();
        for _ in 0..BLOCK {
            if !std::mem::take(&mut self.pending) && !self.read()? {
                break;
            }
            self.take_row(block, &mut problems);
        }
        problems.result()
    }

    fn name(&self, line: u64) -> String {
        format!("{}:{line}", self.name)
    }
}
