//! The run of a case whose cracks are driven by the K of their tips: blocks of [`TipField`] until there is a reason to stop.

use std::time::Instant;

use super::checkpoint::{self, Checkpoint};
use super::end_of_life::{End, first_end};
use super::snapshot::Album;
use super::{CurvePoint, Observer, Prediction, Progress, RunFigures, StopReason, TipRecord, laws, memory, plastic_zone};
use crate::case::Case;
use crate::error::{Error, Result};
use crate::fatigue::crack_tip::TipState;
use crate::fatigue::growth_law::GrowthLaw;
use crate::growth::TipNow;
use crate::growth::plate::Plate;
use crate::growth::tip_field::steering::equivalent_factor;
use crate::growth::tip_field::{self, Step, TipField};

/// Relative difference between lengths that are equal but for round-off.
const ROUND_OFF: f64 = 1e-12;

/// Blocks after which a run begins anew from its bonds, so that it can be taken up there.
const BLOCKS_ANEW: usize = 32;

/// Predicts the a-N curve of a case of driver `tip_field` with a law over K, from its start or from where an earlier run stood.
///
/// # Errors
/// As [`super::predict`], and a specimen without sharp crack.
pub(super) fn run(
    case: &Case,
    checkpoint: Option<Checkpoint>,
    law: &dyn GrowthLaw,
    observer: &dyn Observer,
) -> Result<Prediction> {
    let started = Instant::now();
    let hash = checkpoint::hash(case);
    let mut case = case.clone();
    case.model.spacing = case.model.fitting_spacing(&case.specimen);
    let case = &case;
    let plate = Plate::build(&case.specimen, &case.specimen, &case.material, &case.model)?;
    let mut growth = TipField::start(case, &plate, law)?;
    let end = first_end(case);
    let until = end.map_or(f64::INFINITY, |end| end.crack_length);

    let mut warnings = plate.warnings();
    warnings.extend(growth.warnings());
    let (mut curve, mut album, earlier_s) = match checkpoint {
        Some(checkpoint) => checkpoint.restore_tips(&mut growth)?,
        None => {
            growth.open()?;
            let curve = vec![row(case, &growth, 0.0, growth.work(), 0)];
            laws::check_within(case, law, &curve[0])?;
            let mut album = Album::default();
            album.open(&plate, &growth.bonds, &growth.displacement, &curve[0]);
            album.show(&plate, observer);
            (curve, album, 0.0)
        }
    };
    // A run that was taken up stands where the earlier one had begun anew.
    let mut anew = curve.len();
    let stop = loop {
        let last = &curve[curve.len() - 1];
        if let Some(reason) = reason_to_stop(case, end, &growth, last) {
            break reason;
        }
        if curve.len() >= anew + BLOCKS_ANEW {
            anew = curve.len();
            let elapsed_s = earlier_s + started.elapsed().as_secs_f64();
            observer.may_keep(&|| Checkpoint::of_tips(hash, &growth, (&curve, &album), &progress(case, until, last), elapsed_s));
            if let Err(error) = growth.begin_anew() {
                tracing::debug!(%error, "no equilibrium from the bonds alone");
                break StopReason::NoConvergence;
            }
        }
        let step = growth.advance(last.cycles, until);
        let (next, ended) = after(case, &growth, last, &step);
        if step.cut > 0 || step.cycles > 0.0 {
            curve.push(next);
        }
        if ended.is_none() {
            laws::check_within(case, law, &curve[curve.len() - 1])?;
        }
        let now = &curve[curve.len() - 1];
        if album.is_due(now) && step.end.is_none() {
            album.look(&plate, &growth.bonds, &growth.displacement, now);
            album.show(&plate, observer);
        }
        observer.grown(&now.tips);
        if !observer.block_done(&progress(case, until, now)) {
            return Err(Error::Mechanics(format!("{}: the run was cancelled", case.name)));
        }
        if let Some(reason) = ended {
            break reason;
        }
    };
    album.finish(&plate, &growth.bonds, &growth.displacement, &curve[curve.len() - 1]);
    warnings.extend(laws::beyond_warning(case, law, &curve));
    warnings.extend(plastic_zone::warnings(case, &curve));
    let body = &plate.body;
    Ok(Prediction {
        stop,
        snapshots: album.snapshots,
        grid: plate.grid(),
        figures: RunFigures {
            points: plate.points(),
            points_solved: growth.points(),
            bonds: plate.bonds(),
            blocks: curve.len() - 1,
            solves: growth.solves,
            iterations: growth.iterations,
            spacing: body.lattice.spacing,
            horizon: body.horizon(),
            wall_s: earlier_s + started.elapsed().as_secs_f64(),
            memory_mb: memory::peak_mb(),
        },
        curve,
        warnings,
    })
}

