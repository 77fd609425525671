//! Growth rates as other programs keep them, several stress ratios side by side: AFGROW's `.lkpx` and easigrow's `.dadn`. They are read as the table
//! of one row a rate that [`super::rates`] takes, as are tables with a column for every stress ratio: `da/dN (mm/cycle), R=0.1, R=0.5`.

use std::fmt::Write as _;
use std::path::Path;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::header::{columns_of, ratio_of_name};
use super::import::Import;
use perilife_base::error::{Result, fail_if};
use perilife_base::table::names::{Named, Role};
use perilife_base::table::units::{RateUnit, Unit};
use perilife_base::table::{Fault, Row, Table, whole_file};

/// A rate with its ΔK at every stress ratio, in the units of the file.
type WideRow = (f64, Vec<f64>);
type Wide = (Vec<f64>, Vec<WideRow>);
type Placed = (usize, f64);

/// The rows of a file of such a kind as a table with its units in the header; `None` of other files.
/// Errors: a file that is not as these programs write it.
pub fn as_table(bytes: &[u8], file: &Path) -> Option<Result<String>> {
    let extension = file.extension()?.to_str()?.to_ascii_lowercase();
    let read = match extension.as_str() {
        "dadn" => dadn(bytes, file).map(|wide| (wide, "delta_k_mpa_sqrt_m,da_dn_m_per_cycle")),
        "lkpx" => lkpx(bytes, file),
        _ => return None,
    };
    Some(read.map(|((ratios, rows), header)| {
        let mut text = format!("{header},stress_ratio\n");
        let mut places: Vec<(usize, &f64)> = ratios.iter().enumerate().collect();
        places.sort_by(|a, b| a.1.total_cmp(b.1));
        for (place, ratio) in places {
            let known = rows.iter().filter_map(|(rate, delta_k)| Some((rate, delta_k.get(place).filter(|k| **k > 0.0)?)));
            for (rate, delta_k) in known {
                // Writing to a String cannot fail.
                let _ = writeln!(text, "{delta_k:e},{rate:e},{ratio}");
            }
        }
        text
    }))
}

/// Puts columns of stress ratios below each other, which hold ΔK beside a column of da/dN, or da/dN beside one of ΔK; an empty cell stands for
/// nothing. Without a unit in their names ΔK has that of the rates, which a note says.
pub(super) fn below_each_other(table: &mut Table, import: &Import) {
    let columns = columns_of(&table.header, &table.names, import);
    let of = |role: Role| columns.iter().find(|column| column.role == role);
    let (own, name) = match (of(Role::Rate), of(Role::DeltaK).or(of(Role::KMax))) {
        (Some(rate), None) => (rate, "ΔK"),
        (None, Some(delta_k)) => (delta_k, "da/dN"),
        _ => return,
    };
    let named = |(i, name)| ratio_of_name(name).map(|(ratio, unit)| (i, ratio, unit));
    let ratios: Vec<(usize, &str, &str)> = table.names.iter().map(String::as_str).enumerate().filter_map(named).collect();
    let Some((first, _, mut unit)) = ratios.first().copied() else { return };
    if name == "ΔK" && unit.is_empty() && import.intensity.is_none() {
        let is_inch = own.unit == Named::Is(Unit::Rate(RateUnit::Inch)) || import.rate == Some(RateUnit::Inch);
        unit = if is_inch { "(ksi√in)" } else { "(MPa√m)" };
        let (file, column) = (table.file.display(), &table.header[first]);
        table.notes.push(format!(
            "units: {file}: {column} read as ΔK {unit}, the unit that matches the rates; otherwise set intensity_unit"
        ));
    }
    let cells = |row: &Row, (i, ratio, _): &(usize, &str, &str)| {
        let cells = [row.cell(own.index), row.cell(*i), ratio].into_iter().collect();
        (!row.cell(*i).is_empty()).then_some(Row { line: row.line, cells })
    };
    let rows = ratios.iter().flat_map(|of| table.rows.iter().filter_map(|row| cells(row, of))).collect();
    let header = |own: &str| vec![own.to_owned(), format!("{name} {unit}"), "stress_ratio".to_owned()];
    let (names, header) = (header(&table.names[own.index]), header(&table.header[own.index]));
    (table.rows, table.names, table.header) = (rows, names, header);
}

