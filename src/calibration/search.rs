//! Search for p: few true runs, everything between them from the surrogate.
//!
//! Run at a first p (and, where specimens scatter, at the ends of their range), minimise the misfit on the replay of that run,
//! run again there, minimise on what the true runs interpolate, and so on until p stands still. A never needs a search
//! ([`inverse_a`]).

use argmin::core::{CostFunction, Executor, State};
use argmin::solver::brent::BrentOpt;
use rayon::prelude::*;

use crate::calibration::criterion::Criterion;
use crate::calibration::misfit::{inverse_a, misfit};
use crate::calibration::model::{ForwardModel, RecordedRun, cycles_since_first};
use crate::calibration::surrogate::Surrogate;
use crate::error::{Error, Result};

/// Exponents a fit can give.
pub const P_MIN: f64 = *crate::fatigue::STEADY_EXPONENTS.start();
/// See [`P_MIN`].
pub const P_MAX: f64 = *crate::fatigue::STEADY_EXPONENTS.end();

/// p stands still when it moves less than this: the noise of runs (0.1 % in cycles, in which bonds break one by one) moves
/// the best p by as much, and its standard error is several times larger.
const P_TOLERANCE: f64 = 0.01;
/// True runs for one curve, at most.
const RUNS_ONE: usize = 4;
/// True runs for all specimens together, at most.
const RUNS_ALL: usize = 6;
/// A specimen this far outside the p of all true runs asks for one more.
const REACH_SPECIMEN: f64 = 0.15;
/// How far from the true runs a minimum is believed before the next run corrects it.
const REACH_STEP: f64 = 0.8;

/// True runs with their exponents, newest last.
pub type Runs = Vec<(f64, RecordedRun)>;

/// A and p of one curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constants {
    /// A, 1/cycle.
    pub a: f64,
    /// Exponent p.
    pub p: f64,
}

/// Result of the search on one curve.
#[derive(Debug)]
pub struct Found {
    /// The fit; p is that of the last true run, A follows from that run.
    pub constants: Constants,
    /// All true runs.
    pub runs: Runs,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Cycles of a curve at its lengths, both counted from the first reading.
#[derive(Debug, Clone, Copy)]
pub struct Target<'a> {
    /// Cycles since the first reading.
    pub cycles: &'a [f64],
    /// Crack lengths, m.
    pub lengths: &'a [f64],
    /// Which lives count.
    pub criterion: Criterion,
}

/// Exponents of the first runs for one curve and the specimens behind it, whose exponents are `expected`: `start`, the best guess
/// for the curve, comes last; before it the ends of their range, where it reaches farther than a run serves. Runs apart from
/// each other tell how cycles depend on p; close ones differ by their noise.
#[must_use]
pub fn first_exponents(start: f64, expected: impl Iterator<Item = f64>) -> Vec<f64> {
    let start = start.clamp(P_MIN, P_MAX);
    let mut exponents = beyond((start, start), expected);
    exponents.push(start);
    exponents
}

/// Fits p and A to one curve, from runs at `first` exponents (at least one, the best guess last) on.
pub fn search(model: &dyn ForwardModel, target: Target<'_>, first: Vec<f64>) -> Result<Found> {
    let runs_max = RUNS_ONE + first.len() - 1;
    let mut runs = true_runs(model, first)?;
    let mut warnings = Vec::new();
    loop {
        let last = runs[runs.len() - 1].0;
        let p = best_p(&Surrogate::new(&runs, target.lengths)?, target)?;
        if (p - last).abs() < P_TOLERANCE {
            break;
        }
        if runs.len() == runs_max {
            warnings.push(format!("p still moves by {:.4} after {runs_max} runs", (p - last).abs()));
            break;
        }
        runs.push(true_run(model, p)?);
    }
    let p = runs[runs.len() - 1].0;
    if p - P_MIN < 0.01 || P_MAX - p < 0.01 {
        warnings
            .push(format!("p = {p:.3} is an end of the range searched, {P_MIN} to {P_MAX}: the curve does not follow the law"));
    }
    Ok(Found { constants: at_last_run(&runs, target)?, runs, warnings })
}

