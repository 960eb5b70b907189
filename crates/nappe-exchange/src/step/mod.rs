//! STEP files (ISO 10303-21): exact shapes as bodies with names, colours and units.

mod error;
mod read;
mod write;

pub use error::StepError;
pub(crate) use read::Course;
pub use read::{StepFile, read};
pub use write::{Schema, StepOptions, StepReport, write};
