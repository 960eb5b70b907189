//! The page `docs/sources.md` names types, examples and tests: this holds it to what is there.

use crate::root;
use std::fs;

/// Every link of a page as (text, target).
fn links(page: &str) -> Vec<(&str, &str)> {
    let mut links = Vec::new();
    let mut rest = page;
    while let Some(i) = rest.find("](") {
        let text = rest[..i].rfind('[').map_or("", |k| &rest[k + 1..i]);
        let tail = &rest[i + 2..];
        let end = tail.find(')').unwrap_or(tail.len());
        links.push((text, &tail[..end]));
        rest = &tail[end..];
    }
    links
}

/// Whether Rust code defines a function or type of this name.
fn defines(code: &str, name: &str) -> bool {
    ["fn ", "struct ", "enum ", "trait "].iter().any(|word| {
        let head = format!("{word}{name}");
        code.match_indices(&head).any(|(i, _)| {
            let after = code[i + head.len()..].chars().next();
            !after.is_some_and(|c| c.is_alphanumeric() || c == '_')
        })
    })
}

fn read(path: &str) -> String {
    let path = root().join(path);
    fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

#[test]
fn every_row_names_what_is_there() {
    let page = read("docs/sources.md");
    let links = links(&page);
    assert!(links.len() > 150, "{} links only", links.len());
    for (text, target) in links {
        let content = read(&format!("docs/{target}"));
        if let Some(name) = text.strip_prefix('`').and_then(|t| t.strip_suffix('`')) {
            assert!(
                defines(&content, name),
                "docs/sources.md: {target} has no `{name}`"
            );
        } else if let Some(file) = target.strip_prefix("../examples/") {
            assert_eq!(file, format!("{text}.nappe.toml"), "docs/sources.md");
        }
    }
}

/// What the page calls a test is one: its last column links to functions marked `#[test]`, or to property tests.
#[test]
fn the_last_column_holds_tests() {
    let page = read("docs/sources.md");
    let rows = page
        .lines()
        .filter(|l| l.starts_with("| ") && l.matches(" | ").count() == 3);
    let mut tests = 0;
    for row in rows {
        let last = row.rsplit(" | ").next().unwrap_or_default();
        for (text, target) in links(last) {
            let name = text.trim_matches('`');
            let content = read(&format!("docs/{target}"));
            let at = content.find(&format!("fn {name}("));
            let before = at.map_or("", |i| &content[..i]).trim_end();
            assert!(
                before.ends_with("#[test]"),
                "{target}: `{name}` is not a test"
            );
            tests += 1;
        }
    }
    assert!(tests > 70, "{tests} tests only");
}

#[test]
fn every_example_is_bundled_and_in_the_gallery() {
    let bundled = read("crates/nappe-cli/src/commands/examples.rs");
    let gallery = read("docs/gallery.md");
    let files = fs::read_dir(root().join("examples")).expect("the folder of examples");
    let mut names: Vec<String> = files
        .filter_map(|f| f.ok()?.file_name().into_string().ok())
        .filter_map(|f| Some(f.strip_suffix(".nappe.toml")?.to_owned()))
        .collect();
    names.sort();
    assert!(names.len() > 20, "{names:?}");
    for name in names {
        assert!(
            bundled.contains(&format!("    \"{name}\",")),
            "{name} is not bundled"
        );
        assert!(
            gallery.contains(&format!("examples/{name}.nappe.toml")),
            "{name} has no picture"
        );
    }
}

#[test]
fn pictures_of_the_pages_exist() {
    for page in ["README.md", "docs/gallery.md"] {
        let text = read(page);
        let folder = if page.starts_with("docs/") {
            "docs/"
        } else {
            ""
        };
        for (_, target) in links(&text).into_iter().filter(|(_, t)| !t.contains("://")) {
            let path = root().join(format!("{folder}{target}"));
            assert!(path.exists(), "{page}: {target} is not there");
        }
    }
}
