//! A measured file as cells: cut by [`perilife_base::table`], without rows that do not count.

use std::path::Path;

use super::exclusion_flags::exclude_flagged;
use super::import::{Import, LeaveOut};
use perilife_base::error::{Result, fail_if, input};
use perilife_base::table::{self, Table};

/// Cuts the bytes of a file into cells. Rows that are left out by their lines go, and those that the table itself marks as not counting.
/// Errors: as [`table::read`] and [`take_rows_out`]; a Parquet file.
pub(super) fn read(bytes: &[u8], file: &Path, import: &Import) -> Result<Table> {
    let remedy = "save the table as CSV or .xlsx";
    fail_if!(bytes.starts_with(b"PAR1"), table::whole_file(file).error("is a Parquet file, which is not supported", remedy));
    let mut table = table::read(bytes, file, import)?;
    take_rows_out(&mut table, &import.left_out)?;
    exclude_flagged(&mut table, import)?;
    Ok(table)
}

/// Takes rows out of a table by their lines.
/// Errors: a line without a row, or whose row has no such cell.
fn take_rows_out(table: &mut Table, all: &[LeaveOut]) -> Result<()> {
    let plain = |text: &str| text.replace(|c: char| c.is_whitespace() || "\",;|".contains(c), "");
    for (index, one) in all.iter().enumerate().filter(|(_, one)| one.line.is_some()) {
        let place = table.rows.iter().position(|row| Some(row.line) == one.line);
        let cells: Vec<&str> = place.iter().flat_map(|&place| &table.rows[place].cells).collect();
        let value = one.value.as_deref().unwrap_or_default();
        // Messages cut long rows off.
        let (given, is_cut) = (plain(value.trim_end_matches("...")), value.ends_with("..."));
        let is_it = |text: &str| if is_cut { plain(text).starts_with(&given) } else { plain(text) == given };
        let is_there = one.value.is_some() && cells.iter().copied().chain([&*cells.concat()]).any(is_it);
        let Some(place) = place.filter(|_| is_there) else {
            let (line, cells) = (one.line.unwrap_or_default(), place.map_or("no row".to_owned(), |_| cells.join(" | ")));
            let problem = format!("is not a cell of line {line} of {}, which has {cells}", table.file.display());
            let remedy = "count lines from 1, the header included, and give the wrong cell";
            return Err(input(&format!("measured.leave_out[{index}].value"), format!("\"{value}\""), problem, remedy));
        };
        table.rows.remove(place);
    }
    Ok(())
}