/// easigrow: remarks behind `#`, a row of stress ratios, then a row a rate: da/dN in m and ΔK in MPa√m at every ratio.
fn dadn(bytes: &[u8], file: &Path) -> Result<Wide> {
    let text = String::from_utf8_lossy(bytes);
    let mut rows = Vec::new();
    let mut ratios = None;
    for (number, line) in text.lines().enumerate() {
        let words = line.split('#').next().unwrap_or_default().split(|c: char| c.is_whitespace() || c == ',');
        let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
        if words.is_empty() {
            continue;
        }
        let fault = |value| Fault { line: Some(number + 1), value: Some(value), ..whole_file(file) };
        let numbers: Vec<f64> = words
            .iter()
            .map(|word| {
                word.parse()
                    .map_err(|_| fault(word).error("is not a number", "give a row of stress ratios, then rows of da/dN and ΔK"))
            })
            .collect::<Result<_>>()?;
        match &ratios {
            None => ratios = Some(numbers),
            Some(ratios) if numbers.len() == ratios.len() + 1 => rows.push((numbers[0], numbers[1..].to_vec())),
            Some(ratios) => {
                let problem =
                    format!("has {} numbers, expected {}: da/dN and ΔK at every ratio", numbers.len(), ratios.len() + 1);
                return Err(fault(line).error(problem, "give one ΔK for every stress ratio of the first row"));
            }
        }
    }
    let ratios =
        ratios.ok_or_else(|| whole_file(file).error("has no rows", "give a row of stress ratios, then rows of da/dN and ΔK"))?;
    Ok((ratios, rows))
}

/// AFGROW: `PropertyData` with the property `tlookup`, whose `DataTable` names its columns by `Field` (`dadn` or `r_0.1`) and has its cells as
/// `FieldData`, both by `pos`; `units` of the root are `SI` or English.
fn lkpx(bytes: &[u8], file: &Path) -> Result<(Wide, &'static str)> {
    const REMEDY: &str = "export the table of rates from the program again, or give it as CSV";
    let text = String::from_utf8_lossy(bytes);
    let mut reader = Reader::from_str(&text);
    let (mut ratios, mut rows): (Vec<Placed>, Vec<Vec<Placed>>) = (Vec::new(), Vec::new());
    let (mut is_in_table, mut is_si, mut cell) = (false, false, None);
    let attribute = |element: &BytesStart<'_>, name: &str| {
        let found = element.attributes().flatten().find(|one| one.key.as_ref().eq_ignore_ascii_case(name));
        found.map(|one| one.value.into_owned())
    };
    loop {
        let event = reader.read_event().map_err(|error| whole_file(file).error(format!("is not XML: {error}"), REMEDY))?;
        match event {
            Event::Eof => break,
            Event::Start(element) | Event::Empty(element) => {
                let position = || attribute(&element, "pos").and_then(|pos| pos.trim().parse::<usize>().ok());
                if let Some(units) = attribute(&element, "units") {
                    is_si = units.eq_ignore_ascii_case("si") || units.eq_ignore_ascii_case("metric");
                }
                match element.local_name().as_ref() {
                    "PropertyData" => is_in_table = attribute(&element, "property").is_some_and(|name| name == "tlookup"),
                    "Field" if is_in_table => {
                        let ratio = attribute(&element, "property").and_then(|name| name.strip_prefix("r_")?.parse().ok());
                        ratios.extend(position().zip(ratio));
                    }
                    "row" if is_in_table => rows.push(Vec::new()),
                    "FieldData" if is_in_table => cell = position(),
                    _ => {}
                }
            }
            Event::Text(words) => {
                let number = words.trim().parse::<f64>().ok();
                if let (Some(at), Some(number), Some(row)) = (cell.take(), number, rows.last_mut()) {
                    row.push((at, number));
                }
            }
            Event::End(element) if element.local_name().as_ref() == "PropertyData" => is_in_table = false,
            _ => {}
        }
    }
    let of = |row: &[Placed], at: usize| row.iter().find(|(place, _)| *place == at).map(|(_, number)| *number);
    // The first column is the rate, whatever it is called.
    let wide: Vec<WideRow> = rows
        .iter()
        .filter_map(|row| Some((of(row, 1)?, ratios.iter().map(|(place, _)| of(row, *place).unwrap_or(0.0)).collect())))
        .collect();
    fail_if!(ratios.is_empty() || wide.is_empty(), whole_file(file).error("has no table of rates (tlookup)", REMEDY));
    let header = if is_si { "delta_k_mpa_sqrt_m,da_dn_m_per_cycle" } else { "delta_k_ksi_sqrt_in,da_dn_in_per_cycle" };
    Ok(((ratios.into_iter().map(|(_, ratio)| ratio).collect(), wide), header))
}
