//! Pictures of the damaged plate along a run.

use super::outcome::Snapshot;
use crate::growth::record::CurvePoint;
use crate::growth::{CrackGrowth, Fields, GrowthStatus};
use crate::levels::PointGrid;

/// Snapshots between the first and the last.
const BETWEEN: f64 = 20.0;

/// Collects snapshots at even steps of growth.
#[derive(Debug, Default)]
pub struct Snapshots {
    /// What was taken so far.
    pub taken: Vec<Snapshot>,
    /// Growth between two, m.
    pub(super) step: f64,
    /// Growth at which the next is due, m.
    pub(super) next: f64,
}

impl Snapshots {
    /// Takes the plate at N = 0, and then whenever the cracks have grown enough.
    pub fn follow(&mut self, growth: &mut dyn CrackGrowth) -> Option<(&Snapshot, PointGrid)> {
        let now = growth.now();
        let is_first = self.taken.is_empty();
        if !is_first && now.growth() < self.next {
            return None;
        }
        let grid = growth.grid()?;
        if is_first {
            self.step = grid.columns.min(grid.rows) as f64 * grid.spacing / BETWEEN;
        }
        self.next = now.growth() + self.step;
        self.take(growth).map(|snapshot| (snapshot, grid))
    }

    /// Takes the last snapshot, where something has changed since the one before.
    pub fn finish(&mut self, growth: &mut dyn CrackGrowth) {
        let GrowthStatus { cycles, crack_length, .. } = growth.now();
        if self.taken.last().is_none_or(|last| last.crack_length < crack_length || last.cycles < cycles) {
            self.take(growth);
        }
    }

    /// Takes the plate as it stands. A picture that takes an equilibrium which is not found is left out: the curve counts more.
    fn take(&mut self, growth: &mut dyn CrackGrowth) -> Option<&Snapshot> {
        let fields = growth.fields().unwrap_or_else(|error| {
            tracing::warn!("a snapshot is left out: {error}");
            None
        });
        let Fields { displacement, damage, remaining_life, stress } = fields?;
        let GrowthStatus { cycles, crack_length, .. } = growth.now();
        self.taken.push(Snapshot { cycles, crack_length, displacement, damage, remaining_life, stress });
        self.taken.last()
    }

    /// Keeps to the ends of the curve.
    pub fn keep_within(&mut self, curve: &[CurvePoint]) {
        let (Some(first), Some(last)) = (curve.first(), curve.last()) else { return };
        for snapshot in &mut self.taken {
            snapshot.cycles = snapshot.cycles.clamp(first.cycles, last.cycles);
            snapshot.crack_length = snapshot.crack_length.clamp(first.crack_length, last.crack_length);
        }
    }
}
