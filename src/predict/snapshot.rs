//! Pictures of the damaged plate along a run.

use super::{CurvePoint, Observer, Snapshot};
use crate::growth::plate::Plate;
use crate::state::Bonds;

/// Snapshots between the first and the last.
const BETWEEN: f64 = 20.0;

/// What a picture is taken of.
pub trait Moment {
    /// Cycles.
    fn cycles(&self) -> f64;
    /// Crack length, m.
    fn crack_length(&self) -> f64;
    /// Growth of all tips together, m.
    fn growth(&self) -> f64;
}

impl Moment for CurvePoint {
    fn cycles(&self) -> f64 {
        self.cycles
    }

    fn crack_length(&self) -> f64 {
        self.crack_length
    }

    fn growth(&self) -> f64 {
        self.tips.iter().map(|tip| tip.growth).sum()
    }
}

/// Collects snapshots at even steps of growth.
#[derive(Default)]
pub struct Album {
    /// What was taken so far.
    pub snapshots: Vec<Snapshot>,
    /// Growth between two, m.
    pub(super) step: f64,
    /// Growth at which the next is due, m.
    pub(super) next: f64,
}

impl Album {
    /// Starts with the plate at N = 0.
    pub fn open(&mut self, plate: &Plate, bonds: &Bonds, displacement: &[f64], row: &impl Moment) {
        let lattice = &plate.body.lattice;
        self.step = lattice.columns.min(lattice.rows) as f64 * lattice.spacing / BETWEEN;
        self.look(plate, bonds, displacement, row);
    }

    /// Whether the cracks have grown enough for the next snapshot.
    pub fn is_due(&self, row: &impl Moment) -> bool {
        row.growth() >= self.next
    }

    /// Takes a snapshot.
    pub fn look(&mut self, plate: &Plate, bonds: &Bonds, displacement: &[f64], row: &impl Moment) {
        self.next = row.growth() + self.step;
        self.snapshots.push(snapshot(plate, bonds, displacement, row));
    }

    /// Shows the latest snapshot to who watches the run.
    pub fn show(&self, plate: &Plate, observer: &dyn Observer) {
        if let Some(snapshot) = self.snapshots.last() {
            observer.looked(snapshot, &plate.grid());
        }
    }

    /// Counts cycles from N = 0, `zero` cycles after the start of the run, and keeps to the ends of the curve.
    pub fn count_from(&mut self, zero: f64, curve: &[CurvePoint]) {
        let (Some(first), Some(last)) = (curve.first(), curve.last()) else { return };
        for snapshot in &mut self.snapshots {
            snapshot.cycles = (snapshot.cycles - zero).clamp(first.cycles, last.cycles);
            snapshot.crack_length = snapshot.crack_length.clamp(first.crack_length, last.crack_length);
        }
    }

    /// Takes the last snapshot.
    pub fn finish(&mut self, plate: &Plate, bonds: &Bonds, displacement: &[f64], row: &impl Moment) {
        if self.snapshots.last().is_none_or(|last| last.crack_length < row.crack_length() || last.cycles < row.cycles()) {
            self.snapshots.push(snapshot(plate, bonds, displacement, row));
        }
    }
}

fn snapshot(plate: &Plate, bonds: &Bonds, displacement: &[f64], row: &impl Moment) -> Snapshot {
    let (displacement, damage) = plate.fields(bonds, displacement);
    Snapshot { cycles: row.cycles(), crack_length: row.crack_length(), displacement, damage }
}
