//! Laws as least squares sees them: constants that are searched, the range and the starts of each, and the rates they give.
//!
//! Two constants have limits that depend on the rows: K_c lies above every K_max, and the threshold below every ΔK. They are searched as
//! `K_c = K_max (1 + e^u)` and `ΔK₀ = ΔK₀,max / (1 + e^-u)`, ΔK₀,max being the one at which the first row would stand still.

use std::collections::BTreeMap;

use crate::error::{Result, input};
use crate::fatigue::growth_law::nasgro::{Nasgro, RATIO_MIN};
use crate::fatigue::growth_law::{Forman, GrowthLaw, GrowthLawKind, Walker};
use crate::fatigue::paris::ParisLaw;
use crate::input::{INTENSITY, Quantity, number};
use crate::measured::RateRow;
use crate::units::{MM_PER_CYCLE, MPA_SQRT_M};

/// Constants that the user gives, by their keys.
pub type Given = BTreeMap<String, f64>;

/// A constant that is searched, or given.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parameter {
    /// Its key in `[fatigue]`.
    pub key: &'static str,
    /// Ends of the search, of its variable.
    pub bounds: [f64; 2],
    /// Where searches start, of its variable.
    pub starts: [f64; 2],
    /// Which rates tell it.
    pub told_by: &'static str,
    /// Standard error above which it is not known: a share of its value, or (alpha, slopes) an absolute one.
    pub error_max: f64,
    /// Value where it is neither given nor searched.
    default: Option<f64>,
}

const NEAR_FRACTURE: &str = "rates near fracture tell it";
const NEAR_THRESHOLD: &str = "rates near the threshold tell it";
const RATIOS: &str = "rates at several stress ratios tell it";
const POWER: &str = "rates over a wide range of ΔK tell it";

/// Ends of the search for ln(K_c / K_max - 1).
const ABOVE_K_MAX: [f64; 2] = [-6.9, 2.9];
/// Ends of the search for the logit of ΔK₀ over the largest possible.
const BELOW_DELTA_K: [f64; 2] = [-3.0, 9.2];
/// Stress ratios that differ by less are one.
const SAME_RATIO: f64 = 0.02;

pub(super) const K_C: &str = "k_c_mpa_sqrt_m";
pub(super) const THRESHOLD: &str = "nasgro_delta_k_0_mpa_sqrt_m";
pub(super) const GAMMA: &str = "walker_gamma";

const fn searched(key: &'static str, bounds: [f64; 2], starts: [f64; 2], told_by: &'static str, error_max: f64) -> Parameter {
    Parameter { key, bounds, starts, told_by, error_max, default: None }
}

const fn held(key: &'static str, value: f64) -> Parameter {
    Parameter { key, bounds: [value; 2], starts: [value; 2], told_by: "", error_max: 0.0, default: Some(value) }
}

const fn exponent(key: &'static str) -> Parameter {
    searched(key, [0.5, 20.0], [3.0; 2], POWER, 1.0)
}

const INSTABILITY: Parameter = searched(K_C, ABOVE_K_MAX, [-2.0, 0.5], NEAR_FRACTURE, 1.0);

/// Constants of a law but C, which is its level; the key of C.
pub(super) fn parameters(kind: GrowthLawKind) -> (&'static str, Vec<Parameter>) {
    match kind {
        GrowthLawKind::Walker => {
            let gamma = searched(GAMMA, [0.0, 2.0], [0.5; 2], RATIOS, f64::INFINITY);
            ("paris_c_mm_per_cycle", vec![exponent("paris_m"), gamma])
        }
        GrowthLawKind::Forman => ("forman_c_mm_per_cycle", vec![exponent("forman_m"), INSTABILITY]),
        GrowthLawKind::Nasgro => {
            let all = vec![
                exponent("nasgro_n"),
                searched("nasgro_p", [0.0, 5.0], [0.25, 1.0], NEAR_THRESHOLD, 1.0),
                searched("nasgro_q", [0.0, 5.0], [0.25, 1.0], NEAR_FRACTURE, 1.0),
                searched("nasgro_alpha", [1.0, 3.0], [1.5, 2.5], RATIOS, 1.0),
                held("nasgro_smax_over_flow", 0.3),
                searched(THRESHOLD, BELOW_DELTA_K, [0.0, 3.0], NEAR_THRESHOLD, 1.0),
                searched("nasgro_c_th", [-5.0, 5.0], [0.5; 2], "rates near the threshold at several stress ratios tell it", 2.0),
                held("nasgro_c_th_negative", 0.0),
                INSTABILITY,
            ];
            ("nasgro_c_mm_per_cycle", all)
        }
        _ => ("paris_c_mm_per_cycle", vec![exponent("paris_m")]),
    }
}

