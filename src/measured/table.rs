//! A measured file as cells: cut by [`perilife_base::table`], without rows that do not count.

use std::path::Path;

use super::import::Import;
use super::marks::leave_marked_out;
use perilife_base::error::Result;
use perilife_base::table::{self, Table};

/// Cuts the bytes of a file into cells. Rows that the table itself marks as not counting are left out.
/// Errors: as [`table::read`]; a Parquet file.
pub(super) fn read(bytes: &[u8], file: &Path, import: &Import) -> Result<Table> {
    if bytes.starts_with(b"PAR1") {
        return Err(table::whole_file(file).error("is a Parquet file, which is not read", "save the table as CSV or .xlsx"));
    }
    let mut table = table::read(bytes, file, import)?;
    leave_marked_out(&mut table, import)?;
    Ok(table)
}
