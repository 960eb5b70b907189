//! Another kernel's answers about the same surfaces, where it is installed.

use crate::run::Folder;
use serde_json::Value;
use std::process::Command;

/// How far answers may be apart that both kernels find by iteration, relative to the model's diagonal, or to the figure.
const AGREE: f64 = 1e-6;
/// Points looked at for each model, from a box twice as large as the model's.
const POINTS: usize = 40;

/// What the other kernel says; `None` if it is not installed.
fn asked(folder: &Folder) -> Option<Value> {
    let python = std::env::var("NAPPE_PEERS_PYTHON").unwrap_or_else(|_| "python3".into());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/peers/occt.py");
    let files = ["model.json", "points.csv"].map(|f| folder.path(f));
    let output = Command::new(python).arg(script).args(files).output().ok()?;
    if output.status.code() == Some(3) {
        return None;
    }
    let told = String::from_utf8_lossy(&output.stderr);
    // A system without Python at all is one without the kernel.
    if output.stdout.is_empty() && !told.contains("Traceback") {
        return None;
    }
    assert!(output.status.success(), "{told}");
    Some(serde_json::from_slice(&output.stdout).unwrap())
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap()
}

fn vector(v: &Value) -> [f64; 3] {
    [0, 1, 2].map(|k| number(&v[k]))
}

/// Nearest points, areas and centroids. Open CASCADE's search may miss the nearest place; then its distance is greater, never
/// less.
#[test]
fn another_kernel_agrees_about_distances_areas_and_centroids() {
    for name in ["teapot", "hermite", "bezier-rib", "torus"] {
        let folder = Folder::new();
        let example = format!(
            "{}/../../examples/{name}.nappe.toml",
            env!("CARGO_MANIFEST_DIR")
        );
        folder.write(
            "model.nappe.toml",
            &std::fs::read_to_string(example).unwrap(),
        );
        folder.nappe("build model.nappe.toml -o model.json").data();
        let exact: Value = serde_json::from_slice(&folder.read("model.json")).unwrap();
        for surface in exact["surfaces"].as_array().unwrap() {
            assert_eq!(surface["exactness"]["is"], "exact", "{name}");
        }
        let info = folder.nappe("info model.nappe.toml --format json");
        let info: Value = serde_json::from_str(info.data()).unwrap();
        let [lo, hi] = ["min", "max"].map(|k| vector(&info["box"][k]));
        let diagonal = (0..3).map(|k| (hi[k] - lo[k]).powi(2)).sum::<f64>().sqrt();
        // Fractions of multiples of irrational numbers are spread evenly.
        let share = |i: usize, k: usize| (i as f64 * [0.754_877, 0.569_840, 0.430_159][k]).fract();
        let at = |i: usize, k: usize| lo[k] + (hi[k] - lo[k]) * (2.0 * share(i, k) - 0.5);
        let rows: String = (1..=POINTS)
            .map(|i| format!("{},{},{}\n", at(i, 0), at(i, 1), at(i, 2)))
            .collect();
        folder.write("points.csv", &format!("x,y,z\n{rows}"));
        let Some(theirs) = asked(&folder) else {
            eprintln!("skipped: Open CASCADE (cadquery-ocp) is not installed");
            return;
        };
        let ours = folder.nappe("project model.nappe.toml --points points.csv --format jsonl");
        let ours: Vec<Value> = ours
            .data()
            .lines()
            .map(|l| serde_json::from_str(l).unwrap())
            .collect();
        assert_eq!(ours.len(), POINTS);
        let mut missed = 0;
        for (ours, theirs) in ours.iter().zip(theirs["distances"].as_array().unwrap()) {
            let (a, b) = (number(&ours["distance"]), number(theirs));
            assert!(a <= b + AGREE * diagonal, "{name}: {a} against {b}");
            missed += usize::from(b > a + AGREE * diagonal);
        }
        assert!(missed <= POINTS / 10, "{name}: {missed} places missed");
        for (ours, theirs) in info["surfaces"]
            .as_array()
            .unwrap()
            .iter()
            .zip(theirs["surfaces"].as_array().unwrap())
        {
            let (a, b) = (number(&ours["area"]["value"]), number(&theirs["area"]));
            let error = AGREE * b + number(&ours["area"]["certainty"]["error"]);
            assert!((a - b).abs() <= error, "{name}: area {a} against {b}");
            let (a, b) = (
                vector(&ours["centroid"]["point"]),
                vector(&theirs["centre"]),
            );
            for k in 0..3 {
                let apart = (a[k] - b[k]).abs();
                assert!(
                    apart <= AGREE * diagonal,
                    "{name}: centroid {a:?} against {b:?}"
                );
            }
        }
    }
}