/// Refuses constants that no law has, or beyond what it can have.
pub(super) fn check_given(given: &Given) -> Result<()> {
    let kinds = [GrowthLawKind::Walker, GrowthLawKind::Forman, GrowthLawKind::Nasgro];
    let known: Vec<&str> = kinds.into_iter().flat_map(|kind| parameters(kind).1).map(|parameter| parameter.key).collect();
    for (key, &value) in given {
        let path = format!("fit.given.{key}");
        let quantity: Quantity = match key.as_str() {
            K_C | THRESHOLD => INTENSITY,
            GAMMA => number("a Walker exponent", 0.0, 2.0),
            "nasgro_alpha" => number("a constraint factor, 1 to 3", 1.0, 3.0),
            "nasgro_smax_over_flow" => number("a share of the flow stress", 0.0, 0.99),
            "nasgro_p" | "nasgro_q" => number("an exponent", 0.0, 20.0),
            "nasgro_c_th" | "nasgro_c_th_negative" => number("a slope of the threshold over R", -10.0, 10.0),
            "paris_m" | "forman_m" | "nasgro_n" => number("an exponent", 0.5, 20.0),
            _ => {
                let remedy = format!("known here: {}; C is always fitted", known.join(", "));
                return Err(input(&path, value, "is no constant of a law that can be given", remedy));
            }
        };
        quantity.read(&path, value)?;
    }
    Ok(())
}

/// A law with some constants given, over some rows.
#[derive(Debug, Clone)]
pub(super) struct Candidate<'a> {
    pub kind: GrowthLawKind,
    parameters: Vec<Parameter>,
    given: Vec<Option<f64>>,
    rows: &'a [RateRow],
}

impl<'a> Candidate<'a> {
    /// The law over the rows.
    /// Errors: in words, why these rows say nothing about it.
    pub fn new(kind: GrowthLawKind, given: &Given, rows: &'a [RateRow]) -> std::result::Result<Self, String> {
        let parameters = parameters(kind).1;
        let values = parameters.iter().map(|parameter| given.get(parameter.key).copied().or(parameter.default)).collect();
        let candidate = Candidate { kind, parameters, given: values, rows };
        let ratios = || rows.iter().map(|row| row.ratio.max(0.0));
        let (low, high) = (ratios().fold(f64::INFINITY, f64::min), ratios().fold(f64::NEG_INFINITY, f64::max));
        let several = [GAMMA, "nasgro_alpha", "nasgro_c_th"];
        let lacks: Vec<&str> = candidate.free().map(|parameter| parameter.key).filter(|key| several.contains(key)).collect();
        if high - low < SAME_RATIO && !lacks.is_empty() {
            let one = format!("all rates are of one stress ratio, R = {:.3}{}", rows[0].ratio, closed(rows));
            return Err(format!("{} not identified: {one}; give by fit.given", lacks.join(", ")));
        }
        let least = rows.iter().map(|row| row.ratio).fold(f64::INFINITY, f64::min);
        if kind == GrowthLawKind::Nasgro && least < RATIO_MIN {
            return Err(format!("its crack opening is not known at R = {least}, below {RATIO_MIN}"));
        }
        if let Some(k_c) = candidate.given(K_C).filter(|k_c| *k_c * MPA_SQRT_M <= candidate.k_max()) {
            return Err(format!("{K_C} = {k_c} is given, and a crack grew at K_max = {:.3}", candidate.k_max() / MPA_SQRT_M));
        }
        Ok(candidate)
    }

    /// Constants that are searched.
    pub fn free(&self) -> impl Iterator<Item = &Parameter> {
        self.parameters.iter().zip(&self.given).filter(|(_, given)| given.is_none()).map(|(parameter, _)| parameter)
    }

