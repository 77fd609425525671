//! Output that is whole or absent, and touches nothing of anybody else: the one guard of whatever a command writes.
//!
//! A folder of results ([`OutputFolder`]) is made under a temporary name and published at the end. Its marker ([`Marker`], file
//! `.perilife`) says of which kind the run is and which files are its own; a later run of the same kind replaces those and refuses
//! to begin where there is anything else, an input of its own above all. The same is checked again at the end, of the folder as it is
//! then. A single file ([`OutputFile`]) replaces only one with the sign of the same command, and never one that was read. Who
//! writes takes a lock, so that two never write one place, and what a killed process left behind is recognized.

mod file;
mod folder;
mod lock;
mod marker;
mod staging;

pub use file::{OutputFile, Sort, write_file};
pub use folder::{LockedFolder, OutputFolder, Room};
pub use lock::Share;
pub use marker::{Marker, RunKind};
pub use staging::{MARKER, fold_up, is_temporary};

use std::path::Path;

use serde::Serialize;

use perilife_base::columns::Table;
use perilife_base::error::{Error, Result};

/// Writes a table into a folder in the making, in the units that are shown.
pub fn write_table(folder: &Path, table: &Table) -> Result<()> {
    write_file(&folder.join(&table.file), table.csv().as_bytes())
}

/// Writes a result into a folder in the making, in the units that are shown.
pub fn write_json(folder: &Path, name: &str, result: &impl Serialize) -> Result<()> {
    // Results are numbers, text and keys, which all have a form in JSON.
    let result = serde_json::to_value(result).unwrap_or_default();
    write_file(&folder.join(name), format!("{:#}\n", super::units::shown_result(&result)).as_bytes())
}

/// An error with something more to say at its end.
fn said(error: Error, more: &str) -> Error {
    match error {
        Error::Input(mut trouble) => {
            trouble.remedy = format!("{}; {more}", trouble.remedy);
            Error::Input(trouble)
        }
        Error::File { path, action, source } => {
            Error::File { path, action, source: std::io::Error::new(source.kind(), format!("{source}; {more}")) }
        }
        other => Error::Mechanics(format!("{other}; {more}")),
    }
}
