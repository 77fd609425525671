//! Results to files: tables, `result.json`, charts, pictures and ParaView files.
//!
//! A run writes into an [`output::OutputFolder`], which appears under its name only once it is whole.

pub mod answers;
pub mod band;
pub mod catalogue;
pub mod chart;
pub mod checks;
pub mod csv;
pub mod damage;
pub mod digits;
pub mod factor_sweep;
pub mod factors;
pub mod fit;
pub mod fleet;
pub mod fit_use;
pub mod fracture;
pub mod inspections;
pub mod json;
pub mod model_words;
pub mod output;
pub mod paper;
pub mod pictures;
pub mod provenance;
pub mod resample;
pub mod quality;
pub mod run;
pub mod sensitivities;
pub mod spectrum;
pub mod speed;
pub mod specimen_picture;
pub mod stability;
pub mod stability_picture;
pub mod stresses;
pub mod sweep;
pub mod test_record;
pub mod time;
pub mod units;
pub mod verification;
pub mod vtk;

mod axis;
pub mod labels;
mod raster;
