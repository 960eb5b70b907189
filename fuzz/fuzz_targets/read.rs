//! Any bytes are either a file of the format that the first of them chooses, or an error with its place; never a panic, a hang
//! or memory out of proportion. What was read can be measured and made a scene.
#![no_main]

#[path = "../../crates/nappe-exchange/tests/fuzz/look.rs"]
#[allow(dead_code)]
mod look;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Some((choice, bytes)) = bytes.split_first() {
        let ending = look::ENDINGS[usize::from(*choice) % look::ENDINGS.len()];
        look::look(ending, bytes);
    }
});
