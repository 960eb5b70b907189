//! The command as a user runs it: the built binary, its files, its output and its exit codes.

#![allow(clippy::unwrap_used)]

mod bad_input;
mod build;
mod check;
mod eval;
mod examples;
mod files;
mod files_back;
mod help;
mod info;
mod intersect;
mod peers;
mod peers_files;
mod project;
mod render;
mod run;
