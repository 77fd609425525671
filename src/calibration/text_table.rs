//! A measured file as cells of text with the line each row stands on: byte order mark, line ends, separators.
//!
//! Only the form is judged here, not the meaning: which character separates columns, whether every row has as many
//! columns as the header, and whether a cell is a number. Rows keep their line so that later complaints can name it.

use std::path::{Path, PathBuf};

use crate::error::{Error, InputError, Result};

/// Longest cell or row repeated in a message.
const SHOWN: usize = 40;

/// Cells of a file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TextTable {
    /// Where it came from.
    pub file: PathBuf,
    /// Column names as written.
    pub header: Vec<String>,
    /// Line of the header.
    pub header_line: usize,
    /// Rows below the header.
    pub rows: Vec<TextRow>,
    /// Whether `7,5` is a number here (never where the comma separates columns).
    pub decimal_comma: bool,
}

/// One row of cells.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TextRow {
    /// Line in the file, counted from 1.
    pub line: usize,
    /// As many cells as the header has.
    pub cells: Vec<String>,
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

impl TextTable {
    /// Cuts the bytes of a file into cells.
    pub(crate) fn parse(bytes: &[u8], file: &Path) -> Result<TextTable> {
        let text = decode(bytes, file)?;
        let lines = kept_lines(text);
        let Some(&(header_line, header_text)) = lines.first() else {
            return Err(
                whole_file(file).error("is empty", "give a header line `specimen,cycles,crack_length_mm` and at least 5 rows")
            );
        };
        let separator = separator_of(header_text, header_line, file)?;
        let mut records = records(&lines, separator, file)?.into_iter();
        // `lines` is not empty, but a header of nothing but quotes may still give no record.
        let mut header = records.next().map(|row| row.cells).unwrap_or_default();
        let columns = drop_trailing_blanks(&mut header);
        if columns < 2 {
            return Err(Fault { file, line: Some(header_line), key: None, value: Some(header_text) }.error(
                "is a header of one column, or its columns are not separated by a comma, a semicolon or a tab",
                "give at least the columns cycles and crack_length_mm",
            ));
        }
        let mut rows = Vec::with_capacity(lines.len());
        for mut row in records {
            while row.cells.len() > columns && row.cells.last().is_some_and(String::is_empty) {
                row.cells.pop();
            }
            check_width(&row, columns, &lines, separator, file)?;
            rows.push(row);
        }
        if rows.is_empty() {
            return Err(whole_file(file).error("has a header but no rows", "give at least 5 readings below the header"));
        }
        Ok(TextTable { file: file.to_path_buf(), header, header_line, rows, decimal_comma: separator != b',' })
    }

    /// The number in a cell, or an error that names file, line, column and value.
    pub(crate) fn number(&self, row: &TextRow, column: usize) -> Result<f64> {
        let cell = row.cells[column].as_str();
        let fault = Fault { file: &self.file, line: Some(row.line), key: Some(&self.header[column]), value: Some(cell) };
        if cell.is_empty() {
            return Err(Fault { value: Some("\"\""), ..fault }.error("is empty", "give a number or leave the whole row out"));
        }
        let plain = match cell.matches(',').count() {
            0 => cell.to_owned(),
            1 if self.decimal_comma && !cell.contains('.') => cell.replace(',', "."),
            _ => {
                return Err(fault.error(
                    "has more than one kind of decimal sign",
                    "write 1234.5 (or 1234,5 between semicolons), no thousands separators",
                ));
            }
        };
        let number: f64 =
            plain.parse().map_err(|_| fault.error("is not a number", "give a plain number such as 1234.5 or 1.2345e3"))?;
        if !number.is_finite() {
            return Err(fault.error("is not a finite number", "give the reading, or leave the whole row out"));
        }
        Ok(number)
    }
}

/// A complaint about the file as a whole.
pub(crate) fn whole_file(file: &Path) -> Fault<'_> {
    Fault { file, line: None, key: None, value: None }
}

