//! Where tables come from.

use super::{Notes, Source, Wanted, csv, parquet};
use crate::failure::{Failure, Problem};
use std::fs::File;
use std::io::{self, BufReader, IsTerminal, Read, Seek};
use std::path::Path;

/// A table in a file. It can be read several times. What comes through a pipe is in a temporary file, so that it may be
/// larger than the memory.
#[derive(Debug)]
pub(crate) struct Input {
    /// What messages call it.
    name: String,
    file: File,
    wanted: Wanted,
}

/// The first bytes of every Parquet file.
const PARQUET: &[u8] = b"PAR1";

impl Input {
    /// The table that an option names; without one, or by `-`, standard input. What else could be given is `instead`, if
    /// standard input is a terminal.
    pub(crate) fn named(
        path: Option<&Path>,
        wanted: Wanted,
        instead: &str,
    ) -> Result<Input, Failure> {
        match path {
            Some(path) if path.as_os_str() != "-" => Input::file(path, wanted),
            _ => Input::standard(wanted, instead),
        }
    }

    /// A table in a file or a named pipe.
    fn file(path: &Path, wanted: Wanted) -> Result<Input, Failure> {
        let name = path.display().to_string();
        if path.is_dir() {
            return Err(Problem::new(format!("{name}: is a directory, not a table"))
                .help(format!(
                    "name a file with a table of the {}, CSV or Parquet",
                    wanted.what
                ))
                .into());
        }
        let file = File::open(path).map_err(|e| unreadable(&name, &wanted, &e))?;
        if path.is_file() {
            Ok(Input { name, file, wanted })
        } else {
            Input::kept(name, file, wanted)
        }
    }

    /// A table on standard input.
    fn standard(wanted: Wanted, instead: &str) -> Result<Input, Failure> {
        let stdin = io::stdin();
        if stdin.is_terminal() {
            return Err(Failure::usage(format!(
                "no {}: give a table with {} FILE{instead}, or pipe rows of {} in",
                wanted.what,
                wanted.option,
                wanted.columns.join(",")
            )));
        }
        Input::kept("standard input".into(), stdin.lock(), wanted)
    }

    fn kept(name: String, mut stream: impl Read, wanted: Wanted) -> Result<Input, Failure> {
        let refused = |e| {
            Problem::new(format!(
                "{name}: could not be kept in a temporary file: {e}"
            ))
            .help(format!(
                "make room where temporary files go, or give the table as a file with {}",
                wanted.option
            ))
        };
        let mut file = tempfile::tempfile().map_err(refused)?;
        io::copy(&mut stream, &mut file).map_err(refused)?;
        Ok(Input { name, file, wanted })
    }

    /// What messages call it.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// The rows from the first on. The format of a table shows in its first bytes.
    pub(crate) fn rows<'a>(&'a self, notes: &mut Notes) -> Result<Box<dyn Source + 'a>, Failure> {
        let mut head = Vec::new();
        let mut opened = || -> io::Result<(File, u64)> {
            let mut file = self.file.try_clone()?;
            file.rewind()?;
            (&mut file)
                .take(PARQUET.len() as u64)
                .read_to_end(&mut head)?;
            file.rewind()?;
            let size = file.metadata()?.len();
            Ok((file, size))
        };
        let (file, size) = opened().map_err(|e| unreadable(&self.name, &self.wanted, &e))?;
        let name = self.name.clone();
        if head == PARQUET {
            let rows = parquet::Rows::open(file, name, &self.wanted, notes)?;
            Ok(Box::new(rows))
        } else {
            let text = BufReader::new(file);
            let rows = csv::Rows::open(text, size, name, &self.wanted, notes)?;
            Ok(Box::new(rows))
        }
    }
}

fn unreadable(name: &str, wanted: &Wanted, e: &io::Error) -> Problem {
    let Wanted { what, option, .. } = wanted;
    Problem::new(format!("{name}: could not read the {what}: {e}")).help(format!(
        "{option} names a table, CSV or Parquet, of the {what}; `-` is standard input"
    ))
}
