//! `nappe schema`.

use crate::failure::Failure;
use std::io::Write;

/// Print the JSON Schema of the model file, for editors that complete and check as you type
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Example:
  nappe schema > nappe.schema.json   and as the first line of a model: #:schema ./nappe.schema.json")]
pub(crate) struct Args {}

impl Args {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let mut text = nappe_model::schema();
        text.push('\n');
        Ok(std::io::stdout().lock().write_all(text.as_bytes())?)
    }
}
