//! What a run carries from block to block, its growing a-N curve first. The displacement is not among it: the solver makes it of the
//! bonds.

use serde::{Deserialize, Serialize};

use crate::ageing::BondLife;
use crate::case::{Case, Engine};
use crate::end_of_life::End;
use crate::record::{CurvePoint, TipRecord};
use perilife_laws::growth_rate::{LengthAverage, Rate, Sample, rates, release_rate_at_end};
use perilife_plate::specimen::handbook::{HandbookFormula, handbook};
use perilife_plate::specimen::{LengthConvention, Specimen};
use perilife_points::body::{Body, Bond};
use perilife_points::crack_tip::CrackTip;
use perilife_points::state::Bonds;

/// Growth, in horizons, over which rates are taken.
const RATE_SPAN_HORIZONS: f64 = 1.0;
/// Growth of all tips, in horizons, for the energy release rate: K within 2 % of a crack of four horizons, 7 % of two.
const RELEASE_SPAN_HORIZONS: f64 = 3.0;
/// Growth before which that says nothing: the first bonds to break turn the cut end of a crack into a grown one.
const RELEASE_KNOWN_HORIZONS: f64 = 2.0;
/// Initial crack length, in horizons, below which the finite horizon matters by more than some percent in rate.
const SHORT_CRACK_HORIZONS: f64 = 5.0;

/// All rows of a run so far.
pub struct GrowthHistory {
    pub past: History,
    formula: Option<HandbookFormula>,
    specimen: Specimen,
    /// Cycles at which the run was ended without a break.
    run_out: Option<f64>,
    /// Largest crack length the plate has room for, m.
    limit: f64,
}

/// What a track has taken down.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct History {
    rows: Vec<CurvePoint>,
    cycles: f64,
    /// Longest crack so far as the ways of its tips have it, m.
    longest: f64,
}

impl History {
    /// Whether it can be that of a run with `tips` tips.
    pub(super) fn fits(&self, tips: usize) -> bool {
        !self.rows.is_empty() && self.rows.iter().all(|row| row.tips.len() == tips)
    }
}

impl GrowthHistory {
    /// Nothing is taken down yet.
    pub(super) fn new(case: &Case) -> Self {
        GrowthHistory {
            past: History::default(),
            formula: handbook(&case.specimen),
            specimen: case.specimen.clone(),
            run_out: None,
            limit: match case.specimen.convention {
                LengthConvention::MeanOfTips => case.specimen.length_limit().0,
                LengthConvention::SumOfTips => f64::INFINITY,
            },
        }
    }

    pub(super) fn last(&self) -> &CurvePoint {
        // The first row is recorded before the first block.
        &self.past.rows[self.past.rows.len() - 1]
    }

    /// Lets cycles pass.
    pub(super) fn spend(&mut self, cycles: f64) {
        self.past.cycles += cycles;
    }

    pub(super) fn cycles(&self) -> f64 {
        self.past.cycles
    }

    /// Records the plate at its start or after a block.
    ///
    /// Where bonds break all around, the way of a tip goes to and fro: a crack is never recorded longer than its plate.
    pub(super) fn record(&mut self, tips: Vec<TipRecord>, broken_bonds: usize, work: f64) {
        let growth: Vec<f64> = tips.iter().map(|tip| tip.growth).collect();
        let crack_length = self.specimen.crack_length_after(&growth);
        self.past.longest = self.past.longest.max(crack_length);
        let crack_length = crack_length.min(self.limit);
        self.past.rows.push(CurvePoint { work, broken_bonds, ..CurvePoint::bare(self.past.cycles, crack_length, tips) });
    }

    /// Ends the curve at a run-out: the crack stands where it is.
    pub(super) fn run_out(&mut self, cycles_max: f64) {
        self.run_out = Some(cycles_max);
    }

