//! A measured file as cells of text, each row with its line: from CSV in any usual dress, a workbook or Parquet.
//!
//! Only the form is judged here: the encoding ([`decode`]), which character separates columns and which row is the header ([`cut`]).
//! What a column means is said by [`super::names`], which number a cell holds by [`super::decimal`].

mod cut;
mod decode;
mod separator;
mod workbook;

use std::path::{Path, PathBuf};

use csv::StringRecord;

pub(crate) use separator::Separator;

use crate::calibration::import::Import;
use crate::error::{Error, InputError, Result};

/// Longest cell or row repeated in a message.
const SHOWN: usize = 40;

/// Most columns of a table of readings.
const COLUMNS_MAX: usize = 4096;

/// Rows that a message about a table of unknown shape shows.
const ROWS_SHOWN: usize = 5;

/// Cells of a file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Table {
    /// Where it came from.
    pub file: PathBuf,
    /// Column names as written; `column 1`, `column 2` in a table without header.
    pub header: Vec<String>,
    /// Column names with the units of a row of units below the header.
    pub names: Vec<String>,
    /// Line of the header.
    pub header_line: usize,
    /// Rows below the header.
    pub rows: Vec<Row>,
    /// First and last line of text behind the readings, which holds none.
    pub footer: Option<[usize; 2]>,
    /// What separates columns; `None` where the cells are stored, not written.
    pub separator: Option<Separator>,
}

/// One row of cells.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    /// Line in the file, counted from 1.
    pub line: usize,
    /// As many cells as the header has.
    pub cells: StringRecord,
}

impl Row {
    /// The cell of a column, without blanks around it.
    pub(crate) fn cell(&self, column: usize) -> &str {
        self.cells.get(column).unwrap_or_default()
    }

    fn is_blank(&self) -> bool {
        self.cells.iter().all(str::is_empty)
    }
}

/// What is wrong with a place of a measured file.
pub(crate) struct Fault<'a> {
    pub file: &'a Path,
    pub line: Option<usize>,
    pub key: Option<&'a str>,
    pub value: Option<&'a str>,
}

impl Fault<'_> {
    /// The input error that says so.
    pub(crate) fn error(&self, problem: impl Into<String>, remedy: impl Into<String>) -> Error {
        Error::Input(Box::new(InputError {
            file: Some(self.file.to_path_buf()),
            line: self.line,
            key: self.key.map(str::to_owned),
            value: self.value.map(shown),
            problem: problem.into(),
            remedy: remedy.into(),
        }))
    }
}

impl Table {
    /// Cuts the bytes of a file into cells: a workbook by its content, Parquet by the ending of its name, everything else as text.
    pub(crate) fn read(bytes: &[u8], file: &Path, import: &Import) -> Result<Table> {
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
        cut::text(&decode::text(bytes, file)?, file, import)
    }

    /// What the user should know of what was not read.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let line = |[first, last]: [usize; 2]| {
            let lines = if first == last { format!("line {first}") } else { format!("lines {first} to {last}") };
            format!("{}: {lines} behind the readings hold text and no number: not read", self.file.display())
        };
        self.footer.map(line).into_iter().collect()
    }

    /// A complaint about a name in the header.
    pub(crate) fn header_fault(&self, column: usize) -> Fault<'_> {
        let name = self.header[column].as_str();
        Fault {
            file: &self.file,
            line: Some(self.header_line),
            key: Some("header"),
            value: Some(if name.is_empty() { "\"\"" } else { name }),
        }
    }

    /// A complaint about a cell.
    pub(crate) fn cell_fault<'a>(&'a self, row: &'a Row, column: usize) -> Fault<'a> {
        let cell = row.cell(column);
        let value = if cell.is_empty() { "\"\"" } else { cell };
        Fault { file: &self.file, line: Some(row.line), key: Some(&self.header[column]), value: Some(value) }
    }

    /// Cells of the first rows.
    pub(crate) fn first_cells(&self) -> Vec<Vec<String>> {
        self.rows.iter().take(ROWS_SHOWN).map(|row| row.cells.iter().map(shown).collect()).collect()
    }

    /// The first rows as they were cut, one a line, for a message about a shape that is not known.
    pub(crate) fn first_rows(&self) -> String {
        let mut text = match self.separator {
            Some(separator) => format!("read so far, columns separated by {}:", separator.name()),
            None => "read so far:".to_owned(),
        };
        let mut show = |line: usize, cells: &mut dyn Iterator<Item = &str>| {
            let cells: Vec<String> = cells.map(shown).collect();
            text.push_str(&format!("\n  line {line}: {}", cells.join(" | ")));
        };
        show(self.header_line, &mut self.header.iter().map(String::as_str));
        self.rows.iter().take(ROWS_SHOWN).for_each(|row| show(row.line, &mut row.cells.iter()));
        text
    }
}

/// A complaint about the file as a whole.
pub(crate) fn whole_file(file: &Path) -> Fault<'_> {
    Fault { file, line: None, key: None, value: None }
}

/// A table of stored cells whose first row is the header.
fn parquet(bytes: &[u8], file: &Path) -> Result<Table> {
    #[cfg(feature = "tables")]
    {
        let cells = crate::tables::read_parquet(bytes, file)?;
        // Row n counts as line n, and so it passes the same checks as a CSV file.
        let rows = cells.rows.into_iter().enumerate();
        let rows = rows.map(|(index, cells)| Row { line: index + 1, cells: StringRecord::from(cells) }).collect();
        Ok(Table {
            file: file.to_path_buf(),
            names: cells.header.clone(),
            header: cells.header,
            header_line: 0,
            rows,
            footer: None,
            separator: None,
        })
    }
    #[cfg(not(feature = "tables"))]
    {
        let _ = bytes;
        Err(whole_file(file)
            .error("is a Parquet table, which this build cannot read", "give CSV, or build with the feature `tables`"))
    }
}

/// A cell as a message repeats it: not longer than one can read.
fn shown(text: &str) -> String {
    if text.chars().count() <= SHOWN {
        return text.to_owned();
    }
    let head: String = text.chars().take(SHOWN).collect();
    format!("{head}...")
}
