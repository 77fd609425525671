//! Workbooks (`.xlsx`): the cells of one sheet, with the row of each.
//!
//! Cells come one by one: a sheet that uses its last row and column alone would fill the memory as a rectangle.

use std::io::{Cursor, Read};
use std::path::Path;

use calamine::{Data, DataRef, Reader, Xlsx, XlsxError};
use csv::StringRecord;

use super::{COLUMNS_MAX, Fault, Row, Table, cut, whole_file};
use crate::calibration::columns::names_a_test;
use crate::calibration::import::{Import, Sheet};
use crate::error::{Error, Result};
use crate::units::unmistakable;

/// Most bytes a workbook may unpack to.
const UNPACKED_MAX: u64 = 1 << 30;
/// Most cells read of a sheet.
const CELLS_MAX: usize = 20_000_000;

/// Whether the bytes are those of a workbook.
pub(super) fn is_workbook(bytes: &[u8], file: &Path) -> bool {
    let ending = |known: &[&str]| file.extension().is_some_and(|own| known.iter().any(|known| own.eq_ignore_ascii_case(known)));
    bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"\xd0\xcf\x11\xe0") || ending(&["xlsx", "xlsm", "xls", "xlsb", "ods"])
}

/// The table of a sheet: the one that is asked for, else the only one that names cycles and crack length.
pub(super) fn table(bytes: &[u8], file: &Path, import: &Import) -> Result<Table> {
    let broken = |error: XlsxError| broken(file, &error.to_string());
    check_size(bytes, file)?;
    let mut book: Xlsx<_> = Xlsx::new(Cursor::new(bytes)).map_err(broken)?;
    let sheets = book.sheet_names();
    if let Some(wanted) = &import.sheet {
        return sheet_table(&mut book, chosen(wanted, &sheets, file)?, file, import)?
            .ok_or_else(|| sheet_fault(file, &wanted.0).error("is an empty sheet", "name the sheet of the readings"));
    }
    let mut found: Vec<(String, Table)> = Vec::new();
    let mut other = None;
    for name in &sheets {
        match sheet_table(&mut book, name, file, import) {
            Ok(Some(table)) if names_a_test(&table.names, import) => found.push((name.clone(), table)),
            Ok(Some(table)) => other = other.or(Some(Ok(table))),
            Ok(None) => {}
            Err(error) => other = other.or(Some(Err(error))),
        }
    }
    match found.len() {
        1 => Ok(found.remove(0).1),
        0 => other.unwrap_or_else(|| Err(whole_file(file).error("has no sheet with cells", "give the sheet of the readings"))),
        _ => {
            let names: Vec<String> = found.iter().map(|(name, _)| format!("{name:?}")).collect();
            let problem = format!("has {} sheets of readings: {}", names.len(), names.join(", "));
            Err(whole_file(file).error(problem, format!("say which by measured.sheet = {} (--sheet)", names[0])))
        }
    }
}

/// The sheet of that name, or else of that number.
fn chosen<'s>(wanted: &Sheet, sheets: &'s [String], file: &Path) -> Result<&'s str> {
    let by_name = sheets.iter().find(|name| **name == wanted.0);
    let by_number = || sheets.get(wanted.0.parse::<usize>().ok()?.checked_sub(1)?);
    by_name.or_else(by_number).map(String::as_str).ok_or_else(|| {
        let known: Vec<String> = sheets.iter().enumerate().map(|(index, name)| format!("{} {name:?}", index + 1)).collect();
        sheet_fault(file, &wanted.0).error("is no sheet of this workbook", format!("its sheets are {}", known.join(", ")))
    })
}

fn sheet_fault<'a>(file: &'a Path, sheet: &'a str) -> Fault<'a> {
    Fault { key: Some("measured.sheet"), value: Some(sheet), ..whole_file(file) }
}

/// The table of a sheet; `None` without cells.
fn sheet_table(book: &mut Xlsx<Cursor<&[u8]>>, name: &str, file: &Path, import: &Import) -> Result<Option<Table>> {
    let broken = |error: XlsxError| broken(file, &format!("sheet {name:?}: {error}"));
    let mut reader = book.worksheet_cells_reader(name).map_err(broken)?;
    let mut rows: Vec<(u32, Vec<String>)> = Vec::new();
    let mut cells = 0;
    while let Some(cell) = reader.next_cell().map_err(broken)? {
        let (row, column) = cell.get_position();
        let text = written(cell.get_value());
        if text.is_empty() {
            continue;
        }
        cells += 1;
        if cells > CELLS_MAX || column as usize >= COLUMNS_MAX {
            return Err(
                whole_file(file).error(format!("sheet {name:?} is larger than any table of readings"), "give the readings alone")
            );
        }
        if rows.last().is_none_or(|(last, _)| *last != row) {
            rows.push((row, Vec::new()));
        }
        let Some((_, cells)) = rows.last_mut() else { continue };
        cells.resize(cells.len().max(column as usize + 1), String::new());
        cells[column as usize] = text;
    }
    let widest = rows.iter().map(|(_, cells)| cells.len()).max().unwrap_or(0);
    if widest == 0 {
        return Ok(None);
    }
    let rows = rows.into_iter().map(|(row, mut cells)| {
        cells.resize(widest, String::new());
        Row { line: row as usize + 1, cells: StringRecord::from(cells) }
    });
    let mut table = cut::assemble(rows.collect(), file, import)?;
    let columns = table.header.len();
    table.rows.iter_mut().for_each(|row| row.cells.truncate(columns));
    Ok(Some(table))
}

/// A cell as it would stand in a CSV file: all digits of a number.
fn written(value: &DataRef<'_>) -> String {
    match Data::from(value.clone()) {
        Data::Empty => String::new(),
        Data::String(text) => text.trim().to_owned(),
        Data::Float(number) => unmistakable(&number.to_string()),
        Data::Int(number) => number.to_string(),
        other => other.to_string(),
    }
}

/// Unpacks without keeping anything: a file of a few bytes can stand for any number of them.
fn check_size(bytes: &[u8], file: &Path) -> Result<()> {
    let broken = |error: String| broken(file, &error);
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| broken(error.to_string()))?;
    let mut left = UNPACKED_MAX;
    for index in 0..archive.len() {
        let entry = archive.by_index(index).map_err(|error| broken(error.to_string()))?;
        let unpacked = std::io::copy(&mut entry.take(left), &mut std::io::sink()).map_err(|error| broken(error.to_string()))?;
        left -= unpacked;
        if left == 0 {
            return Err(whole_file(file).error("unpacks to more than 1 GiB", "give the readings alone, or CSV"));
        }
    }
    Ok(())
}

fn broken(file: &Path, reason: &str) -> Error {
    whole_file(file).error(format!("is no workbook of the kind .xlsx ({reason})"), "save it as .xlsx or as CSV")
}
