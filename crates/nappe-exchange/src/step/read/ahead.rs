//! Spline surfaces of a shell with many faces, read ahead on several threads.

use super::file::Got;
use super::place::Space;
use super::splines;
use super::surfaces::Expanse;
use nappe::parallel;
use std::collections::HashMap;
use std::sync::Arc;

/// Fewer faces are read as they come.
const MANY: usize = 64;
/// So many faces are read between two looks at how much was read. Each of them may read this part of what may be read at
/// all; what that does not reach is read again in its turn, so that what is refused does not depend on threads.
const ROUND: usize = 64;

/// Surfaces by their numbers.
pub(super) type Ready = HashMap<u64, Expanse>;

/// Reads the spline surfaces of faces. What is wrong with one of them is told when it comes.
pub(super) fn ahead(space: &Space<'_>, faces: &[u64], threads: usize, ready: &mut Ready) {
    if faces.len() < MANY {
        return;
    }
    for round in faces.chunks(ROUND) {
        if space.file.is_spent() {
            return;
        }
        let before = space.file.reads();
        let read = |i: usize| {
            let file = space.file.view(ROUND as u64);
            let space = Space {
                file: &file,
                ..space.clone()
            };
            let surface = surface(&space, round[i], ready);
            (surface.ok().flatten(), file.reads() - before)
        };
        let found = parallel::each(threads, round.len(), read, |_| false);
        for (surface, reads) in found {
            space.file.add_reads(reads);
            ready.extend(surface);
        }
    }
}

/// The number and the surface of a face; `None` if it is no spline or has been read.
fn surface(space: &Space<'_>, face: u64, ready: &Ready) -> Got<Option<(u64, Expanse)>> {
    let face = space.file.record(face)?;
    if !matches!(face.kind(), "ADVANCED_FACE" | "FACE_SURFACE") {
        return Ok(None);
    }
    let id = face.args().reference(2)?;
    let kind = space.file.kind(id);
    if ready.contains_key(&id) || !kind.contains("SURFACE") {
        return Ok(None);
    }
    let record = space.file.record(id)?;
    if !splines::is_surface(&record) {
        return Ok(None);
    }
    let surface = splines::surface(space, &record)?;
    Ok(Some((id, Expanse::Bounded(Arc::new(surface)))))
}
