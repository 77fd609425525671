//! Laws over K fitted to rates at several stress ratios, and which of them the rates are for.
//!
//! Each law is fitted by least squares on ln da/dN. Of those whose constants the rates tell the one counts whose
//! criterion of Akaike (1974, IEEE Trans. Autom. Control 19:716) for small samples (Hurvich and Tsai 1989, Biometrika 76:297) is least,
//!
//! `AICc = n ln(S/n) + 2 k + 2 k (k + 1) / (n - k - 1)`,
//!
//! S the sum of squares of n rates and k the number of fitted constants with the scatter. A difference below 2 says little, one above 10
//! nearly all (Burnham and Anderson 2002, section 2.6). Rates of parabolas through seven readings share readings: neighbours of one test
//! whose scatter is correlated by ρ count as `n (1 - ρ)/(1 + ρ)` rates, in the first term and in the errors. ρ is that of residuals about a
//! smooth curve through each test, a polynomial in ln ΔK: what all laws miss is no scatter. A law whose residuals are twice those of another
//! is not chosen, whatever the criterion says.

pub mod case;
pub mod fit;
mod least_squares;

use nalgebra::{DMatrix, DVector};

use crate::paris::doubt_of_exponent;
use crate::rates::threshold;
pub use fit::Given;
use fit::{LawFit, fit};
use perilife_base::error::{Error, Result, input_missing};
use perilife_base::units::{MM_PER_CYCLE, MPA_SQRT_M};
use perilife_laws::growth_law::{GrowthLawKind, doubt};
use perilife_measured::RateRow;

/// Laws that rates are fitted by: one of them, or the best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitLaw(pub Option<GrowthLawKind>);

impl FitLaw {
    /// Key of the input file that takes these names.
    pub const KEY: &'static str = "fit.law";

    /// Every law, the best last.
    pub fn all() -> impl Iterator<Item = Self> {
        kinds().map(|kind| FitLaw(Some(kind))).chain([FitLaw(None)])
    }

    pub fn name(self) -> &'static str {
        self.0.map_or("best", GrowthLawKind::name)
    }

    pub fn meaning(self) -> &'static str {
        self.0.and_then(|kind| kind.0.fit).unwrap_or("the best of them by Akaike's criterion (AICc)")
    }
}

perilife_base::kinds!(names of FitLaw);

/// Laws that rates are fitted by, in the order of their number of constants.
fn kinds() -> impl Iterator<Item = GrowthLawKind> {
    GrowthLawKind::all().filter(|kind| kind.0.fit.is_some())
}

/// Variance of ln da/dN that is round-off: tables carry ten digits.
const ROUND_OFF: f64 = 1e-20;
/// Rates beyond this factor of the law, or below its inverse, are named.
const FACTOR: f64 = 3.0;
const NAMED: usize = 5;
/// A law whose residuals are larger than those of another by this factor is not chosen; a law that misses smooth curves through the tests
/// by this factor more than the rates do does not bend as they do.
const RMS_FACTOR: f64 = 2.0;
/// Smallest misfit of ln da/dN that is named.
const BEND_MIN: f64 = 0.05;
/// Largest correlation of neighbouring rates: that of parabolas through seven readings with six in common.
const CORRELATION_MAX: f64 = 0.7;
/// Difference of the criterion above which a law that was asked for is the wrong one.
const WORSE: f64 = 10.0;

#[derive(Debug, Clone, PartialEq)]
pub struct LawFits {
    pub candidates: Vec<LawFit>,
    pub chosen: usize,
    /// Criterion of the next best law less that of the chosen one; `None` where no other law is left.
    pub margin: Option<(GrowthLawKind, f64)>,
    /// How many independent rates the rates count as.
    pub effective_rates: f64,
    pub warnings: Vec<String>,
}

impl LawFits {
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
    fit::check_given(given)?;
    let smooth = Smooth::through(rows);
    let effective = smooth.effective_rates(rows);
    let candidates: Vec<LawFit> = kinds().map(|kind| judged(kind, given, rows, effective)).collect();
    let chosen = choose(&candidates, wanted)?;
    let others = candidates.iter().enumerate().filter(|(i, other)| *i != chosen && other.left_out.is_none());
    let next = others.map(|(_, other)| other).min_by(|a, b| a.aicc.total_cmp(&b.aicc));
    let margin = next.map(|next| (next.kind, next.aicc - candidates[chosen].aicc));
    let mut fits = LawFits { candidates, chosen, margin, effective_rates: effective, warnings: Vec::new() };
    fits.warnings = warnings(&fits, rows);
    fits.warnings.extend(smooth.misfit(rows, fits.law()));
    check_metal(fits.law(), rows)?;
    Ok(fits)
}

