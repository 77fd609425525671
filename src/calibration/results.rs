//! Results of a calibration as they are written: `fit.json`, `fitted.toml`, `fit_curves.csv` of lives, `fit_rates.csv` of rates,
//! `rates.csv` of both, and in words.

use std::fmt::Write as _;

use serde_json::{Map, Value, json};

use super::case::CalibrationCase;
use super::fit::{Bonds, Fit};
use super::laws::case::LawCase;
use super::laws::fit::LawFit;
use super::laws::{FitLaw, LawFits};
use super::rates::{self, Flags, RateMethod, RatePoint, add_delta_k, rates};
use super::search::FittedCurve;
use perilife_base::cells::field;
use perilife_base::units::{GPA, MM, MM_PER_CYCLE, MPA_SQRT_M};
use perilife_growth::case::record::{CurveRecord, FittedLaw, FittedRecord, LawRecord};
use perilife_measured::{LeaveOut, MeasuredCurve};

/// `fit.json` of a fit that took `wall_s` seconds; units as in the names, cycles else, null for what is not known.
pub fn report(calibration: &CalibrationCase, fit: &Fit, wall_s: f64) -> Value {
    let law = record(calibration, fit);
    let [from, to] = window_mm(fit);
    let specimen = |curve: &FittedCurve| {
        json!({
            "name": curve.name,
            "a": curve.constants.a,
            "p": curve.constants.p,
            "life_measured": curve.life_measured(),
            "life_fitted": curve.life_fitted(),
            "rms_life_error": curve.rms_life_error(),
        })
    };
    json!({
        "a": law.a,
        "p": law.p,
        "horizon_mm": law.horizon_mm,
        "spacing_mm": law.spacing_mm,
        "paris_c_mm_per_cycle": law.paris_c_mm_per_cycle,
        "paris_m": law.paris_m,
        "paris_m_error": law.paris_m_error,
        "pivot_delta_k_mpa_sqrt_m": law.pivot_delta_k_mpa_sqrt_m,
        "rate_at_pivot_mm_per_cycle": law.rate_at_pivot_mm_per_cycle,
        "rate_at_pivot_relative_error": law.rate_at_pivot_relative_error,
        "p_error": law.p_error,
        "p_source": p_source(calibration, fit),
        "criterion": calibration.criterion.name(),
        "covariance": fit.confidence.covariance,
        "increment_scatter": fit.confidence.increment_scatter,
        "rms_life_error": fit.record.rms_life_error(),
        "life_measured": fit.record.life_measured(),
        "life_fitted": fit.record.life_fitted(),
        "fitted_to": fit.record.name,
        "from_crack_length_mm": from,
        "to_crack_length_mm": to,
        "delta_k_min_mpa_sqrt_m": law.delta_k_min_mpa_sqrt_m,
        "delta_k_max_mpa_sqrt_m": law.delta_k_max_mpa_sqrt_m,
        "specimens": fit.specimens.iter().map(specimen).collect::<Vec<_>>(),
        "law": law.law,
        "curve": law.curve,
        "misfit_at_ends": fit.misfit_at_ends,
        "power_law_misfit_at_ends": fit.power_law_misfit,
        "population": fit.population,
        "left_out": law.left_out,
        "evaluations": fit.own_path.as_ref().map_or(1, |path| path.runs),
        "wall_s": wall_s,
        "warnings": calibration.warnings.iter().chain(&fit.warnings).collect::<Vec<_>>(),
        "version": law.version,
        "sources": law.sources,
    })
}

/// Where p comes from: `fitted`, `given`, `not_identified`, or the file of a record.
fn p_source<'c>(calibration: &'c CalibrationCase, fit: &Fit) -> &'c str {
    calibration.exponent.source_over(fit.paris.delta_k_max / fit.paris.delta_k_min)
}

/// Ends of the fit window, mm.
fn window_mm(fit: &Fit) -> [f64; 2] {
    let lengths = || fit.record.crack_length.iter().copied();
    [lengths().fold(f64::INFINITY, f64::min), lengths().fold(0.0, f64::max)].map(|length| tidy(length / MM))
}

