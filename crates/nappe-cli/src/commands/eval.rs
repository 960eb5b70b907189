//! `nappe eval`.

use crate::eval::{self, Asked, Grid, Input, Target};
use crate::failure::{Failure, Problem};
use crate::model::{self, ModelArgs};
use crate::output;
use crate::screen::Screen;
use crate::table::{self, OutputFormat};
use nappe::curve::MAX_ORDER;
use nappe_model::{Model, Velocity};
use std::io;
use std::path::PathBuf;

/// Evaluate a surface or a curve and its derivatives at many parameters
///
/// Reads rows of u,v (t for a curve) and writes u,v,x,y,z for each; with --order 1 also x_u,y_u,z_u,x_v,y_v,z_v, with
/// --order 2 x_uu,…,x_uv,…,x_vv,…, and so on; with --sensitivity radius also dx_dradius,dy_dradius,dz_dradius. Derivatives
/// are exact. Every number has as many digits, 17 at most, as it
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
  nappe eval bowl.nappe.toml --surface bowl --grid 5 --sensitivity radius
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

    /// Also how the points move, at fixed u and v or t, with a parameter of the model: columns dx_dNAME, dy_dNAME, dz_dNAME; may
    /// be given several times
    #[arg(long, value_name = "PARAMETER")]
    sensitivity: Vec<String>,

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
        let asked = Asked {
            order: usize::from(self.order),
            rates: self.rates(&model, &target)?,
        };
        let columns = eval::columns(&target, &asked);
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
                eval::check(&target, &input, &asked)?;
                // One lock for the whole table, and large writes.
                let out = io::BufWriter::with_capacity(output::BUFFER, io::stdout());
                let mut sink = format.sink(&columns, out)?;
                let notes = eval::run(&target, &input, &asked, sink.as_mut())?;
                sink.finish()?;
                notes
            }
            Some(path) => output::write_with(path, |out| {
                let mut sink = format.sink(&columns, out)?;
                let notes = eval::run(&target, &input, &asked, sink.as_mut())?;
                sink.finish()?;
                Ok(notes)
            })?,
        };
        for note in notes {
            screen.note(note);
        }
        Ok(())
    }

    /// How the target moves with each parameter that is asked for.
    fn rates(
        &self,
        model: &Model,
        target: &Target,
    ) -> Result<Vec<(String, Option<Target>)>, Failure> {
        let each = self.model.velocities(model, &self.sensitivity)?;
        let mut rates = Vec::new();
        for (parameter, all) in self.sensitivity.iter().zip(each) {
            let named = |name: &str| format!("{name} by {parameter}");
            let rate = match target {
                Target::Curve(name, _) => {
                    let known = model.curves.iter().zip(all.curves);
                    let velocity = known.filter(|(c, _)| c.name == *name).map(|k| k.1).next();
                    fixed(target, parameter, velocity)?.map(|v| Target::Curve(named(name), v))
                }
                Target::Surface(name, _) => {
                    let known = model.surfaces.iter().zip(all.surfaces);
                    let velocity = known.filter(|(s, _)| s.name == *name).map(|k| k.1).next();
                    fixed(target, parameter, velocity)?.map(|v| Target::Surface(named(name), v))
                }
            };
            rates.push((parameter.clone(), rate));
        }
        Ok(rates)
    }
}

/// The velocity at fixed parameters of the curve or surface; none: it does not move.
fn fixed<T>(
    target: &Target,
    parameter: &str,
    velocity: Option<Velocity<T>>,
) -> Result<Option<T>, Problem> {
    let unknown = |why: &str, help: &str| {
        let message = format!("how {target} moves with {parameter} is not known: {why}");
        Problem::new(message).help(help)
    };
    match velocity {
        Some(Velocity::Still) => Ok(None),
        Some(Velocity::Moves(v)) => Ok(Some(v)),
        Some(Velocity::Follows(_)) => Err(unknown(
            "its corners move along its parameter, so that the velocity at fixed parameters jumps there",
            "write parametrization = \"uniform\" for the curve that has the corners",
        )),
        Some(Velocity::Unknown(why)) => Err(unknown(&why, "leave the parameter out")),
        None => Err(unknown("it is not built", "leave the parameter out")),
    }
}
