//! A measured file as cells of text, each row with its line: from CSV in any usual dress, a workbook or Parquet.
//!
//! Only the form is judged here: the encoding and which character separates columns ([`lines`]), which row is the header ([`cut`]).
//! What a column means is said by [`super::names`], which number a cell holds by [`super::decimal`].

mod cells;
mod cut;
mod hidden;
mod lines;
mod workbook;

use std::path::Path;

pub(super) use cells::{Fault, Row, Separator, Table, whole_file};

use super::import::Import;
use super::marks::leave_marked_out;
use crate::error::Result;

/// Cuts the bytes of a file into cells: a workbook by its content, Parquet by the ending of its name, everything else as text. Rows that
/// the table itself marks as not counting are left out.
pub(super) fn read(bytes: &[u8], file: &Path, import: &Import) -> Result<Table> {
    let mut table = cells_of(bytes, file, import)?;
    leave_marked_out(&mut table, import)?;
    Ok(table)
}

fn cells_of(bytes: &[u8], file: &Path, import: &Import) -> Result<Table> {
    if workbook::is_workbook(bytes, file) {
        return workbook::table(bytes, file, import);
    }
    if let Some(sheet) = &import.sheet {
        let fault = Fault { key: Some("measured.sheet"), value: Some(&sheet.0), ..whole_file(file) };
        return Err(fault.error("is given for a file that is no workbook", "leave sheet out, or give the .xlsx file"));
    }
    if file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("parquet")) {
        return parquet(bytes, file);
    }
    cut::text(&lines::decoded(bytes, file)?, file, import)
}

/// A table of stored cells whose first row is the header.
fn parquet(bytes: &[u8], file: &Path) -> Result<Table> {
    #[cfg(feature = "tables")]
    {
        let cells = crate::tables::read_parquet(bytes, file)?;
        // Row n counts as line n, and so it passes the same checks as a CSV file.
        let rows = cells.rows.into_iter().enumerate();
        let rows = rows.map(|(index, cells)| Row { line: index + 1, cells: cells.into() }).collect();
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
        Err(whole_file(file)
            .error("is a Parquet table, which this build cannot read", "give CSV, or build with the feature `tables`"))
    }
}
