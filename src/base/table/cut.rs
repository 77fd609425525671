//! Text into header and rows: which character separates columns, and where below a preamble the table starts.
//!
//! Neither can be told from one line: a name holds the other separator (`Length, mm` between tabs), a number a decimal comma. So every
//! separator cuts the file, and the one counts whose header names what a test has, whose rows are as wide as the header, and whose
//! cells are numbers.

use std::borrow::Cow;
use std::path::Path;

use super::Vocabulary;
use super::cells::{COLUMNS_MAX, Fault, Row, Separator, Table, whole_file};
use super::lines::Line;
use super::names::{is_unit_or_blank, with_unit};
use super::numerals::is_number;
use crate::cells::{ROWS_MAX, SMALLER, TEXT_MAX, restored, too_many};
use crate::error::{Result, fail_if};

const SAMPLE: usize = 400;
const PREAMBLE_MAX: usize = 200;

#[derive(Debug, Clone, Copy)]
pub(super) struct TableBounds {
    /// The header; `None` where the table has none.
    header: Option<usize>,
    body: usize,
    columns: usize,
    /// Whether the header names what a test has.
    named: bool,
}

/// How well a separator cuts the sample, better ones larger.
#[derive(Debug, PartialEq, PartialOrd)]
struct Merit(bool, bool, f64);

/// Cuts a text into a table.
/// Errors: no table, or rows that are not as wide as its header.
pub(super) fn text(text: &str, file: &Path, words: &dyn Vocabulary) -> Result<Table> {
    check_size(text, file)?;
    let is_comment = |line: &str| ["#", "%", "//"].iter().any(|sign| line.trim_start().starts_with(sign));
    let (lines, comments): (Vec<Line<'_>>, Vec<Line<'_>>) = written_lines(text).partition(|(_, line)| !is_comment(line));
    fail_if!(lines.is_empty(), whole_file(file).error("is empty", words.remedy()));
    let sample = &lines[..lines.len().min(SAMPLE)];
    let mut candidates: Vec<(Merit, Separator)> = Vec::new();
    for separator in Separator::ALL {
        let rows = separator.cut(sample, file)?;
        if let Some(place) = place(&rows, words) {
            candidates.push((merit(&rows, place), separator));
        }
    }
    // Stable: of equals the one that stands in numbers least.
    candidates.sort_by(|a, b| b.0.partial_cmp(&a.0).unwrap_or(std::cmp::Ordering::Equal));
    let Some(&(_, best)) = candidates.first() else {
        return Err(Fault { line: Some(lines[0].0), value: Some(lines[0].1), ..whole_file(file) }
            .error("is not a table of 2 to 4096 columns: no separator found (tab ; , | space)", words.remedy()));
    };
    let first_try = whole(best, &lines, &comments, file, words);
    if first_try.is_ok() {
        return first_try;
    }
    // What the sample did not show: another separator may cut all of it.
    let others = candidates.iter().skip(1).filter(|(merit, _)| merit.0 && merit.1);
    let second_try = others.filter_map(|&(_, other)| whole(other, &lines, &comments, file, words).ok()).next();
    second_try.map_or(first_try, Ok)
}

/// A text whose lines alone would take up much more than it does itself.
fn check_size(text: &str, file: &Path) -> Result<()> {
    let too_large = |what, count, most| Err(whole_file(file).error(too_many(what, count, most), SMALLER));
    match written_lines(text).take(ROWS_MAX + 1).count() {
        _ if text.len() > TEXT_MAX => too_large("bytes of text", text.len(), TEXT_MAX),
        lines if lines > ROWS_MAX => too_large("or more lines", lines, ROWS_MAX),
        _ => Ok(()),
    }
}

/// Lines that are not blank; they may end with LF, CRLF or CR.
fn written_lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    let end = if text.contains('\n') { '\n' } else { '\r' };
    let lines = text.split(end).enumerate().map(|(index, line)| (index + 1, line.trim_end_matches('\r')));
    lines.filter(|(_, line)| !line.trim().is_empty())
}

/// Whether a row has as many numbers as a table has columns at least.
fn has_numbers(row: &Row, words: &dyn Vocabulary) -> bool {
    row.cells.iter().filter(|cell| is_number(cell)).take(words.columns()).count() == words.columns()
}

/// Number of columns of a header: spreadsheets end rows with empty columns, which are none.
fn width(row: &Row) -> usize {
    (0..row.cells.len()).rev().find(|&column| !row.cell(column).is_empty()).map_or(0, |last| last + 1)
}

