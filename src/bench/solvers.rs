//! A run with another solver: whole, or extrapolated where that would take too long.

use super::Bench;
use super::clock::Timing;
use super::extrapolation::History;
use super::scene::Found;
use crate::calibration::median::median;
use crate::case::Case;
use crate::error::Result;

/// What may be spent on a slow solver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// Seconds for measured blocks.
    pub blocks_s: f64,
    /// Estimated seconds up to which a run is made whole.
    pub whole_s: f64,
}

/// A run of a case whose breaks are known from the default solver (`history`, which found `known`): first some blocks; from these
/// the whole, or the whole itself if it does not take too long.
///
/// # Errors
/// Those of the run and of the measured blocks.
pub(super) fn whole_or_extrapolated(
    bench: &mut Bench<'_>,
    case: &Case,
    (history, known): (&History, &Found),
    budget: Budget,
    run: impl Fn(&Case) -> Result<Found>,
) -> Result<(Found, Timing)> {
    let before = bench.reference.beside()?;
    let sampled = history.sample(case.model.solver, case.loading.maximum, budget.blocks_s)?;
    let beside = median(&[before, bench.reference.run()?]);
    let estimate = sampled.whole(history.blocks());
    if estimate <= budget.whole_s {
        let (found, timing) = bench.time(|| run(case))?;
        return Ok((found, Timing { estimated_s: Some(estimate), ..timing }));
    }
    let timing = Timing {
        wall_s: estimate,
        cpu_s: f64::NAN,
        ratio: estimate / beside,
        repeats: 1,
        estimated_s: Some(estimate),
        extrapolated_from: Some(sampled.blocks.len()),
    };
    Ok((known.clone(), timing))
}
