//! How fast large STEP files are written and read, beside what the machine needs for their bytes alone and beside another
//! kernel, all in one run.
//!
//! `cargo xtask bench [--json FILE] [--page] T9`. The file has 1000 bicubic faces, the surface of `bench/inputs/bicubic.json` at
//! 1000 places. *Limit* of writing is a file of the same bytes, forced to the disk as ours is; of reading it is one search
//! through the bytes for semicolons. Figures are the least of several runs. `--page` writes the section of
//! `docs/performance.md`.

#![allow(clippy::unwrap_used, missing_docs)]

use nappe::body::sew;
use nappe::surface::SurfaceRef;
use nappe::{DVec3, NurbsSurface, Units};
use nappe_exchange::step::{self, Schema, StepOptions};
use nappe_exchange::{Document, Item, ItemForm};
use serde_json::{Value, json};
use std::fs::{self, File};
use std::hint::black_box;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Instant;

/// Faces of the file.
const FACES: usize = 1000;
/// Runs of which the least counts.
const RUNS: usize = 5;
const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/performance.md");
const TITLE: &str = "\n## Files\n";

/// One task.
struct Row {
    task: &'static str,
    kind: String,
    /// Nanoseconds a face, the least that is needed, and other kernels.
    ns: f64,
    limit: f64,
    peers: Vec<(String, f64)>,
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let flag = |name: &str| args.iter().any(|a| a == name);
    let file = args
        .iter()
        .position(|a| a == "--json")
        .map(|i| &args[i + 1]);
    let named = |a: &&String| !a.starts_with("--") && Some(*a) != file;
    let mut names = args.iter().filter(named).peekable();
    if names.peek().is_some() && !names.any(|n| "T9".starts_with(n.as_str())) {
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    let mut rows = measured(dir.path());
    peers(&mut rows, dir.path());
    let text = table(&rows);
    print!("{text}");
    if let Some(path) = file {
        let mut out = File::options()
            .create(true)
            .append(true)
            .open(path)
            .unwrap();
        for r in &rows {
            let peers: serde_json::Map<String, Value> =
                r.peers.iter().map(|p| (p.0.clone(), json!(p.1))).collect();
            let row = json!({"task": r.task, "kind": r.kind, "n": FACES, "ns_per_item": r.ns, "limit_ns": r.limit,
                "ratio_to_limit": r.ns / r.limit, "peers": peers});
            writeln!(out, "{row}").unwrap();
        }
    }
    if flag("--page") {
        let page = fs::read_to_string(PAGE).unwrap();
        let before = page.find(TITLE).map_or(page.as_str(), |at| &page[..at]);
        fs::write(PAGE, format!("{before}{}", section(&text))).unwrap();
    }
}

/// The least time of some runs, nanoseconds for each of `n` items. The first run, which finds cold caches, does not count.
fn best(runs: usize, n: usize, mut f: impl FnMut()) -> f64 {
    f();
    let time = |_| {
        let start = Instant::now();
        f();
        start.elapsed().as_secs_f64() * 1e9 / n as f64
    };
    (0..runs).map(time).fold(f64::INFINITY, f64::min)
}

/// The surface of the inputs, somewhere along x.
fn faces() -> Document {
    let text = include_str!("../../../../bench/inputs/bicubic.json");
    let input: Value = serde_json::from_str(text).unwrap();
    let numbers = |v: &Value| -> Vec<f64> {
        v.as_array()
            .unwrap()
            .iter()
            .map(|x| x.as_f64().unwrap())
            .collect()
    };
    let rows = input["points"].as_array().unwrap();
    let points: Vec<DVec3> = rows
        .iter()
        .flat_map(|row| row.as_array().unwrap())
        .map(|p| DVec3::from_slice(&numbers(p)))
        .collect();
    let knots = [numbers(&input["knots_u"]), numbers(&input["knots_v"])];
    let item = |i: usize| {
        let moved: Vec<DVec3> = points
            .iter()
            .map(|p| *p + DVec3::X * (20.0 * i as f64))
            .collect();
        let surface = NurbsSurface::new([3, 3], knots.clone(), &moved, None).unwrap();
        let surface: SurfaceRef = Arc::new(surface);
        let body = sew(&[surface], 1e-9).body;
        Item {
            name: String::new(),
            colour: None,
            form: ItemForm::Body {
                body,
                faces: Vec::new(),
            },
        }
    };
    Document {
        units: Units::Millimetre,
        items: (0..FACES).map(item).collect(),
        ..Document::default()
    }
}

fn measured(dir: &Path) -> Vec<Row> {
    let document = faces();
    let path = dir.join("t9.step");
    let options = StepOptions {
        schema: Schema::Ap242,
        tolerance: 1e-6,
    };
    let write = best(RUNS, FACES, || {
        step::write(&path, &document, &options).unwrap();
    });
    let bytes = fs::read(&path).unwrap();
    let plain = dir.join("plain");
    let plain = best(RUNS, FACES, || {
        let mut out = File::create(&plain).unwrap();
        out.write_all(&bytes).unwrap();
        out.sync_all().unwrap();
    });
    let [read, pass] = reading(&path, &bytes);
    let size = bytes.len() as f64 / 1e6;
    let row = |task, what: &str, ns, limit| Row {
        task,
        kind: format!("STEP {what}, {FACES} bicubic faces, {size:.0} MB"),
        ns,
        limit,
        peers: Vec::new(),
    };
    vec![
        row("T9 out", "out", write, plain),
        row("T9 in", "in", read, pass),
    ]
}

/// What it takes to read a file, and to search through its bytes for semicolons.
fn reading(path: &Path, bytes: &[u8]) -> [f64; 2] {
    let read = best(RUNS, FACES, || {
        drop(black_box(step::read(&fs::read(path).unwrap()).unwrap()))
    });
    let pass = best(RUNS, FACES, || {
        black_box(black_box(bytes).iter().filter(|b| **b == b';').count());
    });
    [read, pass]
}

/// What Open CASCADE takes for the same faces, where it is installed, and what we take for its file.
fn peers(rows: &mut Vec<Row>, dir: &Path) {
    let python = std::env::var("NAPPE_PEERS_PYTHON").unwrap_or_else(|_| "python3".into());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../bench/peers.py");
    let theirs = dir.join("theirs.step");
    let output = Command::new(&python)
        .args([script, "files"])
        .arg(&theirs)
        .stderr(Stdio::inherit())
        .output();
    let Ok(output) = output else {
        return eprintln!("other libraries: skipped, {python} cannot be run");
    };
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let Ok(figure) = serde_json::from_str::<Value>(line) else {
            continue;
        };
        if let Some(row) = rows.iter_mut().find(|r| figure["task"] == r.task) {
            let name = figure["peer"].as_str().unwrap_or_default().to_owned();
            row.peers
                .push((name, figure["ns_per_item"].as_f64().unwrap_or(f64::NAN)));
        }
    }
    let Ok(bytes) = fs::read(&theirs) else {
        return;
    };
    let [read, pass] = reading(&theirs, &bytes);
    let size = bytes.len() as f64 / 1e6;
    let kind = format!("STEP in, the same as the other kernel writes it, {size:.0} MB");
    let peers = rows
        .iter()
        .find(|r| r.task == "T9 in")
        .map_or(Vec::new(), |r| r.peers.clone());
    rows.push(Row {
        task: "T9 in",
        kind,
        ns: read,
        limit: pass,
        peers,
    });
}

/// Seconds of all faces.
fn seconds(ns: f64) -> String {
    format!("{:.3}", ns * FACES as f64 / 1e9)
}

fn table(rows: &[Row]) -> String {
    let mut text = String::from(
        "| task | kind | s | limit, s | × limit | others, s (times ours) |\n|---|---|--:|--:|--:|---|\n",
    );
    for r in rows {
        let peers: Vec<String> = r
            .peers
            .iter()
            .map(|(name, ns)| format!("{name} {} ({:.1}×)", seconds(*ns), ns / r.ns))
            .collect();
        text += &format!(
            "| {} | {} | {} | {} | {:.1} | {} |\n",
            r.task,
            r.kind,
            seconds(r.ns),
            seconds(r.limit),
            r.ns / r.limit,
            peers.join(", ")
        );
    }
    text
}

fn section(table: &str) -> String {
    format!(
        "{TITLE}\n{table}\nThe surface of the shared inputs at {FACES} places, on all cores; files are forced to the disk and replace \
         the old one only when they are whole. *Limit* is a file of the same bytes, also forced to the disk, or one search through \
         the bytes for semicolons.\n"
    )
}