    fn given(&self, key: &str) -> Option<f64> {
        self.parameters.iter().zip(&self.given).find(|(parameter, _)| parameter.key == key).and_then(|(_, given)| *given)
    }

    fn k_max(&self) -> f64 {
        self.rows.iter().map(RateRow::k_max).fold(0.0, f64::max)
    }

    /// Keys and values of all constants but C.
    pub fn constants(&self, variables: &[f64]) -> Vec<(&'static str, f64)> {
        let mut variable = variables.iter();
        let raw: Vec<(&'static str, f64, bool)> = (self.parameters.iter().zip(&self.given))
            .map(|(parameter, given)| match given {
                Some(value) => (parameter.key, *value, true),
                None => (parameter.key, variable.next().copied().unwrap_or(f64::NAN), false),
            })
            .collect();
        let at = |key: &str| raw.iter().find(|(own, ..)| *own == key).map_or(0.0, |(_, value, _)| *value);
        let value = |&(key, value, is_given): &(&'static str, f64, bool)| match key {
            _ if is_given => (key, value),
            K_C => (key, self.k_max() / MPA_SQRT_M * (1.0 + value.exp())),
            THRESHOLD => (key, self.threshold_max(&at) / MPA_SQRT_M / (1.0 + (-value).exp())),
            _ => (key, value),
        };
        raw.iter().map(value).collect()
    }

    /// ΔK₀ at which the first of the rows stands still, Pa√m.
    fn threshold_max(&self, at: &dyn Fn(&str) -> f64) -> f64 {
        let unit = nasgro(&|key| if key == THRESHOLD { 1.0 } else { at(key) });
        let most = |row: &RateRow| (1.0 - row.ratio) * row.k_max() / unit.threshold_at(row.ratio) * MPA_SQRT_M;
        self.rows.iter().map(most).fold(f64::INFINITY, f64::min)
    }

    /// The law with C = 1 mm/cycle.
    fn law(&self, constants: &[(&'static str, f64)]) -> Box<dyn GrowthLaw> {
        let at = |key: &str| constants.iter().find(|(own, _)| *own == key).map_or(0.0, |(_, value)| *value);
        match self.kind {
            GrowthLawKind::Forman => Box::new(Forman { c: MM_PER_CYCLE, m: at("forman_m"), k_c: at(K_C) * MPA_SQRT_M }),
            GrowthLawKind::Nasgro => Box::new(nasgro(&at)),
            kind => {
                let gamma = if kind == GrowthLawKind::Walker { at(GAMMA) } else { 1.0 };
                Box::new(Walker { paris: ParisLaw { c: MM_PER_CYCLE, m: at("paris_m") }, gamma, threshold: 0.0 })
            }
        }
    }

    /// ln of the rates (mm/cycle) at C = 1; `None` where a row has none.
    pub fn shape(&self, variables: &[f64]) -> Option<Vec<f64>> {
        let law = self.law(&self.constants(variables));
        let rate = |row: &RateRow| Some((law.rate(row.k_max(), row.ratio) / MM_PER_CYCLE).ln()).filter(|rate| rate.is_finite());
        self.rows.iter().map(rate).collect()
    }
}

/// Why rates at several negative ratios count as one.
fn closed(rows: &[RateRow]) -> &'static str {
    let differ = rows.iter().any(|row| (row.ratio - rows[0].ratio).abs() >= SAME_RATIO);
    if differ { ", and negative ones count as 0: compression does not open a crack" } else { "" }
}

pub(super) fn nasgro(at: &dyn Fn(&str) -> f64) -> Nasgro {
    Nasgro {
        c: MM_PER_CYCLE,
        n: at("nasgro_n"),
        p: at("nasgro_p"),
        q: at("nasgro_q"),
        alpha: at("nasgro_alpha"),
        stress_over_flow: at("nasgro_smax_over_flow"),
        threshold: at(THRESHOLD) * MPA_SQRT_M,
        threshold_slopes: [at("nasgro_c_th_negative"), at("nasgro_c_th")],
        k_c: at(K_C) * MPA_SQRT_M,
    }
}
