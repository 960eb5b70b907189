//! Why a command did not do what was asked.

use clap::CommandFactory;
use clap::error::ErrorKind;
use miette::Diagnostic;
use std::fmt;
use std::io;

/// Why a command ends early.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The model file is wrong.
    Model(Box<nappe_model::Diagnostics>),
    /// Something else that was given is wrong: what is wrong, each to be shown.
    Problems(Vec<Box<dyn Diagnostic + Send + Sync>>),
    /// The command line is wrong in a way that the parser could not see.
    Usage(clap::Error),
    /// A check failed, or something is not decided, and that was already put out.
    Verdict,
    /// Standard output refused bytes.
    Output(io::Error),
}

/// A problem without a place in a model file.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{message}")]
pub(crate) struct Problem {
    message: String,
    help: Option<String>,
}

impl Problem {
    pub(crate) fn new(message: impl Into<String>) -> Problem {
        Problem {
            message: message.into(),
            help: None,
        }
    }

    /// With what to do about it.
    pub(crate) fn help(mut self, help: impl Into<String>) -> Problem {
        self.help = Some(help.into());
        self
    }
}

impl Diagnostic for Problem {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help
            .as_ref()
            .map(|h| Box::new(h) as Box<dyn fmt::Display>)
    }
}

impl From<Problem> for Failure {
    fn from(p: Problem) -> Failure {
        Failure::Problems(vec![Box::new(p)])
    }
}

impl From<Vec<Problem>> for Failure {
    fn from(p: Vec<Problem>) -> Failure {
        Failure::Problems(p.into_iter().map(|p| Box::new(p) as _).collect())
    }
}

impl Failure {
    /// A command line that contradicts itself.
    pub(crate) fn usage(message: impl fmt::Display) -> Failure {
        Failure::Usage(crate::cli::Cli::command().error(ErrorKind::ArgumentConflict, message))
    }

    /// True if whoever reads standard output has had enough: that is not an error.
    pub(crate) fn is_closed_pipe(&self) -> bool {
        matches!(self, Failure::Output(e) if e.kind() == io::ErrorKind::BrokenPipe)
    }
}

impl From<io::Error> for Failure {
    fn from(e: io::Error) -> Failure {
        Failure::Output(e)
    }
}
