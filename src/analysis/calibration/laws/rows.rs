//! Rates of growth over ΔK and R: from tables, those of `perilife rates` among them, or from readings.
//!
//! Columns are those of `fatigue.growth_table`. ΔK is that of ASTM E647: the tensile part of the range, ΔK = (1 - max(R, 0)) K_max.

use std::path::Path;

use crate::error::{Error, InputError, Result};
use crate::units::{MM_PER_CYCLE, MPA_SQRT_M};

/// Columns of a table of rates.
pub const DELTA_K: &str = "delta_k_mpa_sqrt_m";
/// See [`DELTA_K`].
pub const GROWTH_RATE: &str = "da_dn_mm_per_cycle";
/// See [`DELTA_K`].
pub const RATIO: &str = "stress_ratio";
/// A flag of `perilife rates` that speaks against nothing.
const HARMLESS: &str = "load_changes";

/// One rate.
#[derive(Debug, Clone, PartialEq)]
pub struct RateRow {
    /// Test it belongs to: its file, and the specimen where the file names one. Rows of a test follow each other.
    pub series: String,
    /// Where it stands, for messages.
    pub place: String,
    /// ΔK, Pa√m.
    pub delta_k: f64,
    /// da/dN, m/cycle.
    pub rate: f64,
    /// Stress ratio R.
    pub ratio: f64,
}

impl RateRow {
    /// K_max, Pa√m.
    pub fn k_max(&self) -> f64 {
        self.delta_k / (1.0 - self.ratio.max(0.0))
    }

    /// ln of the rate in mm/cycle.
    pub fn log_rate(&self) -> f64 {
        (self.rate / MM_PER_CYCLE).ln()
    }
}

/// Rates of a table, and how many of its rows something speaks against, which are left out.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RateTable {
    /// Good rows.
    pub rows: Vec<RateRow>,
    /// Rows that carry a flag of `perilife rates`.
    pub flagged: usize,
}

/// Reads a table; `ratio` is that of all its rows, where it has no such column.
/// Errors: a table without the columns, cells that are no numbers or none of growth, a stress ratio given twice or not at all.
pub fn read(bytes: &[u8], file: &Path, ratio: Option<f64>) -> Result<RateTable> {
    read_rows(bytes, file, ratio).map_err(|error| error.in_file(file))
}

fn wrong(line: u64, key: &str, value: &str, problem: impl Into<String>, remedy: impl Into<String>) -> Error {
    Error::Input(Box::new(InputError {
        line: Some(line as usize),
        key: Some(key.to_owned()),
        value: Some(value.to_owned()),
        problem: problem.into(),
        remedy: remedy.into(),
        ..InputError::default()
    }))
}

fn read_rows(bytes: &[u8], file: &Path, given: Option<f64>) -> Result<RateTable> {
    // A byte order mark is no part of the first name.
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(bytes);
    let broken = |error: csv::Error| {
        let line = error.position().map_or(1, csv::Position::line);
        wrong(
            line,
            "row",
            "",
            format!("cannot be read as CSV: {error}"),
            "separate columns by commas, numbers with a decimal point",
        )
    };
    let header = reader.headers().map_err(broken)?.clone();
    let column = |name: &str| header.iter().position(|column| column == name);
    let [Some(delta_k), Some(rate)] = [DELTA_K, GROWTH_RATE].map(column) else {
        let names = header.iter().collect::<Vec<_>>().join(",");
        let remedy = format!(
            "name the columns {DELTA_K}, {GROWTH_RATE} and {RATIO}; `perilife rates` writes such a table from a-N readings"
        );
        return Err(wrong(1, "header", &names, format!("lacks the columns {DELTA_K} and {GROWTH_RATE}"), remedy));
    };
    let ratio = column(RATIO);
    match (ratio, given) {
        (Some(_), Some(given)) => {
            let problem = format!("is a column, and stress_ratio = {given} is given for the file");
            return Err(wrong(1, "header", RATIO, problem, "leave one of them out"));
        }
        (None, None) => {
            let remedy = format!("add a column {RATIO}, or write {{ file = \"{}\", stress_ratio = ... }}", file.display());
            return Err(wrong(1, "header", RATIO, "is no column, and no stress_ratio is given for the file", remedy));
        }
        _ => {}
    }
    let (specimen, flags) = (column("specimen"), column("flags"));
    let mut table = RateTable::default();
    for record in reader.records() {
        let record = record.map_err(broken)?;
        let line = record.position().map_or(0, csv::Position::line);
        let cell = |at: usize| record.get(at).unwrap_or("");
        if flags.is_some_and(|flags| cell(flags).split_whitespace().any(|word| word != HARMLESS)) {
            table.flagged += 1;
            continue;
        }
        let value = |at: usize, key: &str| -> Result<f64> {
            let number = cell(at).parse::<f64>().ok().filter(|number| number.is_finite());
            let remedy = if cell(at).is_empty() && key == DELTA_K {
                "give ΔK in every row: `perilife rates --specimen CASE.toml` knows it"
            } else {
                "give a plain number such as 1.2e-5"
            };
            number.ok_or_else(|| wrong(line, key, cell(at), "is not a number", remedy))
        };
        let above_zero = |at: usize, key: &str| {
            let size = value(at, key)?;
            let remedy = "leave rows without growth out";
            if size > 0.0 { Ok(size) } else { Err(wrong(line, key, cell(at), "is not above zero", remedy)) }
        };
        let of_row = ratio.map_or(Ok(given.unwrap_or(0.0)), |at| value(at, RATIO))?;
        if of_row >= 1.0 {
            return Err(wrong(line, RATIO, &of_row.to_string(), "is no stress ratio below 1", "give K_min over K_max"));
        }
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        table.rows.push(RateRow {
            series: specimen.map_or_else(|| format!("{name}, R {of_row}"), |at| format!("{name}, {}", cell(at))),
            place: format!("{}: line {line}", file.display()),
            delta_k: above_zero(delta_k, DELTA_K)? * MPA_SQRT_M,
            rate: above_zero(rate, GROWTH_RATE)? * MM_PER_CYCLE,
            ratio: of_row,
        });
    }
    Ok(table)
}
