//! A measured file as cells: cut by [`perilife_base::table`], without rows that do not count.

use std::path::Path;

use super::import::Import;
use super::leave_out::take_rows_out;
use super::marks::leave_marked_out;
use perilife_base::error::Result;
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
