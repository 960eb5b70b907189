//! Solids with cavities.

use nappe::body::{Body, figures};

/// Whether a body is one solid with cavities: all its shells are closed, the normals of the first point outwards and those
/// of all others inwards, whichever way faces and shells say so. Cost: the volume of each shell.
pub(crate) fn hollow(body: &Body) -> bool {
    if body.shells.len() < 2 || !body.shells.iter().all(|s| s.closed) {
        return false;
    }
    let Ok(found) = figures(body) else {
        return false;
    };
    let outwards = |i: usize| found.volumes[i].as_ref().map(|v| v.value > 0.0);
    outwards(0) == Some(true) && (1..body.shells.len()).all(|i| outwards(i) == Some(false))
}
