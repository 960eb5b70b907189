//! Files of other programs that are read.

use crate::failure::Problem;
use crate::screen::Screen;
use nappe_exchange::{Progress, Read, read_telling};
use std::path::Path;

/// Reads a file of the format that its ending names, and shows how far it is.
pub(crate) fn read(path: &Path, screen: &Screen) -> Result<Read, Problem> {
    let progress = screen.progress(&format!("Reading {}", path.display()));
    let tell = |share| progress.tell(share);
    let read = read_telling(path, Progress::to(&tell));
    progress.finish();
    read.map_err(|e| Problem::new(e.to_string()))
}
