//! Readings of crack length against cycles, with the loads between them.

use std::collections::HashMap;
use std::path::PathBuf;

use super::columns::is_stress;
use perilife_base::error::{Error, Result, input};
use perilife_base::input::LENGTH;
use perilife_base::table::names::{Column, Role};
use perilife_base::table::{Fault, Table};
use perilife_base::units::{MM, round_off};
use perilife_plate::specimen::{LoadMeasure, Specimen, SpecimenKind};

pub const READINGS_MIN: usize = 5;
/// Fall of a crack length over the scatter of readings, and over the whole growth, beyond which a reading is a typing error.
const FALL_SCATTERS: f64 = 10.0;
const FALL_SHARE: f64 = 0.02;
/// Slack of window ends against readings, m: `9.0 mm` in a file and in a key need not be the same binary number.
const LENGTH_SLACK: f64 = 1e-9;

/// Readings of one specimen, in the order of the test.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeasuredCurve {
    pub specimen: String,
    pub cycles: Vec<f64>,
    /// Crack length in the convention of the specimen, m.
    pub crack_length: Vec<f64>,
    /// Largest difference between the sides of the specimen at each reading, m; empty where one length was read.
    pub side_difference: Vec<f64>,
    /// Loads of each reading as read; `None` where the file has none.
    pub loads: Option<Loads>,
    /// What the file says beside readings and the case says too.
    pub stated: Vec<Stated>,
    /// Range of load at each reading over that of the case ([`Measured::resolve_loads`]); empty where it is that of the case.
    pub load_factor: Vec<f64>,
    /// Whether the growth up to each reading is left out (`measured.leave_out`); empty where none is.
    pub left_out: Vec<bool>,
    /// Precision of a reading, m, where the user says it.
    pub precision: Option<f64>,
    pub source: Source,
}

/// A column of a quantity that the case says too.
#[derive(Debug, Clone, PartialEq)]
pub struct Stated {
    pub role: Role,
    pub is_stress: bool,
    pub column: String,
    /// What a number of the file is multiplied by for SI units.
    pub factor: f64,
    /// Of every reading, SI; NaN where the cell holds no number.
    pub values: Vec<f64>,
}

impl Stated {
    pub(super) fn new(table: &Table, column: Column) -> Self {
        let name = table.header[column.index].clone();
        Stated { role: column.role, is_stress: is_stress(&column), column: name, factor: column.factor, values: Vec::new() }
    }
}

/// Where the readings of a curve stand; empty for computed curves.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Source {
    pub file: PathBuf,
    pub lines: Vec<usize>,
    pub length_column: String,
    /// Metres per unit of that column.
    pub length_unit: f64,
    /// Whether the file has lengths tip to tip, of which the half was taken.
    pub is_tip_to_tip: bool,
    pub is_named_by_file: bool,
    /// Cycles of the file at the first reading of a window, which counts them from 0.
    pub cycles_before: f64,
    /// Orientation, environment and waveform, as noted above its table.
    pub noted: [Option<String>; 3],
}

/// Loads of the readings of a curve as a file has them.
#[derive(Debug, Clone, PartialEq)]
pub struct Loads {
    /// Force (N) or gross stress (Pa).
    pub measure: LoadMeasure,
    /// Whether `maximum` holds ranges.
    pub is_range: bool,
    /// Largest load of a cycle; NaN where that of the case holds.
    pub maximum: Vec<f64>,
    /// Smallest over largest load; NaN where the file does not say it, and that of the case holds.
    pub ratio: Vec<f64>,
}

impl Loads {
    fn of_readings(&self, readings: &[usize]) -> Self {
        let some = |of: &[f64]| readings.iter().filter_map(|&reading| of.get(reading).copied()).collect();
        Loads { maximum: some(&self.maximum), ratio: some(&self.ratio), ..*self }
    }
}

impl MeasuredCurve {
    /// Readings without loads or other remarks.
    pub fn new(specimen: impl Into<String>, cycles: Vec<f64>, crack_length: Vec<f64>) -> Self {
        MeasuredCurve { specimen: specimen.into(), cycles, crack_length, ..MeasuredCurve::default() }
    }

