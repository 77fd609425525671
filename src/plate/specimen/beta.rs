//! β(a) of a specimen from a table, `specimen.beta_file`: K for hand calculation of a `plate` and of the standard specimens
//! with through cracks.
//!
//! ```text
//! K = β(a) σ √(πa)
//! ```
//! σ is the nominal stress of the case, or under a force P on pins or rollers P / (B W), with thickness B and width W of the specimen
//! ([`Specimen::width`]; of a `plate` its size along x). a is the crack length of a standard specimen; of a `plate` half the length of a
//! crack with two tips, the whole length of one with one tip, kinks included. Tips of several cracks grow alike. ln β is smooth between
//! the rows ([`Blended`]).

use std::f64::consts::PI;

use super::{LengthConvention, LoadMeasure, Specimen, SpecimenKind};
use perilife_base::blended::Blended;
use perilife_base::error::{Error, InputError, Result, input_missing};
use perilife_base::input::Folder;
use perilife_base::units::{INCH, MM};

/// Key of the file.
pub const KEY: &str = "specimen.beta_file";
/// First line of the file.
pub const HEADER: &str = "crack_length_mm,beta";
/// The same of a table in inches.
const HEADER_INCH: &str = "crack_length_in,beta";
/// Share of a length by which the table may end before it.
const SLACK: f64 = 1e-9;
/// Share by which cracks of one table may differ in length.
const ALIKE: f64 = 1e-6;

/// β over the length of a crack of one specimen.
#[derive(Debug, Clone, PartialEq)]
pub struct BetaTable {
    /// ln β over a, m.
    logarithms: Blended,
    /// Crack length of the specimen at the start in its own convention, and the a of β there, m.
    start: [f64; 2],
    /// Tips whose growth adds up to the crack length of a `plate`; else 1.
    tips: f64,
    /// Stress σ for a nominal load of 1.
    stress: f64,
    file: String,
    last_line: usize,
    column: Column,
}

impl Specimen {
    /// Stress σ of β = K/(σ √(πa)) for a nominal load, Pa: the load itself, or force over thickness and width.
    pub fn beta_stress(&self, load: f64) -> f64 {
        match self.load_measure {
            LoadMeasure::Stress => load,
            LoadMeasure::Force => load / (self.thickness * self.width),
        }
    }

    /// The specimen at another crack length in its own convention, m, all tips having grown alike and straight on.
    pub fn grown_alike(&self, crack_length: f64) -> Specimen {
        let shared = if self.convention == LengthConvention::SumOfTips { self.tips.len().max(1) } else { 1 };
        let mut grown = self.clone();
        grown.move_tips(&vec![(crack_length - self.crack_length) / shared as f64; self.tips.len()]);
        grown.crack_length = crack_length;
        grown
    }

    /// Reads the table of β of a specimen that has its load.
    /// Errors: [`Error::Input`] by file and line on what is no table, by key on a specimen that it does not describe.
    pub fn read_beta(&mut self, file: &str, folder: &Folder) -> Result<()> {
        let (a, tips) = self.length_of_beta()?;
        let text = folder.read(file)?;
        let rows = rows(&String::from_utf8_lossy(&text)).map_err(|error| error.in_file(&folder.path(file)))?;
        let [first, last] = [rows[0], rows[rows.len() - 1]];
        if a < first.length * (1.0 - SLACK) || a > last.length * (1.0 + SLACK) {
            let (row, end) = if a < first.length { (first, "begins") } else { (last, "ends") };
            let problem = format!("is where the table {end}, and the crack has {} mm at the start", round(a));
            return Err(row.fault(problem, "give a table from the initial crack length to the end").in_file(&folder.path(file)));
        }
        self.beta = Some(BetaTable {
            logarithms: Blended::new(rows.iter().map(|row| (row.length, row.beta.ln()))),
            start: [self.crack_length, a],
            tips,
            stress: self.beta_stress(1.0),
            file: file.to_owned(),
            last_line: last.line,
            column: last.column,
        });
        Ok(())
    }

    /// The a of β at the start, m, and how many tips share the growth of the crack length.
    /// Errors: no sharp crack, or cracks of unlike length.
    fn length_of_beta(&self) -> Result<(f64, f64)> {
        if self.kind != SpecimenKind::Plate {
            return Ok((self.crack_length, 1.0));
        }
        let lines = self.crack_lines();
        let length = |tip: usize| {
            let line = &lines[self.line_end(tip)?.line];
            Some(line.length() / self.tips_of(line).max(1) as f64)
        };
        let lengths = (0..self.tips.len()).map(length).collect::<Option<Vec<f64>>>().filter(|lengths| !lengths.is_empty());
        let lengths = lengths.ok_or_else(|| {
            input_missing(
                KEY,
                "needs sharp cracks: the end of a slot has no stress intensity factor",
                "start a crack in the slot",
            )
        })?;
        let [least, most] = [f64::min, f64::max].map(|pick| lengths.iter().copied().reduce(pick).unwrap_or(f64::NAN));
        if most > least * (1.0 + ALIKE) {
            let problem =
                format!("is one table, and the cracks have unlike lengths, a = {} and {} mm", round(least), round(most));
            return Err(input_missing(KEY, problem, "leave it out: K of every crack is then found on nodes"));
        }
        Ok((most, lengths.len() as f64))
    }
}

impl BetaTable {
    /// The a of β at a crack length of the specimen, m.
    pub fn length_at(&self, crack_length: f64) -> f64 {
        self.start[1] + (crack_length - self.start[0]) / self.tips
    }

    /// β at a crack length of the specimen, m; beyond the table that of its end.
    pub fn at(&self, crack_length: f64) -> f64 {
        let lengths = self.logarithms.x();
        self.logarithms.at(self.length_at(crack_length).clamp(lengths[0], lengths[lengths.len() - 1])).exp()
    }

