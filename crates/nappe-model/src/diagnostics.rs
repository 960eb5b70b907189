//! What is wrong with a model file, where, and what would be right.

use crate::value::Span;
use miette::{
    GraphicalReportHandler, GraphicalTheme, LabeledSpan, NamedSource, Severity as MietteSeverity,
};
use std::fmt;

/// How bad it is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Severity {
    /// There is no model.
    Error,
    /// There is a model, but something about it should be known.
    Warning,
}

/// A place in the file with a remark.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Label {
    /// The byte range.
    pub span: Span,
    /// The remark; may be empty.
    pub text: String,
}

/// One thing that is wrong.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Diagnostic {
    /// The class of the problem: a short stable name such as `unknown-key`.
    pub code: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// What is wrong, with the object's name and the numbers.
    pub message: String,
    /// Where; the first is the main place.
    pub labels: Vec<Label>,
    /// What would be right.
    pub help: Option<String>,
}

impl Diagnostic {
    /// An error without a place.
    pub(crate) fn new(code: &'static str, message: impl Into<String>) -> Self {
        Self {
            code,
            severity: Severity::Error,
            message: message.into(),
            labels: Vec::new(),
            help: None,
        }
    }

    /// Adds a place.
    pub(crate) fn at(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label {
            span,
            text: text.into(),
        });
        self
    }

    /// Says what would be right.
    pub(crate) fn help(mut self, text: impl Into<String>) -> Self {
        self.help = Some(text.into());
        self
    }

    /// Makes it a warning.
    pub(crate) fn warning(mut self) -> Self {
        self.severity = Severity::Warning;
        self
    }
}

/// Everything that is wrong with a file, in the order of the file.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Diagnostics {
    /// The name of the file.
    pub file: String,
    /// Its text.
    pub text: String,
    /// The problems.
    pub list: Vec<Diagnostic>,
    /// How many objects were not built only because they depend on one that is wrong.
    pub skipped: usize,
}

/// How diagnostics are drawn.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct RenderStyle {
    /// Colours (ANSI escapes).
    pub color: bool,
    /// Line drawing characters beyond ASCII.
    pub unicode: bool,
    /// The width in columns; 0 for the default of 100.
    pub width: usize,
}

/// Columns when nothing else is said.
const DEFAULT_WIDTH: usize = 100;

impl Diagnostics {
    pub(crate) fn new(file: &str, text: &str) -> Self {
        Self {
            file: file.into(),
            text: text.into(),
            list: Vec::new(),
            skipped: 0,
        }
    }

    pub(crate) fn push(&mut self, d: Diagnostic) {
        // The same thing is not said twice (two keys may refer to the same broken text).
        if !self.list.contains(&d) {
            self.list.push(d);
        }
    }

    /// True if there is no model.
    pub fn has_errors(&self) -> bool {
        self.list.iter().any(|d| d.severity == Severity::Error)
    }

    /// In the order of the file; problems without a place come first.
    pub(crate) fn sort(&mut self) {
        self.list
            .sort_by_key(|d| d.labels.first().map_or(0, |l| l.span.start + 1));
    }

    /// Line and column, both from 1, of a byte of the file; columns count characters.
    pub fn line_column(&self, byte: usize) -> (usize, usize) {
        let mut byte = byte.min(self.text.len());
        while !self.text.is_char_boundary(byte) {
            byte -= 1;
        }
        let before = &self.text[..byte];
        let line = before.matches('\n').count() + 1;
        let start = before.rfind('\n').map_or(0, |i| i + 1);
        (line, before[start..].chars().count() + 1)
    }

    /// `file:line:column` of a problem's main place, or the file.
    pub fn place(&self, d: &Diagnostic) -> String {
        match d.labels.first() {
            Some(l) => {
                let (line, column) = self.line_column(l.span.start);
                format!("{}:{line}:{column}", self.file)
            }
            None => self.file.clone(),
        }
    }

