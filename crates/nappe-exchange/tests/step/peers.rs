//! Another kernel reads what we write, where it is installed.

use crate::files::FILES;
use crate::swept;
use crate::{sewn, shared, written};
use nappe::measure::{IntegralOptions, area};
use nappe::query::{Finder, FinderOptions};
use nappe::{DVec3, Units};
use nappe_exchange::step::{self, Schema, StepOptions};
use serde_json::Value;
use std::path::PathBuf;
use std::process::Command;

/// Relative difference of areas and volumes, both integrated by the other kernel.
const AGREE: f64 = 1e-6;

fn asked(files: &[PathBuf]) -> Option<Vec<Value>> {
    let python = std::env::var("NAPPE_PEERS_PYTHON").unwrap_or_else(|_| "python3".into());
    let script = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../nappe-cli/tests/peers/occt_step.py"
    );
    let output = Command::new(python).arg(script).args(files).output().ok()?;
    let told = String::from_utf8_lossy(&output.stderr);
    if output.status.code() == Some(3) || (output.stdout.is_empty() && !told.contains("Traceback"))
    {
        return None;
    }
    assert!(output.status.success(), "{told}");
    // The other kernel also talks on the standard output.
    let text = String::from_utf8_lossy(&output.stdout);
    let json = &text[text.rfind("[{").unwrap_or(0)..];
    Some(serde_json::from_str(json).unwrap())
}

/// How far areas may be apart: in one file curves and surfaces agree only within 5 µm, and what is between them is counted by
/// one of them.
fn allowed(name: &str) -> f64 {
    if name.ends_with("MAINBODY_FRONT.stp") {
        4.0 * AGREE
    } else {
        AGREE
    }
}

#[test]
fn public_files_written_again_are_the_same_to_another_kernel() {
    let Some(shared) = shared() else {
        eprintln!("skipped: the public files are not beside the project");
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let mut pairs = Vec::new();
    for (name, ..) in FILES {
        let original = shared.join(name);
        let file = step::read(&std::fs::read(&original).unwrap()).unwrap();
        let again = dir.path().join(name.replace('/', "-"));
        let options = StepOptions {
            schema: Schema::Ap242,
            tolerance: 1e-6,
        };
        let report = step::write(&again, &file.document, &options).unwrap();
        assert_eq!(report.approximated, 0, "{name}");
        pairs.extend([original, again]);
    }
    let Some(answers) = asked(&pairs) else {
        eprintln!("skipped: Open CASCADE (cadquery-ocp) is not installed");
        return;
    };
    for ((name, ..), pair) in FILES.iter().zip(answers.chunks(2)) {
        for key in ["read", "valid", "solids", "closed", "faces"] {
            assert_eq!(pair[0][key], pair[1][key], "{name}: {key}");
        }
        assert_eq!(pair[1]["valid"], true, "{name}");
        for key in ["area", "volume"] {
            let [a, b] = [0, 1].map(|i| pair[i][key].as_f64().unwrap());
            assert!(
                (a - b).abs() <= allowed(name) * a.abs(),
                "{name}: {key} {a} against {b}"
            );
        }
    }
}

#[test]
fn swept_surfaces_are_whole_and_the_same_to_another_kernel() {
    let dir = tempfile::tempdir().unwrap();
    let all = swept::all();
    let files = all.iter().enumerate().map(|(i, (_, surface))| {
        let path = dir.path().join(format!("{i}.step"));
        let document = sewn(std::slice::from_ref(surface), Units::Millimetre);
        std::fs::write(&path, written(&document, Schema::Ap242)).unwrap();
        path
    });
    let answers = dir.path().join("answers.json");
    let script = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../nappe-cli/tests/peers/occt_files.py"
    );
    let python = std::env::var("NAPPE_PEERS_PYTHON").unwrap_or_else(|_| "python3".into());
    let output = Command::new(python)
        .arg(script)
        .arg(&answers)
        .args(files)
        .output();
    let Some(output) = output.ok().filter(|o| o.status.code() != Some(3)) else {
        eprintln!("skipped: Open CASCADE (cadquery-ocp) is not installed");
        return;
    };
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
    let answers: Vec<Value> = serde_json::from_slice(&std::fs::read(answers).unwrap()).unwrap();
    for ((name, surface), answer) in all.iter().zip(&answers) {
        assert_eq!(answer["read"], true, "{name}");
        assert_eq!(answer["valid"], true, "{name}");
        let [face] = answer["faces"].as_array().unwrap().as_slice() else {
            panic!("{name}: not one face");
        };
        let own = area(surface.as_ref(), &IntegralOptions::default());
        let theirs = face["area"].as_f64().unwrap();
        assert!(
            (own.value - theirs).abs() <= AGREE * own.value,
            "{name}: area {} against {theirs}",
            own.value
        );
        let options = FinderOptions {
            tol: Some(1e-11),
            ..FinderOptions::default()
        };
        let finder = Finder::new(std::slice::from_ref(surface), options).unwrap();
        let points = face["points"].as_array().unwrap();
        assert!(!points.is_empty(), "{name}");
        for p in points {
            let [x, y, z] = [0, 1, 2].map(|i| p[i].as_f64().unwrap());
            let far = finder.nearest(DVec3::new(x, y, z)).unwrap().distance;
            assert!(far <= 1e-9, "{name}: {far:e}");
        }
    }
}