/// Fits A alone at a given p.
pub fn search_a(model: &dyn ForwardModel, target: Target<'_>, p: f64) -> Result<Found> {
    let runs = vec![true_run(model, p)?];
    Ok(Found { constants: at_last_run(&runs, target)?, runs, warnings: Vec::new() })
}

/// Fits each specimen from the runs at hand, adding true runs (at most six in all) where specimens lie beyond them.
pub fn search_each(model: &dyn ForwardModel, targets: &[Target<'_>], runs: &mut Runs) -> Result<Vec<Constants>> {
    loop {
        let fits: Vec<Constants> = targets.par_iter().map(|target| on_surrogate(runs, *target)).collect::<Result<_>>()?;
        let mut wanted = beyond(range(runs.iter().map(|(p, _)| *p)), fits.iter().map(|fit| fit.p));
        wanted.truncate(RUNS_ALL.saturating_sub(runs.len()));
        if wanted.is_empty() {
            return Ok(fits);
        }
        runs.extend(true_runs(model, wanted)?);
    }
}

/// The ends of the range of some exponents that lie too far outside that of runs.
fn beyond((low, high): (f64, f64), exponents: impl Iterator<Item = f64>) -> Vec<f64> {
    let (lowest, highest) = range(exponents);
    let below = (lowest < low - REACH_SPECIMEN).then_some(lowest);
    let above = (highest > high + REACH_SPECIMEN).then_some(highest);
    below.into_iter().chain(above).map(|p| p.clamp(P_MIN, P_MAX)).collect()
}

/// True runs side by side, in the order of their exponents.
fn true_runs(model: &dyn ForwardModel, exponents: Vec<f64>) -> Result<Runs> {
    exponents.into_par_iter().map(|p| true_run(model, p)).collect()
}

/// A of each target at a fixed p, from the runs at hand.
pub fn search_each_a(targets: &[Target<'_>], runs: &Runs) -> Result<Vec<Constants>> {
    targets.iter().map(|target| at_last_run(runs, *target)).collect()
}

fn true_run(model: &dyn ForwardModel, p: f64) -> Result<(f64, RecordedRun)> {
    Ok((p, model.run(p)?))
}

fn at_last_run(runs: &Runs, target: Target<'_>) -> Result<Constants> {
    let (p, run) = &runs[runs.len() - 1]; // every caller has made at least one run
    let model = cycles_since_first(&run.curve, target.lengths)?;
    Ok(Constants { a: 1.0 / inverse_a(target.criterion, &model, target.cycles), p: *p })
}

fn on_surrogate(runs: &Runs, target: Target<'_>) -> Result<Constants> {
    let surrogate = Surrogate::new(runs, target.lengths)?;
    let p = best_p(&surrogate, target)?;
    Ok(Constants { a: 1.0 / inverse_a(target.criterion, &surrogate.cycles(p), target.cycles), p })
}

/// The p of the smallest misfit on the surrogate, no further than a step beyond the true runs.
fn best_p(surrogate: &Surrogate<'_>, target: Target<'_>) -> Result<f64> {
    let (low, high) = surrogate.range();
    let problem = Misfit { surrogate, target };
    let solver = BrentOpt::new((low - REACH_STEP).max(P_MIN), (high + REACH_STEP).min(P_MAX)).set_tolerance(1e-7, 1e-6);
    let outcome = Executor::new(problem, solver).configure(|state| state.max_iters(100)).run();
    let failed = |reason: String| Error::Mechanics(format!("the search for p failed: {reason}"));
    let outcome = outcome.map_err(|error| failed(error.to_string()))?;
    outcome.state().get_best_param().copied().ok_or_else(|| failed("no p was tried".to_owned()))
}

/// Misfit as argmin sees it.
struct Misfit<'a> {
    surrogate: &'a Surrogate<'a>,
    target: Target<'a>,
}

impl CostFunction for Misfit<'_> {
    type Param = f64;
    type Output = f64;

    fn cost(&self, p: &f64) -> std::result::Result<f64, argmin::core::Error> {
        let value = misfit(self.target.criterion, &self.surrogate.cycles(*p), self.target.cycles);
        // Any finite curve beats one that could not be computed.
        Ok(if value.is_finite() { value } else { f64::MAX })
    }
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}
