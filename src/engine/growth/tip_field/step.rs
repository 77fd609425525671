//! How long a block is: the ways of all tips over the same cycles, and the cycles.
//!
//! The block is as long as the fastest tip takes for a step. With its length as independent variable the other tips follow
//! `da_i/da = r_i/r`, by the rates of this block and the last one extrapolated to the middle of the step (Adams and Bashforth),
//! and the cycles are `∫ da/r` with ln r a parabola through the rates at the ends of this step and at the start of the last one.
//! What the parabola adds to the straight line tells how long the next step may be.

use super::{Tip, TipField, TipFieldState, ahead};
use crate::case::Case;
use crate::fatigue::STEP_ERROR_PERCENT;
use crate::specimen::Specimen;

/// Growth of a tip in the first block, in horizons: nothing is known yet of how its rate changes.
const STEP_FIRST_HORIZONS: f64 = 0.15;
/// Growth in a block at the most after a corner, in horizons, until the aims since then show how the crack curves.
const STEP_TURNING_HORIZONS: f64 = 0.4;
/// Growth in any block at the most, in horizons. Lives and paths against steps of a tenth: `tests/verification/tip_field.rs`.
const STEP_HORIZONS: f64 = 1.5;
/// Next step over the last one, at the most.
const STEP_RISE: f64 = 1.6;
/// Share of a block's cycles that the parabola may add: beyond it the rates lie on none.
const CURVATURE_SHARE_MOST: f64 = 0.02;
/// Growth in a block at the most, in horizons, where a rim or another crack lies near, and K changes fast.
const STEP_NEAR_HORIZONS: f64 = 0.2;
/// How near that is, in horizons.
const NEAR_HORIZONS: f64 = 3.0;
/// Turn of a tip in a block at the most, rad, unless that makes the block shorter than the step near rims. With 2° cycles half way
/// of an edge crack that curves into a hole are -0.7 instead of -0.5 % off finite elements, its path 0.13 instead of 0.10 mm.
const TURN: f64 = std::f64::consts::PI / 180.0;
/// Growth of a tip over that of the fastest, at the most, where rates are extrapolated.
const SHARE_MOST: f64 = 1.5;
/// Way to a rim straight ahead, in horizons, that is gone in one block where it takes less than [`SHARE_LEFT`] of the cycles so far:
/// what is left of the plate there is nearly a mechanism, and says nothing about its life.
const LEFT_HORIZONS: f64 = 4.0;
const SHARE_LEFT: f64 = 5e-4;

/// Limits of steps of a run.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepControl {
    /// Horizon of the body, m.
    horizon: f64,
    /// Measure of steps, m: the horizon, less where a smaller error is asked for than by default.
    measure: f64,
    /// Error of the cycles of a block that is asked for, as share.
    error: f64,
}

impl StepControl {
    pub(super) fn new(case: &Case, horizon: f64) -> Self {
        let percent = case.fatigue.step_error_percent;
        let finer = (percent / STEP_ERROR_PERCENT).sqrt().min(1.0);
        StepControl { horizon, measure: finer * horizon, error: 0.01 * percent }
    }

    /// Growth of a tip at the most in a block of which nothing is known yet of how its rate changes, m.
    pub(super) fn first(&self) -> f64 {
        STEP_FIRST_HORIZONS * self.measure
    }

    /// Growth of a tip at the most in the block after one of length `grown`, m, in which the parabola added the share `curvature_share`.
    pub(super) fn next(&self, grown: f64, curvature_share: f64) -> f64 {
        let most = (self.error / curvature_share.abs().max(f64::MIN_POSITIVE)).sqrt().min(STEP_RISE) * grown;
        most.clamp(STEP_NEAR_HORIZONS * self.measure, STEP_HORIZONS * self.measure)
    }

    /// Growth of a tip at the most in its surroundings, m.
    fn of_tip(&self, specimen: &Specimen, state: &TipFieldState, tip: &Tip) -> f64 {
        let most = if ahead::is_near_rim(specimen, &state.lines, tip.end, NEAR_HORIZONS * self.horizon) {
            STEP_NEAR_HORIZONS * self.measure
        } else if tip.steering.is_turning(tip.growth, self.horizon) {
            state.step.min(STEP_TURNING_HORIZONS * self.measure)
        } else {
            state.step
        };
        let turn = TURN * self.measure / self.horizon;
        let turning = (turn / tip.steering.curvature(self.horizon).abs()).max(STEP_NEAR_HORIZONS * self.measure);
        most.min(turning)
    }
}

