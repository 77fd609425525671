//! Whether a table of a folder is still the one that its run wrote, by what the result beside it says.

use std::path::Path;

use serde_json::Value;

use super::curve::Row;
use super::record::RESULT_FILE;
use perilife_base::columns::Table;
use perilife_base::error::{Error, InputError, Result};
use perilife_base::input::{Opened, sha256};

fn refuse(path: &Path, problem: String) -> Error {
    let remedy = "copy the folder again, or run the case again".to_owned();
    Error::Input(Box::new(InputError { file: Some(path.to_path_buf()), problem, remedy, ..InputError::default() }))
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

/// The rows of the curve of a folder, as its run wrote it by the `result.json` beside it; without that file there is nothing to compare with.
/// Errors: a table that is not as it was written.
pub fn curve(folder: &Path, name: &str, opened: &Opened) -> Result<(Vec<Row>, String)> {
    let (path, beside) = (folder.join(name), folder.join(RESULT_FILE));
    let bytes = opened.read(&path, name)?;
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let rows = || Row::of_table(&Table::read(&text, &path)?);
    if !beside.is_file() {
        return Ok((rows()?, text));
    }
    let Ok(result) = serde_json::from_slice::<Value>(&opened.read(&beside, RESULT_FILE)?) else {
        return Err(refuse(&path, format!("stands beside a {RESULT_FILE} that is cut off or damaged")));
    };
    if let Some(entry) = listed(&result, name) {
        check_listed(&path, &bytes, entry, RESULT_FILE)?;
        return Ok((rows()?, text));
    }
    // A run of an earlier version says its life alone.
    let rows = rows()?;
    match (result["life_cycles"].as_f64(), rows.last().map(|row| row.cycles)) {
        (Some(life), Some(last)) if last < life => Err(refuse(&path, format!("ends at {last} cycles, and the run at {life}"))),
        _ => Ok((rows, text)),
    }
}
