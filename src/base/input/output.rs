//! What a run leaves beside its tables and pictures: `[output]` of a case or a scene.

use serde::Deserialize;
use toml::Value;

use super::slice;
use crate::error::Result;

/// Keys of `[output]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// Whether the fields of some moments are written for ParaView, which takes most of the room of a run.
    pub paraview: bool,
    /// Whether a run draws its cracks as they grow.
    pub animation: bool,
}

impl Output {
    /// Reads the section.
    pub fn from_value(value: &Value) -> Result<Self> {
        slice(value, "output")
    }
}
