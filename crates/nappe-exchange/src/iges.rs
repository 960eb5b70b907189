//! IGES 5.3: exact curves, surfaces, trimmed faces and solids.
//!
//! Reading takes over: curves 100, 102, 104, 106 (forms 1–3, 11–13, 63), 110, 112, 126; points 116; surfaces 108, 114, 118,
//! 120, 122, 128; faces 143 with 141 and 144 with 142; shells and solids 510, 514, 186, also on the surfaces 190, 192, 194,
//! 196 and 198; placements 124; subfigures 308 and 408; colours 314; names of the property 406 (form 15) and labels.
//! Everything else is listed with its reason.
//!
//! [`write()`] puts out 110, 126, 128 and 116, as 144 with 142, or as 514 and 186; names (406) and colours (314).
//!
//! Source: US Product Data Association, *Initial Graphics Exchange Specification IGES 5.3*, 1996.

mod bodies;
mod conic;
mod curves;
mod document;
mod file;
mod out;
mod record;
mod space;
mod surfaces;
#[cfg(test)]
mod tests;
mod trimmed;
mod write;

pub(crate) use curves::placed;
pub(crate) use document::read;
pub(crate) use write::write_telling;
pub use write::{IgesOptions, IgesReport, write};
