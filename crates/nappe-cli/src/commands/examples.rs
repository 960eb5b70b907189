//! `nappe examples`.

use crate::failure::{Failure, Problem};
use crate::screen::Screen;
use crate::text::Table;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// List the bundled models, print one, or write them all to a folder
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  nappe examples                     list them
  nappe examples duct                print one
  nappe examples --write models      write them all to the folder models")]
pub(crate) struct Args {
    /// The model to print
    #[arg(conflicts_with = "write")]
    name: Option<String>,

    /// Write all models to this folder, which is made if it is missing
    #[arg(long, value_name = "FOLDER")]
    write: Option<PathBuf>,

    /// Replace files that are there
    #[arg(long, requires = "write")]
    force: bool,
}

macro_rules! bundled {
    ($($name:literal),* $(,)?) => {
        &[$(Example {
            name: $name,
            text: include_str!(concat!("../../../../examples/", $name, ".nappe.toml")),
        }),*]
    };
}

/// A model that comes with the program.
#[derive(Debug)]
struct Example {
    name: &'static str,
    text: &'static str,
}

const EXAMPLES: &[Example] = bundled![
    "bezier-rib",
    "bilinear",
    "blade",
    "blend",
    "bottle",
    "coons-blending",
    "coons-neighbour",
    "coons-quintic",
    "curves-on-surfaces",
    "diagonal-key",
    "diagonal-key-space",
    "diagonal-key-stitched",
    "duct",
    "fillet-box",
    "fillet-cylinder",
    "fillet-hull",
    "fillet-pipes",
    "fillet-planes",
    "hermite",
    "intersection",
    "quadrics",
    "rational-basis",
    "revolution-chashnikov",
    "revolution-conic-sections",
    "revolution-grigoriev",
    "sphere-octants",
    "teapot",
    "torus",
    "vase",
    "wigley",
    "wing-coons",
    "wing-ruled",
];

impl Example {
    /// The model's title.
    fn title(&self) -> &'static str {
        self.text
            .lines()
            .find_map(|line| line.strip_prefix("title = \"")?.strip_suffix('"'))
            .unwrap_or_default()
    }

    fn file_name(&self) -> String {
        format!("{}.nappe.toml", self.name)
    }
}

impl Args {
    pub(crate) fn run(&self, screen: &Screen) -> Result<(), Failure> {
        if let Some(folder) = &self.write {
            return write_all(folder, self.force, screen);
        }
        let text = match &self.name {
            None => list(),
            Some(name) => find(name)?.text.to_owned(),
        };
        Ok(io::stdout().lock().write_all(text.as_bytes())?)
    }
}

fn list() -> String {
    let mut table = Table::headed(["name", "model"]);
    for e in EXAMPLES {
        table.row([e.name, e.title()]);
    }
    format!("{table}\n")
}

fn find(name: &str) -> Result<&'static Example, Problem> {
    let bare = name.strip_suffix(".nappe.toml").unwrap_or(name);
    EXAMPLES.iter().find(|e| e.name == bare).ok_or_else(|| {
        let near = nappe::expr::nearest(bare, EXAMPLES.iter().map(|e| e.name));
        Problem::new(format!("there is no bundled model `{name}`")).help(match near {
            Some(near) => format!("did you mean `{near}`? `nappe examples` lists all"),
            None => "`nappe examples` lists all".to_owned(),
        })
    })
}

fn write_all(folder: &Path, force: bool, screen: &Screen) -> Result<(), Failure> {
    let refused = |e: io::Error| {
        Problem::new(format!(
            "{}: could not make the folder: {e}",
            folder.display()
        ))
        .help("choose a folder that you may write to")
    };
    fs::create_dir_all(folder).map_err(refused)?;
    let there: Vec<String> = EXAMPLES
        .iter()
        .map(Example::file_name)
        .filter(|name| folder.join(name).symlink_metadata().is_ok())
        .collect();
    if !there.is_empty() && !force {
        return Err(Problem::new(format!(
            "{}: already there: {}",
            folder.display(),
            there.join(", ")
        ))
        .help("nothing was written; --force replaces them, or choose another folder")
        .into());
    }
    for e in EXAMPLES {
        crate::output::write(&folder.join(e.file_name()), e.text.as_bytes())?;
    }
    screen.note(format!(
        "{} models written to {}",
        EXAMPLES.len(),
        folder.display()
    ));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_example_of_the_repository_is_bundled_and_titled() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
        let files: BTreeSet<String> = fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .filter(|name| name.ends_with(".nappe.toml"))
            .collect();
        let bundled: BTreeSet<String> = EXAMPLES.iter().map(Example::file_name).collect();
        assert_eq!(files, bundled);
        for e in EXAMPLES {
            assert!(!e.title().is_empty(), "{} has no title", e.name);
        }
    }
}
