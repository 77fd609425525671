//! What a run leaves beside its tables and pictures: `[output]` of a case or a scene.

use toml::Value;

use crate::error::Result;
use crate::keys::{key, section};

crate::keys! {
    /// Keys of `[output]`.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
    pub struct Output {
        /// Whether the fields of some moments are written for ParaView, which takes most of the room of a run.
        paraview: bool = key("paraview", "ParaView: also the fields of some moments"), or "false" false;
        /// Whether a run draws its cracks as they grow.
        animation: bool = key("animation", "Animation: also growth.svg, the cracks as they grow"), or "false" false;
    }
}

impl Output {
    /// Reads the section.
    pub fn from_value(value: &Value) -> Result<Self> {
        section(value, "output")
    }
}
