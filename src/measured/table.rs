//! A measured file as cells: cut by [`perilife_base::table`], or Parquet.

use std::path::Path;

use super::import::Import;
use super::marks::leave_marked_out;
use perilife_base::error::Result;
use perilife_base::table::{self, Table};

/// Cuts the bytes of a file into cells: Parquet by the ending of its name, everything else by what it is. Rows that the table itself marks
/// as not counting are left out.
pub(super) fn read(bytes: &[u8], file: &Path, import: &Import) -> Result<Table> {
    let is_parquet = file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("parquet"));
    let mut table = if is_parquet && import.sheet.is_none() { parquet(bytes, file)? } else { table::read(bytes, file, import)? };
    leave_marked_out(&mut table, import)?;
    Ok(table)
}

/// A table of stored cells whose first row is the header.
fn parquet(bytes: &[u8], file: &Path) -> Result<Table> {
    #[cfg(feature = "tables")]
    {
        let cells = perilife_tables::read_parquet(bytes, file)?;
        // Row n counts as line n, and so it passes the same checks as a CSV file.
        let rows = cells.rows.into_iter().enumerate();
        let rows = rows.map(|(index, cells)| table::Row { line: index + 1, cells: cells.into() }).collect();
        Ok(Table {
            file: file.to_path_buf(),
            names: cells.header.clone(),
            header: cells.header,
            header_line: 0,
            rows,
            footer: None,
            separator: None,
            preamble: Vec::new(),
            notes: Vec::new(),
        })
    }
    #[cfg(not(feature = "tables"))]
    {
        let _ = bytes;
        Err(table::whole_file(file)
            .error("is a Parquet table, which this build cannot read", "give CSV, or build with the feature `tables`"))
    }
}
