//! The model file `*.nappe.toml`: read, diagnosed, resolved, built.
//!
//! [`load`] reads a file, [`parse`] a text; both give a [`Model`] with the kernel's curves and surfaces, or
//! [`Diagnostics`]: everything that is wrong, each with file, line, column, the numbers and a remedy.
//!
//! ```
//! let text = r#"
//! nappe = 1
//! [params]
//! size = 2
//! [surfaces.floor]
//! kind = "bilinear"
//! corners = [[[0, 0, 0], [0, "size", 0]], [["size", 0, 0], ["size", "size", 1]]]
//! "#;
//! let model = nappe_model::parse(text, "floor.nappe.toml", &Default::default()).expect("a model without faults");
//! assert_eq!(model.surfaces[0].name, "floor");
//! assert_eq!(model.surfaces[0].surface.point([1.0, 1.0]).z, 1.0);
//!
//! let faults = nappe_model::parse(&text.replace("bilinear", "bilinaer"), "floor.nappe.toml", &Default::default());
//! let text = faults.expect_err("a misspelt kind").to_string();
//! assert!(text.starts_with("floor.nappe.toml:6:8: ") && text.contains("did you mean \"bilinear\"?"));
//! ```
//!
//! The kinds of curves and surfaces and their keys are listed once, in [`registry`]; [`schema`] makes the JSON Schema
//! of the file from that list.
//!
//! Limits, each with its own message: [`MAX_FILE`] bytes, [`MAX_OBJECTS`] curves and surfaces, [`MAX_PARAMETERS`]
//! parameters, references nested [`MAX_REFERENCE_DEPTH`] deep; and those of expressions
//! ([`nappe::expr::MAX_LENGTH`], [`nappe::expr::MAX_DEPTH`]).

mod blend;
mod build;
mod checks;
mod coons;
mod curves;
mod data;
mod decode;
mod diagnostics;
mod diagonal_key;
mod drawing;
mod fillet;
mod import;
mod join;
mod model;
mod params;
mod rational;
mod reader;
pub mod registry;
mod round;
mod schema;
mod surfaces;
mod traced;
mod value;
mod velocity;

pub use checks::{Check, CheckSide, CheckTolerance, Continuity};
pub use diagnostics::{Diagnostic, Diagnostics, Label, Severity};
pub use drawing::RenderStyle;
pub use import::{Imported, ImportedCurve, ImportedFace, Importer};
pub use model::{Join, Model, NamedCurve, NamedSurface};
pub use nappe::Units;
pub use params::Parameter;
pub use reader::{Overrides, load, load_with, parse, parse_with};
pub use schema::schema;
pub use velocity::{Velocities, Velocity, velocities};

/// The largest file in bytes.
pub const MAX_FILE: usize = 64 << 20;
/// The greatest number of curves and surfaces.
pub const MAX_OBJECTS: usize = 200_000;
/// The greatest number of parameters.
pub const MAX_PARAMETERS: usize = 2_000;
/// The greatest length of a chain of objects that refer to each other.
pub const MAX_REFERENCE_DEPTH: usize = 64;
