//! Tables of points and derivatives, written row by row. Every number is written with as many digits as it takes to
//! read the same number back: 17 significant digits at most.

use super::Target;
use super::columns;
use clap::ValueEnum;
use nappe::surface::jet_len;
use parquet::basic::{Compression, Repetition, Type as PhysicalType};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

/// The format of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum OutputFormat {
    /// Comma-separated, with a header line.
    Csv,
    /// One JSON object in each line.
    Jsonl,
    /// Parquet, all columns 64-bit floating-point numbers.
    Parquet,
}

impl OutputFormat {
    /// The format that a file's ending names.
    pub(crate) fn of(path: &Path) -> Option<OutputFormat> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "csv" => Some(OutputFormat::Csv),
            "jsonl" | "ndjson" => Some(OutputFormat::Jsonl),
            "parquet" => Some(OutputFormat::Parquet),
            _ => None,
        }
    }

    /// A table of what evaluating the target up to `order` gives.
    pub(crate) fn sink<'a>(
        self,
        target: &Target,
        order: usize,
        out: impl Write + Send + 'a,
    ) -> io::Result<Box<dyn Sink + 'a>> {
        let values = match target {
            Target::Curve(..) => order + 1,
            Target::Surface(..) => jet_len(order),
        };
        let names = columns::names(target, 3 * values);
        let shape = Shape {
            parameters: target.parameters().len(),
            values: 3 * values,
        };
        Ok(match self {
            OutputFormat::Csv => Box::new(Csv::new(shape, &names, out)?),
            OutputFormat::Jsonl => Box::new(Jsonl::new(shape, &names, out)),
            OutputFormat::Parquet => Box::new(Parquet::new(shape, &names, out)?),
        })
    }
}

/// Takes the rows of a table.
pub(crate) trait Sink {
    /// Adds rows: their parameters, and the coordinates of the point and derivatives at each.
    fn rows(&mut self, parameters: &[f64], values: &[f64]) -> io::Result<()>;

    /// Writes what is still held back.
    fn finish(self: Box<Self>) -> io::Result<()>;
}

/// Drops everything.
pub(super) struct Nowhere;

impl Sink for Nowhere {
    fn rows(&mut self, _: &[f64], _: &[f64]) -> io::Result<()> {
        Ok(())
    }

    fn finish(self: Box<Self>) -> io::Result<()> {
        Ok(())
    }
}

/// The numbers in each row.
#[derive(Clone, Copy, Debug)]
struct Shape {
    parameters: usize,
    values: usize,
}

impl Shape {
    fn rows<'a>(
        self,
        parameters: &'a [f64],
        values: &'a [f64],
    ) -> impl Iterator<Item = impl Iterator<Item = f64>> {
        parameters
            .chunks_exact(self.parameters)
            .zip(values.chunks_exact(self.values))
            .map(|(p, v)| p.iter().chain(v).copied())
    }
}

struct Csv<W> {
    shape: Shape,
    out: W,
    text: Vec<u8>,
}

impl<W: Write> Csv<W> {
    fn new(shape: Shape, names: &[String], mut out: W) -> io::Result<Self> {
        writeln!(out, "{}", names.join(","))?;
        Ok(Csv {
            shape,
            out,
            text: Vec::new(),
        })
    }
}

impl<W: Write> Sink for Csv<W> {
    fn rows(&mut self, parameters: &[f64], values: &[f64]) -> io::Result<()> {
        self.text.clear();
        let mut number = ryu::Buffer::new();
        for row in self.shape.rows(parameters, values) {
            for (i, x) in row.enumerate() {
                if i > 0 {
                    self.text.push(b',');
                }
                self.text.extend_from_slice(number.format(x).as_bytes());
            }
            self.text.push(b'\n');
        }
        self.out.write_all(&self.text)
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        self.out.flush()
    }
}

struct Jsonl<W> {
    shape: Shape,
    out: W,
    /// What stands before each number: `{"u":`, `,"v":` …
    before: Vec<String>,
    text: Vec<u8>,
}

impl<W: Write> Jsonl<W> {
    fn new(shape: Shape, names: &[String], out: W) -> Self {
        let before = names
            .iter()
            .enumerate()
            .map(|(i, n)| format!("{}\"{n}\":", if i == 0 { '{' } else { ',' }))
            .collect();
        Jsonl {
            shape,
            out,
            before,
            text: Vec::new(),
        }
    }
}

impl<W: Write> Sink for Jsonl<W> {
    fn rows(&mut self, parameters: &[f64], values: &[f64]) -> io::Result<()> {
        self.text.clear();
        let mut number = ryu::Buffer::new();
        for row in self.shape.rows(parameters, values) {
            for (x, before) in row.zip(&self.before) {
                self.text.extend_from_slice(before.as_bytes());
                self.text.extend_from_slice(number.format(x).as_bytes());
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
    shape: Shape,
    file: SerializedFileWriter<W>,
    /// The columns of the group that is being filled.
    columns: Vec<Vec<f64>>,
}

impl<W: Write + Send> Parquet<W> {
    fn new(shape: Shape, names: &[String], out: W) -> io::Result<Self> {
        let fields = names
            .iter()
            .map(|n| {
                Type::primitive_type_builder(n, PhysicalType::DOUBLE)
                    .with_repetition(Repetition::REQUIRED)
                    .build()
                    .map(Arc::new)
            })
            .collect::<Result<_, _>>();
        let schema = fields
            .and_then(|f| Type::group_type_builder("points").with_fields(f).build())
            .map_err(parquet_error)?;
        // Measured coordinates hardly repeat: a dictionary or a general compression only costs time.
        let properties = WriterProperties::builder()
            .set_dictionary_enabled(false)
            .set_compression(Compression::UNCOMPRESSED)
            .set_created_by(concat!("nappe version ", env!("CARGO_PKG_VERSION")).into())
            .build();
        let file = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties))
            .map_err(parquet_error)?;
        Ok(Parquet {
            shape,
            file,
            columns: vec![Vec::new(); names.len()],
        })
    }

    fn write_group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.file.next_row_group()?;
        let mut columns = self.columns.iter_mut();
        while let Some(mut writer) = group.next_column()? {
            if let Some(column) = columns.next() {
                writer
                    .typed::<DoubleType>()
                    .write_batch(column, None, None)?;
                column.clear();
            }
            writer.close()?;
        }
        group.close()?;
        Ok(())
    }
}

impl<W: Write + Send> Sink for Parquet<W> {
    fn rows(&mut self, parameters: &[f64], values: &[f64]) -> io::Result<()> {
        for row in self.shape.rows(parameters, values) {
            for (x, column) in row.zip(&mut self.columns) {
                column.push(x);
            }
        }
        if self.columns[0].len() >= GROUP {
            self.write_group().map_err(parquet_error)?;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        if !self.columns[0].is_empty() {
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
