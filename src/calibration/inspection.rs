//! What is left of a life from a crack length on, and how often to inspect.

use serde::{Deserialize, Serialize};

use crate::population::plate::Quantiles;
use perilife_base::error::{Result, fail_if, input};
use perilife_base::monotone::Monotone;
use perilife_base::units::MM;
use perilife_growth::case::Case;
use perilife_growth::predict::Prediction;

/// Factor of the inspection interval: three looks before the end.
pub const FACTOR: f64 = 3.0;

/// What is left of a life from a crack length on, and an inspection interval.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = Remaining))]
pub struct Inspection {
    /// Crack length today: of a plate that of the crack of `tip`.
    pub crack_length_mm: f64,
    /// The tip of a plate whose crack that is.
    pub tip: Option<usize>,
    /// Crack length of the curve then: in a plate with several cracks that of the one that ends its life.
    pub crack_length_governing_mm: f64,
    /// Cycles at which the curve reaches that length.
    pub cycles_at: f64,
    pub life_cycles: f64,
    /// From there to the end.
    pub remaining_cycles: f64,
    /// Cycles that 5 % of specimens do not live on; null without a band.
    pub remaining_cycles_p05: Option<f64>,
    /// Median of the specimens.
    pub remaining_cycles_p50: Option<f64>,
    /// Cycles that 95 % do not live on.
    pub remaining_cycles_p95: Option<f64>,
    /// What the remaining life is divided by.
    pub factor: f64,
    /// The 5 % remaining life over the factor; without a band remaining cycles over the factor.
    pub inspection_interval_cycles: f64,
    /// Whether there is a band, from which the interval comes.
    pub has_band: bool,
    /// Whether the plate lives on where its curve ends: at a hole, where cracks have joined, or at stop.cycles_max.
    pub life_is_lower_bound: bool,
}

/// From which crack length on a plate is inspected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InspectFrom {
    /// Crack length, mm: in the convention of a standard specimen, in a plate the length of the crack of a tip.
    pub crack_length_mm: f64,
    /// The tip of a plate; the one that ends its life where it is left out.
    pub tip: Option<usize>,
    /// What the remaining life is divided by.
    pub factor: f64,
    /// What the user calls length, factor and tip.
    pub names: [&'static str; 3],
}

impl InspectFrom {
    pub fn check(&self) -> Result<()> {
        if self.factor.is_finite() && self.factor >= 1.0 {
            return Ok(());
        }
        Err(input(self.names[1], self.factor, "is not 1 or more", format!("give for example {FACTOR}")))
    }
}

/// Lengths of the crack of every tip of a plate over the rows of its curve, mm.
#[derive(Debug, Clone, PartialEq)]
pub struct TipLengths {
    /// By tip; empty of the end of a slot.
    pub lengths: Vec<Vec<f64>>,
    pub leads: usize,
}

impl TipLengths {
    /// Of a run; `None` of a standard specimen, whose crack length is that of its convention.
    pub fn of_run(case: &Case, prediction: &Prediction) -> Option<Self> {
        let (leads, _) = prediction.leading_tip(&case.specimen)?;
        let of_tip = |tip: usize| {
            let lengths = prediction.curve.iter().map(|row| row.crack_length_of(&case.specimen, tip).map(|length| length / MM));
            lengths.collect::<Option<Vec<f64>>>().unwrap_or_default()
        };
        Some(TipLengths { lengths: (0..case.specimen.tips.len()).map(of_tip).collect(), leads })
    }

    /// The tip that is meant, and crack length and cycles of the curve when its crack has the length that was asked for.
    /// Errors: no such tip, a length that its crack does not come to.
    fn of_curve(&self, curve: &[[f64; 2]], from: InspectFrom) -> Result<(usize, [f64; 2])> {
        let tip = from.tip.unwrap_or(self.leads);
        let Some(lengths) = self.lengths.get(tip).filter(|lengths| !lengths.is_empty()) else {
            let problem = format!("is not a crack tip of this plate, which has {}", self.lengths.len());
            return Err(input(from.names[2], tip, problem, "count tips from 0, as in a_n.csv"));
        };
        let (shortest, longest) = (lengths[0], lengths[lengths.len() - 1]);
        let length = from.crack_length_mm;
        let problem = || format!("is not on the curve: the crack of tip {tip} has {shortest:.4} to {longest:.4} mm");
        let remedy = "give a length between them, or another tip";
        fail_if!(!(shortest..=longest).contains(&length), input(from.names[0], format!("{length} mm"), problem(), remedy));
        let after = lengths.partition_point(|known| *known < length).clamp(1, lengths.len() - 1);
        let (a, b) = (lengths[after - 1], lengths[after]);
        let share = if b > a { (length - a) / (b - a) } else { 1.0 };
        let of_curve = curve[after - 1][0] + share * (curve[after][0] - curve[after - 1][0]);
        let cycles = Monotone::new(lengths.iter().zip(curve).map(|(length, [_, cycles])| [*length, *cycles])).at(length);
        Ok((tip, [of_curve, cycles]))
    }
}

