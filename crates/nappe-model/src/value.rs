//! The file as a tree of values with their places, free of the TOML library.

use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A byte range of the file.
pub(crate) type Span = Range<usize>;

/// A value and its place.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) span: Span,
    pub(crate) value: Value,
}

/// A value of the file.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    Number(f64),
    Text {
        text: String,
        /// Where the text begins in the file, if it stands there letter by letter (no escapes).
        start: Option<usize>,
    },
    Bool(bool),
    List(Vec<Node>),
    Table(Table),
    Date,
}

/// A table: keys in the order of the file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Table {
    pub(crate) entries: Vec<(Key, Node)>,
}

/// A key and its place.
#[derive(Clone, Debug)]
pub(crate) struct Key {
    pub(crate) name: String,
    pub(crate) span: Span,
}

impl Table {
    pub(crate) fn get(&self, name: &str) -> Option<&Node> {
        self.entries
            .iter()
            .find(|(k, _)| k.name == name)
            .map(|(_, v)| v)
    }

    /// Takes a value out of the table.
    pub(crate) fn take(&mut self, name: &str) -> Option<Node> {
        let i = self.entries.iter().position(|(k, _)| k.name == name)?;
        Some(self.entries.remove(i).1)
    }
}

impl Node {
    /// What kind of value it is, for messages.
    pub(crate) fn describe(&self) -> String {
        match &self.value {
            Value::Number(x) => format!("the number {x}"),
            Value::Text { text, .. } if text.chars().count() <= 40 => format!("the text {text:?}"),
            Value::Text { .. } => "a text".into(),
            Value::Bool(b) => format!("{b}"),
            Value::List(l) => format!(
                "a list of {} value{}",
                l.len(),
                if l.len() == 1 { "" } else { "s" }
            ),
            Value::Table(_) => "a table".into(),
            Value::Date => "a date".into(),
        }
    }

    /// The place of a part of a text, or of the whole where the text is written with escapes.
    pub(crate) fn place(&self, part: &Span) -> Span {
        match &self.value {
            Value::Text { start: Some(s), .. } => s + part.start..s + part.end,
            _ => self.span.clone(),
        }
    }
}

/// Turns the library's tree into ours; each part of it goes as ours comes, for both together are large.
pub(crate) fn table(source: &str, t: DeTable<'_>) -> Table {
    let entries = t.into_iter().map(|(k, v)| {
        let span = k.span();
        let name = k.into_inner().into_owned();
        (Key { name, span }, node(source, v))
    });
    Table {
        entries: entries.collect(),
    }
}

fn node(source: &str, v: Spanned<DeValue<'_>>) -> Node {
    let span = v.span();
    let value = match v.into_inner() {
        DeValue::String(s) => {
            let raw = source.get(span.clone()).unwrap_or_default();
            let quote = if raw.starts_with("\"\"\"") || raw.starts_with("'''") {
                3
            } else {
                1
            };
            let literal = raw.get(quote..raw.len().saturating_sub(quote)) == Some(s.as_ref());
            Value::Text {
                text: s.into_owned(),
                start: literal.then_some(span.start + quote),
            }
        }
        DeValue::Integer(i) => Value::Number(integer(i.as_str(), i.radix())),
        DeValue::Float(f) => Value::Number(f.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(b) => Value::Bool(b),
        DeValue::Datetime(_) => Value::Date,
        DeValue::Array(a) => Value::List(a.into_iter().map(|x| node(source, x)).collect()),
        DeValue::Table(t) => Value::Table(table(source, t)),
    };
    Node { span, value }
}

/// An integer as a double; integers beyond 2⁵³ are rounded.
fn integer(text: &str, radix: u32) -> f64 {
    if radix == 10 {
        return text.parse().unwrap_or(f64::NAN);
    }
    u128::from_str_radix(text, radix).map_or(f64::NAN, |x| x as f64)
}
