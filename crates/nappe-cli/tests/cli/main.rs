//! The command as a user runs it: the built binary, its files, its output and its exit codes.

#![allow(clippy::unwrap_used)]

mod eval;
mod examples;
mod help;
mod run;
