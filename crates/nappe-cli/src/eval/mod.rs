//! Points and derivatives at many parameters: read block by block, evaluated, written block by block, so that the
//! data may be larger than the memory.

mod columns;
mod grid;
mod target;

pub(crate) use self::columns::columns;
pub(crate) use self::grid::Grid;
pub(crate) use self::target::{Asked, Target};

use crate::failure::{Failure, Problem};
use crate::table::{self, Block, Cell, Notes, Nowhere, Problems, Sink, Source};
use crate::text::exactly;
use nappe::Interval;

/// The parameters to evaluate at.
#[derive(Debug)]
pub(crate) enum Input {
    /// A table of them.
    Table(table::Input),
    /// A uniform grid over the whole domain.
    Grid(Grid),
}

impl Input {
    fn rows<'a>(
        &'a self,
        target: &Target,
        notes: &mut Notes,
    ) -> Result<Box<dyn Source + 'a>, Failure> {
        match self {
            Input::Grid(grid) => Ok(Box::new(grid.over(target)?)),
            Input::Table(table) => table.rows(notes),
        }
    }
}

/// Evaluates at every row of the input and hands the results to the sink, unless a row is bad: then all rows are still
/// looked at, and all bad ones are told.
///
/// The notes say what of the input was not used.
pub(crate) fn run(
    target: &Target,
    input: &Input,
    asked: &Asked,
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
        if block.numbers.is_empty() {
            continue;
        }
        values.clear();
        target.evaluate(&block.numbers, block.grid.as_ref(), asked, &mut values);
        check_finite(
            target,
            source.as_ref(),
            &block,
            asked,
            &values,
            &mut problems,
        );
        if problems.is_empty() {
            put(sink, target, &block.numbers, &values)?;
        }
    }
    problems.result()?;
    Ok(notes)
}

/// Does all that [`run`] does but put anything out: what is wrong shows before the first byte is written.
pub(crate) fn check(target: &Target, input: &Input, asked: &Asked) -> Result<(), Failure> {
    run(target, input, asked, &mut Nowhere).map(drop)
}

/// Puts parameters out with what was found there.
fn put(
    sink: &mut dyn Sink,
    target: &Target,
    parameters: &[f64],
    values: &[f64],
) -> std::io::Result<()> {
    let first = target.parameters().len();
    let rows = parameters.len() / first;
    let second = values.len() / rows;
    sink.rows(rows, &|row, column| {
        Cell::Number(match column.checked_sub(first) {
            None => parameters[row * first + column],
            Some(column) => values[row * second + column],
        })
    })
}

/// Takes the rows that could not be read, or are outside the domain, out of the block.
fn check_domain(target: &Target, source: &dyn Source, block: &mut Block, problems: &mut Problems) {
    let (names, domain) = (target.parameters(), target.domain());
    let width = names.len();
    let good = |row: &[f64]| row.iter().zip(&domain).all(|(&p, range)| range.contains(p));
    if block.bad.is_empty() && block.numbers.chunks_exact(width).all(good) {
        return;
    }
    let mut kept = Block::default();
    let mut bad = block.bad.iter().peekable();
    for (i, row) in block.numbers.chunks_exact(width).enumerate() {
        if bad.next_if(|&&b| b == i).is_some() {
            continue;
        }
        let place = block.places.get(i).copied().unwrap_or_default();
        if good(row) {
            kept.numbers.extend_from_slice(row);
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
    asked: &Asked,
    values: &[f64],
    problems: &mut Problems,
) {
    if values.iter().all(|v| v.is_finite()) {
        return;
    }
    let names = target.parameters();
    let rows = block.numbers.len() / names.len();
    let width = values.len() / rows;
    let columns = columns::names(target, asked);
    for (row, row_values) in values.chunks_exact(width).enumerate() {
        if let Some(bad) = row_values.iter().position(|v| !v.is_finite()) {
            let at: Vec<String> = names
                .iter()
                .zip(&block.numbers[row * names.len()..])
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
