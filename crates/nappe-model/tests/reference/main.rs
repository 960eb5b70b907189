//! `docs/model-file.md` is made from the registry: this writes it (`cargo xtask docs`) or checks that it is up to date,
//! and that each of its snippets is a model without faults.

mod files;
mod snippets;

use nappe_model::registry::{self, Key, Kind, Need, Shape};
use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::Arc;
use std::{env, fs};

/// Set to write the page instead of checking it.
const WRITE: &str = "NAPPE_WRITE_DOCS";

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs/model-file.md")
}

#[test]
fn the_page_is_up_to_date() {
    let page = page();
    if env::var_os(WRITE).is_some() {
        fs::write(path(), page).expect("the folder docs");
    } else {
        let there = fs::read_to_string(path()).expect("docs/model-file.md");
        assert!(
            there == page,
            "docs/model-file.md is out of date: run `cargo xtask docs`"
        );
    }
}

#[test]
fn every_snippet_is_a_model_without_faults() {
    for (table, kinds) in [
        ("curves", registry::CURVES),
        ("surfaces", registry::SURFACES),
    ] {
        for kind in kinds {
            let snippet = snippets::of(table, kind.name);
            assert!(
                snippet.contains(&format!("kind = \"{}\"", kind.name)),
                "{snippet}"
            );
            let text = format!("nappe = 1\n{}\n{snippet}", snippets::SETTING);
            let read = nappe_model::parse_with(
                &text,
                kind.name,
                &Default::default(),
                Arc::new(files::Files),
            );
            if let Err(faults) = read {
                panic!("{faults}");
            }
        }
    }
    let whole = snippets::WHOLE;
    if let Err(faults) = nappe_model::parse(whole, "whole", &Default::default()) {
        panic!("{faults}");
    }
}

fn page() -> String {
    let mut page = String::from(
        "# The model file\n\nMade by `cargo xtask docs` from the list of kinds that the reader itself uses. A model is a \
         TOML file whose name ends in `.nappe.toml`. `nappe schema` prints a JSON Schema for editors.\n",
    );
    write!(page, "\n```toml\n{}```\n", snippets::WHOLE).expect("a string");
    page.push_str("\n## The file\n\n");
    keys(&mut page, registry::TOP, 0);
    page.push_str(
        "* `[params]`: numbers by name, each a number, an expression, or `{ value, min, max, doc }`.\n\
         * `[curves.NAME]`, `[surfaces.NAME]`: objects by name, each with a `kind`; see below.\n\
         * `[[checks]]`: claims that `nappe check` proves.\n",
    );
    keys(&mut page, registry::CHECK, 1);
    page.push_str(TEXT);
    write!(page, "```toml\n{}```\n", snippets::SETTING.trim_start()).expect("a string");
    for (table, title, kinds) in [
        ("curves", "Curves", registry::CURVES),
        ("surfaces", "Surfaces", registry::SURFACES),
    ] {
        write!(page, "\n## {title}\n").expect("a string");
        for kind in kinds {
            describe(&mut page, table, kind);
        }
    }
    page
}

/// What is common to all kinds.
const TEXT: &str = "
## Values

* A **number** is a TOML number or an expression in quotes: `\"radius * sqrt(2)\"`. Expressions have `+ - * / ^`,
  comparisons and `if(c, a, b)`, `sqrt exp ln abs min max sin cos tan asin acos atan atan2 sinh cosh tanh floor ceil`,
  `pi`, `tau`, `e` and the parameters. Numbers are at most 1e30: products of larger lengths would overflow. For the same
  reason no surface extends farther, or is smaller than 1e-30.
* An **angle** carries its unit: `\"45deg\"`, `\"0.5rad\"`, `\"1/4 turn\"`, and is at most 1000 turns.
* A **curve** is a name, a side of a surface such as `\"dome.south\"`, or a table with `kind`.
* **Sides**: `south` is v = 0, `north` v = 1, `west` u = 0, `east` u = 1. South and north run along u, west and east
  along v.
* Every curve and surface may have `construction_only = true`: it is built, but not put out.

The snippets below are parts of a model that also has

";

fn describe(page: &mut String, table: &str, kind: &Kind) {
    write!(page, "\n### `{}`\n\n{}.\n\n", kind.name, upper(kind.doc)).expect("a string");
    keys(page, kind.keys, 0);
    let snippet = snippets::of(table, kind.name);
    write!(page, "\n```toml\n{snippet}```\n").expect("a string");
}

fn upper(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map_or_else(String::new, |c| c.to_uppercase().chain(letters).collect())
}

fn keys(page: &mut String, keys: &[Key], depth: usize) {
    let several = keys.iter().any(|k| matches!(k.need, Need::Form(_)));
    for key in keys {
        let need = match key.need {
            Need::Required => String::new(),
            Need::Optional(default) => format!(" *Default: {default}.*"),
            Need::Form(n) if several => format!(" *Form {}.*", n + 1),
            Need::Form(_) => String::new(),
        };
        let indent = "  ".repeat(depth);
        writeln!(
            page,
            "{indent}* `{}`: {} — {}.{need}",
            key.name,
            key.shape.describe(),
            key.doc
        )
        .expect("a string");
        nested(page, &key.shape, depth + 1);
    }
}

/// The keys of the tables that a shape may be.
fn nested(page: &mut String, shape: &Shape, depth: usize) {
    match shape {
        Shape::Record(inner) => keys(page, inner, depth),
        Shape::Either(shapes) => shapes.iter().for_each(|s| nested(page, s, depth)),
        Shape::List(item, _) | Shape::Grid(item, _) => nested(page, item, depth),
        _ => {}
    }
}
