//! Laws as least squares sees them: constants that are searched, and the rates they give.
//! Two have limits that depend on the rows: [`Role`].

use std::collections::BTreeMap;

use super::kinds;
use perilife_base::error::{Result, input};
use perilife_base::units::{MM_PER_CYCLE, MPA_SQRT_M};
use perilife_laws::growth_law::description::{Constant, Role};
use perilife_laws::growth_law::{FactorLaw, GrowthLaw, GrowthLawKind};
use perilife_measured::RateRow;
use perilife_plate::loading::SAME_RATIO;

/// Constants that the user gives, by their keys.
pub type Given = BTreeMap<String, f64>;

/// Refuses constants that no law has, or beyond what it can have.
pub(super) fn check_given(given: &Given) -> Result<()> {
    // Walker has those of Paris, too.
    let known: Vec<&Constant> = kinds().skip(1).flat_map(|kind| &kind.0.constants[1..]).collect();
    for (key, &value) in given {
        let path = format!("fit.given.{key}");
        let Some(constant) = known.iter().find(|constant| constant.key == key) else {
            let known: Vec<&str> = known.iter().map(|constant| constant.key).collect();
            let remedy = format!("known here: {}; C is always fitted", known.join(", "));
            return Err(input(&path, value, "is no constant of a law that can be given", remedy));
        };
        constant.quantity.read(&path, value)?;
    }
    Ok(())
}

/// A law with some constants given, over some rows.
#[derive(Debug, Clone)]
pub(super) struct Candidate<'a> {
    pub kind: GrowthLawKind,
    /// All constants but C, which is its level.
    constants: &'static [Constant],
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
        let lacks: Vec<&str> =
            candidate.free().filter(|constant| constant.is_told_by_ratios()).map(|constant| constant.key).collect();
        if high - low < SAME_RATIO && !lacks.is_empty() {
            let one = format!("all rates are of one stress ratio, R = {:.3}{}", rows[0].ratio, closed(rows));
            return Err(format!("{} not identified: {one}; give by fit.given", lacks.join(", ")));
        }
        let least = rows.iter().map(|row| row.ratio).fold(f64::INFINITY, f64::min);
        if let Some((what, limit)) = kind.0.compression.filter(|(_, limit)| least < *limit) {
            return Err(format!("its {what} is not known at R = {least}, below {limit}"));
        }
        let k_c = kind.0.place(Role::Toughness).and_then(|place| Some((constants[place - 1].key, candidate.given[place - 1]?)));
        if let Some((key, k_c)) = k_c.filter(|(_, k_c)| *k_c * MPA_SQRT_M <= candidate.k_max()) {
            return Err(format!("{key} = {k_c} is given, and a crack grew at K_max = {:.3}", candidate.k_max() / MPA_SQRT_M));
        }
        Ok(candidate)
    }

    /// Constants that are searched.
    pub fn free(&self) -> impl Iterator<Item = &'static Constant> {
        self.constants.iter().zip(&self.given).filter(|(_, given)| given.is_none()).map(|(constant, _)| constant)
    }

    fn k_max(&self) -> f64 {
        self.rows.iter().map(RateRow::k_max).fold(0.0, f64::max)
    }

    /// Keys and values of all constants but C.
    pub fn constants(&self, variables: &[f64]) -> Vec<(&'static str, f64)> {
        let mut variables = variables.iter();
        let raw: Vec<f64> =
            self.given.iter().map(|given| given.or_else(|| variables.next().copied()).unwrap_or(f64::NAN)).collect();
        let value = |(i, constant): (usize, &'static Constant)| match constant.role {
            Role::Toughness if self.given[i].is_none() => self.k_max() / MPA_SQRT_M * (1.0 + raw[i].exp()),
            Role::Threshold if self.given[i].is_none() => self.threshold_max(&raw) / MPA_SQRT_M / (1.0 + (-raw[i]).exp()),
            _ => raw[i],
        };
        self.constants.iter().enumerate().map(|one| (one.1.key, value(one))).collect()
    }

    /// Threshold, Pa√m, at which the first of the rows stands still.
    fn threshold_max(&self, raw: &[f64]) -> f64 {
        let unit = |(constant, &raw): (&Constant, &f64)| if constant.role == Role::Threshold { 1.0 } else { raw };
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
    if differ { ", and negative ones count as 0: compression does not open a crack" } else { "" }
}
