//! What a run leaves beside its tables and pictures: `[output]` of a case or a scene.

use toml::Value;

use crate::error::Result;
use crate::keys::{key, section};

crate::keys! {
    /// Keys of `[output]`.
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
