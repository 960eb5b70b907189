//! Points and derivatives at many parameters: read block by block, evaluated, written block by block, so that the
//! data may be larger than the memory.

mod columns;
mod csv;
mod grid;
mod parquet;
mod sink;
mod target;

pub(crate) use self::grid::Grid;
pub(crate) use self::sink::{OutputFormat, Sink};
pub(crate) use self::target::Target;

use crate::failure::{Failure, Problem};
use crate::text::exactly;
use std::fs::File;
use std::io::{self, BufReader, Cursor, IsTerminal, Read};
use std::path::Path;

/// Rows evaluated at a time: enough to make the cost of a block nothing, few enough to stay in the cache.
const BLOCK: usize = 4096;

/// Bad rows that are told in one go.
const MOST_PROBLEMS: usize = 10;

/// Rows of parameters, one number for a curve, two for a surface.
#[derive(Debug, Default)]
struct Block {
    /// The parameters, row after row.
    parameters: Vec<f64>,
    /// The line or row of the input each comes from; empty if they come from no input.
    places: Vec<u64>,
    /// If the rows are a grid: its values of u and of v. The rows run through v first.
    grid: Option<[Vec<f64>; 2]>,
}

impl Block {
    fn clear(&mut self) {
        self.parameters.clear();
        self.places.clear();
        self.grid = None;
    }
}

/// Where parameters come from.
trait Source {
    /// Fills the block with the next rows; leaves it empty at the end.
    fn fill(&mut self, block: &mut Block) -> Result<(), Failure>;

    /// How a row is named in messages.
    fn name(&self, place: u64) -> String;
}

/// What was told while reading, in full sentences.
pub(crate) type Notes = Vec<String>;

/// The parameters to evaluate at.
#[derive(Clone, Debug)]
pub(crate) enum Input<'a> {
    /// A table in a file.
    File(&'a Path),
    /// A table on standard input.
    Standard,
    /// A uniform grid over the whole domain.
    Grid(Grid),
}

/// Evaluates at every row of the input and hands the results to the sink.
///
/// The notes say what of the input was not used.
pub(crate) fn run(
    target: &Target,
    input: &Input<'_>,
    order: usize,
    sink: &mut dyn Sink,
) -> Result<Notes, Failure> {
    let mut notes = Notes::new();
    let mut source = open(target, input, &mut notes)?;
    let mut block = Block::default();
    let mut values = Vec::new();
    loop {
        block.clear();
        source.fill(&mut block)?;
        if block.parameters.is_empty() {
            return Ok(notes);
        }
        check_domain(target, source.as_ref(), &block)?;
        values.clear();
        target.evaluate(&block.parameters, block.grid.as_ref(), order, &mut values);
        check_finite(target, source.as_ref(), &block, &values)?;
        sink.rows(&block.parameters, &values)?;
    }
}

/// The first bytes of every Parquet file.
const PARQUET: &[u8] = b"PAR1";

fn open<'a>(
    target: &'a Target,
    input: &Input<'_>,
    notes: &mut Notes,
) -> Result<Box<dyn Source + 'a>, Failure> {
    match *input {
        Input::Grid(grid) => Ok(Box::new(grid.over(target)?)),
        Input::File(path) => {
            let name = path.display().to_string();
            let file = File::open(path).map_err(|e| unreadable(&name, &e))?;
            if path.is_dir() {
                return Err(Problem::new(format!("{name}: is a directory, not a table")).into());
            }
            let again = path.is_file().then_some(path);
            open_stream(file, again, name, target, notes)
        }
        Input::Standard => {
            let stdin = io::stdin();
            if stdin.is_terminal() {
                return Err(Failure::usage(format!(
                    "no parameters: give a table with --uv FILE, a grid with --grid N, or pipe rows of {} in",
                    target.parameters().join(",")
                )));
            }
            open_stream(stdin.lock(), None, "standard input".into(), target, notes)
        }
    }
}

/// Opens a table whose format shows in its first bytes. `again` is the file it comes from, if it can be opened anew.
fn open_stream<'a>(
    mut stream: impl Read + 'a,
    again: Option<&Path>,
    name: String,
    target: &'a Target,
    notes: &mut Notes,
) -> Result<Box<dyn Source + 'a>, Failure> {
    let mut head = Vec::new();
    let head_len = PARQUET.len() as u64;
    (&mut stream)
        .take(head_len)
        .read_to_end(&mut head)
        .map_err(|e| unreadable(&name, &e))?;
    if head != PARQUET {
        let text = BufReader::new(Cursor::new(head).chain(stream));
        return Ok(Box::new(csv::Rows::open(text, name, target, notes)?));
    }
    // A Parquet file is read from its end, which a pipe has only once all of it is there.
    let rows = match again {
        Some(path) => {
            let file = File::open(path).map_err(|e| unreadable(&name, &e))?;
            parquet::Rows::open(file, name, target, notes)?
        }
        None => {
            stream
                .read_to_end(&mut head)
                .map_err(|e| unreadable(&name, &e))?;
            parquet::Rows::open(bytes::Bytes::from(head), name, target, notes)?
        }
    };
    Ok(Box::new(rows))
}

