//! Measured a-N curves: readings of crack length against cycles, checked one by one.
//!
//! A file is a CSV table `specimen,cycles,crack_length_mm` (or wide, in other units, with semicolons; see
//! [`Units`]), with the feature `tables` also a Parquet table of the same columns. Every complaint names file, line,
//! column and value. A crack length that falls from one reading to the next is reading noise and accepted; cycles that
//! fall or repeat are a mistake of the file and refused.

use std::path::{Path, PathBuf};

use crate::calibration::columns;
pub use crate::calibration::columns::{CycleUnit, Layout, LengthUnit, Shape, Units};
use crate::calibration::text_table::{Fault, TextRow, TextTable, whole_file};
use crate::error::{Error, InputError, Result, input};
use crate::units::MM;

/// Fewest readings a curve can have.
pub const READINGS_MIN: usize = 5;

/// More cycles than any test has run: beyond it the unit is wrong.
const CYCLES_MAX: f64 = 1e15;

/// Longer than any specimen, m: beyond it the unit is wrong.
const LENGTH_MAX: f64 = 100.0;

/// Slack of window ends against readings, m: `9.0 mm` in a file and in a key need not be the same binary number.
const LENGTH_SLACK: f64 = 1e-9;

/// Readings of one specimen, in the order of the test.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredCurve {
    /// Name of the specimen.
    pub specimen: String,
    /// Cycles, rising.
    pub cycles: Vec<f64>,
    /// Crack length in the convention of the specimen, m.
    pub crack_length: Vec<f64>,
    /// Where the readings stand.
    pub source: Source,
}

/// Where the readings of a curve stand; empty for computed curves.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Source {
    /// File.
    pub file: PathBuf,
    /// Line of each reading.
    pub lines: Vec<usize>,
    /// Column of crack length.
    pub length_column: String,
    /// Metres per unit of that column.
    pub length_unit: f64,
}

/// Curves of one or many files.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Measured {
    /// One curve per specimen, in the order of the files.
    pub curves: Vec<MeasuredCurve>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Reads one or many files.
pub fn read(files: &[PathBuf], units: Units) -> Result<Measured> {
    let mut all = Measured::default();
    for file in files {
        let bytes = std::fs::read(file).map_err(|error| Error::file(file, "cannot read", error))?;
        all.add(parse(&bytes, file, units)?)?;
    }
    Ok(all)
}

/// Reads the bytes of one file; `file` is only named in messages and, where there is no specimen column, in the curve. Its ending
/// tells Parquet from CSV.
pub fn parse(bytes: &[u8], file: &Path, units: Units) -> Result<Measured> {
    let table = if is_parquet(file) { parquet_table(bytes, file) } else { TextTable::parse(bytes, file) };
    Ok(curves_of(&table?, units, &mut Err)?.0)
}

/// What a file holds although some of it is wrong.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Survey {
    /// What its columns are.
    pub layout: Option<Layout>,
    /// Curves of the good rows.
    pub measured: Measured,
    /// What is wrong, row by row, up to [`PROBLEMS_MAX`].
    pub problems: Vec<InputError>,
}

/// Most problems that a survey names.
pub const PROBLEMS_MAX: usize = 100;

/// Reads the bytes of one file as [`parse`] does, but goes on behind a bad row.
#[must_use]
pub fn survey(bytes: &[u8], file: &Path, units: Units) -> Survey {
    let mut problems: Vec<InputError> = Vec::new();
    let mut note = |error: Error| match error {
        Error::Input(problem) if problems.len() < PROBLEMS_MAX => {
            problems.push(*problem);
            Ok(())
        }
        other => Err(other),
    };
    let table = if is_parquet(file) { parquet_table(bytes, file) } else { TextTable::parse(bytes, file) };
    let read = table.and_then(|table| curves_of(&table, units, &mut note));
    match read {
        Ok((measured, layout)) => Survey { layout: Some(layout), measured, problems },
        // Too many, or one that leaves no table.
        Err(Error::Input(problem)) => {
            problems.push(*problem);
            Survey { problems, ..Survey::default() }
        }
        Err(other) => {
            problems.push(InputError { file: Some(file.to_path_buf()), problem: other.to_string(), ..InputError::default() });
            Survey { problems, ..Survey::default() }
        }
    }
}

/// What is done about a bad row: an error ends the reading.
type Fate<'a> = &'a mut dyn FnMut(Error) -> Result<()>;

fn is_parquet(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("parquet"))
}

#[cfg(feature = "tables")]
fn parquet_table(bytes: &[u8], file: &Path) -> Result<TextTable> {
    let cells = crate::tables::read_parquet(bytes, file)?;
    let rows = cells.rows.into_iter().enumerate().map(|(index, cells)| TextRow { line: index + 1, cells }).collect();
    // Row n counts as line n, and so it passes the same checks as a CSV file.
    Ok(TextTable { file: file.to_path_buf(), header: cells.header, header_line: 0, rows, decimal_comma: false })
}

