//! Files with random faults: no panic, no hang.

use crate::{sewn, shared, wave, written};
use nappe::{DVec3, Units};
use nappe_exchange::step::{self, Schema};
use std::time::Instant;

/// Numbers from Knuth's linear congruence.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % n.max(1)
    }
}

fn mutated(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let mut out = bytes.to_vec();
    for _ in 0..=random.below(4) {
        let at = random.below(out.len());
        let length = 1 + random.below(30);
        let end = (at + length).min(out.len());
        match random.below(6) {
            0 => {
                out[at] = *b"0123456789#(),.'$*;=/\\-E\xff"
                    .get(random.below(25))
                    .unwrap()
            }
            1 => drop(out.drain(at..end)),
            2 => {
                let part = out[at..end].to_vec();
                out.splice(at..at, part);
            }
            3 => {
                // Another number in the place of one.
                if let Some(n) = out[at..].iter().position(u8::is_ascii_digit) {
                    let word: &[u8] =
                        [&b"1E308"[..], b"-1.", b"0", b"99999", b"1E-320"][random.below(5)];
                    out.splice(at + n..=at + n, word.iter().copied());
                }
            }
            4 => {
                let to = random.below(out.len());
                let part = out[at..end].to_vec();
                out.splice(to..to, part);
            }
            _ => {
                if random.below(10) == 0 {
                    out.truncate(at.max(1));
                }
            }
        }
    }
    out
}

#[test]
fn no_fault_makes_a_reader_panic_or_hang() {
    let mut files = vec![written(
        &sewn(&[wave(5, 4, DVec3::ZERO, 1.0)], Units::Inch),
        Schema::Ap242,
    )];
    if let Some(shared) = shared() {
        for name in [
            "truck/occt-cone.step",
            "truck/occt-torus.step",
            "truck/abc-0008.step",
        ] {
            files.push(std::fs::read(shared.join(name)).unwrap());
        }
    }
    let mut random = Random(7);
    let (mut read, mut slowest) = (0, 0.0f64);
    for round in 0..400 {
        let bytes = mutated(&files[round % files.len()], &mut random);
        let start = Instant::now();
        if let Ok(file) = step::read(&bytes) {
            read += 1;
            assert!(
                !file.document.items.is_empty()
                    || !file.document.left_out.is_empty()
                    || file.entities < 2000
            );
        }
        slowest = slowest.max(start.elapsed().as_secs_f64());
    }
    assert!(
        read > 40,
        "{read}: too many files are refused at once to say anything"
    );
    assert!(slowest < 20.0, "{slowest} s");
}
