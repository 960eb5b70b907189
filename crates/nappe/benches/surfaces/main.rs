//! How fast the kernel is, beside the time to write the result to memory, a plain loop over single points, and what
//! other libraries take, all in one run.
//!
//! `cargo xtask bench [--quick] [--json FILE] [--page] [--growth] [NAME…]`. Each figure is the best of several runs, so that other
//! processes disturb it least. Only ratios mean something: machines and minutes differ. `--page` writes
//! `docs/performance.md` and its plots; `--growth` only prints how cost grows.
//!
//! Tasks that write a result are measured twice beside writing it: to memory (in the JSON `ns_per_item`, `limit_ns` and
//! `ratio_to_limit`), and to a place that stays in the last-level cache, if it is large enough (`ns_in_cache` and
//! `ratio_in_cache`). How fast memory is decides the first ratio, how fast the cache is the second.

#![allow(clippy::unwrap_used, missing_docs)]

mod cases;
mod clock;
mod memory;
mod page;
mod peers;
mod plot;
mod scaling;
mod tasks;

use std::fs::File;
use std::io::{BufWriter, Write};
use tasks::Row;

fn main() {
    let args: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    if let [scaling::ALONE, n, tol] = args.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        return scaling::mesh_alone(n.parse().unwrap(), tol.parse().unwrap());
    }
    let flag = |name: &str| args.iter().any(|a| a == name);
    let file = args
        .iter()
        .position(|a| a == "--json")
        .map(|i| args.get(i + 1).expect("--json FILE").clone());
    let names: Vec<&str> = args
        .iter()
        .filter(|a| !a.starts_with("--") && Some(*a) != file.as_ref())
        .map(String::as_str)
        .collect();
    let quick = flag("--quick");
    if flag("--growth") {
        let plots = scaling::measure(quick, &names);
        plots.iter().for_each(|p| print!("\n{}", page::growth(p)));
        return;
    }
    let mut rows = tasks::all(quick, &names);
    peers::add(&mut rows);
    print!("{}", table(&rows));
    if let Some(file) = file {
        let mut out = BufWriter::new(File::create(&file).expect("the file of --json can be made"));
        for row in &rows {
            writeln!(out, "{}", row.json()).unwrap();
        }
    }
    if flag("--page") {
        page::write(&rows, &scaling::measure(quick, &[]));
    }
}

/// The rows as plain text.
fn table(rows: &[Row]) -> String {
    let mut text = format!(
        "{:6} {:24} {:>9} {:>9} {:>9} {:>7} {:>9} {:>7} {:>9} {:>7}  peers\n",
        "task", "kind", "n", "ns/item", "limit", "×limit", "in cache", "×limit", "plain", "×plain"
    );
    for r in rows {
        let or_none = |x: Option<f64>| x.map_or(String::new(), number);
        let peers: Vec<String> = r
            .peers
            .iter()
            .map(|(name, ns)| format!("{name} {} ({}×)", number(*ns), number(ns / r.ns)))
            .collect();
        text += &format!(
            "{:6} {:24} {:9} {:>9} {:>9} {:>7} {:>9} {:>7} {:>9} {:>7}  {}\n",
            r.task,
            r.kind,
            r.n,
            number(r.ns),
            or_none(r.limit),
            or_none(r.ratio()),
            or_none(r.cached.map(|c| c[0])),
            or_none(r.ratio_in_cache()),
            or_none(r.plain),
            or_none(r.plain.map(|p| p / r.ns)),
            peers.join(", ")
        );
    }
    text
}

/// Three digits, as many as a figure of this kind is worth.
fn number(x: f64) -> String {
    match x {
        x if x >= 100.0 => format!("{x:.0}"),
        x if x >= 10.0 => format!("{x:.1}"),
        x => format!("{x:.2}"),
    }
}
