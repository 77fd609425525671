//! Results to files: tables, `result.json`, charts, pictures and ParaView files.
//!
//! Knows: tables, pictures, words, checks, the report, provenance, folders that are whole or absent, US units in what is written.
//! Must not know: scenes, studies, terminals, networks.
//!
//! Imports `calibration` and what it imports, and `tables` for Parquet.
//!
//! A run writes into an [`output::OutputFolder`], which appears under its name only once it is whole.

pub mod answers;
pub mod band;
pub mod chart;
pub mod checks;
pub mod curve;
pub mod factors;
pub mod fit;
#[cfg(feature = "tables")]
pub mod frames;
pub mod fleet;
pub mod format;
pub mod record;
pub mod model_words;
pub mod output;
pub mod paper;
pub mod pictures;
pub mod provenance;
pub mod run;
pub mod spectrum;
pub mod specimen_picture;
pub mod stresses;
pub mod sweep;
pub mod snapshots;

pub mod axis;
