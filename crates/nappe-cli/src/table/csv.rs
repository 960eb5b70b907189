//! Tables as text.

use super::problems::Problems;
use super::{BLOCK, Block, Notes, Source, Wanted};
use crate::failure::{Failure, Problem};
use std::io::{BufRead, Read};
use std::ops::Range;

/// A line that is longer is no row of a table.
const LONGEST_LINE: u64 = 1 << 20;
/// Characters of a field that a message shows.
const MOST_SHOWN: usize = 40;

/// A table: comma-separated, with a header that names the columns in any order, or without one and with
/// the wanted columns alone in their order. Empty lines and lines that begin with `#` are skipped, with two exceptions: one
/// before the first row that names the wanted columns is the header, and after a header whose first column is handed on,
/// what begins with `#` is a row.
///
/// A field may stand in quotes, with quotes in it doubled; it ends in the line where it begins. So every row has one
/// line, and every field a column, which messages name. A field whose quotes do not end is an error of its row.
pub(super) struct Rows<'a, R> {
    input: R,
    name: String,
    wanted: &'a Wanted,
    /// Where each wanted column stands in a row.
    at: Vec<usize>,
    /// Where the columns stand that are handed on, and their names.
    others: Vec<usize>,
    other_names: Vec<String>,
    /// The number of columns of every row.
    width: usize,
    /// The line that was read last, its number, and its fields without blanks and quotes.
    line: Vec<u8>,
    number: u64,
    fields: Vec<Range<usize>>,
    /// Where the field begins whose quotes do not end.
    unclosed: Option<usize>,
    /// True if the line holds a row that was read but not given out.
    pending: bool,
    /// True once the header or the first row was taken.
    begun: bool,
    /// True if the line begins with `#`.
    marked: bool,
    /// The first line with a text to hand on that is not UTF-8.
    foreign: Option<u64>,
    /// The bytes in all, and those that were read.
    size: u64,
    done: u64,
}

impl<'a, R: BufRead> Rows<'a, R> {
    /// Reads the first line and takes it as a header if nothing in it is a number.
    pub(super) fn open(
        input: R,
        size: u64,
        name: String,
        wanted: &'a Wanted,
        notes: &mut Notes,
    ) -> Result<Self, Failure> {
        let width = wanted.columns.len();
        let mut rows = Rows {
            input,
            name,
            wanted,
            at: (0..width).collect(),
            others: Vec::new(),
            other_names: Vec::new(),
            width,
            line: Vec::new(),
            number: 0,
            fields: Vec::new(),
            unclosed: None,
            pending: false,
            begun: false,
            marked: false,
            foreign: None,
            size,
            done: 0,
        };
        rows.pending = rows.read()?;
        rows.begun = true;
        if rows.pending && (0..rows.fields.len()).all(|i| rows.value(i).is_none()) {
            let marked = rows.marked;
            rows.take_header(notes)?;
            // Below a mark the header may come once more.
            rows.pending = marked && rows.read()?;
            if rows.pending && rows.names_all() {
                rows.take_header(notes)?;
                rows.pending = false;
            }
        }
        if rows.pending && wanted.others && rows.fields.len() != rows.width {
            // Every row would be wrong.
            return Err(rows.wrong_count().into());
        }
        Ok(rows)
    }

