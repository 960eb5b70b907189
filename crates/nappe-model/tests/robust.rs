//! Any text gives a model or faults, never a panic; faults can always be drawn.

use nappe_model::{Overrides, RenderStyle, parse, registry};
use proptest::prelude::*;

/// All example models: what mutations start from.
fn examples() -> Vec<(String, String)> {
    let dir = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let mut all: Vec<_> = std::fs::read_dir(dir)
        .expect("the folder of examples")
        .filter_map(|e| {
            let path = e.ok()?.path();
            let name = path.file_name()?.to_string_lossy().into_owned();
            name.ends_with(".nappe.toml")
                .then(|| Some((name, std::fs::read_to_string(&path).ok()?)))
                .flatten()
        })
        .collect();
    all.sort();
    all
}

fn survives(text: &str) {
    if let Err(d) = parse(text, "any.nappe.toml", &Overrides::default()) {
        assert!(d.has_errors() && !d.render(RenderStyle::default()).is_empty());
        assert!(d.list.iter().all(|x| x.help.is_some()), "{d}");
    }
}

/// Pieces that mutations insert: what the format gives a meaning, and what hurts.
const PIECES: &[&str] = &[
    "nan",
    "inf",
    "-1",
    "0",
    "1e308",
    "1e-308",
    "-0.0",
    "[",
    "]",
    "{",
    "}",
    "\"",
    "'",
    "=",
    ",",
    "\n",
    "#",
    "[[",
    "\"t\"",
    "\"1/0\"",
    "\"9^9^9\"",
    "\"u\"",
    "\"0deg\"",
    "\"1e9turn\"",
    "[0, 0, 0]",
    "[]",
    "{}",
    "true",
    "é",
    "\u{0}",
    "kind = \"reverse\"\n",
    "kind = \"join\"\n",
    "degree = 64\n",
    "closed = true\n",
    "1979-05-27",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn any_text_is_read_or_refused(text in "\\PC{0,200}") {
        survives(&text);
        survives(&format!("nappe = 1\n{text}"));
    }

    #[test]
    fn any_toml_like_text_is_read_or_refused(text in "[a-z\\[\\]{}=,.'\" \n0-9-]{0,200}") {
        survives(&format!("nappe = 1\n[curves.a]\n{text}"));
    }

    /// Examples with bytes cut out, repeated and replaced.
    #[test]
    fn damaged_examples_are_read_or_refused(
        which in 0usize..100,
        cuts in prop::collection::vec((0.0f64..1.0, 0usize..30, prop::sample::select(PIECES)), 1..6),
    ) {
        let all = examples();
        let mut text = all[which % all.len()].1.clone();
        for (at, len, piece) in cuts {
            let mut from = (at * text.len() as f64) as usize;
            while !text.is_char_boundary(from) {
                from -= 1;
            }
            let mut to = (from + len).min(text.len());
            while !text.is_char_boundary(to) {
                to += 1;
            }
            text.replace_range(from..to, piece);
        }
        survives(&text);
    }

    /// Examples with single numbers replaced: they parse, and reach the geometry.
    #[test]
    fn examples_with_other_numbers_are_built_or_refused(
        which in 0usize..100,
        picks in prop::collection::vec((0usize..10_000, prop::sample::select(&["0", "-1", "1", "1e300", "1e-300", "-1e9", "3.5"][..])), 1..4),
    ) {
        let all = examples();
        let text = &all[which % all.len()].1;
        let mut words: Vec<String> = text.split_inclusive([' ', ',', '[', ']', '\n', '"']).map(String::from).collect();
        let is_number = |w: &String| w.starts_with(|c: char| c.is_ascii_digit() || c == '-');
        let numbers: Vec<usize> = (1..words.len()).filter(|&i| is_number(&words[i])).collect();
        for (i, new) in picks {
            if numbers.is_empty() {
                break;
            }
            let word = &mut words[numbers[i % numbers.len()]];
            let end: String = word.chars().rev().take(1).filter(|c| !c.is_alphanumeric()).collect();
            *word = format!("{new}{end}");
        }
        survives(&words.concat());
    }
}

/// Each kind with each key left out, and given each wrong value.
#[test]
fn keys_of_any_value_are_read_or_refused() {
    for (table, kinds) in [
        ("curves", registry::CURVES),
        ("surfaces", registry::SURFACES),
    ] {
        for kind in kinds {
            for key in kind.keys {
                for value in PIECES {
                    survives(&format!(
                        "nappe = 1\n[{table}.x]\nkind = \"{}\"\n{} = {value}\n",
                        kind.name, key.name
                    ));
                }
            }
        }
    }
}

#[test]
fn examples_have_no_faults() {
    for (name, text) in examples() {
        if let Err(d) = parse(&text, &name, &Overrides::default()) {
            panic!("{d}");
        }
    }
}
