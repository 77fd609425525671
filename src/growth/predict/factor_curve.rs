//! K of a growing crack against its length, by the field of its tip: what a calibration integrates laws over, and what the
//! constant of a law of bonds is measured against.
//!
//! The path of a crack does not depend on C, and that of a single tip not on m either, so one run serves every pair of C and m. Of several
//! tips the faster ones grow the farther ahead of the others the larger m is.

use super::{CurvePoint, GoverningCrack, Observer, Prediction, RunFigures, StopReason, TipRecord, predict};
use crate::case::{Case, LawSource};
use crate::cracks::steering::equivalent_factor;
use perilife_base::blended::Blended;
use perilife_base::error::{Error, Result};
use perilife_base::units::MM;
use perilife_laws::Driver;
use perilife_laws::paris::ParisLaw;
use perilife_plate::specimen::{LengthConvention, Specimen};
use perilife_points::crack_tip::TipState;

/// Exponent of a run whose tips share its growth, where nothing better is known.
pub const EXPONENT_USUAL: f64 = 3.0;
/// Difference of ln K between tips that grow alike.
const ALIKE: f64 = 0.01;

/// K_eq at maximum load over crack length; where K does not follow the load in proportion, the one whose range at the ratio of the load is ΔK.
#[derive(Debug, Clone, PartialEq)]
pub struct FactorCurve {
    /// Of every tip whose growth adds to the length of the governing crack; of a standard specimen the fastest stands for all.
    tips: Vec<TipFactors>,
    /// Whether tips of unlike K, of this crack or of others, share the growth, so that the path depends on the exponent.
    pub depends_on_exponent: bool,
    pub figures: RunFigures,
    /// What the user should know about that run.
    pub warnings: Vec<String>,
}

/// K of a tip while it grows, between the rows of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TipFactors {
    /// ln of K_eq, K in Pa√m, over crack length, m.
    logarithms: Blended,
}

impl FactorCurve {
    /// Of a case, whatever its driver, law, threshold and limit of cycles, up to `stop.crack_length`.
    /// Errors: as [`super::predict`]; a run that ends before that length.
    pub fn of(case: &Case, observer: &dyn Observer) -> Result<Self> {
        Self::at_exponent(case, EXPONENT_USUAL, observer)
    }

    /// The same, several tips growing by this exponent.
    pub fn at_exponent(case: &Case, m: f64, observer: &dyn Observer) -> Result<Self> {
        let done = unit_growth(case, m, observer)?;
        let (tips, is_shared) = match case.specimen.convention {
            LengthConvention::MeanOfTips => {
                let of_row = |row: &CurvePoint| (row.crack_length, row.delta_k / case.loading.range_share());
                (vec![TipFactors::new(solved(&done.curve).map(of_row))], false)
            }
            LengthConvention::SumOfTips => {
                let ratio = case.loading.ratio;
                (of_every_tip(&case.specimen, &done.curve, ratio), solved(&done.curve).any(|row| is_unlike(row, ratio)))
            }
        };
        Ok(FactorCurve { tips, depends_on_exponent: is_shared, figures: done.figures, warnings: done.warnings })
    }

    /// Crack length at which it begins, m.
    pub fn start(&self) -> f64 {
        self.tips.iter().map(|tip| tip.lengths()[0]).fold(f64::INFINITY, f64::min)
    }

    /// K_eq at maximum load, Pa√m, at a crack length, m, of the fastest tip.
    pub fn at(&self, length: f64) -> f64 {
        self.of_tips(length).into_iter().fold(f64::NAN, f64::max)
    }

    /// K_eq at maximum load, Pa√m, at a crack length, m, of every tip that grows there.
    pub fn of_tips(&self, length: f64) -> Vec<f64> {
        let last = self.tips.iter().filter_map(|tip| tip.lengths().last()).copied().fold(0.0, f64::max);
        // Beyond the last row by a rounding, K goes on.
        let grows = |tip: &&TipFactors| {
            let lengths = tip.lengths();
            (lengths[0] * (1.0 - 1e-9)..=lengths[lengths.len() - 1] * (1.0 + 1e-9)).contains(&length.min(last))
        };
        self.tips.iter().filter(grows).map(|tip| tip.at(length)).collect()
    }
}

