//! The formats of other programs: AFGROW's `.spx` and `.sub`, and FASTRAN.

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::columns;
use super::content::{Content, RawCycle};
use perilife_base::error::{Error, InputError, Result, fail_if};

/// A line that is not empty and no comment: its number, counted from 1, and what it holds.
pub(super) type Row<'a> = (usize, &'a str);

/// Lines that say something; what stands behind `#` is a comment.
pub(super) fn rows(text: &str) -> impl Iterator<Item = Row<'_>> {
    let numbered = text.lines().enumerate().map(|(place, line)| (place + 1, line.split('#').next().unwrap_or_default().trim()));
    numbered.filter(|(_, line)| !line.is_empty())
}

/// Cells of a line: between semicolons, or else between commas, tabs and blanks.
pub(super) fn cells(line: &str) -> impl Iterator<Item = &str> {
    let by_semicolon = line.contains(';');
    let is_between = move |c: char| if by_semicolon { c == ';' } else { c == ',' || c.is_whitespace() };
    line.split(is_between).map(str::trim).filter(|cell| !cell.is_empty())
}

/// The number of a cell.
/// Errors: none, or one that is not finite.
pub(super) fn number(line: usize, column: &str, cell: &str) -> Result<f64> {
    let remedy = "give a number with a decimal point";
    match cell.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(fault(Some(line), column, cell, "is not a finite number", remedy)),
        Err(_) => Err(fault(Some(line), column, cell, "is not a number", remedy)),
    }
}

/// An error about a value of a spectrum; the file is named by who knows it.
pub(super) fn fault(line: Option<usize>, column: &str, value: &str, problem: &str, remedy: &str) -> Error {
    Error::Input(Box::new(InputError {
        line,
        key: Some(column.to_owned()),
        value: Some(value.to_owned()),
        problem: problem.to_owned(),
        remedy: remedy.to_owned(),
        ..InputError::default()
    }))
}

/// `.sub` of AFGROW: sub-spectra one after the other, each a line with its number of rows, then rows `max min cycles`.
pub(super) fn sub<'a>(mut rows: impl Iterator<Item = Row<'a>>) -> Result<Content> {
    let mut found = Vec::new();
    let mut has_title = false;
    while let Some((line, title)) = rows.next() {
        // A title in words stands for one with an unknown number of rows.
        let count = if is_numbers(title) { cells(title).next().and_then(|cell| cell.parse::<usize>().ok()) } else { None };
        let is_title = !is_numbers(title) || cells(title).count() == 1;
        let remedy = "give a title line first, with the number of rows that follow";
        fail_if!(!is_title && !has_title, fault(Some(line), "row", title, "expected the title line of a .sub file", remedy));
        if !is_title {
            found.push(cycle_of_row((line, title))?);
            continue;
        }
        has_title = true;
        for read in 0..count.unwrap_or(0) {
            let Some(row) = rows.next() else {
                let problem = format!("gives more rows than follow, {read}");
                return Err(fault(Some(line), "rows", title, &problem, "give that number of rows max min cycles"));
            };
            found.push(cycle_of_row(row)?);
        }
    }
    Ok(Content::Cycles(found))
}

fn is_numbers(line: &str) -> bool {
    cells(line).all(|cell| cell.parse::<f64>().is_ok())
}

fn cycle_of_row((line, text): Row<'_>) -> Result<RawCycle> {
    let values: Vec<f64> = cells(text).map(|cell| number(line, "row", cell)).collect::<Result<_>>()?;
    match values[..] {
        [max, min] => Ok(RawCycle { line, max, min, count: 1.0 }),
        [max, min, count] => Ok(RawCycle { line, max, min, count }),
        _ => Err(fault(Some(line), "row", text, &format!("has {} values", values.len()), "give rows max min cycles")),
    }
}

const OF_FASTRAN: &str = "give a title, a line `points Smax Smin INVERT ICLIP`, then that number of peaks and valleys";

