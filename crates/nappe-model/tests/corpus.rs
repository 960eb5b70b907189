//! The corpus that fuzzing left: every text is a model or a list of diagnostics that name the file.
#![allow(clippy::unwrap_used)]

use std::path::Path;

#[test]
fn every_text_of_the_fuzz_corpus_is_read_or_refused() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/model");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let bytes = std::fs::read(entry.unwrap().path()).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        if let Err(faults) = nappe_model::parse(&text, "corpus.nappe.toml", &Default::default()) {
            assert!(faults.to_string().contains("corpus.nappe.toml"), "{faults}");
        }
        seen += 1;
    }
    assert!(seen > 50, "the corpus has {seen} texts");
}