/// The run of a case up to `stop.crack_length` in which every tip grows by K^m, whatever its driver, law, threshold and limit of cycles.
/// Errors: as [`predict`]; a run that ends before that length.
pub(super) fn unit_growth(case: &Case, m: f64, observer: &dyn Observer) -> Result<Prediction> {
    let mut case = case.clone();
    // A crack that goes straight takes the same steps with all laws.
    let m = if case.specimen.convention == LengthConvention::SumOfTips { m } else { 1.0 };
    case.law = LawSource::Paris(ParisLaw { c: 1.0, m });
    case.fatigue.driver = Driver::TipField;
    (case.fatigue.threshold, case.fatigue.walker_gamma) = (0.0, 1.0);
    case.stop.cycles_max = f64::INFINITY;
    let done = predict(&case, observer)?;
    if done.stop != StopReason::CrackLengthReached {
        return Err(Error::Mechanics(format!(
            "{}: the crack ended as {} at a length of {:.3} mm, before {:.3} mm, to which its K is needed",
            case.name,
            done.stop,
            done.crack_length_final() / MM,
            case.stop.crack_length / MM
        )));
    }
    Ok(done)
}

/// Rows whose K was solved for, and the last one: between them the curve is smooth, and rows there are what a run made of it on its way.
pub(super) fn solved(curve: &[CurvePoint]) -> impl Iterator<Item = &CurvePoint> {
    let last = curve.len().saturating_sub(1);
    curve.iter().enumerate().filter(move |(index, row)| row.is_solved || *index == last).map(|(_, row)| row)
}

/// K of every tip of the governing crack over the rows in which it grows.
fn of_every_tip(specimen: &Specimen, curve: &[CurvePoint], ratio: f64) -> Vec<TipFactors> {
    let (count, governing) = (curve.first().map_or(0, |row| row.tips.len()), GoverningCrack::of(specimen, curve));
    let of_tip = |tip: usize| {
        let factor = |row: &CurvePoint| Some((governing.length(row), growing_factor(&row.tips[tip], ratio)?));
        TipFactors::new(solved(curve).filter_map(factor))
    };
    (0..count).filter(|tip| governing.has(*tip)).map(of_tip).filter(|tip| tip.lengths().len() > 1).collect()
}

/// K_eq of a tip that grows, as [`FactorCurve`] has it.
fn growing_factor(record: &TipRecord, ratio: f64) -> Option<f64> {
    let factor = equivalent_factor(record.factors.filter(|_| record.state == TipState::Active)?);
    Some(factor * record.response.range_share(ratio) / (1.0 - ratio.max(0.0))).filter(|factor| *factor > 0.0)
}

/// Whether tips of unlike K grow in a row.
fn is_unlike(row: &CurvePoint, ratio: f64) -> bool {
    let factors: Vec<f64> = row.tips.iter().filter_map(|tip| growing_factor(tip, ratio)).collect();
    let (low, high) = factors.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), k| (low.min(*k), high.max(*k)));
    factors.len() > 1 && (high / low).ln() > ALIKE
}

impl TipFactors {
    /// Of its rows, at least two: lengths that rise, m, and K, Pa√m.
    pub fn new(rows: impl Iterator<Item = (f64, f64)>) -> Self {
        TipFactors { logarithms: Blended::new(rows.map(|(length, k)| (length, k.ln()))) }
    }

    fn lengths(&self) -> &[f64] {
        self.logarithms.x()
    }

    /// K at a length: its logarithm is smooth between rows ([`Blended`]).
    pub fn at(&self, length: f64) -> f64 {
        self.logarithms.at(length).exp()
    }
}
