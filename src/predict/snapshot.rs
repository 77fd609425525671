//! Pictures of the damaged plate along a run.

use super::{CurvePoint, Observer, Snapshot};
use crate::error::Result;
use crate::growth::{CrackGrowth, Now};

/// Snapshots between the first and the last.
const BETWEEN: f64 = 20.0;

/// Collects snapshots at even steps of growth.
#[derive(Debug, Default)]
pub struct Album {
    /// What was taken so far.
    pub snapshots: Vec<Snapshot>,
    /// Growth between two, m.
    pub(super) step: f64,
    /// Growth at which the next is due, m.
    pub(super) next: f64,
}

impl Album {
    /// Takes the plate at N = 0, and then whenever the cracks have grown enough; shows it to who watches the run.
    ///
    /// # Errors
    /// As [`CrackGrowth::fields`].
    pub fn follow(&mut self, growth: &mut dyn CrackGrowth, observer: &dyn Observer) -> Result<()> {
        let Some(plate) = growth.plate() else { return Ok(()) };
        let now = growth.now();
        let is_first = self.snapshots.is_empty();
        if !now.is_counting || !is_first && (now.growth() < self.next || !now.is_settled) {
            return Ok(());
        }
        if is_first {
            let lattice = &plate.body.lattice;
            self.step = lattice.columns.min(lattice.rows) as f64 * lattice.spacing / BETWEEN;
        }
        self.next = now.growth() + self.step;
        self.take(growth)?;
        if let Some(snapshot) = self.snapshots.last() {
            observer.looked(snapshot, &plate.grid());
        }
        Ok(())
    }

    /// Takes the last snapshot, where something has changed since the one before.
    ///
    /// # Errors
    /// As [`CrackGrowth::fields`].
    pub fn finish(&mut self, growth: &mut dyn CrackGrowth) -> Result<()> {
        let Now { cycles_of_run, crack_length, .. } = growth.now();
        if self.snapshots.last().is_none_or(|last| last.crack_length < crack_length || last.cycles < cycles_of_run) {
            self.take(growth)?;
        }
        Ok(())
    }

    fn take(&mut self, growth: &mut dyn CrackGrowth) -> Result<()> {
        if let Some(fields) = growth.fields()? {
            let Now { cycles_of_run: cycles, crack_length, .. } = growth.now();
            self.snapshots.push(Snapshot { cycles, crack_length, displacement: fields.displacement, damage: fields.damage });
        }
        Ok(())
    }

    /// Counts cycles from N = 0, `zero` cycles after the start of the run, and keeps to the ends of the curve.
    pub fn count_from(&mut self, zero: f64, curve: &[CurvePoint]) {
        let (Some(first), Some(last)) = (curve.first(), curve.last()) else { return };
        for snapshot in &mut self.snapshots {
            snapshot.cycles = (snapshot.cycles - zero).clamp(first.cycles, last.cycles);
            snapshot.crack_length = snapshot.crack_length.clamp(first.crack_length, last.crack_length);
        }
    }
}
