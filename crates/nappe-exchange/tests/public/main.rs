//! The public files of other systems, read, measured and meshed; and the table of them in `docs/exchange.md`, which
//! `cargo xtask docs` writes and this checks.

#![allow(clippy::unwrap_used)]

mod shape;
#[path = "../shared/mod.rs"]
mod shared;

use nappe::body;
use nappe::measure::Measured;
use nappe::mesh::MeshOptions;
use nappe::significant as number;
use nappe_exchange::{Document, ItemForm, Progress, Read, mesh_document};
use shared::shared;
use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

/// Set to write the page instead of checking it.
const WRITE: &str = "NAPPE_WRITE_DOCS";
/// What stands around the table.
const MARKS: [&str; 2] = [
    "<!-- table of public files: made by `cargo xtask docs` -->\n",
    "<!-- end of the table -->\n",
];

/// All STEP and IGES files, by folder and name.
fn files(shared: &Path) -> Vec<String> {
    let folders = fs::read_dir(shared).unwrap().map(|e| e.unwrap().path());
    let mut names = Vec::new();
    for folder in folders.filter(|f| f.is_dir()) {
        for file in fs::read_dir(&folder).unwrap() {
            let path = file.unwrap().path();
            let ending = path.extension().unwrap_or_default();
            if ["step", "stp", "iges", "igs"].iter().any(|e| ending == *e) {
                let name = path.strip_prefix(shared).unwrap();
                names.push(name.to_string_lossy().replace('\\', "/"));
            }
        }
    }
    names.sort();
    names
}

fn document(path: &Path) -> Document {
    match nappe_exchange::read(path).unwrap() {
        Read::Document(d) => d,
        Read::Mesh(_) => panic!("{}: a mesh", path.display()),
    }
}

/// The area of all bodies, what the solids enclose, and the number of solids and of faces.
fn figures(d: &Document) -> (Option<Measured>, Option<Measured>, usize, usize) {
    let (mut areas, mut volumes) = (Vec::new(), Vec::new());
    let (mut solids, mut faces) = (0, 0);
    for item in &d.items {
        let ItemForm::Body { body, .. } = &item.form else {
            continue;
        };
        let found = body::figures(body).unwrap();
        faces += body.faces.len();
        areas.extend(found.areas.into_iter().map(Result::ok));
        let closed = body.shells.iter().zip(found.volumes).filter(|s| s.0.closed);
        let before = volumes.len();
        volumes.extend(closed.map(|s| s.1));
        solids += usize::from(volumes.len() > before);
    }
    let sum = |all: Vec<Option<Measured>>| -> Option<Measured> {
        let all: Option<Vec<Measured>> = all.into_iter().collect();
        Some(all?.into_iter().sum())
    };
    (sum(areas), sum(volumes), solids, faces)
}

/// Digits of the figures in the table.
const DIGITS: usize = 6;

fn row(name: &str, d: &Document) -> String {
    let (area, volume, solids, faces) = figures(d);
    let made = mesh_document(d, None, Progress::default());
    let unit = d.units.symbol();
    let told = |m: Option<Measured>, power: &str| {
        m.map_or("not told".to_owned(), |m| {
            format!("{} {unit}{power}", number(m.value, DIGITS))
        })
    };
    let bodies = made.bodies;
    let sheets = bodies - solids;
    let mut out: Vec<String> = d
        .left_out
        .iter()
        .map(|l| format!("{} {}", l.count, l.what))
        .collect();
    if !made.missing.is_empty() {
        out.push(format!("{} faces without triangles", made.missing.len()));
    }
    let volume = if solids == 0 {
        String::new()
    } else {
        told(volume, "³")
    };
    let area = if bodies == 0 {
        String::new()
    } else {
        told(area, "²")
    };
    format!(
        "| `{name}` | {solids} | {sheets} | {} | {faces} | {area} | {volume} | {} |\n",
        made.scene.curves.len(),
        out.join(", ")
    )
}

#[test]
fn the_table_of_public_files_is_up_to_date() {
    let Some(shared) = shared() else {
        eprintln!("skipped: the public files are not beside the project");
        return;
    };
    let mut table = String::from(
        "| file | solids | sheets | curves | faces | area | volume | left out |\n|---|---|---|---|---|---|---|---|\n",
    );
    for name in files(&shared) {
        table
            .write_str(&row(&name, &document(&shared.join(&name))))
            .unwrap();
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/exchange.md");
    let page = fs::read_to_string(&path).unwrap();
    let (before, rest) = page.split_once(MARKS[0]).expect("the mark of the table");
    let (there, after) = rest.split_once(MARKS[1]).expect("the end of the table");
    if env::var_os(WRITE).is_some() {
        fs::write(&path, [before, MARKS[0], &table, MARKS[1], after].concat()).unwrap();
    } else {
        assert_eq!(
            there, table,
            "docs/exchange.md is out of date: run `cargo xtask docs`"
        );
    }
}

/// Every face has triangles; solids are watertight; area and volume of the triangles are those of the surfaces within what
/// their distance allows.
#[test]
fn triangles_of_public_files_are_those_of_their_surfaces() {
    let Some(shared) = shared() else {
        eprintln!("skipped: the public files are not beside the project");
        return;
    };
    for name in files(&shared) {
        let mut failed = 0;
        for item in document(&shared.join(&name)).items {
            let ItemForm::Body { body, .. } = item.form else {
                continue;
            };
            let what = format!("{name}: {}", item.name);
            let tol = 1e-3 * body::extent(&body).diagonal();
            let made = body::mesh(&body, &MeshOptions::with_tol(tol)).unwrap();
            failed += made.failed.len();
            if made.failed.is_empty() {
                shape::compare(&body, &made.mesh, &what);
            }
        }
        assert_eq!(failed, 0, "{name}: faces without triangles");
    }
}
