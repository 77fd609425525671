//! Do the doors work?

<<<<<<< HEAD
#[path = "support/made_up_run.rs"]
mod made_up_run;

#[path = "interface/bad_csv.rs"]
mod bad_csv;
#[path = "interface/cli.rs"]
mod cli;
#[path = "interface/export.rs"]
mod export;
=======
#[path = "interface/bad_toml.rs"]
mod bad_toml;
>>>>>>> 4fb3fff3a70816874743efc0ef8d5539fdf8b594
