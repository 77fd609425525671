//! Do the doors work?

#[path = "interface/bad_toml.rs"]
mod bad_toml;
