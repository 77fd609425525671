//! What a life means that began with a crack that does not go through: when it was through, what the error of its K does to it, and how much of it
//! lies where that error is not stated.

use super::CurvePoint;
use super::laws::growth_law;
use crate::case::Case;
use perilife_plate::specimen::part_through::{Limit, STATED_ERROR};

/// The part of a life before break-through.
#[derive(Debug, Clone)]
pub struct PartThroughLife {
    /// Cycles until the crack is through, or to the end of the run.
    pub cycles: f64,
    /// Semi-axes a and c then, m.
    pub axes: [f64; 2],
    pub is_through: bool,
    /// The whole life over that of the run where K of the part-through crack is larger, and smaller, by its stated error: `∫ dN r(K)/r(K (1 ± e))` and what
    /// is left after break-through. Infinite where the crack would stand still.
    pub life_factors: [f64; 2],
    /// Ranges of the formulas that were left, and cycles spent there, most first.
    pub outside: Vec<(&'static Limit, f64)>,
    /// Cycles spent outside of any range.
    pub cycles_outside: f64,
}

impl PartThroughLife {
    /// Of the curve of a case; `None` of a crack that goes through from the start.
    pub fn of(case: &Case, curve: &[CurvePoint]) -> Option<Self> {
        let flaw = case.specimen.part_through?;
        let law = growth_law(case).ok()?;
        let axes = |row: &CurvePoint| row.depth.map(|depth| [depth.depth, row.crack_length]);
        let end = curve.iter().position(|row| !row.is_of_front()).unwrap_or(curve.len().saturating_sub(1));
        let (last, life) = (curve.get(end)?, curve.last()?.cycles);
        let mut found = PartThroughLife {
            cycles: last.cycles,
            axes: axes(last)?,
            is_through: axes(last)?[0] >= flaw.through_depth(),
            life_factors: [1.0; 2],
            outside: Vec::new(),
            cycles_outside: 0.0,
        };
        let mut scaled = [life - last.cycles; 2];
        for rows in curve[..=end].windows(2) {
            let cycles = rows[1].cycles - rows[0].cycles;
            // The last of these rows has K of the through crack.
            let k_max = rows[0].delta_k / case.loading.range_share();
            let (own, ratio) = (law.rate(k_max, case.loading.ratio), case.loading.ratio);
            // Where K is larger and smaller by its stated error.
            let factors = [1.0 + STATED_ERROR, 1.0 - STATED_ERROR]
                .map(|error| if own > 0.0 { own / law.rate(k_max * error, ratio) } else { 1.0 });
            scaled = [0, 1].map(|i| scaled[i] + cycles * factors[i]);
            found.count_outside(&flaw.limits_left(axes(&rows[0])?), cycles);
        }
        if life > 0.0 {
            found.life_factors = scaled.map(|cycles| cycles / life);
        }
        found.outside.sort_by(|a, b| b.1.total_cmp(&a.1));
        Some(found)
    }

    fn count_outside(&mut self, left: &[&'static Limit], cycles: f64) {
        for limit in left {
            match self.outside.iter_mut().find(|(known, _)| known.name == limit.name) {
                Some((_, sum)) => *sum += cycles,
                None => self.outside.push((limit, cycles)),
            }
        }
        self.cycles_outside += if left.is_empty() { 0.0 } else { cycles };
    }
}