/// Bytes as text without a byte order mark.
fn decode<'a>(bytes: &'a [u8], file: &Path) -> Result<&'a str> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(whole_file(file).error("is UTF-16 text", "save it as CSV in UTF-8"));
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    std::str::from_utf8(bytes).map_err(|error| {
        let line = 1 + bytes[..error.valid_up_to()].iter().filter(|&&byte| byte == b'\n').count();
        Fault { line: Some(line), ..whole_file(file) }.error("is not UTF-8 text", "save it as CSV in UTF-8")
    })
}

/// Lines that are neither blank nor comments (`#`), with their numbers; line ends may be LF, CRLF or CR.
fn kept_lines(text: &str) -> Vec<(usize, &str)> {
    let unix = text.contains('\n');
    let split: Vec<&str> = if unix { text.split('\n').collect() } else { text.split('\r').collect() };
    split
        .into_iter()
        .enumerate()
        .map(|(index, line)| (index + 1, line.trim_end_matches('\r')))
        .filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'))
        .collect()
}

/// Separator of the header line: semicolon, tab or comma, and only one of them.
fn separator_of(header: &str, line: usize, file: &Path) -> Result<u8> {
    let present: Vec<u8> = b";\t,".iter().copied().filter(|&byte| header.bytes().any(|other| other == byte)).collect();
    match present.as_slice() {
        [] => Ok(b','),
        [one] => Ok(*one),
        _ => Err(Fault { file, line: Some(line), key: None, value: Some(header) }
            .error("mixes separators in the header", "separate all columns by commas, or all by semicolons")),
    }
}

/// Records of the kept lines. The CSV reader counts lines of what it is given, `lines` maps them to lines of the file.
fn records(lines: &[(usize, &str)], separator: u8, file: &Path) -> Result<Vec<TextRow>> {
    let mut joined = String::new();
    for (_, line) in lines {
        joined.push_str(line);
        joined.push('\n');
    }
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator)
        .trim(csv::Trim::All)
        .from_reader(joined.as_bytes());
    let mut rows = Vec::with_capacity(lines.len());
    for record in reader.records() {
        let record = record
            .map_err(|error| whole_file(file).error(format!("cannot be cut into columns ({error})"), "save it as plain CSV"))?;
        let position = record.position().map_or(1, |position| position.line() as usize);
        let line = lines.get(position.saturating_sub(1)).map_or(0, |&(line, _)| line);
        rows.push(TextRow { line, cells: record.iter().map(str::to_owned).collect() });
    }
    Ok(rows)
}

/// Spreadsheets end rows with empty columns; they are not columns. Returns how many are left.
fn drop_trailing_blanks(header: &mut Vec<String>) -> usize {
    while header.last().is_some_and(String::is_empty) {
        header.pop();
    }
    header.len()
}

/// Complains about a row that is shorter or longer than the header.
fn check_width(row: &TextRow, columns: usize, lines: &[(usize, &str)], separator: u8, file: &Path) -> Result<()> {
    if row.cells.len() == columns {
        return Ok(());
    }
    let text = lines.iter().find(|(line, _)| *line == row.line).map_or("", |(_, text)| *text);
    let fault = Fault { file, line: Some(row.line), key: None, value: Some(text) };
    let other_separator = b";\t,".iter().any(|&byte| byte != separator && text.bytes().any(|found| found == byte));
    let problem = format!(
        "has {} {} where the header has {columns}",
        row.cells.len(),
        if row.cells.len() == 1 { "column" } else { "columns" }
    );
    Err(match (separator, other_separator) {
        (_, true) => fault.error(format!("{problem}, and mixes separators"), "separate every row as the header is separated"),
        (b',', false) if row.cells.len() > columns => {
            fault.error(problem, "give one value a column; with decimal commas separate the columns by semicolons")
        }
        _ => fault.error(problem, "give one value a column"),
    })
}

/// A cell as a message repeats it: not longer than one can read.
fn shown(text: &str) -> String {
    if text.chars().count() <= SHOWN {
        return text.to_owned();
    }
    let head: String = text.chars().take(SHOWN).collect();
    format!("{head}...")
}