/// Where header and readings stand; `None` for less than two columns.
pub(super) fn place(rows: &[Row], words: &dyn Vocabulary) -> Option<TableBounds> {
    let head = &rows[..rows.len().min(PREAMBLE_MAX)];
    let below = |header: usize| header + 1 + usize::from(rows.get(header + 1).is_some_and(is_row_of_units));
    let names = |row: &Row| row.cells.iter().map(str::to_owned).collect::<Vec<String>>();
    let named: Vec<usize> = (0..head.len())
        .filter(|&row| {
            let can_be = (words.columns()..=COLUMNS_MAX).contains(&rows[row].cells.len()) && !is_number(rows[row].cell(0));
            can_be && words.is_header(&names(&rows[row]))
        })
        .collect();
    // A line of the preamble may speak of cycles and crack length too; below the header stand numbers.
    let above_numbers = named.iter().find(|&&row| rows.get(below(row)).is_some_and(|row| has_numbers(row, words)));
    let header = above_numbers.or(named.first()).copied();
    let (header, body, width_of) = match (header, head.iter().position(|row| has_numbers(row, words))) {
        (Some(header), _) => (Some(header), below(header), header),
        (None, Some(0)) => (None, 0, 0),
        (None, Some(first)) => {
            let over_units = first > 1 && is_row_of_units(&rows[first - 1]) && width(&rows[first - 2]) > 1;
            let header = first - 1 - usize::from(over_units);
            (Some(header), first, header)
        }
        (None, None) => (Some(0), 1.min(rows.len()), 0),
    };
    let columns = width(rows.get(width_of)?);
    (words.columns()..=COLUMNS_MAX).contains(&columns).then_some(TableBounds { header, body, columns, named: !named.is_empty() })
}

/// Rows up to the last one that has a number: what stands behind is text.
fn without_footer(rows: &[Row]) -> usize {
    // A row cut by another separator holds readings, and is no text.
    let has_number = |row: &Row| row.cells.iter().flat_map(|cell| cell.split([',', ';', '\t', '|'])).any(is_number);
    rows.iter().rposition(has_number).map_or(rows.len(), |last| last + 1)
}

fn is_row_of_units(row: &Row) -> bool {
    // `1000, 1` is a reading.
    let is_text = |cell: &str| !cell.is_empty() && !is_number(cell);
    row.cells.len() <= COLUMNS_MAX && row.cells.iter().any(is_text) && row.cells.iter().all(is_unit_or_blank)
}

fn merit(rows: &[Row], place: TableBounds) -> Merit {
    let end = without_footer(rows).max(place.body);
    let body = || rows[place.body..end].iter().filter(|row| !row.is_blank());
    let fits = body().next().is_some() && body().all(|row| width(row) <= place.columns && row.cells.len() >= place.columns);
    let (numbers, cells) = body()
        .flat_map(|row| row.cells.iter())
        .filter(|cell| !cell.is_empty())
        .fold((0_usize, 0_usize), |(numbers, cells), cell| (numbers + usize::from(is_number(cell)), cells + 1));
    // Names that no row has a cell for each of are words of other names: `N,total crack length (mm)` cut at blanks.
    let named = place.named && (body().next().is_none() || body().any(|row| row.cells.len() >= place.columns));
    Merit(named, fits, numbers as f64 / cells.max(1) as f64)
}

fn whole(separator: Separator, lines: &[Line<'_>], comments: &[Line<'_>], file: &Path, words: &dyn Vocabulary) -> Result<Table> {
    let rows = separator.cut(lines, file)?;
    let mut table = assemble(rows, file, words)?;
    table.separator = Some(separator);
    if separator == Separator::Blanks {
        // Words, not cells.
        table.preamble = lines[..table.preamble.len()].iter().map(|(line, text)| (*line, text.trim().to_owned())).collect();
    }
    let first = table.rows.first().map_or(usize::MAX, |row| row.line);
    let above = comments.iter().filter(|(line, _)| *line < first).map(|(line, text)| (*line, (*text).to_owned()));
    table.preamble.extend(above);
    if table.header_line == 0 {
        header_in_comment(&mut table, comments, separator, words);
    }
    let columns = table.header.len();
    for row in &mut table.rows {
        if row.cells.len() > columns && width(row) <= columns {
            row.cells.truncate(columns);
        }
        if !words.leaves_out(row.line) {
            check_width(row, columns, lines, separator, file)?;
        }
    }
    fail_if!(table.rows.is_empty(), whole_file(file).error("has a header but no rows", words.remedy()));
    Ok(table)
}

