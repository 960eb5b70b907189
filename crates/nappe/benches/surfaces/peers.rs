//! Other libraries, where they are installed.

use crate::tasks::Row;
use serde_json::Value;
use std::process::{Command, Stdio};

/// Runs `bench/peers.py` and puts its figures beside the rows of the same task.
pub(crate) fn add(rows: &mut [Row]) {
    if !rows.iter().any(|r| r.task.starts_with('T')) {
        return;
    }
    let python = std::env::var("NAPPE_PEERS_PYTHON").unwrap_or_else(|_| "python3".into());
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../../bench/peers.py");
    let output = match Command::new(&python)
        .arg(script)
        .stderr(Stdio::inherit())
        .output()
    {
        Ok(output) => output,
        Err(e) => {
            eprintln!("other libraries: skipped, {python}: {e}");
            return;
        }
    };
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let Ok(figure) = serde_json::from_str::<Value>(line) else {
            eprintln!("other libraries: not understood: {line}");
            continue;
        };
        let (Some(task), Some(peer), Some(ns)) = (
            figure["task"].as_str(),
            figure["peer"].as_str(),
            figure["ns_per_item"].as_f64(),
        ) else {
            continue;
        };
        // The first row of a task is the one with the shared inputs, unless the kind is named.
        let kind = figure["kind"].as_str();
        let is_meant = |r: &&mut Row| r.task == task && kind.is_none_or(|kind| r.kind == kind);
        if let Some(row) = rows.iter_mut().find(is_meant) {
            row.peers.push((peer.into(), ns));
        }
    }
}
