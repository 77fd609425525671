//! From the cells of a table to the readings of every specimen, each checked by itself and against the one before.

use std::collections::HashMap;

use crate::calibration::cells::{load, value};
use crate::calibration::columns::{Column, Layout, LoadColumns, Shape};
use crate::calibration::decimal::Decimal;
use crate::calibration::loads::Loads;
use crate::calibration::measured::{Measured, MeasuredCurve, READINGS_MIN, Source, first_of};
use crate::calibration::pairs::Pair;
use crate::calibration::table::{Fault, Row, Table, whole_file};
use crate::error::{Error, Result};
use crate::specimen::LoadMeasure;

/// More cycles than any test has run: beyond it the unit is wrong.
const CYCLES_MAX: f64 = 1e15;

/// Longer than any specimen, m: beyond it the unit is wrong.
const LENGTH_MAX: f64 = 100.0;

/// What is done about a bad row: an error ends the reading.
type Fate<'a> = &'a mut dyn FnMut(Error) -> Result<()>;

/// Curves of a table of cells.
pub(crate) fn curves_of(table: &Table, layout: &Layout, fate: Fate<'_>) -> Result<Measured> {
    let mut measured = Measured { curves: Vec::new(), warnings: layout.warnings.clone() };
    measured.curves = match &layout.shape {
        Shape::Long { specimen, cycles, lengths, sides, loads } => {
            let columns = ReadingColumns { cycles: *cycles, lengths, sides, loads: *loads };
            long_curves(table, layout.decimal, *specimen, &columns, fate)?
        }
        Shape::WideCycles(length, specimens) => {
            wide_curves(table, layout.decimal, specimens.iter().map(|cycles| (*cycles, *length, cycles.index)), fate)?
        }
        Shape::WideLengths(cycles, specimens) => {
            wide_curves(table, layout.decimal, specimens.iter().map(|length| (*cycles, *length, length.index)), fate)?
        }
        Shape::Paired(pairs) => paired_curves(table, layout.decimal, pairs, fate)?,
    };
    let mut falling = Vec::new();
    for curve in &measured.curves {
        let specimen = || Fault { key: Some("specimen"), value: Some(&curve.specimen), ..whole_file(&table.file) };
        if curve.cycles.len() < READINGS_MIN {
            fate(specimen().error(
                format!("has {} readings", curve.cycles.len()),
                format!("give at least {READINGS_MIN} readings for every specimen"),
            ))?;
        } else if matches!(layout.shape, Shape::WideLengths(..)) && curve.crack_length.last() <= curve.crack_length.first() {
            fate(specimen().error(
                "is a column that does not grow, so it is no crack length",
                "leave columns of other quantities out of a wide table, or name one of crack length by measured.columns.length",
            ))?;
        }
        let falls = curve.crack_length.windows(2).filter(|pair| pair[1] < pair[0]).count();
        if falls > 0 {
            falling.push(format!(
                "{}: specimen {}: crack length falls at {falls} of {} readings (taken as reading noise)",
                table.file.display(),
                curve.specimen,
                curve.cycles.len()
            ));
        }
    }
    measured.warnings.extend(first_of(falling));
    Ok(measured)
}

/// Columns of a reading.
struct ReadingColumns<'a> {
    cycles: Column,
    lengths: &'a [Column],
    sides: &'a [Column],
    loads: LoadColumns,
}