    fn window(&self, from: f64, to: f64) -> MeasuredCurve {
        let inside = |&reading: &usize| self.crack_length[reading] >= from && self.crack_length[reading] <= to;
        let first = (0..self.cycles.len()).find(inside);
        let start = first.map_or(from, |first| self.crack_length[first]);
        let readings: Vec<usize> =
            (0..self.cycles.len()).filter(inside).filter(|&reading| self.crack_length[reading] >= start).collect();
        self.of_readings(&readings)
    }

    /// The curve of some of its readings, in their order, cycles counted from the first. The growth between two of them is left out
    /// where that of any step between them was.
    pub fn of_readings(&self, readings: &[usize]) -> MeasuredCurve {
        fn some<T: Copy>(of: &[T], readings: &[usize]) -> Vec<T> {
            readings.iter().filter_map(|&reading| of.get(reading).copied()).collect()
        }
        let start = readings.first().map_or(0.0, |&first| self.cycles[first]);
        let steps = readings.iter().enumerate().map(|(i, &to)| (if i == 0 { to } else { readings[i - 1] }, to));
        let left_out = steps.map(|(from, to)| (from + 1..=to).any(|step| self.left_out.get(step) == Some(&true)));
        MeasuredCurve {
            specimen: self.specimen.clone(),
            cycles: readings.iter().map(|&reading| self.cycles[reading] - start).collect(),
            crack_length: some(&self.crack_length, readings),
            side_difference: some(&self.side_difference, readings),
            loads: self.loads.as_ref().map(|loads| loads.of_readings(readings)),
            stated: Vec::new(),
            precision: self.precision,
            load_factor: some(&self.load_factor, readings),
            left_out: if self.left_out.is_empty() { Vec::new() } else { left_out.collect() },
            source: Source {
                lines: some(&self.source.lines, readings),
                cycles_before: self.source.cycles_before + start,
                ..self.source.clone()
            },
        }
    }

    /// Whether every reading has the load of the case and counts.
    pub fn is_plain(&self) -> bool {
        self.load_factor.is_empty() && !self.left_out.contains(&true)
    }

    pub fn counts(&self, reading: usize) -> bool {
        self.left_out.get(reading) != Some(&true)
    }

    /// Cycles since the first reading, those of steps left out taken off.
    pub fn cycles_counted(&self) -> Vec<f64> {
        let Some(&first) = self.cycles.first() else { return Vec::new() };
        if !self.left_out.contains(&true) {
            return self.cycles.iter().map(|n| n - first).collect();
        }
        let mut sum = 0.0;
        let step = |i: usize| if i > 0 && self.counts(i) { self.cycles[i] - self.cycles[i - 1] } else { 0.0 };
        (0..self.cycles.len())
            .map(|i| {
                sum += step(i);
                sum
            })
            .collect()
    }

    /// Usual scatter of a reading about the straight line between its neighbours, m: 1.4826 times the median of the distances, as a standard
    /// deviation of one reading.
    pub fn scatter(&self) -> f64 {
        let mut distances: Vec<f64> = (1..self.cycles.len().saturating_sub(1)).map(|i| self.off_line(i).abs()).collect();
        distances.sort_by(f64::total_cmp);
        // The line has half the variance of a reading beside that of the reading itself.
        distances.get(distances.len() / 2).map_or(0.0, |median| 1.4826 * median / 1.5_f64.sqrt())
    }

    /// Distance of a reading from the straight line between its neighbours, m; 0 at the ends.
    fn off_line(&self, i: usize) -> f64 {
        if i == 0 || i + 1 >= self.cycles.len() {
            return 0.0;
        }
        let [n, a] = [&self.cycles, &self.crack_length];
        let share = (n[i] - n[i - 1]) / (n[i + 1] - n[i - 1]);
        a[i] - a[i - 1] - share * (a[i + 1] - a[i - 1])
    }

