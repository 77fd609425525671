//! Reading input files: TOML text to checked slices, every error with file, line, key, value and remedy.
//!
//! Sections are declared by their keys ([`keys`](mod@crate::keys)); numbers pass through a [`Quantity`], which refuses what is not finite or
//! beyond reason and converts to SI. [`Document`] holds the text, so that an error about a key finds its line.

mod document;
mod folder;
mod quantity;
mod slice;
mod us_keys;

pub use document::{Document, ForeignSections, Sections};
pub use folder::{FileId, Folder, Opened, OpenedFile, Provenance, STREAM, sha256};
pub use quantity::*;
pub use slice::{LEVELS_OF_SCENES, OF_SCENES, PLANNED, number_of, shorten, slice, table_of, value_at};

use toml::Value;

use crate::error::Result;
use crate::keys::{key, section};

crate::keys! {
    /// What a run leaves beside its tables and pictures: `[output]` of a case or a scene.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    pub struct Output {
        paraview: bool = key("paraview", "ParaView files: fields at several stages"), or "false" false;
        animation: bool = key("animation", "Animation: growth.svg of the growing cracks"), or "false" false;
        tables_only: bool = key("tables_only", "Tables only: no pictures"), or "false" false;
    }
}

impl Output {
    pub fn from_value(value: &Value) -> Result<Self> {
        section(value, "output")
    }
}
