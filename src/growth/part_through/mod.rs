//! A crack that does not go through, by hand calculation until it does, and then on as a through crack by the K of its tips on nodes.
//!
//! Both semi-axes grow apart by the law over K (`fronts`; K: [`perilife_plate::specimen::part_through`]), under a spectrum whose order counts each with the zones of
//! its own overloads (`overloads`). Rule of break-through: the crack is through where its
//! deepest point reaches the far face, a/t = 1 (both faces of an embedded crack), up to which the equations of Newman and Raju (1984) are made
//! ("a/t < 1", their accuracy is stated to 0.8). From there on it is a straight through crack of length c, the one on the face at which it began: the
//! other face catches up within few cycles, so that the life that is left is rather too short.

mod fronts;
mod neighbours;
mod overloads;

pub use neighbours::Neighbours;
pub use overloads::Order;

use super::CrackGrowth;
use super::end_of_life::strength_reason;
use super::record::{CurvePoint, DepthRecord, StopReason, TipRecord, Turn};
use crate::case::Case;
use fronts::{Fronts, Grown, STEP_MOST};
use overloads::Overloads;
use perilife_base::error::{Error, Result, input_missing};
use perilife_base::units::MM;
use perilife_laws::growth_law::GrowthLaw;
use perilife_laws::retardation::Underway;
use perilife_plate::specimen::PartThrough;

/// [`CrackGrowth`] of a crack that does not go through.
pub struct PartThroughGrowth<'a> {
    fronts: Fronts<'a>,
    /// Step to try next.
    step: f64,
    /// What is known of the order of its loads, where that counts.
    overloads: Option<Overloads<'a>>,
    curve: Vec<CurvePoint>,
}

/// The case once the crack of a front is through, at its last row.
/// Errors: a plate without room for it.
pub fn broken_through(case: &Case, last: &CurvePoint) -> Result<Case> {
    Ok(case.with_through_crack(flaw(case)?.through(&case.specimen, last.crack_length)?))
}

/// What the user should know of the row at which the crack is through.
pub fn note(row: &CurvePoint) -> String {
    let CurvePoint { cycles, crack_length, .. } = row;
    let length = crack_length / MM;
    format!(
        "breakthrough: after {cycles:.0} cycles at c = {length:.3} mm; then a straight through crack of that length (K from nodes)"
    )
}

fn flaw(case: &Case) -> Result<PartThrough> {
    let problem = "is one of a through crack";
    case.specimen.part_through.ok_or_else(|| input_missing("specimen.kind", problem, "give a specimen with a part-through crack"))
}

impl<'a> PartThroughGrowth<'a> {
    /// The crack of a case before its first row, with what the order of its loads needs.
    /// Errors: a specimen whose crack goes through; no K beside other holes.
    pub fn start(case: &'a Case, law: Box<dyn GrowthLaw>, order: Option<Order>) -> Result<Self> {
        let flaw = flaw(case)?;
        let fronts = Fronts { case, flaw, neighbours: Neighbours::of(case, &flaw)?, law };
        let spectrum = case.loading.spectrum.as_deref();
        let overloads = spectrum.zip(order).map(|(spectrum, order)| Overloads::start(&fronts, spectrum, order));
        Ok(PartThroughGrowth { fronts, step: STEP_MOST, overloads, curve: Vec::new() })
    }

    /// Where the loads and the zone at the face are after the last row, where their order counts.
    pub fn overload(&self) -> Option<Underway> {
        self.overloads.as_ref().map(|overloads| overloads.at[1])
    }
}

