//! `[fit]` of a calibration file: which constants are fitted, and how.

use serde::Deserialize;

use crate::calibration::criterion::Criterion;
use crate::calibration::exponent::Exponent;
use crate::calibration::laws::FitLaw;
use crate::calibration::measured::MeasuredCurve;
use crate::case::Method;
use crate::error::{Result, input, input_missing};
use crate::input::Folder;

crate::kinds! {
    /// Constants a calibration can fit.
    pub enum Parameter for "fit.parameters" {
        A = "a": "the constant A",
        P = "p": "the exponent p",
    }
}

/// `[fit]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FitSlice {
    pub parameters: Option<Vec<Parameter>>,
    pub p: Option<f64>,
    pub record: Option<String>,
    pub criterion: Option<Criterion>,
    /// Looked at before ([`crate::calibration::laws::case::is_law_fit`]): no other law comes here.
    #[serde(rename = "law")]
    _law: Option<FitLaw>,
}

/// The exponent of `[fit]` for a window with this ratio of the largest to the smallest ΔK; `None` where a run has to tell it.
pub(super) fn exponent(fit: &FitSlice, folder: &Folder, method: Method, delta_k_ratio: Option<f64>) -> Result<Exponent> {
    let parameters = fit.parameters.clone().unwrap_or_else(|| vec![Parameter::A, Parameter::P]);
    let names: Vec<String> = parameters.iter().map(|parameter| format!("\"{parameter}\"")).collect();
    if !parameters.contains(&Parameter::A) {
        let remedy = "write parameters = [\"a\", \"p\"], or [\"a\"] with p = ...";
        return Err(input("fit.parameters", format!("[{}]", names.join(", ")), "leaves a out, which is always fitted", remedy));
    }
    match (parameters.contains(&Parameter::P), fit.p, fit.record.as_deref()) {
        (_, Some(p), Some(_)) => Err(input("fit.p", p, "stands beside record: p is given twice", "give p or record")),
        (true, Some(p), None) => Err(input("fit.p", p, "is given and fitted at once", "remove p, or write parameters = [\"a\"]")),
        (true, None, None) => Ok(Exponent::fitted(delta_k_ratio.unwrap_or(f64::INFINITY))),
        (true, None, Some(file)) => match delta_k_ratio {
            Some(ratio) => Exponent::record_if_needed(file, folder, method, ratio),
            None => {
                let problem = "stands in for p where ΔK varies too little, which on this plate only a run shows";
                let remedy = "leave it out, or take its p by parameters = [\"a\"]";
                Err(input("fit.record", format!("\"{file}\""), problem, remedy))
            }
        },
        (false, Some(p), None) => Ok(Exponent::given(p)),
        (false, None, Some(file)) => Exponent::of_record(file, folder, method),
        (false, None, None) => Err(input_missing(
            "fit.p",
            "is missing",
            "give the exponent p, or record = \"fitted.toml\", or fit it too: parameters = [\"a\", \"p\"]",
        )),
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
