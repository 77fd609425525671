//! Does each part do its job?

#[path = "support/made_up_run.rs"]
mod made_up_run;

#[path = "unit/report.rs"]
mod report;