fn fastran_header(line: &str) -> Option<[f64; 5]> {
    let values: Vec<f64> = cells(line).map(|cell| cell.parse().ok()).collect::<Option<_>>()?;
    <[f64; 5]>::try_from(values).ok().filter(|[points, most, least, ..]| points.fract() == 0.0 && *points >= 2.0 && most > least)
}

/// Whether the second line of a text is such a header, below a title that is no row of five columns.
pub(super) fn is_fastran(first: &str, second: &str) -> bool {
    fastran_header(second).is_some() && fastran_header(first).is_none() && !columns::is_header(first)
}

/// Spectrum of FASTRAN: a title; `points Smax Smin INVERT ICLIP`; then so many whole numbers, maxima and minima in turn. The largest of the
/// numbers stands for Smax and the smallest for Smin, others between them in proportion.
pub(super) fn fastran<'a>(mut rows: impl Iterator<Item = Row<'a>>) -> Result<Content> {
    rows.next();
    let (line, text) = rows.next().unwrap_or((1, ""));
    let Some([points, most, least, invert, clip]) = fastran_header(text) else {
        return Err(fault(Some(line), "header", text, "is not `points Smax Smin INVERT ICLIP`", OF_FASTRAN));
    };
    for (name, value) in [("INVERT", invert), ("ICLIP", clip)] {
        let remedy = "write the final points, with 0 here; truncation_percent clips peaks";
        fail_if!(value != 0.0, fault(Some(line), name, &value.to_string(), "is not supported (it changes the points)", remedy));
    }
    let mut found = Vec::new();
    for (line, text) in rows {
        for cell in cells(text) {
            found.push(number(line, "point", cell)?);
        }
    }
    let problem = || format!("is not the number of points that follow, {}", found.len());
    fail_if!(found.len() != points as usize, fault(Some(line), "points", &points.to_string(), &problem(), OF_FASTRAN));
    let ends = found.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(*x), high.max(*x)]);
    let scale = (most - least) / (ends[1] - ends[0]);
    // Where all are equal nothing turns, which is refused where points are counted.
    let value = |x: f64| if scale.is_finite() { least + scale * (x - ends[0]) } else { x };
    Ok(Content::Points(found.into_iter().map(value).collect()))
}

const OF_SPX: &str = "give <SubSpectrum> with <B Mx=\"max\" Mn=\"min\" C=\"cycles\"/>";

/// Reads the cycles of all sub-spectra.
/// `.spx` of AFGROW: XML with `<B Mx="" Mn="" C=""/>` in every `<SubSpectrum>`, maximum, minimum and cycles in their order.
pub(super) fn spx(text: &str) -> Result<Content> {
    let mut reader = Reader::from_str(text);
    // Lines are counted as far as was read, so that the whole takes one pass.
    let (mut line, mut counted) = (1, 0);
    let mut found = Vec::new();
    loop {
        let event = reader.read_event();
        let place = (reader.buffer_position() as usize).min(text.len());
        line += text.as_bytes()[counted..place].iter().filter(|byte| **byte == b'\n').count();
        counted = place;
        match event {
            Ok(Event::Start(tag) | Event::Empty(tag)) if tag.local_name().as_ref() == "B" => {
                found.push(cycle_of_tag(&tag, line)?)
            }
            Ok(Event::Eof) => return Ok(Content::Cycles(found)),
            Ok(_) => {}
            Err(error) => return Err(fault(Some(line), "XML", &error.to_string(), "cannot be read", OF_SPX)),
        }
    }
}

fn cycle_of_tag(tag: &BytesStart<'_>, line: usize) -> Result<RawCycle> {
    let value = |name: &str| -> Result<f64> {
        let attribute = tag.try_get_attribute(name).ok().flatten();
        let attribute = attribute.ok_or_else(|| fault(Some(line), name, "", "is missing in <B>", OF_SPX))?;
        let text = attribute.value;
        number(line, name, text.trim())
    };
    Ok(RawCycle { line, max: value("Mx")?, min: value("Mn")?, count: value("C")? })
}
