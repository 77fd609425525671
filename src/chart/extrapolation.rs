//! What a run would take with a solver too slow to run it whole.
//!
//! A run is made with the default solver, and its breaks are taken down. The slow solver then starts on the same plate, and at
//! some places along the run solves one block after the other's breaks, starting from the equilibrium before: what a run with it
//! would do at every block, without symmetry. All blocks between two measured ones take their mean. Only equilibrium counts, not what a run does
//! beside it, so that the slow solver is rather flattered.

use std::time::Instant;

use crate::body::{Body, Bond};
use crate::case::Case;
use crate::error::Result;
use crate::fatigue::pieces::{Connectivity, remove_fragments};
use crate::growth::bond_strain::BondStrain;
use crate::predict::laws::bond_rates;
use crate::predict::record::Record;
use crate::predict::{Prediction, Silent};
use crate::solver::{Equilibrium, SolverKind, Symmetry};
use crate::state::Bonds;

/// Blocks measured along a run.
pub const BLOCKS: usize = 20;
/// Least number of blocks, however slow they are.
const BLOCKS_LEAST: usize = 5;

/// The breaks of a run, block by block.
#[derive(Debug)]
pub struct History {
    plate: (Body, Bonds),
    /// Blocks in which something broke.
    blocks: Vec<Vec<Bond>>,
}

/// Measured blocks of a slow solver.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampled {
    /// Seconds of set-up and first solve.
    pub start_s: f64,
    /// (block, counted from 0; seconds of its solve), rising.
    pub blocks: Vec<(usize, f64)>,
    /// Work of the load f·u after the last of them, J.
    pub work: f64,
    /// Bonds broken by then.
    pub broken_bonds: usize,
}

impl History {
    /// Runs a case and takes down its breaks.
    pub fn of(case: &Case) -> Result<(Self, Prediction)> {
        let record = Record::new(case, &Silent).unchecked();
        let case = &record.case().clone();
        let mut growth = BondStrain::start(case, |horizon| bond_rates(case, horizon))?;
        let mut history = History { plate: growth.plate_and_bonds(), blocks: Vec::new() };
        let prediction = record.follow(&mut growth, |growth| {
            let reason = growth.next_break();
            history.blocks.extend(Some(growth.last_broken().to_vec()).filter(|broken| !broken.is_empty()));
            reason
        })?;
        Ok((history, prediction))
    }

    /// Blocks in which something broke: so many solves does a run take that solves after each.
    pub fn blocks(&self) -> usize {
        self.blocks.len()
    }

    /// Measures a solver at up to [`BLOCKS`] places, fewer where their solves, taken as long as the first one, would take more than
    /// `seconds`; the solves that lead up to them come on top.
    ///
    /// # Errors
    /// A run that broke nothing; a solver that does not converge.
    pub fn sample(&self, kind: SolverKind, load: f64, seconds: f64) -> Result<Sampled> {
        let (body, start) = &self.plate;
        let mut bonds = start.clone();
        let mut displacement = Vec::new();
        let started = Instant::now();
        let mut equilibrium = Equilibrium::new(kind, Symmetry::Off, body, &bonds, load);
        equilibrium.solve(body, &bonds, &mut displacement)?;
        let start_s = started.elapsed().as_secs_f64();
        let count = places(self.blocks.len(), (seconds / start_s) as usize);
        let mut blocks = Vec::with_capacity(count.len());
        let mut done = 0;
        for block in count {
            // Up to the block at one go, not measured.
            if done < block {
                let Some(broken) = cut(body, &mut bonds, &self.blocks[done..block].concat()) else { break };
                equilibrium.bonds_changed(body, &bonds, &broken);
                equilibrium.solve(body, &bonds, &mut displacement)?;
            }
            let Some(broken) = cut(body, &mut bonds, &self.blocks[block]) else { break };
            let started = Instant::now();
            equilibrium.bonds_changed(body, &bonds, &broken);
            equilibrium.solve(body, &bonds, &mut displacement)?;
            blocks.push((block, started.elapsed().as_secs_f64()));
            done = block + 1;
        }
        let broken_bonds = self.blocks[..done].iter().map(Vec::len).sum();
        Ok(Sampled { start_s, blocks, work: equilibrium.work(), broken_bonds })
    }
}

/// Places of measured blocks among `blocks`: [`BLOCKS`] or as many as `affordable` in the middle of equal parts.
pub fn places(blocks: usize, affordable: usize) -> Vec<usize> {
    let count = affordable.clamp(BLOCKS_LEAST, BLOCKS).min(blocks);
    (0..count).map(|i| (2 * i + 1) * blocks / (2 * count)).collect()
}

/// Breaks bonds and sets free pieces aside; all of them, or `None` where the plate is in two.
fn cut(body: &Body, bonds: &mut Bonds, broken: &[Bond]) -> Option<Vec<Bond>> {
    broken.iter().for_each(|&bond| bonds.cut(body, bond));
    match remove_fragments(body, bonds, broken) {
        Connectivity::Severed => None,
        Connectivity::Connected(aside) => Some(broken.iter().copied().chain(aside).collect()),
    }
}

impl Sampled {
    /// Seconds of a run of so many blocks: set-up, first solve, and the line through the measured blocks (level before the first
    /// and after the last one) summed over all. NaN where none was measured.
    pub fn whole(&self, blocks: usize) -> f64 {
        self.start_s + (0..blocks).map(|block| self.at(block)).sum::<f64>()
    }

    /// Seconds of one block.
    fn at(&self, block: usize) -> f64 {
        let next = self.blocks.partition_point(|(measured, _)| *measured < block);
        match (next.checked_sub(1).and_then(|i| self.blocks.get(i)), self.blocks.get(next)) {
            (None, None) => f64::NAN,
            (Some((_, only)), None) | (None, Some((_, only))) => *only,
            (Some((from, t)), Some((to, s))) => t + (s - t) * (block - from) as f64 / (to - from) as f64,
        }
    }
}
