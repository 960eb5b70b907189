//! Files that are written: whole, or not at all.

use crate::failure::{Failure, Problem};
use nappe_exchange::step::Schema;
use nappe_exchange::{ExchangeError, write_atomically};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Bytes gathered before each write to standard output.
pub(crate) const BUFFER: usize = 1 << 16;

/// Says early that a file will not be writable, before anything long is done.
pub(crate) fn check(path: &Path) -> Result<(), Failure> {
    nappe_exchange::check_target(path).map_err(refused)
}

/// Writes a file in one go.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    write_atomically(path, |out| out.write_all(bytes)).map_err(refused)
}

/// Writes a file bit by bit. Where the work fails, the old file stays.
pub(crate) fn write_with<T>(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&mut File>) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let mut failure = None;
    let written = write_atomically(path, |out| {
        fill(out).map_err(|f| match f {
            Failure::Output(e) => e,
            other => {
                failure = Some(other);
                io::Error::other("the work failed")
            }
        })
    });
    match (failure, written) {
        (Some(f), _) => Err(f),
        (None, written) => written.map_err(refused),
    }
}

/// What the writer says.
pub(crate) fn refused(e: ExchangeError) -> Failure {
    problem(e).into()
}

/// What the writer says; most say the remedy themselves.
pub(crate) fn problem(e: ExchangeError) -> Problem {
    let problem = Problem::new(e.to_string());
    match e {
        ExchangeError::Nothing { .. } => problem
            .help("a mesh holds surfaces, .json, .svg and .png also curves; what is construction_only is not put out"),
        ExchangeError::Io { .. } => {
            problem.help("check the permissions of the directory and the room on the disk; what was there before stays")
        }
        _ => problem,
    }
}

/// The standard that STEP files follow.
pub(crate) fn schema(ap214: bool) -> Schema {
    if ap214 { Schema::Ap214 } else { Schema::Ap242 }
}

/// Refuses a choice of the standard where no STEP file is written.
pub(crate) fn check_ap214(ap214: bool, is_step: bool) -> Result<(), Failure> {
    if ap214 && !is_step {
        let why = "--ap214 is for STEP files: name a file that ends with .step or .stp";
        return Err(Failure::usage(why));
    }
    Ok(())
}
