//! Draws the examples with the release build of the command, and the page that shows them.

use crate::{Outcome, cargo, root, run};
use std::fmt::Write as _;
use std::fs;
use std::process::Command;

/// One picture: the example's name, the file it goes to (without ending), options of `nappe render`, a caption.
type Picture = (
    &'static str,
    &'static str,
    &'static [&'static str],
    &'static str,
);

const PICTURES: &[Picture] = &[
    (
        "duct",
        "duct",
        &["--isolines", "8"],
        "A round-to-square duct: four cubic Coons panels between two collars.",
    ),
    (
        "duct",
        "duct-zebra",
        &["--style", "zebra"],
        "Zebra stripes run across the collar joints without a kink.",
    ),
    (
        "bilinear",
        "bilinear",
        &["--isolines", "10", "--nets"],
        "Four corners of a cube: a hyperbolic paraboloid.",
    ),
];

pub(crate) fn draw() -> Outcome {
    let folder = root().join("docs/gallery");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    run(&mut cargo(&[
        "build",
        "--release",
        "--package",
        "nappe-cli",
    ]))?;
    let target =
        std::env::var("CARGO_TARGET_DIR").map_or_else(|_| root().join("target"), Into::into);
    let nappe = target.join("release").join("nappe");
    let mut page = String::from(
        "# Gallery\n\nDrawn by `cargo xtask gallery` from the models in [`examples/`](../examples), without a GPU and \
         without a screen.\n",
    );
    for (example, file, options, caption) in PICTURES {
        let model = format!("examples/{example}.nappe.toml");
        let out = format!("docs/gallery/{file}.png");
        run(Command::new(&nappe)
            .args(["render", &model, "-o", &out, "--size", "900x640"])
            .args(*options))?;
        let command = format!("nappe render {model} -o {file}.png {}", options.join(" "));
        let command = command.trim_end();
        write!(
            page,
            "\n## {file}\n\n{caption}\n\n![{caption}](gallery/{file}.png)\n\n`{command}`\n"
        )
        .map_err(|e| e.to_string())?;
    }
    let page_path = root().join("docs/gallery.md");
    fs::write(&page_path, page).map_err(|e| format!("{}: {e}", page_path.display()))
}
