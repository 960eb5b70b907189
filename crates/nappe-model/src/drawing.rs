//! Diagnostics drawn with the lines of the file that they speak of.

use crate::diagnostics::{Diagnostic, Diagnostics, Label, Severity};
use miette::{
    GraphicalReportHandler, GraphicalTheme, LabeledSpan, MietteError, MietteSpanContents,
    Severity as MietteSeverity, SourceCode, SourceSpan, SpanContents,
};
use std::fmt;

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
/// Of a longer line only the part around the place is shown.
const LONG_LINE: usize = 240;
/// Bytes shown before and after the place in a long line.
const AROUND: usize = 60;
/// A place that is longer, or covers more lines, is shown by its first line.
const LONG_PLACE: usize = 600;
/// The most lines of a place that are shown.
const MOST_LINES: usize = 12;

impl Diagnostics {
    /// Draws every problem with its lines of the file, and the summary. Of lines longer than 240 bytes the part around
    /// the place is shown. The same input gives the same text.
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
        let source = Source(self);
        let mut out = String::new();
        for diagnostic in &self.list {
            let report = Report {
                diagnostic,
                source: &source,
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
}

/// The text of a file, of which the drawing library takes the lines around each place.
#[derive(Debug)]
struct Source<'a>(&'a Diagnostics);

impl Source<'_> {
    /// The byte where the line of a byte begins.
    fn line_start(&self, at: usize) -> usize {
        self.0.text[..at].rfind('\n').map_or(0, |i| i + 1)
    }

    /// The byte behind the last of the line of a byte, without its end of line.
    fn line_end(&self, at: usize) -> usize {
        let text = &self.0.text;
        text[at..].find('\n').map_or(text.len(), |i| at + i)
    }

    /// The nearest beginning of a character at or before a byte.
    fn character(&self, at: usize) -> usize {
        let mut at = at.min(self.0.text.len());
        while !self.0.text.is_char_boundary(at) {
            at -= 1;
        }
        at
    }

    /// A place as it is marked: its first line, or the beginning of that, where all of it would fill the screen.
    fn marked(&self, l: &Label) -> std::ops::Range<usize> {
        let [start, end] = [l.span.start, l.span.end].map(|i| self.character(i));
        let end = end.max(start);
        let many_lines = self.0.text[start..end]
            .matches('\n')
            .nth(MOST_LINES)
            .is_some();
        let end = if many_lines || end - start > LONG_PLACE {
            end.min(self.line_end(start))
        } else {
            end
        };
        let whole_line = self.line_end(end) - self.line_start(start);
        if whole_line > LONG_LINE && end - start > AROUND {
            start..self.character(start + AROUND)
        } else {
            start..end
        }
    }

    /// The bytes to show around a place.
    fn window(&self, start: usize, end: usize, lines: usize) -> std::ops::Range<usize> {
        let mut from = self.line_start(start);
        if start - from > LONG_LINE {
            from = self.character(start - AROUND);
        } else {
            for _ in 0..lines.min(from) {
                let before = self.line_start(from.saturating_sub(1));
                if from - before > LONG_LINE {
                    break;
                }
                from = before;
            }
        }
        let mut to = self.line_end(end);
        if to - end > LONG_LINE {
            to = self.character(end + AROUND);
        } else {
            for _ in 0..lines {
                let next = (to + 1).min(self.0.text.len());
                let after = self.line_end(next);
                if after - to > LONG_LINE {
                    break;
                }
                to = after;
            }
        }
        from..to
    }
}

impl SourceCode for Source<'_> {
    fn read_span<'s>(
        &'s self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'s> + 's>, MietteError> {
        let (start, end) = (
            self.character(span.offset()),
            self.character(span.offset() + span.len()),
        );
        if end - start > LONG_PLACE {
            // Two places that are far apart are drawn apart.
            return Err(MietteError::OutOfBounds);
        }
        let shown = if before == 0 && after == 0 {
            start..end
        } else {
            self.window(start, end, before.max(after))
        };
        let (line, column) = self.0.line_column(shown.start);
        let data = &self.0.text[shown.clone()];
        Ok(Box::new(MietteSpanContents::new_named(
            self.0.file.clone(),
            data.as_bytes(),
            (shown.start, shown.len()).into(),
            line - 1,
            column - 1,
            data.matches('\n').count() + 1,
        )))
    }
}

/// A problem as the drawing library wants it.
#[derive(Debug)]
struct Report<'a> {
    diagnostic: &'a Diagnostic,
    source: &'a Source<'a>,
}

impl fmt::Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.diagnostic.labels.is_empty() {
            write!(f, "{}: ", self.source.0.file)?;
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
    fn source_code(&self) -> Option<&dyn SourceCode> {
        (!self.diagnostic.labels.is_empty()).then_some(self.source as &dyn SourceCode)
    }
    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let labels = self.diagnostic.labels.iter().enumerate().map(|(i, l)| {
            let text = (!l.text.is_empty()).then(|| l.text.clone());
            let marked = self.source.marked(l);
            let span = (marked.start, marked.len());
            if i == 0 {
                LabeledSpan::new_primary_with_span(text, span)
            } else {
                LabeledSpan::new_with_span(text, span)
            }
        });
        Some(Box::new(labels))
    }
}
