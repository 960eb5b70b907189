//! The commands, one to a file: what each takes from the command line, and what it asks of the other crates.

mod bends;
mod build;
mod check;
mod closing;
mod completions;
mod convert;
mod eval;
mod examples;
mod figures;
mod info;
mod info_file;
mod intersect;
mod project;
mod rates;
mod render;
mod report;
mod schema;
mod touching;
mod traced;

use crate::failure::Failure;
use crate::screen::Screen;
use clap::Subcommand;

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Build(build::Args),
    Eval(eval::Args),
    Info(info::Args),
    Intersect(intersect::Args),
    Check(check::Args),
    Project(project::Args),
    Render(render::Args),
    Convert(convert::Args),
    Schema(schema::Args),
    Examples(examples::Args),
    Completions(completions::Args),
}

impl Command {
    /// Does it.
    pub(crate) fn run(&self, screen: &Screen) -> Result<(), Failure> {
        match self {
            Command::Build(args) => args.run(screen),
            Command::Eval(args) => args.run(screen),
            Command::Info(args) => args.run(screen),
            Command::Intersect(args) => args.run(screen),
            Command::Check(args) => args.run(screen),
            Command::Project(args) => args.run(screen),
            Command::Render(args) => args.run(screen),
            Command::Convert(args) => args.run(screen),
            Command::Schema(args) => args.run(),
            Command::Examples(args) => args.run(screen),
            Command::Completions(args) => args.run(),
        }
    }
}

/// Reads a length that is greater than zero.
fn length(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x.is_finite() => Ok(x),
        Ok(x) => Err(format!("{x} is not a length greater than zero")),
        Err(_) => Err(format!("`{text}` is not a number")),
    }
}

/// Reads a finite number.
fn number(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(format!("`{text}` is not a number")),
    }
}
