//! Life by hand calculation: handbook K(a) of a standard specimen, growth law, quadrature.
//!
//! `N(a) = ∫ da / (da/dN)` from the initial crack length, by the law over K of the case; no growth at or below the threshold. Costs less than a millisecond.

use super::end_of_life::{End, first_end};
use super::record::{CurvePoint, StopReason, TipRecord};
use super::{CrackGrowth, GrowthStatus, State};
use crate::case::Case;
use crate::error::{Error, Result, input_missing};
use crate::fatigue::crack_tip::TipState;
use crate::fatigue::growth_law::GrowthLaw;
use crate::quadrature::integrate;
use crate::specimen::geometry::along;
use crate::specimen::handbook::{HandbookFormula, handbook};
use crate::units::MM;

/// Intervals of the a-N curve, their lengths in constant ratio: what is taken linear between two rows is then off by less than
/// 1e-4 of life.
const INTERVALS: usize = 256;
/// Relative error of the cycles of each interval.
const TOLERANCE: f64 = 1e-10;

/// [`CrackGrowth`] by the K of a handbook, one interval a block.
pub struct HandCalculation<'a> {
    case: &'a Case,
    formula: HandbookFormula,
    law: Box<dyn GrowthLaw>,
    /// Where growth ends at the latest: the given ends, or the plate in two.
    end: End,
    curve: Vec<CurvePoint>,
}

impl<'a> HandCalculation<'a> {
    /// Growth of the crack of a case of method `handbook`.
    /// Errors: no handbook formula.
    pub fn start(case: &'a Case, law: Box<dyn GrowthLaw>) -> Result<Self> {
        let formula = handbook(&case.specimen)
            .ok_or_else(|| input_missing("model.method", "\"handbook\" has no K(a) for this specimen", "use \"peridynamics\""))?;
        let severed = End { crack_length: case.specimen.length_limit().0, reason: StopReason::Severed };
        Ok(HandCalculation { case, formula, law, end: first_end(case).unwrap_or(severed), curve: Vec::new() })
    }

    fn last(&self) -> &CurvePoint {
        // `open` makes the first row, before the first block.
        &self.curve[self.curve.len() - 1]
    }

    /// da/dN, m/cycle.
    fn rate(&self, crack_length: f64) -> f64 {
        self.law.rate(self.formula.k_i(crack_length, self.case.loading.maximum), self.case.loading.ratio)
    }

    /// Cycles between two crack lengths.
    fn cycles(&self, from: f64, to: f64) -> f64 {
        integrate(|a| 1.0 / self.rate(a), from, to, TOLERANCE).value
    }

    /// Crack length `cycles` after `from`, which lies below `to`: halved until no double is left between.
    fn length_after(&self, cycles: f64, from: f64, to: f64) -> f64 {
        let (mut below, mut above) = (from, to);
        loop {
            let middle = 0.5 * (below + above);
            if middle <= below || middle >= above {
                return below;
            }
            if self.cycles(from, middle) > cycles { above = middle } else { below = middle }
        }
    }

    /// Row of the curve; K and rate are unknown (NaN) where the plate ends.
    fn point(&self, cycles: f64, crack_length: f64) -> CurvePoint {
        let (specimen, loading) = (&self.case.specimen, &self.case.loading);
        let delta_k = self.formula.delta_k(crack_length, loading.maximum, loading.range_share());
        let growth = crack_length - specimen.crack_length;
        let ahead =
            |seed: &crate::specimen::TipSeed| along(seed.position, [0, 1].map(|i| seed.position[i] + seed.direction[i]), growth);
        CurvePoint {
            is_solved: true,
            cycles,
            crack_length,
            delta_k,
            growth_rate: self.rate(crack_length),
            work: f64::NAN,
            limit_load: self.case.limit_load_at(crack_length),
            broken_bonds: 0,
            tips: specimen
                .tips
                .iter()
                .map(|seed| TipRecord {
                    state: TipState::Active,
                    position: ahead(seed),
                    growth,
                    factors: Some([delta_k / loading.range_share(), 0.0]),
                    t_stress: None,
                })
                .collect(),
            depth: None,
        }
    }

    /// The next interval of the curve; the reason why there is none after it.
    /// Errors: a growth rate that is no number.
    pub fn next_interval(&mut self) -> Result<Option<StopReason>> {
        let (start, End { crack_length: end, reason }) = (self.case.specimen.crack_length, self.end);
        let (done, last) = (self.curve.len(), self.last());
        if done > INTERVALS || end <= start {
            return Ok(Some(reason));
        }
        // K of every formula rises with crack length: a crack above the threshold at its start stays above it.
        if self.curve[0].growth_rate == 0.0 {
            return Ok(Some(StopReason::NothingAges));
        }
        let to = if done == INTERVALS { end } else { start * (end / start).powf(done as f64 / INTERVALS as f64) };
        let (from, before, cycles_max) = (last.crack_length, last.cycles, self.case.stop.cycles_max);
        let more = self.cycles(from, to);
        if more.is_nan() {
            return Err(Error::Mechanics(format!(
                "{}: the growth rate between {:.4} mm and {:.4} mm is no number",
                self.case.name,
                from / MM,
                to / MM
            )));
        }
        if before + more > cycles_max {
            let reached = self.length_after(cycles_max - before, from, to);
            self.curve.push(self.point(cycles_max, reached));
            return Ok(Some(StopReason::RunOut));
        }
        self.curve.push(self.point(before + more, to));
        Ok((done == INTERVALS).then_some(reason))
    }
}

impl CrackGrowth for HandCalculation<'_> {
    fn open(&mut self) -> Result<()> {
        self.curve = vec![self.point(0.0, self.case.specimen.crack_length)];
        Ok(())
    }

    fn now(&self) -> GrowthStatus<'_> {
        let CurvePoint { cycles, crack_length, delta_k, limit_load, ref tips, .. } = *self.last();
        GrowthStatus { cycles, crack_length, delta_k, limit_load, tips }
    }

    fn law(&self) -> Option<&dyn GrowthLaw> {
        Some(&*self.law)
    }

    fn state(&self) -> State {
        State::Rows(self.curve.clone())
    }

    fn restore(&mut self, state: State) -> Result<bool> {
        let State::Rows(curve) = state else { return Ok(false) };
        let fits = !curve.is_empty();
        self.curve = curve;
        Ok(fits)
    }

    fn curve(&mut self) -> Vec<CurvePoint> {
        std::mem::take(&mut self.curve)
    }

    /// How much of the life the formula is not made for.
    fn warnings(&self) -> Vec<String> {
        let life = self.curve.last().map_or(0.0, |point| point.cycles);
        let outside: f64 = self
            .curve
            .windows(2)
            .filter(|pair| !pair.iter().all(|point| self.formula.holds_at(point.crack_length)))
            .map(|pair| pair[1].cycles - pair[0].cycles)
            .sum();
        let HandbookFormula { name, range, .. } = self.formula;
        let words = || format!("{:.2} % of the life lies outside the range of {name} ({range})", 100.0 * outside / life);
        // A share that shows in no life is not worth a word.
        (outside > 1e-3 * life).then(words).into_iter().collect()
    }
}