    /// The readings from which, or to which, the crack falls back by more than ten times the scatter and two percent of its growth, where
    /// leaving that one reading out mends it: typing errors.
    pub(super) fn typing_errors(&self) -> Vec<usize> {
        let last = self.cycles.len() - 1;
        let least = (FALL_SCATTERS * self.scatter()).max(FALL_SHARE * (self.crack_length[last] - self.crack_length[0]));
        let mut errors: Vec<usize> = Vec::new();
        for i in 1..=last {
            if self.crack_length[i - 1] - self.crack_length[i] <= least || errors.last() == Some(&(i - 1)) {
                continue;
            }
            let wrong = if self.off_line(i - 1).abs() > self.off_line(i).abs() { i - 1 } else { i };
            let mends = wrong == 0 || wrong == last || self.crack_length[wrong + 1] - self.crack_length[wrong - 1] > -least;
            if mends {
                errors.push(wrong);
            }
        }
        errors
    }

    /// Where a reading stands, for messages: its line, or its number where there is no file.
    pub fn line(&self, reading: usize) -> usize {
        self.source.lines.get(reading).copied().unwrap_or(reading + 1)
    }

    /// Stem of the file of a curve that is the only one of its file and has no name of its own.
    fn file_stem(&self) -> Option<String> {
        self.source.is_named_by_file.then(|| self.source.file.file_stem().unwrap_or_default().to_string_lossy().into_owned())
    }

    fn folder_name(&self) -> Option<String> {
        Some(self.source.file.parent()?.file_name()?.to_string_lossy().into_owned())
    }

    pub(super) fn fault(&self, reading: usize) -> Fault<'_> {
        Fault { file: &self.source.file, line: self.source.lines.get(reading).copied(), key: None, value: None }
    }

    pub(super) fn wrong_length(&self, reading: usize, problem: impl Into<String>, remedy: impl Into<String>) -> Error {
        let value = round_off(self.crack_length[reading] / self.source.length_unit).to_string();
        Fault { key: Some(&self.source.length_column), value: Some(&value), ..self.fault(reading) }.error(problem, remedy)
    }

    /// File, line and specimen of a reading, to go in front of a message.
    pub(super) fn place(&self, reading: usize) -> String {
        format!("{}: line {}: specimen {}", self.source.file.display(), self.line(reading), self.specimen)
    }

    /// Cycles from the first reading to the last.
    pub fn life(&self) -> f64 {
        self.cycles.last().unwrap_or(&0.0) - self.cycles.first().unwrap_or(&0.0)
    }
}

#[derive(Debug, Clone, PartialEq, Default)]
pub struct Measured {
    /// One curve per specimen, in the order of the files.
    pub curves: Vec<MeasuredCurve>,
    pub warnings: Vec<String>,
}

/// Most problems that a survey names, and most warnings of one kind.
pub const PROBLEMS_MAX: usize = 100;

/// The first warnings of one kind, and how many more there are.
pub fn first_of(mut warnings: Vec<String>) -> Vec<String> {
    let more = warnings.len().saturating_sub(PROBLEMS_MAX);
    let name = warnings.first().and_then(|line| line.split_once(": ")).map_or(String::new(), |(name, _)| name.to_owned());
    warnings.truncate(PROBLEMS_MAX);
    warnings.extend((more > 0).then(|| format!("{name}: and {more} more warnings of this kind")));
    warnings
}

/// Largest difference between the crack lengths on the sides of a specimen that E647 accepts, m: 0.025 W of a central crack or two
/// edge cracks, 0.25 B of one edge crack.
pub fn side_difference_max(kind: SpecimenKind, width: f64, thickness: f64) -> f64 {
    let limit = if kind.sharing().is_some_and(|(cracks, _)| cracks == 2.0) { 0.025 * width } else { 0.25 * thickness };
    // Lengths of 12.8 and 11.2 mm differ by 1.6 mm and a rounding.
    limit * (1.0 + 1e-9)
}

impl Measured {
    /// The same of readings of a precision, mm.
    /// Errors: one that is no length.
    pub fn of_precision(mut self, key: &str, precision: Option<f64>) -> Result<Self> {
        let precision = LENGTH.read_optional(key, precision)?;
        self.curves.iter_mut().for_each(|curve| curve.precision = precision);
        Ok(self)
    }

