//! From the cells of a table to the readings of every specimen, each checked by itself and against the one before.

use std::collections::HashMap;

use super::columns::{Layout, Series, Shape, is_stress};
use super::curve::{Loads, Measured, MeasuredCurve, READINGS_MIN, Source, Stated, first_of};
use perilife_base::error::{Error, Result, fail_if};
use perilife_base::linear_fit::line;
use perilife_base::table::Decimal;
use perilife_base::table::names::{Column, Role, is_unit_or_blank};
use perilife_base::table::quantities::number_at;
use perilife_base::table::{Fault, Row, Table, whole_file};
use perilife_base::units::MM;
use perilife_plate::specimen::LoadMeasure;

/// More cycles than any test has run: beyond it the unit is wrong.
const CYCLES_MAX: f64 = 1e15;
/// Longer than any specimen, m: beyond it the unit is wrong.
const LENGTH_MAX: f64 = 100.0;
/// What is done about a bad row: an error ends the reading.
type Fate<'a> = &'a mut dyn FnMut(Error) -> Result<()>;

pub(super) fn curves_of(table: &Table, layout: &Layout, of_plate: bool, fate: Fate<'_>) -> Result<Measured> {
    let mut measured = Measured { curves: Vec::new(), warnings: layout.warnings.clone() };
    for series in &layout.series {
        let mut of_series = curves(table, layout.decimal, series, fate)?;
        if let Some(column) = series.optical {
            let correct = |curve| correct(curve, table, layout.decimal, column);
            measured.warnings.extend(of_series.iter_mut().map(correct).collect::<Result<Vec<_>>>()?);
        }
        measured.curves.extend(of_series);
    }
    let mut falling = Vec::new();
    for curve in &measured.curves {
        let specimen = || Fault { key: Some("specimen"), value: Some(&curve.specimen), ..whole_file(&table.file) };
        // A run-out has few readings of one length; it is named where the lot is complete.
        let stands = curve.crack_length.iter().all(|length| *length <= curve.crack_length[0]) && curve.cycles.len() > 1;
        let (count, least) = (curve.cycles.len(), if of_plate || stands { 1 } else { READINGS_MIN });
        if count < least {
            let problem = format!("has {count} reading{}", if count == 1 { "" } else { "s" });
            fate(specimen().error(problem, format!("give at least {least} readings for every specimen")))?;
        } else if layout.shape == Shape::WideLengths && curve.crack_length.last() <= curve.crack_length.first() {
            let remedy = "remove columns of other quantities from a wide table, or set measured.columns.length";
            fate(specimen().error("does not increase: not a crack length", remedy))?;
        }
        let falls = curve.crack_length.windows(2).filter(|pair| pair[1] < pair[0]).count();
        if falls > 0 {
            let (file, name) = (table.file.display(), &curve.specimen);
            let drops = format!("crack length drops at {falls} of {count} readings (treated as noise)");
            falling.push(format!("readings: {file}: specimen {name}: {drops}"));
        }
    }
    measured.warnings.extend(first_of(falling));
    Ok(measured)
}

/// Crack plane orientations after ASTM E1823; labels of what is noted, the longer ones first; words that only an environment has.
const ORIENTATIONS: [&str; 12] = ["L-T", "T-L", "L-S", "S-L", "S-T", "T-S", "C-R", "R-C", "C-L", "L-C", "R-L", "L-R"];
const OF_ORIENTATION: [&str; 7] =
    ["crack plane orientation", "crack plane", "orientation", "orientierung", "rissorientierung", "rissebene", "probenlage"];
const OF_WAVEFORM: [&str; 6] = ["waveform", "wellenform", "test frequency", "frequency", "prüffrequenz", "frequenz"];
const OF_ENVIRONMENT: [&str; 9] = [
    "test environment", "environment", "test temperature", "temperature", "atmosphere", "umgebung", "prüftemperatur",
    "temperatur", "medium",
];
const ENVIRONMENTS: [&str; 12] =
    ["air", "vacuum", "humid", "humidity", "seawater", "salt", "room temperature", "°c", "deg c", "laborluft", "luft", "vakuum"];

/// Fields of the lines above a table.
pub(super) fn fields(table: &Table) -> Vec<Vec<String>> {
    let trimmed = |part: &str| part.trim_matches(|c: char| c.is_whitespace() || "#%*".contains(c)).to_owned();
    let parts = |line: &str| line.split(['|', ';', '\t']).flat_map(|part| part.split(", ")).map(trimmed).collect();
    table.preamble.iter().map(|(_, line)| parts(&line.replace('"', ""))).collect()
}