#[cfg(not(feature = "tables"))]
fn parquet_table(_bytes: &[u8], file: &Path) -> Result<TextTable> {
    Err(whole_file(file)
        .error("is a Parquet table, which this build cannot read", "give CSV, or build with the feature `tables`"))
}

/// Curves of a table of cells.
fn curves_of(table: &TextTable, units: Units, fate: Fate<'_>) -> Result<(Measured, Layout)> {
    let layout = columns::recognise(table, units)?;
    let mut curves = match layout.shape {
        Shape::Long { specimen, cycles, length } => long_curves(table, &layout, (specimen, cycles, length), fate)?,
        Shape::WideCycles | Shape::WideLengths => wide_curves(table, &layout, fate)?,
    };
    let mut measured = Measured::default();
    for curve in &mut curves {
        if curve.cycles.len() < READINGS_MIN {
            let fault = Fault { key: Some("specimen"), value: Some(&curve.specimen), ..whole_file(&table.file) };
            fate(fault.error(
                format!("has {} readings", curve.cycles.len()),
                format!("give at least {READINGS_MIN} readings for every specimen"),
            ))?;
        }
        let falls = curve.crack_length.windows(2).filter(|pair| pair[1] < pair[0]).count();
        if falls > 0 {
            measured.warnings.push(format!(
                "{}: specimen {}: crack length falls at {falls} of {} readings (taken as reading noise)",
                table.file.display(),
                curve.specimen,
                curve.cycles.len()
            ));
        }
    }
    measured.curves = curves;
    Ok((measured, layout))
}

