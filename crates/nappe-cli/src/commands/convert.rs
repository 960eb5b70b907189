//! `nappe convert`.

use super::closing;
use crate::failure::{Failure, Problem};
use crate::input;
use crate::output;
use crate::screen::Screen;
use crate::text::{Table, bytes, count};
use nappe_exchange::{
    Document, DocumentMesh, Format, LeftOut, Missing, Progress, Read, Scene, WriteOptions,
    WriteReport, mesh_document,
};
use std::path::PathBuf;
use std::time::Instant;

/// Convert a file: exact geometry to meshes, pictures, STEP and IGES, and meshes to meshes and pictures
///
/// Reads .stl .obj .ply .glb .gltf .3mf (meshes), .step .stp .igs .iges (exact geometry). The ending of the second file
/// says its format. Bodies become triangles within a proven distance, watertight along the edges that faces share, with
/// names, colours and units. What could not be taken over is told with its reason.
///
/// Faces and curves that get no triangles or lines, and geometry of the file that cannot be read, are named; the file
/// then holds the rest, and the exit code is 1.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  nappe convert part.step part.glb
  nappe convert part.step part.stl --tolerance 0.01
  nappe convert hull.iges hull.step
  nappe convert hull.iges hull.step --ap214
  nappe convert scan.stl scan.png")]
pub(crate) struct Args {
    /// The file to read
    #[arg(value_name = "IN")]
    input: PathBuf,

    /// The file to write
    #[arg(value_name = "OUT")]
    output: PathBuf,

    /// The greatest distance between triangles and surfaces, or between approximated and exact surfaces, in the unit of the
    /// file. Default: for triangles a thousandth of the diagonal of the box, else a micrometre
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = super::length)]
    tolerance: Option<f64>,

    /// Write a .step file by AP214, which older systems read, instead of AP242
    #[arg(long)]
    ap214: bool,
}

impl Args {
    pub(crate) fn run(&self, screen: &Screen) -> Result<(), Failure> {
        let start = Instant::now();
        let format = Format::from_path(&self.output).map_err(output::refused)?;
        output::check_ap214(self.ap214, format == Format::Step)?;
        output::check(&self.output)?;
        let read = input::read(&self.input, screen)?;
        let input = self.input.display();
        match read {
            Read::Mesh(m) if format.is_exact() || format == Format::Json => {
                let triangles = count(m.triangles());
                let what = format!("{input}: holds {triangles} triangles and no exact surfaces");
                Err(Problem::new(what)
                    .help("a mesh can be converted to other meshes and to pictures")
                    .into())
            }
            Read::Mesh(_) if self.tolerance.is_some() => Err(Failure::usage(format!(
                "--tolerance is for exact geometry: the triangles of {input} are taken as they are"
            ))),
            Read::Mesh(m) => {
                let missing = m.missing.iter().map(Problem::new).collect();
                self.plain(&m.to_scene(), &m.notes, missing, screen)
            }
            Read::Document(d) if format.is_exact() => {
                let (notes, missing) = lost(&d);
                self.plain(&exact(d), &notes, missing, screen)
            }
            Read::Document(_) if format == Format::Json => {
                let what = format!("{input}: holds faces, and .json files hold whole surfaces");
                Err(Problem::new(what)
                    .help("convert it to .step, .igs, a mesh or a picture")
                    .into())
            }
            Read::Document(d) => self.mesh(&d, start, screen),
        }
    }

    fn write(&self, scene: &Scene, screen: &Screen) -> Result<WriteReport, Failure> {
        let progress = screen.progress(&format!("Writing {}", self.output.display()));
        let tell = |share| progress.tell(share);
        let options = WriteOptions {
            progress: Progress::to(&tell),
            tolerance: self.tolerance,
            schema: output::schema(self.ap214),
            ..WriteOptions::default()
        };
        let report = nappe_exchange::write(&self.output, scene, &options);
        progress.finish();
        report.map_err(output::refused)
    }

    /// Writes what was read as it is.
    fn plain(
        &self,
        scene: &Scene,
        notes: &[String],
        missing: Vec<Problem>,
        screen: &Screen,
    ) -> Result<(), Failure> {
        // What is missing may be why there is nothing to write.
        let report = self
            .write(scene, screen)
            .map_err(|e| self.with(e, missing.clone()))?;
        let size = bytes(report.bytes);
        screen.note(format!("{}: {size}", self.output.display()));
        for note in notes.iter().chain(&report.notes) {
            screen.note(note);
        }
        self.whole(missing)
    }

    /// Fails if something is missing in the file that was written.
    fn whole(&self, missing: Vec<Problem>) -> Result<(), Failure> {
        if missing.is_empty() {
            return Ok(());
        }
        let rest = format!("{} holds the rest", self.output.display());
        Err(few(missing, &rest).into())
    }

