//! Entities as text.

use glam::DVec3;
use std::io::{self, Write};

/// Bytes gathered before they are handed on.
const PART: usize = 1 << 16;

/// Writes entities one after the other. Values are separated where they follow each other.
pub(super) struct Out<'w> {
    to: &'w mut dyn Write,
    text: Vec<u8>,
    last: u64,
    number: zmij::Buffer,
    /// Whether all numbers were finite.
    finite: bool,
}

impl<'w> Out<'w> {
    pub(super) fn new(to: &'w mut dyn Write) -> Self {
        Out {
            to,
            text: Vec::with_capacity(2 * PART),
            last: 0,
            number: zmij::Buffer::new(),
            finite: true,
        }
    }

    /// Whether all numbers up to here were finite; others have no spelling, and what is written is then worth nothing.
    pub(super) fn is_finite(&self) -> bool {
        self.finite
    }

    /// Text outside entities.
    pub(super) fn raw(&mut self, text: &str) {
        self.text.extend_from_slice(text.as_bytes());
    }

    /// A whole entity.
    pub(super) fn whole(&mut self, entity: &str) -> io::Result<u64> {
        self.last += 1;
        let line = format!("#{}={entity};\n", self.last);
        self.raw(&line);
        self.pass_on()?;
        Ok(self.last)
    }

    /// Begins an entity: its keyword and, where `named`, an empty name.
    pub(super) fn open(&mut self, keyword: &str) -> &mut Self {
        self.last += 1;
        self.text.push(b'#');
        self.digits(self.last);
        self.text.push(b'=');
        self.raw(keyword);
        self.text.push(b'(');
        self
    }

    /// Ends an entity and gives its number.
    pub(super) fn close(&mut self) -> io::Result<u64> {
        self.raw(");\n");
        self.pass_on()?;
        Ok(self.last)
    }

    fn pass_on(&mut self) -> io::Result<()> {
        if self.text.len() >= PART {
            self.to.write_all(&self.text)?;
            self.text.clear();
        }
        Ok(())
    }

    pub(super) fn finish(mut self) -> io::Result<()> {
        self.to.write_all(&self.text)?;
        self.text.clear();
        self.to.flush()
    }

    fn comma(&mut self) {
        if self.text.last() != Some(&b'(') {
            self.text.push(b',');
        }
    }

    fn digits(&mut self, n: u64) {
        let (mut digits, mut at, mut n) = ([0u8; 20], 20, n);
        loop {
            at -= 1;
            digits[at] = b'0' + (n % 10) as u8;
            n /= 10;
            if n == 0 {
                break;
            }
        }
        self.text.extend_from_slice(&digits[at..]);
    }

    pub(super) fn reference(&mut self, id: u64) -> &mut Self {
        self.comma();
        self.text.push(b'#');
        self.digits(id);
        self
    }

    pub(super) fn count(&mut self, n: usize) -> &mut Self {
        self.comma();
        self.digits(n as u64);
        self
    }

    /// The shortest decimal that reads back as the same number, in the standard's spelling: `1.`, `2.5E-7`.
    pub(super) fn real(&mut self, x: f64) -> &mut Self {
        self.comma();
        if !x.is_finite() {
            self.finite = false;
            self.raw("0.");
            return self;
        }
        let digits = self.number.format_finite(x).as_bytes();
        let end = digits
            .iter()
            .position(|b| *b == b'e')
            .unwrap_or(digits.len());
        let (mantissa, exponent) = digits.split_at(end);
        let mantissa = mantissa.strip_suffix(b".0").unwrap_or(mantissa);
        self.text.extend_from_slice(mantissa);
        if !mantissa.contains(&b'.') {
            self.text.push(b'.');
        }
        if let Some(power) = exponent.get(1..) {
            self.text.push(b'E');
            self.text.extend_from_slice(power);
        }
        self
    }

    /// `.T.`, or another value of an enumeration, or `$` or `*`.
    pub(super) fn word(&mut self, word: &str) -> &mut Self {
        self.comma();
        self.raw(word);
        self
    }

    pub(super) fn flag(&mut self, yes: bool) -> &mut Self {
        self.word(if yes { ".T." } else { ".F." })
    }

    pub(super) fn text(&mut self, text: &str) -> &mut Self {
        self.comma();
        let text = encoded(text);
        self.raw(&text);
        self
    }

    /// Begins a list.
    pub(super) fn list(&mut self) -> &mut Self {
        self.comma();
        self.text.push(b'(');
        self
    }

    pub(super) fn end(&mut self) -> &mut Self {
        self.text.push(b')');
        self
    }

    pub(super) fn references(&mut self, ids: &[u64]) -> &mut Self {
        self.list();
        for id in ids {
            self.reference(*id);
        }
        self.end()
    }

    pub(super) fn reals(&mut self, values: impl IntoIterator<Item = f64>) -> &mut Self {
        self.list();
        for x in values {
            self.real(x);
        }
        self.end()
    }

    pub(super) fn point(&mut self, p: DVec3) -> io::Result<u64> {
        self.open("CARTESIAN_POINT")
            .text("")
            .reals(p.to_array())
            .close()
    }

    pub(super) fn direction(&mut self, d: DVec3) -> io::Result<u64> {
        self.open("DIRECTION").text("").reals(d.to_array()).close()
    }

    pub(super) fn placement(&mut self, origin: DVec3, z: DVec3, x: DVec3) -> io::Result<u64> {
        let origin = self.point(origin)?;
        let (z, x) = (self.direction(z)?, self.direction(x)?);
        self.open("AXIS2_PLACEMENT_3D")
            .text("")
            .reference(origin)
            .reference(z)
            .reference(x)
            .close()
    }
}

/// A text between quotes, letters beyond ASCII as escapes.
pub(super) fn encoded(text: &str) -> String {
    let mut out = String::from("'");
    let mut wide = false;
    for c in text.chars() {
        let plain = (' '..='~').contains(&c);
        if plain == wide {
            out.push_str(if plain { "\\X0\\" } else { "\\X2\\" });
            wide = !plain;
        }
        match c {
            '\'' => out.push_str("''"),
            '\\' => out.push_str("\\\\"),
            c if plain => out.push(c),
            c => {
                let mut units = [0; 2];
                for unit in c.encode_utf16(&mut units) {
                    out.push_str(&format!("{unit:04X}"));
                }
            }
        }
    }
    if wide {
        out.push_str("\\X0\\");
    }
    out.push('\'');
    out
}
