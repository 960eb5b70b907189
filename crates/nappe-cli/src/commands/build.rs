//! `nappe build`.

use super::closing;
use crate::failure::Failure;
use crate::model::ModelArgs;
use crate::scene::Bend;
use crate::screen::Screen;
use crate::text::{self, Table};
use crate::{output, scene, slits};
use nappe_exchange::{Format, ItemForm, Progress, Scene, WriteOptions, WriteReport};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Build a model and write it: meshes within a proven tolerance, exact surfaces, pictures
///
/// The ending of each file says its format: .glb .gltf .stl .obj .ply .3mf .vtu (meshes), .json (exact NURBS curves and
/// surfaces; one curve where surfaces share a side, else a note tells the gap), .step .stp .igs .iges (exact surfaces, sewn along
/// the sides they share), .svg .png (pictures). Files are replaced only when the new ones are whole.
///
/// Ends with a table: patches, triangles, box, the proven distance between mesh and surfaces, the files, the time; and
/// with a note for sides that nearly meet, or meet in part, and are not joined.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  nappe build duct.nappe.toml                                      writes duct.glb
  nappe build duct.nappe.toml -o duct.stl -o duct.json -o duct.png
  nappe build duct.nappe.toml --tolerance 0.01 --set radius=80 -o duct.3mf
  nappe build duct.nappe.toml --ap214 -o duct.step                 for systems that do not read AP242")]
pub(crate) struct Args {
    #[command(flatten)]
    model: ModelArgs,

    /// A file to write; may be given several times. Default: a .glb beside the model
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,

    /// The greatest distance between mesh and surface, in the model's units. Default: the model's, else a thousandth of
    /// the diagonal of its box
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = super::length)]
    tolerance: Option<f64>,

    /// Write .step files by AP214, which older systems read, instead of AP242
    #[arg(long)]
    ap214: bool,
}

impl Args {
    pub(crate) fn run(&self, screen: &Screen) -> Result<(), Failure> {
        let start = Instant::now();
        if self.model.path().metadata().map_or(true, |m| m.is_dir()) {
            // What is wrong is the model, not the name that a file beside it would have.
            self.model.open(screen)?;
        }
        let files = self.files()?;
        output::check_ap214(self.ap214, files.iter().any(|f| f.1 == Format::Step))?;
        let model = self.model.open(screen)?;
        let tolerance = scene::tolerance(&model, self.tolerance);
        let unmeshed = |f: Format| f == Format::Json || f.is_exact();
        let mut scene = if files.iter().all(|f| unmeshed(f.1)) {
            scene::unmeshed(&model)
        } else {
            let detail = scene::Detail {
                tolerance,
                least_cells: 1,
            };
            scene::scene(&model, detail, self.tolerance, screen)?
        };
        let mut apart_forms = None;
        if files.iter().any(|f| f.1 == Format::Json) {
            let (exact, apart) = scene::exact(&model, tolerance)?;
            scene.exact = exact;
            apart_forms = apart;
        }
        if files.iter().any(|f| f.1.is_exact()) {
            scene.document = scene::document(&model, tolerance);
        }
        if files.iter().any(|f| f.1 == Format::Vtu) {
            scene.fields = [Bend::Gaussian, Bend::Mean]
                .map(|which| scene::curvature_field(&model, &scene.mesh, which))
                .to_vec();
        }
        let mut reports = Vec::new();
        for (path, _) in &files {
            let progress = screen.progress(&format!("Writing {}", path.display()));
            let tell = |share| progress.tell(share);
            let options = WriteOptions {
                progress: Progress::to(&tell),
                tolerance: Some(tolerance),
                schema: output::schema(self.ap214),
                ..WriteOptions::default()
            };
            let report = nappe_exchange::write(path, &scene, &options);
            progress.finish();
            reports.push(report.map_err(output::refused)?);
        }
        screen.note(table(&scene, &reports, start));
        if !scene.parts.is_empty() {
            for note in slits::notes(&model, tolerance) {
                screen.note(note);
            }
        }
        if let Some(note) = apart_forms {
            screen.note(note);
        }
        for report in &reports {
            for note in &report.notes {
                screen.note(format!("{}: {note}", report.path.display()));
            }
        }
        Ok(())
    }

    /// The files to write with their formats, all of them possible.
    fn files(&self) -> Result<Vec<(PathBuf, Format)>, Failure> {
        let mut paths = self.output.clone();
        if paths.is_empty() {
            paths.push(beside(self.model.path()));
        }
        let mut files = Vec::new();
        let mut problems = Vec::new();
        for (i, path) in paths.iter().enumerate() {
            if paths[..i].iter().any(|p| same_file(p, path)) {
                return Err(Failure::usage(format!(
                    "{} is to be written twice",
                    path.display()
                )));
            }
            match Format::from_path(path)
                .and_then(|f| nappe_exchange::check_target(path).map(|()| f))
            {
                Ok(format) => files.push((path.clone(), format)),
                Err(e) => problems.push(output::problem(e)),
            }
        }
        if problems.is_empty() {
            Ok(files)
        } else {
            Err(problems.into())
        }
    }
}

/// True if two paths are, or would be, the same file.
fn same_file(a: &Path, b: &Path) -> bool {
    let whole = |p: &Path| {
        let parent = p.parent().filter(|d| !d.as_os_str().is_empty());
        let directory = parent.unwrap_or(Path::new(".")).canonicalize().ok()?;
        p.canonicalize()
            .ok()
            .or_else(|| Some(directory.join(p.file_name()?)))
    };
    a == b || whole(a).is_some_and(|a| Some(a) == whole(b))
}

/// `a/duct.glb` for `a/duct.nappe.toml`.
fn beside(model: &Path) -> PathBuf {
    let name = model.file_name().unwrap_or_default().to_string_lossy();
    let bare = name.strip_suffix(".toml").unwrap_or(&name);
    let bare = bare.strip_suffix(".nappe").unwrap_or(bare);
    model.with_file_name(format!("{bare}.glb"))
}

/// How many curves and surfaces go out exactly: in files of NURBS, or else as the faces and curves of a document.
fn exact_count(scene: &Scene) -> usize {
    if !scene.exact.is_empty() {
        return scene.exact.len();
    }
    let items = scene.document.items.iter();
    items
        .map(|item| match &item.form {
            ItemForm::Body { body, .. } => body.faces.len(),
            ItemForm::Curve(_) => 1,
            ItemForm::Points(_) => 0,
        })
        .sum()
}

fn table(scene: &Scene, reports: &[WriteReport], start: Instant) -> Table {
    let mut table = Table::of_facts();
    if let Some(title) = &scene.title {
        table.row(["title", title]);
    }
    if scene.parts.is_empty() {
        table.row([
            "curves and surfaces".to_owned(),
            text::count(exact_count(scene)),
        ]);
    } else {
        table.row(["patches".to_owned(), text::count(scene.parts.len())]);
        closing::mesh(&mut table, scene);
    }
    closing::files(&mut table, scene, reports, start);
    table
}
