//! Does each part do its job?

#[path = "unit/case.rs"]
mod case;
#[path = "unit/handbook.rs"]
mod handbook;
#[path = "unit/loading.rs"]
mod loading;
#[path = "unit/specimen.rs"]
mod specimen;
