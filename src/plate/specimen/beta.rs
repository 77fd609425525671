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
use std::path::Path;

use super::{LengthConvention, LoadMeasure, Specimen, SpecimenKind};
use perilife_base::blended::Blended;
use perilife_base::error::{Error, Result, input_missing};
use perilife_base::input::Folder;
use perilife_base::table::names::{Kind, Role};
use perilife_base::table::quantities::{Words, in_si, numbers};
use perilife_base::table::{self, Fault, whole_file};
use perilife_base::units::round_mm;

pub const KEY: &str = "specimen.beta_file";
pub const HEADER: &str = "crack_length_mm,beta";
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
    /// Name of the column of its lengths, and their unit, m.
    column: (String, f64),
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
        let path = folder.path(file);
        let (rows, column) = rows(&folder.read(file)?, &path)?;
        let [first, last] = [rows[0], rows[rows.len() - 1]];
        if a < first.length * (1.0 - SLACK) || a > last.length * (1.0 + SLACK) {
            let (row, end) = if a < first.length { (first, "begins") } else { (last, "ends") };
            let problem = format!("is where the table {end}; the initial crack is {} mm", round_mm(a));
            return Err(row.fault(&path, &column, problem, "give a table from the initial crack length to the end"));
        }
        self.beta = Some(BetaTable {
            logarithms: Blended::new(rows.iter().map(|row| (row.length, row.beta.ln()))),
            start: [self.crack_length, a],
            tips,
            stress: self.beta_stress(1.0),
            file: file.to_owned(),
            last_line: last.line,
            column: (column, last.unit),
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
        let lengths = lengths
            .ok_or_else(|| input_missing(KEY, "requires cracks, not slots (a slot has no K)", "start a crack in the slot"))?;
        let [least, most] = [f64::min, f64::max].map(|pick| lengths.iter().copied().reduce(pick).unwrap_or(f64::NAN));
        if most > least * (1.0 + ALIKE) {
            let problem =
                format!("one table cannot serve cracks of different length, a = {} and {} mm", round_mm(least), round_mm(most));
            return Err(input_missing(KEY, problem, "remove it: K of each crack is then computed on nodes"));
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
        let row = BetaRow { line: self.last_line, length: a, beta: f64::NAN, unit: self.column.1 };
        let problem = format!("is the end of the table; growth continues to {} mm", round_mm(self.length_at(crack_length)));
        let most = round_mm(self.bounds()[1]);
        Err(row.fault(
            self.file.as_ref(),
            &self.column.0,
            problem,
            &format!("give a longer table, or stop.crack_length_mm up to {most}"),
        ))
    }
}

#[derive(Debug, Clone, Copy)]
struct BetaRow {
    line: usize,
    length: f64,
    beta: f64,
    unit: f64,
}

impl BetaRow {
    fn fault(self, file: &Path, name: &str, problem: impl Into<String>, remedy: &str) -> Error {
        let length = ((self.length / self.unit * 1e6).round() / 1e6).to_string();
        Fault { line: Some(self.line), key: Some(name), value: Some(&length), ..whole_file(file) }.error(problem, remedy)
    }
}

const WORDS: Words = Words {
    kind: Kind::Beta,
    roles: &[Role::Length, Role::Beta],
    is_enough: |roles| roles.contains(&Role::Beta) && roles.contains(&Role::Length),
    columns: 2,
    remedy: "begin with crack_length_mm,beta (or crack_length_in,beta), then one pair a line",
};

fn rows(bytes: &[u8], file: &Path) -> Result<(Vec<BetaRow>, String)> {
    let table = table::read(bytes, file, &WORDS)?;
    let roles = WORDS.roles(&table)?;
    let place = |wanted: Role| roles.iter().position(|(role, _)| *role == wanted).unwrap_or_default();
    let (length, beta) = (place(Role::Length), place(Role::Beta));
    let unit = in_si(&table, length, roles[length].1, None)?;
    let mut rows: Vec<BetaRow> = Vec::new();
    for (row, (line, values)) in table.rows.iter().zip(numbers(&table, &[(length, false), (beta, false)])?) {
        if let Some((column, _)) = [length, beta].into_iter().zip(&values).find(|(_, value)| **value <= 0.0) {
            let remedy = "give lengths and beta = K/(σ√(πa)), above zero";
            return Err(table.cell_fault(row, column).error("is not a number above zero", remedy));
        }
        let row = BetaRow { line, length: values[0] * unit, beta: values[1], unit };
        if let Some(before) = rows.last().filter(|before| before.length >= row.length) {
            let problem = format!("is not above the {} mm of line {}", round_mm(before.length), before.line);
            return Err(row.fault(file, &table.header[length], problem, "sort the rows by crack length, each length once"));
        }
        rows.push(row);
    }
    match rows[..] {
        [_, _, ..] => Ok((rows, table.header[length].clone())),
        _ => Err(whole_file(file).error("has only one row", "give two rows or more below crack_length_mm,beta")),
    }
}
