//! One law fitted to rates: its constants with their errors, or why these rates do not tell them; and the law as least squares sees it, constants
//! that are searched and the rates they give. Two have limits that depend on the rows: [`Role`].

use std::collections::BTreeMap;

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::kinds;
use super::least_squares::{Minimum, minimise, without_level};
use perilife_base::error::{Result, input};
use perilife_base::units::{MM_PER_CYCLE, MPA_SQRT_M};
use perilife_laws::growth_law::description::{Constant as Parameter, Role};
use perilife_laws::growth_law::{FactorLaw, GrowthLaw, GrowthLawKind};
use perilife_measured::RateRow;
use perilife_plate::loading::SAME_RATIO;

/// Share of the range of a variable within which an optimum lies at its end.
const AT_END: f64 = 1e-3;
/// Smallest over largest eigenvalue of scaled normal equations below which constants trade against each other without end.
const SINGULAR: f64 = 1e-13;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constant {
    pub key: &'static str,
    /// Value in the unit of its key in `[fatigue]`.
    pub value: f64,
    /// Standard error; `None` where it was given.
    pub error: Option<f64>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct LawFit {
    pub kind: GrowthLawKind,
    /// Its constants, C first; empty where there is no fit.
    pub constants: Vec<Constant>,
    /// How many of them were fitted, C among them.
    pub fitted: usize,
    /// Measured less fitted ln da/dN, row by row.
    pub residuals: Vec<f64>,
    /// Akaike's information criterion for small samples; NaN where there is no fit.
    pub aicc: f64,
    pub left_out: Option<String>,
    /// Its factor that no rate tells, and that is 1.
    pub lacks: Option<&'static str>,
}

impl LawFit {
    fn none(kind: GrowthLawKind, why: String) -> Self {
        let (constants, residuals, left_out) = (Vec::new(), Vec::new(), Some(why));
        LawFit { kind, constants, fitted: 0, residuals, aicc: f64::NAN, left_out, lacks: None }
    }

    /// Its constants, without those of factors that it lacks and that have no value.
    pub fn known_constants(&self) -> impl Iterator<Item = &Constant> {
        self.constants.iter().filter(|constant| constant.value.is_finite())
    }

    pub fn rms(&self) -> f64 {
        (self.residuals.iter().map(|residual| residual * residual).sum::<f64>() / self.residuals.len() as f64).sqrt()
    }

    /// Widens the errors by a factor, for residuals that follow each other.
    pub(super) fn widen(&mut self, factor: f64) {
        self.constants.iter_mut().filter_map(|constant| constant.error.as_mut()).for_each(|error| *error *= factor);
    }

    /// A constant that is fitted and whose error is larger than it may be.
    pub(super) fn judge_errors(&mut self) {
        let unknown = self.constants.iter().find_map(|constant| {
            let parameter = self.kind.0.constants[1..].iter().find(|parameter| parameter.key == constant.key)?;
            let size = if parameter.needs.1 { 1.0 } else { constant.value.abs() };
            let error = constant.error.filter(|error| *error > parameter.error_max * size)?;
            Some(unidentified(parameter, &format!("{:.3e} ± {error:.1e}", constant.value)))
        });
        self.left_out = self.left_out.take().or(unknown);
    }
}

/// Fits a law by least squares on ln da/dN.
pub(super) fn fit(kind: GrowthLawKind, given: &Given, rows: &[RateRow]) -> LawFit {
    let candidate = match Candidate::new(kind, given, rows) {
        Ok(candidate) => candidate,
        Err(why) => return LawFit::none(kind, why),
    };
    let free: Vec<Parameter> = candidate.free().copied().collect();
    // C, the others and the scatter.
    if rows.len() < free.len() + 3 {
        return LawFit::none(kind, format!("{} rates are too few for its {} constants", rows.len(), free.len() + 1));
    }
    let measured: Vec<f64> = rows.iter().map(RateRow::log_rate).collect();
    let bounds: Vec<[f64; 2]> = free.iter().map(|parameter| parameter.bounds).collect();
    let shape = |variables: &[f64]| candidate.shape(variables);
    if candidate.shape(&free.iter().map(|parameter| parameter.starts[0]).collect::<Vec<_>>()).is_none() {
        return LawFit::none(kind, "its given constants predict arrest or fracture within the data".to_owned());
    }
    let minima = starts(&free).into_par_iter().filter_map(|start| minimise(&shape, &measured, &start, &bounds));
    let Some(best) = minima.min_by(|a, b| a.sum().total_cmp(&b.sum())) else {
        return LawFit::none(kind, "the least-squares fit did not converge".to_owned());
    };
    let scatter = best.sum() / (rows.len() - free.len() - 1) as f64;
    let trouble = at_end(&free, &best).or_else(|| trade(&free, &best.slopes));
    let errors = errors(&candidate, &best, scatter);
    let c = Constant { key: kind.0.constants[0].key, value: best.level.exp(), error: Some(best.level.exp() * errors[0]) };
    let is_free = |key: &str| free.iter().any(|parameter| parameter.key == key);
    let others = candidate.constants(&best.at).into_iter().enumerate();
    let others = others.map(|(i, (key, value))| Constant { key, value, error: is_free(key).then(|| errors[i + 1]) });
    LawFit {
        kind,
        constants: std::iter::once(c).chain(others).collect(),
        fitted: free.len() + 1,
        residuals: best.residuals,
        aicc: f64::NAN,
        left_out: trouble,
        lacks: None,
    }
}

fn starts(free: &[Parameter]) -> Vec<Vec<f64>> {
    free.iter().fold(vec![Vec::new()], |all, parameter| {
        let [first, second] = parameter.starts;
        let values = if first == second { vec![first] } else { vec![first, second] };
        all.iter().flat_map(|start| values.iter().map(|value| [&start[..], &[*value]].concat())).collect()
    })
}

fn at_end(free: &[Parameter], best: &Minimum) -> Option<String> {
    let (parameter, low) = free.iter().zip(&best.at).find_map(|(parameter, &value)| {
        let [low, high] = parameter.bounds;
        let near = AT_END * (high - low);
        (value - low < near || high - value < near).then_some((parameter, value - low < near))
    })?;
    let end = match (parameter.role, low) {
        (Role::Toughness, true) => "the largest K_max of the rates".to_owned(),
        (Role::Toughness, false) => "19 times the largest K_max of the rates".to_owned(),
        (Role::Threshold, true) => "a twentieth of the smallest ΔK of the rates".to_owned(),
        (Role::Threshold, false) => "the smallest ΔK of the rates".to_owned(),
        (Role::Plain, low) => format!("{}", parameter.bounds[usize::from(!low)]),
    };
    Some(unidentified(parameter, &format!("best fit at the limit of its range, {end}")))
}

/// Why a law is out of question, the key of the constant first.
fn unidentified(parameter: &Parameter, why: &str) -> String {
    format!("{} cannot be determined: {why}; {}, or set it in fit.given", parameter.key, parameter.needs.0)
}

/// A constant that others can make up for.
fn trade(free: &[Parameter], slopes: &DMatrix<f64>) -> Option<String> {
    let mut scaled = without_level(slopes);
    for (i, parameter) in free.iter().enumerate() {
        let size = scaled.column(i).norm();
        if size <= f64::EPSILON {
            return Some(unidentified(parameter, "no rate depends on it"));
        }
        scaled.column_mut(i).scale_mut(1.0 / size);
    }
    if free.is_empty() {
        return None;
    }
    let eigen = (scaled.transpose() * scaled).symmetric_eigen();
    let (least, most) = (eigen.eigenvalues.imin(), eigen.eigenvalues.max());
    let parameter = &free[eigen.eigenvectors.column(least).icamax()];
    (eigen.eigenvalues[least] < SINGULAR * most).then(|| unidentified(parameter, "other constants compensate for it"))
}

/// Standard errors of ln C and of all constants behind it, from `s² (JᵀJ)⁻¹`, taken from the variables to the constants by their slopes.
fn errors(candidate: &Candidate<'_>, best: &Minimum, scatter: f64) -> Vec<f64> {
    let projected = without_level(&best.slopes);
    let own = candidate.constants(&best.at);
    let Some(covariance) = (projected.transpose() * &projected).try_inverse().map(|inverse| inverse * scatter) else {
        return vec![f64::INFINITY; own.len() + 1];
    };
    let means = best.slopes.row_mean();
    let level = scatter / best.residuals.len() as f64 + (&means * &covariance * means.transpose())[(0, 0)];
    let mut turn = DMatrix::zeros(own.len(), best.at.len());
    for variable in 0..best.at.len() {
        let size = 1e-6 * best.at[variable].abs().max(1.0);
        let mut moved = best.at.clone();
        moved[variable] += size;
        for (i, (_, value)) in candidate.constants(&moved).into_iter().enumerate() {
            turn[(i, variable)] = (value - own[i].1) / size;
        }
    }
    let of_constants = &turn * covariance * turn.transpose();
    std::iter::once(level).chain(of_constants.diagonal().iter().copied()).map(|square| square.max(0.0).sqrt()).collect()
}

/// Constants that the user gives, by their keys.
pub type Given = BTreeMap<String, f64>;

/// Refuses constants that no law has, or beyond what it can have.
pub(super) fn check_given(given: &Given) -> Result<()> {
    // Walker has those of Paris, too.
    let known: Vec<&Parameter> = kinds().skip(1).flat_map(|kind| &kind.0.constants[1..]).collect();
    for (key, &value) in given {
        let path = format!("fit.given.{key}");
        let Some(constant) = known.iter().find(|constant| constant.key == key) else {
            let known: Vec<&str> = known.iter().map(|constant| constant.key).collect();
            let remedy = format!("use one of: {}; C is always fitted", known.join(", "));
            return Err(input(&path, value, "is not a constant that can be given", remedy));
        };
        constant.quantity.read(&path, value)?;
    }
    Ok(())
}

#[derive(Debug, Clone)]
struct Candidate<'a> {
    pub kind: GrowthLawKind,
    /// All constants but C, which is its level.
    constants: &'static [Parameter],
    given: Vec<Option<f64>>,
    rows: &'a [RateRow],
}

