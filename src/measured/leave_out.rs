//! `[measured] leave_out`: growth over some cycles that does not count, or a row of a file by its line, with the reason, which every result has.

use std::collections::HashMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::curve::{Measured, READINGS_MIN};
use perilife_base::error::{Result, input, input_missing};
use perilife_base::table::Table;

/// Cycles of a specimen that do not count, or a row of a file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LeaveOut {
    /// Name of the specimen; may be left out where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub specimen: Option<String>,
    /// First cycles, as the file counts them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_cycles: Option<f64>,
    /// Last cycles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to_cycles: Option<f64>,
    /// File of the row; may be missing where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Line of the row in it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// A cell of the row, which shows that the line is the one that is meant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<String>,
    /// Why.
    pub reason: String,
}

impl LeaveOut {
    /// Whether it covers or cuts the growth between two readings, by their cycles.
    pub fn covers(&self, before: f64, after: f64) -> bool {
        let Some((from, to)) = self.from_cycles.zip(self.to_cycles) else { return false };
        let slack = 1e-9 * to.abs();
        before < to - slack && after > from + slack
    }

    /// Whether it is a row of a file.
    pub(super) fn is_of(&self, file: &Path) -> bool {
        self.line.is_some() && self.file.as_ref().is_none_or(|name| file.ends_with(name))
    }

    /// Line and value, or specimen and cycles.
    pub fn place(&self) -> String {
        let beside =
            |name: &Option<String>, words: &str| name.as_ref().map_or_else(String::new, |name| format!("{words}{name}, "));
        let cycles = [self.from_cycles, self.to_cycles].map(Option::unwrap_or_default);
        match self.line {
            Some(line) => format!("{}line {line}: {}", beside(&self.file, ""), self.value.as_deref().unwrap_or_default()),
            None => format!("{}{} to {} cycles", beside(&self.specimen, "specimen "), cycles[0], cycles[1]),
        }
    }

    /// Refuses what is neither a row of one of the files nor cycles, and what has no reason.
    fn check(&self, key: &str, files: &[String]) -> Result<()> {
        let is_cycles = self.from_cycles.is_some() && self.to_cycles.is_some();
        let has_cycles = self.from_cycles.is_some() || self.to_cycles.is_some();
        let has_row = self.file.is_some() || self.value.is_some();
        if if self.line.is_some() { has_cycles || self.specimen.is_some() } else { !is_cycles || has_row } {
            let remedy = "give line, value and reason (file where there are several), or from_cycles, to_cycles and reason";
            return Err(input_missing(key, "is neither a row by its line nor cycles from and to", remedy));
        }
        if self.reason.trim().is_empty() {
            return Err(input(&format!("{key}.reason"), "\"\"", "says nothing", "say why the readings do not count"));
        }
        let wrong = match &self.file {
            Some(name) => Some((name.as_str(), "is not one of measured.files")).filter(|_| !files.contains(name)),
            None => Some(("\"\"", "is missing, and there are several files")).filter(|_| self.line.is_some() && files.len() > 1),
        };
        let remedy = || format!("use one of {}", files.join(", "));
        wrong.map_or(Ok(()), |(value, problem)| Err(input(&format!("{key}.file"), value, problem, remedy())))
    }
}

/// Refuses entries that name no readings of these files.
pub fn check_left_out(all: &[LeaveOut], files: &[String]) -> Result<()> {
    all.iter().enumerate().try_for_each(|(index, one)| one.check(&format!("measured.leave_out[{index}]"), files))
}

/// A text without quotes, blanks and what separates cells.
fn plain(text: &str) -> String {
    text.chars().filter(|c| !(c.is_whitespace() || "\",;|".contains(*c))).collect()
}

/// Takes rows out of a table by their lines.
/// Errors: a line without a row, or whose row has no such cell.
pub(super) fn take_rows_out(table: &mut Table, all: &[LeaveOut]) -> Result<()> {
    for (index, one) in all.iter().enumerate().filter(|(_, one)| one.is_of(&table.file)) {
        let (key, line) = (format!("measured.leave_out[{index}]"), one.line.unwrap_or_default());
        let Some(place) = table.rows.iter().position(|row| row.line == line) else {
            let problem = format!("is not a row below the header of {}", table.file.display());
            return Err(input(&format!("{key}.line"), line, problem, "count lines from 1, the header included"));
        };
        let row = &table.rows[place];
        let value = one.value.as_deref().unwrap_or_default();
        // Messages cut long rows off.
        let (given, is_cut) = (plain(value.trim_end_matches("...")), value.ends_with("..."));
        let whole = plain(&row.cells.iter().collect::<String>());
        let is_it = |text: String| text == given || is_cut && text.starts_with(&given);
        if one.value.is_none() || !(is_it(whole) || row.cells.iter().any(|cell| is_it(plain(cell)))) {
            let cells: Vec<&str> = row.cells.iter().collect();
            let problem = format!("is not a cell of line {line} of {}, which has {}", table.file.display(), cells.join(" | "));
            return Err(input(&format!("{key}.value"), format!("\"{value}\""), problem, "give the cell that is wrong"));
        }
        table.rows.remove(place);
    }
    Ok(())
}

