//! Tables of parameters as Parquet.

use super::problems::Problems;
use super::target::Target;
use super::{BLOCK, Block, Notes, Source};
use crate::failure::{Failure, Problem};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{DataType, DoubleType, FloatType};
use parquet::errors::ParquetError;
use parquet::file::reader::{ChunkReader, FileReader, SerializedFileReader};

/// A table of parameters: flat columns of 64- or 32-bit floating-point numbers, named as the parameters.
pub(super) struct Rows {
    reader: Box<dyn FileReader>,
    name: String,
    parameters: &'static [&'static str],
    /// The column of each parameter.
    at: Vec<usize>,
    /// The next group of rows.
    group: usize,
    /// The parameters' columns of the group that is being read.
    columns: Vec<ColumnReader>,
    /// The rows given out so far.
    done: u64,
}

impl Rows {
    /// Opens a file and finds the columns.
    pub(super) fn open(
        file: impl ChunkReader + 'static,
        name: String,
        target: &Target,
        notes: &mut Notes,
    ) -> Result<Self, Failure> {
        let reader = SerializedFileReader::new(file).map_err(|e| damaged(&name, &e))?;
        let schema = reader.metadata().file_metadata().schema_descr();
        let columns: Vec<String> = schema.columns().iter().map(|c| c.path().string()).collect();
        let at = super::find_columns(&columns, target, &name, notes)?;
        for &i in &at {
            use parquet::basic::Type::{DOUBLE, FLOAT};
            let column = schema.column(i);
            if !matches!(column.physical_type(), DOUBLE | FLOAT) || column.max_rep_level() > 0 {
                return Err(Problem::new(format!(
                    "{name}: the column `{}` holds {}, not floating-point numbers",
                    columns[i],
                    if column.max_rep_level() > 0 {
                        "lists".into()
                    } else {
                        column.physical_type().to_string()
                    }
                ))
                .help("write the parameters as columns of 64-bit floating-point numbers")
                .into());
            }
        }
        Ok(Rows {
            reader: Box::new(reader),
            name,
            parameters: target.parameters(),
            at,
            group: 0,
            columns: Vec::new(),
            done: 0,
        })
    }

    /// Goes on to the next group of rows. False at the end.
    fn next_group(&mut self) -> Result<bool, Failure> {
        if self.group == self.reader.num_row_groups() {
            return Ok(false);
        }
        let opened = self.reader.get_row_group(self.group).and_then(|group| {
            self.at
                .iter()
                .map(|&i| group.get_column_reader(i))
                .collect::<Result<Vec<_>, _>>()
        });
        self.columns = opened.map_err(|e| damaged(&self.name, &e))?;
        self.group += 1;
        Ok(true)
    }
}

impl Source for Rows {
    fn fill(&mut self, block: &mut Block, problems: &mut Problems) -> Result<bool, Failure> {
        loop {
            let mut columns = Vec::with_capacity(self.columns.len());
            for reader in &mut self.columns {
                let read = match reader {
                    ColumnReader::DoubleColumnReader(r) => read::<DoubleType>(r),
                    ColumnReader::FloatColumnReader(r) => read::<FloatType>(r),
                    _ => Err(ParquetError::General("the type of a column changed".into())),
                };
                columns.push(read.map_err(|e| damaged(&self.name, &e))?);
            }
            let rows = columns.iter().map(Vec::len).min().unwrap_or(0);
            if columns.iter().any(|c| c.len() != rows) {
                return Err(Problem::new(format!(
                    "{}: the columns are of different lengths: the file is damaged",
                    self.name
                ))
                .help("write the file anew")
                .into());
            }
            for i in 0..rows {
                self.done += 1;
                let row: Vec<f64> = columns.iter().filter_map(|c| c[i]).collect();
                if row.len() == columns.len() {
                    block.parameters.extend(row);
                    block.places.push(self.done);
                    block.columns.extend(0..columns.len());
                    continue;
                }
                for k in (0..columns.len()).filter(|&k| columns[k][i].is_none()) {
                    problems.push(self.done, || {
                        Problem::new(format!("{}: it is null", self.name(self.done, Some(k))))
                            .help("give every row all its parameters")
                    });
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

    fn name(&self, row: u64, parameter: Option<usize>) -> String {
        let column = parameter.map_or(String::new(), |k| {
            format!(", column `{}`", self.parameters[k])
        });
        format!("{}, row {row}{column}", self.name)
    }
}

/// The next rows of a column, `None` for nulls; none at the end of the group.
fn read<T: DataType>(reader: &mut ColumnReaderImpl<T>) -> Result<Vec<Option<f64>>, ParquetError>
where
    T::T: Into<f64> + Copy,
{
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    let (rows, _, _) = reader.read_records(BLOCK, Some(&mut levels), None, &mut values)?;
    let mut values = values.into_iter().map(Into::into);
    // Without nulls there may be no levels; with them, each row has one, and the highest means "a value".
    if values.len() == rows {
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
