//! Columns of a spectrum by their names: cycles by any two of maximum, minimum, range, mean and stress ratio, or turning points.
//!
//! Columns without names are cycles or turning points only where `loading.spectrum_format` says so; one column without a name is turning points.

use std::path::Path;

use super::content::{Content, RawCycle, SpectrumFormat};
use perilife_base::error::Result;
use perilife_base::table::names::{Kind, Named, Role};
use perilife_base::table::quantities::{Words, in_si, numbers};
use perilife_base::table::units::Unit;
use perilife_base::table::{self, Fault, Table, whole_file};

const REMEDY: &str = "name the columns max, min, cycles (or two of max, min, range, amplitude, mean, stress ratio, and \
                      cycles), or give one column of peaks and valleys";
/// Difference of a scale from the size of a unit by which both are one.
const ALIKE: f64 = 0.02;

const WORDS: Words =
    Words { kind: Kind::Spectrum, roles: &[], is_enough: |roles| format_of(roles).is_some(), columns: 1, remedy: REMEDY };

/// Maximum and minimum by what a row says of them: maximum, minimum, range, mean, ratio; `None` where that is not enough.
fn ends([max, min, range, mean, ratio]: [Option<f64>; 5]) -> Option<[f64; 2]> {
    Some(match (max, min, range, mean, ratio) {
        (Some(max), Some(min), ..) => [max, min],
        (Some(max), _, Some(range), ..) => [max, max - range],
        (_, Some(min), Some(range), ..) => [min + range, min],
        (_, _, Some(range), Some(mean), _) => [mean + 0.5 * range, mean - 0.5 * range],
        (Some(max), _, _, _, Some(ratio)) => [max, ratio * max],
        (Some(max), _, _, Some(mean), _) => [max, 2.0 * mean - max],
        (_, Some(min), _, Some(mean), _) => [2.0 * mean - min, min],
        (_, _, Some(range), _, Some(ratio)) => [range / (1.0 - ratio), ratio * range / (1.0 - ratio)],
        _ => return None,
    })
}

fn format_of(roles: &[Role]) -> Option<SpectrumFormat> {
    let has = |role: Role| roles.contains(&role);
    let given = |role: Role| has(role).then_some(1.0);
    let range = given(Role::Range).or(given(Role::Amplitude));
    let of_cycles = ends([given(Role::Max), given(Role::Min), range, given(Role::Mean), given(Role::Ratio)]);
    let loads = roles.iter().filter(|role| **role == Role::Value).count();
    match (of_cycles, loads) {
        (Some(_), 0) => Some(SpectrumFormat::Cycles),
        (None, 1) if roles.iter().all(|role| matches!(role, Role::Value | Role::Other)) => Some(SpectrumFormat::TurningPoints),
        _ => None,
    }
}

pub(super) fn is_header(line: &str) -> bool {
    let names = line.split([',', ';', '\t', '|']).filter(|name| !name.trim().is_empty());
    let roles: Vec<Role> = names.filter_map(|name| Some(WORDS.role(name)?.0)).collect();
    roles.len() > 1 && format_of(&roles).is_some()
}