    /// K_max at the last row, Pa√m, from the energy release rate; `None` with a handbook, or before growth of two horizons.
    pub(super) fn k_max_released(&self, case: &Case, horizon: f64) -> Option<f64> {
        if self.formula.is_some() || self.last().growth() < RELEASE_KNOWN_HORIZONS * horizon {
            return None;
        }
        let span = RELEASE_SPAN_HORIZONS * horizon;
        let recent = self.past.rows.iter().rposition(|row| row.growth() < self.last().growth() - span).unwrap_or(0);
        let released = release_rate_at_end(&self.samples(&self.past.rows[recent..]), case.specimen.thickness)?;
        Some((released * case.material.plane_modulus()).sqrt())
    }

    pub(super) fn warnings(&self, case: &Case, body: &Body) -> Vec<String> {
        let mut warnings = Vec::new();
        let flaw = case.specimen.smallest_flaw();
        if case.engine() == Engine::Bonds && flaw < SHORT_CRACK_HORIZONS * body.horizon() {
            warnings.push(format!(
                "bonds: the initial crack is only {:.1} horizons long: it grows too fast at first (a model artifact, not a short-crack effect; \
                 fatigue.driver = \"tip_field\" avoids it)",
                flaw / body.horizon()
            ));
        }
        if self.past.longest > self.limit + body.horizon() {
            let words = "bonds: bonds broke all around the tips: the path near the end is not reliable; use the life, not the length \
                         (fatigue.ageing = \"crack_tip\" keeps breaks at the tips)";
            warnings.push(words.to_owned());
        }
        let stopped_in_grip = self.past.rows.last().is_some_and(|row| {
            row.tips.iter().any(|tip| {
                let [column, line] = body.lattice.locate(tip.position).map(f64::round);
                (0.0..body.lattice.columns as f64).contains(&column)
                    && (0.0..body.lattice.rows as f64).contains(&line)
                    && body.no_fail[body.lattice.place(column as usize, line as usize)]
            })
        });
        if stopped_in_grip {
            warnings.push("bonds: a crack tip is in the zone around a load or support, where bonds do not fail".to_owned());
        }
        warnings
    }

    fn samples(&self, rows: &[CurvePoint]) -> Vec<Sample> {
        let sample = |row: &CurvePoint| Sample {
            cycles: row.cycles,
            crack_length: row.crack_length,
            growth: row.growth(),
            work: row.work,
        };
        rows.iter().map(sample).collect()
    }

    /// The rows with lengths averaged over one spacing of growth.
    fn averaged(&self, spacing: f64) -> Vec<CurvePoint> {
        let cycles: Vec<f64> = self.past.rows.iter().map(|row| row.cycles).collect();
        let lengths: Vec<f64> = self.past.rows.iter().map(|row| row.crack_length).collect();
        // A spacing of growth at every tip.
        let growth = vec![spacing; self.past.rows[0].tips.len()];
        let average =
            LengthAverage::new(&cycles, &lengths, self.specimen.crack_length_after(&growth) - self.specimen.crack_length);
        let mut rows = self.past.rows.clone();
        let work: Vec<f64> = self.past.rows.iter().map(|row| row.work).collect();
        rows.iter_mut().zip(average.of(&work)).for_each(|(row, work)| row.work = work);
        rows.iter_mut().zip(average.of_rising(&lengths)).for_each(|(row, length)| row.crack_length = length);
        for tip in 0..self.past.rows[0].tips.len() {
            let growth: Vec<f64> = self.past.rows.iter().map(|row| row.tips[tip].growth).collect();
            rows.iter_mut().zip(average.of_rising(&growth)).for_each(|(row, growth)| row.tips[tip].growth = growth);
        }
        rows
    }

