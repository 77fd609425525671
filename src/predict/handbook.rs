//! Life by hand calculation: handbook K(a) of a standard specimen, Paris law, quadrature.
//!
//! `N(a) = ∫ da / (da/dN)` from the initial crack length, by the law over K of the case; no growth at or below the threshold. Costs less than a millisecond.

use std::time::Instant;

use super::end_of_life::{End, first_end};
use super::{
    CurvePoint, Observer, PointGrid, Prediction, Progress, RunFigures, StopReason, TipRecord, laws, memory, plastic_zone,
};
use crate::case::Case;
use crate::error::{Error, Result, input_missing};
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

/// Predicts the a-N curve of a case of method `handbook`.
///
/// # Errors
/// No fatigue law, no handbook formula, or a life beyond numbers.
pub(super) fn run(case: &Case, observer: &dyn Observer) -> Result<Prediction> {
    let started = Instant::now();
    let growth = Growth::of(case)?;
    let (curve, stop) = growth.curve()?;
    curve[..curve.len() - 1].iter().chain(&curve[..1]).try_for_each(|row| laws::check_within(case, &*growth.law, row))?;
    let mut warnings = growth.warnings(&curve);
    warnings.extend(laws::beyond_warning(case, &*growth.law, &curve));
    warnings.extend(plastic_zone::warnings(case, &curve));
    let prediction = Prediction {
        figures: figures(curve.len() - 1, started),
        curve,
        stop,
        snapshots: Vec::new(),
        grid: PointGrid { spacing: f64::NAN, columns: 0, rows: 0, origin: [0.0; 2], angle: 0.0, point_at: Vec::new() },
        warnings,
    };
    let progress = Progress { cycles: prediction.life_cycles(), crack_length: prediction.crack_length_final(), share: 1.0 };
    // The run is over: nothing is left to cancel.
    let _ = observer.block_done(&progress);
    Ok(prediction)
}

/// Figures of a run without points; the rows of the curve are its blocks.
fn figures(blocks: usize, started: Instant) -> RunFigures {
    RunFigures {
        points: 0,
        points_solved: 0,
        bonds: 0,
        blocks,
        solves: 0,
        iterations: 0,
        spacing: f64::NAN,
        horizon: f64::NAN,
        wall_s: started.elapsed().as_secs_f64(),
        memory_mb: memory::peak_mb(),
    }
}

/// Growth of the crack of one case.
struct Growth<'a> {
    case: &'a Case,
    formula: HandbookFormula,
    law: Box<dyn GrowthLaw>,
}

impl<'a> Growth<'a> {
    fn of(case: &'a Case) -> Result<Self> {
        let formula = handbook(&case.specimen)
            .ok_or_else(|| input_missing("model.method", "\"handbook\" has no K(a) for this specimen", "use \"peridynamics\""))?;
        Ok(Growth { case, formula, law: laws::growth_law(case)? })
    }

    fn k_max(&self, crack_length: f64) -> f64 {
        self.formula.k_i(crack_length, self.case.loading.maximum)
    }

    /// da/dN, m/cycle.
    fn rate(&self, crack_length: f64) -> f64 {
        self.law.rate(self.k_max(crack_length), self.case.loading.ratio)
    }

    /// Cycles between two crack lengths.
    fn cycles(&self, from: f64, to: f64) -> f64 {
        integrate(|a| 1.0 / self.rate(a), from, to, TOLERANCE).value
    }

    /// Where growth ends at the latest: the given ends, or the plate in two.
    fn end(&self) -> End {
        let severed = End { crack_length: self.case.specimen.length_limit().0, reason: StopReason::Severed };
        first_end(self.case).unwrap_or(severed)
    }

    /// The a-N curve and why it ends.
    fn curve(&self) -> Result<(Vec<CurvePoint>, StopReason)> {
        let (start, end) = (self.case.specimen.crack_length, self.end());
        let mut curve = vec![self.point(0.0, start)];
        if end.crack_length <= start {
            return Ok((curve, end.reason));
        }
        // K of every formula rises with crack length: a crack above the threshold at its start stays above it.
        if curve[0].growth_rate == 0.0 {
            return Ok((curve, StopReason::NothingAges));
        }
        let cycles_max = self.case.stop.cycles_max;
        let (mut cycles, mut from) = (0.0, start);
        for i in 1..=INTERVALS {
            let share = i as f64 / INTERVALS as f64;
            let to = if i == INTERVALS { end.crack_length } else { start * (end.crack_length / start).powf(share) };
            let more = self.cycles(from, to);
            if more.is_nan() {
                return Err(Error::Mechanics(format!(
                    "{}: the growth rate between {:.4} mm and {:.4} mm is no number",
                    self.case.name,
                    from / MM,
                    to / MM
                )));
            }
            if cycles + more > cycles_max {
                curve.push(self.point(cycles_max, self.length_after(cycles_max - cycles, from, to)));
                return Ok((curve, StopReason::RunOut));
            }
            cycles += more;
            curve.push(self.point(cycles, to));
            from = to;
        }
        Ok((curve, end.reason))
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
            cycles,
            crack_length,
            delta_k,
            growth_rate: self.rate(crack_length),
            work: f64::NAN,
            broken_bonds: 0,
            tips: specimen
                .tips
                .iter()
                .map(|seed| TipRecord { position: ahead(seed), growth, factors: Some([delta_k / loading.range_share(), 0.0]) })
                .collect(),
        }
    }

    /// What speaks against the formula.
    fn warnings(&self, curve: &[CurvePoint]) -> Vec<String> {
        let life = curve.last().map_or(0.0, |point| point.cycles);
        let outside: f64 = curve
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