fn unreadable(name: &str, e: &io::Error) -> Problem {
    Problem::new(format!("{name}: could not read the parameters: {e}"))
        .help("--uv names a table, CSV or Parquet, of the parameters; `-` is standard input")
}

/// Bad rows, as many as are told in one go.
#[derive(Debug, Default)]
struct Problems {
    told: Vec<Problem>,
    /// Found in the same block, but not told.
    more: usize,
}

impl Problems {
    fn push(&mut self, p: Problem) {
        if self.told.len() < MOST_PROBLEMS {
            self.told.push(p);
        } else {
            self.more += 1;
        }
    }

    fn result(mut self) -> Result<(), Failure> {
        if self.told.is_empty() {
            return Ok(());
        }
        if self.more > 0 {
            self.told.push(Problem::new(format!(
                "{} more problems like these; reading stopped there",
                self.more
            )));
        }
        Err(self.told.into())
    }
}

fn check_domain(target: &Target, source: &dyn Source, block: &Block) -> Result<(), Failure> {
    let (names, domain) = (target.parameters(), target.domain());
    let mut problems = Problems::default();
    for (row, parameters) in block.parameters.chunks_exact(names.len()).enumerate() {
        for ((&p, name), range) in parameters.iter().zip(names).zip(&domain) {
            if range.contains(p) {
                continue;
            }
            let place = source.name(block.places.get(row).copied().unwrap_or_default());
            problems.push(if p.is_finite() {
                Problem::new(format!(
                    "{place}: {name} = {} is outside the domain of {target}",
                    exactly(p)
                ))
                .help(format!(
                    "{name} runs from {} to {}",
                    exactly(range.lo),
                    exactly(range.hi)
                ))
            } else {
                Problem::new(format!("{place}: {name} = {p} is not a finite number")).help(format!(
                    "{name} of {target} runs from {} to {}",
                    exactly(range.lo),
                    exactly(range.hi)
                ))
            });
        }
    }
    problems.result()
}

/// No number that is not finite is put out: a curve or surface can have a singular derivative at a parameter.
fn check_finite(
    target: &Target,
    source: &dyn Source,
    block: &Block,
    values: &[f64],
) -> Result<(), Failure> {
    if values.iter().all(|v| v.is_finite()) {
        return Ok(());
    }
    let names = target.parameters();
    let rows = block.parameters.len() / names.len();
    let width = values.len() / rows;
    let columns = columns::names(target, width);
    let mut problems = Problems::default();
    for (row, row_values) in values.chunks_exact(width).enumerate() {
        if let Some(bad) = row_values.iter().position(|v| !v.is_finite()) {
            let at: Vec<String> = names
                .iter()
                .zip(&block.parameters[row * names.len()..])
                .map(|(n, &p)| format!("{n} = {}", exactly(p)))
                .collect();
            let place = source.name(block.places.get(row).copied().unwrap_or_default());
            problems.push(
                Problem::new(format!(
                    "{place}: {} of {target} is {} at {}",
                    columns[names.len() + bad],
                    row_values[bad],
                    at.join(", ")
                ))
                .help("the surface or curve has no finite value there; leave the parameter out"),
            );
        }
    }
    problems.result()
}

/// Where each parameter stands among named columns; the note says which columns are not used.
fn find_columns(
    columns: &[String],
    target: &Target,
    place: &str,
    notes: &mut Notes,
) -> Result<Vec<usize>, Failure> {
    let mut at = Vec::new();
    for parameter in target.parameters() {
        let mut found = (0..columns.len()).filter(|&i| columns[i].eq_ignore_ascii_case(parameter));
        match (found.next(), found.next()) {
            (Some(i), None) => at.push(i),
            (Some(i), Some(j)) => {
                return Err(Problem::new(format!(
                    "{place}: the columns {} and {} are both named {parameter}",
                    i + 1,
                    j + 1
                ))
                .help("rename one of them")
                .into());
            }
            (None, _) => {
                return Err(Problem::new(format!(
                    "{place}: there is no column {parameter}; the columns are {}",
                    columns.join(", ")
                ))
                .help(format!(
                    "{target} is evaluated at {}: name the columns so, or leave the header out",
                    target.parameters().join(", ")
                ))
                .into());
            }
        }
    }
    let unused: Vec<&str> = (0..columns.len())
        .filter(|i| !at.contains(i))
        .map(|i| columns[i].as_str())
        .collect();
    if !unused.is_empty() {
        notes.push(format!("{place}: not used: {}", unused.join(", ")));
    }
    Ok(at)
}