    /// Puts the curves of another file behind these.
    /// Specimens named by files of one stem have the names of their folders.
    /// Errors: a specimen whose name another one has.
    pub fn add(&mut self, other: Measured) -> Result<()> {
        let mut other = other;
        for curve in &mut other.curves {
            let Some(stem) = curve.file_stem().filter(|stem| *stem == curve.specimen) else { continue };
            if !self.curves.iter().any(|earlier| earlier.specimen == stem || earlier.file_stem() == Some(stem.clone())) {
                continue;
            }
            let alike = |earlier: &&mut MeasuredCurve| earlier.file_stem() == Some(stem.clone());
            for curve in self.curves.iter_mut().filter(alike).chain([curve]) {
                curve.specimen = curve.folder_name().unwrap_or(stem.clone());
            }
        }
        let own: HashMap<&str, &MeasuredCurve> = self.curves.iter().map(|curve| (curve.specimen.as_str(), curve)).collect();
        for curve in &other.curves {
            let Some(earlier) = own.get(curve.specimen.as_str()) else { continue };
            let problem = format!("also occurs in {}", earlier.source.file.display());
            let fault = Fault { key: Some("specimen"), value: Some(&curve.specimen), ..curve.fault(0) };
            return Err(fault.error(problem, "give every specimen its own name"));
        }
        self.curves.extend(other.curves);
        self.warnings.extend(other.warnings);
        Ok(())
    }

    /// Leaves specimens out whose crack does not grow by more than its readings scatter: run-outs, of which no rate follows.
    /// Errors: no other is there.
    pub fn leave_standing_out(&mut self) -> Result<()> {
        let grown = |curve: &MeasuredCurve| curve.crack_length.iter().copied().fold(0.0, f64::max) - curve.crack_length[0];
        let stands = |curve: &MeasuredCurve| grown(curve) <= 3.0 * curve.scatter().max(0.0);
        if let Some(first) = self.curves.first().filter(|_| self.curves.iter().all(stands)) {
            let fault = Fault { key: Some("specimen"), value: Some(&first.specimen), ..first.fault(0) };
            return Err(fault.error("has no growth beyond the scatter of its readings", "give readings of growth"));
        }
        let line = |curve: &MeasuredCurve| {
            let (file, name, life) = (curve.source.file.display(), &curve.specimen, curve.life());
            format!("readings: {file}: specimen {name}: no crack growth in {life:.0} cycles (run-out); excluded from the fit")
        };
        self.warnings.extend(first_of(self.curves.iter().filter(|curve| stands(curve)).map(line).collect()));
        self.curves.retain(|curve| !stands(curve));
        Ok(())
    }

    pub(super) fn exclude_typing_errors(&mut self) {
        let mut left_out = Vec::new();
        for curve in self.curves.iter_mut().filter(|curve| curve.cycles.len() > READINGS_MIN) {
            let errors = curve.typing_errors();
            left_out.extend(errors.iter().map(|&reading| {
                let before = if reading == 0 { 1 } else { reading - 1 };
                let [own, earlier] = [reading, before].map(|reading| round_off(curve.crack_length[reading] / MM));
                let (place, line) = (curve.place(reading), curve.line(before));
                format!(
                    "readings: {place}: {own} mm, after {earlier} mm on line {line}: crack length drops again, likely a typing error; \
                     excluded from the fit. Correct the number"
                )
            }));
            if !errors.is_empty() {
                let kept: Vec<usize> = (0..curve.cycles.len()).filter(|reading| !errors.contains(reading)).collect();
                *curve = curve.of_readings(&kept);
            }
        }
        self.warnings.extend(first_of(left_out));
    }

    /// Refuses readings beyond the specimen: `limit` in m, and its name, for example "half width". Meant for the whole
    /// file before any window is cut, since a reading that cannot be tells that the file or the specimen is the wrong one.
    pub fn check_lengths(&self, limit: f64, limit_name: &str) -> Result<()> {
        for curve in &self.curves {
            let Some(reading) = curve.crack_length.iter().position(|&a| a >= limit) else { continue };
            let problem = format!("is outside the specimen, whose {limit_name} is {} mm", round_off(limit / MM));
            let remedy =
                "check the number, its unit, and whether the file gives the crack length of the specimen's test standard";
            return Err(curve.wrong_length(reading, problem, remedy));
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
                "crack front: {}:{}: specimen {}: front and back crack lengths differ by up to {:.2} mm; {} of {} readings exceed {:.2} mm \
                 (ASTM E647)",
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
