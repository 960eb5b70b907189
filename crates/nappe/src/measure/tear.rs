//! Where a surface jumps.

use crate::breaks::Breaks;
use crate::surface::{Dir, Surface};

/// The first parameter at which a surface jumps, if it does: u before v. Cost: none.
pub fn tear(surface: &dyn Surface) -> Option<(Dir, f64)> {
    [Dir::U, Dir::V]
        .into_iter()
        .find_map(|dir| Some((dir, surface.breaks(dir).tear()?)))
}