/// Cycles or turning points of a table with what is to be said of them; `scale` is the unit that values have, and what a value of 1 stands for in
/// it. Values of a column with another unit are converted.
/// Errors: names that are not known or not enough, columns without names whose format is not given, cells that are not numbers.
pub(super) fn read(
    bytes: &[u8],
    file: &Path,
    asked: Option<SpectrumFormat>,
    scale: (Unit, f64),
) -> Result<(SpectrumFormat, Content, Vec<String>)> {
    let least = if asked == Some(SpectrumFormat::Cycles) { 2 } else { 1 };
    let mut table = table::read(bytes, file, &Words { columns: least, ..WORDS })?;
    let mut notes = table.warnings();
    check_preamble(&table)?;
    let (format, columns) = columns_of(&table, asked, scale)?;
    if columns.len() == 1 && format == SpectrumFormat::TurningPoints {
        notes.extend(without_count(&mut table)?);
    }
    // Forces in N may be written in thousands, as counts are; stresses, ratios and kN are below a thousand.
    let is_large = |column: &Read| match column.role {
        Role::Cycles => true,
        Role::Ratio => false,
        _ => !scale.0.is_stress() && column.factor * scale.0.si() < 1e3,
    };
    let read: Vec<(usize, bool)> = columns.iter().map(|column| (column.index, is_large(column))).collect();
    let rows = numbers(&table, &read)?;
    let of = |values: &[f64], role: Role| {
        let place = columns.iter().position(|column| column.role == role)?;
        Some(values[place] * columns[place].factor)
    };
    if format == SpectrumFormat::TurningPoints {
        let points = rows.iter().filter_map(|(_, values)| of(values, Role::Value)).collect();
        return Ok((format, Content::Points(points), notes));
    }
    if let Some(place) = columns.iter().position(|column| column.role == Role::Cycles).filter(|_| asked.is_none()) {
        // 1, 2, 3, ... as 0, 1000, 2000, 3000, ...
        let step = rows.get(1).zip(rows.first()).map_or(0.0, |(second, first)| second.1[place] - first.1[place]);
        let is_from = |from: f64| rows.iter().enumerate().all(|(row, (_, values))| values[place] == from + step * row as f64);
        if rows.len() > 2 && step > 0.0 && (is_from(0.0) || is_from(step)) {
            let problem = "ambiguous: row numbers or numbers of cycles";
            let remedy = "rename it row, or set loading.spectrum_format = \"cycles\" if these are numbers of cycles";
            return Err(table.header_fault(columns[place].index).error(problem, remedy));
        }
    }
    let cycle = |(line, values): &(usize, Vec<f64>)| {
        let value = |role: Role| of(values, role);
        let range = value(Role::Range).or(value(Role::Amplitude).map(|amplitude| 2.0 * amplitude));
        let [max, min] = ends([value(Role::Max), value(Role::Min), range, value(Role::Mean), value(Role::Ratio)])?;
        Some(RawCycle { line: *line, max, min, count: value(Role::Cycles).unwrap_or(1.0) })
    };
    Ok((format, Content::Cycles(rows.iter().filter_map(cycle).collect()), notes))
}

struct Read {
    index: usize,
    role: Role,
    factor: f64,
}

fn columns_of(table: &Table, asked: Option<SpectrumFormat>, scale: (Unit, f64)) -> Result<(SpectrumFormat, Vec<Read>)> {
    let count = table.header.len();
    let bare = |roles: &[Role]| roles.iter().enumerate().map(|(index, &role)| Read { index, role, factor: 1.0 }).collect();
    let is_title = count == 1 && format_of(&[WORDS.role(&table.names[0]).map_or(Role::Other, |(role, _)| role)]).is_none();
    if table.header_line == 0 || is_title {
        return match (asked, count) {
            (Some(SpectrumFormat::Cycles), 2 | 3) => {
                Ok((SpectrumFormat::Cycles, bare(&[Role::Max, Role::Min, Role::Cycles][..count])))
            }
            (None | Some(SpectrumFormat::TurningPoints), 1) => {
                if asked.is_none() {
                    refuse_pairs(table)?;
                }
                Ok((SpectrumFormat::TurningPoints, bare(&[Role::Value])))
            }
            _ => Err(nameless(table)),
        };
    }
    let roles = WORDS.roles(table)?;
    let only: Vec<Role> = roles.iter().map(|(role, _)| *role).collect();
    let Some(format) = format_of(&only).filter(|format| asked.is_none_or(|asked| asked == *format)) else {
        let fault = table.header_fault(0);
        return Err(fault.error("conflicts with loading.spectrum_format: columns of another format", "remove spectrum_format"));
    };
    let mut columns = Vec::new();
    for (index, (role, unit)) in roles.into_iter().enumerate().filter(|(_, (role, _))| *role != Role::Other) {
        let factor = match role {
            Role::Ratio => 1.0,
            Role::Cycles => in_si(table, index, unit, Some(Unit::Cycles(table::units::CycleUnit::Cycles)))?,
            _ => factor(table, index, unit, scale)?,
        };
        columns.push(Read { index, role, factor });
    }
    Ok((format, columns))
}

