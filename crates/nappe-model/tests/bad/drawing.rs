//! How faults are drawn.

use crate::faults;
use nappe_model::RenderStyle;

#[test]
fn drawings_show_file_line_column_and_the_line() {
    let d = faults("nappe = 1\n[curves.c]\nkind = \"lime\"\n");
    let plain = d.render(RenderStyle::default());
    for words in [
        "bad.nappe.toml:3:8",
        "kind = \"lime\"",
        "there is no kind \"lime\"",
        "did you mean \"line\"?",
        "1 error",
    ] {
        assert!(plain.contains(words), "{words} in\n{plain}");
    }
    assert!(plain.is_ascii(), "{plain}");
    let color = d.render(RenderStyle {
        color: true,
        unicode: true,
        width: 60,
    });
    assert!(color.contains('\u{1b}') && color.contains('╭'));
    assert_eq!(
        plain,
        d.render(RenderStyle::default()),
        "the same input gives the same text"
    );
}

/// Of a long line the part around the place is drawn, and the place is still that in the file.
#[test]
fn long_lines_are_drawn_in_part() {
    let many = vec!["0.125"; 50_000].join(", ");
    let text = format!(
        "nappe = 1\n[curves.c]\nkind = 'nurbs'\ndegree = 1\npoints = [[0,0,0],[1,0,0]]\nknots = [{many}, oops, {many}]\n"
    );
    let at = text.lines().nth(5).unwrap().find("oops").unwrap() + 1;
    let plain = faults(&text.replace("oops", "'oops'")).render(RenderStyle::default());
    // The place is inside the quotes.
    assert!(
        plain.contains(&format!("bad.nappe.toml:6:{}]", at + 1)),
        "{plain}"
    );
    assert!(plain.contains("0.125, 'oops', 0.125"), "{plain}");
    assert!(plain.len() < 2000, "{} bytes", plain.len());
}

/// Two places far apart in one line, as in a file without line breaks, are drawn one after the other.
#[test]
fn places_far_apart_in_one_line_are_drawn_apart() {
    let blank = " ".repeat(20_000);
    let line = |from: &str, to: &str| format!("{{kind='line',from={from},to={to}}}");
    let text = format!(
        "nappe = 1\nsurfaces = {{s={{kind='coons',south={},{blank}north={},west={},east={}}}}}\n",
        line("[0,0,0]", "[1,0,0]"),
        line("[0,1,0]", "[1,1,9]"),
        line("[0,0,0]", "[0,1,0]"),
        line("[1,0,0]", "[1,1,0]"),
    );
    let d = faults(&text);
    let plain = d.render(RenderStyle::default());
    assert!(
        plain.contains("`north`") && plain.contains("`east`"),
        "{plain}"
    );
    assert!(plain.len() < 3000, "{} bytes:\n{plain}", plain.len());
}

/// A list over very many lines is shown by its first.
#[test]
fn long_places_are_shown_by_their_first_line() {
    let rows = vec!["  [0, 0, 0],"; 1000].join("\n");
    let d = faults(&format!(
        "nappe = 1\n[curves.c]\nkind = 'line'\nfrom = [\n{rows}\n]\nto = [1, 0, 0]\n"
    ));
    let plain = d.render(RenderStyle::default());
    assert!(plain.contains("bad.nappe.toml:4:8]"), "{plain}");
    assert!(plain.lines().count() < 30, "{plain}");
}
