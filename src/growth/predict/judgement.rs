//! Warnings of a finished run, and refusals of a run and of a case before it is run.

use super::record::BLOCKS_WITHOUT_GROWTH;
use super::{Prediction, StopReason, fit_use};
use crate::case::{Case, first_load, ratio_line};
use perilife_base::error::{Error, Result, input};
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_plate::loading::{LoadControl, SAME_RATIO};
use perilife_plate::specimen::handbook::handbook;

/// Span of the stress ratios of a spectrum from which its life without load interaction is warned about.
const RATIOS_SPAN: f64 = 0.3;

/// Warnings beside those of the run itself.
/// Errors: [`Error::Mechanics`] if the run ended before the crack grew.
pub fn judge(case: &Case, prediction: &Prediction) -> Result<Vec<String>> {
    let mut warnings = Vec::new();
    let start = prediction.curve.first().map_or(f64::INFINITY, |point| point.crack_length);
    // An empty curve compares as not grown.
    let grown = prediction.crack_length_final().max(0.0) > start;
    let no_curve = |why: &str, remedy: &str| {
        Err(Error::Mechanics(format!("{}: no a-N curve: {why} before the crack grew; {remedy}", case.name)))
    };
    match prediction.stop {
        StopReason::NoConvergence if grown => {
            warnings.push("stopped: the solver did not converge; the curve ends at the last converged increment".to_owned());
        }
        StopReason::NoConvergence => {
            return no_curve("the solver did not converge", "use another model.spacing_mm");
        }
        StopReason::NoGrowth if grown => {
            warnings.push(format!(
                "stopped: bonds kept breaking but no crack tip advanced in the last {BLOCKS_WITHOUT_GROWTH} increments: the curve ends at the last \
                 advance; use fatigue.driver = \"tip_field\", or another model.spacing_mm"
            ));
        }
        StopReason::NoGrowth => {
            return no_curve(
                "bonds kept breaking but no crack tip advanced",
                "use fatigue.driver = \"tip_field\", or another model.spacing_mm",
            );
        }
        // Under the threshold nothing ages either, which is an answer.
        StopReason::NothingAges if !grown && (case.fatigue.threshold > 0.0 || !case.spends_bond_life()) => {
            let why = "no growth: every crack is closed or below the threshold ΔK_th";
            warnings.push(why.to_owned());
        }
        StopReason::NothingAges | StopReason::LeftPlate | StopReason::EnteredHole | StopReason::CracksJoined if !grown => {
            let why = format!("no breakable bond at a crack tip is loaded (stopped by {})", prediction.stop);
            return no_curve(
                &why,
                "move crack and hole or support apart, or reduce model.spacing_mm; `perilife check` lists the tips",
            );
        }
        _ => {}
    }
    warnings.extend(beyond_load(case, prediction));
    warnings.extend(hardly_loaded(prediction));
    warnings.extend(fit_use::of_other_ratios(case, prediction));
    warnings.extend(no_interaction(case));
    Ok(warnings)
}

/// A load or a size whose unit slipped: thresholds of metals are from 1 MPa√m.
fn hardly_loaded(prediction: &Prediction) -> Option<String> {
    let most = prediction.curve.iter().map(|row| row.delta_k).fold(0.0, f64::max) / MPA_SQRT_M;
    let words = "is below the threshold of any metal: check the units of load, thickness and crack length";
    (0.0 < most && most < 0.5).then(|| format!("units: ΔK up to {most:.3} MPa√m {words}"))
}

/// Warning of the life beyond the table of the load, under its last row.
fn beyond_load(case: &Case, prediction: &Prediction) -> Option<String> {
    let (course, last) = (case.loading.course()?, prediction.curve.last()?);
    let rows = &prediction.curve[prediction.curve.partition_point(|row| row.crack_length <= course.end() * (1.0 + 1e-9))..];
    let share = 100.0 * (last.cycles - rows.first()?.cycles) / last.cycles;
    let [end, reached] = [course.end(), last.crack_length].map(|length| length / MM);
    Some(format!(
        "loading: {} ends at a = {end:.3} mm; growth to {reached:.3} mm under its last load ({share:.2} % of life); add rows, or set \
         stop.crack_length_mm = {end:.3}",
        course.key
    ))
}

