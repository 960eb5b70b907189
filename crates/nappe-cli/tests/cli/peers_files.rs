//! Another kernel reads the files that are written of all examples, where it is installed.

use crate::run::Folder;
use serde_json::Value;
use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// How far areas and volumes may be apart, relative, whatever bounds are told.
pub(crate) const AGREE: f64 = 1e-6;
/// How far points of exact surfaces may be from ours, relative to the model's diagonal.
const NEAR: f64 = 1e-9;
/// The tolerance of surfaces that have no exact form, relative to the diagonal; then their areas can agree.
const TOLERANCE: f64 = 1e-7;
/// How near the nearest points are found, relative to the diagonal.
const FOUND: f64 = 1e-10;
pub(crate) const ENDINGS: [&str; 2] = ["step", "igs"];

/// An example: what is told about it, and what a test needs of that.
pub(crate) struct Example {
    pub(crate) name: String,
    pub(crate) info: Value,
    diagonal: f64,
    tolerance: f64,
    /// Millimetres in its unit.
    unit: f64,
}

impl Example {
    /// Builds both files in the folder.
    pub(crate) fn build(folder: &Folder, path: &Path) -> Example {
        let file = path.file_name().unwrap().to_str().unwrap();
        let name = file.trim_end_matches(".nappe.toml").to_owned();
        let model = path.to_str().unwrap();
        let info = folder.nappe(&format!("info {model} --format json"));
        let info: Value = serde_json::from_str(info.data()).unwrap();
        let [lo, hi] = ["min", "max"].map(|k| [0, 1, 2].map(|i| number(&info["box"][k][i])));
        let diagonal = (0..3).map(|k| (hi[k] - lo[k]).powi(2)).sum::<f64>().sqrt();
        let tolerance = diagonal * TOLERANCE;
        folder
            .nappe(&format!(
                "build {model} --tolerance {tolerance} -o {name}.step -o {name}.igs"
            ))
            .data();
        let unit = match info["units"].as_str().unwrap() {
            "mm" => 1.0,
            "cm" => 10.0,
            "m" => 1e3,
            other => panic!("{name}: {other}"),
        };
        Example {
            name,
            info,
            diagonal,
            tolerance,
            unit,
        }
    }

    /// What the other kernel found in one of the files.
    fn compare(&self, folder: &Folder, theirs: &Value, ending: &str) {
        let at = format!("{}.{ending}", self.name);
        assert_eq!(theirs["read"], true, "{at}");
        assert_eq!(theirs["valid"], true, "{at}");
        let shells = self.info["shells"].as_array().unwrap();
        for key in ["closed", "solids"] {
            assert_eq!(theirs[key], shells.len(), "{at}: {key}");
        }
        let volume: f64 = shells.iter().map(|s| number(&s["volume"]["value"])).sum();
        let found = number(&theirs["volume"]) / self.unit.powi(3);
        assert!(
            (found - volume).abs() <= AGREE * volume,
            "{at}: {found} for {volume}"
        );

        let surfaces = self.info["surfaces"].as_array().unwrap();
        let faces = theirs["faces"].as_array().unwrap();
        assert_eq!(faces.len(), surfaces.len(), "{at}");
        // Faces of STEP files are in the order of shells.
        let named: HashMap<&str, &Value> = surfaces
            .iter()
            .map(|s| (s["name"].as_str().unwrap(), s))
            .collect();
        let mut rows = String::from("allowed,x,y,z\n");
        for (face, same) in faces.iter().zip(surfaces) {
            let surface = face["name"].as_str().map_or(same, |name| named[name]);
            let area = number(&surface["area"]["value"]);
            let found = number(&face["area"]) / self.unit.powi(2);
            let name = surface["name"].as_str().unwrap();
            assert!(
                (found - area).abs() <= AGREE * area,
                "{at}: {name}: {found} for {area}"
            );
            let exact = if ending == "igs" {
                "exact_nurbs"
            } else {
                "exact_shape"
            };
            let allowed = if surface[exact] == true {
                0.0
            } else {
                self.tolerance
            };
            let allowed = allowed + NEAR * self.diagonal;
            let points = face["points"].as_array().unwrap();
            assert!(!points.is_empty(), "{at}: {name}");
            for p in points {
                let [x, y, z] = [0, 1, 2].map(|k| number(&p[k]) / self.unit);
                writeln!(rows, "{allowed},{x},{y},{z}").unwrap();
            }
        }
        folder.write("points.csv", &rows);
        let path = format!(
            "{}/../../examples/{}.nappe.toml",
            env!("CARGO_MANIFEST_DIR"),
            self.name
        );
        let near = folder.nappe(&format!(
            "project {path} --points points.csv --format jsonl --tolerance {}",
            FOUND * self.diagonal
        ));
        for row in near.data().lines() {
            let row: Value = serde_json::from_str(row).unwrap();
            let allowed: f64 = row["allowed"].as_str().unwrap().parse().unwrap();
            assert!(number(&row["distance"]) <= allowed, "{at}: {row}");
        }
        assert_eq!(
            near.data().lines().count(),
            rows.lines().count() - 1,
            "{at}"
        );
    }
}

pub(crate) fn number(v: &Value) -> f64 {
    v.as_f64().unwrap()
}

/// The model files of all examples.
pub(crate) fn examples() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let mut paths: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.to_string_lossy().ends_with(".nappe.toml"))
        .collect();
    paths.sort();
    assert!(!paths.is_empty());
    paths
}

/// Python with the other kernel, if there is one.
fn python() -> Option<String> {
    let python = std::env::var("NAPPE_PEERS_PYTHON").unwrap_or_else(|_| "python3".into());
    let found = Command::new(&python)
        .args(["-c", "import OCP.STEPControl"])
        .output()
        .is_ok_and(|o| o.status.success());
    if !found {
        eprintln!("skipped: Open CASCADE (cadquery-ocp) is not installed");
    }
    found.then_some(python)
}

/// Valid, closed where we say closed, with our areas and volumes, and no point away from our surfaces.
#[test]
fn another_kernel_finds_the_same_in_files_of_all_examples() {
    let Some(python) = python() else { return };
    let folder = Folder::new();
    let examples: Vec<Example> = examples()
        .iter()
        .map(|p| Example::build(&folder, p))
        .collect();
    let files = examples
        .iter()
        .flat_map(|e| ENDINGS.map(|ending| folder.path(&format!("{}.{ending}", e.name))));
    let answers = folder.path("answers.json");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/peers/occt_files.py");
    let output = Command::new(python)
        .arg(script)
        .arg(&answers)
        .args(files)
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
    let answers: Vec<Value> = serde_json::from_slice(&std::fs::read(answers).unwrap()).unwrap();
    assert_eq!(answers.len(), 2 * examples.len());
    for (example, answers) in examples.iter().zip(answers.chunks(2)) {
        for (answer, ending) in answers.iter().zip(ENDINGS) {
            example.compare(&folder, answer, ending);
        }
    }
}
