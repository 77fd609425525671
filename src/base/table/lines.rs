//! Bytes of a text file as text (UTF-8 or UTF-16 with or without a byte order mark, else Windows-1252), what stands between the columns
//! of its lines, and lines cut by it.

use std::borrow::Cow;
use std::path::Path;

use csv::StringRecord;
use encoding_rs::{Encoding, UTF_16BE, UTF_16LE, WINDOWS_1252};

use super::cells::{Fault, Row, Separator, whole_file};
use super::numerals::GROUPING;
use crate::cells::{CELLS_MAX, SMALLER, too_many};
use crate::error::Result;

/// Bytes looked at for the zeros that UTF-16 without a mark is known by.
const LOOKED_AT: usize = 256;

/// The text of a file without byte order mark.
/// Errors: characters that no text has: the file is something else.
pub fn decoded<'a>(bytes: &'a [u8], file: &Path) -> Result<Cow<'a, str>> {
    let text = match Encoding::for_bom(bytes).map(|(encoding, _)| encoding).or_else(|| unmarked_utf16(bytes)) {
        Some(encoding) => encoding.decode(bytes).0,
        None => match std::str::from_utf8(bytes) {
            Ok(text) => Cow::Borrowed(text),
            // Spreadsheets of Western Europe; every byte is a character in it.
            Err(_) => WINDOWS_1252.decode(bytes).0,
        },
    };
    let strange =
        |c: char| (c.is_control() && !matches!(c, '\t' | '\n' | '\r' | '\u{b}' | '\u{c}' | '\u{85}')) || c == '\u{fffd}';
    if let Some(place) = text.find(strange) {
        let line = 1 + text[..place].matches('\n').count();
        return Err(Fault { line: Some(line), ..whole_file(file) }
            .error("is not text (it has control characters)", "save the table as CSV in UTF-8, or as .xlsx"));
    }
    Ok(text)
}

/// UTF-16 of mostly Latin letters has a zero in every other byte.
fn unmarked_utf16(bytes: &[u8]) -> Option<&'static Encoding> {
    let head = &bytes[..bytes.len().min(LOOKED_AT) & !1];
    let zeros = |offset: usize| head.iter().skip(offset).step_by(2).filter(|&&byte| byte == 0).count();
    let (even, odd, most) = (zeros(0), zeros(1), head.len() / 2 * 3 / 4);
    match head.len() {
        0..8 => None,
        _ if odd > most && even == 0 => Some(UTF_16LE),
        _ if even > most && odd == 0 => Some(UTF_16BE),
        _ => None,
    }
}

pub(super) type Line<'a> = (usize, &'a str);

impl Separator {
    /// The lines cut into cells, quotes respected.
    /// Errors: more cells than a table that is read may have: a byte of text can be one of them, which takes up eight and more.
    pub(super) fn cut(self, lines: &[Line<'_>], file: &Path) -> Result<Vec<Row>> {
        let cells = lines.iter().map(|(_, text)| self.cells(text)).sum::<usize>();
        if cells > CELLS_MAX {
            return Err(
                whole_file(file).error(format!("{}, cut at {}", too_many("cells", cells, CELLS_MAX), self.name()), SMALLER)
            );
        }
        match self.character() {
            // Quotes may hold the separator and line ends.
            Some(character) if lines.iter().any(|(_, text)| text.contains('"')) => records(lines, character as u8, file),
            Some(character) => Ok(lines.iter().map(|&(line, text)| Row { line, cells: at_character(text, character) }).collect()),
            None => Ok(lines.iter().map(|&(line, text)| Row { line, cells: self.at_blanks(text) }).collect()),
        }
    }

    fn cells(self, text: &str) -> usize {
        match self.character() {
            Some(character) => text.matches(character).count() + 1,
            None => words(text).count(),
        }
    }

    fn at_blanks(self, text: &str) -> StringRecord {
        let whole = text.trim();
        match self {
            Separator::Gap => whole.split("  ").map(str::trim).filter(|cell| !cell.is_empty()).collect(),
            _ => words(whole).collect(),
        }
    }
}

/// Words between blanks; no-break and thin ones separate thousands, never columns.
fn words(text: &str) -> impl Iterator<Item = &str> {
    let is_blank = |c: char| c == ' ' || c.is_whitespace() && !GROUPING.contains(&c);
    text.split(is_blank).map(str::trim).filter(|word| !word.is_empty())
}

fn at_character(text: &str, character: char) -> StringRecord {
    let mut cells = StringRecord::with_capacity(text.len(), text.matches(character).count() + 1);
    text.split(character).for_each(|cell| cells.push_field(cell.trim()));
    cells
}

/// Records of the lines. The CSV reader counts lines of what it is given, `lines` maps them to lines of the file.
fn records(lines: &[Line<'_>], separator: u8, file: &Path) -> Result<Vec<Row>> {
    let mut joined = String::with_capacity(lines.iter().map(|(_, line)| line.len() + 1).sum());
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
        rows.push(Row { line, cells: record });
    }
    Ok(rows)
}