/// The plate as it stands, as a row of the curve; ΔK and da/dN are those of the fastest tip.
fn row(case: &Case, growth: &TipField, cycles: f64, work: f64, broken_bonds: usize) -> CurvePoint {
    let tips = growth.tips();
    let fastest = tips.iter().max_by(|a, b| equivalent_factor(a.factors).total_cmp(&equivalent_factor(b.factors)));
    let growths: Vec<f64> = tips.iter().map(|tip| tip.growth).collect();
    let is_open = growth.is_growing();
    CurvePoint {
        cycles,
        crack_length: case.specimen.crack_length_after(&growths),
        delta_k: fastest.filter(|_| is_open).map_or(f64::NAN, |tip| case.loading.range_share() * equivalent_factor(tip.factors)),
        growth_rate: fastest.filter(|_| is_open).map_or(f64::NAN, |tip| tip.rate),
        work,
        broken_bonds,
        tips: tips
            .iter()
            .map(|&TipNow { position, growth, factors, .. }| TipRecord { position, growth, factors: Some(factors) })
            .collect(),
    }
}

/// Reasons that show on a row: a known end is reached, or K_max of a tip is the toughness.
fn reason_to_stop(case: &Case, end: Option<End>, growth: &TipField, last: &CurvePoint) -> Option<StopReason> {
    if let Some(end) = end.filter(|end| last.crack_length >= end.crack_length * (1.0 - ROUND_OFF)) {
        return Some(end.reason);
    }
    let toughness = case.material.toughness.filter(|_| growth.is_growing())?;
    (last.delta_k >= case.loading.range_share() * toughness).then_some(StopReason::Toughness)
}

/// The row after a block, and the reason to stop that the block brought.
fn after(case: &Case, growth: &TipField, last: &CurvePoint, step: &Step) -> (CurvePoint, Option<StopReason>) {
    let cycles = last.cycles + step.cycles;
    let next = row(case, growth, cycles, step.work, last.broken_bonds + step.cut);
    if cycles > case.stop.cycles_max {
        return (between(last, next, (case.stop.cycles_max - last.cycles) / step.cycles), Some(StopReason::RunOut));
    }
    let toughness = case.material.toughness.map(|toughness| case.loading.range_share() * toughness);
    if let Some(limit) = toughness.filter(|limit| next.delta_k > *limit && last.delta_k < *limit) {
        let share = (limit - last.delta_k) / (next.delta_k - last.delta_k);
        return (between(last, next, share), Some(StopReason::Toughness));
    }
    let reason = step.end.map(|end| match end {
        tip_field::End::NothingGrows => StopReason::NothingAges,
        tip_field::End::LeftRefinement => StopReason::LeftRefinement,
        tip_field::End::Severed => StopReason::Severed,
        tip_field::End::NoConvergence => StopReason::NoConvergence,
        tip_field::End::NoTipLeft => {
            let entered = growth.state.tips.iter().any(|tip| matches!(tip.state, TipState::EnteredHole | TipState::LinkedUp));
            if entered { StopReason::EnteredHole } else { StopReason::LeftPlate }
        }
    });
    (next, reason)
}

/// The row at a share of the way between two.
fn between(last: &CurvePoint, next: CurvePoint, share: f64) -> CurvePoint {
    let mix = |a: f64, b: f64| a + share * (b - a);
    let tip = |(a, b): (&TipRecord, &TipRecord)| TipRecord {
        position: [0, 1].map(|i| mix(a.position[i], b.position[i])),
        growth: mix(a.growth, b.growth),
        factors: a.factors.zip(b.factors).map(|(a, b)| [0, 1].map(|i| mix(a[i], b[i]))),
    };
    CurvePoint {
        cycles: mix(last.cycles, next.cycles),
        crack_length: mix(last.crack_length, next.crack_length),
        delta_k: mix(last.delta_k, next.delta_k),
        growth_rate: mix(last.growth_rate, next.growth_rate),
        work: mix(last.work, next.work),
        broken_bonds: next.broken_bonds,
        tips: last.tips.iter().zip(&next.tips).map(tip).collect(),
    }
}

fn progress(case: &Case, until: f64, now: &CurvePoint) -> Progress {
    let start = case.specimen.crack_length;
    let end = if until.is_finite() { until } else { start + case.specimen.width };
    let grown = (now.crack_length - start) / (end - start);
    let share = grown.max(now.cycles / case.stop.cycles_max).clamp(0.0, 1.0);
    Progress { cycles: now.cycles, crack_length: now.crack_length, share }
}
