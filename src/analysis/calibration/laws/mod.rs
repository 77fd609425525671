//! Laws over K fitted to rates at several stress ratios, and which of them the rates are for.
//!
//! Each law is fitted by least squares on ln da/dN. Of those whose constants the rates tell the one counts whose
//! criterion of Akaike (1974, IEEE Trans. Autom. Control 19:716) for small samples (Hurvich and Tsai 1989, Biometrika 76:297) is least,
//!
//! `AICc = n ln(S/n) + 2 k + 2 k (k + 1) / (n - k - 1)`,
//!
//! S the sum of squares of n rates and k the number of fitted constants with the scatter. A difference below 2 says little, one above 10
//! nearly all (Burnham and Anderson 2002, section 2.6). Rates of parabolas through seven readings share readings: neighbours of one test whose
//! residuals are correlated by ρ count as `n (1 - ρ)/(1 + ρ)` rates, in the criterion and in the errors.

mod candidate;
pub mod case;
pub mod fit;
mod least_squares;
pub mod rows;

use crate::calibration::paris::doubt;
use crate::error::{Error, Result, input_missing};
use crate::fatigue::growth_law::GrowthLawKind;
pub use candidate::Given;
use fit::{LawFit, fit};
use rows::RateRow;

crate::kinds! {
    /// Laws that rates are fitted by.
    pub enum FitLaw for "fit.law" {
        Paris = "paris": "da/dN = C ΔK^m; of a-N readings A and p of bonds as well",
        Walker = "walker": "da/dN = C (K_max (1-R)^γ)^m",
        Forman = "forman": "da/dN = C ΔK^m / ((1-R) K_c - ΔK)",
        Nasgro = "nasgro": "the NASGRO equation",
        Best = "best": "the one of them that the rates are for, by Akaike's criterion",
    }
}

/// Laws in the order of their number of constants.
const LAWS: [(FitLaw, GrowthLawKind); 4] = [
    (FitLaw::Paris, GrowthLawKind::Paris),
    (FitLaw::Walker, GrowthLawKind::Walker),
    (FitLaw::Forman, GrowthLawKind::Forman),
    (FitLaw::Nasgro, GrowthLawKind::Nasgro),
];

/// Variance of ln da/dN that is round-off: tables carry ten digits.
const ROUND_OFF: f64 = 1e-20;
/// Rates beyond this factor of the law, or below its inverse, are named.
const FACTOR: f64 = 3.0;
/// Most rows that are named.
const NAMED: usize = 5;
/// Difference of the criterion above which a law that was asked for is the wrong one.
const WORSE: f64 = 10.0;

/// All laws fitted to the same rates.
#[derive(Debug, Clone, PartialEq)]
pub struct LawFits {
    /// Each law, fitted or left out.
    pub candidates: Vec<LawFit>,
    /// Place of the chosen one.
    pub chosen: usize,
    /// Criterion of the next best law less that of the chosen one; `None` where no other law is left.
    pub margin: Option<(GrowthLawKind, f64)>,
    /// How many independent rates the rates count as.
    pub effective_rates: f64,
    /// What the user should know.
    pub warnings: Vec<String>,
}

impl LawFits {
    /// The chosen law.
    pub fn law(&self) -> &LawFit {
        &self.candidates[self.chosen]
    }

    /// The least criterion of those that are left.
    pub fn least_aicc(&self) -> f64 {
        self.candidates.iter().filter(|law| law.left_out.is_none()).map(|law| law.aicc).fold(f64::INFINITY, f64::min)
    }
}

/// Fits every law and chooses the one asked for, or the best.
/// Errors: [`Error::Mechanics`] where the rates do not tell the law asked for, or none; constants that no law has, or no metal.
pub fn fit_laws(rows: &[RateRow], wanted: FitLaw, given: &Given) -> Result<LawFits> {
    candidate::check_given(given)?;
    let mut candidates: Vec<LawFit> = LAWS.iter().map(|(_, kind)| fit(*kind, given, rows)).collect();
    let effective = effective_rates(rows, &candidates);
    for candidate in &mut candidates {
        candidate.widen((rows.len() as f64 / effective).sqrt());
        candidate.aicc = criterion(candidate, effective);
        candidate.judge_errors();
        if candidate.left_out.is_none() && !candidate.aicc.is_finite() {
            let words = format!("{effective:.1} independent rates are too few for its {} constants", candidate.fitted);
            candidate.left_out = Some(words);
        }
    }
    let chosen = choose(&candidates, wanted)?;
    let others = candidates.iter().enumerate().filter(|(i, other)| *i != chosen && other.left_out.is_none());
    let next = others.map(|(_, other)| other).min_by(|a, b| a.aicc.total_cmp(&b.aicc));
    let margin = next.map(|next| (next.kind, next.aicc - candidates[chosen].aicc));
    let mut fits = LawFits { candidates, chosen, margin, effective_rates: effective, warnings: Vec::new() };
    fits.warnings = warnings(&fits, rows);
    check_metal(fits.law())?;
    Ok(fits)
}

