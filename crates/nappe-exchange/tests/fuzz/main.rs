//! Valid files with faults, of every format that is read: no panic, no hang, no memory out of proportion.
//!
//! The faults are the same in every run. `NAPPE_FUZZ_SECONDS` asks for so many seconds for each format, and
//! `NAPPE_FUZZ_SEED` for other ones (see `cargo xtask fuzz`). Bytes that fail are kept in the folder for temporary files.

#![allow(clippy::unwrap_used)]

mod faults;
mod look;
mod seeds;
mod watch;

use faults::Random;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};
use watch::Watch;

/// Files of a format in a run that is not told how long to take.
const FILES: usize = 150;

fn asked(name: &str) -> Option<u64> {
    std::env::var(name).ok()?.parse().ok()
}

#[test]
fn no_file_makes_a_reader_panic_hang_or_grow() {
    let seconds = asked("NAPPE_FUZZ_SECONDS").map(Duration::from_secs);
    let seed = asked("NAPPE_FUZZ_SEED").unwrap_or(20_261_128);
    let watch = Watch::start();
    let mut failed = Vec::new();
    for ending in ["step"].into_iter().chain(look::ENDINGS) {
        let seeds = seeds::of(ending);
        assert!(!seeds.is_empty(), "{ending}");
        let mut random = Random(seed);
        let (start, mut files, mut slowest) = (Instant::now(), 0, Duration::ZERO);
        while seconds.map_or(files < FILES, |s| start.elapsed() < s) {
            // The seeds themselves first.
            let bytes = match seeds.get(files) {
                Some(whole) => whole.clone(),
                None => faults::file(ending, &seeds[files % seeds.len()], &mut random),
            };
            watch.begin(ending, &bytes);
            let one = Instant::now();
            let looked = catch_unwind(AssertUnwindSafe(|| match ending {
                "step" => look::look_step(&bytes),
                _ => look::look(ending, &bytes),
            }));
            slowest = slowest.max(one.elapsed());
            watch.end();
            if looked.is_err() {
                failed.push(watch::keep(ending, &bytes, "panics"));
            }
            files += 1;
        }
        eprintln!("{ending}: {files} files, the slowest took {slowest:.2?}");
    }
    assert!(failed.is_empty(), "panics: {failed:#?}");
}

/// Valid files are read: what is made of them is more than noise.
#[test]
fn seeds_are_read() {
    use nappe_exchange::read::read_bytes;
    for ending in look::ENDINGS {
        for seed in seeds::of(ending) {
            let read = read_bytes(ending, &seed);
            assert!(read.is_ok(), "{ending}: {:?}", read.err());
        }
    }
    for seed in seeds::of("step") {
        let read = nappe_exchange::step::read(&seed).unwrap();
        assert!(!read.document.items.is_empty());
    }
}
