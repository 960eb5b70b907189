//! The command line.

use crate::commands::Command;
use clap::{ColorChoice, Parser};

/// Exact surfaces from model files: certified meshes, pictures and numbers
///
/// A model file (*.nappe.toml) describes curves and surfaces. nappe builds them exactly, meshes them within a proven
/// tolerance, draws them, and answers questions about them with error bounds.
#[derive(Debug, Parser)]
#[command(
    name = "nappe",
    version,
    arg_required_else_help = true,
    disable_help_subcommand = true,
    after_help = "\
Examples:
  nappe examples --write models                      put the bundled models into the folder models
  nappe build models/duct.nappe.toml                 mesh the duct into models/duct.glb
  nappe render models/vase.nappe.toml -o vase.png    draw the vase

`nappe COMMAND --help` explains a command. Exit codes: 0 done; 1 the model or the data are wrong, or a check failed; \
2 the command line is wrong."
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,

    /// When to use colours in messages
    #[arg(long, global = true, help_heading = "Global options", value_name = "WHEN", default_value_t = ColorChoice::Auto)]
    pub(crate) color: ColorChoice,

    /// Show problems only: no notes, tables or progress on standard error
    #[arg(long, short, global = true, help_heading = "Global options")]
    pub(crate) quiet: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_well_defined() {
        Cli::command().debug_assert();
    }
}
