//! Do the doors work?

mod band;
mod calibrate;
mod check;
pub mod cli;
mod doors;
mod ends;
mod export;
mod fleet;
mod fracture;
mod laws;
mod nothing_lost;
mod part_through;
pub mod practice;
mod rates;
mod readme;
mod report;
mod service;
mod sif;
mod spectrum;
mod sweep;
mod traceable;
mod units;
mod studies;
mod bad_files;
mod checkpoint;
mod methods;
