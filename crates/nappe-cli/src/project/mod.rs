//! The nearest point to each point of a table: read block by block, found, written block by block.

mod answer;

pub(crate) use self::answer::{Asked, Question};

use self::answer::{Answers, Status, columns};
use crate::failure::{Failure, Problem};
use crate::screen::Progress;
use crate::table::{Block, Input, Notes, OutputFormat, Problems, Sink, Source, Wanted};
use nappe::DVec3;
use std::io::Write;

/// What a table of points must have.
pub(crate) fn wanted() -> Wanted {
    Wanted {
        columns: &["x", "y", "z"],
        what: "points",
        purpose: "points are read from x, y, z".into(),
        option: "--points",
        others: true,
    }
}

/// How the rows of a table were answered.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    /// All.
    pub(crate) rows: u64,
    /// Those without an answer, and what is wrong with the first of them.
    pub(crate) unanswered: u64,
    pub(crate) problems: Vec<Problem>,
    /// Those whose gap is wider than was asked for, and the widest.
    pub(crate) wide: u64,
    pub(crate) widest: f64,
    /// What else was told while reading.
    pub(crate) notes: Notes,
}

/// Answers every row of the input, in order. A row that has no answer is put out with its status.
///
/// With `ahead`, the whole table is read before the first row is put out, so that what is no table puts out nothing.
pub(crate) fn run(
    question: &Question,
    input: &Input,
    format: OutputFormat,
    out: impl Write + Send,
    ahead: bool,
    progress: &Progress,
) -> Result<Tally, Failure> {
    let mut tally = Tally::default();
    if ahead {
        let mut source = input.rows(&mut Notes::new())?;
        let (mut block, mut problems) = (Block::default(), Problems::default());
        let mut rows = 0;
        while filled(source.as_mut(), &mut block, &mut problems)? {
            rows += block.places.len();
            block.clear();
        }
        if rows == 0 {
            return Err(no_points(input));
        }
    }
    let mut problems = Problems::default();
    let mut source = input.rows(&mut tally.notes)?;
    let others = source.others().len();
    let columns = columns(question, source.others());
    check_names(input, &columns)?;
    let mut sink = format.sink(&columns, out)?;
    let mut block = Block::default();
    loop {
        block.clear();
        if !filled(source.as_mut(), &mut block, &mut problems)? {
            break;
        }
        let answers = question.answer(&block, others);
        count(&answers, source.as_ref(), &block, &mut problems, &mut tally);
        put(sink.as_mut(), &answers, &block)?;
        progress.tell(source.share());
    }
    if tally.rows == 0 {
        return Err(no_points(input));
    }
    sink.finish()?;
    tally.notes.extend(source.notes());
    tally.problems = problems.list();
    Ok(tally)
}

/// The next block. Where reading stops, what was found before is told too.
fn filled(
    source: &mut dyn Source,
    block: &mut Block,
    problems: &mut Problems,
) -> Result<bool, Failure> {
    let filled = source.fill(block, problems);
    filled.map_err(|stopped| std::mem::take(problems).before(stopped))
}

fn no_points(input: &Input) -> Failure {
    Problem::new(format!("{}: there are no points in it", input.name()))
        .help("give a table with the columns x, y, z and at least one row")
        .into()
}

/// No two columns of the output may have one name.
fn check_names(input: &Input, columns: &[crate::table::Column]) -> Result<(), Failure> {
    let mut names: Vec<&str> = columns.iter().map(|c| c.name.as_str()).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        None => Ok(()),
        Some(twice) => Err(Problem::new(format!(
            "{}: the output would have two columns named `{}`",
            input.name(),
            twice[0]
        ))
        .help("columns beside x, y, z are handed on: rename or remove this one")
        .into()),
    }
}

/// Counts what was and was not answered, and says why not.
fn count(
    answers: &Answers<'_>,
    source: &dyn Source,
    block: &Block,
    problems: &mut Problems,
    tally: &mut Tally,
) {
    let (mut last, mut last_wide) = (None, None);
    for answer in &answers.list {
        // A row is wide if one of its places is.
        if let Status::Wide(gap) = answer.status {
            tally.widest = tally.widest.max(gap);
            tally.wide += u64::from(last_wide.replace(answer.row) != Some(answer.row));
        }
        if last == Some(answer.row) {
            continue;
        }
        last = Some(answer.row);
        tally.rows += 1;
        match &answer.status {
            Status::Proven | Status::Wide(_) => {}
            Status::Unreadable => tally.unanswered += 1,
            Status::Failed(error) => {
                tally.unanswered += 1;
                let place = block.places[answer.row];
                problems.push(place, || {
                    Problem::new(format!("{}: {error}", source.name(place, None)))
                });
            }
        }
    }
}

fn put(sink: &mut dyn Sink, answers: &Answers<'_>, block: &Block) -> std::io::Result<()> {
    sink.rows(answers.list.len(), &|row, column| {
        answers.cell(block, row, column)
    })
}

/// The points of a block.
fn points(block: &Block) -> Vec<DVec3> {
    let rows = block.numbers.chunks_exact(3);
    rows.map(DVec3::from_slice).collect()
}