/// A law fitted to rates that count as so many; where they do not tell a constant of one factor that may be 1, as that of fracture in the NASGRO
/// equation, it is fitted without it. Without any of them it would be another law.
fn judged(kind: GrowthLawKind, given: &Given, rows: &[RateRow], effective: f64) -> LawFit {
    let judged = |given: &Given| {
        let mut law = fit(kind, given, rows);
        law.widen((rows.len() as f64 / effective).sqrt());
        law.aicc = criterion(&law, effective);
        law.judge_errors();
        law
    };
    let law = judged(given);
    let unknown = |(key, _): &(&str, f64)| law.left_out.as_ref().is_some_and(|why| why.starts_with(key));
    let Some((of, constants)) = kind.0.factors.iter().find(|(_, own)| own.iter().take(2).any(unknown)) else { return law };
    let others = constants.iter().map(|(key, value)| ((*key).to_owned(), *value));
    let simpler = judged(&others.chain(given.clone()).collect());
    if simpler.left_out.is_none() { LawFit { lacks: Some(of), ..simpler } } else { law }
}

fn choose(candidates: &[LawFit], wanted: FitLaw) -> Result<usize> {
    if let Some(kind) = wanted.0 {
        let place = candidates.iter().position(|candidate| candidate.kind == kind).unwrap_or(0);
        let no_law = |why: &String| Error::Mechanics(format!("law {wanted} cannot be fitted: {why}"));
        return candidates[place].left_out.as_ref().map_or(Ok(place), |why| Err(no_law(why)));
    }
    let left = || candidates.iter().enumerate().filter(|(_, candidate)| candidate.left_out.is_none());
    let closest = left().map(|(_, candidate)| candidate.rms()).fold(f64::INFINITY, f64::min);
    left()
        .filter(|(_, candidate)| candidate.rms() <= (RMS_FACTOR * closest).max(ROUND_OFF.sqrt()))
        .min_by(|a, b| a.1.aicc.total_cmp(&b.1.aicc))
        .map(|(place, _)| place)
        .ok_or_else(|| {
            let reasons = candidates
                .iter()
                .filter_map(|candidate| Some(format!("\n  {}: {}", candidate.kind, candidate.left_out.as_ref()?)));
            Error::Mechanics(format!("no law can be fitted:{}", reasons.collect::<String>()))
        })
}

/// AICc; NaN without a fit. The last term counts rates as they are: constants are not too many because neighbours are alike.
fn criterion(candidate: &LawFit, rates: f64) -> f64 {
    if candidate.residuals.is_empty() {
        return f64::NAN;
    }
    let (all, k) = (candidate.residuals.len() as f64, (candidate.fitted + 1) as f64);
    rates * candidate.rms().powi(2).max(ROUND_OFF).ln() + 2.0 * k + 2.0 * k * (k + 1.0) / (all - k - 1.0).max(1.0)
}

/// A smooth curve through the rates of every test: a polynomial of ln da/dN over ln ΔK.
struct Smooth {
    /// Rate less curve, in ln, row by row; NaN where a test has too few rates.
    residuals: Vec<f64>,
}

impl Smooth {
    fn through(rows: &[RateRow]) -> Self {
        let mut residuals = vec![f64::NAN; rows.len()];
        for of_test in (0..rows.len()).collect::<Vec<_>>().chunk_by(|&a, &b| rows[a].series == rows[b].series) {
            let x: Vec<f64> = of_test.iter().map(|&row| rows[row].delta_k.ln()).collect();
            let y: Vec<f64> = of_test.iter().map(|&row| rows[row].log_rate()).collect();
            for (&row, residual) in of_test.iter().zip(about_polynomial(&x, &y)) {
                residuals[row] = residual;
            }
        }
        Smooth { residuals }
    }

    fn pairs<'a>(&'a self, rows: &'a [RateRow]) -> impl Iterator<Item = [f64; 2]> + 'a {
        let same = |i: &usize| rows[*i].series == rows[*i - 1].series && self.residuals[*i].is_finite();
        (1..rows.len()).filter(same).map(|i| [self.residuals[i - 1], self.residuals[i]])
    }

    fn effective_rates(&self, rows: &[RateRow]) -> f64 {
        let all = rows.len() as f64;
        let known = || self.residuals.iter().filter(|residual| residual.is_finite());
        let variance = known().map(|residual| residual * residual).sum::<f64>() / known().count() as f64;
        let pairs = self.pairs(rows).count();
        if pairs <= 4 || variance <= ROUND_OFF {
            return all;
        }
        let correlation = self.pairs(rows).map(|[a, b]| a * b).sum::<f64>() / (pairs as f64 * variance);
        // Twice the error of a correlation that is none; parabolas through seven readings reach 0.7.
        let correlation = correlation.min(CORRELATION_MAX);
        let is_real = correlation > 2.0 / (pairs as f64).sqrt();
        if is_real { all * (1.0 - correlation) / (1.0 + correlation) } else { all }
    }