impl<'a> Candidate<'a> {
    /// The law over the rows.
    /// Errors: in words, why these rows say nothing about it.
    pub fn new(kind: GrowthLawKind, given: &Given, rows: &'a [RateRow]) -> std::result::Result<Self, String> {
        let constants = &kind.0.constants[1..];
        let values = constants.iter().map(|constant| given.get(constant.key).copied().or(constant.held)).collect();
        let candidate = Candidate { kind, constants, given: values, rows };
        let ratios = || rows.iter().map(|row| row.ratio.max(0.0));
        let (low, high) = (ratios().fold(f64::INFINITY, f64::min), ratios().fold(f64::NEG_INFINITY, f64::max));
        let lacks: Vec<&str> = candidate.free().filter(|constant| constant.needs.1).map(|constant| constant.key).collect();
        if high - low < SAME_RATIO && !lacks.is_empty() {
            let one = format!("all rates are at one stress ratio, R = {:.3}{}", rows[0].ratio, closed(rows));
            return Err(format!("{} cannot be determined: {one}; set in fit.given", lacks.join(", ")));
        }
        let least = rows.iter().map(|row| row.ratio).fold(f64::INFINITY, f64::min);
        if let Some((what, limit)) = kind.0.compression.filter(|(_, limit)| least < *limit) {
            return Err(format!("its {what} is not defined at R = {least}, below {limit}"));
        }
        let k_c = kind.0.place(Role::Toughness).and_then(|place| Some((constants[place - 1].key, candidate.given[place - 1]?)));
        if let Some((key, k_c)) = k_c.filter(|(_, k_c)| *k_c * MPA_SQRT_M <= candidate.k_max()) {
            return Err(format!("{key} = {k_c} is below the tested K_max = {:.3}", candidate.k_max() / MPA_SQRT_M));
        }
        Ok(candidate)
    }

