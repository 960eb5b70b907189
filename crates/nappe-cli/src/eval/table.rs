//! Where parameters come from.

use super::grid::Grid;
use super::target::Target;
use super::{Notes, Source, csv, parquet};
use crate::failure::{Failure, Problem};
use std::fs::File;
use std::io::{self, BufReader, IsTerminal, Read, Seek};
use std::path::Path;

/// The parameters to evaluate at. They can be read several times.
#[derive(Debug)]
pub(crate) enum Input {
    /// A table in a file. What comes through a pipe is in a temporary one, so that it may be larger than the memory.
    Table {
        /// What messages call it.
        name: String,
        /// The file.
        file: File,
    },
    /// A uniform grid over the whole domain.
    Grid(Grid),
}

/// The first bytes of every Parquet file.
const PARQUET: &[u8] = b"PAR1";

impl Input {
    /// A table in a file or a named pipe.
    pub(crate) fn file(path: &Path) -> Result<Input, Failure> {
        let name = path.display().to_string();
        if path.is_dir() {
            return Err(Problem::new(format!("{name}: is a directory, not a table"))
                .help("name a file with a table of the parameters, CSV or Parquet")
                .into());
        }
        let file = File::open(path).map_err(|e| unreadable(&name, &e))?;
        if path.is_file() {
            Ok(Input::Table { name, file })
        } else {
            Input::kept(name, file)
        }
    }

    /// A table on standard input.
    pub(crate) fn standard(target: &Target) -> Result<Input, Failure> {
        let stdin = io::stdin();
        if stdin.is_terminal() {
            return Err(Failure::usage(format!(
                "no parameters: give a table with --uv FILE, a grid with --grid N, or pipe rows of {} in",
                target.parameters().join(",")
            )));
        }
        Input::kept("standard input".into(), stdin.lock())
    }

    fn kept(name: String, mut stream: impl Read) -> Result<Input, Failure> {
        let refused = |e| {
            Problem::new(format!(
                "{name}: could not be kept in a temporary file: {e}"
            ))
            .help("make room where temporary files go, or give the table as a file with --uv")
        };
        let mut file = tempfile::tempfile().map_err(refused)?;
        io::copy(&mut stream, &mut file).map_err(refused)?;
        Ok(Input::Table { name, file })
    }

    /// The rows from the first on. The format of a table shows in its first bytes.
    pub(super) fn rows<'a>(
        &self,
        target: &'a Target,
        notes: &mut Notes,
    ) -> Result<Box<dyn Source + 'a>, Failure> {
        match self {
            Input::Grid(grid) => Ok(Box::new(grid.over(target)?)),
            Input::Table { name, file } => {
                let mut head = Vec::new();
                let mut opened = || -> io::Result<File> {
                    let mut file = file.try_clone()?;
                    file.rewind()?;
                    (&mut file)
                        .take(PARQUET.len() as u64)
                        .read_to_end(&mut head)?;
                    file.rewind()?;
                    Ok(file)
                };
                let file = opened().map_err(|e| unreadable(name, &e))?;
                let name = name.clone();
                if head == PARQUET {
                    Ok(Box::new(parquet::Rows::open(file, name, target, notes)?))
                } else {
                    let text = BufReader::new(file);
                    Ok(Box::new(csv::Rows::open(text, name, target, notes)?))
                }
            }
        }
    }
}

fn unreadable(name: &str, e: &io::Error) -> Problem {
    Problem::new(format!("{name}: could not read the parameters: {e}"))
        .help("--uv names a table, CSV or Parquet, of the parameters; `-` is standard input")
}
