//! Tables as Parquet.

use super::problems::Problems;
use super::{BLOCK, Block, Notes, Source, Wanted};
use crate::failure::{Failure, Problem};
use parquet::basic::{ConvertedType, LogicalType, Type as Physical};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{ChunkReader, FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

/// A table: the wanted columns are flat, of 64- or 32-bit floating-point numbers.
pub(super) struct Rows<'a> {
    reader: Box<dyn FileReader>,
    name: String,
    wanted: &'a Wanted,
    /// The column of each wanted one.
    at: Vec<usize>,
    /// Those that are handed on, with what their integers mean, and their names.
    others: Vec<(usize, Meaning)>,
    other_names: Vec<String>,
    /// The next group of rows.
    group: usize,
    /// The columns of the group that is being read: the wanted ones, then the others.
    columns: Vec<ColumnReader>,
    /// The rows given out so far.
    done: u64,
}

/// What a column that is handed on holds.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Meaning {
    /// What its type says.
    Plain,
    /// Integers without a sign.
    Unsigned,
}

/// What a column holds, if it can be handed on: single numbers, texts and truth values.
fn meaning(column: &ColumnDescriptor) -> Option<Meaning> {
    if column.max_rep_level() > 0 || column.max_def_level() > 1 {
        return None;
    }
    let text = matches!(
        column.logical_type_ref(),
        Some(LogicalType::String | LogicalType::Enum | LogicalType::Json)
    ) || matches!(
        column.converted_type(),
        ConvertedType::UTF8 | ConvertedType::ENUM | ConvertedType::JSON
    );
    match (column.physical_type(), column.logical_type_ref()) {
        (Physical::BYTE_ARRAY, _) if text => Some(Meaning::Plain),
        (Physical::DOUBLE | Physical::FLOAT | Physical::BOOLEAN, None) => Some(Meaning::Plain),
        (Physical::INT32 | Physical::INT64, Some(LogicalType::Integer(i))) => {
            Some(if i.is_signed {
                Meaning::Plain
            } else {
                Meaning::Unsigned
            })
        }
        (Physical::INT32 | Physical::INT64, None) => match column.converted_type() {
            ConvertedType::NONE
            | ConvertedType::INT_8
            | ConvertedType::INT_16
            | ConvertedType::INT_32
            | ConvertedType::INT_64 => Some(Meaning::Plain),
            ConvertedType::UINT_8
            | ConvertedType::UINT_16
            | ConvertedType::UINT_32
            | ConvertedType::UINT_64 => Some(Meaning::Unsigned),
            _ => None,
        },
        _ => None,
    }
}

impl<'a> Rows<'a> {
    /// Opens a file and finds the columns.
    pub(super) fn open(
        file: impl ChunkReader + 'static,
        name: String,
        wanted: &'a Wanted,
        notes: &mut Notes,
    ) -> Result<Self, Failure> {
        let reader = SerializedFileReader::new(file).map_err(|e| damaged(&name, &e))?;
        let schema = reader.metadata().file_metadata().schema_descr();
        let columns: Vec<String> = schema.columns().iter().map(|c| c.path().string()).collect();
        let [at, others] = super::find_columns(&columns, wanted, &name)?;
        for &i in &at {
            let column = schema.column(i);
            if !matches!(column.physical_type(), Physical::DOUBLE | Physical::FLOAT)
                || column.max_rep_level() > 0
            {
                return Err(Problem::new(format!(
                    "{name}: the column `{}` holds {}, not floating-point numbers",
                    columns[i],
                    if column.max_rep_level() > 0 {
                        "lists".into()
                    } else {
                        column.physical_type().to_string()
                    }
                ))
                .help(format!(
                    "write the {} as columns of 64-bit floating-point numbers",
                    wanted.what
                ))
                .into());
            }
        }
        let (mut carried, mut left) = (Vec::new(), Vec::new());
        for i in others {
            match meaning(&schema.column(i)).filter(|_| wanted.others) {
                Some(meaning) => carried.push((i, meaning)),
                None => left.push(i),
            }
        }
        super::unused(&columns, &left, &name, notes);
        Ok(Rows {
            name,
            wanted,
            at,
            other_names: carried.iter().map(|&(i, _)| columns[i].clone()).collect(),
            others: carried,
            group: 0,
            columns: Vec::new(),
            done: 0,
            reader: Box::new(reader),
        })
    }

    /// Goes on to the next group of rows. False at the end.
    fn next_group(&mut self) -> Result<bool, Failure> {
        if self.group == self.reader.num_row_groups() {
            // A group that ends early gives less than the file says it holds.
            let groups = self.reader.metadata().row_groups().iter();
            let rows: i64 = groups.map(|g| g.num_rows()).sum();
            if i64::try_from(self.done).ok() != Some(rows) {
                return Err(Problem::new(format!(
                    "{}: {} of {rows} rows could be read: the file is damaged",
                    self.name, self.done
                ))
                .help("write the file anew")
                .into());
            }
            return Ok(false);
        }
        let opened = self.reader.get_row_group(self.group).and_then(|group| {
            let others = self.others.iter().map(|o| o.0);
            let all = self.at.iter().copied().chain(others);
            all.map(|i| group.get_column_reader(i))
                .collect::<Result<Vec<_>, _>>()
        });
        self.columns = opened.map_err(|e| damaged(&self.name, &e))?;
        self.group += 1;
        Ok(true)
    }
}

