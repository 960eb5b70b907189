//! What can be wrong with a STEP file as a whole.

/// A STEP file that cannot be read. What is wrong with one entity only is left out and listed
/// ([`LeftOut`](crate::LeftOut)) instead.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages name every field
pub enum StepError {
    #[error(
        "line {line}: this is not a STEP file; it should begin with `ISO-10303-21;`, but begins with `{found}`"
    )]
    NotStep { line: usize, found: String },
    #[error(
        "line {line}: the file ends inside {what} that begins here; is it cut off? Ask for it again"
    )]
    CutOff { line: usize, what: &'static str },
    #[error("line {line}: {what} expected, `{found}` found")]
    Syntax {
        line: usize,
        what: &'static str,
        found: String,
    },
    #[error(
        "line {line}: the number of the entity `#{digits}…` is larger than any that can be read"
    )]
    Number { line: usize, digits: String },
    #[error("lines {} and {}: #{id} is there twice; which one is meant is not known", lines[0], lines[1])]
    Twice { id: u64, lines: [usize; 2] },
    #[error("the file has more than {most} entities")]
    TooMany { most: usize },
    #[error("the file has no DATA section")]
    NoData,
}