/// Header and readings of rows that may have a preamble.
/// Errors: less than two columns.
pub(super) fn assemble(mut rows: Vec<Row>, file: &Path, words: &dyn Vocabulary) -> Result<Table> {
    let place =
        place(&rows, words).ok_or_else(|| whole_file(file).error("is not a table of 2 to 4096 columns", words.remedy()))?;
    let cells = |row: &Row| (0..place.columns).map(|column| row.cell(column).to_owned()).collect::<Vec<String>>();
    let header = match place.header {
        Some(header) => cells(&rows[header]),
        None => (1..=place.columns).map(|column| format!("column {column}")).collect(),
    };
    let row_of_units = place.header.filter(|header| header + 1 < place.body).map(|header| &rows[header + 1]);
    let units = row_of_units.map(cells);
    let in_units = |(name, unit): (&String, &String)| {
        let fault = Fault { line: row_of_units.map(|row| row.line), key: Some(name), value: Some(unit), ..whole_file(file) };
        with_unit(name, unit).map_err(|own| {
            let problem = format!("conflicts with the unit of the name above it, {}", own.name());
            fault.error(problem, "name the unit in one place, or the same in both")
        })
    };
    let names = match &units {
        None => header.clone(),
        Some(units) => header.iter().zip(units).map(in_units).collect::<Result<_>>()?,
    };
    let header_line = place.header.map_or(0, |header| rows[header].line);
    let above = place.header.unwrap_or(0);
    let in_words = |row: &Row| (row.line, row.cells.iter().filter(|cell| !cell.is_empty()).collect::<Vec<_>>().join("; "));
    let preamble = rows[..above].iter().map(in_words).collect();
    let end = without_footer(&rows).max(place.body);
    let footer = rows.get(end).map(|first| [first.line, rows[rows.len() - 1].line]);
    rows.truncate(end);
    rows.drain(..place.body);
    // Programs that test in blocks repeat the header over each.
    let repeats = |row: &Row, of: &[String]| of.iter().enumerate().all(|(column, name)| row.cell(column) == name);
    rows.retain(|row| !row.is_blank() && !repeats(row, &header) && !units.as_ref().is_some_and(|units| repeats(row, units)));
    for row in rows.iter_mut().filter(|row| row.cells.iter().any(|cell| restored(cell) != cell)) {
        row.cells = row.cells.iter().map(restored).collect();
    }
    let header = header.iter().map(|name| restored(name).to_owned()).collect();
    let notes = Vec::new();
    Ok(Table { file: file.to_path_buf(), header, names, header_line, rows, footer, separator: None, preamble, notes })
}

/// A header behind the sign of a comment, as programs for arrays write it.
fn header_in_comment(table: &mut Table, comments: &[Line<'_>], separator: Separator, words: &dyn Vocabulary) {
    let Some(first) = table.rows.first().map(|row| row.line) else { return };
    let Some(&(line, text)) = comments.iter().rev().find(|(line, _)| *line < first) else { return };
    let text = Cow::Borrowed(text.trim_start().trim_start_matches(['#', '%', '/']));
    let Ok(rows) = separator.cut(&[(line, &text)], &table.file) else { return };
    let Some(names) = rows.first().map(|row| row.cells.iter().map(str::to_owned).collect::<Vec<String>>()) else { return };
    if names.len() == table.header.len() && words.is_header(&names) {
        (table.header, table.names, table.header_line) = (names.clone(), names, line);
    }
}

/// Complains about a row that is shorter or longer than the header.
fn check_width(row: &Row, columns: usize, lines: &[Line<'_>], separator: Separator, file: &Path) -> Result<()> {
    if row.cells.len() == columns {
        return Ok(());
    }
    let text = lines.iter().find(|(line, _)| *line == row.line).map_or("", |(_, text)| *text);
    let fault = Fault { file, line: Some(row.line), key: None, value: Some(text) };
    let other = Separator::ALL.iter().filter(|other| **other != separator).filter_map(|other| other.character());
    let mixes = other.into_iter().any(|character| character != ',' && text.contains(character));
    let (count, at) = (row.cells.len(), separator.name());
    let unit = if count == 1 { "column" } else { "columns" };
    let problem = format!("has {count} {unit} where the header has {columns}, cut at {at}");
    Err(if mixes {
        fault.error(format!("{problem}, and mixes separators"), "separate every row as the header is separated")
    } else if separator == Separator::Comma && row.cells.len() > columns {
        fault.error(problem, "give one value a column; with decimal commas separate the columns by semicolons")
    } else {
        fault.error(problem, "give one value a column")
    })
}