    pub fn free(&self) -> impl Iterator<Item = &'static Parameter> {
        self.constants.iter().zip(&self.given).filter(|(_, given)| given.is_none()).map(|(constant, _)| constant)
    }

    fn k_max(&self) -> f64 {
        self.rows.iter().map(RateRow::k_max).fold(0.0, f64::max)
    }

    pub fn constants(&self, variables: &[f64]) -> Vec<(&'static str, f64)> {
        let mut variables = variables.iter();
        let raw: Vec<f64> =
            self.given.iter().map(|given| given.or_else(|| variables.next().copied()).unwrap_or(f64::NAN)).collect();
        let value = |(i, constant): (usize, &'static Parameter)| match constant.role {
            Role::Toughness if self.given[i].is_none() => self.k_max() / MPA_SQRT_M * (1.0 + raw[i].exp()),
            Role::Threshold if self.given[i].is_none() => self.threshold_max(&raw) / MPA_SQRT_M / (1.0 + (-raw[i]).exp()),
            _ => raw[i],
        };
        self.constants.iter().enumerate().map(|one| (one.1.key, value(one))).collect()
    }

    /// Threshold, Pa√m, at which the first of the rows stands still.
    fn threshold_max(&self, raw: &[f64]) -> f64 {
        let unit = |(constant, &raw): (&Parameter, &f64)| if constant.role == Role::Threshold { 1.0 } else { raw };
        let unit = self.law(self.constants.iter().zip(raw).map(unit));
        let most =
            |row: &RateRow| (1.0 - row.ratio) * row.k_max() / (self.kind.0.threshold)(&unit.constants, row.ratio) * MPA_SQRT_M;
        self.rows.iter().map(most).fold(f64::INFINITY, f64::min)
    }

    /// The law with C = 1 mm/cycle.
    fn law(&self, others: impl Iterator<Item = f64>) -> FactorLaw {
        self.kind.0.of(std::iter::once(1.0).chain(others))
    }

    /// ln of the rates (mm/cycle) at C = 1; `None` where a row has none.
    pub fn shape(&self, variables: &[f64]) -> Option<Vec<f64>> {
        let law = self.law(self.constants(variables).into_iter().map(|(_, value)| value));
        let rate = |row: &RateRow| Some((law.rate(row.k_max(), row.ratio) / MM_PER_CYCLE).ln()).filter(|rate| rate.is_finite());
        self.rows.iter().map(rate).collect()
    }
}

/// Why rates at several negative ratios count as one.
fn closed(rows: &[RateRow]) -> &'static str {
    let differ = rows.iter().any(|row| (row.ratio - rows[0].ratio).abs() >= SAME_RATIO);
    if differ { ", R < 0 treated as 0" } else { "" }
}
