//! Any text is either a model or a list of diagnostics; never a panic, a hang or memory out of proportion.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match nappe_model::parse(text, "fuzz.nappe.toml", &Default::default()) {
        Ok(model) => {
            for s in &model.surfaces {
                let [u, v] = s.surface.domain();
                std::hint::black_box(s.surface.point([u.mid(), v.mid()]));
            }
        }
        Err(faults) => {
            std::hint::black_box(faults.to_string());
        }
    }
});
