//! Points and derivatives at many parameters: read block by block, evaluated, written block by block, so that the
//! data may be larger than the memory.

mod columns;
mod csv;
mod grid;
mod parquet;
mod problems;
mod sink;
mod table;
mod target;

pub(crate) use self::grid::Grid;
pub(crate) use self::sink::{OutputFormat, Sink};
pub(crate) use self::table::Input;
pub(crate) use self::target::Target;

use self::problems::Problems;

use crate::failure::{Failure, Problem};
use crate::text::exactly;
use nappe::Interval;

/// Rows evaluated at a time: enough to make the cost of a block nothing, few enough to stay in the cache.
const BLOCK: usize = 4096;

/// Rows of parameters, one number for a curve, two for a surface.
#[derive(Debug, Default)]
struct Block {
    /// The parameters, row after row.
    parameters: Vec<f64>,
    /// The line or row of the input each comes from; empty if they come from no input.
    places: Vec<u64>,
    /// Where in its line or row each parameter stands, counted as the source does.
    columns: Vec<usize>,
    /// If the rows are a grid: its values of u and of v. The rows run through v first.
    grid: Option<[Vec<f64>; 2]>,
}

impl Block {
    fn clear(&mut self) {
        self.parameters.clear();
        self.places.clear();
        self.columns.clear();
        self.grid = None;
    }
}

/// Where parameters come from.
trait Source {
    /// Fills the block with the next rows and says which could not be read. False at the end.
    fn fill(&mut self, block: &mut Block, problems: &mut Problems) -> Result<bool, Failure>;

    /// How a row is named in messages, or a column of it.
    fn name(&self, place: u64, column: Option<usize>) -> String;
}

/// What was told while reading, in full sentences.
pub(crate) type Notes = Vec<String>;

/// Evaluates at every row of the input and hands the results to the sink, unless a row is bad: then all rows are still
/// looked at, and all bad ones are told.
///
/// The notes say what of the input was not used.
pub(crate) fn run(
    target: &Target,
    input: &Input,
    order: usize,
    sink: &mut dyn Sink,
) -> Result<Notes, Failure> {
    let mut notes = Notes::new();
    let mut problems = Problems::default();
    let mut source = input.rows(target, &mut notes)?;
    let mut block = Block::default();
    let mut values = Vec::new();
    loop {
        block.clear();
        match source.fill(&mut block, &mut problems) {
            Ok(true) => {}
            Ok(false) => break,
            Err(stopped) => return Err(problems.before(stopped)),
        }
        check_domain(target, source.as_ref(), &mut block, &mut problems);
        if block.parameters.is_empty() {
            continue;
        }
        values.clear();
        target.evaluate(&block.parameters, block.grid.as_ref(), order, &mut values);
        check_finite(target, source.as_ref(), &block, &values, &mut problems);
        if problems.is_empty() {
            sink.rows(&block.parameters, &values)?;
        }
    }
    problems.result()?;
    Ok(notes)
}

/// Does all that [`run`] does but put anything out: what is wrong shows before the first byte is written.
pub(crate) fn check(target: &Target, input: &Input, order: usize) -> Result<(), Failure> {
    run(target, input, order, &mut sink::Nowhere).map(drop)
}

/// Takes the rows that are outside the domain out of the block.
fn check_domain(target: &Target, source: &dyn Source, block: &mut Block, problems: &mut Problems) {
    let (names, domain) = (target.parameters(), target.domain());
    let width = names.len();
    let good = |row: &[f64]| row.iter().zip(&domain).all(|(&p, range)| range.contains(p));
    if block.parameters.chunks_exact(width).all(good) {
        return;
    }
    let mut kept = Block::default();
    for (i, row) in block.parameters.chunks_exact(width).enumerate() {
        let place = block.places.get(i).copied().unwrap_or_default();
        if good(row) {
            kept.parameters.extend_from_slice(row);
            kept.places.push(place);
            // Rows are only named by their places from here on.
            continue;
        }
        for (k, (&p, range)) in row.iter().zip(&domain).enumerate() {
            if !range.contains(p) {
                problems.push(place, || {
                    let column = block.columns.get(i * width + k).copied();
                    outside(target, &source.name(place, column), names[k], p, *range)
                });
            }
        }
    }
    *block = kept;
}

fn outside(target: &Target, place: &str, name: &str, p: f64, range: Interval) -> Problem {
    let (lo, hi) = (exactly(range.lo), exactly(range.hi));
    if p.is_finite() {
        let p = exactly(p);
        Problem::new(format!(
            "{place}: {name} = {p} is outside the domain of {target}"
        ))
        .help(format!("{name} runs from {lo} to {hi}"))
    } else {
        Problem::new(format!("{place}: {name} = {p} is not a finite number"))
            .help(format!("{name} of {target} runs from {lo} to {hi}"))
    }
}

/// No number that is not finite is put out: a curve or surface can have a singular derivative at a parameter.
fn check_finite(
    target: &Target,
    source: &dyn Source,
    block: &Block,
    values: &[f64],
    problems: &mut Problems,
) {
    if values.iter().all(|v| v.is_finite()) {
        return;
    }
    let names = target.parameters();
    let rows = block.parameters.len() / names.len();
    let width = values.len() / rows;
    let columns = columns::names(target, width);
    for (row, row_values) in values.chunks_exact(width).enumerate() {
        if let Some(bad) = row_values.iter().position(|v| !v.is_finite()) {
            let at: Vec<String> = names
                .iter()
                .zip(&block.parameters[row * names.len()..])
                .map(|(n, &p)| format!("{n} = {}", exactly(p)))
                .collect();
            let place = block.places.get(row).copied().unwrap_or_default();
            problems.push(place, || {
                Problem::new(format!(
                    "{}: {} of {target} is {} at {}",
                    source.name(place, None),
                    columns[names.len() + bad],
                    row_values[bad],
                    at.join(", ")
                ))
                .help("the surface or curve has no finite value there; leave the parameter out")
            });
        }
    }
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
