//! Texts: quotes are doubled, and letters beyond ASCII are written as escapes.

/// The text between two quotes, escapes resolved (`\X2\…\X0\`, `\X4\…\X0\`, `\X\hh`, `\S\c`, `\\`). Bytes beyond ASCII, which
/// the standard does not allow, are taken as UTF-8, else as Latin 1. A broken escape stays as it is.
pub(super) fn decode(raw: &[u8]) -> String {
    let raw: String = match std::str::from_utf8(raw) {
        Ok(s) => s.to_owned(),
        Err(_) => raw.iter().map(|b| char::from(*b)).collect(),
    };
    let raw = raw.replace("''", "'");
    if !raw.contains('\\') {
        return raw;
    }
    let mut out = String::with_capacity(raw.len());
    let mut rest = raw.as_str();
    while let Some(at) = rest.find('\\') {
        out.push_str(&rest[..at]);
        rest = &rest[at..];
        match escape(rest) {
            Some((text, length)) => {
                out.push_str(&text);
                rest = &rest[length..];
            }
            None => {
                out.push('\\');
                rest = &rest[1..];
            }
        }
    }
    out.push_str(rest);
    out
}

/// What the escape at the beginning stands for, and how long it is.
fn escape(s: &str) -> Option<(String, usize)> {
    if s.starts_with("\\\\") {
        return Some(("\\".into(), 2));
    }
    for (start, digits) in [("\\X2\\", 4), ("\\X4\\", 8)] {
        if let Some(rest) = s.strip_prefix(start) {
            let hex = &rest[..rest.find("\\X0\\")?];
            let length = start.len() + hex.len() + 4;
            return Some((wide(hex, digits)?, length));
        }
    }
    if let Some(rest) = s.strip_prefix("\\X\\") {
        let code = u8::from_str_radix(rest.get(..2)?, 16).ok()?;
        return Some((char::from(code).into(), 5));
    }
    if let Some(rest) = s.strip_prefix("\\S\\") {
        let c = rest.chars().next().filter(char::is_ascii)?;
        return Some((char::from(c as u8 | 0x80).into(), 4));
    }
    // A choice of the alphabet for `\S\`: all but the first are out of use.
    let page = s.strip_prefix("\\P")?;
    (page.as_bytes().get(1) == Some(&b'\\')).then(|| (String::new(), 4))
}

/// Letters of four or eight hexadecimal digits each.
fn wide(hex: &str, digits: usize) -> Option<String> {
    if !hex.is_ascii() || !hex.len().is_multiple_of(digits) {
        return None;
    }
    let codes: Option<Vec<u32>> = (0..hex.len() / digits)
        .map(|i| u32::from_str_radix(&hex[i * digits..(i + 1) * digits], 16).ok())
        .collect();
    if digits == 4 {
        let units: Option<Vec<u16>> = codes?.into_iter().map(|c| u16::try_from(c).ok()).collect();
        return String::from_utf16(&units?).ok();
    }
    codes?.into_iter().map(char::from_u32).collect()
}

#[cfg(test)]
mod tests {
    use super::decode;

    #[test]
    fn escapes_stand_for_letters() {
        assert_eq!(decode(b"it''s \\\\ \\X\\E4"), "it's \\ \u{e4}");
        assert_eq!(decode(b"\\X2\\03C00041\\X0\\!"), "\u{3c0}A!");
        assert_eq!(decode(b"\\X4\\0001F600\\X0\\"), "\u{1f600}");
        assert_eq!(decode(b"\\X2\\D83DDE00\\X0\\"), "\u{1f600}");
        assert_eq!(decode(b"\\PA\\\\S\\d"), "\u{e4}");
        assert_eq!(decode("\u{e4}".as_bytes()), "\u{e4}");
        assert_eq!(decode(b"\xe4"), "\u{e4}");
    }

    #[test]
    fn broken_escapes_stay() {
        for raw in [
            "\\X2\\03C",
            "\\X2\\03\\X0\\",
            "\\X\\Z",
            "\\",
            "\\Q",
            "\\P",
            "\\S\\",
        ] {
            assert_eq!(decode(raw.as_bytes()), raw);
        }
    }
}