/// What a field says behind one of these labels, or the fields behind it, perhaps with a unit in brackets or a field.
fn labelled(line: &[String], place: usize, labels: &[&str]) -> Option<String> {
    let of = |label: &&str| Some((line[place].get(..label.len())?, line[place].get(label.len()..)?));
    let is_label =
        |own: &&str| of(own).is_some_and(|(a, b)| a.eq_ignore_ascii_case(own) && !b.starts_with(char::is_alphanumeric));
    let rest = of(labels.iter().find(|own| is_label(own))?)?.1.trim_start();
    let (unit, rest) = rest.strip_prefix(['(', '[']).and_then(|rest| rest.split_once([')', ']'])).unwrap_or(("", rest));
    let own = rest.trim_start_matches([' ', ':', '=']);
    let mut behind = line[place + 1..].iter().map(String::as_str);
    // `W`, `W mm` or `W (mm)` in a cell, the number in the next one, and perhaps its unit behind that.
    let is_unit = |text: &&str| text.contains(char::is_alphabetic) && is_unit_or_blank(text);
    let (unit, value) =
        if own.is_empty() || is_unit(&own) { (if own.is_empty() { unit } else { own }, behind.next()?) } else { (unit, own) };
    let is_number = value.replace(',', ".").parse::<f64>().is_ok();
    let unit = if unit.is_empty() { behind.next().filter(is_unit).unwrap_or_default() } else { unit };
    Some(if is_number { format!("{value} {unit}").trim_end().to_owned() } else { value.to_owned() })
}

/// All that the lines above a table say behind one of these labels.
pub fn said_above(lines: &[Vec<String>], labels: &[&str]) -> Vec<String> {
    let of_line = |line: &Vec<String>| (0..line.len()).filter_map(|at| labelled(line, at, labels)).collect::<Vec<_>>();
    lines.iter().flat_map(of_line).filter(|value| !value.is_empty()).collect()
}

/// Orientation, environment and waveform of a test, as the lines above a table note them.
fn noted(table: &Table) -> [Option<String>; 3] {
    let lines = fields(table);
    let is_written = |c: char| c.is_alphanumeric() || "-°%.".contains(c);
    let is_environment = |part: &str| {
        let own = format!(" {} ", part.to_lowercase().replace(|c| !is_written(c), " "));
        ENVIRONMENTS.iter().any(|name| own.contains(&format!(" {name} ")))
    };
    let of_label = said_above(&lines, &OF_ENVIRONMENT);
    let unlabelled = |line: &&Vec<String>, at: usize| labelled(line, at, &OF_ENVIRONMENT).is_none() && is_environment(&line[at]);
    let others =
        lines.iter().flat_map(|line| (0..line.len()).filter(move |at| unlabelled(&line, *at)).map(move |at| line[at].clone()));
    let others: Vec<String> = others.filter(|part| !of_label.contains(part)).collect();
    // Without its hyphen an orientation needs its label.
    let plain = |text: &str| text.replace(['-', ' '], "").to_uppercase();
    let said = said_above(&lines, &OF_ORIENTATION);
    let said = said.iter().find_map(|value| ORIENTATIONS.iter().find(|one| plain(one) == plain(value)).copied());
    let mut words = lines.iter().flatten().flat_map(|part| part.split(|c| !is_written(c)));
    let orientation = said.or_else(|| words.find_map(|word| ORIENTATIONS[..6].iter().find(|one| **one == word).copied()));
    let waveform = said_above(&lines, &OF_WAVEFORM).into_iter().filter(|value| value.parse::<f64>().is_err());
    let joined = |all: Vec<String>| Some(all.join(", ")).filter(|words| !words.is_empty());
    [orientation.map(str::to_owned), joined([of_label, others].concat()), joined(waveform.collect())]
}

