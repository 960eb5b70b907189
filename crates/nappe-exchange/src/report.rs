//! What was asked of a writer and what it did.

use crate::format::Format;
use crate::render::PictureOptions;
use crate::step::Schema;
use nappe::mesh::Certainty;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// How to write.
#[derive(Clone, Debug, Default)]
pub struct WriteOptions<'a> {
    /// Told the finished share, from 0 to 1, now and then.
    pub progress: Progress<'a>,
    /// How `.png` and `.svg` are drawn.
    pub picture: PictureOptions,
    /// How far a curve or surface that has no exact form may be from what stands for it in `.step`; by default a
    /// thousandth of a millimetre.
    pub tolerance: Option<f64>,
    /// The standard that `.step` follows.
    pub schema: Schema,
}

/// Somebody to tell how far a long work is; by default nobody.
#[derive(Clone, Copy, Default)]
pub struct Progress<'a>(Option<&'a (dyn Fn(f64) + Sync)>);

impl<'a> Progress<'a> {
    /// Calls this with the finished share, from 0 to 1.
    pub fn to(listener: &'a (dyn Fn(f64) + Sync)) -> Progress<'a> {
        Progress(Some(listener))
    }

    pub(crate) fn tell(self, share: f64) {
        if let Some(listener) = self.0 {
            listener(share);
        }
    }
}

impl std::fmt::Debug for Progress<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if self.0.is_some() {
            "Progress(listener)"
        } else {
            "Progress(nobody)"
        })
    }
}

/// Steps between two reports: seldom enough to cost nothing.
const STEPS_PER_REPORT: u64 = 1 << 14;

/// Counts the steps of one piece of work.
pub(crate) struct Ticker<'a> {
    progress: Progress<'a>,
    done: u64,
    total: u64,
}

impl<'a> Ticker<'a> {
    pub(crate) fn new(progress: Progress<'a>, total: usize) -> Ticker<'a> {
        Ticker {
            progress,
            done: 0,
            total: total as u64,
        }
    }

    pub(crate) fn step(&mut self) {
        self.done += 1;
        if self.done.is_multiple_of(STEPS_PER_REPORT) {
            self.progress
                .tell((self.done as f64 / self.total.max(1) as f64).min(1.0));
        }
    }
}

/// Counts the steps of one piece of work that several threads share.
pub(crate) struct Shares<'a> {
    progress: Progress<'a>,
    done: AtomicUsize,
    total: usize,
}

impl<'a> Shares<'a> {
    pub(crate) fn new(progress: Progress<'a>, total: usize) -> Shares<'a> {
        Shares {
            progress,
            done: AtomicUsize::new(0),
            total: total.max(1),
        }
    }

    /// Tells of a step that has taken long enough for that.
    pub(crate) fn step(&self) {
        let done = self.done.fetch_add(1, Relaxed) + 1;
        self.progress
            .tell((done as f64 / self.total as f64).min(1.0));
    }
}

/// What a writer put into its file.
#[derive(Clone, Debug, PartialEq)]
pub struct WriteReport {
    /// The file.
    pub path: PathBuf,
    /// Its format.
    pub format: Format,
    /// Its size.
    pub bytes: u64,
    /// Triangles written; of an SVG, shapes; 0 for exact geometry.
    pub triangles: usize,
    /// Triangles left out because two of their corners are the same number in the file. Their neighbours meet across
    /// them, so the mesh stays watertight.
    pub dropped_degenerate: usize,
    /// Triangles written though their three corners, as stored, lie on one line: leaving them out would open a slit.
    /// Their stored normal is that of the exact corners.
    pub kept_slivers: usize,
    /// The farthest that rounding to the format's numbers moved a point, in the scene's units; 0 if it stores f64.
    pub rounding: f64,
    /// The deviation of the stored mesh from the surfaces: that of the mesh with `rounding` added.
    pub deviation: Certainty,
    /// Anything a person should know, in full sentences; empty if all is as expected.
    pub notes: Vec<String>,
}

/// What a format's writer counts while it writes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) triangles: usize,
    pub(crate) dropped: usize,
    pub(crate) slivers: usize,
    pub(crate) rounding: f64,
    pub(crate) notes: Vec<String>,
}
