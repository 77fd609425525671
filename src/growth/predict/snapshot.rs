//! Pictures of the damaged plate along a run.

use serde::{Deserialize, Serialize};

use super::chain::Chain;
use crate::Fields;
use crate::record::CurvePoint;
use perilife_base::raster::{PointGrid, Snapshot};

/// Snapshots between the first and the last.
const BETWEEN: f64 = 20.0;

/// Collects snapshots at even steps of growth.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Snapshots {
    pub taken: Vec<Snapshot>,
    /// Growth between two, m.
    step: f64,
    /// Growth at which the next is due, m.
    next: f64,
}

impl Snapshots {
    /// Takes the plate at N = 0, and then whenever the cracks have grown enough.
    pub fn follow(&mut self, chain: &mut Chain<'_>) -> Option<(&Snapshot, PointGrid)> {
        let now = chain.now();
        let is_first = self.taken.is_empty();
        if !is_first && now.growth() < self.next {
            return None;
        }
        let grid = chain.stage.grid()?;
        if is_first {
            self.step = grid.columns.min(grid.rows) as f64 * grid.spacing / BETWEEN;
        }
        self.next = now.growth() + self.step;
        self.take(chain).map(|snapshot| (snapshot, grid))
    }

    /// Takes the last snapshot, where something has changed since the one before.
    pub fn finish(&mut self, chain: &mut Chain<'_>) {
        let CurvePoint { cycles, crack_length, .. } = *chain.now();
        if chain.stage.grid().is_some()
            && self.taken.last().is_none_or(|last| last.crack_length < crack_length || last.cycles < cycles)
        {
            self.take(chain);
        }
    }

    /// Takes the plate as it stands. A picture that takes an equilibrium which is not found is left out: the curve counts more.
    fn take(&mut self, chain: &mut Chain<'_>) -> Option<&Snapshot> {
        let fields = chain.stage.fields().unwrap_or_else(|error| {
            tracing::warn!("a snapshot is omitted: {error}");
            None
        });
        let Fields { displacement, damage, remaining_life, stress } = fields?;
        let CurvePoint { cycles, crack_length, .. } = *chain.now();
        self.taken.push(Snapshot { cycles, crack_length, displacement, damage, remaining_life, stress });
        self.taken.last()
    }

    /// Takes the cycles of another count of the same rows, and leaves out what lies beyond its end.
    pub fn recount(&mut self, before: &[CurvePoint], now: &[CurvePoint]) {
        let (Some(end), Some(cycles)) = (now.last().map(|row| row.crack_length), now.last().map(|row| row.cycles)) else {
            return;
        };
        let first = self.taken.iter().position(|snapshot| snapshot.crack_length >= end);
        self.taken.truncate(first.map_or(self.taken.len(), |first| first + 1));
        for snapshot in &mut self.taken {
            let row = before.partition_point(|row| row.cycles < snapshot.cycles);
            let share = match row.checked_sub(1).zip(before.get(row)) {
                Some((place, after)) if after.cycles > before[place].cycles => {
                    (snapshot.cycles - before[place].cycles) / (after.cycles - before[place].cycles)
                }
                _ => 1.0,
            };
            let at = |row: usize| now.get(row).map_or(cycles, |row| row.cycles);
            let from = at(row.saturating_sub(1));
            snapshot.cycles = from + share * (at(row) - from);
        }
    }

    pub fn keep_within(&mut self, curve: &[CurvePoint]) {
        let (Some(first), Some(last)) = (curve.first(), curve.last()) else { return };
        for snapshot in &mut self.taken {
            snapshot.cycles = snapshot.cycles.clamp(first.cycles, last.cycles);
            snapshot.crack_length = snapshot.crack_length.clamp(first.crack_length, last.crack_length);
        }
    }
}