/// Curves of a series, specimens in the order of their first rows.
fn curves(table: &Table, decimal: Decimal, series: &Series, fate: Fate<'_>) -> Result<Vec<MeasuredCurve>> {
    let empty = |name: &str| {
        let length = &series.lengths[0];
        let (file, length_column) = (table.file.clone(), table.header[length.index].clone());
        let is_named_by_file = series.specimen.is_none() && series.own.is_empty();
        let is_tip_to_tip = series.lengths.iter().all(Column::is_tip_to_tip);
        let length_unit = length.factor;
        let noted = noted(table);
        let source = Source { file, length_column, length_unit, is_tip_to_tip, is_named_by_file, noted, ..Source::default() };
        MeasuredCurve { specimen: name.to_owned(), source, ..MeasuredCurve::default() }
    };
    // A specimen that has columns is one, even if nothing stands in them.
    let mut curves: Vec<MeasuredCurve> = if series.own.is_empty() { Vec::new() } else { vec![empty(&series.name)] };
    let mut places: HashMap<&str, usize> = curves.iter().map(|_| (series.name.as_str(), 0)).collect();
    let is_reading = |row: &&Row| series.own.is_empty() || series.own.iter().any(|&column| !row.cell(column).is_empty());
    for row in table.rows.iter().filter(is_reading) {
        let name = series.specimen.map_or(series.name.as_str(), |column| row.cell(column.index));
        if name.is_empty() {
            let fault = Fault { line: Some(row.line), key: Some("specimen"), value: Some("\"\""), ..whole_file(&table.file) };
            fate(fault.error("is empty", "name the specimen in every row, or remove the column"))?;
            continue;
        }
        let place = *places.entry(name).or_insert(curves.len());
        if place == curves.len() {
            curves.push(empty(name));
        }
        add_reading(&mut curves[place], table, row, decimal, series).or_else(&mut *fate)?;
    }
    Ok(curves)
}

/// Corrects crack lengths of potential drop or compliance by the few that were read optically, as E647 asks: by the straight line through those that
/// have both. What was done.
fn correct(curve: &mut MeasuredCurve, table: &Table, decimal: Decimal, optical: Column) -> Result<String> {
    let place = |row: &Row| curve.source.lines.iter().position(|line| *line == row.line);
    let rows = table.rows.iter().filter(|row| !row.cell(optical.index).is_empty());
    let both = rows.filter_map(|row| Some((curve.crack_length[place(row)?], row)));
    let both = both.map(|(own, row)| Ok((own, value(table, row, optical, decimal)?))).collect::<Result<Vec<_>>>()?;
    let (own, read): (Vec<f64>, Vec<f64>) = both.into_iter().unzip();
    let (start, name) = (
        format!("readings: {}: specimen {}: {}", table.file.display(), curve.specimen, curve.source.length_column),
        &table.header[optical.index],
    );
    let Some(line) = line(&own, &read).filter(|line| line.slope > 0.0) else {
        return Ok(format!("{start} is not corrected: {} of its readings have {name} too, and a line needs two", own.len()));
    };
    let corrected: Vec<f64> = curve.crack_length.iter().map(|length| line.intercept + line.slope * length).collect();
    if !(0.5..=2.0).contains(&line.slope) || corrected.iter().any(|length| *length <= 0.0) {
        let slope = format!("{:.3}", line.slope);
        let fault = Fault { key: Some(&curve.source.length_column), value: Some(&slope), ..whole_file(&table.file) };
        let problem =
            format!("is the slope of {name} over it, outside 0.5 to 2 or with lengths below 0: not readings of one crack");
        return Err(fault.error(problem, "correct the readings, or set the length by measured.columns"));
    }
    curve.crack_length = corrected;
    let (offset, slope, count) = (line.intercept / MM, line.slope, own.len());
    Ok(format!("{start} is corrected by {count} readings of {name} (ASTM E647): {offset:.3} mm + {slope:.4} times it"))
}

