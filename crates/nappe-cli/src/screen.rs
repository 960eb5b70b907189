//! Standard error: reports, tables, notes and progress. Data never goes here.

use clap::ColorChoice;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme, ThemeCharacters, ThemeStyles};
use nappe_model::{Diagnostics, RenderStyle};
use std::fmt::Display;
use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

/// The width of reports when they do not go to a terminal.
const PAPER_WIDTH: usize = 120;
/// Work that lasts longer shows its progress.
const PATIENCE: Duration = Duration::from_secs(1);

/// Standard error and how to write to it.
#[derive(Debug)]
pub(crate) struct Screen {
    quiet: bool,
    colour: bool,
    width: usize,
}

impl Screen {
    pub(crate) fn new(choice: ColorChoice, quiet: bool) -> Screen {
        let terminal = std::io::stderr().is_terminal();
        let plain = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty())
            || std::env::var_os("TERM").is_some_and(|t| t == "dumb");
        let colour = match choice {
            ColorChoice::Always => true,
            ColorChoice::Never => false,
            ColorChoice::Auto => terminal && !plain,
        };
        let width = match console_width() {
            Some(w) if terminal => w,
            _ => PAPER_WIDTH,
        };
        Screen {
            quiet,
            colour,
            width,
        }
    }

    /// Shows a problem.
    pub(crate) fn report(&self, problem: &dyn Diagnostic) {
        let theme = GraphicalTheme {
            characters: ThemeCharacters::unicode(),
            styles: if self.colour {
                ThemeStyles::ansi()
            } else {
                ThemeStyles::none()
            },
        };
        let mut text = String::new();
        let shown = GraphicalReportHandler::new_themed(theme)
            .with_width(self.width)
            .with_links(false)
            .without_syntax_highlighting()
            .render_report(&mut text, problem);
        if shown.is_err() {
            text = format!("error: {problem}\n");
        }
        put(&text);
    }

    /// Shows what is wrong with a model file.
    pub(crate) fn diagnostics(&self, found: &Diagnostics) {
        put(&found.render(RenderStyle {
            color: self.colour,
            unicode: true,
            width: self.width,
        }));
    }

    /// Shows what should be known about a model that is not wrong, unless the user wants quiet.
    pub(crate) fn warn(&self, found: &Diagnostics) {
        if !self.quiet {
            self.diagnostics(found);
        }
    }

    /// Shows a note or a table, unless the user wants quiet.
    pub(crate) fn note(&self, text: impl Display) {
        if !self.quiet {
            put(&format!("{text}\n"));
        }
    }

    /// A progress bar for a piece of work. It shows itself only on a terminal and only when the work lasts.
    pub(crate) fn progress(&self, what: &str) -> Progress {
        let bar = (!self.quiet && std::io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::with_draw_target(Some(SHARES), ProgressDrawTarget::hidden());
            if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent}% {eta}") {
                bar.set_style(style);
            }
            bar.set_message(what.to_owned());
            bar
        });
        Progress {
            bar,
            start: Instant::now(),
        }
    }
}

/// Parts into which a progress bar divides its work.
const SHARES: u64 = 1000;

/// The progress of one piece of work.
#[derive(Clone, Debug)]
pub(crate) struct Progress {
    bar: Option<ProgressBar>,
    start: Instant,
}

impl Progress {
    /// The finished share, from 0 to 1.
    pub(crate) fn tell(&self, share: f64) {
        if let Some(bar) = &self.bar
            && self.start.elapsed() > PATIENCE
        {
            if bar.is_hidden() {
                bar.set_draw_target(ProgressDrawTarget::stderr());
            }
            bar.set_position((share.clamp(0.0, 1.0) * SHARES as f64) as u64);
        }
    }

    /// Takes the bar away.
    pub(crate) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Says that the program itself is wrong.
pub(crate) fn bug(what: &str) {
    put(&format!(
        "nappe: this is a bug in nappe {}, not in your model.\n{what}\nPlease report it with the command line and the \
         model file.\n",
        env!("CARGO_PKG_VERSION")
    ));
}

fn console_width() -> Option<usize> {
    let (terminal_size::Width(columns), _) = terminal_size::terminal_size_of(std::io::stderr())?;
    (columns > 0).then_some(columns.into())
}

fn put(text: &str) {
    // If standard error is closed there is nobody to tell.
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}