impl Source for Rows<'_> {
    fn fill(&mut self, block: &mut Block, problems: &mut Problems) -> Result<bool, Failure> {
        loop {
            let (numbers, others) = self.next_columns()?;
            let lengths = numbers.iter().map(Vec::len);
            let mut lengths = lengths.chain(others.iter().map(Vec::len));
            let rows = lengths.next().unwrap_or(0);
            if lengths.any(|l| l != rows) {
                return Err(Problem::new(format!(
                    "{}: the columns are of different lengths: the file is damaged",
                    self.name
                ))
                .help("write the file anew")
                .into());
            }
            for i in 0..rows {
                self.done += 1;
                for (k, column) in numbers.iter().enumerate() {
                    if column[i].is_none() {
                        problems.push(self.done, || {
                            Problem::new(format!("{}: it is null", self.name(self.done, Some(k))))
                                .help(format!("give every row all its {}", self.wanted.what))
                        });
                    }
                    block.numbers.push(column[i].unwrap_or(f64::NAN));
                }
                if numbers.iter().any(|column| column[i].is_none()) {
                    block.bad.push(block.places.len());
                }
                block.places.push(self.done);
                block.columns.extend(0..numbers.len());
                for column in &others {
                    block.others.push(column[i].as_deref().unwrap_or(""));
                }
            }
            if rows > 0 {
                return Ok(true);
            }
            if !self.next_group()? {
                return Ok(false);
            }
        }
    }

    fn name(&self, row: u64, column: Option<usize>) -> String {
        let column = column.map_or(String::new(), |k| {
            format!(", column `{}`", self.wanted.columns[k])
        });
        format!("{}, row {row}{column}", self.name)
    }

    fn others(&self) -> &[String] {
        &self.other_names
    }

    fn share(&self) -> f64 {
        let rows = self.reader.metadata().file_metadata().num_rows();
        self.done as f64 / rows.max(1) as f64
    }
}

type Numbers = Vec<Vec<Option<f64>>>;
type Others = Vec<Vec<Option<String>>>;

impl Rows<'_> {
    /// The next rows of all columns.
    fn next_columns(&mut self) -> Result<(Numbers, Others), Problem> {
        let (mut numbers, mut others) = (Vec::new(), Vec::new());
        let wanted = self.at.len();
        for (k, reader) in self.columns.iter_mut().enumerate() {
            let read = if k < wanted {
                read_numbers(reader).map(|column| numbers.push(column))
            } else {
                read_texts(reader, self.others[k - wanted].1).map(|column| others.push(column))
            };
            read.map_err(|e| damaged(&self.name, &e))?;
        }
        Ok((numbers, others))
    }
}

fn read_numbers(reader: &mut ColumnReader) -> Result<Vec<Option<f64>>, ParquetError> {
    match reader {
        ColumnReader::DoubleColumnReader(r) => read(r, |x| x),
        ColumnReader::FloatColumnReader(r) => read(r, f64::from),
        _ => Err(changed()),
    }
}

fn read_texts(
    reader: &mut ColumnReader,
    meaning: Meaning,
) -> Result<Vec<Option<String>>, ParquetError> {
    let unsigned = meaning == Meaning::Unsigned;
    match reader {
        ColumnReader::DoubleColumnReader(r) => read(r, |x| x.to_string()),
        ColumnReader::FloatColumnReader(r) => read(r, |x| x.to_string()),
        ColumnReader::BoolColumnReader(r) => read(r, |x| x.to_string()),
        ColumnReader::Int32ColumnReader(r) if unsigned => {
            read(r, |x| x.cast_unsigned().to_string())
        }
        ColumnReader::Int64ColumnReader(r) if unsigned => {
            read(r, |x| x.cast_unsigned().to_string())
        }
        ColumnReader::Int32ColumnReader(r) => read(r, |x| x.to_string()),
        ColumnReader::Int64ColumnReader(r) => read(r, |x| x.to_string()),
        ColumnReader::ByteArrayColumnReader(r) => {
            read(r, |x| String::from_utf8_lossy(x.data()).into_owned())
        }
        _ => Err(changed()),
    }
}

fn changed() -> ParquetError {
    ParquetError::General("the type of a column changed".into())
}

/// The next rows of a column, `None` for nulls; none at the end of the group.
fn read<T: DataType, R>(
    reader: &mut ColumnReaderImpl<T>,
    of: impl Fn(T::T) -> R,
) -> Result<Vec<Option<R>>, ParquetError> {
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    let (rows, _, _) = reader.read_records(BLOCK, Some(&mut levels), None, &mut values)?;
    let whole = values.len() == rows;
    let mut values = values.into_iter().map(of);
    // Without nulls there may be no levels; with them, each row has one, and the highest means "a value".
    if whole {
        return Ok(values.map(Some).collect());
    }
    let present = levels.iter().copied().max().unwrap_or(0).max(1);
    Ok(levels
        .iter()
        .map(|&l| if l == present { values.next() } else { None })
        .collect())
}

fn damaged(name: &str, e: &ParquetError) -> Problem {
    Problem::new(format!("{name}: could not be read as Parquet: {e}")).help(
        "readable are files without encryption, uncompressed or compressed with Snappy, gzip or LZ4",
    )
}
