//! Whether a table of a run is still what was written: copies over a broken line are cut off, at the end of a row as well.

use std::path::Path;

use serde_json::Value;

use super::csv::parse_a_n;
use super::json::RESULT_FILE;
use crate::error::{InputError, Result};
use crate::input::{Opened, sha256};

/// Compares a table with what `result.json` beside it says of it; without that file there is nothing to compare with.
///
/// # Errors
/// [`crate::Error::Input`] for a table that was cut off or changed; [`crate::Error::File`] if `result.json` cannot be read.
pub fn check(folder: &Path, name: &str, table: &[u8], opened: &Opened) -> Result<()> {
    let (path, beside) = (folder.join(name), folder.join(RESULT_FILE));
    let refuse = |problem: String| {
        let remedy = "copy the folder again, or run the case again".to_owned();
        let error = InputError { file: Some(path.clone()), problem, remedy, ..InputError::default() };
        Err(crate::Error::Input(Box::new(error)))
    };
    if !beside.is_file() {
        return Ok(());
    }
    let Ok(result) = serde_json::from_slice::<Value>(&opened.read(&beside, RESULT_FILE)?) else {
        return refuse(format!("stands beside a {RESULT_FILE} that is cut off or damaged"));
    };
    let said = result["tables"].as_array().into_iter().flatten().find(|entry| entry["file"] == name);
    if let Some(entry) = said {
        let bytes = entry["bytes"].as_u64().unwrap_or(0);
        return match table.len() as u64 {
            length if length < bytes => refuse(format!("is cut off: {length} of the {bytes} bytes that the run wrote")),
            _ if entry["sha256"] != sha256(table) => refuse(format!("is not the table that the run wrote, by {RESULT_FILE}")),
            _ => Ok(()),
        };
    }
    // A run of an earlier version says its life alone.
    let last = parse_a_n(&String::from_utf8_lossy(table), &path)?.last().map(|row| row.cycles);
    match (result["life_cycles"].as_f64(), last) {
        (Some(life), Some(last)) if last < life => refuse(format!("ends at {last} cycles, and the run at {life}")),
        _ => Ok(()),
    }
}
