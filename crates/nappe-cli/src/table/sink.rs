//! Tables written row by row. Every number is written with as many digits as it takes to
//! read the same number back: 17 significant digits at most.

use crate::failure::{Failure, Problem};
use crate::output;
use clap::ValueEnum;
use parquet::basic::{Compression, LogicalType, Repetition, Type as PhysicalType};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::sync::Arc;

/// The format of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum OutputFormat {
    /// Comma-separated, with a header line.
    Csv,
    /// One JSON object in each line.
    Jsonl,
    /// Parquet, numbers as 64-bit floating-point numbers, those that count as 64-bit integers.
    Parquet,
}

impl OutputFormat {
    /// The format that a file's ending names.
    fn of(path: &Path) -> Option<OutputFormat> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "csv" => Some(OutputFormat::Csv),
            "jsonl" | "ndjson" => Some(OutputFormat::Jsonl),
            "parquet" => Some(OutputFormat::Parquet),
            _ => None,
        }
    }

    /// The format that was asked for, that of the file's ending, or CSV. Errors: an ending that names none, and Parquet for
    /// a terminal, and a file that cannot be written.
    pub(crate) fn choose(
        asked: Option<OutputFormat>,
        path: Option<&Path>,
    ) -> Result<OutputFormat, Failure> {
        let format = match (asked, path) {
            (Some(format), _) => format,
            (None, None) => OutputFormat::Csv,
            (None, Some(path)) => OutputFormat::of(path).ok_or_else(|| {
                Problem::new(format!(
                    "{}: the ending names no format of tables",
                    path.display()
                ))
                .help("known endings: .csv .jsonl .ndjson .parquet; or say --format")
            })?,
        };
        if format == OutputFormat::Parquet && path.is_none() && io::stdout().is_terminal() {
            return Err(Failure::usage(
                "--format parquet is binary: write it to a file with -o FILE.parquet, or pipe it on",
            ));
        }
        if let Some(path) = path {
            output::check(path)?;
        }
        Ok(format)
    }

    /// A table with these columns.
    pub(crate) fn sink<'a>(
        self,
        columns: &[Column],
        out: impl Write + Send + 'a,
    ) -> io::Result<Box<dyn Sink + 'a>> {
        Ok(match self {
            OutputFormat::Csv => Box::new(Csv::new(columns, out)?),
            OutputFormat::Jsonl => Box::new(Jsonl::new(columns, out)),
            OutputFormat::Parquet => Box::new(Parquet::new(columns, out)?),
        })
    }
}

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Holds {
    Numbers,
    Counts,
    Texts,
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Column {
    pub(crate) name: String,
    pub(crate) holds: Holds,
    /// Cells may be missing.
    pub(crate) optional: bool,
}

impl Column {
    /// A column of numbers, none missing.
    pub(crate) fn numbers(name: impl Into<String>) -> Column {
        Column {
            name: name.into(),
            holds: Holds::Numbers,
            optional: false,
        }
    }

    /// A column of numbers.
    pub(crate) fn some_numbers(name: impl Into<String>) -> Column {
        Column {
            optional: true,
            ..Column::numbers(name)
        }
    }

    /// A column of whole numbers that count something, none missing.
    pub(crate) fn counts(name: impl Into<String>) -> Column {
        Column {
            holds: Holds::Counts,
            ..Column::numbers(name)
        }
    }

    /// A column of texts.
    pub(crate) fn texts(name: impl Into<String>) -> Column {
        Column {
            holds: Holds::Texts,
            ..Column::some_numbers(name)
        }
    }
}

/// What stands in a row and a column.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Cell<'a> {
    /// A finite number.
    Number(f64),
    Count(u32),
    Text(&'a str),
    Missing,
}

/// What stands in a row and a column, both counted from 0.
pub(crate) type Cells<'c, 'a> = &'c dyn Fn(usize, usize) -> Cell<'a>;

/// Takes the rows of a table.
pub(crate) trait Sink {
    /// Adds rows.
    fn rows(&mut self, count: usize, cells: Cells<'_, '_>) -> io::Result<()>;

    /// Writes what is still held back.
    fn finish(self: Box<Self>) -> io::Result<()>;
}

/// Drops everything.
pub(crate) struct Nowhere;

impl Sink for Nowhere {
    fn rows(&mut self, _: usize, _: Cells<'_, '_>) -> io::Result<()> {
        Ok(())
    }

    fn finish(self: Box<Self>) -> io::Result<()> {
        Ok(())
    }
}

struct Csv<W> {
    columns: usize,
    out: W,
    text: Vec<u8>,
}

impl<W: Write> Csv<W> {
    fn new(columns: &[Column], out: W) -> io::Result<Self> {
        let mut csv = Csv {
            columns: columns.len(),
            out,
            text: Vec::new(),
        };
        csv.rows(1, &|_, k| Cell::Text(&columns[k].name))?;
        Ok(csv)
    }
}

impl<W: Write> Sink for Csv<W> {
    fn rows(&mut self, count: usize, cells: Cells<'_, '_>) -> io::Result<()> {
        self.text.clear();
        let mut number = ryu::Buffer::new();
        for row in 0..count {
            for column in 0..self.columns {
                if column > 0 {
                    self.text.push(b',');
                }
                match cells(row, column) {
                    Cell::Number(x) => self.text.extend_from_slice(number.format(x).as_bytes()),
                    Cell::Count(n) => self.text.extend_from_slice(n.to_string().as_bytes()),
                    Cell::Text(text) => put_field(&mut self.text, text),
                    Cell::Missing => {}
                }
            }
            self.text.push(b'\n');
        }
        self.out.write_all(&self.text)
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        self.out.flush()
    }
}

/// A text, in quotes where it would not be read back as it is.
fn put_field(out: &mut Vec<u8>, text: &str) {
    let special = |c: char| matches!(c, ',' | '"' | '\n' | '\r');
    if text.contains(special) || text.trim() != text || text.starts_with('#') {
        out.push(b'"');
        out.extend_from_slice(text.replace('"', "\"\"").as_bytes());
        out.push(b'"');
    } else {
        out.extend_from_slice(text.as_bytes());
    }
}

struct Jsonl<W> {
    out: W,
    /// What stands before each cell: `{"u":`, `,"v":` …
    before: Vec<String>,
    text: Vec<u8>,
}

impl<W: Write> Jsonl<W> {
    fn new(columns: &[Column], out: W) -> Self {
        let mark = |i| if i == 0 { '{' } else { ',' };
        let before = |(i, c): (usize, &Column)| format!("{}{}:", mark(i), quoted(&c.name));
        Jsonl {
            out,
            before: columns.iter().enumerate().map(before).collect(),
            text: Vec::new(),
        }
    }
}

/// A text as JSON.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

impl<W: Write> Sink for Jsonl<W> {
    fn rows(&mut self, count: usize, cells: Cells<'_, '_>) -> io::Result<()> {
        self.text.clear();
        let mut number = ryu::Buffer::new();
        for row in 0..count {
            for (column, before) in self.before.iter().enumerate() {
                self.text.extend_from_slice(before.as_bytes());
                match cells(row, column) {
                    Cell::Number(x) => self.text.extend_from_slice(number.format(x).as_bytes()),
                    Cell::Count(n) => self.text.extend_from_slice(n.to_string().as_bytes()),
                    Cell::Text(text) => self.text.extend_from_slice(quoted(text).as_bytes()),
                    Cell::Missing => self.text.extend_from_slice(b"null"),
                }
            }
            self.text.extend_from_slice(b"}\n");
        }
        self.out.write_all(&self.text)
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        self.out.flush()
    }
}

/// Rows in one group of a Parquet file: a group is held in memory until it is complete.
const GROUP: usize = 1 << 16;

struct Parquet<W: Write + Send> {
    file: SerializedFileWriter<W>,
    /// The columns of the group that is being filled, and how many rows they have.
    columns: Vec<Filling>,
    rows: usize,
}

/// A column that is being filled: what is there, and 1 for each row that has something, if rows need not.
struct Filling {
    values: Values,
    levels: Option<Vec<i16>>,
}

enum Values {
    Numbers(Vec<f64>),
    Counts(Vec<i64>),
    Texts(Vec<ByteArray>),
}

impl Filling {
    fn of(column: &Column) -> Filling {
        Filling {
            values: match column.holds {
                Holds::Numbers => Values::Numbers(Vec::new()),
                Holds::Counts => Values::Counts(Vec::new()),
                Holds::Texts => Values::Texts(Vec::new()),
            },
            levels: column.optional.then(Vec::new),
        }
    }

    fn push(&mut self, cell: Cell<'_>) {
        let there = match (&mut self.values, cell) {
            (Values::Numbers(all), Cell::Number(x)) => {
                all.push(x);
                1
            }
            (Values::Counts(all), Cell::Count(n)) => {
                all.push(n.into());
                1
            }
            (Values::Texts(all), Cell::Text(text)) => {
                all.push(text.into());
                1
            }
            _ => 0,
        };
        if let Some(levels) = &mut self.levels {
            levels.push(there);
        }
    }

    /// Hands all to a writer, and is empty then.
    fn write(&mut self, writer: &mut SerializedColumnWriter<'_>) -> Result<(), ParquetError> {
        let levels = self.levels.as_deref();
        match &mut self.values {
            Values::Numbers(all) => write::<DoubleType>(writer, all, levels)?,
            Values::Counts(all) => write::<Int64Type>(writer, all, levels)?,
            Values::Texts(all) => write::<ByteArrayType>(writer, all, levels)?,
        }
        if let Some(levels) = &mut self.levels {
            levels.clear();
        }
        Ok(())
    }
}

fn write<T: DataType>(
    writer: &mut SerializedColumnWriter<'_>,
    values: &mut Vec<T::T>,
    levels: Option<&[i16]>,
) -> Result<(), ParquetError> {
    writer.typed::<T>().write_batch(values, levels, None)?;
    values.clear();
    Ok(())
}

impl<W: Write + Send> Parquet<W> {
    fn new(columns: &[Column], out: W) -> io::Result<Self> {
        let field = |c: &Column| {
            let (physical, logical) = match c.holds {
                Holds::Numbers => (PhysicalType::DOUBLE, None),
                Holds::Counts => (PhysicalType::INT64, None),
                Holds::Texts => (PhysicalType::BYTE_ARRAY, Some(LogicalType::String)),
            };
            Type::primitive_type_builder(&c.name, physical)
                .with_logical_type(logical)
                .with_repetition(if c.optional {
                    Repetition::OPTIONAL
                } else {
                    Repetition::REQUIRED
                })
                .build()
                .map(Arc::new)
        };
        let fields = columns.iter().map(field).collect::<Result<_, _>>();
        let schema = fields
            .and_then(|f| Type::group_type_builder("points").with_fields(f).build())
            .map_err(parquet_error)?;
        // Measured coordinates hardly repeat: a dictionary or a general compression only costs time.
        let mut properties = WriterProperties::builder()
            .set_dictionary_enabled(false)
            .set_compression(Compression::UNCOMPRESSED)
            .set_created_by(concat!("nappe version ", env!("CARGO_PKG_VERSION")).into());
        for c in columns.iter().filter(|c| c.holds == Holds::Texts) {
            // Names of surfaces do repeat.
            let path = parquet::schema::types::ColumnPath::from(c.name.as_str());
            properties = properties.set_column_dictionary_enabled(path, true);
        }
        let file = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties.build()))
            .map_err(parquet_error)?;
        Ok(Parquet {
            file,
            columns: columns.iter().map(Filling::of).collect(),
            rows: 0,
        })
    }

    fn write_group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.file.next_row_group()?;
        let mut columns = self.columns.iter_mut();
        while let Some(mut writer) = group.next_column()? {
            if let Some(column) = columns.next() {
                column.write(&mut writer)?;
            }
            writer.close()?;
        }
        group.close()?;
        self.rows = 0;
        Ok(())
    }
}

impl<W: Write + Send> Sink for Parquet<W> {
    fn rows(&mut self, count: usize, cells: Cells<'_, '_>) -> io::Result<()> {
        for row in 0..count {
            for (k, column) in self.columns.iter_mut().enumerate() {
                column.push(cells(row, k));
            }
        }
        self.rows += count;
        if self.rows >= GROUP {
            self.write_group().map_err(parquet_error)?;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        if self.rows > 0 {
            self.write_group().map_err(parquet_error)?;
        }
        self.file.finish().map_err(parquet_error)?;
        self.file.inner_mut().flush()
    }
}

/// The cause that the system gave, where there is one: a closed pipe must be told from a full disk.
fn parquet_error(e: ParquetError) -> io::Error {
    match e {
        ParquetError::External(source) => match source.downcast::<io::Error>() {
            Ok(e) => *e,
            Err(source) => io::Error::other(source),
        },
        e => io::Error::other(e),
    }
}
