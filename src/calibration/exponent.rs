//! `[fit]` of a calibration file, and where the exponent comes from: fitted, given, or of a record because the window does not identify it.

use super::criterion::Criterion;
use super::laws::FitLaw;
use perilife_base::error::{Result, fail_if, input, input_missing};
use perilife_base::input::Folder;
use perilife_base::keys::key;
use perilife_growth::case::{Method, fitted_record};
use perilife_measured::MeasuredCurve;

/// Below this ratio of the largest to the smallest ΔK a curve does not say what p is.
pub const DELTA_K_RATIO_MIN: f64 = 2.0;

perilife_base::kinds! {
    pub enum Parameter for "fit.parameters" {
        A = "a": "the constant A",
        P = "p": "the exponent p",
    }
}

perilife_base::keys! {
    pub struct FitKeys {
        parameters: Vec<Parameter> = key("parameters", "Fitted constants"), or "a, p" vec![Parameter::A, Parameter::P];
        p: Option<f64> = key("p", "Exponent p: given, not fitted");
        record: Option<String> = key("record", "Record of the exponent: fitted.toml of another calibration");
        criterion: Criterion = key("criterion", "Criterion: lives to be fitted"), or "both_ends" Criterion::BothEnds;
        law: Option<FitLaw> = key("law", "Growth law to fit: default paris");
    }
}

/// The exponent of `[fit]` for a window with this ratio of the largest to the smallest ΔK; `None` where a run has to tell it.
pub(super) fn exponent(fit: &FitKeys, folder: &Folder, method: Method, delta_k_ratio: Option<f64>) -> Result<Exponent> {
    let parameters = &fit.parameters;
    let names: Vec<String> = parameters.iter().map(|parameter| format!("\"{parameter}\"")).collect();
    let remedy = "write parameters = [\"a\", \"p\"], or [\"a\"] with p = ...";
    let problem = "does not contain a, which is always fitted";
    fail_if!(!parameters.contains(&Parameter::A), input("fit.parameters", format!("[{}]", names.join(", ")), problem, remedy));
    match (parameters.contains(&Parameter::P), fit.p, fit.record.as_deref()) {
        (_, Some(p), Some(_)) => Err(input("fit.p", p, "conflicts with record", "give p or record")),
        (true, Some(p), None) => Err(input("fit.p", p, "is both given and fitted", "remove p, or write parameters = [\"a\"]")),
        (true, None, None) => Ok(Exponent::default()),
        (true, None, Some(file)) => match delta_k_ratio {
            Some(ratio) => Exponent::record_if_needed(file, folder, method, ratio),
            None => {
                let problem = "replaces p if ΔK varies too little, which is known only after a run";
                let remedy = "remove it, or use its p by parameters = [\"a\"]";
                Err(input("fit.record", format!("\"{file}\""), problem, remedy))
            }
        },
        (false, Some(p), None) => Ok(Exponent { fixed: Some(p), source: "given".to_owned(), ..Exponent::default() }),
        (false, None, Some(file)) => Exponent::of_record(file, folder, method),
        (false, None, None) => {
            let remedy = "give the exponent p, or record = \"fitted.toml\", or fit it too: parameters = [\"a\", \"p\"]";
            Err(input_missing("fit.p", "is missing", remedy))
        }
    }
}

/// Largest over smallest ΔK of all readings.
pub(super) fn delta_k_ratio(curves: &[MeasuredCurve], k_i: &dyn Fn(f64) -> f64) -> f64 {
    let of_curve = |curve: &MeasuredCurve| -> Vec<f64> {
        let factor = |i: usize| curve.load_factor.get(i).copied().unwrap_or(1.0);
        curve.crack_length.iter().enumerate().map(|(i, &length)| k_i(length) * factor(i)).collect()
    };
    let all = curves.iter().flat_map(of_curve);
    let (low, high) = all.fold((f64::INFINITY, 0.0_f64), |(low, high), k| (low.min(k), high.max(k)));
    high / low
}

/// The exponent of a calibration before its fit.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Exponent {
    /// Its value; `None` where it is fitted.
    pub fixed: Option<f64>,
    /// Standard error of a value from a record, else 0.
    pub error: f64,
    /// `given`, or the file of the record; empty where it is fitted.
    source: String,
    pub warning: Option<String>,
}

impl Exponent {
    /// Where it comes from over a window with this ratio of ΔK, which on a drawn plate only a fit shows: `fitted`, `not_identified`, `given`
    /// or the file of a record.
    pub fn source_over(&self, delta_k_ratio: f64) -> &str {
        match self.fixed {
            Some(_) => &self.source,
            None if delta_k_ratio < DELTA_K_RATIO_MIN => "not_identified",
            None => "fitted",
        }
    }

    /// Of a record: p, or m for hand calculation.
    pub fn of_record(file: &str, folder: &Folder, method: Method) -> Result<Self> {
        let record = fitted_record(file, folder)?;
        let is_of_bonds = method == Method::Peridynamics;
        let (p, error) = if is_of_bonds { (record.p, record.p_error) } else { (record.paris_m, record.paris_m_error) };
        Ok(Exponent { fixed: Some(p), error, source: file.to_owned(), warning: None })
    }

    /// The exponent of a record where the window does not identify it, else the fitted one.
    fn record_if_needed(file: &str, folder: &Folder, method: Method, delta_k_ratio: f64) -> Result<Self> {
        let of_record = Self::of_record(file, folder, method)?;
        if delta_k_ratio >= DELTA_K_RATIO_MIN {
            let warning = format!("exponent: ΔK varies by a factor of {delta_k_ratio:.2}, enough to fit p; {file} not used");
            return Ok(Exponent { warning: Some(warning), ..Self::default() });
        }
        let (p, error) = (of_record.fixed.unwrap_or(f64::NAN), of_record.error);
        let few = format!("ΔK varies only by a factor of {delta_k_ratio:.2} (need {DELTA_K_RATIO_MIN})");
        let warning = format!("exponent: {few}: p = {p:.4} ± {error:.4} taken from {file}");
        Ok(Exponent { warning: Some(warning), ..of_record })
    }
}
