//! Runs the built binary in a folder of its own.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// A folder that goes away with the test.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Folder {
        Folder(tempfile::tempdir().unwrap())
    }

    /// A folder with one model, `model.nappe.toml`. The lines that every model has are added.
    pub(crate) fn with_model(text: &str) -> Folder {
        let folder = Folder::new();
        folder.write("model.nappe.toml", &format!("nappe = 1\n{text}"));
        folder
    }

    /// A model with a surface, `step`, that jumps by 1 at u = 0.5.
    pub(crate) fn with_torn_surface() -> Folder {
        let rail = |y: u8| {
            format!(
                "{{ kind = \"expression\", x = \"t\", y = \"{y}\", z = \"if(t < 0.5, 0, 1)\" }}"
            )
        };
        let [south, north] = [0, 1].map(rail);
        Folder::with_model(&format!(
            "[surfaces.step]\nkind = \"ruled\"\nsouth = {south}\nnorth = {north}\n"
        ))
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    /// The names of all files, sorted.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> = entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    /// Runs `nappe` here with arguments separated by spaces.
    pub(crate) fn nappe(&self, args: &str) -> Run {
        self.nappe_with(args, b"")
    }

    /// The same with something on standard input.
    pub(crate) fn nappe_with(&self, args: &str, input: &[u8]) -> Run {
        let mut child = nappe(self.0.path())
            .args(args.split_whitespace())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut stdin = child.stdin.take().unwrap();
        let input = input.to_vec();
        // In a thread of its own: the child may stop reading while this side waits for its output.
        let feeder = std::thread::spawn(move || {
            let _ = stdin.write_all(&input);
        });
        let output = child.wait_with_output().unwrap();
        feeder.join().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Run {
            code: output.status.code().unwrap(),
            stderr: text(output.stderr),
            stdout: output.stdout,
        }
    }
}

/// The binary with an environment that does not depend on the tester's.
pub(crate) fn nappe(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_nappe"));
    command
        .current_dir(folder)
        .env_remove("NO_COLOR")
        .env("COLUMNS", "100");
    command
}

/// What a run gave.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) code: i32,
    pub(crate) stdout: Vec<u8>,
    pub(crate) stderr: String,
}

impl Run {
    /// Standard output as text, of a run that succeeded.
    pub(crate) fn data(&self) -> &str {
        assert_eq!(self.code, 0, "{}", self.stderr);
        std::str::from_utf8(&self.stdout).unwrap()
    }

    /// Standard error of a run that failed as it should: because of the model or the data.
    pub(crate) fn problem(&self) -> &str {
        assert_eq!(self.code, 1, "{}", self.stderr);
        &self.stderr
    }
}