/// Adds the reading of a row after checking it by itself and against the reading before.
fn add_reading(curve: &mut MeasuredCurve, table: &Table, row: &Row, decimal: Decimal, series: &Series) -> Result<()> {
    let fault = |column: Column| table.cell_fault(row, column.index);
    let number = |column: Column| value(table, row, column, decimal);
    let cycles = series.cycles;
    let n = number(cycles)?;
    let mut a = 0.0;
    for &column in &series.lengths {
        let on_side = number(column)?;
        let remedy = "give the crack length as the test standard of the specimen defines it";
        fail_if!(on_side <= 0.0, fault(column).error("is not above 0", remedy));
        a += on_side / series.lengths.len() as f64;
    }
    fail_if!(n < 0.0, fault(cycles).error("is negative", "count cycles from 0 upwards"));
    fail_if!(n > CYCLES_MAX, fault(cycles).error("is more than 1e15 cycles", "check the number and its unit"));
    match curve.cycles.last() {
        Some(&before) if n == before => {
            let remedy = "remove duplicate cycle counts";
            return Err(fault(cycles).error("repeats the cycles of the previous reading", remedy));
        }
        Some(&before) if n < before => {
            let problem = format!("is below the previous reading ({})", before / cycles.factor);
            let remedy = "sort the readings of each specimen by cycles, or correct the number";
            return Err(fault(cycles).error(problem, remedy));
        }
        _ => {}
    }
    fail_if!(a > LENGTH_MAX, fault(series.lengths[0]).error("is more than 100 m", "check the number and its unit"));
    let sides = series.sides.iter().map(|side| number(*side)).collect::<Result<Vec<f64>>>()?;
    let load = load(table, row, decimal, series)?;
    if sides.len() > 1 {
        let [low, high] = [f64::min, f64::max].map(|of| sides.iter().copied().reduce(of).unwrap_or(a));
        curve.side_difference.push(high - low);
    }
    if let Some((maximum, ratio)) = load {
        let measure = if series.loads.iter().any(is_stress) { LoadMeasure::Stress } else { LoadMeasure::Force };
        let is_range = series.load(Role::Max).is_none() && series.load(Role::Range).is_some();
        let none = || Loads { measure, is_range, maximum: Vec::new(), ratio: Vec::new() };
        let loads = curve.loads.get_or_insert_with(none);
        loads.maximum.push(maximum);
        loads.ratio.push(ratio);
    }
    if curve.stated.is_empty() {
        curve.stated = series.compared.iter().map(|column| Stated::new(table, *column)).collect();
    }
    for (stated, column) in curve.stated.iter_mut().zip(&series.compared) {
        // A cell without a number says nothing.
        stated.values.push(value(table, row, *column, decimal).unwrap_or(f64::NAN));
    }
    curve.cycles.push(n);
    curve.crack_length.push(a);
    curve.source.lines.push(row.line);
    Ok(())
}

/// The number in a cell in SI units.
pub(super) fn value(table: &Table, row: &Row, column: Column, decimal: Decimal) -> Result<f64> {
    let number = number_at(table, row, column.index, decimal)?;
    Ok(column.factor * if column.is_log { 10_f64.powf(number) } else { number })
}

/// Largest load and stress ratio of a reading, either NaN where the file does not say it; of a file that has ranges alone, the range
/// in the place of the largest load.
fn load(table: &Table, row: &Row, decimal: Decimal, series: &Series) -> Result<Option<(f64, f64)>> {
    let [maximum, minimum, range, ratio] = [Role::Max, Role::Min, Role::Range, Role::Ratio].map(|role| series.load(role));
    let Some(column) = maximum.or(range).or(ratio) else { return Ok(None) };
    let of = |column: Option<Column>| column.map(|column| value(table, row, column, decimal)).transpose();
    // A ratio alone goes with the largest load of the case, and with a smallest load says the largest.
    let largest = match (maximum.or(range), of(minimum)?, of(ratio)?) {
        (Some(column), ..) => value(table, row, column, decimal)?,
        (None, Some(smallest), Some(ratio)) if smallest / ratio > 0.0 => smallest / ratio,
        _ => f64::NAN,
    };
    fail_if!(
        largest <= 0.0,
        table.cell_fault(row, column.index).error("is not above 0", "give the maximum load of the cycle, tension positive")
    );
    let range_beside = if maximum.is_some() { of(range)? } else { None };
    let r = match (of(minimum)?, of(ratio)?, range_beside) {
        (Some(smallest), ..) if maximum.is_some() => smallest / largest,
        // The largest is the smallest and the range.
        (Some(smallest), ..) if range.is_some() => smallest / (smallest + largest),
        (Some(_), None, _) => f64::NAN,
        (_, Some(ratio), _) => ratio,
        (None, None, Some(range)) => 1.0 - range / largest,
        (None, None, None) => f64::NAN,
    };
    if r >= 1.0 {
        let column = minimum.or(ratio).or(range).unwrap_or(column);
        return Err(table.cell_fault(row, column.index).error("gives no load range", "give a minimum load below the maximum"));
    }
    Ok(Some((largest, r)))
}
