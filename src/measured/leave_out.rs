//! `[measured] leave_out`: rows of a file that are not read, and growth over some cycles that does not count, with the reason, which stands
//! in every result.

use std::collections::HashMap;
use std::path::Path;

use super::curve::{Measured, READINGS_MIN};
use super::exclusion_flags::exclude_flagged;
use super::import::{Import, LeaveOut};
use perilife_base::error::{Result, fail_if, input, input_missing};
use perilife_base::table::{self, Table};

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
                let remedy = format!("exclude fewer: at least {READINGS_MIN} readings are needed");
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

    fn mark(&mut self, key: &str, window: &LeaveOut, places: &HashMap<String, usize>) -> Result<usize> {
        let [from_cycles, to_cycles] = [window.from_cycles, window.to_cycles].map(|cycles| cycles.unwrap_or(f64::NAN));
        let unknown = || {
            let names = self.curves.iter().take(NAMES_MAX).map(|curve| format!("\"{}\"", curve.specimen));
            let more = self.curves.len().saturating_sub(NAMES_MAX);
            let names = names.chain((more > 0).then(|| format!("{more} more"))).collect::<Vec<_>>().join(", ");
            let (key, remedy) = (format!("{key}.specimen"), format!("use one of {names}"));
            match &window.specimen {
                Some(name) => input(&key, format!("\"{name}\""), "is not a specimen of the files", remedy),
                None => input_missing(&key, "is missing, and there are several", remedy),
            }
        };
        let alone = (self.curves.len() == 1).then_some(0);
        let place = window.specimen.as_ref().map_or(alone, |name| places.get(name).copied()).ok_or_else(unknown)?;
        if !(from_cycles.is_finite() && to_cycles.is_finite() && from_cycles < to_cycles) {
            let problem = format!("is not above from_cycles = {from_cycles}");
            return Err(input(&format!("{key}.to_cycles"), to_cycles, problem, "give the range of cycles to exclude"));
        }
        let curve = &mut self.curves[place];
        let count = curve.cycles.len();
        let covered = |step: usize| window.covers(curve.cycles[step - 1], curve.cycles[step]);
        let steps: Vec<usize> = (1..count).filter(|&step| covered(step)).collect();
        let problem = || format!("contains no reading of specimen {}", curve.specimen);
        let remedy = || format!("its readings go from {} to {} cycles", curve.cycles[0], curve.cycles[count - 1]);
        fail_if!(steps.is_empty(), input(&format!("{key}.from_cycles"), from_cycles, problem(), remedy()));
        curve.left_out.resize(count, false);
        steps.into_iter().for_each(|step| curve.left_out[step] = true);
        Ok(place)
    }
}

/// Cuts the bytes of a file into cells. Rows that are left out by their lines go, and those that the table itself marks as not counting.
/// Errors: as [`table::read`] and [`take_rows_out`]; a Parquet file.
pub(super) fn table_of(bytes: &[u8], file: &Path, import: &Import) -> Result<Table> {
    let remedy = "save the table as CSV or .xlsx";
    fail_if!(bytes.starts_with(b"PAR1"), table::whole_file(file).error("is a Parquet file, which is not supported", remedy));
    let mut table = table::read(bytes, file, import)?;
    take_rows_out(&mut table, &import.left_out)?;
    exclude_flagged(&mut table, import)?;
    Ok(table)
}

/// Takes rows out of a table by their lines.
/// Errors: a line without a row, or whose row has no such cell.
fn take_rows_out(table: &mut Table, all: &[LeaveOut]) -> Result<()> {
    let plain = |text: &str| text.replace(|c: char| c.is_whitespace() || "\",;|".contains(c), "");
    for (index, one) in all.iter().enumerate().filter(|(_, one)| one.line.is_some()) {
        let place = table.rows.iter().position(|row| Some(row.line) == one.line);
        let cells: Vec<&str> = place.iter().flat_map(|&place| &table.rows[place].cells).collect();
        let value = one.value.as_deref().unwrap_or_default();
        // Messages cut long rows off.
        let (given, is_cut) = (plain(value.trim_end_matches("...")), value.ends_with("..."));
        let is_it = |text: &str| if is_cut { plain(text).starts_with(&given) } else { plain(text) == given };
        let is_there = one.value.is_some() && cells.iter().copied().chain([&*cells.concat()]).any(is_it);
        let Some(place) = place.filter(|_| is_there) else {
            let (line, cells) = (one.line.unwrap_or_default(), place.map_or("no row".to_owned(), |_| cells.join(" | ")));
            let problem = format!("is not a cell of line {line} of {}, which has {cells}", table.file.display());
            let remedy = "count lines from 1, the header included, and give the wrong cell";
            return Err(input(&format!("measured.leave_out[{index}].value"), format!("\"{value}\""), problem, remedy));
        };
        table.rows.remove(place);
    }
    Ok(())
}
