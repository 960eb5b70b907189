//! `nappe convert`.

use crate::failure::{Failure, Problem};
use crate::output;
use crate::screen::Screen;
use crate::text::{bytes, count};
use nappe_exchange::{Document, Format, LeftOut, Progress, Read, Scene, WriteOptions};
use std::path::PathBuf;

/// Convert a file: meshes to meshes and pictures, exact geometry between STEP and IGES
///
/// Reads .stl .obj .ply .glb .gltf .3mf (meshes), .step .stp .igs .iges (exact geometry). The ending of the second file
/// says its format. What could not be taken over is told with its reason.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  nappe convert scan.stl scan.glb
  nappe convert hull.iges hull.step")]
pub(crate) struct Args {
    /// The file to read
    #[arg(value_name = "IN")]
    input: PathBuf,

    /// The file to write
    #[arg(value_name = "OUT")]
    output: PathBuf,
}

impl Args {
    pub(crate) fn run(&self, screen: &Screen) -> Result<(), Failure> {
        let format = Format::from_path(&self.output).map_err(output::refused)?;
        output::check(&self.output)?;
        let read = nappe_exchange::read(&self.input).map_err(|e| Problem::new(e.to_string()))?;
        let (scene, notes) = match read {
            Read::Mesh(m) if format.is_exact() || format == Format::Json => {
                let (name, triangles) = (self.input.display(), count(m.triangles()));
                let what = format!("{name}: holds {triangles} triangles and no exact surfaces");
                return Err(Problem::new(what)
                    .help("a mesh can be converted to other meshes and to pictures")
                    .into());
            }
            Read::Mesh(m) => (m.to_scene(), m.notes),
            Read::Document(d) if format.is_exact() => {
                let notes = d.left_out.iter().map(left_out).collect();
                (exact(d), notes)
            }
            Read::Document(_) => {
                let what = format!("{}: holds exact geometry", self.input.display());
                return Err(Problem::new(what)
                    .help("it can be converted to .step and .igs; trimmed surfaces cannot be meshed yet")
                    .into());
            }
        };
        let progress = screen.progress(&format!("Writing {}", self.output.display()));
        let tell = |share| progress.tell(share);
        let options = WriteOptions {
            progress: Progress::to(&tell),
            ..WriteOptions::default()
        };
        let report = nappe_exchange::write(&self.output, &scene, &options);
        progress.finish();
        let report = report.map_err(output::refused)?;
        let size = bytes(report.bytes);
        screen.note(format!("{}: {size}", self.output.display()));
        for note in notes.iter().chain(&report.notes) {
            screen.note(note);
        }
        Ok(())
    }
}

fn exact(document: Document) -> Scene {
    Scene {
        title: document.name.clone(),
        units: document.units,
        document,
        ..Scene::default()
    }
}

fn left_out(l: &LeftOut) -> String {
    let first = match (l.count, l.first.as_str()) {
        (_, "") => String::new(),
        (1, first) => format!(" ({first})"),
        (n, first) => format!(" ({} of them, the first {first})", count(n)),
    };
    format!("left out: {}{first}: {}", l.what, l.why)
}