    /// The curve to a known end.
    pub(super) fn curve(&self, case: &Case, body: &Body, end: Option<End>) -> Vec<CurvePoint> {
        let mut rows = self.averaged(body.lattice.spacing);
        if let Some(cycles_max) = self.run_out {
            // The crack stands where it is until then.
            rows.extend(rows.last().cloned().map(|row| CurvePoint { cycles: cycles_max, ..row }));
        }
        if let Some(end) = end {
            end_at(&mut rows, &end, &case.specimen);
        }
        let (span, thickness) = (RATE_SPAN_HORIZONS * body.horizon(), case.specimen.thickness);
        let rate = rates(&self.samples(&rows), span, thickness);
        // Where crack length sums the growth of all tips, da/dN is still that of one: the fastest.
        let of_tip = |tip: usize| {
            let samples = self.samples(&rows).into_iter().zip(&rows);
            let growth: Vec<Sample> = samples.map(|(s, row)| Sample { crack_length: row.tips[tip].growth, ..s }).collect();
            rates(&growth, span, thickness)
        };
        let tips = if case.specimen.convention == LengthConvention::SumOfTips { rows[0].tips.len() } else { 0 };
        let of_tips: Vec<Vec<Rate>> = (0..tips).map(of_tip).collect();
        let fastest = |i: usize| of_tips.iter().map(|tip| tip[i].growth_rate).reduce(f64::max).unwrap_or(rate[i].growth_rate);
        let share = case.loading.range_share();
        let cracks = case.specimen.crack_lines();
        let limit_load = |tips: &[TipRecord], crack_length: f64| {
            let mut cracks = cracks.clone();
            for (tip, record) in tips.iter().enumerate() {
                if let Some(end) = case.specimen.line_end(tip).filter(|_| record.growth > 0.0) {
                    cracks[end.line].grow(end.at_last, record.position);
                }
            }
            case.limit_load(crack_length, &cracks)
        };
        let point = |(i, row): (usize, &CurvePoint)| CurvePoint {
            limit_load: limit_load(&row.tips, row.crack_length),
            delta_k: match &self.formula {
                Some(_) if row.crack_length >= self.limit * (1.0 - 1e-9) => f64::NAN,
                Some(formula) => formula.delta_k(row.crack_length, case.loading.maximum, share),
                None => share * (rate[i].energy_release_rate * case.material.plane_modulus()).sqrt(),
            },
            growth_rate: fastest(i),
            tips: tips_with_rates(&row.tips, of_tips.iter().map(|tip| tip[i].growth_rate)),
            ..row.clone()
        };
        rows.iter().enumerate().map(point).collect()
    }
}

/// Tips with the rates that are known of them.
fn tips_with_rates(tips: &[TipRecord], rates: impl Iterator<Item = f64>) -> Vec<TipRecord> {
    let mut tips = tips.to_vec();
    tips.iter_mut().zip(rates).for_each(|(tip, rate)| tip.growth_rate = Some(rate).filter(|rate| rate.is_finite()));
    tips
}

/// Ends the rows at a crack length that they pass.
fn end_at(rows: &mut Vec<CurvePoint>, end: &End, specimen: &Specimen) {
    let length = |row: &CurvePoint| end.length_of(specimen, row);
    let Some(past) = rows.iter().position(|row| length(row) >= end.crack_length).filter(|&past| past > 0) else { return };
    rows.truncate(past + 1);
    let (before, row) = (&rows[past - 1], &rows[past]);
    let share = (end.crack_length - length(before)) / (length(row) - length(before));
    let last = CurvePoint { is_solved: true, ..row.clone().between(before, share) };
    // Where that is the length of the row there is no rounding between.
    let crack_length = if specimen.has_several_cracks() { last.crack_length } else { end.crack_length };
    rows[past] = CurvePoint { crack_length, ..last };
}

pub(super) struct RunState {
    pub bonds: Bonds,
    pub life: BondLife,
    pub tips: Vec<CrackTip>,
    /// Bonds that come near the critical stretch, also away from the tips.
    pub near_limit: Vec<Bond>,
    /// The curve so far.
    pub track: GrowthHistory,
    /// Bonds broken since the start, those set aside not counted.
    pub broken_bonds: usize,
    pub solves: usize,
    pub iterations: usize,
    /// Whether a window was condensed; a solver that is built anew has none at first.
    pub had_window: bool,
}

impl RunState {
    /// The start of a run with these tips, all bonds but those of the initial cracks whole.
    pub(super) fn start(case: &Case, body: &Body, tips: Vec<CrackTip>) -> Self {
        let bonds = Bonds::new(body);
        RunState {
            life: BondLife::whole(bonds.multiplier.len()),
            track: GrowthHistory::new(case),
            near_limit: Vec::new(),
            broken_bonds: 0,
            solves: 0,
            iterations: 0,
            had_window: false,
            bonds,
            tips,
        }
    }
}
