//! Measured a-N curves: readings of crack length against cycles, and the loads between them.
//!
//! A file is a table of readings in any usual dress: CSV in the units and names of laboratories, a workbook, with the
//! feature `tables` also Parquet. Every complaint names file, line, column and value. A crack length that falls from one reading to the
//! next is reading noise and accepted; cycles that fall or repeat are a mistake of the file and refused.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::calibration::columns::{self, Layout};
pub use crate::calibration::import::{ColumnName, ColumnNames, CycleUnit, Import, LengthUnit, LoadUnit, Sheet};
use crate::calibration::loads::Loads;
use crate::calibration::readings::curves_of;
use crate::calibration::table::{Fault, Table};
use crate::calibration::test_piece::side_difference_max;
use crate::error::{Error, InputError, Result, input};
use crate::input::Opened;
use crate::specimen::Specimen;
use crate::units::MM;

/// Fewest readings a curve can have.
pub const READINGS_MIN: usize = 5;

/// Slack of window ends against readings, m: `9.0 mm` in a file and in a key need not be the same binary number.
const LENGTH_SLACK: f64 = 1e-9;

/// Readings of one specimen, in the order of the test.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeasuredCurve {
    /// Name of the specimen.
    pub specimen: String,
    /// Cycles, rising.
    pub cycles: Vec<f64>,
    /// Crack length in the convention of the specimen, m.
    pub crack_length: Vec<f64>,
    /// Largest difference between the sides of the specimen at each reading, m; empty where one length was read.
    pub side_difference: Vec<f64>,
    /// Loads of each reading as read; `None` where the file has none.
    pub loads: Option<Loads>,
    /// Range of load at each reading over that of the case ([`Measured::resolve_loads`]); empty where it is that of the case.
    pub load_factor: Vec<f64>,
    /// Whether the growth up to each reading is left out ([`crate::calibration::leave_out`]); empty where none is.
    pub left_out: Vec<bool>,
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
    /// Cycles of the file at the first reading of a window, which counts them from 0.
    pub cycles_before: f64,
}

/// Curves of one or many files.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Measured {
    /// One curve per specimen, in the order of the files.
    pub curves: Vec<MeasuredCurve>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Reads one or many files; `-` is standard input.
pub fn read(files: &[PathBuf], import: &Import) -> Result<Measured> {
    read_into(&Opened::default(), files, import)
}

/// The same, remembering what was read.
pub fn read_into(opened: &Opened, files: &[PathBuf], import: &Import) -> Result<Measured> {
    let mut all = Measured::default();
    for file in files {
        let bytes = opened.read(file, &file.display().to_string())?;
        all.add(parse(&bytes, file, import)?)?;
    }
    Ok(all)
}

/// Reads the bytes of one file; `file` is only named in messages and, where there is no specimen column, in the curve. Its ending
/// tells Parquet from CSV.
pub fn parse(bytes: &[u8], file: &Path, import: &Import) -> Result<Measured> {
    let table = Table::read(bytes, file, import)?;
    let layout = columns::recognise(&table, import)?;
    curves_of(&table, &layout, &mut Err)
}

/// What a file holds although some of it is wrong.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Survey {
    /// Column names as written.
    pub header: Vec<String>,
    /// Cells of the first rows below them.
    pub first_rows: Vec<Vec<String>>,
    /// What its columns are.
    pub layout: Option<Layout>,
    /// Curves of the good rows.
    pub measured: Measured,
    /// What is wrong, row by row, up to [`PROBLEMS_MAX`].
    pub problems: Vec<InputError>,
}

/// Most problems that a survey names, and most warnings of one kind.
pub const PROBLEMS_MAX: usize = 100;

/// The first warnings of one kind, and how many more there are.
pub(crate) fn first_of(mut warnings: Vec<String>) -> Vec<String> {
    let more = warnings.len().saturating_sub(PROBLEMS_MAX);
    warnings.truncate(PROBLEMS_MAX);
    warnings.extend((more > 0).then(|| format!("and {more} more warnings of this kind")));
    warnings
}

/// Reads the bytes of one file as [`parse`] does, but goes on behind a bad row.
pub fn survey(bytes: &[u8], file: &Path, import: &Import) -> Survey {
    let mut survey = Survey::default();
    let mut problems: Vec<InputError> = Vec::new();
    let mut note = |error: Error| match error {
        Error::Input(problem) if problems.len() < PROBLEMS_MAX => {
            problems.push(*problem);
            Ok(())
        }
        other => Err(other),
    };
    let mut look = || {
        let table = Table::read(bytes, file, import)?;
        survey.header.clone_from(&table.header);
        survey.first_rows = table.first_cells();
        let layout = columns::recognise(&table, import)?;
        survey.measured = curves_of(&table, &layout, &mut note)?;
        survey.layout = Some(layout);
        Ok(())
    };
    match look() {
        Ok(()) => {}
        // Too many, or one that leaves no table.
        Err(Error::Input(problem)) => problems.push(*problem),
        Err(other) => {
            let file = Some(file.to_path_buf());
            problems.push(InputError { file, problem: other.to_string(), ..InputError::default() });
        }
    }
    survey.problems = problems;
    survey
}

impl Measured {
    /// Puts the curves of another file behind these.
    ///
    /// # Errors
    /// [`Error::Input`] if a specimen has a name that stands here already.
    pub fn add(&mut self, other: Measured) -> Result<()> {
        let own: HashMap<&str, &MeasuredCurve> = self.curves.iter().map(|curve| (curve.specimen.as_str(), curve)).collect();
        for curve in &other.curves {
            let Some(earlier) = own.get(curve.specimen.as_str()) else { continue };
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

    /// Warns of crack fronts that are more uneven than E647 accepts.
    pub fn check_sides(&mut self, specimen: &Specimen) {
        let limit = side_difference_max(specimen.kind, specimen.width, specimen.thickness);
        let mut of_sides = Vec::new();
        for curve in &self.curves {
            let uneven: Vec<usize> = (0..curve.side_difference.len()).filter(|&i| curve.side_difference[i] > limit).collect();
            let Some(&first) = uneven.first() else { continue };
            of_sides.push(format!(
                "{}:{}: specimen {}: crack lengths on its sides differ by {:.2} mm; at {} of {} readings by more than the {:.2} mm that \
                 ASTM E647 accepts",
                curve.source.file.display(),
                curve.line(first),
                curve.specimen,
                curve.side_difference[first] / MM,
                uneven.len(),
                curve.cycles.len(),
                limit / MM
            ));
        }
        self.warnings.extend(first_of(of_sides));
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

/// Nine significant digits for messages: hides the last bits that unit conversion leaves.
pub(crate) fn round_off(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}