    /// A failure of writing, and what was missing before.
    fn with(&self, failure: Failure, missing: Vec<Problem>) -> Failure {
        match failure {
            Failure::Problems(mut problems) if !missing.is_empty() => {
                let more = few(missing, "nothing was written");
                problems.extend(more.into_iter().map(|p| Box::new(p) as _));
                Failure::Problems(problems)
            }
            other => other,
        }
    }

    /// Writes the triangles of bodies.
    fn mesh(&self, document: &Document, start: Instant, screen: &Screen) -> Result<(), Failure> {
        let progress = screen.progress("Meshing");
        let tell = |share| progress.tell(share);
        let made = mesh_document(document, self.tolerance, Progress::to(&tell));
        progress.finish();
        let (notes, mut missing) = lost(document);
        missing.extend(made.missing.iter().map(without_triangles));
        let shown = |notes: &[String]| notes.iter().for_each(|note| screen.note(note));
        if made.scene.parts.is_empty() && made.scene.curves.is_empty() {
            shown(&notes);
            let mut problems = few(missing, "nothing was written");
            if problems.is_empty() {
                let what = format!("{}: holds no faces and no curves", self.input.display());
                problems.push(Problem::new(what).help("`nappe info` tells what it holds"));
            }
            return Err(problems.into());
        }
        let report = self.write(&made.scene, screen);
        if let Ok(report) = &report {
            screen.note(table(&made, report, start));
        }
        shown(&notes);
        if made.points > 0 {
            let points = count(made.points);
            screen.note(format!(
                "left out: {points} points: meshes and pictures have no place for single points"
            ));
        }
        for place in &made.turned_round {
            screen.note(format!(
                "note: {place}: its loops run the wrong way round and were turned"
            ));
        }
        let report = report.map_err(|e| self.with(e, missing.clone()))?;
        shown(&report.notes);
        self.whole(missing)
    }
}

/// Problems that are shown one by one.
const MOST_SHOWN: usize = 20;

fn without_triangles(m: &Missing) -> Problem {
    Problem::new(format!("{} is left out: {}", m.place, m.why))
}

/// What a reader left out: notes, and the geometry that is missing.
fn lost(document: &Document) -> (Vec<String>, Vec<Problem>) {
    let (geometry, other): (Vec<&LeftOut>, Vec<&LeftOut>) =
        document.left_out.iter().partition(|l| l.is_geometry);
    let one = |l: &LeftOut| Problem::new(format!("{} is left out: {}", named(l), l.why));
    (
        other.into_iter().map(left_out).collect(),
        geometry.into_iter().map(one).collect(),
    )
}

/// The first of what is missing, and what became of the rest.
fn few(mut problems: Vec<Problem>, rest: &str) -> Vec<Problem> {
    let more = problems.len().saturating_sub(MOST_SHOWN);
    problems.truncate(MOST_SHOWN);
    if more > 0 {
        let what = format!("{} more faces, curves or reasons are left out", count(more));
        problems.push(Problem::new(what));
    }
    let last = problems.pop();
    let help = format!("{rest}; `nappe info` tells more of the file, another --tolerance may help");
    problems.extend(last.map(|p| p.help(help)));
    problems
}

fn table(made: &DocumentMesh, report: &WriteReport, start: Instant) -> Table {
    let scene = &made.scene;
    let mut table = Table::of_facts();
    if let Some(title) = &scene.title {
        table.row(["title", title]);
    }
    table.row(["bodies".to_owned(), count(made.bodies)]);
    let faces = match (scene.parts.len(), made.faces) {
        (meshed, all) if meshed == all => count(all),
        (meshed, all) => format!("{} of {}", count(meshed), count(all)),
    };
    table.row(["faces".to_owned(), faces]);
    if !scene.curves.is_empty() {
        table.row(["curves".to_owned(), count(scene.curves.len())]);
    }
    closing::mesh(&mut table, scene);
    closing::files(&mut table, scene, std::slice::from_ref(report), start);
    table
}

fn exact(document: Document) -> Scene {
    Scene {
        title: document.name.clone(),
        units: document.units,
        document,
        ..Scene::default()
    }
}

/// What a reader left out, in words.
pub(super) fn left_out(l: &LeftOut) -> String {
    let kind = if l.is_geometry {
        "missing geometry"
    } else {
        "left out"
    };
    format!("{kind}: {}: {}", named(l), l.why)
}

/// What was left out, how many and which.
fn named(l: &LeftOut) -> String {
    let first = match (l.count, l.first.as_str()) {
        (_, "") => String::new(),
        (1, first) => format!(" ({first})"),
        (n, first) => format!(" ({} of them, the first {first})", count(n)),
    };
    format!("{}{first}", l.what)
}
