//! All tests, in one program: one link, one pool of threads, runs that several tests look at done once.
//! `cargo test unit::` or `cargo test interface::service` selects.

mod interface;
mod unit;
mod validation;
mod verification;

/// What several tests share.
mod support {
    pub mod browser;
    pub mod correspondence;
    pub mod daily;
    pub mod desk;
    pub mod fatigue_test;
    pub mod field;
    pub mod fits;
    pub mod hand_cases;
    pub mod installed;
    pub mod lab;
    pub mod made_up_case;
    pub mod made_up_run;
    pub mod median;
    pub mod nginx;
    pub mod noise;
    pub mod plates;
    pub mod postgres;
    pub mod rows;
    pub mod scenes;
    pub mod server;
    pub mod shared;
    pub mod slurm;
    pub mod statics;
    pub mod workbook;
    pub mod written;
}
