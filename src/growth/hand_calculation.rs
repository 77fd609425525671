//! Life by hand calculation: handbook K(a) of a standard specimen, or that of a table of β, growth law, quadrature.
//!
//! `N(a) = ∫ da / (da/dN)` from the initial crack length, by the law over K of the case; no growth at or below the threshold. Costs less than a millisecond.
//! The crack length of a `plate` is that of all cracks, whose n tips grow alike: `da = n × growth of a tip`.

use super::CrackGrowth;
use super::end_of_life::{self, End, first_end};
use super::record::{CurvePoint, StopReason, TipRecord};
use crate::case::Case;
use perilife_base::error::{Error, Result, input_missing};
use perilife_base::quadrature::integrate;
use perilife_base::units::MM;
use perilife_laws::growth_law::GrowthLaw;
use perilife_laws::response::Response;
use perilife_plate::loading::residual::ResidualStress;
use perilife_plate::specimen::LengthConvention;
use perilife_plate::specimen::green::centre_crack;
use perilife_plate::specimen::handbook::{HandbookFormula, handbook};
use perilife_points::crack_tip::TipState;

/// Intervals of the a-N curve, lengths in constant ratio: linear interpolation is off by less than 1e-4 of life.
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
    /// Tips whose growth adds up to that of the crack length.
    sharing: f64,
    /// K of residual stress over crack length, where there is one.
    residual: Option<FactorOfResidual>,
    curve: Vec<CurvePoint>,
}

/// K_res of a center crack at equally spaced lengths, by a cubic through four neighbors in between.
struct FactorOfResidual {
    from: f64,
    step: f64,
    factors: Vec<f64>,
}

impl FactorOfResidual {
    fn new(case: &Case, residual: &ResidualStress, to: f64) -> Self {
        let (from, width) = (case.specimen.crack_length, case.specimen.width);
        let step = (to - from) / INTERVALS as f64;
        let factor = |i: usize| {
            // Half of both sides: what is not symmetric was refused.
            let stress = |x: f64| 0.5 * (residual.at([x, 0.0])[1] + residual.at([-x, 0.0])[1]);
            let length = (from + step * (i as f64 - 1.0)).clamp(0.5 * from, 0.5 * width * (1.0 - 1e-9));
            centre_crack(length, width, stress)
        };
        FactorOfResidual { from: from - step, step, factors: (0..INTERVALS + 4).map(factor).collect() }
    }

    /// K_res, Pa√m, at a crack length, m (Catmull and Rom 1974).
    fn at(&self, crack_length: f64) -> f64 {
        let at = (crack_length - self.from) / self.step;
        let place = (at.floor().max(1.0) as usize).min(self.factors.len() - 3);
        let (t, of) = (at - place as f64, |i: usize| self.factors[place + i - 1]);
        let slopes = [0.5 * (of(2) - of(0)), 0.5 * (of(3) - of(1))];
        let (rise, u) = (of(2) - of(1), 1.0 - t);
        of(1) + t * rise + t * u * (u * (slopes[0] - rise) - t * (slopes[1] - rise))
    }
}

impl<'a> HandCalculation<'a> {
    /// Growth of the crack of a case of method `handbook`.
    /// Errors: no handbook formula.
    pub fn start(case: &'a Case, law: Box<dyn GrowthLaw>) -> Result<Self> {
        let formula = handbook(&case.specimen)
            .ok_or_else(|| input_missing("model.method", "\"handbook\" has no K(a) for this specimen", "use \"peridynamics\""))?;
        let severed = End { crack_length: case.specimen.length_limit().0, reason: StopReason::Severed };
        let end = first_end(case).unwrap_or(severed);
        case.specimen.beta.as_ref().map_or(Ok(()), |table| table.check_end(end.crack_length))?;
        let sharing = if case.specimen.convention == LengthConvention::SumOfTips { case.specimen.tips.len() as f64 } else { 1.0 };
        let of = |residual: &std::sync::Arc<ResidualStress>| FactorOfResidual::new(case, residual, end.crack_length);
        let residual = case.loading.residual.as_ref().filter(|_| end.crack_length > case.specimen.crack_length).map(of);
        Ok(HandCalculation { case, formula, law, end, sharing, residual, curve: Vec::new() })
    }

    fn last(&self) -> &CurvePoint {
        // `open` makes the first row, before the first block.
        &self.curve[self.curve.len() - 1]
    }

    /// K at maximum load, Pa√m, and how it follows the load.
    fn factors(&self, crack_length: f64) -> (f64, Response) {
        let of_load = self.formula.k_i(crack_length, self.case.loading.at(crack_length));
        let Some(residual) = &self.residual else { return (of_load, Response::PROPORTIONAL) };
        let of_residual = residual.at(crack_length);
        (of_load + of_residual, Response::of_residual(of_residual / (of_load + of_residual)))
    }