impl Inspection {
    /// Of a curve, crack length in mm and cycles, with at least one row; `left` is what is left at its rows.
    /// Errors: a length that is not on the curve, a factor below 1, a tip that is none.
    pub fn of(
        curve: &[[f64; 2]],
        tips: Option<&TipLengths>,
        left: Option<&[Quantiles]>,
        from: InspectFrom,
        is_lower_bound: bool,
    ) -> Result<Self> {
        from.check()?;
        let of_tip = tips.map(|tips| tips.of_curve(curve, from)).transpose()?;
        let problem = "applies only to kind = \"plate\"; this specimen has one crack length";
        let remedy = "remove it";
        fail_if!(let (None, Some(tip)) = (of_tip, from.tip), input(from.names[2], tip, problem, remedy));
        let (length, end) = (of_tip.map_or(from.crack_length_mm, |(_, [length, _])| length), curve[curve.len() - 1]);
        let (shortest, longest) = (curve[0][0], end[0]);
        let problem = || format!("is not on the curve, {shortest} to {longest} mm");
        let remedy = "give a length between them";
        fail_if!(!(shortest..=longest).contains(&length), input(from.names[0], format!("{length} mm"), problem(), remedy));
        let cycles_at = of_tip.map_or_else(|| Monotone::new(curve.iter().copied()).at(length), |(_, [_, cycles])| cycles);
        let remaining = end[1] - cycles_at;
        Ok(Inspection {
            crack_length_mm: from.crack_length_mm,
            tip: of_tip.map(|(tip, _)| tip),
            crack_length_governing_mm: length,
            cycles_at,
            life_cycles: end[1],
            remaining_cycles: remaining,
            remaining_cycles_p05: None,
            remaining_cycles_p50: None,
            remaining_cycles_p95: None,
            factor: from.factor,
            inspection_interval_cycles: remaining / from.factor,
            has_band: false,
            life_is_lower_bound: is_lower_bound,
        }
        .with(left.and_then(|left| between(curve, left, length, remaining))))
    }

    /// The same with quantiles of the remaining life.
    pub fn with(self, quantiles: Option<Quantiles>) -> Self {
        let Some([low, middle, high]) = quantiles else { return self };
        Inspection {
            remaining_cycles_p05: Some(low),
            remaining_cycles_p50: Some(middle),
            remaining_cycles_p95: Some(high),
            inspection_interval_cycles: low / self.factor,
            has_band: true,
            ..self
        }
    }

    /// Quantiles of the remaining life, where there is a band.
    pub fn quantiles(&self) -> Option<Quantiles> {
        Some([self.remaining_cycles_p05?, self.remaining_cycles_p50?, self.remaining_cycles_p95?])
    }
}

/// Quantiles of what is left at a length between rows: their ratio to the cycles of the run is linear between them.
fn between(curve: &[[f64; 2]], left: &[Quantiles], length: f64, remaining: f64) -> Option<Quantiles> {
    let end = curve[curve.len() - 1][1];
    let ratio = |i: usize| left[i].map(|cycles| cycles / (end - curve[i][1]));
    let last = curve.iter().rposition(|row| row[1] < end)?;
    let before = curve.partition_point(|row| row[0] <= length).saturating_sub(1).min(last);
    let after = (before + 1).min(last);
    let (a, b) = (curve[before][0], curve[after][0]);
    let share = if b > a { ((length - a) / (b - a)).clamp(0.0, 1.0) } else { 0.0 };
    let (from, to) = (ratio(before), ratio(after));
    let found = [0, 1, 2].map(|k| remaining * (from[k] + share * (to[k] - from[k])));
    found.iter().all(|cycles| cycles.is_finite()).then_some(found)
}
