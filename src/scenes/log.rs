//! What is taken down while a scene runs: history, crack fronts, onset, separation, states for pictures.

use serde::{Deserialize, Serialize};

use super::bonds::BondState;
use super::boundary::Boundary;
use super::fronts::{self, CRACKED, Fronts, LOGGED};
use super::outcome::{Fracture, HistoryRow, SceneEnd, SceneFigures};
use super::scene::Scene;
use perilife_base::raster::Snapshot;
use perilife_points::net::Net;

/// Snapshots of a run beside the first.
const SNAPSHOTS: usize = 20;
/// Looks at crack fronts and at separation in a run at the most: each costs as much as an evaluation of the forces.
const LOOKS: usize = 400;

/// Collects the outcome of a run.
pub struct Log<'a> {
    pub(super) net: &'a Net,
    pub(super) boundary: &'a Boundary,
    steps: usize,
    fronts: Fronts<'a>,
    cracking: Fronts<'a>,
    taken: Taken,
}

/// What was taken down so far, beside the fronts.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
struct Taken {
    history: Vec<HistoryRow>,
    snapshots: Vec<Snapshot>,
    onset: Option<usize>,
    separated: Option<usize>,
    broken: usize,
    /// Broken bonds when separation was last asked for.
    asked: usize,
    next_picture: usize,
    next_look: usize,
}

/// What a log holds, for a run that goes on later.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Records {
    fronts: fronts::Standing,
    cracking: fronts::Standing,
    taken: Taken,
}

impl Records {
    /// Step of the last row; 0 without any.
    pub fn last_step(&self) -> usize {
        self.taken.history.last().map_or(0, |row| row.step)
    }
}

impl<'a> Log<'a> {
    /// A log of a run of so many steps.
    pub fn new(scene: &'a Scene, net: &'a Net, boundary: &'a Boundary, steps: usize) -> Self {
        Log {
            net,
            boundary,
            steps,
            fronts: Fronts::new(&scene.specimen, net, CRACKED),
            cracking: Fronts::new(&scene.specimen, net, LOGGED),
            taken: Taken::default(),
        }
    }

    pub fn records(&self) -> Records {
        Records { fronts: self.fronts.standing().clone(), cracking: self.cracking.standing().clone(), taken: self.taken.clone() }
    }

    /// Puts back what a log of an earlier run held; whether that was a run on this net.
    pub fn restore(&mut self, records: Records) -> bool {
        let Records { fronts, cracking, taken } = records;
        let points = self.net.len();
        let is_of_net = |picture: &Snapshot| picture.displacement.len() == points && picture.damage.len() == points;
        let fits = taken.snapshots.iter().all(is_of_net);
        self.taken = taken;
        self.fronts.restore(fronts) && self.cracking.restore(cracking) && fits
    }

    /// Told of broken bonds in a step.
    pub fn broke(&mut self, step: usize, broken: usize) {
        self.taken.broken += broken;
        if broken > 0 && self.taken.onset.is_none() {
            self.taken.onset = Some(step);
        }
    }

    pub fn last(&self) -> Option<&HistoryRow> {
        self.taken.history.last()
    }

    /// Bonds broken so far.
    pub fn broken(&self) -> usize {
        self.taken.broken
    }

    /// Whether loads and supports are no longer joined by bonds.
    pub fn is_separated(&self) -> bool {
        self.taken.separated.is_some()
    }

    /// Takes down a row, the crack fronts where bonds broke, and a picture when one is due.
    pub fn row(&mut self, mut row: HistoryRow, u: &[f64], bonds: &BondState) {
        row.broken_bonds = self.taken.broken;
        let picture = row.step >= self.taken.next_picture;
        let last = row.step == self.steps;
        if picture || (self.taken.broken > self.taken.asked && (last || row.step >= self.taken.next_look)) {
            self.taken.next_look = row.step + self.steps / LOOKS;
            let damage = bonds.damage(self.net);
            self.fronts.advance(row.step, row.time, &damage);
            self.cracking.advance(row.step, row.time, &damage);
            if self.taken.broken > self.taken.asked
                && self.taken.separated.is_none()
                && self.boundary.is_separated(self.net, bonds)
            {
                self.taken.separated = Some(row.step);
            }
            self.taken.asked = self.taken.broken;
            if picture {
                self.taken.next_picture = row.step + (self.steps / SNAPSHOTS).max(1);
                self.look(&row, u, damage);
            }
        }
        self.taken.history.push(row);
    }

    fn look(&mut self, row: &HistoryRow, u: &[f64], damage: Vec<f64>) {
        let unknowns = self.net.unknowns;
        self.taken.snapshots.push(Snapshot {
            cycles: if row.time > 0.0 { row.time } else { row.step as f64 },
            crack_length: 0.0,
            displacement: u.chunks_exact(unknowns).map(|u| [u[0], u[1]]).collect(),
            damage,
            remaining_life: Vec::new(),
            stress: Vec::new(),
        });
    }

    /// The outcome; takes a last picture.
    pub fn close(mut self, end: SceneEnd, u: &[f64], bonds: &BondState, figures: SceneFigures) -> Fracture {
        if let Some(row) = self.taken.history.last().copied() {
            let damage = bonds.damage(self.net);
            // Between two looks the procedure may know first.
            if end == SceneEnd::Separated {
                self.taken.separated.get_or_insert(row.step);
            }
            self.look(&row, u, damage);
        }
        Fracture {
            history: self.taken.history,
            path: self.fronts.into_path(),
            cracking: self.cracking.into_path(),
            snapshots: self.taken.snapshots,
            grid: self.net.grid.clone(),
            end,
            onset_step: self.taken.onset,
            separated_step: self.taken.separated,
            figures: SceneFigures { points: self.net.len(), bonds: self.net.bonds.len(), ..figures },
            warnings: Vec::new(),
        }
    }
}
