//! The help, the command line's own errors, and completions.

use crate::run::Folder;
use insta::assert_snapshot;

const COMMANDS: [&str; 6] = [
    "build",
    "eval",
    "project",
    "schema",
    "examples",
    "completions",
];

#[test]
fn help_of_every_command() {
    let folder = Folder::new();
    assert_snapshot!("help", folder.nappe("--help").data());
    for command in COMMANDS {
        let run = folder.nappe(&format!("{command} --help"));
        assert!(run.data().contains("Example"), "{command} has no example");
        assert_snapshot!(format!("help-{command}"), run.data());
    }
}

#[test]
fn a_wrong_command_line_is_exit_code_2() {
    let folder = Folder::new();
    for args in [
        "",
        "biuld",
        "build",
        "build a.toml --tolerance -1",
        "build a.toml --tolerance x",
        "build a.toml --set radius",
        "eval a.toml",
        "eval a.toml --surface a --curve b",
        "eval a.toml --surface a --order 9",
        "eval a.toml --surface a --grid 1",
        "eval a.toml --surface a --grid 3 --uv b.csv",
        "render a.toml",
        "render a.toml -o a.png --size 3",
        "render a.toml -o a.png --view above",
        "check a.toml --format xml",
        "project a.toml --tolerance 0",
        "project a.toml --surface a --curve b",
        "project a.toml --all --signed",
        "completions ksh",
        "examples a --write b",
        "convert a",
    ] {
        let run = folder.nappe(args);
        assert_eq!(run.code, 2, "`nappe {args}`: {}", run.stderr);
        assert!(run.stdout.is_empty(), "`nappe {args}`");
        assert!(!run.stderr.contains("panicked"), "{}", run.stderr);
    }
    assert_snapshot!(folder.nappe("biuld").stderr);
}

#[test]
fn completions_name_every_command() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let run = folder.nappe(&format!("completions {shell}"));
        for command in COMMANDS {
            assert!(run.data().contains(command), "{shell}: {command}");
        }
    }
}
