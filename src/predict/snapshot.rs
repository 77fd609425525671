//! Pictures of the damaged plate along a run.

use super::curve::Row;
use super::{CurvePoint, Snapshot};
use crate::body::Body;
use crate::body::lattice::LANES;
use crate::solver::field::Layout;
use crate::state::Bonds;

/// Snapshots between the first and the last.
const BETWEEN: f64 = 20.0;

/// Collects snapshots at even steps of growth.
#[derive(Default)]
pub struct Album {
    /// What was taken so far.
    pub snapshots: Vec<Snapshot>,
    step: f64,
    next: f64,
}

impl Album {
    /// Starts with the plate at N = 0.
    pub fn open(&mut self, body: &Body, bonds: &Bonds, displacement: &[f64], row: &Row) {
        let lattice = &body.lattice;
        self.step = lattice.columns.min(lattice.rows) as f64 * lattice.spacing / BETWEEN;
        self.look(body, bonds, displacement, row);
    }

    /// Whether the cracks have grown enough for the next snapshot.
    pub fn is_due(&self, row: &Row) -> bool {
        row.growth() >= self.next
    }

    /// Takes a snapshot.
    pub fn look(&mut self, body: &Body, bonds: &Bonds, displacement: &[f64], row: &Row) {
        self.next = row.growth() + self.step;
        self.snapshots.push(take(body, bonds, displacement, row));
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
    pub fn finish(&mut self, body: &Body, bonds: &Bonds, displacement: &[f64], row: &Row) {
        if self.snapshots.last().is_none_or(|last| last.crack_length < row.crack_length || last.cycles < row.cycles) {
            self.snapshots.push(take(body, bonds, displacement, row));
        }
    }
}

fn take(body: &Body, bonds: &Bonds, displacement: &[f64], row: &Row) -> Snapshot {
    let layout = Layout::of(&body.lattice, body.stencil.unknowns);
    let places = body.places();
    let damage = |place: usize| {
        let (column, row) = body.lattice.column_row(place);
        if bonds.chunk_is_regular(row, column / LANES) {
            return 0.0;
        }
        let [mut whole, mut intact] = [0_u32; 2];
        for (k, &step) in body.steps.iter().enumerate() {
            for owner in [place, place.wrapping_add_signed(-step)] {
                let bond = k * places + owner;
                whole += u32::from(body.multiplier[bond] > 0.0);
                intact += u32::from(bonds.multiplier[bond] > 0.0);
            }
        }
        if whole == 0 { 1.0 } else { 1.0 - f64::from(intact) / f64::from(whole) }
    };
    let motion = |place: usize| {
        let at = layout.index(place);
        body.lattice.from_axes([displacement[at], displacement[at + layout.stride]])
    };
    Snapshot {
        cycles: row.cycles,
        crack_length: row.crack_length,
        displacement: body.points.iter().map(|&p| motion(p as usize)).collect(),
        damage: body.points.iter().map(|&p| damage(p as usize)).collect(),
    }
}
