//! Tables of readings as laboratories write them: cycles, crack lengths and loads of one or many specimens.
//!
//! Knows: readings and rates, loads between readings, readings left out.
//! Must not know: points, nodes, growth, fits.
//!
//! Imports `base` and `plate`.
//!
//! In the order data flows: what the user says of files (`import`); the `header` that column names make up ([`perilife_base::table::names`]); the cells
//! of a table (cut by [`perilife_base::table`]) without rows that `leave_out` and `exclusion_flags` exclude; its `columns`; `readings` of every specimen, which make up a `curve` with `loads`, some of them left out (`leave_out`); or `rates` of growth over ΔK.
//!
//! Every complaint names file, line, column and value. A crack length that falls from one reading to the next is reading noise and
//! accepted; cycles that fall or repeat are a mistake of the file and refused.

mod columns;
mod curve;
mod header;
mod import;
mod leave_out;
mod loads;
mod exclusion_flags;
pub mod rates;
mod wide_rates;
mod readings;

use std::path::{Path, PathBuf};

pub use columns::{Layout, Series, Shape};
pub use curve::{Loads, Measured, MeasuredCurve, PROBLEMS_MAX, READINGS_MIN, Source, first_of, side_difference_max};
pub use import::{ColumnNames, Import, LeaveOut, check_left_out};
pub use loads::{LoadHistory, SAME_LOAD, ratio_warnings};
pub use perilife_base::table::names::{Column, Named, Role};
pub use rates::{RangeKind, RateFile, RateFileKeys, RateRow, RateTable};

use perilife_base::error::{Error, InputError, Result};
use perilife_base::input::Opened;
use readings::curves_of;
pub use readings::said_above;

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

/// Reads the bytes of one file; `file` is only named in messages and, where there is no specimen column, in the curve.
pub fn parse(bytes: &[u8], file: &Path, import: &Import) -> Result<Measured> {
    let table = leave_out::table_of(bytes, file, import)?;
    let layout = columns::recognise(&table, import)?;
    curves_of(&table, &layout, import.of_plate, &mut Err)
}

/// What a file holds although some of it is wrong.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Survey {
    pub header: Vec<String>,
    pub first_rows: Vec<Vec<String>>,
    /// Fields of the lines above the table.
    pub above: Vec<Vec<String>>,
    pub layout: Option<Layout>,
    pub measured: Measured,
    /// What is wrong, row by row, up to [`PROBLEMS_MAX`].
    pub problems: Vec<InputError>,
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
        let table = leave_out::table_of(bytes, file, import)?;
        survey.header.clone_from(&table.header);
        survey.first_rows = table.first_cells();
        survey.above = readings::fields(&table);
        let layout = columns::recognise(&table, import)?;
        survey.measured = curves_of(&table, &layout, import.of_plate, &mut note)?;
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
