//! Errors of K and of lives against what does not come from the method.

use super::Run;
use crate::case::{Case, Method};
use crate::error::{Error, Result};
use crate::growth::element_free;
use crate::growth::record::TipRecord;
use crate::growth::tip_field::initial_tips;
use crate::specimen::handbook::handbook_tada;
use crate::units::MM;
use crate::verify::scene::{MATERIAL_AND_LAW, PULL};
use crate::verify::standard::Standard;

/// Keys of a middle tension panel twice as long as wide, mm.
pub fn middle_tension(width: f64, half_crack: f64, spacing: f64) -> String {
    format!(
        "[specimen]\nkind = \"middle_tension\"\nwidth_mm = {width}\nlength_mm = {}\nthickness_mm = 2\ncrack_length_mm = \
         {half_crack}\n{PULL}[model]\nspacing_mm = {spacing}\n{MATERIAL_AND_LAW}",
        2.0 * width
    )
}

/// K and T of the initial tips by the method of a case.
pub fn tips(case: &Case) -> Result<Vec<TipRecord>> {
    match case.model.method {
        Method::ElementFreeGalerkin => element_free::initial_tips(case),
        Method::Peridynamics | Method::Handbook => Ok(initial_tips(case)?.tips),
    }
}

/// K_I and K_II of one of the initial tips, Pa√m.
///
/// # Errors
/// As [`tips`]; a tip at which nothing was read.
pub fn factors(case: &Case, tip: usize) -> Result<[f64; 2]> {
    let found = tips(case)?.get(tip).and_then(|tip| tip.factors);
    found.ok_or_else(|| Error::Mechanics(format!("tip {tip} has no K")))
}

/// Error of K_I of a standard specimen against the handbook (Tada where it has two formulas), percent.
pub fn against_handbook(case: &Case) -> Result<f64> {
    let formula = handbook_tada(&case.specimen).ok_or_else(|| Error::Mechanics("no handbook formula".to_owned()))?;
    let exact = formula.k_i(case.specimen.crack_length, case.loading.maximum);
    Ok(percent(factors(case, 0)?[0], exact))
}

/// Error of K_I of a tip against that of the same plate on fine nodes without elements (0.3 % of K), which share nothing with points
/// and bonds, percent. `keys` are the overrides of the case that is judged.
pub fn against_nodes(run: &Run, text: &str, keys: &[&str], tip: usize) -> Result<f64> {
    let nodes = run.case(text, &["model.method=element_free_galerkin", "model.tolerance_percent=1"])?;
    let exact = factors(&nodes, tip)?[0];
    Ok(percent(factors(&run.case(text, keys)?, tip)?[0], exact))
}

/// Error of a life against quadrature with K of finite elements, percent.
pub fn life_error(run: &Run, specimen: &Standard, set: &[&str]) -> Result<f64> {
    Ok(percent(specimen.over_quadrature_watched(set, run)?, 1.0))
}

/// Error in percent of the truth.
pub fn percent(computed: f64, truth: f64) -> f64 {
    100.0 * (computed / truth - 1.0)
}

/// A length in millimetres for a key.
pub fn mm(metres: f64) -> f64 {
    metres / MM
}
