//! Results of a calibration as they are written: `fit.json`, `fitted.toml`, `fit_curves.csv`.

use std::fmt::Write as _;

use serde::Serialize;

use crate::calibration::case::CalibrationCase;
use crate::calibration::fit::{Fit, FittedCurve};
use crate::calibration::lack_of_fit::LackOfFit;
use crate::case::Method;
use crate::case::record::{FittedRecord, LeaveOut, SourceFile};
use crate::cells::field;
use crate::units::{GPA, MM};

/// Content of `fit.json`; units as in the names, cycles else.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FitReport {
    /// A at `horizon_mm`, 1/cycle; null for hand calculation.
    pub a: f64,
    /// Exponent p.
    pub p: f64,
    /// Horizon that A belongs to.
    pub horizon_mm: f64,
    /// Lattice spacing of the fit.
    pub spacing_mm: f64,
    /// C of da/dN = C ΔK^m in mm/cycle and MPa√m.
    pub paris_c_mm_per_cycle: f64,
    /// m of the same (not p).
    pub paris_m: f64,
    /// Standard error of m; 0 where p was given.
    pub paris_m_error: f64,
    /// ΔK at which the rate is best determined.
    pub pivot_delta_k_mpa_sqrt_m: f64,
    /// da/dN there.
    pub rate_at_pivot_mm_per_cycle: f64,
    /// Relative standard error of that rate.
    pub rate_at_pivot_relative_error: f64,
    /// Standard error of p; 0 where p was given.
    pub p_error: f64,
    /// Where p comes from: `fitted`, `given`, `not_identified`, or the file of a record.
    pub p_source: String,
    /// Which lives were counted: `fit.criterion`.
    pub criterion: String,
    /// Covariance of (ln A, p).
    pub covariance: [[f64; 2]; 2],
    /// Relative scatter of the cycles between readings about the fit.
    pub increment_scatter: f64,
    /// Rms life error of the record's curve.
    pub rms_life_error: f64,
    /// Life of the record's curve, measured.
    pub life_measured: f64,
    /// Life of the record's curve, fitted.
    pub life_fitted: f64,
    /// What the record was fitted to: the name of the only specimen, or `median`.
    pub fitted_to: String,
    /// Ends of the fit window.
    pub from_crack_length_mm: f64,
    /// See `from_crack_length_mm`.
    pub to_crack_length_mm: f64,
    /// Smallest ΔK of the fit window.
    pub delta_k_min_mpa_sqrt_m: f64,
    /// Largest ΔK of the fit window.
    pub delta_k_max_mpa_sqrt_m: f64,
    /// Each specimen with its own fit.
    pub specimens: Vec<SpecimenReport>,
    /// Which estimate of C and m is written: `least_squares` or `robust`.
    pub estimate: String,
    /// m by the repeated median of rates; null where p was given or there are too few.
    pub robust_paris_m: f64,
    /// C of the same.
    pub robust_paris_c_mm_per_cycle: f64,
    /// By how much the law misses measured rates at both ends of its range; null for fewer than six rates.
    pub lack_of_fit: Option<LackOfFit>,
    /// Readings that were left out.
    pub left_out: Vec<LeaveOut>,
    /// How often K(a) was computed: once, whatever is fitted to it; again where several tips share the growth by an exponent that is not
    /// known before.
    pub evaluations: usize,
    /// Wall time.
    pub wall_s: f64,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Program version.
    pub version: String,
    /// Measured files with their hashes.
    pub sources: Vec<SourceFile>,
}

/// One specimen of `fit.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpecimenReport {
    /// Name.
    pub name: String,
    /// A of its own fit, 1/cycle.
    pub a: f64,
    /// p of its own fit.
    pub p: f64,
    /// Measured cycles from the first to the last reading of the window.
    pub life_measured: f64,
    /// Fitted cycles over the same lengths.
    pub life_fitted: f64,
    /// Rms life error.
    pub rms_life_error: f64,
}

