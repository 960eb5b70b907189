//! STEP files (ISO 10303-21): exact shapes as bodies with names, colours and units.

mod error;
mod read;

pub use error::StepError;
pub use read::{StepFile, read};
