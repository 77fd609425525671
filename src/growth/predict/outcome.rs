//! What a run gives and how it reports while it goes on.

use serde::{Deserialize, Serialize};

use super::chain::Chain;
use super::initiation::PhaseOne;
use crate::cracks::steering::equivalent_factor;
pub use crate::cross_check::CrossCheck;
pub use crate::record::{CurvePoint, StopReason, TipRecord};
use perilife_base::machine;
use perilife_base::raster::{PointGrid, Snapshot};
use perilife_base::units::MM;
use perilife_plate::specimen::{LengthConvention, Specimen};
use perilife_points::body::Body;
use perilife_points::solver::SolverUsed;

/// Relative difference between growths of tips that grew alike.
const ALIKE: f64 = 1e-3;

/// Figures of a run that users ask for.
#[derive(Debug, Clone, PartialEq)]
pub struct RunFigures {
    pub points: usize,
    pub points_solved: usize,
    pub bonds: usize,
    pub blocks: usize,
    pub solves: usize,
    /// Solver iterations in all (0 for a direct solver).
    pub iterations: usize,
    /// Times that nodes were made finer than usual, near tips and rims and far from them.
    pub refined: [u32; 2],
    /// Cycles that its steps may be off by.
    pub step_error: f64,
    /// What solved; `None` of a hand calculation.
    pub solver: Option<SolverUsed>,
    /// Actual lattice spacing, m.
    pub spacing: f64,
    pub horizon: f64,
    pub wall_s: f64,
    /// Peak memory of the process, MB.
    pub memory_mb: f64,
}

impl RunFigures {
    /// Of a run that is over, after so many blocks and seconds.
    pub(super) fn of(chain: &Chain<'_>, blocks: usize, wall_s: f64) -> Self {
        let (body, statistics) = (chain.stage.body(), chain.statistics());
        let body = body.as_deref();
        RunFigures {
            points: body.map_or(statistics.points_solved, |body| body.points.len()),
            points_solved: statistics.points_solved,
            bonds: body.map_or(0, |body| body.bond_count),
            blocks,
            solves: statistics.solves,
            iterations: statistics.iterations,
            refined: statistics.refined,
            step_error: statistics.step_error,
            solver: statistics.solver,
            spacing: body.map_or(f64::NAN, |body| body.lattice.spacing),
            horizon: body.map_or(f64::NAN, Body::horizon),
            wall_s,
            memory_mb: machine::peak_mb(),
        }
    }
}

/// What a run gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// The a-N curve: first row N = 0, or the end of phase I, at the initial crack length; cycles and length never fall.
    pub curve: Vec<CurvePoint>,
    /// Why it ended.
    pub stop: StopReason,
    /// Snapshots: first, some between, last.
    pub snapshots: Vec<Snapshot>,
    pub grid: PointGrid,
    pub figures: RunFigures,
    /// Phase I, before the cracks of the case had formed: the rows of the curve begin after it.
    pub phase_one: Option<PhaseOne>,
    /// K against an independent one, where there is one.
    pub cross_check: Option<CrossCheck>,
    /// Cycles of the same curve by the mean rate of a pass, where retardation has counted them anew.
    pub unretarded_cycles: Option<f64>,
    /// What the user should know: warnings in plain words.
    pub warnings: Vec<String>,
}

impl Prediction {
    /// The life, cycles; `None` where the cracks stand still under these loads, so that it has no end.
    pub fn life(&self) -> Option<f64> {
        (self.stop != StopReason::NothingAges).then(|| self.life_cycles())
    }

    /// Cycles from N = 0 to the end of the run.
    pub fn life_cycles(&self) -> f64 {
        self.curve.last().map_or(0.0, |point| point.cycles)
    }

    /// The tip that ends the life of a plate, which grew fastest at the end, and the length of its crack at the start and there, m; `None` of
    /// standard specimens, whose crack length is that of their standard, and of ends of slots.
    pub fn leading_tip(&self, specimen: &Specimen) -> Option<(usize, [f64; 2])> {
        let (first, [.., last]) = (self.curve.first()?, &self.curve[1..]) else { return None };
        let tip = governing_tip(specimen, &self.curve)?;
        let lengths = [first, last].map(|row| row.crack_length_of(specimen, tip));
        Some((tip, [lengths[0]?, lengths[1]?]))
    }

    /// Cycles at which the crack has a length, m, linear between rows; `None` where it never has.
    pub fn cycles_at(&self, crack_length: f64) -> Option<f64> {
        let rows = self.curve.windows(2).find(|rows| (rows[0].crack_length..=rows[1].crack_length).contains(&crack_length))?;
        let [from, to] = [rows[0].crack_length, rows[1].crack_length];
        let share = if to > from { (crack_length - from) / (to - from) } else { 0.0 };
        Some(rows[0].cycles + share * (rows[1].cycles - rows[0].cycles))
    }