/// One row a reading; specimens in the order of their first rows.
fn long_curves(
    table: &TextTable,
    layout: &Layout,
    (specimen, cycles, length): (Option<usize>, usize, usize),
    fate: Fate<'_>,
) -> Result<Vec<MeasuredCurve>> {
    let alone = table.file.file_stem().map_or_else(|| "specimen".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let mut curves: Vec<MeasuredCurve> = Vec::new();
    for row in &table.rows {
        let name = specimen.map_or(alone.as_str(), |column| row.cells[column].as_str());
        if name.is_empty() {
            let fault = Fault { line: Some(row.line), key: Some("specimen"), value: Some("\"\""), ..whole_file(&table.file) };
            fate(fault.error("is empty", "name the specimen in every row, or leave the column out"))?;
            continue;
        }
        // The last curve is the one of the row in all files but interleaved ones.
        let place = match curves.iter().rposition(|curve| curve.specimen == name) {
            Some(place) => place,
            None => {
                curves.push(empty_curve(name, table, length, layout));
                curves.len() - 1
            }
        };
        add_reading(&mut curves[place], table, row, layout, cycles, length).or_else(&mut *fate)?;
    }
    Ok(curves)
}

/// One column a specimen; an empty cell means that the specimen was not read there.
fn wide_curves(table: &TextTable, layout: &Layout, fate: Fate<'_>) -> Result<Vec<MeasuredCurve>> {
    let mut curves = Vec::with_capacity(table.header.len() - 1);
    for column in 1..table.header.len() {
        let (cycles, length) = if layout.shape == Shape::WideCycles { (column, 0) } else { (0, column) };
        let mut curve = empty_curve(&table.header[column], table, length, layout);
        for row in table.rows.iter().filter(|row| !row.cells[column].is_empty()) {
            add_reading(&mut curve, table, row, layout, cycles, length).or_else(&mut *fate)?;
        }
        curves.push(curve);
    }
    Ok(curves)
}

fn empty_curve(name: &str, table: &TextTable, length: usize, layout: &Layout) -> MeasuredCurve {
    let source = Source {
        file: table.file.clone(),
        lines: Vec::new(),
        length_column: table.header[length].clone(),
        length_unit: layout.length_unit,
    };
    MeasuredCurve { specimen: name.to_owned(), cycles: Vec::new(), crack_length: Vec::new(), source }
}

/// Adds the reading of a row after checking it by itself and against the reading before.
fn add_reading(
    curve: &mut MeasuredCurve,
    table: &TextTable,
    row: &TextRow,
    layout: &Layout,
    cycles: usize,
    length: usize,
) -> Result<()> {
    let fault = |column: usize| Fault {
        file: &table.file,
        line: Some(row.line),
        key: Some(&table.header[column]),
        value: Some(&row.cells[column]),
    };
    let n = table.number(row, cycles)? * layout.cycle_unit;
    let a = table.number(row, length)? * layout.length_unit;
    if n < 0.0 {
        return Err(fault(cycles).error("is negative", "count cycles from 0 upwards"));
    }
    if n > CYCLES_MAX {
        return Err(fault(cycles).error("is more than 1e15 cycles", "check the number and its unit"));
    }
    if let Some(&before) = curve.cycles.last() {
        let shown = before / layout.cycle_unit;
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
    if a <= 0.0 {
        return Err(
            fault(length).error("is not above 0", "give the crack length as the test standard of the specimen defines it")
        );
    }
    if a > LENGTH_MAX {
        return Err(fault(length).error("is more than 100 m", "check the number and its unit"));
    }
    curve.cycles.push(n);
    curve.crack_length.push(a);
    curve.source.lines.push(row.line);
    Ok(())
}

impl Measured {
    /// Puts the curves of another file behind these.
    ///
    /// # Errors
    /// [`Error::Input`] if a specimen has a name that stands here already.
    pub fn add(&mut self, other: Measured) -> Result<()> {
        for curve in &other.curves {
            let Some(earlier) = self.curves.iter().find(|earlier| earlier.specimen == curve.specimen) else { continue };
            let problem = format!("stands in {} too", earlier.source.file.display());
            let fault = Fault {
                file: &curve.source.file,
                line: curve.source.lines.first().copied(),
                key: Some("specimen"),
                value: Some(&curve.specimen),
            };
            return Err(fault.error(problem, "give every specimen its own name"));
        }
        self.curves.extend(other.curves);
        self.warnings.extend(other.warnings);
        Ok(())
    }

    /// Refuses readings beyond the specimen: `limit` in m, and its name, for example "half width". Meant for the whole
    /// file before any window is cut, since a reading that cannot be tells that the file or the specimen is the wrong one.
    pub fn check_lengths(&self, limit: f64, limit_name: &str) -> Result<()> {
        for curve in &self.curves {
            let Some(reading) = curve.crack_length.iter().position(|&a| a >= limit) else { continue };
            let value = format!("{}", round_off(curve.crack_length[reading] / curve.source.length_unit));
            let fault = Fault {
                file: &curve.source.file,
                line: curve.source.lines.get(reading).copied(),
                key: Some(&curve.source.length_column),
                value: Some(&value),
            };
            return Err(fault.error(
                format!("is not inside the specimen, whose {limit_name} is {} mm", round_off(limit / MM)),
                "check the number, its unit, and whether the file gives the crack length of the specimen's test standard",
            ));
        }
        Ok(())
    }

    /// Readings between two crack lengths (m). Cycles are counted from the first reading kept; readings of that specimen
    /// that noise puts before this first one in length are left out, because a model that starts there has no cycles for them.
    pub fn window(&self, from: Option<f64>, to: Option<f64>) -> Result<Measured> {
        let from = from.unwrap_or(0.0) - LENGTH_SLACK;
        let to = to.unwrap_or(f64::INFINITY) + LENGTH_SLACK;
        let mut kept = Measured { curves: Vec::with_capacity(self.curves.len()), warnings: self.warnings.clone() };
        for curve in &self.curves {
            let one = curve.window(from, to);
            if one.cycles.len() < READINGS_MIN {
                return Err(input(
                    "measured.from_crack_length_mm .. to_crack_length_mm",
                    format!("{} .. {}", round_off((from + LENGTH_SLACK) / MM), round_off((to - LENGTH_SLACK) / MM)),
                    format!("leaves {} of {} readings of specimen {}", one.cycles.len(), curve.cycles.len(), curve.specimen),
                    format!("widen the window to at least {READINGS_MIN} readings of every specimen"),
                ));
            }
            kept.curves.push(one);
        }
        Ok(kept)
    }
}

impl MeasuredCurve {
    fn window(&self, from: f64, to: f64) -> MeasuredCurve {
        let inside = |&reading: &usize| self.crack_length[reading] >= from && self.crack_length[reading] <= to;
        let first = (0..self.cycles.len()).find(inside);
        let start = first.map_or((0.0, from), |first| (self.cycles[first], self.crack_length[first]));
        let readings: Vec<usize> =
            (0..self.cycles.len()).filter(inside).filter(|&reading| self.crack_length[reading] >= start.1).collect();
        MeasuredCurve {
            specimen: self.specimen.clone(),
            cycles: readings.iter().map(|&reading| self.cycles[reading] - start.0).collect(),
            crack_length: readings.iter().map(|&reading| self.crack_length[reading]).collect(),
            source: Source {
                lines: readings.iter().filter_map(|&reading| self.source.lines.get(reading).copied()).collect(),
                ..self.source.clone()
            },
        }
    }

    /// Cycles from the first reading to the last.
    #[must_use]
    pub fn life(&self) -> f64 {
        self.cycles.last().unwrap_or(&0.0) - self.cycles.first().unwrap_or(&0.0)
    }
}

/// Nine significant digits for messages: hides the last bits that unit conversion leaves.
fn round_off(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}