/// The record that predictions read.
pub fn record(calibration: &CalibrationCase, fit: &Fit) -> FittedRecord {
    let case = &calibration.case;
    // Without bonds there is no A.
    let of_bonds = |value: fn(&Bonds) -> f64| fit.bonds.as_ref().map_or(f64::NAN, |bonds| tidy(value(bonds)));
    FittedRecord {
        method: case.model.method().name().to_owned(),
        a: fit.bonds.map_or(f64::NAN, |_| fit.record.constants.a),
        p: fit.record.constants.p,
        horizon_mm: of_bonds(|bonds| bonds.horizon / MM),
        spacing_mm: of_bonds(|bonds| bonds.spacing / MM),
        horizon_ratio: case.points().horizon_ratio,
        scaling: "a at another horizon = a * (horizon / horizon_mm)^((p - 2) / 2)".to_owned(),
        rate_constant: fit.bonds.map(|bonds| bonds.rate_constant),
        paris_c_mm_per_cycle: fit.paris.c,
        paris_m: fit.paris.m,
        paris_m_error: fit.paris.m_error.max(calibration.exponent.error),
        pivot_delta_k_mpa_sqrt_m: fit.paris.pivot,
        rate_at_pivot_mm_per_cycle: fit.paris.rate_at_pivot,
        rate_at_pivot_relative_error: fit.paris.rate_at_pivot_error,
        p_error: fit.p_error().max(calibration.exponent.error),
        delta_k_min_mpa_sqrt_m: fit.paris.delta_k_min,
        delta_k_max_mpa_sqrt_m: fit.paris.delta_k_max,
        lack_of_fit_percent: fit.misfit_at_ends.largest(),
        stress_ratio: case.loading.ratio,
        bond_law: case.points().bond_law.kind.name().to_owned(),
        kernel: case.points().bond_law.kernel.name().to_owned(),
        rotation: case.points().bond_law.rotation.name().to_owned(),
        surface_correction: case.points().bond_law.surface_correction.name().to_owned(),
        ageing: case.fatigue.ageing.name().to_owned(),
        zone_radius_horizons: case.fatigue.zone_radius_horizons,
        youngs_modulus_gpa: tidy(case.material.youngs_modulus / GPA),
        poisson_ratio: case.material.poisson_ratio,
        plane: case.material.plane.name().to_owned(),
        thickness_mm: tidy(case.specimen.thickness / MM),
        material: case.material.name.clone(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        sources: calibration.sources.clone(),
        law: if fit.curve.is_some() { FittedLaw::Curve } else { FittedLaw::Paris },
        curve: fit
            .curve
            .as_ref()
            .zip(fit.population.as_ref())
            .map(|(law, lot)| CurveRecord::of(law, lot.gain.unwrap_or(f64::NAN), &|k| lot.errors_at(k))),
        left_out: left_out(calibration, fit),
        population: fit.population.as_ref().and_then(|population| toml::Table::try_from(population).ok()),
    }
}

/// What the user left out, and the program.
pub fn left_out(calibration: &CalibrationCase, fit: &Fit) -> Vec<LeaveOut> {
    [&calibration.left_out[..], &fit.left_out].concat()
}

/// The curve in words, a row for every knot.
fn curve_words(curve: &CurveRecord, fit: &Fit) -> Vec<String> {
    let misses = fit.power_law_misfit.map_or_else(String::new, |misfit| format!("; the power law misses it: {}", misfit.words()));
    let specimens = fit.specimens.len();
    let head = format!("  law            curve (gain {:.1} over a power law, {specimens} specimens{misses})", curve.gain);
    let row = |i: usize| {
        format!(
            "    ΔK {:>7.3}   da/dN {:.3e} ± {:.1} %   m {:.2} ± {:.2}",
            curve.delta_k_mpa_sqrt_m[i],
            curve.da_dn_mm_per_cycle[i],
            100.0 * curve.da_dn_relative_error[i],
            curve.m[i],
            curve.m_error[i]
        )
    };
    std::iter::once(head).chain((0..curve.m.len()).map(row)).collect()
}

/// A fit in words: rate at the pivot and exponent with their errors, never A alone.
pub fn summary(calibration: &CalibrationCase, fit: &Fit, wall_s: f64) -> Vec<String> {
    let law = record(calibration, fit);
    let [from, to] = window_mm(fit);
    let life = 100.0 * (fit.record.life_fitted() / fit.record.life_measured() - 1.0);
    let source = match p_source(calibration, fit) {
        "fitted" => String::new(),
        "not_identified" => " (not identified)".to_owned(),
        "given" => " (given)".to_owned(),
        file => format!(" (from {file})"),
    };
    let error = |error: f64| if error > 0.0 { format!(" ± {error:.4}") } else { String::new() };
    let mut lines = vec![format!("fit to {}, {from} to {to} mm", fit.record.name)];
    // Hand calculation has no bonds: its p is m.
    if fit.bonds.is_some() {
        lines.push(format!("  A              {:.6e} at horizon {} mm", law.a, law.horizon_mm));
        lines.push(format!("  p              {:.4}{}{source}", law.p, error(law.p_error)));
    }
    lines.extend([
        format!(
            "  rate           {:.4e} mm/cycle ± {:.2} % at the pivot ΔK = {:.3} MPa√m",
            law.rate_at_pivot_mm_per_cycle,
            100.0 * law.rate_at_pivot_relative_error,
            law.pivot_delta_k_mpa_sqrt_m
        ),
        format!(
            "  power law      da/dN = {:.4e} ΔK^{:.4} (mm/cycle, MPa√m), the best one by lives",
            law.paris_c_mm_per_cycle, law.paris_m
        ),
        format!("  m              {:.4}{}{source}", law.paris_m, error(law.paris_m_error)),
        "  ±              one standard error".to_owned(),
        format!("  calibrated ΔK  {:.3} to {:.3} MPa√m", law.delta_k_min_mpa_sqrt_m, law.delta_k_max_mpa_sqrt_m),
        format!(
            "  life           measured {:.0}, fitted {:.0} cycles ({life:+.2} %), rms life error {:.2} %",
            fit.record.life_measured(),
            fit.record.life_fitted(),
            100.0 * fit.record.rms_life_error()
        ),
    ]);
    match (&law.curve, fit.population.as_ref().and_then(|population| population.gain)) {
        (Some(curve), _) => lines.extend(curve_words(curve, fit)),
        (None, Some(gain)) => lines.push(format!("  law            Paris: no curve is better (gain {gain:.1})")),
        (None, None) => lines.push("  law            Paris".to_owned()),
    }
    lines.push(format!("  misfit at ends {}", fit.misfit_at_ends.words()));
    lines.extend(law.left_out.iter().map(|one| format!("  left out       {} ({})", one.place(), one.reason)));
    lines.push(format!("  specimens      {}, in {wall_s:.1} s", fit.specimens.len()));
    lines
}

/// `fit_curves.csv`: each reading of each specimen with the cycles of its own fit, and after them, for several specimens,
/// their median with the record's fit.
pub fn fit_curves_csv(fit: &Fit) -> String {
    let mut text = String::from("specimen,crack_length_mm,cycles_measured,cycles_fitted\n");
    for curve in curves_written(fit) {
        for ((length, measured), fitted) in curve.crack_length.iter().zip(&curve.cycles_measured).zip(&curve.cycles_fitted) {
            // Writing to a String cannot fail. `Display` of f64 keeps all digits.
            let _ = writeln!(text, "{},{},{measured},{fitted}", field(&curve.name), tidy(length / MM));
        }
    }
    text
}

/// `rates.csv` of a fit to readings: growth over every interval that it took in and ΔK in its middle, as a table of rates that a law over K
/// can be fitted to. None of them is left out for a short step, which the fit did not do either.
pub fn fitted_rates_csv(calibration: &CalibrationCase, fit: &Fit) -> String {
    let specimen = |curve: &MeasuredCurve| {
        let mut points = rates(curve, RateMethod::Secant);
        add_delta_k(&mut points, &calibration.case, &|length| fit.delta_k(calibration, length));
        for point in &mut points {
            point.flags = Flags { not_growing: point.flags.not_growing, ..Flags::default() };
        }
        (curve.specimen.clone(), points)
    };
    let specimens: Vec<(String, Vec<RatePoint>)> = calibration.curves.iter().map(specimen).collect();
    rates::table(specimens.iter().flat_map(|(name, points)| points.iter().map(move |point| (&**name, point))))
}

/// `rates.csv` of a fit to rates.
pub fn rates_taken_csv(case: &LawCase) -> String {
    let points: Vec<RatePoint> = case.rows.iter().map(|row| RatePoint::of_rate(row.delta_k, row.rate, row.ratio)).collect();
    rates::table(case.rows.iter().map(|row| &*row.series).zip(&points))
}

/// The curves of `fit_curves`: the specimens, then the record's median where it is not one of them.
pub fn curves_written(fit: &Fit) -> impl Iterator<Item = &FittedCurve> {
    fit.specimens.iter().chain((fit.specimens.len() > 1).then_some(&fit.record))
}

/// Twelve significant digits: hides the last bits that unit conversion leaves, so that 3.015 mm reads as 3.015.
fn tidy(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

/// `fit.json` of laws over K; null for what a law without a fit does not have.
pub fn law_report(case: &LawCase, fits: &LawFits, wall_s: f64) -> Value {
    let candidate = |law: &LawFit| {
        json!({
            "law": law.kind.name(),
            "constants": values(law),
            "standard_errors": errors(law),
            "fitted_constants": law.fitted,
            "rms_log_rate": law.rms(),
            "aicc": law.aicc,
            "delta_aicc": law.aicc - fits.least_aicc(),
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

fn values(law: &LawFit) -> Map<String, Value> {
    law.known_constants().map(|constant| (constant.key.to_owned(), json!(constant.value))).collect()
}

fn errors(law: &LawFit) -> Map<String, Value> {
    law.constants.iter().filter_map(|constant| Some((constant.key.to_owned(), json!(constant.error?)))).collect()
}

/// The record of a law over K that predictions read.
pub fn law_record(case: &LawCase, fits: &LawFits) -> LawRecord {
    let law = fits.law();
    let mut fatigue = toml::Table::new();
    fatigue.insert("growth_law".to_owned(), law.kind.name().into());
    fatigue.extend(law.known_constants().map(|constant| (constant.key.to_owned(), constant.value.into())));
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

/// A fit of laws in words, the chosen one first.
pub fn law_summary(case: &LawCase, fits: &LawFits) -> Vec<String> {
    let law = fits.law();
    let [low, high] = case.delta_k_range();
    let ratios = case.ratios().iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
    let mut lines = vec![format!("fit of laws to {} rates at R = {ratios}, ΔK {low:.3} to {high:.3} MPa√m", case.rows.len())];
    let asked = match (case.law, fits.margin) {
        (FitLaw(None), Some((_, margin))) if margin < 0.0 => "best by its residuals, less than half of the others",
        (FitLaw(None), _) => "best by AICc",
        _ => "as asked for",
    };
    let margin = match fits.margin {
        Some((next, margin)) if margin >= 0.0 => format!(", {margin:.1} better than {next}{}", strength(margin)),
        Some((next, margin)) => format!(", {:.1} worse than {next}", -margin),
        None => ", no other law is left".to_owned(),
    };
    lines.push(format!("  law            {} ({asked}{margin})", law.kind));
    lines.extend(law.known_constants().map(|constant| {
        let error = constant.error.map_or_else(|| "(given)".to_owned(), |error| format!("± {}", figure(error, 2)));
        format!("    {:<28} {} {error}", constant.key, figure(constant.value, 5))
    }));
    lines.push("  ±              one standard error".to_owned());
    lines.extend(case.units.iter().map(|line| format!("  read           {line}")));
    lines.extend(case.range.map(|range| format!("  ΔK at R < 0    taken as {range} from the tables: {}", range.meaning())));
    for candidate in &fits.candidates {
        lines.push(match &candidate.left_out {
            Some(why) => format!("  {:<14} left out: {why}", candidate.kind.name()),
            None => format!(
                "  {:<14} rms {:.3} of ln da/dN, {} constants, delta AICc {:.1}",
                candidate.kind.name(),
                candidate.rms(),
                candidate.fitted,
                candidate.aicc - fits.least_aicc()
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
