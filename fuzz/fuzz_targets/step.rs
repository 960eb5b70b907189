//! Any bytes are either a STEP file or an error with its place; never a panic, a hang or memory out of proportion. What
//! was read can be looked at.
#![no_main]

#[path = "../../crates/nappe-exchange/tests/fuzz/look.rs"]
#[allow(dead_code)]
mod look;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| look::look_step(bytes));
