//! What is wrong with a model file, where, and what would be right.

use crate::value::Span;
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
            message: shortened(message.into()),
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
        self.help = Some(shortened(text.into()));
        self
    }

    /// Makes it a warning.
    pub(crate) fn warning(mut self) -> Self {
        self.severity = Severity::Warning;
        self
    }
}

/// The most characters of a message: names and words of a file can be of any length.
const MOST_CHARACTERS: usize = 1000;

/// The text without what makes it unreadably long.
fn shortened(mut text: String) -> String {
    if let Some((cut, _)) = text.char_indices().nth(MOST_CHARACTERS) {
        text.truncate(cut);
        text.push('…');
    }
    text
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
    /// How many problems were found beyond those listed.
    pub unlisted: usize,
}

/// The most errors, and the most warnings, that are listed: a file of a million wrong numbers would fill the memory
/// with messages that nobody reads. The others are counted.
const MOST_LISTED: usize = 200;

impl Diagnostics {
    pub(crate) fn new(file: &str, text: &str) -> Self {
        Self {
            file: file.into(),
            text: text.into(),
            list: Vec::new(),
            skipped: 0,
            unlisted: 0,
        }
    }

    pub(crate) fn push(&mut self, d: Diagnostic) {
        if self.count(d.severity) >= MOST_LISTED {
            self.unlisted += 1;
        } else if !self.list.contains(&d) {
            // The same thing is not said twice (two keys may refer to the same broken text).
            self.list.push(d);
        }
    }

    /// How many are listed of one severity.
    fn count(&self, severity: Severity) -> usize {
        self.list.iter().filter(|d| d.severity == severity).count()
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
        let [errors, warnings] = [Severity::Error, Severity::Warning].map(|s| self.count(s));
        let count = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
        let mut parts = Vec::new();
        if errors > 0 {
            parts.push(count(errors, "error"));
        }
        if warnings > 0 {
            parts.push(count(warnings, "warning"));
        }
        let mut text = parts.join(", ");
        if self.unlisted > 0 {
            text += &format!("; {} more are not listed", self.unlisted);
        }
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

    /// One problem in one line.
    pub(crate) fn line(&self, d: &Diagnostic) -> String {
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
