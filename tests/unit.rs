//! Does each part do its job?

#[path = "support/made_up_case.rs"]
mod made_up_case;
#[path = "support/made_up_run.rs"]
mod made_up_run;

#[path = "unit/commands.rs"]
mod commands;
#[path = "unit/layering.rs"]
mod layering;
#[path = "unit/output.rs"]
mod output;
#[path = "unit/pictures.rs"]
mod pictures;
#[path = "unit/report.rs"]
mod report;
#[path = "unit/case.rs"]
mod case;
#[path = "unit/handbook.rs"]
mod handbook;
#[path = "unit/loading.rs"]
mod loading;
#[path = "unit/specimen.rs"]
mod specimen;