/// One row a reading; specimens in the order of their first rows.
fn long_curves(
    table: &Table,
    decimal: Decimal,
    specimen: Option<usize>,
    columns: &ReadingColumns<'_>,
    fate: Fate<'_>,
) -> Result<Vec<MeasuredCurve>> {
    let alone = table.file.file_stem().map_or_else(|| "specimen".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let mut curves: Vec<MeasuredCurve> = Vec::new();
    let mut places: HashMap<&str, usize> = HashMap::new();
    for row in &table.rows {
        let name = specimen.map_or(alone.as_str(), |column| row.cell(column));
        if name.is_empty() {
            let fault = Fault { line: Some(row.line), key: Some("specimen"), value: Some("\"\""), ..whole_file(&table.file) };
            fate(fault.error("is empty", "name the specimen in every row, or leave the column out"))?;
            continue;
        }
        let place = *places.entry(name).or_insert(curves.len());
        if place == curves.len() {
            curves.push(empty_curve(name, table, columns.lengths[0]));
        }
        add_reading(&mut curves[place], table, row, decimal, columns).or_else(&mut *fate)?;
    }
    Ok(curves)
}

/// One column a specimen; an empty cell means that the specimen was not read there.
fn wide_curves(
    table: &Table,
    decimal: Decimal,
    specimens: impl Iterator<Item = (Column, Column, usize)>,
    fate: Fate<'_>,
) -> Result<Vec<MeasuredCurve>> {
    let mut curves = Vec::new();
    for (cycles, length, own) in specimens {
        let mut curve = empty_curve(&table.header[own], table, length);
        let columns = ReadingColumns { cycles, lengths: &[length], sides: &[], loads: LoadColumns::default() };
        for row in table.rows.iter().filter(|row| !row.cell(own).is_empty()) {
            add_reading(&mut curve, table, row, decimal, &columns).or_else(&mut *fate)?;
        }
        curves.push(curve);
    }
    Ok(curves)
}

/// Two columns a specimen, each as long as its test; a row in which both are empty is none of its readings.
fn paired_curves(table: &Table, decimal: Decimal, pairs: &[Pair], fate: Fate<'_>) -> Result<Vec<MeasuredCurve>> {
    let mut curves = Vec::new();
    for Pair { specimen, cycles, length } in pairs {
        let mut curve = empty_curve(specimen, table, *length);
        let columns = ReadingColumns { cycles: *cycles, lengths: &[*length], sides: &[], loads: LoadColumns::default() };
        for row in table.rows.iter().filter(|row| !row.cell(cycles.index).is_empty() || !row.cell(length.index).is_empty()) {
            add_reading(&mut curve, table, row, decimal, &columns).or_else(&mut *fate)?;
        }
        curves.push(curve);
    }
    Ok(curves)
}

fn empty_curve(name: &str, table: &Table, length: Column) -> MeasuredCurve {
    let source = Source {
        file: table.file.clone(),
        length_column: table.header[length.index].clone(),
        length_unit: length.factor,
        ..Source::default()
    };
    MeasuredCurve { specimen: name.to_owned(), source, ..MeasuredCurve::default() }
}

/// Adds the reading of a row after checking it by itself and against the reading before.
fn add_reading(
    curve: &mut MeasuredCurve,
    table: &Table,
    row: &Row,
    decimal: Decimal,
    columns: &ReadingColumns<'_>,
) -> Result<()> {
    let (cycles, length) = (columns.cycles, columns.lengths[0]);
    let fault = |column: Column| table.cell_fault(row, column.index);
    let n = value(table, row, cycles, decimal)?;
    let mut a = 0.0;
    for column in columns.lengths {
        let on_side = value(table, row, *column, decimal)?;
        if on_side <= 0.0 {
            return Err(
                fault(*column).error("is not above 0", "give the crack length as the test standard of the specimen defines it")
            );
        }
        a += on_side / columns.lengths.len() as f64;
    }
    if n < 0.0 {
        return Err(fault(cycles).error("is negative", "count cycles from 0 upwards"));
    }
    if n > CYCLES_MAX {
        return Err(fault(cycles).error("is more than 1e15 cycles", "check the number and its unit"));
    }
    if let Some(&before) = curve.cycles.last() {
        let shown = before / cycles.factor;
        if n == before {
            return Err(
                fault(cycles).error("repeats the cycles of the reading before", "keep one reading for each number of cycles")
            );
        }
        if n < before {
            return Err(fault(cycles).error(
                format!("is below the reading before ({shown})"),
                "sort the readings of each specimen by cycles, or correct the number",
            ));
        }
    }
    if a > LENGTH_MAX {
        return Err(fault(length).error("is more than 100 m", "check the number and its unit"));
    }
    let sides = columns.sides.iter().map(|side| value(table, row, *side, decimal)).collect::<Result<Vec<f64>>>()?;
    let load = load(table, row, decimal, &columns.loads)?;
    if sides.len() > 1 {
        let [low, high] = [f64::min, f64::max].map(|of| sides.iter().copied().reduce(of).unwrap_or(a));
        curve.side_difference.push(high - low);
    }
    if let Some((maximum, ratio)) = load {
        let measure = if columns.loads.is_stress { LoadMeasure::Stress } else { LoadMeasure::Force };
        let loads =
            curve.loads.get_or_insert_with(|| Loads { is_range: columns.loads.maximum.is_none(), ..Loads::empty(measure) });
        loads.maximum.push(maximum);
        loads.ratio.push(ratio);
    }
    curve.cycles.push(n);
    curve.crack_length.push(a);
    curve.source.lines.push(row.line);
    Ok(())
}
