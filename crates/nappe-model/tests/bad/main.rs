//! Every bad input: the place, the words and the remedy of its message.

mod curves;
mod drawing;
mod file;
mod limits;
mod references;
mod surfaces;

use nappe_model::{Diagnostics, Overrides, parse};

fn faults(text: &str) -> Diagnostics {
    match parse(text, "bad.nappe.toml", &Overrides::default()) {
        Err(d) => d,
        Ok(_) => panic!("accepted:\n{text}"),
    }
}

/// The text after `nappe = 1` (so its first line is line 2), the line and column of the message, words of the message,
/// and words of the remedy.
type Row = (
    &'static str,
    (usize, usize),
    &'static [&'static str],
    &'static str,
);

/// Every fault has its place, its numbers and its remedy.
fn check(rows: &[Row]) {
    // All rows are tried, so that a change shows everything that it touches.
    let mut wrong = Vec::new();
    for (text, (line, column), words, remedy) in rows {
        let d = faults(&format!("nappe = 1\n{text}"));
        let place = format!("bad.nappe.toml:{line}:{column}");
        let at: Vec<_> = d.list.iter().filter(|x| d.place(x) == place).collect();
        let fits = at.iter().any(|x| {
            let help = x.help.as_deref().unwrap_or_default();
            words.iter().all(|w| x.message.contains(w)) && help.contains(remedy)
        });
        let helped = d
            .list
            .iter()
            .all(|x| x.help.as_ref().is_some_and(|h| !h.is_empty()));
        if !fits || !helped {
            wrong.push(format!(
                "expected {place} with {words:?} and {remedy:?}, got\n{d}\nin\n{text}\n"
            ));
        }
    }
    assert!(
        wrong.is_empty(),
        "{} rows:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}