    /// The last line: how many problems, and what was not tried.
    pub fn summary(&self) -> String {
        let errors = self
            .list
            .iter()
            .filter(|d| d.severity == Severity::Error)
            .count();
        let warnings = self.list.len() - errors;
        let count = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
        let mut parts = Vec::new();
        if errors > 0 {
            parts.push(count(errors, "error"));
        }
        if warnings > 0 {
            parts.push(count(warnings, "warning"));
        }
        let mut text = parts.join(", ");
        if self.skipped > 0 {
            text += &format!(
                "; {} not built because {} on what is wrong",
                if self.skipped == 1 {
                    "1 object was".to_owned()
                } else {
                    format!("{} objects were", self.skipped)
                },
                if self.skipped == 1 {
                    "it depends"
                } else {
                    "they depend"
                },
            );
        }
        text
    }

    /// Draws every problem with its lines of the file, and the summary. The same input gives the same text.
    pub fn render(&self, style: RenderStyle) -> String {
        let theme = match (style.unicode, style.color) {
            (true, true) => GraphicalTheme::unicode(),
            (true, false) => GraphicalTheme::unicode_nocolor(),
            (false, true) => GraphicalTheme::ascii(),
            (false, false) => GraphicalTheme::none(),
        };
        let handler = GraphicalReportHandler::new_themed(theme)
            .with_links(false)
            .with_width(if style.width == 0 {
                DEFAULT_WIDTH
            } else {
                style.width
            })
            .without_cause_chain();
        let source = NamedSource::new(&self.file, self.text.clone());
        let mut out = String::new();
        for diagnostic in &self.list {
            let report = Report {
                diagnostic,
                source: &source,
                file: &self.file,
            };
            // Writing to a String does not fail; if the library cannot draw, the plain line remains.
            if handler.render_report(&mut out, &report).is_err() {
                out += &self.line(diagnostic);
            }
            out.push('\n');
        }
        out += &self.summary();
        out.push('\n');
        out
    }

    /// One problem in one line.
    fn line(&self, d: &Diagnostic) -> String {
        let help = d.help.as_ref().map_or(String::new(), |h| format!(" ({h})"));
        format!("{}: {}{help}", self.place(d), d.message)
    }
}

/// One line for each problem: `file:line:column: message (remedy)`.
impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for d in &self.list {
            writeln!(f, "{}", self.line(d))?;
        }
        write!(f, "{}", self.summary())
    }
}

impl std::error::Error for Diagnostics {}

/// A problem as the drawing library wants it.
#[derive(Debug)]
struct Report<'a> {
    diagnostic: &'a Diagnostic,
    source: &'a NamedSource<String>,
    file: &'a str,
}

impl fmt::Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.diagnostic.labels.is_empty() {
            write!(f, "{}: ", self.file)?;
        }
        write!(f, "{}", self.diagnostic.message)
    }
}

impl std::error::Error for Report<'_> {}

impl miette::Diagnostic for Report<'_> {
    fn code<'b>(&'b self) -> Option<Box<dyn fmt::Display + 'b>> {
        Some(Box::new(self.diagnostic.code))
    }
    fn severity(&self) -> Option<MietteSeverity> {
        Some(match self.diagnostic.severity {
            Severity::Error => MietteSeverity::Error,
            Severity::Warning => MietteSeverity::Warning,
        })
    }
    fn help<'b>(&'b self) -> Option<Box<dyn fmt::Display + 'b>> {
        self.diagnostic
            .help
            .as_ref()
            .map(|h| Box::new(h) as Box<dyn fmt::Display>)
    }
    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        (!self.diagnostic.labels.is_empty()).then_some(self.source as &dyn miette::SourceCode)
    }
    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let labels = self.diagnostic.labels.iter().enumerate().map(|(i, l)| {
            let text = (!l.text.is_empty()).then(|| l.text.clone());
            let span = (l.span.start, l.span.end - l.span.start);
            if i == 0 {
                LabeledSpan::new_primary_with_span(text, span)
            } else {
                LabeledSpan::new_with_span(text, span)
            }
        });
        Some(Box::new(labels))
    }
}
