//! The public files that are beside the project on some machines only.

use std::path::{Path, PathBuf};

/// The folder of public files beside the project; `None` where it is not.
pub(crate) fn shared() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    ["../shared/data", "../../shared/data"]
        .into_iter()
        .map(|d| root.join(d))
        .find(|d| d.is_dir())
}