    /// Reads the next row. False at the end.
    fn read(&mut self) -> Result<bool, Failure> {
        loop {
            self.line.clear();
            self.number += 1;
            let mut line = Read::take(&mut self.input, LONGEST_LINE + 1);
            let read = line.read_until(b'\n', &mut self.line).map_err(|e| {
                Problem::new(format!(
                    "{}:{}: could not read: {e}",
                    self.name, self.number
                ))
                .help("is the file whole, and can it be read?")
            })?;
            if read == 0 {
                return Ok(false);
            }
            self.done += read as u64;
            if read as u64 > LONGEST_LINE {
                return Err(Problem::new(format!(
                    "{}:{}: the line is longer than {LONGEST_LINE} bytes: this is no table of {}",
                    self.name, self.number, self.wanted.what
                ))
                .help(format!(
                    "write one row of {} in each line, or give a Parquet file",
                    self.wanted.what
                ))
                .into());
            }
            // Some programs begin their texts with this mark.
            let mark = if self.number == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
                3
            } else {
                0
            };
            let start = mark + blanks(&self.line[mark..]);
            if start == self.line.len() {
                continue;
            }
            self.marked = self.line[start] == b'#';
            if self.marked && self.begun && !self.others.contains(&0) {
                continue;
            }
            let from = if self.marked && !self.begun {
                start + 1
            } else {
                mark
            };
            self.fields.clear();
            self.unclosed = split(&self.line, from, &mut self.fields);
            if !self.marked || self.begun || self.names_all() {
                return Ok(true);
            }
        }
    }

    /// True if the fields name all wanted columns.
    fn names_all(&self) -> bool {
        let named = |name: &&str| {
            let is = |i| self.text(i).eq_ignore_ascii_case(name.as_bytes());
            (0..self.fields.len()).any(is)
        };
        self.wanted.columns.iter().all(named)
    }

    fn take_header(&mut self, notes: &mut Notes) -> Result<(), Failure> {
        if self.unclosed.is_some() {
            return Err(self.no_end().into());
        }
        let columns: Vec<String> = (0..self.fields.len()).map(|i| self.meaning(i)).collect();
        let place = self.name(self.number, None);
        let [at, others] = super::find_columns(&columns, self.wanted, &place)?;
        if self.wanted.others {
            self.other_names = others.iter().map(|&i| columns[i].clone()).collect();
            self.note_foreign(&others);
            self.others = others;
        } else {
            super::unused(&columns, &others, &place, notes);
        }
        self.at = at;
        self.width = columns.len();
        Ok(())
    }

    /// What stands in a field; nothing if the line has fewer.
    fn text(&self, field: usize) -> &[u8] {
        self.fields
            .get(field)
            .map_or(&[], |f| &self.line[f.clone()])
    }

    /// What a field means: inside quotes two stand for one.
    fn meaning(&self, field: usize) -> String {
        let text = String::from_utf8_lossy(self.text(field));
        let quoted = self
            .fields
            .get(field)
            .is_some_and(|f| f.start > 0 && self.line[f.start - 1] == b'"');
        if quoted {
            text.replace("\"\"", "\"")
        } else {
            text.into_owned()
        }
    }

    fn value(&self, field: usize) -> Option<f64> {
        std::str::from_utf8(self.text(field)).ok()?.parse().ok()
    }

    /// Remembers the line if one of these fields is not UTF-8.
    fn note_foreign(&mut self, fields: &[usize]) {
        let is_foreign = |&at: &usize| std::str::from_utf8(self.text(at)).is_err();
        if self.foreign.is_none() && fields.iter().any(is_foreign) {
            self.foreign = Some(self.number);
        }
    }

    /// The column of a field in its line, in characters from 1.
    fn column(&self, field: usize) -> usize {
        self.column_at(self.fields[field].start)
    }

    /// The same of a byte.
    fn column_at(&self, byte: usize) -> usize {
        // Of the bytes of a character only the first counts.
        let first = |b: &&u8| **b & 0xc0 != 0x80;
        self.line[..byte].iter().filter(first).count() + 1
    }

    /// Appends the row that was read, and says what is wrong with it.
    fn take_row(&self, block: &mut Block, problems: &mut Problems) {
        let line = self.number;
        let whole = self.fields.len() == self.width && self.unclosed.is_none();
        let mut good = whole;
        if self.unclosed.is_some() {
            problems.push(line, || self.no_end());
        } else if !whole {
            problems.push(line, || self.wrong_count());
        }
        for (k, &at) in self.at.iter().enumerate() {
            let value = self.value(at);
            if whole && value.is_none() {
                problems.push(line, || self.no_number(k));
                good = false;
            }
            block.numbers.push(value.unwrap_or(f64::NAN));
        }
        if !good {
            block.bad.push(block.places.len());
        }
        block.places.push(line);
        let column = |&at: &usize| self.column(at.min(self.fields.len() - 1));
        block.columns.extend(self.at.iter().map(column));
        for &at in &self.others {
            block.others.push(&self.meaning(at));
        }
    }

    fn no_end(&self) -> Problem {
        let column = self.unclosed.map(|at| self.column_at(at));
        Problem::new(format!(
            "{}: the quote that begins here does not end in this line",
            self.name(self.number, column)
        ))
        .help("a field ends in the line where it begins: take line breaks out, and double quotes that stand in it")
    }

    fn wrong_count(&self) -> Problem {
        let expected = if self.width == self.wanted.columns.len() {
            self.wanted.columns.join(",")
        } else {
            "as many as the header".to_owned()
        };
        // The first field that is too much, or the last where some are missing.
        let at = self.width.min(self.fields.len() - 1);
        Problem::new(format!(
            "{}: {} instead of {} ({expected})",
            self.name(self.number, Some(self.column(at))),
            counted(self.fields.len()),
            self.width
        ))
        .help("columns are separated by commas; a table with more columns needs a header line that names them")
    }

    fn no_number(&self, k: usize) -> Problem {
        let at = self.at[k];
        let field = String::from_utf8_lossy(self.text(at));
        let shown: String = field.chars().take(MOST_SHOWN).collect();
        let rest = if shown.len() < field.len() { "…" } else { "" };
        Problem::new(format!(
            "{}: {} is `{shown}{rest}`, not a number",
            self.name(self.number, Some(self.column(at))),
            self.wanted.columns[k],
        ))
        .help("numbers are written as 0.25 or 2.5e-1, with a point")
    }
}

