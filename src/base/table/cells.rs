//! Cells of text, each row with its line, and what is wrong with one of them.

use std::path::{Path, PathBuf};

use csv::StringRecord;

use crate::error::{Error, InputError, Result, fail_if};

const SHOWN: usize = 40;
pub const COLUMNS_MAX: usize = 4096;
const LINES_SHOWN: usize = 10;
const ROWS_SHOWN: usize = 5;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Separator {
    Tab,
    Semicolon,
    Comma,
    Bar,
    /// Two blanks or more, so that names may have blanks.
    Gap,
    Blanks,
}

impl Separator {
    /// All, those first that stand in numbers least.
    pub(super) const ALL: [Separator; 6] =
        [Separator::Tab, Separator::Semicolon, Separator::Comma, Separator::Bar, Separator::Gap, Separator::Blanks];

    pub fn name(self) -> &'static str {
        match self {
            Separator::Tab => "tabs",
            Separator::Semicolon => "semicolons",
            Separator::Comma => "commas",
            Separator::Bar => "vertical bars",
            Separator::Gap => "two or more blanks",
            Separator::Blanks => "blanks",
        }
    }

    /// Its character; `None` for a run of blanks.
    pub(super) fn character(self) -> Option<char> {
        match self {
            Separator::Tab => Some('\t'),
            Separator::Semicolon => Some(';'),
            Separator::Comma => Some(','),
            Separator::Bar => Some('|'),
            Separator::Gap | Separator::Blanks => None,
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    pub file: PathBuf,
    /// Column names as written; `column 1`, `column 2` in a table without header.
    pub header: Vec<String>,
    /// Column names with the units of a row of units below the header.
    pub names: Vec<String>,
    pub header_line: usize,
    pub rows: Vec<Row>,
    /// First and last line of text behind the readings, which holds none.
    pub footer: Option<[usize; 2]>,
    /// What separates columns; `None` where the cells are stored, not written.
    pub separator: Option<Separator>,
    /// Lines above the header, and comments there.
    pub preamble: Vec<(usize, String)>,
    pub notes: Vec<String>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    pub line: usize,
    pub cells: StringRecord,
}

impl Row {
    /// The cell of a column, without blanks around it.
    pub fn cell(&self, column: usize) -> &str {
        self.cells.get(column).unwrap_or_default()
    }

    pub(super) fn is_blank(&self) -> bool {
        self.cells.iter().all(str::is_empty)
    }
}

pub struct Fault<'a> {
    pub file: &'a Path,
    pub line: Option<usize>,
    pub key: Option<&'a str>,
    /// The cell, or what else is complained about.
    pub value: Option<&'a str>,
}

impl Fault<'_> {
    pub fn error(&self, problem: impl Into<String>, remedy: impl Into<String>) -> Error {
        Error::Input(Box::new(InputError {
            file: Some(self.file.to_path_buf()),
            line: self.line,
            key: self.key.map(str::to_owned),
            value: self.value.map(shown),
            problem: problem.into(),
            remedy: remedy.into(),
            ..InputError::default()
        }))
    }
}

impl Table {
    /// What the user should know of what was not read.
    pub fn warnings(&self) -> Vec<String> {
        let line = |[first, last]: [usize; 2]| {
            let lines = if first == last { format!("line {first}") } else { format!("lines {first} to {last}") };
            format!("table: {}: {lines}: text after the readings ignored", self.file.display())
        };
        self.footer.map(line).into_iter().chain(self.notes.iter().cloned()).collect()
    }

    /// Leaves rows out, which a note says; `why` ends its sentence.
    /// Errors: no row is left.
    pub fn leave_out(&mut self, why: &str, remedy: &str, is_out: impl Fn(&Row) -> bool) -> Result<()> {
        let lines: Vec<usize> = self.rows.iter().filter(|row| is_out(row)).map(|row| row.line).collect();
        let (out, all) = (lines.len(), self.rows.len());
        if out == 0 {
            return Ok(());
        }
        fail_if!(out == all, whole_file(&self.file).error(format!("has no usable row: each is {why}"), remedy));
        let shown: Vec<String> = lines.iter().take(LINES_SHOWN).map(usize::to_string).collect();
        let more = if out > LINES_SHOWN { ", ..." } else { "" };
        let lines = format!("line{} {}{more}", if out == 1 { "" } else { "s" }, shown.join(", "));
        self.notes.push(format!("table: {}: {out} of {all} rows excluded: {why} ({lines}); {remedy}", self.file.display()));
        self.rows.retain(|row| !is_out(row));
        Ok(())
    }

    pub fn header_fault(&self, column: usize) -> Fault<'_> {
        let name = self.header[column].as_str();
        Fault {
            file: &self.file,
            line: Some(self.header_line),
            key: Some("header"),
            value: Some(if name.is_empty() { "\"\"" } else { name }),
        }
    }

    pub fn cell_fault<'a>(&'a self, row: &'a Row, column: usize) -> Fault<'a> {
        let cell = row.cell(column);
        let value = if cell.is_empty() { "\"\"" } else { cell };
        Fault { file: &self.file, line: Some(row.line), key: Some(&self.header[column]), value: Some(value) }
    }

    pub fn first_cells(&self) -> Vec<Vec<String>> {
        self.rows.iter().take(ROWS_SHOWN).map(|row| row.cells.iter().map(shown).collect()).collect()
    }

    /// The first rows as they were cut, one a line, for a message about a shape that is not known.
    pub fn first_rows(&self) -> String {
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

pub fn whole_file(file: &Path) -> Fault<'_> {
    Fault { file, line: None, key: None, value: None }
}

fn shown(text: &str) -> String {
    if text.chars().count() <= SHOWN {
        return text.to_owned();
    }
    let head: String = text.chars().take(SHOWN).collect();
    format!("{head}...")
}
