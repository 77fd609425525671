//! Workbooks (`.xlsx`): the cells of one sheet, with the row of each.
//!
//! Cells come one by one: a sheet that uses its last row and column alone would fill the memory as a rectangle.

use std::io::{Cursor, Read, Write};
use std::path::Path;

use calamine::{Data, DataRef, Reader, Xlsx, XlsxError};
use csv::StringRecord;

use super::cells::{COLUMNS_MAX, Fault, Row, Table, whole_file};
use super::{Sheet, Vocabulary, cut, hidden};
use crate::cells::{CELLS_MAX, SMALLER, TEXT_MAX, UNPACKED_MAX, too_many};
use crate::error::{Error, Result, fail_if};
use crate::units::unmistakable;

/// Most sheets of a workbook: a file may name one sheet any number of times.
const SHEETS_MAX: usize = 256;

pub fn is_workbook(bytes: &[u8], file: &Path) -> bool {
    let ending = |known: &[&str]| file.extension().is_some_and(|own| known.iter().any(|known| own.eq_ignore_ascii_case(known)));
    bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"\xd0\xcf\x11\xe0") || ending(&["xlsx", "xlsm", "xls", "xlsb", "ods"])
}

/// The table of a sheet: the one that is asked for, else the only one that names cycles and crack length.
pub(super) fn table(bytes: &[u8], file: &Path, words: &dyn Vocabulary) -> Result<Table> {
    let broken = |error: XlsxError| broken(file, &error.to_string());
    check_size(bytes, file)?;
    let mut book: Xlsx<_> = Xlsx::new(Cursor::new(bytes)).map_err(broken)?;
    let sheets = book.sheet_names();
    fail_if!(sheets.len() > SHEETS_MAX, whole_file(file).error(too_many("sheets", sheets.len(), SHEETS_MAX), SMALLER));
    let mut taken = Taken::default();
    if let Some(wanted) = words.sheet() {
        let name = chosen(wanted, &sheets, file)?;
        let table = sheet_table(&mut book, name, file, words, &mut taken)?
            .ok_or_else(|| sheet_fault(file, &wanted.0).error("is an empty sheet", "name the sheet of the readings"))?;
        return without_hidden(table, bytes, name);
    }
    let mut found: Vec<(String, Table)> = Vec::new();
    let mut other = None;
    for name in &sheets {
        match sheet_table(&mut book, name, file, words, &mut taken) {
            Ok(Some(table)) if words.is_header(&table.names) => found.push((name.clone(), table)),
            Ok(Some(table)) => other = other.or(Some(Ok(table))),
            Ok(None) => {}
            Err(error) => other = other.or(Some(Err(error))),
        }
    }
    match found.len() {
        1 => {
            let (name, table) = found.remove(0);
            without_hidden(table, bytes, &name)
        }
        0 => other.unwrap_or_else(|| Err(whole_file(file).error("has no sheet with cells", "give the sheet of the readings"))),
        _ => {
            let names: Vec<String> = found.iter().map(|(name, _)| format!("{name:?}")).collect();
            let problem = format!("has {} sheets of readings: {}", names.len(), names.join(", "));
            Err(whole_file(file)
                .error(problem, format!("set measured.sheet = {} (--sheet) for readings, or keep one sheet", names[0])))
        }
    }
}

/// The table without hidden rows, which are readings taken out; hidden columns are read, and told of.
fn without_hidden(mut table: Table, bytes: &[u8], sheet: &str) -> Result<Table> {
    let hidden = hidden::of_sheet(bytes, sheet);
    let names = hidden.columns.iter().filter_map(|column| table.header.get(*column)).filter(|name| !name.is_empty());
    let names: Vec<&str> = names.map(String::as_str).collect();
    if !names.is_empty() {
        let note = format!("table: {}: hidden columns are used: {}", table.file.display(), names.join(", "));
        table.notes.push(note);
    }
    table.leave_out("hidden in the workbook", "unhide them to read them", |row| hidden.rows.contains(&row.line))?;
    Ok(table)
}

/// The sheet of that name, or else of that number.
fn chosen<'s>(wanted: &Sheet, sheets: &'s [String], file: &Path) -> Result<&'s str> {
    let by_name = sheets.iter().find(|name| **name == wanted.0);
    let by_number = || sheets.get(wanted.0.parse::<usize>().ok()?.checked_sub(1)?);
    by_name.or_else(by_number).map(String::as_str).ok_or_else(|| {
        let known: Vec<String> = sheets.iter().enumerate().map(|(index, name)| format!("{} {name:?}", index + 1)).collect();
        sheet_fault(file, &wanted.0).error("is not a sheet of this workbook", format!("its sheets are {}", known.join(", ")))
    })
}

fn sheet_fault<'a>(file: &'a Path, sheet: &'a str) -> Fault<'a> {
    Fault { key: Some("measured.sheet"), value: Some(sheet), ..whole_file(file) }
}

/// What the sheets of a workbook that were read so far take up.
#[derive(Default)]
struct Taken {
    cells: usize,
    /// Bytes of their text: cells share it in the file, but not here.
    text: usize,
}