/// What a mean rate per pass leaves out. Lives of AA7050 under two sequences, predicted without load interaction over measured, are 0.59 and 0.56
/// (`perilife validate`; White and Mongru 2014, Adv. Mater. Res. 891-892:687; White, Barter and Medhekar 2018, Int. J. Fatigue 112:240).
fn no_interaction(case: &Case) -> Option<String> {
    let spectrum = case.loading.spectrum.as_ref().filter(|_| case.retardation.is_none())?;
    let [low, high] = spectrum.ratios;
    let strength = if case.material.yield_strength.is_none() { " and material.yield_strength_mpa" } else { "" };
    (high - low > RATIOS_SPAN - SAME_RATIO).then(|| {
        format!(
            "load interaction: none, at R = {low:.2} to {high:.2} (usually conservative: two published tests of AA7050 took 1.7 and 1.8 times the \
             life without it); compare with loading.retardation = \"newman\"{strength}"
        )
    })
}

/// Why the plate fails in the first cycle, and the load at the limit.
pub fn breaks_at_once(case: &Case, prediction: &Prediction) -> Option<String> {
    let [row] = prediction.curve.as_slice() else { return None };
    let required = case.stop.required.unwrap_or(1.0);
    let load = case.loading.doing(row.work, row.crack_length) * required;
    let k_max = row.k_max_at(required, &case.loading);
    // A limit may be reached but for round-off.
    let when = if required == 1.0 { "in the first cycle" } else { "under the required strength, at the start" };
    let words = || Some(first_load(case, load, Some(k_max).filter(|k| *k > 0.0))?.replacen("in the first cycle", when, 1));
    prediction
        .stop
        .is_strength()
        .then(|| words().unwrap_or_else(|| format!("fails in the first cycle: {}. No life computed.", prediction.stop.meaning())))
}

/// Why a finished run is not valid: failure in the first cycle, or over a quarter of life above the tested ΔK.
pub fn refusal(case: &Case, prediction: &Prediction) -> Option<Error> {
    if let Some(problem) = breaks_at_once(case, prediction) {
        return Some(Error::Mechanics(format!("{}: {problem}", case.name)));
    }
    let [_, above] = fit_use::life_shares_outside(case, prediction)?;
    (above > fit_use::EXTRAPOLATION_REFUSED && !case.allow_extrapolation)
        .then(|| extrapolates(case, &format!("{:.1} % of the life is above", 100.0 * above), "; results are marked not valid"))
}

/// Refuses a case before it is run: its first ΔK is above the tested range, or that of cycles with a quarter of the growth, and K only rises.
/// Errors: [`Error::Input`] where it does.
pub fn refuse_beforehand(case: &Case) -> Result<()> {
    if let (Some(record), Some(spectrum)) = (&case.law_record, &case.loading.spectrum)
        && fit_use::share_of_other_ratios(case, None).is_some_and(|share| share > fit_use::EXTRAPOLATION_REFUSED)
    {
        spectrum.ratios.into_iter().try_for_each(|ratio| ratio_line(record, ratio, "loading.spectrum_file").map(|_| ()))?;
    }
    let Some(first) = first_delta_k(case).filter(|_| !case.allow_extrapolation) else { return Ok(()) };
    match fit_use::growth_shares_outside(case, first) {
        Some([_, above]) if above > fit_use::EXTRAPOLATION_REFUSED => {
            let (at, percent) = (first / MPA_SQRT_M, 100.0 * above);
            let what = match case.loading.spectrum {
                Some(_) => format!("{percent:.0} % of the first growth is by cycles with ΔK above"),
                None => format!("the first ΔK, {at:.2} MPa√m, and with it the whole life, is above"),
            };
            Err(extrapolates(case, &what, ""))
        }
        _ => Ok(()),
    }
}

fn extrapolates(case: &Case, what: &str, more: &str) -> Error {
    let [low, high] = fit_use::fitted_range(case).unwrap_or([f64::NAN; 2]);
    let text = format!("{what} the tested ΔK, {low:.2} to {high:.2} MPa√m: the life there is overestimated");
    let remedy = "fit a law to tests at that ΔK, or set fatigue.allow_extrapolation = true";
    input("fatigue.allow_extrapolation", false, format!("{}: {text}{more}", case.name), remedy)
}

/// ΔK of the initial crack, Pa√m, where a handbook has it and it only rises from there.
pub fn first_delta_k(case: &Case) -> Option<f64> {
    let formula = handbook(&case.specimen).filter(|_| case.loading.control == LoadControl::Load)?;
    Some(formula.delta_k(case.specimen.crack_length, case.loading.maximum, case.loading.range_share()))
}
