//! Whether a table of a folder is still the one that its run wrote, by what the result beside it says.

use std::path::Path;

use serde_json::Value;

use super::curve::Row;
use super::record::RESULT_FILE;
use perilife_base::columns::{AGAIN, Table};
use perilife_base::error::{Error, InputError, Result};
use perilife_base::input::{Opened, sha256};
use perilife_base::units::us::System;

/// A file of results that is not as it was written.
pub(crate) fn refuse(path: &Path, problem: String) -> Error {
    Error::Input(Box::new(InputError {
        file: Some(path.to_path_buf()),
        problem,
        remedy: AGAIN.to_owned(),
        ..InputError::default()
    }))
}

/// What a result says of one of its tables; `None` of an earlier version.
pub fn listed<'r>(result: &'r Value, name: &str) -> Option<&'r Value> {
    result["tables"].as_array().into_iter().flatten().find(|entry| entry["file"] == name)
}

/// Compares a table with the entry of a result about it.
/// Errors: one that is cut off, or not the one that was written; `by` names the file that says so.
pub fn check_listed(path: &Path, table: &[u8], entry: &Value, by: &str) -> Result<()> {
    let bytes = entry["bytes"].as_u64().unwrap_or(0);
    match table.len() as u64 {
        length if length < bytes => Err(refuse(path, format!("is cut off: {length} of the {bytes} bytes that the run wrote"))),
        _ if entry["sha256"] != sha256(table) => Err(refuse(path, format!("is not the table that the run wrote, by {by}"))),
        _ => Ok(()),
    }
}

/// The rows of the curve of a folder, as its run wrote it by the `result.json` beside it (without that file there is nothing to compare
/// with), and the units of its text.
/// Errors: a table that is not as it was written.
pub fn curve(folder: &Path, name: &str, opened: &Opened) -> Result<(Vec<Row>, System)> {
    let (path, beside) = (folder.join(name), folder.join(RESULT_FILE));
    let bytes = opened.read(&path, name)?;
    let rows = || {
        let table = Table::read(&String::from_utf8_lossy(&bytes), &path)?;
        Ok((Row::of_table(&table)?, table.units))
    };
    if !beside.is_file() {
        return rows();
    }
    let Ok(result) = serde_json::from_slice::<Value>(&opened.read(&beside, RESULT_FILE)?) else {
        return Err(refuse(&path, format!("cannot be checked: {RESULT_FILE} is truncated or damaged")));
    };
    if let Some(entry) = listed(&result, name) {
        check_listed(&path, &bytes, entry, RESULT_FILE)?;
        return rows();
    }
    // A run of an earlier version says its life alone.
    let (rows, units) = rows()?;
    match (result["life_cycles"].as_f64(), rows.last().map(|row| row.cycles)) {
        (Some(life), Some(last)) if last < life => Err(refuse(&path, format!("ends at {last} cycles, and the run at {life}"))),
        _ => Ok((rows, units)),
    }
}