    /// da/dN, m/cycle.
    fn rate(&self, crack_length: f64) -> f64 {
        let (k_max, response) = self.factors(crack_length);
        if k_max <= 0.0 {
            return 0.0;
        }
        self.law.mean_rate(k_max, self.case.loading.ratio, &response)
    }

    /// Cycles between two crack lengths.
    fn cycles(&self, from: f64, to: f64) -> f64 {
        integrate(|a| 1.0 / (self.sharing * self.rate(a)), from, to, TOLERANCE).value
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
        let (k_max, response) = self.factors(crack_length);
        // Pressed shut.
        let k_max = if k_max < 0.0 { 0.0 } else { k_max };
        let growth = (crack_length - specimen.crack_length) / self.sharing;
        let growth_rate = self.rate(crack_length);
        let tip = |seed| TipRecord {
            factors: Some([k_max, 0.0]),
            response,
            growth_rate: Some(growth_rate),
            ..TipRecord::ahead(seed, growth)
        };
        let row = CurvePoint::bare(cycles, crack_length, specimen.tips.iter().map(tip).collect());
        let row = CurvePoint { growth_rate, limit_load: self.case.limit_load_at(crack_length), ..row };
        row.with_response(k_max, response, loading)
    }

    /// The next interval of the curve; the reason why there is none after it.
    /// Errors: a growth rate that is no number.
    pub fn next_interval(&mut self) -> Result<Option<StopReason>> {
        let (start, End { crack_length: end, reason }) = (self.case.specimen.crack_length, self.end);
        let (done, last) = (self.curve.len(), self.last());
        if done > INTERVALS || end <= start {
            return Ok(Some(reason));
        }
        let is_broken = |row: &CurvePoint| end_of_life::reason_to_stop(self.case, None, row, &[TipState::Active], true);
        let is_row_by_row = self.residual.is_some() || self.case.loading.course().is_some();
        if let Some(reason) = Some(last).filter(|_| is_row_by_row).and_then(is_broken) {
            return Ok(Some(reason));
        }
        let to = if done == INTERVALS { end } else { start * (end / start).powf(done as f64 / INTERVALS as f64) };
        // K of a formula rises with crack length, that of a table or of a residual stress may fall.
        if last.growth_rate == 0.0 || self.rate(to) == 0.0 {
            return Ok(Some(StopReason::NothingAges));
        }
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
        if more.is_infinite() && cycles_max.is_infinite() {
            return Ok(Some(StopReason::NothingAges));
        }
        if before + more > cycles_max {
            let reached = self.length_after(cycles_max - before, from, to);
            self.curve.push(self.point(cycles_max, reached));
            return Ok(Some(StopReason::RunOut));
        }
        let (next, reason) = (self.point(before + more, to), (done == INTERVALS).then_some(reason));
        // The sections of a plate are not known as a formula before the run, nor K of a residual stress or of a load that follows the crack.
        let is_open = self.case.specimen.ligament(to).is_none() || is_row_by_row;
        let (next, reason) = if is_open { end_of_life::row_after(self.case, last, next, reason) } else { (next, reason) };
        self.curve.push(next);
        Ok(reason)
    }
}

impl HandCalculation<'_> {
    /// What the user should know where residual stress outweighs the least load along the crack.
    fn overlap(&self) -> Option<String> {
        const LOOKED_AT: usize = 200;
        let Case { loading, .. } = self.case;
        let (residual, longest) = (loading.residual.as_ref()?, self.last().crack_length);
        let least = loading.maximum * loading.lower_loads().0.first()?.max(0.0);
        let presses = |x: &f64| residual.at([*x, 0.0])[1] + least < 0.0;
        let at = (0..=LOOKED_AT).map(|k| longest * k as f64 / LOOKED_AT as f64).find(presses)?;
        Some(format!(
            "contact: residual stress closes crack faces at x = {:.3} mm at minimum load; handbook K ignores their contact; use \
             model.method = \"element_free_galerkin\"",
            at / MM
        ))
    }
}

impl CrackGrowth for HandCalculation<'_> {
    fn open(&mut self) -> Result<()> {
        self.curve = vec![self.point(0.0, self.case.specimen.crack_length)];
        Ok(())
    }

    fn now(&self) -> &CurvePoint {
        self.last()
    }

    fn law(&self) -> Option<&dyn GrowthLaw> {
        Some(&*self.law)
    }

    fn curve(&mut self) -> Vec<CurvePoint> {
        std::mem::take(&mut self.curve)
    }

    fn warnings(&self) -> Vec<String> {
        self.overlap().into_iter().collect()
    }
}
