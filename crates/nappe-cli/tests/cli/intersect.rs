//! `nappe intersect`: rows, bounds and exit codes.

use crate::run::Folder;

/// A ball, a sheet through it, and a sheet that touches it from above.
const MODEL: &str = r#"
[surfaces.ball]
kind = "quadric"
shape = "sphere"
semi_axes = [1]
[surfaces.through]
kind = "bilinear"
corners = [[[-2, -2, 0.6], [-2, 2, 0.6]], [[2, -2, 0.6], [2, 2, 0.6]]]
[surfaces.along]
kind = "bilinear"
corners = [[[1, -2, -2], [1, -2, 2]], [[1, 2, -2], [1, 2, 2]]]
"#;

#[test]
fn every_row_is_within_its_error_and_that_within_the_tolerance() {
    let folder = Folder::with_model(MODEL);
    let run = folder.nappe(
        "intersect model.nappe.toml --surfaces ball through --tolerance 0.001 --format jsonl",
    );
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.contains("there are no others"), "{}", run.stderr);
    let rows = run.data().lines();
    let rows: Vec<serde_json::Value> = rows.map(|l| serde_json::from_str(l).unwrap()).collect();
    assert!(rows.len() > 20);
    for row in rows {
        let [x, y, z, error] = ["x", "y", "z", "error"].map(|key| row[key].as_f64().unwrap());
        assert!(error > 0.0 && error <= 0.001 * (1.0 + 1e-9), "{row}");
        // The circle of radius 0.8 at the height 0.6.
        assert!((x.hypot(y) - 0.8).hypot(z - 0.6) <= error, "{row}");
    }
}

#[test]
fn places_that_are_not_decided_are_told_by_the_exit_code() {
    let folder = Folder::with_model(MODEL);
    let command = "intersect model.nappe.toml --surfaces ball along -o seam.csv";
    let run = folder.nappe(command);
    assert_eq!(run.code, 1);
    assert!(
        run.stderr
            .contains("not decided: there may be others there"),
        "{}",
        run.stderr
    );
    // What was found is written all the same.
    assert!(folder.names().contains(&"seam.csv".to_owned()));
    assert_eq!(folder.nappe(&format!("{command} --quiet")).code, 1);
}
