//! A thread that ends the run where a reader takes too long or too much memory: neither can be stopped from outside.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

/// The most time for one file, in a build that is hardly optimized, on a machine that does other things as well.
const TIME: Duration = Duration::from_secs(20);
/// The most memory in bytes that a file of some hundred kB may take.
const MEMORY: u64 = 1 << 30;
const PAUSE: Duration = Duration::from_millis(20);

/// A file that is being read: since when, its ending and bytes, and the memory before.
type Job = Option<(Instant, String, Vec<u8>, u64)>;

pub(crate) struct Watch(Arc<Mutex<Job>>);

impl Watch {
    pub(crate) fn start() -> Watch {
        let job: Arc<Mutex<Job>> = Arc::default();
        let seen = job.clone();
        thread::spawn(move || {
            loop {
                thread::sleep(PAUSE);
                let job = seen.lock().unwrap();
                if let Some((since, ending, bytes, before)) = &*job {
                    let more = memory().saturating_sub(*before);
                    let why = if since.elapsed() > TIME {
                        "takes too long"
                    } else if more > MEMORY {
                        "takes too much memory"
                    } else {
                        continue;
                    };
                    eprintln!("{:?} {why}", keep(ending, bytes, why));
                    std::process::exit(1);
                }
            }
        });
        Watch(job)
    }

    pub(crate) fn begin(&self, ending: &str, bytes: &[u8]) {
        let job = (Instant::now(), ending.to_owned(), bytes.to_vec(), memory());
        *self.0.lock().unwrap() = Some(job);
    }

    pub(crate) fn end(&self) {
        *self.0.lock().unwrap() = None;
    }
}

/// The resident memory of this process in bytes; 0 on systems that do not tell it in a file.
fn memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmRSS:"));
    let number = line.and_then(|l| l.split_whitespace().next()?.parse::<u64>().ok());
    number.unwrap_or(0) << 10
}

/// Keeps bytes that fail, and tells where.
pub(crate) fn keep(ending: &str, bytes: &[u8], why: &str) -> PathBuf {
    let sum = bytes.iter().fold(0u32, |a, b| {
        a.wrapping_mul(16_777_619).wrapping_add(u32::from(*b))
    });
    let why = why.replace(' ', "-");
    let path = std::env::temp_dir().join(format!("nappe-{why}-{sum:08x}.{ending}"));
    let _ = std::fs::write(&path, bytes);
    path
}
