//! Do the doors work?

mod bad_csv;
mod bad_scenes;
mod bad_sweeps;
mod bad_toml;
mod calibrate;
mod chart;
mod check;
mod checkpoint;
pub mod cli;
mod doors;
mod element_free;
mod ends;
mod export;
mod fracture;
mod hand_calculation;
mod laws;
mod nothing_lost;
mod practice;
mod rates;
mod service;
mod sif;
mod stability;
mod sweep;
mod time_limit;
mod tip_field;
mod traceable;
mod verify;