    /// K_I, Pa√m, at a crack length of the specimen, m, under a nominal load, Pa or N.
    pub fn k_i(&self, crack_length: f64, load: f64) -> f64 {
        self.at(crack_length) * self.stress * load * (PI * self.length_at(crack_length)).sqrt()
    }

    /// First and last crack length of the specimen that it knows, m.
    pub fn bounds(&self) -> [f64; 2] {
        let lengths = self.logarithms.x();
        [lengths[0], lengths[lengths.len() - 1]].map(|a| self.start[0] + self.tips * (a - self.start[1]))
    }

    /// Whether it knows a crack length of the specimen, m.
    pub fn holds_at(&self, crack_length: f64) -> bool {
        let [first, last] = self.bounds();
        (first * (1.0 - SLACK)..=last * (1.0 + SLACK)).contains(&crack_length)
    }

    /// Refuses an end of growth that the table does not reach: a crack length of the specimen, m.
    pub fn check_end(&self, crack_length: f64) -> Result<()> {
        if self.holds_at(crack_length) {
            return Ok(());
        }
        let a = self.logarithms.x()[self.logarithms.x().len() - 1];
        let row = Row { line: self.last_line, length: a, beta: f64::NAN, column: self.column };
        let problem = format!("is where the table ends, and growth goes on to {} mm", round(self.length_at(crack_length)));
        let most = round(self.bounds()[1]);
        Err(row.fault(problem, &format!("give a longer table, or stop.crack_length_mm up to {most}")).in_file(self.file.as_ref()))
    }
}

/// A row of the file, SI.
#[derive(Debug, Clone, Copy)]
struct Row {
    line: usize,
    length: f64,
    beta: f64,
    column: Column,
}

/// Name and unit, m, of the column of lengths.
type Column = (&'static str, f64);

impl Row {
    /// What is wrong with it, its length as the file has it.
    fn fault(self, problem: impl Into<String>, remedy: &str) -> Error {
        let length = (self.length / self.column.1 * 1e6).round() / 1e6;
        fault(self.line, self.column.0, &length.to_string(), problem, remedy)
    }
}

/// The first line: the column of lengths, with its unit in m, and whether the file has decimal commas, since its cells stand between
/// other marks. A table without it does not say its unit.
fn header((line, content): (usize, &str)) -> Result<(&'static str, f64, bool)> {
    let names = cells(content, !content.contains(','));
    match names[..] {
        ["crack_length_mm", "beta"] => Ok(("crack_length_mm", MM, !content.contains(','))),
        ["crack_length_in", "beta"] => Ok(("crack_length_in", INCH, !content.contains(','))),
        _ => {
            let problem = format!("stands where the header {HEADER} is expected");
            Err(fault(line, "row", content, problem, &format!("begin with {HEADER} or {HEADER_INCH}, then one pair a line")))
        }
    }
}

/// Cells between semicolons, tabs or blanks, and commas where those are not decimal.
fn cells(content: &str, has_decimal_commas: bool) -> Vec<&str> {
    let parts = |mark: char| matches!(mark, ';' | '\t' | ' ') || (mark == ',' && !has_decimal_commas);
    content.split(parts).filter(|cell| !cell.is_empty()).collect()
}

/// The rows of the table: two numbers a line below the header.
fn rows(text: &str) -> Result<Vec<Row>> {
    let mut rows: Vec<Row> = Vec::new();
    let lines = text.trim_start_matches('\u{feff}').lines().enumerate().map(|(place, line)| (place + 1, line.trim()));
    let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let (column, unit, has_decimal_commas) = lines.next().map_or(Ok(("crack_length_mm", MM, false)), header)?;
    for (line, content) in lines {
        let [length, beta] = cells(content, has_decimal_commas)[..] else {
            return Err(fault(line, "row", content, "is no pair of crack length and beta", &format!("give {column},beta")));
        };
        let number = |column, cell| positive(line, column, cell, has_decimal_commas);
        let row = Row { line, length: number(column, length)? * unit, beta: number("beta", beta)?, column: (column, unit) };
        if let Some(before) = rows.last().filter(|before| before.length >= row.length) {
            let problem = format!("does not rise above the {} mm of line {}", round(before.length), before.line);
            return Err(row.fault(problem, "sort the rows by crack length, each length once"));
        }
        rows.push(row);
    }
    if rows.len() < 2 {
        let count = if rows.is_empty() { "no row" } else { "one row" };
        return Err(fault(rows.len().max(1), "rows", count, "is no curve", "give two rows or more below crack_length_mm,beta"));
    }
    Ok(rows)
}

fn positive(line: usize, column: &str, cell: &str, has_decimal_commas: bool) -> Result<f64> {
    let number = if has_decimal_commas { cell.replace(',', ".").parse::<f64>() } else { cell.parse::<f64>() };
    match number {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        Ok(_) => Err(fault(line, column, cell, "is not a number above zero", "give lengths and beta = K/(σ√(πa)), above zero")),
        Err(_) => Err(fault(line, column, cell, "is not a number", "give numbers with a decimal point")),
    }
}

fn fault(line: usize, column: &str, value: &str, problem: impl Into<String>, remedy: &str) -> Error {
    Error::Input(Box::new(InputError {
        line: Some(line),
        key: Some(column.to_owned()),
        value: Some(value.to_owned()),
        problem: problem.into(),
        remedy: remedy.to_owned(),
        ..InputError::default()
    }))
}

/// Metres as mm, rounded for messages.
fn round(metres: f64) -> f64 {
    (metres / MM * 1e6).round() / 1e6
}