fn counted(columns: usize) -> String {
    if columns == 1 {
        "1 column".to_owned()
    } else {
        format!("{columns} columns")
    }
}

/// The number of blanks at the beginning.
fn blanks(line: &[u8]) -> usize {
    line.iter().take_while(|b| b.is_ascii_whitespace()).count()
}

/// The fields of a line from a byte on, and where the last begins if it is in quotes that do not end.
fn split(line: &[u8], mut from: usize, fields: &mut Vec<Range<usize>>) -> Option<usize> {
    loop {
        let start = from + blanks(&line[from..]);
        let mut end = start;
        let quoted = line.get(start) == Some(&b'"');
        let mut inside = false;
        while let Some(&b) = line.get(end) {
            match b {
                b'"' if quoted => inside = !inside,
                b',' if !inside => break,
                _ => {}
            }
            end += 1;
        }
        let text = line[start..end].trim_ascii_end();
        fields.push(if quoted && text.len() > 1 && text.ends_with(b"\"") {
            start + 1..start + text.len() - 1
        } else {
            start..start + text.len()
        });
        if end == line.len() {
            return inside.then_some(start);
        }
        from = end + 1;
    }
}

impl<R: BufRead> Source for Rows<'_, R> {
    fn fill(&mut self, block: &mut Block, problems: &mut Problems) -> Result<bool, Failure> {
        for i in 0..BLOCK {
            if !std::mem::take(&mut self.pending) && !self.read()? {
                return Ok(i > 0);
            }
            self.take_row(block, problems);
            if self.foreign.is_none() && !self.line.is_ascii() {
                let others = std::mem::take(&mut self.others);
                self.note_foreign(&others);
                self.others = others;
            }
        }
        Ok(true)
    }

    fn name(&self, line: u64, column: Option<usize>) -> String {
        let column = column.map_or(String::new(), |c| format!(":{c}"));
        format!("{}:{line}{column}", self.name)
    }

    fn others(&self) -> &[String] {
        &self.other_names
    }

    fn notes(&self) -> Notes {
        let note = |line| {
            format!(
                "{}: text that is not UTF-8: what could not be read was put out as \u{fffd}",
                self.name(line, None)
            )
        };
        self.foreign.map(note).into_iter().collect()
    }

    fn share(&self) -> f64 {
        self.done as f64 / self.size.max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(line: &str) -> Vec<&str> {
        let mut found = Vec::new();
        let unclosed = split(line.as_bytes(), 0, &mut found);
        assert_eq!(unclosed.is_some(), line.contains("open"));
        found.into_iter().map(|f| &line[f]).collect()
    }

    #[test]
    fn lines_are_split_at_commas_outside_quotes() {
        assert_eq!(fields("0.5,1\r\n"), ["0.5", "1"]);
        assert_eq!(fields(" 0.5 ,\t1 "), ["0.5", "1"]);
        assert_eq!(fields("\"a,b\", \"u\",,x\"y"), ["a,b", "u", "", "x\"y"]);
        assert_eq!(fields("\"say \"\"so\"\"\",2"), ["say \"\"so\"\"", "2"]);
        assert_eq!(fields(""), [""]);
        assert_eq!(fields("1,"), ["1", ""]);
        assert_eq!(fields("\"open,1"), ["\"open,1"]);
    }
}
