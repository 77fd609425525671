//! K of a growing crack against its length, by the field of its tip: what a calibration integrates laws over, and what the
//! constant of a law of bonds is measured against.
//!
//! A crack that no law can turn aside, as that of a standard specimen, has one K(a) whatever its growth law, so one run serves
//! every pair of C and m.

use super::{Observer, RunFigures, StopReason, predict};
use crate::case::{Case, LawSource};
use crate::error::{Error, Result};
use crate::fatigue::Driver;
use crate::fatigue::paris::ParisLaw;
use crate::units::MM;

/// K_eq at maximum load over crack length.
#[derive(Debug, Clone, PartialEq)]
pub struct FactorCurve {
    lengths: Vec<f64>,
    /// ln of K_eq, K in Pa√m.
    logarithms: Vec<f64>,
    /// Figures of the run that it comes from.
    pub figures: RunFigures,
    /// What the user should know about that run.
    pub warnings: Vec<String>,
}

impl FactorCurve {
    /// Of a case, whatever its driver, law, threshold and limit of cycles, up to `stop.crack_length`.
    ///
    /// # Errors
    /// As [`super::predict`]; a run that ends before that length.
    pub fn of(case: &Case, observer: &dyn Observer) -> Result<Self> {
        let mut case = case.clone();
        // Any law will do: a crack that goes straight takes the same steps with all of them.
        case.law = LawSource::Paris(ParisLaw { c: 1.0, m: 1.0 });
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
        let share = case.loading.range_share();
        let (lengths, logarithms) = done.curve.iter().map(|row| (row.crack_length, (row.delta_k / share).ln())).unzip();
        Ok(FactorCurve { lengths, logarithms, figures: done.figures, warnings: done.warnings })
    }

    /// K_eq at maximum load, Pa√m, at a crack length, m: its logarithm on the parabolas through the two rows around it and the one
    /// before or behind, the nearer row's taken the more, so that value and slope are continuous.
    #[must_use]
    pub fn at(&self, length: f64) -> f64 {
        let last = self.lengths.len() - 1; // a run has its start and its end
        let before = self.lengths.partition_point(|&a| a < length).clamp(1, last) - 1;
        let share = (length - self.lengths[before]) / (self.lengths[before + 1] - self.lengths[before]);
        let left = self.through(before.saturating_sub(1)..=(before + 1), length);
        let right = self.through(before..=(before + 2).min(last), length);
        (left + share * (right - left)).exp()
    }

    /// The polynomial through some rows.
    fn through(&self, rows: std::ops::RangeInclusive<usize>, length: f64) -> f64 {
        let weight = |i: usize| {
            let others = rows.clone().filter(|&j| j != i);
            others.map(|j| (length - self.lengths[j]) / (self.lengths[i] - self.lengths[j])).product::<f64>()
        };
        rows.clone().map(|i| weight(i) * self.logarithms[i]).sum()
    }
}