    /// A line where the law does not bend as the rates of the tests do: what is left of its residuals in every test without their mean.
    fn misfit(&self, rows: &[RateRow], law: &LawFit) -> Option<String> {
        let known: Vec<usize> = (0..rows.len()).filter(|&row| self.residuals[row].is_finite()).collect();
        let mut bend = 0.0;
        for of_test in known.chunk_by(|&a, &b| rows[a].series == rows[b].series) {
            let mean = of_test.iter().map(|&row| law.residuals[row]).sum::<f64>() / of_test.len() as f64;
            bend += of_test.iter().map(|&row| (law.residuals[row] - mean).powi(2)).sum::<f64>();
        }
        let scatter: f64 = known.iter().map(|&row| self.residuals[row].powi(2)).sum();
        let [bend, scatter] = [bend, scatter].map(|sum| (sum / known.len() as f64).sqrt());
        let misses = format!("rms {bend:.3} in ln da/dN, {scatter:.3} for a smooth curve per test");
        let remedy = "growth_law = \"table\" with growth_table uses the rates directly";
        (!known.is_empty() && bend > (RMS_FACTOR * scatter).max(BEND_MIN))
            .then(|| format!("law: {} misses the shape of the data: {misses}; {remedy}", law.kind))
    }
}

/// Values less their polynomial over x, of degree 4 or less, with at least three values for each of its constants; NaN where there are
/// fewer.
fn about_polynomial(x: &[f64], y: &[f64]) -> Vec<f64> {
    let degree = (x.len() / 3).saturating_sub(1).min(4);
    let (low, high) = (x.iter().copied().fold(f64::INFINITY, f64::min), x.iter().copied().fold(f64::NEG_INFINITY, f64::max));
    if degree == 0 || low == high {
        return vec![f64::NAN; x.len()];
    }
    let columns = DMatrix::from_fn(x.len(), degree + 1, |i, power| (2.0 * (x[i] - low) / (high - low) - 1.0).powi(power as i32));
    let y = DVector::from_column_slice(y);
    match columns.clone().svd(true, true).solve(&y, 1e-12) {
        Ok(constants) => (y - columns * constants).as_slice().to_vec(),
        Err(_) => vec![f64::NAN; x.len()],
    }
}

fn warnings(fits: &LawFits, rows: &[RateRow]) -> Vec<String> {
    let law = fits.law();
    let without = |of: &str| format!("law: {} fitted without its {of} factor, not identifiable from these rates", law.kind);
    let mut lines: Vec<String> = law.lacks.map(without).into_iter().collect();
    let of_test = |test: &[RateRow]| {
        let rates = test.iter().map(|row| (row.delta_k / MPA_SQRT_M, row.rate / MM_PER_CYCLE));
        threshold(rates).map(|(_, words)| format!("threshold: {}: {words}", test[0].series))
    };
    lines.extend(rows.chunk_by(|a, b| a.series == b.series).filter_map(of_test));
    if let Some((kind, margin)) = fits.margin.filter(|(_, margin)| *margin < -WORSE) {
        lines.push(format!("law: {} is not the best: {kind} is better by {:.1} in AICc", law.kind, -margin));
    }
    if fits.effective_rates < 0.9 * rows.len() as f64 {
        let (count, weight) = (rows.len(), fits.effective_rates);
        lines.push(format!("rates: neighbors are correlated (seven-point polynomial): {count} rates weigh as {weight:.0}"));
    }
    let far: Vec<String> = (rows.iter().zip(&law.residuals))
        .filter(|(_, residual)| residual.abs() > FACTOR.ln())
        .map(|(row, residual)| format!("rates: {}: {:.2} times the rate of the law {}", row.place, residual.exp(), law.kind))
        .collect();
    lines.extend(far.iter().take(NAMED).cloned());
    if far.len() > NAMED {
        lines.push(format!("rates: {} more are off by more than a factor of {FACTOR}", far.len() - NAMED));
    }
    lines
}

/// Refuses a law that no metal has: a unit that slipped shows here.
fn check_metal(law: &LawFit, rows: &[RateRow]) -> Result<()> {
    // The middle of the ratios: a law has no rates at ratios that it was not fitted to.
    let ratio = rows[rows.len() / 2].ratio;
    let of_power = law.kind.0.read.is_none().then(|| doubt_of_exponent(law.constants[1].value)).flatten();
    let fitted = law.kind.0.of(law.constants.iter().map(|constant| constant.value));
    match of_power.or_else(|| doubt(&fitted, ratio)) {
        None => Ok(()),
        Some(doubt) => Err(input_missing("measured.rates", format!("implausible growth law: {doubt}"), "")),
    }
}
