//! `nappe completions`.

use crate::cli::Cli;
use crate::failure::Failure;
use clap::CommandFactory;
use clap_complete::Shell;
use std::io::Write;

/// Print a script that completes nappe's commands in a shell
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  nappe completions bash > ~/.local/share/bash-completion/completions/nappe
  nappe completions fish > ~/.config/fish/completions/nappe.fish")]
pub(crate) struct Args {
    /// The shell
    shell: Shell,
}

impl Args {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), "nappe", &mut script);
        Ok(std::io::stdout().lock().write_all(&script)?)
    }
}
