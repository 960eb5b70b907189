//! The parameters of an entity, parsed where they lie.

use super::scan::shown;

/// A parameter.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value<'a> {
    /// `#12`.
    Ref(u64),
    /// A number without a point.
    Int(i64),
    /// A number with a point.
    Real(f64),
    /// The letters between quotes, as they are.
    Text(&'a [u8]),
    /// The letters between points: `T` of `.T.`.
    Enum(&'a [u8]),
    /// `(…)`.
    List(Vec<Value<'a>>),
    /// `LENGTH_MEASURE(25.4)`.
    Typed(&'a [u8], Vec<Value<'a>>),
    /// `$`, `*`, or a binary number.
    None,
}

/// Lists deeper than this are refused; the deepest of the standard have three levels.
const DEPTH: usize = 16;

/// A place among the parameters of an entity.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    /// The byte that it is at.
    pub(super) fn place(&self) -> usize {
        self.at
    }

    fn wrong(&self, what: &str) -> String {
        format!("{what} expected, `{}` found", shown(self.bytes, self.at))
    }

    #[inline]
    fn blanks(&mut self) {
        loop {
            match self.bytes.get(self.at) {
                Some(b' ' | b'\t' | b'\r' | b'\n') => self.at += 1,
                Some(b'/') if self.bytes.get(self.at + 1) == Some(&b'*') => {
                    let rest = &self.bytes[self.at + 2..];
                    let end = rest.windows(2).position(|w| w == b"*/");
                    self.at += end.map_or(2, |n| n + 4);
                }
                _ => return,
            }
        }
    }

    /// The next letter, blanks skipped.
    #[inline]
    pub(super) fn peek(&mut self) -> Option<u8> {
        self.blanks();
        self.bytes.get(self.at).copied()
    }

    /// Goes over a letter that must be next.
    #[inline]
    pub(super) fn expect(&mut self, letter: u8, what: &str) -> Result<(), String> {
        if self.peek() == Some(letter) {
            self.at += 1;
            return Ok(());
        }
        Err(self.wrong(what))
    }

    /// A keyword.
    pub(super) fn keyword(&mut self) -> Result<&'a [u8], String> {
        self.blanks();
        let rest = &self.bytes[self.at.min(self.bytes.len())..];
        let end = rest
            .iter()
            .position(|b| !(b.is_ascii_alphanumeric() || matches!(b, b'_' | b'!')));
        let name = &rest[..end.unwrap_or(rest.len())];
        if name.is_empty() {
            return Err(self.wrong("a keyword"));
        }
        self.at += name.len();
        Ok(name)
    }

    /// The letters of a text, the cursor being at its first quote.
    pub(super) fn text(&mut self) -> Result<&'a [u8], String> {
        self.expect(b'\'', "a text")?;
        let start = self.at;
        loop {
            match self.bytes.get(self.at) {
                Some(b'\'') if self.bytes.get(self.at + 1) == Some(&b'\'') => self.at += 2,
                Some(b'\'') => break,
                Some(_) => self.at += 1,
                None => return Err("a text has no end".into()),
            }
        }
        self.at += 1;
        Ok(&self.bytes[start..self.at - 1])
    }

    /// A number, with or without a point.
    #[inline]
    pub(super) fn real(&mut self) -> Result<f64, String> {
        self.blanks();
        let start = self.at;
        let rest = &self.bytes[start.min(self.bytes.len())..];
        let unsigned = match rest {
            [b'-' | b'+', rest @ ..] => rest,
            rest => rest,
        };
        // The parser also takes `inf` and `nan`.
        if !matches!(unsigned.first(), Some(b'0'..=b'9' | b'.')) {
            return Err(self.wrong("a number"));
        }
        match fast_float2::parse_partial::<f64, _>(rest) {
            Ok((x, length)) if x.is_finite() => {
                self.at += length;
                Ok(x)
            }
            Ok(_) => Err(self.wrong("a number below 1.8e308")),
            Err(_) => Err(self.wrong("a number")),
        }
    }

    fn number(&mut self) -> Result<Value<'a>, String> {
        let start = self.at;
        let x = self.real()?;
        let digits = &self.bytes[start..self.at];
        let whole = digits
            .iter()
            .all(|b| b.is_ascii_digit() || matches!(b, b'-' | b'+'));
        let integer = std::str::from_utf8(digits)
            .ok()
            .and_then(|s| s.parse().ok());
        Ok(match integer {
            Some(i) if whole => Value::Int(i),
            _ => Value::Real(x),
        })
    }

    /// The number of a reference, the cursor being at its `#`.
    #[inline]
    pub(super) fn reference(&mut self) -> Result<u64, String> {
        self.expect(b'#', "a reference")?;
        let (start, mut id) = (self.at, 0u64);
        while let Some(d) = self.bytes.get(self.at).filter(|b| b.is_ascii_digit()) {
            let next = id
                .checked_mul(10)
                .and_then(|n| n.checked_add(u64::from(d - b'0')));
            id = next.ok_or("a reference to a number that is too large")?;
            self.at += 1;
        }
        if self.at == start {
            return Err(self.wrong("a number after `#`"));
        }
        Ok(id)
    }

    /// One parameter.
    pub(super) fn value(&mut self, depth: usize) -> Result<Value<'a>, String> {
        match self.peek() {
            Some(b'#') => Ok(Value::Ref(self.reference()?)),
            Some(b'0'..=b'9' | b'-' | b'+') => self.number(),
            Some(b'\'') => Ok(Value::Text(self.text()?)),
            Some(b'(') => Ok(Value::List(self.list(depth + 1)?)),
            Some(b'$' | b'*') => {
                self.at += 1;
                Ok(Value::None)
            }
            Some(b'.') => {
                self.at += 1;
                let name = self.keyword()?;
                self.expect(b'.', "the point that ends an enumeration value")?;
                Ok(Value::Enum(name))
            }
            Some(b'"') => {
                let rest = &self.bytes[self.at + 1..];
                let end = rest.iter().position(|b| *b == b'"');
                self.at += 2 + end.ok_or("a binary number has no end")?;
                Ok(Value::None)
            }
            Some(b) if b.is_ascii_alphabetic() || b == b'!' => {
                let name = self.keyword()?;
                Ok(Value::Typed(name, self.list(depth + 1)?))
            }
            _ => Err(self.wrong("a parameter")),
        }
    }

    /// A list in parentheses.
    pub(super) fn list(&mut self, depth: usize) -> Result<Vec<Value<'a>>, String> {
        if depth > DEPTH {
            return Err(format!("lists inside lists more than {DEPTH} deep"));
        }
        self.expect(b'(', "`(`")?;
        let mut values = Vec::new();
        if self.peek() == Some(b')') {
            self.at += 1;
            return Ok(values);
        }
        loop {
            values.push(self.value(depth)?);
            match self.peek() {
                Some(b',') => self.at += 1,
                Some(b')') => {
                    self.at += 1;
                    return Ok(values);
                }
                _ => return Err(self.wrong("`,` or `)`")),
            }
        }
    }
}
