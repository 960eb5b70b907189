//! STEP files (ISO 10303-21): exact shapes as bodies with names, colours and units.

mod error;
mod read;
mod write;

pub use error::StepError;
pub(crate) use read::Course;
pub(crate) use read::read_telling;
pub use read::{StepFile, read};
pub(crate) use write::write_telling;
pub use write::{Schema, StepOptions, StepReport, write};
