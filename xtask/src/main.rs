//! The project's own tasks, so that nobody has to remember a command line: `cargo xtask help` lists them.

mod gallery;
#[cfg(test)]
mod sources;

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::{SystemTime, UNIX_EPOCH};

const HELP: &str = "\
cargo xtask <task>

  test             all tests of all crates, documentation examples included
  ci               what CI runs: formatting, lints, documentation, then `test`
  bench [ARGS]     speed beside the limit of memory and other libraries; `--json FILE`, `--page` (docs/performance.md)
  gallery          draw docs/gallery/*.png and docs/gallery.md from examples/
  docs             write docs/model-file.md from the list of kinds and keys, and the table of docs/exchange.md
  fuzz [MINUTES]   valid files with faults, then random models and files, to the readers (installs cargo-fuzz on first use; default 2 minutes each)
";

/// A task's result: an error is a sentence for the person at the terminal.
pub(crate) type Outcome = Result<(), String>;

fn main() -> ExitCode {
    let args: Vec<String> = env::args().skip(1).collect();
    let rest = args.get(1..).unwrap_or_default();
    let outcome = match args.first().map(String::as_str) {
        Some("test") => test(rest),
        Some("ci") => ci(),
        Some("bench") => bench(rest),
        Some("gallery") => gallery::draw(),
        Some("docs") => docs(),
        Some("fuzz") => fuzz(rest),
        Some("help" | "--help" | "-h") => {
            print!("{HELP}");
            Ok(())
        }
        other => {
            eprint!("{HELP}");
            Err(other.map_or("which task?".into(), |t| format!("there is no task '{t}'")))
        }
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("xtask: {message}");
            ExitCode::FAILURE
        }
    }
}

/// The folder that holds the workspace.
pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .map(Path::to_path_buf)
        .unwrap_or_default()
}

/// Runs a command in the root folder and says which one failed.
pub(crate) fn run(command: &mut Command) -> Outcome {
    let shown = format!("{command:?}").replace('"', "");
    eprintln!("$ {shown}");
    let status = command
        .current_dir(root())
        .status()
        .map_err(|e| format!("{shown}: {e}"))?;
    if status.success() {
        Ok(())
    } else {
        Err(format!("{shown}: {status}"))
    }
}

/// Cargo, the one that runs this task.
pub(crate) fn cargo(args: &[&str]) -> Command {
    let mut c = Command::new(env::var("CARGO").unwrap_or_else(|_| "cargo".into()));
    c.args(args);
    c
}

/// Property tests draw the same numbers in every run, so that a failure belongs to a change; another seed in the
/// environment explores, and `fuzz` does so by intent.
fn test(rest: &[String]) -> Outcome {
    const SEED: &str = "PROPTEST_RNG_SEED";
    let mut command = cargo(&["test", "--workspace", "--no-fail-fast"]);
    if env::var_os(SEED).is_none() {
        command.env(SEED, "20261122");
    }
    run(command
        .env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "1")
        .args(rest))
}

fn ci() -> Outcome {
    run(&mut cargo(&["fmt", "--all", "--", "--check"]))?;
    run(&mut cargo(&[
        "clippy",
        "--workspace",
        "--all-targets",
        "--",
        "-D",
        "warnings",
    ]))?;
    run(cargo(&["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings"))?;
    test(&[])
}

fn bench(rest: &[String]) -> Outcome {
    run(cargo(&["bench", "--package", "nappe", "--bench", "surfaces", "--"]).args(rest))?;
    run(cargo(&[
        "bench",
        "--package",
        "nappe-exchange",
        "--bench",
        "files",
        "--",
    ])
    .args(rest))
}

/// The test that checks the page writes it when told to.
fn docs() -> Outcome {
    for (package, test) in [("nappe-model", "reference"), ("nappe-exchange", "public")] {
        run(
            cargo(&["test", "--package", package, "--test", test, "--quiet"])
                .env("NAPPE_WRITE_DOCS", "1"),
        )?;
    }
    Ok(())
}

/// Valid files with faults first, which any compiler can do. Coverage-guided fuzzing needs two unstable compiler flags; the
/// stable compiler takes them when told to.
fn fuzz(rest: &[String]) -> Outcome {
    let minutes: u64 = match rest.first() {
        Some(m) => m
            .parse()
            .map_err(|_| format!("'{m}' is not a number of minutes"))?,
        None => 2,
    };
    let seed = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |t| t.as_secs());
    run(
        cargo(&["test", "--package", "nappe-exchange", "--test", "fuzz"])
            .args(["--", "--nocapture"])
            .env("NAPPE_FUZZ_SECONDS", (minutes * 60).to_string())
            .env("NAPPE_FUZZ_SEED", seed.to_string()),
    )?;
    if cargo(&["fuzz", "--version"])
        .output()
        .map_or(true, |o| !o.status.success())
    {
        run(&mut cargo(&["install", "--locked", "cargo-fuzz"]))?;
    }
    let seconds = format!("-max_total_time={}", minutes * 60);
    for target in ["model", "step", "read"] {
        run(cargo(&["fuzz", "run", target, "--sanitizer", "none", "--"])
            .args([
                seconds.as_str(),
                "-max_len=4096",
                "-timeout=20",
                "-rss_limit_mb=4096",
            ])
            .env("RUSTC_BOOTSTRAP", "1"))?;
    }
    Ok(())
}
