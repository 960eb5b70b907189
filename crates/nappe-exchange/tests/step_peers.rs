//! Another kernel reads what we write, where it is installed.

use nappe_exchange::step::{self, Schema, StepOptions};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Relative difference of areas and volumes, both integrated by the other kernel.
const AGREE: f64 = 1e-6;

fn shared() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    ["../shared/data", "../../shared/data"]
        .into_iter()
        .map(|d| root.join(d))
        .find(|d| d.is_dir())
}

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

#[test]
fn public_files_written_again_are_the_same_to_another_kernel() {
    let Some(shared) = shared() else {
        eprintln!("skipped: the public files are not beside the project");
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let mut pairs = Vec::new();
    for name in NAMES {
        let original = shared.join(name);
        let file = step::read(&std::fs::read(&original).unwrap()).unwrap();
        let again = dir.path().join(name.replace('/', "-"));
        let options = StepOptions {
            schema: Schema::Ap242,
            tolerance: 1e-6,
        };
        let report = step::write(&again, &file.document, &options).unwrap();
        println!("{name} {report:?}");
        pairs.extend([original, again]);
    }
    let Some(answers) = asked(&pairs) else {
        eprintln!("skipped: Open CASCADE (cadquery-ocp) is not installed");
        return;
    };
    let mut bad = 0;
    for (name, pair) in NAMES.iter().zip(answers.chunks(2)) {
        let [a, b] = pair else { unreachable!() };
        let number = |v: &Value, k: &str| v[k].as_f64().unwrap_or(f64::NAN);
        let close = |k: &str| (number(a, k) - number(b, k)).abs() <= AGREE * number(a, k).abs();
        let same = a["solids"] == b["solids"]
            && a["faces"] == b["faces"]
            && close("area")
            && close("volume")
            && b["valid"] == a["valid"];
        if !same {
            bad += 1;
            println!("DIFFERENT {name}\n  {a}\n  {b}");
        } else {
            println!("same {name} {b}");
        }
    }
    assert_eq!(bad, 0);
}

const NAMES: [&str; 19] = [
    "axom/boxed_sphere.step",
    "axom/sliced_cylinder.step",
    "axom/tet.step",
    "cax-if/MAINBODY_FRONT.stp",
    "cax-if/TAIL_TURBINE.stp",
    "cax-if/as1-oc-214.stp",
    "cax-if/dm1-id-214.stp",
    "cax-if/sg1-c5-214.stp",
    "hulls-and-wing/wigley.step",
    "occt/screw.step",
    "thin-revolved/single_volume_thin.stp",
    "tigl/nacelle.stp",
    "truck/abc-0000.step",
    "truck/abc-0008.step",
    "truck/occt-cone.step",
    "truck/occt-cube.step",
    "truck/occt-cylinder.step",
    "truck/occt-sphere.step",
    "truck/occt-torus.step",
];