/// What values of a column are multiplied by, so that they have the unit of the scale.
/// Errors: a unit of stress beside a scale of force, or the other way round; a scale that converts the unit once more.
fn factor(table: &Table, column: usize, named: Named, (unit, scale): (Unit, f64)) -> Result<f64> {
    let factor = in_si(table, column, named, Some(unit))? / unit.si();
    let Named::Is(own) = named else { return Ok(1.0) };
    let fault = |problem: String, remedy: &str| Err(table.header_fault(column).error(problem, remedy));
    if own.is_stress() != unit.is_stress() {
        let problem = format!("is in {}, and the scale of the spectrum is in {}", own.name(), unit.name());
        return fault(problem, "give spectrum_scale_mpa = 1 for stresses, spectrum_scale_n = 1 for forces");
    }
    if factor != 1.0 && (scale / factor - 1.0).abs() < ALIKE {
        let problem = format!("is converted from {} to {}; the scale {scale} would convert it twice", own.name(), unit.name());
        return fault(problem, "set the scale to 1, or remove the unit from the name");
    }
    Ok(factor)
}

/// Numbers on both sides of a comma, which may be two columns or decimals.
fn refuse_pairs(table: &Table) -> Result<()> {
    let Some(first) = table.rows.first().filter(|_| table.rows.iter().all(|row| row.cell(0).contains(','))) else {
        return Ok(());
    };
    let remedy =
        "set loading.spectrum_format = \"cycles\" (maximum, minimum) or \"turning_points\" (decimal commas), or name the columns";
    let fault = Fault { line: Some(first.line), value: Some(first.cell(0)), ..whole_file(&table.file) };
    Err(fault.error("ambiguous: two columns, or one with decimal commas", remedy))
}

fn nameless(table: &Table) -> perilife_base::error::Error {
    let (line, shown) = match table.header_line {
        0 => {
            (table.rows.first().map(|row| row.line), table.rows.first().map(|row| row.cells.iter().collect::<Vec<_>>().join(",")))
        }
        line => (Some(line), Some(table.header.join(","))),
    };
    let fault = Fault { line, key: Some("row"), value: shown.as_deref(), ..whole_file(&table.file) };
    let count = table.header.len();
    let columns = if count == 1 { "column" } else { "columns" };
    let remedy = format!("{REMEDY}; or set loading.spectrum_format = \"cycles\" for the columns maximum, minimum, cycles");
    fault.error(format!("has {count} {columns} without a known name"), remedy)
}

fn check_preamble(table: &Table) -> Result<()> {
    let title = (table.header_line, table.header.join(" "));
    for (line, text) in table.preamble.iter().chain([&title]).filter(|(line, _)| *line > 0) {
        let numbers: Option<Vec<f64>> =
            text.split([' ', ',', ';', '\t']).filter(|word| !word.is_empty()).map(|word| word.parse().ok()).collect();
        if let Some([_, ..]) = numbers.as_deref().filter(|numbers| **numbers != [table.rows.len() as f64]) {
            let fault = Fault { line: Some(*line), value: Some(text), ..whole_file(&table.file) };
            return Err(
                fault.error("is above the table and is not its number of rows", "write one load a line, or one cycle a line")
            );
        }
    }
    Ok(())
}

/// Takes out a first number that says how many follow; what is to be said of it.
/// Errors: one that may be such a number and is not quite.
fn without_count(table: &mut Table) -> Result<Option<String>> {
    let values = numbers(table, &[(0, false)])?;
    let Some(((line, first), rest)) = values.split_first().map(|((line, values), rest)| ((*line, values[0]), rest)) else {
        return Ok(None);
    };
    let (most, follow) = (rest.iter().map(|(_, values)| values[0]).fold(0.0, f64::max), rest.len() as f64);
    if first.fract() != 0.0 || rest.len() < 4 {
        return Ok(None);
    }
    if first == follow && first > 2.0 * most {
        table.rows.remove(0);
        return Ok(Some(format!("spectrum: {}: line {line}, {first}, is the number of values below", table.file.display())));
    }
    let is_named = table.header_line > 0 && WORDS.role(&table.names[0]).is_some();
    let is_near = (0.5 * follow..=2.0 * follow).contains(&first) && first > 2.0 * most;
    if is_near || (first == follow && !is_named) {
        let cell = first.to_string();
        let fault = Fault { line: Some(line), value: Some(&cell), ..whole_file(&table.file) };
        let problem = format!("may be the number of values, and {follow} follow");
        return Err(fault.error(problem, "remove the line, or write the name load above it if it is a load"));
    }
    Ok(None)
}
