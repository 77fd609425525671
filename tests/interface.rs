//! Do the doors work?

#[path = "support/browser.rs"]
mod browser;
#[path = "support/daily.rs"]
mod daily;
#[path = "support/fatigue_test.rs"]
mod fatigue_test;
#[path = "support/made_up_run.rs"]
mod made_up_run;
#[path = "support/nginx.rs"]
mod nginx;
#[path = "support/noise.rs"]
mod noise;
#[path = "support/postgres.rs"]
mod postgres;
#[path = "support/server.rs"]
mod server;
#[path = "support/slurm.rs"]
mod slurm;

#[path = "interface/tip_field.rs"]
mod tip_field;
#[path = "interface/bad_csv.rs"]
mod bad_csv;
#[path = "interface/bad_sweeps.rs"]
mod bad_sweeps;
#[path = "interface/bad_toml.rs"]
mod bad_toml;
#[path = "interface/chart.rs"]
mod chart;
#[path = "interface/calibrate.rs"]
mod calibrate;
#[path = "interface/check.rs"]
mod check;
#[path = "interface/checkpoint.rs"]
mod checkpoint;
#[path = "interface/cli.rs"]
mod cli;
#[path = "interface/doors.rs"]
mod doors;
#[path = "interface/export.rs"]
mod export;
#[path = "interface/bad_scenes.rs"]
mod bad_scenes;
#[path = "interface/fracture.rs"]
mod fracture;
#[path = "interface/element_free.rs"]
mod element_free;
#[path = "interface/time_limit.rs"]
mod time_limit;
#[path = "interface/ends.rs"]
mod ends;
#[path = "interface/hand_calculation.rs"]
mod hand_calculation;
#[path = "interface/laws.rs"]
mod laws;
#[path = "interface/nothing_lost.rs"]
mod nothing_lost;
#[path = "interface/rates.rs"]
mod rates;
#[path = "interface/service.rs"]
mod service;
#[path = "interface/sif.rs"]
mod sif;
#[path = "interface/stability.rs"]
mod stability;
#[path = "interface/sweep.rs"]
mod sweep;
#[path = "interface/traceable.rs"]
mod traceable;
#[path = "interface/verify.rs"]
mod verify;
