//! `nappe project`.

use crate::commands::length;
use crate::failure::{Failure, Problem};
use crate::model::{self, ModelArgs};
use crate::output;
use crate::project::{self, Asked, Question, Tally};
use crate::screen::Screen;
use crate::table::{Input, OutputFormat};
use crate::text::number;
use nappe::query::{Finder, FinderOptions, QueryError, Sidedness, SignedFinder};
use nappe_model::Model;
use std::io;
use std::path::PathBuf;

/// Find the nearest point of a model to each of many points
///
/// Reads rows of x,y,z and writes, in their order: the given point px,py,pz, what stands in other columns of the table (an
/// id, for instance; as text), the distance, the surface and its parameters u,v, the nearest point x,y,z, the gap, and a
/// status. Nothing of the model is nearer than the distance less the gap: that is proven, rounding included.
///
/// A row that has no answer is put out too, with empty fields. Its status says why: `unreadable` (not three numbers),
/// `not finite`, or `no distance` (too far away to compute with). The first ten are told with their lines, and all are
/// counted; the exit code is 0 all the same. The status of an answer whose gap is wider than --tolerance, as where a whole
/// circle is about equally near, is `gap`, that of all others `ok`.
///
/// Of closed shells, --signed gives a negative distance inside; of open surfaces, behind the normal r_u × r_v. It is
/// empty where no side is defined: beyond an open edge, on a surface, at an open surface's pole, and where surfaces disagree. Of a closed shell it is also
/// empty nearer than 1e-4 of the diagonal to an edge, a seam, a tip or a pole, where the places there disagree; and always
/// where more than two sides meet or the inside is not certain. A note says which surfaces do not close shells.
///
/// With --all there is a row for each of several nearest places, all within the tolerance; those with the status `gap` may be farther. The box around each has the diagonal
/// `extent`, and its `locus` is a `point` or, where a curve or a whole surface is as near, `spread`.
///
/// Tables are read and written as by `nappe eval`, may be larger than the memory, and are worked on by all cores. In text a
/// field ends in the line where it begins. Lines that begin with # are skipped, but below a header whose first column is
/// handed on they are rows.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  nappe project duct.nappe.toml --points scan.csv -o deviations.csv --signed
  nappe project vase.nappe.toml --points scan.parquet --surface wall -o nearest.parquet
  echo 10,20,30 | nappe project vase.nappe.toml --all
  nappe project vase.nappe.toml --curve wall --points scan.csv --format jsonl")]
pub(crate) struct Args {
    #[command(flatten)]
    model: ModelArgs,

    /// A table of points, CSV or Parquet; `-` or none: standard input
    #[arg(long, value_name = "FILE")]
    points: Option<PathBuf>,

    /// Only this surface, or those of this object; may be given several times. Default: all that are put out
    #[arg(long, value_name = "NAME")]
    surface: Vec<String>,

    /// Instead of surfaces, this curve; may be given several times
    #[arg(long, value_name = "NAME", conflicts_with = "surface")]
    curve: Vec<String>,

    /// The gap to reach, in the model's units; default: a billionth of the diagonal
    #[arg(long, value_name = "T", value_parser = length)]
    tolerance: Option<f64>,

    /// Also the distance with a sign
    #[arg(long, conflicts_with_all = ["curve", "all"])]
    signed: bool,

    /// All nearest places, a row for each
    #[arg(long)]
    all: bool,

    /// The format of the output; default: by the ending of -o, else csv
    #[arg(long)]
    format: Option<OutputFormat>,

    /// Write to this file, .csv, .jsonl or .parquet, instead of standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

impl Args {
    pub(crate) fn run(&self, screen: &Screen) -> Result<(), Failure> {
        let format = OutputFormat::choose(self.format, self.output.as_deref())?;
        let model = self.model.open(screen)?;
        let input = Input::named(self.points.as_deref(), project::wanted(), "")?;
        let question = self.question(&model)?;
        if let Asked::Signed(finder) = &question.asked {
            tell_sides(screen, &finder.sidedness());
        }
        let progress = screen.progress("finding nearest points");
        let tally = match &self.output {
            None => {
                let out = io::BufWriter::with_capacity(output::BUFFER, io::stdout());
                project::run(&question, &input, format, out, true, &progress)
            }
            Some(path) => output::write_with(path, |out| {
                project::run(&question, &input, format, out, false, &progress)
            }),
        };
        progress.finish();
        tell(screen, tally?);
        Ok(())
    }

    fn question(&self, model: &Model) -> Result<Question, Failure> {
        let options = FinderOptions {
            tol: self.tolerance,
            ..FinderOptions::default()
        };
        let asked = |finder| {
            if self.all {
                Asked::All(finder)
            } else {
                Asked::One(finder)
            }
        };
        if !self.curve.is_empty() {
            let of = |name: &String| model::curve(model, name);
            let curves = self.curve.iter().map(of).collect::<Result<Vec<_>, _>>()?;
            return Ok(Question {
                asked: asked(Finder::on_curves(&curves, options).map_err(refused)?),
                names: self.curve.clone(),
                of_curves: true,
            });
        }
        let (names, surfaces): (Vec<_>, Vec<_>) =
            model::surfaces(model, &self.surface)?.into_iter().unzip();
        let asked = if self.signed {
            SignedFinder::new(&surfaces, options).map(Asked::Signed)
        } else {
            Finder::new(&surfaces, options).map(asked)
        };
        Ok(Question {
            asked: asked.map_err(refused)?,
            names,
            of_curves: false,
        })
    }
}

fn refused(error: QueryError) -> Problem {
    let problem = Problem::new(error.to_string());
    match error {
        QueryError::NoSurface => problem.help(
            "the model puts out no surface; name one with --surface, or a curve with --curve",
        ),
        _ => problem,
    }
}

/// Says what signs mean where it is not the inside of a shell.
fn tell_sides(screen: &Screen, all: &[Sidedness]) {
    let count = |which| all.iter().filter(|&&s| s == which).count();
    let [closed, open, unknown] =
        [Sidedness::Closed, Sidedness::Open, Sidedness::Unknown].map(count);
    if closed == all.len() {
        return;
    }
    let mut note = format!("{closed} of {} surfaces close shells", all.len());
    if open > 0 {
        note += &format!("; of {open} the sign is that of the normal r_u × r_v");
    }
    if unknown > 0 {
        note += &format!(
            "; {unknown} have no sign: more than two sides meet there, or the inside is not certain"
        );
    }
    screen.note(note);
}

/// Says which rows have no answer, and which a wide gap.
fn tell(screen: &Screen, tally: Tally) {
    for problem in &tally.problems {
        screen.report(problem);
    }
    for note in &tally.notes {
        screen.note(note);
    }
    let Tally {
        rows,
        unanswered,
        wide,
        widest,
        ..
    } = tally;
    if unanswered > 0 {
        let what = format!("{unanswered} of {rows} points have no answer");
        screen.report(
            &Problem::new(what).help("they were put out with empty fields; their status says why"),
        );
    }
    if wide > 0 {
        screen.note(format!(
            "{wide} of {rows} points have a gap above the tolerance, {} at most: their status is gap",
            number(widest, 3)
        ));
    }
}
