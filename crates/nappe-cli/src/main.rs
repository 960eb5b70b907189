//! The command `nappe`: model files in, certified meshes, pictures and numbers out. It only asks the other crates and
//! shows what they answer.

mod cli;
mod commands;
mod eval;
mod failure;
mod fault;
mod imports;
mod input;
mod model;
mod output;
mod project;
mod scene;
mod screen;
mod slits;
mod table;
mod text;

use clap::Parser;
use failure::{Failure, Problem};
use std::process::ExitCode;

/// The model or the data are wrong, or a check failed.
const WRONG: u8 = 1;
/// The command line is wrong.
const USAGE: u8 = 2;

fn main() -> ExitCode {
    std::panic::set_hook(Box::new(|panic| screen::bug(&panic.to_string())));
    let cli = cli::Cli::parse();
    let screen = screen::Screen::new(cli.color, cli.quiet);
    match cli.command.run(&screen) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) if failure.is_closed_pipe() => ExitCode::SUCCESS,
        Err(Failure::Model(problems)) => {
            screen.diagnostics(&problems);
            ExitCode::from(WRONG)
        }
        Err(Failure::Verdict) => ExitCode::from(WRONG),
        Err(Failure::Problems(problems)) => {
            for p in &problems {
                screen.report(p.as_ref());
            }
            ExitCode::from(WRONG)
        }
        Err(Failure::Output(e)) => {
            screen.report(
                &Problem::new(format!("standard output: could not write: {e}")).help(
                    "make room, or write to a file with -o, which is kept only when it is whole",
                ),
            );
            ExitCode::from(WRONG)
        }
        Err(Failure::Usage(e)) => {
            // Nothing can be done if standard error is closed.
            let _ = e.print();
            ExitCode::from(USAGE)
        }
    }
}
