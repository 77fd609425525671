//! `[measured] leave_out`: growth over some cycles that does not count, with the reason, which stands in every result.

use std::collections::HashMap;

use super::curve::{Measured, READINGS_MIN};
use super::import::LeaveOut;
use perilife_base::error::{Result, fail_if, input, input_missing};

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

    /// Marks the growth of a window; gives the place of its curve.
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
