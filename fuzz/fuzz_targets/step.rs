//! Any bytes are either a STEP file or an error with its place; never a panic, a hang or memory out of proportion. What
//! was read can be looked at.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nappe_exchange::step;

fuzz_target!(|bytes: &[u8]| {
    match step::read(bytes) {
        Ok(file) => {
            for item in &file.document.items {
                if let nappe_exchange::ItemForm::Body { body, .. } = &item.form {
                    let _ = std::hint::black_box(body.validate(1.0));
                }
            }
        }
        Err(e) => {
            std::hint::black_box(e.to_string());
        }
    }
});
