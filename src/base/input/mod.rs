//! Reading input files: TOML text to checked slices, every error with file, line, key, value and remedy.
//!
//! Sections are declared by their keys ([`keys`](mod@crate::keys)); numbers pass through a [`Quantity`], which refuses what is not finite or
//! beyond reason and converts to SI. [`Document`] holds the text, so that an error about a key finds its line.

mod document;
mod folder;
mod output;
mod quantity;
mod slice;
mod us_keys;

pub use document::{Document, ForeignSections, Sections};
pub use folder::{FileId, Folder, Opened, OpenedFile, Provenance, STREAM, sha256};
pub use output::Output;
pub use quantity::*;
pub use slice::{LEVELS_OF_SCENES, OF_SCENES, PLANNED, number_of, shorten, slice, table_of, value_at};
