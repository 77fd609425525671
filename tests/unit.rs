//! Does each part do its job?

#[path = "support/noise.rs"]
mod noise;

#[path = "unit/confidence.rs"]
mod confidence;
#[path = "unit/measured.rs"]
mod measured;
#[path = "unit/misfit.rs"]
mod misfit;
#[path = "unit/rates.rs"]
mod rates;
#[cfg(feature = "tables")]
#[path = "unit/tables.rs"]
mod tables;
