//! The peridynamic engine as forward model of a calibration, with replays of what it did.

use super::model::{ForwardModel, RecordedRun, UnitCurve};
use crate::body::Bond;
use crate::case::Case;
use crate::error::{Error, Result};
use crate::fatigue::FatigueLaw;
use crate::fatigue::ageing::AgeingBond;
use crate::fatigue::length_average::LengthAverage;
use crate::predict::{CurvePoint, Observer, Recorder, StopReason, run};

/// Runs a case with A = 1 and any p.
pub struct PdModel<'a> {
    case: Case,
    observer: &'a dyn Observer,
}

impl<'a> PdModel<'a> {
    /// Forward model of a calibration case, reporting to an observer.
    ///
    /// # Errors
    /// None yet: the body is built anew by every run.
    pub fn new(case: &Case, observer: &'a dyn Observer) -> Result<Self> {
        let mut case = case.clone();
        // With A = 1 cycles are counted in units of 1/A: a limit on cycles would mean nothing.
        case.stop.cycles_max = f64::INFINITY;
        Ok(PdModel { case, observer })
    }
}

impl ForwardModel for PdModel<'_> {
    fn run(&self, p: f64) -> Result<RecordedRun> {
        let mut recording = Recording::default();
        let done = run(&self.case, |horizon| Ok(FatigueLaw { a: 1.0, p, horizon }), &mut recording, self.observer)?;
        if done.stop == StopReason::NoConvergence {
            return Err(Error::Mechanics(format!(
                "{}: the equilibrium solver did not converge at a crack length of {:.3} mm",
                self.case.name,
                done.crack_length_final() / crate::units::MM
            )));
        }
        if done.stop == StopReason::LeftRefinement {
            return Err(Error::Mechanics(format!(
                "{}: the crack left the finest level of points at a length of {:.3} mm; give refinement.regions that hold its way up \
                 to the last reading and four horizons on",
                self.case.name,
                done.crack_length_final() / crate::units::MM
            )));
        }
        let curve: UnitCurve =
            done.curve.iter().map(|CurvePoint { cycles, crack_length, .. }| (*cycles, *crack_length)).collect();
        let end = done.crack_length_final();
        let figures = done.figures;
        let replay = move |p: f64| recording.replay(p, end, figures.spacing);
        let mut recorded = RecordedRun::new(curve, figures.horizon, figures.spacing, replay);
        recorded.warnings = done.warnings;
        Ok(recorded)
    }
}

/// What a run did, block by block.
#[derive(Debug, Default)]
struct Recording {
    blocks: Vec<RecordedBlock>,
}

#[derive(Debug)]
struct RecordedBlock {
    ageing: Vec<AgeingBond>,
    spent: Vec<Bond>,
    crack_length: f64,
}

impl Recorder for Recording {
    fn block(&mut self, ageing: &[AgeingBond], spent: &[Bond], crack_length: f64) {
        self.blocks.push(RecordedBlock { ageing: ageing.to_vec(), spent: spent.to_vec(), crack_length });
    }
}

impl Recording {
    /// The same sequence of breaks at another exponent, with the strains as recorded: each block lasts until its bonds are
    /// spent. Good to about 1 % of life for a change of p by 0.3, since the order of breaks hardly depends on p.
    fn replay(&self, p: f64, end: f64, spacing: f64) -> UnitCurve {
        let mut life: std::collections::HashMap<Bond, f64> = std::collections::HashMap::new();
        let mut cycles = 0.0;
        let (mut all_cycles, mut lengths) = (Vec::new(), Vec::new());
        for block in &self.blocks {
            let spending: Vec<(Bond, f64)> = block.ageing.iter().map(|b| (b.bond, b.strain.powf(p))).collect();
            let to_spend = |(bond, rate): &(Bond, f64)| life.get(bond).copied().unwrap_or(1.0).max(0.0) / rate;
            let lasts =
                spending.iter().filter(|(bond, _)| block.spent.contains(bond)).map(to_spend).fold(f64::INFINITY, f64::min);
            // A block that spent no bond (fixed cycles) has no length of its own at another p.
            let lasts = if lasts.is_finite() { lasts } else { 0.0 };
            for (bond, rate) in spending {
                *life.entry(bond).or_insert(1.0) -= lasts * rate;
            }
            cycles += lasts;
            all_cycles.push(cycles);
            lengths.push(block.crack_length.min(end));
        }
        let averaged = LengthAverage::new(&all_cycles, &lengths, spacing).of_rising(&lengths);
        all_cycles.into_iter().zip(averaged).collect()
    }
}