impl TipField<'_> {
    /// How far every tip goes in the next block, m, after so many `cycles`, and until the crack has the length `until` at the latest.
    pub(super) fn next_lengths(&self, fastest: usize, cycles: f64, until: f64) -> Vec<f64> {
        let rate = self.state.tips[fastest].rate;
        let step = self.last_way(fastest).filter(|way| *way / rate < SHARE_LEFT * cycles).unwrap_or_else(|| self.step(rate));
        self.lengths(fastest, step, until)
    }

    /// How far every tip goes while the fastest goes a step, m, all less where the crack would become longer than `until`.
    fn lengths(&self, fastest: usize, step: f64, until: f64) -> Vec<f64> {
        let lead = &self.state.tips[fastest];
        let share = |tip: &Tip| {
            let now = tip.rate / lead.rate;
            let Some(([before, since], [lead_before, _])) = tip.before.zip(lead.before) else { return now };
            // ln of the ratio is linear in the growth of the fastest.
            let known = before > 0.0 && lead_before > 0.0 && since > 0.0;
            if known { now * (now * lead_before / before).powf(0.5 * step / since) } else { now }
        };
        let way = |tip: &Tip| if tip.is_growing() { step * share(tip).min(SHARE_MOST) } else { 0.0 };
        let mut ways: Vec<f64> = self.state.tips.iter().map(way).collect();
        let length_after = |ways: &[f64]| {
            let growth: Vec<f64> = self.state.tips.iter().zip(ways).map(|(tip, way)| tip.growth + way).collect();
            self.case.specimen.crack_length_after(&growth)
        };
        let (now, then) = (length_after(&vec![0.0; ways.len()]), length_after(&ways));
        if then > until {
            let share = ((until - now) / (then - now)).clamp(0.0, 1.0);
            ways.iter_mut().for_each(|way| *way *= share);
        }
        ways
    }

    /// Growth of the fastest tip, of this rate, in the next block, m: no tip takes a longer step than its surroundings allow.
    fn step(&self, rate: f64) -> f64 {
        let growing = self.state.tips.iter().filter(|tip| tip.is_growing());
        let of_tip = |tip: &Tip| self.steps.of_tip(&self.case.specimen, &self.state, tip) * rate / tip.rate;
        growing.map(of_tip).fold(f64::INFINITY, f64::min)
    }

    /// Way of a tip straight ahead to a rim or another crack, m, if it is short.
    fn last_way(&self, tip: usize) -> Option<f64> {
        let tip = &self.state.tips[tip];
        let (from, [x, y]) = (self.position(tip), self.heading(tip.end));
        let reach = LEFT_HORIZONS * self.body.horizon();
        let to = [from[0] + reach * x, from[1] + reach * y];
        ahead::first_rim(&self.case.specimen, &self.state.lines, tip.end.line, from, to).map(|(share, _)| share * reach)
    }
}

/// Cycles of a step of the fastest tip: its rates at the start of the step before, where known, with that step's length, at the
/// start and at the end of this one, m/cycle, whose length is `grown`, m. Gives the share that the parabola adds, too.
pub(in crate::growth) fn cycles(past: Option<[f64; 2]>, rate: f64, rate_then: f64, grown: f64) -> (f64, f64) {
    let curvature_share = past.map_or(0.0, |[before, way]| curvature_share([before, rate, rate_then], [way, grown]));
    let counted = if curvature_share.abs() < CURVATURE_SHARE_MOST { curvature_share } else { 0.0 };
    (grown * mean_inverse(rate, rate_then) * (1.0 + counted), curvature_share)
}

/// Mean of 1/r between two rates with ln r linear between them, cycles/m.
fn mean_inverse(from: f64, to: f64) -> f64 {
    if to.is_infinite() {
        return 0.5 / from;
    }
    let fall = (from / to).ln();
    // (1/to - 1/from) / ln(from/to), whose difference loses digits where the rates are nearly equal.
    if fall.abs() < 1e-4 { (1.0 + 0.5 * fall) / from } else { (fall.exp_m1() / fall) / from }
}

/// Share by which a parabola of ln r through three rates raises `∫ da/r` over the second of the `ways` between them, m, above that
/// of the straight line: `c h²/6` with c the second divided difference.
fn curvature_share([before, from, to]: [f64; 3], [first, second]: [f64; 2]) -> f64 {
    let slope = |a: f64, b: f64, way: f64| (b / a).ln() / way;
    let curvature = (slope(from, to, second) - slope(before, from, first)) / (first + second);
    let share = curvature * second * second / 6.0;
    if share.is_finite() { share } else { 0.0 }
}
