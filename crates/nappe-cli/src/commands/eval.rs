//! `nappe eval`.

use crate::eval::{self, Grid, Input, Target};
use crate::failure::Failure;
use crate::model::{self, ModelArgs};
use crate::output;
use crate::screen::Screen;
use crate::table::{self, OutputFormat};
use nappe::curve::MAX_ORDER;
use std::io;
use std::path::PathBuf;

/// Evaluate a surface or a curve and its derivatives at many parameters
///
/// Reads rows of u,v (t for a curve) and writes u,v,x,y,z for each; with --order 1 also x_u,y_u,z_u,x_v,y_v,z_v, with
/// --order 2 x_uu,…,x_uv,…,x_vv,…, and so on. Derivatives are exact. Every number has as many digits, 17 at most, as it
/// takes to read back the same number.
///
/// Every row is checked before anything is put out: a bad one (not a number, outside the domain, no finite value there)
/// is told with its line and column, the first ten of them and how many more there are, and nothing is written. For
/// standard output the table is evaluated twice; a file given with -o is only kept if all went well. Tables may be
/// larger than the memory; one that comes through a pipe is kept in a temporary file.
///
/// Text is comma-separated. With a header line the columns may stand in any order and others are passed over (a note
/// says which); without one there are the parameters alone. Lines that begin with # (but for a header
/// that names the columns) and empty lines are skipped. At a break of a curve or surface the piece above it decides.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  nappe eval bowl.nappe.toml --surface bowl --grid 11x21 --order 1 > points.csv
  echo 0.25,0.5 | nappe eval bowl.nappe.toml --surface bowl
  nappe eval bowl.nappe.toml --curve profile --uv t.csv --format jsonl
  nappe eval bowl.nappe.toml --surface bowl --uv uv.parquet -o points.parquet")]
pub(crate) struct Args {
    #[command(flatten)]
    model: ModelArgs,

    /// The surface to evaluate
    #[arg(long, value_name = "NAME", required_unless_present = "curve")]
    surface: Option<String>,

    /// The curve to evaluate
    #[arg(long, value_name = "NAME", conflicts_with = "surface")]
    curve: Option<String>,

    /// A table of parameters, CSV or Parquet; `-` or none: standard input
    #[arg(long, value_name = "FILE", visible_alias = "t")]
    uv: Option<PathBuf>,

    /// Instead of a table, N × M parameters in equal steps over the whole domain, the ends among them
    #[arg(long, value_name = "N[xM]", conflicts_with = "uv")]
    grid: Option<Grid>,

    /// Derivatives up to this order
    #[arg(long, value_name = "K", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=MAX_ORDER as i64))]
    order: u8,

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
        let target = match (&self.surface, &self.curve) {
            (Some(name), _) => Target::Surface(name.clone(), model::surface(&model, name)?),
            (None, name) => {
                let name = name.as_deref().unwrap_or_default();
                Target::Curve(name.to_owned(), model::curve(&model, name)?)
            }
        };
        let order = usize::from(self.order);
        let columns = eval::columns(&target, order);
        let input = match &self.grid {
            Some(grid) => Input::Grid(*grid),
            None => Input::Table(table::Input::named(
                self.uv.as_deref(),
                target.wanted(),
                ", a grid with --grid N",
            )?),
        };
        let notes = match &self.output {
            None => {
                // What is written cannot be taken back, so all is looked at before.
                eval::check(&target, &input, order)?;
                // One lock for the whole table, and large writes.
                let out = io::BufWriter::with_capacity(output::BUFFER, io::stdout());
                let mut sink = format.sink(&columns, out)?;
                let notes = eval::run(&target, &input, order, sink.as_mut())?;
                sink.finish()?;
                notes
            }
            Some(path) => output::write_with(path, |out| {
                let mut sink = format.sink(&columns, out)?;
                let notes = eval::run(&target, &input, order, sink.as_mut())?;
                sink.finish()?;
                Ok(notes)
            })?,
        };
        for note in notes {
            screen.note(note);
        }
        Ok(())
    }
}
