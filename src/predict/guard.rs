//! What no run may do: count cycles that are no number, or go on for ever without growth.

use crate::error::{Error, Result};
use crate::growth::GrowthStatus;
use crate::growth::record::StopReason;

/// Blocks in a row without growth of any tip at which a run ends. A block breaks at least one bond; a tip grows by a spacing with some
/// ten to a hundred of them.
pub const BLOCKS_WITHOUT_GROWTH: usize = 4096;

/// Watches a run block by block.
#[derive(Debug, Default)]
pub struct Guard {
    /// Growth of all tips together at the last block that had some, m, and blocks since.
    grown: Option<f64>,
    idle: usize,
}

impl Guard {
    /// Takes in the row after a block; the reason to stop where no tip has grown for too long. Runs without tips have none to watch.
    ///
    /// # Errors
    /// [`Error::Mechanics`]: cycles or crack length that are no finite number, or cycles that fall.
    pub fn check(&mut self, before: f64, now: &GrowthStatus<'_>) -> Result<Option<StopReason>> {
        for (what, value) in [("cycles", now.cycles), ("crack length", now.crack_length)] {
            if !value.is_finite() {
                let problem = format!("the {what} after a block came out as {value} (crack length {:.6e} m)", now.crack_length);
                return Err(Error::Mechanics(format!("{problem}; give a smaller model.spacing_mm, and report this case")));
            }
        }
        if now.cycles_of_run < before {
            let problem = format!("cycles fell from {before} to {}", now.cycles_of_run);
            return Err(Error::Mechanics(format!("{problem}; report this case")));
        }
        let grown = now.growth();
        self.idle = if now.tips.is_empty() || self.grown.is_none_or(|before| grown > before) { 0 } else { self.idle + 1 };
        self.grown = Some(self.grown.map_or(grown, |before| before.max(grown)));
        Ok((self.idle >= BLOCKS_WITHOUT_GROWTH).then_some(StopReason::NoGrowth))
    }
}
