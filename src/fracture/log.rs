//! What is taken down while a scene runs: history, crack fronts, onset, separation, states for pictures.

use super::bonds::BondState;
use super::boundary::Boundary;
use super::fronts::{CRACKED, Fronts, LOGGED};
use super::outcome::{Fracture, HistoryRow, SceneEnd, SceneFigures};
use super::pieces::is_separated;
use super::scene::Scene;
use crate::levels::Net;
use crate::predict::Snapshot;

/// Snapshots of a run beside the first.
const SNAPSHOTS: usize = 20;
/// Looks at crack fronts and at separation in a run at the most: each costs as much as an evaluation of the forces.
const LOOKS: usize = 400;

/// Collects the outcome of a run.
pub struct Log<'a> {
    net: &'a Net,
    boundary: &'a Boundary,
    steps: usize,
    history: Vec<HistoryRow>,
    fronts: Fronts<'a>,
    cracking: Fronts<'a>,
    snapshots: Vec<Snapshot>,
    onset: Option<usize>,
    separated: Option<usize>,
    broken: usize,
    /// Broken bonds when separation was last asked for.
    asked: usize,
    next_picture: usize,
    next_look: usize,
}

impl<'a> Log<'a> {
    /// A log of a run of so many steps.
    #[must_use]
    pub fn new(scene: &'a Scene, net: &'a Net, boundary: &'a Boundary, steps: usize) -> Self {
        Log {
            net,
            boundary,
            steps,
            history: Vec::new(),
            fronts: Fronts::new(&scene.specimen, net, CRACKED),
            cracking: Fronts::new(&scene.specimen, net, LOGGED),
            snapshots: Vec::new(),
            onset: None,
            separated: None,
            broken: 0,
            asked: 0,
            next_picture: 0,
            next_look: 0,
        }
    }

    /// Told of broken bonds in a step.
    pub fn broke(&mut self, step: usize, broken: usize) {
        self.broken += broken;
        if broken > 0 && self.onset.is_none() {
            self.onset = Some(step);
        }
    }

    /// Bonds broken so far.
    #[must_use]
    pub fn broken(&self) -> usize {
        self.broken
    }

    /// Whether loads and supports are no longer joined by bonds.
    #[must_use]
    pub fn is_separated(&self) -> bool {
        self.separated.is_some()
    }

    /// Takes down a row, the crack fronts where bonds broke, and a picture when one is due.
    pub fn row(&mut self, mut row: HistoryRow, u: &[f64], bonds: &BondState) {
        row.broken_bonds = self.broken;
        let picture = row.step >= self.next_picture;
        let last = row.step == self.steps;
        if picture || (self.broken > self.asked && (last || row.step >= self.next_look)) {
            self.next_look = row.step + self.steps / LOOKS;
            let damage = bonds.damage(self.net);
            self.fronts.advance(row.step, row.time, &damage);
            self.cracking.advance(row.step, row.time, &damage);
            if self.broken > self.asked && self.separated.is_none() && is_separated(self.net, self.boundary, bonds) {
                self.separated = Some(row.step);
            }
            self.asked = self.broken;
            if picture {
                self.next_picture = row.step + (self.steps / SNAPSHOTS).max(1);
                self.look(&row, u, damage);
            }
        }
        self.history.push(row);
    }

    fn look(&mut self, row: &HistoryRow, u: &[f64], damage: Vec<f64>) {
        let unknowns = self.net.unknowns;
        self.snapshots.push(Snapshot {
            cycles: if row.time > 0.0 { row.time } else { row.step as f64 },
            crack_length: 0.0,
            displacement: u.chunks_exact(unknowns).map(|u| [u[0], u[1]]).collect(),
            damage,
            remaining_life: Vec::new(),
        });
    }

    /// The outcome; takes a last picture.
    #[must_use]
    pub fn close(mut self, end: SceneEnd, u: &[f64], bonds: &BondState, figures: SceneFigures) -> Fracture {
        if let Some(row) = self.history.last().copied() {
            let damage = bonds.damage(self.net);
            // Between two looks the procedure may know first.
            if end == SceneEnd::Separated {
                self.separated.get_or_insert(row.step);
            }
            self.look(&row, u, damage);
        }
        Fracture {
            history: self.history,
            path: self.fronts.path,
            cracking: self.cracking.path,
            snapshots: self.snapshots,
            grid: self.net.grid.clone(),
            end,
            onset_step: self.onset,
            separated_step: self.separated,
            figures: SceneFigures { points: self.net.len(), bonds: self.net.bonds.len(), ..figures },
            warnings: Vec::new(),
        }
    }
}