    pub fn crack_length_final_mm(&self) -> f64 {
        self.crack_length_final() / MM
    }

    /// Crack length at the end, m.
    pub fn crack_length_final(&self) -> f64 {
        self.curve.last().map_or(f64::NAN, |point| point.crack_length)
    }
}

/// Tip of a plate that grew fastest at the end of a run, or has the largest K_I where nothing grew; `None` of standard specimens.
fn governing_tip(specimen: &Specimen, curve: &[CurvePoint]) -> Option<usize> {
    let last = curve.last().filter(|_| specimen.kind.is_plate())?;
    let before = curve.len().checked_sub(2).map(|row| &curve[row]);
    let leads = |tip: usize| match before {
        Some(before) => last.tips[tip].growth - before.tips[tip].growth,
        None => last.tips[tip].factors.map_or(0.0, |[k_i, _]| k_i),
    };
    // Of tips that grew alike that of the longest crack.
    let most = (0..last.tips.len()).map(leads).fold(f64::NEG_INFINITY, f64::max);
    let length = |tip: usize| last.crack_length_of(specimen, tip).unwrap_or(0.0);
    (0..last.tips.len()).filter(|tip| leads(*tip) >= most * (1.0 - ALIKE)).max_by(|a, b| length(*a).total_cmp(&length(*b)))
}

/// The crack whose length, ΔK and da/dN make a row: of several the one whose tip ends the life, else that of the convention.
#[derive(Debug, Clone)]
pub struct GoverningCrack<'a> {
    specimen: &'a Specimen,
    /// Its initial length, m, and its tips; `None` where the length of the row is that of the specimen.
    of_several: Option<(f64, Vec<usize>)>,
}

impl<'a> GoverningCrack<'a> {
    pub fn of(specimen: &'a Specimen, curve: &[CurvePoint]) -> Self {
        let line = |tip: usize| specimen.line_end(tip).map(|end| end.line);
        let governing = governing_tip(specimen, curve).and_then(line).filter(|_| specimen.has_several_cracks());
        let of_several = governing.map(|governing| {
            let tips = (0..specimen.tips.len()).filter(|tip| line(*tip) == Some(governing));
            (specimen.crack_lines()[governing].length(), tips.collect())
        });
        GoverningCrack { specimen, of_several }
    }

    /// Whether the plate has others beside it.
    pub fn is_of_several(&self) -> bool {
        self.of_several.is_some()
    }

    /// Its length at a row, m.
    pub fn length(&self, row: &CurvePoint) -> f64 {
        let grown = |tips: &[usize]| tips.iter().map(|tip| row.tips[*tip].growth).sum::<f64>();
        self.of_several.as_ref().map_or(row.crack_length, |(start, tips)| start + grown(tips))
    }

    /// How fast that grows, m/cycle; NaN where it is not known.
    pub fn growth_rate(&self, row: &CurvePoint) -> f64 {
        let own: Vec<f64> = self.tips(row).filter_map(|tip| tip.growth_rate).collect();
        let in_depth = row.depth.and_then(|depth| depth.growth_rate);
        let fastest = row.tips.iter().filter_map(|tip| tip.growth_rate).chain(in_depth).fold(0.0, f64::max);
        if own.is_empty() || fastest <= 0.0 {
            return row.growth_rate;
        }
        let sum = own.iter().sum::<f64>() * row.growth_rate / fastest;
        if self.specimen.convention == LengthConvention::SumOfTips { sum } else { sum / own.len() as f64 }
    }

    /// ΔK of the tip of it that leads, Pa√m; NaN where it is not known.
    pub fn delta_k(&self, row: &CurvePoint, ratio: f64) -> f64 {
        let range = |tip: &TipRecord| Some(equivalent_factor(tip.factors?) * tip.response.range_share(ratio));
        let in_depth = row.depth.and_then(|depth| Some(depth.k_i? * row.response.range_share(ratio)));
        let own = self.tips(row).filter_map(range).reduce(f64::max);
        let largest = row.tips.iter().filter_map(range).chain(in_depth).fold(0.0, f64::max);
        own.filter(|_| largest > 0.0).map_or(row.delta_k, |own| row.delta_k * own.max(0.0) / largest)
    }

    pub fn has(&self, tip: usize) -> bool {
        self.of_several.as_ref().is_none_or(|(_, tips)| tips.contains(&tip))
    }

    fn tips<'b>(&'b self, row: &'b CurvePoint) -> impl Iterator<Item = &'b TipRecord> {
        row.tips.iter().enumerate().filter(|(tip, _)| self.has(*tip)).map(|(_, tip)| tip)
    }
}

/// What a run reports while it goes on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// Cycles since N = 0.
    pub cycles: f64,
    /// Crack length, m.
    pub crack_length: f64,
    /// Share of the way to the nearest end that is in sight, 0 to 1.
    pub share: f64,
}