/// Most names of specimens in a message.
const NAMES_MAX: usize = 20;

impl Measured {
    /// Leaves out the growth between all readings that a window of cycles covers or cuts. At the start and the end of a curve the
    /// readings go with it.
    /// Errors: a window without specimen, reason or readings, or one that leaves fewer than [`READINGS_MIN`] readings.
    pub fn leave_out(&mut self, windows: &[LeaveOut]) -> Result<()> {
        let key = |index: usize| format!("measured.leave_out[{index}]");
        let names: HashMap<String, usize> =
            self.curves.iter().enumerate().rev().map(|(place, curve)| (curve.specimen.clone(), place)).collect();
        let mark = |(index, window)| Ok((index, self.mark(&key(index), window, &names)?));
        let windows = windows.iter().enumerate().filter(|(_, window)| window.line.is_none());
        let places: Vec<(usize, usize)> = windows.map(mark).collect::<Result<_>>()?;
        for (index, place) in places {
            let curve = &mut self.curves[place];
            let counted: Vec<usize> = (1..curve.cycles.len()).filter(|&step| curve.counts(step)).collect();
            if counted.len() + 1 < READINGS_MIN {
                let kept = if counted.is_empty() { 0 } else { counted.len() + 1 };
                let remedy = format!("leave out less: at least {READINGS_MIN} readings are needed");
                return Err(input_missing(&key(index), format!("leaves {kept} readings"), remedy));
            }
            let kept: Vec<usize> = (counted[0] - 1..=counted[counted.len() - 1]).collect();
            if kept.len() < curve.cycles.len() {
                *curve = curve.of_readings(&kept);
                // The first reading of a curve ends no step.
                curve.left_out[0] = false;
            }
        }
        Ok(())
    }

    /// Marks the growth of a window; gives the place of its curve.
    fn mark(&mut self, key: &str, window: &LeaveOut, places: &HashMap<String, usize>) -> Result<usize> {
        let specimen = &window.specimen;
        let [from_cycles, to_cycles] = [window.from_cycles, window.to_cycles].map(|cycles| cycles.unwrap_or(f64::NAN));
        let known = || {
            let names = self.curves.iter().take(NAMES_MAX).map(|curve| format!("\"{}\"", curve.specimen));
            let more = self.curves.len().saturating_sub(NAMES_MAX);
            names.chain((more > 0).then(|| format!("{more} more"))).collect::<Vec<_>>().join(", ")
        };
        let place = match specimen {
            Some(name) => places.get(name).copied().ok_or_else(|| {
                let remedy = format!("use one of {}", known());
                input(&format!("{key}.specimen"), format!("\"{name}\""), "is no specimen of the files", remedy)
            })?,
            None if self.curves.len() == 1 => 0,
            None => {
                let remedy = format!("name one of {}", known());
                return Err(input_missing(&format!("{key}.specimen"), "is missing, and there are several", remedy));
            }
        };
        if !(from_cycles.is_finite() && to_cycles.is_finite() && from_cycles < to_cycles) {
            let problem = format!("is not above from_cycles = {from_cycles}");
            return Err(input(&format!("{key}.to_cycles"), to_cycles, problem, "give the window of cycles that does not count"));
        }
        let curve = &mut self.curves[place];
        let count = curve.cycles.len();
        let covered = |step: usize| window.covers(curve.cycles[step - 1], curve.cycles[step]);
        let steps: Vec<usize> = (1..count).filter(|&step| covered(step)).collect();
        if steps.is_empty() {
            let problem = format!("covers no growth of specimen {}", curve.specimen);
            let remedy = format!("its readings go from {} to {} cycles", curve.cycles[0], curve.cycles[count - 1]);
            return Err(input(&format!("{key}.from_cycles"), from_cycles, problem, remedy));
        }
        curve.left_out.resize(count, false);
        steps.into_iter().for_each(|step| curve.left_out[step] = true);
        Ok(place)
    }
}
