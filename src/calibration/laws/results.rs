//! A fit of laws as it is written: `fit.json`, `fitted.toml`, `fit_rates.csv`, and in words.

use std::fmt::Write as _;

use serde_json::{Map, Value, json};

use super::case::LawCase;
use super::fit::LawFit;
use super::{FitLaw, LawFits};
use crate::case::record::LawRecord;
use crate::cells::field;
use crate::units::{MM_PER_CYCLE, MPA_SQRT_M};

/// Content of `fit.json`.
pub fn report(case: &LawCase, fits: &LawFits, wall_s: f64) -> Value {
    let best = fits.candidates.iter().filter(|law| law.left_out.is_none()).map(|law| law.aicc).fold(f64::INFINITY, f64::min);
    let candidate = |law: &LawFit| {
        let is_fitted = !law.constants.is_empty();
        json!({
            "law": law.kind.name(),
            "constants": values(law),
            "standard_errors": errors(law),
            "fitted_constants": law.fitted,
            "rms_log_rate": is_fitted.then(|| law.rms()),
            "aicc": finite(law.aicc),
            "delta_aicc": finite(law.aicc - best),
            "left_out": law.left_out,
        })
    };
    let [low, high] = case.delta_k_range();
    let ratios = case.ratios();
    json!({
        "law": fits.law().kind.name(),
        "law_asked_for": case.law.name(),
        "aicc_margin": fits.margin.map(|(_, margin)| margin),
        "next_best": fits.margin.map(|(kind, _)| kind.name()),
        "constants": values(fits.law()),
        "standard_errors": errors(fits.law()),
        "rms_log_rate": fits.law().rms(),
        "rates": case.rows.len(),
        "effective_rates": fits.effective_rates,
        "stress_ratios": ratios,
        "delta_k_min_mpa_sqrt_m": low,
        "delta_k_max_mpa_sqrt_m": high,
        "candidates": fits.candidates.iter().map(candidate).collect::<Vec<_>>(),
        "material": case.material,
        "wall_s": wall_s,
        "warnings": case.warnings.iter().chain(&fits.warnings).collect::<Vec<_>>(),
        "version": env!("CARGO_PKG_VERSION"),
        "sources": case.sources,
    })
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

fn values(law: &LawFit) -> Map<String, Value> {
    law.constants.iter().map(|constant| (constant.key.to_owned(), json!(constant.value))).collect()
}

fn errors(law: &LawFit) -> Map<String, Value> {
    law.constants.iter().filter_map(|constant| Some((constant.key.to_owned(), json!(constant.error?)))).collect()
}

/// The record that predictions read.
pub fn record(case: &LawCase, fits: &LawFits) -> LawRecord {
    let law = fits.law();
    let mut fatigue = toml::Table::new();
    fatigue.insert("growth_law".to_owned(), law.kind.name().into());
    fatigue.extend(law.constants.iter().map(|constant| (constant.key.to_owned(), constant.value.into())));
    let [low, high] = case.delta_k_range();
    let ratios = || case.rows.iter().map(|row| row.ratio);
    LawRecord {
        material: case.material.clone(),
        delta_k_min_mpa_sqrt_m: low,
        delta_k_max_mpa_sqrt_m: high,
        stress_ratio_min: ratios().fold(f64::INFINITY, f64::min),
        stress_ratio_max: ratios().fold(f64::NEG_INFINITY, f64::max),
        rates: case.rows.len(),
        rms_log_rate: law.rms(),
        aicc_margin: fits.margin.map(|(_, margin)| margin),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        fatigue,
        errors: law.constants.iter().filter_map(|constant| Some((constant.key.to_owned(), constant.error?))).collect(),
        sources: case.sources.clone(),
    }
}

/// `fit_rates.csv`: every rate beside that of the law.
pub fn rates_csv(case: &LawCase, fits: &LawFits) -> String {
    let mut text = String::from("series,stress_ratio,delta_k_mpa_sqrt_m,da_dn_mm_per_cycle,da_dn_fitted_mm_per_cycle\n");
    for (row, residual) in case.rows.iter().zip(&fits.law().residuals) {
        let (k, rate) = (row.delta_k / MPA_SQRT_M, row.rate / MM_PER_CYCLE);
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{},{},{k:.10e},{rate:.10e},{:.10e}", field(&row.series), row.ratio, rate * (-residual).exp());
    }
    text
}

/// The fit in words, the chosen law first.
pub fn summary(case: &LawCase, fits: &LawFits) -> Vec<String> {
    let law = fits.law();
    let [low, high] = case.delta_k_range();
    let ratios = case.ratios().iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
    let mut lines = vec![format!("fit of laws to {} rates at R = {ratios}, ΔK {low:.3} to {high:.3} MPa√m", case.rows.len())];
    let asked = if case.law == FitLaw::Best { "best by AICc" } else { "as asked for" };
    let margin = match fits.margin {
        Some((next, margin)) if margin >= 0.0 => format!(", {margin:.1} better than {next}{}", strength(margin)),
        Some((next, margin)) => format!(", {:.1} worse than {next}", -margin),
        None => ", no other law is left".to_owned(),
    };
    lines.push(format!("  law            {} ({asked}{margin})", law.kind));
    lines.extend(law.constants.iter().map(|constant| {
        let error = constant.error.map_or_else(|| "(given)".to_owned(), |error| format!("± {}", figure(error, 2)));
        format!("    {:<28} {} {error}", constant.key, figure(constant.value, 5))
    }));
    lines.push("  ±              one standard error".to_owned());
    let best = fits.candidates.iter().filter(|law| law.left_out.is_none()).map(|law| law.aicc).fold(f64::INFINITY, f64::min);
    for candidate in &fits.candidates {
        lines.push(match &candidate.left_out {
            Some(why) => format!("  {:<14} left out: {why}", candidate.kind.name()),
            None => format!(
                "  {:<14} rms {:.3} of ln da/dN, {} constants, delta AICc {:.1}",
                candidate.kind.name(),
                candidate.rms(),
                candidate.fitted,
                candidate.aicc - best
            ),
        });
    }
    lines
}

/// What a difference of the criterion is worth (Burnham and Anderson 2002).
fn strength(margin: f64) -> &'static str {
    match margin {
        margin if margin < 2.0 => ": hardly a difference",
        margin if margin > 10.0 => "",
        _ => ": some evidence",
    }
}

/// A number with some significant digits.
fn figure(value: f64, digits: usize) -> String {
    if value != 0.0 && !(1e-3..1e4).contains(&value.abs()) {
        return format!("{value:.*e}", digits - 1);
    }
    let before = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    format!("{value:.*}", (digits as i32 - 1 - before).max(0) as usize)
}