impl Taken {
    fn check(&self, name: &str, file: &Path) -> Result<()> {
        let over = [("cells", self.cells, CELLS_MAX), ("bytes of text in cells", self.text, TEXT_MAX)];
        match over.into_iter().find(|(_, count, most)| count > most) {
            None => Ok(()),
            Some((what, count, most)) => {
                Err(whole_file(file).error(format!("{} (sheet {name:?})", too_many(what, count, most)), SMALLER))
            }
        }
    }
}

/// The table of a sheet; `None` without cells.
fn sheet_table(
    book: &mut Xlsx<Cursor<&[u8]>>,
    name: &str,
    file: &Path,
    words: &dyn Vocabulary,
    taken: &mut Taken,
) -> Result<Option<Table>> {
    let broken = |error: XlsxError| broken(file, &format!("sheet {name:?}: {error}"));
    let mut reader = book.worksheet_cells_reader(name).map_err(broken)?;
    let mut rows: Vec<(u32, Vec<String>)> = Vec::new();
    while let Some(cell) = reader.next_cell().map_err(broken)? {
        let (row, column) = cell.get_position();
        let text = written(cell.get_value());
        taken.cells += 1;
        taken.text += text.len();
        taken.check(name, file)?;
        if text.is_empty() {
            continue;
        }
        if column as usize >= COLUMNS_MAX {
            return Err(whole_file(file).error(format!("sheet {name:?} has more than {COLUMNS_MAX} columns"), SMALLER));
        }
        if rows.last().is_none_or(|(last, _)| *last != row) {
            rows.push((row, Vec::new()));
        }
        let Some((_, cells)) = rows.last_mut() else { continue };
        // Up to the column of the cell, where a row may have no other.
        taken.cells += (column as usize).saturating_sub(cells.len());
        taken.check(name, file)?;
        cells.resize(cells.len().max(column as usize + 1), String::new());
        cells[column as usize] = text;
    }
    let widest = rows.iter().map(|(_, cells)| cells.len()).max().unwrap_or(0);
    if widest == 0 {
        return Ok(None);
    }
    taken.cells += rows.iter().map(|(_, cells)| widest - cells.len()).sum::<usize>();
    taken.check(name, file)?;
    let rows = rows.into_iter().map(|(row, mut cells)| {
        cells.resize(widest, String::new());
        Row { line: row as usize + 1, cells: StringRecord::from(cells) }
    });
    let mut table = cut::assemble(rows.collect(), file, words)?;
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

/// How an XML text of shared texts says how many there are.
const CLAIM: &[u8] = b"uniqueCount";

/// The largest [`CLAIM`] of an XML text: its reader takes room for so many texts before it sees the first.
#[derive(Default)]
struct Claims {
    /// Letters of the name that stand at the end of what was seen.
    matched: usize,
    /// The number behind a name, as far as it was seen.
    number: Option<u64>,
    largest: u64,
}

impl Claims {
    fn see(&mut self, byte: u8) {
        match self.number {
            // Half of UTF-16.
            _ if byte == 0 => {}
            Some(number) if byte.is_ascii_digit() => {
                self.number = Some(number.saturating_mul(10).saturating_add(u64::from(byte - b'0')));
                self.largest = self.largest.max(self.number.unwrap_or(0));
            }
            Some(0) if byte.is_ascii_whitespace() || matches!(byte, b'=' | b'"' | b'\'') => {}
            Some(_) => self.number = None,
            // An attribute stands behind a blank, so that no letter of its own name goes before it.
            None if byte == CLAIM[self.matched] => self.matched += 1,
            None => self.matched = 0,
        }
        if self.matched == CLAIM.len() {
            (self.matched, self.number) = (0, Some(0));
        }
    }
}

impl Write for Claims {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        bytes.iter().for_each(|&byte| self.see(byte));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// Unpacks without keeping anything: a file of a few bytes can stand for any number of them.
fn check_size(bytes: &[u8], file: &Path) -> Result<()> {
    let broken = |error: String| broken(file, &error);
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| broken(error.to_string()))?;
    let mut left = UNPACKED_MAX;
    for index in 0..archive.len() {
        let entry = archive.by_index(index).map_err(|error| broken(error.to_string()))?;
        let name = entry.name().map_err(|error| broken(error.to_string()))?;
        let is_text = name.to_ascii_lowercase().ends_with("sharedstrings.xml");
        let mut claims = Claims::default();
        let mut nothing = std::io::sink();
        let sink: &mut dyn Write = if is_text { &mut claims } else { &mut nothing };
        let unpacked = std::io::copy(&mut entry.take(left), sink).map_err(|error| broken(error.to_string()))?;
        if claims.largest > CELLS_MAX as u64 {
            return Err(whole_file(file).error(format!("declares {} texts", claims.largest), SMALLER));
        }
        left -= unpacked;
        let problem = || format!("unpacks to more than {UNPACKED_MAX} bytes");
        fail_if!(left == 0, whole_file(file).error(problem(), "give the readings alone, or CSV"));
    }
    Ok(())
}

fn broken(file: &Path, reason: &str) -> Error {
    whole_file(file).error(format!("is not an .xlsx workbook ({reason})"), "save it as .xlsx or as CSV")
}
