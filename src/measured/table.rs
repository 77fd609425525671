//! A measured file as cells: cut by [`perilife_base::table`], without rows that do not count.

use std::path::Path;

use super::import::{Import, LeaveOut};
use super::marks::leave_marked_out;
use perilife_base::error::{Result, input};
use perilife_base::table::{self, Table};

/// Cuts the bytes of a file into cells. Rows that are left out by their lines go, and those that the table itself marks as not counting.
/// Errors: as [`table::read`] and [`take_rows_out`]; a Parquet file.
pub(super) fn read(bytes: &[u8], file: &Path, import: &Import) -> Result<Table> {
    if bytes.starts_with(b"PAR1") {
        return Err(table::whole_file(file).error("is a Parquet file, which is not read", "save the table as CSV or .xlsx"));
    }
    let mut table = table::read(bytes, file, import)?;
    take_rows_out(&mut table, &import.left_out)?;
    leave_marked_out(&mut table, import)?;
    Ok(table)
}

/// A text without quotes, blanks and what separates cells.
fn plain(text: &str) -> String {
    text.chars().filter(|c| !(c.is_whitespace() || "\",;|".contains(*c))).collect()
}

/// Takes rows out of a table by their lines.
/// Errors: a line without a row, or whose row has no such cell.
fn take_rows_out(table: &mut Table, all: &[LeaveOut]) -> Result<()> {
    for (index, one) in all.iter().enumerate().filter(|(_, one)| one.is_of(&table.file)) {
        let (key, line) = (format!("measured.leave_out[{index}]"), one.line.unwrap_or_default());
        let Some(place) = table.rows.iter().position(|row| row.line == line) else {
            let problem = format!("is not a row below the header of {}", table.file.display());
            return Err(input(&format!("{key}.line"), line, problem, "count lines from 1, the header included"));
        };
        let cells: Vec<&str> = table.rows[place].cells.iter().collect();
        let value = one.value.as_deref().unwrap_or_default();
        // Messages cut long rows off.
        let (given, is_cut) = (plain(value.trim_end_matches("...")), value.ends_with("..."));
        let is_it = |text: &str| if is_cut { plain(text).starts_with(&given) } else { plain(text) == given };
        if one.value.is_none() || !cells.iter().copied().chain([&*cells.concat()]).any(is_it) {
            let problem = format!("is not a cell of line {line} of {}, which has {}", table.file.display(), cells.join(" | "));
            return Err(input(&format!("{key}.value"), format!("\"{value}\""), problem, "give the cell that is wrong"));
        }
        table.rows.remove(place);
    }
    Ok(())
}
