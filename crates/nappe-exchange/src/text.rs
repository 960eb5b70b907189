//! Numbers and names as text.

use glam::DVec3;
use nappe::mesh::Certainty;

/// The shortest decimal that reads back as the same number.
pub(crate) fn number(x: f64) -> String {
    // Debug, unlike Display, writes very large and small numbers with an exponent.
    let s = format!("{x:?}");
    s.strip_suffix(".0").map(str::to_owned).unwrap_or(s)
}

/// Three numbers with blanks between.
pub(crate) fn triple(p: DVec3) -> String {
    format!("{} {} {}", number(p.x), number(p.y), number(p.z))
}

/// Text as an XML attribute or element holds it; characters that XML has no place for become `�`.
pub(crate) fn xml(s: &str) -> String {
    let mut out = String::with_capacity(s.len());
    for c in s.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&apos;"),
            '\n' => out.push_str("&#10;"),
            '\r' => out.push_str("&#13;"),
            '\t' => out.push_str("&#9;"),
            '\0'..='\x1f' | '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// A name on one line without blanks, for formats that end names at a blank.
pub(crate) fn word(s: &str) -> String {
    let w: String = s
        .chars()
        .map(|c| {
            if c.is_whitespace() || c.is_control() {
                '_'
            } else {
                c
            }
        })
        .collect();
    if w.is_empty() { "_".into() } else { w }
}

/// A name on one line.
pub(crate) fn line(s: &str) -> String {
    s.chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect()
}

/// How far the mesh is from the surfaces, for comments.
pub(crate) fn certainty(c: Certainty, unit: &str) -> String {
    match c {
        Certainty::Exact => "exact".into(),
        Certainty::Bounded(e) => format!("proven deviation at most {} {unit}", number(e)),
        Certainty::Estimated(e) => format!("estimated deviation {} {unit}", number(e)),
    }
}

/// An sRGB channel as a byte.
pub(crate) fn byte(x: f32) -> u8 {
    (x.clamp(0.0, 1.0) * 255.0).round() as u8
}