/// The place of the law asked for, or of the best.
fn choose(candidates: &[LawFit], wanted: FitLaw) -> Result<usize> {
    if wanted != FitLaw::Best {
        let place = LAWS.iter().position(|(law, _)| *law == wanted).unwrap_or(0);
        let no_law = |why: &String| Error::Mechanics(format!("the rates do not tell the law {wanted}: {why}"));
        return candidates[place].left_out.as_ref().map_or(Ok(place), |why| Err(no_law(why)));
    }
    let left = candidates.iter().enumerate().filter(|(_, candidate)| candidate.left_out.is_none());
    left.min_by(|a, b| a.1.aicc.total_cmp(&b.1.aicc)).map(|(place, _)| place).ok_or_else(|| {
        let reasons =
            candidates.iter().filter_map(|candidate| Some(format!("\n  {}: {}", candidate.kind, candidate.left_out.as_ref()?)));
        Error::Mechanics(format!("the rates tell no law:{}", reasons.collect::<String>()))
    })
}

/// AICc; NaN without a fit, infinite where the rates are too few.
fn criterion(candidate: &LawFit, rates: f64) -> f64 {
    if candidate.residuals.is_empty() {
        return f64::NAN;
    }
    let k = (candidate.fitted + 1) as f64;
    if rates - k - 1.0 <= 0.0 {
        return f64::INFINITY;
    }
    rates * candidate.rms().powi(2).max(ROUND_OFF).ln() + 2.0 * k + 2.0 * k * (k + 1.0) / (rates - k - 1.0)
}

/// How many independent rates they are, by the residuals of the closest law.
fn effective_rates(rows: &[RateRow], candidates: &[LawFit]) -> f64 {
    let all = rows.len() as f64;
    let fitted = candidates.iter().filter(|candidate| !candidate.residuals.is_empty());
    let Some(closest) = fitted.min_by(|a, b| a.rms().total_cmp(&b.rms())) else { return all };
    if closest.rms().powi(2) <= ROUND_OFF {
        return all;
    }
    let pairs: Vec<f64> = (1..rows.len())
        .filter(|&i| rows[i].series == rows[i - 1].series)
        .map(|i| closest.residuals[i] * closest.residuals[i - 1])
        .collect();
    let correlation = pairs.iter().sum::<f64>() / (pairs.len() as f64 * closest.rms().powi(2));
    // Twice the error of a correlation that is none.
    let is_real = pairs.len() > 4 && correlation > 2.0 / (pairs.len() as f64).sqrt();
    if is_real { all * (1.0 - correlation.min(0.95)) / (1.0 + correlation.min(0.95)) } else { all }
}

fn warnings(fits: &LawFits, rows: &[RateRow]) -> Vec<String> {
    let law = fits.law();
    let mut lines = Vec::new();
    if let Some((kind, margin)) = fits.margin.filter(|(_, margin)| *margin < -WORSE) {
        lines.push(format!("the rates are not for the law {}: {kind} is better by {:.1} of AICc", law.kind, -margin));
    }
    if fits.effective_rates < 0.9 * rows.len() as f64 {
        lines.push(format!(
            "neighbouring rates are correlated (of a parabola through seven readings they are): {} rates count as {:.0}",
            rows.len(),
            fits.effective_rates
        ));
    }
    let far: Vec<String> = (rows.iter().zip(&law.residuals))
        .filter(|(_, residual)| residual.abs() > FACTOR.ln())
        .map(|(row, residual)| format!("{}: the rate is {:.2} times that of the law {}", row.place, residual.exp(), law.kind))
        .collect();
    lines.extend(far.iter().take(NAMED).cloned());
    if far.len() > NAMED {
        lines.push(format!("{} more rates lie beyond a factor {FACTOR} of the law", far.len() - NAMED));
    }
    lines
}

/// Refuses a law that no metal has: a unit that slipped shows here.
fn check_metal(law: &LawFit) -> Result<()> {
    let value = |key: &str| law.constants.iter().find(|constant| constant.key == key).map(|constant| constant.value);
    let (Some(c), Some(m)) = (value("paris_c_mm_per_cycle"), value("paris_m")) else { return Ok(()) };
    match doubt(c, m) {
        None => Ok(()),
        Some(doubt) => Err(input_missing("measured.rates", format!("give a law that no metal has: {doubt}"), "")),
    }
}
