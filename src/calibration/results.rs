//! Files of a calibration beside `fit.json`: `fitted.toml`, `fit_curves.csv` and `readings.csv` of lives, `fit_rates.csv` of rates,
//! `rates.csv` of both.

use super::case::CalibrationCase;
use super::fit::{Bonds, Fit};
use super::laws::LawFits;
use super::laws::case::LawCase;
use super::rates::{self, Flags, RateMethod, RatePoint, add_delta_k, rates};
use super::search::FittedCurve;
use perilife_base::columns::Table;
use perilife_base::units::{GPA, MM, MM_PER_CYCLE, MPA_SQRT_M};
use perilife_growth::case::record::{CurveRecord, FittedLaw, FittedRecord, LawRecord};
use perilife_measured::{LeaveOut, MeasuredCurve};

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

pub fn left_out(calibration: &CalibrationCase, fit: &Fit) -> Vec<LeaveOut> {
    [&calibration.left_out[..], &fit.left_out].concat()
}

/// `fit_curves.csv`: each reading of each specimen with the cycles of its own fit, and after them, for several specimens,
/// their median with the record's fit.
pub fn fit_curves(fit: &Fit) -> Table {
    let of = |values: fn(&FittedCurve) -> &Vec<f64>| curves_written(fit).flat_map(values).copied();
    let names = curves_written(fit).flat_map(|curve| std::iter::repeat_n(&curve.name, curve.crack_length.len()));
    Table::new("fit_curves.csv")
        .foreign("specimen", names)
        .numbers("crack_length_mm", of(|curve| &curve.crack_length).map(|length| tidy(length / MM)))
        .exact("cycles_measured", of(|curve| &curve.cycles_measured))
        .exact("cycles_fitted", of(|curve| &curve.cycles_fitted))
}

/// `rates.csv` of a fit to readings: growth over every interval that it took in and ΔK in its middle, as a table of rates that a law over K
/// can be fitted to. None of them is left out for a short step, which the fit did not do either.
pub fn fitted_rates(calibration: &CalibrationCase, fit: &Fit) -> Table {
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
pub fn rates_taken(case: &LawCase) -> Table {
    let points: Vec<RatePoint> = case.rows.iter().map(|row| RatePoint::of_rate(row.delta_k, row.rate, row.ratio)).collect();
    rates::table(case.rows.iter().map(|row| &*row.series).zip(&points))
}

/// The curves of `fit_curves`: the specimens, then the record's median where it is not one of them.
pub fn curves_written(fit: &Fit) -> impl Iterator<Item = &FittedCurve> {
    fit.specimens.iter().chain((fit.specimens.len() > 1).then_some(&fit.record))
}

/// Twelve significant digits: hides the last bits that unit conversion leaves, so that 3.015 mm reads as 3.015.
pub(super) fn tidy(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
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
pub fn rates_beside_law(case: &LawCase, fits: &LawFits) -> Table {
    let rows = || case.rows.iter().zip(&fits.law().residuals);
    Table::new("fit_rates.csv")
        .foreign("series", rows().map(|(row, _)| &row.series))
        .measured("stress_ratio", rows().map(|(row, _)| Some(row.ratio)))
        .measured("delta_k_mpa_sqrt_m", rows().map(|(row, _)| Some(row.delta_k / MPA_SQRT_M)))
        .measured("da_dn_mm_per_cycle", rows().map(|(row, _)| Some(row.rate / MM_PER_CYCLE)))
        .measured("da_dn_fitted_mm_per_cycle", rows().map(|(row, residual)| Some(row.rate / MM_PER_CYCLE * (-residual).exp())))
}