impl PartThroughGrowth<'_> {
    fn last(&self) -> &CurvePoint {
        // `open` makes the first row, before the first step.
        &self.curve[self.curve.len() - 1]
    }

    /// Adds the next row; what ends the growth of the front there.
    /// Errors: a growth rate that is no number.
    pub fn next_step(&mut self) -> Result<Option<Turn>> {
        let from = self.place(self.last());
        if let Some(ending) = self.ending(from) {
            return Ok(Some(ending));
        }
        let next = match &mut self.overloads {
            Some(overloads) => overloads.next(&self.fronts, from),
            None => self.fronts.next(from, &mut self.step),
        };
        let Some((mut to, mut taken)) = next else { return self.standstill(from).map(Some) };
        let mut ending = self.ending(to);
        if ending.is_some() {
            (to, ending, taken) = self.first_ending(from, taken);
        }
        let row = match &mut self.overloads {
            Some(overloads) => {
                overloads.take(&self.fronts, from, taken);
                self.counted(from, to)
            }
            None => self.row(to),
        };
        self.curve.push(row);
        Ok(ending)
    }

    fn after(&self, from: Grown, step: f64) -> Grown {
        match &self.overloads {
            Some(overloads) => overloads.after(&self.fronts, from, step),
            None => self.fronts.after(from, step).0,
        }
    }

    /// The row of a place whose rates are those of the cycles from the last one.
    fn counted(&self, from: Grown, to: Grown) -> CurvePoint {
        let mut row = self.row(to);
        let rates = [0, 1].map(|end| (to.axes[end] - from.axes[end]) / (to.cycles - from.cycles));
        row.growth_rate = rates[0].max(rates[1]);
        row.depth = row.depth.map(|depth| DepthRecord { growth_rate: Some(rates[0]), ..depth });
        row.tips.iter_mut().for_each(|tip| tip.growth_rate = Some(rates[1]));
        row
    }

    /// Why there is no next place.
    fn standstill(&self, from: Grown) -> Result<Turn> {
        let rates = self.fronts.rates(from.axes);
        if rates.iter().any(|rate| rate.is_nan()) {
            let ([a, c], name) = (from.axes.map(|length| length / MM), &self.fronts.case.name);
            return Err(Error::Mechanics(format!("{name}: the growth rate at a = {a:.4} mm, c = {c:.4} mm is no number")));
        }
        // What grows and cannot go on is at the end of the width, where K is infinite.
        let grows = rates.iter().any(|rate| *rate > 0.0) && self.fronts.is_at_end(from.axes);
        Ok(Turn::Stop(if grows { StopReason::Severed } else { StopReason::NothingAges }))
    }

    /// Where within a step its ending is reached: halved until no double is left between.
    fn first_ending(&self, from: Grown, step: f64) -> (Grown, Option<Turn>, f64) {
        let (mut below, mut above) = (0.0, step);
        loop {
            let middle = 0.5 * (below + above);
            if middle <= below || middle >= above {
                let at = self.after(from, above);
                let ending = self.ending(at);
                return (self.settled(at, ending), ending, above);
            }
            if self.ending(self.after(from, middle)).is_some() { above = middle } else { below = middle }
        }
    }

    /// The place of an ending without its last rounding.
    fn settled(&self, Grown { axes: [a, c], cycles }: Grown, ending: Option<Turn>) -> Grown {
        let (stop, flaw) = (&self.fronts.case.stop, &self.fronts.flaw);
        match ending {
            Some(Turn::HandOver | Turn::Stop(StopReason::BrokenThrough)) => Grown { axes: [flaw.through_depth(), c], cycles },
            Some(Turn::Stop(StopReason::CrackDepthReached)) => Grown { axes: [stop.crack_depth, c], cycles },
            Some(Turn::Stop(StopReason::CrackLengthReached)) => Grown { axes: [a, stop.crack_length], cycles },
            Some(Turn::Stop(StopReason::RunOut)) => Grown { axes: [a, c], cycles: stop.cycles_max },
            _ => Grown { axes: [a, c], cycles },
        }
    }

    /// What ends growth at a place: what was asked for, what breaks under the load, the plate, break-through.
    fn ending(&self, Grown { axes, cycles }: Grown) -> Option<Turn> {
        let Fronts { case, flaw, .. } = &self.fronts;
        let required = case.stop.required.unwrap_or(1.0);
        let load = required * case.loading.maximum;
        let factor = required * self.fronts.factors(axes).into_iter().fold(0.0, f64::max);
        let breaks = |reason| Some(Turn::Stop(strength_reason(case, reason)));
        match axes {
            [a, _] if a >= case.stop.crack_depth => Some(Turn::Stop(StopReason::CrackDepthReached)),
            [_, c] if c >= case.stop.crack_length => Some(Turn::Stop(StopReason::CrackLengthReached)),
            _ if case.toughness_at_end().is_some_and(|toughness| factor >= toughness) => breaks(StopReason::Toughness),
            _ if case.yield_strength_at_end().is_some_and(|strength| flaw.limit_stress(axes, strength) <= load) => {
                breaks(StopReason::NetSectionYield)
            }
            // Under bending no plate in its plane can go on.
            [a, _] if a >= flaw.through_depth() && (case.stop.at_break_through || flaw.bending_ratio != 0.0) => {
                Some(Turn::Stop(StopReason::BrokenThrough))
            }
            [a, _] if a >= flaw.through_depth() => Some(Turn::HandOver),
            [_, c] if c >= flaw.to_hole => Some(Turn::Stop(StopReason::EnteredHole)),
            // K of most formulas is infinite where the crack takes the whole width.
            [_, c] if c >= flaw.room() || factor.is_infinite() => Some(Turn::Stop(StopReason::Severed)),
            _ if cycles >= case.stop.cycles_max => Some(Turn::Stop(StopReason::RunOut)),
            _ => None,
        }
    }

    fn place(&self, row: &CurvePoint) -> Grown {
        let depth = row.depth.map_or(self.fronts.flaw.depth, |record| record.depth);
        Grown { axes: [depth, row.crack_length], cycles: row.cycles }
    }

    fn row(&self, Grown { axes, cycles }: Grown) -> CurvePoint {
        let Fronts { case, flaw, .. } = &self.fronts;
        let (factors, rates) = (self.fronts.factors(axes), self.fronts.rates(axes));
        let growth = axes[1] - flaw.half_length;
        let tip =
            |seed| TipRecord { factors: Some([factors[1], 0.0]), growth_rate: Some(rates[1]), ..TipRecord::ahead(seed, growth) };
        CurvePoint {
            delta_k: case.loading.range_share() * factors[0].max(factors[1]),
            growth_rate: rates[0].max(rates[1]),
            limit_load: case.material.yield_strength.map(|strength| flaw.limit_stress(axes, strength)),
            depth: Some(DepthRecord { depth: axes[0], k_i: Some(factors[0]), growth_rate: Some(rates[0]) }),
            ..CurvePoint::bare(cycles, axes[1], case.specimen.tips.iter().map(tip).collect())
        }
    }

    /// Why a run that was not asked to ends at break-through.
    fn why_no_through_crack(&self) -> Option<String> {
        let Fronts { case, flaw, .. } = &self.fronts;
        let is_through = self.curve.last().is_some_and(|row| self.place(row).axes[0] >= flaw.through_depth());
        (is_through && flaw.bending_ratio != 0.0 && !case.stop.at_break_through).then(|| {
            "breakthrough: the run ends at break-through: K of a through crack under bending out of the plane of the plate is not computed"
                .to_owned()
        })
    }
}

impl CrackGrowth for PartThroughGrowth<'_> {
    fn open(&mut self) -> Result<()> {
        let [a, c] = self.fronts.flaw.start();
        self.curve = vec![self.row(Grown { axes: [a, c], cycles: 0.0 })];
        Ok(())
    }

    fn now(&self) -> &CurvePoint {
        self.last()
    }

    fn law(&self) -> Option<&dyn GrowthLaw> {
        Some(&*self.fronts.law)
    }

    /// Its rows, which stay where no through crack can go on.
    fn curve(&mut self) -> Vec<CurvePoint> {
        self.curve.clone()
    }

    fn warnings(&self) -> Vec<String> {
        self.why_no_through_crack().into_iter().collect()
    }
}
