//! Do the doors work?

#[path = "support/made_up_run.rs"]
mod made_up_run;

#[path = "interface/bad_csv.rs"]
mod bad_csv;
#[path = "interface/cli.rs"]
mod cli;
#[path = "interface/export.rs"]
mod export;
#[path = "interface/bad_toml.rs"]
mod bad_toml;