impl FitReport {
    /// The report of a fit that took `wall_s` seconds.
    pub fn new(calibration: &CalibrationCase, fit: &Fit, wall_s: f64) -> Self {
        let lengths = &fit.record.crack_length;
        FitReport {
            a: bond_constant(calibration, fit),
            p: fit.record.constants.p,
            horizon_mm: tidy(fit.horizon / MM),
            spacing_mm: tidy(fit.spacing / MM),
            paris_c_mm_per_cycle: fit.paris.c,
            paris_m: fit.paris.m,
            paris_m_error: fit.paris.m_error.max(calibration.exponent.error),
            pivot_delta_k_mpa_sqrt_m: fit.paris.pivot,
            rate_at_pivot_mm_per_cycle: fit.paris.rate_at_pivot,
            rate_at_pivot_relative_error: fit.paris.rate_at_pivot_error,
            p_error: p_error(calibration, fit),
            p_source: calibration.exponent.source_over(fit.paris.delta_k_max / fit.paris.delta_k_min),
            criterion: calibration.criterion.name().to_owned(),
            covariance: fit.confidence.covariance,
            increment_scatter: fit.confidence.increment_scatter,
            rms_life_error: fit.record.rms_life_error(),
            life_measured: fit.record.life_measured(),
            life_fitted: fit.record.life_fitted(),
            fitted_to: fit.record.name.clone(),
            from_crack_length_mm: tidy(lengths.iter().copied().fold(f64::INFINITY, f64::min) / MM),
            to_crack_length_mm: tidy(lengths.iter().copied().fold(0.0, f64::max) / MM),
            delta_k_min_mpa_sqrt_m: fit.paris.delta_k_min,
            delta_k_max_mpa_sqrt_m: fit.paris.delta_k_max,
            specimens: fit.specimens.iter().map(SpecimenReport::new).collect(),
            estimate: fit.estimate.name().to_owned(),
            robust_paris_m: fit.robust.map_or(f64::NAN, |robust| robust.m),
            robust_paris_c_mm_per_cycle: fit.robust.map_or(f64::NAN, |robust| robust.c),
            lack_of_fit: fit.lack_of_fit,
            left_out: calibration.left_out.clone(),
            evaluations: fit.evaluations,
            wall_s,
            warnings: calibration.warnings.iter().chain(&fit.warnings).cloned().collect(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            sources: calibration.sources.clone(),
        }
    }
}

impl SpecimenReport {
    fn new(curve: &FittedCurve) -> Self {
        SpecimenReport {
            name: curve.name.clone(),
            a: curve.constants.a,
            p: curve.constants.p,
            life_measured: curve.life_measured(),
            life_fitted: curve.life_fitted(),
            rms_life_error: curve.rms_life_error(),
        }
    }
}

/// A of the bonds; NaN for hand calculation, which has none.
fn bond_constant(calibration: &CalibrationCase, fit: &Fit) -> f64 {
    match calibration.case.model.method {
        Method::Peridynamics => fit.record.constants.a,
        Method::Handbook | Method::ElementFreeGalerkin => f64::NAN,
    }
}

/// Standard error of p: of this fit, or of the record it was taken from.
fn p_error(calibration: &CalibrationCase, fit: &Fit) -> f64 {
    fit.p_error().max(calibration.exponent.error)
}

/// The record that predictions read.
pub fn record(calibration: &CalibrationCase, fit: &Fit) -> FittedRecord {
    let case = &calibration.case;
    FittedRecord {
        method: case.model.method.name().to_owned(),
        a: bond_constant(calibration, fit),
        p: fit.record.constants.p,
        horizon_mm: tidy(fit.horizon / MM),
        spacing_mm: tidy(fit.spacing / MM),
        horizon_ratio: case.model.horizon_ratio,
        scaling: "a at another horizon = a * (horizon / horizon_mm)^((p - 2) / 2)".to_owned(),
        rate_constant: fit.rate_constant,
        paris_c_mm_per_cycle: fit.paris.c,
        paris_m: fit.paris.m,
        paris_m_error: fit.paris.m_error.max(calibration.exponent.error),
        pivot_delta_k_mpa_sqrt_m: fit.paris.pivot,
        rate_at_pivot_mm_per_cycle: fit.paris.rate_at_pivot,
        rate_at_pivot_relative_error: fit.paris.rate_at_pivot_error,
        p_error: p_error(calibration, fit),
        delta_k_min_mpa_sqrt_m: fit.paris.delta_k_min,
        delta_k_max_mpa_sqrt_m: fit.paris.delta_k_max,
        stress_ratio: case.loading.ratio,
        bond_law: case.model.bond_law.kind.name().to_owned(),
        kernel: case.model.bond_law.kernel.name().to_owned(),
        rotation: case.model.bond_law.rotation.name().to_owned(),
        surface_correction: case.model.bond_law.surface_correction.name().to_owned(),
        ageing: case.fatigue.ageing.name().to_owned(),
        zone_radius_horizons: case.fatigue.zone_radius_horizons,
        precrack: case.fatigue.precrack.name().to_owned(),
        youngs_modulus_gpa: tidy(case.material.youngs_modulus / GPA),
        poisson_ratio: case.material.poisson_ratio,
        plane: case.material.plane.name().to_owned(),
        thickness_mm: tidy(case.specimen.thickness / MM),
        material: case.material.name.clone(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        sources: calibration.sources.clone(),
        estimate: fit.estimate,
        left_out: calibration.left_out.clone(),
    }
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

/// The curves of `fit_curves`: the specimens, then the record's median where it is not one of them.
pub fn curves_written(fit: &Fit) -> impl Iterator<Item = &FittedCurve> {
    fit.specimens.iter().chain((fit.specimens.len() > 1).then_some(&fit.record))
}

/// Twelve significant digits: hides the last bits that unit conversion leaves, so that 3.015 mm reads as 3.015.
fn tidy(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}
